/* SPDX-License-Identifier: BSD-2-Clause */
/* warp: maps from the unit square to the shapes that rendering needs. Each preserves the measure up to the stated
 * density. u1 and u2 are uniform in [0,1) and independent. */
#pragma once

#include "bis/base/vec.h"

/* bis_warp_sphere returns a direction that is uniform on the sphere. Its density is 1/(4 pi) per sr. */
vec3 bis_warp_sphere(double u1, double u2);

/* bis_warp_cosine returns a direction on the hemisphere about +z with density cos(theta)/pi per sr: a uniform disc,
 * lifted to the hemisphere (Malley). sin theta = sqrt(u1), phi = 2 pi u2, cos theta = sqrt(1 - u1) > 0. Materials draw
 * by the same formula (src/thesis/direction_formulas.h). */
vec3 bis_warp_cosine(double u1, double u2);
