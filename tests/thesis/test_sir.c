/* sir: what is special about resampling: the degenerate case, the variance, the repeats; and the errata of chapter 4 as
 * twins: each is what the thesis prints, computed here from the same candidates, and must be rejected. Family-wise
 * significance 1e-3. */
#include "bis/thesis/phong.h"
#include "bis/thesis/rng.h"
#include "bis/base/stats.h"
#include "thesis/candidates.h"
#include "thesis/proposal.h"

#include "lit.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#define SEED 47u

static double alpha(void)
{
    return stat_level(1e-3, 24);
}

static vec3 tilted(void)
{
    return normalize(vec3_from(0.2, -0.3, 0.8));
}

static bis_settings sir(bis_proposal proposal, uint32_t M, uint32_t N, bool stratify)
{
    bis_settings s = bis_settings_default(&bis_sir);

    s.proposal = proposal;
    s.candidates = M;
    s.shadowrays = N;
    s.stratify = stratify;
    return s;
}

/* ---- E24 ---- */

static void M_1_N_1_is_plain_importance_sampling_bit_for_bit_E24(void **state)
{
    static const bis_sampler_kind kinds[] = {BIS_SAMPLER_RANDOM, BIS_SAMPLER_STRATIFIED, BIS_SAMPLER_SOBOL, BIS_SAMPLER_HALTON};
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0.15, false);
    int lit_pixels = 0;

    (void)state;
    for (int k = 0; k < 16; k++) {
        bis_settings one = sir(k % 2 ? BIS_PROPOSAL_BRDF : BIS_PROPOSAL_EM, 1, 1, false), plain = bis_settings_default(k % 2 ? &bis_brdf : &bis_em);
        bis_scratch scratch, plain_scratch;
        lit l, p;

        plain.samples = 1;
        one.resampling = k / 8 ? BIS_RESAMPLING_MULTINOMIAL : BIS_RESAMPLING_SYSTEMATIC;
        lit_init(&l, light, bis_phong((rgb){0.1f, 0.4f, 0.3f}, (rgb){0.9f, 0.3f, 0.1f}, 20), tilted(), 50, LIT_HALF);
        lit_init(&p, light, l.material, tilted(), 50, LIT_HALF);
        l.kind = p.kind = kinds[k / 2 % 4];
        assert_int_equal(bis_scratch_init(&scratch, &one, NULL), BIS_OK);
        assert_int_equal(bis_scratch_init(&plain_scratch, &plain, NULL), BIS_OK);
        for (uint64_t run = 0; run < 2000; run++) {
            rgb a = lit_once(&l, &one, &scratch, SEED, run), b = lit_once(&p, &plain, &plain_scratch, SEED, run);
            assert_memory_equal(&a, &b, sizeof a);
            lit_pixels += !rgb_is_black(a);
        }
        assert_int_equal(l.counters.shadow_rays, p.counters.shadow_rays);
        bis_scratch_clear(&scratch);
        bis_scratch_clear(&plain_scratch);
    }
    assert_true(lit_pixels > 16 * 200);
    bis_light_free(light);
}

/* ---- E31: variance ---- */

/* In the open and without colour, F/phat is the same for all candidates: resampling adds no noise, and the estimate is
 * Zhat. */
static void unshadowed_grey_point_has_only_the_candidates_variance_E31(void **state)
{
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0, false);
    bis_settings s = sir(BIS_PROPOSAL_EM, 8, 3, false);
    bis_scratch scratch;
    lit l;

    (void)state;
    /* diffuse: f cos is smooth over the map's patches, so that the variance has no heavy tail and can be tested
     * itself */
    lit_init(&l, light, bis_phong(grey(0.8), grey(0), 1), tilted(), 40, LIT_OPEN);
    double truth = rgbd_sum(lit_truth(&l, false)), variance = lit_variance_em(&l);
    for (int k = 0; k < 2; k++) {
        stat_moments square = {0};
        s.resampling = k ? BIS_RESAMPLING_MULTINOMIAL : BIS_RESAMPLING_SYSTEMATIC;
        assert_int_equal(bis_scratch_init(&scratch, &s, NULL), BIS_OK);
        for (uint64_t run = 0; run < 60000; run++) {
            double d = rgb_sum(lit_once(&l, &s, &scratch, SEED + (uint64_t)k, run)) - truth;
            stat_add(&square, d * d);
        }
        stat_assert_mean("E31_variance", SEED, &square, variance / 8, alpha());
        /* twin: "lighting and BRDF completely factored away", L_ns^2 var(V)/N = 0 here; or that of N samples */
        stat_assert_not_mean("E31_as_N", SEED, &square, variance / 3, alpha());
        bis_scratch_clear(&scratch);
    }
    bis_light_free(light);
}

static void stratified_candidates_with_systematic_resampling_are_less_noisy(void **state)
{
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0, false);
    bis_settings thesis = sir(BIS_PROPOSAL_EM, 64, 8, false), ours = sir(BIS_PROPOSAL_EM, 64, 8, true);
    stat_moments m[4], n[4];
    lit l;

    (void)state;
    thesis.resampling = BIS_RESAMPLING_MULTINOMIAL;
    lit_init(&l, light, bis_phong(grey(0.8), grey(0), 1), tilted(), 40, LIT_HALF);
    lit_run(m, &l, &thesis, 4000, SEED);
    lit_run(n, &l, &ours, 4000, SEED);
    assert_true(stat_variance(&n[3]) < 0.2 * stat_variance(&m[3])); /* measured: 0.07 */
    bis_light_free(light);
}

/* E26: q_L alone fails on narrow lobes, q_f alone under a sun. With independent candidates the mixture stays within 1.5
 * of the better of the two. (Stratified ones gain more than their share of M: there a divided M may cost up to 4 where
 * both errors are small.) */
static void mixture_is_within_1_5_of_the_better_proposal_E26(void **state)
{
    static const lit_map maps[] = {LIT_SPOTTY, LIT_SMOOTH, LIT_ONE_BLOCK, LIT_CONSTANT};
    const bis_material materials[] = {bis_phong(grey(0.8), grey(0), 1), bis_phong(grey(0), grey(1), 5), bis_phong(grey(0), grey(1), 50),
                                      bis_phong(grey(0), grey(1), 1000), bis_phong(grey(0.5), grey(0.5), 50)};

    int em_alone = 0, brdf_alone = 0;

    (void)state;
    for (int i = 0; i < 4 * 5; i++) {
        bis_light *light = lit_new_light(maps[i % 4], 1, 0, false);
        double rmse[3], truth = 0;
        for (int p = 0; p < 3; p++) {
            const bis_settings s = sir((bis_proposal)p, 256, 15, false);
            stat_moments m[4];
            lit l;
            lit_init(&l, light, materials[i / 4], tilted(), 40, LIT_OPEN);
            truth = rgbd_sum(lit_truth(&l, true));
            lit_run(m, &l, &s, 1000, SEED);
            rmse[p] = sqrt(stat_variance(&m[3]) + (m[3].mean - truth) * (m[3].mean - truth));
        }
        double better = fmin(rmse[BIS_PROPOSAL_EM], rmse[BIS_PROPOSAL_BRDF]);
        bis_light_free(light);
        if (truth <= 1e-6) continue; /* the lobe misses the block */
        const double bound = 1.5 * better + 1e-5 * truth;
        if (rmse[BIS_PROPOSAL_MIX] > bound) {
            fail_msg("map %d, material %d: em %g, brdf %g, mix %g of %g", i % 4, i / 4, rmse[0], rmse[1], rmse[2], truth);
        }
        em_alone += rmse[BIS_PROPOSAL_EM] > bound;
        brdf_alone += rmse[BIS_PROPOSAL_BRDF] > bound;
    }
    /* twins: "q_L or q_f" */
    assert_true(em_alone >= 3 && brdf_alone >= 3);
}

/* ---- resampling ---- */

enum { M_WEIGHTS = 8 };

static bis_stream plain_stream(uint64_t pixel)
{
    static const bis_sampler sampler = {.kind = BIS_SAMPLER_RANDOM, .seed = SEED, .spp = 1};
    bis_stream stream;

    bis_stream_init(&stream, &sampler, pixel, 0);
    return stream;
}

static double weigh(bis_candidate c[M_WEIGHTS], const double w[M_WEIGHTS])
{
    double W = 0;

    for (int i = 0; i < M_WEIGHTS; i++) {
        c[i] = (bis_candidate){.C = {w[i], 0, 0}, .w = w[i]};
        W += w[i];
    }
    return W;
}

static void candidates_are_chosen_in_proportion_to_their_weights_and_in_order(void **state)
{
    static const double w[M_WEIGHTS] = {0, 3, 1e-3, 0, 7, 0.5, 2, 0};
    bis_candidate c[M_WEIGHTS];
    double W = weigh(c, w);

    (void)state;
    for (int k = 0; k < 2; k++) {
        enum { N = 5, RUNS = 40000 };
        double observed[M_WEIGHTS] = {0}, expected[M_WEIGHTS];
        bis_stream stream = plain_stream((uint64_t)k);
        for (int run = 0; run < RUNS; run++) {
            uint32_t chosen[N];
            bis_candidates_resample(chosen, N, c, M_WEIGHTS, W, k ? BIS_RESAMPLING_MULTINOMIAL : BIS_RESAMPLING_SYSTEMATIC, &stream);
            for (int j = 0; j < N; j++) {
                assert_true(chosen[j] < M_WEIGHTS && w[chosen[j]] > 0 && (j == 0 || chosen[j] >= chosen[j - 1]));
                observed[chosen[j]]++;
            }
            /* systematic: candidate 4 holds 0.52 of the weight, so 2 or 3 of 5 marks */
            if (k == 0) assert_true((chosen[0] == 4) + (chosen[1] == 4) + (chosen[2] == 4) + (chosen[3] == 4) + (chosen[4] == 4) >= 2);
        }
        for (int i = 0; i < M_WEIGHTS; i++) expected[i] = (double)N * RUNS * w[i] / W;
        stat_assert_fit("resampling", SEED, observed, expected, M_WEIGHTS, alpha());
        for (int i = 0; i < M_WEIGHTS; i++) expected[i] = (double)N * RUNS * (w[i] > 0 ? 0.2 : 0);
        stat_assert_no_fit("resampling_uniform", SEED, observed, expected, M_WEIGHTS, alpha());
    }
}

/* Multinomial marks, made in order, are distributed like independent ones: so are the pairs of choices. */
static void multinomial_choices_are_independent(void **state)
{
    static const double w[M_WEIGHTS] = {1, 2, 3, 4, 0, 0, 0, 0};
    bis_candidate c[M_WEIGHTS];
    double W = weigh(c, w), observed[16] = {0}, expected[16];
    bis_stream stream = plain_stream(2);

    (void)state;
    for (int run = 0; run < 50000; run++) {
        uint32_t chosen[2];
        bis_candidates_resample(chosen, 2, c, M_WEIGHTS, W, BIS_RESAMPLING_MULTINOMIAL, &stream);
        observed[chosen[0] * 4 + chosen[1]]++;
    }
    for (int i = 0; i < 16; i++) expected[i] = i / 4 > i % 4 ? 0 : 50000 * w[i / 4] * w[i % 4] / (W * W) * (i / 4 == i % 4 ? 1 : 2);
    stat_assert_fit("multinomial_pairs", SEED, observed, expected, 16, alpha());
}

/* A mark that rounding puts on W must go to the last positive candidate, not to the last. */
static void last_mark_never_runs_past_the_last_positive_candidate(void **state)
{
    static const double w[M_WEIGHTS] = {0.1, 0.2, 0.3, 0, 0, 0, 0, 0};
    bis_candidate c[M_WEIGHTS];
    double W = weigh(c, w);

    (void)state;
    for (int k = 0; k < 2; k++) {
        uint32_t chosen[3];
        bis_stream stream = plain_stream(3);
        /* W too large by some ulps, as if it had been summed in another order: marks beyond the running sum */
        bis_candidates_resample(chosen, 3, c, M_WEIGHTS, W * 1.5, k ? BIS_RESAMPLING_MULTINOMIAL : BIS_RESAMPLING_SYSTEMATIC, &stream);
        for (int j = 0; j < 3; j++) assert_true(chosen[j] <= 2);
        assert_int_equal(chosen[2], 2);
    }
}

static void repeats_are_traced_once_and_counted_k_times_E32(void **state)
{
    bis_light *light = lit_new_light(LIT_ONE_BLOCK, 1, 0, false);
    const uint32_t chosen[] = {1, 1, 1, 3, 6, 6};
    bis_candidate c[M_WEIGHTS] = {{.w = 0}};
    lit l;

    (void)state;
    lit_init(&l, light, bis_phong(grey(0.8), grey(0), 1), (vec3){0, 0, 1}, 0, LIT_HALF);
    for (int i = 0; i < M_WEIGHTS; i++) c[i] = (bis_candidate){{0, i % 2 ? -0.6f : 0.6f, 0.8f}, {i, 2 * i, 0}, 3 * i};
    rgbd L = bis_candidates_trace(&l.pt, c, chosen, 6, 3);
    assert_int_equal(l.counters.shadow_rays, 3);
    assert_true(fabs(L.r - 4) < 1e-12 && fabs(L.g - 8) < 1e-12 && L.b == 0); /* 1, 1, 1 and 3 are seen; each adds C/w Z = (1, 2, 0) */
    bis_light_free(light);
}

/* ---- twins: as printed ---- */

typedef rgbd (*printed)(const lit *l, const bis_candidate *c, uint32_t M, const uint32_t *chosen, uint32_t N, double W);

/* The same candidates and choices, another estimate of them. */
static stat_moments run_printed(lit *l, bis_proposal proposal, uint32_t M, uint32_t N, uint32_t runs, printed estimate)
{
    bis_candidate c[64];
    uint32_t chosen[64];
    stat_moments m = {0};

    for (uint64_t run = 0; run < runs; run++) {
        bis_stream stream = plain_stream(run);
        double W = bis_candidates_draw(c, M, proposal, false, NULL, &l->pt, &stream);
        if (W > 0) bis_candidates_resample(chosen, N, c, M, W, BIS_RESAMPLING_MULTINOMIAL, &stream);
        stat_add(&m, W > 0 ? estimate(l, c, M, chosen, N, W).r : 0);
    }
    return m;
}

static rgbd ours(const lit *l, const bis_candidate *c, uint32_t M, const uint32_t *chosen, uint32_t N, double W)
{
    return bis_candidates_trace(&l->pt, c, chosen, N, W / M / N);
}

static double mean_V(const lit *l, const bis_candidate *c, const uint32_t *chosen, uint32_t N)
{
    double V = 0;

    for (uint32_t j = 0; j < N; j++) V += bis_point_sees(&l->pt, c[chosen[j]].wi);
    return V / N;
}

/* Eq. 4.6 as printed: L_ns in RGB times the mean of V. */
static rgbd L_ns_times_mean_V(const lit *l, const bis_candidate *c, uint32_t M, const uint32_t *chosen, uint32_t N, double W)
{
    (void)W;
    return rgbd_scale(bis_candidates_unoccluded(c, M), mean_V(l, c, chosen, N));
}

/* Red light blocked, blue light open: the truth has no red, the printed formula turns grey. */
static void colour_of_shadows_is_right_E6(void **state)
{
    bis_light *light = lit_new_light(LIT_RED_BLUE, 1, 0, false);
    lit l;

    (void)state;
    lit_init(&l, light, bis_phong(grey(0.9), grey(0), 1), (vec3){0, 0, 1}, 0, LIT_HALF);
    rgbd truth = lit_truth(&l, true);
    assert_true(truth.r == 0 && truth.b > 0.4);
    stat_moments m = run_printed(&l, BIS_PROPOSAL_EM, 32, 4, 4000, ours), twin = run_printed(&l, BIS_PROPOSAL_EM, 32, 4, 4000, L_ns_times_mean_V);
    assert_true(m.mean == 0 && m.m2 == 0);
    stat_assert_not_mean("E6_printed", SEED, &twin, 0, alpha());
    bis_light_free(light);
}

/* E20: q_A has the area factors, the printed weight assumes q_L: f cos times the integral of L. */
static void area_weighting_does_not_change_the_picture_E20(void **state)
{
    static const double b[] = {0, 0.1, 0.2, 1};

    (void)state;
    for (int i = 0; i < 4; i++) {
        bis_light *light = lit_new_light(LIT_SPOTTY, 1, b[i], false);
        stat_moments twin = {0};
        bis_settings s = sir(BIS_PROPOSAL_EM, 16, 4, true);
        stat_moments m[4];
        lit l;

        lit_init(&l, light, bis_phong(grey(0.8), grey(0), 1), tilted(), 40, LIT_OPEN);
        rgbd truth = lit_truth(&l, true);
        lit_run(m, &l, &s, 20000, SEED);
        stat_assert_mean("E20", SEED, &m[3], rgbd_sum(truth), alpha());

        bis_stream stream = plain_stream(9);
        for (int run = 0; run < 40000; run++) {
            bis_light_point y;
            double u[4];
            for (int k = 0; k < 4; k++) u[k] = bis_stream_random(&stream);
            assert_true(bis_light_sample(light, u, &y));
            stat_add(&twin, (double)l.material.Kd.r / PI * fmax(0, bis_bsdf_cos(&l.pt.bsdf, y.wi)) * bis_light_power(light));
        }
        if (b[i] == 0) {
            stat_assert_mean("E20_b_0", SEED, &twin, rgbd_sum(truth), alpha());
        } else {
            stat_assert_not_mean("E20_printed", SEED, &twin, rgbd_sum(truth), alpha());
        }
        bis_light_free(light);
    }
}

static rgbd F(const lit *l, vec3 wi)
{
    rgb f = bis_bsdf_f(&l->pt.bsdf, wi), Le = bis_light_Le(l->light, wi);
    double cos_theta = fmax(0, bis_bsdf_cos(&l->pt.bsdf, wi)) * bis_point_sees(&l->pt, wi);

    return (rgbd){(double)f.r * (double)Le.r * cos_theta, (double)f.g * (double)Le.g * cos_theta,
                  (double)f.b * (double)Le.b * cos_theta};
}

/* The line between eq. 4.8 and 4.9: w in the denominator. */
static rgbd F_over_w(const lit *l, const bis_candidate *c, uint32_t M, const uint32_t *chosen, uint32_t N, double W)
{
    (void)M;
    (void)N;
    (void)W;
    return rgbd_scale(F(l, c[chosen[0]].wi), 1 / c[chosen[0]].w);
}

/* Eq. 4.9 with f as in 4.8, the whole integrand, and not what is left of it after division by phat. */
static rgbd F_times_mean_w(const lit *l, const bis_candidate *c, uint32_t M, const uint32_t *chosen, uint32_t N,
                           double W)
{
    (void)N;
    return rgbd_scale(F(l, c[chosen[0]].wi), W / M);
}

static void eq_4_9_holds_for_F_over_phat_alone_E24(void **state)
{
    static const uint32_t sizes[] = {1, 4};
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0, false);
    lit l;

    (void)state;
    lit_init(&l, light, bis_phong(grey(0.8), grey(0), 1), tilted(), 40, LIT_HALF);
    const double truth = lit_truth(&l, true).r;
    for (int i = 0; i < 2; i++) {
        stat_moments m = run_printed(&l, BIS_PROPOSAL_EM, sizes[i], 1, 20000, ours);
        stat_moments over = run_printed(&l, BIS_PROPOSAL_EM, sizes[i], 1, 20000, F_over_w);
        stat_moments times = run_printed(&l, BIS_PROPOSAL_EM, sizes[i], 1, 20000, F_times_mean_w);
        stat_assert_mean("E24", SEED, &m, truth, alpha());
        stat_assert_not_mean("E24_over_w", SEED, &over, truth, alpha());
        stat_assert_not_mean("E24_times_w", SEED, &times, truth, alpha());
    }
    bis_light_free(light);
}

/* A set of which no candidate is worth anything is an estimate of 0. Left out of the mean, or drawn again, it makes
 * the rest too bright: half of the sphere is below the horizon, so a set of M is worthless with probability 2^-M. */
static void a_set_without_weight_counts_as_0_and_left_out_brightens_the_rest_E25(void **state)
{
    bis_light *light = lit_new_light(LIT_CONSTANT, 1, 0, false);

    (void)state;
    for (uint32_t M = 1; M <= 4; M *= 2) {
        const bis_settings s = sir(BIS_PROPOSAL_EM, M, 1, false);
        stat_moments m = {0}, twin = {0};
        bis_scratch scratch;
        lit l;
        lit_init(&l, light, bis_phong(grey(1), grey(0), 1), (vec3){0, 0, 1}, 30, LIT_OPEN);
        assert_int_equal(bis_scratch_init(&scratch, &s, NULL), BIS_OK);
        for (uint64_t run = 0; run < 20000; run++) {
            const uint64_t rays = l.counters.shadow_rays;
            const double L = (double)lit_once(&l, &s, &scratch, SEED, run).r;
            stat_add(&m, L);
            if (l.counters.shadow_rays > rays) stat_add(&twin, L);
            else assert_true(L == 0);
        }
        stat_assert_mean("E25", SEED, &m, 1, alpha());
        stat_assert_not_mean("E25_left_out", SEED, &twin, 1, alpha());
        stat_assert_mean("E25_factor", SEED, &twin, 1 / (1 - pow(0.5, M)), alpha());
        bis_scratch_clear(&scratch);
    }
    bis_light_free(light);
}

static rgbd exact_L_ns;

/* E21: L_ns known exactly, or from anywhere but the same candidates. */
static rgbd exact_L_ns_times_mean_V(const lit *l, const bis_candidate *c, uint32_t M, const uint32_t *chosen, uint32_t N, double W)
{
    (void)M;
    (void)W;
    return rgbd_scale(exact_L_ns, mean_V(l, c, chosen, N));
}

static void L_ns_must_come_from_the_same_candidates_E21(void **state)
{
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0, false);
    lit l;

    (void)state;
    lit_init(&l, light, bis_phong(grey(0.2), grey(0.8), 10), tilted(), 40, LIT_HALF);
    exact_L_ns = lit_truth(&l, false);
    for (uint32_t M = 1; M <= 8; M *= 2) {
        rgbd truth = lit_truth(&l, true);
        stat_moments m = run_printed(&l, BIS_PROPOSAL_EM, M, 1, 40000, ours);
        stat_moments twin = run_printed(&l, BIS_PROPOSAL_EM, M, 1, 40000, exact_L_ns_times_mean_V);
        stat_assert_mean("E21", SEED, &m, truth.r, alpha());
        stat_assert_not_mean("E21_exact_L_ns", SEED, &twin, truth.r, alpha());
    }
    bis_light_free(light);
}

/* E23: w = Le with candidates from the BRDF renders the mixture's density in place of f cos: a white furnace returns
 * more than the albedo. */
static rgbd weight_is_Le(const lit *l, const bis_candidate *c, uint32_t M, const uint32_t *chosen, uint32_t N, double W)
{
    double sum = 0;

    (void)chosen;
    (void)N;
    (void)W;
    for (uint32_t i = 0; i < M; i++) {
        if (c[i].w > 0) sum += (double)bis_light_Le(l->light, c[i].wi).r;
    }
    return (rgbd){sum / M, 0, 0};
}

static void furnace_returns_the_albedo_at_grazing_E23(void **state)
{
    static const double degrees[] = {60, 85}, albedo[] = {0.490, 0.108};
    bis_light *light = lit_new_light(LIT_CONSTANT, 1, 0, false);

    (void)state;
    for (int i = 0; i < 2; i++) {
        lit l;
        lit_init(&l, light, bis_phong(grey(0), grey(1), 50), tilted(), degrees[i], LIT_OPEN);
        double truth = lit_truth(&l, true).r;
        assert_true(fabs(truth - albedo[i]) < 1e-3);
        stat_moments m = run_printed(&l, BIS_PROPOSAL_BRDF, 16, 4, 10000, ours), twin = run_printed(&l, BIS_PROPOSAL_BRDF, 16, 4, 10000, weight_is_Le);
        stat_assert_mean("E23", SEED, &m, truth, alpha());
        stat_assert_not_mean("E23_printed", SEED, &twin, truth, alpha());
    }
    bis_light_free(light);
}

/* E32: error bars from independent whole estimates are true; those from the N visibilities of one set of candidates are
 * too small. */
static void intervals_from_replicates_cover_95_percent_E32(void **state)
{
    enum { REPLICATES = 40, RUNS = 2500 };
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0.15, false);
    const bis_settings s = sir(BIS_PROPOSAL_MIX, 8, 4, false);
    uint32_t covered = 0;
    bis_scratch scratch;
    lit l;

    (void)state;
    lit_init(&l, light, bis_phong(grey(0.5), grey(0.5), 5), tilted(), 40, LIT_HALF);
    double truth = rgbd_sum(lit_truth(&l, true));
    assert_int_equal(bis_scratch_init(&scratch, &s, NULL), BIS_OK);
    for (uint64_t run = 0; run < RUNS; run++) {
        stat_moments m = {0};
        for (uint64_t k = 0; k < REPLICATES; k++) stat_add(&m, rgb_sum(lit_once(&l, &s, &scratch, SEED, run * REPLICATES + k)));
        covered += bis_stats_student_p((m.mean - truth) / sqrt(stat_variance(&m) / REPLICATES), REPLICATES - 1) >= 0.05;
    }
    assert_true(covered > 0.93 * RUNS && covered < 0.97 * RUNS);
    bis_scratch_clear(&scratch);
    bis_light_free(light);
}

static bool error_falls_as(double slope, const double rmse[3])
{
    return fabs(log(rmse[2] / rmse[0]) / log(16) - slope) < 0.02;
}

/* Error falls with N^(-1/2), cost with 1/error^2. */
static void error_of_random_candidates_falls_with_the_square_root_E9(void **state)
{
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0, false);
    double rmse[3];

    (void)state;
    for (int k = 0; k < 3; k++) {
        bis_settings s = bis_settings_default(&bis_em);
        stat_moments m[4];
        lit l;
        s.samples = 4u << 2 * k;
        lit_init(&l, light, bis_phong(grey(0.8), grey(0), 1), tilted(), 40, LIT_HALF);
        l.kind = BIS_SAMPLER_RANDOM;
        lit_run(m, &l, &s, 20000u >> k, SEED);
        rmse[k] = sqrt(stat_variance(&m[3]));
    }
    assert_true(error_falls_as(-0.5, rmse));
    assert_false(error_falls_as(-2, rmse)); /* "image quality depends on N^2" */
    bis_light_free(light);
}

/* ---- the lobe's own number ---- */

static double lobe_u[2], rest_u;

static bool note_numbers(const bis_bsdf *b, double u0, double u1, double u2, vec3 *wi)
{
    (void)b;
    lobe_u[0] = u0, lobe_u[1] = u2, rest_u = u1;
    *wi = (vec3){0, 0, 1};
    return true;
}

/* Of u[0] < p = 1/4 the lobe gets 4 u[0], of the others 4/3 (u[0] - 1/4). With p = 1/4 + 3 x 2^-54 and u[0] = 1 - 2^-53
 * both differences are halves of the last bit and round to the same even number, 3/4 - 2^-52: the quotient 1 is no
 * number of [0,1), and the largest one below it is taken. */
static void the_number_that_chose_the_lobe_is_used_again_below_1(void **state)
{
    (void)state;
    static const struct {
        double p, u, rest;
    } cases[] = {{0.25, 0.125, 0.5}, {0.25, 0.25, 0}, {0.25, 0.625, 0.5}, {0.25, 0.1875, 0.75}, {0, 0.5, 0.5},
                 {1, 0.75, 0.75}, {0.25 + 3 * 0x1p-54, 1 - 0x1p-53, 1 - 0x1p-53}};
    bis_bsdf_model model = bis_phong_model;
    bis_material m = {.model = &model};
    bis_bsdf b = {.material = &m};
    model.sample = note_numbers;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        vec3 wi;
        b.p_specular = cases[i].p;
        assert_true(bis_bsdf_draw(&b, (double[2]){cases[i].u, 0.375}, &wi));
        assert_true(lobe_u[0] == cases[i].u && lobe_u[1] == 0.375 && rest_u == cases[i].rest);
        assert_true(wi.x == 0 && wi.y == 0 && wi.z == 1);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(M_1_N_1_is_plain_importance_sampling_bit_for_bit_E24),
        cmocka_unit_test(unshadowed_grey_point_has_only_the_candidates_variance_E31),
        cmocka_unit_test(stratified_candidates_with_systematic_resampling_are_less_noisy),
        cmocka_unit_test(mixture_is_within_1_5_of_the_better_proposal_E26),
        cmocka_unit_test(candidates_are_chosen_in_proportion_to_their_weights_and_in_order),
        cmocka_unit_test(multinomial_choices_are_independent),
        cmocka_unit_test(last_mark_never_runs_past_the_last_positive_candidate),
        cmocka_unit_test(repeats_are_traced_once_and_counted_k_times_E32),
        cmocka_unit_test(colour_of_shadows_is_right_E6),
        cmocka_unit_test(area_weighting_does_not_change_the_picture_E20),
        cmocka_unit_test(eq_4_9_holds_for_F_over_phat_alone_E24),
        cmocka_unit_test(a_set_without_weight_counts_as_0_and_left_out_brightens_the_rest_E25),
        cmocka_unit_test(L_ns_must_come_from_the_same_candidates_E21),
        cmocka_unit_test(furnace_returns_the_albedo_at_grazing_E23),
        cmocka_unit_test(intervals_from_replicates_cover_95_percent_E32),
        cmocka_unit_test(error_of_random_candidates_falls_with_the_square_root_E9),
        cmocka_unit_test(the_number_that_chose_the_lobe_is_used_again_below_1),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
