/* SPDX-License-Identifier: BSD-2-Clause */
/* first_light: a glimpse of all the picture before its first pass. A finished render has the bits that it has without;
 * one that must end within its first pass leaves a whole picture, in which each pixel is what it is in a finished pass
 * or like a glimpse within 7 rows and columns. (Where visibility is learned, a glimpse knows less than that pass.) */
#include "render/first_light.h"

#include "bis/base/clock.h"
#include "claim.h"
#include "stat.h"
#include "world.h"

#include <math.h>
#include <string.h>

enum { SIDE = 8 }; /* of the squares that have a pixel each in a glimpse */

/* The default learns, so the order of its rays counts: a glimpse must not teach it, nor look around a second time. */
static void make_learning(world *w)
{
    make_world(w, &bis_sir);
    w->desc.view.settings.proposal = BIS_PROPOSAL_PRODUCT;
    w->desc.view.settings.candidates = 64;
    w->desc.view.settings.learn = true;
}

static void a_finished_render_has_the_same_bits_and_counts(void **state)
{
    for (int i = -1; i < 0 || bis_integrators[i]; i++) {
        world w;
        bis_film plain, film;
        bis_render_result before, result;
        if (i < 0) make_learning(&w);
        else make_world(&w, bis_integrators[i]);
        w.desc.view.edge_samples = i % 2 ? 4 : 1;
        render(&plain, &before, &w, whole, &(bis_render_options){.budget = {.spp = 3}, .n_threads = 2});
        for (int threads = 1; threads <= 3; threads += 2) {
            render(&film, &result, &w, whole,
                   &(bis_render_options){.budget = {.spp = 3}, .n_threads = threads, .first_light = true});
            assert_same_bits(&film, &plain);
            assert_memory_equal(&result.counters, &before.counters, sizeof before.counters);
            assert_true(result.missing == 0 && !result.interrupted);
            bis_film_clear(&film);
        }
        bis_film_clear(&plain);
        clear_world(&w);
    }
}

static bool same_pixel(const bis_film *a, size_t i, const bis_film *b, size_t j)
{
    return memcmp(a->sum + 3 * i, b->sum + 3 * j, 3 * sizeof *a->sum) == 0 && a->hits[i] == b->hits[j];
}

/* The time is over before it began: nothing but the glimpse is there. What its pixels are, a finished pass says. Twin:
 * the other pixels of that pass are not like their glimpse. */
static void a_late_render_shows_its_glimpse(void **state)
{
    const double crops[][4] = {{0, 1, 0, 1}, {0.3, 0.9, 0.2, 0.7}, {0.5, 0.52, 0.5, 0.56}};
    world w;
    bis_film film, clean;
    bis_render_result result;
    make_world(&w, &bis_em);
    for (size_t c = 0; c < 3; c++) {
        size_t others = 0, missing = 0;
        render(&film, &result, &w, crops[c],
               &(bis_render_options){.budget = {.seconds = 1e-9}, .n_threads = 2, .first_light = true});
        render(&clean, &(bis_render_result){0}, &w, crops[c], &(bis_render_options){.budget = {.spp = 1}});
        for (int y = 0; y < film.height; y++) {
            for (int x = 0; x < film.width; x++) {
                const size_t i = (size_t)(y * film.width + x),
                             from = (size_t)(y / SIDE * SIDE * film.width + x / SIDE * SIDE);
                assert_true(same_pixel(&film, i, &clean, from));
                others += !same_pixel(&clean, i, &clean, from);
                missing += i != from;
            }
        }
        const double n = (double)film.width * film.height;
        assert_true(missing == 0 || others > 0);
        assert_true(fabs(result.missing - (double)missing / n) < 1e-12);
        assert_int_equal(result.passes, 1);
        assert_false(result.interrupted || result.error.is_known);
        bis_film_clear(&film);
        bis_film_clear(&clean);
    }
    clear_world(&w);
}

/* Rays of a look count, and those of a glimpse do not. A picture of 256 x 256 pixels has 5 squares of 128 pixels and
 * more, with 64 looks each at most; those of 32 and 64 pixels, and the tiles, wait until the glimpse is there. The
 * twin has no glimpse: it looks around in all squares first. */
static void a_late_render_has_looked_around_coarsely(void **state)
{
    uint64_t rays[2];
    world w;
    make_learning(&w);
    for (int k = 0; k < 2; k++) {
        const bis_render_options options = {.budget = {.seconds = 1e-9}, .n_threads = 2, .first_light = k == 0};
        bis_render_result result;
        bis_film film;
        assert_int_equal(bis_film_init(&film, 256, 256, whole, (bis_loc){0}, NULL), BIS_OK);
        assert_int_equal(bis_render(&result, &film, &w.scene, &w.desc.view, &options, NULL), BIS_OK);
        assert_true(k == 0 ? result.missing > 0.98 : result.missing == 0);
        rays[k] = result.counters.camera_rays;
        bis_film_clear(&film);
    }
    assert_in_range(rays[0], 5 * 4, 5 * 64);
    assert_true(rays[1] >= 256 * 256 + (5 + 16 + 64) * 4);
    clear_world(&w);
}

/* Twin of the promise: without first_light the first pass is completed. */
static void without_it_the_first_pass_is_complete(void **state)
{
    world w;
    bis_film film;
    bis_render_result result;
    make_world(&w, &bis_em);
    render(&film, &result, &w, whole, &(bis_render_options){.budget = {.seconds = 1e-9}});
    assert_true(result.missing == 0 && result.passes == 1);
    assert_int_equal(result.counters.camera_rays, WIDTH * HEIGHT);
    bis_film_clear(&film);
    clear_world(&w);
}

/* In the middle of the first pass, and before its glimpse is there. */
static void an_interrupted_first_pass_leaves_what_there_is(void **state)
{
    world w;
    bis_film film, clean;
    bis_render_result result;
    size_t own = 0;
    make_world(&w, &fused);
    set_fuse(-1);
    render(&clean, &result, &w, whole, &(bis_render_options){.budget = {.spp = 1}, .first_light = true});
    const long all = world_calls;
    for (int early = 0; early < 2; early++) {
        set_fuse(early ? 2 : all / 2);
        /* one sample is all that is asked for, and yet it is not done */
        render(&film, &result, &w, whole,
               &(bis_render_options){.budget = {.spp = 1}, .n_threads = 1, .interrupted = &world_flag,
                                     .first_light = true});
        assert_true(result.interrupted);
        assert_int_equal(result.passes, early ? 0 : 1);
        assert_true(early ? result.missing == 0 : result.missing > 0.1 && result.missing < 0.9);
        for (int i = 0; i < WIDTH * HEIGHT && !early; i++) {
            const int from = i / WIDTH / SIDE * SIDE * WIDTH + i % WIDTH / SIDE * SIDE;
            const bool is_own = same_pixel(&film, (size_t)i, &clean, (size_t)i);
            assert_true(is_own || same_pixel(&film, (size_t)i, &clean, (size_t)from));
            own += is_own;
        }
        bis_film_clear(&film);
    }
    assert_true(own > WIDTH * HEIGHT / 10);
    bis_film_clear(&clean);
    clear_world(&w);
}

/* The layer `samples` of a pixel that is missing is 0, and 1 elsewhere. */
static void the_layer_of_samples_tells_which_pixels_are_missing(void **state)
{
    world w;
    bis_film film;
    bis_render_result result;
    bis_channel channels[BIS_FILM_MAX_CHANNELS];
    float samples[WIDTH * HEIGHT];
    make_world(&w, &bis_em);
    render_layers(&film, &result, &w, whole, 1u << BIS_LAYER_SAMPLES,
        &(bis_render_options){.budget = {.seconds = 1e-9}, .first_light = true});
    assert_int_equal(bis_film_layers(&film, channels, NULL), 1);
    bis_film_layers(&film, channels, samples);
    assert_true(channels[0].data == samples && channels[0].stride == 1 && strcmp(channels[0].name, "samples.Y") == 0);
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        assert_true(samples[i] == (i % WIDTH % SIDE == 0 && i / WIDTH % SIDE == 0 ? 1 : 0));
    bis_film_clear(&film);
    clear_world(&w);
}

/* ---- the result so far ---- */

typedef struct seen {
    const bis_film *film;
    uint64_t spp[8];
    int n;
    bool is_right;
} seen;

static void note(const bis_render_result *result, void *user)
{
    seen *s = user;
    s->is_right &= s->film->passes == result->passes && s->film->weight == (double)result->spp &&
                   result->counters.camera_rays == result->spp * WIDTH * HEIGHT && result->missing == 0;
    if (s->n < 8) s->spp[s->n] = result->spp;
    s->n++;
}

/* Passes of 1, 1, 2, 4, 4. The error that is told on the way changes nothing: the same bits, the same last figure. */
static void the_result_so_far_is_told_between_passes(void **state)
{
    const uint64_t expected[] = {1, 2, 4, 8, 12};
    world w;
    bis_film film, plain;
    bis_render_result result, before;
    seen s = {.film = &film, .is_right = true};
    make_world(&w, &bis_em);
    render(&plain, &before, &w, whole, &(bis_render_options){.budget = {.spp = 12}});
    render(&film, &result, &w, whole, &(bis_render_options){.budget = {.spp = 12}, .so_far = note, .user = &s});
    assert_int_equal(s.n, 5);
    for (int i = 0; i < 5; i++) assert_int_equal(s.spp[i], expected[i]);
    assert_true(s.is_right);
    assert_same_bits(&film, &plain);
    assert_true(result.error.relative_rmse == before.error.relative_rmse);
    bis_film_clear(&film);
    s.n = 0;
    const double every = 0.2, began = bis_clock_now();
    render(&film, &result, &w, whole, /* the twin: not again before an interval has passed */
           &(bis_render_options){.budget = {.spp = 12}, .so_far = note, .every = every, .user = &s});
    assert_true(s.n * every <= bis_clock_now() - began);
    bis_film_clear(&film);
    bis_film_clear(&plain);
    clear_world(&w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_finished_render_has_the_same_bits_and_counts),
        cmocka_unit_test(a_late_render_shows_its_glimpse),
        cmocka_unit_test(a_late_render_has_looked_around_coarsely),
        cmocka_unit_test(without_it_the_first_pass_is_complete),
        cmocka_unit_test(an_interrupted_first_pass_leaves_what_there_is),
        cmocka_unit_test(the_layer_of_samples_tells_which_pixels_are_missing),
        cmocka_unit_test(the_result_so_far_is_told_between_passes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
