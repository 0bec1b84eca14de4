/* SPDX-License-Identifier: BSD-2-Clause */
/* integrators: every estimator against brute force (tests/support/lit.h), and the cases where the answer is exact.
 * Family-wise significance of this file 1e-3, three channels a test. What is biased by design, and the twins, are in
 * test_sir.c, test_rejection.c. */
#include "bis/beyond/microfacet.h"
#include "bis/thesis/phong.h"
#include "bis/thesis/rng.h"

#include "claim.h"
#include "forced.h"
#include "lit.h"

#include <string.h>

#define SEED 31u

/* Three channels of twelve points with microfacets for each integrator that there is, and the tests of named ones. */
static double alpha(void)
{
    int n = 0;
    while (bis_integrators[n]) n++;
    return stat_level(1e-3, 3 * 12 * n + 947);
}

static bis_material glossy(void)
{
    return bis_phong((rgb){0, 0, 0}, (rgb){0.9f, 0.8f, 0.7f}, 10);
}

/* ---- unbiased ---- */

/* What the configurations run through: light, material, occluder. Each configuration takes the next of the 24 (2 maps,
 * b = 0 and 0.15, 3 materials, 2 occluders), so that all pairs with the integrators' own parameters occur. */
typedef struct setting {
    bis_light *lights[4];
    lit points[24];
    rgbd truth[24], unshadowed[24];
    int next;
} setting;

static void setting_init(setting *c)
{
    const bis_material materials[] = {
        bis_phong((rgb){0.8f, 0.5f, 0.2f}, grey(0), 1), glossy(), bis_phong(grey(0.5), (rgb){0.5f, 0.3f, 0.1f}, 50)};

    c->next = 0;
    for (int i = 0; i < 4; i++)
        c->lights[i] = lit_new_light(i / 2 ? LIT_SMOOTH : LIT_SPOTTY, 1, i % 2 ? 0.15 : 0, false);
    for (int i = 0; i < 24; i++) {
        lit_init(&c->points[i], c->lights[i % 4], materials[i % 3], lit_tilted(), 40, i / 12 ? LIT_HALF : LIT_OPEN);
        c->truth[i] = lit_truth(&c->points[i], true);
        c->unshadowed[i] = lit_truth(&c->points[i], false);
    }
}

static void setting_clear(setting *c)
{
    for (int i = 0; i < 4; i++) bis_light_free(c->lights[i]);
}

static void check(const char *name, const stat_moments m[4], rgbd truth)
{
    stat_assert_mean(name, SEED, &m[0], truth.r, alpha());
    stat_assert_mean(name, SEED, &m[1], truth.g, alpha());
    stat_assert_mean(name, SEED, &m[2], truth.b, alpha());
}

static void check_next(setting *c, const bis_settings *s, uint32_t cost)
{
    static const bis_sampler_kind kinds[] = {
        BIS_SAMPLER_RANDOM, BIS_SAMPLER_STRATIFIED, BIS_SAMPLER_SOBOL, BIS_SAMPLER_HALTON};
    const int i = c->next++ % 24;
    /* directions of the BRDF meet the spots of a map seldom: more runs, so that an error of a half is found */
    const bool by_brdf = s->integrator == &bis_brdf || (s->integrator != &bis_em && s->integrator != &bis_mis &&
                                                        s->proposal == BIS_PROPOSAL_BRDF);
    const uint32_t runs = (by_brdf && i % 4 < 2 ? 10 : 1) * (200000 / (cost + 3));
    stat_moments m[4];

    assert_int_equal(bis_settings_check(s, (bis_loc){NULL, 0, 0}, NULL), BIS_OK);
    c->points[i].kind = kinds[c->next % 4];
    lit_run(m, &c->points[i], s, runs, SEED + (uint64_t)c->next);
    check(s->integrator->name, m, s->integrator == &bis_unoccluded ? c->unshadowed[i] : c->truth[i]);
}

static const uint32_t counts_M[] = {1, 2, 8, 64}, counts_N[] = {1, 15};

static void em_and_brdf_are_unbiased(void **state)
{
    setting c;

    setting_init(&c);
    for (int i = 0; i < 48; i++) {
        bis_settings s = bis_settings_default(i / 24 ? &bis_brdf : &bis_em);
        s.samples = counts_N[i % 2];
        check_next(&c, &s, s.samples);
    }
    setting_clear(&c);
}

static void mis_is_unbiased_for_each_heuristic_and_split(void **state)
{
    static const double splits[] = {0, 0.1, 0.5, 1};
    setting c;

    setting_init(&c);
    for (int i = 0; i < 32; i++) {
        bis_settings s = bis_settings_default(&bis_mis);
        s.samples = i % 2 ? 15 : 2;
        s.split = splits[i / 2 % 4];
        s.heuristic = i / 8 % 2 ? BIS_HEURISTIC_POWER : BIS_HEURISTIC_BALANCE;
        check_next(&c, &s, s.samples);
        c.next += i % 5; /* 32 and 24 share factors: shift */
    }
    setting_clear(&c);
}

static void compensated_mis_is_unbiased(void **state)
{
    for (int i = 0; i < 8; i++) {
        bis_light *light = lit_new_light(i % 2 ? LIT_SMOOTH : LIT_SPOTTY, 1, i / 4 ? 0.15 : 0, true);
        bis_settings s = bis_settings_default(&bis_mis);
        stat_moments m[4];
        lit l;
        s.compensate = true;
        s.samples = 4;
        s.heuristic = i / 2 % 2 ? BIS_HEURISTIC_POWER : BIS_HEURISTIC_BALANCE;
        lit_init(&l, light, bis_phong(grey(0.5), grey(0.5), 20), lit_tilted(), 40, LIT_HALF);
        lit_run(m, &l, &s, 30000, SEED);
        check("mis_compensated", m, lit_truth(&l, true));
        bis_light_free(light);
    }
}

/* What an integrator asks of a material, it asks through bis/bsdf.h: a second model must come out right without a
 * line of theirs. */
static void every_integrator_is_unbiased_for_microfacets_too(void **state)
{
    const bis_material materials[] = {bis_microfacet(grey(0), (rgb){0.9f, 0.6f, 0.3f}, 0.4),
                                      bis_microfacet((rgb){0.2f, 0.5f, 0.8f}, grey(0.04), 0.7),
                                      bis_plastic((rgb){0.1f, 0.3f, 0.6f}, (rgb){0.16f, 0.1f, 0}, 2.4, 0.5)};
    bis_light *lights[] = {lit_new_light(LIT_SPOTTY, 1, 0.15, false), lit_new_light(LIT_SMOOTH, 1, 0, false)};

    for (int i = 0; i < 12; i++) {
        lit l;
        lit_init(&l, lights[i % 2], materials[i / 2 % 3], lit_tilted(), i / 6 ? 75 : 40, i / 6 ? LIT_OPEN : LIT_HALF);
        const rgbd truth = lit_truth(&l, true), unshadowed = lit_truth(&l, false);
        for (int k = 0; bis_integrators[k]; k++) {
            bis_settings s = bis_settings_default(bis_integrators[k]);
            stat_moments m[4];
            s.estimator = BIS_ESTIMATOR_PLAIN;
            s.samples = s.shadowrays = 4;
            s.candidates = 16;
            l.kind = (bis_sampler_kind)((i + k) % 4);
            const uint32_t more = bis_integrators[k] == &bis_brdf && i % 2 == 0 ? 10 : 1; /* as in check_next */
            lit_run(m, &l, &s, bis_integrators[k] == &bis_exact ? 10 : more * 20000, SEED + (uint64_t)i);
            check(bis_integrators[k]->name, m, bis_integrators[k] == &bis_unoccluded ? unshadowed : truth);
        }
    }
    for (int i = 0; i < 2; i++) bis_light_free(lights[i]);
}

/* Twin: the balance heuristic with half of each density, (q_em + q_brdf)/2, is right only when both techniques draw
 * equally many. */
static void balance_heuristic_needs_the_counts(void **state)
{
    enum { N_EM = 1, N_BRDF = 3 };
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0, false);
    stat_moments right = {0}, wrong = {0};
    bis_rng r;
    lit l;

    lit_init(&l, light, bis_phong(grey(0.5), grey(0.5), 5), lit_tilted(), 40, LIT_OPEN);
    double truth = lit_truth(&l, true).g;
    bis_rng_init(&r, SEED, 0, 0, 0);
    for (int run = 0; run < 40000; run++) {
        double sum[2] = {0, 0};
        for (int j = 0; j < N_EM + N_BRDF; j++) {
            bis_light_point y;
            double q_brdf, u[4];
            for (int k = 0; k < 4; k++) u[k] = bis_rng_double(&r);
            if (j < N_EM) {
                assert_true(bis_light_sample(light, u, &y));
            } else {
                assert_true(bis_bsdf_sample(&l.pt.bsdf, u[0], u[1], u[2], &y.wi));
                y.Le = bis_light_Le(light, y.wi);
                y.pdf = bis_light_pdf(light, y.wi);
            }
            double F = (double)bis_bsdf_f_pdf(&l.pt.bsdf, y.wi, &q_brdf).g * fmax(0, bis_bsdf_cos(&l.pt.bsdf, y.wi)) *
                       (double)y.Le.g;
            if (F <= 0) continue;
            sum[0] += F / (N_EM * y.pdf + N_BRDF * q_brdf);
            sum[1] += F / ((y.pdf + q_brdf) / 2 * (N_EM + N_BRDF));
        }
        stat_add(&right, sum[0]);
        stat_add(&wrong, sum[1]);
    }
    stat_assert_mean("mis_twin", SEED, &right, truth, alpha());
    stat_assert_not_mean("mis_without_counts", SEED, &wrong, truth, alpha());
    bis_light_free(light);
}

static void sir_is_unbiased_for_every_M_and_N_E21(void **state)
{
    setting c;

    setting_init(&c);
    for (int i = 0; i < 3 * 4 * 2 * 2 * 2; i++) {
        bis_settings s = bis_settings_default(&bis_sir);
        s.proposal = (bis_proposal)(i % 3); /* em, brdf, mix */
        s.candidates = counts_M[i / 3 % 4];
        s.shadowrays = counts_N[i / 12 % 2];
        s.resampling = i / 24 % 2 ? BIS_RESAMPLING_MULTINOMIAL : BIS_RESAMPLING_SYSTEMATIC;
        s.stratify = i / 48;
        check_next(&c, &s, s.candidates + s.shadowrays);
        c.next += i % 7;
    }
    setting_clear(&c);
}

static void plain_rejection_is_unbiased_for_every_M_and_N_E22(void **state)
{
    static const bis_proposal proposals[] = {BIS_PROPOSAL_EM, BIS_PROPOSAL_BRDF, BIS_PROPOSAL_CHOOSE};
    setting c;

    setting_init(&c);
    for (int i = 0; i < 3 * 4 * 2 * 2; i++) {
        bis_settings s = bis_settings_default(&bis_rejection);
        s.estimator = BIS_ESTIMATOR_PLAIN;
        s.proposal = proposals[i % 3];
        s.candidates = counts_M[i / 3 % 4];
        s.shadowrays = counts_N[i / 12 % 2];
        check_next(&c, &s, s.candidates + s.shadowrays);
        c.next += i % 7;
    }
    setting_clear(&c);
}

static void unoccluded_is_unbiased_for_L_ns(void **state)
{
    setting c;

    setting_init(&c);
    for (int i = 0; i < 24; i++) {
        bis_settings s = bis_settings_default(&bis_unoccluded);
        s.proposal = (bis_proposal)(i % 3);
        s.candidates = counts_M[i / 3 % 4];
        s.stratify = i / 12;
        check_next(&c, &s, s.candidates);
    }
    setting_clear(&c);
}

static void exact_is_unbiased_and_nearly_exact(void **state)
{
    setting c;

    setting_init(&c);
    for (int i = 0; i < 24; i++) {
        bis_settings s = bis_settings_default(&bis_exact);
        stat_moments m[4];
        s.perpatch = i % 2 ? 4 : 1;
        lit_run(m, &c.points[i], &s, s.perpatch == 1 ? 40 : 10, SEED);
        check("exact", m, c.truth[i]);
        assert_true(sqrt(stat_variance(&m[3])) < 0.02 * m[3].mean);
    }
    setting_clear(&c);
}

/* ---- exact cases ---- */

/* All integrators with all their proposals, M = 8, N = 3: for claims that hold for each. */
enum { N_ALL = 16 };

static void all_settings(bis_settings s[N_ALL])
{
    int k = 0;

    s[k++] = bis_settings_default(&bis_em);
    s[k++] = bis_settings_default(&bis_brdf);
    s[k++] = bis_settings_default(&bis_mis);
    s[k++] = bis_settings_default(&bis_exact);
    for (int i = 0; i < 6; i++) {
        s[k] = bis_settings_default(&bis_rejection);
        s[k].proposal = (bis_proposal[]){BIS_PROPOSAL_EM, BIS_PROPOSAL_BRDF, BIS_PROPOSAL_CHOOSE}[i % 3];
        s[k++].estimator = i / 3 ? BIS_ESTIMATOR_PLAIN : BIS_ESTIMATOR_RATIO;
    }
    for (int i = 0; i < 6; i++) {
        s[k] = bis_settings_default(&bis_sir);
        s[k].proposal = (bis_proposal)(i % 3);
        s[k++].stratify = i / 3;
    }
    for (int i = 0; i < N_ALL; i++) {
        s[i].samples = 5;
        s[i].candidates = 8;
        s[i].shadowrays = 3;
    }
}

/* Returns the number of shadow rays; asserts that all estimates are exactly 0. */
static uint64_t assert_black(lit *l)
{
    bis_settings s[N_ALL];
    uint64_t rays = 0;

    all_settings(s);
    for (int i = 0; i < N_ALL; i++) {
        stat_moments m[4];
        lit_run(m, l, &s[i], 50, SEED);
        assert_true(m[3].mean == 0 && m[3].m2 == 0);
        rays += l->counters.shadow_rays;
    }
    return rays;
}

static void fully_hidden_point_is_exactly_black_E29(void **state)
{
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0.15, false);
    lit l;

    lit_init(&l, light, glossy(), lit_tilted(), 40, LIT_ALL);
    assert_true(assert_black(&l) > 0);
    bis_light_free(light);
}

static void black_map_black_surface_and_hidden_eye_cast_no_ray(void **state)
{
    bis_light *black = lit_new_light(LIT_BLACK, 1, 0.15, false), *spotty = lit_new_light(LIT_SPOTTY, 1, 0.15, false);
    lit l;

    lit_init(&l, black, glossy(), lit_tilted(), 40, LIT_OPEN);
    assert_int_equal(assert_black(&l), 0);
    lit_init(&l, spotty, bis_phong(grey(0), grey(0), 10), lit_tilted(), 40, LIT_OPEN);
    assert_int_equal(assert_black(&l), 0);
    lit_init(&l, spotty, glossy(), lit_tilted(), 95, LIT_OPEN);
    assert_int_equal(assert_black(&l), 0);
    bis_light_free(black);
    bis_light_free(spotty);
}

static void surface_turned_away_from_all_light_casts_no_ray_E25(void **state)
{
    bis_light *below = lit_new_light(LIT_BELOW, 1, 0.15, false);
    lit l;

    lit_init(&l, below, bis_phong(grey(0.5), grey(0.5), 20), (vec3){0, 0, 1}, 40, LIT_OPEN);
    assert_int_equal(assert_black(&l), 0);
    bis_light_free(below);
}

static void no_ray_is_cast_below_the_geometric_surface_E37(void **state)
{
    bis_light *light = lit_new_light(LIT_ONE_BLOCK, 1, 0, false);
    lit l;

    lit_init(&l, light, bis_phong(grey(1), grey(0), 1), (vec3){0, 0, 1}, 40, LIT_OPEN);
    l.pt.ng = normalize(vec3_from(0.8, 0.8, 0.3)); /* the lit block lies about phi = 281 degrees: behind this face */
    assert_int_equal(assert_black(&l), 0);

    /* twin: one normal n(x), the shading normal's, and light leaks through the face */
    const bis_settings s = bis_settings_default(&bis_em);
    stat_moments m[4];
    l.pt.ng = l.pt.n;
    lit_run(m, &l, &s, 50, SEED);
    assert_true(m[3].mean > 0);
    bis_light_free(light);
}

/* The candidates of a diffuse surface from the BRDF are those of the product: no noise at all under a constant
 * light. */
static void constant_light_on_open_diffuse_plane_is_exact_from_the_brdf_and_right_in_the_mean_for_all(void **state)
{
    bis_light *light = lit_new_light(LIT_CONSTANT, 2, 0, false);
    bis_settings s[N_ALL];
    lit l;

    lit_init(&l, light, bis_phong((rgb){0.5f, 0.5f, 0.8f}, grey(0), 1), lit_tilted(), 40, LIT_OPEN);
    all_settings(s);
    for (int i = 0; i < N_ALL; i++) {
        const bool from_brdf =
            s[i].integrator == &bis_brdf ||
            (s[i].integrator == &bis_sir && (s[i].proposal == BIS_PROPOSAL_BRDF || s[i].proposal == BIS_PROPOSAL_MIX));
        stat_moments m[4];
        if (s[i].integrator == &bis_exact) continue; /* 131072 rays a run: below */
        lit_run(m, &l, &s[i], from_brdf ? 100 : 20000, SEED);
        if (from_brdf) {
            assert_true(fabs(m[0].mean - 1) < 1e-6 && m[0].m2 < 1e-10);
            assert_true(fabs(m[2].mean - 0.4) < 1e-6 && m[2].m2 < 1e-10);
        } else if (s[i].integrator != &bis_rejection || s[i].estimator == BIS_ESTIMATOR_PLAIN) {
            check("constant", m, (rgbd){1, 0.5, 0.4});
        }
    }
    const bis_settings exact = bis_settings_default(&bis_exact);
    stat_moments m[4];
    lit_run(m, &l, &exact, 2, SEED);
    assert_true(fabs(m[0].mean - 1) < 1e-4 && fabs(m[2].mean - 0.4) < 1e-4);
    bis_light_free(light);
}

/* E1: the table covers the sphere; whoever drops directions below the horizon instead of counting them gets twice the
 * truth here. */
static void directions_below_the_horizon_count_E1(void **state)
{
    bis_light *light = lit_new_light(LIT_CONSTANT, 1, 0, false);
    const bis_settings s = bis_settings_default(&bis_em);
    stat_moments m[4], twin = {0};
    bis_rng r;
    lit l;

    lit_init(&l, light, bis_phong(grey(1), grey(0), 1), lit_tilted(), 0, LIT_OPEN);
    lit_run(m, &l, &s, 20000, SEED);
    check("E1", m, (rgbd){1, 0.5, 0.25});

    bis_rng_init(&r, SEED, 0, 0, 0);
    while (twin.n < 20000) {
        bis_light_point y;
        assert_true(bis_light_sample(light, (double[4]){bis_rng_double(&r), bis_rng_double(&r), 0.5, 0.5}, &y));
        double cos_theta = bis_bsdf_cos(&l.pt.bsdf, y.wi);
        if (cos_theta > 0) stat_add(&twin, (double)y.Le.r / PI * cos_theta / y.pdf);
    }
    stat_assert_not_mean("E1_dropped", SEED, &twin, 1, alpha());
    bis_light_free(light);
}

/* E5: L/q cancelled as if L were scalar turns coloured light grey. */
static void each_channel_is_right_under_coloured_light_E5(void **state)
{
    bis_light *light = lit_new_light(LIT_RED_BLUE, 1, 0, false);
    bis_settings s[N_ALL];
    lit l;

    lit_init(&l, light, bis_phong((rgb){0.9f, 0.5f, 0.3f}, grey(0), 1), lit_tilted(), 40, LIT_OPEN);
    rgbd truth = lit_truth(&l, true);
    all_settings(s);
    for (int i = 0; i < N_ALL; i++) {
        stat_moments m[4];
        if (s[i].integrator == &bis_rejection && s[i].estimator == BIS_ESTIMATOR_RATIO) continue;
        lit_run(m, &l, &s[i], s[i].integrator == &bis_exact ? 20 : 10000, SEED);
        check("E5", m, truth);
    }

    stat_moments twin = {0};
    bis_rng r;
    bis_rng_init(&r, SEED, 0, 0, 0);
    for (int i = 0; i < 20000; i++) {
        bis_light_point y;
        assert_true(bis_light_sample(
            light, (double[4]){bis_rng_double(&r), bis_rng_double(&r), bis_rng_double(&r), bis_rng_double(&r)}, &y));
        double cos_theta = fmax(0, bis_bsdf_cos(&l.pt.bsdf, y.wi));
        stat_add(&twin, (double)l.material.Kd.b / PI * cos_theta * bis_light_power(light) / 3);
    }
    stat_assert_not_mean("E5_scalar", SEED, &twin, truth.b, alpha());
    bis_light_free(light);
}

/* E4: one lit block: integral by em = by brdf = by exact = L dOmega in the mean. The lookup agrees with the table. */
static void one_lit_window_is_found_by_all_E4(void **state)
{
    bis_light *light = lit_new_light(LIT_ONE_BLOCK, 1, 0, false);
    bis_settings s[N_ALL];
    lit l;

    lit_init(&l, light, bis_phong(grey(0.8), grey(0.2), 5), lit_tilted(), 40, LIT_HALF);
    rgbd truth = lit_truth(&l, true);
    all_settings(s);
    for (int i = 0; i < N_ALL; i++) {
        stat_moments m[4];
        if (s[i].integrator == &bis_rejection && s[i].estimator == BIS_ESTIMATOR_RATIO) continue;
        lit_run(m, &l, &s[i], s[i].integrator == &bis_exact ? 20 : 20000, SEED);
        check("E4", m, truth);
    }
    bis_light_free(light);
}

/* ---- extremes ---- */

static void first_and_last_random_numbers_are_survived(void **state)
{
    bis_light *lights[] = {lit_new_light(LIT_SPOTTY, 1, 0.15, false), lit_new_light(LIT_CONSTANT, 1, 0, false)};
    const bis_sampler sampler = {.kind = BIS_SAMPLER_RANDOM, .seed = 1, .spp = 1};
    bis_settings s[N_ALL];

    bis_rng check_forced = forced(1 - 0x1p-53, 5);
    for (int i = 0; i < 5; i++) bis_rng_u64(&check_forced);
    assert_true(bis_rng_double(&check_forced) == 1 - 0x1p-53);

    all_settings(s);
    for (int i = 0; i < N_ALL; i++) {
        bis_scratch scratch;
        if (s[i].integrator == &bis_exact) continue;
        assert_int_equal(bis_scratch_init(&scratch, &s[i], NULL), BIS_OK);
        for (int k = 0; k < 2 * 2 * 2 * 60; k++) {
            lit l;
            bis_stream stream;
            lit_init(
                &l, lights[k / 2 % 2], bis_phong(grey(0.3), grey(0.6), k / 4 % 2 ? 0.0 : 50), lit_tilted(), 85,
                LIT_HALF);
            bis_stream_init(&stream, &sampler, 7, 0);
            stream.rng = forced(k % 2 ? 1 - 0x1p-53 : 0, (uint64_t)k / 8);
            rgb L = s[i].integrator->Lo(&s[i], &l.pt, &stream, &scratch);
            assert_true(rgb_is_finite(L) && L.r >= 0 && L.g >= 0 && L.b >= 0);
        }
        bis_scratch_clear(&scratch);
    }
    bis_light_free(lights[0]);
    bis_light_free(lights[1]);
}

/* Radiance from 1e-36 to 1e36 and exponents to 1e8: f Le alone would overflow a float. Estimates scale with the
 * light. */
static void radiance_of_1e36_and_exponents_of_1e8_stay_finite(void **state)
{
    static const double scales[] = {1e-38, 1e-30, 1, 1e30, 1e35}, more[] = {0, 50, 1e5, 1e8};
    bis_settings s[N_ALL];

    all_settings(s);
    for (int e = 0; e < 5; e++) {
        bis_light *light = lit_new_light(LIT_SMOOTH, scales[e], 0.15, false);
        for (int i = 0; i < N_ALL * 4; i++) {
            const bool narrow = more[i / N_ALL] > 1e3;
            stat_moments m[4];
            lit l;
            if (narrow && (s[i % N_ALL].integrator == &bis_exact || s[i % N_ALL].proposal == BIS_PROPOSAL_EM)) continue;
            lit_init(&l, light, bis_phong(grey(0), grey(1), more[i / N_ALL]), (vec3){0, 0, 1}, 30, LIT_OPEN);
            lit_run(m, &l, &s[i % N_ALL], 100, SEED); /* asserts finiteness */
            if (narrow && s[i % N_ALL].integrator == &bis_brdf) {
                rgb mirror = bis_light_Le(light, l.pt.bsdf.r); /* the radiance of one patch, or of two */
                assert_true(fabs(m[1].mean / (double)mirror.g - 0.87) < 0.15);
            }
        }
        bis_light_free(light);
    }
}

/* ---- counting ---- */

static void counters_equal_hand_counts_E30(void **state)
{
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0.15, false);
    bis_settings s = bis_settings_default(&bis_sir);
    stat_moments m[4];
    lit l;

    s.candidates = 40;
    s.shadowrays = 7;
    lit_init(&l, light, bis_phong(grey(0.5), grey(0.5), 5), lit_tilted(), 40, LIT_OPEN);
    lit_run(m, &l, &s, 100, SEED);
    assert_int_equal(l.counters.candidates, 100 * 40);
    assert_true(l.counters.shadow_rays <= 100 * 7 && l.counters.shadow_rays > 100 * 2);

    lit_init(&l, light, bis_phong(grey(0.5), grey(0), 5), lit_tilted(), 40, LIT_OPEN);
    s = bis_settings_default(&bis_exact);
    s.perpatch = 3;
    lit_run(m, &l, &s, 1, SEED);
    assert_true(l.counters.shadow_rays > 8600 &&
                l.counters.shadow_rays < 11000); /* 3 in each of 64 * 64 above the horizon, a fifth of them black */
    bis_light_free(light);
}

/* ---- settings ---- */

static void assert_refused(const bis_settings *s, const char *part)
{
    bis_diag diag = {0};

    assert_int_equal(bis_settings_check(s, (bis_loc){"s.txt", 3, 1}, &diag), BIS_INPUT);
    assert_int_equal(diag.n_errors, 1);
    if (!strstr(diag.messages[0].text, part)) fail_msg("\"%s\" is not in: %s", part, diag.messages[0].text);
    assert_non_null(strstr(diag.messages[0].text, "s.txt:3:1: error: "));
    bis_diag_clear(&diag);
}

static void bad_settings_are_refused_with_the_way_out(void **state)
{
    bis_settings s = bis_settings_default(&bis_mis);

    s.samples = 1;
    assert_refused(&s, "take \"em\" or \"brdf\"");
    s = bis_settings_default(&bis_mis);
    s.split = 1.5;
    assert_refused(&s, "\"split\" is 1.5");
    s.split = (double)NAN;
    assert_refused(&s, "\"split\" is nan");
    s = bis_settings_default(&bis_em);
    s.samples = 0;
    assert_refused(&s, "\"samples\" is 0");
    s = bis_settings_default(&bis_sir);
    s.candidates = 0;
    assert_refused(&s, "\"candidates\" is 0");
    s.candidates = 1;
    s.shadowrays = 0;
    assert_refused(&s, "\"shadowrays\" is 0");
    s = bis_settings_default(&bis_sir);
    s.proposal = BIS_PROPOSAL_CHOOSE;
    assert_refused(&s, "takes \"em\", \"brdf\", \"mix\" or \"product\"");
    s = bis_settings_default(&bis_rejection);
    s.proposal = BIS_PROPOSAL_MIX;
    assert_refused(&s, "takes \"em\", \"brdf\" or \"choose\"");
    s = bis_settings_default(&bis_exact);
    s.perpatch = 0;
    assert_refused(&s, "\"perpatch\" is 0");
}

static void defaults_are_allowed_and_those_of_the_contract(void **state)
{
    for (const bis_integrator *const *i = bis_integrators; *i; i++) {
        const bis_settings s = bis_settings_default(*i);
        assert_int_equal(bis_settings_check(&s, (bis_loc){NULL, 0, 0}, NULL), BIS_OK);
        assert_ptr_equal(bis_integrator_find((*i)->name), *i);
        assert_true(s.samples == 16 && s.candidates == 800 && s.shadowrays == 15 && s.perpatch == 1);
        assert_int_equal(s.stratify, s.integrator != &bis_em && s.integrator != &bis_mis);
        assert_int_equal(s.proposal, *i == &bis_rejection ? BIS_PROPOSAL_CHOOSE : BIS_PROPOSAL_MIX);
    }
    assert_null(bis_integrator_find("path"));
    assert_string_equal(bis_proposal_name(BIS_PROPOSAL_CHOOSE), "choose");
}

static void only_what_proposes_from_the_map_needs_tables(void **state)
{
    bis_settings s = bis_settings_default(&bis_sir);

    assert_int_equal(s.integrator->light_needs(&s), BIS_NEED_CURVE);
    s.stratify = false;
    assert_int_equal(s.integrator->light_needs(&s), BIS_NEED_TABLE);
    s.proposal = BIS_PROPOSAL_BRDF;
    assert_int_equal(s.integrator->light_needs(&s), 0);
    s = bis_settings_default(&bis_mis);
    assert_int_equal(s.integrator->light_needs(&s), BIS_NEED_TABLE | BIS_NEED_SPREAD);
    s.compensate = true;
    assert_int_equal(s.integrator->light_needs(&s), BIS_NEED_TABLE | BIS_NEED_SPREAD | BIS_NEED_COMPENSATED);
    assert_int_equal(bis_brdf.light_needs(&s), 0);
    assert_int_equal(bis_exact.light_needs(&s), 0);
    assert_int_equal(bis_em.light_needs(&s), BIS_NEED_TABLE | BIS_NEED_SPREAD);
}

/* ---- the weights of mis ---- */

/* Under a constant light 1 a white diffuse surface's two samples are C = 1 by the BRDF and 4c by the map (uniform on
 * the sphere), c the cosine, and the ratio of their densities is 4c: so the estimate's second moment is two integrals
 * over c. `power`: 2 or 1, eq. 4.3 as a power or a balance heuristic. */
static double second_moment_of_mis(int power)
{
    enum { STEPS = 10000 };
    double em = 0, em2 = 0, brdf = 0, brdf2 = 0;

    for (int i = 0; i < STEPS; i++) {
        const double c = (i + 0.5) / STEPS, of_em = 1 / (1 + pow(4 * c, power)), of_brdf = 1 - of_em;
        em += 0.5 * 4 * c * of_em / STEPS; /* half of the sphere is above the horizon */
        em2 += 0.5 * pow(4 * c * of_em, 2) / STEPS;
        brdf += 2 * c * of_brdf / STEPS; /* the cosine's own density */
        brdf2 += 2 * c * of_brdf * of_brdf / STEPS;
    }
    return em2 + brdf2 + 2 * em * brdf;
}

static void mis_scatters_as_the_weights_of_its_heuristic_say(void **state)
{
    static const bis_heuristic heuristics[] = {BIS_HEURISTIC_BALANCE, BIS_HEURISTIC_POWER};
    bis_light *light = lit_new_light(LIT_CONSTANT, 1, 0, false); /* red is 1 */

    for (int h = 0; h < 2; h++) {
        bis_settings s = bis_settings_default(&bis_mis);
        bis_scratch scratch;
        stat_moments squares = {0}, mean = {0};
        lit l;
        s.samples = 2;
        s.heuristic = heuristics[h];
        lit_init(&l, light, bis_phong(grey(1), grey(0), 1), lit_tilted(), 40, LIT_OPEN);
        l.kind = BIS_SAMPLER_RANDOM;
        assert_int_equal(bis_scratch_init(&scratch, &s, NULL), BIS_OK);
        for (uint64_t run = 0; run < 40000; run++) {
            const double red = (double)lit_once(&l, &s, &scratch, SEED, run).r;
            stat_add(&mean, red);
            stat_add(&squares, red * red);
        }
        stat_assert_mean("mis_mean", SEED, &mean, 1, alpha());
        stat_assert_mean("mis_squares", SEED, &squares, second_moment_of_mis(h + 1), alpha());
        stat_assert_not_mean("mis_other_squares", SEED, &squares, second_moment_of_mis(2 - h), alpha());
        bis_scratch_clear(&scratch);
    }
    bis_light_free(light);
}

/* split times samples, rounded, are the map's, but each technique has at least one; there is room for the larger share.
 */
static void mis_divides_its_samples(void **state)
{
    static const struct { double split; uint32_t samples, larger; } rows[] = {
        {0.5, 8, 4}, {0.25, 4, 3}, {0, 4, 3}, {1, 4, 3}, {0.5, 2, 1}, {0.1, 2, 1}, {0.9, 2, 1}, {0.3, 10, 7},
    };

    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        bis_settings s = bis_settings_default(&bis_mis);
        bis_needs need = {0, 0, 0, 0};
        s.split = rows[i].split;
        s.samples = rows[i].samples;
        bis_mis.scratch_needs(&s, &need);
        assert_int_equal(need.n_points, rows[i].larger);
    }
}

/* By hand: the points of the sampler that are alive at a time, the candidates, those that are traced, and the
 * directions of a shared set. mis splits its samples by the nearest number, and leaves each technique one. */
static void an_integrator_has_room_for_what_it_draws(void **state)
{
    static const struct {
        const bis_integrator *integrator;
        bis_proposal proposal;
        bool stratify, learn;
        double split;
        bis_needs needs; /* n_points, n_candidates, n_traced, n_set */
    } cases[] = {
        {&bis_em, BIS_PROPOSAL_EM, false, false, 0.5, {10, 0, 0, 0}},
        {&bis_em, BIS_PROPOSAL_EM, true, false, 0.5, {0, 0, 0, 10}},
        {&bis_brdf, BIS_PROPOSAL_EM, true, false, 0.5, {10, 0, 0, 0}},
        {&bis_mis, BIS_PROPOSAL_EM, false, false, 0.3, {7, 0, 0, 0}},
        {&bis_mis, BIS_PROPOSAL_EM, false, false, 0.8, {8, 0, 0, 0}},
        {&bis_mis, BIS_PROPOSAL_EM, true, false, 0.3, {7, 0, 0, 3}},
        {&bis_mis, BIS_PROPOSAL_EM, true, false, 0.26, {7, 0, 0, 3}},
        {&bis_mis, BIS_PROPOSAL_EM, true, false, 0.24, {8, 0, 0, 2}},
        {&bis_mis, BIS_PROPOSAL_EM, true, false, 0.8, {2, 0, 0, 8}},
        {&bis_mis, BIS_PROPOSAL_EM, true, false, 0, {9, 0, 0, 1}},
        {&bis_mis, BIS_PROPOSAL_EM, true, false, 1, {1, 0, 0, 9}},
        {&bis_rejection, BIS_PROPOSAL_MIX, true, true, 0.5, {0, 64, 5, 0}},
        {&bis_sir, BIS_PROPOSAL_MIX, true, false, 0.5, {0, 64, 5, 64}},
        {&bis_sir, BIS_PROPOSAL_EM, false, false, 0.5, {0, 64, 5, 0}},
        {&bis_sir, BIS_PROPOSAL_PRODUCT, true, true, 0.5, {0, 64, 15, 0}},
        {&bis_exact, BIS_PROPOSAL_EM, true, false, 0.5, {0, 0, 0, 0}},
        {&bis_unoccluded, BIS_PROPOSAL_EM, true, false, 0.5, {0, 64, 0, 64}},
        {&bis_unoccluded, BIS_PROPOSAL_BRDF, true, false, 0.5, {0, 64, 0, 0}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bis_settings s = bis_settings_default(cases[i].integrator);
        bis_needs need = {0, 0, 0, 0};
        const bis_needs expected = cases[i].needs;
        s.samples = 10;
        s.candidates = 64;
        s.shadowrays = 5;
        s.proposal = cases[i].proposal;
        s.stratify = cases[i].stratify;
        s.learn = cases[i].learn;
        s.split = cases[i].split;
        s.integrator->scratch_needs(&s, &need);
        if (need.n_points != expected.n_points || need.n_candidates != expected.n_candidates ||
            need.n_traced != expected.n_traced || need.n_set != expected.n_set)
            fail_msg("case %zu, %s: points %u, candidates %u, traced %u, set %u", i, s.integrator->name,
                     (unsigned)need.n_points, (unsigned)need.n_candidates, (unsigned)need.n_traced,
                     (unsigned)need.n_set);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_integrator_has_room_for_what_it_draws),
        cmocka_unit_test(mis_scatters_as_the_weights_of_its_heuristic_say),
        cmocka_unit_test(em_and_brdf_are_unbiased),
        cmocka_unit_test(mis_is_unbiased_for_each_heuristic_and_split),
        cmocka_unit_test(compensated_mis_is_unbiased),
        cmocka_unit_test(every_integrator_is_unbiased_for_microfacets_too),
        cmocka_unit_test(balance_heuristic_needs_the_counts),
        cmocka_unit_test(sir_is_unbiased_for_every_M_and_N_E21),
        cmocka_unit_test(plain_rejection_is_unbiased_for_every_M_and_N_E22),
        cmocka_unit_test(unoccluded_is_unbiased_for_L_ns),
        cmocka_unit_test(exact_is_unbiased_and_nearly_exact),
        cmocka_unit_test(fully_hidden_point_is_exactly_black_E29),
        cmocka_unit_test(black_map_black_surface_and_hidden_eye_cast_no_ray),
        cmocka_unit_test(surface_turned_away_from_all_light_casts_no_ray_E25),
        cmocka_unit_test(no_ray_is_cast_below_the_geometric_surface_E37),
        cmocka_unit_test(constant_light_on_open_diffuse_plane_is_exact_from_the_brdf_and_right_in_the_mean_for_all),
        cmocka_unit_test(directions_below_the_horizon_count_E1),
        cmocka_unit_test(each_channel_is_right_under_coloured_light_E5),
        cmocka_unit_test(one_lit_window_is_found_by_all_E4),
        cmocka_unit_test(first_and_last_random_numbers_are_survived),
        cmocka_unit_test(radiance_of_1e36_and_exponents_of_1e8_stay_finite),
        cmocka_unit_test(counters_equal_hand_counts_E30),
        cmocka_unit_test(bad_settings_are_refused_with_the_way_out),
        cmocka_unit_test(defaults_are_allowed_and_those_of_the_contract),
        cmocka_unit_test(only_what_proposes_from_the_map_needs_tables),
        cmocka_unit_test(mis_divides_its_samples),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
