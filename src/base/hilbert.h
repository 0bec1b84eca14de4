/* SPDX-License-Identifier: BSD-2-Clause */
/* hilbert: Hilbert's curve without a loop over its levels, for doubles (curve.c) and for vectors (curve_many.c).
 *
 * Hilbert's curve (1891) as a machine: the base-4 digits of t, from the top, select the next quadrant. Digit d = 2 a
 * + b (bits a, b) visits (x, y) = (a, a xor b): up, right, down. Within quadrant 0 the curve is mirrored at the
 * diagonal (x and y are swapped); within quadrant 3 it is mirrored at the other diagonal (swapped and both
 * complemented). Swap and complement commute. The state at a level is therefore only the parity of the swaps (d = 0
 * or 3) and the parity of the complements (d = 3) of the digits above. These are two prefix parities, and log2(32)
 * word operations compute them for all levels at once (Warren 2012, "Hacker's Delight", chapter 16). */
#pragma once

#include <stdint.h>

/* even_bits returns every second bit of x (bits 0, 2, 4, ...), side by side. */
static inline uint32_t even_bits(uint32_t x)
{
    x &= 0x55555555u;
    x = (x | x >> 1) & 0x33333333u;
    x = (x | x >> 2) & 0x0f0f0f0fu;
    x = (x | x >> 4) & 0x00ff00ffu;
    return (x | x >> 8) & 0x0000ffffu;
}

/* parity_above returns a number whose bit k is the parity of the bits of x above k. */
static inline uint32_t parity_above(uint32_t x)
{
    x >>= 1;
    x ^= x >> 1;
    x ^= x >> 2;
    x ^= x >> 4;
    x ^= x >> 8;
    return x ^ x >> 16;
}

/* hilbert_x returns the column of the cell whose digits have the upper bits a and the lower bits b, on a curve of so
 * many levels as `levels` has bits, all of which are 1. */
static inline uint32_t hilbert_x(uint32_t a, uint32_t b, uint32_t levels)
{
    const uint32_t swap = parity_above(~(a ^ b) & levels), complement = parity_above(a & b);

    return a ^ (swap & b) ^ complement; /* swap ? a ^ b : a */
}

/* hilbert_y returns the row, of the column x and b: a and a ^ b differ by b, so it is the other of the two. */
static inline uint32_t hilbert_y(uint32_t x, uint32_t b) { return x ^ b; }
