/* cone_lanes: what the bounds of phong_lanes.c and microfacet_lanes.c over cones of directions share. */
#pragma once

#include "bis/base/vec.h"
#include "bis/beyond/lanes.h"

/* Returns the largest cosine about an axis over the directions of a cone: that of the angle between the two axes less
 * the half angle, or 1 where the axis lies within. Never too small for rounding: 2^-20 is added. */
static inline BIS_INLINE float largest_cosine(vec3 axis, float x, float y, float z, float cosine, float sine)
{
    const float c = axis.x * x + axis.y * y + axis.z * z, s2 = 1 - c * c;
    const float s = sqrtf(bis_lanes_choose(s2 > 0, s2, 0));
    const float most = c * cosine + s * sine + 0x1p-20f;
    const float bounded = bis_lanes_choose(most < 1, most, 1);

    return bis_lanes_choose(c > cosine, 1, bounded);
}
