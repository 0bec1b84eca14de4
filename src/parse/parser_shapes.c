/* SPDX-License-Identifier: BSD-2-Clause */
/* parser_shapes: Shape, docs/scene-format.md, "Shape".
 *
 * Files are only looked for, not read: bis_scene_build reads each of them once, however many shapes and instances name
 * it. */
#include "bis/base/file.h"
#include "base/grow.h"
#include "approximate.h"
#include "directives.h"
#include "parser_ask.h"
#include "parser_shapes.h"
#include "parser_textures.h"
#include "parser_version.h"
#include "scene/scene_peek.h"

#include <string.h>

/* ---- meshes ---- */

/* A file of a format that neither PLY nor OBJ is, whatever it is called. */
static bool is_model(bis_parser *p, bis_loc at, const char *path)
{
    bis_stranger_kind kind;
    const char *what = bis_scene_peek_stranger(path, &kind);
    if (!what || kind != BIS_STRANGER_MODEL) return false;
    return !bis_parser_error(p, at, "\"%s\" is %s: %s", bis_parser_word(p, path), what, BIS_MODEL_ADVICE);
}

/* The mesh of a file: a new one, or the one that has been named before. Takes over path. */
static bool file_mesh(bis_parser *p, char *path, const bis_mesh_desc *desc, uint32_t *index)
{
    const size_t room = strlen(path) + 40;
    char *key = bis_alloc(room, 1); /* kind, smooth, parts, up, fit, path */
    bis_mesh_desc mesh = *desc;
    bool ok = key != NULL;

    if (ok) snprintf(key, room, "%c%c%c%c%a %s", desc->kind == BIS_SHAPE_PLY ? 'p' : 'o', desc->smooth ? 's' : 'f',
                     desc->has_parts ? 'm' : '-', desc->is_y_up ? 'y' : 'z', desc->fit, path);
    if (ok && bis_names_find(&p->mesh_names, key, index)) {
        bis_free(path);
    } else if (ok && is_model(p, desc->loc, path)) {
        bis_free(key);
        bis_free(path);
        return false;
    } else {
        mesh.filename = path;
        ok = ok && bis_parser_add_mesh(p, &mesh, index);
        if (!ok) bis_free(path);
        if (ok && !bis_names_set(&p->mesh_names, key, *index)) ok = false;
    }
    if (!ok && !p->stop) bis_parser_nomem(p, desc->loc);
    bis_free(key);
    return ok;
}

static bool read_file(bis_parser *p, bis_shape_desc *shape)
{
    const char *name;
    bis_mesh_desc mesh = {.kind = shape->kind};
    bis_params_bool(p, "smooth", &mesh.smooth);
    if (shape->kind == BIS_SHAPE_OBJ) bis_params_bool(p, "materials", &mesh.has_parts);
    if (bis_params_float(p, "fit", &mesh.fit, (bis_interval){0, HUGE_VAL, true, true})) {
        static const char *const axes[] = {"z", "y"};
        int up = 0;
        bis_params_choice(p, "up", &up, axes, BIS_COUNT(axes));
        mesh.is_y_up = up == 1;
    }
    const bool given = bis_params_has(p, "filename");
    const bis_loc at = bis_params_at(p, "filename");
    if (!bis_params_string(p, "filename", &name)) {
        if (!given) bis_parser_error(p, p->name_at, "Shape needs \"string filename\"");
        return false;
    }
    char *path = bis_parser_path(p, at, name, NULL);
    mesh.loc = at;
    return path && file_mesh(p, path, &mesh, &shape->mesh);
}

/* ---- trianglemesh ---- */

static bool read_triangles(bis_parser *p, bis_shape_desc *shape)
{
    bis_mesh m = {0};
    const bool ok = bis_parser_points(p, "trianglemesh", &m) &&
                    bis_parser_indices(p, "trianglemesh", 3, m.n_vertices, &m.index, &m.n_triangles) &&
                    bis_parser_add_mesh(p, &(bis_mesh_desc){.kind = BIS_SHAPE_TRIANGLES, .mesh = m, .loc = shape->loc},
                                        &shape->mesh);
    if (!ok) bis_mesh_clear(&m);
    return ok;
}

/* ---- Shape ---- */

void bis_parser_drop_uv(bis_parser *p)
{
    bis_scene_desc *d = p->desc;
    bool some = false;
    for (size_t i = 0; i < d->n_meshes; i++)
        some |= d->meshes[i].mesh.uv || d->meshes[i].making == BIS_MAKING_REVOLVED;
    bool *is_used = some ? bis_alloc(d->n_meshes, sizeof *is_used) : NULL;
    if (some && !is_used) bis_parser_nomem(p, (bis_loc){d->files[0], 0, 0});
    if (!is_used) return;
    for (size_t i = 0; i < d->n_shapes; i++) {
        const bis_shape_desc *s = &d->shapes[i];
        if (s->kind == BIS_SHAPE_TRIANGLES && bis_textures_of(&d->textures, s->material)) is_used[s->mesh] = true;
    }
    for (size_t i = 0; i < d->n_meshes; i++) {
        if (is_used[i]) continue;
        bis_free(d->meshes[i].mesh.uv);
        d->meshes[i].mesh.uv = NULL;
        d->meshes[i].lacks_uv = true;
    }
    bis_free(is_used);
}

/* A missing file, which a plan lists, has none that are known. */
static bool has_parts(const bis_parser *p, const bis_shape_desc *shape)
{
    if (shape->kind != BIS_SHAPE_OBJ) return false;
    const bis_mesh_desc *m = &p->desc->meshes[shape->mesh];
    return m->has_parts && !bis_parser_is_missing(p, m->filename);
}

/* Does "alpha" of this shape change nothing in the scene's version, but in another? */
static bool is_passed_over(bis_parser *p, bis_loc at, bool is_mesh)
{
    const char *what = is_mesh ? "\"alpha\" between 0 and 1" : "\"alpha\" of a shape that is no mesh";
    return bis_parser_is_before_v4(p, at, what, "it makes holes, and 0 the whole shape a hole", "it changes nothing");
}

/* "alpha" or "shadowalpha": 1 and more changes nothing, another constant than 0 and a texture are not modelled. Returns
 * whether it is a constant 0. whole: what --approximate makes of it. */
static bool is_0(bis_parser *p, const bis_choice *shape, const char *name, const char *whole)
{
    static const bis_interval any = {-HUGE_VAL, HUGE_VAL, false, false};
    char kind[BIS_APPROXIMATION_KIND];
    uint32_t texture = BIS_NO_TEXTURE;
    double alpha = 1;
    const bis_loc at = bis_params_at(p, name);
    bis_params_number(p, name, &alpha, any, &texture);
    const bool varies = texture != BIS_NO_TEXTURE, is_mesh = shape->value < BIS_MADE_SPHERE;
    if (!varies && alpha >= 1) return false;
    snprintf(kind, sizeof kind, "\"%s\" of Shape \"%s\"", name, shape->name);
    const bool is_alike = is_mesh && (varies || alpha == 0); /* in all versions */
    if (!is_alike && is_passed_over(p, at, is_mesh)) {
        bis_approximate_pass(p, at, "ignored, which changes nothing, as in pbrt-v1 to v3", "%s", kind);
        return false;
    }
    if (!varies && alpha <= 0) return true;
    bis_approximate_or_refuse(p, at, kind, whole, "\"%s\" is not modelled but for 0 and 1", name);
    return false;
}

/* pbrt-v4's alpha of any shape, earlier versions' of triangle meshes, of which 0 alone counts, and their shadowalpha.
 * Returns whether the shape is there. Sources: src/pbrt/cpu/primitive.cpp, and src/shapes/triangle.cpp of v3. */
static bool read_alpha(bis_parser *p, const bis_choice *shape)
{
    const bool is_seen = !is_0(p, shape, "alpha", "the shape has no holes");
    if (is_0(p, shape, "shadowalpha", "its shadow has no holes"))
        bis_approximate_or_refuse(p, bis_params_at(p, "shadowalpha"), "\"shadowalpha\" of 0",
                                  "the shape casts a shadow",
                                  "\"shadowalpha\" is not modelled: shapes that are seen cast shadows");
    return is_seen;
}

void bis_directive_shape(bis_parser *p, bis_loc at)
{
    static const bis_choice shapes[] = {
        {"plymesh", BIS_SHAPE_PLY},      {"objmesh", BIS_SHAPE_OBJ},          {"trianglemesh", BIS_SHAPE_TRIANGLES},
        {"sphere", BIS_MADE_SPHERE},     {"disk", BIS_MADE_DISK},             {"cylinder", BIS_MADE_CYLINDER},
        {"cone", BIS_MADE_CONE},         {"paraboloid", BIS_MADE_PARABOLOID}, {"hyperboloid", BIS_MADE_HYPERBOLOID},
        {"loopsubdiv", BIS_MADE_LOOP},   {"bilinearmesh", BIS_MADE_PATCHES},  {"heightfield", BIS_MADE_HEIGHTS},
        {"nurbs", BIS_MADE_NURBS},       {"curve", BIS_FOREIGN},
    };
    /* what changes nothing here: texture coordinates that are of no use, tangents, and numbers of faces for other
     * textures */
    static const char *const silent[] = {"uv", "st", "S", "faceIndices"};
    /* what may not have been asked for after a mistake */
    static const char *const rest[] = {"indices", "N", "Pz", "Pw", "P", "u0", "u1", "uknots", "v0", "v1", "vknots"};

    const bis_choice *chosen = bis_parser_begin(p, "Shape", shapes, BIS_COUNT(shapes));
    if (!chosen || chosen->value == BIS_FOREIGN) return; /* left out */
    const bool is_seen = read_alpha(p, chosen);
    bis_shape_desc shape = {.to_world = p->now.ctm, .material = p->now.material, .loc = at};
    bool ok;
    if (chosen->value >= BIS_MADE_SPHERE) {
        ok = bis_parser_made(p, chosen->value, &shape);
    } else {
        shape.kind = (bis_shape_kind)chosen->value;
        ok = shape.kind == BIS_SHAPE_TRIANGLES ? read_triangles(p, &shape) : read_file(p, &shape);
    }
    if (!ok) bis_params_skip(p, rest, BIS_COUNT(rest));
    bis_params_skip(p, silent, BIS_COUNT(silent));
    bis_parser_override(p, &shape.material);
    bis_params_end(p, "Shape", chosen->name);
    if (!ok || !is_seen) return;
    if (has_parts(p, &shape)) bis_parser_add_parts(p, &shape);
    else bis_parser_add_shape(p, &shape);
}
