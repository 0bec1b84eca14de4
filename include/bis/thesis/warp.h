/* warp: maps from the unit square to the shapes that rendering needs. Each preserves the measure up to the stated
 * density. u1 and u2 are uniform in [0,1) and independent. */
#pragma once

#include "bis/base/vec.h"

/* bis_warp_sphere returns a direction that is uniform on the sphere. Its density is 1/(4 pi) per sr. */
vec3 bis_warp_sphere(double u1, double u2);

/* bis_warp_disc stores a point that is uniform on the unit disc in d[2]. It is the concentric map of Shirley and
 * Chiu, which keeps neighbouring numbers neighbours. */
void bis_warp_disc(double d[2], double u1, double u2);

/* bis_warp_cosine returns a direction on the hemisphere about +z with density cos(theta)/pi per sr. z is > 0 for all
 * (u1, u2) but those that the map puts on the disc's rim, where z = 0. z is computed without the cancellation of 1 -
 * r^2 near the rim. */
vec3 bis_warp_cosine(double u1, double u2);

/* bis_warp_cosine_pdf returns the density of bis_warp_cosine in 1/sr: cos_theta/pi, and 0 below the horizon. */
double bis_warp_cosine_pdf(double cos_theta);
