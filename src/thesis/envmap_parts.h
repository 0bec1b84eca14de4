/* SPDX-License-Identifier: BSD-2-Clause */
/* envmap_parts: functions of src/thesis/envmap.c that are no part of its face. src/beyond/mapping.c uses the first
 * two. */
#pragma once

#include "bis/thesis/envmap.h"

/* bis_envmap_init_rows allocates and fills the edges and solid angles of the rows of a width x height map. The pixels
 * stay as they are. Errors: BIS_NOMEM. */
bis_status bis_envmap_init_rows(bis_envmap *em, int width, int height, bis_diag *diag);

/* bis_envmap_clean returns the colour c without bad values (docs/errata.md E7): a channel that is NaN, infinite or
 * negative becomes 0. It is counted in *defects as a channel of pixel (x, y), which subtends solid_angle sr. */
rgb bis_envmap_clean(bis_envmap_defects *defects, rgb c, int x, int y, double solid_angle);

/* bis_envmap_circle stores sin and cos of the polar angle of the circle at height u2 in [0,1) of row y. If u2 is
 * uniform, the circle is uniform by solid angle. */
void bis_envmap_circle(const bis_envmap *em, int y, double u2, double *sin_theta, double *cos_theta);
