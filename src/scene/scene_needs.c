/* SPDX-License-Identifier: BSD-2-Clause */
/* scene_needs: one walk over the shapes, and what the settings ask of the light. */
#include "scene_needs.h"

#include "beyond/guide.h"
#include "bis/base/mem.h"

static void add_shape(bis_scene_needs *needs, const bis_scene_desc *d, const bis_shape_desc *s)
{
    const bis_material_textures *m = bis_textures_of(&d->textures, s->material);

    if (bis_shape_is_mesh(s->kind)) {
        needs->uses[s->mesh]++;
        needs->with_uv[s->mesh] |= m && bis_textures_want_uv(&d->textures, m);
    } else {
        needs->n_quadrics++;
    }
    /* the first shape of a material marks its images; marking again would find the same */
    if (m && !needs->materials[s->material]) bis_textures_mark_all(needs->images, &d->textures, m);
    needs->materials[s->material] = true;
}

/* Without shapes no integrator is ever asked. */
static const char *why_no_drawing(const bis_scene_desc *d, unsigned asked)
{
    if (!d->n_shapes) return "there is no geometry to light";
    if (!d->has_light) return "there is no light";
    if (!bis_light_desc_has_map(&d->light)) return "a constant light is drawn from without tables";
    if (!(asked & (BIS_NEED_TABLE | BIS_NEED_CURVE))) return "this integrator, so set, draws nothing from the map";
    return NULL;
}

static void add_light(bis_scene_needs *needs, const bis_scene_desc *d)
{
    const bis_settings *s = &d->view.settings;
    const unsigned asked = d->light_needs ? d->light_needs : s->integrator->light_needs(s);

    needs->light = d->n_shapes ? asked : 0;
    needs->table = bis_light_table_kind(&d->light, needs->light, d->view.sampler.kind);
    needs->why_no_drawing = why_no_drawing(d, asked);
}

bis_status bis_scene_needs_of(bis_scene_needs *needs, const bis_scene_desc *desc, bis_diag *diag)
{
    *needs = (bis_scene_needs){.uses = bis_alloc(desc->n_meshes, sizeof *needs->uses),
                               .with_uv = bis_alloc(desc->n_meshes, sizeof *needs->with_uv),
                               .materials = bis_alloc(desc->n_materials, sizeof *needs->materials),
                               .images = bis_alloc(desc->textures.n_files, sizeof *needs->images)};
    if (!needs->uses || !needs->with_uv || !needs->materials || !needs->images)
        return bis_error(diag, BIS_NOMEM, (bis_loc){desc->path, 0, 0},
                         "no memory for %zu meshes, %zu materials and %zu images", desc->n_meshes, desc->n_materials,
                         desc->textures.n_files);
    for (size_t i = 0; i < desc->n_shapes; i++) add_shape(needs, desc, &desc->shapes[i]);
    add_light(needs, desc);
    needs->embree = desc->accel.kind == BIS_ACCEL_EMBREE ||
                    (desc->accel.kind == BIS_ACCEL_DEFAULT && bis_accel_embree_version());
    return BIS_OK;
}

bool bis_scene_learns(const bis_scene_desc *desc)
{
    return desc->n_shapes && desc->has_light &&
           bis_beyond_needs_of(&desc->view.settings).visibility;
}

void bis_scene_needs_clear(bis_scene_needs *needs)
{
    bis_free(needs->uses);
    bis_free(needs->with_uv);
    bis_free(needs->materials);
    bis_free(needs->images);
    *needs = (bis_scene_needs){.uses = NULL};
}
