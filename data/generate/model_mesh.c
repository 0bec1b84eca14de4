/* SPDX-License-Identifier: BSD-2-Clause */
/* model_mesh: from a drawing to a closed mesh, and to a PLY file.
 *
 * A turned piece is a profile and the rings it makes, closed by a fan of triangles at each pole; a tube is a grid that
 * is joined at both pairs of sides. Both share every vertex by its index, so that they are closed and consistently
 * wound by construction, and the library's own vertex normals (bis_mesh_smooth_normals) fit them. Cost:
 * O(triangles). */
#include "model.h"

#include "bis/base/file.h"
#include "bis/base/mem.h"

#include <assert.h>
#include <math.h>
#include <string.h>

static void profile_add(model_profile *p, double r, double z)
{
    assert(p->n < MODEL_MAX_OUTLINE);
    p->r[p->n] = r;
    p->z[p->n] = z;
    p->n++;
}

/* The straight piece to (r, z), without its first point. */
static void profile_line(model_profile *p, double r, double z, double step)
{
    double r0 = p->r[p->n - 1], z0 = p->z[p->n - 1];
    double d = hypot(r - r0, z - z0);

    if (d == 0) return;
    int n = (int)ceil(d / step);
    for (int i = 1; i <= n; i++) profile_add(p, r0 + (r - r0) * i / n, z0 + (z - z0) * i / n);
}

/* The corner b between a and c, as a quadratic Bezier curve between the points where it leaves its two sides. */
static void profile_corner(
    model_profile *p, const model_corner *a, const model_corner *b, const model_corner *c, double step)
{
    double ar = a->r - b->r, az = a->z - b->z, cr = c->r - b->r, cz = c->z - b->z;
    double la = hypot(ar, az), lc = hypot(cr, cz), t = b->round * 0.5 * fmin(la, lc);
    double turn = PI - acos(fmax(-1, fmin(1, (ar * cr + az * cz) / (la * lc))));
    double r0 = b->r + ar / la * t, z0 = b->z + az / la * t, r1 = b->r + cr / lc * t, z1 = b->z + cz / lc * t;

    profile_line(p, r0, z0, step);
    if (t == 0) return;
    int n = (int)ceil(fmax(turn / (18 * PI / 180), (hypot(b->r - r0, b->z - z0) + hypot(r1 - b->r, z1 - b->z)) / step));
    for (int i = 1; i <= n; i++) {
        double s = (double)i / n, q = 1 - s;
        profile_add(p, q * q * r0 + 2 * q * s * b->r + s * s * r1, q * q * z0 + 2 * q * s * b->z + s * s * z1);
    }
}

void model_profile_draw(model_profile *p, const model_corner *corners, size_t n, double step)
{
    assert(n >= 3 && corners[0].r == 0 && corners[n - 1].r == 0);
    p->n = 0;
    profile_add(p, corners[0].r, corners[0].z);
    for (size_t i = 1; i + 1 < n; i++) profile_corner(p, &corners[i - 1], &corners[i], &corners[i + 1], step);
    profile_line(p, corners[n - 1].r, corners[n - 1].z, step);
    p->r[p->n - 1] = 0;
}

vec3 model_round(const void *data, double r, double z, double theta)
{
    (void)data;
    return vec3_from(r * cos(theta), r * sin(theta), z);
}

static bis_status mesh_alloc(bis_mesh *m, size_t n_vertices, size_t n_triangles, bis_diag *diag)
{
    *m = (bis_mesh){.n_vertices = n_vertices, .n_triangles = n_triangles};
    m->p = bis_alloc(n_vertices, sizeof *m->p);
    m->index = bis_alloc(n_triangles, 3 * sizeof *m->index);
    if (m->p && m->index) return BIS_OK;
    bis_mesh_clear(m);
    return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for a mesh of %zu triangles", n_triangles);
}

static uint32_t *put(uint32_t *index, size_t a, size_t b, size_t c)
{
    *index++ = (uint32_t)a;
    *index++ = (uint32_t)b;
    *index++ = (uint32_t)c;
    return index;
}

bis_status model_turn(
    bis_mesh *m, const model_profile *p, size_t n_around, model_bend bend, const void *data, bis_diag *diag)
{
    size_t n_rings = p->n - 2, top = 1 + n_rings * n_around;
    bis_status status = mesh_alloc(m, top + 1, 2 * n_rings * n_around, diag);

    if (status) return status;
    m->p[0] = bend(data, 0, p->z[0], 0);
    m->p[top] = bend(data, 0, p->z[p->n - 1], 0);
    for (size_t i = 0; i < n_rings; i++) {
        for (size_t j = 0; j < n_around; j++) {
            m->p[1 + i * n_around + j] = bend(data, p->r[i + 1], p->z[i + 1], 2 * PI * (double)j / (double)n_around);
        }
    }
    uint32_t *index = m->index;
    for (size_t j = 0; j < n_around; j++) {
        size_t k = (j + 1) % n_around;
        index = put(index, 0, 1 + k, 1 + j);
        for (size_t i = 0; i + 1 < n_rings; i++) {
            size_t a = 1 + i * n_around, b = a + n_around;
            index = put(index, a + j, a + k, b + k);
            index = put(index, a + j, b + k, b + j);
        }
        size_t last = 1 + (n_rings - 1) * n_around;
        index = put(index, last + j, last + k, top);
    }
    return BIS_OK;
}

bis_status model_tube_mesh(bis_mesh *m, size_t n_u, size_t n_v, model_tube position, const void *data, bis_diag *diag)
{
    bis_status status = mesh_alloc(m, n_u * n_v, 2 * n_u * n_v, diag);

    if (status) return status;
#pragma omp parallel for schedule(static)
    for (size_t i = 0; i < n_u; i++) {
        for (size_t j = 0; j < n_v; j++) {
            size_t a = i * n_v, b = (i + 1) % n_u * n_v, k = (j + 1) % n_v;
            uint32_t *index = m->index + 6 * (a + j);

            m->p[a + j] = position(data, (double)i / (double)n_u, (double)j / (double)n_v);
            index = put(index, a + j, b + j, b + k);
            put(index, a + j, b + k, a + k);
        }
    }
    return BIS_OK;
}

bis_status model_append(bis_mesh *m, const bis_mesh *part, vec3 by, bis_diag *diag)
{
    size_t n_vertices = m->n_vertices + part->n_vertices, n_triangles = m->n_triangles + part->n_triangles;
    vec3 *p = bis_realloc(m->p, n_vertices, sizeof *p);

    if (!p) return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for %zu vertices", n_vertices);
    m->p = p;
    uint32_t *index = bis_realloc(m->index, n_triangles, 3 * sizeof *index);
    if (!index) return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for %zu triangles", n_triangles);
    m->index = index;
    for (size_t i = 0; i < part->n_vertices; i++) p[m->n_vertices + i] = add(part->p[i], by);
    for (size_t i = 0; i < 3 * part->n_triangles; i++) {
        index[3 * m->n_triangles + i] = part->index[i] + (uint32_t)m->n_vertices;
    }
    m->n_vertices = n_vertices;
    m->n_triangles = n_triangles;
    return BIS_OK;
}

static void put_little_endian(unsigned char *to, uint32_t v)
{
    for (int i = 0; i < 4; i++) to[i] = (unsigned char)(v >> (8 * i));
}

static void put_floats(unsigned char *to, vec3 v)
{
    const float f[3] = {v.x, v.y, v.z};

    for (int i = 0; i < 3; i++) {
        uint32_t bits;
        memcpy(&bits, &f[i], sizeof bits);
        put_little_endian(to + 4 * i, bits);
    }
}

/* Write errors stay with the stream until bis_outfile_commit asks for them. */
static void write_ply(FILE *f, const bis_mesh *m)
{
    fprintf(f, "ply\nformat binary_little_endian 1.0\nelement vertex %zu\n", m->n_vertices);
    fprintf(f, "property float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\nproperty "
               "float nz\n");
    fprintf(f, "element face %zu\nproperty list uchar int vertex_indices\nend_header\n", m->n_triangles);
    for (size_t i = 0; i < m->n_vertices; i++) {
        unsigned char row[24];
        put_floats(row, m->p[i]);
        put_floats(row + 12, m->n[i]);
        fwrite(row, 1, sizeof row, f);
    }
    for (size_t i = 0; i < m->n_triangles; i++) {
        unsigned char row[13] = {3};
        for (size_t j = 0; j < 3; j++) put_little_endian(row + 1 + 4 * j, m->index[3 * i + j]);
        fwrite(row, 1, sizeof row, f);
    }
}

bis_status model_write(bis_mesh *m, const char *path, bis_diag *diag)
{
    bis_outfile *out;
    bis_status status = bis_mesh_smooth_normals(m, diag);

    if (status) return status;
    status = bis_outfile_open(&out, path, diag);
    if (status) return status;
    write_ply(bis_outfile_stream(out), m);
    return bis_outfile_commit(out, diag);
}
