/* SPDX-License-Identifier: BSD-2-Clause */
/* curve_many: stratified points for many directions at once. Hilbert's curve as in curve.c, 12 levels instead of 26;
 * below its last cells, 2^-12 wide, the place is random. Cost: 2 ns a point with AVX-512. */
#include "curve_many.h"

#include "base/hilbert.h"

#include "bis/thesis/lanes.h"
#include "bis/thesis/rng.h"

#include <stdbool.h>

/* 32 bits in, 32 well-mixed bits out (Wellons 2018, "lowbias32"). */
static inline uint32_t mixed(uint32_t x)
{
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    return x ^ x >> 16;
}

static inline float unit_float(uint32_t bits24) { return (float)(int32_t)bits24 * 0x1p-24f; }

/* many: i rest would not fit 31 bits. */
static inline BIS_INLINE void points_as(float *u1, float *u2, uint32_t n, uint32_t padded, uint64_t keys,
                                        const bool many)
{
    const uint32_t key1 = (uint32_t)keys, key2 = (uint32_t)(keys >> 32);
    const uint32_t cells = 1u << 24, last = cells - 1, whole = cells / n, rest = cells % n;
    const float inverse = 1 / (float)n, size = (float)cells * inverse;

#pragma omp simd
    for (uint32_t i = 0; i < padded; i++) {
        /* (i + u)/n, counted in cells: i whole + i rest/n + u size. In float, i + u would leave u so few bits that up
         * to half of the cells are never drawn. */
        const float before = many ? (float)((double)i * rest / n) : (float)(int32_t)(i * rest) * inverse;
        const float within = before + unit_float(mixed(i ^ key1) >> 8) * size;
        const uint32_t t24 = i * whole + (uint32_t)(int32_t)within, digits = t24 < last ? t24 : last;
        const uint32_t a = even_bits(digits >> 1), b = even_bits(digits);
        const uint32_t x = hilbert_x(a, b, 0xfffu), y = hilbert_y(x, b);
        const uint32_t place = mixed(i ^ key2);

        u1[i] = unit_float(x << 12 | place >> 20);
        u2[i] = unit_float(y << 12 | (place & 0xfffu));
    }
}

BIS_LANES
static void points(float *u1, float *u2, uint32_t n, uint32_t padded, uint64_t keys)
{
    if (n <= 1u << 15) points_as(u1, u2, n, padded, keys, false); /* (padded - 1) (n - 1) < 2^31 */
    else points_as(u1, u2, n, padded, keys, true);
}

void bis_curve_points(float *u1, float *u2, uint32_t n, uint64_t key)
{
    points(u1, u2, n, bis_lanes_round_up(n), bis_hash(key));
}
