/* SPDX-License-Identifier: BSD-2-Clause */
/* flat_stage_about: what is known of a pixel without a random number, as JSON: the scene and its light, the surface,
 * why nothing is reflected, and the methods that are worth a run. */
#include "flat/stage.h"

#include "bis/base/file.h"
#include "bis/thesis/envmap.h"
#include "flat/face.h"

#include <stdlib.h>
#include <string.h>

static const char *kind_of(const bis_shape_desc *s)
{
    static const char *const kinds[] = {[BIS_SHAPE_PLY] = "plymesh",
                                        [BIS_SHAPE_OBJ] = "objmesh",
                                        [BIS_SHAPE_TRIANGLES] = "trianglemesh",
                                        [BIS_SHAPE_SPHERE] = "sphere",
                                        [BIS_SHAPE_DISK] = "disk"};
    return kinds[s->kind];
}

static const char *why_nothing(const bis_flat_stage *stage)
{
    if (!stage->is_hit) return "no surface: the camera looks past all shapes";
    if (bis_light_is_black(stage->scene.light)) return "no light: the scene has none, or a black one";
    if (rgb_is_black(stage->hit.material->Kd) && rgb_is_black(stage->hit.material->Ks))
        return "no reflection: the material is black";
    if (bis_bsdf_is_black(&stage->pt.bsdf))
        return "no reflection: the eye lies below the horizon of the shading normal";
    return NULL;
}

static void put_vector(bis_json *j, const char *key, vec3 v)
{
    bis_json_triple(j, key, (double)v.x, (double)v.y, (double)v.z);
}

static void put_colour(bis_json *j, const char *key, rgb c)
{
    bis_json_triple(j, key, (double)c.r, (double)c.g, (double)c.b);
}

static void put_material(bis_json *j, const bis_material *m, double p_specular)
{
    const bis_bsdf_width w = m->model->width(m);
    const bool has_exponent = strcmp(w.name, "exponent") == 0, has_alpha = strcmp(w.name, "alpha") == 0;

    bis_json_open(j, "material", '{');
    bis_json_text(j, "model", m->model->name);
    put_colour(j, "Kd", m->Kd);
    put_colour(j, "Ks", m->Ks);
    BIS_JSON_NUMBERS(j, {"exponent", has_exponent ? w.value : (double)NAN},
                     {"alpha", has_alpha ? w.value : (double)NAN}, {"p_specular", p_specular});
    if (w.scene_name && !has_exponent && !has_alpha) bis_json_number(j, w.name, w.value); /* of a model of one's own */
    bis_json_close(j);
}

/* The surface, its texture coordinates, and what the width of its lobe is called. */
static void put_hit(bis_json *j, const bis_flat_stage *stage)
{
    const bis_scene_desc *desc = &stage->desc;
    const bis_shape_desc *s = &desc->shapes[stage->hit.shape];
    const bool is_file = s->kind == BIS_SHAPE_PLY || s->kind == BIS_SHAPE_OBJ;
    const bis_bsdf_width w = stage->hit.material->model->width(stage->hit.material);
    double uv[2];

    bis_json_open(j, "hit", '{');
    bis_json_text(j, "shape", kind_of(s));
    bis_json_text(j, "file", is_file ? desc->meshes[s->mesh].filename : NULL);
    BIS_JSON_NUMBERS(j, {"line", s->loc.line},
                     {"triangle", bis_shape_is_mesh(s->kind) ? (double)stage->hit.part : (double)NAN},
                     {"distance", stage->hit.t});
    put_vector(j, "point", stage->pt.p);
    put_vector(j, "normal", stage->pt.n);
    put_vector(j, "geometric_normal", stage->pt.ng);
    put_vector(j, "wo", stage->pt.wo);
    put_vector(j, "mirrored", stage->pt.bsdf.r);
    bis_json_number(j, "cos_wo", dot(stage->pt.n, stage->pt.wo));
    put_material(j, stage->hit.material, stage->pt.bsdf.p_specular);
    bis_json_close(j);
    bis_geometry_uv(&stage->scene.geometry, stage->hit.prim, &stage->hit.eye, uv);
    bis_json_open(j, "uv", '[');
    BIS_JSON_NUMBERS(j, {NULL, uv[0]}, {NULL, uv[1]});
    bis_json_close(j);
    bis_json_open(j, "lobe", '{');
    bis_json_text(j, "name", w.name);
    bis_json_number(j, "value", w.value);
    bis_json_close(j);
}

static void put_methods(bis_json *j, const bis_settings *own)
{
    bis_pixel_method list[BIS_PIXEL_MAX_METHODS];
    const size_t n = bis_pixel_methods(list, own);

    bis_json_open(j, "methods", '[');
    for (size_t i = 0; i < n; i++) {
        const bis_settings *s = &list[i].settings;
        bis_json_open(j, NULL, '{');
        bis_json_text(j, "method", list[i].name);
        bis_json_text(j, "claim", s->integrator->claim);
        bis_json_bool(j, "without_shadows", list[i].is_open);
        bis_json_open(j, "settings", '{');
        bis_json_text(j, "integrator", s->integrator->name);
        for (const bis_parameter *p = NULL; (p = bis_parameter_next(s->integrator, p)) != NULL;)
            bis_flat_put_parameter(j, p->name, p, bis_parameter_get(p, s));
        bis_json_close(j);
        bis_json_close(j);
    }
    bis_json_close(j);
}

static void put_all(bis_json *j, const bis_flat_stage *stage)
{
    const bis_scene_desc *desc = &stage->desc;
    const bis_view *view = &desc->view;
    const char *nothing = why_nothing(stage);

    const bis_envmap *em = bis_light_envmap(stage->scene.light);

    bis_json_open(j, NULL, '{');
    bis_json_text(j, "scene", desc->path);
    bis_json_text(j, "light", desc->light.filename);
    bis_json_number(j, "map_width", em ? em->width : (double)NAN);
    BIS_JSON_NUMBERS(j, {"width", view->film.width}, {"height", view->film.height});
    bis_json_count(j, "seed", view->sampler.seed);
    bis_json_text(j, "sampler", bis_sampler_name(view->sampler.kind));
    BIS_JSON_NUMBERS(j, {"x", stage->x}, {"y", stage->y});
    if (stage->is_hit) put_hit(j, stage);
    else bis_json_null(j, "hit");
    bis_json_text(j, "nothing", nothing);
    if (nothing)
        put_colour(j, "radiance", stage->is_hit ? (rgb){0, 0, 0}
                                                : bis_light_seen(&desc->light, stage->scene.light, stage->hit.eye.d));
    put_methods(j, &view->settings);
    bis_json_close(j);
}

bis_status bis_do_stage_about(bis_flat_stage *stage, const char **text, bis_diag *diag)
{
    size_t n;

    if (!stage->is_chosen) return bis_flat_refuse(diag, "no pixel was chosen: choose one first");
    free(stage->about);
    stage->about = NULL;
    bis_json j = {.out = open_memstream(&stage->about, &n), .keeps_bytes = true};
    if (j.out) put_all(&j, stage);
    if (!j.out || fclose(j.out) != 0)
        return bis_error(diag, BIS_NOMEM, nowhere, "no memory for what is known of a pixel");
    *text = stage->about;
    return BIS_OK;
}
