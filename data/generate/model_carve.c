/* SPDX-License-Identifier: BSD-2-Clause */
/* model_carve: a block cut along an outline, its edges rounded, with grooves: the knight's head, the king's cross.
 *
 * The block is the set F < 0 of
 *     F(x, y, z) = hypot(1 - depth/edge, y / half_thickness) - 1 + groove,
 * depth being how far (x, z) lies inside the outline (at most `edge`; negative outside): at the outline the section is
 * a point, `edge` further in it has its full thickness, in between it is a quarter of an ellipse.
 *
 * The surface is found by surface nets (Gibson 1998): one vertex in each cell of a lattice that F changes sign in, at
 * the mean of the crossings on its 12 edges; one quadrilateral around each lattice edge that F changes sign on. Every
 * vertex is shared, so the surface is closed. Four quadrilaterals would share an edge where the corners of a lattice
 * face are in, out, in, out: there one corner is filled first. Each vertex is then moved onto F = 0 along the gradient,
 * which takes the lattice's steps out of the shading.
 *
 * Cost: O(outline x columns) for the depths, O(cells) for the rest. */
#include "model.h"

#include "bis/base/mem.h"

#include <assert.h>
#include <float.h>
#include <math.h>

/* A lattice of nx * ny * nz points, y fastest; values of F, and the vertex of the cell whose low corner is the
 * point. */
typedef struct lattice {
    const model_block *block;
    int nx, ny, nz;
    double x0, y0, z0, cell;
    double *depth;    /* depth[nz][nx] */
    float *f;         /* f[nz][nx][ny] */
    uint32_t *vertex; /* vertex[nz][nx][ny], NO_VERTEX where F keeps its sign */
} lattice;

#define NO_VERTEX UINT32_MAX

/* Signed distance to the outline, positive inside. */
static double outline_depth(const model_block *b, double x, double z)
{
    double best = (double)INFINITY;
    int inside = 0;

    for (size_t i = 0, j = b->n - 1; i < b->n; j = i++) {
        double ex = b->x[i] - b->x[j], ez = b->z[i] - b->z[j], px = x - b->x[j], pz = z - b->z[j];
        double t = fmin(1, fmax(0, (px * ex + pz * ez) / (ex * ex + ez * ez)));
        double dx = px - t * ex, dz = pz - t * ez;

        best = fmin(best, dx * dx + dz * dz);
        if ((b->z[i] > z) != (b->z[j] > z) && px < ex * pz / ez) inside = !inside;
    }
    return inside ? sqrt(best) : -sqrt(best);
}

static double implicit(const model_block *b, double x, double y, double z, double depth)
{
    double rim = 1 - fmin(1, depth / b->edge);
    double f = hypot(rim, y / b->half_thickness(x, z)) - 1;

    return b->groove ? f + b->groove(x, y, z, depth) : f;
}

static size_t at(const lattice *l, int i, int j, int k)
{
    return ((size_t)k * (size_t)l->nx + (size_t)i) * (size_t)l->ny + (size_t)j;
}

static void lattice_clear(lattice *l)
{
    bis_free(l->depth);
    bis_free(l->f);
    bis_free(l->vertex);
}

/* The box of the outline and the greatest thickness (tried on the lattice's own columns), two cells wider on each
 * side. */
static bis_status lattice_init(lattice *l, const model_block *b, bis_diag *diag)
{
    double x1 = b->x[0], z1 = b->z[0], thick = 0;

    *l = (lattice){.block = b, .cell = b->cell, .x0 = b->x[0], .z0 = b->z[0]};
    for (size_t i = 0; i < b->n; i++) {
        l->x0 = fmin(l->x0, b->x[i]);
        l->z0 = fmin(l->z0, b->z[i]);
        x1 = fmax(x1, b->x[i]);
        z1 = fmax(z1, b->z[i]);
    }
    l->nx = (int)ceil((x1 - l->x0) / b->cell) + 5;
    l->nz = (int)ceil((z1 - l->z0) / b->cell) + 5;
    l->x0 -= 2 * b->cell;
    l->z0 -= 2 * b->cell;
    for (int k = 0; k < l->nz; k++) {
        for (int i = 0; i < l->nx; i++)
            thick = fmax(thick, b->half_thickness(l->x0 + i * b->cell, l->z0 + k * b->cell));
    }
    /* An even number of points, so that the plane of symmetry y = 0 lies between two of them. */
    l->ny = 2 * ((int)ceil(1.35 * thick / b->cell) + 2);
    l->y0 = -(l->ny - 1) * 0.5 * b->cell;
    size_t n_columns = (size_t)l->nx * (size_t)l->nz, n = n_columns * (size_t)l->ny;
    l->depth = bis_alloc(n_columns, sizeof *l->depth);
    l->f = bis_alloc(n, sizeof *l->f);
    l->vertex = bis_alloc(n, sizeof *l->vertex);
    if (l->depth && l->f && l->vertex) return BIS_OK;
    lattice_clear(l);
    return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for a lattice of %zu points", n);
}

static void lattice_fill(lattice *l)
{
#pragma omp parallel for schedule(dynamic)
    for (int k = 0; k < l->nz; k++) {
        for (int i = 0; i < l->nx; i++) {
            double x = l->x0 + i * l->cell, z = l->z0 + k * l->cell, depth = outline_depth(l->block, x, z);

            l->depth[(size_t)k * (size_t)l->nx + (size_t)i] = depth;
            for (int j = 0; j < l->ny; j++) {
                l->f[at(l, i, j, k)] = (float)implicit(l->block, x, l->y0 + j * l->cell, z, depth);
                l->vertex[at(l, i, j, k)] = NO_VERTEX;
            }
        }
    }
}

/* Fill a corner of each lattice face whose corners are in, out, in, out, until none is left: the one of the two outer
 * ones that F says is nearer to the surface. Points are only ever filled, so this ends. */
static bool fill_one(lattice *l, const int p[3], int axis)
{
    size_t c[4];

    for (int i = 0; i < 4; i++) {
        static const int around[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
        int q[3] = {p[0], p[1], p[2]};
        q[(axis + 1) % 3] += around[i][0];
        q[(axis + 2) % 3] += around[i][1];
        c[i] = at(l, q[0], q[1], q[2]);
    }
    bool in0 = l->f[c[0]] < 0, in1 = l->f[c[1]] < 0;
    if (in0 == in1 || in0 != (l->f[c[2]] < 0) || in1 != (l->f[c[3]] < 0)) return false;
    float *a = &l->f[c[in0 ? 1 : 0]], *b = &l->f[c[in0 ? 3 : 2]], *nearer = *a <= *b ? a : b;
    *nearer = *nearer > 0 ? -*nearer : -FLT_MIN;
    return true;
}

static void fill_corners(lattice *l)
{
    bool again = true;

    while (again) {
        again = false;
        for (int k = 0; k + 1 < l->nz; k++) {
            for (int i = 0; i + 1 < l->nx; i++) {
                for (int j = 0; j + 1 < l->ny; j++) {
                    for (int axis = 0; axis < 3; axis++) again |= fill_one(l, (int[3]){i, j, k}, axis);
                }
            }
        }
    }
}

/* The mean of the crossings on the 12 edges of cell (i, j, k), in lattice coordinates. False: F keeps its sign. */
static bool cell_vertex(const lattice *l, int i, int j, int k, double p[3])
{
    double sum[3] = {0, 0, 0};
    int n = 0;

    for (int axis = 0; axis < 3; axis++) {
        for (int e = 0; e < 4; e++) {
            int a[3], b[3];
            a[axis] = 0;
            a[(axis + 1) % 3] = e & 1;
            a[(axis + 2) % 3] = e >> 1;
            for (int c = 0; c < 3; c++) b[c] = a[c] + (c == axis);
            double fa = (double)l->f[at(l, i + a[0], j + a[1], k + a[2])],
                   fb = (double)l->f[at(l, i + b[0], j + b[1], k + b[2])];
            if ((fa < 0) == (fb < 0)) continue;
            for (int c = 0; c < 3; c++) sum[c] += a[c] + (b[c] - a[c]) * fa / (fa - fb);
            n++;
        }
    }
    if (n == 0) return false;
    p[0] = i + sum[0] / n;
    p[1] = j + sum[1] / n;
    p[2] = k + sum[2] / n;
    return true;
}

/* Newton's steps along the gradient, each at most a quarter of a cell and all together within the vertex's own cell: a
 * vertex that left its cell could fold its triangles. */
static vec3 settle(const lattice *l, double x, double y, double z)
{
    const model_block *b = l->block;
    const double h = 0.05 * l->cell, x_in = x, y_in = y, z_in = z, reach = 0.35 * l->cell;

    for (int step = 0; step < 4; step++) {
        double f = implicit(b, x, y, z, outline_depth(b, x, z));
        double gx = (implicit(b, x + h, y, z, outline_depth(b, x + h, z)) - f) / h;
        double gy = (implicit(b, x, y + h, z, outline_depth(b, x, z)) - f) / h;
        double gz = (implicit(b, x, y, z + h, outline_depth(b, x, z + h)) - f) / h;
        double g2 = gx * gx + gy * gy + gz * gz;

        if (f == 0 || g2 == 0) break;
        double s = f / g2 * fmin(1, 0.25 * l->cell * sqrt(g2) / fabs(f));
        x = fmin(x_in + reach, fmax(x_in - reach, x - s * gx));
        y = fmin(y_in + reach, fmax(y_in - reach, y - s * gy));
        z = fmin(z_in + reach, fmax(z_in - reach, z - s * gz));
    }
    return vec3_from(x, y, z);
}

static size_t count_vertices(lattice *l)
{
    size_t n = 0;
    double p[3];

    for (int k = 0; k + 1 < l->nz; k++) {
        for (int i = 0; i + 1 < l->nx; i++) {
            for (int j = 0; j + 1 < l->ny; j++) {
                if (cell_vertex(l, i, j, k, p)) l->vertex[at(l, i, j, k)] = (uint32_t)n++;
            }
        }
    }
    return n;
}

static void place_vertices(const lattice *l, bis_mesh *m)
{
#pragma omp parallel for schedule(dynamic)
    for (int k = 0; k < l->nz - 1; k++) {
        double p[3];
        for (int i = 0; i + 1 < l->nx; i++) {
            for (int j = 0; j + 1 < l->ny; j++) {
                uint32_t v = l->vertex[at(l, i, j, k)];
                if (v == NO_VERTEX) continue;
                cell_vertex(l, i, j, k, p);
                m->p[v] = settle(l, l->x0 + p[0] * l->cell, l->y0 + p[1] * l->cell, l->z0 + p[2] * l->cell);
            }
        }
    }
}

/* The quadrilateral around the lattice edge from at0 along axis, if F changes sign on it, cut along its shorter
 * diagonal; facing F > 0. The lattice is wide enough for the four cells to exist. index may be NULL: only count.
 * Returns the triangles made. */
static size_t edge_quad(const lattice *l, const vec3 *p, const int at0[3], int axis, uint32_t *index)
{
    int to[3] = {at0[0], at0[1], at0[2]};
    uint32_t v[4];

    to[axis]++;
    bool in0 = l->f[at(l, at0[0], at0[1], at0[2])] < 0, in1 = l->f[at(l, to[0], to[1], to[2])] < 0;
    if (in0 == in1) return 0;
    if (!index) return 2;
    for (int c = 0; c < 4; c++) {
        static const int around[4][2] = {{-1, -1}, {0, -1}, {0, 0}, {-1, 0}};
        int cell[3] = {at0[0], at0[1], at0[2]};
        cell[(axis + 1) % 3] += around[c][0];
        cell[(axis + 2) % 3] += around[c][1];
        v[c] = l->vertex[at(l, cell[0], cell[1], cell[2])];
        assert(v[c] != NO_VERTEX);
    }
    int turn = length(sub(p[v[0]], p[v[2]])) <= length(sub(p[v[1]], p[v[3]])) ? 0 : 1;
    const int order[2][6] = {{0, 2, 1, 0, 3, 2}, {0, 1, 2, 0, 2, 3}};
    for (int c = 0; c < 6; c++) index[c] = v[(order[in0][c] + turn) % 4];
    return 2;
}

static size_t make_quads(const lattice *l, const vec3 *p, uint32_t *index)
{
    size_t n = 0;

    for (int k = 1; k + 1 < l->nz; k++) {
        for (int i = 1; i + 1 < l->nx; i++) {
            for (int j = 1; j + 1 < l->ny; j++) {
                for (int axis = 0; axis < 3; axis++)
                    n += edge_quad(l, p, (int[3]){i, j, k}, axis, index ? index + 3 * n : NULL);
            }
        }
    }
    return n;
}

bis_status model_carve(bis_mesh *m, const model_block *block, bis_diag *diag)
{
    lattice l;
    bis_status status = lattice_init(&l, block, diag);

    *m = (bis_mesh){0};
    if (status) return status;
    lattice_fill(&l);
    fill_corners(&l);
    m->n_vertices = count_vertices(&l);
    m->n_triangles = make_quads(&l, NULL, NULL);
    m->p = bis_alloc(m->n_vertices, sizeof *m->p);
    m->index = bis_alloc(m->n_triangles, 3 * sizeof *m->index);
    if (m->p && m->index) {
        place_vertices(&l, m);
        make_quads(&l, m->p, m->index);
    } else {
        bis_mesh_clear(m);
        status = bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for a carved mesh");
    }
    lattice_clear(&l);
    return status;
}
