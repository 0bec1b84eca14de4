/* SPDX-License-Identifier: BSD-2-Clause */
/* stats and tests/stat: the judges are judged. References of Q: mpmath, 40 digits, rounded to 17; tables of Abramowitz
 * and Stegun (26.8); closed forms. Family-wise significance 0.01. */
#include "bis/base/stats.h"
#include "bis/thesis/rng.h"
#include "claim.h"
#include "stat.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static double alpha(void) { return stat_level(0.01, 3); }

static void assert_relative(double v, double expected, double tolerance)
{
    if (!(fabs(v - expected) <= tolerance * fabs(expected))) fail_msg("%.17g, expected %.17g", v, expected);
}

static void gamma_q_agrees_with_published_values_to_1e_13_sqrt_a(void **state)
{
    const double cases[][3] = {{0.5, 600, 6.0995688148084337e-263}, {0.5, 1e-12, 0.9999988716208329},
                               {2.5, 1e-10, 1},                     {19.9, 40, 0.00016334204091683553},
                               {20, 40, 0.00017630289773856828},    {100, 50, 0.99999999967999347},
                               {100, 200, 1.8438936497115742e-15},  {1e6, 1e6, 0.49986701923912741},
                               {1e6, 1.01e6, 1.0606997477586901e-23}, {1e6, 0.99e6, 1},
                               {500000, 503000, 1.1445084182949127e-5}, {3, 700, 2.4225323864783195e-299}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_relative(bis_stats_gamma_q(cases[i][0], cases[i][1]), cases[i][2], 1e-13 * sqrt(1 + cases[i][0]));
}

static void gamma_q_has_its_closed_forms(void **state)
{
    for (double x = 1e-6; x < 600; x *= 1.37) {
        assert_relative(bis_stats_gamma_q(1, x), exp(-x), 1e-13);
        assert_relative(bis_stats_gamma_q(0.5, x), erfc(sqrt(x)), 1e-13);
        double poisson = 0; /* Q(40, x) = P(a Poisson variable of mean x is below 40) */
        for (int k = 39; k >= 0; k--)
            poisson += exp(k * log(x) - x - lgamma(k + 1.0));
        assert_relative(bis_stats_gamma_q(40, x), poisson, 1e-12);
    }
}

static void gamma_q_has_its_limits(void **state)
{
    assert_true(bis_stats_gamma_q(3, 0) == 1);
    assert_true(bis_stats_gamma_q(3, HUGE_VAL) == 0);
    assert_true(bis_stats_gamma_q(3, 1e6) == 0);
    assert_true(bis_stats_gamma_q(1e8, 1e8) > 0.4999 && bis_stats_gamma_q(1e8, 1e8) < 0.5);
}

static void chi_square_p_agrees_with_the_tables(void **state)
{
    const double cases[][3] = {{3.84146, 1, .05},    {18.3070, 10, .05},   {124.342, 100, .05}, {10.828, 1, .001},
                               {29.588, 10, .001},   {149.449, 100, .001}, {0.0039321, 1, .95}, {67.3276, 100, .995}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_relative(bis_stats_chi_square_p(cases[i][0], cases[i][1]), cases[i][2], 1e-3);
}

static void normal_p_is_two_sided_and_never_0_in_reach(void **state)
{
    assert_relative(bis_stats_normal_p(1.9599639845400545), .05, 1e-14);
    assert_true(bis_stats_normal_p(0) == 1);
    assert_true(bis_stats_normal_p(-3) == bis_stats_normal_p(3));
    assert_relative(bis_stats_normal_p(10), 1.5239706048321052e-23, 1e-13);
    assert_true(bis_stats_normal_p(37) > 0);
}

/* Closed forms for 1, 2 and 4 degrees of freedom; tables for others; the normal law for very many. */
static void student_p_has_its_closed_forms_and_agrees_with_the_tables(void **state)
{
    static const double table[][3] = {
        {2.228139, 10, 0.05}, {3.169273, 10, 0.01}, {2.042272, 30, 0.05}, {1.475884, 5, 0.2}};
    for (double t = 1e-3; t < 1e4; t *= 1.7) {
        const double q = 1 + t * t / 4;
        assert_relative(bis_stats_student_p(t, 1), 0.63661977236758134308 * atan(1 / t), 1e-13);
        assert_relative(bis_stats_student_p(-t, 2), 2 / (2 + t * t + t * sqrt(2 + t * t)), 1e-12);
        if (t < 10) assert_relative(bis_stats_student_p(t, 4), 1 - 0.75 * t / sqrt(q) * (1 - t * t / (12 * q)), 1e-9);
    }
    for (size_t i = 0; i < 4; i++) assert_relative(bis_stats_student_p(table[i][0], table[i][1]), table[i][2], 1e-5);
    for (double t = 0.1; t < 5; t += 0.3) /* they differ by about t^4/(4 dof), at most 2e-5 */
        assert_relative(bis_stats_student_p(t, 1e7), bis_stats_normal_p(t), 3e-5);
    assert_true(bis_stats_student_p(0, 7) == 1 && bis_stats_student_p(HUGE_VAL, 3) == 0);
}

static void sidak_gives_back_the_family(void **state)
{
    assert_relative(bis_stats_sidak(.01, 1), .01, 1e-15);
    assert_relative(bis_stats_sidak(.01, 40), 2.5122e-4, 1e-4);
    assert_relative(bis_stats_sidak(1e-12, 1e6), 1e-18, 1e-9); /* 1 - (1 - alpha)^(1/m) would give 0 */
    for (double m = 1; m < 1e5; m *= 7)
        assert_relative(-expm1(m * log1p(-bis_stats_sidak(.03, m))), .03, 1e-12);
}

/* ---- the harness ---- */

enum { CELLS = 30, DRAWS = 3000 };

/* Cell i has probability proportional to 1 / (1 + i)^2, so that several of them must be pooled. Draws come by brute
 * force, so that no module under test elsewhere is needed. excess: probability moved from cell 1 to cell 0. */
static void draw_histogram(double observed[CELLS], double expected[CELLS], uint64_t seed, double excess)
{
    double p[CELLS], sum = 0;
    bis_rng r;
    bis_rng_init(&r, seed, 0, 0, 0);
    for (int i = 0; i < CELLS; i++)
        sum += p[i] = 1.0 / ((1 + i) * (1 + i));
    for (int i = 0; i < CELLS; i++) {
        p[i] /= sum;
        expected[i] = DRAWS * p[i];
        observed[i] = 0;
    }
    p[0] += excess;
    p[1] -= excess;
    for (int k = 0; k < DRAWS; k++) {
        double u = bis_rng_double(&r);
        int i = 0;
        for (; i < CELLS - 1 && u >= p[i]; i++)
            u -= p[i];
        observed[i]++;
    }
}

static void p_values_of_a_right_histogram_are_uniform(void **state)
{
    double bins[20] = {0}, expected_bins[20], observed[CELLS], expected[CELLS];
    const int runs = 4000;
    for (int k = 0; k < runs; k++) {
        draw_histogram(observed, expected, 1000 + (uint64_t)k, 0);
        stat_result r = stat_chi_square(observed, expected, CELLS, alpha());
        bins[(int)fmin(r.p * 20, 19)]++;
    }
    for (int i = 0; i < 20; i++)
        expected_bins[i] = runs / 20.0;
    stat_assert_fit("stats_p_values", 1000, bins, expected_bins, 20, alpha());
    bins[0] += 60, bins[19] -= 60; /* the twin: p too often small */
    stat_assert_no_fit("stats_p_values_twin", 1000, bins, expected_bins, 20, alpha());
}

/* References: mpmath, 30 digits; for one degree of freedom also in closed form, (z + z)^2, but for the far tail. */
static void power_agrees_with_reference_noncentralities(void **state)
{
    const double cases[][4] = {
        {1, .05, .9, 10.5074194}, {10, .05, .9, 20.5319707}, {100, .05, .9, 49.2930040}, {1, .01, .99, 24.0313411}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const double *c = cases[i], e = stat_least_error(1, c[0], c[1], c[2]);
        assert_relative(e * e, c[3], 1e-6);
        assert_relative(stat_power(c[0], c[1], c[3]), c[2], 1e-6);
        assert_relative(stat_power(c[0], c[1], 0), c[1], 1e-9);
    }
    assert_relative(stat_least_shift(.05, .8), 1.959964 + .841621, 1e-6);
    assert_true(stat_power(50000, 1e-6, 4000) > 0.99 && stat_power(50000, 1e-6, 1000) < 0.5);
}

/* An excess e between two cells adds e^2 DRAWS (1/p0 + 1/p1) to the statistic's mean, which is 23 (24 pools) with a
 * standard deviation of 7. e = 5.2 % adds 65 here (p0 = .62, p1 = .16): about the smallest error that 3000 draws show
 * this surely. */
static void an_excess_of_5_percent_is_found_with_99_percent_power(void **state)
{
    double observed[CELLS], expected[CELLS];
    int found = 0, found_smaller = 0;
    const int runs = 1000;
    const double level = bis_stats_sidak(0.01, 8); /* the one that 5.2 % belongs to */
    /* sum of p e^2 = excess^2 (1/p0 + 1/p1) */
    const double p0 = 0.6208, p1 = p0 / 4, least = stat_least_error(DRAWS, 23, level, 0.99) / sqrt(1 / p0 + 1 / p1);
    assert_true(fabs(least - 0.052) < 0.002);
    for (int k = 0; k < runs; k++) {
        draw_histogram(observed, expected, 9000 + (uint64_t)k, 0.052);
        found += stat_chi_square(observed, expected, CELLS, level).rejected;
        draw_histogram(observed, expected, 9000 + (uint64_t)k, 0.01);
        found_smaller += stat_chi_square(observed, expected, CELLS, level).rejected;
    }
    assert_true(found >= 980); /* 990 expected, standard error 3 */
    assert_true(found_smaller < 100);
}

static void a_hit_in_a_cell_of_probability_0_rejects(void **state)
{
    const double expected[] = {1e6, 0, 1e6}, right[] = {1e6, 0, 1e6}, wrong[] = {1e6, 1, 1e6 - 1};
    assert_false(stat_chi_square(right, expected, 3, alpha()).rejected);
    stat_assert_no_fit("stats_impossible", 0, wrong, expected, 3, alpha());
}

static void lost_draws_and_nans_reject(void **state)
{
    const double expected[] = {1e6, 1e6}, lost[] = {1e6, 1e6 - 200}, nans[] = {1e6, nan("")};
    stat_assert_no_fit("stats_lost", 0, lost, expected, 2, alpha());
    stat_assert_no_fit("stats_nan", 0, nans, expected, 2, alpha());
    stat_assert_no_fit("stats_nan", 0, expected, nans, 2, alpha());
}

static void small_cells_are_pooled_and_the_last_pool_is_kept(void **state)
{
    /* 1000 + 30 cells of 0.4: two pools of 5.2 (13 cells each), and 4 cells, 1.6, that join the last. */
    double expected[31] = {1000}, observed[31] = {1000};
    for (int i = 1; i <= 30; i++)
        expected[i] = 0.4;
    observed[1] = 5, observed[30] = 7;
    stat_result r = stat_chi_square(observed, expected, 31, alpha());
    assert_true(r.dof == 2);
    assert_relative(r.statistic, 0.2 * 0.2 / 5.2 + 0.2 * 0.2 / 6.8, 1e-9);
    observed[0] -= 30, observed[30] += 30; /* an error in what would be dropped */
    stat_assert_no_fit("stats_last_pool", 0, observed, expected, 31, alpha());
}

static void a_mean_is_accepted_at_its_place_and_rejected_6_errors_away(void **state)
{
    bis_rng r;
    stat_moments m = {0};
    bis_rng_init(&r, 5, 0, 0, 0);
    for (int i = 0; i < 120000; i++)
        stat_add(&m, bis_rng_double(&r));
    const double error = sqrt(1 / 12.0 / 120000);
    assert_relative(stat_variance(&m), 1 / 12.0, 0.02);
    stat_assert_mean("stats_mean", 5, &m, 0.5, alpha());
    stat_assert_not_mean("stats_mean", 5, &m, 0.5 + 6 * error + (m.mean - 0.5), alpha());
    stat_assert_not_mean("stats_mean", 5, &m, nan(""), alpha());
}

static void a_constant_must_equal_its_mean(void **state)
{
    stat_moments m = {0};
    for (int i = 0; i < 10; i++)
        stat_add(&m, 0.7);
    stat_assert_mean("stats_constant", 0, &m, 0.7, alpha());
    stat_assert_not_mean("stats_constant", 0, &m, 0.7 + 1e-9, alpha());
}

/* This program itself, which judges three p-values, runs again and judges one. It comes first among the tests, because
 * each run begins the program's file in build/power anew. */
static void a_program_that_judges_another_number_than_it_tells_fails(void **state)
{
    char command[1024];

    assert_int_equal(system("mkdir -p build"), 0);
    snprintf(command, sizeof command, "%s 'a_constant*' >build/test_stats.out 2>&1", program_invocation_name);
    assert_int_not_equal(system(command), 0);
    assert_int_equal(
        system("grep -q '1 p-values were judged, and stat_level was told 3: write 1$' build/test_stats.out"), 0);
    /* the twin: one test was asked for, and nobody promises the rest */
    snprintf(command, sizeof command, "BIS_TEST='a_constant*' %s >build/test_stats.out 2>&1", program_invocation_name);
    assert_int_equal(system(command), 0);
}

/* Of ten p-values the smallest must not be below 1 - 0.999^(1/10) = 1.0005e-4. */
static void a_p_value_that_is_judged_later_fails_the_program(void **state)
{
    static const char *const rows[] = {"1.001e-4 10", "1.000e-4 10", "1.000e-4 11"};
    char command[1024];

    for (int i = 0; i < 3; i++) {
        snprintf(command, sizeof command, "%s later %s >build/test_stats.out 2>&1", program_invocation_name, rows[i]);
        assert_int_equal(system(command) != 0, i == 1);
    }
    snprintf(command, sizeof command, "%s later 1e-9 10 >build/test_stats.out 2>&1", program_invocation_name);
    assert_int_not_equal(system(command), 0);
    assert_int_equal(system("grep -q '^stat: a claim: p 1e-09 is below 0.0001, the level of each of 10 p-values$' "
                            "build/test_stats.out"), 0);
}

/* test_stats TEST: only the tests of that name, with no word to the count of p-values. test_stats later P M: P is
 * judged among M. */
int main(int argc, char **argv)
{
    if (argc > 3) {
        stat_judges(atoi(argv[3]));
        stat_later(1e-3, atof(argv[2]), "a %s", "claim");
        return 0;
    }
    if (argc > 1) cmocka_set_test_filter(argv[1]);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_program_that_judges_another_number_than_it_tells_fails),
        cmocka_unit_test(a_p_value_that_is_judged_later_fails_the_program),
        cmocka_unit_test(gamma_q_agrees_with_published_values_to_1e_13_sqrt_a),
        cmocka_unit_test(gamma_q_has_its_closed_forms),
        cmocka_unit_test(gamma_q_has_its_limits),
        cmocka_unit_test(chi_square_p_agrees_with_the_tables),
        cmocka_unit_test(normal_p_is_two_sided_and_never_0_in_reach),
        cmocka_unit_test(student_p_has_its_closed_forms_and_agrees_with_the_tables),
        cmocka_unit_test(sidak_gives_back_the_family),
        cmocka_unit_test(p_values_of_a_right_histogram_are_uniform),
        cmocka_unit_test(power_agrees_with_reference_noncentralities),
        cmocka_unit_test(an_excess_of_5_percent_is_found_with_99_percent_power),
        cmocka_unit_test(a_hit_in_a_cell_of_probability_0_rejects),
        cmocka_unit_test(lost_draws_and_nans_reject),
        cmocka_unit_test(small_cells_are_pooled_and_the_last_pool_is_kept),
        cmocka_unit_test(a_mean_is_accepted_at_its_place_and_rejected_6_errors_away),
        cmocka_unit_test(a_constant_must_equal_its_mean),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
