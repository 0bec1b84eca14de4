/* envmap: an environment map is a sphere of constant-radiance patches, thesis 3.1, eq. 3.2.
 *
 * Lat-long, W x H pixels, in the light's own frame, z up: direction (sin t cos p, sin t sin p, cos t) lies at u = p/(2
 * pi), v = t/pi, row 0 at +z. A pixel is a patch, not a point light (docs/errata.md E2): a direction inside it is drawn
 * uniformly by solid angle, and radiance is looked up by nearest pixel everywhere (E4). Nothing here knows about files
 * or worlds. */
#ifndef BIS_ENVMAP_H
#define BIS_ENVMAP_H

#include "bis/base/status.h"
#include "bis/base/vec.h"

#include <stddef.h>
#include <stdint.h>

/* What was wrong with the values of a map (E7): counted per kind, and set to 0. */
typedef struct bis_envmap_defects {
    size_t n_nan, n_infinite, n_negative; /* channel values */
    int first_x, first_y;                 /* the first pixel of any kind, in reading order */
    char first_channel;                   /* 'R', 'G', 'B' */
    double solid_angle;                   /* sr of the pixels concerned */
} bis_envmap_defects;

typedef struct bis_envmap {
    int width, height;
    rgb *pixels;             /* pixels[height][width], finite and >= 0 */
    double *cos_edge;        /* cos_edge[height + 1]: cos(pi j / height), exactly 1 and -1 at the ends */
    double *row_solid_angle; /* row_solid_angle[height]: sr of ONE pixel of row j, (2 pi / W)(cos t_j - cos t_{j+1}) without cancellation */
    bis_envmap_defects defects;
    double angular_power_before, angular_power_after; /* integral of intensity around the resampling of an angular map; 0, 0 for a lat-long */
} bis_envmap;

typedef struct bis_image bis_image; /* bis/base/image.h */

/* Take over the image's pixels (image is cleared, on failure, too); clean bad values. width * height < 2^32. Errors:
 * BIS_NOMEM. */
bis_status bis_envmap_from_latlong(bis_envmap *em, bis_image *image, bis_diag *diag);

/* Resample a square angular map (Debevec's probe; SPEC 1) once to width x width/2, by averaging over each patch with
 * enough sub-samples that the energy agrees to 1%. width 0: twice the probe's width; odd widths are rounded up to even.
 * Pixels whose centre has r > 1 are ignored. image is borrowed. Errors: BIS_INPUT (not square), BIS_NOMEM. */
bis_status bis_envmap_from_angular(bis_envmap *em, const bis_image *image, int width, bis_diag *diag);
void bis_envmap_clear(bis_envmap *em);

/* Multiply the radiance by scale (finite, >= 0, per channel); overflow to infinity is BIS_INPUT and leaves the map as
 * it was. */
bis_status bis_envmap_scale(bis_envmap *em, rgb scale, bis_diag *diag);

/* The pixel (y * width + x) that a unit direction of the light's frame lies in. By atan2 in double: acos of a float
 * misses the row of one direction in 23 at 4096 rows. */
size_t bis_envmap_pixel(const bis_envmap *em, vec3 w_local);

/* Radiance from w_local. */
static inline rgb bis_envmap_Le(const bis_envmap *em, vec3 w_local) { return em->pixels[bis_envmap_pixel(em, w_local)]; }

/* The direction at (u1, u2) in [0,1)^2 of pixel (x, y), uniform in solid angle: phi and cos(theta) uniform between the
 * edges (E2). */
vec3 bis_envmap_direction(const bis_envmap *em, int x, int y, double u1, double u2);

/* Integral of r+g+b over the sphere, in double. */
double bis_envmap_power(const bis_envmap *em);
double bis_envmap_max_intensity(const bis_envmap *em);

/* Bytes of the pixels, and of all else. */
size_t bis_envmap_bytes(const bis_envmap *em);

#endif
