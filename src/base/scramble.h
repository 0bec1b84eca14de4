/* SPDX-License-Identifier: BSD-2-Clause */
/* scramble: digits of whole numbers, reversed, permuted and counted. src/thesis/sampler.c makes its point sets of them.
 *
 * Owen scrambling (Owen 1995) permutes each digit at random, in a way that depends on all digits above it. The nets
 * stay nets, each point becomes uniform, and two sequences with different keys become independent. For base 2 the
 * permutations come from a hash in which only lower bits change a bit, applied to the reversed number (Laine and
 * Karras 2011, with the constants of Vegdahl 2021). For base 3 the permutation is digit by digit. */
#pragma once

#include "bis/base/hash.h"

#include <float.h>
#include <stdbool.h>

/* ---- orders ---- */

/* number_of returns the k-th number of a sequence without repeats (k < 2^64), of its own for each key. */
static inline uint64_t number_of(uint64_t key, uint64_t k) { return bis_hash(key + k * 0x9e3779b97f4a7c15u); }

/* how_many returns how many of 0, ..., n - 1 leave the rest `rest` when they are divided by `step`. */
static inline uint64_t how_many(uint64_t n, uint64_t rest, uint64_t step)
{
    return rest < n ? (n - 1 - rest) / step + 1 : 0;
}

/* place_of returns the place of the i-th of n in an order in which successive numbers lie far apart: the n numbers are
 * sorted by their digits in base 2, the lowest first, each flipped at random by the digits below it. This is van der
 * Corput's sequence with Owen's scrambling, whose values are replaced by their ranks, because n need not be a power of
 * two. If it is one, each aligned block of 2^k numbers has one place in each 2^k-th of the whole. So the two halves of
 * the n interleave, and the difference between their means tells what is left of the error (src/render/film_error.c).
 * If it is none, not all ranks are equally likely, and they are turned by a random number. */
static inline uint64_t place_of(uint64_t i, uint64_t n, uint64_t key)
{
    const bool is_power = (n & (n - 1)) == 0;
    uint64_t place = is_power ? 0 : number_of(key, 0) % n;

    for (uint64_t bit = 1; bit < n; bit *= 2) {
        const uint64_t below = i & (bit - 1), digit = i & bit, flip = number_of(key, bit | below) & 1;
        if ((digit != 0) != flip) place += how_many(n, below | (digit ^ bit), 2 * bit);
    }
    return place % n;
}

/* cell_at stores the cell at a place of a curve through width x height cells. The curve halves the longer side and
 * passes first one half, then the other: neighbours on it are neighbours in the plane or nearly so. */
static inline void cell_at(uint64_t place, uint64_t width, uint64_t height, uint64_t cell[2])
{
    uint64_t side[2] = {width, height};

    cell[0] = cell[1] = 0;
    while (side[0] * side[1] > 1) {
        const int k = side[0] < side[1];
        const uint64_t half = side[k] / 2, first = half * side[!k];
        if (place < first) {
            side[k] = half;
        } else {
            place -= first;
            cell[k] += half;
            side[k] -= half;
        }
    }
}

/* ---- base 2 ---- */

/* reversed returns the 32 bits of x in reversed order. */
static inline uint32_t reversed(uint32_t x)
{
    x = (x & 0x55555555u) << 1 | (x >> 1 & 0x55555555u);
    x = (x & 0x33333333u) << 2 | (x >> 2 & 0x33333333u);
    x = (x & 0x0f0f0f0fu) << 4 | (x >> 4 & 0x0f0f0f0fu);
    x = (x & 0x00ff00ffu) << 8 | (x >> 8 & 0x00ff00ffu);
    return x << 16 | x >> 16;
}

/* scrambled applies Owen's scrambling to a number whose digits stand in reversed order. Each line is a bijection and
 * passes information only from lower bits to higher ones (a product with an even number is shifted by at least one
 * bit). */
static inline uint32_t scrambled(uint32_t x, uint32_t key)
{
    x ^= x * 0x3d20adeau;
    x += key;
    x *= key >> 16 | 1;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

/* mirrored applies Owen's scrambling to a number whose digits stand in reversed order, but mirrors it by its first two
 * digits: each of them that is 1 flips all digits after it. Two numbers that differ in the first digit alone become x
 * and 1 - x, and two that differ in the second alone mirror each other within their half. Digits before a digit decide
 * what becomes of it, so this is a scrambling too, and nets stay nets. Two digits are mirrored, because 16 samples had
 * more squared error with more. */
static inline uint32_t mirrored(uint32_t x, uint32_t key)
{
    const uint32_t first = (x ^ (uint32_t)bis_hash(key)) & 3; /* two digits, flipped at random */
    uint32_t after = scrambled(x >> 2, key);

    after = (first & 2 ? ~after : after) << 1 | first >> 1;
    return (first & 1 ? ~after : after) << 1 | (first & 1);
}

/* sobol2 returns the second dimension of Sobol's sequence, in reversed order like the first one, which is the index
 * itself. Its matrix is Pascal's triangle modulo 2: bit j of the result is the sum of all bits k of x with k a superset
 * of j as sets of binary digits (Lucas). The sum is therefore made digit by digit. */
static inline uint32_t sobol2(uint32_t x)
{
    x ^= x >> 1 & 0x55555555u;
    x ^= x >> 2 & 0x33333333u;
    x ^= x >> 4 & 0x0f0f0f0fu;
    x ^= x >> 8 & 0x00ff00ffu;
    return x ^ x >> 16;
}

/* with_random_tail returns 32 digits with 21 random ones after them, as a number in [0,1). */
static inline double with_random_tail(uint32_t x, uint64_t random)
{
    return (double)((uint64_t)x << 21 | (random & 0x1fffff)) * 0x1p-53;
}

/* ---- base 3 ---- */

/* scrambled_base3 returns index with its digits reversed in base 3 and permuted. Each digit gets one of the six
 * permutations d -> a + b d (mod 3), b = 1 or 2; the digits above choose which. `rest` follows after `depth` digits. */
static inline double scrambled_base3(uint32_t index, int depth, uint64_t key, double rest)
{
    uint64_t above = 1, value = 0, cells = 1; /* above: 1, then the digits, so that no two prefixes are the same */
    for (int d = 0; d < depth; d++) {
        uint64_t choice = (bis_hash(key + above * 0x9e3779b97f4a7c15u) >> 32) * 6 >> 32;
        uint32_t digit = index % 3;
        index /= 3;
        value = 3 * value + (choice + (choice < 3 ? digit : 2 * digit)) % 3;
        above = 3 * above + digit;
        cells *= 3;
    }
    double u = ((double)value + rest) / (double)cells;
    return u < 1 ? u : 1 - DBL_EPSILON / 2; /* the sum rounds up to the next integer if rest is nearly 1 */
}

/* base3_digits returns how many base-3 digits number `count` points. */
static inline int base3_digits(uint64_t count)
{
    int digits = 0;
    for (uint64_t power = 1; power < count && digits < 21; power *= 3)
        digits++; /* 3^21 > 2^32 */
    return digits;
}
