/* SPDX-License-Identifier: BSD-2-Clause */
/* map_help: small environment maps for tests, and comparing numbers. */
#ifndef TESTS_MAP_HELP_H
#define TESTS_MAP_HELP_H

#include "bis/thesis/envmap.h"

#include <stdint.h>

/* A black map; set pixels[] at will. bis_envmap_clear it. */
bis_envmap map_new(int width, int height);

/* Log-uniform intensities over `decades` powers of ten with random hues, a fraction `black` of the pixels black. */
bis_envmap map_random(int width, int height, double decades, double black, uint64_t seed);

/* A copy turned by k columns to the right. */
bis_envmap map_rolled(const bis_envmap *em, int k);

size_t map_n(const bis_envmap *em);
double map_intensity(const bis_envmap *em, size_t pixel);
double map_solid_angle(const bis_envmap *em, size_t pixel);

/* |a - b| <= tolerance; a NaN fails. A macro, as cmocka's assertions are, for the place in the message. */
#define assert_near(a, b, tolerance) map_assert_near((a), (b), (tolerance), __FILE__, __LINE__)
void map_assert_near(double a, double b, double tolerance, const char *file, int line);

/* Path of a file of the shared test data, or NULL when it is not there. The string lives until the next call. */
const char *shared_data(const char *name);

#endif
