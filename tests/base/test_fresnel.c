/* SPDX-License-Identifier: BSD-2-Clause */
/* fresnel: against Fresnel's equations in complex numbers, angles of the textbooks, and Walsh's closed mean. */
#include "bis/base/fresnel.h"

#include "bis/thesis/rng.h"
#include "claim.h"

#include <complex.h>
#include <math.h>
#include <stdbool.h>

static const double right_angle = 1.57079632679489661923;

static void assert_near(double a, double b, double tolerance)
{
    if (!(fabs(a - b) <= tolerance)) fail_msg("%.12g is not %.12g within %g", a, b, tolerance);
}

static double by_complex_numbers(double eta, double k2, double cos_theta)
{
    const long double c = (long double)cos_theta;
    const long double complex m = (long double)eta + sqrtl((long double)k2) * (long double complex)I,
                              q = csqrtl(m * m - (1 - c * c));
    const long double s = cabsl((c - q) / (c + q)), p = cabsl((m * m * c - q) / (m * m * c + q));

    return (double)((s * s + p * p) / 2);
}

/* Indices over eight decades, a third of them dielectric, at angles down to 1e-4 of a right one from grazing. */
static double random_surface(bis_rng *r, int i, double *k2)
{
    *k2 = i % 3 ? pow(10, 10 * bis_rng_double(r) - 6) : 0;
    return pow(10, 8 * bis_rng_double(r) - 4);
}

static void reflectances_are_those_of_complex_numbers(void **state)
{
    bis_rng r;

    bis_rng_init(&r, 5, 0, 0, 0);
    for (int i = 0; i < 20000; i++) {
        double k2;
        const double eta = random_surface(&r, i, &k2), c = cos(right_angle * (1 - pow(10, -4 * bis_rng_double(&r))));
        const double F = by_complex_numbers(eta, k2, c);
        assert_near(bis_fresnel(eta, k2, c), F, 1e-10 * F + 1e-13);
    }
}

static void angles_of_the_textbooks_have_their_reflectances(void **state)
{
    assert_near(bis_fresnel(1.5, 0, 1), 0.04, 1e-15); /* (0.5/2.5)^2 */
    assert_near(bis_fresnel(1, 4, 1), 0.5, 1e-15);    /* k = 2: 4/8 */
    assert_near(bis_fresnel(1.5, 0, 0), 1, 0);
    assert_near(bis_fresnel(0.2, 15, 0), 1, 0);
    /* Brewster: tan theta = eta, nothing of p, ((1 - eta^2)/(1 + eta^2))^2 of s */
    assert_near(bis_fresnel(1.5, 0, 1 / sqrt(1 + 2.25)), pow(1.25 / 3.25, 2) / 2, 1e-15);
    /* total reflection beyond asin 0.5 */
    assert_near(bis_fresnel(0.5, 0, cos(right_angle / 3 + 1e-9)), 1, 1e-15);
    assert_true(bis_fresnel(0.5, 0, cos(right_angle / 3 - 1e-3)) < 0.95);
    assert_near(bis_fresnel(1, 0, 0.5), 0, 0); /* no surface */
}

/* Its square is 0 in double: head on, both polarizations would be 0/0. */
static void an_index_of_next_to_nothing_reflects_all(void **state)
{
    assert_true(bis_fresnel(1e-300, 0, 1) == 1);
    assert_true(bis_fresnel(1e-300, 0, 0.5) == 1);
}

/* What the bounds of src/beyond/microfacet.c and the precision of its lanes rest on: from the normal to grazing F falls
 * and then rises, and is never below half of what it is at the normal. */
static void the_largest_reflectance_of_a_range_is_at_an_end_of_it(void **state)
{
    enum { N = 500 };
    bis_rng r;

    bis_rng_init(&r, 5, 1, 0, 0);
    for (int i = 0; i < 2000; i++) {
        double k2, last = 2, at_normal = 0;
        const double eta = random_surface(&r, i, &k2);
        bool rises = false;
        for (int j = 0; j < N; j++) {
            const double F = bis_fresnel(eta, k2, cos(right_angle * j / N));
            if (j == 0) at_normal = F;
            if (F > last * (1 + 1e-12) + 1e-15) rises = true;
            if (rises && F < last * (1 - 1e-12) - 1e-15) fail_msg("eta %g, k2 %g: falls again at %d", eta, k2, j);
            assert_true(F >= at_normal / 2);
            last = F;
        }
    }
}

/* Walsh's mean of a dielectric (Duntley 1942, eq. 5), 0.0918 for glass. */
static double walsh(double n)
{
    const double n2 = n * n, n4 = n2 * n2;

    return 0.5 + (n - 1) * (3 * n + 1) / (6 * (n + 1) * (n + 1)) +
           n2 * (n2 - 1) * (n2 - 1) / pow(n2 + 1, 3) * log((n - 1) / (n + 1)) -
           2 * n2 * n * (n2 + 2 * n - 1) / ((n2 + 1) * (n4 - 1)) +
           8 * n4 * (n4 + 1) / ((n2 + 1) * (n4 - 1) * (n4 - 1)) * log(n);
}

static void the_mean_is_walshs(void **state)
{
    static const double eta[] = {1.2, 1.33, 1.5, 2, 4};

    assert_near(walsh(1.5), 0.0918, 5e-5);
    for (int i = 0; i < 5; i++) assert_near(bis_fresnel_mean(eta[i], 0), walsh(eta[i]), 1e-4);
    assert_near(bis_fresnel_mean(1, 0), 0, 0);
}

/* Copper's red, gold's blue, silver's green, aluminium's red, water: back from both reflectances, and not from others.
 */
static void the_index_is_found_from_both_reflectances(void **state)
{
    static const double eta[] = {0.2, 1.442, 0.117, 1.66, 1.33}, k[] = {3.912, 1.603, 3.122, 9.22, 0};

    for (int i = 0; i < 5; i++) {
        const double k2 = k[i] * k[i], R = bis_fresnel(eta[i], k2, 1);
        assert_near(bis_fresnel_k2(R, eta[i]), k2, 1e-12 * k2 + 1e-15);
        assert_near(bis_fresnel_eta(R, bis_fresnel_mean(eta[i], k2)), eta[i], 1e-6);
        assert_true(fabs(bis_fresnel_eta(R, bis_fresnel_mean(eta[i], k2) * 1.01) - eta[i]) > 1e-3);
    }
    /* beyond the two dielectrics: those */
    assert_near(bis_fresnel_eta(0.04, 0), 1.5, 1e-12);
    assert_near(bis_fresnel_eta(0.04, 1), 1 / 1.5, 1e-12);
    assert_near(bis_fresnel_k2(0.04, 3), 0, 0);
    /* k = 30000: eta is looked for up to 10^12, and 48 halvings and the middle of what is left are as near as this */
    const double R = bis_fresnel(0.001, 9e8, 1), most = (1 + sqrt(R)) / (1 - sqrt(R));
    assert_true(most > 8e11);
    assert_near(bis_fresnel_eta(R, bis_fresnel_mean(0.001, 9e8)), 0.001, most * 0x1p-49);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reflectances_are_those_of_complex_numbers),
        cmocka_unit_test(angles_of_the_textbooks_have_their_reflectances),
        cmocka_unit_test(an_index_of_next_to_nothing_reflects_all),
        cmocka_unit_test(the_largest_reflectance_of_a_range_is_at_an_end_of_it),
        cmocka_unit_test(the_mean_is_walshs),
        cmocka_unit_test(the_index_is_found_from_both_reflectances),
    };

    return cmocka_run_group_tests_name("fresnel", tests, NULL, NULL);
}
