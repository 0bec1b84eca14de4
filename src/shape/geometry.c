/* SPDX-License-Identifier: BSD-2-Clause */
/* geometry: all meshes of a scene become one mesh in world space, so that an accelerator sees two arrays and no
 * pointers. Invariants: every index is below n_vertices; every vertex is finite; p has one spare vertex behind the
 * last; `ranges` ascends, so that the material of a triangle is found by bisection and costs 12 bytes a mesh instead of
 * 4 bytes a triangle. Arrays grow by doubling, but the first mesh keeps the arrays of its reader. */
#include "bis/shape/geometry.h"

#include "bis/base/mem.h"
#include "quadric.h"

#include <float.h>
#include <string.h>

static bool is_identity(const bis_xform *t)
{
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 4; j++)
            if (t->m[i][j] != (i == j ? 1 : 0)) return false;
    }
    return true;
}

/* Does it exchange left and right? Its determinant tells. */
static bool is_mirrored(const bis_xform *t)
{
    const double(*m)[4] = t->m;
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
               m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]) <
           0;
}

static bool is_empty(const bis_geometry *g) { return g->n_vertices == 0 && g->n_triangles == 0; }

static bis_status no_memory(bis_diag *diag, const char *what, size_t n)
{
    return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for %s: %zu in all", what, n);
}

/* An empty geometry is all zeros, so that `= {0}` makes one; its box is only meaningful from the first primitive on. */
static void start_box(bis_geometry *g)
{
    if (is_empty(g) && g->n_quadrics == 0) {
        g->box.lo = (vec3){FLT_MAX, FLT_MAX, FLT_MAX};
        g->box.hi = (vec3){-FLT_MAX, -FLT_MAX, -FLT_MAX};
    }
}

/* Room for item n of a list that is full whenever n is a power of two: doubling without a word for the capacity. */
static bool room_for_one(void **list, size_t n, size_t size)
{
    if ((n & (n - 1)) != 0) return true;
    void *longer = bis_realloc(*list, n == 0 ? 1 : 2 * n, size);
    if (longer) *list = longer;
    return longer != NULL;
}

static size_t grown(size_t capacity, size_t need)
{
    return need <= capacity ? capacity : need > 2 * capacity ? need : 2 * capacity;
}

static void fill_without_uv(bis_uv *uv, size_t n)
{
    for (size_t i = 0; i < n; i++) uv[i] = (bis_uv){NAN, 0};
}

/* As for normals. */
static bis_status reserve_uv(bis_geometry *g, size_t n_vertices, size_t capacity, bis_diag *diag)
{
    const bool is_new = !g->uv;

    if (!is_new && capacity == g->capacity_vertices) return BIS_OK;
    bis_uv *uv = bis_realloc(g->uv, capacity, sizeof *uv);
    if (!uv) return no_memory(diag, "texture coordinates", n_vertices);
    g->uv = uv;
    if (is_new) fill_without_uv(uv, g->n_vertices);
    return BIS_OK;
}

/* Makes room for so many vertices and triangles in all; with normals and texture coordinates if g has them, or if the
 * new mesh brings them (normals, uv). */
static bis_status reserve(bis_geometry *g, size_t n_vertices, size_t n_triangles, bool normals, bool uv, bis_diag *diag)
{
    size_t nv = grown(g->capacity_vertices, n_vertices), nt = grown(g->capacity_triangles, n_triangles);
    bool new_normals = normals && !g->n;

    if (nv > g->capacity_vertices || !g->p) {
        vec3 *p = bis_realloc(g->p, nv + 1, sizeof *p);
        if (!p) return no_memory(diag, "vertices", n_vertices);
        g->p = p;
    }
    if (new_normals || (g->n && nv > g->capacity_vertices)) {
        vec3 *n = bis_realloc(g->n, nv, sizeof *n);
        if (!n) return no_memory(diag, "vertex normals", n_vertices);
        g->n = n;
        if (new_normals) memset(g->n, 0, g->n_vertices * sizeof *n);
    }
    bis_status status = uv || g->uv ? reserve_uv(g, n_vertices, nv, diag) : BIS_OK;
    if (status) return status;
    g->capacity_vertices = nv;
    if (nt > g->capacity_triangles || !g->index) {
        uint32_t *index = bis_realloc(g->index, nt, 3 * sizeof *index);
        if (!index) return no_memory(diag, "triangles", n_triangles);
        g->index = index;
        g->capacity_triangles = nt;
    }
    return BIS_OK;
}

static bis_status add_range(bis_geometry *g, uint32_t material, bool mirrored, bis_diag *diag)
{
    const bis_range *last = g->n_ranges > 0 ? &g->ranges[g->n_ranges - 1] : NULL;
    if (last && last->material == material && last->mirrored == mirrored) return BIS_OK;
    void *ranges = g->ranges;
    if (!room_for_one(&ranges, g->n_ranges, sizeof *g->ranges))
        return no_memory(diag, "ranges of materials", g->n_ranges + 1);
    g->ranges = ranges;
    g->ranges[g->n_ranges++] = (bis_range){(uint32_t)g->n_triangles, material, mirrored};
    return BIS_OK;
}

static bis_status check_mesh(const bis_geometry *g, const bis_mesh *m, bis_diag *diag)
{
    const bis_loc nowhere = {0};

    if (m->n_vertices > UINT32_MAX - g->n_vertices)
        return bis_error(diag, BIS_INPUT, nowhere, "%zu and %zu vertices: a scene may have at most 2^32 - 1",
                         g->n_vertices, m->n_vertices);
    if (m->n_triangles >= UINT32_MAX - bis_geometry_primitives(g))
        return bis_error(diag, BIS_INPUT, nowhere,
                         "%zu and %zu triangles: a scene may have at most 2^32 - 2 primitives",
                         bis_geometry_primitives(g), m->n_triangles);
    for (size_t i = 0; i < 3 * m->n_triangles; i++) {
        if (m->index[i] >= m->n_vertices)
            return bis_error(diag, BIS_INPUT, nowhere, "triangle %zu has index %u, but the mesh has %zu vertices",
                             i / 3, m->index[i], m->n_vertices);
    }
    return BIS_OK;
}

/* The first mesh's arrays become the scene's: no second copy of the largest mesh is ever made. */
static bis_status move_mesh(bis_geometry *g, bis_mesh *m, bis_diag *diag)
{
    vec3 *p = bis_realloc(m->p, m->n_vertices + 1, sizeof *p);

    if (!p) return no_memory(diag, "vertices", m->n_vertices);
    bis_free(g->p);
    bis_free(g->n);
    bis_free(g->uv);
    bis_free(g->index);
    g->p = p;
    g->n = m->n;
    g->uv = m->uv;
    g->index = m->index;
    g->n_vertices = g->capacity_vertices = m->n_vertices;
    g->n_triangles = g->capacity_triangles = m->n_triangles;
    *m = (bis_mesh){0};
    return BIS_OK;
}

static bis_status copy_mesh(bis_geometry *g, const bis_mesh *m, const bis_xform *t, bis_diag *diag)
{
    const size_t first = g->n_vertices;
    bis_status status = reserve(g, first + m->n_vertices, g->n_triangles + m->n_triangles, m->n != NULL, m->uv != NULL,
                                diag);

    if (status) return status;
    for (size_t i = 0; i < m->n_vertices; i++) g->p[first + i] = bis_xform_point(t, m->p[i]);
    if (g->n) {
        for (size_t i = 0; i < m->n_vertices; i++)
            g->n[first + i] = m->n ? bis_xform_normal(t, m->n[i]) : (vec3){0, 0, 0};
    }
    if (m->uv) memcpy(g->uv + first, m->uv, m->n_vertices * sizeof *g->uv);
    else if (g->uv) fill_without_uv(g->uv + first, m->n_vertices);
    for (size_t i = 0; i < 3 * m->n_triangles; i++) {
        g->index[3 * g->n_triangles + i] = (uint32_t)first + m->index[i]; /* below 2^32 by check_mesh */
    }
    g->n_vertices += m->n_vertices;
    g->n_triangles += m->n_triangles;
    return BIS_OK;
}

/* All vertices of m after t, or those of m itself where t is the identity, must be finite; the box grows by them. */
static bis_status check_finite(bis_geometry *g, const bis_mesh *m, const bis_xform *t, bis_diag *diag)
{
    bis_box box = g->box;

    for (size_t i = 0; i < m->n_vertices; i++) {
        vec3 p = t ? bis_xform_point(t, m->p[i]) : m->p[i];
        bool ok = vec3_is_finite(p) && (!m->n || vec3_is_finite(t ? bis_xform_normal(t, m->n[i]) : m->n[i]));
        if (!ok) {
            return bis_error(diag, BIS_INPUT, (bis_loc){0},
                             "vertex %zu (%g, %g, %g) or its normal does not fit into a float after its transformation",
                             i, (double)m->p[i].x, (double)m->p[i].y, (double)m->p[i].z);
        }
        bis_box_include(&box, p);
    }
    g->box = box;
    return BIS_OK;
}

bis_status bis_geometry_add_mesh(bis_geometry *g, bis_mesh *m, const bis_xform *to_world, uint32_t material,
                                 bis_diag *diag)
{
    const bool identity = is_identity(to_world);
    bis_status status = check_mesh(g, m, diag);

    if (status || m->n_vertices == 0) return status;
    start_box(g);
    const bis_box before = g->box;
    status = check_finite(g, m, identity ? NULL : to_world, diag);
    if (status) return status;
    status = add_range(g, material, is_mirrored(to_world), diag);
    if (!status) status = identity && is_empty(g) ? move_mesh(g, m, diag) : copy_mesh(g, m, to_world, diag);
    if (status) {
        g->box = before; /* a range without triangles does no harm */
        return status;
    }
    g->p[g->n_vertices] = (vec3){0, 0, 0};
    return BIS_OK;
}

bis_status bis_geometry_add_quadric(bis_geometry *g, const bis_quadric *q, bis_diag *diag)
{
    const bis_box box = bis_quadric_bounds(q);

    if (!vec3_is_finite(box.lo) || !vec3_is_finite(box.hi)) {
        return bis_error(diag, BIS_INPUT, (bis_loc){0}, "a %s of radius %g does not fit into floats in world space",
                         q->kind == BIS_SPHERE ? "sphere" : "disk", q->radius);
    }
    if (bis_geometry_primitives(g) >= UINT32_MAX - 1)
        return bis_error(diag, BIS_INPUT, (bis_loc){0}, "a scene may have at most 2^32 - 2 primitives");
    void *quadrics = g->quadrics;
    if (!room_for_one(&quadrics, g->n_quadrics, sizeof *g->quadrics))
        return no_memory(diag, "spheres and disks", g->n_quadrics + 1);
    start_box(g);
    bis_box_include(&g->box, box.lo);
    bis_box_include(&g->box, box.hi);
    g->quadrics = quadrics;
    g->quadrics[g->n_quadrics++] = *q;
    return BIS_OK;
}

void bis_geometry_clear(bis_geometry *g)
{
    bis_free(g->p);
    bis_free(g->n);
    bis_free(g->uv);
    bis_free(g->index);
    bis_free(g->ranges);
    bis_free(g->quadrics);
    *g = (bis_geometry){0};
}

size_t bis_geometry_bytes(const bis_geometry *g)
{
    size_t bytes = 3 * g->capacity_triangles * sizeof *g->index;

    if (g->p) bytes += (g->capacity_vertices + 1) * sizeof *g->p;
    if (g->n) bytes += g->capacity_vertices * sizeof *g->n;
    if (g->uv) bytes += g->capacity_vertices * sizeof *g->uv;
    return bytes + g->n_ranges * sizeof *g->ranges + g->n_quadrics * sizeof *g->quadrics;
}

bis_box bis_geometry_bounds(const bis_geometry *g, uint32_t prim)
{
    if (prim >= g->n_triangles) return bis_quadric_bounds(&g->quadrics[prim - g->n_triangles]);
    const uint32_t *index = g->index + 3 * (size_t)prim;
    bis_box box = {g->p[index[0]], g->p[index[0]]};
    bis_box_include(&box, g->p[index[1]]);
    bis_box_include(&box, g->p[index[2]]);
    return box;
}
