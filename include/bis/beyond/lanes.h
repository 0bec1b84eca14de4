/* lanes: many directions at once, as arrays that the compiler turns into vectors.
 *
 * A candidate costs some 25 ns one by one, most of it in the power of the lobe; eight or sixteen side by side cost 1 to
 * 2 ns each. What it takes:
 * structures of arrays, in float; loops without calls or branches; polynomials for log and exp; and BIS_LANES, which
 * has a function compiled for AVX-512, for AVX2 and for any processor, and chooses when the program starts. No
 * intrinsics, no -ffast-math: each loop is plain C and the same formula as in the plain module beside it (phong_lanes.c
 * : phong.c), which stays its reference and its oracle in the tests.
 *
 * The bits do not depend on the processor: every operation is IEEE's, none is fused (-ffp-contract=off), and sums have
 * a fixed order. */
#ifndef BIS_LANES_H
#define BIS_LANES_H

#include <math.h>
#include <stdint.h>
#include <string.h>

/* Clones need an indirect function of glibc's loader. Sanitizers instrument the function that chooses, and it runs
 * before they are ready. For static functions only: clang 14 gives an exported one another name than its callers in other
 * files know. */
#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !defined(BIS_ONE_CLONE)
#if !defined(__has_feature)
#define BIS_LANES __attribute__((target_clones("avx512f", "avx2", "default")))
#elif !__has_feature(address_sanitizer) && !__has_feature(thread_sanitizer) && !__has_feature(undefined_behavior_sanitizer)
#define BIS_LANES __attribute__((target_clones("avx512f", "avx2", "default")))
#endif
#endif
#ifndef BIS_LANES
#define BIS_LANES
#endif

/* Into every clone, before it is made: a loop with a call in it is no vector. */
#define BIS_INLINE __attribute__((always_inline))

/* Lanes come in blocks of so many: arrays hold a whole number of blocks, and what fills the last one has Le = 0. */
enum { BIS_LANES_BLOCK = 16 };

static inline uint32_t bis_lanes_blocks(uint32_t n) { return (n + BIS_LANES_BLOCK - 1) / BIS_LANES_BLOCK; }
static inline uint32_t bis_lanes_round_up(uint32_t n) { return bis_lanes_blocks(n) * BIS_LANES_BLOCK; }

/* Directions towards the light: wi = (x, y, z), unit, world space; radiance from there over the light's mean radiance,
 * which keeps it within a float's range whatever the map's unit; the light's density in 1/sr. Each array 64-byte
 * aligned. */
typedef struct bis_lanes {
    float *x, *y, *z, *r, *g, *b, *q_L;
} bis_lanes;

enum { BIS_LANES_ARRAYS = 7 };

/* The seven arrays of n lanes (a whole number of blocks) in memory[BIS_LANES_ARRAYS * n]. */
static inline bis_lanes bis_lanes_in(float *memory, uint32_t n)
{
    return (bis_lanes){memory, memory + n, memory + 2 * (size_t)n, memory + 3 * (size_t)n, memory + 4 * (size_t)n, memory + 5 * (size_t)n, memory + 6 * (size_t)n};
}

static inline BIS_INLINE float bis_float_of_bits(int32_t i)
{
    float f;
    memcpy(&f, &i, sizeof f);
    return f;
}

static inline BIS_INLINE int32_t bis_bits_of_float(float f)
{
    int32_t i;
    memcpy(&i, &f, sizeof i);
    return i;
}

/* yes ? a : b without a branch, which gcc makes of ?: where it can save work on one side, and then has no vector. */
static inline BIS_INLINE float bis_lanes_choose(int yes, float a, float b)
{
    const int32_t mask = -(int32_t)yes;
    return bis_float_of_bits((bis_bits_of_float(a) & mask) | (bis_bits_of_float(b) & ~mask));
}

/* log(1 - x) for 0 <= x < 1, relative error below 2^-22 (x near 0 included: that is why the argument is x and not 1 -
 * x). 1 - x = 2^e (1 + d) with 1 + d between sqrt(1/2) and sqrt(2); where e = 0, d is -x itself, before 1 - x was
 * rounded. log(1+d) = d - d^2/2 + d^3 P(d), P by interpolation at Chebyshev's nodes, degree 7: 2e-8. */
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
    return k * 0.693359375f + (d + (dd * (d * p - 0.5f) - k * 2.12194440e-4f)); /* ln 2 in two parts: k times the first is exact */
}

/* exp(y) - 1 and exp(y) for y <= 0: e^y = 2^k e^r, |r| <= ln(2)/2, e^r - 1 = r + r^2 P(r), degree 4: 1e-8. Below 2^-64,
 * which stands for everything smaller: a float's denormals are slow, and a weight must not be 0 where the exact one is
 * not. */
typedef struct bis_lanes_power {
    float two_k, em1; /* e^y = two_k (1 + em1) */
} bis_lanes_power;

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

static inline BIS_INLINE float bis_lanes_exp(float y)
{
    bis_lanes_power e = bis_lanes_exp_parts(y);
    return e.two_k + e.two_k * e.em1;
}

/* 1 - e^y without cancellation: where k = 0, two_k - 1 is 0 exactly. */
static inline BIS_INLINE float bis_lanes_1mexp(float y)
{
    bis_lanes_power e = bis_lanes_exp_parts(y);
    return (1 - e.two_k) - e.two_k * e.em1;
}

/* sin and cos of 2 pi u, 0 <= u < 1, absolute error below 2^-22: the nearest quarter turn, and what is left of it, at
 * most pi/4, by polynomials, 1e-8. */
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

/* atan2(y, x) in [-pi, pi], absolute error below 4e-7. atan(a)/a for 0 <= a <= 1 by a polynomial in a^2, degree 9:
 * 2e-9. */
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

/* n stratified points, one in each n-th of Hilbert's curve over the unit square, in its order, as a function of key:
 * u1[n], u2[n] and on to the end of their last block. 24 bits each. */
void bis_lanes_points(float *u1, float *u2, uint32_t n, uint64_t key);

#endif
