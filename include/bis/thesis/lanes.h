/* SPDX-License-Identifier: BSD-2-Clause */
/* lanes: many directions at once, in arrays that the compiler turns into vectors.
 *
 * One candidate alone costs about 25 ns, most of it in the power of the lobe. Eight or sixteen candidates side by side
 * cost 1 to 2 ns each. This needs structures of float arrays, loops without calls or branches, polynomials for log and
 * exp, and BIS_LANES: it compiles a function for AVX-512, for AVX2 and for any processor, and the program chooses when
 * it starts. There are no intrinsics and no -ffast-math. A material's formulas serve lanes and single directions alike
 * (src/thesis/real_float.h).
 *
 * The bits do not depend on the processor: every operation is IEEE's, none is fused (-ffp-contract=off), and sums
 * have a fixed order. */
#pragma once

#include "bis/base/clones.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

/* Lanes come in blocks of this size. Arrays hold a whole number of blocks, and lanes that only fill the last block
 * have Le = 0. */
enum { BIS_LANES_BLOCK = 16 };

/* bis_lanes_blocks returns the number of blocks that hold n lanes, bis_lanes_round_up the number of lanes in these
 * blocks. */
static inline uint32_t bis_lanes_blocks(uint32_t n) { return (n + BIS_LANES_BLOCK - 1) / BIS_LANES_BLOCK; }
static inline uint32_t bis_lanes_round_up(uint32_t n) { return bis_lanes_blocks(n) * BIS_LANES_BLOCK; }

/* Directions towards the light. x, y, z: the unit direction wi in world space. r, g, b: the radiance from there over
 * the light's mean radiance; this quotient fits into a float whatever the map's unit is. q: the density in
 * 1/sr. Each array is aligned to 64 bytes. */
typedef struct bis_lanes {
    float *x, *y, *z, *r, *g, *b, *q;
} bis_lanes;

enum { BIS_LANES_ARRAYS = 7 };

/* bis_lanes_in returns the seven arrays of n lanes (a whole number of blocks) in memory[BIS_LANES_ARRAYS * n]. */
static inline bis_lanes bis_lanes_in(float *memory, uint32_t n)
{
    return (bis_lanes){memory, memory + n, memory + 2 * (size_t)n, memory + 3 * (size_t)n,
                       memory + 4 * (size_t)n, memory + 5 * (size_t)n, memory + 6 * (size_t)n};
}

/* bis_lanes_from returns the lanes of x from number i on. */
static inline bis_lanes bis_lanes_from(const bis_lanes *x, size_t i)
{
    return (bis_lanes){x->x + i, x->y + i, x->z + i, x->r + i, x->g + i, x->b + i, x->q + i};
}

/* bis_float_of_bits returns the float with these bits. */
static inline BIS_INLINE float bis_float_of_bits(int32_t i)
{
    float f;
    memcpy(&f, &i, sizeof f);
    return f;
}

/* bis_bits_of_float returns the bits of a float. */
static inline BIS_INLINE int32_t bis_bits_of_float(float f)
{
    int32_t i;
    memcpy(&i, &f, sizeof i);
    return i;
}

/* bis_lanes_choose returns yes ? a : b without a branch. gcc makes a branch of ?: if this can save work on one side,
 * and then the loop does not become a vector loop. */
static inline BIS_INLINE float bis_lanes_choose(int yes, float a, float b)
{
    const int32_t mask = -(int32_t)yes;
    return bis_float_of_bits((bis_bits_of_float(a) & mask) | (bis_bits_of_float(b) & ~mask));
}

/* bis_lanes_sum returns the sum of a block. It is added in halves, as vectors of any width add it, so the bits do not
 * depend on the width. */
static inline BIS_INLINE float bis_lanes_sum(const float v[BIS_LANES_BLOCK])
{
    float a[8], c[4];

    for (int i = 0; i < 8; i++) a[i] = v[i] + v[i + 8];
    for (int i = 0; i < 4; i++) c[i] = a[i] + a[i + 4];
    return (c[0] + c[2]) + (c[1] + c[3]);
}

/* bis_lanes_log1m returns log(1 - x) for 0 <= x < 1 with a relative error below 2^-22, also for x near 0; for this
 * reason the argument is x and not 1 - x. 1 - x = 2^e (1 + d) with 1 + d between sqrt(1/2) and sqrt(2). If e = 0, d
 * is -x itself, before 1 - x was rounded. log(1+d) = d - d^2/2 + d^3 P(d), where P interpolates at Chebyshev's nodes
 * with degree 7 and error 2e-8. */
static inline BIS_INLINE float bis_lanes_log1m(float x)
{
    int32_t bits = bis_bits_of_float(1 - x) - 0x3f3504f3; /* of sqrt(1/2) */
    int32_t e = bits >> 23;
    float rounded = bis_float_of_bits((bits & 0x7fffff) + 0x3f3504f3) - 1;
    float d = bis_lanes_choose(e == 0, -x, rounded);
    float p = -7.902743771e-02f;

    p = p * d + 1.262231985e-01f;
    p = p * d - 1.299818376e-01f;
    p = p * d + 1.421449592e-01f;
    p = p * d - 1.664128146e-01f;
    p = p * d + 2.000104509e-01f;
    p = p * d - 2.500030642e-01f;
    p = p * d + 3.333333073e-01f;
    float dd = d * d, k = (float)e;
    /* ln 2 in two parts: k times the first is exact */
    return k * 0.693359375f + (d + (dd * (d * p - 0.5f) - k * 2.12194440e-4f));
}

/* The parts of exp(y). e^y = 2^k e^r with |r| <= ln(2)/2, and em1 = e^r - 1. */
typedef struct bis_lanes_power {
    float two_k, em1; /* e^y = two_k (1 + em1) */
} bis_lanes_power;

/* bis_lanes_exp_parts returns the parts of exp(y) for y <= 0. e^r - 1 = r + r^2 P(r), where P has degree 4 and error
 * 1e-8. Results below 2^-64 are replaced by 2^-64, because a float's denormals are slow, and because a weight must
 * not be 0 where the exact one is not. */
static inline BIS_INLINE bis_lanes_power bis_lanes_exp_parts(float y)
{
    y = bis_lanes_choose(y < -44.361420f, -44.361420f, y); /* 64 ln 2 */
    int32_t k = (int32_t)(y * 1.44269504f - 0.5f);
    float kf = (float)k, r = (y - kf * 0.693359375f) + kf * 2.12194440e-4f;
    float p = 1.392617612e-03f;

    p = p * r + 8.363173075e-03f;
    p = p * r + 4.166655466e-02f;
    p = p * r + 1.666657703e-01f;
    p = p * r + 5.000000000e-01f;
    return (bis_lanes_power){bis_float_of_bits((k + 127) << 23), r + r * r * p};
}

/* bis_lanes_exp returns e^y for y <= 0. */
static inline BIS_INLINE float bis_lanes_exp(float y)
{
    bis_lanes_power e = bis_lanes_exp_parts(y);
    return e.two_k + e.two_k * e.em1;
}

/* bis_lanes_1mexp returns 1 - e^y for y <= 0 without cancellation: if k = 0, two_k - 1 is exactly 0. */
static inline BIS_INLINE float bis_lanes_1mexp(float y)
{
    bis_lanes_power e = bis_lanes_exp_parts(y);
    return (1 - e.two_k) - e.two_k * e.em1;
}

/* bis_lanes_sincos2pi stores sin and cos of 2 pi u, 0 <= u < 1, with an absolute error below 2^-22. It takes the
 * nearest quarter turn; the rest, at most pi/4, goes through polynomials with error 1e-8. */
static inline BIS_INLINE void bis_lanes_sincos2pi(float u, float *sine, float *cosine)
{
    int32_t quarter = (int32_t)(4 * u + 0.5f);
    float x = (4 * u - (float)quarter) * 1.57079633f, xx = x * x;
    float s = x + x * xx * (-1.666666466e-01f + xx * (8.332748271e-03f - xx * 1.958789088e-04f));
    float c = 1 - xx * (0.5f - xx * (4.166666466e-02f + xx * (-1.388830303e-03f + xx * 2.454794189e-05f)));
    float a = bis_lanes_choose(quarter & 1, c, s), b = bis_lanes_choose(quarter & 1, s, c);

    *sine = bis_lanes_choose(quarter >> 1 & 1, -a, a);
    *cosine = bis_lanes_choose((quarter + 1) >> 1 & 1, -b, b);
}

/* bis_lanes_atan2 returns atan2(y, x) in [-pi, pi] with an absolute error below 4e-7. atan(a)/a for 0 <= a <= 1 is a
 * polynomial in a^2 of degree 9 with error 2e-9. */
static inline BIS_INLINE float bis_lanes_atan2(float y, float x)
{
    float ax = bis_lanes_choose(x < 0, -x, x), ay = bis_lanes_choose(y < 0, -y, y);
    float most = bis_lanes_choose(ax > ay, ax, ay), least = bis_lanes_choose(ax > ay, ay, ax);
    float a = least / bis_lanes_choose(most > 0, most, 1), s = a * a;
    float p = -1.701170068e-03f;

    p = p * s + 1.048764927e-02f;
    p = p * s - 3.035186482e-02f;
    p = p * s + 5.708955597e-02f;
    p = p * s - 8.349724971e-02f;
    p = p * s + 1.093234150e-01f;
    p = p * s - 1.426001608e-01f;
    p = p * s + 1.999807528e-01f;
    p = p * s - 3.333327629e-01f;
    p = p * s + 9.999999972e-01f;
    a = p * a;
    a = bis_lanes_choose(ay > ax, 1.57079633f - a, a);
    a = bis_lanes_choose(x < 0, 3.14159265f - a, a);
    return bis_lanes_choose(y < 0, -a, a);
}
