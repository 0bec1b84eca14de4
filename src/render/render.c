/* render: passes over tiles by threads.
 *
 * One pass is one camera sample of every pixel (with adaptive sampling several, see adapt.h). Threads take tiles in any
 * order, but what a pixel gets depends on (seed, pixel, pass) alone, and only whole passes reach the film, in order:
 * the film's bits depend on the scene and the number of passes, never on threads, time, or the moment of Ctrl-C. To
 * that end a pass is kept aside (16 bytes a pixel) and added to the film when it is complete; an abandoned one leaves
 * no trace, not even in the counters. The values of layers, where some are asked for, go the same way.
 *
 * A pixel of a crop gets what it gets in the full picture. Where a pixel learns from its neighbours (visibility.h), all
 * pixels of its tile are rendered, and those beside the crop are dropped: up to 15 columns and rows on each side.
 * Adaptive sampling weighs each tile against the whole picture, of which a crop knows nothing: there it does not hold.
 *
 * Budgets are looked at between passes. For time: another pass is begun if one of mean length still fits, so a render
 * ends at most one pass early. For error: the estimate costs a sweep over the film, so it is made at passes 4, 5, 6,
 * ... and, from 20 on, each time their number has grown by a twentieth: an unneeded 5% of passes at most, and a number
 * of passes that no clock can change.
 *
 * An error is estimated from the scatter of the passes, which tells the truth only where they are independent
 * replicates (docs/errata.md E32). The camera samples of one pixel are not: a stratified or low-discrepancy sampler
 * spreads them over the pixel, and the scatter overestimates the error, at edges twofold and more. So where an error is
 * asked for, each pass has a seed of its own. */
#include "bis/render/render.h"

#include "bis/base/clock.h"
#include "bis/base/mem.h"
#include "adapt.h"
#include "beyond/batch.h"
#include "edges.h"
#include "gather.h"

#include <assert.h>
#include <math.h>
#include <stdalign.h>
#include <string.h>

#ifdef _OPENMP
#include <omp.h>
#endif

enum { TILE = BIS_RENDER_TILE, MIN_ERROR_PASSES = 4 };

/* Of the random numbers that are seeds: beyond all purposes of sampler.c. */
static const uint64_t PURPOSE_PASS = (uint64_t)4 << 32;

static const double seconds_between_reports = 0.2;

enum { MAX_METHODS = 1 + BIS_MAX_EXCEPTIONS };

/* What one thread has for itself; a cache line of its own, for counters that change with every ray. */
typedef struct worker {
    alignas(64) bis_counters counters; /* of this pass */
    bis_scratch scratch[MAX_METHODS];
    bis_fast fast[MAX_METHODS];
} worker;

/* Settings of some materials, and what all threads share for them. */
typedef struct method {
    const bis_settings *settings; /* NULL: no material has them, nothing is made */
    bis_Lo *Lo;                   /* the integrator's own, or the vector path */
    bis_pool pool;                /* M = 0: none */
    bis_clusters clusters;        /* n = 0: none */
    bis_visibility visibility;    /* n_tiles = 0: none */
} method;

/* What a pass makes of a pixel, kept until it is complete: the mean of its camera samples. */
typedef struct sample {
    rgb L;
    float hit; /* the share that hit geometry */
} sample;

typedef struct render {
    const bis_scene *scene;
    const bis_scene_desc *desc;
    const bis_render_options *options;
    bis_film *film;
    bis_budget budget;
    bool independent; /* passes have seeds of their own */
    bis_adapt adapt;  /* n_tiles = 0: every pass is one camera sample */
    worker *workers;
    method methods[MAX_METHODS];
    int n_methods;
    bis_rect area;             /* what is rendered: the crop, or all of its tiles */
    unsigned char *edge;       /* edge[][] of the area, see edges.h; NULL: all pixels are alike */
    bis_sampler edge_sampler;  /* all camera samples of an edge pixel */
    int n_threads;
    sample *pass;       /* pass[height][width] of the crop */
    float *pass_layers; /* pass_layers[height][width][film->layers.n_values]: the same of the layers, NULL where there are none */
    bis_xform to_camera;
    int n_tiles;      /* bis_film_tiles */
    bool whole_tiles; /* of which pixels beside the crop are rendered as well */
    uint32_t most_passes; /* of budget.spp; 0: not limited by it */
    double start, last_report;
    double rmse, rmse_upper; /* as last estimated; NAN: not yet */
    bis_counters counters;
    uint32_t passes;
} render;

int bis_render_threads(const bis_render_options *options)
{
#ifdef _OPENMP
    return options->n_threads > 0 ? options->n_threads : omp_get_max_threads();
#else
    (void)options;
    return 1;
#endif
}

static int this_thread(void)
{
#ifdef _OPENMP
    return omp_get_thread_num();
#else
    return 0;
#endif
}

static void add_counters(bis_counters *sum, const bis_counters *c)
{
    sum->camera_rays += c->camera_rays;
    sum->shadow_rays += c->shadow_rays;
    sum->candidates += c->candidates;
    sum->accepted += c->accepted;
    sum->fallbacks += c->fallbacks;
    sum->nonfinite += c->nonfinite;
}

/* --- one camera sample
 * --------------------------------------------------------------------------------------------- */

/* A NaN or infinity must not reach the film. */
static rgb finite_or_black(worker *w, rgb L)
{
    if (rgb_is_finite(L)) return L;
    w->counters.nonfinite++;
    return (rgb){0};
}

/* Light reflected towards the eye, eq. 3.1; what layers want to know is added to values, unless NULL. */
static rgb reflected(const render *r, worker *w, const bis_point *pt, bis_stream *stream, float *values)
{
    const int m = bis_scene_method_of(r->desc, bis_scene_material_of(r->desc, pt));
    const bis_settings *settings = r->methods[m].settings;
    bis_scratch *scratch = &w->scratch[m];
    const bis_stream before = *stream;
    rgb L = {0};

    if (!bis_bsdf_is_black(&pt->bsdf)) L = finite_or_black(w, r->methods[m].Lo(settings, pt, stream, scratch));
    if (values && !bis_gather_surface(values, &r->film->layers, settings, r->methods[m].Lo, &r->to_camera, pt, before, scratch, L)) w->counters.nonfinite++;
    return L;
}

static rgb metered(const render *r, worker *w, const bis_point *pt, bis_stream *stream, float *values)
{
    const bis_meter *m = r->options->meter;
    const unsigned char g = m->group[bis_scene_material_of(r->desc, pt)];
    const double start = bis_clock_processor();
    const rgb L = reflected(r, w, pt, stream, values);

    m->seconds[g] += bis_clock_processor() - start;
    m->points[g]++;
    return L;
}

/* Camera sample `index` of the film's pixel (x, y); *hits counts those that hit. A ray that escapes sees the map. values: for the
 * layers, or NULL. */
static rgb camera_sample(const render *r, worker *w, const bis_sampler *sampler, int x, int y, uint64_t index, uint32_t *hits, float *values)
{
    const bis_film *f = r->film;
    const bis_counters before = w->counters;
    double u[2] = {0.5, 0.5};
    bis_stream stream;
    bis_point pt;
    rgb L;

    x = x * f->step + f->step / 2; /* of the picture */
    y = y * f->step + f->step / 2;
    bis_stream_init(&stream, sampler, (uint64_t)y * (uint64_t)f->picture_width + (uint64_t)x, index);
    if (r->desc->pixel_jitter) bis_stream_camera(&stream, u);
    for (int i = 0; i < 2 && r->options->footprint > 0; i++) u[i] = 0.5 + (u[i] - 0.5) * r->options->footprint;
    const ray eye = bis_camera_ray(&r->desc->camera, f->picture_width, f->picture_height, x + u[0], y + u[1]);
    w->counters.camera_rays++;
    if (bis_scene_point(&pt, r->scene, r->desc, eye, &w->counters, NULL)) {
        ++*hits;
        L = r->options->meter ? metered(r, w, &pt, &stream, values) : reflected(r, w, &pt, &stream, values);
    } else {
        L = finite_or_black(w, r->desc->light.visible ? bis_light_Le(r->scene->light, eye.d) : (rgb){0});
    }
    if (values) bis_gather_counts(values, &f->layers, &before, &w->counters);
    return L;
}

/* What a pass makes of pixel (x, y): the mean of n camera samples, `first` and those after it. */
static sample pixel_sample(const render *r, worker *w, const bis_sampler *sampler, int x, int y, uint64_t first, uint32_t n, float *values)
{
    uint32_t hits = 0;
    rgb L = camera_sample(r, w, sampler, x, y, first, &hits, values);
    if (n == 1) return (sample){L, (float)hits};

    rgbd sum = {(double)L.r, (double)L.g, (double)L.b};
    for (uint32_t i = 1; i < n; i++) {
        L = camera_sample(r, w, sampler, x, y, first + i, &hits, values);
        sum = rgbd_add(sum, (rgbd){(double)L.r, (double)L.g, (double)L.b});
    }
    if (values) bis_gather_mean(values, &r->film->layers, n);
    return (sample){rgbd_round(rgbd_scale(sum, 1 / (double)n)), (float)hits / (float)n};
}

/* --- one pass
 * ------------------------------------------------------------------------------------------------------ */

/* The layers' values of pixel number i of the pass under way, or NULL. */
static float *layers_at(const render *r, size_t i) { return r->pass_layers ? r->pass_layers + i * (size_t)r->film->layers.n_values : NULL; }

static bool interrupted(const render *r) { return r->options->interrupted && *r->options->interrupted; }

/* The sampler of a pass that is independent of all others: n camera samples with a seed of their own. */
static bis_sampler sampler_of_pass(const render *r, uint32_t pass, uint32_t n)
{
    bis_sampler s = r->desc->sampler;
    bis_rng rng;

    bis_rng_init(&rng, s.seed, pass, 0, PURPOSE_PASS);
    s.seed = bis_rng_u64(&rng);
    bis_sampler_set_spp(&s, n);
    return s;
}

static bis_rect tile_of(const render *r, int t) { return r->whole_tiles ? bis_film_tile(r->film, TILE, t) : bis_film_tile_of_crop(r->film, TILE, t); }

static size_t index_in(bis_rect area, int x, int y) { return (size_t)(y - area.y0) * (size_t)(area.x1 - area.x0) + (size_t)(x - area.x0); }

/* Tile number t. The flag is looked at for each pixel: one of `exact` under a large map takes a tenth
 * of a second. */
static void render_tile(const render *r, worker *w, int t, uint32_t pass)
{
    const bis_film *f = r->film;
    const uint32_t n = r->adapt.n_tiles ? r->adapt.samples[t] : 1, edge_n = r->edge ? n * r->desc->edge_samples : n;
    const bis_sampler sampler = r->independent ? sampler_of_pass(r, pass, n) : r->desc->sampler;
    const bis_sampler edge_sampler = r->independent ? sampler_of_pass(r, pass, edge_n) : r->edge_sampler;
    const bis_rect tile = tile_of(r, t);

    for (int m = 0; m < r->n_methods; m++) {
        const method *of = &r->methods[m];
        if (!of->visibility.n_tiles) continue;
        bis_visibility_factors(w->fast[m].visible, of->clusters.n, &of->visibility, (size_t)t);
        w->fast[m].counted = of->visibility.counted[t];
    }
    for (int y = tile.y0; y < tile.y1; y++) {
        for (int x = tile.x0; x < tile.x1; x++) {
            if (interrupted(r)) return;
            const bool in_crop = x >= f->x0 && x < f->x0 + f->width && y >= f->y0 && y < f->y0 + f->height;
            const size_t i = in_crop ? (size_t)(y - f->y0) * (size_t)f->width + (size_t)(x - f->x0) : 0;
            float *values = in_crop ? layers_at(r, i) : NULL;
            if (values) memset(values, 0, (size_t)f->layers.n_values * sizeof *values);
            const bool edge = r->edge && r->edge[index_in(r->area, x, y)];
            const uint32_t samples = edge ? edge_n : n; /* 64 x 1024 at most */
            const uint64_t first = r->independent ? 0 : (uint64_t)pass * samples;
            const sample s = pixel_sample(r, w, edge ? &edge_sampler : &sampler, x, y, first, samples, values);
            if (in_crop) r->pass[i] = s;
        }
    }
}

/* How much of the budget is used up, and how long it will last, with `share` of the pass under way done. */
static void report(render *r, double share)
{
    bis_progress p = {.passes_done = r->passes, .passes_total = r->most_passes, .seconds_left = (double)NAN};

    if (!r->options->progress) return;
    r->last_report = bis_clock_now();
    p.seconds = r->last_report - r->start;
    if (r->most_passes) p.share = (r->passes + share) / r->most_passes;
    if (r->budget.seconds > 0) p.share = fmax(p.share, p.seconds / r->budget.seconds);
    /* The error falls with the root of the number of passes (docs/errata.md E9). */
    if (r->budget.error > 0 && r->rmse_upper > 0) p.share = fmax(p.share, pow(r->budget.error / r->rmse_upper, 2));
    p.share = fmin(p.share, 1); /* the first pass may exceed the time */
    if (p.share > 0) p.seconds_left = p.seconds * (1 - p.share) / p.share;
    r->options->progress(&p, r->options->user);
}

/* Two methods may draw the same directions: they serve different points, as one pool serves many. */
static void fill(const render *r, method *of)
{
    if (of->clusters.n) bis_clusters_fill(&of->clusters, r->scene->light, r->desc->sampler.seed, r->passes, r->n_threads);
    if (of->pool.M) bis_pool_fill(&of->pool, r->scene->light, r->desc->sampler.seed, r->passes, r->n_threads);
}

/* False: interrupted, not all pixels were done. */
static bool render_pass(render *r)
{
    int n_done = 0;

    for (int i = 0; i < r->n_threads; i++) r->workers[i].counters = (bis_counters){0};
    for (int m = 0; m < r->n_methods; m++) fill(r, &r->methods[m]);
#pragma omp parallel for schedule(dynamic) num_threads(r->n_threads)
    for (int t = 0; t < r->n_tiles; t++) {
        worker *w = &r->workers[this_thread()];
        int done;
        render_tile(r, w, t, r->passes);
#pragma omp atomic capture
        done = ++n_done;
        if (this_thread() == 0 && bis_clock_now() - r->last_report > seconds_between_reports) report(r, (double)done / r->n_tiles);
    }
    return !interrupted(r);
}

static void keep_pass(render *r)
{
    bis_film *f = r->film;

#pragma omp parallel for num_threads(r->n_threads)
    for (int y = 0; y < f->height; y++) {
        for (int x = 0; x < f->width; x++) {
            size_t i = (size_t)y * (size_t)f->width + (size_t)x;
            bis_film_add(f, f->x0 + x, f->y0 + y, r->pass[i].L, (double)r->pass[i].hit);
            if (r->pass_layers) bis_layers_add(&f->layers, i, layers_at(r, i));
        }
    }
    for (int i = 0; i < r->n_threads; i++) add_counters(&r->counters, &r->workers[i].counters);
    for (int m = 0; m < r->n_methods; m++) bis_visibility_learn(&r->methods[m].visibility, r->n_threads);
    f->passes++;
}

/* What the error budget will take, as far as the pilot knows: the error falls with the root of the number of passes. */
static void forecast(render *r)
{
    const double factor = pow(r->rmse_upper / r->budget.error, 2), spp = r->passes * (r->adapt.n_tiles ? BIS_ADAPT_SAMPLES : 1);
    const bis_forecast f = {.error = r->rmse_upper, .spp = factor * spp, .seconds = factor * (bis_clock_now() - r->start)};

    if (!r->options->forecast) return;
    r->options->forecast(&f, r->options->user);
}

/* --- all passes
 * ---------------------------------------------------------------------------------------------------- */

/* May another pass begin? One has been completed. */
static bool budget_left(render *r, uint32_t *next_check)
{
    const bis_budget *b = &r->budget;

    if (interrupted(r)) return false;
    if (r->most_passes && r->passes >= r->most_passes) return false;
    if (r->passes == UINT32_MAX) return false;
    if (b->seconds > 0) {
        double spent = bis_clock_now() - r->start;
        if (spent + spent / r->passes > b->seconds) return false;
    }
    if (b->error > 0 && r->passes >= *next_check) {
        bool first = *next_check == MIN_ERROR_PASSES;
        r->rmse = bis_film_relative_rmse(r->film, &r->rmse_upper);
        *next_check = r->passes + 1 + r->passes / 20;
        if (r->rmse_upper <= b->error) return false;
        if (first) forecast(r);
    }
    return true;
}

static void render_passes(render *r, bis_render_result *result)
{
    uint32_t next_check = MIN_ERROR_PASSES;
    bool complete;

    do {
        complete = render_pass(r);
        if (complete) {
            keep_pass(r);
            r->passes++;
            if (r->adapt.n_tiles) bis_adapt_next(&r->adapt, r->film);
        }
    } while (complete && budget_left(r, &next_check));
    result->seconds = bis_clock_now() - r->start;
    /* where all passes are done, it came too late */
    result->interrupted = interrupted(r) && !(r->most_passes && r->passes >= r->most_passes);
    report(r, 0);
}

static bis_status make_workers(render *r, bis_diag *diag)
{
    bis_status status = BIS_OK;

    r->workers = bis_alloc((size_t)r->n_threads, sizeof *r->workers);
    if (!r->workers) return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for %d threads", r->n_threads);
    r->n_methods = 1 + r->desc->exceptions.n;
    for (int m = 0; m < r->n_methods; m++) {
        const bis_settings *settings = bis_scene_settings(r->desc, m);
        if (!bis_scene_uses_method(r->desc, m)) continue;
        r->methods[m].settings = settings;
        r->methods[m].Lo = bis_fast_Lo(settings);
        for (int i = 0; i < r->n_threads && !status; i++) {
            worker *w = &r->workers[i];
            status = bis_scratch_init(&w->scratch[m], settings, diag);
            if (!status) status = bis_fast_init(&w->fast[m], settings, diag);
            w->scratch[m].fast = &w->fast[m];
        }
    }
    return status;
}

/* Room for the pass under way. */
static bis_status make_pass(render *r, bis_diag *diag)
{
    const bis_film *f = r->film;
    const size_t n = (size_t)f->width * (size_t)f->height, n_values = (size_t)f->layers.n_values;

    r->pass = bis_alloc(n, sizeof *r->pass);
    if (r->pass && n_values) r->pass_layers = bis_alloc(n, n_values * sizeof *r->pass_layers);
    if (r->pass && (r->pass_layers || !n_values)) return BIS_OK;
    return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for a pass of %d x %d pixels", f->width, f->height);
}

/* Directions drawn once a pass, a pool or clusters, where the integrator asks for them, the light has a curve to draw
 * them along, and there is a surface to light. */
static bis_status make_pool(render *r, int m, bis_diag *diag)
{
    const bis_light *light = r->scene->light;
    method *of = &r->methods[m];
    const bis_fast_needs needs = bis_fast_needs_of(of->settings);
    bis_light_point any;
    bis_status status = BIS_OK;

    if ((needs.n_pool == 0 && !needs.clusters) || !r->scene->accel || bis_light_is_constant(light)) return BIS_OK;
    if (!bis_light_sample_curve(light, 0, (double[2]){0, 0}, &any)) return BIS_OK; /* nothing to draw: black, or all of it compensated away */
    if (needs.n_pool) status = bis_pool_init(&of->pool, needs.n_pool, needs.batch, diag);
    if (!status && needs.clusters) status = bis_clusters_init(&of->clusters, light, of->settings->candidates, diag);
    if (!status && needs.visibility) status = bis_visibility_init(&of->visibility, (size_t)r->n_tiles, diag);
    for (int i = 0; !status && i < r->n_threads; i++) {
        worker *w = &r->workers[i];
        bis_fast *f = &w->fast[m];
        if (needs.n_pool) {
            w->scratch[m].sets = &of->pool.sets;
            f->pool = &of->pool;
        }
        if (needs.clusters) f->clusters = &of->clusters;
        if (needs.visibility && !(f->visible = bis_alloc(bis_lanes_round_up(of->clusters.n), sizeof *f->visible))) {
            status = bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for the visibility of %u clusters", (unsigned)of->clusters.n);
        }
    }
    return status;
}

/* After make_pool, which knows who learns. */
static void find_area(render *r)
{
    for (int m = 0; m < r->n_methods; m++) r->whole_tiles |= r->methods[m].visibility.n_tiles > 0 && !r->desc->adaptive;
    const bis_rect first = tile_of(r, 0), last = tile_of(r, r->n_tiles - 1);
    r->area = (bis_rect){first.x0, first.y0, last.x1, last.y1};
}

/* Where they are asked for, camera rays are not all the same, and there is something to see. */
static bis_status find_edges(render *r, bis_diag *diag)
{
    const int width = r->area.x1 - r->area.x0, height = r->area.y1 - r->area.y0;

    if (r->desc->edge_samples <= 1 || !r->desc->pixel_jitter || !r->scene->accel) return BIS_OK;
    r->edge_sampler = r->desc->sampler;
    bis_sampler_set_spp(&r->edge_sampler, (uint64_t)r->desc->sampler.spp * r->desc->edge_samples);
    r->edge = bis_edges_find(r->film, r->area, r->scene, r->desc, r->n_threads);
    if (!r->edge) return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for the edges of %d x %d pixels", width, height);
    r->counters.camera_rays += bis_edges_rays(r->film, r->area);
    return BIS_OK;
}

static size_t workspace(const render *r)
{
    const size_t pixel = sizeof *r->pass + (size_t)r->film->layers.n_values * sizeof *r->pass_layers;
    size_t methods = 0;

    for (int m = 0; m < r->n_methods; m++) {
        const method *of = &r->methods[m];
        if (!of->settings) continue;
        methods += bis_pool_bytes(&of->pool) + bis_clusters_bytes(&of->clusters) + bis_visibility_bytes(&of->visibility) +
                   (size_t)r->n_threads * (bis_scratch_bytes(of->settings) + bis_fast_bytes(of->settings));
    }
    return methods + bis_adapt_bytes(&r->adapt) + (size_t)r->n_threads * sizeof *r->workers + (size_t)r->film->width * (size_t)r->film->height * pixel;
}

bis_status bis_render(bis_render_result *result, bis_film *film, const bis_scene *scene, const bis_scene_desc *desc,
                      const bis_render_options *options, bis_diag *diag)
{
    render r = {
        .scene = scene,
        .desc = desc,
        .options = options,
        .film = film,
        .budget = options->budget,
        .independent = options->budget.error > 0 || desc->adaptive,
        .n_threads = bis_render_threads(options),
        .to_camera = bis_xform_inverse(&desc->camera.to_world),
        .rmse = (double)NAN,
        .rmse_upper = (double)NAN,
    };
    bis_status status;
    int across;

    *result = (bis_render_result){.relative_rmse = (double)NAN, .error_bound = (double)NAN};
    assert(film->passes == 0);
    if (!r.budget.spp && !(r.budget.seconds > 0) && !(r.budget.error > 0)) r.budget.spp = (uint32_t)desc->sampler.spp;
    r.most_passes = desc->adaptive ? r.budget.spp / BIS_ADAPT_SAMPLES + (r.budget.spp % BIS_ADAPT_SAMPLES > 0) : r.budget.spp;
    r.n_tiles = bis_film_tiles(film, TILE, &across);
    status = make_workers(&r, diag);
    for (int m = 0; m < r.n_methods && !status; m++)
        if (r.methods[m].settings) status = make_pool(&r, m, diag);
    find_area(&r);
    if (!status) status = make_pass(&r, diag);
    if (!status && desc->adaptive) status = bis_adapt_init(&r.adapt, film, TILE, diag);
    r.start = r.last_report = bis_clock_now();
    if (!status) status = find_edges(&r, diag);
    if (status) goto done;
    render_passes(&r, result);
    result->counters = r.counters;
    result->relative_rmse = bis_film_relative_rmse(film, &result->error_bound);
    result->passes = r.passes;
    result->spp = desc->adaptive ? (uint64_t)r.passes * BIS_ADAPT_SAMPLES : r.passes;
    result->n_threads = r.n_threads;
    result->bytes = workspace(&r);
done:
    for (int m = 0; m < r.n_methods; m++) {
        for (int i = 0; i < r.n_threads; i++) {
            bis_scratch_clear(&r.workers[i].scratch[m]);
            bis_fast_clear(&r.workers[i].fast[m]);
        }
        bis_pool_clear(&r.methods[m].pool);
        bis_clusters_clear(&r.methods[m].clusters);
        bis_visibility_clear(&r.methods[m].visibility);
    }
    bis_adapt_clear(&r.adapt);
    bis_free(r.workers);
    bis_free(r.pass);
    bis_free(r.pass_layers);
    bis_free(r.edge);
    return status;
}
