/* SPDX-License-Identifier: BSD-2-Clause */
/* parser_points: points, normals, texture coordinates and faces that a Shape lists. Their numbers are checked against
 * one another here, where the place is known. */
#include "bis/base/file.h"
#include "base/grow.h"
#include "approximate.h"
#include "parser_ask.h"
#include "parser_shapes.h"
#include "parser_version.h"

#include <string.h>

bool bis_parser_add_mesh(bis_parser *p, const bis_mesh_desc *mesh, uint32_t *index)
{
    bis_scene_desc *d = p->desc;
    if (!BIS_ROOM(d->meshes, d->capacity_meshes, d->n_meshes) || d->n_meshes >= UINT32_MAX)
        return bis_parser_nomem(p, mesh->loc);
    *index = (uint32_t)d->n_meshes;
    d->meshes[d->n_meshes] = *mesh;
    if (mesh->making == BIS_MAKING_NONE)
        d->meshes[d->n_meshes].size = (bis_made_size){mesh->mesh.n_vertices, mesh->mesh.n_triangles};
    d->n_meshes++;
    return true;
}

/* numbers as vectors, three each; what is left over is dropped. NULL: complained. */
static vec3 *vectors(bis_parser *p, const bis_param *param, const char *name)
{
    const double *v = p->params.numbers + param->first;
    const size_t n = param->n / 3;
    char kind[BIS_APPROXIMATION_KIND];
    snprintf(kind, sizeof kind, "\"%s\" of numbers that are no vectors", name);
    if (param->n % 3 && !bis_approximate_or_refuse(p, param->at, kind, "the last numbers are left out", "\"%s\" has "
                                                   "%zu values, must have a multiple of 3", name, param->n))
        return NULL;
    vec3 *out = bis_alloc(n, sizeof *out);
    if (!out) bis_parser_nomem(p, param->at);
    for (size_t i = 0; out && i < n; i++) out[i] = vec3_from(v[3 * i], v[3 * i + 1], v[3 * i + 2]);
    return out;
}

/* Indices are doubles here, like all numbers of a scene: whole ones below 2^53 are exact. */
static bool check_index(bis_parser *p, const bis_param *param, size_t i, size_t n_points)
{
    char buf[32];
    const double v = p->params.numbers[param->first + i];
    if (v >= 0 && v < (double)n_points && v == floor(v)) return true;
    bis_approximate_or_refuse(p, param->at, "a mesh with an index out of range", "the mesh is left out, as in pbrt",
                              "\"indices\" holds %s as its value %zu, must be a whole number in [0, %zu]",
                              bis_format_double(buf, v), i + 1, n_points - 1);
    return false;
}

/* pbrt-v1 to v3 do not look at indices that make no face. False: complained. */
static bool drop_surplus(bis_parser *p, const bis_param *param, size_t per_face)
{
    static const char kind[] = "indices that make no face";
    if (param->n % per_face == 0) return true;
    if (!bis_parser_predates_v4(p))
        return bis_approximate_or_refuse(p, param->at, kind, "left out, as in pbrt", "\"indices\" has %zu values, must "
                                         "have a multiple of %zu", param->n, per_face);
    bis_approximate_pass(p, param->at, "left out, as in pbrt-v1 to v3", kind);
    return true;
}

bool bis_parser_indices(bis_parser *p, const char *shape, size_t per_face, size_t n_points, uint32_t **index,
                        size_t *n_faces)
{
    const bool given = bis_params_has(p, "indices"); /* asked first: `take` returns NULL after a complaint, too */
    const bis_param *param = bis_params_take(p, "indices", BIS_TYPE_INTEGER, 0);
    if (!param && given) return false;
    if (!param && n_points != per_face) {
        bis_approximate_or_refuse(p, p->name_at, "a mesh without \"indices\"", "left out, as in pbrt",
                                  "%s needs \"integer indices\", unless it has %zu points; it has %zu", shape, per_face,
                                  n_points);
        return false;
    }
    if (param && !drop_surplus(p, param, per_face)) return false;
    *n_faces = param ? param->n / per_face : 1;
    const size_t n = *n_faces * per_face;
    *index = bis_alloc(n, sizeof **index);
    if (!*index) return bis_parser_nomem(p, p->name_at);
    for (size_t i = 0; i < n; i++) {
        if (param && !check_index(p, param, i, n_points)) return false;
        (*index)[i] = param ? (uint32_t)p->params.numbers[param->first + i] : (uint32_t)i;
    }
    return true;
}

/* Of another number than the points: pbrt drops them all, but pbrt-v1 to v3 take the first of too many texture
 * coordinates. Returns whether they are to be used; *ok becomes false after a complaint. */
static bool fits(bis_parser *p, const bis_param *param, const char *name, size_t per_point, size_t n_points, bool *ok)
{
    char kind[BIS_APPROXIMATION_KIND];
    if (param->n == per_point * n_points) return true;
    const bool takes_first = strcmp(name, "N") != 0 && param->n > per_point * n_points && bis_parser_predates_v4(p);
    const char *consequence = takes_first ? "the first ones are taken" : "left out, as in pbrt";
    snprintf(kind, sizeof kind, "\"%s\" of another number than \"P\"", name);
    *ok = bis_approximate_or_refuse(p, param->at, kind, consequence, "\"%s\" has %zu values, must have %zu for each of "
                                    "the %zu points", name, param->n, per_point, n_points);
    return *ok && takes_first;
}

static bool read_normals(bis_parser *p, bis_mesh *m)
{
    const bool given = bis_params_has(p, "N");
    const bis_param *param = bis_params_take(p, "N", BIS_TYPE_NORMAL, 0);
    bool ok = true;
    if (!param) return !given;
    if (!fits(p, param, "N", 3, m->n_vertices, &ok)) return ok;
    m->n = vectors(p, param, "N");
    return m->n != NULL;
}

/* pbrt-v4's point2 uv, pbrt-v3's float uv or st. */
static bool read_uv(bis_parser *p, bis_mesh *m)
{
    const char *name = bis_params_has(p, "uv") ? "uv" : "st";
    const bool given = bis_params_has(p, name);
    const bis_param *param = bis_params_take(p, name, BIS_TYPE_POINT2 | BIS_TYPE_FLOAT, 0);
    bool ok = true;
    if (!param) return !given;
    if (!fits(p, param, name, 2, m->n_vertices, &ok)) return ok;
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

    if (!given)
        bis_approximate_or_refuse(p, p->name_at, "a mesh without \"P\"", "left out, as in pbrt",
                                  "%s needs \"point3 P\"", shape);
    if (!points) return false;
    m->p = vectors(p, points, "P");
    m->n_vertices = points->n / 3; /* before N and uv, whose numbers are held against it */
    return m->p && (m->n_vertices <= UINT32_MAX || bis_parser_error(p, points->at, "more than 2^32 - 1 points")) &&
           read_normals(p, m) && read_uv(p, m);
}
