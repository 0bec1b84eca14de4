/* SPDX-License-Identifier: BSD-2-Clause */
/* What `bis verify` judges by, by hand: chi-square, means and their bounds, the search for a hit; and that text and
 * JSON tell the same. That it accepts what is right and rejects what is wrong is in test_verify_map,
 * test_verify_bsdf, ... */
#include "tools/verify/verify.h"

#include "bis/base/mem.h"
#include "bis/base/stats.h"
#include "bis/files/image_file.h"
#include "bis/thesis/rng.h"
#include "claim.h"
#include "json_check.h"
#include "map_help.h"
#include "mesh_help.h"
#include "program.h"

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
        cmocka_unit_test(cells_are_pooled_in_order_and_the_rest_joins_the_last),
        cmocka_unit_test(p_is_the_tail_of_a_shifted_gamma_distribution),
        cmocka_unit_test(moments_are_the_sums_about_the_mean),
        cmocka_unit_test(the_skewness_beside_another_mean_is_that_of_added_moments),
        cmocka_unit_test(a_mean_is_judged_by_what_is_beyond_its_slack),
        cmocka_unit_test(the_bound_of_a_skewed_mean_is_that_of_the_page),
        cmocka_unit_test(the_definition_of_the_density_is_that_by_hand),
        cmocka_unit_test(a_search_knows_what_is_turned_and_stretched),
        cmocka_unit_test(a_quadrics_edge_is_in_doubt_by_what_was_worked_out),
        cmocka_unit_test(a_tolerance_depends_on_no_order),
        cmocka_unit_test(text_and_json_of_a_map_tell_the_same),
    };
    program_folder(DIR);
    return cmocka_run_group_tests_name("verdicts", tests, NULL, NULL);
}
