/* SPDX-License-Identifier: BSD-2-Clause */
/* real: one text of a formula, compiled twice: with REAL float for loops over many directions, which become vectors,
 * and with REAL double for a single direction, which in the tests is the reference of the loops. A text says
 *
 *     FORMULA REAL OF(half)(REAL x) { return x / 2; }
 *
 * which becomes half_float where it is included after `#define REAL float`, and half_double after `#define REAL
 * double`. thesis/model.h does so for the text of a material.
 *
 * Rules for such a text, because gcc gives up a vector loop without a word (scripts/check/check_vectors.sh speaks): no
 * branch on a REAL (write OF(choose)), no local array, no result through a pointer (return a struct), no function but
 * these and other FORMULAs. A condition that is known when the loop is compiled may be an `if`. Float: the polynomials
 * of bis/thesis/lanes.h; double: the C library. */
#pragma once

#include "bis/thesis/lanes.h"

#define REAL_PASTE2(a, b) a##_##b
#define REAL_PASTE(a, b) REAL_PASTE2(a, b)
#define OF(name) REAL_PASTE(name, REAL)
#define FORMULA static inline BIS_INLINE

/* choose returns yes ? a : b. */
FORMULA float choose_float(int yes, float a, float b) { return bis_lanes_choose(yes, a, b); }
FORMULA double choose_double(int yes, double a, double b) { return yes ? a : b; }

/* log1m returns log(1 - x), 0 <= x < 1. */
FORMULA float log1m_float(float x) { return bis_lanes_log1m(x); }
FORMULA double log1m_double(double x) { return log1p(-x); }

/* exp returns e^y, y <= 0. Below e^-708 a double would be a denormal, which is slow: 0. A float stops at 2^-64. */
FORMULA float exp_float(float y) { return bis_lanes_exp(y); }
FORMULA double exp_double(double y) { return y < -708 ? 0 : exp(y); }

/* one_minus_exp returns 1 - e^y, y <= 0, without cancellation. */
FORMULA float one_minus_exp_float(float y) { return bis_lanes_1mexp(y); }
FORMULA double one_minus_exp_double(double y) { return -expm1(y); }

/* sqrt and fabs are those of C. */
FORMULA float sqrt_float(float x) { return sqrtf(x); }
FORMULA double sqrt_double(double x) { return sqrt(x); }
FORMULA float fabs_float(float x) { return fabsf(x); }
FORMULA double fabs_double(double x) { return fabs(x); }

/* sincos2pi stores sin and cos of 2 pi u, 0 <= u < 1. */
FORMULA void sincos2pi_float(float u, float *s, float *c) { bis_lanes_sincos2pi(u, s, c); }
FORMULA void sincos2pi_double(double u, double *s, double *c)
{
    *s = sin(2 * 3.14159265358979323846 * u);
    *c = cos(2 * 3.14159265358979323846 * u);
}

/* BELOW_1 is the largest number below 1. */
#define BELOW_1_float 0x1.fffffep-1f
#define BELOW_1_double (1 - 0x1p-53)
