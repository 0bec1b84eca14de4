/* SPDX-License-Identifier: BSD-2-Clause */
/* stats: the incomplete gamma function, of which the chi-square tail is a special case.
 *
 * Both of its classical expansions share the factor x^a e^-x / Gamma(a), and each converges where the other does not:
 *   below the mode, x < a + 1, the series    P = x^a e^-x / Gamma(a) * sum over k of x^k / (a (a+1) ... (a+k)),  Q =
 *   1 - P; above it, the continued fraction         Q = x^a e^-x / Gamma(a) * 1/(x+1-a - 1(1-a)/(x+3-a -
 *   2(2-a)/(x+5-a - ...))).
 * Near x = a either takes some 10 sqrt(a) terms, elsewhere a dozen. Source: Abramowitz and Stegun 6.5.29 and 6.5.31
 * (the latter's even part), summed by the modified Lentz method (Thompson and Barnett 1986). */
#include "bis/base/stats.h"

#include <assert.h>
#include <float.h>
#include <math.h>

/* x^a e^-x / Gamma(a). From logarithms the error would be a log(x) ulps: 1e-9 at a = 1e6. For large a the large terms
 * are cancelled by hand, through Stirling's series: with x = a (1 + mu), it is
 *   sqrt(a / 2 pi) exp(-a (mu - log(1 + mu)) - 1/(12 a) + 1/(360 a^3) - ...), next term 1/(1188 a^9) < 2e-15 for a >=
 *   20. */
static double common_factor(double a, double x)
{
    if (a < 20) {
        int sign;
        return exp(a * log(x) - x - lgamma_r(a, &sign));
    }
    double mu = (x - a) / a, r = 1 / (a * a);
    double stirling = (1.0 / 12 - r * (1.0 / 360 - r * (1.0 / 1260 - r / 1680))) / a;
    return sqrt(a / (2 * 3.14159265358979323846)) * exp(-a * (mu - log1p(mu)) - stirling);
}

/* P(a, x) / common_factor, x < a + 1: all terms are positive and fall from the start. */
static double series(double a, double x)
{
    double term = 1 / a, sum = term;
    for (double k = 1; term > sum * DBL_EPSILON; k++) {
        term *= x / (a + k);
        sum += term;
    }
    return sum;
}

/* Q(a, x) / common_factor, x >= a + 1. c and d are the ratios of successive numerators and denominators. Neither
 * vanishes here: all partial denominators are positive and, seen from the back, exceed what is subtracted. */
static double continued_fraction(double a, double x)
{
    double b = x + 1 - a, c = HUGE_VAL, d = 1 / b, product = d, step = 0;
    for (double k = 1; fabs(step - 1) > DBL_EPSILON; k++) {
        double numerator = -k * (k - a);
        b += 2;
        d = 1 / (b + numerator * d);
        c = b + numerator / c;
        step = c * d;
        product *= step;
    }
    return product;
}

double bis_stats_gamma_q(double a, double x)
{
    assert(a > 0 && x >= 0);
    if (x == 0) return 1;
    if (isinf(x)) return 0;
    double factor = common_factor(a, x);
    if (x < a + 1) return 1 - factor * series(a, x);
    return factor == 0 ? 0 : factor * continued_fraction(a, x);
}

double bis_stats_chi_square_p(double statistic, double dof) { return bis_stats_gamma_q(dof / 2, statistic / 2); }

double bis_stats_normal_p(double z) { return erfc(fabs(z) * 0.70710678118654752440); }

/* The continued fraction of I_x(a, b), Abramowitz and Stegun 26.5.8, for x < (a+1)/(a+b+2), where it converges in
 * O(sqrt(max(a, b))) steps; modified Lentz as above, two partial numerators a step. No denominator vanishes in that
 * range of x. */
static double beta_fraction(double a, double b, double x)
{
    double c = 1, d = 1 / (1 - (a + b) * x / (a + 1)), product = d, step = 0;
    for (double m = 1; fabs(step - 1) > DBL_EPSILON; m++) {
        double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
        double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
        d = 1 / (1 + even * d);
        c = 1 + even / c;
        product *= c * d;
        d = 1 / (1 + odd * d);
        c = 1 + odd / c;
        step = c * d;
        product *= step;
    }
    return product;
}

/* I_x(a, b), the regularised incomplete beta function, with y = 1 - x given apart so that neither end cancels. */
static double beta_regularised(double a, double b, double x, double y)
{
    int sign;
    if (x <= 0) return 0;
    if (y <= 0) return 1;
    double factor = exp(lgamma_r(a + b, &sign) - lgamma_r(a, &sign) - lgamma_r(b, &sign) + a * log(x) + b * log(y));
    if (x < (a + 1) / (a + b + 2)) return factor * beta_fraction(a, b, x) / a;
    return 1 - factor * beta_fraction(b, a, y) / b;
}

double bis_stats_student_p(double t, double dof)
{
    assert(dof > 0);
    if (isinf(t)) return 0;
    return beta_regularised(dof / 2, 0.5, dof / (dof + t * t), t * t / (dof + t * t));
}

double bis_stats_sidak(double alpha, double m) { return -expm1(log1p(-alpha) / m); }
