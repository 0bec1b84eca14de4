/* SPDX-License-Identifier: BSD-2-Clause */
/* rng: keys from coordinates.
 *
 * Each coordinate is added to the hash of the ones before it, and the sum is hashed again. bis_hash is a bijection.
 * Two streams that differ in only one coordinate therefore certainly have different keys; any two others coincide
 * with probability 2^-64. */
#include "bis/thesis/rng.h"

#include <assert.h>

void bis_rng_init(bis_rng *r, uint64_t seed, uint64_t pixel, uint64_t sample, uint64_t purpose)
{
    /* because (0, 0, 0, 0) must not give the hash's fixed point 0 */
    uint64_t key = bis_hash(seed + 0x9e3779b97f4a7c15u);
    key = bis_hash(key + pixel);
    key = bis_hash(key + sample);
    *r = (bis_rng){bis_hash(key + purpose), 0};
}

uint64_t bis_rng_below(bis_rng *r, uint64_t n)
{
    assert(n > 0);
    uint64_t partial = (0 - n) % n; /* 2^64 mod n */
    uint64_t x;
    do
        x = bis_rng_u64(r);
    while (x > UINT64_MAX - partial);
    return x % n;
}
