/* SPDX-License-Identifier: BSD-2-Clause */
/* mesh: what a reader hands over, and vertex normals for those who ask for smooth shading.
 *
 * A vertex normal is the sum of its faces' unit normals, each weighted by the face's angle there (Thürmer and
 * Wüthrich 1998, "Computing vertex normals from polygonal facets"): the sum does not depend on how a flat face is cut
 * into triangles. O(n), sums in double, in the order of the triangles. */
#include "bis/shape/geometry.h"

#include "bis/base/mem.h"
#include "triangle.h"

void bis_mesh_clear(bis_mesh *m)
{
    bis_free(m->p);
    bis_free(m->n);
    bis_free(m->uv);
    bis_free(m->index);
    bis_free(m->part);
    *m = (bis_mesh){0};
}

/* ---- parts ---- */

bis_status bis_mesh_sort_parts(bis_mesh_parts *parts, bis_mesh *m, size_t n, bis_diag *diag)
{
    uint32_t *sorted = bis_alloc(m->n_triangles, 3 * sizeof *sorted);

    *parts = (bis_mesh_parts){.n = n, .first = bis_alloc(n + 1, sizeof *parts->first),
                              .number = bis_alloc(m->n_vertices, sizeof *parts->number)};
    if (!sorted || !parts->first || !parts->number) {
        bis_free(sorted);
        bis_mesh_parts_clear(parts);
        return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory to sort %zu triangles", m->n_triangles);
    }
    for (size_t i = 0; i < m->n_vertices; i++) parts->number[i] = UINT32_MAX;
    for (size_t i = 0; i < m->n_triangles; i++) parts->first[m->part[i] + 1]++;
    for (size_t k = 0; k < n; k++) parts->first[k + 1] += parts->first[k];
    /* first[k] runs through part k to its end, the beginning of the next */
    for (size_t i = 0; i < m->n_triangles; i++) {
        uint32_t *to = sorted + 3 * parts->first[m->part[i]]++;
        for (size_t c = 0; c < 3; c++) to[c] = m->index[3 * i + c];
    }
    for (size_t k = n; k > 0; k--) parts->first[k] = parts->first[k - 1];
    parts->first[0] = 0;
    bis_free(m->index);
    bis_free(m->part);
    m->index = sorted;
    m->part = NULL;
    return BIS_OK;
}

void bis_mesh_parts_clear(bis_mesh_parts *parts)
{
    bis_free(parts->first);
    bis_free(parts->number);
    *parts = (bis_mesh_parts){0};
}

static void copy_vertices(bis_mesh *out, const bis_mesh *m, const uint32_t *index, const uint32_t *number)
{
    for (size_t i = 0; i < 3 * out->n_triangles; i++) {
        const uint32_t from = index[i], to = number[from];
        out->index[i] = to;
        out->p[to] = m->p[from];
        if (out->n) out->n[to] = m->n[from];
        if (out->uv) out->uv[to] = m->uv[from];
    }
}

bis_status bis_mesh_take_part(bis_mesh *out, const bis_mesh *m, bis_mesh_parts *parts, size_t k, bis_diag *diag)
{
    const uint32_t *index = m->index + 3 * parts->first[k];
    uint32_t *number = parts->number;
    bis_status status = BIS_OK;

    *out = (bis_mesh){.n_triangles = parts->first[k + 1] - parts->first[k]};
    for (size_t i = 0; i < 3 * out->n_triangles; i++)
        if (number[index[i]] == UINT32_MAX) number[index[i]] = (uint32_t)out->n_vertices++;
    out->p = bis_alloc(out->n_vertices, sizeof *out->p);
    out->index = bis_alloc(out->n_triangles, 3 * sizeof *out->index);
    if (m->n) out->n = bis_alloc(out->n_vertices, sizeof *out->n);
    if (m->uv) out->uv = bis_alloc(out->n_vertices, sizeof *out->uv);
    const bool ok = out->p && out->index && !out->n == !m->n && !out->uv == !m->uv;
    if (ok) copy_vertices(out, m, index, number);
    for (size_t i = 0; i < 3 * out->n_triangles; i++) number[index[i]] = UINT32_MAX;
    if (!ok) {
        status = bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for a part of %zu triangles", out->n_triangles);
        bis_mesh_clear(out);
    }
    return status;
}

/* ---- normals ---- */

/* The angle at a between b and c. atan2 of sine and cosine: acos would lose half the digits of small angles. */
static double corner_angle(vec3 a, vec3 b, vec3 c)
{
    const vec3 v[3] = {a, b, c};
    double n[3], e[3] = {(double)b.x - (double)a.x, (double)b.y - (double)a.y, (double)b.z - (double)a.z};
    double f[3] = {(double)c.x - (double)a.x, (double)c.y - (double)a.y, (double)c.z - (double)a.z};

    area_vector(v, n);
    return atan2(sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]), e[0] * f[0] + e[1] * f[1] + e[2] * f[2]);
}

static void add_face(double (*sum)[3], const vec3 *p, const uint32_t index[3])
{
    const vec3 v[3] = {p[index[0]], p[index[1]], p[index[2]]};
    double n[3];

    area_vector(v, n);
    double size = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (!(size > 0)) return;
    for (int i = 0; i < 3; i++) {
        double weight = corner_angle(v[i], v[(i + 1) % 3], v[(i + 2) % 3]) / size;
        for (int j = 0; j < 3; j++) sum[index[i]][j] += weight * n[j];
    }
}

bis_status bis_mesh_smooth_normals(bis_mesh *m, bis_diag *diag)
{
    double (*sum)[3] = bis_alloc(m->n_vertices, sizeof *sum);
    vec3 *n = bis_alloc(m->n_vertices, sizeof *n);
    bis_status status = BIS_OK;

    if (!sum || !n) {
        status = bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for the normals of %zu vertices", m->n_vertices);
        goto done;
    }
    for (size_t i = 0; i < m->n_triangles; i++) add_face(sum, m->p, m->index + 3 * i);
    for (size_t i = 0; i < m->n_vertices; i++) {
        double size = sqrt(sum[i][0] * sum[i][0] + sum[i][1] * sum[i][1] + sum[i][2] * sum[i][2]);
        if (size > 0) n[i] = vec3_from(sum[i][0] / size, sum[i][1] / size, sum[i][2] / size);
    }
    bis_free(m->n);
    m->n = n;
    n = NULL;
done:
    bis_free(n);
    bis_free(sum);
    return status;
}
