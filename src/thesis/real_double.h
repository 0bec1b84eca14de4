/* SPDX-License-Identifier: BSD-2-Clause */
/* real_double: a formula is written once, for `real` numbers. Here real is double: for one direction at a time, which
 * in the tests is the reference of real_float.h. There it is float: for loops over many directions. A file includes one
 * of the two, then formulas: src/thesis/phong.c this one, phong_many.c the other. */
#pragma once

#include "bis/base/clones.h"
#include "bis/base/vec.h"

#include <math.h>
#include <stdbool.h>

typedef double real;

/* A function that is copied into the loop which calls it. */
#define FORMULA static inline BIS_INLINE

/* The largest number below 1. */
static const real below_1 = 1 - 0x1p-53;

/* choose returns yes ? a : b. */
FORMULA real choose(int yes, real a, real b) { return yes ? a : b; }

/* log1m returns log(1 - x), 0 <= x < 1. */
FORMULA real log1m(real x) { return log1p(-x); }

/* exp_of returns e^y, y <= 0. Below e^-708 it would be a denormal, which is slow: 0. */
FORMULA real exp_of(real y) { return y < -708 ? 0 : exp(y); }

/* one_minus_exp returns 1 - e^y, y <= 0, without cancellation. */
FORMULA real one_minus_exp(real y) { return -expm1(y); }

/* root and absolute return the square root of x and |x|. */
FORMULA real root(real x) { return sqrt(x); }
FORMULA real absolute(real x) { return fabs(x); }

/* sincos2pi stores sin and cos of 2 pi u, 0 <= u < 1. */
FORMULA void sincos2pi(real u, real *s, real *c)
{
    *s = sin(2 * PI * u);
    *c = cos(2 * PI * u);
}
