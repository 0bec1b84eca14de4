/* SPDX-License-Identifier: BSD-2-Clause */
/* coat: closed forms for a smooth one, and quadrature over all facets, seen or not, that shares no code with it. */
#include "bis/beyond/coat.h"
#include "claim.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

static void assert_about(double a, double b, double tolerance)
{
    if (!(fabs(a - b) <= tolerance)) fail_msg("%.6g is not %.6g within %g", a, b, tolerance);
}

/* The mean of light from all directions that glass of 1.5 reflects is 0.0918 outside and 0.5963 inside (Judd 1942).
 * What passes is the same from both sides (reciprocity): in/eta^2 = 1 - back. Without an interface a layer leaves 2
 * E3(t). */
static void a_smooth_coat_is_that_of_closed_forms(void **state)
{
    static const double eta[] = {1.1, 1.33, 1.5, 2.5, 10};
    double in, back;

    bis_coat_shares(&in, &back, 1e-4, 1.5, 0);
    assert_about(in, 1 - 0.0918, 1e-4);
    assert_about(back, 0.5963, 1e-4);
    for (int i = 0; i < 5; i++) {
        bis_coat_shares(&in, &back, 1e-4, eta[i], 0);
        assert_about(in / (eta[i] * eta[i]), 1 - back, 2e-4);
    }
    bis_coat_shares(&in, &back, 1e-4, 1, 0.01);
    assert_about(in, 0.980556, 1e-4);
    assert_about(back, 0, 1e-12);
    bis_coat_shares(&in, &back, 1e-4, 1, 0.5);
    assert_about(in, 0.443208, 1e-3);
}

/* Unpolarised light on an interface, by sines and cosines; beyond the critical angle all. */
static double reflected(double eta, double c)
{
    const double s = sqrt(1 - c * c) / eta, t = sqrt(fmax(0, 1 - s * s));
    const double across = (c - eta * t) / (c + eta * t), along = (eta * c - t) / (eta * c + t);

    return s >= 1 ? 1 : (across * across + along * along) / 2;
}

static double g2(double a, double c, double d)
{
    const double x = sqrt(1 + a * a * (1 / (c * c) - 1)), y = sqrt(1 + a * a * (1 / (d * d) - 1));

    return 2 / (x + y);
}

/* Midpoints of the cosine squared, and of a facet's u = tan^2 theta/(a^2 + tan^2 theta) and azimuth, in which the
 * facets of a surface are uniform; u = 1 - v^2, because their area grows without bound at u = 1. */
static void by_quadrature(double *in, double *back, double a, double eta, double thickness)
{
    enum { N = 96, M = 64 };

    *in = *back = 0;
    for (int i = 0; i < N * N * M; i++) {
        const double c = sqrt((i % N + 0.5) / N), v = (i / N % N + 0.5) / N, phi = pi * (i / N / N + 0.5) / M;
        const double tangent = a * sqrt(1 - v * v) / v, h = 1 / sqrt(1 + tangent * tangent);
        const double met = h * (c + sqrt(1 - c * c) * tangent * cos(phi)), seen = 2 * v * met / (c * h * N * N * M);
        if (met <= 0) continue;
        const double t = sqrt(1 - (1 - met * met) / (eta * eta)), down = c / eta + h * (t - met / eta);
        const double up = 2 * met * h - c;
        if (down > 0) *in += seen * (1 - reflected(eta, met)) * g2(a, c, down) * exp(-thickness / down);
        if (up > 0) *back += seen * reflected(1 / eta, met) * g2(a, c, up) * exp(-thickness * (1 / c + 1 / up));
    }
}

static void a_rough_coat_is_that_of_quadrature(void **state)
{
    static const double cases[][3] = {{0.05, 1.5, 0},   {0.2, 1.5, 0.01}, {0.5, 1.5, 0.02}, {0.8, 1.33, 0},
                                      {0.3, 2.5, 0.25}, {1, 1.2, 0.1},    {0.6, 4, 0}};

    for (int i = 0; i < 7; i++) {
        double in, back, a, b;
        bis_coat_shares(&in, &back, cases[i][0], cases[i][1], cases[i][2]);
        by_quadrature(&a, &b, cases[i][0], cases[i][1], cases[i][2]);
        assert_about(in, a, 0.002);
        assert_about(back, b, 0.002);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_smooth_coat_is_that_of_closed_forms),
        cmocka_unit_test(a_rough_coat_is_that_of_quadrature),
    };

    return cmocka_run_group_tests_name("coat", tests, NULL, NULL);
}
