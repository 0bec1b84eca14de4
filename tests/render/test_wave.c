/* SPDX-License-Identifier: BSD-2-Clause */
/* wave: what is rendered in waves has the bits of what is rendered one camera sample after the other, for every
 * integrator, accelerator, number of threads and size of passes. The other road is in this file: a loop over passes,
 * pixels and samples that calls Lo, and shadow rays that are traced one by one. */
#include "render/edges.h"
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(edge_pixels_have_samplers_of_all_their_samples),
        cmocka_unit_test(waves_have_the_bits_of_single_samples),
        cmocka_unit_test(one_ray_that_is_lost_changes_the_bits),
        cmocka_unit_test(many_samples_of_one_pixel_fill_several_waves),
        cmocka_unit_test(an_integrator_may_trace_its_rays_at_once),
        cmocka_unit_test(what_passes_share_and_learn_does_not_bias),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
