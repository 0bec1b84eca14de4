/* SPDX-License-Identifier: BSD-2-Clause */
/* flat_render: a scene into memory. */
#include "bis/base/clock.h"
#include "bis/base/mem.h"
#include "bis/flat/taught.h"
#include "bis/flat/scene.h"
#include "flat/face.h"
#include "flat/wishes.h"
#include "tools/describe.h"

#include <stdlib.h>
#include <string.h>

struct bis_flat_picture {
    int width, height;
    float *rgba;
    char *stats; /* of open_memstream */
    bis_render_result result;
    float *planes;                            /* the channels of all layers, [height][width] each */
    int first[BIS_N_LAYERS], n[BIS_N_LAYERS]; /* the channels of a layer; n = 0: the picture does not have it */
};

/* ---- rendering ---- */

/* The layers, each by itself, so that it is known which channels are whose. */
static bool keep_layers(bis_flat_picture *p, const bis_film *film)
{
    const size_t n_pixels = (size_t)p->width * (size_t)p->height;
    bis_channel channels[BIS_FILM_MAX_CHANNELS];
    const int n = bis_film_layers(film, channels, NULL);

    p->planes = n > 0 ? bis_alloc((size_t)n * n_pixels, sizeof *p->planes) : NULL;
    if (n > 0 && !p->planes) return false;
    bis_film one = *film;
    for (int i = 0, at = 0; i < BIS_N_LAYERS; at += p->n[i++]) {
        one.layers.asked = film->layers.asked & 1u << i;
        p->first[i] = at;
        p->n[i] = one.layers.asked ? bis_film_layers(&one, channels, p->planes + (size_t)at * n_pixels) : 0;
    }
    return true;
}

static bis_status keep(bis_flat_picture **out, const bis_film *film, const bis_stats *stats, bis_diag *diag)
{
    bis_flat_picture *p = bis_alloc(1, sizeof *p);
    size_t n;

    if (!p) return bis_error(diag, BIS_NOMEM, nowhere, "no memory for the picture");
    p->width = film->width;
    p->height = film->height;
    p->result = *stats->result;
    p->rgba = bis_alloc((size_t)film->width * (size_t)film->height, 4 * sizeof *p->rgba);
    FILE *f = p->rgba && keep_layers(p, film) ? open_memstream(&p->stats, &n) : NULL;
    if (f) bis_stats_print(stats, f);
    if (!f || fclose(f) != 0) {
        bis_flat_picture_close(p);
        return bis_error(diag, BIS_NOMEM, nowhere, "no memory for the picture");
    }
    bis_film_resolve(film, p->rgba);
    *out = p;
    return BIS_OK;
}

static void watch(const bis_progress *p, void *user)
{
    const bis_flat_wishes *w = user;
    w->watcher(p->share, p->seconds, p->seconds_left, w->user);
}

/* Renders into film, and keeps the picture with its figures. */
static bis_status render(bis_flat_picture **out, bis_film *film, const bis_scene *scene, double parse_seconds,
                         const bis_flat_wishes *w, bis_diag *diag)
{
    const bis_scene_desc *d = scene->desc;
    const double start = bis_clock_now();
    bis_render_result result;
    const bis_render_options options = {
        .budget = {.spp = (uint32_t)w->spp, .seconds = w->seconds, .error = w->error},
        .n_threads = (int)w->threads,
        .interrupted = w->stop,
        .progress = w->watcher ? watch : NULL,
        .user = (void *)(uintptr_t)w,
    };
    bis_status status = bis_render(&result, film, scene, &d->view, &options, diag);

    if (!status && result.passes == 0)
        status = bis_flat_refuse(diag, "the render was stopped before its first pass was complete");
    if (status) return status;
    bis_stats stats = bis_stats_of(d, bis_scene_figures_of(scene), scene->seconds, film, &result);
    const bis_scene_seconds *of = &scene->seconds;
    stats.extent = bis_geometry_primitives(&scene->geometry) > 0 ? &scene->geometry.box : NULL;
    stats.seconds.parse = parse_seconds;
    stats.seconds.total = parse_seconds + of->load + of->envmap + of->accel + (bis_clock_now() - start);
    return keep(out, film, &stats, diag);
}

/* A picture as the settings ask, which begin with those of the scene. */
static bis_status make_picture(bis_flat_picture **out, bis_flat_scene *s, const char *const *settings,
                               bis_flat_wishes *w, bis_diag *diag)
{
    bis_scene_desc d = *s->desc; /* shallow: the settings change values alone */
    bis_scene scene = *s->scene;
    bis_film film = {0};
    bis_status status = bis_flat_wish(&d, w, settings, diag);

    if (!status) status = bis_flat_scene_check(s, &d, w, diag);
    if (!status) status = bis_flat_scene_light(&scene.light, s, &d, w, diag);
    if (status) return status;
    scene.desc = &d;
    const bis_film_desc *size = &d.view.film;
    status = bis_film_init_thin(&film, size->width, size->height, size->crop, w->step ? w->step : 1, nowhere, diag);
    if (!status) status = bis_film_want(&film, size->layers, diag);
    if (!status) status = render(out, &film, &scene, s->parse_seconds, w, diag);
    bis_film_clear(&film);
    return status;
}

/* Another language has only int to give. */
_Static_assert(sizeof(sig_atomic_t) == sizeof(int), "stop is as large as an int");

bis_status bis_do_render_with(bis_flat_picture **picture, const char *scene, const char *const *settings,
                              const bis_light *light, bis_flat_watcher *watcher, void *user,
                              const volatile sig_atomic_t *stop, bis_diag *diag)
{
    bis_flat_wishes w = {.light = light, .watcher = watcher, .user = user, .stop = stop};
    bis_flat_scene s = {0};
    bis_status status = bis_flat_scene_begin(&s, scene, settings, &w, false, diag);

    if (!status) status = make_picture(picture, &s, (const char *const[]){NULL}, &w, diag);
    bis_flat_scene_end(&s);
    return status;
}

bis_status bis_do_scene_render(bis_flat_picture **picture, bis_flat_scene *scene, const char *const *settings,
                               const bis_light *light, bis_flat_watcher *watcher, void *user,
                               const volatile sig_atomic_t *stop, bis_diag *diag)
{
    bis_flat_wishes w = {.light = light, .watcher = watcher, .user = user, .stop = stop};
    static const char *const of_opening[] = {"text", "approximate"};

    for (int i = 0; i < 2; i++)
        if (bis_flat_setting(settings, of_opening[i]))
            return bis_flat_refuse(diag, "%s belongs to the opening of a scene", of_opening[i]);
    return make_picture(picture, scene, settings, &w, diag);
}

bis_status bis_do_render(bis_flat_picture **picture, const char *scene, const char *const *settings,
                         const volatile sig_atomic_t *stop, bis_diag *diag)
{
    return bis_do_render_with(picture, scene, settings, NULL, NULL, NULL, stop, diag);
}

void bis_flat_picture_close(bis_flat_picture *picture)
{
    if (!picture) return;
    bis_free(picture->rgba);
    bis_free(picture->planes);
    free(picture->stats);
    bis_free(picture);
}

void bis_flat_picture_shape(const bis_flat_picture *picture, int shape[2])
{
    if (!shape) return;
    shape[0] = picture ? picture->width : 0;
    shape[1] = picture ? picture->height : 0;
}

void bis_flat_picture_pixels(const bis_flat_picture *picture, float *rgba)
{
    if (!picture || !rgba) return;
    memcpy(rgba, picture->rgba, (size_t)picture->width * (size_t)picture->height * 4 * sizeof *rgba);
}

const char *bis_flat_layer_name(int i) { return i >= 0 && i < BIS_N_LAYERS ? bis_layer_name((bis_layer)i) : NULL; }

int bis_flat_picture_layer(const bis_flat_picture *picture, const char *name, float *values)
{
    int layer = 0;

    if (!picture || !name) return 0;
    while (layer < BIS_N_LAYERS && strcmp(name, bis_layer_name((bis_layer)layer)) != 0) layer++;
    if (layer == BIS_N_LAYERS) return 0;
    const size_t n = (size_t)picture->n[layer], n_pixels = (size_t)picture->width * (size_t)picture->height;
    const float *planes = n > 0 ? picture->planes + (size_t)picture->first[layer] * n_pixels : NULL;
    for (size_t i = 0; values && i < n * n_pixels; i++) values[i] = planes[i % n * n_pixels + i / n];
    return (int)n;
}

double bis_flat_picture_pass_seconds(const bis_flat_picture *picture)
{
    return picture ? picture->result.seconds / picture->result.passes : (double)NAN;
}

void bis_flat_picture_figures(const bis_flat_picture *picture, double *figure)
{
    if (!picture || !figure) return;
    const bis_render_result *r = &picture->result;
    const double all[BIS_FLAT_FIGURES] = {r->seconds, r->passes, (double)r->counters.camera_rays,
                                          (double)r->counters.shadow_rays, (double)r->counters.candidates,
                                          (double)r->counters.accepted, (double)r->counters.nonfinite, r->n_threads,
                                          r->interrupted, r->error.relative_rmse};
    memcpy(figure, all, sizeof all);
}

const char *bis_flat_picture_stats(const bis_flat_picture *picture) { return picture ? picture->stats : NULL; }
