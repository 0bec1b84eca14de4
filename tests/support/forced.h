/* SPDX-License-Identifier: BSD-2-Clause */
/* forced: random numbers that a test chooses. */
#ifndef TESTS_FORCED_H
#define TESTS_FORCED_H

#include "bis/thesis/rng.h"

/* unhash returns x with bis_hash(x) = h: its steps backwards. */
static inline uint64_t unhash(uint64_t h)
{
    h ^= h >> 31 ^ h >> 62;
    h *= 0x319642b2d24d8ec3u; /* the inverses of bis_hash's factors modulo 2^64 */
    h ^= h >> 27 ^ h >> 54;
    h *= 0x96de1b173f119089u;
    return h ^ h >> 30 ^ h >> 60;
}

/* forced returns a stream whose number k is u: a multiple of 2^-53 in [0,1). Numbers count from 0. */
static inline bis_rng forced(double u, uint64_t k)
{
    return (bis_rng){unhash((uint64_t)(u * 0x1p53) << 11) ^ (0x9e3779b97f4a7c15u * k), 0};
}

#endif
