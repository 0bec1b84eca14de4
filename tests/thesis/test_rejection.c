/* SPDX-License-Identifier: BSD-2-Clause */
/* rejection: what is accepted is distributed as the product, how many are, and what each estimator and fallback is
 * biased by. The unbiased settings are also in test_integrators.c. Family-wise significance 1e-3. */
#include "bis/beyond/microfacet.h"
#include "bis/thesis/phong.h"
#include "bis/thesis/rng.h"
#include "bis/thesis/warp.h"
#include "bis/scene/light_load.h"
#include "thesis/light_many.h"

#include "claim.h"
#include "lit.h"
#include "set_help.h"

#define SEED 53u

static double alpha(void)
{
    return stat_level(1e-3, 14);
}

static bis_settings rejection(bis_proposal proposal, uint32_t M, uint32_t N, bis_estimator estimator)
{
    bis_settings s = lit_settings(&bis_rejection, proposal, M, N);
    s.estimator = estimator;
    return s;
}

/* ---- what is accepted ---- */

/* Counts the rays by block of 8 x 8 pixels. */
enum { ACROSS = 16, DOWN = 8, BLOCKS = ACROSS * DOWN };

typedef struct recorder {
    bis_accel accel;
    double *hits;
} recorder;

static int block_of(double x, double y, double z)
{
    double phi = atan2(y, x), turns = phi < 0 ? phi / (2 * PI) + 1 : phi / (2 * PI);

    return (int)(acos(z) / PI * DOWN) * ACROSS + (int)(turns * ACROSS) % ACROSS;
}

static bool record(const bis_accel *a, const ray *r)
{
    ((const recorder *)a)->hits[block_of((double)r->d.x, (double)r->d.y, fmax(-1, fmin(1, (double)r->d.z)))]++;
    return false;
}

/* p (eq. 4.4) of a diffuse surface, integrated over the blocks. */
static void expect_product(double *expected, const lit *l, double count)
{
    enum { K = 64 };
    double total = 0;

    for (int i = 0; i < BLOCKS; i++) {
        double c0 = cos(PI * (i / ACROSS) / DOWN), c1 = cos(PI * ((int)(i / ACROSS) + 1) / DOWN);
        expected[i] = 0;
        for (int k = 0; k < K * K; k++) {
            double z = c0 + (c1 - c0) * ((int)(k / K) + 0.5) / K,
                   phi = 2 * PI * (i % ACROSS + (k % K + 0.5) / K) / ACROSS, s = sqrt(1 - z * z);
            vec3 wi = vec3_from(s * cos(phi), s * sin(phi), z);
            expected[i] +=
                rgb_sum(rgb_mul(l->material.Kd, bis_light_Le(l->light, wi))) * fmax(0, dot(wi, l->pt.n)) * (c0 - c1);
        }
        total += expected[i];
    }
    for (int i = 0; i < BLOCKS; i++) expected[i] *= count / total;
}

static void accepted_directions_have_the_product_density_eq_4_4(void **state)
{
    static const bis_accel_ops recording = {.name = "recorder", .occluded = record};
    static const bis_proposal proposals[] = {BIS_PROPOSAL_EM, BIS_PROPOSAL_BRDF, BIS_PROPOSAL_CHOOSE};
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0.15, false);

    for (int i = 0; i < 4; i++) {
        double hits[BLOCKS] = {0}, expected[BLOCKS];
        recorder rec = {{.ops = &recording}, hits};
        bis_settings s = i < 3 ? rejection(proposals[i], 16, 16, BIS_ESTIMATOR_PLAIN) : bis_settings_default(&bis_em);
        stat_moments m[4];
        lit l;

        lit_init(&l, light, bis_phong((rgb){0.9f, 0.5f, 0.2f}, grey(0), 1), lit_tilted(), 40, LIT_OPEN);
        l.pt.accel = &rec.accel;
        lit_run(m, &l, &s, 20000, SEED);
        expect_product(expected, &l, (double)l.counters.shadow_rays);
        if (i < 3) {
            assert_int_equal(l.counters.accepted, l.counters.shadow_rays);
            stat_assert_fit("rejection_product", SEED, hits, expected, BLOCKS, alpha());
        } else { /* twin: directions from the map alone, none rejected */
            stat_assert_no_fit("rejection_em", SEED, hits, expected, BLOCKS, alpha());
        }
    }
    bis_light_free(light);
}

/* E27: the mean acceptance is L_ns/B, and no acceptance probability exceeds 1 (asserted while rendering, too). */
static void mean_acceptance_is_L_ns_over_B_E27(void **state)
{
    static const lit_map maps[] = {LIT_SPOTTY, LIT_SMOOTH, LIT_CONSTANT};

    for (int i = 0; i < 6; i++) {
        bis_light *light = lit_new_light(maps[i / 2], 1, 0.15, false);
        const bis_proposal proposal = i % 2 ? BIS_PROPOSAL_BRDF : BIS_PROPOSAL_EM;
        const bis_settings s = rejection(proposal, 8, 4, BIS_ESTIMATOR_PLAIN);
        stat_moments accepted = {0};
        bis_scratch scratch;
        lit l;

        lit_init(&l, light, bis_phong(grey(0.5), grey(0.5), 5), lit_tilted(), 40, LIT_OPEN);
        assert_int_equal(bis_scratch_init(&scratch, &s, NULL), BIS_OK);
        for (uint64_t run = 0; run < 30000; run++) {
            uint64_t before = l.counters.accepted;
            lit_once(&l, &s, &scratch, SEED, run);
            stat_add(&accepted, (double)(l.counters.accepted - before) / 8);
        }
        double expected = rgbd_sum(lit_truth(&l, false)) / bis_candidates_bound(&l.pt, proposal);
        assert_true(expected < 1);
        stat_assert_mean("E27", SEED, &accepted, expected, alpha());
        /* twin: c = f_max in place of f_max Lam / L_ns, as printed: M = f_max N */
        if (proposal == BIS_PROPOSAL_EM)
            stat_assert_not_mean("E27_printed", SEED, &accepted, fmin(1, 1 / bis_bsdf_max_f_cos(&l.pt.bsdf)), alpha());
        bis_scratch_clear(&scratch);
        bis_light_free(light);
    }
}

/* "choose" takes each proposal with a probability as the other's bound. So the mean share of accepted candidates is
 * that of both, L_ns/B, in these shares. The twin prefers the larger bound: there the share is 2 L_ns/(B_em + B_brdf).
 * */
static void choose_prefers_the_smaller_bound_by_the_acceptance_that_comes_out(void **state)
{
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0.15, false);
    const bis_settings s = rejection(BIS_PROPOSAL_CHOOSE, 8, 4, BIS_ESTIMATOR_PLAIN);
    stat_moments accepted = {0};
    bis_scratch scratch;
    lit l;

    lit_init(&l, light, bis_phong(grey(0.2), grey(0.8), 20), lit_tilted(), 40, LIT_OPEN);
    assert_int_equal(bis_scratch_init(&scratch, &s, NULL), BIS_OK);
    for (uint64_t run = 0; run < 30000; run++) {
        const uint64_t before = l.counters.accepted;
        lit_once(&l, &s, &scratch, SEED, run);
        stat_add(&accepted, (double)(l.counters.accepted - before) / 8);
    }
    const double L_ns = rgbd_sum(lit_truth(&l, false)), em = bis_candidates_bound(&l.pt, BIS_PROPOSAL_EM),
                 brdf = bis_candidates_bound(&l.pt, BIS_PROPOSAL_BRDF);
    stat_assert_mean("choose", SEED, &accepted, L_ns * (brdf / em + em / brdf) / (em + brdf), alpha());
    stat_assert_not_mean("choose_larger", SEED, &accepted, 2 * L_ns / (em + brdf), alpha());
    bis_scratch_clear(&scratch);
    bis_light_free(light);
}

/* ---- the bound ---- */

enum { N_DIRECTIONS = 2048 };

/* Where w may reach B: drawn from the material, about the mirror's direction at all scales, next to the horizon,
 * everywhere. */
static void fill_directions(const bis_lanes *y, const bis_bsdf *b, uint64_t seed)
{
    bis_rng r;

    bis_rng_init(&r, SEED, seed, 0, 0);
    for (uint32_t i = 0; i < N_DIRECTIONS; i++) {
        const double u[3] = {bis_rng_double(&r), bis_rng_double(&r), bis_rng_double(&r)};
        const double near = exp(-30 * u[0]), phi = 2 * PI * u[1];
        const vec3 rim = vec3_from(cos(near) * cos(phi), cos(near) * sin(phi), sin(near));
        const vec3 anywhere = bis_warp_sphere(u[1], u[2]);
        vec3 wi = anywhere;
        if (i % 4 == 0) bis_bsdf_draw(b, u, &wi);
        if (i % 4 == 1) wi = normalize(add(b->r, mul(anywhere, near)));
        if (i % 4 == 2) wi = to_world(&b->local, rim);
        y->x[i] = wi.x, y->y[i] = wi.y, y->z[i] = wi.z;
    }
}

/* The largest w/B - 1 over the directions, B as in candidates.h. */
static double excess(bis_set *x, lit *l, bis_proposal proposal, uint64_t seed)
{
    const bool em = proposal == BIS_PROPOSAL_EM;
    const double B = bis_candidates_bound(&l->pt, proposal);
    const bis_lanes *y = em ? &x->own : &x->brdf.x;
    double worst = -1;

    fill_directions(y, &l->pt.bsdf, seed);
    bis_light_look(l->light, y, x->pixel, N_DIRECTIONS);
    for (uint32_t i = 0; em && bis_light_is_constant(l->light) && i < N_DIRECTIONS; i++) y->q[i] = (float)(INV_PI / 4);
    x->M = N_DIRECTIONS;
    x->beta = em;
    x->unit_of_Le = bis_light_mean(l->light);
    x->map = (bis_half){x->own, em ? N_DIRECTIONS : 0, 0};
    x->brdf.n = em ? 0 : N_DIRECTIONS;
    x->brdf.first = x->map.n;
    bis_set_weigh(x, &l->pt);
    for (uint32_t i = 0; i < N_DIRECTIONS; i++) worst = fmax(worst, bis_set_weight(x, i) / B - 1);
    return worst;
}

static bis_material extreme(int k)
{
    static const double exponents[] = {0, 1, 50, 1e5, 1e8}, indices[] = {1.5, 0.6, 1.05, 1.001};
    static const double roughnesses[] = {BIS_MICROFACET_MIN_ROUGHNESS, 0.1, 0.5, 1};
    const double n = exponents[k / 12 % 5], a = roughnesses[k / 12 % 4],
                 Ks = (double[]){1, 0.04, 1e-3, 1e-6}[k / 12 % 3];

    switch (k % 12) {
    case 0: return bis_phong(grey(0), grey(1), n);
    case 1: return bis_phong(grey(0.5), grey(0.05), n);
    case 2: return bis_phong(grey(1), grey(0), n);
    case 3: return bis_microfacet(grey(0), grey(Ks), a);
    case 4: return bis_microfacet(grey(0.5), grey(Ks), a);
    case 5: return bis_microfacet_metal(grey(0.9), grey(0.2), a);
    case 6: return bis_microfacet_metal(grey(0.05), grey(0.6), a);
    case 7: return bis_microfacet_metal(grey(1e-3), grey(1.01), a);
    default: return bis_plastic(k / 12 % 2 ? grey(0) : grey(0.5), grey(0.04), indices[k % 4], a);
    }
}

/* What floats may add to w is derived in src/thesis/rejection.c. */
static void no_weight_exceeds_the_bound_by_more_than_2_to_the_minus_16_E27(void **state)
{
    static const double degrees[] = {0, 40, 85, 89.9};
    bis_light *lights[] = {lit_new_light(LIT_SPOTTY, 1e-35, 0, false), lit_new_light(LIT_SMOOTH, 1e30, 0.15, false),
                           lit_new_light(LIT_CONSTANT, 1, 0, false)};
    const bis_settings s = rejection(BIS_PROPOSAL_EM, N_DIRECTIONS, 1, BIS_ESTIMATOR_PLAIN);
    bis_scratch scratch;
    double worst = -1;

    assert_int_equal(bis_scratch_init(&scratch, &s, NULL), BIS_OK);
    for (int k = 0; k < 60 * 4 * 3 * 2; k++) {
        lit l;
        lit_init(&l, lights[k / 240 % 3], extreme(k % 60), lit_tilted(), degrees[k / 60 % 4], LIT_OPEN);
        worst = fmax(worst, excess(scratch.set, &l, k / 720 ? BIS_PROPOSAL_BRDF : BIS_PROPOSAL_EM, (uint64_t)k));
    }
    print_message("w is at most B (1 %+.2f 2^-16)\n", worst * 0x1p16);
    assert_true(worst <= 0x1p-16);
    assert_true(worst > -0x1p-20); /* twin: a bound that is smaller by 2^-20 is exceeded */
    bis_scratch_clear(&scratch);
    for (int i = 0; i < 3; i++) bis_light_free(lights[i]);
}

/* A map that is black but for one pixel (x, y) of 128 x 64. *solid_angle: its size. */
static bis_light *one_texel_sun(int x, int y, double *solid_angle)
{
    const bis_light_desc desc = {.L = {1, 1, 1}, .scale = 1, .levels = 8, .to_world = bis_xform_identity()};
    bis_image image;
    bis_light *light;
    bis_envmap em;

    assert_int_equal(bis_image_init(&image, 128, 64, NULL), BIS_OK);
    image.pixels[y * 128 + x] = (rgb){1e7f, 1e7f, 1e7f};
    assert_int_equal(bis_envmap_from_latlong(&em, &image, NULL), BIS_OK);
    *solid_angle = em.row_solid_angle[y];
    assert_int_equal(bis_light_from_envmap(&light, &em, &desc, BIS_NEED_TABLE, NULL), BIS_OK);
    return light;
}

/* Rejecting candidates of the BRDF against a map with one sun: of a white diffuse surface's, those in the sun's
 * pixel are accepted and no others, a share of (integral of cos over the pixel)/pi, which is 2/128 (sin^2 - sin^2)/2
 * of its upper and lower edge. For one accepted direction that takes thousands. Printed is p < L_max q_f, M ~ L_max
 * N, L_max = 1/(its solid angle) the largest value of q_L: too few by the factor D of E27, here pi/cos. */
static void expected_M_on_a_one_texel_sun_is_pi_over_its_projected_solid_angle_E28(void **state)
{
    static const int rows[] = {2, 10, 25};

    for (int i = 0; i < 3; i++) {
        const double top = sin(PI * rows[i] / 64), bottom = sin(PI * (rows[i] + 1) / 64);
        const double share = (bottom * bottom - top * top) / 128;
        const bis_settings s = rejection(BIS_PROPOSAL_BRDF, 800, 15, BIS_ESTIMATOR_PLAIN);
        double solid_angle;
        bis_light *light = one_texel_sun(40, rows[i], &solid_angle);
        stat_moments accepted = {0};
        bis_scratch scratch;
        lit l;

        lit_init(&l, light, bis_phong(grey(1), grey(0), 1), (vec3){0, 0, 1}, 30, LIT_OPEN);
        assert_int_equal(bis_scratch_init(&scratch, &s, NULL), BIS_OK);
        for (uint64_t run = 0; run < 10000; run++) {
            const uint64_t before = l.counters.accepted;
            lit_once(&l, &s, &scratch, SEED, run);
            stat_add(&accepted, (double)(l.counters.accepted - before) / 800);
        }
        assert_int_equal(l.counters.candidates, 10000 * 800); /* capped: whatever N asks for */
        print_message("one pixel of %.2g sr: M = %.0f for one accepted, expected %.0f; as printed %.0f\n", solid_angle,
                      1 / accepted.mean, 1 / share, 1 / solid_angle);
        stat_assert_mean("E28", SEED, &accepted, share, alpha());
        stat_assert_not_mean("E28_printed", SEED, &accepted, solid_angle, alpha());
        bis_scratch_clear(&scratch);
        bis_light_free(light);
    }
}

static void at_most_N_of_the_accepted_are_traced_each_once(void **state)
{
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0.15, false);
    const bis_settings s = rejection(BIS_PROPOSAL_EM, 20, 3, BIS_ESTIMATOR_RATIO);
    bis_scratch scratch;
    lit l;

    lit_init(&l, light, bis_phong(grey(0.8), grey(0), 1), lit_tilted(), 40, LIT_OPEN);
    assert_int_equal(bis_scratch_init(&scratch, &s, NULL), BIS_OK);
    for (uint64_t run = 0; run < 2000; run++) {
        l.counters = (bis_counters){0};
        lit_once(&l, &s, &scratch, SEED, run);
        assert_int_equal(l.counters.candidates, 20);
        if (l.counters.accepted > 0)
            assert_int_equal(l.counters.shadow_rays, l.counters.accepted < 3 ? l.counters.accepted : 3);
        assert_int_equal(l.counters.fallbacks, l.counters.accepted == 0);
    }
    bis_scratch_clear(&scratch);
    bis_light_free(light);
}

/* ---- bias ---- */

/* E22: drawing until N are accepted, with L_ns from all draws so far: M is a stopping time that ends in a success. */
static void stopping_at_the_Nth_acceptance_is_biased_E22(void **state)
{
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0, false);
    const bis_settings fixed = rejection(BIS_PROPOSAL_EM, 12, 1, BIS_ESTIMATOR_PLAIN);
    stat_moments m[4], twin = {0};
    lit l;

    lit_init(&l, light, bis_phong(grey(0.2), grey(0.8), 10), lit_tilted(), 40, LIT_HALF);
    double truth = rgbd_sum(lit_truth(&l, true)), B = bis_candidates_bound(&l.pt, BIS_PROPOSAL_EM);
    lit_run(m, &l, &fixed, 40000, SEED);
    stat_assert_mean("E22", SEED, &m[3], truth, alpha());

    const bis_sampler sampler = {.kind = BIS_SAMPLER_RANDOM, .seed = SEED, .spp = 1};
    bis_scratch scratch;
    assert_int_equal(bis_scratch_init(&scratch, &fixed, NULL), BIS_OK);
    for (uint64_t run = 0; run < 20000; run++) {
        double W = 0, M = 0, w;
        bis_stream stream;
        bis_stream_init(&stream, &sampler, run, 0);
        do { /* of two, the first: a single one would reuse its set's point */
            assert_true(bis_set_draw(scratch.set, 2, BIS_PROPOSAL_EM, false, &l.pt, &stream));
            bis_set_weigh(scratch.set, &l.pt);
            W += w = bis_set_weight(scratch.set, 0);
            M++;
        } while (bis_stream_random(&stream) * B >= w);
        stat_add(&twin, W / M * bis_point_sees(&l.pt, set_direction(scratch.set, 0)));
    }
    bis_scratch_clear(&scratch);
    stat_assert_not_mean("E22_printed", SEED, &twin, truth, alpha());
    bis_light_free(light);
}

static void ratio_estimator_is_right_to_a_percent_at_M_800(void **state)
{
    static const bis_proposal proposals[] = {BIS_PROPOSAL_EM, BIS_PROPOSAL_BRDF, BIS_PROPOSAL_CHOOSE};
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0.15, false);

    for (int i = 0; i < 3; i++) {
        const bis_settings s = rejection(proposals[i], 800, 15, BIS_ESTIMATOR_RATIO);
        stat_moments m[4];
        lit l;
        lit_init(&l, light, bis_phong(grey(0.5), grey(0.5), 5), lit_tilted(), 40, LIT_HALF);
        lit_run(m, &l, &s, 1500, SEED);
        assert_true(fabs(m[3].mean / rgbd_sum(lit_truth(&l, true)) - 1) < 0.015);
    }
    bis_light_free(light);
}

/* E29: nothing accepted. The printed rule adds light in shadow; resampling the same candidates does not. */
static void fallback_unoccluded_brightens_shadows_and_resample_does_not_E29(void **state)
{
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0, false);
    stat_moments m[3][4];

    for (int k = 0; k < 3; k++) {
        bis_settings s = rejection(BIS_PROPOSAL_EM, 32, 4, BIS_ESTIMATOR_RATIO);
        lit l;
        s.fallback = (bis_fallback[]){BIS_FALLBACK_RESAMPLE, BIS_FALLBACK_SUBSET, BIS_FALLBACK_UNOCCLUDED}[k];
        lit_init(&l, light, bis_phong(grey(0), grey(1), 1000), lit_tilted(), 40, LIT_ALL);
        lit_run(m[k], &l, &s, 2000, SEED);
        assert_true(l.counters.fallbacks > 1000);
    }
    assert_true(m[0][3].mean == 0 && m[0][3].m2 == 0);
    assert_true(m[1][3].mean == 0 && m[1][3].m2 == 0);
    assert_true(m[2][3].mean > 0);

    for (int k = 0; k < 3; k++) {
        bis_settings s = rejection(BIS_PROPOSAL_EM, 32, 4, BIS_ESTIMATOR_RATIO);
        lit l;
        s.fallback = (bis_fallback[]){BIS_FALLBACK_RESAMPLE, BIS_FALLBACK_SUBSET, BIS_FALLBACK_UNOCCLUDED}[k];
        lit_init(&l, light, bis_phong(grey(0), grey(1), 300), (vec3){0, 0, 1}, 40, LIT_HALF);
        /* the lobe looks at y < 0: turn the eye so that it straddles the occluder's edge */
        l.pt.wo = normalize(vec3_from(0.6, 0.03, 0.8));
        bis_bsdf_init(&l.pt.bsdf, &l.material, l.pt.n, l.pt.wo);
        double truth = rgbd_sum(lit_truth(&l, true));
        lit_run(m[k], &l, &s, 20000, SEED);
        assert_true(l.counters.fallbacks > 10000);
        if (k == 0)
            assert_true(
                fabs(m[k][3].mean / truth - 1) < 0.1); /* what remains is the O(1/M) of the ratio, and noise of 3 % */
        if (k == 2) assert_true(m[k][3].mean / truth - 1 > 0.1);
    }
    bis_light_free(light);
}

static void plain_returns_0_when_nothing_is_accepted_and_counts_no_fallback(void **state)
{
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0, false);
    const bis_settings s = rejection(BIS_PROPOSAL_EM, 4, 4, BIS_ESTIMATOR_PLAIN);
    bis_scratch scratch;
    int none = 0;
    lit l;

    lit_init(&l, light, bis_phong(grey(0), grey(1), 1000), lit_tilted(), 40, LIT_OPEN);
    assert_int_equal(bis_scratch_init(&scratch, &s, NULL), BIS_OK);
    for (uint64_t run = 0; run < 500; run++) {
        l.counters = (bis_counters){0};
        rgb L = lit_once(&l, &s, &scratch, SEED, run);
        assert_int_equal(l.counters.fallbacks, 0);
        if (l.counters.accepted > 0) continue;
        none++;
        assert_true(rgb_is_black(L) && l.counters.shadow_rays == 0);
    }
    assert_true(none > 400);
    bis_scratch_clear(&scratch);
    bis_light_free(light);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(accepted_directions_have_the_product_density_eq_4_4),
        cmocka_unit_test(mean_acceptance_is_L_ns_over_B_E27),
        cmocka_unit_test(no_weight_exceeds_the_bound_by_more_than_2_to_the_minus_16_E27),
        cmocka_unit_test(choose_prefers_the_smaller_bound_by_the_acceptance_that_comes_out),
        cmocka_unit_test(expected_M_on_a_one_texel_sun_is_pi_over_its_projected_solid_angle_E28),
        cmocka_unit_test(at_most_N_of_the_accepted_are_traced_each_once),
        cmocka_unit_test(stopping_at_the_Nth_acceptance_is_biased_E22),
        cmocka_unit_test(ratio_estimator_is_right_to_a_percent_at_M_800),
        cmocka_unit_test(fallback_unoccluded_brightens_shadows_and_resample_does_not_E29),
        cmocka_unit_test(plain_returns_0_when_nothing_is_accepted_and_counts_no_fallback),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
