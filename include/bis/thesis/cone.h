/* SPDX-License-Identifier: BSD-2-Clause */
/* cone: bounds over many directions at once, for models that say how much they can reflect from a part of the sphere.
 * */
#pragma once

#include "bis/base/vec.h"
#include "bis/thesis/lanes.h"

/* Cones of directions with the light that comes from each: the axis, a unit vector, in x, y, z; the cosine of the half
 * angle, and at least its sine; the energy in r, g, b, which is the integral of Le over the cone's part of the map,
 * over the light's mean radiance. Arrays hold whole blocks of lanes. */
typedef struct bis_cones {
    float *x, *y, *z, *cosine, *sine, *r, *g, *b;
} bis_cones;

enum { BIS_CONES_ARRAYS = 8 };

/* bis_cones_in returns the eight arrays of n cones (a whole number of blocks) in memory[BIS_CONES_ARRAYS * n]. */
static inline bis_cones bis_cones_in(float *memory, uint32_t n)
{
    const size_t m = n;

    return (bis_cones){memory,         memory + m,     memory + 2 * m, memory + 3 * m,
                       memory + 4 * m, memory + 5 * m, memory + 6 * m, memory + 7 * m};
}

/* bis_cone_sine returns at least the sine of an angle whose cosine c, of two unit vectors of floats, was rounded by at
 * most 2^-22. So 1 - c^2 is off by less than 2^-20, which is added, because the sine of an angle near 0 or pi is the
 * root of that error. */
static inline BIS_INLINE float bis_cone_sine(float c)
{
    return sqrtf(1 + 0x1p-20f - c * c);
}

/* bis_cone_cosine returns at least the largest cosine about a unit axis over the directions of a cone: that of the
 * angle between the two axes less the half angle, or 1 where the axis lies within. 2^-20 is added, because c and the
 * two products are each off by less than 2^-22. */
static inline BIS_INLINE float bis_cone_cosine(vec3 axis, float x, float y, float z, float cosine, float sine)
{
    const float c = axis.x * x + axis.y * y + axis.z * z;
    const float most = c * cosine + bis_cone_sine(c) * sine + 0x1p-20f;
    const float bounded = bis_lanes_choose(most < 1, most, 1);

    return bis_lanes_choose(c > cosine, 1, bounded);
}
