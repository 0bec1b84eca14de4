/* pass: from a camera sample to the film.
 *
 * One pass is one camera sample of every pixel (with adaptive sampling several, see adapt.h; in edge pixels several,
 * see edges.h). Threads take tiles in any order, but what a pixel gets depends on (seed, pixel, pass) alone, and only
 * whole passes reach the film, in order: the film's bits depend on the scene and the number of passes, never on
 * threads, time, or the moment of Ctrl-C. To that end a pass is kept aside (16 bytes a pixel) and added to the film
 * when it is complete; an abandoned one leaves no trace, not even in the counters. The values of layers go the same
 * way.
 *
 * A pixel of a crop gets what it gets in the full picture. Where a pixel learns from its neighbours (visibility.h), all
 * pixels of its tile are rendered, and those beside the crop are dropped: up to 15 columns and rows on each side. */
#include "pass.h"

#include "gather.h"

#include <string.h>

#ifdef _OPENMP
#include <omp.h>
#endif

/* Of the random numbers that are seeds: beyond all purposes of sampler.c. */
static const uint64_t PURPOSE_PASS = (uint64_t)4 << 32;

static int this_thread(void)
{
#ifdef _OPENMP
    return omp_get_thread_num();
#else
    return 0;
#endif
}

bool bis_pass_interrupted(const bis_workspace *w)
{
    return w->options->interrupted && *w->options->interrupted;
}

/* --- one camera sample -------------------------------------------------------------------------------------------- */

/* A NaN or infinity must not reach the film. */
static rgb finite_or_black(bis_worker *me, rgb L)
{
    if (rgb_is_finite(L)) return L;
    me->counters.nonfinite++;
    return (rgb){0};
}

/* Light reflected towards the eye, eq. 3.1. Adds to values what the layers show of it, unless values is NULL. */
static rgb reflected(const bis_workspace *w, bis_worker *me, const bis_point *pt, bis_stream *stream, float *values)
{
    const bis_settings *settings = &w->view->settings;
    const bis_stream before = *stream;
    rgb L = {0};

    if (!bis_bsdf_is_black(&pt->bsdf)) L = finite_or_black(me, w->Lo(settings, pt, stream, &me->scratch));
    if (values && !bis_gather_surface(values, &w->film->layers, settings, w->Lo, &w->to_camera, pt, before,
                                      &me->scratch, L)) {
        me->counters.nonfinite++;
    }
    return L;
}

/* Camera sample `index` of the film's pixel (x, y); *hits counts those that hit. A ray that escapes sees the map.
 * values: for the layers, or NULL. */
static rgb camera_sample(const bis_workspace *w, bis_worker *me, const bis_sampler *sampler, int x, int y,
                         uint64_t index, uint32_t *hits, float *values)
{
    const bis_film *f = w->film;
    const bis_counters before = me->counters;
    double u[2] = {0.5, 0.5};
    bis_stream stream;
    bis_point pt;
    rgb L;

    x = x * f->step + f->step / 2; /* of the picture */
    y = y * f->step + f->step / 2;
    bis_stream_init(&stream, sampler, (uint64_t)y * (uint64_t)f->picture_width + (uint64_t)x, index);
    if (w->view->pixel_jitter) bis_stream_camera(&stream, u);
    for (int i = 0; i < 2 && w->options->footprint > 0; i++) u[i] = 0.5 + (u[i] - 0.5) * w->options->footprint;
    const ray eye = bis_camera_ray(&w->view->camera, f->picture_width, f->picture_height, x + u[0], y + u[1]);
    me->counters.camera_rays++;
    if (bis_scene_point(&pt, w->scene, w->desc, eye, &me->counters, NULL)) {
        ++*hits;
        L = reflected(w, me, &pt, &stream, values);
    } else {
        L = finite_or_black(me, w->desc->light.visible ? bis_light_Le(w->scene->light, eye.d) : (rgb){0});
    }
    if (values) bis_gather_counts(values, &f->layers, &before, &me->counters);
    return L;
}

/* What a pass makes of pixel (x, y): the mean of n camera samples, `first` and those after it. */
static bis_pixel_mean pixel_sample(const bis_workspace *w, bis_worker *me, const bis_sampler *sampler, int x, int y,
                                   uint64_t first, uint32_t n, float *values)
{
    uint32_t hits = 0;
    rgb L = camera_sample(w, me, sampler, x, y, first, &hits, values);
    if (n == 1) return (bis_pixel_mean){L, (float)hits};

    rgbd sum = {(double)L.r, (double)L.g, (double)L.b};
    for (uint32_t i = 1; i < n; i++) {
        L = camera_sample(w, me, sampler, x, y, first + i, &hits, values);
        sum = rgbd_add(sum, (rgbd){(double)L.r, (double)L.g, (double)L.b});
    }
    if (values) bis_gather_mean(values, &w->film->layers, n);
    return (bis_pixel_mean){rgbd_round(rgbd_scale(sum, 1 / (double)n)), (float)hits / (float)n};
}

/* --- one pass -------------------------------------------------------------------------------------------------------
 */

/* The sampler of a pass that is independent of all others: n camera samples with a seed of their own. */
static bis_sampler sampler_of_pass(const bis_workspace *w, uint32_t pass, uint32_t n)
{
    bis_sampler s = w->view->sampler;
    bis_rng rng;

    bis_rng_init(&rng, s.seed, pass, 0, PURPOSE_PASS);
    s.seed = bis_rng_u64(&rng);
    bis_sampler_set_spp(&s, n);
    return s;
}

static size_t index_in(bis_rect area, int x, int y)
{
    return (size_t)(y - area.y0) * (size_t)(area.x1 - area.x0) + (size_t)(x - area.x0);
}

/* Tile number t. The flag of interruption is read for each pixel, because one pixel of `exact` under a large map takes
 * a tenth of a second. */
static void render_tile(const bis_workspace *w, bis_worker *me, int t, uint32_t pass)
{
    const bis_film *f = w->film;
    const uint32_t n = w->adapt.n_tiles ? w->adapt.samples[t] : 1, edge_n = w->edge ? n * w->view->edge_samples : n;
    const bis_sampler sampler = w->independent ? sampler_of_pass(w, pass, n) : w->view->sampler;
    const bis_sampler edge_sampler = w->independent ? sampler_of_pass(w, pass, edge_n) : w->edge_sampler;
    const bis_rect tile = bis_workspace_tile(w, t);

    if (w->visibility.n_tiles) {
        bis_visibility_factors(me->fast.visible, w->clusters.n, &w->visibility, (size_t)t);
        me->fast.counted = w->visibility.counted[t];
    }
    for (int y = tile.y0; y < tile.y1; y++) {
        for (int x = tile.x0; x < tile.x1; x++) {
            if (bis_pass_interrupted(w)) return;
            const bool in_crop = x >= f->x0 && x < f->x0 + f->width && y >= f->y0 && y < f->y0 + f->height;
            const size_t i = in_crop ? (size_t)(y - f->y0) * (size_t)f->width + (size_t)(x - f->x0) : 0;
            float *values = in_crop ? bis_workspace_layers(w, i) : NULL;
            if (values) memset(values, 0, (size_t)f->layers.n_values * sizeof *values);
            const bool edge = w->edge && w->edge[index_in(w->area, x, y)];
            const uint32_t samples = edge ? edge_n : n; /* 64 x 1024 at most */
            const uint64_t first = w->independent ? 0 : (uint64_t)pass * samples;
            const bis_pixel_mean mean =
                pixel_sample(w, me, edge ? &edge_sampler : &sampler, x, y, first, samples, values);
            if (in_crop) w->pass[i] = mean;
        }
    }
}

bool bis_pass_render(bis_workspace *w, uint32_t pass, bis_pass_progress *progress, void *user)
{
    const uint64_t seed = w->view->sampler.seed;
    int n_done = 0;

    for (int i = 0; i < w->n_threads; i++) w->workers[i].counters = (bis_counters){0};
    if (w->clusters.n) bis_clusters_fill(&w->clusters, w->scene->light, seed, pass, w->n_threads);
    if (w->pool.M) bis_pool_fill(&w->pool, w->scene->light, seed, pass, w->n_threads);
#pragma omp parallel for schedule(dynamic) num_threads(w->n_threads)
    for (int t = 0; t < w->n_tiles; t++) {
        bis_worker *me = &w->workers[this_thread()];
        int done;
        render_tile(w, me, t, pass);
#pragma omp atomic capture
        done = ++n_done;
        if (this_thread() == 0) progress((double)done / w->n_tiles, user);
    }
    return !bis_pass_interrupted(w);
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

void bis_pass_keep(bis_workspace *w, bis_counters *sum)
{
    bis_film *f = w->film;

#pragma omp parallel for num_threads(w->n_threads)
    for (int y = 0; y < f->height; y++) {
        for (int x = 0; x < f->width; x++) {
            size_t i = (size_t)y * (size_t)f->width + (size_t)x;
            bis_film_add(f, f->x0 + x, f->y0 + y, w->pass[i].L, (double)w->pass[i].hit);
            if (w->pass_layers) bis_layers_add(&f->layers, i, bis_workspace_layers(w, i));
        }
    }
    for (int i = 0; i < w->n_threads; i++) add_counters(sum, &w->workers[i].counters);
    bis_visibility_learn(&w->visibility, w->n_threads);
    f->passes++;
}

