/* curve: space-filling curves, so that one number in [0,1) can be stratified where two dimensions matter.
 *
 * Neighbours on the curve are neighbours in the plane: N equal intervals of it are N compact cells of equal area, for
 * any N, also a prime. This is what makes stratified candidates and systematic resampling pay (chapter 4 of docs/). */
#ifndef BIS_CURVE_H
#define BIS_CURVE_H

#include <stdint.h>

/* Position i + xi of n equal strata of [0,1), xi in [0,1). The last number of the last stratum may round to 1: it is
 * moved back to the largest below. */
static inline double bis_stratum(uint32_t i, double xi, uint32_t n)
{
    double t = ((double)i + xi) / (double)n;

    return t < 1 ? t : 1 - 0x1p-53;
}

/* Hilbert's curve, 26 levels: t in [0,1) to (u[0], u[1]) in [0,1)^2, measure preserving; the bits of t below 2^-52 are
 * lost, jitter inside the last level's cell (2^-26 wide) is not added. */
void bis_curve_hilbert(double t, double u[2]);

/* A curve of the same kind through the cells of any width x height rectangle, each visited once, steps of 1 to a
 * 4-neighbour (one diagonal step where an odd size forces it). order[i] = y * width + x of the i-th cell;
 * width, height < 2^31, width * height < 2^32. Cost: O(width * height). */
void bis_curve_rectangle(uint32_t *order, uint32_t width, uint32_t height);

#endif
