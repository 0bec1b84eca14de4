/* SPDX-License-Identifier: BSD-2-Clause */
/* envelope, estimators: their parameters (M = 1 to 1e6, N > M), contrast, radiances, forced random numbers, grazing
 * views and lights, bad materials. The other road: closed forms of a diffuse surface under a map of patches, scaling by
 * powers of two, and the theory of resampling. */
#include "claim.h"
#include "envelope.h"
#include "forced.h"
#include "lit.h"
#include "map_help.h"

#include "bis/base/mem.h"
#include "bis/thesis/phong.h"
#include "bis/render/render.h"
#include "thesis/choose.h"

#include <float.h>
#include <stdio.h>
#include <sys/stat.h>

#define COUNT(a) ((int)(sizeof(a) / sizeof *(a)))

static const uint64_t SEED = 20;
static const double PERCENTILE = 4.9; /* |z| of 1e-6: some hundred are looked at */

/* ---- what is run ---- */

typedef struct method {
    const char *name;
    bis_settings s;
} method;

/* All integrators and proposals but `exact`, which is nobody's extreme. */
enum { N_METHODS = 13 };

static void make_methods(method m[N_METHODS], uint32_t M, uint32_t N)
{
    const struct {
        const char *name;
        const bis_integrator *integrator;
        bis_proposal proposal;
        bool stratify;
        bis_estimator estimator;
    } list[N_METHODS] = {
        {"em", &bis_em, BIS_PROPOSAL_EM, false, 0},
        {"brdf", &bis_brdf, BIS_PROPOSAL_EM, false, 0},
        {"mis balance", &bis_mis, BIS_PROPOSAL_EM, false, 0},
        {"mis power", &bis_mis, BIS_PROPOSAL_EM, true, 0},
        {"rejection em", &bis_rejection, BIS_PROPOSAL_EM, false, BIS_ESTIMATOR_PLAIN},
        {"rejection brdf", &bis_rejection, BIS_PROPOSAL_BRDF, false, BIS_ESTIMATOR_PLAIN},
        {"rejection choose", &bis_rejection, BIS_PROPOSAL_CHOOSE, false, BIS_ESTIMATOR_PLAIN},
        {"sir em", &bis_sir, BIS_PROPOSAL_EM, true, 0},
        {"sir brdf", &bis_sir, BIS_PROPOSAL_BRDF, true, 0},
        {"sir mix", &bis_sir, BIS_PROPOSAL_MIX, true, 0},
        {"sir mix, independent", &bis_sir, BIS_PROPOSAL_MIX, false, 0},
        {"unoccluded", &bis_unoccluded, BIS_PROPOSAL_MIX, true, 0},
        {"rejection choose, ratio", &bis_rejection, BIS_PROPOSAL_CHOOSE, false, BIS_ESTIMATOR_RATIO},
    };
    for (int i = 0; i < N_METHODS; i++) {
        bis_settings s = bis_settings_default(list[i].integrator);
        s.proposal = list[i].proposal;
        s.stratify = list[i].stratify;
        s.estimator = list[i].estimator;
        s.heuristic = i == 3 ? BIS_HEURISTIC_POWER : BIS_HEURISTIC_BALANCE;
        s.candidates = M;
        s.shadowrays = N;
        s.samples = N < 2 ? 2 : N;
        m[i] = (method){list[i].name, s};
    }
}

/* The last one is biased by O(1/M) and takes no part in z-tests. */
enum { N_UNBIASED = N_METHODS - 1 };

/* ---- lights ---- */

static bis_light *light_of(bis_envmap *em, double b, const bis_xform *turn)
{
    const bis_light_desc desc = {
        .L = {1, 1, 1}, .scale = 1, .area_exponent = b, .levels = 8, .to_world = turn ? *turn : bis_xform_identity()};
    bis_light *light;

    assert_int_equal(bis_light_from_envmap(&light, em, &desc, BIS_NEED_TABLE | BIS_NEED_CURVE, NULL), BIS_OK);
    return light;
}

/* Reflected by a diffuse surface facing +z, of the green channel: Kd/pi sum Le pi/W (cos^2 t_j - cos^2 t_{j+1}) over
 * the upper rows, cut at the horizon. */
static double diffuse_truth(const bis_envmap *em, double Kd)
{
    const long double pi = acosl(-1);
    long double sum = 0;

    for (size_t i = 0; i < map_n(em); i++) {
        const size_t y = i / (size_t)em->width;
        const long double c0 = cosl(pi * (long double)y / em->height),
                          c1 = fmaxl(0, cosl(pi * (long double)(y + 1) / em->height));
        if (c0 > 0) sum += (long double)em->pixels[i].g * (c0 - c1) * (c0 + c1);
    }
    return (double)((long double)Kd / em->width * sum);
}

/* z of the mean of `runs` estimates, green, against the truth; rounding alone, 1e-6, is no error. Right-or-wrong:
 * finite, not negative. */
static void try_mean(envelope *z, envelope *finite, lit *l, const method *m, uint32_t runs, double truth,
                     const char *what)
{
    stat_moments moments = {0};
    bis_scratch scratch;

    assert_int_equal(bis_scratch_init(&scratch, &m->s, NULL), BIS_OK);
    for (uint32_t run = 0; run < runs; run++) {
        const rgb L = lit_once(l, &m->s, &scratch, SEED, run);
        envelope_expect(finite, rgb_is_finite(L) && L.r >= 0 && L.g >= 0 && L.b >= 0, "%s, %s: %g", m->name, what,
                        (double)L.g);
        stat_add(&moments, (double)L.g);
    }
    bis_scratch_clear(&scratch);
    const double error = fmax(0, fabs(moments.mean - truth) - 1e-6 * truth),
                 deviation = sqrt(stat_variance(&moments) / runs);
    envelope_try(z, error > 0 ? error / deviation : 0, "%s, %s: mean %g, truth %g, deviation %g", m->name, what,
                 moments.mean, truth, deviation);
}

/* ---- contrast ---- */

static void means_are_right_for_contrasts_of_1_to_1e76(void **state)
{
    static const double decades[] = {0, 3, 6, 12, 76};
    envelope z = envelope_row("diffuse surface under 8 x 4 texels of contrast 1 to 1e12 and 1e76, b = 0.15; every "
                              "integrator and proposal, M = 16, N = 4",
                              "size of z of the mean against the closed form", PERCENTILE);
    envelope finite = envelope_row("the same", "estimates not finite or negative", 0);

    for (int k = 0; k < COUNT(decades); k++) {
        bis_envmap em = map_random(8, 4, decades[k], k % 2 ? 0.3 : 0, (uint64_t)k + 1);
        const double truth = diffuse_truth(&em, 0.5);
        char what[32];
        method m[N_METHODS];
        bis_light *light = light_of(&em, 0.15, NULL);
        lit l;
        lit_init(&l, light, bis_phong(grey(0.5), grey(0), 0), (vec3){0, 0, 1}, 30, LIT_OPEN);
        make_methods(m, 16, 4);
        snprintf(what, sizeof what, "contrast 1e%g", decades[k]);
        for (int i = 0; i < N_UNBIASED; i++) try_mean(&z, &finite, &l, &m[i], 4000, truth, what);
        bis_light_free(light);
    }
    envelope_close(&z);
    envelope_close(&finite);
}

/* ---- M and N ---- */

static void means_are_right_for_any_M_and_N(void **state)
{
    static const uint32_t counts[][3] = {{1, 1, 20000}, {1, 15, 20000}, {2, 1000, 1000},
                                         {8, 9, 4000},  {800, 1, 400},  {1000000, 15, 2}};
    envelope z = envelope_row(
        "half-shadowed glossy surface; M = 1, N = 1; M = 1, N = 15; M = 2, N = 1000; M = 8, N = 9; M = 800, N = 1",
        "size of z of the mean against quadrature", PERCENTILE);
    envelope large = envelope_row("the same point in the open, M = 1e6, N = 15",
                                  "relative error of a single estimate, r+g+b, against quadrature", 5e-3);
    envelope finite = envelope_row("both", "estimates not finite or negative", 0);
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0.15, false);
    lit half, open;

    lit_init(&half, light, bis_phong(grey(0.4), grey(0.6), 10), normalize((vec3){1, 2, 2}), 40, LIT_HALF);
    lit_init(&open, light, bis_phong(grey(0.4), grey(0.6), 10), normalize((vec3){1, 2, 2}), 40, LIT_OPEN);
    const double truth = lit_truth(&half, true).g;
    const rgbd whole = lit_truth(&open, false);
    for (int k = 0; k < COUNT(counts); k++) {
        const uint32_t M = counts[k][0], N = counts[k][1];
        method m[N_METHODS];
        char what[32];
        make_methods(m, M, N);
        snprintf(what, sizeof what, "M %u, N %u", M, N);
        for (int i = 4; i < N_UNBIASED; i++) { /* those with M candidates */
            const bool is_unoccluded = m[i].s.integrator == &bis_unoccluded;
            if (M < 1000000) {
                try_mean(&z, &finite, &half, &m[i], counts[k][2], is_unoccluded ? whole.g : truth, what);
                continue;
            }
            bis_scratch scratch;
            assert_int_equal(bis_scratch_init(&scratch, &m[i].s, NULL), BIS_OK);
            const rgb L = lit_once(&open, &m[i].s, &scratch, SEED, (uint64_t)i);
            envelope_expect(&finite, rgb_is_finite(L) && L.g > 0, "%s, %s", m[i].name, what);
            envelope_try(&large, relative_error(rgb_sum(L), rgbd_sum(whole)), "%s, %s: %g, truth %g", m[i].name, what,
                         rgb_sum(L), rgbd_sum(whole));
            bis_scratch_clear(&scratch);
        }
    }
    bis_light_free(light);
    envelope_close(&z);
    envelope_close(&large);
    envelope_close(&finite);
}

/* ---- forced numbers ---- */

static void forced_numbers_are_survived_at_any_exponent_and_view(void **state)
{
    static const double numbers[] = {0, 0x1p-53, 1 - 0x1p-24, 1 - 0x1p-53}, exponents[] = {0, 2.5, 1e8},
                        views[] = {0, 89.999, 90 - 1e-7};
    const bis_sampler sampler = {.kind = BIS_SAMPLER_RANDOM, .seed = 1, .spp = 1};
    envelope e = envelope_row("0, 2^-53, 1 - 2^-24, 1 - 2^-53 as the k-th random number, k = 0 to 39; n = 0 to 1e8; "
                              "views at 0 to 89.9999999 degrees; every integrator",
                              "estimates not finite or negative", 0);
    bis_light *lights[] = {lit_new_light(LIT_SPOTTY, 1e20, 0.15, false), lit_new_light(LIT_CONSTANT, 1e-30, 0, false)};
    method m[N_METHODS];

    make_methods(m, 8, 15);
    for (int i = 0; i < N_METHODS; i++) {
        bis_scratch scratch;
        assert_int_equal(bis_scratch_init(&scratch, &m[i].s, NULL), BIS_OK);
        for (int k = 0; k < 40 * 4 * 3 * 3 * 2; k++) {
            const double n = exponents[k / 160 % 3], view = views[k / 480 % 3], u = numbers[k % 4];
            lit l;
            bis_stream stream;
            lit_init(&l, lights[k / 1440], bis_phong(grey(0.3), grey(0.6), n), normalize((vec3){1, 1, 0.25f}), view,
                     LIT_HALF);
            bis_stream_init(&stream, &sampler, 7, 0);
            stream.rng = forced(u, (uint64_t)(k / 4 % 40));
            const rgb L = m[i].s.integrator->Lo(&m[i].s, &l.pt, &stream, &scratch);
            envelope_expect(&e, rgb_is_finite(L) && L.r >= 0 && L.g >= 0 && L.b >= 0,
                            "%s, number %d = %.17g, n %g, view %g", m[i].name, k / 4 % 40, u, n, view);
        }
        bis_scratch_clear(&scratch);
    }
    bis_light_free(lights[0]);
    bis_light_free(lights[1]);
    envelope_close(&e);
}

/* How far the systematic choices of each weight are from N w/W, beyond the 1 that equally spaced marks allow, over N. W
 * and the weights are added in long double. */
static void try_even(envelope *e, const bis_choice *c, uint32_t N, const char *what)
{
    long double W = 0;

    for (uint32_t i = 0; i < c->n; i++) W += (long double)c->w[i];
    for (uint32_t i = 0, j = 0; i < c->n; i++) {
        const bool chosen = j < c->n_chosen && c->item[j] == i;
        const double times = chosen ? c->times[j] : 0;
        j += chosen;
        envelope_try(e, (fabs(times - (double)(N * (long double)c->w[i] / W)) - 1) / N, "%s, weight %u", what, i);
    }
}

/* The sum of a block of 16 floats is off by 2^-22: an item's two ends by 2^-21 of W together. */
static void resampling_keeps_its_promise_for_any_weights(void **state)
{
    static const double numbers[] = {0, 0.5, 1 - 0x1p-24, 1 - 0x1p-53};
    static const uint32_t counts[][2] = {{1, 1},     {1, 1000},      {2, 1},        {5, 7},
                                         {1000, 15}, {1000, 100000}, {1000000, 15}, {100000, 100000}};
    envelope legal = envelope_row(
        "resampling N of M = 1 to 1e6, N < M and N > M; weights equal, 1e-30 to 1e30, one positive; forced marks",
        "choices of weight 0, out of range, out of order, or not N", 0);
    envelope even = envelope_row("the same, systematic",
                                 "difference of a weight's choices from N w/W beyond 1, over N", 0x1p-21);

    for (int k = 0; k < COUNT(counts) * COUNT(numbers) * 3 * 2; k++) {
        const uint32_t M = counts[k % COUNT(counts)][0], N = counts[k % COUNT(counts)][1];
        const double u = numbers[k / COUNT(counts) % COUNT(numbers)];
        const int law = k / COUNT(counts) / COUNT(numbers) % 3;
        const bool multinomial = k / COUNT(counts) / COUNT(numbers) / 3;
        bis_stream stream = {.rng = forced(u, 0)};
        bis_claims claims = {0};
        bis_choice c;
        char what[99];
        uint64_t marks = 0;
        snprintf(what, sizeof what, "M %u N %u law %d u %g", M, N, law, u);
        bis_choice_claim(&c, bis_lanes_round_up(M), &claims);
        assert_false(claims.failed);
        for (uint32_t i = 0; i < M; i++) {
            const double x = fmod(i * 0.618033988749895, 1);
            c.w[i] = (float)(law == 0 ? 0.1 : law == 1 ? pow(10, 60 * x - 30) : i == M / 2 ? 1e-30 : 0);
        }
        const double W = bis_choice_sum(&c, bis_lanes_round_up(M));
        if (multinomial) bis_choose_multinomial(&c, N, W, &stream);
        else bis_choose_systematic(&c, N, W, bis_stream_random(&stream));
        for (uint32_t j = 0; j < c.n_chosen; j++) {
            envelope_expect(
                &legal, c.item[j] < M && c.w[c.item[j]] > 0 && (j == 0 || c.item[j] > c.item[j - 1]), "%s", what);
            marks += c.times[j];
        }
        envelope_expect(&legal, marks == N, "%s", what);
        if (!multinomial) try_even(&even, &c, N, what);
        bis_choice_clear(&c);
    }
    envelope_close(&legal);
    envelope_close(&even);
}

/* ---- radiances ---- */

static void estimates_scale_with_the_light(void **state)
{
    static const int powers[] = {-100, -60, 60, 100, 110};
    envelope e =
        envelope_row("spotty map and constant light times 2^-100 to 2^110 (1e-30 to 1e33), n = 2.5; every integrator",
                     "estimates that differ in any bit from the scaled one", 0);
    envelope denormal =
        envelope_row("the same times 1e-38", "relative error of an estimate: denormal floats have fewer digits", 1e-4);
    method m[N_METHODS];

    make_methods(m, 8, 4);
    for (int k = 0; k < 2 * (COUNT(powers) + 1); k++) {
        const lit_map map = k % 2 ? LIT_CONSTANT : LIT_SMOOTH;
        const bool tiny = k / 2 == COUNT(powers);
        const double scale = tiny ? 1e-38 : ldexp(1, powers[k / 2]);
        bis_light *one = lit_new_light(map, 1, 0.15, false), *scaled = lit_new_light(map, scale, 0.15, false);
        lit a, b;
        lit_init(&a, one, bis_phong(grey(0.25), grey(0.5), 2.5), normalize((vec3){1, 2, 2}), 50, LIT_HALF);
        lit_init(&b, scaled, bis_phong(grey(0.25), grey(0.5), 2.5), normalize((vec3){1, 2, 2}), 50, LIT_HALF);
        for (int i = 0; i < N_METHODS; i++) {
            bis_scratch scratch;
            assert_int_equal(bis_scratch_init(&scratch, &m[i].s, NULL), BIS_OK);
            for (uint64_t run = 0; run < 100; run++) {
                const double L = (double)lit_once(&a, &m[i].s, &scratch, SEED, run).g,
                             S = (double)lit_once(&b, &m[i].s, &scratch, SEED, run).g;
                if (tiny) {
                    envelope_try(&denormal, fabs(S / scale - L) / fmax(L, 0.01), "%s, run %u: %g, %g", m[i].name,
                                 (unsigned)run, L, S / scale);
                } else {
                    envelope_expect(&e, S == L * scale, "%s, 2^%d", m[i].name, powers[k / 2]);
                }
            }
            bis_scratch_clear(&scratch);
        }
        bis_light_free(one);
        bis_light_free(scaled);
    }
    envelope_close(&e);
    envelope_close(&denormal);
}

/* A floor seen from above. */
static void count_on_a_floor(envelope *film)
{
    bis_scene_desc *desc;
    bis_scene *scene;
    bis_render_result result;
    bis_film picture;
    float pixels[8 * 8 * 4];
    mkdir("build", 0777);
    FILE *f = fopen("build/envelope_overflow.txt", "w");
    assert_non_null(f);
    fputs("LookAt 0 0 5  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 20\nFilm \"image\" \"integer xresolution\" "
          "8 \"integer yresolution\" 8\n"
          "Sampler \"random\" \"integer pixelsamples\" 4\nIntegrator \"em\" \"integer samples\" 1\nWorldBegin\n"
          "LightSource \"infinite\" \"rgb L\" [3.4e38 3.4e38 3.4e38]\nMaterial \"matte\" \"rgb Kd\" [1 1 1]\n"
          "Shape \"disk\" \"float radius\" 100\nWorldEnd\n",
          f);
    fclose(f);
    bis_diag diag = {0};
    const bis_status parsed = bis_scene_parse(&desc, "build/envelope_overflow.txt", &diag);
    if (parsed) fail_msg("%s", diag.messages[0].text);
    assert_int_equal(bis_scene_build(&scene, desc, &diag), BIS_OK);
    const double crop[4] = {0, 1, 0, 1};
    assert_int_equal(bis_film_init(&picture, 8, 8, crop, (bis_loc){0}, &diag), BIS_OK);
    const bis_render_options options = {.budget = {.spp = 4}, .n_threads = 1};
    assert_int_equal(bis_render(&result, &picture, scene, &desc->view, &options, &diag), BIS_OK);
    bis_film_resolve(&picture, pixels);
    for (int i = 0; i < 8 * 8 * 4; i++) envelope_expect(film, isfinite(pixels[i]) && pixels[i] >= 0, "value %d", i);
    envelope_expect(film, result.counters.nonfinite > 0 && result.counters.nonfinite < 256, "%llu counted",
                    (unsigned long long)result.counters.nonfinite);
    bis_film_clear(&picture);
    bis_scene_free(scene);
    bis_scene_desc_free(desc);
    bis_diag_clear(&diag);
    remove("build/envelope_overflow.txt");
}

/* Beyond FLT_MAX an estimate is +infinity: the film counts it, leaves it out, and stays finite. Never a NaN, never a
 * wrong finite number. */
static void estimates_beyond_the_largest_float_are_infinite_and_counted(void **state)
{
    envelope e = envelope_row("constant light of 3.4e38, single directions: estimates up to 4 times that",
                              "NaN, negative or -infinity instead of +infinity", 0);
    envelope film =
        envelope_row("the same, rendered", "pixels not finite, estimates that are missing in `nonfinite`", 0);
    bis_light *light = lit_new_light(LIT_CONSTANT, (double)FLT_MAX, 0, false);
    method m[N_METHODS];
    int n_infinite = 0;
    lit l;

    make_methods(m, 1, 1);
    lit_init(&l, light, bis_phong(grey(1), grey(0), 0), (vec3){0, 0, 1}, 10, LIT_OPEN);
    for (int i = 0; i < N_METHODS; i++) {
        bis_scratch scratch;
        assert_int_equal(bis_scratch_init(&scratch, &m[i].s, NULL), BIS_OK);
        for (uint64_t run = 0; run < 200; run++) {
            const rgb L = lit_once(&l, &m[i].s, &scratch, SEED, run);
            envelope_expect(&e, L.r >= 0 && L.g >= 0 && L.b >= 0, "%s: %g %g %g", m[i].name, (double)L.r, (double)L.g,
                            (double)L.b);
            n_infinite += isinf(L.r);
        }
        bis_scratch_clear(&scratch);
    }
    envelope_expect(&e, n_infinite > 0, "no overflow was tried");
    envelope_close(&e);
    bis_light_free(light);

    count_on_a_floor(&film);
    envelope_close(&film);
}

/* ---- grazing ---- */

/* One lit texel, of 0.01 degrees, just above the horizon: the row ends at 90 degrees. Facing +z exactly, or all turned
 * by the same rotation. */
static void light_at_grazing_is_reflected_by_its_closed_form(void **state)
{
    enum { H = 18000, W = 4 };
    const bis_xform turn = bis_xform_rotate(77, 1, -2, 0.5);
    envelope z = envelope_row("light at 89.99 to 90 degrees on a diffuse surface, views at 0 to 89.999 degrees; every "
                              "integrator with candidates from the map",
                              "size of z of the mean against the closed form", PERCENTILE);
    envelope turned =
        envelope_row("the same, all turned off the axes (floats hold a normal to 6e-8: 3e-4 of this cosine)",
                     "relative error of the mean", 1e-2);
    envelope finite = envelope_row("both", "estimates not finite or negative", 0);

    for (int k = 0; k < 4; k++) {
        bis_envmap em = map_new(W, H);
        method m[N_METHODS];
        const bool is_turned = k / 2;
        const double view = k % 2 ? 89.999 : 0;
        em.pixels[(H / 2 - 1) * W + 1] = (rgb){0, 1e10f, 0};
        const double truth = diffuse_truth(&em, 0.5);
        bis_light *light = light_of(&em, 0, is_turned ? &turn : NULL);
        lit l;
        lit_init(&l, light, bis_phong(grey(0.5), grey(0), 0),
                 is_turned ? normalize(bis_xform_vector(&turn, (vec3){0, 0, 1})) : (vec3){0, 0, 1}, view, LIT_OPEN);
        make_methods(m, 16, 4);
        for (int i = 0; i < N_UNBIASED; i++) {
            if (i == 1 || i == 5 || i == 6 || i == 8)
                continue; /* those that propose from the BRDF alone never look there */
            if (!is_turned) {
                try_mean(&z, &finite, &l, &m[i], 3000, truth, "axis");
            } else {
                stat_moments moments[4];
                lit_run(moments, &l, &m[i].s, 3000, SEED);
                envelope_expect(&finite, isfinite(moments[1].mean), "%s", m[i].name);
                if (m[i].s.integrator != &bis_rejection)
                    envelope_try(&turned, relative_error(moments[1].mean, truth), "%s, view %g: %g, truth %g",
                                 m[i].name, view, moments[1].mean, truth);
            }
        }
        bis_light_free(light);
    }
    envelope_close(&z);
    envelope_close(&turned);
    envelope_close(&finite);
}

/* wo so near the horizon that its cosine, or the mirrored one, rounds to nothing. */
static void views_at_the_very_horizon_are_survived(void **state)
{
    static const float cosines[] = {1e-3f, 1.7e-5f, 1e-7f, 1e-12f, 1e-30f, 1e-38f, 1e-45f, 0, -1e-45f, -1e-3f};
    envelope e = envelope_row("views of cosine 1e-3 to 1e-45, 0, below; diffuse, glossy and mirror-like (n = 1e8); "
                              "normals on and off the axes; every integrator",
                              "estimates not finite or negative", 0);
    bis_light *lights[] = {lit_new_light(LIT_SPOTTY, 1, 0.15, false), lit_new_light(LIT_CONSTANT, 1, 0, false)};
    method m[N_METHODS];

    make_methods(m, 8, 4);
    for (int k = 0; k < COUNT(cosines) * 3 * 4 * 2; k++) {
        const double kd = (const double[]){1, 0.5, 0}[k / COUNT(cosines) % 3], n = kd > 0 ? 10 : 1e8;
        const vec3 normals[] = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, normalize((vec3){1, -2, 0.5f})},
                   normal = normals[k / COUNT(cosines) / 3 % 4];
        const frame about = frame_about(normal);
        lit l;
        lit_init(&l, lights[k / COUNT(cosines) / 12], bis_phong(grey(kd), grey(1 - kd), n), normal, 0, LIT_HALF);
        l.pt.wo = to_world(&about, vec3_from(0.6, 0.8, (double)cosines[k % COUNT(cosines)]));
        bis_bsdf_init(&l.pt.bsdf, &l.material, normal, l.pt.wo);
        for (int i = 0; i < N_METHODS; i++) {
            bis_scratch scratch;
            assert_int_equal(bis_scratch_init(&scratch, &m[i].s, NULL), BIS_OK);
            for (uint64_t run = 0; run < 20; run++) {
                const rgb L = lit_once(&l, &m[i].s, &scratch, SEED, run);
                envelope_expect(&e, rgb_is_finite(L) && L.r >= 0 && L.g >= 0 && L.b >= 0, "%s, cosine %g, n %g",
                                m[i].name, (double)cosines[k % COUNT(cosines)], n);
            }
            bis_scratch_clear(&scratch);
        }
    }
    bis_light_free(lights[0]);
    bis_light_free(lights[1]);
    envelope_close(&e);
}

/* ---- nothing there ---- */

static void black_is_exactly_black(void **state)
{
    static const double reflectances[] = {0, 1e-45, 1e-38, 1e-20, 1};
    envelope black =
        envelope_row("black map, black surface, hidden point; every integrator", "estimates other than exactly 0", 0);
    envelope finite = envelope_row(
        "reflectances 1e-45 to 1 under a spotty map and a constant light, n = 0, 10, 1e8; every integrator",
        "estimates not finite or negative", 0);
    bis_light *lights[] = {lit_new_light(LIT_BLACK, 1, 0.15, false), lit_new_light(LIT_SPOTTY, 1, 0.15, false),
                           lit_new_light(LIT_CONSTANT, 1, 0, false), lit_new_light(LIT_CONSTANT, 0, 0, false)};
    method m[N_METHODS];

    make_methods(m, 8, 4);
    for (int k = 0; k < 4 * 5 * 5 * 3; k++) {
        const double kd = reflectances[k / 4 % 5], ks = reflectances[k / 20 % 5];
        const bool dark = k % 4 == 0 || k % 4 == 3 || (kd == 0 && ks == 0) || k % 7 == 0;
        if (kd == 1 && ks == 1) continue;
        lit l;
        lit_init(&l, lights[k % 4], bis_phong(grey(kd), grey(ks), (const double[]){0, 10, 1e8}[k / 100]),
                 (vec3){0, 0, 1}, 30, k % 7 == 0 ? LIT_ALL : LIT_HALF);
        for (int i = 0; i < N_METHODS; i++) {
            bis_scratch scratch;
            assert_int_equal(bis_scratch_init(&scratch, &m[i].s, NULL), BIS_OK);
            for (uint64_t run = 0; run < 20; run++) {
                const rgb L = lit_once(&l, &m[i].s, &scratch, SEED, run);
                envelope_expect(&finite, rgb_is_finite(L) && L.r >= 0 && L.g >= 0 && L.b >= 0, "%s, Kd %g, Ks %g",
                                m[i].name, kd, ks);
                if (dark && m[i].s.integrator != &bis_unoccluded)
                    envelope_expect(&black, rgb_is_black(L), "%s, Kd %g, Ks %g", m[i].name, kd, ks);
            }
            bis_scratch_clear(&scratch);
        }
    }
    for (int i = 0; i < 4; i++) bis_light_free(lights[i]);
    envelope_close(&black);
    envelope_close(&finite);
}

static void page_has_the_same_rows(void **state)
{
    envelope_finish(4, "Estimators");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(means_are_right_for_contrasts_of_1_to_1e76),
        cmocka_unit_test(means_are_right_for_any_M_and_N),
        cmocka_unit_test(forced_numbers_are_survived_at_any_exponent_and_view),
        cmocka_unit_test(resampling_keeps_its_promise_for_any_weights),
        cmocka_unit_test(estimates_scale_with_the_light),
        cmocka_unit_test(estimates_beyond_the_largest_float_are_infinite_and_counted),
        cmocka_unit_test(light_at_grazing_is_reflected_by_its_closed_form),
        cmocka_unit_test(views_at_the_very_horizon_are_survived),
        cmocka_unit_test(black_is_exactly_black),
        cmocka_unit_test(page_has_the_same_rows),
    };
    envelope_one_thread();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
