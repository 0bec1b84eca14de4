/* SPDX-License-Identifier: BSD-2-Clause */
/* wave: what is rendered in waves has the bits of what is rendered one camera sample after the other, for every
 * integrator, accelerator, number of threads and size of passes. The other road is in this file: a loop over passes,
 * pixels and samples that calls Lo, and shadow rays that are traced one by one. */
#include "render/edges.h"
#include "render/pass.h"
#include "render/ranks.h"
#include "render/survey.h"
#include "render/workspace.h"
#include "claim.h"
#include "stat.h"
#include "world.h"

#include "bis/base/mem.h"
#include "bis/base/stats.h"

#include <math.h>
#include <string.h>

enum { TILE = BIS_RENDER_TILE, ACROSS = (WIDTH + TILE - 1) / TILE, TILES = ACROSS * ((HEIGHT + TILE - 1) / TILE) };

/* ---- one after the other ---- */

/* Of the light samples on outlines, with an edge light of 1/4: a quarter, rounded up. A vector has 16 candidates. */
static bis_settings quarter_of(const bis_settings *s)
{
    bis_settings q = *s;
    if (!s->stratify || s->integrator == &bis_brdf) q.samples = (s->samples + 3) / 4; /* else whole sets */
    q.shadowrays = (s->shadowrays + 3) / 4;
    if (s->integrator == &bis_mis && q.samples < 2) q.samples = 2;
    if (s->proposal == BIS_PROPOSAL_PRODUCT) q.candidates = s->candidates < 64 ? 16 : (s->candidates + 3) / 4;
    return q;
}

static rgb radiance(
    const world *w, bis_workspace *work, const bis_sampler *sampler, bool edge, int x, int y, uint64_t index, bool *hit)
{
    const bis_view *view = &w->desc.view;
    double u[2] = {0.5, 0.5};
    bis_stream stream;
    bis_own_material m;
    bis_point pt;

    bis_stream_init(&stream, sampler, (uint64_t)(y * WIDTH + x), index);
    if (view->pixel_jitter) bis_stream_camera(&stream, u);
    const ray eye = bis_camera_ray(&view->camera, WIDTH, HEIGHT, x + u[0], y + u[1]);
    *hit = bis_scene_point(&pt, &m, &w->scene, eye, &work->workers[0].counters, NULL);
    if (!*hit) return bis_light_Le(w->scene.light, eye.d);
    const bis_settings quarter = quarter_of(&view->settings),
                       *s = edge && view->edge_light > 0 ? &quarter : &view->settings;
    return s->integrator->Lo(s, &pt, &stream, &work->workers[0].scratch);
}

/* A look around in a place of `side` x `side` pixels from (x0, y0) on: a sample in each quarter, with random numbers of
 * their own, until a quarter of the rays of a round came through, 16 times at most. A square has one cell. */
static void look_one_by_one(const world *w, bis_workspace *work, int which, int x0, int y0, int side)
{
    bis_sampler sampler = w->desc.view.sampler;
    bis_visibility *v = &work->visibility;
    const bool is_tile = side == TILE;
    const int step = side / TILE, first = is_tile ? 16 * which : 16 * TILES + which - TILES;
    bis_rng rng;

    bis_rng_init(&rng, sampler.seed, UINT64_MAX, (uint64_t)step - 1, (uint64_t)4 << 32);
    sampler.seed = bis_rng_u64(&rng);
    bis_sampler_set_spp(&sampler, 1);
    for (int round = 0; round < 16; round++) {
        uint64_t rays = 0, seen = 0;
        for (int quarter = 0; quarter < 4; quarter++) {
            const int c = 4 * quarter + round % 4, p = (7 * round + 5) % 16,
                      bits[] = {p & 1, p >> 1 & 1, p >> 2 & 1, p >> 3};
            const uint64_t x1 = (uint64_t)(x0 + step * (8 * (quarter % 2) + 4 * (c % 2) + bits[0] + 2 * bits[2])),
                           y1 = (uint64_t)(y0 + step * (8 * (quarter / 2) + 4 * (c / 2 % 2) + bits[1] + 2 * bits[3])),
                           any = bis_hash(sampler.seed + (x1 << 32 | y1));
            const int x = (int)(x1 + any % (uint64_t)step), y = (int)(y1 + (any >> 32) % (uint64_t)step);
            bool hit;
            if (x >= WIDTH || y >= HEIGHT) continue;
            bis_guess_look(&work->workers[0].guide.guess, work->clusters.n, v, (size_t)(first + (is_tile ? c : 0)));
            radiance(w, work, &sampler, false, x, y, 0, &hit);
        }
        for (int c = first; c < first + (is_tile ? 16 : 1); c++) {
            for (int k = 0; k < BIS_VISIBILITY_PARTS; k++) {
                rays += v->counted[c].rays[k];
                seen += v->counted[c].seen[k];
            }
        }
        bis_visibility_learn(v, &which, 1, 1);
        if (rays > 0 && 4 * seen >= rays) return;
    }
}

/* Squares of the picture, from the whole down to those of 2 x 2 tiles: each is in one of the next larger ones. */
static void survey_one_by_one(const world *w, bis_workspace *work)
{
    bis_visibility *v = &work->visibility;
    int largest = 2 * TILE;

    while (largest < WIDTH || largest < HEIGHT) largest *= 2;
    work->workers[0].scratch.guide->learns = true;
    for (int side = largest; side > TILE; side /= 2) {
        size_t before = 0; /* squares of smaller sizes */
        for (int s = 2 * TILE; s < side; s *= 2)
            before += (size_t)((WIDTH + s - 1) / s) * (size_t)((HEIGHT + s - 1) / s);
        for (int y = 0; y < HEIGHT; y += side) {
            for (int x = 0; x < WIDTH; x += side) {
                const size_t k = before + (size_t)(y / side * ((WIDTH + side - 1) / side) + x / side);
                look_one_by_one(w, work, TILES + (int)k, x, y, side);
                bis_visibility_close(v, k, work->clusters.n);
            }
        }
    }
}

static void pass_one_by_one(
    bis_film *film, const world *w, bis_workspace *work, uint32_t number, uint32_t n, uint64_t before)
{
    if (work->clusters.n) bis_clusters_fill(&work->clusters, w->scene.light, w->desc.view.sampler.seed, number, 1);
    if (work->pool.M) bis_pool_fill(&work->pool, w->scene.light, w->desc.view.sampler.seed, number, 1);
    if (number == 0 && work->visibility.n_tiles) survey_one_by_one(w, work);
    for (int t = TILES - 1; t >= 0;
        t--) { /* the order of tiles is nobody's business, nor that of the pixels of a cell */
        if (number == 0 && work->visibility.n_tiles)
            look_one_by_one(w, work, t, t % ACROSS * TILE, t / ACROSS * TILE, TILE);
        for (int at = 0; at < TILE * TILE; at++) {
            /* 4 x 4 cells of 4 x 4 pixels; four of them, a square, follow each other, and so do four squares */
            const int c = at / 16, x = t % ACROSS * TILE + 8 * (c / 4 % 2) + 4 * (c % 2) + 3 - at % 4,
                      y = t / ACROSS * TILE + 8 * (c / 8) + 4 * (c / 2 % 2) + 3 - at / 4 % 4;
            const size_t cell = (size_t)(16 * t + c);
            if (x >= WIDTH || y >= HEIGHT) continue;
            const int edge = work->edge ? bis_edges_kind(work->edge, work->area, x, y) : 0;
            const uint32_t most = w->desc.view.edge_samples, k = edge == 2 ? most : edge ? (most + 1) / 2 : 1;
            rgbd sum = {0, 0, 0};
            double hits = 0;
            if (work->visibility.n_tiles)
                bis_guess_look(&work->workers[0].guide.guess, work->clusters.n, &work->visibility, cell);
            for (uint32_t i = 0; i < n * k; i++) {
                bool hit;
                const rgb L = radiance(w, work, edge ? &work->edge_samplers[edge] : &w->desc.view.sampler, k > 1, x, y,
                    before * k + i, &hit);
                sum = (rgbd){sum.r + (double)L.r, sum.g + (double)L.g, sum.b + (double)L.b};
                hits += hit;
            }
            const double mean = 1 / (double)(n * k);
            bis_film_add(
                film, x, y, rgb_from(sum.r * mean, sum.g * mean, sum.b * mean), (double)(float)(hits / (n * k)), n);
        }
    }
    bis_visibility_learn(&work->visibility, NULL, work->visibility.n_tiles, 1);
    bis_film_end_pass(film, n);
}

static void render_one_by_one(
    bis_film *film, bis_counters *counters, const world *w, const uint32_t *sizes, uint32_t n_passes)
{
    const bis_render_options options = {.n_threads = 1};
    bis_workspace work = {.scene = &w->scene, .desc = &w->desc, .view = &w->desc.view, .options = &options,
                          .film = film};
    uint64_t before = 0;

    assert_int_equal(bis_film_init(film, WIDTH, HEIGHT, whole, (bis_loc){0}, NULL), BIS_OK);
    assert_int_equal(bis_workspace_init(&work, NULL), BIS_OK);
    assert_int_equal(bis_workspace_find_edges(&work, NULL), BIS_OK);
    for (uint32_t p = 0; p < n_passes; p++) {
        pass_one_by_one(film, w, &work, p, sizes[p], before);
        before += sizes[p];
    }
    *counters = work.workers[0].counters;
    bis_workspace_clear(&work);
}

/* ---- settings ---- */

typedef struct setting {
    const bis_integrator *integrator;
    uint32_t M, N;
    bis_proposal proposal;
    bool learn, stratify;
} setting;

static const setting settings[] = {
    {&bis_em, 0, 5, BIS_PROPOSAL_EM, false, false},
    {&bis_em, 0, 5, BIS_PROPOSAL_EM, false, true},
    {&bis_brdf, 0, 5, BIS_PROPOSAL_EM, false, false},
    {&bis_mis, 0, 6, BIS_PROPOSAL_EM, false, false},
    {&bis_rejection, 40, 3, BIS_PROPOSAL_CHOOSE, false, false},
    {&bis_exact, 0, 1, BIS_PROPOSAL_EM, false, false},      /* 128 rays a sample: a wave is full before its samples */
    {&bis_unoccluded, 10, 1, BIS_PROPOSAL_EM, false, false}, /* no rays */
    {&bis_sir, 40, 5, BIS_PROPOSAL_MIX, false, true},
    {&bis_sir, 5, 3, BIS_PROPOSAL_MIX, false, false}, /* less than a vector holds */
    {&bis_sir, 64, 16, BIS_PROPOSAL_PRODUCT, false, true},
    {&bis_sir, 64, 16, BIS_PROPOSAL_PRODUCT, true, true},
    {&bis_sir, 4096, 1500, BIS_PROPOSAL_PRODUCT, true, true}, /* one sample has more rays than a wave holds */
};

static void choose(world *w, const setting *s)
{
    bis_settings *to = &w->desc.view.settings;

    *to = bis_settings_default(s->integrator);
    to->candidates = s->M;
    to->shadowrays = to->samples = s->N;
    to->perpatch = 1;
    to->proposal = s->proposal;
    to->learn = s->learn;
    to->stratify = s->stratify;
}

/* ---- tests ---- */

static void use_accel(world *w, bis_accel_kind kind)
{
    const bis_accel_options options = {.kind = kind};
    bis_accel_free(w->scene.accel);
    assert_int_equal(bis_accel_new(&w->scene.accel, &w->scene.geometry, &options, NULL), BIS_OK);
}

static void waves_have_the_bits_of_single_samples(void **state)
{
    static const int threads[] = {1, 2, 3, 7};
    static const uint32_t growing[] = {1, 1, 2, 3}; /* of 7 camera samples */
    for (size_t i = 0; i < sizeof settings / sizeof *settings; i++) {
        const bool large = settings[i].M > 1000;
        for (int kind = 0; kind < 2; kind++) {
            if (kind && !bis_accel_embree_version()) continue;
            world w;
            bis_film one, waves;
            bis_counters counters;
            bis_render_result result;
            make_world(&w, &bis_sir);
            choose(&w, &settings[i]);
            use_accel(&w, kind ? BIS_ACCEL_EMBREE : BIS_ACCEL_GRID);
            w.desc.view.edge_samples = i % 3 == 0 || settings[i].learn ? 4 : 1;
            w.desc.view.edge_light = kind ? 0 : 0.25;
            if (i % 2) w.desc.view.sampler.kind = BIS_SAMPLER_SOBOL;
            render_one_by_one(&one, &counters, &w, growing, large ? 2 : 4);
            const bis_render_options options = {.budget = {.spp = large ? 2 : 7}, .n_threads = threads[i % 4]};
            render(&waves, &result, &w, whole, &options);
            assert_same_bits(&one, &waves);
            assert_int_equal(result.counters.shadow_rays, counters.shadow_rays);
            assert_int_equal(result.counters.candidates, counters.candidates);
            assert_int_equal(result.counters.accepted, counters.accepted);
            assert_int_equal(result.counters.fallbacks, counters.fallbacks);
            assert_true(settings[i].integrator == &bis_unoccluded || counters.shadow_rays > 0);
            bis_film_clear(&one);
            bis_film_clear(&waves);
            clear_world(&w);
        }
    }
}

/* One thread tells after each of the tiles what share of the pass is done. */
static void note_share(double share, void *user)
{
    double *const told = user; /* how often, and the last share */
    assert_true(share > told[1] && share <= 1);
    told[0]++;
    told[1] = share;
}

static void a_pass_tells_its_progress_after_each_tile(void **state)
{
    const bis_render_options options = {.n_threads = 1};
    const bis_pass pass = {.number = 0, .n = 1, .first = 0, .weight = 1};
    double told[2] = {0, 0};
    bis_film film;
    world w;
    bis_workspace work = {.scene = &w.scene, .desc = &w.desc, .view = &w.desc.view, .options = &options,
                          .film = &film};

    make_world(&w, &bis_em);
    assert_int_equal(bis_film_init(&film, WIDTH, HEIGHT, whole, (bis_loc){0}, NULL), BIS_OK);
    assert_int_equal(bis_workspace_init(&work, NULL), BIS_OK);
    assert_true(bis_pass_render(&work, &pass, note_share, told));
    assert_true(told[0] == work.n_tiles && told[1] == 1 && work.n_tiles > 1);
    bis_workspace_clear(&work);
    bis_film_clear(&film);
    clear_world(&w);
}

/* Twin: the comparison sees one shadow ray. */
static bool one_ray_is_lost(const bis_accel *a, const ray *r)
{
    static long n;
    return n++ == 500;
}

static bool same_hit(const bis_accel *a, const ray *r, bis_hit *hit)
{
    return bis_accel_intersect((const bis_accel *)(const void *)a->geometry, r, hit);
}

static void one_ray_that_is_lost_changes_the_bits(void **state)
{
    static const bis_accel_ops ops = {.name = "leaky", .intersect = same_hit, .occluded = one_ray_is_lost};
    static const uint32_t sizes[] = {1};
    world w;
    bis_film one, waves;
    bis_counters counters;
    bis_render_result result;
    make_world(&w, &bis_em);
    bis_accel *real = w.scene.accel, leaky = {&ops, (const bis_geometry *)(const void *)real};
    w.scene.accel = &leaky;
    render_one_by_one(&one, &counters, &w, sizes, 1); /* loses ray 500 */
    render(&waves, &result, &w, whole, &(bis_render_options){.budget = {.spp = 1}, .n_threads = 1}); /* none */
    assert_true(counters.shadow_rays > 500);
    assert_memory_not_equal(one.sum, waves.sum, 3 * WIDTH * HEIGHT * sizeof *one.sum);
    w.scene.accel = real;
    bis_film_clear(&one);
    bis_film_clear(&waves);
    clear_world(&w);
}

/* A pixel with a thousand camera samples, one with none, and pixels of nothing but sky. */
static void many_samples_of_one_pixel_fill_several_waves(void **state)
{
    static const uint32_t sizes[] = {1, 1};
    world w;
    bis_film one, waves;
    bis_counters counters;
    bis_render_result result;
    make_world(&w, &bis_em);
    w.desc.view.edge_samples = 1024;
    render_one_by_one(&one, &counters, &w, sizes, 2);
    render(&waves, &result, &w, whole, &(bis_render_options){.budget = {.spp = 2}, .n_threads = 2});
    assert_same_bits(&one, &waves);
    assert_true(result.counters.camera_rays > 20 * 2 * 1024);
    bis_film_clear(&one);
    bis_film_clear(&waves);
    clear_world(&w);
}

/* An integrator that does not put its rays off, as a student's first: bis_point_sees, and the sum is returned. */
static rgb impatient_Lo(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch)
{
    const vec3 wi = normalize((vec3){pt->n.x + (float)bis_stream_random(stream) - 0.5f, pt->n.y, pt->n.z});
    return bis_point_sees(pt, wi) ? (rgb){1, 2, 3} : (rgb){0.25f, 0, 0};
}

static void an_integrator_may_trace_its_rays_at_once(void **state)
{
    const bis_integrator impatient = {
        .name = "impatient", .light_needs = no_light_needs, .scratch_needs = no_scratch, .Lo = impatient_Lo};
    static const uint32_t sizes[] = {1, 1, 2, 4};
    world w;
    bis_film one, waves;
    bis_counters counters;
    bis_render_result result;
    make_world(&w, &impatient);
    render_one_by_one(&one, &counters, &w, sizes, 4);
    render(&waves, &result, &w, whole, &(bis_render_options){.budget = {.spp = 8}, .n_threads = 2});
    assert_same_bits(&one, &waves);
    bis_film_clear(&one);
    bis_film_clear(&waves);
    clear_world(&w);
}

/* ---- unbiased ---- */

enum { BIASED_TESTS = 5 * TILES };

/* The mean radiance of each tile, over `runs` renders of 7 camera samples with seeds of their own. */
static void tile_means(stat_moments m[TILES], world *w, uint64_t first_seed, int runs, uint32_t pass_size)
{
    for (int run = 0; run < runs; run++) {
        bis_film film;
        bis_render_result result;
        w->desc.view.sampler.seed = first_seed + (uint64_t)run;
        bis_sampler_set_spp(&w->desc.view.sampler, 7);
        render(&film, &result, w, whole, &(bis_render_options){.budget = {.spp = 7}, .pass_size = pass_size});
        for (int t = 0; t < TILES; t++) {
            double sum = 0;
            int n = 0;
            for (int y = t / ACROSS * TILE; y < HEIGHT && y < (t / ACROSS + 1) * TILE; y++) {
                for (int x = t % ACROSS * TILE; x < WIDTH && x < (t % ACROSS + 1) * TILE; x++, n++)
                    for (int k = 0; k < 3; k++) sum += film.sum[3 * (y * WIDTH + x) + k] / film.weight;
            }
            stat_add(&m[t], sum / n);
        }
        bis_film_clear(&film);
    }
}

/* Welch: the difference of two means over its standard error; the smaller of the two numbers of runs bounds the degrees
 * of freedom from below. */
static double p_of_difference(const stat_moments *a, const stat_moments *b, double factor)
{
    const double se = sqrt(stat_variance(a) * factor * factor / a->n + stat_variance(b) / b->n);
    return bis_stats_student_p((a->mean * factor - b->mean) / se, fmin(a->n, b->n) - 1);
}

/* Growing passes, edge samples, low-discrepancy camera samples, pools and what earlier passes have learned, against the
 * plainest estimate: `em` with random samples, one a pass. */
static void what_passes_share_and_learn_does_not_bias(void **state)
{
    enum { RUNS = 60, PLAIN = 300 };
    static const struct {
        setting s;
        bis_sampler_kind sampler;
        uint32_t edge_samples;
    } cases[] = {
        {{&bis_sir, 64, 24, BIS_PROPOSAL_PRODUCT, true, true}, BIS_SAMPLER_SOBOL, 8}, /* the default */
        {{&bis_sir, 16, 4, BIS_PROPOSAL_PRODUCT, true, true}, BIS_SAMPLER_STRATIFIED, 1},
        {{&bis_sir, 40, 5, BIS_PROPOSAL_MIX, false, true}, BIS_SAMPLER_HALTON, 4},
        {{&bis_mis, 0, 6, BIS_PROPOSAL_EM, false, true}, BIS_SAMPLER_SOBOL, 4},
        {{&bis_em, 0, 5, BIS_PROPOSAL_EM, false, true}, BIS_SAMPLER_STRATIFIED, 4},
    };
    const double alpha = stat_level(1e-2, BIASED_TESTS);
    stat_moments plain[TILES] = {{0}};
    world w;
    make_world(&w, &bis_em);
    w.desc.view.settings.samples = 8;
    w.desc.view.sampler.kind = BIS_SAMPLER_RANDOM;
    tile_means(plain, &w, 100000, PLAIN, 1);
    clear_world(&w);
    stat_judges(BIASED_TESTS);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        stat_moments m[TILES] = {{0}};
        make_world(&w, &bis_sir);
        choose(&w, &cases[i].s);
        w.desc.view.sampler.kind = cases[i].sampler;
        w.desc.view.edge_samples = cases[i].edge_samples;
        w.desc.view.edge_light = 0.25;
        tile_means(m, &w, 1 + 1000 * i, RUNS, 0);
        for (int t = 0; t < TILES; t++) {
            const double p = p_of_difference(&m[t], &plain[t], 1);
            if (p < alpha) fail_msg("case %zu, tile %d: %g and %g, p %g", i, t, m[t].mean, plain[t].mean, p);
        }
        /* twin: 2 % too bright in one tile is found */
        assert_true(p_of_difference(&m[1], &plain[1], 1.02) < alpha);
        clear_world(&w);
    }
}

/* Squares of 32 x 32 pixels, of twice that, and so on, to the one that holds all: counted by hand. */
static void squares_of_a_picture_are_those_that_have_a_pixel(void **state)
{
    static const struct { int width, height; size_t n; } cases[] = {
        {31, 31, 1}, {32, 32, 1}, {1, 1, 1}, {33, 32, 2 + 1}, {32, 33, 2 + 1}, {33, 33, 4 + 1}, {63, 31, 2 + 1},
        {31, 64, 2 + 1}, {64, 64, 4 + 1}, {65, 64, 6 + 2 + 1}, {64, 65, 6 + 2 + 1}, {96, 1, 3 + 2 + 1},
        {1, 97, 4 + 2 + 1}, {128, 128, 16 + 4 + 1}, {129, 127, 20 + 6 + 2 + 1},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const bis_film f = {.full_width = cases[i].width, .full_height = cases[i].height};
        const size_t n = bis_survey_squares(&f);
        if (n != cases[i].n) fail_msg("%d x %d: %zu squares", cases[i].width, cases[i].height, n);
    }
}

/* ---- where squares are ---- */

enum { MOST_SQUARES = 128 };

typedef struct square {
    int side, x, y;
} square;

/* Squares of 32 pixels in reading order, of 64, and so on, up to the one that holds the picture. */
static size_t list_squares(square s[MOST_SQUARES], int width, int height)
{
    size_t n = 0;
    for (int side = 32;; side *= 2) {
        for (int y = 0; y < height; y += side)
            for (int x = 0; x < width; x += side) s[n++] = (square){side, x, y};
        if (side >= width && side >= height) return n;
    }
}

/* The number of the square of this side that holds a pixel. */
static uint32_t square_of(const square *s, size_t n, int side, int x, int y)
{
    for (size_t k = 0; k < n; k++)
        if (s[k].side == side && x >= s[k].x && x < s[k].x + side && y >= s[k].y && y < s[k].y + side)
            return (uint32_t)k;
    fail_msg("no square of %d has pixel (%d, %d)", side, x, y);
    return 0;
}

/* Around a tile is the square of 32 pixels that it is in, around a square the next larger one, and around the last one
 * none. The tiles are those of a crop, the squares those of the picture. */
static void each_place_is_in_the_square_around_it(void **state)
{
    static const int sizes[][2] = {{37, 21}, {300, 200}, {129, 127}, {20, 250}};
    static const double crops[][4] = {{0, 1, 0, 1}, {0.3, 0.9, 0.4, 1}};

    for (int i = 0; i < 8; i++) {
        const int width = sizes[i / 2][0], height = sizes[i / 2][1];
        const bis_film f = bis_film_place(width, height, crops[i % 2], 1);
        square s[MOST_SQUARES];
        const size_t n = list_squares(s, width, height);
        bis_visibility v;
        int across;
        const int n_tiles = bis_film_tiles(&f, TILE, &across);
        assert_int_equal(bis_visibility_init(&v, (size_t)n_tiles, n, 1, NULL), BIS_OK);
        assert_int_equal(bis_survey_squares(&f), n);
        bis_survey_place(&v, &f);
        for (int t = 0; t < n_tiles; t++) {
            const int x = (f.x0 / TILE + t % across) * TILE, y = (f.y0 / TILE + t / across) * TILE;
            assert_int_equal(v.above[t], square_of(s, n, 32, x, y));
        }
        for (size_t k = 0; k + 1 < n; k++)
            assert_int_equal(v.above[(size_t)n_tiles + k], square_of(s, n, 2 * s[k].side, s[k].x, s[k].y));
        assert_int_equal(v.above[(size_t)n_tiles + n - 1], BIS_NO_SQUARE);
        bis_visibility_clear(&v);
    }
}

/* ---- which squares are looked at ---- */

enum { BROAD = 300, HIGH = 200 };

/* A workspace that learns, of a crop of 300 x 200 pixels from which 99 squares are seen. */
typedef struct survey {
    world w;
    bis_film film;
    bis_render_options options;
    bis_workspace work;
    int told;
} survey;

static void open_survey(survey *s, const int at[4], const bis_render_options *options)
{
    const double crop[4] = {(at[0] - 0.5) / BROAD, (at[1] - 0.5) / BROAD, (at[2] - 0.5) / HIGH, (at[3] - 0.5) / HIGH};
    const double all[4] = {fmax(0, crop[0]), crop[1], fmax(0, crop[2]), crop[3]};

    *s = (survey){.options = *options};
    make_world(&s->w, &bis_sir);
    choose(&s->w, &(setting){&bis_sir, 64, 16, BIS_PROPOSAL_PRODUCT, true, true});
    assert_int_equal(bis_film_init(&s->film, BROAD, HIGH, all, (bis_loc){0}, NULL), BIS_OK);
    assert_true(s->film.x0 == at[0] && s->film.width == at[1] - at[0] && s->film.y0 == at[2] &&
                s->film.height == at[3] - at[2]);
    s->work = (bis_workspace){.scene = &s->w.scene, .desc = &s->w.desc, .view = &s->w.desc.view,
                              .options = &s->options, .film = &s->film};
    assert_int_equal(bis_workspace_init(&s->work, NULL), BIS_OK);
    bis_clusters_fill(&s->work.clusters, s->w.scene.light, 1, 0, 1);
}

static void close_survey(survey *s)
{
    bis_workspace_clear(&s->work);
    bis_film_clear(&s->film);
    clear_world(&s->w);
}

static void count_telling(double share, void *user)
{
    assert_true(share == 0);
    ++*(int *)user;
}

static uint64_t counted_rays(const bis_workspace *w)
{
    uint64_t n = 0;
    for (int i = 0; i < w->n_threads; i++) n += w->workers[i].counters.camera_rays;
    return n;
}

/* Closed are the squares from `least` pixels on that have a pixel of what is rendered. Returns how many. */
static int assert_closed(const survey *s, int least)
{
    const bis_rect a = s->work.area;
    square all[MOST_SQUARES];
    const size_t n = list_squares(all, BROAD, HIGH);
    int closed = 0;

    assert_int_equal(s->work.visibility.n_squares, n);
    for (size_t k = 0; k < n; k++) {
        bool touches = false;
        for (int y = a.y0; y < a.y1; y++)
            for (int x = a.x0; x < a.x1; x++)
                touches |= x >= all[k].x && x < all[k].x + all[k].side && y >= all[k].y && y < all[k].y + all[k].side;
        const bool wanted = touches && all[k].side >= least;
        if ((s->work.visibility.squares[k].h[0] > 0) != wanted)
            fail_msg("square of %d at (%d, %d)", all[k].side, all[k].x, all[k].y);
        closed += wanted;
    }
    return closed;
}

/* First squares of 128 pixels and more, then the others, where they touch the tiles of the crop: here along the borders
 * of squares. Each is told once. A second survey, of a resumed render, finds what the first one found. */
static void squares_are_looked_at_coarse_to_fine(void **state)
{
    static const int crops[][4] = {{0, 300, 0, 200}, {33, 64, 40, 64}, {128, 256, 0, 64}, {250, 300, 170, 200},
                                   {0, 1, 199, 200}};
    static const int coarse[] = {9, 3, 3, 5, 3}, fine[] = {99, 5, 13, 15, 5};

    for (size_t i = 0; i < sizeof crops / sizeof *crops; i++) {
        survey s;
        open_survey(&s, crops[i], &(bis_render_options){.n_threads = 1});
        const bis_visibility *v = &s.work.visibility;
        const size_t first = bis_visibility_first_cell(v, v->n_tiles), bytes = v->n_squares * sizeof *v->squares;
        bis_square *kept = bis_alloc(v->n_squares, sizeof *kept);
        bis_survey(&s.work, false, true, count_telling, &s.told);
        assert_int_equal(assert_closed(&s, 128), coarse[i]);
        assert_true(s.told == coarse[i] && !s.work.surveyed);
        assert_in_range(counted_rays(&s.work), coarse[i], 64 * (unsigned)coarse[i]);
        bis_survey(&s.work, true, true, count_telling, &s.told);
        assert_int_equal(assert_closed(&s, 0), fine[i]);
        assert_true(s.told == fine[i] && s.work.surveyed);
        assert_in_range(counted_rays(&s.work), fine[i], 64 * (unsigned)fine[i]);
        memcpy(kept, v->squares, bytes);
        bis_seen *known = bis_alloc(v->n_squares, sizeof *known);
        memcpy(known, v->known + first, v->n_squares * sizeof *known);
        bis_survey(&s.work, false, false, count_telling, &s.told);
        assert_int_equal(assert_closed(&s, 128), coarse[i]);
        assert_int_equal(counted_rays(&s.work), 0); /* it is not counted again */
        bis_survey(&s.work, true, false, count_telling, &s.told);
        assert_memory_equal(v->squares, kept, bytes);
        assert_memory_equal(v->known + first, known, v->n_squares * sizeof *known);
        bis_free(kept);
        bis_free(known);
        close_survey(&s);
    }
}

/* Rays of a survey count once for the picture: in its first part, or in rank 0. Who is interrupted has looked at
 * nothing and has not done it; nor has, in small squares, who is late. */
static void a_survey_counts_once_and_may_end(void **state)
{
    static const int all[4] = {0, BROAD, 0, HIGH};
    static volatile sig_atomic_t flag = 1;
    bis_ranks leader = {.rank = 0, .size = 2}, other = {.rank = 1, .size = 2};
    unsigned char fine = 0;
    const struct {
        bis_render_options options;
        bool counts, looks, late;
    } cases[] = {
        {{.n_threads = 1}, true, true, false},
        {{.n_threads = 1, .part = {1, 3}}, true, true, false},
        {{.n_threads = 1, .part = {2, 3}}, false, true, false},
        {{.n_threads = 1, .ranks = &leader}, true, true, false},
        {{.n_threads = 1, .ranks = &other}, false, true, false},
        {{.n_threads = 1, .interrupted = &flag}, false, false, false},
        {{.n_threads = 1}, true, true, true},
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        survey s;
        open_survey(&s, all, &cases[i].options);
        if (cases[i].late) s.work.fine = &fine, s.work.late = 0;
        for (int is_fine = 0; is_fine < 2; is_fine++) {
            bis_counters before = s.work.workers[0].counters;
            bis_survey(&s.work, is_fine, true, count_telling, &s.told);
            const bool looks = cases[i].looks && !(is_fine && cases[i].late);
            assert_int_equal(assert_closed(&s, !cases[i].looks ? 1000 : looks && is_fine ? 0 : 128),
                             !cases[i].looks ? 0 : looks && is_fine ? 99 : 9);
            assert_int_equal(counted_rays(&s.work) > before.camera_rays, looks && cases[i].counts);
            assert_int_equal(s.work.surveyed, looks && is_fine);
        }
        s.work.fine = NULL;
        close_survey(&s);
    }
}

/* An accelerator in which one shadow ray of `each` comes through; 0: nothing is hit. */
typedef struct dim {
    bis_accel accel;
    const bis_accel *inner;
    uint32_t each, *n;
} dim;

static bool dim_intersect(const bis_accel *a, const ray *r, bis_hit *hit)
{
    const dim *d = (const dim *)a;
    return d->each > 0 && bis_accel_intersect(d->inner, r, hit);
}

static bool dim_occluded(const bis_accel *a, const ray *r)
{
    const dim *d = (const dim *)a;
    return (*d->n)++ % d->each > 0;
}

/* The ball fills the picture of 256 x 256 pixels, so that all samples meet it. A look ends after its first round, of 4
 * samples, if a quarter of the rays came through; after 16 rounds it has seen enough of the dark, or of the sky. There
 * are 5 squares of 128 pixels and more, and 80 others. The same goes for tiles. */
static void a_look_ends_where_a_quarter_comes_through(void **state)
{
    static const struct { uint32_t each, rays; } cases[] = {{0, 64}, {1, 4}, {2, 4}, {3, 4}, {5, 64}, {1u << 30, 64}};
    static const bis_accel_ops ops = {.name = "dim", .intersect = dim_intersect, .occluded = dim_occluded};
    const bis_render_options options = {.n_threads = 1};

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        uint32_t n = 0;
        int told = 0;
        world w;
        bis_film film;
        make_world(&w, &bis_sir);
        choose(&w, &(setting){&bis_sir, 64, 64, BIS_PROPOSAL_PRODUCT, true, true});
        w.desc.view.camera.fov_deg = 5;
        bis_workspace work = {.scene = &w.scene, .desc = &w.desc, .view = &w.desc.view, .options = &options,
                              .film = &film};
        assert_int_equal(bis_film_init(&film, 256, 256, whole, (bis_loc){0}, NULL), BIS_OK);
        assert_int_equal(bis_workspace_init(&work, NULL), BIS_OK);
        bis_clusters_fill(&work.clusters, w.scene.light, 1, 0, 1);
        dim d = {{&ops, &w.scene.geometry}, w.scene.accel, cases[i].each, &n};
        w.scene.accel = &d.accel;
        bis_survey(&work, false, true, count_telling, &told);
        assert_int_equal(counted_rays(&work), 5 * cases[i].rays);
        bis_survey(&work, true, true, count_telling, &told);
        assert_int_equal(counted_rays(&work), 85 * cases[i].rays);
        if (cases[i].each != 5) { /* a tile knows so much that its rays are few, and a fifth of them is luck */
            bis_survey_tile(&work, &work.workers[0], 3);
            assert_int_equal(counted_rays(&work), 86 * cases[i].rays);
        }
        w.scene.accel = (bis_accel *)(uintptr_t)d.inner;
        bis_workspace_clear(&work);
        bis_film_clear(&film);
        clear_world(&w);
    }
}

/* An outline takes 5 camera samples where another pixel takes one, a turn 3: their sampler divides as many. */
static void edge_pixels_have_samplers_of_all_their_samples(void **state)
{
    static const bis_sampler_kind kinds[] = {
        BIS_SAMPLER_RANDOM, BIS_SAMPLER_STRATIFIED, BIS_SAMPLER_SOBOL, BIS_SAMPLER_HALTON};
    static const uint64_t times[] = {[BIS_EDGE_NONE] = 1, [BIS_EDGE_TURN] = 3, [BIS_EDGE_OUTLINE] = 5};
    const bis_render_options options = {.n_threads = 1};
    world w;
    make_world(&w, &bis_em);
    w.desc.view.edge_samples = 5;
    for (int i = 0; i < 4; i++) {
        bis_film film;
        bis_workspace work = {.scene = &w.scene, .desc = &w.desc, .view = &w.desc.view, .options = &options,
                              .film = &film};
        w.desc.view.sampler.kind = kinds[i];
        bis_sampler_set_spp(&w.desc.view.sampler, 16);
        assert_int_equal(bis_film_init(&film, WIDTH, HEIGHT, whole, (bis_loc){0}, NULL), BIS_OK);
        assert_int_equal(bis_workspace_init(&work, NULL), BIS_OK);
        assert_int_equal(bis_workspace_find_edges(&work, NULL), BIS_OK);
        for (int k = 0; k < BIS_EDGE_KINDS; k++) {
            bis_sampler wanted = w.desc.view.sampler;
            const bis_sampler *found = &work.edge_samplers[k];
            bis_sampler_set_spp(&wanted, 16 * times[k]);
            assert_true(found->kind == kinds[i] && found->seed == wanted.seed && found->jitter == wanted.jitter);
            assert_true(found->spp == wanted.spp && found->spp >= 16 * times[k]);
        }
        bis_workspace_clear(&work);
        bis_film_clear(&film);
    }
    clear_world(&w);
}

/* A film in a corner: what is learned is that of the whole picture, of which 2^23 pixels have cells, and more have
 * none. Squares of 32, 64, ..., 4096 pixels, by hand. */
static void what_is_learned_is_of_the_size_of_the_picture(void **state)
{
    static const struct { int height; size_t n_squares; uint32_t cells; } cases[] = {
        {2048, 128 * 64 + 64 * 32 + 32 * 16 + 16 * 8 + 8 * 4 + 4 * 2 + 2 + 1, 16},
        {2049, 128 * 65 + 64 * 33 + 32 * 17 + 16 * 9 + 8 * 5 + 4 * 3 + 2 * 2 + 1, 1},
    };
    const bis_render_options options = {.n_threads = 1};
    world w;
    make_world(&w, &bis_sir);
    choose(&w, &(setting){&bis_sir, 64, 16, BIS_PROPOSAL_PRODUCT, true, true});
    for (size_t i = 0; i < 2; i++) {
        bis_film film;
        bis_workspace work = {.scene = &w.scene, .desc = &w.desc, .view = &w.desc.view, .options = &options,
                              .film = &film};
        assert_int_equal(bis_film_init(&film, 4096, cases[i].height, (const double[]){0, 0.01, 0, 0.01}, (bis_loc){0},
                                       NULL), BIS_OK);
        assert_int_equal(bis_workspace_init(&work, NULL), BIS_OK);
        assert_int_equal(work.visibility.n_squares, cases[i].n_squares);
        assert_int_equal(work.visibility.cells, cases[i].cells);
        bis_workspace_clear(&work);
        bis_film_clear(&film);
    }
    clear_world(&w);
}

static void without_memory_for_materials_there_is_no_wave(void **state)
{
    const bis_scene_desc textured = {.textures.n_of_material = 1};
    const bis_wave_task task = {.desc = &textured};
    const long live = bis_mem_live();
    bis_wave *w = NULL;
    long k = 0;
    while (!w) {
        bis_mem_fail_at(++k);
        w = bis_wave_new(&task, NULL, NULL, NULL);
        bis_mem_fail_at(0);
        if (!w) assert_int_equal(bis_mem_live(), live);
    }
    assert_int_equal(k, 3);
    bis_wave_free(w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_learned_is_of_the_size_of_the_picture),
        cmocka_unit_test(a_look_ends_where_a_quarter_comes_through),
        cmocka_unit_test(edge_pixels_have_samplers_of_all_their_samples),
        cmocka_unit_test(squares_of_a_picture_are_those_that_have_a_pixel),
        cmocka_unit_test(each_place_is_in_the_square_around_it),
        cmocka_unit_test(squares_are_looked_at_coarse_to_fine),
        cmocka_unit_test(a_survey_counts_once_and_may_end),
        cmocka_unit_test(waves_have_the_bits_of_single_samples),
        cmocka_unit_test(a_pass_tells_its_progress_after_each_tile),
        cmocka_unit_test(one_ray_that_is_lost_changes_the_bits),
        cmocka_unit_test(many_samples_of_one_pixel_fill_several_waves),
        cmocka_unit_test(an_integrator_may_trace_its_rays_at_once),
        cmocka_unit_test(what_passes_share_and_learn_does_not_bias),
        cmocka_unit_test(without_memory_for_materials_there_is_no_wave),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
