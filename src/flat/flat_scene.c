/* SPDX-License-Identifier: BSD-2-Clause */
/* flat_scene: a scene that stays open. What a picture of it asks for is a shallow copy of its description; geometry and
 * accelerator serve every integrator, camera and light. A light is built for what any integrator needs: what it holds
 * besides changes no bit of what an integrator draws from it. */
#include "bis/base/clock.h"
#include "bis/base/mem.h"
#include "bis/render/film.h"
#include "bis/shape/accel.h"
#include "bis/thesis/integrator.h"
#include "flat/face.h"
#include "flat/wishes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const unsigned all_needs = BIS_NEED_TABLE | BIS_NEED_CURVE | BIS_NEED_SPREAD; /* one table for all methods */

/* ---- opening ---- */

/* A light that is given: desc is of its pixels, which image borrows. */
static void give(bis_light_desc *desc, bis_image *image, const bis_light *light)
{
    const bis_envmap *em = bis_light_envmap(light);

    *image = (bis_image){em->width, em->height, em->pixels, NULL};
    desc->image = image;
    desc->filename = (char *)(uintptr_t)"the given light"; /* only read */
    desc->has_mapping = true; /* lat-long by now, even where it is square */
}

/* The same in the place of the scene's, whose frame stands upright (BIS_PARSE_OTHER_LIGHT). */
static bis_status replace_light(bis_flat_scene *s, const bis_light *light, bis_diag *diag)
{
    bis_light_desc *desc = &s->desc->light;

    give(desc, &s->pixels, light);
    desc->filename = bis_strdup(desc->filename); /* the description frees it */
    return desc->filename ? BIS_OK : bis_error(diag, BIS_NOMEM, nowhere, "no memory for the light");
}

static void turn(bis_light_desc *light, double degrees)
{
    const bis_xform by = bis_xform_rotate(degrees, 0, 0, 1);
    if (degrees != 0) light->to_world = bis_xform_compose(&light->to_world, &by);
}

bis_status bis_flat_scene_begin(bis_flat_scene *s, const char *path, const char *const *settings, bis_flat_wishes *w,
                                bool is_kept, bis_diag *diag)
{
    const double start = bis_clock_now();
    bis_status status = bis_flat_parse(&s->desc, path, settings, w->light, diag);

    if (!status) status = bis_flat_wish(s->desc, w, settings, diag);
    if (!status && w->light) status = replace_light(s, w->light, diag);
    if (status) return status;
    turn(&s->desc->light, w->turn);
    w->light = NULL; /* it is the scene's now, and so is its turn */
    w->turn = 0;
    const bis_settings *own = &s->desc->view.settings;
    s->is_kept = is_kept;
    s->needs = all_needs | own->integrator->light_needs(own);
    if (is_kept) s->desc->light_needs = s->needs;
    s->parse_seconds = bis_clock_now() - start;
    return bis_scene_build(&s->scene, s->desc, diag);
}

void bis_flat_scene_end(bis_flat_scene *s)
{
    for (int i = 0; i < s->n_lights; i++) bis_light_free(s->lights[i].light);
    bis_light_free(s->given);
    bis_free(s->points);
    bis_scene_free(s->scene);
    bis_scene_desc_free(s->desc);
}

bis_status bis_do_scene_open(bis_flat_scene **scene, const char *path, const char *const *settings,
                             const bis_light *light, bis_diag *diag)
{
    bis_flat_wishes w = {.light = light};
    bis_flat_scene *s = bis_alloc(1, sizeof *s);

    if (!s) return bis_error(diag, BIS_NOMEM, nowhere, "no memory for a scene");
    const bis_status status = bis_flat_scene_begin(s, path, settings, &w, true, diag);
    if (!status) *scene = s;
    else bis_flat_scene_close(s);
    return status;
}

void bis_flat_scene_close(bis_flat_scene *scene)
{
    if (!scene) return;
    bis_flat_scene_end(scene);
    free(scene->about);
    bis_free(scene);
}

/* ---- what changes from picture to picture ---- */

bis_status bis_flat_scene_check(const bis_flat_scene *s, const bis_scene_desc *d, const bis_flat_wishes *w,
                                bis_diag *diag)
{
    const bis_film_desc *own = &s->desc->view.film, *film = &d->view.film;

    if (d->accel.kind != s->desc->accel.kind)
        return bis_flat_refuse(diag, "the accelerator of an open scene is built: open it with another");
    if (s->points && (film->width != own->width || film->height != own->height || w->step > 1 ||
                      d->view.camera.points != s->points || memcmp(film->crop, own->crop, sizeof own->crop) != 0))
        return bis_flat_refuse(diag, "points stand in the place of pixels: leave width, height, crop, step and camera "
                               "out");
    if (!s->is_kept || !s->scene->accel || bis_scene_accel_suits(s->scene, d)) return BIS_OK;
    return bis_flat_refuse(diag, "the accelerator of this scene does not reach to the %s",
                           d->view.camera.points ? "points: open the scene with accelerator=grid"
                                                 : "camera: open the scene with this camera");
}

/* ---- points ---- */

/* The first of n points that is none; n: all are. */
static size_t read_points(ray *points, size_t n, const float *p, const float *normal)
{
    for (size_t i = 0; i < n; i++, p += 3, normal += 3) {
        const double x = (double)normal[0], y = (double)normal[1], z = (double)normal[2];
        const double l = hypot(hypot(x, y), z);
        points[i] = (ray){{p[0], p[1], p[2]}, vec3_from(-x / l, -y / l, -z / l), INFINITY};
        if (!vec3_is_finite(points[i].o) || !vec3_is_finite(points[i].d) || !isfinite(l)) return i;
    }
    return n;
}

bis_status bis_do_scene_points(bis_flat_scene *scene, int width, int height, const float *point, const float *normal,
                               bis_diag *diag)
{
    bis_view *view = &scene->desc->view;

    if (scene->points) *view = scene->view;
    bis_free(scene->points);
    scene->points = NULL;
    if (width == 0 && height == 0) return BIS_OK;
    if (width < 1 || height < 1 || width > BIS_IMAGE_MAX_SIDE || height > BIS_IMAGE_MAX_SIDE)
        return bis_flat_refuse(diag, "%d x %d points: give sides from 1 to %d", width, height, BIS_IMAGE_MAX_SIDE);
    if (!point || !normal) return bis_flat_refuse(diag, "no points are given: give an array");
    if (!scene->scene->accel) return bis_flat_refuse(diag, "the scene has no shapes: ask its map for the irradiance");
    const size_t n = (size_t)width * (size_t)height;
    ray *points = bis_alloc(n, sizeof *points);
    if (!points) return bis_error(diag, BIS_NOMEM, nowhere, "no memory for %zu points", n);
    const size_t bad = read_points(points, n, point, normal);
    if (bad < n) {
        bis_free(points);
        return bis_flat_refuse(diag, "point %zu: give finite numbers, and a normal that is not 0", bad);
    }
    bis_scene_desc d = *scene->desc;
    d.view.camera.points = points;
    d.view.film = (bis_film_desc){width, height, {0, 1, 0, 1}, view->film.layers};
    d.view.edge_samples = 1; /* neighbours on the film are none on a surface */
    const bis_status status = bis_flat_scene_check(scene, &d, &(bis_flat_wishes){0}, diag);
    if (status) {
        bis_free(points);
        return status;
    }
    scene->points = points;
    scene->view = *view;
    *view = d.view;
    return BIS_OK;
}

void bis_flat_scene_mesh(const bis_flat_scene *scene, size_t size[2], float *point, float *normal, uint32_t *face,
                         uint32_t *shape)
{
    if (!scene || !size) return;
    const bis_geometry *g = &scene->scene->geometry;
    size_t range = 0;
    uint32_t k = 0;
    size[0] = g->n_vertices;
    size[1] = g->n_triangles;
    if (!point || !normal || !face || !shape) return;
    for (size_t i = 0; i < g->n_vertices; i++) {
        const vec3 p = g->p[i], n = g->n ? g->n[i] : (vec3){0, 0, 0};
        memcpy(point + 3 * i, (float[]){p.x, p.y, p.z}, 3 * sizeof *point);
        memcpy(normal + 3 * i, (float[]){n.x, n.y, n.z}, 3 * sizeof *normal);
    }
    for (size_t i = 0; i < g->n_triangles; i++) {
        const uint32_t *v = g->index + 3 * i;
        while (scene->scene->shape_end[k] <= i) k++;
        while (range + 1 < g->n_ranges && g->ranges[range + 1].first <= i) range++;
        memcpy(face + 3 * i, g->ranges[range].mirrored ? (uint32_t[]){v[0], v[2], v[1]} : v, 3 * sizeof *face);
        shape[i] = k;
    }
}

/* Whether a map with the settings of a is that with the settings of b. */
static bool is_same_light(const bis_light_desc *a, const bis_light_desc *b)
{
    return a->area_exponent == b->area_exponent && a->as_printed == b->as_printed &&
           memcmp(&a->to_world, &b->to_world, sizeof a->to_world) == 0;
}

static bis_status load_light(bis_light **light, bis_flat_scene *s, const bis_light_desc *wanted, unsigned needs,
                             bis_diag *diag)
{
    const int at = s->next_light;
    const bis_status status = bis_light_load(light, wanted, needs, NULL, NULL); /* it warned when the scene was built */

    if (status)
        return bis_error(diag, status, nowhere, "%s \"%s\" with other settings",
                         status == BIS_NOMEM ? "no memory to build" : "cannot build", wanted->filename);
    if (at < s->n_lights) bis_light_free(s->lights[at].light);
    else s->n_lights++;
    s->lights[at].desc = *wanted;
    s->lights[at].needs = needs;
    s->lights[at].light = *light;
    s->next_light = (at + 1) % BIS_FLAT_LIGHTS;
    return BIS_OK;
}

bis_status bis_flat_scene_given(bis_light **light, bis_scene_desc *d, const bis_flat_wishes *w, unsigned needs,
                                bis_diag *diag)
{
    bis_image image;
    bis_light_desc desc = bis_light_desc_default();

    give(&desc, &image, w->light);
    desc.visible = d->light.visible;
    desc.windows = d->light.windows;
    if (w->has_area_exponent) desc.area_exponent = d->light.area_exponent;
    desc.as_printed = d->view.settings.as_printed;
    desc.to_world = d->light.to_world;
    desc.table_kind = bis_light_table_kind(&desc, needs, d->view.sampler.kind);
    const bis_status status = bis_light_load(light, &desc, needs, NULL, diag);
    desc.image = NULL; /* it was read */
    d->light = desc;
    d->has_light = true;
    return status;
}

bis_status bis_flat_scene_light(bis_light **light, bis_flat_scene *s, bis_scene_desc *d, const bis_flat_wishes *w,
                                bis_diag *diag)
{
    const unsigned needs = s->needs | d->view.settings.integrator->light_needs(&d->view.settings);
    bis_light_desc own = s->desc->light;

    *light = s->scene->light;
    if (w->light && !d->light.filename) d->light.to_world = s->desc->upright; /* as bis_scene_parse_as has it */
    turn(&d->light, w->turn);
    if (w->light) { /* built for this picture's method alone */
        bis_light_free(s->given);
        s->given = NULL;
        const bis_status status =
            bis_flat_scene_given(&s->given, d, w, d->view.settings.integrator->light_needs(&d->view.settings), diag);
        *light = s->given;
        return status;
    }
    bis_light_desc wanted = d->light;
    if (!s->is_kept || !d->has_light || !d->n_shapes || !bis_light_desc_has_map(&wanted)) return BIS_OK;
    own.as_printed = s->desc->view.settings.as_printed;
    wanted.as_printed = d->view.settings.as_printed;
    wanted.table_kind = bis_light_table_kind(&wanted, needs, d->view.sampler.kind);
    if (needs == s->needs && is_same_light(&wanted, &own)) return BIS_OK;
    for (int i = 0; i < s->n_lights; i++) {
        if (s->lights[i].needs != needs || !is_same_light(&s->lights[i].desc, &wanted)) continue;
        *light = s->lights[i].light;
        return BIS_OK;
    }
    return load_light(light, s, &wanted, needs, diag);
}

/* ---- what it covers ---- */

/* The share of side x side rays through pixel (x, y) of the full picture that meet a shape. */
static float cover(const bis_flat_scene *s, const bis_camera *camera, const bis_film *film, int x, int y, int side)
{
    int hits = 0;

    for (int k = 0; s->scene->accel && k < side * side; k++) {
        const ray eye = bis_camera_ray(camera, film->full_width, film->full_height, x + (k % side + 0.5) / side,
                                       y + (k / side + 0.5) / side);
        bis_hit hit;
        hits += bis_accel_intersect(s->scene->accel, &eye, &hit);
    }
    return (float)hits / (float)(side * side);
}

bis_status bis_do_scene_coverage(bis_flat_scene *scene, const char *const *settings, int side, float *share,
                                 bis_diag *diag)
{
    bis_flat_wishes w = {0};
    bis_scene_desc d = *scene->desc; /* shallow: the settings change values alone */

    if (!(side >= 1 && side <= 64)) return bis_flat_refuse(diag, "side is %d: give 1 to 64", side);
    bis_status status = bis_flat_wish(&d, &w, settings, diag);
    if (!status) status = bis_flat_scene_check(scene, &d, &w, diag);
    if (status) return status;
    const bis_film film = bis_film_place(d.view.film.width, d.view.film.height, d.view.film.crop, 1);
    for (int i = 0; i < film.width * film.height; i++)
        share[i] = cover(scene, &d.view.camera, &film, film.x0 + i % film.width, film.y0 + i / film.width, side);
    return BIS_OK;
}
