/* SPDX-License-Identifier: BSD-2-Clause */
/* trade_scene: the scene of a sweep, built once for all settings, and one render of it.
 *
 * Geometry and accelerator serve every integrator. The map is built with all that any of them needs, once for each b,
 * and once more where mis wants it compensated: a setting then renders with a shallow copy of the scene that has its
 * light. What else a light holds changes no bit of what an integrator draws from it, so the picture is the one that
 * `bis render` makes with the same setting, passes and seed (tests/tools/test_trade.c). */
#include "trade_scene.h"
#include "trade_settings.h"

#include "bis/base/mem.h"

bool bis_trade_interrupted(const bis_trade *t) { return t->o.interrupted && *t->o.interrupted; }

void bis_trade_tell(const bis_trade *t, const char *what, double share, double seconds_left)
{
    if (t->o.progress) t->o.progress(what, share, seconds_left, t->o.user);
}

/* ---- lights ---- */

static const unsigned all_needs = BIS_NEED_TABLE | BIS_NEED_CURVE | BIS_NEED_SPREAD; /* one table for all methods */
enum { MANY_PIXELS = 1 << 24 }; /* a map of 8192 x 2048: each further importance takes 28 bytes a pixel */

static bis_light *light_for(const bis_trade *t, const bis_trade_setting *s)
{
    for (int i = 0; i < t->n_lights; i++)
        if (t->lights[i].b == s->area_exponent && t->lights[i].compensated == s->settings.compensate)
            return t->lights[i].light;
    return NULL;
}

static bis_status add_light(bis_trade *t, const bis_trade_setting *s, bis_diag *diag)
{
    bis_light_desc light = t->desc->light;
    const unsigned needs = all_needs | (s->settings.compensate ? BIS_NEED_COMPENSATED : 0);
    bis_light *made;

    light.table_kind = bis_light_table_kind(&light, needs, t->desc->view.sampler.kind);
    light.area_exponent = s->area_exponent;
    bis_status status =
        bis_light_load(&made, &light, needs, NULL, NULL); /* its warnings were given with the scene's own */
    if (status)
        return bis_error(diag, status, (bis_loc){0}, "%s \"%s\" once more for setting \"%s\"",
                         status == BIS_NOMEM ? "no memory to build" : "cannot build", light.filename, s->name);
    t->lights[t->n_lights].b = s->area_exponent;
    t->lights[t->n_lights].compensated = s->settings.compensate;
    t->lights[t->n_lights++].light = made;
    return BIS_OK;
}

static bis_status add_lights(bis_trade *t, bis_diag *diag)
{
    bis_status status = BIS_OK;

    t->lights[t->n_lights].b = t->desc->light.area_exponent;
    t->lights[t->n_lights++].light = t->scene->light;
    for (int i = 0; i < t->plan.n_settings && !status; i++) {
        const bis_trade_setting *s = &t->plan.settings[i];
        if (!s->is_swept || light_for(t, s)) continue;
        if (bis_light_is_constant(t->scene->light)) continue;
        bis_trade_tell(t, "building the map's importance", (double)NAN, (double)NAN);
        status = add_light(t, s, diag);
    }
    return status;
}

/* ---- the scene ---- */

bis_status bis_trade_load(bis_trade *t, bis_diag *diag)
{
    bis_trade_tell(t, "reading the scene", (double)NAN, (double)NAN);
    bis_status status = bis_scene_parse_as(&t->desc, t->o.scene, t->o.approximate ? BIS_PARSE_APPROXIMATE : 0, diag);
    if (status) return status;
    if (t->o.n_threads) t->desc->accel.n_threads = t->o.n_threads;
    if (t->o.width) {
        t->desc->view.film.width = t->o.width;
        t->desc->view.film.height = t->o.height;
    }
    if (t->desc->view.settings.as_printed)
        bis_warn(diag, t->desc->integrator_loc,
                 "Option \"asprinted\" is left out: the methods are measured as they should be");
    const unsigned as_printed = t->desc->view.settings.as_printed;
    t->desc->view.settings.as_printed = 0;
    t->desc->light_needs = all_needs;
    status = bis_scene_build(&t->scene, t->desc, diag);
    t->desc->view.settings.as_printed = as_printed;
    if (status) return status;
    if (!t->scene->accel || bis_light_is_black(t->scene->light)) {
        return bis_error(diag, BIS_INPUT, (bis_loc){t->desc->path, 0, 0},
                         "the scene has no %s: every method gives the same picture at once, and there is "
                         "nothing to trade",
                         t->scene->accel ? "light" : "surface");
    }
    const bis_envmap *em = bis_light_is_constant(t->scene->light) ? NULL : bis_light_envmap(t->scene->light);
    const bool small_map = em && (size_t)em->width * (size_t)em->height <= MANY_PIXELS;
    if (em && !small_map)
        bis_warn(diag, (bis_loc){0},
                 "the map has more than 2^24 pixels: other values of b and compensation are left out");
    bis_trade_list_settings(t, small_map);
    return add_lights(t, diag);
}

void bis_trade_unload(bis_trade *t)
{
    for (int i = 1; i < t->n_lights; i++) bis_light_free(t->lights[i].light);
    t->n_lights = 0;
    bis_scene_free(t->scene);
    bis_scene_desc_free(t->desc);
    t->scene = NULL;
    t->desc = NULL;
}

/* ---- one render ---- */

static bis_status image_of(bis_image *image, const bis_film *film, bis_diag *diag)
{
    const size_t n = (size_t)film->width * (size_t)film->height;
    float *rgba = bis_alloc(n, 4 * sizeof *rgba);
    bis_status status =
        rgba ? bis_image_init(image, film->width, film->height, diag)
             : bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for %d x %d pixels", film->width, film->height);
    if (!status) {
        bis_film_resolve(film, rgba);
        for (size_t i = 0; i < n; i++) image->pixels[i] = (rgb){rgba[4 * i], rgba[4 * i + 1], rgba[4 * i + 2]};
    }
    bis_free(rgba);
    return status;
}

static const double whole[4] = {0, 1, 0, 1};

bis_film bis_trade_film(const bis_trade *t, int step)
{
    const bis_trade_plan *p = &t->plan;
    return step ? bis_film_place(p->full_width, p->full_height, t->desc->view.film.crop, step)
                : bis_film_place(1, 1, whole, 1);
}

double bis_trade_pixels(const bis_trade *t, int step)
{
    const bis_film f = bis_trade_film(t, step);
    return (double)f.width * f.height;
}

bis_status bis_trade_render(bis_trade *t, const bis_trade_job *job, bis_image *image, bis_render_result *result,
                            bis_diag *diag)
{
    const bis_film place = bis_trade_film(t, job->step);
    bis_film film;
    bis_scene view = *t->scene;
    bis_light *light = light_for(t, job->setting);
    const bis_render_options options = {
        .budget = {.spp = job->passes}, .n_threads = t->o.n_threads, .interrupted = t->o.interrupted};

    if (image) *image = (bis_image){0};
    if (light) view.light = light; /* a constant one is the same for all b */
    t->desc->view.settings = job->setting->settings;
    t->desc->view.sampler.seed = job->seed;
    bis_sampler_set_spp(&t->desc->view.sampler, job->passes);
    bis_status status = bis_film_init_thin(&film, place.picture_width, place.picture_height,
                                           job->step ? t->desc->view.film.crop : whole, place.step, (bis_loc){0}, diag);
    if (!status) status = bis_render(result, &film, &view, &t->desc->view, &options, diag);
    if (!status && image) status = image_of(image, &film, diag);
    t->n_threads = result->n_threads;
    t->nonfinite += result->counters.nonfinite;
    bis_film_clear(&film);
    return status;
}
