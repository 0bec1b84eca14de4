/* SPDX-License-Identifier: BSD-2-Clause */
/* What `bis verify` reports, by hand: each field of each test, the counts in the notes, the bounds, the text and the
 * JSON. That it accepts what is right and rejects what is wrong is in test_verify_map, test_verify_bsdf, ... Most of
 * it is C and no .expect, because fields are compared that the text rounds. */
#include "tools/verify/verify.h"

#include "bis/base/mem.h"
#include "bis/base/stats.h"
#include "bis/beyond/microfacet.h"
#include "bis/files/image_file.h"
#include "bis/thesis/phong.h"
#include "bis/thesis/rng.h"
#include "claim.h"
#include "further.h"
#include "json_check.h"
#include "lack.h"
#include "lit.h"
#include "map_help.h"
#include "mesh_help.h"
#include "program.h"
#include "tiny.h"

#ifdef _OPENMP
#include <omp.h>
#else
#define omp_set_num_threads(n)
#endif

#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DIR "build/test_verdicts"

/* NAN: it must be no number. */
static void assert_figure(double found, double expected, const char *what)
{
    const bool same =
        isnan(expected) ? isnan(found) : found == expected || fabs(found - expected) <= 1e-9 * fabs(expected);
    if (!same) fail_msg("%s is %.17g, not %.17g", what, found, expected);
}

typedef struct expected_test {
    const char *name, *note;
    double statistic, dof, p, threshold;
    bis_verdict verdict;
} expected_test;

static void assert_test(const bis_verify_test *t, const char *group, const expected_test *e)
{
    assert_string_equal(t->group, group);
    assert_string_equal(t->name, e->name);
    assert_string_equal(t->note, e->note);
    assert_figure(t->statistic, e->statistic, e->name);
    assert_figure(t->dof, e->dof, e->name);
    assert_figure(t->p, e->p, e->name);
    assert_figure(t->threshold, e->threshold, e->name);
    if (t->verdict != e->verdict) fail_msg("%s: verdict %d", e->name, (int)t->verdict);
}

/* ---- the list ---- */

static void a_test_has_the_fields_that_were_handed_in(void **state)
{
    const double limit = 1 - pow(0.99, 1 / 5.0), no = (double)NAN;
    const expected_test expected[] = {
        {"at its limit", "n1", 0.5, 0, no, 0.5, BIS_VERDICT_PASSED},
        {"above", "n2", 0.5000001, 0, no, 0.5, BIS_VERDICT_FAILED},
        {"nothing", "n3", 0, 0, no, 0, BIS_VERDICT_PASSED},
        {"negative", "n4", -1e-300, 0, no, 0.5, BIS_VERDICT_FAILED},
        {"no number", "n5", no, 0, no, 0.5, BIS_VERDICT_FAILED},
        {"left out 7", "why", no, 0, no, no, BIS_VERDICT_SKIPPED},
        {"p 1", "n6", 3, 0, 1, limit, BIS_VERDICT_PASSED},
        {"p at its limit", "n7", 4, 0, limit, limit, BIS_VERDICT_PASSED},
        {"p below", "n8", 5, 0, 0.0019, limit, BIS_VERDICT_FAILED},
        {"p above 1", "n9", 6, 0, 1, limit, BIS_VERDICT_PASSED},
        {"p no number", "n10", 7, 0, 0, limit, BIS_VERDICT_FAILED},
    };
    bis_verify v = {.seed = 1};
    bis_verify_bound(bis_verify_new(&v, "g", "at its %s", "limit"), 0.5, 0.5, "n1");
    bis_verify_bound(bis_verify_new(&v, "g", "above"), 0.5000001, 0.5, "n2");
    bis_verify_bound(bis_verify_new(&v, "g", "nothing"), 0, 0, "n3");
    bis_verify_bound(bis_verify_new(&v, "g", "negative"), -1e-300, 0.5, "n4");
    bis_verify_bound(bis_verify_new(&v, "g", "no number"), no, 0.5, "n5");
    bis_verify_skip(bis_verify_new(&v, "g", "left out %d", 7), "why");
    bis_verify_p(bis_verify_new(&v, "g", "p 1"), 3, 1, "n6");
    bis_verify_p(bis_verify_new(&v, "g", "p at its limit"), 4, bis_stats_sidak(0.01, 5), "n7");
    bis_verify_p(bis_verify_new(&v, "g", "p below"), 5, 0.0019, "n8");
    bis_verify_p(bis_verify_new(&v, "g", "p above 1"), 6, 1 + 1e-7, "n9");
    bis_verify_p(bis_verify_new(&v, "g", "p no number"), 7, no, "n10");
    for (int turn = 0; turn < 2; turn++) { /* judged twice, the counts are the same */
        assert_int_equal(bis_verify_judge(&v, NULL), BIS_OK);
        assert_int_equal(v.n, 11);
        for (int i = 0; i < 11; i++) assert_test(&v.tests[i], "g", &expected[i]);
        assert_int_equal(v.n_statistical, 5);
        assert_int_equal(v.n_failed, 5);
        assert_int_equal(v.n_skipped, 1);
        assert_figure(v.threshold, limit, "threshold");
    }
    for (int i = 0; i < 200; i++)
        bis_verify_bound(bis_verify_new(&v, "h", "%d", i), i, 200, ""); /* the list grows and keeps what it has */
    assert_test(&v.tests[0], "g", &expected[0]);
    assert_int_equal(v.n, 211);
    for (int i = 0; i < 200; i++) assert_true(atoi(v.tests[11 + i].name) == i && v.tests[11 + i].statistic == i);
    bis_verify_clear(&v);
    assert_true(v.n == 0 && !v.tests && v.seed == 1);
}

static void without_a_p_value_the_threshold_is_that_of_one(void **state)
{
    bis_verify v = {.seed = 1};
    assert_int_equal(bis_verify_judge(&v, NULL), BIS_OK);
    assert_true(v.threshold == 0.01 && v.n_statistical == 0 && v.n_failed == 0 && v.n_skipped == 0);
}

/* The published values of FNV-1a for "a" and "foobar". */
static void a_tests_seed_is_made_of_its_name_and_the_runs(void **state)
{
    const bis_verify v = {.seed = 0}, w = {.seed = 0xffffffffffff};
    assert_true(bis_verify_seed(&v, "a") == bis_hash(bis_hash(0xaf63dc4c8601ec8cu)));
    assert_true(bis_verify_seed(&w, "foo%s", "bar") == bis_hash(bis_hash(0x85944171f73967e8u) ^ 0xffffffffffff));
}

static int parts;
static void count_part(const char *what, void *user)
{
    assert_string_equal(what, "a part");
    assert_ptr_equal(user, &parts);
    parts++;
}

static void a_part_that_begins_is_told(void **state)
{
    bis_verify v = {.seed = 3, .as_printed = 1, .halvings = 2, .progress = count_part, .user = &parts},
               quiet = {.seed = 1};
    bis_verify_begin(&v, "a part");
    bis_verify_begin(&quiet, "a part");
    bis_verify_clear(&v); /* what was asked for stays */
    assert_true(v.seed == 3 && v.as_printed == 1 && v.halvings == 2 && v.user == &parts);
    bis_verify_begin(&v, "a part");
    assert_int_equal(parts, 2);
}

/* ---- counts ---- */

/* Expected 2 2 2 | 5 | 4 and 1: the pools are 6, 5, 5 and the last rest of 1 joins the last: 6, 5, 6. */
static void cells_are_pooled_in_order_and_the_rest_joins_the_last(void **state)
{
    const double expected[] = {2, 2, 2, 5, 4, 1, 1}, observed[] = {1, 2, 6, 5, 1, 1, 1}, none[] = {0, 0, 0, 0, 0, 0, 0};
    const double zero[] = {0, 6, 6}, hits[] = {2, 5, 5}, one_more[] = {2, 6, 4};
    const double no_number[] = {6, (double)NAN, 6}, three[] = {6, 6, 6}, few[] = {1, 2};
    bis_verify v = {.seed = 1};
    bis_verify_fit(bis_verify_new(&v, "g", "pools"), observed, expected, 7);
    bis_verify_fit(bis_verify_new(&v, "g", "nothing drawn"), none, expected, 7);
    bis_verify_fit(bis_verify_new(&v, "g", "impossible"), hits, zero, 3);
    bis_verify_fit(bis_verify_new(&v, "g", "three"), one_more, three, 3);
    bis_verify_fit(bis_verify_new(&v, "g", "no number"), three, no_number, 3);
    bis_verify_fit(bis_verify_new(&v, "g", "one pool"), few, few, 2);
    assert_string_equal(v.tests[0].note, "chi-square, 2 degrees of freedom");
    assert_figure(v.tests[0].statistic, 9 / 6.0 + 0 + 9 / 6.0, "pools");
    assert_true(v.tests[0].dof == 2);
    assert_figure(v.tests[1].statistic, 17, "nothing drawn"); /* (0 - E)^2/E = E */
    assert_string_equal(v.tests[2].note, "chi-square; 2 draws fell where nothing can be drawn");
    assert_true(v.tests[2].p == 0 && v.tests[2].dof == 1);
    /* the impossible ones are in the first pool */
    assert_figure(v.tests[2].statistic, 1 / 6.0 + 1 / 6.0, "impossible");
    assert_figure(v.tests[3].statistic, 16 / 6.0 + 0 + 4 / 6.0, "three");
    assert_string_equal(v.tests[4].note, "chi-square; an expected count is not a number");
    assert_true(v.tests[4].p == 0 && isnan(v.tests[4].statistic));
    assert_true(v.tests[5].p == 1 && v.tests[5].dof == 0 && v.tests[5].statistic == 0);
    assert_string_equal(v.tests[5].note, "chi-square, 0 degrees of freedom");
    bis_verify_clear(&v);
}

/* The density of the shifted gamma distribution with these cumulants, summed by Simpson's rule from the statistic on,
 * in place of a gamma function. Two cells of 5: 1, 2 + 2/5 - 6/10, 8 + 2 (22/5 + 1/25). */
static double tail_of_gamma(double statistic, double k1, double k2, double k3)
{
    enum { STEPS = 200000 };
    const double shape = 4 * k2 * k2 * k2 / (k3 * k3), scale = k3 / (2 * k2), shift = k1 - shape * scale;
    const double from = (statistic - shift) / scale, to = from + 60, h = (to - from) / STEPS;
    double sum = 0;
    for (int i = 0; i <= STEPS; i++) {
        const double x = from + i * h, weight = i == 0 || i == STEPS ? 1 : i % 2 ? 4 : 2;
        sum += weight * exp((shape - 1) * log(x) - x - lgamma(shape));
    }
    return sum * h / 3;
}

static void p_is_the_tail_of_a_shifted_gamma_distribution(void **state)
{
    const double two[] = {5, 5}, off[] = {9, 1}, four[] = {6, 10, 20, 50}, off_four[] = {10, 8, 27, 41};
    double sum = 0;
    bis_verify v = {.seed = 1};
    bis_verify_fit(bis_verify_new(&v, "g", "two"), off, two, 2);
    bis_verify_fit(bis_verify_new(&v, "g", "four"), off_four, four, 4);
    assert_near(
        v.tests[0].p / tail_of_gamma(32 / 5.0, 1, 2 + 2 / 5.0 - 6 / 10.0, 8 + 2 * (22 / 5.0 + 1 / 25.0)), 1, 1e-6);
    double k2 = 6, k3 = 24;
    for (int i = 0; i < 4; i++) {
        k2 += 1 / four[i];
        k3 += 22 / four[i] + 1 / (four[i] * four[i]);
        sum += (off_four[i] - four[i]) * (off_four[i] - four[i]) / four[i];
    }
    assert_near(v.tests[1].p / tail_of_gamma(sum, 3, k2 - 22 / 86.0, k3), 1, 1e-6); /* 22 = 4^2 + 2 4 - 2 of 86 draws */
    bis_verify_clear(&v);
}

/* ---- means ---- */

static void moments_are_the_sums_about_the_mean(void **state)
{
    const double x[] = {1, 2, 4, 8, -3, 8.5};
    double mean = 0, m2 = 0, m3 = 0;
    bis_verify_moments m = {0}, still = {0};
    for (int i = 0; i < 6; i++) {
        bis_verify_add(&m, x[i]);
        bis_verify_add(&still, 2);
        mean += x[i] / 6;
    }
    for (int i = 0; i < 6; i++) {
        m2 += pow(x[i] - mean, 2);
        m3 += pow(x[i] - mean, 3);
    }
    assert_figure(m.n, 6, "n");
    assert_figure(m.mean, mean, "mean");
    assert_figure(m.m2, m2, "m2");
    assert_figure(m.m3, m3, "m3");
    /* of one variable: sqrt(n) m3/m2^1.5; of a mean of n: a root of n less */
    assert_figure(bis_verify_skewness(&m), m3 / (m2 * sqrt(m2)), "skewness");
    assert_true(bis_verify_skewness(&still) == 0 && still.mean == 2 && still.m2 == 0);
}

/* Variances and third moments of independent values add up, and those of -b are those of b but for a sign. */
static void the_skewness_beside_another_mean_is_that_of_added_moments(void **state)
{
    const double x[2][4] = {{1, 2, 4, 9}, {-3, 0, 0.5, 1}};
    double m2[2] = {0}, m3[2] = {0};
    bis_verify_moments m[2] = {{.n = 0}, {.n = 0}};
    for (int k = 0; k < 2; k++) {
        const double mean = (x[k][0] + x[k][1] + x[k][2] + x[k][3]) / 4;
        for (int i = 0; i < 4; i++) {
            bis_verify_add(&m[k], x[k][i]);
            m2[k] += pow(x[k][i] - mean, 2);
            m3[k] += pow(x[k][i] - mean, 3);
        }
    }
    assert_true(m3[0] > 0 && m3[1] < 0);
    assert_figure(bis_verify_skewness_beside(&m[0], &m[1], m2[0] / (m2[0] + m2[1])),
                  (m3[0] - m3[1]) / pow(m2[0] + m2[1], 1.5), "skewness of a difference");
}

/* 1 2 3: the mean 2 has the standard error 1/sqrt 3; t of 2 degrees of freedom has the tails 1 - |t|/sqrt(2 + t^2). */
static void a_mean_is_judged_by_what_is_beyond_its_slack(void **state)
{
    const double z = 0.75 * sqrt(3), p = 1 - z / sqrt(2 + z * z), no = (double)NAN, all = (double)INFINITY;
    const expected_test expected[] = {
        {"above", "z", z, 2, p, no, BIS_VERDICT_PASSED},
        {"below", "z", -z, 2, p, no, BIS_VERDICT_PASSED},
        {"within", "z; equal up to rounding and quadrature", 0, 0, 1, no, BIS_VERDICT_PASSED},
        {"no scatter", "z", all, 2, 0, no, BIS_VERDICT_PASSED},
        {"no scatter and right", "z; equal up to rounding and quadrature", 0, 0, 1, no, BIS_VERDICT_PASSED},
        {"not a number", "not a number", no, 0, 0, no, BIS_VERDICT_PASSED},
        {"not a number expected", "not a number", no, 0, 0, no, BIS_VERDICT_PASSED},
        {"without an error", "not a number", -2, 0, 0, no, BIS_VERDICT_PASSED},
        {"hardly a scatter", "z", -all, 1, 0, no, BIS_VERDICT_PASSED}};
    bis_verify v = {.seed = 1};
    bis_verify_moments m = {0}, still = {0}, sick = {0}, one = {0}, hardly = {0};
    for (int i = 1; i <= 3; i++) {
        bis_verify_add(&m, i);
        bis_verify_add(&still, 2);
        bis_verify_add(&sick, i == 2 ? no : i);
    }
    bis_verify_add(&one, 1);
    for (int i = 0; i < 2; i++) bis_verify_add(&hardly, i * 3e-162); /* its error is 0, its skewness 0 over 0 */
    bis_verify_mean(bis_verify_new(&v, "g", "above"), &m, 1, 0.25);
    bis_verify_mean(bis_verify_new(&v, "g", "below"), &m, 3, 0.25);
    bis_verify_mean(bis_verify_new(&v, "g", "within"), &m, 1, 1);
    bis_verify_mean(bis_verify_new(&v, "g", "no scatter"), &still, 1, 0.25);
    bis_verify_mean(bis_verify_new(&v, "g", "no scatter and right"), &still, 2, 0);
    bis_verify_mean(bis_verify_new(&v, "g", "not a number"), &sick, 2, 0);
    bis_verify_mean(bis_verify_new(&v, "g", "not a number expected"), &m, no, 0);
    bis_verify_mean(bis_verify_new(&v, "g", "without an error"), &one, 3, 0); /* one run has no scatter */
    bis_verify_mean(bis_verify_new(&v, "g", "hardly a scatter"), &hardly, 1, 0);
    for (int i = 0; i < 9; i++) assert_test(&v.tests[i], "g", &expected[i]);
    bis_verify_clear(&v);
}

/* Within 1/s the bound is the normal tail, by erfc, times exp(s z^3/3). It falls up to the z at which s z (1 + z^2/dof)
 * = 1 - 1/dof: with dof = infinity at 1/s, with s = 0.1 and dof = 11 at z = 4.05977, the root of 0.1 z + 0.1 z^3/11 =
 * 10/11. */
static void the_bound_of_a_skewed_mean_is_that_of_the_page(void **state)
{
    const double all = (double)INFINITY;
    for (double z = 0.5; z < 10; z += 0.5) {
        const double x = fmin(z, 10), p = fmin(1, erfc(x / sqrt(2)) * exp(0.1 * x * x * x / 3));
        assert_near(bis_verify_t(z, all, 0.1) / p, 1, 1e-9);
        assert_near(bis_verify_t(-z, all, -0.1) / p, 1, 1e-9);
    }
    assert_near(bis_verify_t(30, all, 0.1) / (erfc(10 / sqrt(2)) * exp(100 / 3.0)), 1, 1e-9);
    double root = 4;
    for (int i = 0; i < 50; i++)
        root = root - (0.1 * root + 0.1 * root * root * root / 11 - 10 / 11.0) / (0.1 + 0.3 * root * root / 11);
    assert_near(bis_verify_t(9, 11, 0.1), bis_stats_student_p(root, 11) * exp(0.1 * root * root * root / 3), 1e-12);
    assert_near(bis_verify_t(3, 11, 0), bis_stats_student_p(3, 11), 0);
}

/* ---- maps ---- */

/* A map of 4 x 2: the names, limits and degrees of freedom of all tests. 2^16 draws: each of the 6 pixels that are not
 * black is a cell and, 16 times, a group of its own. */
static void the_tests_of_a_map_have_limits_by_hand(void **state)
{
    const double eps = 0x1p-52, ulp = 0x1p-63, no = (double)NAN;
    const struct { const char *name; double limit; int dof; const char *note; } expected[] = {
        {"solid angles sum to 4 pi", 10 * eps, 0, "relative error of their sum"},
        {"solid angles are differences of cosines", 8 * eps + 4 * ulp, 0, "largest relative error of a row"},
        {"alias: density as defined", 22 * eps, 0, "largest relative error of q dO against w dO / sum"},
        {"alias: density integrates to 1", 22 * eps, 0, "error of the integral"},
        {"alias: table gives that density", 1e-8, 0, "largest relative error of a pixel's probability against q dO"},
        {"alias: draws by pixel", no, 5, "chi-square, 5 degrees of freedom"},
        {"alias: draws in 4 x 4 cells inside pixels", no, 95, "chi-square, 95 degrees of freedom"},
        {"cdf: density as defined", 22 * eps, 0, "largest relative error of q dO against w dO / sum"},
        {"cdf: density integrates to 1", 22 * eps, 0, "error of the integral"},
        {"cdf: table gives that density", 1e-8, 0, "largest relative error of a pixel's probability against q dO"},
        {"cdf: draws by pixel", no, 5, "chi-square, 5 degrees of freedom"},
        {"cdf: draws in 4 x 4 cells inside pixels", no, 95, "chi-square, 95 degrees of freedom"},
        {"curve: draws by pixel", no, 5, "chi-square, 5 degrees of freedom"},
        {"curve: draws in 4 x 4 cells inside pixels", no, 95, "chi-square, 95 degrees of freedom"},
    };
    bis_envmap em = map_new(4, 2);
    for (int i = 0; i < 8; i++) em.pixels[i] = (rgb){i == 1 || i == 3 ? 0 : 1 + (float)i, 1, 0};
    em.pixels[1] = em.pixels[3] = (rgb){0, 0, 0};
    bis_verify v = {.seed = 1};
    assert_int_equal(bis_verify_map(&v, &em, 0.15, 8, NULL), BIS_OK);
    assert_int_equal(v.n, 14);
    for (int i = 0; i < 14; i++) {
        const bis_verify_test *t = &v.tests[i];
        assert_string_equal(t->group, "map");
        assert_string_equal(t->name, expected[i].name);
        assert_string_equal(t->note, expected[i].note);
        assert_figure(t->threshold, expected[i].limit, t->name);
        assert_true(t->dof == expected[i].dof && isnan(t->p) == !isnan(expected[i].limit));
    }
    bis_verify_clear(&v);
    bis_envmap_clear(&em);
    bis_envmap dark = map_new(4, 2);
    bis_verify none = {.seed = 1};
    assert_int_equal(bis_verify_map(&none, &dark, 0.15, 8, NULL), BIS_OK);
    assert_int_equal(none.n, 3);
    const expected_test skipped = {"alias, cdf, curve", "the map gives no light, nothing can be drawn from it", no, 0,
        no, no, BIS_VERDICT_SKIPPED};
    assert_test(&none.tests[2], "map", &skipped);
    bis_verify_clear(&none);
    bis_envmap_clear(&dark);
}

/* Solid angles of 3 rows at the poles' circles 60 and 120 degrees: pi/2 1/2, 1, 1/2 a pixel. One row is wrong by a
 * thousandth. */
static void an_error_of_a_thousandth_is_told_as_such(void **state)
{
    bis_envmap em = map_new(4, 3);
    bis_verify v = {.seed = 1};
    assert_near(em.row_solid_angle[1], PI / 2, 1e-12);
    em.row_solid_angle[1] *= 1 - 1e-3;
    bis_verify_solid_angles(&v, &em);
    assert_near(v.tests[0].statistic, 5e-4, 1e-9); /* the row is half of the sphere */
    assert_near(v.tests[1].statistic, 1e-3, 1e-9);
    assert_figure(v.tests[0].threshold, 11 * 0x1p-52, "the sum's limit");
    assert_figure(v.tests[1].threshold, 8 * 0x1p-52 + 8 * 0x1p-63, "a row's limit"); /* 1 - cos 60 degrees = 1/2 */
    bis_verify_clear(&v);
    bis_envmap_clear(&em);
}

/* w by hand: 0.5 and 1 and 2 of one solid angle, and components smaller and larger than 0.01 sr. In 64 x 64 pixels, row
 * 32, a pixel is 0.00481 sr. */
static void the_definition_of_the_density_is_that_by_hand(void **state)
{
    enum { W = 64, H = 64, N = W * H };
    static double pmf[N];
    bool has_light;
    bis_envmap em = map_new(W, H);
    rgb *const row = em.pixels + 32 * W;
    row[3] = (rgb){1, 0, 0};                                        /* one pixel, level 0 */
    row[10] = row[11] = row[12] = (rgb){0, 1000, 0};                /* three, 0.0144 sr */
    const double one = em.row_solid_angle[32], factor = pow(one / 0.01, 0.5);
    assert_true(one < 0.005 && 3 * one > 0.01);
    assert_int_equal(bis_verify_definition(pmf, &has_light, &em, 0.5, 2, NULL), BIS_OK);
    assert_true(has_light);
    const double sum = factor + 3000;
    for (int i = 0; i < N; i++) {
        const double expected = i == 32 * W + 3 ? factor / sum : i >= 32 * W + 10 && i <= 32 * W + 12 ? 1000 / sum : 0;
        assert_near(pmf[i], expected, 1e-7 * expected); /* the factor is kept as a float */
    }
    assert_int_equal(bis_verify_definition(pmf, &has_light, &em, 0, 2, NULL), BIS_OK);
    assert_near(pmf[32 * W + 3], 1 / 3001.0, 1e-15);
    bis_envmap_clear(&em);
    bis_envmap dark = map_new(W, H);
    assert_int_equal(bis_verify_definition(pmf, &has_light, &dark, 0.5, 2, NULL), BIS_OK);
    assert_false(has_light);
    bis_envmap_clear(&dark);
}

/* Without memory for the regions: no density at all. */
static void a_definition_without_memory_is_none(void **state)
{
    double pmf[8], right[8];
    bool has_light;
    bis_envmap em = map_random(4, 2, 2, 0, 1);
    assert_int_equal(bis_verify_definition(right, &has_light, &em, 0.15, 8, NULL), BIS_OK);
    long n = 0;
    FOR_LACK(l) {
        LACK(l, bis_verify_definition(pmf, &has_light, &em, 0.15, 8, NULL));
        assert_int_equal(l.status == BIS_OK, l.over);
        n++;
    }
    assert_in_range(n, 4, 20); /* labels, levels, a queue at least */
    assert_memory_equal(pmf, right, sizeof pmf);
    bis_envmap_clear(&em);
}

static bool draw_nothing(const void *self, bis_rng *rng, bis_map_sample *s)
{
    *s = (bis_map_sample){.pixel = 0};
    return false;
}

static bool draw_outside(const void *self, bis_rng *rng, bis_map_sample *s)
{
    *s = (bis_map_sample){.pixel = 0, .w_local = {0, 0, -1}}; /* the other pole */
    return true;
}

/* How many draws, from the note: 256 a pixel, 2^16 at least, 2^20 until 8 a pixel are more. */
static void the_number_of_draws_follows_the_pixels(void **state)
{
    static const struct { int width, height; unsigned halvings, draws; } cases[] = {
        {1, 1, 0, 1 << 16}, {16, 16, 0, 1 << 16}, {32, 16, 0, 1 << 17}, {64, 32, 0, 1 << 19}, {128, 64, 0, 1 << 20},
        {128, 64, 3, 1 << 17}, {512, 512, 2, 1 << 19}, {1024, 512, 5, 1 << 17}, {1024, 1024, 5, 1 << 17},
        {40, 10, 0, 6 << 14},
        {16, 16, 2, 1 << 14}, {16, 16, 3, 1 << 14}, {32, 16, 5, 1 << 14}}; /* 2^14 are the fewest */
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bis_envmap em = map_new(cases[i].width, cases[i].height);
        double *pmf = bis_alloc(map_n(&em), sizeof *pmf);
        for (size_t k = 0; k < map_n(&em); k++) pmf[k] = 1 / (double)map_n(&em);
        for (int outside = 0; outside < 2; outside++) {
            const bis_verify_sampler sampler = {"s", outside ? draw_outside : draw_nothing, NULL};
            char note[120];
            bis_verify v = {.seed = 1, .halvings = cases[i].halvings};
            if (outside && cases[i].height == 1) continue;
            assert_int_equal(bis_verify_draws(&v, &sampler, &em, pmf, NULL), BIS_OK);
            snprintf(note, sizeof note, "chi-square; %u draws fell where nothing can be drawn", cases[i].draws);
            assert_string_equal(v.tests[0].name, "s: draws by pixel");
            assert_string_equal(v.tests[0].note, note);
            bis_verify_clear(&v);
        }
        bis_free(pmf);
        bis_envmap_clear(&em);
    }
}

/* ---- materials ---- */

static bool sample_nothing(const bis_bsdf *b, double u0, double u1, double u2, vec3 *wi)
{
    return false;
}

static double radiance_of_furnace;

static rgb Lo_furnace(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch)
{
    return rgb_from(radiance_of_furnace, 0, 0);
}

/* Where nothing is drawn the statistic is the number of draws. The furnace of Kd (0.5, 0.25, 0.75) under (1, 0.5, 0.25)
 * gives 4 0.5 + 2 0.125 + 0.1875 = 2.4375, good to 5e-5 of it: what is off by a little more is seen, by a little less
 * is not. */
static void a_materials_limits_draws_and_furnace_are_those_by_hand(void **state)
{
    bis_bsdf_model blind = bis_phong_model;
    bis_integrator forged = bis_brdf;
    bis_settings s = bis_settings_default(&bis_brdf);
    blind.sample = sample_nothing;
    forged.Lo = Lo_furnace;
    s.integrator = &forged;
    bis_material m = bis_phong((rgb){0.5f, 0.25f, 0.75f}, (rgb){0, 0, 0}, 0);
    m.model = &blind;
    for (int k = 0; k < 4; k++) {
        static const double off[] = {4e-5, 6e-5, -4e-5, -6e-5};
        bis_verify v = {.seed = 1, .halvings = 2};
        radiance_of_furnace = 2.4375 / 4 * (1 + off[k]);
        assert_int_equal(bis_verify_material(&v, &(bis_verify_lobe){"m", &m, 45}, &s, 1, NULL), BIS_OK);
        assert_int_equal(v.n, 3);
        assert_string_equal(v.tests[0].name, "m: density integrates to 1");
        assert_string_equal(v.tests[0].note, "error of the integral");
        assert_figure(v.tests[0].threshold, 5e-5, "the limit of n = 0");
        assert_true(v.tests[0].verdict == BIS_VERDICT_PASSED);
        assert_string_equal(v.tests[1].name, "m: draws by its density");
        assert_near(v.tests[1].statistic, 1 << 15, 1e-6);
        assert_string_equal(v.tests[2].name, "m: furnace, brdf");
        assert_string_equal(v.tests[2].note, k % 2 ? "z" : "z; equal up to rounding and quadrature");
        assert_true(k % 2 ? v.tests[2].p == 0 && v.tests[2].dof == 511 && (v.tests[2].statistic > 0) == (k == 1)
                          : v.tests[2].p == 1);
        for (int i = 0; i < 3; i++) assert_string_equal(v.tests[i].group, "materials");
        bis_verify_clear(&v);
    }
    const struct { bis_material m; double limit; } limits[] = {
        {bis_phong(grey(0.5), grey(0.4), 1e4), 5e-5 + 1e-5}, {bis_microfacet(grey(0.5), grey(0.4), sqrt(0.01)),
         5e-5 + 1e-6}};
    for (int i = 0; i < 2; i++) {
        bis_verify v = {.seed = 1, .halvings = 4};
        assert_int_equal(bis_verify_material(&v, &(bis_verify_lobe){"m", &limits[i].m, 45}, &s, 0, NULL), BIS_OK);
        assert_int_equal(v.n, 2);
        assert_figure(v.tests[0].threshold, limits[i].limit, "the limit of a lobe");
        bis_verify_clear(&v);
    }
}

/* ---- the view ---- */

/* 2^11 draws over 8 candidates and a ray for 8: 128 runs. */
static void too_few_accepted_candidates_are_counted(void **state)
{
    enum { RUNS = 128 };
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0.15, false);
    bis_settings s = bis_settings_default(&bis_rejection);
    bis_verify v = {.seed = 1, .halvings = 10};
    bis_counters counters = {0};
    rgb estimate[RUNS];
    char note[120];
    bool tested;
    lit l;
    lit_init(&l, light, bis_phong(grey(0.5), grey(0.2), 5), (vec3){0, 0, 1}, 40, LIT_OPEN);
    s.candidates = 8;
    s.shadowrays = 1;
    assert_int_equal(bis_verify_point(&v, &(bis_verify_place){"p", &l.pt, BIS_SAMPLER_RANDOM}, &s, 1, &tested, NULL),
        BIS_OK);
    const uint64_t seed = bis_verify_seed(&v, "p: rejection");
    assert_int_equal(bis_verify_runs(estimate,
                         &(bis_verify_job){&l.pt, &s, BIS_SAMPLER_RANDOM, RUNS, seed, NULL}, &counters, NULL),
        BIS_OK);
    assert_true(tested && v.n == 1 && counters.accepted > 50 && counters.accepted < 1000);
    snprintf(
        note, sizeof note, "only %u of its candidates were accepted: too few to judge", (unsigned)counters.accepted);
    const expected_test expected = {
        "p: rejection", note, (double)NAN, 0, (double)NAN, (double)NAN, BIS_VERDICT_SKIPPED};
    assert_test(&v.tests[0], "view", &expected);
    assert_int_equal(counters.shadow_rays, RUNS);
    bis_verify_clear(&v);
    bis_light_free(light);
}

/* Two seeds, which were searched for: the runs by one accept 999 candidates, those by the other 1000. */
static void a_thousand_accepted_candidates_are_enough(void **state)
{
    enum { RUNS = 228 };
    static const struct { unsigned seed; uint64_t accepted; } cases[] = {{423, 999}, {67, 1000}};
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0.15, false);
    bis_settings s = bis_settings_default(&bis_rejection);
    lit l;
    lit_init(&l, light, bis_phong(grey(0.5), grey(0.2), 5), (vec3){0, 0, 1}, 40, LIT_OPEN);
    s.candidates = 10;
    s.shadowrays = 1;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bis_verify v = {.seed = cases[i].seed, .halvings = 9};
        const bis_verify_place place = {"p", &l.pt, BIS_SAMPLER_RANDOM};
        const bis_verify_job job = {&l.pt, &s, BIS_SAMPLER_RANDOM, RUNS, bis_verify_seed(&v, "p: rejection"), NULL};
        bis_counters counters = {0};
        rgb estimate[RUNS];
        bool tested;
        assert_int_equal(bis_verify_point(&v, &place, &s, 1, &tested, NULL), BIS_OK);
        assert_int_equal(bis_verify_runs(estimate, &job, &counters, NULL), BIS_OK);
        assert_int_equal(counters.accepted, cases[i].accepted);
        assert_int_equal(v.tests[0].verdict == BIS_VERDICT_SKIPPED, cases[i].accepted < 1000);
        bis_verify_clear(&v);
    }
    bis_light_free(light);
}

static atomic_uint n_estimates;

static rgb Lo_counted(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch)
{
    n_estimates++;
    return rgb_from(bis_stream_random(stream), 1, 1);
}

/* The message of the allocation for the runs says how many there are to be. */
static unsigned runs_that_find_no_room(const bis_point *pt, const bis_settings *s, unsigned halvings)
{
    for (long k = 1;; k++) {
        bis_verify v = {.seed = 1, .halvings = halvings};
        bis_diag diag = {0};
        bool tested;
        unsigned n = 0;
        bis_mem_fail_at(k);
        const bis_status status = bis_verify_point(&v, &(bis_verify_place){"p", pt, BIS_SAMPLER_RANDOM},
            s, 1, &tested, &diag);
        bis_mem_fail_at(0);
        assert_int_equal(status, BIS_NOMEM); /* so k comes to the runs before all has room */
        if (diag.n_errors) sscanf(diag.messages[0].text, "error: no memory for %u runs", &n);
        bis_diag_clear(&diag);
        bis_verify_clear(&v);
        if (n) return n;
    }
}

/* As many runs as 2^21 candidates and eighths of rays are, 64 to 2^14; `exact`: 2^18 patches, 2 to 2^12 runs. The map
 * has 128 x 64 patches; of one with 8 patches 2^18 would be 2^15 runs. A copy that counts reads no parameter of the
 * table, because the table knows integrators by their address: it is taken for one with samples. The product, whose
 * runs are dear, has 2^8, at least 64. */
static void the_number_of_runs_follows_the_cost(void **state)
{
    static const struct { const bis_integrator *of; uint32_t samples, M, N; unsigned halvings, runs; } cases[] = {
        {&bis_em, 16, 1, 1, 0, 1 << 14}, {&bis_em, 64, 1, 1, 0, 1 << 12}, {&bis_brdf, 64, 1, 1, 2, 1 << 10},
        {&bis_mis, 1 << 12, 1, 1, 0, 64},
        {&bis_em, 1 << 13, 1, 1, 0, 64}, {&bis_sir, 1, 800, 15, 0, 2280}, {&bis_rejection, 1, 1000, 3, 1, 1 << 10},
        {&bis_unoccluded, 1, 240, 2, 0, 1 << 13},
        {&bis_sir, 1, 100000, 3, 0, 64}, {&bis_sir, 1, 2, 1, 0, 1 << 14}, {&bis_exact, 1, 1, 1, 0, 32},
        {&bis_exact, 1, 1, 1, 3, 4}, {&bis_exact, 1, 1, 1, 6, 2}};
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0.15, false);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bis_integrator counted = *cases[i].of;
        bis_settings s = bis_settings_default(cases[i].of);
        bis_verify v = {.seed = 1, .halvings = cases[i].halvings};
        bool tested;
        lit l;
        s.samples = cases[i].samples;
        s.candidates = cases[i].M;
        s.shadowrays = cases[i].N;
        lit_init(&l, light, bis_phong(grey(0.5), grey(0), 1), (vec3){0, 0, 1}, 40, LIT_OPEN);
        const unsigned n = runs_that_find_no_room(&l.pt, &s, cases[i].halvings);
        if (n != cases[i].runs) fail_msg("%s, case %zu: room for %u runs", counted.name, i, n);
        if (!bis_parameter_of(cases[i].of, "samples")) continue;
        counted.Lo = Lo_counted;
        s.integrator = &counted;
        n_estimates = 0;
        assert_int_equal(
            bis_verify_point(&v, &(bis_verify_place){"p", &l.pt, BIS_SAMPLER_RANDOM}, &s, 1, &tested, NULL), BIS_OK);
        assert_true(tested);
        if (n_estimates != cases[i].runs) fail_msg("%s, case %zu: %u runs", counted.name, i, (unsigned)n_estimates);
        bis_verify_clear(&v);
    }
    bis_settings product = bis_settings_default(&bis_sir);
    lit l;
    product.proposal = BIS_PROPOSAL_PRODUCT;
    lit_init(&l, light, bis_phong(grey(0.5), grey(0), 1), (vec3){0, 0, 1}, 40, LIT_OPEN);
    assert_int_equal(runs_that_find_no_room(&l.pt, &product, 0), 256);
    assert_int_equal(runs_that_find_no_room(&l.pt, &product, 1), 128);
    assert_int_equal(runs_that_find_no_room(&l.pt, &product, 9), 64);
    bis_light_free(light);
    const bis_settings exact = bis_settings_default(&bis_exact);
    tiny few;
    tiny_init(&few);
    lit_init(&l, few.light, bis_phong(grey(0.5), grey(0), 1), (vec3){0, 0, 1}, 40, LIT_OPEN);
    assert_int_equal(runs_that_find_no_room(&l.pt, &exact, 0), 1 << 12);
    assert_int_equal(runs_that_find_no_room(&l.pt, &exact, 4), 1 << 11);
    tiny_clear(&few);
}

/* One sample in a run, or two: a test's figures are its own, alone and in a list, because what is known of a sample
 * beforehand is that of its own density. Of one sample of em it is known that it is rare and bright here. */
static void a_sample_is_judged_by_its_own_density(void **state)
{
    const bis_integrator *const integrators[3] = {&bis_em, &bis_brdf, &bis_sir};
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0.15, false);
    const bis_material m = bis_phong((rgb){0.25f, 0.5f, 0.125f}, (rgb){0.5f, 0.25f, 0.25f}, 30);
    bis_settings list[3];
    bis_verify all = {.seed = 1};
    bool tested;
    lit l;
    lit_init(&l, light, m, (vec3){0, 0, 1}, 40, LIT_OPEN);
    for (int i = 0; i < 3; i++) {
        list[i] = bis_settings_default(integrators[i]);
        list[i].samples = list[i].candidates = i == 0 ? 1 : 2;
        list[i].shadowrays = 1;
    }
    assert_int_equal(
        bis_verify_point(&all, &(bis_verify_place){"p", &l.pt, BIS_SAMPLER_RANDOM}, list, 3, &tested, NULL), BIS_OK);
    assert_int_equal(all.n, 3);
    for (int i = 0; i < 3; i++) {
        bis_verify one = {.seed = 1};
        assert_int_equal(
            bis_verify_point(&one, &(bis_verify_place){"p", &l.pt, BIS_SAMPLER_RANDOM}, &list[i], 1, &tested, NULL),
            BIS_OK);
        const bis_verify_test *const a = &all.tests[i], *const b = &one.tests[0];
        assert_string_equal(a->name, b->name);
        assert_string_equal(a->note, b->note);
        assert_true(a->statistic == b->statistic && a->p == b->p && a->dof == b->dof);
        assert_int_equal(strstr(a->note, "rare and bright") != NULL, i == 0);
        bis_verify_clear(&one);
    }
    bis_verify_clear(&all);
    bis_light_free(light);
}

/* ---- accelerators ---- */

/* What the rays were, and how many answers they got. One thread asks, so they come in order. */
enum { MOST_RAYS = 8192 };
typedef struct witness {
    bis_accel accel;
    const bis_accel *right;
    double far;          /* a hit is told at so many times its distance */
    ray rays[MOST_RAYS]; /* that start beside the surface */
    bool met[MOST_RAYS];
    int n, n_shadow;
} witness;

/* The surface is in the plane z = 0, and shadow rays start within 1e-5 of it. */
static bool witness_intersect(const bis_accel *a, const ray *r, bis_hit *hit)
{
    witness *w = (witness *)(uintptr_t)a;
    const bool met = bis_accel_intersect(w->right, r, hit);
    if (met) hit->t = (float)((double)hit->t * w->far);
    if (fabs((double)r->o.z) < 1e-5) {
        w->n_shadow++;
    } else {
        assert_true(w->n < MOST_RAYS);
        w->rays[w->n] = *r;
        w->met[w->n++] = met;
    }
    return met;
}

static bool witness_occluded(const bis_accel *a, const ray *r)
{
    return bis_accel_occluded(((const witness *)a)->right, r);
}

static const bis_accel_ops witnessed = {
    .name = "witness", .intersect = witness_intersect, .occluded = witness_occluded};

/* Where the line of r crosses z = 0; both triangles lie there. */
static bool crosses(const ray *r, double x0, double x1, double y0, double y1, double slack)
{
    const double t = -(double)r->o.z / (double)r->d.z, x = (double)r->o.x + t * (double)r->d.x,
                 y = (double)r->o.y + t * (double)r->d.y;
    return t > 0 && x >= x0 - slack && x <= x1 + slack && y >= y0 - slack && y <= y1 + slack;
}

static int met_among(const witness *w, int n)
{
    int met = 0;
    for (int i = 0; i < n && i < w->n; i++) met += w->met[i];
    return met;
}

static void assert_note(const bis_verify_test *t, int rays, int surfaces, int searched, int grazing, const char *name)
{
    char note[120];
    snprintf(note, sizeof note, "wrong of %d rays and %d from surfaces, %d of them searched; %d more graze an edge",
        rays, surfaces, searched, grazing);
    assert_string_equal(t->note, note);
    assert_string_equal(t->name, name);
    assert_string_equal(t->group, "accelerators");
    assert_true(t->threshold == 0 && t->dof == 0);
}

/* n rays: where they begin, and how many go into the small triangle. */
static void assert_rays_fill_the_scene(const witness *a, int n)
{
    double lo[3] = {9, 9, 9}, hi[3] = {-9, -9, -9}, sum[3] = {0};
    const double margin = 0.1 * sqrt(5), least[3] = {-margin, -margin, -margin},
                 most[3] = {2 + margin, 1 + margin, margin};
    int into_small = 0;
    for (int i = 0; i < n; i++) {
        const double o[3] = {(double)a->rays[i].o.x, (double)a->rays[i].o.y, (double)a->rays[i].o.z};
        for (int c = 0; c < 3; c++) {
            lo[c] = fmin(lo[c], o[c]);
            hi[c] = fmax(hi[c], o[c]);
            sum[c] += o[c] / n;
        }
        assert_near((double)length(a->rays[i].d), 1, 1e-6);
        if (fabs(o[2]) > 0.01 && !crosses(&a->rays[i], 0, 2, 0, 1, 1e-3)) fail_msg("ray %d passes the scene", i);
        into_small += crosses(&a->rays[i], 1.98, 2, 0.98, 1, 1e-4);
    }
    for (int c = 0; c < 3;
        c++) { /* 6000 uniform numbers: an end is missed by a thousandth of the range, the mean by 5 standard errors */
        const double range = most[c] - least[c];
        assert_true(lo[c] >= least[c] - 1e-6 && lo[c] < least[c] + 3e-3 * range && hi[c] <= most[c] + 1e-6 &&
                    hi[c] > most[c] - 3e-3 * range);
        assert_near(sum[c], (least[c] + most[c]) / 2, 5 * range / sqrt(12.0 * n));
    }
    assert_near(
        (double)into_small / n, 0.25, 5 * sqrt(0.25 * 0.75 / n) + 2e-3); /* half of the rays, half of the triangles */
}

/* A triangle of 2 x 1, and one of 0.02 x 0.02 in its corner beyond: a box of 2 x 1 x 0 with a margin of 0.1 sqrt 5. */
static void the_rays_are_where_the_page_says_and_are_counted(void **state)
{
    enum { N = 6000 };
    static witness a, b;
    const bis_xform here = bis_xform_identity();
    const float corner[6][2] = {{0, 0}, {2, 0}, {0, 1}, {2, 1}, {1.98f, 1}, {2, 0.98f}};
    bis_geometry g = {0};
    bis_accel *grid;
    bis_mesh m = new_mesh(6, 2);
    for (uint32_t i = 0; i < 6; i++) {
        m.p[i] = (vec3){corner[i][0], corner[i][1], 0};
        m.index[i] = i;
    }
    assert_int_equal(bis_geometry_add_mesh(&g, &m, &here, 0, NULL), BIS_OK);
    bis_mesh_clear(&m);
    assert_int_equal(bis_accel_new(&grid, &g, &(bis_accel_options){.kind = BIS_ACCEL_GRID}, NULL), BIS_OK);
    omp_set_num_threads(1);

    /* one backend: 2^24 tests of two triangles are more than all rays; 2^24/2/2^20 = 8 of them with 20 halvings */
    for (int halvings = 0; halvings <= 20; halvings += 20) {
        bis_verify v = {.seed = 4, .halvings = (unsigned)halvings};
        a = (witness){.accel = {&witnessed, &g}, .right = grid, .far = 1};
        bis_verify_backends(&v, &a.accel, NULL, N);
        assert_int_equal(a.n, N);
        const int hits = met_among(&a, N), searched = halvings ? 8 + met_among(&a, 8) : N + hits;
        assert_int_equal(a.n_shadow, hits);
        assert_note(&v.tests[0], N, hits, searched, 0, "witness sees what a search sees");
        assert_true(v.tests[0].statistic == 0);
        bis_verify_clear(&v);
    }

    assert_rays_fill_the_scene(&a, N);

    /* two: 2^21/2/2^18 = 4 are searched, and all that differ. Farther by 1.2e-7 is rounding, by a half is wrong. */
    for (int wrong = 0; wrong < 3; wrong++) {
        bis_verify v = {.seed = 4, .halvings = 18};
        a = (witness){.accel = {&witnessed, &g}, .right = grid, .far = 1};
        b = (witness){.accel = {&witnessed, &g}, .right = grid, .far = wrong == 2 ? 1.5 : wrong == 1 ? 1 + 1.2e-7 : 1};
        bis_verify_backends(&v, &a.accel, &b.accel, N);
        const int hits = met_among(&a, N), first = 4 + met_among(&a, 4);
        int differ = 0, new = 0;
        for (int i = 0; i < N; i++) {
            bis_hit hit;
            if (!a.met[i]) continue;
            assert_true(bis_accel_intersect(grid, &a.rays[i], &hit));
            const bool other = (float)((double)hit.t * b.far) != hit.t;
            differ += other;
            new += other && i >= 4;
        }
        assert_true(b.n == N && b.n_shadow == hits && (differ > 0) == (wrong > 0));
        assert_note(&v.tests[0], N, hits, first + new, wrong == 1 ? differ : 0, "witness and witness see the same");
        assert_true(v.tests[0].statistic == (wrong == 2 ? differ : 0));
        bis_verify_clear(&v);
    }
    bis_accel_free(grid);
    bis_geometry_clear(&g);
}

/* ---- the search ---- */

typedef struct sighting {
    vec3 o, d;
    double t;          /* the right answer; infinite: none is met */
    bool doubtful;     /* either answer is right */
} sighting;

/* Right: that there is a hit at t, with `occluded`; wrong: another distance, one answer without the other, a miss. */
static void assert_sightings(const bis_geometry *g, uint32_t left, const sighting *s, size_t n)
{
    const double none = (double)INFINITY;
    for (size_t i = 0; i < n; i++) {
        const ray r = {s[i].o, s[i].d, INFINITY};
        const bool meets = isfinite(s[i].t), either = s[i].doubtful;
        const bis_verify_answer answers[6] = {{s[i].t, meets}, {s[i].t, !meets}, {none, false}, {none, true},
            {meets ? s[i].t * 1.001 : 1, true}, {meets ? s[i].t * 0.999 : 2, true}};
        const bool expected[6] = {true, either, !meets || either, either, false, false};
        for (int k = 0; k < 6; k++) {
            bool right[1];
            bis_verify_search(right, g, &r, left, &answers[k], 1);
            if (right[0] != expected[k])
                fail_msg("ray %zu: answer %d is called %s", i, k, right[0] ? "right" : "wrong");
        }
    }
}

/* A disk of radius 2 at height 0.5 and a sphere of radius 0.5, both twice as large and moved: the disk is at x = 10, z
 * = 1 and 4 wide, the sphere about (0, 0, 0). */
static void a_search_knows_disks_and_spheres(void **state)
{
    const double none = (double)INFINITY;
    const bis_xform away = bis_xform_translate(10, 0, 0), twice = bis_xform_scale(2, 2, 2);
    const bis_quadric disk = {
        .kind = BIS_DISK, .radius = 2, .height = 0.5, .to_world = bis_xform_compose(&away, &twice)};
    const bis_quadric sphere = {.kind = BIS_SPHERE, .radius = 0.5, .to_world = twice};
    bis_geometry g = {0};
    assert_int_equal(bis_geometry_add_quadric(&g, &disk, NULL), BIS_OK);
    assert_int_equal(bis_geometry_add_quadric(&g, &sphere, NULL), BIS_OK);
    const sighting s[] = {{{10, 0, 4}, {0, 0, -1}, 3, false}, {{13.5f, 0, 4}, {0, 0, -1}, 3, false},
        {{14.5f, 0, 4}, {0, 0, -1}, none, false}, {{10, 4, 4}, {0, 0, -1}, 3, true},
        {{10, 4.001f, 4}, {0, 0, -1}, none, false}, {{10, 3.999f, 4}, {0, 0, -1}, 3, false},
        {{10, 0, 4}, {0, 0, 1}, none, false}, {{10, 0, -2}, {0, 0, 1}, 3, false},
        {{10, 0, 0.5f}, {0, 0, -1}, none, false}, {{10, 0, 1}, {1, 0, 0}, none, false},
        {{0, 0, 4}, {0, 0, -1}, 3, false}, {{0, 0, 4}, {0, 0, 1}, none, false}, {{0, 0, 0}, {0, 0, 1}, 1, false},
        {{0.6f, 0, 5}, {0, 0, -1}, 4.2, false}, {{0, 0.6f, 0}, {0, 0, -1}, 0.8, false},
        {{1, 0, 4}, {0, 0, -1}, 4, true}, {{1.001f, 0, 4}, {0, 0, -1}, none, false},
        {{0, 0, -0.5f}, {0, 0, -1}, 0.5, false},
        /* through the sphere and then to the disk's side: the nearer one */
        {{-4, 0, 0}, {1, 0, 0}, 3, false},
        /* aslant, to the disk at (10, 3), (13, 0), (7, 0), (10, -3), (12.8, 2.8), beside it; to the ball at (0.6, 0.8,
           0) */
        {{10, 9, 7}, {0, -1, -1}, 6, false}, {{19, 0, 7}, {-1, 0, -1}, 6, false}, {{1, 0, 7}, {1, 0, -1}, 6, false},
        {{10, -9, -5}, {0, 1, 1}, 6, false}, {{15.8f, 5.8f, 4}, {-1, -1, -1}, 3, false},
        {{15.9f, 5.9f, 4}, {-1, -1, -1}, none, false}, {{4.2f, -5.8f, 4}, {1, 1, -1}, 3, false},
        {{1.6f, 2.8f, 2}, {-1, -2, -2}, 1, false}, {{-1.6f, 2.8f, -2}, {1, -2, 2}, 1, false},
        {{1.6f, 2.8f, 2}, {-1, -2, 2}, none, false}, {{1.6f, 2.8f, 2}, {1, 2, 2}, none, false}};
    assert_sightings(&g, BIS_NO_PRIM, s, sizeof s / sizeof *s);
    /* the disk is left: it is not met again, the sphere is */
    const sighting from_disk[] = {{{10, 0, 4}, {0, 0, -1}, none, false}, {{0, 0, 4}, {0, 0, -1}, 3, false}};
    assert_sightings(&g, 0, from_disk, 2);
    bis_geometry_clear(&g);
}

/* A disk of radius 2 at height 0.5, turned by 90 degrees about x, then by 90 about z: (x, y, z) to (x, -z, y) to (z, x,
 * y), so it stands at x = 0.5 with y and z up to 2. A ball stretched to the half axes 1, 2, 3 about (0, 0, 20). */
static void a_search_knows_what_is_turned_and_stretched(void **state)
{
    const double none = (double)INFINITY;
    const bis_xform about_x = bis_xform_rotate(90, 1, 0, 0), about_z = bis_xform_rotate(90, 0, 0, 1);
    const bis_xform up = bis_xform_translate(0, 0, 20), stretch = bis_xform_scale(1, 2, 3);
    const bis_quadric disk = {.kind = BIS_DISK, .radius = 2, .height = 0.5,
                              .to_world = bis_xform_compose(&about_z, &about_x)};
    const bis_quadric ball = {.kind = BIS_SPHERE, .radius = 1, .to_world = bis_xform_compose(&up, &stretch)};
    bis_geometry g = {0};
    assert_int_equal(bis_geometry_add_quadric(&g, &disk, NULL), BIS_OK);
    assert_int_equal(bis_geometry_add_quadric(&g, &ball, NULL), BIS_OK);
    const sighting s[] = {
        {{4, 0, 0}, {-1, 0, 0}, 3.5, false}, {{4, 1.5f, 1}, {-1, 0, 0}, 3.5, false},
        {{4, 1.5f, 1.5f}, {-1, 0, 0}, none, false},
        {{4, -1.5f, 1}, {-1, 0, 0}, 3.5, false}, {{-3, 0, -1.9f}, {1, 0, 0}, 3.5, false},
        {{-3, 0, 0}, {-1, 0, 0}, none, false},
        {{3, 1, 0}, {-1, -1, 0}, 2.5, false}, {{3, 2, 0}, {-1, 1, 0}, none, false},
        {{0, 0, 30}, {0, 0, -1}, 7, false}, {{0, 9, 20}, {0, -1, 0}, 7, false}, {{9, 0, 20}, {-1, 0, 0}, 8, false},
        {{0.6f, 9, 20}, {0, -1, 0}, 7.4, false}, {{0, 1.2f, 30}, {0, 0, -1}, 7.6, false},
        {{9, 0, 21.8f}, {-1, 0, 0}, 8.2, false},
        {{0.6f, 1.61f, 30}, {0, 0, -1}, none, false}, {{0, 0, 20}, {0, 0, 1}, 3, false}};
    assert_sightings(&g, BIS_NO_PRIM, s, sizeof s / sizeof *s);
    bis_geometry_clear(&g);
}

/* Two triangles, one behind the other, of 2 x 2 at z = 0 and z = -1; what is met is the nearer one. */
static void a_search_finds_the_nearest_triangle(void **state)
{
    const double none = (double)INFINITY;
    const bis_xform here = bis_xform_identity();
    const float corner[6][3] = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, -1}, {2, 0, -1}, {0, 2, -1}};
    bis_geometry g = {0};
    bis_mesh m = new_mesh(6, 2);
    for (uint32_t i = 0; i < 6; i++) {
        m.p[i] = (vec3){corner[i][0], corner[i][1], corner[i][2]};
        m.index[i] = i;
    }
    assert_int_equal(bis_geometry_add_mesh(&g, &m, &here, 0, NULL), BIS_OK);
    bis_mesh_clear(&m);
    const sighting s[] = {{{0.5f, 0.5f, 2}, {0, 0, -1}, 2, false}, {{0.5f, 0.5f, -0.5f}, {0, 0, -1}, 0.5, false},
        {{0.5f, 0.5f, -0.5f}, {0, 0, 1}, 0.5, false}, {{0.5f, 0.5f, 1}, {0, 0, 1}, none, false},
        {{1.5f, 1.5f, 1}, {0, 0, -1}, none, false}, {{-0.5f, 0.5f, 1}, {0, 0, -1}, none, false},
        {{0.5f, -0.5f, 1}, {0, 0, -1}, none, false}};
    assert_sightings(&g, BIS_NO_PRIM, s, sizeof s / sizeof *s);
    /* the first is left: the second is met through it */
    const sighting left[] = {{{0.5f, 0.5f, 2}, {0, 0, -1}, 3, false}, {{0.5f, 0.5f, -2}, {0, 0, 1}, 1, false}};
    assert_sightings(&g, 0, left, 2);
    bis_geometry_clear(&g);
}

static void add_triangle(bis_geometry *g, const vec3 p[3])
{
    const bis_xform here = bis_xform_identity();
    bis_mesh m = new_mesh(3, 1);
    for (uint32_t i = 0; i < 3; i++) m.p[i] = p[i], m.index[i] = i;
    assert_int_equal(bis_geometry_add_mesh(g, &m, &here, 0, NULL), BIS_OK);
    bis_mesh_clear(&m);
}

static bool is_right(const bis_geometry *g, const ray *r, double t)
{
    bool right;
    bis_verify_search(&right, g, r, BIS_NO_PRIM, &(bis_verify_answer){t, isfinite(t)}, 1);
    return right;
}

/* A ball of radius 1 about (100, 0, 0), and rays that start on it: the root at 0 is in doubt, that at 2 is not. */
static void a_ray_that_starts_on_a_ball_meets_its_far_side(void **state)
{
    const bis_quadric ball = {.kind = BIS_SPHERE, .radius = 1, .to_world = bis_xform_translate(100, 0, 0)};
    bis_geometry g = {0};
    assert_int_equal(bis_geometry_add_quadric(&g, &ball, NULL), BIS_OK);
    const sighting s[] = {{{101, 0, 0}, {-1, 0, 0}, 2, false}, {{99, 0, 0}, {1, 0, 0}, 2, false},
                          {{100, 1, 0}, {0, -1, 0}, 2, false}};
    assert_sightings(&g, BIS_NO_PRIM, s, sizeof s / sizeof *s);
    bis_geometry_clear(&g);
}

/* With u = 2^-24. e = (4 0 0), f = (0 4 0), n = (0 0 16), the largest coordinates 3, 3, 4, t = 4; only along z there is
 * more than 0: T = 64 errs by u (4 x 16 x 4 + 13 x 4 x 16) = 1088 u, D.n = 16 by u (2 x 3 x 4 + 2 x 3 x 4 + 8 x 16) =
 * 176 u; t by 1088/16 u + 4 (176/16 + 4) u = 128 u. All weights together are 32: one of 8 delta, where the ray passes
 * the edge at delta, is on the wrong side as far as 2 u 32. */
static void a_distance_may_err_by_what_was_worked_out(void **state)
{
    const double u = 0x1p-24, none = (double)INFINITY;
    const vec3 p[3] = {{-1, -1, 4}, {3, -1, 4}, {-1, 3, 4}};
    bis_geometry g = {0};
    add_triangle(&g, p);
    const ray r = {{0, 0, 0}, {0, 0, 1}, INFINITY};
    for (int sign = -1; sign <= 1; sign += 2) {
        assert_true(is_right(&g, &r, 4 + sign * 127.9 * u));
        assert_false(is_right(&g, &r, 4 + sign * 128.1 * u));
    }
    static const struct {
        double delta;
        bool met, missed;
    } edges[] = {{0x1p-24, true, false}, {0, true, true}, {-2 * 0x1p-24, true, true}, {-8 * 0x1p-24, true, true},
                 {-10 * 0x1p-24, false, true}};
    for (size_t i = 0; i < sizeof edges / sizeof *edges; i++) {
        const ray at = {{(float)(-1 + edges[i].delta), 0, 0}, {0, 0, 1}, INFINITY};
        assert_int_equal(is_right(&g, &at, 4), edges[i].met);
        assert_int_equal(is_right(&g, &at, none), edges[i].missed);
    }
    bis_geometry_clear(&g);
}

/* Quadrics of radius 1 are in doubt by 2^-40 of all sizes. A disk from (1, 0, 1): sizes 1 + 1 + 1, twice 3 x 2^-40 at
 * its rim, where the ray arrives delta beyond it. A ball from (1, 0, 4): sizes 1 + 1 + 4; R^2 less the square of the
 * distance is -8 delta, in doubt to 4 x 6 x 6 x 2^-40. Beside the disk's plane its height is in doubt to 2^-50; a
 * distance to 2^-22 of it. */
static void a_quadrics_edge_is_in_doubt_by_what_was_worked_out(void **state)
{
    const double none = (double)INFINITY, small = 0x1p-40, smaller = 0x1p-50;
    static const double beyond[4] = {-1.02, -0.98, 0.98, 1.02}; /* of the doubt: met, in doubt, in doubt, missed */
    for (int ball = 0; ball < 2; ball++) {
        const bis_quadric q = {.kind = ball ? BIS_SPHERE : BIS_DISK, .radius = 1, .to_world = bis_xform_identity()};
        bis_geometry g = {0};
        assert_int_equal(bis_geometry_add_quadric(&g, &q, NULL), BIS_OK);
        for (int i = 0; i < 4; i++) {
            const float delta = (float)(beyond[i] * (ball ? 18 : 6) * small);
            const ray r = {{1, 0, ball ? 4 : 1}, {delta, 0, -1}, INFINITY};
            assert_int_equal(is_right(&g, &r, ball ? 4 : 1), i < 3);
            assert_int_equal(is_right(&g, &r, none), i > 0);
        }
        for (int sign = -1; sign <= 1; sign += 2) {
            const ray r = {{0, 0, 3}, {0, 0, -1}, INFINITY};
            const double t = ball ? 2 : 3;
            assert_true(is_right(&g, &r, t * (1 + sign * 0.99 * 0x1p-22)));
            assert_false(is_right(&g, &r, t * (1 + sign * 1.01 * 0x1p-22)));
        }
        for (int i = 0; i < 2 && !ball; i++) {
            const ray away = {{0, 0, (float)(i ? 1.02 * smaller : 0.98 * smaller)}, {0, 0, 1}, INFINITY};
            bool right;
            bis_verify_search(&right, &g, &away, BIS_NO_PRIM, &(bis_verify_answer){none, true}, 1);
            assert_int_equal(right, i == 0); /* occluded: where it may be met */
            assert_true(is_right(&g, &away, none));
        }
        bis_geometry_clear(&g);
    }
}

/* How far beyond t, and how far before it, an answer is still right. */
static void tolerance_of(double error[2], const vec3 p[3], const ray *r, double t)
{
    bis_geometry g = {0};
    add_triangle(&g, p);
    assert_true(is_right(&g, r, t));
    for (int k = 0; k < 2; k++) {
        double lo = 0, hi = 0.01 * t;
        assert_false(is_right(&g, r, k ? t - hi : t + hi));
        for (int i = 0; i < 60; i++) {
            const double middle = (lo + hi) / 2;
            *(is_right(&g, r, k ? t - middle : t + middle) ? &lo : &hi) = middle;
        }
        error[k] = lo;
    }
    bis_geometry_clear(&g);
}

static vec3 turned(vec3 v, int k) { return k == 0 ? v : turned((vec3){v.y, v.z, v.x}, k - 1); }

/* The second and the third corner change places, and x, y, z are named anew: the triangle is the same, and so is what
 * may be wrong with t. Each corner, and each axis, is the largest in one of them. */
static void a_tolerance_depends_on_no_order(void **state)
{
    static const vec3 corners[3][3] = {{{-1, -2, 5}, {6, -1, 4}, {-2, 7, 9}}, {{-1, -9, 4}, {6, 8, 5}, {-7, 3, 6}},
                                       {{-8, -1, 3}, {9, -2, 7}, {1, 5, 4}}};
    const vec3 o = {0.25f, 0.5f, -0.5f}, d = {0.125f, 0.0625f, 1};
    for (int i = 0; i < 3; i++) {
        double first[2] = {0, 0};
        const vec3 *c = corners[i];
        const vec3 n = cross(sub(c[1], c[0]), sub(c[2], c[0]));
        const double t = (double)dot(sub(c[0], o), n) / (double)dot(d, n);
        for (int k = 0; k < 6; k++) {
            const int swap = k / 3, turn = k % 3;
            const vec3 p[3] = {turned(c[0], turn), turned(c[1 + swap], turn), turned(c[2 - swap], turn)};
            const ray r = {turned(o, turn), turned(d, turn), INFINITY};
            double error[2];
            tolerance_of(error, p, &r, t);
            if (k == 0) memcpy(first, error, sizeof first);
            for (int j = 0; j < 2; j++) assert_true(fabs(error[j] - first[j]) < 1e-6 * first[j] + 1e-14);
        }
    }
}

/* ---- a scene ---- */

static void verify_text(bis_verify *v, const char *text)
{
    bis_scene_desc *desc = NULL;
    bis_scene *scene = NULL;
    program_write_file(DIR "/scene.txt", text);
    assert_int_equal(bis_scene_parse(&desc, DIR "/scene.txt", NULL), BIS_OK);
    desc->light_needs = BIS_VERIFY_LIGHT_NEEDS;
    assert_int_equal(bis_scene_build(&scene, desc, NULL), BIS_OK);
    assert_int_equal(bis_verify_scene(v, scene, desc, &desc->view.settings, NULL), BIS_OK);
    bis_scene_free(scene);
    bis_scene_desc_free(desc);
}

/* The one that is built for the comparison alone has a message of its own. */
static void without_memory_there_is_no_second_accelerator(void **state)
{
    bis_scene_desc *desc = NULL;
    bis_scene *scene = NULL;
    int refused = 0;
    if (!bis_accel_embree_version()) skip();
    program_write_file(DIR "/scene.txt", "Accelerator \"grid\" WorldBegin LightSource \"infinite\" \"rgb L\" [0 0 0] "
                       "Material \"diffuse\" \"float reflectance\" 0 Shape \"sphere\"");
    assert_int_equal(bis_scene_parse(&desc, DIR "/scene.txt", NULL), BIS_OK);
    desc->light_needs = BIS_VERIFY_LIGHT_NEEDS;
    assert_int_equal(bis_scene_build(&scene, desc, NULL), BIS_OK);
    FOR_LACK(l) {
        bis_verify v = {.seed = 1, .halvings = 8};
        bis_diag diag = {0};
        LACK(l, bis_verify_scene(&v, scene, desc, &desc->view.settings, &diag) ?: bis_verify_judge(&v, &diag));
        assert_int_equal(l.status == BIS_OK, l.over);
        assert_int_equal(diag.n_errors, !l.over);
        if (diag.n) refused += strcmp(diag.messages[0].text, "error: no memory for a second accelerator") == 0;
        bis_diag_clear(&diag);
        bis_verify_clear(&v);
    }
    assert_true(refused > 0);
    bis_scene_free(scene);
    bis_scene_desc_free(desc);
}

/* The scene's accelerator and the other one, where there are two. */
static void the_second_accelerator_is_the_other_one(void **state)
{
    const bool two = bis_accel_embree_version() != NULL;
    static const char *const scenes[2] = {"Accelerator \"grid\" WorldBegin Shape \"sphere\"",
                                          "Accelerator \"embree\" WorldBegin Shape \"sphere\""};
    static const char *const names[2] = {"grid and embree see the same", "embree and grid see the same"};
    for (int i = 0; i < (two ? 2 : 1); i++) {
        bis_verify v = {.seed = 1, .halvings = 8};
        verify_text(&v, scenes[i]);
        const bis_verify_test *const t = &v.tests[v.n - 1];
        assert_string_equal(t->group, "accelerators");
        assert_string_equal(t->name, two ? names[i] : "grid sees what a search sees");
        assert_true(t->statistic == 0);
        bis_verify_clear(&v);
    }
}

/* Black, too narrow, one that two shapes have, and what comes after 24. */
static void materials_are_numbered_and_what_is_left_out_is_said(void **state)
{
    const double no = (double)NAN;
    char text[8192] = "WorldBegin\n";
    static const char *const black = "Material \"diffuse\" \"float reflectance\" 0 Shape \"sphere\"\n";
    bis_verify v = {.seed = 1, .halvings = 9};
    size_t n = strlen(text);
    n += (size_t)snprintf(text + n, sizeof text - n, "%s", black);
    n += (size_t)snprintf(text + n, sizeof text - n,
        "Material \"phong\" \"float Kd\" 0 \"float Ks\" 0.5 \"float exponent\" 2e8 Shape \"sphere\"\n%s", black);
    for (int i = 0; i < 23; i++) /* 25 materials in all: each its own exponent, beyond what floats resolve */
        n += (size_t)snprintf(text + n, sizeof text - n,
            "Material \"phong\" \"float Kd\" 0 \"float Ks\" 0.5 \"float exponent\" %d00000000 Shape \"sphere\"\n",
            i + 3);
    verify_text(&v, text);
    const expected_test first = {"1", "it is black: nothing is drawn", no, 0, no, no, BIS_VERDICT_SKIPPED};
    const expected_test second = {
        "2, n 2e+08", "unit vectors in float cannot resolve exponents beyond 1e8", no, 0, no, no, BIS_VERDICT_SKIPPED};
    const expected_test last = {"24, n 2.4e+09", second.note, no, 0, no, no, BIS_VERDICT_SKIPPED};
    const expected_test many = {
        "25 and on", "too many: only the first are looked at", no, 0, no, no, BIS_VERDICT_SKIPPED};
    const expected_test dark = {"all integrators", "there is no light", no, 0, no, no, BIS_VERDICT_SKIPPED};
    assert_true(v.n == 28);
    assert_string_equal(v.tests[0].group, "map");
    assert_test(&v.tests[1], "materials", &first);
    assert_test(&v.tests[2], "materials", &second);
    assert_test(&v.tests[24], "materials", &last);
    assert_test(&v.tests[25], "materials", &many);
    assert_test(&v.tests[26], "view", &dark);
    assert_string_equal(v.tests[27].group, "accelerators");
    bis_verify_clear(&v);

    v = (bis_verify){.seed = 1, .halvings = 9};
    verify_text(&v, "WorldBegin Material \"microfacet\" \"float roughness\" 0.5 Shape \"sphere\"\n"
                    "Material \"phong\" \"float exponent\" 7 Shape \"sphere\"");
    static const char *const names[] = {
        "1, alpha 0.25, 0 degrees", "1, alpha 0.25, 45 degrees", "1, alpha 0.25, 75 degrees",
        "1, alpha 0.25, 89 degrees",
        "2, n 7, 0 degrees", "2, n 7, 45 degrees", "2, n 7, 75 degrees", "2, n 7, 89 degrees"};
    static const char *const what[] = {
        "density integrates to 1", "draws by its density", "furnace, brdf", "furnace, sir"};
    for (int i = 0; i < 32; i++) {
        char name[128];
        snprintf(name, sizeof name, "%s: %s", names[i / 4], what[i % 4]);
        assert_string_equal(v.tests[1 + i].name, name);
    }
    bis_verify_clear(&v);
}

/* The first pixel of the lattice is the middle of the film, or of its crop window; the second is 0.5 + 0.75487766625
 * and 0.5 + 0.56984029100 of it, less 1. All integrators are in their order. */
static void the_pixels_of_a_view_are_those_of_the_lattice(void **state)
{
    static const char *const integrators[] = {"em", "brdf", "mis", "rejection", "sir", "exact", "unoccluded"};
    static const struct { const char *film, *pixels[3]; unsigned halvings; int n; } cases[] = {
        {"", {"(12, 8)"}, 9, 1},
        {"\"float cropwindow\" [0.25 1 0.125 0.875]", {"(15, 8)"}, 2, 1},
        {"", {"(12, 8)", "(6, 1)", "(0, 10)"}, 1, 3}}; /* 6 halved is 3; twice the steps: 0.00976, 0.63968 */
    for (int c = 0; c < 3; c++) {
        char text[1024];
        int n = 0;
        bis_verify v = {.seed = 1, .halvings = cases[c].halvings};
        snprintf(text, sizeof text,
            "Film \"rgb\" \"integer xresolution\" 24 \"integer yresolution\" 16 %s\nWorldBegin\n"
            "LightSource \"infinite\"\nMaterial \"diffuse\" Translate 0 0 4 Shape \"disk\" \"float radius\" 100\n",
            cases[c].film);
        verify_text(&v, text);
        for (size_t i = 0; i < v.n; i++) {
            char name[64];
            if (strcmp(v.tests[i].group, "view") != 0) continue;
            bool is_other = false;
            for (int k = 0; k < n_further(); k++)
                is_other |= strstr(v.tests[i].name, bis_integrators[OUR_INTEGRATORS + k]->name) != NULL;
            if (is_other) continue;
            assert_true(n < OUR_INTEGRATORS * cases[c].n);
            snprintf(name, sizeof name, "pixel %s: %s", cases[c].pixels[n / OUR_INTEGRATORS],
                integrators[n % OUR_INTEGRATORS]);
            assert_string_equal(v.tests[i].name, name);
            n++;
        }
        assert_int_equal(n, OUR_INTEGRATORS * cases[c].n);
        bis_verify_clear(&v);
    }
}

/* ---- the command ---- */

/* Text and JSON of a map tell the same, and what the library tells. */
static void text_and_json_of_a_map_tell_the_same(void **state)
{
    program_run text, json;
    char value[256], line[256], p[16], dof[16];
    bis_envmap em = map_random(8, 4, 2, 0.1, 3);
    const bis_image image = {8, 4, em.pixels, NULL};
    assert_int_equal(bis_image_save(&image, DIR "/map.PFM", NULL), BIS_OK);
    program_expect(&text, 0, "verify " DIR "/map.PFM --seed 3");
    program_expect(&json, 0, "verify --json " DIR "/map.PFM --seed 3");
    bis_verify v = {.seed = 3};
    assert_int_equal(bis_verify_map(&v, &em, 0.15, 8, NULL), BIS_OK);
    assert_int_equal(bis_verify_judge(&v, NULL), BIS_OK);
    assert_true(json_number(json.output, "seed") == 3 && json_number(json.output, "statistical") == 6);
    assert_figure(json_number(json.output, "corrected"), 1 - pow(0.99, 1 / 6.0), "corrected");
    assert_non_null(strstr(text.output, "14 tests, 0 failed, 0 skipped. 6 of them are statistical: each fails below p "
                                        "= 0.00167, so "));
    for (int i = 0; i < 14; i++) {
        const bis_verify_test *t = &v.tests[i];
        const struct {
            const char *key;
            double value;
        } figures[] = {{"statistic", t->statistic}, {"dof", t->dof > 0 ? t->dof : (double)NAN}, {"p", t->p},
            {"threshold", t->threshold}};
        for (int k = 0; k < 4; k++) {
            snprintf(line, sizeof line, "tests.%d.%s", i, figures[k].key);
            assert_figure(json_number(json.output, line), figures[k].value, line);
        }
        snprintf(line, sizeof line, "tests.%d.verdict", i);
        assert_string_equal(json_value(value, sizeof value, json.output, line), "\"passed\"");
        if (isnan(t->p)) snprintf(p, sizeof p, "%10s", "-");
        else snprintf(p, sizeof p, "%10.3g", t->p);
        snprintf(dof, sizeof dof, "%10.3g", t->threshold);
        snprintf(line, sizeof line, "\n  %-44s %10.3g %s %s  passed: %s\n", t->name, t->statistic, p, dof, t->note);
        if (!strstr(text.output, line)) fail_msg("no %s in %s", line, text.output);
    }
    bis_verify_clear(&v);
    bis_envmap_clear(&em);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_test_has_the_fields_that_were_handed_in),
        cmocka_unit_test(without_a_p_value_the_threshold_is_that_of_one),
        cmocka_unit_test(a_tests_seed_is_made_of_its_name_and_the_runs),
        cmocka_unit_test(a_part_that_begins_is_told),
        cmocka_unit_test(cells_are_pooled_in_order_and_the_rest_joins_the_last),
        cmocka_unit_test(p_is_the_tail_of_a_shifted_gamma_distribution),
        cmocka_unit_test(moments_are_the_sums_about_the_mean),
        cmocka_unit_test(the_skewness_beside_another_mean_is_that_of_added_moments),
        cmocka_unit_test(a_mean_is_judged_by_what_is_beyond_its_slack),
        cmocka_unit_test(the_bound_of_a_skewed_mean_is_that_of_the_page),
        cmocka_unit_test(the_tests_of_a_map_have_limits_by_hand),
        cmocka_unit_test(an_error_of_a_thousandth_is_told_as_such),
        cmocka_unit_test(the_definition_of_the_density_is_that_by_hand),
        cmocka_unit_test(a_definition_without_memory_is_none),
        cmocka_unit_test(the_number_of_draws_follows_the_pixels),
        cmocka_unit_test(a_materials_limits_draws_and_furnace_are_those_by_hand),
        cmocka_unit_test(too_few_accepted_candidates_are_counted),
        cmocka_unit_test(a_thousand_accepted_candidates_are_enough),
        cmocka_unit_test(the_number_of_runs_follows_the_cost),
        cmocka_unit_test(a_sample_is_judged_by_its_own_density),
        cmocka_unit_test(the_rays_are_where_the_page_says_and_are_counted),
        cmocka_unit_test(a_search_knows_disks_and_spheres),
        cmocka_unit_test(a_search_knows_what_is_turned_and_stretched),
        cmocka_unit_test(a_search_finds_the_nearest_triangle),
        cmocka_unit_test(a_ray_that_starts_on_a_ball_meets_its_far_side),
        cmocka_unit_test(a_distance_may_err_by_what_was_worked_out),
        cmocka_unit_test(a_quadrics_edge_is_in_doubt_by_what_was_worked_out),
        cmocka_unit_test(a_tolerance_depends_on_no_order),
        cmocka_unit_test(the_second_accelerator_is_the_other_one),
        cmocka_unit_test(without_memory_there_is_no_second_accelerator),
        cmocka_unit_test(materials_are_numbered_and_what_is_left_out_is_said),
        cmocka_unit_test(the_pixels_of_a_view_are_those_of_the_lattice),
        cmocka_unit_test(text_and_json_of_a_map_tell_the_same),
    };
    program_folder(DIR);
    return cmocka_run_group_tests_name("verdicts", tests, NULL, NULL);
}
