/* SPDX-License-Identifier: BSD-2-Clause */
/* make_grid: (ns + 1)(nt + 1) points of a surface and 2 ns nt triangles between them. */
#include "make_grid.h"

#include "bis/base/mem.h"

bis_status bis_grid_room(bis_mesh *m, size_t n_vertices, size_t n_triangles, bis_loc at, bis_diag *diag)
{
    *m = (bis_mesh){.p = bis_alloc(n_vertices, sizeof *m->p), .n = bis_alloc(n_vertices, sizeof *m->n),
                    .uv = bis_alloc(n_vertices, sizeof *m->uv), .index = bis_alloc(n_triangles, 3 * sizeof *m->index)};
    if (m->p && m->n && m->uv && m->index) return BIS_OK;
    bis_mesh_clear(m);
    return bis_error(diag, BIS_NOMEM, at, "no memory for a mesh of %zu triangles", n_triangles);
}

static vec3 unit_or_zero(const double n[3])
{
    const double size = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    return size > 0 && isfinite(size) ? vec3_from(n[0] / size, n[1] / size, n[2] / size) : (vec3){0, 0, 0};
}

static double size_of(const double a[3]) { return hypot(hypot(a[0], a[1]), a[2]); }

/* A tangent a is off by less than 2 noise, as sqrt 3 < 2, and so a x b by less than 2 (noise_a |b| + noise_b |a|). */
void bis_grid_normal(double out[3], const double along[3], const double across[3], const double noise[2])
{
    cross3(out, along, across);
    if (size_of(out) <= 2 * (noise[0] * size_of(across) + noise[1] * size_of(along))) out[0] = out[1] = out[2] = 0;
}

void bis_grid_add(bis_mesh *m, size_t ns, size_t nt, bis_grid_at *at, const void *surface)
{
    const size_t first = m->n_vertices;

    for (size_t j = 0; j <= nt; j++)
        for (size_t i = 0; i <= ns; i++) {
            bis_grid_point q;
            at(&q, surface, (double)i / (double)ns, (double)j / (double)nt);
            m->p[m->n_vertices] = vec3_from(q.p[0], q.p[1], q.p[2]);
            m->n[m->n_vertices] = unit_or_zero(q.n);
            m->uv[m->n_vertices++] = q.uv;
        }
    for (size_t j = 0; j < nt; j++)
        for (size_t i = 0; i < ns; i++) {
            const size_t k = first + j * (ns + 1) + i;
            const size_t corner[6] = {k, k + 1, k + ns + 2, k, k + ns + 2, k + ns + 1};
            for (int c = 0; c < 6; c++) m->index[3 * m->n_triangles + (size_t)c] = (uint32_t)corner[c];
            m->n_triangles += 2;
        }
}
