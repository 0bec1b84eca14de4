/* SPDX-License-Identifier: BSD-2-Clause */
/* warp: the maps of bis/thesis/warp.h, computed in double. Sines do not come from cosines, because sqrt(1 - z^2) near z
 * = 1 would lose half its digits. */
#include "bis/thesis/warp.h"

#include "thesis/real_double.h"

#include "thesis/direction_formulas.h"

vec3 bis_warp_sphere(double u1, double u2)
{
    /* Archimedes: z is uniform in (-1, 1]. sin^2 theta = (1 - z)(1 + z) with z = 1 - 2 u1. */
    double sin_theta = 2 * sqrt(u1 * (1 - u1)), phi = 2 * PI * u2;
    return vec3_from(sin_theta * cos(phi), sin_theta * sin(phi), 1 - 2 * u1);
}

vec3 bis_warp_cosine(double u1, double u2)
{
    const direction w = cosine(u1, u2);

    return vec3_from(w.x, w.y, w.z);
}
