/* SPDX-License-Identifier: BSD-2-Clause */
/* rng: random numbers that are a function of (seed, pixel, sample, dimension) and of nothing else.
 *
 * A stream is a 64-bit key, mixed from (seed, pixel, sample, purpose). Its k-th number is a bijective mix of the key
 * and k. This is a counter-based generator (Salmon et al. 2011, "Parallel Random Numbers: As Easy as 1, 2, 3") with a
 * mixer in the style of SplitMix. Threads share no state, and nothing depends on their order. Any sample of any pixel
 * can be drawn again. A render can therefore be resumed or split over machines, and one pixel of it can be examined. */
#pragma once

#include "bis/base/hash.h"

typedef struct bis_rng {
    uint64_t key, counter;
} bis_rng;

/* bis_rng_init starts a stream. pixel is y * width + x of the full image. purpose separates the streams of one
 * sample: 0 is for the light integrals, the others are named where they are used. */
void bis_rng_init(bis_rng *r, uint64_t seed, uint64_t pixel, uint64_t sample, uint64_t purpose);

/* bis_rng_u64 returns the next 64 random bits. The key is joined by xor. If it were added, all streams would be
 * windows of one sequence of 2^64 numbers, and among 2^30 streams of 2^10 numbers some hundred pairs would overlap. */
static inline uint64_t bis_rng_u64(bis_rng *r)
{
    return bis_hash(r->key ^ (0x9e3779b97f4a7c15u * r->counter++));
}

/* bis_rng_double returns a number that is uniform in [0,1), a multiple of 2^-53. It is never 1, and it is 0 once in
 * 2^53. It has 53 bits, because a 32-bit number cannot reach the pixels of a contrasty map whose probability lies
 * below 2^-32 (docs/errata.md E14). */
static inline double bis_rng_double(bis_rng *r) { return (double)(bis_rng_u64(r) >> 11) * 0x1p-53; }

/* bis_rng_below returns a number that is exactly uniform in {0, ..., n - 1}: it rejects numbers in the last partial
 * block. n must be > 0. */
uint64_t bis_rng_below(bis_rng *r, uint64_t n);
