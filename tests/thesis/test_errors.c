/* SPDX-License-Identifier: BSD-2-Clause */
/* Errors: they fall with the square root of the cost, error bars are true, and furnaces are exact or right in the mean,
 * for every integrator. (Variances against theory: tests/thesis/test_enumeration.c.) Family-wise significance 1e-3. */
#include "bis/thesis/phong.h"
#include "bis/thesis/rng.h"
#include "bis/base/stats.h"
#include "claim.h"
#include "lit.h"
#include "set_help.h"

#define SEED 61u

/* The furnace: 9 integrators at 4 angles; when to stop: 1. */
static double alpha(void) { return stat_level(1e-3, 37); }

enum { N_INTEGRATORS = 9 };

/* Every unbiased integrator, its parts in the proportion 4 candidates to 1 ray. */
static bis_settings unbiased(int i, uint32_t scale)
{
    static const bis_integrator *const integrators[N_INTEGRATORS] = {
        &bis_em, &bis_brdf, &bis_mis, &bis_sir, &bis_sir, &bis_sir, &bis_rejection, &bis_rejection, &bis_rejection};
    static const bis_proposal proposals[N_INTEGRATORS] = {BIS_PROPOSAL_MIX, BIS_PROPOSAL_MIX, BIS_PROPOSAL_MIX,
        BIS_PROPOSAL_EM, BIS_PROPOSAL_BRDF, BIS_PROPOSAL_MIX, BIS_PROPOSAL_EM, BIS_PROPOSAL_BRDF, BIS_PROPOSAL_CHOOSE};
    bis_settings s = bis_settings_default(integrators[i]);

    s.samples = 4 * scale;
    s.candidates = 8 * scale;
    s.shadowrays = 2 * scale;
    s.proposal = proposals[i];
    s.stratify = false;
    s.resampling = BIS_RESAMPLING_MULTINOMIAL;
    s.estimator = BIS_ESTIMATOR_PLAIN;
    return s;
}

/* ---- convergence ---- */

/* Slope of log RMSE against log cost, cost in candidates and rays as counted, from scales 1, 4 and 16: -1/2, within
 * 0.05 (RMSE of 6000, 3000 and 1500 estimates is good to 1 to 2 %, the slope over a factor of 16 to 0.01). */
static void error_falls_with_the_square_root_of_the_cost_for_every_integrator_E9(void **state)
{
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0.15, false);

    for (int i = 0; i < N_INTEGRATORS; i++) {
        double slope[2], x[3], y[3];
        for (int k = 0; k < 3; k++) {
            const bis_settings s = unbiased(i, 1u << 2 * k);
            const uint32_t runs = 6000u >> k;
            stat_moments m[4];
            lit l;
            lit_init(&l, light, bis_phong(grey(0.5), grey(0.4), 5), lit_tilted(), 40, LIT_HALF);
            l.kind = BIS_SAMPLER_RANDOM;
            const double truth = rgbd_sum(lit_truth(&l, true));
            lit_run(m, &l, &s, runs, SEED);
            const double drawn = (double)l.counters.candidates + (double)l.counters.shadow_rays;
            x[k] = log((l.counters.candidates ? drawn : (double)s.samples * runs) / runs);
            y[k] = log(stat_variance(&m[3]) + (m[3].mean - truth) * (m[3].mean - truth)) / 2;
        }
        for (int k = 0; k < 2; k++) slope[k] = (y[k + 1] - y[k]) / (x[k + 1] - x[k]);
        const double over_all = (y[2] - y[0]) / (x[2] - x[0]);
        const bis_settings s = unbiased(i, 1);
        print_message("%s, proposal %s: slope %.3f (%.3f, %.3f)\n", s.integrator->name, bis_proposal_name(s.proposal),
            over_all, slope[0], slope[1]);
        assert_true(fabs(over_all + 0.5) < 0.05);
        assert_true(fabs(over_all + 2) > 0.05); /* "image quality depends on N^2" */
    }
    bis_light_free(light);
}

/* ---- error bars ---- */

enum { REPLICATES = 16, RUNS = 10000 };

/* 10^4 intervals mean +- t(15) s/4 from 16 independent estimates each. */
static void intervals_from_16_replicates_cover_95_percent_of_10000_runs_E32(void **state)
{
    static const int tried[] = {0, 2, 5, 6};
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0.15, false);

    for (int i = 0; i < 4; i++) {
        const bis_settings s = unbiased(tried[i], tried[i] == 6 ? 4 : 1);
        uint32_t covered = 0;
        bis_scratch scratch;
        lit l;
        lit_init(&l, light, bis_phong(grey(0.6), grey(0.3), 5), lit_tilted(), 40, LIT_HALF);
        const double truth = rgbd_sum(lit_truth(&l, true));
        assert_int_equal(bis_scratch_init(&scratch, &s, NULL), BIS_OK);
        for (uint64_t run = 0; run < RUNS; run++) {
            stat_moments m = {0};
            for (uint64_t k = 0; k < REPLICATES; k++)
                stat_add(&m, rgb_sum(lit_once(&l, &s, &scratch, SEED, run * REPLICATES + k)));
            covered +=
                bis_stats_student_p((m.mean - truth) / sqrt(stat_variance(&m) / REPLICATES), REPLICATES - 1) >= 0.05;
        }
        print_message("%s: %.2f %% of 95 %% intervals hold the truth\n", s.integrator->name, 100.0 * covered / RUNS);
        assert_true(covered > 0.93 * RUNS && covered < 0.97 * RUNS);
        bis_scratch_clear(&scratch);
    }
    bis_light_free(light);
}

/* Twin: the 16 rays of ONE set of 8 candidates taken for replicates. They share the candidates, whose own error no ray
 * sees. */
static void intervals_from_the_rays_of_one_set_do_not_cover_E32(void **state)
{
    enum { M = 8, N = 16, SETS = 2000 };
    const bis_sampler sampler = {.kind = BIS_SAMPLER_RANDOM, .seed = SEED, .spp = 1};
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0.15, false);
    bis_settings s = bis_settings_default(&bis_sir);
    uint32_t covered = 0;
    bis_scratch scratch;
    lit l;

    s.candidates = M;
    s.shadowrays = N;
    lit_init(&l, light, bis_phong(grey(0.6), grey(0.3), 5), lit_tilted(), 40, LIT_HALF);
    const double truth = rgbd_sum(lit_truth(&l, true));
    assert_int_equal(bis_scratch_init(&scratch, &s, NULL), BIS_OK);
    const bis_choice *chosen = &scratch.set->choice;
    for (uint64_t run = 0; run < SETS; run++) {
        stat_moments m = {0};
        bis_stream stream;
        bis_stream_init(&stream, &sampler, run, 0);
        assert_true(bis_set_draw(scratch.set, M, BIS_PROPOSAL_MIX, false, &l.pt, &stream));
        const double Zhat = bis_set_weigh(scratch.set, &l.pt);
        bis_set_choose(scratch.set, N, BIS_RESAMPLING_MULTINOMIAL, &stream);
        for (uint32_t j = 0; j < chosen->n_chosen; j++) {
            const bool V = bis_point_sees(&l.pt, set_direction(scratch.set, chosen->item[j]));
            for (uint32_t k = 0; k < chosen->times[j]; k++) stat_add(&m, Zhat * V);
        }
        const double error = sqrt(stat_variance(&m) / N);
        covered += error > 0 && bis_stats_student_p((m.mean - truth) / error, N - 1) >= 0.05;
    }
    bis_scratch_clear(&scratch);
    print_message("rays of one set: %.1f %%\n", 100.0 * covered / SETS);
    assert_true(covered < 0.93 * SETS);
    bis_light_free(light);
}

/* ---- when to stop ---- */

/* Estimates until the standard error of their mean is 15 % of it; at least four, not all of them 0. *next: the first
 * run not yet used. */
static stat_moments until_error(lit *l, const bis_settings *s, bis_scratch *scratch, uint64_t *next)
{
    stat_moments m = {0};

    while (m.n < 4 || m.mean == 0 || sqrt(stat_variance(&m) / m.n) > 0.15 * m.mean) {
        stat_add(&m, rgb_sum(lit_once(l, s, scratch, SEED, (*next)++)));
    }
    return m;
}

/* How long to go on may depend on the time, or on the scatter of other estimates; not on that of the estimates that
 * are kept: those stop where their mean happens to be large for its scatter. */
static void stopping_by_the_kept_estimates_own_error_is_biased_and_by_that_of_others_is_not_E39(void **state)
{
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0, false);
    bis_settings s = bis_settings_default(&bis_em);
    stat_moments right = {0}, twin = {0};
    uint64_t next = 0;
    bis_scratch scratch;
    lit l;

    s.samples = 1;
    lit_init(&l, light, bis_phong(grey(0.5), grey(0.4), 5), lit_tilted(), 40, LIT_HALF);
    l.kind = BIS_SAMPLER_RANDOM;
    const double truth = rgbd_sum(lit_truth(&l, true));
    assert_int_equal(bis_scratch_init(&scratch, &s, NULL), BIS_OK);
    for (int run = 0; run < 5000; run++) {
        const stat_moments pilot = until_error(&l, &s, &scratch, &next);
        stat_moments kept = {0};
        while (kept.n < pilot.n) stat_add(&kept, rgb_sum(lit_once(&l, &s, &scratch, SEED, next++)));
        stat_add(&right, kept.mean);
        stat_add(&twin, pilot.mean);
    }
    print_message("stopped by own error: %+.1f %%, by that of others: %+.1f %% (standard error %.1f %%)\n",
                  100 * (twin.mean / truth - 1), 100 * (right.mean / truth - 1),
                  100 * sqrt(stat_variance(&right) / right.n) / truth);
    stat_assert_mean("E39", SEED, &right, truth, alpha());
    stat_assert_not_mean("E39_own_error", SEED, &twin, truth, alpha());
    bis_scratch_clear(&scratch);
    bis_light_free(light);
}

/* ---- furnace ---- */

/* White Phong under a constant light, from head on to 89.9 degrees, by every integrator. The reference is a quadrature
 * of its own (tests/support/lit.h), held against the closed form head on: (n+1)/(n+2). */
static void white_furnace_agrees_with_quadrature_from_0_to_89_9_degrees_for_every_integrator_E23_E33(void **state)
{
    static const double degrees[] = {0, 45, 80, 89.9};
    bis_light *light = lit_new_light(LIT_CONSTANT, 1, 0, false);

    for (int d = 0; d < 4; d++) {
        lit l;
        lit_init(&l, light, bis_phong(grey(0), grey(1), 50), lit_tilted(), degrees[d], LIT_OPEN);
        const double truth = lit_truth(&l, true).r;
        if (d == 0) assert_true(fabs(truth - 51.0 / 52) < 1e-4);
        for (int i = 0; i < N_INTEGRATORS; i++) {
            const bis_settings s = unbiased(i, 1);
            stat_moments m[4];
            l.kind = (bis_sampler_kind)(i % 4);
            const bool blind =
                s.integrator == &bis_em || s.proposal == BIS_PROPOSAL_EM || s.proposal == BIS_PROPOSAL_CHOOSE;
            lit_run(m, &l, &s, blind ? 40000 : 8000, SEED); /* blind: 1 direction in 50 falls into the lobe */
            stat_assert_mean("furnace", SEED, &m[0], truth, alpha());
            /* twin: a white surface that returns all */
            if (d > 0) stat_assert_not_mean("furnace_returns_all", SEED, &m[0], 1, alpha());
        }
    }
    bis_light_free(light);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(error_falls_with_the_square_root_of_the_cost_for_every_integrator_E9),
        cmocka_unit_test(intervals_from_16_replicates_cover_95_percent_of_10000_runs_E32),
        cmocka_unit_test(intervals_from_the_rays_of_one_set_do_not_cover_E32),
        cmocka_unit_test(stopping_by_the_kept_estimates_own_error_is_biased_and_by_that_of_others_is_not_E39),
        cmocka_unit_test(white_furnace_agrees_with_quadrature_from_0_to_89_9_degrees_for_every_integrator_E23_E33),
    };

    return cmocka_run_group_tests_name("errors", tests, NULL, NULL);
}
