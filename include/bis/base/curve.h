/* SPDX-License-Identifier: BSD-2-Clause */
/* curve: space-filling curves. With them, one number in [0,1) can be stratified where two dimensions matter.
 *
 * Neighbours on the curve are neighbours in the plane. N equal intervals of the curve are therefore N compact cells
 * of equal area, for every N, even a prime. This is why stratified candidates and systematic resampling reduce the
 * noise (thesis 4.4). */
#pragma once

#include <stdint.h>

/* bis_stratum returns the position (i + xi) / n: the place xi in the i-th of n equal strata of [0,1). xi is in [0,1).
 * The last number of the last stratum may round to 1; the largest double below 1 is then returned. */
static inline double bis_stratum(uint32_t i, double xi, uint32_t n)
{
    double t = ((double)i + xi) / (double)n;

    return t < 1 ? t : 1 - 0x1p-53;
}

/* bis_curve_hilbert maps t in [0,1) to (u[0], u[1]) in [0,1)^2 by Hilbert's curve of 26 levels. It preserves the
 * measure. The bits of t below 2^-52 are lost, and no jitter is added inside a cell of the last level, which is 2^-26
 * wide. */
void bis_curve_hilbert(double t, double u[2]);

/* bis_curve_rectangle fills order[width * height] with a curve of the same kind that visits each cell of a width x
 * height rectangle once. order[i] = y * width + x of the i-th cell. A step goes to one of the 4 neighbours; one step
 * is diagonal where an odd size makes this necessary. width, height < 2^31, and width * height < 2^32. Cost: O(width
 * * height). */
void bis_curve_rectangle(uint32_t *order, uint32_t width, uint32_t height);
