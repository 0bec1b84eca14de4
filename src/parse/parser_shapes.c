/* parser_shapes: Shape, docs/scene-format.md, "Shape".
 *
 * Files are only looked for, not read: bis_scene_build reads each of them once, however many shapes and instances name
 * it. The numbers of a "trianglemesh" are checked against one another here, where the place is known. */
#include "bis/base/file.h"
#include "base/grow.h"
#include "approximate.h"
#include "parser.h"

#include <string.h>

/* ---- meshes ---- */

bool bis_parser_add_mesh(bis_parser *p, const bis_mesh_desc *mesh, uint32_t *index)
{
    bis_scene_desc *d = p->desc;
    if (!BIS_ROOM(d->meshes, d->capacity_meshes, d->n_meshes) || d->n_meshes >= UINT32_MAX)
        return bis_parser_nomem(p, mesh->loc);
    *index = (uint32_t)d->n_meshes;
    d->meshes[d->n_meshes++] = *mesh;
    return true;
}

/* The mesh of a file: a new one, or the one that has been named before. Takes over path. */
static bool file_mesh(bis_parser *p, char *path, const bis_mesh_desc *desc, uint32_t *index)
{
    const size_t room = strlen(path) + 4;
    char *key = bis_alloc(room, 1); /* kind, smooth, parts, path */
    bis_mesh_desc mesh = *desc;
    bool ok = key != NULL;

    if (ok) snprintf(key, room, "%c%c%c%s", desc->kind == BIS_SHAPE_PLY ? 'p' : 'o', desc->smooth ? 's' : 'f',
                     desc->has_parts ? 'm' : '-', path);
    if (ok && bis_names_find(&p->mesh_names, key, index)) {
        bis_free(path);
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
    const bool given = bis_params_has(p, "filename");
    const bis_loc at = bis_params_at(p, "filename");
    if (!bis_params_string(p, "filename", &name)) {
        if (!given) bis_parser_error(p, p->name_at, "Shape needs \"string filename\"");
        return false;
    }
    char *path = bis_parser_path(p, at, name);
    mesh.loc = at;
    return path && file_mesh(p, path, &mesh, &shape->mesh);
}

/* ---- trianglemesh ---- */

/* numbers as vectors, three each; NULL: complained. */
static vec3 *vectors(bis_parser *p, const bis_param *param, const char *name)
{
    const double *v = p->params.numbers + param->first;
    const size_t n = param->n / 3;
    if (param->n % 3) {
        bis_parser_error(p, param->at, "\"%s\" has %zu values, must have a multiple of 3", name, param->n);
        return NULL;
    }
    vec3 *out = bis_alloc(n, sizeof *out);
    if (!out) bis_parser_nomem(p, param->at);
    for (size_t i = 0; out && i < n; i++) out[i] = vec3_from(v[3 * i], v[3 * i + 1], v[3 * i + 2]);
    return out;
}

static bool check_index(bis_parser *p, const bis_param *param, size_t i, size_t n_points)
{
    char buf[32];
    const double v = p->params.numbers[param->first + i];
    if (v >= 0 && v < (double)n_points && v == floor(v)) return true;
    return bis_parser_error(p, param->at, "\"indices\" holds %s as its value %zu, must be a whole number in [0, %zu]",
                            bis_format_double(buf, v), i + 1, n_points - 1);
}

bool bis_parser_indices(bis_parser *p, const char *shape, size_t per_face, size_t n_points, uint32_t **index,
                        size_t *n_faces)
{
    const bool given = bis_params_has(p, "indices");
    const bis_param *param = bis_params_take(p, "indices", BIS_TYPE_INTEGER, 0);
    if (!param && given) return false;
    if (!param && n_points != per_face)
        return bis_parser_error(p, p->name_at,
                                "%s needs \"integer indices\", unless it has %zu points; it has %zu", shape, per_face,
                                n_points);
    const size_t n = param ? param->n : per_face;
    if (n % per_face)
        return bis_parser_error(p, param->at, "\"indices\" has %zu values, must have a multiple of %zu", n, per_face);
    *index = bis_alloc(n, sizeof **index);
    if (!*index) return bis_parser_nomem(p, p->name_at);
    for (size_t i = 0; i < n; i++) {
        if (param && !check_index(p, param, i, n_points)) return false;
        (*index)[i] = param ? (uint32_t)p->params.numbers[param->first + i] : (uint32_t)i;
    }
    *n_faces = n / per_face;
    return true;
}

static bool read_normals(bis_parser *p, bis_mesh *m)
{
    const bool given = bis_params_has(p, "N");
    const bis_param *param = bis_params_take(p, "N", BIS_TYPE_NORMAL, 0);
    if (!param) return !given;
    if (param->n != 3 * m->n_vertices)
        return bis_parser_error(p, param->at, "\"N\" has %zu values, must have 3 for each of the %zu points", param->n,
                                m->n_vertices);
    m->n = vectors(p, param, "N");
    return m->n != NULL;
}

/* pbrt-v4's point2 uv, pbrt-v3's float uv or st. */
static bool read_uv(bis_parser *p, bis_mesh *m)
{
    const char *name = bis_params_has(p, "uv") ? "uv" : "st";
    const bool given = bis_params_has(p, name);
    const bis_param *param = bis_params_take(p, name, BIS_TYPE_POINT2 | BIS_TYPE_FLOAT, 0);
    if (!param) return !given;
    if (param->n != 2 * m->n_vertices)
        return bis_parser_error(p, param->at, "\"%s\" has %zu values, must have 2 for each of the %zu points", name,
                                param->n, m->n_vertices);
    m->uv = bis_alloc(m->n_vertices, sizeof *m->uv);
    if (!m->uv) return bis_parser_nomem(p, param->at);
    const double *v = p->params.numbers + param->first;
    for (size_t i = 0; i < m->n_vertices; i++) m->uv[i] = (bis_uv){(float)v[2 * i], (float)v[2 * i + 1]};
    return true;
}

bool bis_parser_points(bis_parser *p, const char *shape, bis_mesh *m)
{
    const bool given = bis_params_has(p, "P");
    const bis_param *points = bis_params_take(p, "P", BIS_TYPE_POINT3, 0);

    if (!given) bis_parser_error(p, p->name_at, "%s needs \"point3 P\"", shape);
    if (!points) return false;
    m->p = vectors(p, points, "P");
    m->n_vertices = points->n / 3;
    return m->p && (m->n_vertices <= UINT32_MAX || bis_parser_error(p, points->at, "more than 2^32 - 1 points")) &&
           read_normals(p, m) && read_uv(p, m);
}

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
    for (size_t i = 0; i < d->n_meshes; i++) some |= d->meshes[i].mesh.uv != NULL;
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
    }
    bis_free(is_used);
}

static bool has_parts(const bis_parser *p, const bis_shape_desc *shape)
{
    return shape->kind == BIS_SHAPE_OBJ && p->desc->meshes[shape->mesh].has_parts;
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
    static const char *const ignored[] = {"alpha", "shadowalpha"};
    /* what may not have been asked for after a mistake */
    static const char *const rest[] = {"indices", "N", "Pz", "Pw", "P", "u0", "u1", "uknots", "v0", "v1", "vknots"};

    const bis_choice *chosen = bis_parser_begin(p, "Shape", shapes, BIS_COUNT(shapes));
    if (!chosen || chosen->value == BIS_FOREIGN) return; /* left out */
    if (p->approximate && (bis_params_has(p, "alpha") || bis_params_has(p, "shadowalpha")))
        bis_approximate_note(p, at, "the shape has no holes", "\"alpha\" of Shape \"%s\"", chosen->name);
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
    bis_params_ignore(p, ignored, BIS_COUNT(ignored));
    bis_params_end(p, "Shape", chosen->name);
    if (ok && has_parts(p, &shape)) bis_parser_add_parts(p, &shape);
    else if (ok) bis_parser_add_shape(p, &shape);
}
