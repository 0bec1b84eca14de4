/* SPDX-License-Identifier: BSD-2-Clause */
/* What a run of `bis verify` is: its p-values, thresholds and verdicts, for numbers whose distribution is known. The
 * checks themselves are in test_verify_map, test_verify_bsdf and so on, one program a file of src/tools/verify. */
#include "tools/verify/verify.h"
#include "bis/base/mem.h"
#include "bis/base/stats.h"
#include "claim.h"
#include "map_help.h"
#include "verify_help.h"

#include <string.h>

static void thresholds_are_sidaks_and_p_is_never_from_the_wrong_side(void **state)
{
    bis_verify v = {.seed = 1};
    const double expected[] = {100, 100, 3, 3, 3, 0}, observed[] = {90, 110, 2, 4, 3, 0},
                 impossible[] = {90, 110, 2, 4, 2, 1};
    bis_verify_fit(bis_verify_new(&v, "g", "cells of 100, 100, 9"), observed, expected, 6);
    bis_verify_fit(bis_verify_new(&v, "g", "a hit where nothing is expected"), impossible, expected, 6);
    /* a standard error of 1, no skewness: m2 = n (n - 1) */
    const bis_verify_moments off = {.n = 1e9, .mean = 8, .m2 = 1e9 * (1e9 - 1)}, still = {.n = 11, .mean = 2},
                             none = {.n = 11, .mean = (double)NAN};
    bis_verify_mean(bis_verify_new(&v, "g", "three sigma"), &off, 5, 0);
    bis_verify_mean(bis_verify_new(&v, "g", "within rounding"), &still, 5, 3);
    bis_verify_mean(bis_verify_new(&v, "g", "not a number"), &none, 5, 0);
    bis_verify_bound(bis_verify_new(&v, "g", "not a number"), (double)NAN, 1, "");
    bis_verify_bound(bis_verify_new(&v, "g", "at its limit"), 1, 1, "");
    bis_verify_skip(bis_verify_new(&v, "g", "skipped %d", 1), "because");
    assert_int_equal(bis_verify_judge(&v, NULL), BIS_OK);
    assert_int_equal(v.n_statistical, 5);
    assert_near(v.threshold, 1 - pow(0.99, 0.2), 1e-12);
    /* 9 expected in two pools, 6 and a rest of 3: one cell of 9. Three cells of 100, 100, 9: cumulants
     * 2, 4.0646, 18.876; the tail of the shifted gamma distribution that has them, integrated numerically. */
    assert_near(v.tests[0].p, 0.34884298, 1e-6);
    assert_true(v.tests[1].p == 0 && v.tests[4].p == 0 && v.tests[3].p == 1);
    assert_near(v.tests[2].p, 0.0026998, 1e-6);
    assert_int_equal(v.n_failed, 3);
    assert_int_equal(v.n_skipped, 1);
    /* (10^2 + 10^2)/100 and 0; (8 - 5)/1; nothing beyond the slack */
    static const double statistic[] = {2, 2, 3, 0, (double)NAN, (double)NAN, 1};
    static const bis_verdict verdict[] = {BIS_VERDICT_PASSED, BIS_VERDICT_FAILED, BIS_VERDICT_PASSED,
        BIS_VERDICT_PASSED, BIS_VERDICT_FAILED, BIS_VERDICT_FAILED, BIS_VERDICT_PASSED, BIS_VERDICT_SKIPPED};
    static const char *const note[] = {"chi-square, 2 degrees of freedom",
        "chi-square; 1 draws fell where nothing can be drawn", "z", "z; equal up to rounding and quadrature",
        "not a number", "", "", "because"};
    assert_int_equal(v.n, 8);
    for (size_t i = 0; i < 8; i++) {
        const bis_verify_test *t = &v.tests[i];
        assert_string_equal(t->group, "g");
        if (i != 1 && i < 7 && !(isnan(statistic[i]) ? isnan(t->statistic) : fabs(t->statistic - statistic[i]) < 1e-9))
            fail_msg("%s: statistic %g", t->name, t->statistic);
        if (t->verdict != verdict[i]) fail_msg("%s: verdict %d", t->name, (int)t->verdict);
        if (i != 4) assert_string_equal(t->note, note[i]);
        if (!isnan(t->p)) assert_true(t->threshold == v.threshold);
    }
    assert_true(v.tests[0].dof == 2 && v.tests[2].dof == 1e9 - 1 && isnan(v.tests[5].p) && isnan(v.tests[6].p));
    assert_string_equal(v.tests[7].name, "skipped 1");
    bis_verify_clear(&v);
}

/* Farther from what is right is never likelier: without the cut at 1/s, 30 standard errors at s = 0.05 gave p = 1. */
static void a_larger_distance_is_never_more_likely(void **state)
{
    static const double skewness[] = {0, 0.01, 0.05, -0.05, 0.15}, dof[] = {63, 16383, HUGE_VAL};
    const double of_100_tests = bis_stats_sidak(BIS_VERIFY_ALPHA, 100);
    for (int i = 0; i < 5; i++) {
        for (int k = 0; k < 3; k++) {
            double last = 1;
            for (double z = 0; z < 200; z += 0.25) {
                const double p = bis_verify_t(z, dof[k], skewness[i]);
                if (!(p <= last && p >= 0 && p == bis_verify_t(-z, dof[k], skewness[i])))
                    fail_msg("z %g, skewness %g: p %g", z, skewness[i], p);
                last = p;
            }
            if (k > 0 && fabs(skewness[i]) < BIS_VERIFY_MOST_SKEWNESS) assert_true(last < of_100_tests);
        }
    }
    /* by hand: the normal distribution's 6.3342e-5 at 4, times exp(0.05 * 64 / 3) */
    assert_near(bis_verify_t(4, HUGE_VAL, 0.05) / (6.3342484e-5 * exp(3.2 / 3)), 1, 1e-6);
}

/* A bound is met from 0 to itself; a p is at most 1, and one that is none is 0. What is cleared keeps what it was asked
 * with. */
static void a_bound_a_p_and_a_run_have_their_ends(void **state)
{
    static const struct { double value; bis_verdict verdict; } cases[] = {
        {-1e-9, BIS_VERDICT_FAILED}, {0, BIS_VERDICT_PASSED}, {2, BIS_VERDICT_PASSED}, {2.001, BIS_VERDICT_FAILED}};
    static const double given[] = {-0.5, 0, 0.5, 1, 1.5, (double)NAN}, taken[] = {0, 0, 0.5, 1, 1, 0};
    int user;
    bis_verify v = {.seed = 7, .as_printed = BIS_E34, .halvings = 3, .user = &user};
    for (int i = 0; i < 4; i++) {
        bis_verify_test *t = bis_verify_new(&v, "g", "%d", i);
        bis_verify_bound(t, cases[i].value, 2, "n");
        assert_true(t->verdict == cases[i].verdict && t->threshold == 2 && t->statistic == cases[i].value);
        assert_string_equal(t->note, "n");
    }
    for (int i = 0; i < 6; i++) {
        bis_verify_test *t = bis_verify_new(&v, "g", "p %d", i);
        bis_verify_p(t, i, given[i], "n");
        assert_true(t->p == taken[i] && t->statistic == i);
    }
    assert_int_equal(v.n, 10);
    assert_string_equal(v.tests[9].name, "p 5");
    assert_int_equal(bis_verify_judge(&v, NULL), BIS_OK);
    assert_int_equal(v.n_statistical, 6);
    assert_int_equal(v.n_failed, 2 + 3);
    assert_true(bis_verify_seed(&v, "%s", "a") == bis_verify_seed(&v, "a"));
    const uint64_t seed = bis_verify_seed(&v, "a");
    assert_true(seed != bis_verify_seed(&v, "b"));
    bis_verify_clear(&v);
    assert_true(v.seed == 7 && v.as_printed == BIS_E34 && v.halvings == 3 && v.user == &user);
    assert_true(v.n == 0 && v.capacity == 0 && !v.tests && v.n_failed == 0 && v.threshold == 0);
    assert_true(bis_verify_judge(&v, NULL) == BIS_OK && v.threshold == BIS_VERIFY_ALPHA);
    v.seed = 8;
    assert_true(seed != bis_verify_seed(&v, "a"));
}

/* Means of 400 exponential variables, of skewness 0.1: p is below 0.001 in at most 0.1 % of 40000 experiments, but for
 * 4 standard errors, and by t alone, the twin, more often. */
static void skewed_means_do_not_accuse(void **state)
{
    enum { N = 40000, RUNS = 400 };
    int below = 0, below_t = 0;
    bis_rng rng;
    bis_rng_init(&rng, 4, 0, 0, 96);
    for (int k = 0; k < N; k++) {
        bis_verify_moments m = {0};
        bis_verify v = {.seed = 1};
        for (int i = 0; i < RUNS; i++) bis_verify_add(&m, -log1p(-bis_rng_double(&rng)));
        bis_verify_mean(bis_verify_new(&v, "g", "exponential"), &m, 1, 0);
        below += v.tests[0].p < 0.001;
        below_t += bis_stats_student_p(v.tests[0].statistic, RUNS - 1) < 0.001;
        bis_verify_clear(&v);
    }
    const double most = 0.001 * N + 4 * sqrt(0.001 * N);
    if (!(below <= most && below_t > most)) fail_msg("below 0.001: %d of %d, %d by t alone", below, N, below_t);
}

/* Poisson's, by inversion. */
static double poisson(bis_rng *rng, double mean)
{
    double u = bis_rng_double(rng), p = exp(-mean), k = 0;
    for (; u > p && k < 100; k++) {
        u -= p;
        p *= mean / (k + 1);
    }
    return k;
}

/* 200 cells that expect 5 draws each, and one that expects a million: p is below 0.01 in 1 % of 40000 experiments, but
 * for 4 standard errors, and by plain chi-square, the twin, more often. */
static void small_cells_do_not_accuse(void **state)
{
    enum { CELLS = 200, EACH = 5, REST = 1000000, N = 40000 };
    double expected[CELLS + 1], observed[CELLS + 1];
    int below = 0, below_plain = 0;
    bis_rng rng;
    bis_rng_init(&rng, 3, 0, 0, 97);
    for (int i = 0; i <= CELLS; i++) expected[i] = i < CELLS ? EACH : REST;
    for (int k = 0; k < N; k++) {
        bis_verify v = {.seed = 1};
        observed[CELLS] = REST + CELLS * EACH;
        for (int i = 0; i < CELLS; i++) observed[CELLS] -= observed[i] = poisson(&rng, EACH);
        bis_verify_fit(bis_verify_new(&v, "g", "small"), observed, expected, CELLS + 1);
        below += v.tests[0].p < 0.01;
        below_plain += bis_stats_chi_square_p(v.tests[0].statistic, CELLS) < 0.01;
        bis_verify_clear(&v);
    }
    const double most = 0.01 * N + 4 * sqrt(0.01 * N);
    if (!(below <= most && below_plain > most))
        fail_msg("below 0.01: %d of %d, %d by plain chi-square", below, N, below_plain);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(thresholds_are_sidaks_and_p_is_never_from_the_wrong_side),
        cmocka_unit_test(a_larger_distance_is_never_more_likely),
        cmocka_unit_test(a_bound_a_p_and_a_run_have_their_ends),
        cmocka_unit_test(skewed_means_do_not_accuse),
        cmocka_unit_test(small_cells_do_not_accuse),
    };
    return cmocka_run_group_tests_name("verify", tests, NULL, NULL);
}
