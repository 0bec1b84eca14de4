/* SPDX-License-Identifier: BSD-2-Clause */
/* Tests of `bis pixel`: its figures against brute force and against the definitions, what it overhears against the
 * integrators, then the command itself.
 * Statistical tests: 5e-3 for all of this file together. */
#include "tools/pixel/pixel.h"

#include "bis/base/file.h"
#include "bis/beyond/clusters.h"
#include "bis/base/mem.h"
#include "bis/thesis/phong.h"
#include "bis/base/stats.h"
#include "bis/files/image_file.h"
#include "bis/scene/light_load.h"
#include "claim.h"
#include "file_help.h"
#include "json_check.h"
#include "lack.h"
#include "lit.h"
#include "map_help.h"
#include "page_help.h"
#include "program.h"
#include "stat.h"
#include "verify_help.h"
#include "world.h"

#include <stdlib.h>
#include <string.h>

/* All but exact; rejection twice, by either estimator. */
static size_t n_methods(void)
{
    size_t n = 0;
    while (bis_integrators[n]) n++;
    return n;
}

/* Twelve times four channels against brute force, a mean of each method and of the product. */
static double alpha(void) { return stat_level(5e-3, 12 * 4 + 1 + (int)n_methods()); }

enum { EXPONENT = 20 };
static bis_material glossy(void) { return bis_phong((rgb){0.3f, 0.2f, 0.4f}, (rgb){0.5f, 0.6f, 0.4f}, EXPONENT); }
static vec3 slanted(void) { return normalize((vec3){0.3f, -0.4f, 0.8f}); }

/* ---- the truth ---- */

/* p of the difference from brute force in r, g, b and their sum, the least of the four; brute force itself is good to
 * `slack` of the value. */
static double p_of(const bis_pixel_value *v, rgbd truth, double slack)
{
    const double expected[4] = {truth.r, truth.g, truth.b, rgbd_sum(truth)};
    double least = 1;
    for (int k = 0; k < 4; k++) {
        const double e = fmax(0, fabs(v->mean[k] - expected[k]) - slack * expected[k]);
        if (e > 0) least = fmin(least, bis_stats_normal_p(e / v->se[k]));
    }
    return least;
}

static void assert_agrees(const bis_pixel_value *v, rgbd truth)
{
    stat_judges(4);
    assert_true(p_of(v, truth, 1e-4) > alpha());
}

static void exact_is_what_brute_force_gives(void **state)
{
    const lit_map maps[] = {LIT_SPOTTY, LIT_SMOOTH, LIT_ONE_BLOCK, LIT_CONSTANT};
    for (size_t i = 0; i < 4; i++) {
        bis_light *light = lit_new_light(maps[i], 1, 0.15, false);
        lit l;
        lit_init(&l, light, glossy(), slanted(), 40, LIT_HALF);
        bis_pixel_exact e;
        assert_int_equal(bis_pixel_exact_of(&e, &l.pt, BIS_PIXEL_MAX_PATCHES, 1, NULL), BIS_OK);
        assert_true(e.by_patches);
        const rgbd seen = lit_truth(&l, true), open = lit_truth(&l, false);
        assert_agrees(&e.lit, seen);
        assert_agrees(&e.open, open);
        if (maps[i] == LIT_SMOOTH || maps[i] == LIT_CONSTANT)
            assert_true(p_of(&e.lit, open, 1e-4) < alpha()); /* the twin: shadows forgotten */
        assert_true(e.lit.se[3] < 0.01 * e.lit.mean[3]);
        bis_light_free(light);
    }
}

/* One lit patch has all of the bound: cut in four eight times it has the 2^16 cells that are asked for, with two rays
 * each. */
static void a_sum_has_its_cells(void **state)
{
    bis_envmap em = map_new(16, 8);
    const bis_light_desc desc = {.to_world = bis_xform_identity()};
    bis_light *light;
    bis_pixel_exact e;
    lit l;
    em.pixels[40] = grey(1);
    const vec3 n = bis_envmap_direction(&em, 8, 2, 0.5, 0.5);
    assert_int_equal(bis_light_from_envmap(&light, &em, &desc, BIS_NEED_TABLE, NULL), BIS_OK);
    lit_init(&l, light, bis_phong(grey(0.5), grey(0), 1), n, 40, LIT_OPEN);
    assert_int_equal(bis_pixel_exact_of(&e, &l.pt, BIS_PIXEL_MAX_PATCHES, 1, NULL), BIS_OK);
    assert_int_equal(e.patches, 128);
    assert_int_equal(e.rays, 2 << 16);
    bis_light_free(light);
}

static void a_long_mis_stands_in_for_huge_maps(void **state)
{
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0.15, false);
    lit l;
    lit_init(&l, light, glossy(), slanted(), 40, LIT_HALF);
    bis_pixel_exact e;
    assert_int_equal(bis_pixel_exact_of(&e, &l.pt, 100, 2, NULL), BIS_OK);
    assert_false(e.by_patches);
    assert_agrees(&e.lit, lit_truth(&l, true));
    assert_agrees(&e.open, lit_truth(&l, false));
    assert_true(e.lit.se[3] < 0.01 * e.lit.mean[3]);
    /* by the balance heuristic n samples scatter less than n of the mixture, whose variance a sum over patches has */
    bis_pixel_exact sum;
    assert_int_equal(bis_pixel_exact_of(&sum, &l.pt, BIS_PIXEL_MAX_PATCHES, 2, NULL), BIS_OK);
    assert_true(pow(e.lit.se[3], 2) * BIS_PIXEL_MIS_RUNS * BIS_PIXEL_MIS_SAMPLES < sum.variance[2]);
    bis_light_free(light);
}

/* Below the surface but above the shading horizon: light that eq. 4.5 has and eq. 4.1 has not, by the sum and by
 * mis. */
static void what_the_surface_itself_hides_is_hidden_and_in_L_ns(void **state)
{
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0.15, false);
    lit l;
    lit_init(&l, light, glossy(), slanted(), 40, LIT_OPEN);
    const rgbd all = lit_truth(&l, false);
    l.pt.ng = normalize((vec3){0.8f, 0.2f, 0.3f});
    for (int i = 0; i < 2; i++) {
        bis_pixel_exact e;
        assert_int_equal(bis_pixel_exact_of(&e, &l.pt, i ? 0 : BIS_PIXEL_MAX_PATCHES, 3, NULL), BIS_OK);
        assert_agrees(&e.open, all);
        assert_true(e.lit.mean[3] < 0.95 * e.open.mean[3]);
    }
    bis_light_free(light);
}

/* ---- the methods ---- */

static void methods_agree_with_exact_and_a_wrong_one_does_not(void **state)
{
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0.15, false);
    lit l;
    lit_init(&l, light, glossy(), slanted(), 40, LIT_HALF);
    bis_pixel_exact e;
    bis_pixel_method list[BIS_PIXEL_MAX_METHODS];
    bis_settings own = bis_settings_default(&bis_sir);
    own.candidates = 100;
    own.shadowrays = 7;
    const size_t n = bis_pixel_methods(list, &own);
    assert_int_equal(n, n_methods());
    assert_int_equal(bis_pixel_exact_of(&e, &l.pt, BIS_PIXEL_MAX_PATCHES, 1, NULL), BIS_OK);
    for (size_t i = 0; i < n; i++) {
        bis_pixel_method *m = &list[i];
        const bis_integrator *in = m->settings.integrator;
        const bool by_candidates = in == &bis_rejection || in == &bis_sir || in == &bis_unoccluded;
        if (by_candidates) assert_int_equal(m->settings.candidates, 100);
        if (strcmp(m->name, "rejection ratio") == 0) m->settings.candidates = 10000; /* its bias is O(1/M) */
        assert_int_equal(bis_pixel_method_run(m, &l.pt, &e, BIS_SAMPLER_STRATIFIED, 1000, 70 + i, NULL), BIS_OK);
        stat_judges(1);
        if (bis_stats_normal_p(m->z) <= alpha()) fail_msg("%s: z = %g", m->name, m->z);
        assert_true(m->error > 0 && m->error < 3);
        assert_true(m->is_open ? m->rays == 0 : m->rays > 0);
    }
    for (size_t i = 0; i < n; i++) { /* and with the product */
        bis_pixel_method *m = &list[i];
        if (m->settings.integrator != &bis_sir) continue;
        m->settings.proposal = BIS_PROPOSAL_PRODUCT;
        assert_int_equal(bis_pixel_method_run(m, &l.pt, &e, BIS_SAMPLER_STRATIFIED, 300, 69, NULL), BIS_OK);
        stat_judges(1);
        if (bis_stats_normal_p(m->z) <= alpha()) fail_msg("product: z = %g", m->z);
    }
    own.as_printed = BIS_E23; /* the twin: weights as printed */
    own.proposal = BIS_PROPOSAL_EM;
    assert_int_equal(bis_pixel_methods(list, &own), n);
    for (size_t i = 0; i < n; i++) {
        if (strcmp(list[i].name, "sir") != 0) continue;
        assert_int_equal(bis_pixel_method_run(&list[i], &l.pt, &e, BIS_SAMPLER_STRATIFIED, 1000, 70, NULL), BIS_OK);
        assert_true(fabs(list[i].z) > 10);
    }
    bis_light_free(light);
}

/* From the sum over patches and from 20000 estimates; and where a lamp is found by none of them. */
static void skewness_is_known_even_of_what_was_not_hit(void **state)
{
    const bis_integrator *const by[] = {&bis_em, &bis_brdf};
    bis_light *lights[] = {lit_new_light(LIT_SMOOTH, 1, 0.15, false), lit_new_light(LIT_SPOTTY, 1, 0.15, false)};
    bis_pixel_exact e;
    lit l;

    lit_init(&l, lights[0], glossy(), slanted(), 40, LIT_HALF);
    assert_int_equal(bis_pixel_exact_of(&e, &l.pt, BIS_PIXEL_MAX_PATCHES, 1, NULL), BIS_OK);
    for (int i = 0; i < 2; i++) {
        bis_pixel_method m = {.settings = bis_settings_default(by[i])};
        assert_int_equal(
            bis_pixel_method_run(&m, &l.pt, &e, BIS_SAMPLER_RANDOM, 20000, 80 + (uint64_t)i, NULL), BIS_OK);
        assert_near(m.skewness / m.true_skewness, 1, 0.1);
    }
    lit_init(&l, lights[1], glossy(), slanted(), 40, LIT_OPEN);
    assert_int_equal(bis_pixel_exact_of(&e, &l.pt, BIS_PIXEL_MAX_PATCHES, 1, NULL), BIS_OK);
    bis_pixel_method m = {.settings = bis_settings_default(&bis_brdf)};
    assert_int_equal(bis_pixel_method_run(&m, &l.pt, &e, BIS_SAMPLER_RANDOM, 10, 82, NULL), BIS_OK);
    if (!(m.true_skewness > 2 * fabs(m.skewness) && m.true_skewness > 0.1))
        fail_msg("skewness %g, truly %g", m.skewness, m.true_skewness);
    for (int i = 0; i < 2; i++) bis_light_free(lights[i]);
}

/* A run by hand: mean, standard error, skewness and rays. */
static void figures_of_a_method_are_those_of_its_estimates(void **state)
{
    enum { N = 50 };
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0.15, false);
    lit l;
    lit_init(&l, light, glossy(), slanted(), 40, LIT_HALF);
    bis_pixel_exact e;
    assert_int_equal(bis_pixel_exact_of(&e, &l.pt, BIS_PIXEL_MAX_PATCHES, 1, NULL), BIS_OK);
    bis_pixel_method m = {.settings = bis_settings_default(&bis_em)};
    assert_int_equal(bis_pixel_method_run(&m, &l.pt, &e, BIS_SAMPLER_SOBOL, N, 9, NULL), BIS_OK);
    l.kind = BIS_SAMPLER_SOBOL;
    bis_scratch scratch;
    double x[N], mean = 0, m2 = 0, m3 = 0, square = 0;
    assert_int_equal(bis_scratch_init(&scratch, &m.settings, NULL), BIS_OK);
    for (uint64_t run = 0; run < N; run++) x[run] = rgb_sum(lit_once(&l, &m.settings, &scratch, 9, run));
    bis_scratch_clear(&scratch);
    for (int i = 0; i < N; i++) mean += x[i] / N;
    for (int i = 0; i < N; i++) m2 += (x[i] - mean) * (x[i] - mean) / (N - 1);
    for (int i = 0; i < N; i++) square += (x[i] - e.lit.mean[3]) * (x[i] - e.lit.mean[3]) / N;
    for (int i = 0; i < N; i++) m3 += pow((x[i] - mean) / sqrt(m2), 3) / N;
    assert_near(m.L.mean[3] / mean, 1, 1e-12);
    assert_near(m.L.se[3] / sqrt(m2 / N), 1, 1e-9);
    assert_near(m.error / (sqrt(square) / e.lit.mean[3]), 1, 1.0 / N); /* but for n - 1 in place of n */
    assert_near(m.skewness, m3 / sqrt(N), 1e-9);
    assert_near(m.rays, (double)l.counters.shadow_rays / N, 0);
    assert_near(m.z, (mean - e.lit.mean[3]) / sqrt(m2 / N + e.lit.se[3] * e.lit.se[3]), 1e-9);
    bis_light_free(light);
}

/* The same of each channel, and what is said beside a truth that stands here: z and the error of one from lit, or from
 * open where shadows are left out; skewness by the moments of one sample, of q_L for em, of q_f for brdf, of both for
 * mis, each of 16 samples. */
static void figures_of_a_method_follow_from_the_truth(void **state)
{
    enum { N = 30 };
    static const bis_integrator *const of[] = {&bis_em, &bis_brdf, &bis_mis, &bis_rejection, &bis_unoccluded};
    const bis_pixel_exact right = {.by_patches = true, .lit = {{1, 2, 3, 6}, {0.1, 0.2, 0.3, 0.5}},
        .open = {{2, 4, 6, 12}, {0.4, 0.5, 0.6, 0.25}}, .variance = {4, 9, 16}, .third = {2, 3, -8}};
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0.15, false);
    lit l;
    lit_init(&l, light, glossy(), slanted(), 40, LIT_HALF);
    l.kind = BIS_SAMPLER_SOBOL;
    for (int i = 0; i < 5; i++) {
        bis_pixel_method m = {.settings = bis_settings_default(of[i]), .is_open = i == 4};
        bis_scratch scratch;
        double x[4][N], mean[4] = {0}, m2[4] = {0};
        const double truth = i == 4 ? 12 : 6, se = i == 4 ? 0.25 : 0.5;
        m.settings.candidates = 100;
        assert_int_equal(bis_pixel_method_run(&m, &l.pt, &right, BIS_SAMPLER_SOBOL, N, 9, NULL), BIS_OK);
        l.counters = (bis_counters){0};
        assert_int_equal(bis_scratch_init(&scratch, &m.settings, NULL), BIS_OK);
        for (uint64_t run = 0; run < N; run++) {
            const rgb L = lit_once(&l, &m.settings, &scratch, 9, run);
            const double c[4] = {(double)L.r, (double)L.g, (double)L.b, rgb_sum(L)};
            for (int k = 0; k < 4; k++) x[k][run] = c[k];
        }
        bis_scratch_clear(&scratch);
        for (int k = 0; k < 4; k++) {
            for (int run = 0; run < N; run++) mean[k] += x[k][run] / N;
            for (int run = 0; run < N; run++) m2[k] += pow(x[k][run] - mean[k], 2) / (N - 1);
            assert_near(m.L.mean[k] / mean[k], 1, 1e-9);
            assert_near(m.L.se[k] / sqrt(m2[k] / N), 1, 1e-9);
        }
        assert_int_equal(m.repeats, N);
        assert_near(m.z, (mean[3] - truth) / sqrt(m2[3] / N + se * se), 1e-9 * fabs(m.z));
        assert_near(m.error, sqrt(m2[3] + pow(mean[3] - truth, 2)) / truth, 1e-9 * m.error);
        assert_near(m.rays, (double)l.counters.shadow_rays / N, 1e-12);
        assert_near(m.accepted, (double)l.counters.accepted / N, 1e-12);
        assert_true((m.accepted > 0) == (i == 3));
        const double skewness[] = {2 / 8.0, 3 / 27.0, -8 / 64.0};
        if (i < 3) assert_near(m.true_skewness, skewness[i] / sqrt(N * 16), 1e-12);
        else assert_true(isnan(m.true_skewness));
    }
    bis_light_free(light);
}

/* What cannot be said is NAN: a skewness of em by mis, of samples that do not scatter or whose square has no mean; an
 * error beside a truth of 0; z where nothing scatters. */
static void what_has_no_figure_is_not_a_number(void **state)
{
    static const struct { bool by_patches; double variance; bool is_known; } cases[] = {
        {true, 4, true}, {false, 4, false}, {true, 0, false}, {true, (double)INFINITY, false}};
    bis_light *light = lit_new_light(LIT_BLACK, 1, 0.15, false);
    lit l;
    lit_init(&l, light, glossy(), slanted(), 40, LIT_OPEN);
    for (int i = 0; i < 4; i++) {
        bis_pixel_method m = {.settings = bis_settings_default(&bis_em)};
        const bis_pixel_exact e = {.by_patches = cases[i].by_patches, .variance = {cases[i].variance, 1, 1},
                                   .third = {1, 1, 1}, .lit = {{0, 0, 0, i == 3}, {0}}};
        assert_int_equal(bis_pixel_method_run(&m, &l.pt, &e, BIS_SAMPLER_RANDOM, 4, 1, NULL), BIS_OK);
        assert_int_equal(isnan(m.true_skewness), !cases[i].is_known);
        assert_true(isnan(m.z) && m.skewness == 0 && m.L.mean[3] == 0 && m.L.se[3] == 0);
        if (i == 3) assert_near(m.error, 1, 1e-12);
        else assert_true(isnan(m.error));
    }
    bis_light_free(light);
}

/* Numbers of the scene's own integrator go to all that have them, within what these may have: mis needs two samples. */
static void methods_have_the_scenes_numbers(void **state)
{
    bis_pixel_method list[BIS_PIXEL_MAX_METHODS];
    bis_settings own = bis_settings_default(&bis_em);
    own.samples = 1;
    own.as_printed = BIS_E34;
    own.stratify = true;
    const size_t n = bis_pixel_methods(list, &own);
    assert_int_equal(n, n_methods());
    for (size_t i = 0; i < n; i++) {
        const bis_settings *s = &list[i].settings, usual = bis_settings_default(s->integrator);
        assert_true(s->as_printed == BIS_E34 && !s->compensate);
        if (s->integrator == &bis_em) assert_true(s->samples == 1 && s->stratify);
        if (s->integrator == &bis_brdf) assert_int_equal(s->samples, 1);
        if (s->integrator == &bis_mis) assert_true(s->samples == 2 && s->stratify == usual.stratify);
        if (s->integrator == &bis_sir) assert_true(s->candidates == usual.candidates);
    }
    own = bis_settings_default(&bis_mis);
    own.compensate = true;
    own.samples = 9;
    assert_int_equal(bis_pixel_methods(list, &own), n);
    for (size_t i = 0; i < n; i++) {
        assert_false(list[i].settings.compensate);
        if (bis_parameter_of(list[i].settings.integrator, "samples")) assert_int_equal(list[i].settings.samples, 9);
    }
}

static rgb f_without_density(const bis_bsdf *b, vec3 wi, double *pdf)
{
    *pdf = 0;
    return (rgb){0, 0, 0};
}

/* Of a black map nothing is drawn, nor by a black material. A density that underflows is 0, and then so is c. */
static void mis_gets_nothing_where_nothing_is_drawn(void **state)
{
    const bis_settings settings = bis_settings_default(&bis_mis);
    bis_material materials[] = {glossy(), bis_phong((rgb){0, 0, 0}, (rgb){0, 0, 0}, 1), glossy()};
    bis_bsdf_model underflows = bis_phong_model;
    underflows.f_pdf = f_without_density;
    materials[2].model = &underflows;
    bis_light *light = lit_new_light(LIT_BLACK, 1, 0.15, false);
    for (int i = 0; i < 3; i++) {
        lit l;
        bis_pixel_mis mis;
        lit_init(&l, light, materials[i], slanted(), 40, LIT_OPEN);
        assert_int_equal(bis_pixel_mis_of(&mis, &l.pt, &settings, 10, 1, NULL), BIS_OK);
        assert_true(mis.mean == 0 && mis.variance[0] == 0 && mis.variance[1] == 0 && mis.beta == 0);
    }
    bis_light_free(light);
}

/* phat and q_f by eq. 3.14, 3.15 and E35, with pow. */
static double product_of(const lit *l, vec3 wi, double *q_f)
{
    const bis_material *m = &l->material;
    const double c_i = dot(l->pt.n, wi), c_o = dot(l->pt.n, l->pt.wo), a = 2 * c_i * c_o - dot(wi, l->pt.wo);
    const double lobe = a > 0 ? (m->exponent + 1) / (2 * PI) * pow(a, m->exponent) : 0, ks = rgb_sum(m->Ks),
                 kd = rgb_sum(m->Kd);
    const rgb Le = bis_light_Le(l->light, wi);
    *q_f = (ks * lobe + kd * c_i / PI) / (ks + kd);
    return c_i * (rgb_sum(rgb_mul(m->Ks, Le)) * lobe + rgb_sum(rgb_mul(m->Kd, Le)) / PI);
}

/* Under a constant light L a diffuse surface reflects F = rho L q_f, rho = 0.5: a mixture of the two densities, so that
 * the best weights leave no variance. With them each sample is the same number k = rho L/N, because F - beta times
 * (q_L - q_f) is k c: beta = -k n1. The integrals of the balance heuristic, over the cosine, by midpoints; they are
 * told to 2 % by 2^14 times 16 samples. */
static void the_best_weights_leave_nothing_of_a_mixture(void **state)
{
    enum { N = 16, STEPS = 10000, RUNS = 1 << 14 };
    bis_settings s = bis_settings_default(&bis_mis);
    bis_light *light = lit_new_light(LIT_CONSTANT, 1, 0, false); /* r+g+b: 1.75 */
    const double L = 0.5 * 1.75;
    lit l;
    lit_init(&l, light, bis_phong(grey(0.5), grey(0), 1), slanted(), 40, LIT_OPEN);
    for (int n1 = 4; n1 <= 12; n1 += 8) {
        bis_pixel_mis mis;
        const double n2 = N - n1;
        double both = 0, square = 0, by_map = 0, by_brdf = 0;
        for (int i = 0; i < STEPS; i++) {
            const double z = (i + 0.5) / STEPS, q1 = 1 / (4 * PI), q2 = z / PI, F = L * q2, c = n1 * q1 + n2 * q2;
            const double d = 2 * PI / STEPS;
            both += N * q1 * q2 / c * d;
            square += F * F / c * d;
            by_map += F / c * q1 * d;
            by_brdf += F / c * q2 * d;
        }
        const double variance = square - n1 * by_map * by_map - n2 * by_brdf * by_brdf;
        s.samples = N;
        s.split = n1 / 16.0;
        assert_int_equal(bis_pixel_mis_of(&mis, &l.pt, &s, RUNS, 1, NULL), BIS_OK);
        assert_near(mis.beta / (-L * n1 / N), 1, 1e-5);
        assert_true(mis.variance[1] >= 0 && mis.variance[1] < 1e-9 * mis.variance[0]);
        assert_near(mis.variance[0] / variance, 1, 0.02);
        assert_near(mis.overlap / both, 1, 0.02);
        assert_near(mis.mean, L, 5 * sqrt(variance / RUNS));
    }
    bis_light_free(light);
}

/* The samples anew, by the same numbers: what each says, its variance among those of its technique, unbiased, and beta
 * by least squares. */
static void figures_of_mis_are_those_of_its_samples(void **state)
{
    enum { N = 5, N1 = 2, RUNS = 40 };
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0.15, false);
    bis_settings s = bis_settings_default(&bis_mis);
    double F[2][RUNS * N], d[2][RUNS * N], mean[2][2] = {{0}}, products = 0, squares = 0, by_hand[2] = {0, 0};
    int n[2] = {0, 0};
    bis_pixel_mis mis;
    lit l;
    lit_init(&l, light, glossy(), slanted(), 40, LIT_HALF);
    s.samples = N;
    s.split = 0.4;
    assert_int_equal(bis_pixel_mis_of(&mis, &l.pt, &s, RUNS, 9, NULL), BIS_OK);
    for (uint64_t i = 0; i < RUNS; i++) {
        bis_rng rng;
        bis_rng_init(&rng, 9, i, 0, (uint64_t)0x7a << 40);
        for (int j = 0; j < N; j++) {
            const int k = j >= N1;
            bis_light_point y = {.pdf = 0};
            double u[4], q_f;
            for (int a = 0; a < 4; a++) u[a] = bis_rng_double(&rng);
            const bool drawn =
                k ? bis_bsdf_draw(&l.pt.bsdf, u, &y.wi) : bis_light_sample(light, u, &y);
            const double product = product_of(&l, y.wi, &q_f), q_L = bis_light_pdf(light, y.wi);
            const bool is_seen = drawn && dot(l.pt.n, y.wi) > 0 && y.wi.y <= 0;
            if (drawn) q_f = bis_bsdf_pdf(&l.pt.bsdf, y.wi); /* below the horizon, too */
            F[k][n[k]] = is_seen ? product / (N1 * q_L + (N - N1) * q_f) : 0;
            d[k][n[k]++] = drawn ? (q_L - q_f) / (N1 * q_L + (N - N1) * q_f) : 0;
        }
    }
    assert_true(n[0] == RUNS * N1 && n[1] == RUNS * (N - N1));
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < n[k]; i++) {
            mean[k][0] += F[k][i] / n[k];
            mean[k][1] += d[k][i] / n[k];
        }
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < n[k]; i++) {
            products += (F[k][i] - mean[k][0]) * (d[k][i] - mean[k][1]);
            squares += pow(d[k][i] - mean[k][1], 2);
        }
    for (int way = 0; way < 2; way++)
        for (int k = 0; k < 2; k++)
            for (int i = 0; i < n[k]; i++) {
                const double x = F[k][i] - mean[k][0] - way * products / squares * (d[k][i] - mean[k][1]);
                by_hand[way] += (k ? N - N1 : N1) * x * x / (n[k] - 1);
            }
    assert_near(mis.mean / (N1 * mean[0][0] + (N - N1) * mean[1][0]), 1, 1e-4); /* the lobe is a float's, in double */
    assert_near(mis.beta / (products / squares), 1, 1e-3);
    assert_near(mis.overlap, 1 - N1 * (N - N1) * (mean[0][1] - mean[1][1]) / N, 1e-4);
    for (int way = 0; way < 2; way++) assert_near(mis.variance[way] / by_hand[way], 1, 1e-3);
    assert_true(mis.variance[1] < mis.variance[0]);
    bis_light_free(light);
}

/* ---- candidates ---- */

static bis_sampler one_sample(uint64_t seed)
{
    return (bis_sampler){
        .kind = BIS_SAMPLER_STRATIFIED, .seed = seed, .spp = 1, .xsamples = 1, .ysamples = 1, .jitter = true};
}

/* What the figures of one estimate must be, whatever q is. Returns how many candidates are from the map. */
static uint32_t assert_figures(const lit *l, const bis_pixel_candidates *c)
{
    long double W = 0, squares = 0;
    uint32_t chosen = 0, distinct = 0, seen = 0, positive = 0, from_map = 0;
    for (uint32_t i = 0; i < c->M; i++) {
        const bis_pixel_candidate *x = &c->c[i];
        W += (long double)x->w;
        squares += (long double)x->w * (long double)x->w;
        chosen += x->chosen;
        distinct += x->chosen > 0;
        seen += x->seen ? x->chosen : 0;
        from_map += x->from_map;
        if (x->w <= 0) {
            assert_true(x->chosen == 0 && isnan(x->q));
            continue;
        }
        positive++;
        double q_f;
        const double F = product_of(l, x->wi, &q_f);
        assert_near(x->product / F, 1, 1e-4);
        assert_near(x->q_f / q_f, 1, 1e-4);
        assert_near(x->w * x->q / x->product, 1, 1e-12);
        assert_true(x->chosen == 0 || x->seen == (x->wi.y <= 0));
    }
    assert_near(c->W / (double)W, 1, 1e-12);
    assert_near(c->ess / (double)(W * W / squares), 1, 1e-12);
    assert_true(c->ess >= 1 && c->ess <= positive);
    assert_true(chosen == c->N && distinct == c->distinct && seen == c->seen && positive == c->positive);
    assert_int_equal(from_map, c->n_map);
    assert_near(from_map, c->share_em * c->M, 1e-9);
    return from_map;
}

/* Weights are floats: the logarithm and power of the lobe are good to 2^-20 (1 + |log f|), and a cosine to 2^-22, which
 * an exponent of 20 multiplies by 20/cos. Where the lobe counts beside the diffuse part, cos > 0.63 and |log f| < 10.
 */
static const double of_floats = 0x1p-20 * 11 + 0x1p-22 * EXPONENT / 0.63;

static bis_settings sir_of(bis_proposal proposal)
{
    bis_settings s = bis_settings_default(&bis_sir);
    s.candidates = 200;
    s.shadowrays = 9;
    s.proposal = proposal;
    return s;
}

static void draw_candidates(bis_pixel_candidates *c, const lit *l, const bis_settings *s, uint64_t pixel)
{
    const bis_sampler sampler = one_sample(11);
    bis_stream stream;
    bis_stream_init(&stream, &sampler, pixel, 0);
    assert_int_equal(bis_pixel_candidates_draw(c, &l->pt, s, &stream, NULL), BIS_OK);
}

static void candidates_are_those_of_sir_and_their_figures_those_of_the_definitions(void **state)
{
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0.15, false);
    lit l;
    lit_init(&l, light, glossy(), slanted(), 40, LIT_HALF);
    for (bis_proposal proposal = BIS_PROPOSAL_EM; proposal <= BIS_PROPOSAL_MIX; proposal++) {
        const bis_settings s = sir_of(proposal);
        bis_pixel_candidates c;
        draw_candidates(&c, &l, &s, 4);
        bis_scratch scratch;
        assert_int_equal(bis_scratch_init(&scratch, &s, NULL), BIS_OK);
        const rgb L = lit_once(&l, &s, &scratch, 11, 4), found = rgbd_round(c.L);
        bis_scratch_clear(&scratch);
        assert_memory_equal(&L, &found, sizeof L);

        const uint32_t n = assert_figures(&l, &c);
        assert_true(proposal == BIS_PROPOSAL_EM ? n == 200 : proposal == BIS_PROPOSAL_BRDF ? n == 0 : n > 0 && n < 200);
        for (uint32_t i = 0; i < c.M; i++) {
            const bis_pixel_candidate *x = &c.c[i];
            if (x->w > 0) assert_near(x->q / (c.share_em * x->q_L + (1 - c.share_em) * x->q_f), 1, of_floats);
        }
        bis_pixel_candidates_clear(&c);
    }
    bis_light_free(light);
}

/* Within a cluster the product's density is a multiple s of q_L, the same for all of its candidates. Of n candidates
 * from the map it should hold n share s: each pixel has those within one, because marks are equally spaced. Over all
 * clusters share s adds up to 1, but for those that no pixel of 128 has met. Nothing here asks the product. */
static void candidates_of_the_product_are_as_dense_as_their_q_says(void **state)
{
    enum { PIXELS = 128, MOST = 2 * BIS_CLUSTERS + 2 };
    static double s[MOST];
    const bis_settings product = sir_of(BIS_PROPOSAL_PRODUCT);
    const bis_xform identity = bis_xform_identity();
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0.15, false);
    bis_clusters clusters;
    double all = 0;
    lit l;
    lit_init(&l, light, glossy(), slanted(), 40, LIT_HALF);
    assert_int_equal(bis_clusters_init(&clusters, light, 200, NULL), BIS_OK);
    for (uint64_t pixel = 0; pixel < PIXELS; pixel++) {
        double count[MOST] = {0};
        bis_pixel_candidates c;
        draw_candidates(&c, &l, &product, pixel);
        const uint32_t n = assert_figures(&l, &c);
        assert_true(n > 100);
        for (uint32_t i = 0; i < n; i++) {
            const bis_pixel_candidate *x = &c.c[i];
            const bis_pixel_direction d = bis_pixel_direction_of(&identity, x->wi);
            const uint32_t row = (uint32_t)(d.theta / 180 * 64), column = (uint32_t)(d.phi / 360 * 128);
            const uint32_t k = bis_cluster_of_pixel(&clusters, row * 128 + column);
            count[k]++;
            if (x->w <= 0) continue;
            const double by_map = x->q - (1 - c.share_em) * x->q_f, s_k = by_map / (c.share_em * x->q_L);
            if (s[k] > 0) assert_near(s_k / s[k], 1, 2 * of_floats * x->q / by_map);
            else all += bis_cluster_share(&clusters, k) * s_k;
            s[k] = s_k;
        }
        for (uint32_t k = 0; k < clusters.n; k++) {
            const double expected = n * bis_cluster_share(&clusters, k) * s[k];
            if (s[k] > 0 && fabs(count[k] - expected) > 1 + 1e-3)
                fail_msg("cluster %u has %g, expects %g", k, count[k], expected);
        }
        bis_pixel_candidates_clear(&c);
    }
    if (!(all > 1 - MOST / (100.0 * PIXELS) && all < 1 + 1e-3)) fail_msg("the shares add up to %g", all);
    bis_clusters_clear(&clusters);
    bis_light_free(light);
}

/* Bit for bit, the estimate that is shown is that of the first pass of a render; with another seed it is not. */
static void the_estimate_shown_is_what_renders(void **state)
{
    const bis_proposal proposals[] = {BIS_PROPOSAL_BRDF, BIS_PROPOSAL_PRODUCT};
    for (int k = 0; k < 2; k++) {
        world w;
        bis_film film;
        bis_render_result result;
        int equal = 0, hit = 0, other = 0;
        make_world(&w, &bis_sir);
        w.desc.view.settings.proposal = proposals[k];
        w.desc.view.pixel_jitter = false;
        render(&film, &result, &w, whole, &(bis_render_options){.budget = {.spp = 1}});
        for (int i = 0; i < WIDTH * HEIGHT; i += 2) {
            bis_counters counters = {0};
            bis_pixel_candidates c;
            bis_own_material m;
            bis_point pt;
            const ray eye = bis_camera_ray(&w.desc.view.camera, WIDTH, HEIGHT, i % WIDTH + 0.5, i / WIDTH + 0.5);
            if (!bis_scene_point(&pt, &m, &w.scene, eye, &counters, NULL)) continue;
            hit++;
            for (int seed = 0; seed < 2; seed++) {
                bis_sampler sampler = w.desc.view.sampler;
                bis_stream stream;
                sampler.seed += (uint64_t)seed;
                bis_stream_init(&stream, &sampler, (uint64_t)i, 0);
                assert_int_equal(bis_pixel_candidates_draw(&c, &pt, &w.desc.view.settings, &stream, NULL), BIS_OK);
                const rgb L = rgbd_round(c.L);
                const bool same = (double)L.r == film.sum[3 * i] && (double)L.g == film.sum[3 * i + 1] &&
                                  (double)L.b == film.sum[3 * i + 2];
                if (seed) other += same;
                else equal += same;
                bis_pixel_candidates_clear(&c);
            }
        }
        assert_true(hit > 50);
        assert_int_equal(equal, hit);
        assert_true(other < hit / 10); /* black ones are equal */
        bis_film_clear(&film);
        clear_world(&w);
    }
}

/* An equation of 4.4 as printed reaches the one estimate that is shown: it is bit for bit what `sir` itself makes of
 * the same stream. The twin is in the loop: each printed equation changes the estimate, or comparing would show
 * nothing. E23 prints nothing for a mixture, hence proposal "em". */
static void the_estimate_shown_is_that_of_sir_with_E6_E21_and_E23_as_printed(void **state)
{
    const unsigned printed[] = {0, BIS_E6, BIS_E21, BIS_E23, BIS_E6 | BIS_E21, BIS_E6 | BIS_E21 | BIS_E23};
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0.15, false);
    lit l;
    rgb right = {0, 0, 0};
    lit_init(&l, light, glossy(), slanted(), 40, LIT_HALF);
    for (size_t k = 0; k < sizeof printed / sizeof *printed; k++) {
        bis_settings s = sir_of(BIS_PROPOSAL_EM);
        bis_pixel_candidates c;
        s.as_printed = printed[k];
        draw_candidates(&c, &l, &s, 4);
        bis_scratch scratch;
        assert_int_equal(bis_scratch_init(&scratch, &s, NULL), BIS_OK);
        const rgb L = lit_once(&l, &s, &scratch, 11, 4), found = rgbd_round(c.L);
        bis_scratch_clear(&scratch);
        assert_memory_equal(&L, &found, sizeof L);
        assert_true(c.seen > 0);
        if (k == 0) right = L;
        else assert_memory_not_equal(&L, &right, sizeof L);

        /* The figures beside it are those of the same candidates: the weights sum to W, and N were chosen. */
        double W = 0;
        uint32_t chosen = 0;
        for (uint32_t i = 0; i < c.M; i++) {
            W += c.c[i].w;
            chosen += c.c[i].chosen;
        }
        assert_near(c.W / W, 1, 1e-12);
        assert_int_equal(chosen, 9);
        bis_pixel_candidates_clear(&c);
    }
    bis_light_free(light);
}

/* All weights equal: M; one candidate alone: 1. */
static void effective_sample_size_is_M_for_equal_weights_and_1_for_one(void **state)
{
    bis_light *light = lit_new_light(LIT_CONSTANT, 1, 0, false);
    lit l;
    lit_init(&l, light, bis_phong((rgb){0.5f, 0.5f, 0.5f}, (rgb){0, 0, 0}, 1), slanted(), 40, LIT_OPEN);
    bis_settings s = bis_settings_default(&bis_sir);
    const bis_sampler sampler = one_sample(1);
    bis_stream stream;
    bis_pixel_candidates c;
    bis_stream_init(&stream, &sampler, 0, 0);
    assert_int_equal(bis_pixel_candidates_draw(&c, &l.pt, &s, &stream, NULL), BIS_OK);
    assert_near(c.ess, 800, 1e-3); /* f cos/q_f is constant */
    assert_near(c.largest, 1 / 800.0, 1e-8);
    assert_int_equal(c.positive, 800);
    bis_pixel_candidates_clear(&c);
    s.candidates = s.shadowrays = 1;
    bis_stream_init(&stream, &sampler, 0, 0);
    assert_int_equal(bis_pixel_candidates_draw(&c, &l.pt, &s, &stream, NULL), BIS_OK);
    assert_near(c.ess, 1, 1e-12);
    assert_near(c.largest, 1, 1e-12);
    assert_true(c.positive == 1 && c.distinct == 1 && c.seen == 1 && c.c[0].chosen == 1 && c.c[0].seen);
    bis_pixel_candidates_clear(&c);
    bis_light_free(light);
}

/* No light above the horizon: nothing weighs, nothing is chosen, and all figures are numbers or say that they are
 * none. */
static void candidates_without_weight_are_told(void **state)
{
    bis_light *light = lit_new_light(LIT_BELOW, 1, 0.15, false);
    lit l;
    lit_init(&l, light, glossy(), (vec3){0, 0, 1}, 20, LIT_OPEN);
    const bis_settings s = bis_settings_default(&bis_sir);
    const bis_sampler sampler = one_sample(1);
    bis_stream stream;
    bis_pixel_candidates c;
    bis_stream_init(&stream, &sampler, 0, 0);
    assert_int_equal(bis_pixel_candidates_draw(&c, &l.pt, &s, &stream, NULL), BIS_OK);
    assert_true(
        c.W == 0 && c.ess == 0 && c.positive == 0 && c.distinct == 0 && isnan(c.share_em) && rgbd_sum(c.L) == 0);
    bis_pixel_candidates_clear(&c);
    bis_light_free(light);
}

/* ---- shadow rays ---- */

static void every_ray_of_every_integrator_is_overheard(void **state)
{
    enum { RUNS = 5 };
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0.15, false);
    lit l;
    lit_init(&l, light, glossy(), slanted(), 40, LIT_HALF);
    for (int i = 0; bis_integrators[i]; i++) {
        const bis_settings s = bis_settings_default(bis_integrators[i]);
        const bis_sampler sampler = one_sample(21);
        bis_pixel_rays r;
        l.counters.shadow_rays = 0;
        assert_int_equal(bis_pixel_rays_record(&r, &l.pt, &s, &sampler, 8, RUNS, NULL), BIS_OK);
        assert_int_equal(r.n, l.counters.shadow_rays);
        assert_true((r.n > 0) == (bis_integrators[i] != &bis_unoccluded));
        for (size_t k = 0; k < r.n; k++) {
            assert_true(r.ray[k].seen == (r.ray[k].wi.y <= 0)); /* LIT_HALF */
            assert_true(r.ray[k].run < RUNS && (k == 0 || r.ray[k].run >= r.ray[k - 1].run));
            assert_true(bis_pixel_product(&l.pt, r.ray[k].wi) > 0);
        }
        bis_pixel_rays_clear(&r);
    }
    bis_light_free(light);
}

static void the_rays_of_sir_go_to_the_chosen_candidates(void **state)
{
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0.15, false);
    lit l;
    lit_init(&l, light, glossy(), slanted(), 40, LIT_HALF);
    const bis_settings s = bis_settings_default(&bis_sir);
    const bis_sampler sampler = one_sample(31);
    bis_pixel_rays r;
    bis_pixel_candidates c;
    bis_stream stream;
    assert_int_equal(bis_pixel_rays_record(&r, &l.pt, &s, &sampler, 6, 1, NULL), BIS_OK);
    bis_stream_init(&stream, &sampler, 6, 0);
    assert_int_equal(bis_pixel_candidates_draw(&c, &l.pt, &s, &stream, NULL), BIS_OK);
    assert_int_equal(r.n, c.distinct);
    size_t k = 0;
    for (uint32_t i = 0; i < c.M; i++) {
        if (c.c[i].chosen == 0) continue;
        assert_memory_equal(&r.ray[k].wi, &c.c[i].wi, sizeof(vec3));
        assert_true(r.ray[k++].seen == c.c[i].seen);
    }
    bis_pixel_candidates_clear(&c);
    bis_pixel_rays_clear(&r);
    bis_light_free(light);
}

/* ---- no memory ---- */

/* The drawings': tests/cli/test_no_memory.c. */
static void every_allocation_may_fail(void **state)
{
    bis_light *light = lit_new_light(LIT_ONE_BLOCK, 1, 0.15, false);
    const bis_sampler sampler = one_sample(3);
    bis_pixel_method methods[BIS_PIXEL_MAX_METHODS];
    bis_pixel_exact exact;
    lit l;
    lit_init(&l, light, glossy(), slanted(), 40, LIT_OPEN);
    bis_settings sir = bis_settings_default(&bis_sir), by_mis = bis_settings_default(&bis_mis);
    assert_true(bis_pixel_methods(methods, &sir) > 0);
    assert_int_equal(bis_pixel_exact_of(&exact, &l.pt, BIS_PIXEL_MAX_PATCHES, 1, NULL), BIS_OK);
    for (int what = 0; what < 7; what++) {
        sir.proposal = what < 4 ? BIS_PROPOSAL_MIX : BIS_PROPOSAL_PRODUCT;
        FOR_LACK(turn) {
            bis_stream stream;
            bis_pixel_candidates c = {0};
            bis_pixel_rays r = {0};
            bis_pixel_exact e;
            bis_pixel_method m = methods[0];
            bis_pixel_mis mis;
            bis_diag diag = {0};
            bis_stream_init(&stream, &sampler, 0, 0);
            LACK(turn, what == 0   ? bis_pixel_exact_of(&e, &l.pt, BIS_PIXEL_MAX_PATCHES, 1, &diag)
                       : what == 1 ? bis_pixel_method_run(&m, &l.pt, &exact, BIS_SAMPLER_RANDOM, 4, 1, &diag)
                       : what == 6 ? bis_pixel_mis_of(&mis, &l.pt, &by_mis, 4, 1, &diag)
                       : what % 2  ? bis_pixel_candidates_draw(&c, &l.pt, &sir, &stream, &diag)
                                   : bis_pixel_rays_record(&r, &l.pt, &sir, &sampler, 0, 20, &diag));
            assert_int_equal(turn.status == BIS_OK, turn.over);
            assert_int_equal(diag.n_errors, !turn.over);
            if (!turn.over) assert_non_null(strstr(diag.messages[0].text, "no memory for "));
            bis_diag_clear(&diag);
            bis_pixel_candidates_clear(&c);
            bis_pixel_rays_clear(&r);
        }
    }
    bis_pixel_mis none; /* as many samples as would be 2 N, if numbers had no end */
    assert_int_equal(bis_pixel_mis_of(&none, &l.pt, &by_mis, SIZE_MAX / by_mis.samples + 2, 1, NULL), BIS_NOMEM);
    bis_light_free(light);
}

/* ---- the command ---- */

#define DIR "build/test_pixel"
#define SCENE DIR "/scene.txt"

/* From above, orthographic, a film of 8 x 4, x to the left: nothing in the upper left corner, then a triangle, a
 * sphere, and two triangles of a square. */
static void write_scene(const char *path, const char *light, const char *more)
{
    char text[4096];
    snprintf(text, sizeof text,
             "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 4\n"
             "Integrator \"sir\" \"integer candidates\" 60 \"integer shadowrays\" 5\n"
             "LookAt 0 0 10  0 0 0  0 1 0\n"
             "Camera \"orthographic\" \"float screenwindow\" [-4 4 -2 2]\n"
             "WorldBegin\n%s"
             "Material \"phong\" \"rgb Kd\" [0.4 0.3 0.2] \"rgb Ks\" [0.3 0.3 0.3] \"float exponent\" 30\n"
             "Shape \"trianglemesh\" \"point3 P\" [-4 -2 0  -2 -2 0  -2 2 0  -4 2 0] \"integer indices\" [0 1 2  0 2 "
             "3]\n"
             "Translate 0 0 -1\nShape \"sphere\" \"float radius\" 1.5\n"
             "Shape \"trianglemesh\" \"point3 P\" [1.6 -2 0  3 -2 0  1.6 9 0] \"integer indices\" [0 1 2]\n%s",
             light, more);
    program_write_file(path, text);
}

/* The folder anew, its subfolders, too; and the map. */
static void start(void)
{
    assert_int_equal(system("rm -rf " DIR), 0);
    program_folder(DIR);
    bis_envmap em = map_random(32, 16, 3, 0.1, 2);
    const bis_image image = {32, 16, em.pixels, NULL};
    assert_int_equal(bis_image_save(&image, DIR "/map.pfm", NULL), BIS_OK);
    bis_envmap_clear(&em);
}

static const char *const map_light = "LightSource \"infinite\" \"string filename\" \"map.pfm\"\n";

static double json_real(const char *text, const char *path)
{
    char value[64];
    json_value(value, sizeof value, text, path);
    assert_true(*value);
    return atof(value);
}

/* A table in memory: the field of row r (0: the header) and of the column with this name. */
typedef struct table {
    char text[1 << 18];
    int n_rows; /* header included */
} table;

static const char *field(char buf[128], const table *t, int row, const char *column)
{
    const char *line = t->text, *head = t->text;
    int k = 0;
    while (strncmp(head, column, strlen(column)) != 0 || !strchr(",\n", head[strlen(column)])) {
        head += strcspn(head, ",\n");
        assert_true(*head == ',');
        head++;
        k++;
    }
    for (int i = 0; i < row; i++) line = strchr(line, '\n') + 1;
    for (int i = 0; i < k; i++) {
        line += strcspn(line, ",\n");
        assert_true(*line == ',');
        line++;
    }
    snprintf(buf, 128, "%.*s", (int)strcspn(line, ",\n"), line);
    return buf;
}

static void read_table(table *t, const char *path)
{
    read_text(t->text, sizeof t->text, path);
    t->n_rows = 0;
    int commas = -1;
    for (const char *line = t->text; *line;
        line = strchr(line, '\n') + 1) { /* each line ends, and has as many fields as the first */
        int n = 0;
        for (const char *c = line; *c != '\n'; c++) {
            assert_true(*c);
            n += *c == ',';
        }
        if (commas < 0) commas = n;
        assert_int_equal(n, commas);
        t->n_rows++;
    }
}

static double sum_of(const table *t, const char *column)
{
    char buf[128];
    double sum = 0;
    for (int i = 1; i < t->n_rows; i++) sum += atof(field(buf, t, i, column));
    return sum;
}

static void the_command_writes_tables_that_sum_to_what_it_says(void **state)
{
    static program_run r;
    static table t;
    char buf[128];
    start();
    write_scene(SCENE, map_light, "");
    program_expect(&r, 0, "pixel --json --html --repeats 50 --output " DIR "/out " SCENE " 3 2");
    assert_string_equal(r.messages, "");
    assert_true(json_is_valid(r.output));
    assert_int_equal(program_count_files(DIR "/out"), 4);
    char *page = page_data(DIR "/out/pixel.html");
    assert_near(json_real(page, "exact.sum") / json_real(r.output, "exact.sum"), 1, 0); /* what --json says */
    free(page);
    page = page_shown(DIR "/out/pixel.html#all", DIR);
    if (page) assert_non_null(strstr(page, "<h1>Pixel (3, 2) of scene.txt</h1>"));
    free(page);

    read_table(&t, DIR "/out/candidates.csv");
    assert_int_equal(t.n_rows, 61);
    assert_near(sum_of(&t, "weight") / json_real(r.output, "candidates.weights"), 1, 1e-12);
    assert_near(sum_of(&t, "share"), 1, 1e-12);
    assert_near(sum_of(&t, "chosen"), 5, 0);
    double squares = 0, map = 0, seen = 0;
    for (int i = 1; i < t.n_rows; i++) {
        const double w = atof(field(buf, &t, i, "weight"));
        squares += w * w;
        map += strcmp(field(buf, &t, i, "from"), "map") == 0;
        seen += atof(field(buf, &t, i, "seen")) > 0 ? atof(field(buf, &t, i, "chosen")) : 0;
    }
    const double W = sum_of(&t, "weight");
    assert_near(json_real(r.output, "candidates.effective_sample_size") / (W * W / squares), 1, 1e-12);
    assert_near(json_real(r.output, "candidates.share_of_map") * 60, map, 1e-9);
    assert_near(json_real(r.output, "candidates.seen"), seen, 0);

    read_table(&t, DIR "/out/methods.csv");
    assert_int_equal(t.n_rows, 1 + 2 + n_methods());
    assert_near(atof(field(buf, &t, 1, "sum")) / json_real(r.output, "exact.sum"), 1, 1e-12);
    assert_near(atof(field(buf, &t, 2, "se_sum")) / json_real(r.output, "unoccluded.sum_standard_error"), 1, 1e-12);
    assert_string_equal(field(buf, &t, 3, "method"), "em");
    for (int i = 1; i < t.n_rows; i++) {
        const double colours =
            atof(field(buf, &t, i, "r")) + atof(field(buf, &t, i, "g")) + atof(field(buf, &t, i, "b"));
        char sum[128];
        assert_near(colours / atof(field(sum, &t, i, "sum")), 1, 1e-9);
    }
    read_table(&t, DIR "/out/rays.csv");
    assert_true(t.n_rows > 100);
    for (int i = 1; i < t.n_rows; i++) assert_true(atof(field(buf, &t, i, "product")) > 0);
}

/* The surface of pixel (6, 3) faces the eye: n, wo and the mirrored direction are all z, and the material's density is
 * a formula of z: half of it is a lobe of exponent 30, since Ks and Kd have the same sum. */
static double density_of_the_brdf(double z) { return z > 0 ? 0.5 * 31 / (2 * PI) * pow(z, 30) + 0.5 * z / PI : 0; }

/* Each column holds what its name says: directions are unit and have their angles, q_brdf is the formula above, q the
 * mixture of q_map and q_brdf by the share that is told, and the weight the product over q. The line "seen" is exact
 * over unoccluded. */
static void each_column_of_the_tables_is_what_it_is_called(void **state)
{
    static program_run r;
    static table t;
    char buf[128], line[64];
    int n = 0;
    start();
    write_scene(SCENE, map_light,
        "Shape \"trianglemesh\" \"point3 P\" [-1.9 -9 1  -1.9 9 1  -1.9 9 9  -1.9 -9 9] \"integer indices\" [0 1 2  0 "
        "2 3]\n"); /* a wall */
    program_expect(&r, 0, "pixel --json --repeats 20 --output " DIR "/out " SCENE " 6 3");
    const double beta = json_real(r.output, "candidates.share_of_map"), seen = json_real(r.output,
        "exact.sum") / json_real(r.output, "unoccluded.sum");
    assert_true(seen > 0.1 && seen < 0.95 && fabs(beta - 0.5) > 0.01); /* else the checks below could not tell */
    for (int k = 0; k < 2; k++) {
        read_table(&t, k ? DIR "/out/rays.csv" : DIR "/out/candidates.csv");
        for (int i = 1; i < t.n_rows; i++) {
            if (!*field(buf, &t, i, "x")) continue;
            const double x = atof(buf), y = atof(field(buf, &t, i, "y")), z = atof(field(buf, &t, i, "z")),
                theta = atof(field(buf, &t, i, "theta_deg")),
                         phi = atof(field(buf, &t, i, "phi_deg")), q_map = atof(field(buf, &t, i, "q_map")),
                             q_brdf = atof(field(buf, &t, i, "q_brdf"));
            assert_near(x * x + y * y + z * z, 1, 1e-6);
            assert_near(cos(theta * PI / 180), z, 1e-6);
            assert_near(sin(theta * PI / 180) * cos(phi * PI / 180), x, 1e-6);
            assert_near(sin(theta * PI / 180) * sin(phi * PI / 180), y, 1e-6);
            assert_near(q_brdf, density_of_the_brdf(z), 1e-5 * (1 + q_brdf));
            n++;
            if (k) continue;
            const double q = atof(field(buf, &t, i, "q")), product = atof(field(buf, &t, i, "product"));
            assert_near(q / (beta * q_map + (1 - beta) * q_brdf), 1, 1e-5);
            assert_near(atof(field(buf, &t, i, "weight")) * q / product, 1, 1e-5);
        }
    }
    assert_true(n > 200);
    program_expect(&r, 0, "pixel --repeats 20 --output " DIR "/out " SCENE " 6 3");
    snprintf(line, sizeof line, "seen        %.2f %%\n", 100 * seen);
    assert_non_null(strstr(r.output, line));
}

static void a_hit_knows_its_shape_and_triangle(void **state)
{
    start();
    write_scene(SCENE, map_light, "");
    verify_built built = verify_build(SCENE);
    const struct { int x, y; bis_shape_kind kind; int line; uint32_t part; double t; } cases[] = {
        {6, 3, BIS_SHAPE_TRIANGLES, 8, 0, 10}, {7, 0, BIS_SHAPE_TRIANGLES, 8, 1, 10},
        {4, 1, BIS_SHAPE_SPHERE, 10, 0, 0},
        {1, 3, BIS_SHAPE_TRIANGLES, 11, 0, 11}};
    for (size_t i = 0; i < 4; i++) {
        bis_counters counters = {0};
        bis_pixel_hit hit;
        bis_point pt;
        assert_true(bis_pixel_find(&hit, &pt, built.scene, cases[i].x, cases[i].y, &counters));
        assert_int_equal(built.desc->shapes[hit.shape].kind, cases[i].kind);
        assert_int_equal(built.desc->shapes[hit.shape].loc.line, cases[i].line);
        if (cases[i].t == 0) continue;
        assert_int_equal(hit.part, cases[i].part);
        assert_near(hit.t, cases[i].t, 1e-5);
        assert_true(pt.ng.x == 0 && pt.ng.y == 0 && pt.ng.z == 1);
    }
    verify_clear(&built);
}

static void a_pixel_where_nothing_is_reflected_gets_a_clear_answer(void **state)
{
    static program_run r;
    start();
    write_scene(SCENE, map_light, "");
    write_scene(DIR "/dark.txt", "", "");
    write_scene(DIR "/black.txt", map_light,
                "Material \"phong\" \"rgb Kd\" [0 0 0] \"rgb Ks\" [0 0 0]\nShape \"disk\" \"float radius\" 50 \"float "
                "height\" 5\n");
    const struct { const char *scene, *answer; } cases[] = {
        {SCENE, "no surface"}, {DIR "/dark.txt", "no surface"}, {DIR "/black.txt", "the material is black"}};
    for (size_t i = 0; i < 3; i++) {
        program_expect(&r, 0, "pixel %s 0 0 --output " DIR "/none", cases[i].scene);
        assert_non_null(strstr(r.output, cases[i].answer));
        program_expect(&r, 0, "pixel %s 0 0 --json --output " DIR "/none", cases[i].scene);
        assert_true(json_is_valid(r.output));
        char value[128];
        assert_non_null(strstr(json_value(value, sizeof value, r.output, "nothing"), cases[i].answer));
        assert_int_equal(strcmp(json_value(value, sizeof value, r.output, "hit"), "null") == 0, i < 2);
    }
    program_expect(&r, 0, "pixel " DIR "/dark.txt 6 3 --output " DIR "/none");
    assert_non_null(strstr(r.output, "no light"));
    assert_false(program_exists(DIR "/none")); /* no files for nothing */
}

/* Further mistakes are in tests/data/expect/bis/options-others.expect. */
static void wrong_places_and_options_are_refused(void **state)
{
    static program_run r;
    start();
    write_scene(SCENE, map_light, "");
    program_write_file(DIR "/file", "");
    char longest[4200] = SCENE " 1 1 --repeats 2 --output " DIR; /* a folder with a name whose files have none */
    memset(longest + strlen(longest), '/', 4090 - strlen(DIR));
    const struct { int status; const char *arguments, *message; } cases[] = {
        {2, SCENE " 8 0", "X is \"8\", must be an integer in [0, 7]: the film of the scene has 8 x 4 pixels"},
        {2, SCENE " 0 4", "Y is \"4\", must be an integer in [0, 3]"},
        {2, SCENE " 0 -1", "unknown option \"-1\""},
        {1, SCENE " 1 1 --repeats 2 --output " DIR "/file", "is no folder"},
        {1, SCENE " 1 1 --repeats 2 --output " DIR "/no/such", "cannot be made"},
        {1, longest, "the name is too long"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        program_expect(&r, cases[i].status, "pixel %s", cases[i].arguments);
        if (!strstr(r.messages, cases[i].message)) fail_msg("`pixel %s` says: %s", cases[i].arguments, r.messages);
        assert_string_equal(r.output, "");
    }
}

static void options_override_the_scene_for_all_methods(void **state)
{
    static program_run r;
    static table t;
    char buf[128];
    start();
    write_scene(SCENE, map_light, "");
    program_expect(&r, 0,
        "pixel " SCENE
        " 3 2 --repeats 3 --candidates 17 --shadowrays 4 --samples 6 --proposal em --seed 5 --json --output " DIR "/o");
    assert_near(json_real(r.output, "seed"), 5, 0);
    assert_near(json_real(r.output, "candidates.drawn"), 17, 0);
    assert_near(json_real(r.output, "candidates.shadowrays"), 4, 0);
    assert_near(json_real(r.output, "candidates.share_of_map"), 1, 0);
    read_table(&t, DIR "/o/candidates.csv");
    assert_int_equal(t.n_rows, 18);
    read_table(&t, DIR "/o/methods.csv");
    assert_string_equal(field(buf, &t, 3, "repeats"), "3");
    static program_run again;
    program_expect(&again, 0,
        "pixel " SCENE
        " 3 2 --repeats 3 --candidates 17 --shadowrays 4 --samples 6 --proposal em --seed 5 --json --output " DIR "/o");
    assert_string_equal(
        r.output, again.output); /* a folder that is there is written into; the same seed, the same numbers */
}

/* What a method's row of methods.csv says in `column`. */
static void method_says(char text[128], const table *t, const char *method, const char *column)
{
    char name[128];
    int row = 1;
    while (strcmp(field(name, t, row, "method"), method) != 0) assert_true(++row < t->n_rows);
    field(text, t, row, column);
}

/* With --proposal P the row of sir is that of a scene which names P, and unlike that of any other P. That of
 * unoccluded, which has no "product", is that of "mix" there. */
static void each_proposal_is_measured_by_its_name(void **state)
{
    static const char *const names[] = {"em", "brdf", "mix", "product"};
    static program_run r;
    static table t;
    char sir[4][128], open[4][128], named[128];
    start();
    write_scene(SCENE, map_light, "");
    for (int k = 0; k < 4; k++) {
        program_expect(
            &r, 0, "pixel " SCENE " 3 2 --repeats 3 --seed 5 --json --proposal %s --output " DIR "/p", names[k]);
        read_table(&t, DIR "/p/methods.csv");
        method_says(sir[k], &t, "sir", "r");
        method_says(open[k], &t, "unoccluded", "r");
        const double of_map = json_real(r.output, "candidates.share_of_map");
        if (k < 2) assert_near(of_map, k == 0, 0);
        else assert_true(of_map > 0);
        char command[256];
        snprintf(command, sizeof command, "sed 's/\"sir\"/& \"string proposal\" \"%s\"/' " SCENE " >" DIR "/named.txt",
            names[k]);
        assert_int_equal(system(command), 0);
        program_expect(&r, 0, "pixel " DIR "/named.txt 3 2 --repeats 3 --seed 5 --json --output " DIR "/p");
        read_table(&t, DIR "/p/methods.csv");
        method_says(named, &t, "sir", "r");
        assert_string_equal(sir[k], named);
        for (int j = 0; j < k; j++) {
            assert_string_not_equal(sir[j], sir[k]);
            if (k < 3) assert_string_not_equal(open[j], open[k]);
        }
    }
    assert_string_equal(open[3], open[2]);
}

/* The runs that are shown are the fewest with 150 rays or more. The first run of a method is 0. */
static void as_many_runs_are_shown_as_make_150_rays(void **state)
{
    static const int rays[][2] = {{149, 4}, {150, 150}}; /* of em and brdf, of sir */
    start();
    write_scene(SCENE, map_light, "");
    for (size_t k = 0; k < sizeof rays / sizeof *rays; k++) {
        static program_run r;
        static const char *const methods[] = {"em,", "brdf,", "sir,"};
        program_expect(&r, 0, "pixel " SCENE " 3 2 --repeats 2 --samples %d --shadowrays %d --output " DIR "/shown",
            rays[k][0], rays[k][1]);
        char line[512];
        int last[3] = {-1, -1, -1};
        FILE *f = fopen(DIR "/shown/rays.csv", "r");
        assert_non_null(f);
        while (fgets(line, sizeof line, f))
            for (int i = 0; i < 3; i++)
                if (strncmp(line, methods[i], strlen(methods[i])) == 0) last[i] = atoi(line + strlen(methods[i]));
        fclose(f);
        for (int i = 0; i < 3; i++) {
            int runs = 1;
            while (runs * rays[k][i == 2] < 150) runs++;
            assert_int_equal(last[i], runs - 1);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_best_weights_leave_nothing_of_a_mixture),
        cmocka_unit_test(figures_of_mis_are_those_of_its_samples),
        cmocka_unit_test(figures_of_a_method_follow_from_the_truth),
        cmocka_unit_test(what_has_no_figure_is_not_a_number),
        cmocka_unit_test(methods_have_the_scenes_numbers),
        cmocka_unit_test(a_sum_has_its_cells),
        cmocka_unit_test(exact_is_what_brute_force_gives),
        cmocka_unit_test(a_long_mis_stands_in_for_huge_maps),
        cmocka_unit_test(what_the_surface_itself_hides_is_hidden_and_in_L_ns),
        cmocka_unit_test(methods_agree_with_exact_and_a_wrong_one_does_not),
        cmocka_unit_test(skewness_is_known_even_of_what_was_not_hit),
        cmocka_unit_test(figures_of_a_method_are_those_of_its_estimates),
        cmocka_unit_test(mis_gets_nothing_where_nothing_is_drawn),
        cmocka_unit_test(candidates_are_those_of_sir_and_their_figures_those_of_the_definitions),
        cmocka_unit_test(candidates_of_the_product_are_as_dense_as_their_q_says),
        cmocka_unit_test(the_estimate_shown_is_what_renders),
        cmocka_unit_test(the_estimate_shown_is_that_of_sir_with_E6_E21_and_E23_as_printed),
        cmocka_unit_test(effective_sample_size_is_M_for_equal_weights_and_1_for_one),
        cmocka_unit_test(candidates_without_weight_are_told),
        cmocka_unit_test(every_ray_of_every_integrator_is_overheard),
        cmocka_unit_test(the_rays_of_sir_go_to_the_chosen_candidates),
        cmocka_unit_test(every_allocation_may_fail),
        cmocka_unit_test(the_command_writes_tables_that_sum_to_what_it_says),
        cmocka_unit_test(each_column_of_the_tables_is_what_it_is_called),
        cmocka_unit_test(a_hit_knows_its_shape_and_triangle),
        cmocka_unit_test(a_pixel_where_nothing_is_reflected_gets_a_clear_answer),
        cmocka_unit_test(wrong_places_and_options_are_refused),
        cmocka_unit_test(options_override_the_scene_for_all_methods),
        cmocka_unit_test(each_proposal_is_measured_by_its_name),
        cmocka_unit_test(as_many_runs_are_shown_as_make_150_rays),
    };
    return cmocka_run_group_tests_name("pixel", tests, NULL, NULL);
}
