/* real: one text of a formula, twice compiled: with REAL float for loops over a set, which become vectors, and with
 * REAL double for a single direction and for the tests, which hold the first against the second. A file that contains
 * formulas says
 *
 *     #define REAL float
 *     #include "phong_formulas.h"
 *     #undef REAL
 *     #define REAL double
 *     #include "phong_formulas.h"
 *
 * and gets phong_f_float and phong_f_double of OF(phong_f). In such a text there is no branch (real_choose), and no
 * function but these. Float: polynomials of bis/thesis/lanes.h; double: the C library's. */
#pragma once

#include "bis/thesis/lanes.h"

#define REAL_PASTE2(a, b) a##_##b
#define REAL_PASTE(a, b) REAL_PASTE2(a, b)
#define OF(name) REAL_PASTE(name, REAL)
#define FORMULA static inline BIS_INLINE

FORMULA float choose_float(int yes, float a, float b) { return bis_lanes_choose(yes, a, b); }
FORMULA double choose_double(int yes, double a, double b) { return yes ? a : b; }

/* log(1 - x), 0 <= x < 1. */
FORMULA float log1m_float(float x) { return bis_lanes_log1m(x); }
FORMULA double log1m_double(double x) { return log1p(-x); }

/* e^y, y <= 0. Below -708 a double would be a denormal, which is slow: 0. */
FORMULA float exp_float(float y) { return bis_lanes_exp(y); }
FORMULA double exp_double(double y) { return y < -708 ? 0 : exp(y); }

/* 1 - e^y, y <= 0. */
FORMULA float one_minus_exp_float(float y) { return bis_lanes_1mexp(y); }
FORMULA double one_minus_exp_double(double y) { return -expm1(y); }

FORMULA float sqrt_float(float x) { return sqrtf(x); }
FORMULA double sqrt_double(double x) { return sqrt(x); }

FORMULA void sincos2pi_float(float u, float *s, float *c) { bis_lanes_sincos2pi(u, s, c); }
FORMULA void sincos2pi_double(double u, double *s, double *c)
{
    *s = sin(2 * 3.14159265358979323846 * u);
    *c = cos(2 * 3.14159265358979323846 * u);
}

/* the largest number below 1 */
#define BELOW_1_float 0x1.fffffep-1f
#define BELOW_1_double (1 - 0x1p-53)
