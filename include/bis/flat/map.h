/* SPDX-License-Identifier: BSD-2-Clause */
/* map: what is known of a map beyond its radiance, and its pixels as directions. The rules of bis/flat/flat.h hold.
 * A pixel is y * width + x. */
#pragma once

#include "bis/flat/flat.h"

/* bis_flat_light_open_as reads a map as a scene does whose light has these settings, a list of "name=value" that ends
 * with NULL: kind (alias or cdf), area_exponent, levels, mapping, width (of the lat-long map that another one is
 * resampled to), as_printed (E3, E13 or E20). Errors: as bis_flat_light_open. */
int bis_flat_light_open_as(bis_light **light, const char *path, const char *const *settings, char *say, size_t size);

/* bis_flat_light_make_as does the same with radiance in pixels[height][width][3], as bis_flat_light_make. */
int bis_flat_light_make_as(bis_light **light, int width, int height, const float *pixels, const char *const *settings,
                           char *say, size_t size);

/* bis_flat_light_source returns the name of the mapping that the file had, "latlong" if it was not resampled. */
const char *bis_flat_light_source(const bis_light *light);

/* bis_flat_light_facts stores in facts[7] the integral of r+g+b over the sphere before and after resampling (0: it was
 * not resampled); how many values were NaN, infinite or negative and became 0, and the solid angle of their pixels; and
 * the bytes of the tables for drawing directions. */
void bis_flat_light_facts(const bis_light *light, double *facts);

/* bis_flat_light_angles stores in angles[height] the solid angle in sr of one pixel of each row. */
void bis_flat_light_angles(const bis_light *light, double *angles);

/* bis_flat_light_centres stores in w[n][3] the direction of the middle, by solid angle, of each pixel[n]. Errors:
 * BIS_INPUT (a pixel that the map does not have). */
int bis_flat_light_centres(const bis_light *light, size_t n, const uint32_t *pixel, float *w, char *say, size_t size);

/* bis_flat_light_draw draws pixel[n] from u[n][4] as bis_flat_light_sample draws directions. Errors: as that
 * function. */
int bis_flat_light_draw(const bis_light *light, size_t n, const double *u, uint32_t *pixel, char *say, size_t size);
