/* envmap_parts: what src/thesis/envmap.c lends to src/thesis/envmap_angular.c, and nobody else. */
#ifndef BIS_ENVMAP_PARTS_H
#define BIS_ENVMAP_PARTS_H

#include "bis/thesis/envmap.h"

/* Allocate the rows' edges and solid angles of a width x height map; pixels stay as they are. Errors: BIS_NOMEM. */
bis_status bis_envmap_init_rows(bis_envmap *em, int width, int height, bis_diag *diag);

/* E7: a NaN, infinite or negative channel becomes 0 and is counted as one of pixel (x, y), which subtends
 * solid_angle. */
rgb bis_envmap_clean(bis_envmap_defects *defects, rgb c, int x, int y, double solid_angle);

/* The circle at height u2 in [0,1) of row y: sin and cos of its polar angle, uniform in solid angle for uniform u2. */
void bis_envmap_circle(const bis_envmap *em, int y, double u2, double *sin_theta, double *cos_theta);

#endif
