/* SPDX-License-Identifier: BSD-2-Clause */
/* scene_check: what can be known of a scene's files by their heads, for a plan that must not say yes where the render
 * says no. What it finds wrong is read by the loader, so that there is one message for one fault. */
#include "bis/scene/scene.h"

#include "bis/base/mem.h"
#include "bis/files/image_file.h"
#include "files/obj.h"
#include "files/ply.h"
#include "scene_needs.h"
#include "scene_peek.h"

#include <unistd.h>

/* path may be NULL, as of a shape that needs no file. */
static bool is_there(const char *path) { return path && access(path, R_OK) == 0; }

static void keep_first(bis_status *all, bis_status status)
{
    if (!*all) *all = status;
}

/* A head that tells no size is damaged, or longer than what is looked at, and the end may be missing: then the loader
 * decides. */
static bis_status check_image(const bis_texture_file *file, bis_diag *diag)
{
    bis_texture_image image;
    long width, height;

    const bis_status status = bis_image_check_head(file->filename, true, file->loc, diag);
    if (status || (bis_scene_peek_image(file->filename, &width, &height) && !bis_image_looks_cut(file->filename)))
        return status;
    const bis_status loaded = bis_textures_load(&image, file, diag);
    if (!loaded) bis_image_clear(&image.image);
    return loaded;
}

static bis_status check_light(const bis_light_desc *light, bis_diag *diag)
{
    bis_light_desc d = *light;
    long width, height;
    bool is_strip;
    bis_image map;

    if (!is_there(light->filename)) return BIS_OK;
    const bis_status status = bis_image_check_head(light->filename, false, light->loc, diag);
    if (status) return status;
    if (!bis_scene_peek_image(light->filename, &width, &height)) {
        const bis_status loaded = bis_image_read_map(&map, &is_strip, light->filename, light->loc, diag);
        width = map.width;
        height = map.height;
        bis_image_clear(&map);
        if (loaded) return loaded;
        bis_light_take_layout(&d, is_strip);
    }
    return bis_light_check_size(&d, (int)width, (int)height, diag);
}

static bis_status check_mesh(const bis_mesh_desc *m, bis_diag *diag)
{
    bis_mesh mesh = {0};
    long vertices, faces;

    if (!is_there(m->filename)) return BIS_OK;
    if (m->kind == BIS_SHAPE_PLY ? bis_scene_peek_ply(m->filename, &vertices, &faces)
                                 : m->kind != BIS_SHAPE_OBJ || bis_scene_peek_is_text(m->filename))
        return BIS_OK;
    const bis_status status = m->kind == BIS_SHAPE_PLY ? bis_ply_read(&mesh, m->filename, m->loc, diag)
                                                       : bis_obj_read(&mesh, m->filename, m->loc, diag);
    bis_mesh_clear(&mesh);
    return status;
}

/* Does a material need images? own[n_files] is room. */
static bool needs_images(bool *own, const bis_textures *t, const bis_material_textures *m)
{
    bool any = false;

    for (size_t k = 0; k < t->n_files; k++) own[k] = false;
    bis_textures_mark_all(own, t, m);
    for (size_t k = 0; k < t->n_files; k++) any |= own[k];
    return any;
}

static bis_status check_textures(const bis_scene_desc *d, const bis_scene_needs *needs, bool *own, bis_diag *diag)
{
    const bis_textures *t = &d->textures;
    bis_status status = BIS_OK;

    for (uint32_t i = 0; i < t->n_of_material; i++) {
        const bis_material_textures *m = needs->materials[i] ? bis_textures_of(t, i) : NULL;
        if (m && !needs_images(own, t, m))
            keep_first(&status, bis_textures_check(t, NULL, m, &d->materials[i], diag));
    }
    for (size_t k = 0; k < t->n_files; k++)
        if (needs->images[k] && is_there(t->files[k].filename))
            keep_first(&status, check_image(&t->files[k], diag));
    return status;
}

bis_status bis_scene_check_files(const bis_scene_desc *desc, bis_diag *diag)
{
    bool *own = bis_alloc(desc->textures.n_files, sizeof *own);
    bis_scene_needs needs;
    bis_status status = bis_scene_needs_of(&needs, desc, diag);

    if (!status && !own)
        status = bis_error(diag, BIS_NOMEM, (bis_loc){desc->path, 0, 0}, "no memory to look at the scene's files");
    if (status) goto done;
    keep_first(&status, check_light(&desc->light, diag));
    for (size_t i = 0; i < desc->n_meshes; i++)
        if (needs.uses[i]) keep_first(&status, check_mesh(&desc->meshes[i], diag));
    keep_first(&status, check_textures(desc, &needs, own, diag));
done:
    bis_scene_needs_clear(&needs);
    bis_free(own);
    return status;
}
