/* SPDX-License-Identifier: BSD-2-Clause */
/* say: what the functions of flat share: messages into the caller's buffer, settings as text. */
#pragma once

#include "bis/scene/scene.h"

#include <stdint.h>

/* bis_flat_end writes all messages to say[size], one a line, frees them, and returns the status. say may be NULL. */
int bis_flat_end(bis_status status, bis_diag *diag, char *say, size_t size);

/* bis_flat_given looks whether one of n pointers is NULL. names tells them apart: "a, b, c". Errors: BIS_INPUT. */
bis_status bis_flat_given(const char *names, const void *const *pointers, size_t n, bis_diag *diag);

/* The same for a list of variables, whose names the message takes: no function can see them. */
#define BIS_FLAT_GIVEN(diag, ...)                                                                                   \
    bis_flat_given(#__VA_ARGS__, (const void *const[]){__VA_ARGS__},                                                \
                   sizeof(const void *const[]){__VA_ARGS__} / sizeof(void *), diag)

/* bis_flat_weights checks that there are weights w[n] from which one can draw. Errors: BIS_INPUT (n is 0 or above
 * 2^32 - 1, a weight is negative or not finite, all are 0). */
bis_status bis_flat_weights(size_t n, const double *w, bis_diag *diag);

/* bis_flat_direction stores the i-th direction of all[][3] as a unit vector. Errors: BIS_INPUT (it is 0 or not
 * finite). */
bis_status bis_flat_direction(vec3 *w, const float *all, size_t i, bis_diag *diag);

/* bis_flat_unit stores v[3], called name, as a unit vector. Errors: BIS_INPUT (it is 0 or not finite). */
bis_status bis_flat_unit(vec3 *w, const char *name, const double *v, bis_diag *diag);

/* bis_flat_check_numbers checks the random numbers u[n][k] of n samples. Errors: BIS_INPUT (one outside [0,1)). */
bis_status bis_flat_check_numbers(size_t n, size_t k, const double *u, bis_diag *diag);

/* bis_flat_light_describe stores what the arguments say of a map: its name in messages, its table, b of thesis 3.4, and
 * how it covers the sphere (NULL: not said). name is borrowed. Errors: BIS_INPUT (kind, area_exponent, mapping). */
bis_status bis_flat_light_describe(bis_light_desc *desc, const char *name, const char *kind, double area_exponent,
                                   const char *mapping, bis_diag *diag);
