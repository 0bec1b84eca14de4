/* SPDX-License-Identifier: BSD-2-Clause */
/* adapt: samples go where the noise is, and the mean stays right for every number of passes. Family-wise significance
 * of the statistical tests: 0.01. */
#include "render/adapt.h"

#include "bis/thesis/rng.h"

#include "stat.h"
#include "world.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>

#define SEED 20u

static void init(bis_film *f, bis_adapt *a, int width, int height, int tile)
{
    assert_int_equal(bis_film_init(f, width, height, whole, (bis_loc){0}, NULL), BIS_OK);
    assert_int_equal(bis_adapt_init(a, f, tile, NULL), BIS_OK);
}

/* --- where samples go
 * ---------------------------------------------------------------------------------------------- */

/* A pass of pixels 1 + noise_of * (u - 1/2), the noise a function of the tile's column. */
static void flat_pass(bis_film *f, const bis_adapt *a, bis_rng *rng, const double *noise_of)
{
    for (int y = 0; y < f->height; y++) {
        for (int x = 0; x < f->width; x++) {
            uint32_t m = a->samples[y / a->tile * a->tiles_x + x / a->tile];
            double L = 0;
            for (uint32_t i = 0; i < m; i++) L += (1 + noise_of[x / a->tile] * (bis_rng_double(rng) - 0.5)) / m;
            bis_film_add(f, x, y, rgb_from(L, L, L), 1, 1);
        }
    }
    bis_film_end_pass(f, 1);
}

static double samples_in_all(const bis_film *f, const bis_adapt *a)
{
    double sum = 0;
    for (int y = 0; y < f->height; y++)
        for (int x = 0; x < f->width; x++) sum += a->samples[y / a->tile * a->tiles_x + x / a->tile];
    return sum;
}

/* Three columns of tiles, the last one narrow, with noise 0.2, 1 and 0.6: samples in proportion, as many as there may
 * be. */
static void samples_are_in_proportion_to_the_noise_and_keep_their_sum(void **state)
{
    (void)state;
    const double noise_of[3] = {0.2, 1, 0.6};
    bis_film f;
    bis_adapt a;
    bis_rng rng;
    bis_rng_init(&rng, SEED, 0, 0, 0);
    init(&f, &a, 40, 32, 16);
    assert_int_equal(a.n_tiles, 6);
    for (int pass = 0; pass < 12; pass++) {
        for (int t = 0; pass < BIS_ADAPT_PILOT && t < a.n_tiles; t++) assert_int_equal(a.samples[t], BIS_ADAPT_SAMPLES);
        flat_pass(&f, &a, &rng, noise_of);
        bis_adapt_next(&a, &f);
        double all = samples_in_all(&f, &a);
        assert_true(all <= BIS_ADAPT_SAMPLES * 40 * 32 && all > 0.85 * BIS_ADAPT_SAMPLES * 40 * 32);
    }
    for (int t = 0; t < a.n_tiles; t++) {
        /* Standard deviation of noise (u - 1/2) about 1, by the weight of relMSE, 1 + 1/100: */
        double expected = noise_of[t % 3] / sqrt(12 * 1.01);
        assert_true(fabs(a.noise[t] / expected - 1) < 0.1); /* 12 passes, 128 pixels: 2% and better */
    }
    assert_int_equal(a.samples[0], 1);
    assert_true(a.samples[1] >= 6 && a.samples[1] <= 8); /* 7.6 : 1.5 : 4.6 would be in proportion */
    assert_true(a.samples[2] >= 3 && a.samples[2] <= 5);
    bis_adapt_clear(&a);
    bis_film_clear(&f);
}

static void without_noise_every_tile_gets_one_sample_and_a_lone_noisy_one_no_more_than_the_most(void **state)
{
    (void)state;
    const double none[8] = {0}, one[8] = {0, 0, 0, 1};
    for (int k = 0; k < 2; k++) {
        bis_film f;
        bis_adapt a;
        bis_rng rng;
        bis_rng_init(&rng, SEED, 0, 0, 0);
        init(&f, &a, 8 * 16, 16 * 16, 16);
        for (int pass = 0; pass < 3; pass++) {
            flat_pass(&f, &a, &rng, k ? one : none);
            bis_adapt_next(&a, &f);
        }
        for (int t = 0; t < a.n_tiles; t++) {
            if (k == 0 || t % 8 != 3) assert_int_equal(a.samples[t], 1);
            else assert_true(a.samples[t] > 20 && a.samples[t] <= BIS_ADAPT_MOST);
        }
        bis_adapt_clear(&a);
        bis_film_clear(&f);
    }
}

/* --- unbiased
 * ------------------------------------------------------------------------------------------------------ */

enum { SIDE = 4, TRIALS = 20000, MOST_PASSES = 8 };

static double alpha(void) { return stat_level(0.01, MOST_PASSES + 2); }

typedef struct means {
    stat_moments adaptive[MOST_PASSES + 1]; /* after so many passes */
    stat_moments alike;                     /* twin: each sample weighs as much as any other */
    stat_moments stopped;                   /* twin: a tile ends when its own estimate is good enough */
} means;

/* Skewed noise of mean 1: 1/2, and in one of 8 samples 4.5: what comes out bright scatters more. */
static double rare(bis_rng *rng) { return bis_rng_double(rng) < 0.125 ? 4.5 : 0.5; }

/* One picture of 2 x 2 tiles of 2 x 2 pixels: so few values behind an estimate that any correlation of mean and choice
 * shows. */
static void trial(means *m, uint64_t seed)
{
    bis_film f;
    bis_adapt a;
    bis_rng rng;
    double weighted[4] = {0}, weight[4] = {0};
    bis_rng_init(&rng, SEED, seed, 0, 0);
    init(&f, &a, SIDE, SIDE, 2);
    for (int pass = 1; pass <= MOST_PASSES; pass++) {
        for (int i = 0; i < SIDE * SIDE; i++) {
            const int t = i / SIDE / 2 * a.tiles_x + i % SIDE / 2;
            double L = 0;
            for (uint32_t k = 0; k < a.samples[t]; k++) L += rare(&rng);
            bis_film_add(&f, i % SIDE, i / SIDE, rgb_from(L / a.samples[t], L / a.samples[t], 0), 1, 1);
            weighted[t] += L;
            weight[t] += a.samples[t];
        }
        bis_film_end_pass(&f, 1);
        double sum = 0;
        for (size_t i = 0; i < SIDE * SIDE; i++) sum += f.sum[3 * i];
        stat_add(&m->adaptive[pass], sum / (SIDE * SIDE * pass));
        bis_adapt_next(&a, &f);
    }
    stat_add(&m->alike, (weighted[0] / weight[0] + weighted[1] / weight[1] + weighted[2] / weight[2] + weighted[3] / weight[3]) / 4);

    double sum = 0, squares = 0, n = 0;
    while (n < 8 || (n < 400 && squares / n - sum / n * (sum / n) > 0.02 * n * (sum / n) * (sum / n))) {
        double L = rare(&rng);
        sum += L;
        squares += L * L;
        n++;
    }
    stat_add(&m->stopped, sum / n);
    bis_adapt_clear(&a);
    bis_film_clear(&f);
}

static void every_number_of_passes_is_unbiased_and_natural_weights_are_not(void **state)
{
    (void)state;
    means m = {0};
    for (uint64_t seed = 1; seed <= TRIALS; seed++) trial(&m, seed);
    for (int pass = 1; pass <= MOST_PASSES; pass++) stat_assert_mean("adaptive_passes", SEED, &m.adaptive[pass], 1, alpha());
    stat_assert_not_mean("samples_weighed_alike", SEED, &m.alike, 1, alpha());
    stat_assert_not_mean("stopped_by_own_estimate", SEED, &m.stopped, 1, alpha());
}

/* The scatter of the passes estimates the variance of their mean although each has another: pixel by pixel, over many
 * pictures. */
static void scatter_of_unequal_passes_estimates_the_variance_of_their_mean(void **state)
{
    (void)state;
    stat_moments error = {0}, estimate = {0};
    for (uint64_t seed = 1; seed <= 8000; seed++) {
        bis_film f;
        bis_adapt a;
        bis_rng rng;
        const double noise_of[2] = {0.3, 1};
        bis_rng_init(&rng, SEED + 1, seed, 0, 0);
        init(&f, &a, SIDE, SIDE, 2);
        for (int pass = 0; pass < 6; pass++) {
            flat_pass(&f, &a, &rng, noise_of);
            bis_adapt_next(&a, &f);
        }
        double mean = f.sum[6] / 6, variance = bis_film_variance(&f, 6);
        stat_add(&error, (mean - 1) * (mean - 1) - variance);
        stat_add(&estimate, variance);
        bis_adapt_clear(&a);
        bis_film_clear(&f);
    }
    stat_assert_mean("squared_error_less_estimate", SEED, &error, 0, alpha());
    assert_true(estimate.mean > 0);
}

/* --- in renders
 * ---------------------------------------------------------------------------------------------------- */

static void an_adaptive_render_has_the_same_bits_for_any_number_of_threads(void **state)
{
    (void)state;
    world w;
    bis_film one, many;
    bis_render_result a, b;
    make_world(&w, &bis_sir);
    w.desc.view.adaptive = true;
    render_layers(&one, &a, &w, whole, BIS_LAYERS_ALL, &(bis_render_options){.budget = {.spp = 22}, .n_threads = 1});
    render_layers(&many, &b, &w, whole, BIS_LAYERS_ALL, &(bis_render_options){.budget = {.spp = 24}, .n_threads = 5});
    assert_int_equal(one.passes, 6); /* 22 camera samples, rounded up to passes of 4 */
    assert_int_equal(a.spp, 24);
    assert_same_bits(&one, &many);
    assert_memory_equal(one.layers.sum, many.layers.sum, (size_t)one.layers.n_values * WIDTH * HEIGHT * sizeof *one.layers.sum);
    assert_memory_equal(&a.counters, &b.counters, sizeof a.counters);
    double per_pixel = (double)a.counters.camera_rays / (WIDTH * HEIGHT);
    assert_true(per_pixel <= 24 && per_pixel > 20);
    bis_film_clear(&one);
    bis_film_clear(&many);
    clear_world(&w);
}

/* `noise` has mean 1/2 on every surface; black sky, floor and ball seen through pixel centres. */
static void an_adaptive_render_is_unbiased(void **state)
{
    (void)state;
    world w;
    stat_moments m = {0};
    uint64_t rays = 0;
    make_world(&w, &noise);
    w.desc.view.adaptive = true;
    w.desc.view.pixel_jitter = false;
    w.desc.light.visible = false;
    for (uint64_t seed = 1; seed <= 150; seed++) {
        bis_film f;
        bis_render_result result;
        w.desc.view.sampler.seed = seed;
        render(&f, &result, &w, whole, &(bis_render_options){.budget = {.spp = 16}});
        double sum = 0, hits = 0;
        for (size_t i = 0; i < WIDTH * HEIGHT; i++) {
            sum += f.sum[3 * i] / f.weight;
            hits += (double)f.hits[i] / f.weight;
            assert_true(f.hits[i] == 0 || (double)f.hits[i] == f.weight);
        }
        stat_add(&m, sum / hits);
        rays += result.counters.camera_rays;
        bis_film_clear(&f);
    }
    stat_assert_mean("adaptive_render", SEED, &m, 0.5, alpha());
    assert_true(rays < 150 * 16 * WIDTH * HEIGHT); /* not all tiles were alike */
    clear_world(&w);
}

static void every_failing_allocation_is_reported_and_leaves_nothing(void **state)
{
    (void)state;
    world w;
    make_world(&w, &noise);
    w.desc.view.adaptive = true;
    assert_true(first_k_without_failure(&w, 0) > 10);
    clear_world(&w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(samples_are_in_proportion_to_the_noise_and_keep_their_sum),
        cmocka_unit_test(without_noise_every_tile_gets_one_sample_and_a_lone_noisy_one_no_more_than_the_most),
        cmocka_unit_test(every_number_of_passes_is_unbiased_and_natural_weights_are_not),
        cmocka_unit_test(scatter_of_unequal_passes_estimates_the_variance_of_their_mean),
        cmocka_unit_test(an_adaptive_render_has_the_same_bits_for_any_number_of_threads),
        cmocka_unit_test(an_adaptive_render_is_unbiased),
        cmocka_unit_test(every_failing_allocation_is_reported_and_leaves_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
