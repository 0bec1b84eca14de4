/* rounding: from double to float towards a side, for bounds that must hold. */
#pragma once

#include <math.h>

/* The largest float <= v; v within the range of floats. */
static inline float round_down(double v)
{
    float f = (float)v;
    return (double)f > v ? nextafterf(f, -INFINITY) : f;
}

/* The smallest float >= v. */
static inline float round_up(double v)
{
    float f = (float)v;
    return (double)f < v ? nextafterf(f, INFINITY) : f;
}
