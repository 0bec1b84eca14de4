/* SPDX-License-Identifier: BSD-2-Clause */
/* scene_desc: a scene as described: what it is when its file says nothing, how it grows, how it is freed.
 *
 * The defaults are those of docs/scene-format.md and, where it is silent, pbrt-v4's: a perspective camera at the
 * origin that looks along +z, a grey diffuse material. */
#include "scene_desc.h"

#include "base/grow.h"

#include "bis/thesis/phong.h"
#include "bis/scene/light_load.h"

#include <string.h>

const bis_film_desc bis_film_default = {.width = 1280, .height = 720, .crop = {0, 1, 0, 1}};

static bool set_text(char **out, const char *s) { return (*out = bis_strdup(s)) != NULL; }

static bool add_default_material(bis_scene_desc *d)
{
    d->materials = bis_grow(NULL, &d->capacity_materials, 1, sizeof *d->materials);
    if (!d->materials) return false;
    d->materials[d->n_materials++] = bis_phong(rgb_from(0.5, 0.5, 0.5), rgb_from(0, 0, 0), 50);
    return true;
}

static bool add_own_name(bis_scene_desc *d)
{
    char *name = bis_strdup(d->path);
    return name && bis_scene_desc_add_file(d, name);
}

bis_scene_desc *bis_scene_desc_new(const char *path)
{
    bis_scene_desc *d = bis_alloc(1, sizeof *d);
    if (!d) return NULL;
    d->view.camera = (bis_camera){.fov_deg = 90, .to_world = bis_xform_identity()};
    d->view.film = bis_film_default;
    d->view.sampler = (bis_sampler){.kind = BIS_SAMPLER_SOBOL, .jitter = true};
    bis_sampler_set_spp(&d->view.sampler, 16);
    d->view.edge_samples = 8; /* twice the light samples of another pixel: docs/integrators.md */
    d->view.edge_light = 0.25;
    d->view.pixel_jitter = true;
    d->view.settings = bis_settings_unnamed();
    d->light = bis_light_desc_default();
    if (!set_text(&d->path, path) || !set_text(&d->outfile, BIS_FILM_FILENAME) || !add_default_material(d) ||
        !add_own_name(d)) {
        bis_scene_desc_free(d);
        return NULL;
    }
    d->integrator_loc = (bis_loc){d->files[0], 0, 0};
    return d;
}

void bis_scene_name_integrator(bis_scene_desc *d, const bis_integrator *integrator, bis_loc at)
{
    if (d->names_integrator && d->view.settings.integrator == integrator) return;
    bis_settings_replace(&d->view.settings, bis_settings_default(integrator));
    d->integrator_loc = at;
}

void bis_scene_desc_free(bis_scene_desc *d)
{
    if (!d) return;
    for (size_t i = 0; i < d->n_meshes; i++) {
        bis_free(d->meshes[i].filename);
        bis_mesh_clear(&d->meshes[i].mesh);
    }
    for (size_t i = 0; i < d->n_files; i++) bis_free(d->files[i]);
    bis_free(d->meshes);
    bis_free(d->shapes);
    bis_free(d->files);
    bis_free(d->materials);
    for (size_t i = 0; i < d->n_missing; i++) bis_free(d->missing[i]);
    bis_free(d->missing);
    bis_free(d->approximations);
    bis_textures_clear(&d->textures);
    bis_free(d->light.filename);
    bis_free(d->light.distants);
    bis_free(d->outfile);
    bis_free(d->path);
    bis_free(d);
}

const char *bis_approximation_text(char text[BIS_APPROXIMATION_TEXT], const bis_approximation *a)
{
    char number[32] = "", share[64] = "";

    if (a->effect > BIS_EFFECT_INDIRECT) snprintf(number, sizeof number, "%zu x ", a->n);
    if (a->of) snprintf(share, sizeof share, " (of %zu %s)", a->of, a->among);
    snprintf(text, BIS_APPROXIMATION_TEXT, "%s%s%s: %s", number, a->kind, share, a->consequence);
    return text;
}

const char *bis_scene_desc_add_file(bis_scene_desc *d, char *name)
{
    char **files = bis_grow(d->files, &d->capacity_files, d->n_files + 1, sizeof *files);
    if (!files) {
        bis_free(name);
        return NULL;
    }
    d->files = files;
    return d->files[d->n_files++] = name;
}

bool bis_scene_desc_add_missing(bis_scene_desc *d, char *name)
{
    char **missing = bis_grow(d->missing, &d->capacity_missing, d->n_missing + 1, sizeof *missing);
    if (!missing) {
        bis_free(name);
        return false;
    }
    d->missing = missing;
    d->missing[d->n_missing++] = name;
    return true;
}

bool bis_scene_desc_add_shape(bis_scene_desc *d, const bis_shape_desc *shape)
{
    bis_shape_desc *shapes = bis_grow(d->shapes, &d->capacity_shapes, d->n_shapes + 1, sizeof *shapes);
    if (!shapes) return false;
    d->shapes = shapes;
    d->shapes[d->n_shapes++] = *shape;
    return true;
}

bool bis_scene_desc_set_textures(bis_scene_desc *d, uint32_t material, const bis_material_textures *textures)
{
    bis_textures *t = &d->textures;

    if (!bis_room(&t->of_material, &t->capacity_of_material, (size_t)material + 1, sizeof *t->of_material))
        return false;
    while (t->n_of_material <= material) t->of_material[t->n_of_material++] = BIS_NO_TEXTURES;
    t->of_material[material] = *textures;
    return true;
}
