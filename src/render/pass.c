/* SPDX-License-Identifier: BSD-2-Clause */
/* pass: from camera samples (wave.h) to the film.
 *
 * One pass is the same number of camera samples of every pixel (in edge pixels more, see edges.h). Threads take tiles
 * in any order, but what a pixel gets depends on (seed, pixel, pass) alone, and only whole passes reach the film, in
 * order: the film's bits depend on the scene and the number of passes, never on threads, time, or the moment of
 * Ctrl-C. To that end a pass is kept aside (16 bytes a pixel) and added to the film when it is complete; an abandoned
 * one leaves no trace, not even in the counters. The values of layers go the same way.
 *
 * A pixel of a crop gets what it gets in the full picture. Where a pixel learns from its neighbours (visibility.h), all
 * pixels of its tile are rendered, and those beside the crop are dropped: up to 15 columns and rows on each side. */
#include "pass.h"

#include "edges.h"
#include "first_light.h"
#include "gather.h"
#include "survey.h"
#include "team.h"
#include "wave.h"

#include "bis/base/clock.h"
#include "bis/base/hash.h"

#include <string.h>

static const uint64_t purpose_twin = 0x7477696e; /* its random numbers are another seed's */

static size_t index_in(bis_rect area, int x, int y)
{
    return (size_t)(y - area.y0) * (size_t)(area.x1 - area.x0) + (size_t)(x - area.x0);
}

/* What a pass takes of pixel (x, y): its camera samples, or in an edge pixel as many times edgesamples, each of
 * which then has a share of the light samples. */
static void add_samples(const bis_workspace *w, bis_wave *wave, int x, int y, const bis_pass *pass, uint64_t seed,
                        bis_pixel_sum *sum)
{
    const int edge = w->edge ? bis_edges_kind(w->edge, w->area, x, y) : BIS_EDGE_NONE;
    const uint32_t each = bis_edges_samples(edge, w->view->edge_samples);
    bis_sampler sampler = edge ? w->edge_samplers[edge] : w->view->sampler;
    const uint64_t first = pass->first * each;

    sampler.seed = seed;
    sum->settings = each > 1 ? &w->edge_settings : &w->view->settings;
    for (uint64_t k = 0; k < (uint64_t)pass->n * each; k++) bis_wave_add(wave, &sampler, x, y, first + k, sum);
}

/* The run of learned visibility to which pixel number i of tile t belongs. */
static size_t cell_of(const bis_workspace *w, int t, int i)
{
    const size_t cells = w->visibility.cells;
    return (size_t)t * cells + (size_t)i * cells / (BIS_RENDER_TILE * BIS_RENDER_TILE);
}

/* The one of the n twins of a tile that pixel (x, y) has; NULL: none. */
static const bis_twin *twin_at(const bis_twin *twins, int n, int x, int y)
{
    for (int k = 0; k < n; k++)
        if (twins[k].x == x && twins[k].y == y) return &twins[k];
    return NULL;
}

/* The mean of a pixel's camera samples. */
static rgb mean_of(const bis_pixel_sum *sum) { return rgbd_round(rgbd_scale(sum->L, 1 / (double)sum->n)); }

static uint64_t seed_of_twins(const bis_workspace *w) { return bis_hash(w->view->sampler.seed ^ purpose_twin); }

/* The twins of tile t, in the order of its pixels. Nothing is learned from them, and their rays are not counted, so
 * picture and counters are those of a render without twins. All pixels take directions from the pass's clusters, and
 * have some of their error in common. Twins have clusters of their own, because they would not tell it otherwise. */
static void render_twins(const bis_workspace *w, bis_worker *me, int t, const bis_pass *pass)
{
    const bis_rect full = bis_film_tile(w->film, BIS_RENDER_TILE, t),
                   kept = bis_film_tile_of_crop(w->film, BIS_RENDER_TILE, t);
    const uint64_t seed = seed_of_twins(w);
    const bis_counters of_picture = me->counters;
    bis_twin twins[BIS_RENDER_TILE_TWINS];
    int n = 0;

    for (bis_twin twin = {0}; bis_film_next_twin(w->film, kept, &twin);) twins[n++] = twin;
    if (me->scratch.guide) me->scratch.guide->learns = false;
    if (w->of_twins.n) me->guide.clusters = &w->of_twins;
    for (int i = 0; i < BIS_RENDER_TILE * BIS_RENDER_TILE; i++) {
        int x, y;
        bis_survey_pixel(i, &x, &y);
        const bis_twin *twin = twin_at(twins, n, x + full.x0, y + full.y0);
        if (!twin) continue;
        bis_pixel_sum *sum = &me->pixels[twin - twins];
        *sum = (bis_pixel_sum){.cell = cell_of(w, t, i)};
        add_samples(w, me->wave, twin->x, twin->y, pass, seed, sum);
    }
    bis_wave_end(me->wave);
    if (w->of_twins.n) me->guide.clusters = &w->clusters;
    for (int k = 0; k < n; k++) w->pass_twins[twins[k].at] = mean_of(&me->pixels[k]);
    me->counters = of_picture;
}

/* Tile number t, or a glimpse of it: few pixels, from which nothing is learned and whose rays are not counted, because
 * they come again. It returns false if it was interrupted: the tile is then as it was. */
static bool render_tile(const bis_workspace *w, bis_worker *me, int t, const bis_pass *pass, bool is_glimpse)
{
    const bis_film *f = w->film;
    const bis_rect tile = bis_workspace_tile(w, t), full = bis_film_tile(f, BIS_RENDER_TILE, t),
                   kept = bis_film_tile_of_crop(f, BIS_RENDER_TILE, t),
                   crop = bis_film_crop(f);
    bis_pixel_sum dropped;

    const bis_counters before = me->counters;
    if (me->scratch.guide) me->scratch.guide->learns = !is_glimpse;
    if (pass->first == 0 && w->visibility.n_tiles && !is_glimpse) bis_survey_tile(w, me, t);
    for (int i = 0; i < BIS_RENDER_TILE * BIS_RENDER_TILE; i++) {
        int x, y;
        bis_survey_pixel(i, &x, &y);
        x += full.x0, y += full.y0;
        if (!bis_is_in(tile, x, y) || (is_glimpse && !bis_first_light_glimpses(f, x, y))) continue;
        if (bis_workspace_interrupted(w)) return false;
        const bool keep = bis_is_in(kept, x, y);
        bis_pixel_sum *sum = keep ? &me->pixels[index_in(kept, x, y)] : &dropped;
        *sum = (bis_pixel_sum){.values = keep ? bis_workspace_layers(w, index_in(crop, x, y)) : NULL};
        if (sum->values) memset(sum->values, 0, (size_t)f->layers.n_values * sizeof *sum->values);
        sum->cell = cell_of(w, t, i);
        add_samples(w, me->wave, x, y, pass, w->view->sampler.seed, sum);
    }
    bis_wave_end(me->wave);
    if (bis_workspace_interrupted(w)) return false;
    for (int y = kept.y0; y < kept.y1; y++) {
        for (int x = kept.x0; x < kept.x1; x++) {
            if (is_glimpse && !bis_first_light_glimpses(f, x, y)) continue;
            const bis_pixel_sum *sum = &me->pixels[index_in(kept, x, y)];
            w->pass[index_in(crop, x, y)] = (bis_pixel_mean){mean_of(sum), (float)sum->hits / (float)sum->n};
            if (sum->values) bis_gather_mean(sum->values, &f->layers, sum->n / pass->weight);
        }
    }
    if (is_glimpse) me->counters = before;
    else if (w->pass_twins) render_twins(w, me, t, pass);
    return true;
}

/* All tiles that are rendered here: glimpses, or what they are. The latter ends when it is late. */
static void sweep(bis_workspace *w, const bis_pass *pass, bool is_glimpse, bis_pass_progress *progress, void *user)
{
    const bool may_end = !is_glimpse && w->fine && pass->first == 0;
    const int n = bis_workspace_shared(w);
    int n_done = 0;

#pragma omp parallel for schedule(dynamic) num_threads(w->n_threads)
    for (int i = 0; i < n; i++) {
        const int t = bis_workspace_share(w, i);
        int done;
        if (may_end && bis_clock_now() >= w->late) continue;
        if (render_tile(w, &w->workers[bis_workspace_thread()], t, pass, is_glimpse) && w->fine)
            w->fine[t] = is_glimpse ? BIS_TILE_GLIMPSED : BIS_TILE_WHOLE;
#pragma omp atomic capture
        done = ++n_done;
        if (bis_workspace_thread() == 0) progress(is_glimpse ? 0 : (double)done / n, user);
    }
}

bool bis_pass_render(bis_workspace *w, const bis_pass *pass, bis_pass_progress *progress, void *user)
{
    const uint64_t seed = w->view->sampler.seed;

    const bool looks = !w->surveyed && w->visibility.n_squares, is_first = pass->number == 0;

    for (int i = 0; i < w->n_threads; i++) w->workers[i].counters = (bis_counters){0};
    if (w->pool.M) bis_pool_fill(&w->pool, w->scene->light, seed, pass->number, w->n_threads);
    if (w->clusters.n) bis_clusters_fill(&w->clusters, w->scene->light, seed, looks ? 0 : pass->number, w->n_threads);
    if (w->of_twins.n)
        bis_clusters_fill(&w->of_twins, w->scene->light, seed_of_twins(w), pass->number, w->n_threads);
    if (looks) bis_survey(w, false, is_first, progress, user);
    if (w->fine && is_first) sweep(w, pass, true, progress, user);
    if (looks) bis_survey(w, true, is_first, progress, user);
    if (looks && !is_first) bis_clusters_fill(&w->clusters, w->scene->light, seed, pass->number, w->n_threads);
    if (w->share) bis_team_begin_pass(w);
    sweep(w, pass, false, progress, user);
    if (!w->share) return !bis_workspace_interrupted(w);
    bis_team_end_pass(w);
    return !w->is_ended; /* as all ranks see it, even where the flag was set since */
}

static void keep_pixels(const bis_workspace *w, bis_rect r, double weight)
{
    bis_film *f = w->film;

    for (int y = r.y0; y < r.y1; y++) {
        for (int x = r.x0; x < r.x1; x++) {
            size_t i = (size_t)(y - f->y0) * (size_t)f->width + (size_t)(x - f->x0);
            bis_film_add(f, x, y, w->pass[i].L, (double)w->pass[i].hit, weight);
            if (w->pass_layers) bis_layers_add(&f->layers, i, bis_workspace_layers(w, i));
        }
    }
    for (bis_twin t = {0}; w->pass_twins && bis_film_next_twin(f, r, &t);)
        bis_film_add_twin(f, &t, w->pass_twins[t.at], weight);
}

void bis_pass_learn(const bis_workspace *w)
{
    const int *tiles = w->share ? w->share : w->own;
    bis_visibility_learn(&w->visibility, tiles, (size_t)bis_workspace_shared(w), w->n_threads);
}

void bis_pass_keep(bis_workspace *w, const bis_pass *pass, bis_counters *sum)
{
    bis_film *f = w->film;
    const int n = w->own ? w->n_own : f->height; /* tiles, or rows */

#pragma omp parallel for num_threads(w->n_threads)
    for (int i = 0; i < n; i++) {
        const bis_rect row = {f->x0, f->y0 + i, f->x0 + f->width, f->y0 + i + 1};
        keep_pixels(w, w->own ? bis_film_tile_of_crop(f, BIS_RENDER_TILE, w->own[i]) : row, pass->weight);
    }
    for (int i = 0; i < w->n_threads; i++) bis_counters_add(sum, &w->workers[i].counters);
    bis_pass_learn(w);
    bis_film_end_pass(f, pass->weight);
}
