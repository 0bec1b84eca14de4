/* SPDX-License-Identifier: BSD-2-Clause */
/* hash: mixing the bits of a number, for random numbers that are a function of their coordinates. */
#pragma once

#include <stdint.h>

/* bis_hash mixes 64 bits into 64 bits. It is a bijection. */
static inline uint64_t bis_hash(uint64_t x)
{
    x ^= x >> 30;
    x *= 0xbf58476d1ce4e5b9u;
    x ^= x >> 27;
    x *= 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}
