/* SPDX-License-Identifier: BSD-2-Clause */
/* sir: what is special about resampling: the degenerate case, the variance, the repeats; and the errata of chapter 4 as
 * twins: each is what the thesis prints, computed here from the same candidates, and must be rejected. Family-wise
 * significance 1e-3. */
#include "bis/thesis/phong.h"
#include "bis/thesis/rng.h"
#include "claim.h"
#include "lit.h"
#include "set_help.h"

#include <string.h>

#define SEED 47u

static double alpha(void)
{
    return stat_level(1e-3, 21);
}

static bis_settings sir(bis_proposal proposal, uint32_t M, uint32_t N, bool stratify)
{
    bis_settings s = lit_settings(&bis_sir, proposal, M, N);
    s.stratify = stratify;
    return s;
}

/* ---- E24 ---- */

/* Keeps the direction of the last ray; nothing is hidden. */
typedef struct recorder {
    bis_accel accel;
    vec3 *wi;
} recorder;

static bool record(const bis_accel *a, const ray *r)
{
    *((const recorder *)a)->wi = r->d;
    return false;
}

static const bis_accel_ops recording = {.name = "recorder", .occluded = record};

typedef struct way_E24 {
    bis_settings s;
    bis_scratch scratch;
    bis_material material;
    bis_sampler_kind kind;
} way_E24;

static way_E24 new_way(bis_settings s, bis_sampler_kind kind, bool brdf)
{
    way_E24 w = {.s = s, .kind = kind, .material = bis_phong(brdf ? grey(0) : grey(0.3), (rgb){0.9f, 0.3f, 0.1f}, 20)};

    assert_int_equal(bis_scratch_init(&w.scratch, &w.s, NULL), BIS_OK);
    return w;
}

/* One estimate, and the direction of its ray. */
static rgb once_along(vec3 *wi, lit *l, bis_light *light, way_E24 *w, uint64_t run)
{
    const recorder rec = {{.ops = &recording}, wi};

    lit_init(l, light, w->material, lit_tilted(), 50, LIT_OPEN);
    l->pt.accel = &rec.accel;
    l->kind = w->kind;
    *wi = (vec3){0, 0, 0};
    const rgb L = lit_once(l, &w->s, &w->scratch, SEED, run);
    l->pt.accel = NULL;
    return L;
}

/* The error of an estimate from the map. f's: of log and exp, 2^-20 (1 + |log|) of the lobe, and n times what two float
 * vectors leave of 1 - cos; the cosine's, 2^-22 (tests/beyond/test_f_many.c); 15 roundings of w and of F/phat
 * (test_set.c): 2^-20. */
static double error_of_em(const lit *l, vec3 wi)
{
    const double n = l->material.exponent, power = bis_phong_power(l->pt.bsdf.r, wi, n), cosine = dot(wi, l->pt.bsdf.r);

    return 0x1p-19 + 0x1p-22 / bis_bsdf_cos(&l->pt.bsdf, wi) +
           (cosine > 0 ? 0x1p-20 * (1 - log(fmax(power, 0x1p-64))) + n * 0x1p-22 * (1 / cosine - 1) : 0);
}

/* How far a direction from the BRDF may be moved. u1 and u2 are rounded to floats, and the lobe's formula is computed
 * in floats: 2^-17 in all, but where u1 is near 1. There its 2^-25, of which twice as much is allowed, moves the cosine
 * about the axis, (1 - u1)^(1/21), by 2^-24/21 of itself over 1 - u1, and the angle by this over the sine. */
static double moved_at_most(const lit *l, vec3 wi)
{
    const double c = fmax(0x1p-5, dot(wi, l->pt.bsdf.r)), sine = length(cross(wi, l->pt.bsdf.r));

    return 0x1p-17 + 0x1p-24 / (21 * pow(c, 20) * fmax(sine, 0x1p-12));
}

/* From the map: the same direction, bit for bit. From the BRDF: the direction is moved, the cosine by as much, and F/q
 * = Le Ks cos/p_s by their quotient, unless a pixel ends in between. */
static void M_1_N_1_is_plain_importance_sampling_E24(void **state)
{
    static const bis_sampler_kind kinds[] = {
        BIS_SAMPLER_RANDOM, BIS_SAMPLER_STRATIFIED, BIS_SAMPLER_SOBOL, BIS_SAMPLER_HALTON};
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0.15, false);

    for (int k = 0; k < 16; k++) {
        const bool brdf = k % 2;
        bis_settings s = sir(brdf ? BIS_PROPOSAL_BRDF : BIS_PROPOSAL_EM, 1, 1, false),
                     plain = bis_settings_default(brdf ? &bis_brdf : &bis_em);
        int judged = 0;
        plain.samples = 1;
        s.resampling = k / 8 ? BIS_RESAMPLING_MULTINOMIAL : BIS_RESAMPLING_SYSTEMATIC;
        way_E24 one = new_way(s, kinds[k / 2 % 4], brdf), other = new_way(plain, kinds[k / 2 % 4], brdf);
        for (uint64_t run = 0; run < 2000; run++) {
            vec3 wi, wi_plain;
            lit l;
            const rgb a = once_along(&wi, &l, light, &one, run), b = once_along(&wi_plain, &l, light, &other, run);
            const vec3 moved = sub(wi, wi_plain);
            if (!brdf) assert_memory_equal(&wi, &wi_plain, sizeof wi);
            assert_true(sqrt(dot(moved, moved)) < moved_at_most(&l, wi));
            if (rgb_is_black(b) || bis_light_Le(light, wi).r != bis_light_Le(light, wi_plain).r) continue;
            const double error = brdf ? 0x1p-19 + moved_at_most(&l, wi) / bis_bsdf_cos(&l.pt.bsdf, wi)
                                      : error_of_em(&l, wi);
            assert_true(fabs((double)a.r / (double)b.r - 1) < error && fabs((double)a.g / (double)b.g - 1) < error &&
                        fabs((double)a.b / (double)b.b - 1) < error);
            judged++;
        }
        assert_true(judged > 1000);
        bis_scratch_clear(&one.scratch);
        bis_scratch_clear(&other.scratch);
    }
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

    /* diffuse: f cos is smooth over the map's patches, so that the variance has no heavy tail and can be tested
     * itself */
    lit_init(&l, light, bis_phong(grey(0.8), grey(0), 1), lit_tilted(), 40, LIT_OPEN);
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

    thesis.resampling = BIS_RESAMPLING_MULTINOMIAL;
    lit_init(&l, light, bis_phong(grey(0.8), grey(0), 1), lit_tilted(), 40, LIT_HALF);
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
    const bis_material materials[] = {bis_phong(grey(0.8), grey(0), 1), bis_phong(grey(0), grey(1), 5),
        bis_phong(grey(0), grey(1), 50), bis_phong(grey(0), grey(1), 1000), bis_phong(grey(0.5), grey(0.5), 50)};

    int em_alone = 0, brdf_alone = 0;

    for (int i = 0; i < 4 * 5; i++) {
        bis_light *light = lit_new_light(maps[i % 4], 1, 0, false);
        double rmse[3], truth = 0;
        for (int p = 0; p < 3; p++) {
            const bis_settings s = sir((bis_proposal)p, 256, 15, false);
            stat_moments m[4];
            lit l;
            lit_init(&l, light, materials[i / 4], lit_tilted(), 40, LIT_OPEN);
            truth = rgbd_sum(lit_truth(&l, true));
            lit_run(m, &l, &s, 1000, SEED);
            rmse[p] = sqrt(stat_variance(&m[3]) + (m[3].mean - truth) * (m[3].mean - truth));
        }
        double better = fmin(rmse[BIS_PROPOSAL_EM], rmse[BIS_PROPOSAL_BRDF]);
        bis_light_free(light);
        if (truth <= 1e-6) continue; /* the lobe misses the block */
        const double bound = 1.5 * better + 1e-5 * truth;
        if (rmse[BIS_PROPOSAL_MIX] > bound) {
            fail_msg(
                "map %d, material %d: em %g, brdf %g, mix %g of %g", i % 4, i / 4, rmse[0], rmse[1], rmse[2], truth);
        }
        em_alone += rmse[BIS_PROPOSAL_EM] > bound;
        brdf_alone += rmse[BIS_PROPOSAL_BRDF] > bound;
    }
    /* twins: "q_L or q_f" */
    assert_true(em_alone >= 3 && brdf_alone >= 3);
}

/* ---- tracing ---- */

/* Eight candidates at +-37 degrees, of which half are hidden; candidate i has the weight w[i], all of it in red and a
 * third of it in green. */
static void repeats_are_traced_once_and_counted_k_times_E32(void **state)
{
    static const float w[8] = {0, 3, 0, 1, 0, 0, 2, 0};
    bis_light *light = lit_new_light(LIT_ONE_BLOCK, 1, 0, false);
    const bis_settings s = sir(BIS_PROPOSAL_EM, 8, 6, false);
    bis_scratch scratch;
    bis_stream stream;
    lit l;

    lit_init(&l, light, bis_phong(grey(0.8), grey(0), 1), (vec3){0, 0, 1}, 0, LIT_HALF);
    assert_int_equal(bis_scratch_init(&scratch, &s, NULL), BIS_OK);
    bis_set *x = scratch.set;
    x->map.x = x->own;
    x->M = x->map.n = 8;
    x->beta = x->unit_of_Le = 1;
    x->brdf.first = 16;
    x->mark = 0.5;
    for (int i = 0; i < 8; i++) {
        x->own.x[i] = 0, x->own.y[i] = i % 2 ? -0.6f : 0.6f, x->own.z[i] = 0.8f;
        x->own.r[i] = 0.75f * w[i], x->own.g[i] = 0.25f * w[i], x->own.q[i] = 1;
    }
    bis_set_weigh(x, &l.pt);
    bis_set_choose(x, 6, BIS_RESAMPLING_SYSTEMATIC, &stream);
    assert_true(
        x->choice.n_chosen == 3 && x->choice.times[0] == 3 && x->choice.times[1] == 1 && x->choice.times[2] == 2);
    const rgbd L = bis_set_trace((rgbd){1, 0, 0}, x, &l.pt, 4);
    assert_int_equal(l.counters.shadow_rays, 3);
    /* of 6 marks 4 are seen, at y < 0; each adds Z F/phat = (3, 1, 0) */
    assert_true(fabs(L.r - 13) < 1e-5 && fabs(L.g - 4) < 1e-5 && L.b == 0);
    bis_scratch_clear(&scratch);
    bis_light_free(light);
}

/* ---- twins: as printed ---- */

/* Another estimate of the same candidates and choices. Z: Zhat. */
typedef rgbd printed(const lit *l, const bis_set *x, double Z);

static stat_moments run_printed(lit *l, bis_proposal proposal, uint32_t M, uint32_t N, uint32_t runs, printed *estimate)
{
    const bis_sampler sampler = {.kind = BIS_SAMPLER_RANDOM, .seed = SEED, .spp = 1};
    const bis_settings s = sir(proposal, M, N, false);
    bis_scratch scratch;
    stat_moments m = {0};

    assert_int_equal(bis_scratch_init(&scratch, &s, NULL), BIS_OK);
    for (uint64_t run = 0; run < runs; run++) {
        bis_stream stream;
        bis_stream_init(&stream, &sampler, run, 0);
        assert_true(bis_set_draw(scratch.set, M, proposal, false, &l->pt, &stream));
        const double Zhat = bis_set_weigh(scratch.set, &l->pt);
        if (Zhat > 0) bis_set_choose(scratch.set, N, BIS_RESAMPLING_MULTINOMIAL, &stream);
        stat_add(&m, Zhat > 0 ? estimate(l, scratch.set, Zhat).r : 0);
    }
    bis_scratch_clear(&scratch);
    return m;
}

static uint32_t n_marks(const bis_set *x)
{
    uint32_t N = 0;

    for (uint32_t j = 0; j < x->choice.n_chosen; j++) N += x->choice.times[j];
    return N;
}

static rgbd ours(const lit *l, const bis_set *x, double Z)
{
    return bis_set_trace((rgbd){0, 0, 0}, x, &l->pt, Z / n_marks(x));
}

static double mean_V(const lit *l, const bis_set *x)
{
    double V = 0;

    for (uint32_t j = 0; j < x->choice.n_chosen; j++)
        V += x->choice.times[j] * bis_point_sees(&l->pt, set_direction(x, x->choice.item[j]));
    return V / n_marks(x);
}

/* Eq. 4.6 as printed: L_ns in RGB times the mean of V. */
static rgbd L_ns_times_mean_V(const lit *l, const bis_set *x, double Z)
{
    return rgbd_scale(bis_set_mean(x), mean_V(l, x));
}

/* Red light blocked, blue light open: the truth has no red, the printed formula turns grey. */
static void colour_of_shadows_is_right_E6(void **state)
{
    bis_light *light = lit_new_light(LIT_RED_BLUE, 1, 0, false);
    lit l;

    lit_init(&l, light, bis_phong(grey(0.9), grey(0), 1), (vec3){0, 0, 1}, 0, LIT_HALF);
    rgbd truth = lit_truth(&l, true);
    assert_true(truth.r == 0 && truth.b > 0.4);
    stat_moments m = run_printed(&l, BIS_PROPOSAL_EM, 32, 4, 4000, ours),
                 twin = run_printed(&l, BIS_PROPOSAL_EM, 32, 4, 4000, L_ns_times_mean_V);
    assert_true(m.mean == 0 && m.m2 == 0);
    stat_assert_not_mean("E6_printed", SEED, &twin, 0, alpha());
    bis_light_free(light);
}

/* E20: q_A has the area factors, the printed weight assumes q_L: f cos times the integral of L. */
static void area_weighting_does_not_change_the_picture_E20(void **state)
{
    static const double b[] = {0, 0.1, 0.2, 1};

    for (int i = 0; i < 4; i++) {
        bis_light *light = lit_new_light(LIT_SPOTTY, 1, b[i], false);
        stat_moments twin = {0};
        bis_settings s = sir(BIS_PROPOSAL_EM, 16, 4, true);
        stat_moments m[4];
        lit l;

        lit_init(&l, light, bis_phong(grey(0.8), grey(0), 1), lit_tilted(), 40, LIT_OPEN);
        rgbd truth = lit_truth(&l, true);
        lit_run(m, &l, &s, 20000, SEED);
        stat_assert_mean("E20", SEED, &m[3], rgbd_sum(truth), alpha());

        const bis_sampler sampler = {.kind = BIS_SAMPLER_RANDOM, .seed = SEED, .spp = 1};
        bis_stream stream;
        bis_stream_init(&stream, &sampler, 9, 0);
        for (int run = 0; run < 40000; run++) {
            bis_light_point y;
            double u[4];
            for (int k = 0; k < 4; k++) u[k] = bis_stream_random(&stream);
            assert_true(bis_light_sample(light, u, &y));
            stat_add(
                &twin, (double)l.material.Kd.r / PI * fmax(0, bis_bsdf_cos(&l.pt.bsdf, y.wi)) * bis_light_power(light));
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
static rgbd F_over_w(const lit *l, const bis_set *x, double Z)
{
    const uint32_t y = x->choice.item[0];

    return rgbd_scale(F(l, set_direction(x, y)), 1 / bis_set_weight(x, y));
}

/* Eq. 4.9 with f as in 4.8, the whole integrand, and not what is left of it after division by phat. */
static rgbd F_times_mean_w(const lit *l, const bis_set *x, double Z)
{
    return rgbd_scale(F(l, set_direction(x, x->choice.item[0])), Z);
}

static void eq_4_9_holds_for_F_over_phat_alone_E24(void **state)
{
    static const uint32_t sizes[] = {1, 4};
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0, false);
    lit l;

    lit_init(&l, light, bis_phong(grey(0.8), grey(0), 1), lit_tilted(), 40, LIT_HALF);
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
static rgbd exact_L_ns_times_mean_V(const lit *l, const bis_set *x, double Z)
{
    return rgbd_scale(exact_L_ns, mean_V(l, x));
}

static void L_ns_must_come_from_the_same_candidates_E21(void **state)
{
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0, false);
    lit l;

    lit_init(&l, light, bis_phong(grey(0.2), grey(0.8), 10), lit_tilted(), 40, LIT_HALF);
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
static rgbd weight_is_Le(const lit *l, const bis_set *x, double Z)
{
    double sum = 0;

    for (uint32_t i = 0; i < x->M; i++) {
        const uint32_t number = set_number(x, i);
        if (bis_set_weight(x, number) > 0) sum += (double)bis_light_Le(l->light, set_direction(x, number)).r;
    }
    return (rgbd){sum / x->M, 0, 0};
}

static void furnace_returns_the_albedo_at_grazing_E23(void **state)
{
    static const double degrees[] = {60, 85}, albedo[] = {0.490, 0.108};
    bis_light *light = lit_new_light(LIT_CONSTANT, 1, 0, false);

    for (int i = 0; i < 2; i++) {
        lit l;
        lit_init(&l, light, bis_phong(grey(0), grey(1), 50), lit_tilted(), degrees[i], LIT_OPEN);
        double truth = lit_truth(&l, true).r;
        assert_true(fabs(truth - albedo[i]) < 1e-3);
        stat_moments m = run_printed(&l, BIS_PROPOSAL_BRDF, 16, 4, 10000, ours),
                     twin = run_printed(&l, BIS_PROPOSAL_BRDF, 16, 4, 10000, weight_is_Le);
        stat_assert_mean("E23", SEED, &m, truth, alpha());
        stat_assert_not_mean("E23_printed", SEED, &twin, truth, alpha());
    }
    bis_light_free(light);
}

/* ---- the lobe's own number ---- */

static double lobe_u[2], rest_u;

static bool note_numbers(const bis_bsdf *b, double u0, double u1, double u2, vec3 *wi)
{
    lobe_u[0] = u0, lobe_u[1] = u2, rest_u = u1;
    *wi = (vec3){0, 0, 1};
    return true;
}

/* Of u[0] < p = 1/4 the lobe gets 4 u[0], of the others 4/3 (u[0] - 1/4). With p = 1/4 + 3 x 2^-54 and u[0] = 1 - 2^-53
 * both differences are halves of the last bit and round to the same even number, 3/4 - 2^-52: the quotient 1 is no
 * number of [0,1), and the largest one below it is taken. */
static void the_number_that_chose_the_lobe_is_used_again_below_1(void **state)
{
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

/* Without a guide nothing finds the lobe but the BRDF's own candidates: "product" then divides as "mix" does. Its
 * mixture had a quarter of them, and 1.5 times the squared error. */
static void product_without_a_guide_is_mix(void **state)
{
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0.15, false);
    lit l;
    lit_init(&l, light, bis_phong(grey(0.3), grey(0.6), 50), lit_tilted(), 40, LIT_HALF);
    for (int stratify = 0; stratify < 2; stratify++)
        for (uint64_t run = 0; run < 20; run++) {
            rgb L[2];
            for (int k = 0; k < 2; k++) {
                const bis_settings s = sir(k ? BIS_PROPOSAL_PRODUCT : BIS_PROPOSAL_MIX, 128, 8, stratify);
                bis_scratch scratch;
                assert_int_equal(bis_scratch_init(&scratch, &s, NULL), BIS_OK);
                L[k] = lit_once(&l, &s, &scratch, SEED, run);
                bis_scratch_clear(&scratch);
            }
            assert_memory_equal(&L[0], &L[1], sizeof *L);
        }
    bis_light_free(light);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(M_1_N_1_is_plain_importance_sampling_E24),
        cmocka_unit_test(unshadowed_grey_point_has_only_the_candidates_variance_E31),
        cmocka_unit_test(stratified_candidates_with_systematic_resampling_are_less_noisy),
        cmocka_unit_test(mixture_is_within_1_5_of_the_better_proposal_E26),
        cmocka_unit_test(repeats_are_traced_once_and_counted_k_times_E32),
        cmocka_unit_test(colour_of_shadows_is_right_E6),
        cmocka_unit_test(area_weighting_does_not_change_the_picture_E20),
        cmocka_unit_test(eq_4_9_holds_for_F_over_phat_alone_E24),
        cmocka_unit_test(a_set_without_weight_counts_as_0_and_left_out_brightens_the_rest_E25),
        cmocka_unit_test(L_ns_must_come_from_the_same_candidates_E21),
        cmocka_unit_test(furnace_returns_the_albedo_at_grazing_E23),
        cmocka_unit_test(the_number_that_chose_the_lobe_is_used_again_below_1),
        cmocka_unit_test(product_without_a_guide_is_mix),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
