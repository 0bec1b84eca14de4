/* SPDX-License-Identifier: BSD-2-Clause */
/* sine: Taylor's series by Horner's rule, in sums of two doubles (about 106 bits: Dekker 1971, "A floating-point
 * technique for extending the available precision"). Only +, -, *, / of IEEE 754 are used, which round the same
 * everywhere.
 *
 *     sin x = x S(x^2), S = 1 - s/(2 3) (1 - s/(4 5) (1 - ...))
 *     cos x = C(x^2),   C = 1 - s/(1 2) (1 - s/(3 4) (1 - ...))
 *
 * The first term left out is below (pi/2)^28/28! = 1e-24 of 1. What is left to chance is a sine within 1e-24 of the
 * middle of two doubles. cos loses digits to the subtraction from 1 near pi/2, 16 at most of 32. */
#include "sine.h"

#include <assert.h>

enum { LAST = 26 };

typedef struct two {
    double hi, lo; /* their sum counts */
} two;

/* a + b, exactly. */
static two sum(double a, double b)
{
    const double s = a + b, of_b = s - a;
    return (two){s, (a - (s - of_b)) + (b - of_b)};
}

/* The upper half of the digits of a: 134217729 = 2^27 + 1. */
static double upper(double a)
{
    const double c = 134217729 * a;
    return c - (c - a);
}

/* a b, exactly. */
static two product(double a, double b)
{
    const double p = a * b, a1 = upper(a), b1 = upper(b), a0 = a - a1, b0 = b - b1;
    return (two){p, ((a1 * b1 - p) + a1 * b0 + a0 * b1) + a0 * b0};
}

static two times(two a, two b)
{
    const two p = product(a.hi, b.hi);
    return sum(p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
}

/* 1 - s/(first (first + 1)) (1 - s/((first + 2) (first + 3)) (1 - ...)), s = x x */
static two series(double x, int first)
{
    const two s = product(x, x);
    two t = {1, 0};

    for (int k = LAST + first; k >= first; k -= 2) {
        const double d = k * (k + 1);
        const two p = times(s, t), back = product(p.hi / d, d);
        const two rest = sum(1, -p.hi / d);
        t = sum(rest.hi, rest.lo - ((p.hi - back.hi) - back.lo + p.lo) / d);
    }
    return t;
}

double bis_sine(double x)
{
    assert(x >= 0 && x < 1.6);
    const two y = times((two){x, 0}, series(x, 2));
    return y.hi + y.lo;
}

double bis_cosine(double x)
{
    assert(x >= 0 && x < 1.6);
    const two y = series(x, 1);
    return y.hi + y.lo;
}
