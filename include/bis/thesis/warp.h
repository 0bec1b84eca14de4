/* warp: from the unit square to the shapes that rendering needs, measure preserving up to the stated density. */
#ifndef BIS_WARP_H
#define BIS_WARP_H

#include "bis/base/vec.h"

/* Uniform on the sphere; pdf 1/(4 pi). */
vec3 bis_warp_sphere(double u1, double u2);

/* Uniform on the unit disc, Shirley and Chiu's concentric map: keeps neighbouring numbers neighbours. */
void bis_warp_disc(double d[2], double u1, double u2);

/* Cosine-weighted on the hemisphere about +z; pdf cos(theta)/pi. z > 0 for all u in [0,1)^2 but those that the disc's
 * rim maps to z = 0. z is computed without the cancellation of 1 - r^2 near the rim. */
vec3 bis_warp_cosine(double u1, double u2);
double bis_warp_cosine_pdf(double cos_theta);

#endif
