/* SPDX-License-Identifier: BSD-2-Clause */
/* auto: the fit of cost and variance, the best M and N, what the pilot chooses and what it leaves alone, and that
 * its choice can be made again bit for bit. */
#include "tools/auto/auto.h"
#include "tools/auto/auto_fit.h"

#include "bis/base/mem.h"
#include "bis/thesis/phong.h"
#include "bis/files/image_file.h"

#include "auto_help.h"
#include "json_check.h"
#include "program.h"
#include "world.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <openexr.h>
#include <stdio.h>
#include <string.h>

#define DIR "build/test_auto"

/* --- the fit
 * ------------------------------------------------------------------------------------------------------- */

/* Where auto.c measures sir, and what a method with these six numbers would show; rays: the exponent of N. */
enum { N_PLACES = 3 };
static const uint32_t places[N_PLACES][2] = {{64, 4}, {64, 20}, {256, 8}};

static void make_measurements(bis_auto_measured m[N_PLACES], const bis_auto_model *c, const bis_auto_model *v, double rays)
{
    for (int i = 0; i < N_PLACES; i++) {
        const uint32_t M = places[i][0], N = places[i][1];
        m[i] = (bis_auto_measured){M, N, c->constant + c->by_M * M + c->by_N * N, v->constant + v->by_M / M + v->by_N / pow(N, rays)};
    }
}

static const bis_auto_model true_cost = {1.5, 0.004, 0.07}, true_variance = {0.03, 1.2, 0.4};

static double largest_deviation(const bis_auto_model *a, const bis_auto_model *b)
{
    return fmax(fabs(a->constant / b->constant - 1), fmax(fabs(a->by_M / b->by_M - 1), fabs(a->by_N / b->by_N - 1)));
}

static void fitting_finds_the_costs_and_the_variances_that_made_the_figures(void **state)
{
    (void)state;
    bis_auto_measured m[N_PLACES];
    make_measurements(m, &true_cost, &true_variance, 1.5);
    const bis_auto_model cost = bis_auto_fit_cost(m, N_PLACES), variance = bis_auto_fit_variance(m, N_PLACES);
    assert_true(largest_deviation(&cost, &true_cost) < 1e-9);
    assert_true(largest_deviation(&variance, &true_variance) < 1e-9);
}

/* The twin: figures of independent marks, 1/N. */
static void figures_of_another_law_of_N_give_other_coefficients(void **state)
{
    (void)state;
    bis_auto_measured m[N_PLACES];
    make_measurements(m, &true_cost, &true_variance, 1);
    const bis_auto_model variance = bis_auto_fit_variance(m, N_PLACES);
    assert_true(largest_deviation(&variance, &true_variance) > 0.1);
}

static void a_method_without_candidates_needs_two_figures(void **state)
{
    (void)state;
    const bis_auto_measured m[2] = {{0, 6, 1 + 6 * 0.2, 0.1 + 3 / pow(6, 1.5)}, {0, 32, 1 + 32 * 0.2, 0.1 + 3 / pow(32, 1.5)}};
    const bis_auto_model cost = bis_auto_fit_cost(m, 2), variance = bis_auto_fit_variance(m, 2);
    assert_true(fabs(cost.constant - 1) < 1e-9 && fabs(cost.by_N - 0.2) < 1e-9 && cost.by_M == 0);
    assert_true(fabs(variance.constant - 0.1) < 1e-9 && fabs(variance.by_N - 3) < 1e-9 && variance.by_M == 0);
}

static void no_coefficient_is_ever_negative(void **state)
{
    (void)state;
    bis_rng rng;
    bis_rng_init(&rng, 11, 0, 0, 0);
    for (int k = 0; k < 1000; k++) {
        bis_auto_measured m[N_PLACES];
        make_measurements(m, &true_cost, &true_variance, 1.5);
        for (int i = 0; i < N_PLACES; i++) {
            m[i].cost *= exp(2 * bis_rng_double(&rng) - 1);
            m[i].variance *= exp(2 * bis_rng_double(&rng) - 1);
        }
        const bis_auto_model cost = bis_auto_fit_cost(m, N_PLACES), variance = bis_auto_fit_variance(m, N_PLACES);
        assert_true(cost.constant >= 0 && cost.by_M >= 0 && cost.by_N >= 0 && bis_auto_cost(&cost, 64, 8) > 0);
        assert_true(variance.constant >= 0 && variance.by_M >= 0 && variance.by_N >= 0 && bis_auto_variance(&variance, 64, 8) > 0);
    }
}

/* --- the optimum
 * --------------------------------------------------------------------------------------------------- */

static double model_product(const bis_auto_model *c, const bis_auto_model *v, uint32_t M, uint32_t N)
{
    return (c->constant + c->by_M * M + c->by_N * N) * (v->constant + v->by_M / M + v->by_N / pow(N, 1.5));
}

static void nothing_within_the_limits_is_better_than_the_best(void **state)
{
    (void)state;
    const bis_auto_limits limits = {16, 512, 2, 64};
    bis_rng rng;
    bis_rng_init(&rng, 12, 0, 0, 0);
    for (int k = 0; k < 100; k++) {
        double c[3], v[3];
        for (int i = 0; i < 3; i++) { /* some vanish, others are anything within four decades */
            c[i] = bis_rng_double(&rng) < 0.1 ? 0 : pow(10, 4 * bis_rng_double(&rng) - 2);
            v[i] = bis_rng_double(&rng) < 0.1 ? 0 : pow(10, 4 * bis_rng_double(&rng) - 2);
        }
        const bis_auto_model cost = {c[0], c[1] / 100, c[2] / 10}, variance = {v[0], v[1] * 100, v[2] * 10};
        uint32_t M, N;
        bis_auto_best(&M, &N, &cost, &variance, &limits);
        assert_in_range(M, limits.min_M, limits.max_M);
        assert_in_range(N, limits.min_N, limits.max_N);
        const double best = model_product(&cost, &variance, M, N);
        for (uint32_t n = limits.min_N; n <= limits.max_N; n++)
            for (uint32_t m = limits.min_M; m <= limits.max_M; m++) assert_true(model_product(&cost, &variance, m, n) >= best * (1 - 1e-3)); /* M is rounded */
    }
}

static void at_the_best_candidates_have_the_same_share_of_time_and_of_variance(void **state)
{
    (void)state;
    const bis_auto_limits limits = {1, 100000, 1, 10000};
    const bis_auto_model cost = {10, 0.0004, 0.007}, variance = {0.003, 12, 40};
    uint32_t M, N;
    bis_auto_best(&M, &N, &cost, &variance, &limits);
    const double c = cost.constant + cost.by_M * M + cost.by_N * N, v = variance.constant + variance.by_M / M + variance.by_N / pow(N, 1.5);
    assert_true(fabs(cost.by_M * M / c / (variance.by_M / M / v) - 1) < 0.02);
    assert_true(fabs(cost.by_N * N / c / (1.5 * variance.by_N / pow(N, 1.5) / v) - 1) < 0.02);
}

/* --- the pilot
 * ----------------------------------------------------------------------------------------------------- */

static void make_auto_world(world *w)
{
    make_world(w, &bis_auto);
    w->desc.view.film.width = WIDTH;
    w->desc.view.film.height = HEIGHT;
    memcpy(w->desc.view.film.crop, whole, sizeof whole);
}

static void choose(bis_auto_report *r, const world *w, const bis_render_options *options)
{
    assert_int_equal(bis_auto_choose(r, &w->scene, &w->desc, options, NULL), BIS_OK);
}

/* Choose by that clock. */
static void choose_by_work(bis_auto_report *r, world *w, const bis_render_options *options)
{
    counting_accel accel = {{&counting, w->scene.accel->geometry}, w->scene.accel};
    w->scene.accel = &accel.base;
    counts_work = true;
    choose(r, w, options);
    counts_work = false;
    w->scene.accel = accel.inner;
}

static bool was_tried(const bis_auto_report *r, const bis_integrator *i)
{
    for (int k = 0; k < r->n_tried; k++)
        if (r->tried[k].settings.integrator == i) return true;
    return false;
}

/* 1500 camera samples of 777 pixels are 1.17e6, less than 1.2e6: too few. 8000 are enough for the short list, although
 * not all show a surface. Too few: the settings are those of a scene without an Integrator, and no ray is traced. */
static void where_little_is_to_come_nothing_is_tried(void **state)
{
    (void)state;
    const uint32_t spp[] = {0, 1, 1500, 8000};
    const bis_settings usual = bis_settings_unnamed();
    bis_auto_report r;
    world w;
    make_auto_world(&w);
    for (int only_sir = 0; only_sir < 2; only_sir++) {
        w.desc.view.settings = bis_settings_default(only_sir ? &bis_sir : &bis_auto);
        if (only_sir) w.desc.view.settings.candidates = 0;
        bis_settings_leave_open(&w.desc.view.settings);
        for (size_t i = 0; i < sizeof spp / sizeof *spp; i++) {
            const long before = worked;
            choose_by_work(&r, &w, &(bis_render_options){.budget = {.spp = spp[i]}, .n_threads = 1});
            if (spp[i] == 8000) {
                assert_true(r.is_chosen && r.reason == NULL && r.n_tried >= 2 && worked > before);
                continue;
            }
            assert_true(!r.is_chosen && r.n_tried == 0 && r.width == 0 && worked == before);
            assert_string_equal(r.reason, "too short to measure");
            assert_true(bis_settings_equal(&r.settings, &usual) && !r.settings.only_sir);
        }
    }
    clear_world(&w);
}

/* A long render to come: all rounds. */
static void what_is_chosen_was_measured_and_no_other_was_better(void **state)
{
    (void)state;
    const bis_render_options options = {.budget = {.spp = 200000}, .n_threads = 2};
    bis_auto_report r;
    world w;
    make_auto_world(&w);
    choose(&r, &w, &options);
    assert_true(r.n_tried > 8);
    assert_true(r.is_chosen);
    assert_in_range(r.chosen, 0, r.n_tried - 1);
    assert_memory_equal(&r.settings, &r.tried[r.chosen].settings, sizeof r.settings);
    assert_true(r.settings.integrator != &bis_auto);
    assert_int_equal(bis_settings_check(&r.settings, (bis_loc){0}, NULL), BIS_OK);
    assert_true(was_tried(&r, &bis_mis) && was_tried(&r, &bis_sir));
    assert_false(was_tried(&r, &bis_em) || was_tried(&r, &bis_brdf)); /* glossy, under a map */
    for (int i = 0; i < r.n_tried; i++) {
        const bis_auto_tried *t = &r.tried[i];
        assert_true(t->cost > 0 && t->variance > 0 && isfinite(t->cost) && isfinite(t->variance) && t->replicates >= 2);
        if (t->settings.integrator == &bis_sir) {
            const double room = is_usual(&r.settings) ? 1.1 : 1; /* what needs no choice is left for a tenth, not for less */
            assert_true(room * bis_auto_cost_of(&r, i) * t->variance >= bis_auto_cost_of(&r, r.chosen) * r.tried[r.chosen].variance);
            if (is_usual(&t->settings) && !is_usual(&r.settings))
                assert_true(bis_auto_cost_of(&r, i) * t->variance > 1.1 * bis_auto_cost_of(&r, r.chosen) * r.tried[r.chosen].variance);
        }
        assert_true(t->settings.shadowrays <= 64);
    }
    clear_world(&w);
}

static void a_short_render_tries_a_short_list(void **state)
{
    (void)state;
    const bis_render_options options = {.budget = {.spp = 8000}, .n_threads = 1};
    bis_auto_report r;
    world w;
    make_auto_world(&w);
    choose(&r, &w, &options);
    assert_int_equal(r.n_tried, 3);
    assert_int_equal(r.passes, 1);
    clear_world(&w);
}

static void diffuse_surfaces_let_em_take_part(void **state)
{
    (void)state;
    const bis_render_options options = {.budget = {.spp = 8000}, .n_threads = 1};
    bis_auto_report r;
    world w;
    make_auto_world(&w);
    choose(&r, &w, &options);
    assert_false(was_tried(&r, &bis_em));
    w.materials[0] = w.materials[1] = bis_phong((rgb){0.5f, 0.4f, 0.3f}, (rgb){0, 0, 0}, 1);
    choose(&r, &w, &options);
    assert_true(was_tried(&r, &bis_em));
    clear_world(&w);
}

static void among_sirs_settings_alone_nothing_else_is_tried(void **state)
{
    (void)state;
    const bis_render_options options = {.budget = {.spp = 200000}, .n_threads = 1};
    bis_auto_report r;
    world w;
    make_auto_world(&w);
    w.desc.view.settings = bis_settings_default(&bis_sir);
    w.desc.view.settings.candidates = 0;
    bis_settings_leave_open(&w.desc.view.settings);
    assert_true(bis_auto_is_wanted(&w.desc.view.settings));
    choose(&r, &w, &options);
    for (int i = 0; i < r.n_tried; i++) assert_ptr_equal(r.tried[i].settings.integrator, &bis_sir);
    assert_true(r.settings.candidates > 0);
    clear_world(&w);
}

static void a_fixed_integrator_is_left_as_it_is(void **state)
{
    (void)state;
    const bis_render_options options = {.budget = {.spp = 8000}, .n_threads = 1};
    bis_auto_report r;
    world w;
    make_auto_world(&w);
    w.desc.view.settings = bis_settings_default(&bis_mis);
    choose(&r, &w, &options);
    assert_memory_equal(&r.settings, &w.desc.view.settings, sizeof r.settings);
    assert_true(r.n_tried == 0 && r.reason == NULL);
    clear_world(&w);
}

static void without_a_surface_or_light_or_time_it_is_sir_at_once(void **state)
{
    (void)state;
    volatile sig_atomic_t interrupted = 1;
    bis_auto_report r;
    world w;
    make_auto_world(&w);
    for (int i = 0; i < 3; i++) {
        const bis_render_options options = {.budget = {.spp = 8000}, .n_threads = 1, .interrupted = i == 2 ? &interrupted : NULL};
        bis_scene scene = w.scene;
        bis_light *black;
        assert_int_equal(bis_light_constant(&black, (rgb){0, 0, 0}, NULL), BIS_OK);
        if (i == 0) scene.accel = NULL;
        if (i == 1) scene.light = black;
        assert_int_equal(bis_auto_choose(&r, &scene, &w.desc, &options, NULL), BIS_OK);
        assert_ptr_equal(r.settings.integrator, &bis_sir);
        assert_int_equal(bis_settings_check(&r.settings, (bis_loc){0}, NULL), BIS_OK);
        assert_false(r.is_chosen);
        assert_true(is_usual(&r.settings));
        assert_string_equal(r.reason, i < 2 ? "no surface or no light" : "interrupted");
        if (i < 2) assert_int_equal(r.n_tried, 0);
            bis_light_free(black);
    }
    clear_world(&w);
}

static void a_constant_light_is_rendered_with_what_needs_no_map(void **state)
{
    (void)state;
    const bis_render_options options = {.budget = {.spp = 200000}, .n_threads = 1};
    bis_auto_report r;
    world w;
    make_auto_world(&w);
    bis_light *map = w.scene.light;
    assert_int_equal(bis_light_constant(&w.scene.light, (rgb){1, 0.5f, 0.25f}, NULL), BIS_OK);
    choose(&r, &w, &options);
    assert_true(was_tried(&r, &bis_brdf));
    assert_false(was_tried(&r, &bis_em));
    assert_true(r.is_chosen);
    bis_light_free(w.scene.light);
    w.scene.light = map;
    clear_world(&w);
}

/* The relMSE of a pass by another road: the scatter of `spp` passes of the whole picture, over the square of its own
 * mean and the floor that docs/command-line.md (compare) gives; pixels and channels that show a surface. */
static double variance_of_a_pass(world *w, const bis_settings *settings, uint32_t spp)
{
    bis_film film;
    bis_render_result result;
    double mean = 0, sum = 0;
    size_t n = 0;

    w->desc.view.settings = *settings;
    render(&film, &result, w, whole, &(bis_render_options){.budget = {.spp = spp}, .pass_size = 1});
    for (size_t k = 0; k < 3 * WIDTH * HEIGHT; k++) {
        if (film.hits[k / 3] == 0) continue;
        mean += film.sum[k] / spp;
        n++;
    }
    mean /= (double)n;
    for (size_t k = 0; k < 3 * WIDTH * HEIGHT; k++) {
        if (film.hits[k / 3] == 0) continue;
        const double m = film.sum[k] / spp;
        sum += bis_film_variance(&film, k) * spp / (m * m + mean * mean / 100);
    }
    bis_film_clear(&film);
    return sum / (double)n;
}

/* In the geometric mean over what was tried, above 3/4: that, or a half, is what four or two replicates give whose
 * scatter is divided by their number, which would also favour what has had less of them. (About 0.9 comes out: the
 * most noisy cell is forgiven.) Rays through pixels' middles and independent samples: passes are independent. */
static void the_variance_that_is_measured_is_that_of_a_pass(void **state)
{
    (void)state;
    const bis_render_options options = {.budget = {.spp = 200000}, .n_threads = 2};
    bis_auto_report r;
    world w;
    double sum = 0;
    int n = 0;
    make_auto_world(&w);
    w.materials[0] = w.materials[1] = bis_phong((rgb){0.5f, 0.4f, 0.3f}, (rgb){0.2f, 0.2f, 0.2f}, 5);
    w.desc.view.pixel_jitter = false;
    w.desc.view.sampler.kind = BIS_SAMPLER_RANDOM;
    choose(&r, &w, &options);
    for (int i = 0; i < r.n_tried; i++) {
        if (r.tried[i].settings.shadowrays > 16) continue; /* for the time it takes */
        const double ratio = r.tried[i].variance / variance_of_a_pass(&w, &r.tried[i].settings, 50);
        sum += log(ratio);
        n++;
    }
    if (!(n >= 4 && fabs(sum / n) < log(4 / 3.0))) fail_msg("%g over %d settings", exp(sum / n), n);
    clear_world(&w);
}

/* Black surfaces: no noise, whatever is done, and the cheapest wins. */
static void without_noise_the_cheapest_is_chosen(void **state)
{
    (void)state;
    const bis_render_options options = {.budget = {.spp = 200000}, .n_threads = 1};
    bis_auto_report r;
    world w;
    make_auto_world(&w);
    w.materials[0] = w.materials[1] = bis_phong((rgb){0, 0, 0}, (rgb){0, 0, 0}, 1);
    w.desc.light.visible = false;
    choose(&r, &w, &options);
    assert_true(r.is_chosen);
    for (int i = 0; i < r.n_tried; i++) {
        assert_true(r.tried[i].variance == 0);
        assert_true(bis_auto_cost_of(&r, r.chosen) <= bis_auto_cost_of(&r, i));
    }
    clear_world(&w);
}

/* A strip of one row of a picture of 30000 x 100, all floor: 1.5e6 samples are 18750, 3125 pixels, k = sqrt 9.6. Of the
 * 32 rows of a smaller picture it holds no middle (25.12 to 25.44), and the pilot takes the one that it lies in. */
static void a_thin_crop_is_chosen_for_too(void **state)
{
    (void)state;
    const bis_render_options options = {.budget = {.spp = 50}, .n_threads = 1};
    const double strip[4] = {0, 1, 0.785, 0.795};
    bis_auto_report r;
    world w;
    make_auto_world(&w);
    w.desc.view.film.width = 30000;
    w.desc.view.film.height = 100;
    memcpy(w.desc.view.film.crop, strip, sizeof strip);
    w.desc.view.camera.has_screen = true; /* all of the strip shows the floor */
    memcpy(w.desc.view.camera.screen, (double[4]){-1, 1, -1, 1}, sizeof w.desc.view.camera.screen);
    choose(&r, &w, &options);
    assert_true(r.is_chosen && r.width == 9682 && r.height == 1);
    clear_world(&w);
}

/* From `first` on each `step`-th, up to one that no longer fails. */
static void assert_failures_are_reported(const world *w, const bis_render_options *options, long first, long step)
{
    long k;
    for (k = first;; k += step) {
        bis_diag diag = {0};
        bis_auto_report r;
        bis_mem_fail_at(k);
        bis_status status = bis_auto_choose(&r, &w->scene, &w->desc, options, &diag);
        bis_mem_fail_at(0);
        const size_t n_errors = diag.n_errors;
        bis_diag_clear(&diag);
            if (status == BIS_OK) break;
        assert_int_equal(status, BIS_NOMEM);
        assert_true(n_errors >= 1);
        assert_in_range(k, 1, 20000);
    }
    assert_true(k > 50);
}

static void every_failing_allocation_of_the_pilot_is_reported(void **state)
{
    (void)state;
    world w;
    make_auto_world(&w);
    assert_failures_are_reported(&w, &(bis_render_options){.budget = {.spp = 8000}, .n_threads = 1}, 1, 1);
    clear_world(&w);
}

/* Rays of a pass of the full picture, by the render's own counters. */
static double rays_of_a_pass(world *w, const bis_settings *settings, uint32_t spp)
{
    bis_film film;
    bis_render_result result;

    w->desc.view.settings = *settings;
    render(&film, &result, w, whole, &(bis_render_options){.budget = {.spp = spp}});
    bis_film_clear(&film);
    return (double)(result.counters.camera_rays + result.counters.shadow_rays) / spp;
}

/* The same work is the same choice, with any number of threads; and what a pass costs is what its rays cost. The pilot's
 * film is smaller than the picture, and its random numbers are others: their rays differ by some percent. */
static void the_same_work_is_the_same_choice_and_a_pass_costs_its_rays(void **state)
{
    (void)state;
    const double rounding = 1e-12; /* of seconds, as differences of doubles below 1 s; a look at the clock is 1e-8 */
    bis_auto_report r, again;
    world w;
    make_auto_world(&w);
    choose_by_work(&r, &w, &(bis_render_options){.budget = {.spp = 200000}, .n_threads = 2});
    choose_by_work(&again, &w, &(bis_render_options){.budget = {.spp = 200000}, .n_threads = 3});
    assert_true(r.is_chosen && again.chosen == r.chosen && again.n_tried == r.n_tried);
    for (int i = 0; i < r.n_tried; i++) {
        const bis_auto_tried *t = &r.tried[i], *u = &again.tried[i];
        assert_true(fabs(u->cost - t->cost) < rounding && fabs(u->fill - t->fill) < rounding && u->variance == t->variance);
        assert_true(u->replicates == t->replicates && t->fill > 0);
        const double ratio = bis_auto_cost_of(&r, i) / (1e-6 * rays_of_a_pass(&w, &t->settings, 4));
        if (!(fabs(ratio - 1) < 0.1)) fail_msg("setting %d: %g", i, ratio);
    }
    clear_world(&w);
}

/* --- every k-th pixel
 * ---------------------------------------------------------------------------------------------- */

/* The place where the ray meets the surface, with hardly a footprint: the pixel's centre. */
static void a_footprint_of_nearly_nothing_is_the_centre_of_the_pixel(void **state)
{
    (void)state;
    world w;
    bis_film centre, small, all;
    bis_render_result result;
    make_world(&w, &place);
    w.desc.view.pixel_jitter = false;
    render(&centre, &result, &w, whole, &(bis_render_options){.budget = {.spp = 1}});
    w.desc.view.pixel_jitter = true;
    render(&small, &result, &w, whole, &(bis_render_options){.budget = {.spp = 1}, .footprint = 0x1p-20});
    render(&all, &result, &w, whole, &(bis_render_options){.budget = {.spp = 1}});
    double with = 0, without = 0;
    for (int i = 0; i < 3 * WIDTH * HEIGHT; i++) {
        if (centre.hits[i / 3] <= 0 || small.hits[i / 3] <= 0 || all.hits[i / 3] <= 0) continue;
        with = fmax(with, fabs(small.sum[i] - centre.sum[i]));
        without = fmax(without, fabs(all.sum[i] - centre.sum[i]));
    }
    assert_true(with < 1e-2); /* a millionth of a pixel, at grazing angles some thousands of times as much */
    assert_true(without > 0.1);
    bis_film_clear(&centre);
    bis_film_clear(&small);
    bis_film_clear(&all);
    clear_world(&w);
}

/* A footprint of 1 is the whole pixel: the same places, but for the rounding of (u - 1/2) + 1/2. Half the footprint
 * brings the same samples half as far from the centre, on the same side; the mean over the picture of such small steps
 * is linear in them. */
static void a_footprint_draws_the_samples_to_the_centre(void **state)
{
    static const double footprints[] = {0, 1, 1 / 16.0, 1 / 32.0};
    (void)state;
    world w;
    bis_film centre, f[4];
    bis_render_result result;
    make_world(&w, &place);
    w.desc.view.pixel_jitter = false;
    render(&centre, &result, &w, whole, &(bis_render_options){.budget = {.spp = 1}});
    w.desc.view.pixel_jitter = true;
    for (int k = 0; k < 4; k++)
        render(&f[k], &result, &w, whole, &(bis_render_options){.budget = {.spp = 1}, .footprint = footprints[k]});
    double sums[4] = {0}, product = 0;
    int n = 0;
    for (int i = 0; i < 3 * WIDTH * HEIGHT; i++) {
        bool hit = centre.hits[i / 3] > 0;
        for (int k = 0; k < 4; k++) hit &= f[k].hits[i / 3] > 0;
        if (!hit) continue;
        n++;
        assert_true(fabs(f[0].sum[i] - f[1].sum[i]) < 1e-3 * (1 + fabs(f[0].sum[i] - centre.sum[i])));
        for (int k = 0; k < 4; k++) sums[k] += fabs(f[k].sum[i] - centre.sum[i]);
        product += (f[2].sum[i] - centre.sum[i]) * (f[0].sum[i] - centre.sum[i]);
    }
    assert_true(n > WIDTH * HEIGHT);
    assert_true(fabs(sums[3] / sums[2] - 0.5) < 0.02);
    assert_true(product > 0);
    bis_film_clear(&centre);
    for (int k = 0; k < 4; k++) bis_film_clear(&f[k]);
    clear_world(&w);
}

/* --- the program
 * --------------------------------------------------------------------------------------------------- */

static void write_scene_of(const char *path, const char *integrator, const char *phong)
{
    char text[16384];
    snprintf(text, sizeof text, "Film \"rgb\" \"integer xresolution\" 48 \"integer yresolution\" 32\n%s\nSampler \"stratified\" \"integer pixelsamples\" 4\nScale -1 1 1\n"
             "LookAt -2.0 -7.4 0.25   0 0 -0.28   0 0 1\nCamera \"perspective\" \"float fov\" 29\nWorldBegin\n"
             "LightSource \"infinite\" \"string filename\" \"../../data/maps/interior.hdr\"\n"
             "Material \"phong\" %s\nShape \"sphere\" \"float radius\" 1\n"
             "Material \"diffuse\"\nTranslate 0 0 -1\nShape \"disk\" \"float radius\" 30\n", integrator, phong);
    program_write_file(path, text);
}

static void write_scene(const char *path, const char *integrator) { write_scene_of(path, integrator, "\"float Ks\" 0.5 \"float Kd\" 0.4 \"float exponent\" 40"); }

static void read_attribute(char *line, size_t size, const char *path, const char *name)
{
    exr_context_t file;
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    const char *text;
    int32_t length;
    assert_int_equal(exr_start_read(&file, path, &init), EXR_ERR_SUCCESS);
    assert_int_equal(exr_attr_get_string(file, 0, name, &length, &text), EXR_ERR_SUCCESS);
    snprintf(line, size, "%.*s", (int)length, text);
    exr_finish(&file);
}

static void assert_same_picture(const char *a, const char *b, bool same)
{
    bis_image x, y;
    assert_int_equal(bis_image_read(&x, a, (bis_loc){0}, NULL), BIS_OK);
    assert_int_equal(bis_image_read(&y, b, (bis_loc){0}, NULL), BIS_OK);
    assert_int_equal(memcmp(x.pixels, y.pixels, (size_t)x.width * (size_t)x.height * sizeof *x.pixels) == 0, same);
    bis_image_clear(&x);
    bis_image_clear(&y);
}

/* A long time is to come, but the error is reached at once. */
#define LONG " --time 10 --error 0.5 "

static void the_line_in_the_picture_makes_the_picture_again(void **state)
{
    (void)state;
    const char *const wishes[] = {"Integrator \"auto\"", "Integrator \"sir\" \"integer candidates\" 0"};
    for (int i = 0; i < 2; i++) {
        char line[1024];
        program_run r;
        write_scene(DIR "/auto.txt", wishes[i]);
        program_expect(&r, 0, DIR "/auto.txt" LONG "--nthreads 2 --outfile " DIR "/auto.exr");
        assert_non_null(strstr(r.messages, "bis: note: auto chose "));
        read_attribute(line, sizeof line, DIR "/auto.exr", "bis:auto");
        write_scene(DIR "/fixed.txt", line);
        program_expect(&r, 0, DIR "/fixed.txt" LONG "--nthreads 1 --outfile " DIR "/fixed.exr");
        program_expect_only_the_result(&r);
        assert_same_picture(DIR "/auto.exr", DIR "/fixed.exr", true);
        program_expect(&r, 0, DIR "/fixed.txt" LONG "--seed 5 --outfile " DIR "/fixed.exr");
        assert_same_picture(DIR "/auto.exr", DIR "/fixed.exr", false);
    }
}

static void stats_tell_what_was_tried(void **state)
{
    (void)state;
    char value[64];
    program_run r;
    write_scene(DIR "/auto.txt", "Integrator \"em\"");
    program_expect(&r, 0, DIR "/auto.txt" LONG "--integrator auto --quiet --stats - --outfile " DIR "/auto.exr");
    assert_string_equal(r.messages, "");
    assert_true(json_is_valid(r.output));
    assert_string_equal(json_value(value, sizeof value, r.output, "auto.passes"), "1");
    assert_non_null(strstr(r.output, "\"pass_relmse\""));
    program_expect(&r, 0, DIR "/auto.txt --stats - --outfile " DIR "/auto.exr");
    assert_null(strstr(r.output, "\"auto\""));
}

/* 48 x 32 pixels: too short for a pilot. */
static void a_short_picture_is_that_without_an_integrator(void **state)
{
    (void)state;
    static const char note[] = "bis: note: auto takes the default, sir, product, 64 candidates, 24 shadow rays: too short to measure\n";
    const char *const wishes[] = {"Integrator \"auto\"", "Integrator \"sir\" \"integer candidates\" 0"};
    for (int i = 0; i < 2; i++) {
        char value[1024], line[1024];
        program_run r;
        write_scene(DIR "/usual.txt", "");
        program_expect(&r, 0, DIR "/usual.txt --stats - --outfile " DIR "/usual.exr");
        assert_null(strstr(r.output, "\"auto\""));
        write_scene(DIR "/auto.txt", wishes[i]);
        program_expect(&r, 0, DIR "/auto.txt --stats - --outfile " DIR "/auto.exr");
        assert_non_null(strstr(r.messages, note));
        assert_string_equal(json_value(value, sizeof value, r.output, "auto.reason"), "\"too short to measure\"");
        assert_string_equal(json_value(value, sizeof value, r.output, "auto.width"), "0");
        assert_null(strstr(r.output, "pass_relmse"));
        assert_same_picture(DIR "/auto.exr", DIR "/usual.exr", true);
        read_attribute(line, sizeof line, DIR "/auto.exr", "bis:auto-reason");
        assert_string_equal(line, "too short to measure");
        read_attribute(line, sizeof line, DIR "/auto.exr", "bis:auto");
        write_scene(DIR "/fixed.txt", line);
        program_expect(&r, 0, DIR "/fixed.txt --outfile " DIR "/fixed.exr");
        assert_same_picture(DIR "/auto.exr", DIR "/fixed.exr", true);
    }
}

static void the_command_line_can_leave_it_open_and_take_it_back(void **state)
{
    (void)state;
    char value[64];
    program_run r;
    write_scene(DIR "/auto.txt", "Integrator \"sir\" \"integer candidates\" 0");
    program_expect(&r, 0, DIR "/auto.txt --candidates 30 --stats - --outfile " DIR "/auto.exr");
    assert_string_equal(json_value(value, sizeof value, r.output, "candidates"), "30");
    program_expect_only_the_result(&r);
    program_expect(&r, 0, DIR "/auto.txt --integrator sir --candidates 0 --plan");
    assert_non_null(strstr(r.output, "a pilot"));
    program_expect(&r, 2, DIR "/auto.txt --integrator unoccluded --candidates 0");
    assert_non_null(strstr(r.messages, "\"candidates\" is 0"));
    write_scene(DIR "/auto.txt", "Integrator \"auto\" \"integer samples\" 3");
    program_expect(&r, 2, DIR "/auto.txt");
    assert_non_null(strstr(r.messages, "samples"));
    write_scene(DIR "/auto.txt", "Integrator \"rejection\" \"integer candidates\" 0");
    program_expect(&r, 2, DIR "/auto.txt");
}

/* Twin: a limit of 0 would be none, and the scene's many passes would follow. */
static void a_choice_that_takes_all_the_time_leaves_one_pass(void **state)
{
    (void)state;
    char value[64];
    program_run r;
    write_scene(DIR "/auto.txt", "Integrator \"auto\"");
    program_expect(&r, 0, DIR "/auto.txt --quiet --time 1e-9 --stats - --outfile " DIR "/auto.exr");
    assert_string_equal(json_value(value, sizeof value, r.output, "spp"), "1");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fitting_finds_the_costs_and_the_variances_that_made_the_figures),
        cmocka_unit_test(figures_of_another_law_of_N_give_other_coefficients),
        cmocka_unit_test(a_method_without_candidates_needs_two_figures),
        cmocka_unit_test(no_coefficient_is_ever_negative),
        cmocka_unit_test(nothing_within_the_limits_is_better_than_the_best),
        cmocka_unit_test(at_the_best_candidates_have_the_same_share_of_time_and_of_variance),
        cmocka_unit_test(where_little_is_to_come_nothing_is_tried),
        cmocka_unit_test(what_is_chosen_was_measured_and_no_other_was_better),
        cmocka_unit_test(a_short_render_tries_a_short_list),
        cmocka_unit_test(diffuse_surfaces_let_em_take_part),
        cmocka_unit_test(among_sirs_settings_alone_nothing_else_is_tried),
        cmocka_unit_test(a_fixed_integrator_is_left_as_it_is),
        cmocka_unit_test(without_a_surface_or_light_or_time_it_is_sir_at_once),
        cmocka_unit_test(a_constant_light_is_rendered_with_what_needs_no_map),
        cmocka_unit_test(the_variance_that_is_measured_is_that_of_a_pass),
        cmocka_unit_test(without_noise_the_cheapest_is_chosen),
        cmocka_unit_test(a_thin_crop_is_chosen_for_too),
        cmocka_unit_test(every_failing_allocation_of_the_pilot_is_reported),
        cmocka_unit_test(the_same_work_is_the_same_choice_and_a_pass_costs_its_rays),
        cmocka_unit_test(a_footprint_of_nearly_nothing_is_the_centre_of_the_pixel),
        cmocka_unit_test(a_footprint_draws_the_samples_to_the_centre),
        cmocka_unit_test(the_line_in_the_picture_makes_the_picture_again),
        cmocka_unit_test(stats_tell_what_was_tried),
        cmocka_unit_test(a_short_picture_is_that_without_an_integrator),
        cmocka_unit_test(the_command_line_can_leave_it_open_and_take_it_back),
        cmocka_unit_test(a_choice_that_takes_all_the_time_leaves_one_pass),
    };
    program_folder(DIR);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
