/* SPDX-License-Identifier: BSD-2-Clause */
/* workspace: what the threads of a render work with. A scene pays only for what its settings use: without
 * a need for them there are no pool, no clusters and no learned visibility. */
#include "workspace.h"
#include "thesis/set.h"

#include "bis/base/mem.h"
#include "ranks.h"
#include "share.h"
#include "survey.h"
#include "windows.h"

#include <inttypes.h>

int bis_render_threads(const bis_render_options *options)
{
#ifdef _OPENMP
    return options->n_threads > 0 ? options->n_threads : omp_get_max_threads();
#else
    (void)options;
    return 1;
#endif
}

void bis_counters_add(bis_counters *sum, const bis_counters *c)
{
    sum->camera_rays += c->camera_rays;
    sum->shadow_rays += c->shadow_rays;
    sum->candidates += c->candidates;
    sum->accepted += c->accepted;
    sum->fallbacks += c->fallbacks;
    sum->nonfinite += c->nonfinite;
    sum->beside_portals += c->beside_portals;
}

bis_rect bis_workspace_tile(const bis_workspace *w, int t)
{
    return w->whole_tiles ? bis_film_tile(w->film, BIS_RENDER_TILE, t)
                          : bis_film_tile_of_crop(w->film, BIS_RENDER_TILE, t);
}

float *bis_workspace_layers(const bis_workspace *w, size_t i)
{
    return w->pass_layers ? w->pass_layers + i * (size_t)w->film->layers.n_values : NULL;
}

static bis_status make_workers(bis_workspace *w, bis_diag *diag)
{
    const bis_settings *settings = &w->view->settings;
    bis_status status = BIS_OK;

    w->workers = bis_alloc((size_t)w->n_threads, sizeof *w->workers);
    if (!w->workers) return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for %d threads", w->n_threads);
    const bis_wave_task task = {.scene = w->scene, .desc = w->desc, .view = w->view, .film = w->film,
                                .to_camera = &w->to_camera, .options = w->options};
    for (int i = 0; i < w->n_threads && !status; i++) {
        bis_worker *worker = &w->workers[i];
        status = bis_scratch_init(&worker->scratch, settings, diag);
        if (status) continue;
        worker->wave = bis_wave_new(&task, &worker->scratch, &worker->guide, &worker->counters);
        if (!worker->wave) status = bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for a thread's camera samples");
    }
    return status;
}

/* Of the whole picture, so that a crop learns as the whole does. */
static uint64_t pixels_of(const bis_film *f) { return (uint64_t)f->full_width * (uint64_t)f->full_height; }

static bis_status make_clusters(bis_workspace *w, bis_diag *diag)
{
    const bis_light_desc *desc = &w->desc->light;
    bis_clusters *const both[] = {&w->clusters, &w->of_twins};
    bis_portal windows[BIS_PORTALS_MAX];
    uint32_t n = 0;
    bis_status status = BIS_OK;

    if (desc->windows && !desc->n_portals)
        status = bis_windows_find(windows, &n, w->scene, &w->view->camera, w->film, diag);
    for (int i = 0; i < (w->film->twin ? 2 : 1) && !status; i++) {
        status = bis_clusters_init(both[i], w->scene->light, w->view->settings.candidates, diag);
        if (!status && n) bis_clusters_open(both[i], windows, n);
    }
    return status;
}

/* Directions drawn once a pass, a pool or clusters, where they are of use and there is a surface to light. */
static bis_status make_pool(bis_workspace *w, bis_diag *diag)
{
    const bis_light *light = w->scene->light;
    bis_visibility *visibility = NULL;
    bis_status status = BIS_OK;

    if (!w->scene->accel) return BIS_OK;
    /* of one surface a constant light is exact by the BRDF alone, if it hides nothing of itself, as most do not */
    if (bis_light_is_constant(light) && bis_geometry_primitives(&w->scene->geometry) == 1) return BIS_OK;
    const bis_beyond_needs needs = bis_beyond_needs_under(&w->view->settings, light);
    if (needs.n_pool == 0 && !needs.clusters) return BIS_OK;
    if (needs.n_pool) status = bis_pool_init(&w->pool, needs.n_pool, diag);
    if (!status && needs.clusters) status = make_clusters(w, diag);
    if (!status && needs.visibility)
        status = bis_visibility_init(&w->visibility, (size_t)w->n_tiles, bis_survey_squares(w->film),
                                     pixels_of(w->film), diag);
    if (!status && needs.visibility) bis_survey_place(&w->visibility, w->film);
    if (needs.visibility) visibility = &w->visibility;
    for (int i = 0; !status && i < w->n_threads; i++) {
        bis_worker *worker = &w->workers[i];
        if (needs.clusters)
            status = bis_product_guide_init(&worker->guide, &w->clusters, visibility, diag);
        bis_scratch_share(&worker->scratch, needs.n_pool ? &w->pool.sets : NULL,
                          needs.clusters ? &worker->guide.steps : NULL);
    }
    return status;
}

/* After make_pool, which knows whether visibility is learned. */
static void find_area(bis_workspace *w)
{
    w->whole_tiles = w->visibility.n_tiles > 0;
    const bis_rect first = bis_workspace_tile(w, 0), last = bis_workspace_tile(w, w->n_tiles - 1);
    w->area = (bis_rect){first.x0, first.y0, last.x1, last.y1};
}

/* The pass under way has sums of its own, because the film gets whole passes only, in their order: so an interrupted
 * pass leaves no trace, and threads need no lock. */
static bis_status make_pass(bis_workspace *w, bis_diag *diag)
{
    const bis_film *f = w->film;
    const size_t n = (size_t)f->width * (size_t)f->height, n_values = (size_t)f->layers.n_values;

    w->pass = bis_alloc(n, sizeof *w->pass);
    if (w->pass && n_values) w->pass_layers = bis_alloc(n, n_values * sizeof *w->pass_layers);
    if (w->options->first_light) w->fine = bis_alloc((size_t)w->n_tiles, 1);
    if (f->twin) w->pass_twins = bis_alloc(bis_film_twins(f), sizeof *w->pass_twins);
    const bool has_all = w->pass && (w->pass_layers || !n_values) && (w->fine || !w->options->first_light) &&
                         (w->pass_twins || !f->twin);
    if (has_all) return BIS_OK;
    return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for a pass of %d x %d pixels", f->width, f->height);
}

/* The tiles of a part, or all, and of these the share of a rank. A part must have a tile, because an empty file would
 * say nothing when it is merged. */
static bis_status find_own_tiles(bis_workspace *w, bis_diag *diag)
{
    const bis_part part = w->options->part;

    const bis_ranks *ranks = w->options->ranks;

    w->n_own = w->n_tiles;
    if (ranks)
        return bis_share_tiles(&w->share, &w->n_share, w->film,
                               (bis_part){(uint32_t)ranks->rank + 1, (uint32_t)ranks->size}, diag);
    if (!part.n) return BIS_OK;
    if (part.n > (uint32_t)w->n_tiles)
        return bis_error(diag, BIS_INPUT, (bis_loc){0},
                         "a picture of %d x %d pixels has %d tiles of %d x %d: %d parts at most, not %" PRIu32,
                         w->film->width, w->film->height, w->n_tiles, BIS_RENDER_TILE, BIS_RENDER_TILE, w->n_tiles,
                         part.n);
    return bis_share_tiles(&w->own, &w->n_own, w->film, part, diag);
}

bis_status bis_workspace_init(bis_workspace *w, bis_diag *diag)
{
    int across;

    w->to_camera = bis_xform_inverse(&w->view->camera.to_world);
    w->n_threads = bis_render_threads(w->options);
    w->late = HUGE_VAL;
    w->n_tiles = bis_film_tiles(w->film, BIS_RENDER_TILE, &across);
    bis_status status = find_own_tiles(w, diag);
    if (!status) status = make_workers(w, diag);
    if (!status) status = make_pool(w, diag);
    find_area(w);
    if (!status) status = make_pass(w, diag);
    return status;
}

/* Two parts trace the corners between their tiles twice, but only one counts them, so that the sum over parts is that
 * of the picture. */
uint64_t bis_workspace_edge_rays(const bis_workspace *w)
{
    uint64_t n = 0;

    if (!w->edge) return 0;
    if (!w->own) return bis_edges_rays(w->film, w->area, w->area);
    for (int i = 0; i < w->n_own; i++) n += bis_edges_rays(w->film, w->area, bis_workspace_tile(w, w->own[i]));
    return n;
}

static bool find_edges_of(bis_workspace *w, const int *tiles, int n, const double *turns)
{
    const bis_edge_eye from = {w->film, w->scene, w->view, turns};
    bool good = true;

#pragma omp parallel for schedule(dynamic) num_threads(w->n_threads) reduction(&& : good)
    for (int i = 0; i < n; i++) {
        const bis_rect tile = bis_workspace_tile(w, tiles[i]);
        good = bis_edges_find(w->edge, w->area, tile, &from, 1) && good;
    }
    return good;
}

bis_status bis_workspace_find_edges(bis_workspace *w, bis_diag *diag)
{
    const int width = w->area.x1 - w->area.x0, height = w->area.y1 - w->area.y0;

    if (w->view->edge_samples <= 1 || !w->view->pixel_jitter || !w->scene->accel) return BIS_OK;
    for (int kind = 0; kind < BIS_EDGE_KINDS; kind++) {
        const uint64_t each = bis_edges_samples(kind, w->view->edge_samples);
        w->edge_samplers[kind] = w->view->sampler;
        if (each > 1) bis_sampler_set_spp(&w->edge_samplers[kind], w->view->sampler.spp * each);
    }
    const double share = w->view->edge_light > 0 ? w->view->edge_light : 1;
    w->edge_settings = bis_settings_thin(&w->view->settings, share);
    w->edge = bis_alloc(bis_edges_bytes(w->area), 1);
    double *turns = bis_edges_turns(w->desc);
    const bis_edge_eye from = {w->film, w->scene, w->view, turns};
    bool good = w->edge && turns;
    if (good && w->share) good = find_edges_of(w, w->share, w->n_share, turns); /* the others' pixels stay 0 */
    else if (good && w->own) good = find_edges_of(w, w->own, w->n_own, turns);
    else if (good) good = bis_edges_find(w->edge, w->area, w->area, &from, w->n_threads);
    bis_free(turns);
    if (good) return BIS_OK;
    return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for the edges of %d x %d pixels", width, height);
}

void bis_workspace_join_edges(bis_workspace *w)
{
    bis_ranks *ranks = w->options->ranks;

    if (ranks && w->edge) ranks->join_bits(ranks, w->edge, bis_edges_bytes(w->area));
}

size_t bis_workspace_bytes(const bis_workspace *w)
{
    const size_t pixel = sizeof *w->pass + (size_t)w->film->layers.n_values * sizeof *w->pass_layers;
    const size_t n_pixels = (size_t)w->film->width * (size_t)w->film->height;
    const bis_settings *settings = &w->view->settings;
    const size_t thread = sizeof *w->workers + bis_wave_bytes(w->desc) + bis_scratch_bytes(settings) +
                          bis_product_guide_bytes(&w->workers[0].guide);

    return bis_pool_bytes(&w->pool) + bis_clusters_bytes(&w->clusters) + bis_clusters_bytes(&w->of_twins) +
           bis_visibility_bytes(&w->visibility) + (size_t)w->n_threads * thread + n_pixels * pixel +
           (w->pass_twins ? bis_film_twins(w->film) * sizeof *w->pass_twins : 0);
}

void bis_workspace_clear(bis_workspace *w)
{
    for (int i = 0; i < w->n_threads && w->workers; i++) {
        bis_scratch_clear(&w->workers[i].scratch);
        bis_product_guide_clear(&w->workers[i].guide);
        bis_wave_free(w->workers[i].wave);
    }
    bis_pool_clear(&w->pool);
    bis_clusters_clear(&w->clusters);
    bis_clusters_clear(&w->of_twins);
    bis_visibility_clear(&w->visibility);
    bis_free(w->own);
    bis_free(w->share);
    bis_free(w->workers);
    bis_free(w->pass);
    bis_free(w->pass_twins);
    bis_free(w->pass_layers);
    bis_free(w->fine);
    bis_free(w->edge);
}
