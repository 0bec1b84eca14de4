/* SPDX-License-Identifier: BSD-2-Clause */
/* wave: camera samples side by side.
 *
 * What a camera sample costs is mostly waiting for memory: the boxes and triangles that its rays pass. Neighbours pass
 * the same ones. So each step is done for all samples of a wave before the next step begins, and rays go to the
 * accelerator together. Rays are traced in the order in which they were noted: sorting them by direction takes longer
 * than it saves, because at usual sizes of pictures what neighbouring rays share is where they start.
 *
 * The bits of a picture do not depend on waves. A camera sample has its own random numbers, an accelerator answers the
 * same for many rays as for one, and the terms of an estimate are added in the order in which its integrator noted
 * them (bis_point_add): tests/render/test_wave.c compares with Lo called for one sample after the other. What a cell
 * of learned visibility finds is there for the next cell of the tile, so a wave holds samples of one cell alone.
 * Estimators with errors on purpose ("asprinted") scale what they have traced, so their rays are traced at once. */
#include "wave.h"

#include "bis/base/mem.h"
#include "gather.h"

#include <string.h>

/* 16 pixels times 4 camera samples. Larger waves leave the cache: 256 samples were 5 % slower. */
enum { SAMPLES = 64, RAYS = 1024 };

typedef struct sample {
    bis_sampler sampler;
    bis_stream stream;
    bis_point pt;
    bis_pixel_sum *pixel;
    const bis_settings *settings; /* the pixel's: what is dropped has one sum for many pixels */
    rgbd L;
} sample;

struct bis_wave {
    bis_ray_sink ray_sink; /* first: points lead to it */
    bis_wave_task task;
    bis_scratch *scratch;
    bis_product_guide *guide;
    bis_counters *counters;
    bis_own_material *materials; /* materials[SAMPLES], or NULL: the scene has no textures */

    uint32_t n; /* samples */
    size_t cell; /* of learned visibility, that they belong to */
    sample samples[SAMPLES];
    ray eyes[SAMPLES];
    uint32_t prim[SAMPLES];
    uint32_t at; /* the sample whose light is estimated */

    uint32_t n_rays;
    ray rays[RAYS];
    rgbd C[RAYS]; /* the term that a ray carries */
    uint32_t owner[RAYS];
    uint16_t *seen[RAYS];
    bool occluded[RAYS];
};

/* ---- shadow rays ---- */

static void trace(bis_wave *w)
{
    bis_accel_occluded_many(w->task.scene->accel, w->rays, w->n_rays, w->occluded);
    for (uint32_t i = 0; i < w->n_rays; i++) {
        if (w->occluded[i]) continue;
        sample *s = &w->samples[w->owner[i]];
        s->L = rgbd_add(s->L, w->C[i]);
        if (w->seen[i]) ++*w->seen[i];
    }
    w->n_rays = 0;
}

static void note_ray(bis_ray_sink *ray_sink, const bis_point *pt, vec3 wi, const rgbd *C, uint16_t *seen)
{
    bis_wave *w = (bis_wave *)ray_sink;
    const uint32_t i = w->n_rays++;

    w->rays[i] = (ray){pt->origin, wi, INFINITY};
    w->C[i] = *C;
    w->owner[i] = w->at;
    w->seen[i] = seen;
    if (w->n_rays == RAYS) trace(w);
}

/* ---- the steps ---- */

/* The surfaces that were hit. Their vertices lie anywhere in memory: all are asked for before the first is read. */
static void find_points(bis_wave *w)
{
    const bis_geometry *g = &w->task.scene->geometry;
    const bool is_given = w->task.view->camera.points != NULL;

    if (is_given) memset(w->prim, 0, w->n * sizeof *w->prim);
    else bis_accel_intersect_many(w->task.scene->accel, w->eyes, w->n, w->prim);
    bis_geometry_prefetch(g, w->prim, w->n);
    for (uint32_t i = 0; i < w->n; i++) {
        if (w->prim[i] == BIS_NO_PRIM) continue;
        bis_point *pt = &w->samples[i].pt;
        bis_own_material *own = w->materials ? &w->materials[i] : NULL;
        if (is_given) bis_scene_point_given(pt, w->task.scene, w->eyes[i], w->counters);
        else bis_scene_point_at(pt, own, w->task.scene, w->eyes[i], w->prim[i], w->counters);
        pt->ray_sink = w->task.view->settings.as_printed ? NULL : &w->ray_sink;
    }
}

/* What is known of visibility in the cell of the samples. */
static void look_at_cell(bis_wave *w)
{
    if (w->n > 0) bis_product_guide_look(w->guide, w->cell);
}

/* Light reflected towards the eye, eq. 3.1, or what a ray sees that escapes: all but the terms of shadow rays. */
static void add_light(bis_wave *w, sample *s)
{
    const bis_counters before = *w->counters;
    const uint32_t i = w->at;
    rgb L = {0};

    w->counters->camera_rays++;
    if (w->prim[i] == BIS_NO_PRIM) {
        L = bis_light_seen(&w->task.desc->light, w->task.scene->light, w->eyes[i].d);
        w->counters->beside_portals += !rgb_is_black(L) && bis_portals_are_missed(w->task.scene->light, w->eyes[i]);
    } else if (!bis_bsdf_is_black(&s->pt.bsdf)) {
        bis_stream stream = s->stream;
        L = s->settings->integrator->Lo(s->settings, &s->pt, &stream, w->scratch);
    }
    s->L = rgbd_add(s->L, (rgbd){(double)L.r, (double)L.g, (double)L.b});
    if (s->pixel->values) bis_gather_counts(s->pixel->values, &w->task.film->layers, &before, w->counters);
}

/* The sample's radiance is known: a NaN or infinity must not reach the film. */
static void finish(bis_wave *w, sample *s, bool hit)
{
    bis_pixel_sum *pixel = s->pixel;
    rgb L = rgbd_round(s->L);

    if (!rgb_is_finite(L)) {
        L = (rgb){0};
        w->counters->nonfinite++;
    }
    const bis_gathered of = {s->settings, &s->pt, s->stream, w->scratch, L};
    if (hit && pixel->values && !bis_gather_surface(pixel->values, &w->task.film->layers, w->task.to_camera, &of))
        w->counters->nonfinite++;
    pixel->L = rgbd_add(pixel->L, (rgbd){(double)L.r, (double)L.g, (double)L.b});
    pixel->hits += hit;
}

/* One estimate may take a tenth of a second (`exact` under a large map), hence the flag of interruption here. */
void bis_wave_end(bis_wave *w)
{
    const volatile sig_atomic_t *interrupted = w->task.options->interrupted;

    find_points(w);
    look_at_cell(w);
    for (w->at = 0; w->at < w->n; w->at++) {
        if (interrupted && __atomic_load_n(interrupted, __ATOMIC_RELAXED)) break;
        add_light(w, &w->samples[w->at]);
    }
    trace(w);
    for (uint32_t i = 0; i < w->n; i++) finish(w, &w->samples[i], w->prim[i] != BIS_NO_PRIM);
    w->n = 0;
}

void bis_wave_add(bis_wave *w, const bis_sampler *sampler, int x, int y, uint64_t index, bis_pixel_sum *pixel)
{
    const bis_film *f = w->task.film;
    const bis_view *view = w->task.view;
    double u[2] = {0.5, 0.5};

    /* A wave has the samples of one cell, because the next cell learns from the rays of this one. */
    if (w->n > 0 && pixel->cell != w->cell) bis_wave_end(w);
    w->cell = pixel->cell;
    sample *s = &w->samples[w->n];

    x = x * f->step + f->step / 2; /* of the picture */
    y = y * f->step + f->step / 2;
    s->pixel = pixel;
    s->settings = pixel->settings;
    s->L = (rgbd){0, 0, 0};
    s->sampler = *sampler;
    bis_stream_init(&s->stream, &s->sampler, (uint64_t)y * (uint64_t)f->picture_width + (uint64_t)x, index);
    if (view->pixel_jitter) bis_stream_camera(&s->stream, u);
    w->eyes[w->n++] = bis_camera_ray(&view->camera, f->picture_width, f->picture_height, x + u[0], y + u[1]);
    pixel->n++;
    if (w->n == SAMPLES) bis_wave_end(w);
}

/* ---- memory ---- */

bis_wave *bis_wave_new(const bis_wave_task *task, bis_scratch *scratch, bis_product_guide *guide,
                       bis_counters *counters)
{
    bis_wave *w = bis_alloc(1, sizeof *w);

    if (!w) return NULL;
    if (task->desc->textures.n_of_material > 0) {
        w->materials = bis_alloc(SAMPLES, sizeof *w->materials);
        if (!w->materials) {
            bis_free(w);
            return NULL;
        }
    }
    w->ray_sink.add = note_ray;
    w->task = *task;
    w->scratch = scratch;
    w->guide = guide;
    w->counters = counters;
    return w;
}

void bis_wave_free(bis_wave *wave)
{
    if (wave) bis_free(wave->materials);
    bis_free(wave);
}

size_t bis_wave_bytes(const bis_scene_desc *desc)
{
    return sizeof(bis_wave) + (desc->textures.n_of_material > 0 ? SAMPLES * sizeof(bis_own_material) : 0);
}
