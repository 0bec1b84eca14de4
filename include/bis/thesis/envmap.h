/* SPDX-License-Identifier: BSD-2-Clause */
/* envmap: an environment map is a sphere of patches of constant radiance. Source: thesis 3.1, eq. 3.2.
 *
 * The map is lat-long, W x H pixels, in the light's own frame with z up. Direction (sin t cos p, sin t sin p, cos t)
 * lies at u = p/(2 pi), v = t/pi; row 0 is at +z. A pixel is a patch and not a point light (docs/errata.md E2): a
 * direction inside it is drawn uniformly by solid angle. Radiance is always that of the nearest pixel (E4). This
 * module knows neither files nor the world. */
#pragma once

#include "bis/base/status.h"
#include "bis/base/vec.h"

#include <stddef.h>
#include <stdint.h>

/* The defects in the values of a map (E7). They are counted by kind and set to 0. */
typedef struct bis_envmap_defects {
    size_t n_nan, n_infinite, n_negative; /* channel values */
    int first_x, first_y;                 /* the first bad pixel of any kind, in reading order */
    char first_channel;                   /* 'R', 'G', 'B' */
    double solid_angle;                   /* solid angle of the bad pixels in sr */
} bis_envmap_defects;

typedef struct bis_envmap {
    int width, height;
    rgb *pixels;             /* pixels[height][width], finite and >= 0 */
    double *cos_edge;        /* cos_edge[height + 1]: cos(pi j / height), exactly 1 and -1 at the ends */
    /* row_solid_angle[height]: the solid angle in sr of ONE pixel of row j, (2 pi / W)(cos t_j - cos t_{j+1}),
     * computed without cancellation */
    double *row_solid_angle;
    bis_envmap_defects defects;
    /* the mapping of the file, if it was resampled (bis/beyond/mapping.h), and the integral of intensity over the
     * sphere before and after; NULL, 0, 0 for a lat-long map */
    const char *resampled_from;
    double power_before, power_after;
} bis_envmap;

typedef struct bis_image bis_image; /* bis/base/image.h */

/* bis_envmap_from_latlong makes a map of a lat-long image and sets bad values to 0. It takes over the pixels; *image
 * is empty afterwards, on failure too. width * height must be < 2^32. Errors: BIS_NOMEM. */
bis_status bis_envmap_from_latlong(bis_envmap *em, bis_image *image, bis_diag *diag);

/* bis_envmap_clear frees the map. *em is empty afterwards. */
void bis_envmap_clear(bis_envmap *em);

/* bis_envmap_scale multiplies the radiance by `scale`, which is finite and >= 0 per channel. Errors: BIS_INPUT if a
 * value would overflow to infinity. The map is then unchanged. */
bis_status bis_envmap_scale(bis_envmap *em, rgb scale, bis_diag *diag);

/* bis_envmap_pixel returns the pixel (y * width + x) that contains w_local, a unit direction in the light's frame. It
 * uses atan2 in double, because acos of a float finds the wrong row for one direction in 23 at 4096 rows. */
size_t bis_envmap_pixel(const bis_envmap *em, vec3 w_local);

/* bis_envmap_Le returns the radiance from the unit direction w_local. */
static inline rgb bis_envmap_Le(const bis_envmap *em, vec3 w_local)
{
    return em->pixels[bis_envmap_pixel(em, w_local)];
}

/* bis_envmap_direction returns the direction at (u1, u2) of pixel (x, y). If (u1, u2) is uniform in [0,1)^2, the
 * direction is uniform by solid angle, because phi and cos(theta) are uniform between the edges (E2). */
vec3 bis_envmap_direction(const bis_envmap *em, int x, int y, double u1, double u2);

/* bis_envmap_measure computes the two following numbers in one pass over the map. */
void bis_envmap_measure(const bis_envmap *em, double *power, double *most);

/* bis_envmap_power returns the integral of r+g+b over the sphere, summed in double. */
double bis_envmap_power(const bis_envmap *em);

/* bis_envmap_max_intensity returns the largest r+g+b of a pixel. */
double bis_envmap_max_intensity(const bis_envmap *em);

/* bis_envmap_bytes returns the bytes that the pixels and the tables take. */
size_t bis_envmap_bytes(const bis_envmap *em);
