/* rng: random numbers that are a function of (seed, pixel, sample, dimension) and of nothing else.
 *
 * A stream is a 64-bit key, mixed from (seed, pixel, sample, purpose); its k-th number is a bijective mix of key and k,
 * a counter-based generator (Salmon et al. 2011, "Parallel Random Numbers: As Easy as 1, 2, 3", with a SplitMix-style
 * mixer). No state is shared, nothing depends on the order of threads, and any sample of any pixel can be drawn again:
 * a render can be resumed, split over machines, or one pixel of it looked at. */
#ifndef BIS_RNG_H
#define BIS_RNG_H

#include <stdint.h>

typedef struct bis_rng {
    uint64_t key, counter;
} bis_rng;

/* 64 bits in, 64 well-mixed bits out; a bijection. */
static inline uint64_t bis_hash(uint64_t x)
{
    x ^= x >> 30;
    x *= 0xbf58476d1ce4e5b9u;
    x ^= x >> 27;
    x *= 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

/* Start a stream. pixel is y * width + x of the full image; purpose separates streams of one sample (0: the light
 * integrals; others are named where they are used). */
void bis_rng_init(bis_rng *r, uint64_t seed, uint64_t pixel, uint64_t sample, uint64_t purpose);

/* The key is joined by xor: by addition, all streams would be windows of one sequence of 2^64, and among 2^30 streams
 * of 2^10 numbers some hundred pairs would overlap. */
static inline uint64_t bis_rng_u64(bis_rng *r)
{
    return bis_hash(r->key ^ (0x9e3779b97f4a7c15u * r->counter++));
}

/* Uniform in [0, 1), a multiple of 2^-53: never 1, 0 once in 2^53. 53 bits because a 32-bit number cannot reach the
 * pixels of a contrasty map whose probability lies below 2^-32 (docs/errata.md E14). */
static inline double bis_rng_double(bis_rng *r) { return (double)(bis_rng_u64(r) >> 11) * 0x1p-53; }

/* Uniform in {0, ..., n - 1}, exactly (rejection of the last partial block). n > 0. */
uint64_t bis_rng_below(bis_rng *r, uint64_t n);

#endif
