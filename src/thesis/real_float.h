/* SPDX-License-Identifier: BSD-2-Clause */
/* real_float: what real_double.h has, for loops over many directions that the compiler turns into vectors, by the
 * polynomials of bis/thesis/lanes.h.
 *
 * gcc gives up such a loop without a word (scripts/check/check_vectors.sh speaks). So a formula has no branch on a real
 * (write choose), no local array, no result through a pointer (return a struct), and calls nothing but these and other
 * FORMULAs. A condition that is known when the loop is compiled may be an `if`. */
#pragma once

#include "bis/base/vec.h"
#include "bis/thesis/lanes.h"

#include <stdbool.h>

typedef float real;

#define FORMULA static inline BIS_INLINE

/* The largest number below 1. */
static const real below_1 = 0x1.fffffep-1f;

/* choose and the others return, or store, what real_double.h says. */
FORMULA real choose(int yes, real a, real b) { return bis_lanes_choose(yes, a, b); }
FORMULA real log1m(real x) { return bis_lanes_log1m(x); }
FORMULA real exp_of(real y) { return bis_lanes_exp(y); } /* stops at 2^-64 */
FORMULA real one_minus_exp(real y) { return bis_lanes_1mexp(y); }
FORMULA real root(real x) { return sqrtf(x); }
FORMULA real absolute(real x) { return fabsf(x); }
FORMULA void sincos2pi(real u, real *s, real *c) { bis_lanes_sincos2pi(u, s, c); }
