/* SPDX-License-Identifier: BSD-2-Clause */
/* say: what the functions of flat share: messages into the caller's buffer, checks of arrays.
 *
 * A function bis_flat_NAME that returns a status is made by face.awk of its prototype: it looks for NULLs, has
 * bis_do_NAME do the work, and says what went wrong. flat/face.h, which is made, too, declares all bis_do_NAME. */
#pragma once

#include "bis/scene/light_load.h"
#include "bis/scene/scene.h"

#include <stdint.h>

/* Where the mistakes of a caller are. */
static const bis_loc nowhere = {0};

/* bis_flat_end writes all messages to say[size], one a line, frees them, and returns the status. say may be NULL. */
int bis_flat_end(bis_status status, bis_diag *diag, char *say, size_t size);

/* bis_flat_refuse adds what is wrong with the caller's arguments to diag, and returns BIS_INPUT. */
bis_status bis_flat_refuse(bis_diag *diag, const char *fmt, ...) BIS_PRINTF(2, 3);

/* bis_flat_no_mapping refuses the name of a mapping, and lists those that there are. */
bis_status bis_flat_no_mapping(bis_diag *diag, const char *mapping);

/* A pointer to n items that a caller gives; n = 0: it may be NULL. */
typedef struct bis_flat_pointer {
    const char *name;
    const void *pointer;
    size_t n;
} bis_flat_pointer;

/* bis_flat_given looks whether one of the pointers is NULL; behind the last one the name is. Errors: BIS_INPUT. */
bis_status bis_flat_given(const bis_flat_pointer *all, bis_diag *diag);

/* bis_flat_weights checks that there are weights w[n] from which one can draw. Errors: BIS_INPUT (n is 0 or above
 * 2^32 - 1, a weight is negative or not finite, all are 0). */
bis_status bis_flat_weights(size_t n, const double *w, bis_diag *diag);

/* bis_flat_direction stores the i-th direction of all[][3] as a unit vector. Errors: BIS_INPUT (it is 0 or not
 * finite). */
bis_status bis_flat_direction(vec3 *w, const float *all, size_t i, bis_diag *diag);

/* bis_flat_unit stores v[3], called name, as a unit vector. Errors: BIS_INPUT (it is 0 or not finite). */
bis_status bis_flat_unit(vec3 *w, const char *name, const double *v, bis_diag *diag);

/* bis_flat_numbers checks the random numbers u[n][k] of n samples. Errors: BIS_INPUT (one outside [0,1)). */
bis_status bis_flat_numbers(size_t n, size_t k, const double *u, bis_diag *diag);

/* The value of a map or a material in a direction, and the density of drawing it. */
typedef rgb bis_flat_looker(const void *handle, vec3 w, double *pdf);

/* bis_flat_look stores value[n][3] and density pdf[n], as value_of tells them, in the directions w[n][3]. Errors:
 * BIS_INPUT (a direction is 0 or not finite). */
bis_status bis_flat_look(bis_flat_looker *value_of, const void *handle, size_t n, const float *w, float *value,
                         double *pdf, bis_diag *diag);

/* bis_flat_image_of copies pixels[height][width][channels], of which the first three are R, G and B. The caller clears
 * *image, after an error too. Errors: those of bis_image_init. */
bis_status bis_flat_image_of(bis_image *image, int width, int height, int channels, const float *pixels,
                             bis_diag *diag);
