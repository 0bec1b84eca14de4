/* SPDX-License-Identifier: BSD-2-Clause */
/* `bis verify` of a point in view: right integrators pass. Those that are wrong are in test_verify_wrong,
 * test_verify_exact and test_verify_printed. */
#include "base/text.h"
#include "tools/pixel/pixel.h"
#include "tools/truth.h"
#include "tools/verify/verify.h"
#include "bis/base/mem.h"
#include "bis/thesis/phong.h"
#include "bis/thesis/warp.h"
#include "thesis/proposal.h"
#include "claim.h"
#include "lit.h"
#include "map_help.h"
#include "program.h"
#include "verify_help.h"

#include <stdatomic.h>
#include <string.h>

static const bis_settings *all_settings(void)
{
    static bis_settings s[BIS_VERIFY_MAX_INTEGRATORS];
    for (int i = 0; bis_integrators[i]; i++) {
        s[i] = bis_settings_default(bis_integrators[i]);
        s[i].estimator = BIS_ESTIMATOR_PLAIN;
        s[i].candidates = 200;
    }
    return s;
}

static void right_integrators_pass(void **state)
{
    const lit_map maps[] = {LIT_SPOTTY, LIT_SMOOTH, LIT_CONSTANT};
    const lit_hidden hidden[] = {LIT_HALF, LIT_OPEN, LIT_HALF};
    for (int i = 0; i < 3; i++) {
        bis_light *light = lit_new_light(maps[i], 1, 0.15, false);
        lit l;
        bool tested;
        lit_init(&l, light, verify_glossy(&bis_phong_model, 50), normalize(vec3_from(0.2, -0.3, 0.8)), 40, hidden[i]);
        for (uint64_t seed = 0; seed < (i == 0 ? VERIFY_SEEDS : 1); seed++) {
            bis_verify v = {.seed = seed, .halvings = 1};
            bis_settings list[8];
            memcpy(list, all_settings(), 7 * sizeof *list);
            list[7] = bis_settings_unnamed();
            assert_int_equal(
                bis_verify_point(&v, &(bis_verify_place){"right", &l.pt, BIS_SAMPLER_SOBOL}, list, 8, &tested, NULL),
                BIS_OK);
            assert_true(tested);
            assert_int_equal(v.n, 8);
            verify_assert_accepted(&v);
        }
        bis_light_free(light);
    }
}

static void a_point_in_the_dark_is_not_tested(void **state)
{
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0, false);
    lit l;
    bool tested;
    bis_verify v = {.seed = 1};
    lit_init(&l, light, verify_glossy(&bis_phong_model, 5), (vec3){0, 0, 1}, 40, LIT_ALL);
    assert_int_equal(
        bis_verify_point(&v, &(bis_verify_place){"dark", &l.pt, BIS_SAMPLER_RANDOM}, all_settings(), 7, &tested, NULL),
        BIS_OK);
    assert_false(tested);
    assert_int_equal(v.n, 0);
    bis_light_free(light);
}

/* Two halvings leave half of the reference's 2^15 rays: by 2^11 it is known to 2 %, by 2^9 to more than the 5 % with
 * which it judges. */
static void what_is_known_too_badly_is_not_judged(void **state)
{
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0.15, false);
    lit l;
    lit_init(&l, light, bis_phong(grey(0), grey(1), 100), (vec3){0, 0, 1}, 40, LIT_HALF);
    for (unsigned halvings = 8; halvings <= 12; halvings += 4) {
        bis_verify v = {.seed = 1, .halvings = halvings};
        bool tested;
        assert_int_equal(
            bis_verify_point(&v, &(bis_verify_place){"few", &l.pt, BIS_SAMPLER_RANDOM}, all_settings(), 7, &tested,
                NULL), BIS_OK);
        assert_true(tested);
        assert_int_equal(v.n, halvings == 8 ? 7 : 1);
        assert_int_equal(v.tests[0].verdict == BIS_VERDICT_SKIPPED, halvings == 12);
        if (halvings == 12)
            assert_string_equal(v.tests[0].note, "the sum over patches is known too badly: the lobe is too narrow");
        bis_verify_clear(&v);
    }
    bis_light_free(light);
}

/* One small lamp, seen at 84 degrees: a few of brdf's samples outweigh all others, so that p is bounded by Bernstein's
 * inequality. The right one passes; the one that draws again below the horizon, hence too often above it, does not. */
static void what_is_rare_and_bright_is_judged_too(void **state)
{
    bis_light *light = lit_new_light(LIT_ONE_BLOCK, 1, 0.15, false);
    lit l;
    bool tested;
    const bis_material m = bis_phong((rgb){0.05f, 0.05f, 0.05f}, (rgb){0.9f, 0.9f, 0.9f}, 10);
    lit_init(&l, light, m, normalize(vec3_from(0.2, -0.3, 0.8)), 84, LIT_OPEN);
    for (int wrong = 0; wrong < 2; wrong++)
        for (uint64_t seed = 3; seed < 6; seed++) {
            bis_settings s = bis_settings_default(&bis_brdf);
            bis_verify v = {.seed = seed, .halvings = 1};
            if (wrong) s.as_printed = BIS_E34;
            assert_int_equal(
                bis_verify_point(&v, &(bis_verify_place){"lamp", &l.pt, BIS_SAMPLER_STRATIFIED}, &s, 1, &tested, NULL),
                BIS_OK);
            assert_true(tested && v.n == 1 && strstr(v.tests[0].note, "Bernstein"));
            assert_int_equal(wrong, v.tests[0].p < 1e-5);
            bis_verify_clear(&v);
        }
    bis_light_free(light);
}

/* An integrator that verify does not know: directions uniform over the sphere, times a factor, blind to bright light.
 */
static double factor;
static float brightest = INFINITY;

static rgb Lo_of_a_stranger(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch)
{
    rgbd sum = {0, 0, 0};
    bis_stream_points(stream, BIS_DIM_BRDF, s->samples, scratch->u);
    for (uint32_t j = 0; j < s->samples; j++) {
        const vec3 wi = bis_warp_sphere(scratch->u[j][0], scratch->u[j][1]);
        const rgb L = bis_light_Le(pt->light, wi);
        const double c = bis_bsdf_cos(&pt->bsdf, wi), q = s->samples / (4 * 3.14159265358979 * factor);
        if (c > 0 && L.r > 0 && L.r < brightest)
            bis_point_add(&sum, pt, wi, bis_estimate(bis_bsdf_f(&pt->bsdf, wi), L, c, q), NULL);
    }
    return rgbd_round(sum);
}

/* A stranger may have missed a lamp by bad luck, if uniform directions would have, too; else it is judged as ours are.
 * The lamp is met by one uniform direction of 150: perhaps by none of 64 runs, but by many of 16384. */
static void a_stranger_is_held_to_what_uniform_directions_do(void **state)
{
    const struct { lit_map map; double factor; float brightest; unsigned halvings; bool passes; } rows[] = {
        {LIT_SMOOTH, 1, INFINITY, 2, true},   {LIT_SMOOTH, 0.9, INFINITY, 2, false},
        {LIT_SMOOTH, 1.1, INFINITY, 2, false},
        {LIT_ONE_BLOCK, 1, 2, 8, true},       {LIT_ONE_BLOCK, 1, 2, 0, false},
    };
    bis_integrator stranger = bis_brdf; /* its needs, and its name, which is its parameters' */
    stranger.Lo = Lo_of_a_stranger;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        bis_light *light = lit_new_light(rows[i].map, 1, 0.15, false);
        bis_settings s = bis_settings_default(&bis_brdf);
        bis_verify v = {.seed = 1, .halvings = rows[i].halvings};
        lit l;
        bool tested;
        lit_init(&l, light, verify_glossy(&bis_phong_model, 3), (vec3){0, 0, 1}, 40, LIT_OPEN);
        s.integrator = &stranger;
        s.samples = 16;
        factor = rows[i].factor;
        brightest = rows[i].brightest;
        assert_int_equal(
            bis_verify_point(&v, &(bis_verify_place){"p", &l.pt, BIS_SAMPLER_RANDOM}, &s, 1, &tested, NULL), BIS_OK);
        assert_true(tested && v.n == 1);
        if (rows[i].passes != (v.tests[0].p > 1e-4)) fail_msg("row %zu: p %g; %s", i, v.tests[0].p, v.tests[0].note);
        bis_verify_clear(&v);
        bis_light_free(light);
    }
}

static rgb Lo_not_a_number_at_times(const bis_settings *s, const bis_point *pt, bis_stream *stream,
                                    bis_scratch *scratch)
{
    const rgb L = bis_mis.Lo(s, pt, stream, scratch);
    return stream->pixel == 5 ? (rgb){L.r, NAN, L.b} : L;
}

/* One run of many that is no number: the integrator fails at once, whatever the threshold. */
static void what_is_not_a_number_fails(void **state)
{
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0.15, false);
    bis_integrator forged = bis_mis;
    bis_settings s = bis_settings_default(&bis_mis);
    bis_verify v = {.seed = 1, .halvings = 4};
    lit l;
    bool tested;
    lit_init(&l, light, verify_glossy(&bis_phong_model, 5), (vec3){0, 0, 1}, 40, LIT_HALF);
    forged.Lo = Lo_not_a_number_at_times;
    s.integrator = &forged;
    assert_int_equal(bis_verify_point(&v, &(bis_verify_place){"p", &l.pt, BIS_SAMPLER_RANDOM}, &s, 1, &tested, NULL),
        BIS_OK);
    assert_true(tested && v.n == 1);
    assert_int_equal(bis_verify_judge(&v, NULL), BIS_OK);
    assert_string_equal(v.tests[0].group, "view");
    assert_string_equal(v.tests[0].name, "p: mis");
    assert_string_equal(v.tests[0].note, "not a number");
    assert_true(v.tests[0].verdict == BIS_VERDICT_FAILED && v.tests[0].p == 0 && isnan(v.tests[0].statistic));
    assert_int_equal(v.n_failed, 1);
    bis_verify_clear(&v);
    bis_light_free(light);
}

/* By which an integrator is judged follows from the density of its samples: a mean of em's is rare and bright where a
 * narrow lobe is met by one direction in hundreds, one of brdf's where one lamp in a wide lobe is; what mixes both is
 * neither. Resampling has no bound and is left out there. A constant light is drawn from by em, and by sir where it is
 * told to. */
static void the_density_of_its_samples_decides_how_an_integrator_is_judged(void **state)
{
    enum { T, BERNSTEIN, SKIPPED };
    static const struct {
        lit_map map;
        double exponent, degrees;
        int em, brdf, mis, sir_em, sir_brdf, sir_mix;
    } cases[] = {
        {LIT_SMOOTH, 300, 40, BERNSTEIN, T, T, SKIPPED, T, T},
        {LIT_ONE_BLOCK, 10, 84, T, BERNSTEIN, T, T, SKIPPED, T},
        {LIT_CONSTANT, 300, 40, BERNSTEIN, T, T, SKIPPED, T, T},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bis_light *light = lit_new_light(cases[i].map, 1, 0.15, false);
        const bis_material m = bis_phong((rgb){0.05f, 0.05f, 0.05f}, (rgb){0.9f, 0.9f, 0.9f}, cases[i].exponent);
        const int expected[] = {cases[i].em, cases[i].brdf, cases[i].mis, cases[i].sir_em, cases[i].sir_brdf,
                                cases[i].sir_mix};
        const bis_integrator *const of[] = {&bis_em, &bis_brdf, &bis_mis, &bis_sir, &bis_sir, &bis_sir};
        static const bis_proposal proposals[] = {BIS_PROPOSAL_EM, BIS_PROPOSAL_BRDF, BIS_PROPOSAL_MIX};
        lit l;
        lit_init(&l, light, m, normalize(vec3_from(0.2, -0.3, 0.8)), cases[i].degrees, LIT_OPEN);
        for (int k = 0; k < 6; k++) {
            bis_verify v = {.seed = 3, .halvings = 3};
            bis_settings s = bis_settings_default(of[k]);
            bool tested;
            if (k >= 3) s.proposal = proposals[k - 3];
            s.candidates = 16; /* runs of all have about as many samples */
            assert_int_equal(
                bis_verify_point(&v, &(bis_verify_place){"p", &l.pt, BIS_SAMPLER_STRATIFIED}, &s, 1, &tested, NULL),
                BIS_OK);
            assert_true(tested && v.n == 1);
            assert_int_equal(bis_verify_judge(&v, NULL), BIS_OK);
            const bis_verify_test *t = v.tests;
            const bool bound = strstr(t->note, "Bernstein") != NULL;
            const int found = t->verdict == BIS_VERDICT_SKIPPED ? SKIPPED : bound ? BERNSTEIN : T;
            if (found != expected[k]) fail_msg("case %zu, integrator %d: %s", i, k, t->note);
            bis_verify_clear(&v);
        }
        bis_light_free(light);
    }
}

/* ---- z, p and the number of runs, by hand ---- */

/* What the reference says of a point by these halvings: q is the density of the one integrator that is tested. */
static bis_truth reference_of(const lit *l, const bis_verify *v, const bis_truth_density *q)
{
    bis_truth t;
    const bis_truth_question asked = {&l->pt, {4, 2, 1}, (1 << 15) >> v->halvings / 2,
                                      bis_verify_seed(v, "p: reference"), q, q ? 1 : 0};
    assert_int_equal(bis_truth_of(&t, &asked, NULL), BIS_OK);
    return t;
}

/* The difference that neither floats, 2e-6, nor the reference's error explains. */
static double excess_by_hand(const bis_truth *t, double mean)
{
    const double difference = mean - t->lit.mean[3];
    const double rest = fabs(difference) - 2e-6 * t->lit.mean[3] - bis_truth_bound(&t->lit, 1e-7);
    return rest > 0 ? copysign(rest, difference) : 0;
}

/* Bernstein: 2 exp(-n e^2 / (2 E[X^2] + 2 B e/3)), with a tenth more for E[X^2], and twice the largest sample for B. */
static double bernstein_by_hand(const bis_truth *t, double n, double e, double samples_in_one)
{
    const double square = 1.1 * (t->sample[0].variance + pow(t->lit.mean[3], 2));
    const double B = 2 * t->sample[0].most * samples_in_one;
    return 2 * exp(-n * e * e / (2 * square + 2 * B * fabs(e) / 3));
}

/* A stranger whose run r is known, `base` (1 + `amplitude`) for one of `every` and `base` (1 - `amplitude`) for the
 * others. Every run casts three shadow rays. */
static struct {
    double base, amplitude;
    uint64_t every;
    atomic_uint calls;
} told;

static rgb Lo_as_told(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch)
{
    const double L = told.base * (1 + (stream->pixel % told.every == 0 ? told.amplitude : -told.amplitude));
    told.calls++;
    pt->counters->shadow_rays += 3;
    return rgb_from(L, L, L);
}

/* What is said of the stranger. */
static bis_verify_test judged_as_told(const lit *l, bis_sampler_kind kind, unsigned halvings)
{
    bis_integrator stranger = bis_brdf;
    bis_settings s = bis_settings_default(&bis_brdf);
    bis_verify v = {.seed = 1, .halvings = halvings};
    bool tested;
    stranger.Lo = Lo_as_told;
    s.integrator = &stranger;
    s.samples = 16; /* 8 units each: 2^21 >> 8 pay for 64 runs */
    told.calls = 0;
    assert_int_equal(bis_verify_point(&v, &(bis_verify_place){"p", &l->pt, kind}, &s, 1, &tested, NULL), BIS_OK);
    assert_true(tested && v.n == 1);
    const bis_verify_test t = v.tests[0];
    bis_verify_clear(&v);
    return t;
}

/* 64 runs, half of them above their mean by d and half below: a standard error of d/sqrt(63), no skewness. Where they
 * are too dark, p is at least that of uniform directions, three in a run, which are independent only where the sampler
 * says so. Runs that are all alike are infinitely many standard errors away, or none. */
static void z_and_p_of_a_stranger_are_those_by_hand(void **state)
{
    enum { RUNS = 64 };
    static const bis_truth_density uniform = {0, 0, 1};
    static const struct { double off, amplitude; bis_sampler_kind kind; bool is_dark; } cases[] = {
        {1.1, 0.125, BIS_SAMPLER_RANDOM, false}, {1.07, 0.25, BIS_SAMPLER_SOBOL, false},
        {0.9, 0.125, BIS_SAMPLER_RANDOM, true}, {0.9, 0.125, BIS_SAMPLER_SOBOL, true},
        {0.25, 1, BIS_SAMPLER_RANDOM, true}, {1, 0.125, BIS_SAMPLER_RANDOM, false},
        {1.1, 0, BIS_SAMPLER_RANDOM, false}};
    const bis_verify v = {.seed = 1, .halvings = 8};
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0.15, false);
    lit l;
    lit_init(&l, light, verify_glossy(&bis_phong_model, 3), (vec3){0, 0, 1}, 40, LIT_OPEN);
    const bis_truth t = reference_of(&l, &v, &uniform);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        told.base = t.lit.mean[3] / 7 * cases[i].off;
        told.amplitude = cases[i].amplitude;
        told.every = 2;
        const bis_verify_test found = judged_as_told(&l, cases[i].kind, v.halvings);
        const double e = excess_by_hand(&t, 7 * told.base), se = 7 * told.base * told.amplitude / sqrt(RUNS - 1);
        const double z = e == 0 ? 0 : se > 0 ? e / se : copysign((double)INFINITY, e);
        const double by_t = e == 0 ? 1 : bis_verify_t(z, RUNS - 1, 0);
        const double by_uniform =
            fmin(1, bernstein_by_hand(&t, 3 * RUNS, e, cases[i].kind == BIS_SAMPLER_SOBOL ? 3 : 1));
        const bool may_miss = cases[i].is_dark && by_uniform > by_t;
        char note[120], bound[BIS_PERCENT];
        assert_int_equal(told.calls, RUNS);
        assert_int_equal(cases[i].is_dark, z < 0);
        if (isinf(z)) assert_true(found.statistic == z);
        else assert_near(found.statistic, z, 1e-5 * fabs(z));
        assert_near(found.p / fmin(1, 1e-7 + (may_miss ? by_uniform : by_t)), 1, 1e-4);
        snprintf(note, sizeof note, "z; %ssum over patches +- %s",
                 may_miss ? "p is that of uniform directions, which may miss what is bright; " : "",
                 bis_percent(bound, bis_truth_bound(&t.lit, 1e-7) / t.lit.mean[3]));
        assert_string_equal(found.note, note);
    }
    bis_light_free(light);
}

/* Of 64 runs a share f is brighter: the skewness of their mean is (1 - 2f)/sqrt(64 f (1 - f)), 0.1443 for a quarter and
 * 0.2835 for every 8th. The former widens p, the latter leaves no verdict. */
static void runs_that_are_too_skew_are_not_judged(void **state)
{
    const bis_verify v = {.seed = 1, .halvings = 8};
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0.15, false);
    lit l;
    lit_init(&l, light, verify_glossy(&bis_phong_model, 3), (vec3){0, 0, 1}, 40, LIT_OPEN);
    const bis_truth t = reference_of(&l, &v, &(bis_truth_density){0, 0, 1});
    told.base = t.lit.mean[3] / 7 * 1.25;
    told.amplitude = 0.25;
    told.every = 4;
    bis_verify_test found = judged_as_told(&l, BIS_SAMPLER_RANDOM, v.halvings);
    /* mean 1 - 1/8 of the base, deviation sqrt(3)/8 */
    const double z = excess_by_hand(&t, 7 * told.base * 0.875) / (7 * told.base * sqrt(3) / 8 / sqrt(63));
    assert_near(found.statistic, z, 1e-5 * z);
    assert_near(found.p / (bis_verify_t(z, 63, 0.5 / sqrt(12)) + 1e-7), 1, 1e-4);
    assert_true(found.p > 1.01 * (bis_verify_t(z, 63, 0) + 1e-7));
    told.every = 8;
    found = judged_as_told(&l, BIS_SAMPLER_RANDOM, v.halvings);
    assert_int_equal(found.verdict, BIS_VERDICT_SKIPPED);
    assert_string_equal(found.note, "a few runs outweigh all others here: too few to judge");
    bis_light_free(light);
}

/* Our own integrators: z and p from their runs, as bis_verify_runs makes them, and from what the reference says of one
 * sample of their density: third/variance^1.5 over the root of all samples is the skewness of the mean. Up to 0.05 of
 * it t judges, beyond Bernstein. Runs of `exact` have the deviation that the reference has found, but for 1e-7, of a
 * ray in each patch, where no ray is more than twice what one can add to a pair's mean. */
static void z_and_p_of_ours_are_those_by_hand(void **state)
{
    const struct {
        const bis_integrator *of;
        lit_map map;
        double exponent, degrees;
        bis_truth_density q;
        bool by_bernstein;
    } cases[] = {{&bis_em, LIT_SMOOTH, 20, 40, {1, 0, 0}, false}, {&bis_brdf, LIT_SMOOTH, 20, 40, {0, 1, 0}, false},
                 {&bis_mis, LIT_SMOOTH, 20, 40, {0.25, 0.75, 0}, false},
                 {&bis_em, LIT_SMOOTH, 300, 40, {1, 0, 0}, true},
                 {&bis_brdf, LIT_ONE_BLOCK, 10, 84, {0, 1, 0}, true},
                 {&bis_exact, LIT_SMOOTH, 20, 40, {0, 0, 0}, false}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const bool is_exact = cases[i].of == &bis_exact;
        const uint32_t samples = is_exact ? 1 : 16, n = is_exact ? 4 : 2048; /* 2^18 rays, 2^18 samples */
        bis_light *light = lit_new_light(cases[i].map, 1, 0.15, false);
        const bis_material m = bis_phong((rgb){0.05f, 0.05f, 0.05f}, (rgb){0.9f, 0.9f, 0.9f}, cases[i].exponent);
        bis_settings s = bis_settings_default(cases[i].of);
        bis_verify v = {.seed = 5, .halvings = 3};
        bis_verify_moments runs = {0};
        bis_counters counters = {0};
        rgb *estimate = bis_alloc(n, sizeof *estimate);
        bool tested;
        lit l;
        s.samples = 16;
        s.split = 0.25;
        s.as_printed = cases[i].by_bernstein ? BIS_E34 : 0; /* wrong, so that p is not 1 */
        lit_init(&l, light, m, lit_tilted(), cases[i].degrees, LIT_OPEN);
        const bis_truth t = reference_of(&l, &v, is_exact ? NULL : &cases[i].q);
        const uint64_t seed = bis_verify_seed(&v, "p: %s", s.integrator->name);
        const bis_verify_job job = {&l.pt, &s, BIS_SAMPLER_STRATIFIED, n, seed, NULL};
        assert_int_equal(bis_verify_runs(estimate, &job, &counters, NULL), BIS_OK);
        for (uint32_t r = 0; r < n; r++)
            bis_verify_add(&runs, 4 * (double)estimate[r].r + 2 * (double)estimate[r].g + (double)estimate[r].b);
        bis_free(estimate);
        const bis_truth_moments *one = is_exact ? &t.one_ray : &t.sample[0];
        const double skewness = one->third / pow(one->variance, 1.5) / sqrt((double)samples * n);
        const bis_truth_sum patches = {.variance = {0, 0, 0, t.one_ray.variance}, .most = 2 * t.lit.most};
        const double e = excess_by_hand(&t, runs.mean),
                     se = is_exact                ? bis_truth_deviation(&patches, 1e-7) / sqrt(n)
                          : cases[i].by_bernstein ? sqrt(1.1 * (one->variance + pow(t.lit.mean[3], 2)) / (16.0 * n))
                                                  : sqrt(runs.m2 / (n - 1) / n);
        const double most = fmax(fabs(skewness), is_exact ? 0 : fabs(bis_verify_skewness(&runs)));
        const double p = cases[i].by_bernstein ? bernstein_by_hand(&t, 16.0 * n, e, 1)
                         : e == 0              ? 1 : bis_verify_t(e / se, is_exact ? (double)INFINITY : n - 1, most);
        assert_int_equal(most > 0.05, cases[i].by_bernstein);
        assert_int_equal(bis_verify_point(&v, &(bis_verify_place){"p", &l.pt, BIS_SAMPLER_STRATIFIED}, &s, 1, &tested,
                                          NULL), BIS_OK);
        const double off = fabs(v.tests[0].statistic - e / se), share = v.tests[0].p / fmin(1, p + 1e-7);
        if (!(off <= 1e-9 * fabs(e / se) && fabs(share - 1) < 1e-6))
            fail_msg("case %zu: z %g, p %g, must be %g, %g", i, v.tests[0].statistic, v.tests[0].p, e / se, p);
        bis_verify_clear(&v);
        bis_light_free(light);
    }
}

/* Where four rays a patch accused five of seven integrators (seed 17 of 40, z = 9): a wall's edge across bright
 * patches. The point of pixel (12, 8) of the scene of verify_help, 40 seeds. */
static void seeds_that_were_accused_pass(void **state)
{
    enum { N = 40, X = 12, Y = 8 };
    bis_counters counters = {0};
    bis_pixel_hit hit;
    bis_point pt;
    bis_settings s[] = {
        bis_settings_default(&bis_em), bis_settings_default(&bis_mis), bis_settings_default(&bis_exact)};
    verify_write_map();
    verify_write_scene("scene.txt", "Film \"rgb\" \"integer xresolution\" 24 \"integer yresolution\" 16\n");
    verify_built b = verify_build(VERIFY_DIR "/scene.txt");
    assert_true(bis_pixel_find(&hit, &pt, b.scene, X, Y, &counters));
    for (uint64_t seed = 1; seed <= N; seed++) {
        bis_verify v = {.seed = seed, .halvings = 4};
        bool tested;
        assert_int_equal(
            bis_verify_point(&v, &(bis_verify_place){"pixel (12, 8)", &pt, BIS_SAMPLER_SOBOL}, s, 3, &tested, NULL),
            BIS_OK);
        assert_true(tested && v.n == 3);
        verify_assert_accepted(&v);
    }
    verify_clear(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(z_and_p_of_a_stranger_are_those_by_hand),
        cmocka_unit_test(runs_that_are_too_skew_are_not_judged),
        cmocka_unit_test(z_and_p_of_ours_are_those_by_hand),
        cmocka_unit_test(right_integrators_pass),
        cmocka_unit_test(a_point_in_the_dark_is_not_tested),
        cmocka_unit_test(what_is_known_too_badly_is_not_judged),
        cmocka_unit_test(what_is_rare_and_bright_is_judged_too),
        cmocka_unit_test(a_stranger_is_held_to_what_uniform_directions_do),
        cmocka_unit_test(what_is_not_a_number_fails),
        cmocka_unit_test(the_density_of_its_samples_decides_how_an_integrator_is_judged),
        cmocka_unit_test(seeds_that_were_accused_pass),
    };
    return cmocka_run_group_tests_name("verify_view", tests, NULL, NULL);
}
