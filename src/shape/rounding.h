/* SPDX-License-Identifier: BSD-2-Clause */
/* rounding: from double to float towards a side, for bounds that must hold; and the larger and the smaller of two
 * numbers. They agree with nextafterf, fmax and fmin on all numbers but NaNs. They stand here because those are calls
 * to the C library, which cost as much as all the rest of a surface. */
#pragma once

#include "bis/base/clones.h"

#include <stdint.h>
#include <string.h>

/* larger returns the larger of two numbers, smaller the smaller. */
static inline BIS_INLINE double larger(double a, double b) { return a > b ? a : b; }
static inline BIS_INLINE double smaller(double a, double b) { return a < b ? a : b; }

/* round_up returns the smallest float >= v; v lies within the range of floats. Floats of one sign are ordered as their
 * bits are. There is no branch, because no processor can predict whether a number was rounded up or down. */
static inline float round_up(double v)
{
    const float nearest = (float)v, from = nearest + 0.0f; /* -0 becomes 0 */
    int32_t bits;
    float up;

    memcpy(&bits, &from, sizeof bits);
    bits += ((double)nearest < v) * (1 | bits >> 31);
    memcpy(&up, &bits, sizeof up);
    return up;
}

/* round_down returns the largest float <= v. */
static inline float round_down(double v) { return -round_up(-v); }
