/* SPDX-License-Identifier: BSD-2-Clause */
/* curve_many: stratified points of the unit square for a set of candidates. */
#pragma once

#include <stdint.h>

/* bis_curve_points stores n stratified points, one in each n-th part of Hilbert's curve over the unit square, in the
 * order of the curve, as a function of key. It writes u1[n] and u2[n] to the end of their last blocks. The numbers
 * have 24 bits. */
void bis_curve_points(float *u1, float *u2, uint32_t n, uint64_t key);
