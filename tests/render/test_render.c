/* SPDX-License-Identifier: BSD-2-Clause */
/* render: the same bits for any number of threads, any crop, any moment of interruption; budgets; what escaped rays
 * see. The integrators of the library take part in the first test, elsewhere one of our own that does exactly what the
 * test needs. */
#include "bis/base/clock.h"
#include "bis/base/hash.h"
#include "bis/base/mem.h"
#include "bis/beyond/pool.h"
#include "bis/thesis/phong.h"
#include "bis/scene/light_load.h"
#include "render/checkpoint.h"

#include "claim.h"
#include "program.h"
#include "stat.h"
#include "world.h"

#include <dlfcn.h>
#include <limits.h>
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define DIR_NAME "build/test_render"
#define STATE DIR_NAME "/state"

/* ---- same bits ---- */

static void any_number_of_threads_gives_the_same_bits_and_counts(void **state)
{
    const bis_sampler_kind kinds[] = {
        BIS_SAMPLER_RANDOM, BIS_SAMPLER_STRATIFIED, BIS_SAMPLER_SOBOL, BIS_SAMPLER_HALTON};
    const int threads[] = {1, 2, 3, 7};
    for (int i = 0; bis_integrators[i]; i++) {
        world w;
        make_world(&w, bis_integrators[i]);
        w.desc.view.sampler.kind = kinds[i % 4];
        bis_film first = {0};
        bis_render_result one;
        for (int t = 0; t < 4; t++) {
            const bis_render_options options = {.budget = {.spp = 2}, .n_threads = threads[t]};
            bis_film film;
            bis_render_result result;
            render(&film, &result, &w, whole, &options);
#ifdef _OPENMP
            assert_int_equal(result.n_threads, threads[t]);
#endif
            if (t == 0) {
                first = film;
                one = result;
                continue;
            }
            assert_same_bits(&film, &first);
            assert_memory_equal(&result.counters, &one.counters, sizeof one.counters);
            bis_film_clear(&film);
        }
        bis_film_clear(&first);
        clear_world(&w);
    }
}

static void assert_part_of(const bis_film *part, const bis_film *full)
{
    for (int y = 0; y < part->height; y++) {
        const size_t there = (size_t)(y + part->y0) * WIDTH + (size_t)part->x0, here = (size_t)(y * part->width);
        assert_memory_equal(part->sum + 3 * here, full->sum + 3 * there, 3 * (size_t)part->width * sizeof *part->sum);
        assert_memory_equal(
            part->deviation + 3 * here, full->deviation + 3 * there, 3 * (size_t)part->width * sizeof *part->deviation);
        assert_memory_equal(part->hits + here, full->hits + there, (size_t)part->width * sizeof *part->hits);
    }
    for (bis_twin t = {0}, of_full = {0}; part->twin && bis_film_next_twin(part, bis_film_crop(part), &t);) {
        while (bis_film_next_twin(full, bis_film_crop(full), &of_full))
            if (of_full.x == t.x && of_full.y == t.y) break;
        assert_memory_equal(part->twin + BIS_TWIN_VALUES * t.at, full->twin + BIS_TWIN_VALUES * of_full.at,
            BIS_TWIN_VALUES * sizeof *part->twin);
    }
}

/* Pixels [x0, x1) x [y0, y1). */
static void render_part(
    bis_film *film, bis_render_result *result, const world *w, const int at[4], const bis_render_options *options)
{
    const int side[4] = {WIDTH, WIDTH, HEIGHT, HEIGHT};
    double crop[4];
    for (int i = 0; i < 4; i++)
        crop[i] = at[i] == 0 || at[i] == side[i] ? at[i] / side[i] : (at[i] - 0.5) / side[i]; /* rounded up */
    render(film, result, w, crop, options);
    assert_true(
        film->x0 == at[0] && film->x0 + film->width == at[1] && film->y0 == at[2] && film->y0 + film->height == at[3]);
}

/* Along tiles of 16 pixels and across them, single pixels, at each border. */
static const int parts[][4] = {{11, 30, 5, 19}, {16, 32, 0, 16}, {0, 16, 16, 21}, {17, 18, 9, 10}, {36, 37, 20, 21},
    {0, 1, 0, 21}, {30, 37, 0, 3}, {0, 37, 15, 17}};

static void assert_crops_are_parts(world *w, uint32_t spp)
{
    const int threads[] = {1, 2, 3, 7};
    bis_film full, part;
    bis_render_result result;

    render(&full, &result, w, whole, &(bis_render_options){.budget = {.spp = spp}});
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        render_part(
            &part, &result, w, parts[i], &(bis_render_options){.budget = {.spp = spp}, .n_threads = threads[i % 4]});
        assert_part_of(&part, &full);
        bis_film_clear(&part);
    }
    bis_film_clear(&full);
}

static void a_crop_holds_the_same_bits_as_the_full_picture(void **state)
{
    for (int i = 0; bis_integrators[i]; i++) {
        world w;
        make_world(&w, bis_integrators[i]);
        w.desc.view.edge_samples = 1 + (uint32_t)i % 2 * 3;
        assert_crops_are_parts(&w, 3);
        clear_world(&w);
    }
}

/* Where nothing is learned, also where all pixels of a pass share directions (the product's). Independent passes have
 * no twins. The twin of this test: with its own seed the bits differ. */
static void a_twin_is_its_pixel_in_a_render_with_another_seed(void **state)
{
    const uint64_t seed = 7, other = bis_hash(seed ^ 0x7477696e); /* "twin" */
    for (int k = 0; k < 4; k++) {
        const bool product = k >= 2;
        world w;
        bis_film film, another;
        bis_render_result result;
        int n = 0, as_own = 0;
        make_world(&w, product ? &bis_sir : &bis_mis);
        w.desc.view.settings.proposal = product ? BIS_PROPOSAL_PRODUCT : BIS_PROPOSAL_MIX;
        w.desc.view.settings.candidates = 64;
        w.desc.view.edge_samples = k % 2 ? 4 : 1;
        w.desc.view.sampler.seed = seed;
        render(&film, &result, &w, whole, &(bis_render_options){.budget = {.spp = 6}});
        w.desc.view.sampler.seed = other;
        render(&another, &result, &w, whole, &(bis_render_options){.budget = {.spp = 6}});
        for (bis_twin t = {0}; bis_film_next_twin(&film, bis_film_crop(&film), &t); n++) {
            const size_t i = 3 * ((size_t)t.y * WIDTH + (size_t)t.x), bytes = 3 * sizeof *film.sum;
            assert_memory_equal(film.twin + BIS_TWIN_VALUES * t.at, another.sum + i, bytes);
            as_own += memcmp(film.twin + BIS_TWIN_VALUES * t.at, film.sum + i, bytes) == 0;
        }
        assert_true(n > 20 && as_own < n / 2); /* pixels of a constant sky are alike */
        bis_film_clear(&film);
        bis_film_clear(&another);
        w.desc.view.sampler.kind = BIS_SAMPLER_RANDOM;
        render(&film, &result, &w, whole, &(bis_render_options){.budget = {.spp = 6}});
        assert_null(film.twin);
        bis_film_clear(&film);
        clear_world(&w);
    }
}

/* What a tile has learned comes from all its pixels, those beside the crop as well. Twin: without `learn` other bits.
 */
static void a_crop_of_a_picture_that_learns_holds_its_bits(void **state)
{
    for (uint32_t edge_samples = 1; edge_samples <= 4; edge_samples += 3) {
        world w;
        bis_film learned, plain;
        bis_render_result result;
        make_world(&w, &bis_sir);
        w.desc.view.settings.proposal = BIS_PROPOSAL_PRODUCT;
        w.desc.view.settings.candidates = 64;
        w.desc.view.edge_samples = edge_samples;
        for (int learn = 0; learn < 2; learn++) {
            w.desc.view.settings.learn = learn;
            assert_crops_are_parts(&w, 6);
            render(learn ? &learned : &plain, &result, &w, whole, &(bis_render_options){.budget = {.spp = 6}});
        }
        assert_memory_not_equal(learned.sum, plain.sum, 3 * WIDTH * HEIGHT * sizeof *plain.sum);
        bis_film_clear(&learned);
        bis_film_clear(&plain);
        clear_world(&w);
    }
}

/* Of each k x k pixels the one in the middle, with edge samples and in a crop as well. */
static void a_thin_film_holds_the_bits_of_its_pixels_in_the_picture(void **state)
{
    const double crops[2][4] = {{0, 1, 0, 1}, {0.3, 0.9, 0.2, 0.7}};
    for (int i = 0; i < 12; i++) {
        const int k = 2 + i % 4;
        const bis_render_options options = {.budget = {.spp = 3}, .n_threads = 1 + i % 3};
        world w;
        bis_film all, some;
        bis_render_result result;
        int met = 0;
        make_world(&w, i % 2 ? &bis_sir : &bis_mis);
        w.desc.view.edge_samples = i < 6 ? 1 : 4;
        render(&all, &result, &w, crops[i % 2], &options);
        assert_int_equal(bis_film_init_thin(&some, WIDTH, HEIGHT, crops[i % 2], k, (bis_loc){0}, NULL), BIS_OK);
        assert_int_equal(bis_render(&result, &some, &w.scene, &w.desc.view, &options, NULL), BIS_OK);
        for (int y = 0; y < all.height; y++) {
            for (int x = 0; x < all.width; x++) {
                if ((all.x0 + x) % k != k / 2 || (all.y0 + y) % k != k / 2) continue;
                const size_t there = (size_t)(y * all.width + x), here = (size_t)met++;
                assert_memory_equal(some.sum + 3 * here, all.sum + 3 * there, 3 * sizeof *all.sum);
                assert_memory_equal(some.deviation + 3 * here, all.deviation + 3 * there, 3 * sizeof *all.deviation);
            }
        }
        assert_int_equal(met, some.width * some.height);
        bis_film_clear(&all);
        bis_film_clear(&some);
        clear_world(&w);
    }
    bis_film none;
    assert_int_equal(
        bis_film_init_thin(&none, WIDTH, HEIGHT, (double[4]){0, 0.02, 0, 1}, 5, (bis_loc){0}, NULL), BIS_INPUT);
}

/* Each pass is a function of its number: 8 camera samples (passes of 1, 1, 2, 4) are 4 and then one pass more. */
static void more_passes_begin_with_the_same_passes(void **state)
{
    world w;
    make_world(&w, &noise);
    bis_film four, eight;
    bis_render_result result;
    bis_sampler_set_spp(&w.desc.view.sampler, 64); /* within one set of cells */
    render(&four, &result, &w, whole, &(bis_render_options){.budget = {.spp = 4}});
    render(&eight, &result, &w, whole, &(bis_render_options){.budget = {.spp = 8}});
    for (size_t i = 0; i < 3 * WIDTH * HEIGHT; i++) {
        /* the last pass, of weight 4, is what the sums have grown by */
        const double L = (eight.sum[i] - four.sum[i]) / 4, mean = four.sum[i] / 4, old = (double)four.deviation[i];
        /* two halves: their mean squares, of which the second is 0, and a quarter of the square of what parts them */
        const double expected = sqrt(old * old / 2 + (L - mean) * (L - mean) / 4);
        assert_true(L >= 0 && fabs((double)eight.deviation[i] - expected) <= 0x1p-22 * expected);
        assert_true(eight.half[i] == (float)mean);
    }
    bis_film_clear(&four);
    bis_film_clear(&eight);
    clear_world(&w);
}

static void another_seed_gives_other_noise(void **state)
{
    world w;
    make_world(&w, &noise);
    bis_film a, b;
    bis_render_result result;
    render(&a, &result, &w, whole, &(bis_render_options){.budget = {.spp = 1}});
    w.desc.view.sampler.seed = 2;
    render(&b, &result, &w, whole, &(bis_render_options){.budget = {.spp = 1}});
    int equal = 0, hit = 0;
    for (size_t i = 0; i < WIDTH * HEIGHT; i++) {
        hit += a.hits[i] > 0 && b.hits[i] > 0;
        equal += a.hits[i] > 0 && b.hits[i] > 0 && a.sum[3 * i] == b.sum[3 * i];
    }
    assert_true(hit > 300);
    assert_int_equal(equal, 0); /* floats of 24 bits: 777 pixels share one by chance in 4.6e-5 of all seeds */
    bis_film_clear(&a);
    bis_film_clear(&b);
    clear_world(&w);
}

/* ---- interruption ---- */

static void an_interrupted_render_holds_its_complete_passes_and_nothing_else_E39(void **state)
{
    world w;
    make_world(&w, &fused);
    bis_film film, clean;
    bis_render_result result, whole_pass;
    set_fuse(-1);
    render(&clean, &whole_pass, &w, whole, &(bis_render_options){.budget = {.spp = 1}});
    long per_pass = world_calls; /* about: jitter decides at the silhouettes */
    bis_film_clear(&clean);
    for (int threads = 1; threads <= 3; threads += 2) {
        for (int part = 0; part < 4; part++) {
            set_fuse((1 + part) * (per_pass + per_pass / 4)); /* in the middle of the second pass and of later ones */
            const bis_render_options options = {
                .budget = {.spp = 100}, .n_threads = threads, .interrupted = &world_flag};
            render(&film, &result, &w, whole, &options);
            assert_true(result.interrupted);
            assert_true(result.passes >= 1 && result.passes < 8);
            assert_int_equal(film.passes, result.passes);
            assert_int_equal(result.counters.camera_rays, result.spp * WIDTH * HEIGHT);
            set_fuse(-1);
            render(&clean, &whole_pass, &w, whole, &(bis_render_options){.budget = {.spp = (uint32_t)result.spp}});
            assert_same_bits(&film, &clean);
            bis_film_clear(&clean);
            /* twin: the pass under way, too; were any of it kept, the bits would be those of neither */
            render(&clean, &whole_pass, &w, whole, &(bis_render_options){.budget = {.spp = (uint32_t)result.spp + 1}});
            assert_memory_not_equal(film.sum, clean.sum, 3 * WIDTH * HEIGHT * sizeof *film.sum);
            bis_film_clear(&film);
            bis_film_clear(&clean);
        }
    }
    clear_world(&w);
}

static void tell_nothing(const bis_render_result *result, void *user) { fail_msg("%d passes", (int)result->passes); }

static void an_interrupted_first_pass_leaves_nothing(void **state)
{
    world w;
    bis_checkpoint c = {.path = STATE};
    program_folder(DIR_NAME);
    make_world(&w, &fused);
    bis_film film;
    bis_render_result result;
    set_fuse(100);
    render(
        &film, &result, &w, whole,
        &(bis_render_options){.budget = {.spp = 9}, .n_threads = 2, .interrupted = &world_flag, .checkpoint = &c,
                              .so_far = tell_nothing});
    assert_false(program_exists(STATE));
    assert_true(result.interrupted);
    assert_int_equal(result.passes, 0);
    assert_int_equal(film.passes, 0);
    assert_int_equal(result.counters.camera_rays, 0);
    for (size_t i = 0; i < 3 * WIDTH * HEIGHT; i++) assert_true(film.sum[i] == 0);
    bis_film_clear(&film);
    clear_world(&w);
}

/* ---- budgets ---- */

static void note_total(const bis_progress *p, void *user) { *(uint32_t *)user = p->passes_total; }

/* 1, 1, 2, then 4, and the last pass takes what is left. */
static void spp_is_the_number_of_camera_rays_in_growing_passes(void **state)
{
    static const struct {
        uint32_t asked, pass_size;
        int passes;
        double half; /* samples up to the last doubling, after which half as many still come */
    } cases[] = {{1, 0, 1, 0}, {2, 0, 2, 1}, {3, 0, 3, 2},  {4, 0, 3, 2}, {5, 0, 4, 2}, {7, 0, 4, 4},
                 {8, 0, 4, 4}, {9, 0, 5, 4}, {16, 0, 6, 8}, {7, 1, 7, 4}, {7, 3, 3, 3}, {0, 0, 6, 8},
                 {13, 5, 3, 5}, {10, 5, 2, 5}};
    world w;
    make_world(&w, &noise);
    bis_sampler_set_spp(&w.desc.view.sampler, 16); /* no budget at all: the scene's */
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bis_film film;
        bis_render_result result;
        uint32_t total = 0;
        const bis_render_options options = {.budget = {.spp = cases[i].asked}, .pass_size = cases[i].pass_size,
                                            .progress = note_total, .user = &total};
        const uint32_t spp = cases[i].asked ? cases[i].asked : 16;
        render(&film, &result, &w, whole, &options);
        assert_int_equal(film.passes, cases[i].passes);
        assert_int_equal(total, cases[i].passes);
        assert_int_equal(result.passes, cases[i].passes);
        assert_int_equal(result.spp, spp);
        assert_true(film.weight == spp && film.half_weight == cases[i].half);
        assert_int_equal(result.counters.camera_rays, spp * WIDTH * HEIGHT);
        assert_false(result.interrupted);
        bis_film_clear(&film);
    }
    clear_world(&w);
}

static void the_shortest_time_still_completes_one_pass_E39(void **state)
{
    world w;
    make_world(&w, &noise);
    bis_film film;
    bis_render_result result;
    render(&film, &result, &w, whole, &(bis_render_options){.budget = {.seconds = 1e-9}});
    assert_int_equal(result.passes, 1);
    assert_false(result.interrupted);
    bis_film_clear(&film);
    clear_world(&w);
}

static void an_error_budget_ends_when_the_bound_holds_and_not_before(void **state)
{
    world w;
    make_world(&w, &noise);
    w.desc.view.pixel_jitter = false;
    bis_film film, shorter;
    bis_render_result result, other;
    const double error = 0.02;
    double upper, upper_shorter;
    stat_keep_seeds(true); /* the bound of a shorter render may by chance hold, too */
    render(&film, &result, &w, whole, &(bis_render_options){.budget = {.error = error}});
    upper = bis_film_estimate_error(&film).upper;
    assert_true(upper <= error);
    assert_true(result.passes > 20);
    /* Checks grow apart by a twentieth: with 10% fewer passes the bound did not hold. */
    const uint32_t fewer = (uint32_t)result.spp - 4 * (result.passes / 10 + 1);
    render(&shorter, &other, &w, whole, &(bis_render_options){.budget = {.spp = fewer}}); /* the same passes */
    upper_shorter = bis_film_estimate_error(&shorter).upper;
    assert_true(upper_shorter > error);
    stat_keep_seeds(false);
    bis_film_clear(&film);
    bis_film_clear(&shorter);
    clear_world(&w);
}

static void an_error_budget_takes_three_passes_at_least_and_spp_at_most(void **state)
{
    world w;
    make_world(&w, &place);
    w.desc.view.pixel_jitter = false; /* no scatter at all: the estimate is 0 from the second pass on */
    bis_film film;
    bis_render_result result;
    render(&film, &result, &w, whole, &(bis_render_options){.budget = {.error = 0.1}});
    assert_int_equal(result.passes, 3);
    bis_film_clear(&film);
    w.desc.view.settings = bis_settings_default(&noise);
    render(&film, &result, &w, whole, &(bis_render_options){.budget = {.error = 1e-6, .spp = 17}});
    assert_int_equal(result.spp, 17);
    assert_int_equal(result.passes, 7); /* 1, 1, 2, 4, 4, 4, 1 */
    bis_film_clear(&film);
    clear_world(&w);
}

typedef struct progress_log {
    int n;
    double last_share, began, last_seconds;
    bool in_order;
} progress_log;

/* The render has begun after this program looked at the clock, so it has taken no longer than from then to now. */
static void log_progress(const bis_progress *p, void *user)
{
    progress_log *log = user;
    log->in_order = (log->n == 0 || log->in_order) && p->share >= log->last_share && p->share <= 1 &&
                    p->passes_done <= p->passes_total && p->seconds > log->last_seconds &&
                    p->seconds <= bis_clock_now() - log->began;
    log->last_share = p->share;
    log->last_seconds = p->seconds;
    log->n++;
}

static void progress_grows_to_the_whole_budget(void **state)
{
    world w;
    make_world(&w, &bis_exact);
    bis_film film;
    bis_render_result result;
    progress_log log = {.began = bis_clock_now()};
    render(
        &film, &result, &w, whole, &(bis_render_options){.budget = {.spp = 3}, .progress = log_progress, .user = &log});
    assert_true(log.n >= 1 && log.in_order && log.last_share == 1);
    assert_true(log.n <= 1 + (bis_clock_now() - log.began) / 0.2); /* the last, and five a second */
    assert_true(result.seconds > 0 && result.seconds <= bis_clock_now() - log.began);
    bis_film_clear(&film);
    clear_world(&w);
}

/* ---- time ---- */

/* This program's own clock, which the library reads: while it is set, it stands, and goes on where something takes its
 * time. In nanoseconds. */
static struct {
    atomic_bool is_set;
    atomic_llong now;
} watch;

int clock_gettime(clockid_t of, struct timespec *t)
{
    static int (*real)(clockid_t, struct timespec *);
    if (!real) *(void **)&real = dlsym(RTLD_NEXT, "clock_gettime");
    if (!watch.is_set || of != CLOCK_MONOTONIC) return real(of, t);
    const long long now = watch.now;
    *t = (struct timespec){now / 1000000000, now % 1000000000};
    return 0;
}

static void pass_time(double seconds) { watch.now += llround(1e9 * seconds); }

/* Seconds since the clock was set. */
static double elapsed(void) { return (double)(watch.now - 1000000000000) / 1e9; }

/* As noise, but the next n_ticks camera samples that meet a surface take `tick` seconds each. */
static double tick;
static int n_ticks;

static rgb ticking_Lo(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch)
{
    if (n_ticks-- > 0) pass_time(tick);
    return noise_Lo(s, pt, stream, scratch);
}

static const bis_integrator ticking = {
    .name = "ticking", .light_needs = no_light_needs, .scratch_needs = no_scratch, .Lo = ticking_Lo};

enum { FOR_EVER = INT_MAX };

static void set_watch(double seconds, int n)
{
    tick = seconds;
    n_ticks = n;
    watch.now = 1000000000000; /* 1000 s */
    watch.is_set = true;
}

/* Independent samples, so that no pixel is rendered twice. */
static void make_ticking(world *w, double seconds, int n)
{
    make_world(w, &ticking);
    w->desc.view.sampler.kind = BIS_SAMPLER_RANDOM;
    set_watch(seconds, n);
}

static void clear_ticking(world *w)
{
    watch.is_set = false;
    clear_world(w);
}

/* A pixel of the ball; and the lowest row, which sees the floor everywhere: tiles of 16, 16 and 5 pixels. */
static const int one_pixel[4] = {18, 19, 10, 11}, one_row[4] = {0, 37, 20, 21};

/* An accelerator whose first ray takes its time. */
typedef struct tired {
    bis_accel accel;
    const bis_accel *right;
    double rest; /* seconds */
} tired;

static bool tired_intersect(const bis_accel *a, const ray *r, bis_hit *hit)
{
    tired *t = (tired *)a;

    pass_time(t->rest);
    t->rest = 0;
    return bis_accel_intersect(t->right, r, hit);
}

static bool tired_occluded(const bis_accel *a, const ray *r)
{
    return bis_accel_occluded(((const tired *)a)->right, r);
}

/* One pixel, 10 s a sample. One pass always comes, and then as many samples as the time has room for, or as were asked
 * for. The search for outlines is done once: it takes its time, but does not make passes dearer. */
static void time_is_used_up_and_not_exceeded(void **state)
{
    static const bis_accel_ops ops = {.name = "tired", .intersect = tired_intersect, .occluded = tired_occluded};

    for (int seconds = 5; seconds < 200; seconds += 7)
        for (int k = 0; k < 3; k++) {
            const uint32_t most = k == 1 ? 7 : 0;
            const double search = k == 2 ? 100 : 0, room = fmax(1, floor((seconds - search) / 10));
            const bis_render_options options = {.budget = {.spp = most, .seconds = seconds}, .n_threads = 1};
            world w;
            bis_film film;
            bis_render_result result;
            make_ticking(&w, 10, FOR_EVER);
            tired slow = {{&ops, &w.scene.geometry}, w.scene.accel, search};
            w.scene.accel = &slow.accel;
            w.desc.view.edge_samples = search > 0 ? 2 : 1;
            render_part(&film, &result, &w, one_pixel, &options);
            assert_true(film.hits[0] == (float)result.spp && !result.interrupted && slow.rest == 0);
            if ((double)result.spp != (most > 0 ? fmin(most, room) : room))
                fail_msg("%d s, %g s for outlines: %d samples", seconds, search, (int)result.spp);
            assert_true(fabs(result.seconds - search - 10 * (double)result.spp) < 1e-6);
            w.scene.accel = (bis_accel *)slow.right;
            bis_film_clear(&film);
            clear_ticking(&w);
        }
}

/* What was told, in its order. */
typedef struct telling {
    const bis_film *film;
    int n;
    bis_progress reports[16];
    double at[16];          /* seconds, of what was told n times */
    uint64_t spp[16];
    double most[16];        /* of the film */
    int n_forecasts;
    bis_forecast forecast;
    double share;           /* of the first report after it */
    const char *path;       /* of a checkpoint */
    uint64_t kept[16];      /* camera samples in it */
    double seconds;         /* in it */
    uint32_t interrupts;    /* after this pass; 0: never */
} telling;

static void note_report(const bis_progress *p, void *user)
{
    telling *t = user;
    assert_true(t->n < 16);
    t->at[t->n] = elapsed();
    t->reports[t->n++] = *p;
}

/* One row in three passes of one sample of 1 s: 111 s. What is left follows from what was taken and from the share that
 * is done, which is that of the samples, or that of the seconds if it is larger. */
static void reports_say_what_is_done_and_what_is_left(void **state)
{
    static const bis_budget budgets[] = {{.spp = 3}, {.spp = 3, .seconds = 130}, {.seconds = 80}};

    for (size_t i = 0; i < sizeof budgets / sizeof *budgets; i++) {
        telling t = {0};
        const bis_render_options options = {.budget = budgets[i], .n_threads = 1, .progress = note_report, .user = &t};
        world w;
        bis_film film;
        bis_render_result result;
        make_ticking(&w, 1, FOR_EVER);
        render_part(&film, &result, &w, one_row, &options);
        assert_true(t.n >= 3 && t.reports[t.n - 1].passes_done == result.passes);
        for (int k = 0; k < t.n; k++) {
            const bis_progress *p = &t.reports[k];
            const double by_spp = budgets[i].spp ? p->seconds / 111 : 0,
                         share = budgets[i].seconds > 0 ? fmax(by_spp, p->seconds / budgets[i].seconds) : by_spp;
            assert_true(fabs(t.at[k] - p->seconds) < 1e-6 && p->passes_total == budgets[i].spp);
            assert_true(fabs(p->share - fmin(1, share)) < 0.08); /* tiles, and the last of 5 pixels, count alike */
            assert_true(fabs(p->seconds_left - p->seconds * (1 - p->share) / p->share) < 1e-5);
        }
        bis_film_clear(&film);
        clear_ticking(&w);
    }
}

static uint64_t kept_samples(const char *path, double *seconds)
{
    bis_checkpoint c = {0};
    uint64_t spp;
    if (access(path, F_OK)) return 0;
    assert_int_equal(bis_checkpoint_read(&c, path, NULL), BIS_OK);
    memcpy(&spp, c.data + c.at, sizeof spp); /* the state begins with camera samples and seconds */
    memcpy(seconds, c.data + c.at + sizeof spp, sizeof *seconds);
    bis_checkpoint_clear(&c);
    return spp;
}

static void note_result(const bis_render_result *result, void *user)
{
    telling *t = user;
    assert_true(t->n < 16);
    assert_true(fabs(result->seconds - elapsed()) < 1e-6 && result->passes == t->film->passes);
    assert_int_equal(result->n_threads, 1);
    assert_true(result->bytes > 0 && !result->interrupted);
    t->at[t->n] = elapsed();
    t->most[t->n] = t->film->most;
    if (t->path) t->kept[t->n] = kept_samples(t->path, &t->seconds);
    t->spp[t->n++] = result->spp;
}

/* One pixel, 10 s a sample: passes end after 10, 20, 40, 80 and 120 s. */
static void the_result_so_far_is_told_once_in_an_interval(void **state)
{
    static const struct {
        double every;
        int n;
        uint64_t spp[5];
    } cases[] = {
        {0, 5, {1, 2, 4, 8, 12}}, {10, 5, {1, 2, 4, 8, 12}}, {20, 4, {2, 4, 8, 12}}, {21, 3, {4, 8, 12}},
        {40, 3, {4, 8, 12}},      {41, 1, {8}},              {80, 1, {8}},           {121, 0, {0}},
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        world w;
        bis_film film;
        bis_render_result result;
        telling t = {.film = &film};
        make_ticking(&w, 10, FOR_EVER);
        render_part(&film, &result, &w, one_pixel,
                    &(bis_render_options){.budget = {.spp = 12}, .n_threads = 1, .so_far = note_result,
                                          .every = cases[i].every, .user = &t});
        assert_int_equal(t.n, cases[i].n);
        for (int k = 0; k < t.n; k++) {
            assert_int_equal(t.spp[k], cases[i].spp[k]);
            assert_true(t.at[k] == 10 * (double)t.spp[k]);
        }
        bis_film_clear(&film);
        clear_ticking(&w);
    }
}

/* The same pixel, and the checkpoint as it is after each pass: one is written before a pass if the interval has passed
 * since the last one, or if the pass is smaller than its place demands, and after a whole last pass. */
static void a_checkpoint_is_kept_once_in_an_interval(void **state)
{
    static const struct {
        uint32_t spp;
        double every;
        uint64_t kept[6]; /* the last one: at the end */
    } cases[] = {
        {12, 0, {0, 1, 2, 4, 8, 12}},  {12, 10, {0, 1, 2, 4, 8, 12}}, {12, 20, {0, 0, 2, 4, 8, 12}},
        {12, 21, {0, 0, 0, 4, 8, 12}}, {12, 40, {0, 0, 0, 4, 8, 12}}, {12, 41, {0, 0, 0, 0, 8, 12}},
        {12, 80, {0, 0, 0, 0, 8, 12}}, {12, 81, {0, 0, 0, 0, 0, 12}}, {11, 1e9, {0, 0, 0, 0, 8, 8}},
    };

    program_folder(DIR_NAME);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bis_checkpoint c = {.path = STATE, .every = cases[i].every};
        world w;
        bis_film film;
        bis_render_result result;
        telling t = {.film = &film, .path = STATE};
        unlink(STATE);
        make_ticking(&w, 10, FOR_EVER);
        render_part(&film, &result, &w, one_pixel,
                    &(bis_render_options){.budget = {.spp = cases[i].spp}, .n_threads = 1, .so_far = note_result,
                                          .user = &t, .checkpoint = &c});
        assert_int_equal(t.n, 5);
        for (int k = 0; k < 5; k++) assert_int_equal(t.kept[k], cases[i].kept[k]);
        assert_int_equal(kept_samples(STATE, &t.seconds), cases[i].kept[5]);
        assert_true(t.seconds == 10 * (double)(cases[i].spp == 11 ? 8 : 12)); /* the others ended when it was kept */
        bis_film_clear(&film);
        clear_ticking(&w);
    }
}

/* 4 samples of 10 s, then 20 s a sample of 165 s in all: a pass has room in 125 s at 10 s, 4 samples; then 45 s are
 * left, which are two samples at the 20 s of this process, and would be three at the mean of both. */
static void a_later_process_knows_the_seconds_and_finds_its_own_speed(void **state)
{
    world w;
    bis_film film;
    bis_render_result result;
    bis_checkpoint c = {.path = STATE, .every = 1e9};
    program_folder(DIR_NAME);
    make_ticking(&w, 10, FOR_EVER);
    render_part(&film, &result, &w, one_pixel,
                &(bis_render_options){.budget = {.spp = 4}, .n_threads = 1, .checkpoint = &c});
    bis_film_clear(&film);
    telling t = {.film = &film};
    c = (bis_checkpoint){.every = 1e9};
    assert_int_equal(bis_checkpoint_read(&c, STATE, NULL), BIS_OK);
    set_watch(20, FOR_EVER);
    render_part(&film, &result, &w, one_pixel,
                &(bis_render_options){.budget = {.seconds = 165}, .n_threads = 1, .checkpoint = &c,
                                      .progress = note_report, .user = &t});
    assert_int_equal(result.spp, 10);
    assert_int_equal(result.passes, 5);
    assert_true(fabs(result.seconds - 160) < 1e-6);
    assert_int_equal(t.n, 3); /* two passes of a tile, and the end */
    for (int k = 0; k < 3; k++) assert_true(fabs(t.reports[k].seconds - (k == 0 ? 120 : 160)) < 1e-6);
    bis_film_clear(&film);

    /* a time that is over allows none */
    assert_int_equal(bis_checkpoint_read(&c, STATE, NULL), BIS_OK);
    set_watch(20, FOR_EVER);
    render_part(&film, &result, &w, one_pixel,
                &(bis_render_options){.budget = {.seconds = 49}, .n_threads = 1, .checkpoint = &c});
    assert_int_equal(result.spp, 4);
    assert_true(fabs(result.seconds - 40) < 1e-6);
    bis_film_clear(&film);
    clear_ticking(&w);
}

/* The same row, 1 s a sample: the glimpse is there after 5 s, and tiles of 16 and 16 pixels end after 21 and 37 s. None
 * begins when the time is over; those that have not begun miss all but every 8th pixel. */
static void the_first_pass_ends_with_the_time(void **state)
{
    static const struct {
        double seconds;
        int missing;
    } cases[] = {{5, 32}, {6, 18}, {21, 18}, {22, 4}, {37, 4}, {38, 0}};

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        world w;
        bis_film film;
        bis_render_result result;
        make_ticking(&w, 1, FOR_EVER);
        render_part(&film, &result, &w, one_row,
                    &(bis_render_options){.budget = {.seconds = cases[i].seconds}, .n_threads = 1,
                                          .first_light = true});
        assert_true(fabs(result.missing - cases[i].missing / 37.0) < 1e-12);
        assert_true(result.passes == 1 && result.spp == 1 && !result.interrupted);
        bis_film_clear(&film);
        clear_ticking(&w);
    }
}

static void note_forecast(const bis_forecast *f, void *user)
{
    telling *t = user;
    t->n_forecasts++;
    t->forecast = *f;
    t->share = -1;
    t->at[0] = elapsed();
    t->spp[0] = (uint64_t)t->film->weight;
    assert_true(f->error == bis_film_estimate_error(t->film).upper);
}

static void note_share(const bis_progress *p, void *user)
{
    telling *t = user;
    if (t->share < 0) t->share = p->share;
}

/* The row, 1 s a sample. An error falls with the root of the samples, so that both samples and seconds grow with the
 * square of the errors; and of an error budget so much is used as that square says. */
static void a_forecast_is_the_square_of_the_errors_times_what_was_taken(void **state)
{
    const double error = 0.05;
    world w;
    bis_film film;
    bis_render_result result;
    telling t = {.film = &film};
    make_ticking(&w, 1, FOR_EVER);
    render_part(&film, &result, &w, one_row,
                &(bis_render_options){.budget = {.error = error}, .n_threads = 1, .forecast = note_forecast,
                                      .progress = note_share, .user = &t});
    const double factor = t.forecast.error * t.forecast.error / (error * error);
    assert_int_equal(t.n_forecasts, 1);
    assert_true(factor > 1 && t.at[0] == 37 * (double)t.spp[0]);
    assert_true(fabs(t.forecast.spp / (factor * (double)t.spp[0]) - 1) < 1e-9);
    assert_true(fabs(t.forecast.seconds / (factor * t.at[0]) - 1) < 1e-9);
    assert_true(fabs(t.share * factor - 1) < 1e-9);
    bis_film_clear(&film);
    clear_ticking(&w);
}

static void interrupt_after(const bis_render_result *result, void *user)
{
    if (result->passes == ((const telling *)user)->interrupts) world_flag = 1;
}

/* Passes of 1, 1 and 2 samples: what comes after the last of them comes too late. A time is no number of samples. */
static void who_interrupts_a_finished_render_comes_too_late(void **state)
{
    for (uint32_t passes = 1; passes <= 4; passes++) {
        const bool by_time = passes == 4;
        const uint32_t after = by_time ? 3 : passes;
        telling t = {.interrupts = after};
        world w;
        bis_film film;
        bis_render_result result;
        make_ticking(&w, 10, FOR_EVER);
        world_flag = 0;
        render_part(&film, &result, &w, one_pixel,
                    &(bis_render_options){.budget = {.spp = by_time ? 0 : 4, .seconds = 1e6}, .n_threads = 1,
                                          .interrupted = &world_flag, .so_far = interrupt_after,
                                          .progress = note_report, .user = &t});
        assert_int_equal(result.passes, after);
        assert_true(fabs(t.reports[t.n - 1].share - (by_time ? 40 / 1e6 : (double)result.spp / 4)) < 1e-9);
        assert_int_equal(result.interrupted, passes != 3);
        bis_film_clear(&film);
        clear_ticking(&w);
    }
}

/* A pixel's error is no error of a picture, however small: the samples end the render, and nothing is forecast. */
static void an_error_that_is_not_known_ends_nothing(void **state)
{
    world w;
    bis_film film;
    bis_render_result result;
    telling t = {.film = &film};
    make_ticking(&w, 1, FOR_EVER);
    render_part(&film, &result, &w, one_pixel,
                &(bis_render_options){.budget = {.error = 10, .spp = 20}, .n_threads = 1, .forecast = note_forecast,
                                      .user = &t});
    assert_true(result.error.upper < 10 && !result.error.is_bounded);
    assert_int_equal(result.spp, 20);
    assert_int_equal(t.n_forecasts, 0);
    bis_film_clear(&film);
    clear_ticking(&w);
}

/* ---- counters ---- */

/* Two triangles seen head on from z = -2 by a camera of 90 degrees: they fill the middle 18 x 10 of 36 x 20 pixels.
 * Under a light from everywhere a white wall's candidates from the BRDF are all alike: with systematic resampling
 * each ray has its own. */
static void make_wall(world *w)
{
    const vec3 corners[4] = {{-1.8f, -1, 0}, {1.8f, -1, 0}, {1.8f, 1, 0}, {-1.8f, 1, 0}};
    const uint32_t index[6] = {0, 1, 2, 0, 2, 3};
    const bis_xform identity = bis_xform_identity();
    const bis_accel_options accel = {.kind = BIS_ACCEL_GRID};
    bis_mesh m = {.n_vertices = 4, .n_triangles = 2};

    *w = (world){0};
    m.p = bis_alloc(4, sizeof *m.p);
    m.index = bis_alloc(6, sizeof *m.index);
    memcpy(m.p, corners, sizeof corners);
    memcpy(m.index, index, sizeof index);
    w->scene.desc = &w->desc;
    w->materials[0] = bis_phong((rgb){1, 1, 1}, (rgb){0, 0, 0}, 1);
    w->desc.materials = w->materials;
    w->desc.n_materials = 1;
    w->desc.view.camera = (bis_camera){.fov_deg = 90, .to_world = bis_xform_translate(0, 0, -2)};
    w->desc.view.sampler = (bis_sampler){.kind = BIS_SAMPLER_STRATIFIED, .seed = 1, .jitter = true};
    w->desc.view.settings = bis_settings_default(&bis_sir);
    w->desc.view.settings.proposal = BIS_PROPOSAL_BRDF;
    w->desc.view.settings.candidates = 800;
    w->desc.view.settings.shadowrays = 15;
    w->desc.has_light = true;
    w->desc.light = (bis_light_desc){.L = {1, 1, 1}, .scale = 1, .visible = true, .to_world = bis_xform_identity()};
    bis_sampler_set_spp(&w->desc.view.sampler, 1);
    assert_int_equal(bis_geometry_add_mesh(&w->scene.geometry, &m, &identity, 0, NULL), BIS_OK);
    bis_mesh_clear(&m);
    assert_int_equal(bis_accel_new(&w->scene.accel, &w->scene.geometry, &accel, NULL), BIS_OK);
    assert_int_equal(bis_light_constant(&w->scene.light, w->desc.light.L, NULL), BIS_OK);
}

/* "15/800" of chapter 5 as what it takes to render an image: 15 rays in each pixel. But only a quarter of the pixels
 * is hit, and candidates, camera rays and shadow rays are different things. */
static void counters_equal_hand_counts_on_two_triangles_and_15_rays_a_pixel_is_rejected_E30(void **state)
{
    enum { W = 36, H = 20, PASSES = 3, HITS = PASSES * W * H / 4 };
    world w;
    make_wall(&w);
    bis_film film;
    bis_render_result result;
    assert_int_equal(bis_film_init(&film, W, H, whole, (bis_loc){0}, NULL), BIS_OK);
    const bis_render_options options = {.budget = {.spp = PASSES}};
    assert_int_equal(bis_render(&result, &film, &w.scene, &w.desc.view, &options, NULL), BIS_OK);
    assert_int_equal(result.counters.camera_rays, PASSES * W * H);
    assert_int_equal(result.counters.candidates, 800 * HITS);
    assert_int_equal(result.counters.shadow_rays, 15 * HITS);
    assert_int_not_equal(result.counters.shadow_rays, 15 * PASSES * W * H);
    bis_film_clear(&film);
    clear_world(&w);
}

/* ---- what a camera sample sees ---- */

/* The upper rows see the sky: no hit, and the map's radiance in the pixel's direction. */
static void escaped_rays_see_the_map_where_it_is_visible(void **state)
{
    world w;
    make_world(&w, &place);
    w.desc.view.pixel_jitter = false;
    for (int visible = 0; visible < 2; visible++) {
        bis_film film;
        bis_render_result result;
        w.desc.light.visible = visible;
        render(&film, &result, &w, whole, &(bis_render_options){.budget = {.spp = 2}});
        for (int x = 0; x < WIDTH; x++) {
            ray r = bis_camera_ray(&w.desc.view.camera, WIDTH, HEIGHT, x + 0.5, 0.5);
            rgb Le = visible ? bis_light_Le(w.scene.light, r.d) : (rgb){0};
            assert_int_equal(film.hits[x], 0);
            assert_true(film.sum[3 * x] == 2 * (double)Le.r && film.sum[3 * x + 1] == 2 * (double)Le.g);
        }
        bis_film_clear(&film);
    }
    clear_world(&w);
}

static void without_jitter_rays_pass_through_pixel_centres(void **state)
{
    world w;
    make_world(&w, &place);
    w.desc.view.pixel_jitter = false;
    bis_film film;
    bis_render_result result;
    render(&film, &result, &w, whole, &(bis_render_options){.budget = {.spp = 1}});
    /* The lowest row sees the floor y = -1 where its rays say so. */
    for (int x = 0; x < WIDTH; x++) {
        size_t i = (size_t)((HEIGHT - 1) * WIDTH + x);
        ray r = bis_camera_ray(&w.desc.view.camera, WIDTH, HEIGHT, x + 0.5, HEIGHT - 0.5);
        double t = (-1 - (double)r.o.y) / (double)r.d.y;
        assert_true(fabs(film.sum[3 * i] - 10 - t * (double)r.d.x) < 1e-5);
        assert_true(fabs(film.sum[3 * i + 2] - 10 - ((double)r.o.z + t * (double)r.d.z)) < 1e-5);
    }
    bis_film_clear(&film);
    clear_world(&w);
}

static void a_black_material_reflects_nothing_and_costs_nothing(void **state)
{
    world w;
    make_world(&w, &sick);
    for (int i = 0; i < 2; i++) w.materials[i].Kd = w.materials[i].Ks = (rgb){0};
    w.desc.light.visible = false;
    bis_film film;
    bis_render_result result;
    render(&film, &result, &w, whole, &(bis_render_options){.budget = {.spp = 1}});
    uint64_t hits = 0;
    for (size_t i = 0; i < WIDTH * HEIGHT; i++) {
        assert_true(film.sum[3 * i] == 0);
        hits += film.hits[i] > 0;
    }
    assert_true(hits > 300);
    assert_int_equal(result.counters.nonfinite + result.counters.shadow_rays + result.counters.candidates, 0);
    bis_film_clear(&film);
    clear_world(&w);
}

static void estimates_that_are_not_finite_are_counted_and_kept_out(void **state)
{
    world w;
    make_world(&w, &sick);
    bis_film film;
    bis_render_result result;
    render(&film, &result, &w, whole, &(bis_render_options){.budget = {.spp = 4}});
    assert_true(result.counters.nonfinite > 100);
    for (size_t i = 0; i < 3 * WIDTH * HEIGHT; i++) assert_true(isfinite(film.sum[i]));
    const uint64_t n = result.counters.nonfinite;
    bis_film_clear(&film);
    /* a layer that asks the integrator again counts each again, and keeps it out, too */
    render_layers(&film, &result, &w, whole, 1u << BIS_LAYER_UNOCCLUDED, &(bis_render_options){.budget = {.spp = 4}});
    assert_true(result.counters.nonfinite == 2 * n);
    bis_film_clear(&film);
    clear_world(&w);
}

/* ---- memory ---- */

static void every_failing_allocation_is_reported_and_leaves_nothing(void **state)
{
    world w;
    make_world(&w, &bis_sir);
    assert_true(first_k_without_failure(&w, 0) > 6);
    clear_world(&w);
}

/* ---- light at the edge of a float ---- */

/* Every way to draw: the integrators, proposals and layouts in memory that differ. */
static int ways_to_draw(bis_settings s[16])
{
    static const bis_proposal proposals[] = {
        BIS_PROPOSAL_EM, BIS_PROPOSAL_BRDF, BIS_PROPOSAL_MIX, BIS_PROPOSAL_PRODUCT};
    static const bis_integrator *const plain[] = {&bis_em, &bis_brdf, &bis_mis, &bis_mis};
    int n = 0;

    for (int i = 0; i < 4; i++) {
        s[n] = bis_settings_default(plain[i]);
        if (i == 3) s[n].heuristic = BIS_HEURISTIC_POWER;
        s[n++].samples = 4;
    }
    for (int i = 0; i < 3; i++) {
        s[n] = bis_settings_default(&bis_rejection);
        s[n++].proposal = i == 2 ? BIS_PROPOSAL_CHOOSE : proposals[i];
    }
    for (int i = 0; i < 8; i++) {
        s[n] = bis_settings_default(&bis_sir);
        s[n].proposal = proposals[i % 4];
        s[n].resampling = i < 4 ? BIS_RESAMPLING_SYSTEMATIC : BIS_RESAMPLING_MULTINOMIAL;
        s[n++].learn = i == 3;
    }
    for (int i = 0; i < n; i++) {
        s[i].candidates = 48;
        s[i].shadowrays = 4;
    }
    return n;
}

/* A 16 x 8 map of denormal floats, from the least on, in columns 1 to 15; `first` in column 0. */
static bis_light *denormal_light(const bis_light_desc *desc, float first)
{
    static const float tiny[] = {1e-45f, 3e-45f, 1e-44f, 1e-42f, 1e-40f, 5e-39f};
    bis_image image;
    bis_envmap em;
    bis_light *light;

    assert_int_equal(bis_image_init(&image, 16, 8, NULL), BIS_OK);
    for (int i = 0; i < 16 * 8; i++)
        image.pixels[i] =
            i % 16 ? (rgb){tiny[i % 6], tiny[(i + 1) % 6], tiny[(i / 16) % 6]} : (rgb){first, first, first};
    assert_int_equal(bis_envmap_from_latlong(&em, &image, NULL), BIS_OK);
    assert_int_equal(bis_light_from_envmap(&light, &em, desc, BIS_NEED_TABLE | BIS_NEED_CURVE, NULL), BIS_OK);
    return light;
}

/* Means of the picture for N_SEEDS seeds, in units of `first`; no estimate may fail. */
enum { N_DENORMAL_SEEDS = 24 };

static void means_of_picture(double mean[N_DENORMAL_SEEDS], world *w, float first)
{
    for (int seed = 0; seed < N_DENORMAL_SEEDS; seed++) {
        bis_film film;
        bis_render_result result;
        w->desc.view.sampler.seed = 100 + (uint64_t)seed;
        assert_int_equal(bis_film_init(&film, 12, 8, whole, (bis_loc){0}, NULL), BIS_OK);
        assert_int_equal(bis_render(&result, &film, &w->scene, &w->desc.view,
                             &(bis_render_options){.budget = {.spp = 2}}, NULL),
            BIS_OK);
        if (result.counters.nonfinite)
            fail_msg("%s: %d estimates are not finite", w->desc.view.settings.integrator->name,
                (int)result.counters.nonfinite);
        mean[seed] = 0;
        for (int i = 0; i < 3 * 12 * 8; i++) mean[seed] += film.sum[i] / (double)first;
        bis_film_clear(&film);
    }
}

/* Every integrator against `exact`, seed by seed: the same camera samples. 3 maps, 15 ways: family-wise 1e-3. Under a
 * map of denormals alone the light is cast into floats of a few bits, so that only "finite" is asked there. */
static void lit_denormals_leave_every_estimate_finite_and_the_means_right(void **state)
{
    static const float firsts[] = {1, 1e30f, 0x1p-126f, 1e-42f};
    bis_settings ways[16];
    const int n_ways = ways_to_draw(ways);
    const double alpha = stat_level(1e-3, 3 * n_ways);

    for (int map = 0; map < 4; map++) {
        double exact[N_DENORMAL_SEEDS], mean[N_DENORMAL_SEEDS];
        world w;
        make_world(&w, &bis_exact);
        bis_light_free(w.scene.light);
        w.desc.light.visible = false;
        w.scene.light = denormal_light(&w.desc.light, firsts[map]);
        means_of_picture(exact, &w, firsts[map]);
        for (int i = 0; i < n_ways; i++) {
            stat_moments difference = {0}, twin = {0};
            w.desc.view.settings = ways[i];
            means_of_picture(mean, &w, firsts[map]);
            for (int k = 0; k < N_DENORMAL_SEEDS; k++) {
                stat_add(&difference, mean[k] - exact[k]);
                stat_add(&twin, 2 * mean[k] - exact[k]);
            }
            if (map == 3) continue;
            const stat_result r = stat_mean(&difference, 0, alpha);
            stat_judges(1);
            if (r.rejected)
                fail_msg("map %d, way %d, %s: mean %g off by %g, p = %g", map, i, ways[i].integrator->name, exact[0],
                    difference.mean, r.p);
            if (ways[i].integrator == &bis_em && !stat_mean(&twin, 0, alpha).rejected)
                fail_msg("the twin, twice too bright, was not noticed");
        }
        clear_world(&w);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_number_of_threads_gives_the_same_bits_and_counts),
        cmocka_unit_test(a_crop_holds_the_same_bits_as_the_full_picture),
        cmocka_unit_test(a_twin_is_its_pixel_in_a_render_with_another_seed),
        cmocka_unit_test(a_crop_of_a_picture_that_learns_holds_its_bits),
        cmocka_unit_test(a_thin_film_holds_the_bits_of_its_pixels_in_the_picture),
        cmocka_unit_test(more_passes_begin_with_the_same_passes),
        cmocka_unit_test(another_seed_gives_other_noise),
        cmocka_unit_test(an_interrupted_render_holds_its_complete_passes_and_nothing_else_E39),
        cmocka_unit_test(an_interrupted_first_pass_leaves_nothing),
        cmocka_unit_test(spp_is_the_number_of_camera_rays_in_growing_passes),
        cmocka_unit_test(the_shortest_time_still_completes_one_pass_E39),
        cmocka_unit_test(an_error_budget_ends_when_the_bound_holds_and_not_before),
        cmocka_unit_test(an_error_budget_takes_three_passes_at_least_and_spp_at_most),
        cmocka_unit_test(progress_grows_to_the_whole_budget),
        cmocka_unit_test(time_is_used_up_and_not_exceeded),
        cmocka_unit_test(reports_say_what_is_done_and_what_is_left),
        cmocka_unit_test(the_result_so_far_is_told_once_in_an_interval),
        cmocka_unit_test(a_checkpoint_is_kept_once_in_an_interval),
        cmocka_unit_test(a_later_process_knows_the_seconds_and_finds_its_own_speed),
        cmocka_unit_test(the_first_pass_ends_with_the_time),
        cmocka_unit_test(a_forecast_is_the_square_of_the_errors_times_what_was_taken),
        cmocka_unit_test(who_interrupts_a_finished_render_comes_too_late),
        cmocka_unit_test(an_error_that_is_not_known_ends_nothing),
        cmocka_unit_test(counters_equal_hand_counts_on_two_triangles_and_15_rays_a_pixel_is_rejected_E30),
        cmocka_unit_test(escaped_rays_see_the_map_where_it_is_visible),
        cmocka_unit_test(without_jitter_rays_pass_through_pixel_centres),
        cmocka_unit_test(a_black_material_reflects_nothing_and_costs_nothing),
        cmocka_unit_test(estimates_that_are_not_finite_are_counted_and_kept_out),
        cmocka_unit_test(lit_denormals_leave_every_estimate_finite_and_the_means_right),
        cmocka_unit_test(every_failing_allocation_is_reported_and_leaves_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
