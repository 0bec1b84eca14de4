/* SPDX-License-Identifier: BSD-2-Clause */
/* make_patches: bilinear patches, height fields and NURBS surfaces as grids of triangles.
 *
 * A bilinear patch p(u, v) differs from two triangles by at most |twist|/4, twist = p00 - p10 - p01 + p11, in the
 * middle of their diagonal; n x n pieces differ by 1/n^2 of that. A parallelogram has no twist. */
#include "make_grid.h"

#include "bis/base/mem.h"

#include <assert.h>

/* ---- bilinear patches ---- */

typedef struct patch {
    const bis_mesh *m;
    const uint32_t *corner;
} patch;

static void coordinates(double out[3], vec3 p)
{
    out[0] = (double)p.x;
    out[1] = (double)p.y;
    out[2] = (double)p.z;
}

/* a, b, c, d at (0,0), (1,0), (0,1), (1,1) */
static double bilinear(double a, double b, double c, double d, double s, double t)
{
    return (1 - t) * ((1 - s) * a + s * b) + t * ((1 - s) * c + s * d);
}

static void bilinear_vector(double out[3], const vec3 *list, const uint32_t corner[4], double s, double t)
{
    double v[4][3];
    for (int k = 0; k < 4; k++) coordinates(v[k], list[corner[k]]);
    for (int c = 0; c < 3; c++) out[c] = bilinear(v[0][c], v[1][c], v[2][c], v[3][c], s, t);
}

/* The largest of the corners' coordinates. */
static double largest(const vec3 *list, const uint32_t corner[4])
{
    double v[3], most = 0;
    for (int k = 0; k < 4; k++) {
        coordinates(v, list[corner[k]]);
        for (int c = 0; c < 3; c++) most = fmax(most, fabs(v[c]));
    }
    return most;
}

static void patch_at(bis_grid_point *out, const void *surface, double s, double t)
{
    const patch *x = surface;
    const bis_mesh *m = x->m;
    const uint32_t *k = x->corner;
    double a[3], b[3], along[3], across[3];

    bilinear_vector(out->p, m->p, k, s, t);
    out->uv = (bis_uv){(float)s, (float)t};
    if (m->uv) {
        const bis_uv *w = m->uv;
        out->uv.u = (float)bilinear((double)w[k[0]].u, (double)w[k[1]].u, (double)w[k[2]].u, (double)w[k[3]].u, s, t);
        out->uv.v = (float)bilinear((double)w[k[0]].v, (double)w[k[1]].v, (double)w[k[2]].v, (double)w[k[3]].v, s, t);
    }
    if (m->n) {
        bilinear_vector(out->n, m->n, k, s, t);
        return;
    }
    bilinear_vector(a, m->p, k, 0, t);
    bilinear_vector(b, m->p, k, 1, t);
    for (int c = 0; c < 3; c++) along[c] = b[c] - a[c];
    bilinear_vector(a, m->p, k, s, 0);
    bilinear_vector(b, m->p, k, s, 1);
    for (int c = 0; c < 3; c++) across[c] = b[c] - a[c];
    /* a coordinate may be off by half of its last bit, and a tangent by twice that */
    const double noise = 0x1p-23 * largest(m->p, k);
    bis_grid_normal(out->n, along, across, (double[2]){noise, noise});
}

/* The length of a box's diagonal. */
static double diagonal(const bis_mesh *m, const uint32_t (*corner)[4], size_t n)
{
    bis_box box = {m->p[corner[0][0]], m->p[corner[0][0]]};
    for (size_t i = 0; i < n; i++)
        for (int k = 0; k < 4; k++) bis_box_include(&box, m->p[corner[i][k]]);
    return hypot(hypot((double)box.hi.x - (double)box.lo.x, (double)box.hi.y - (double)box.lo.y),
                 (double)box.hi.z - (double)box.lo.z);
}

/* At most 71, because a twist is at most two diagonals. */
static size_t pieces(const bis_mesh *m, const uint32_t corner[4], double size)
{
    double v[4][3], twist[3];
    for (int k = 0; k < 4; k++) coordinates(v[k], m->p[corner[k]]);
    for (int c = 0; c < 3; c++) twist[c] = v[0][c] - v[1][c] - v[2][c] + v[3][c];
    if (!(size > 0)) return 1; /* all is one point */
    const double share = hypot(hypot(twist[0], twist[1]), twist[2]) / size;
    return share > 0 && isfinite(share) ? (size_t)ceil(sqrt(share / (4 * BIS_MAKE_PATCH_ERROR))) : 1;
}

bis_status bis_make_patches(bis_mesh *m, const uint32_t (*corner)[4], size_t n, bis_loc at, bis_diag *diag)
{
    const double size = n ? diagonal(m, corner, n) : 0;
    size_t n_vertices = 0, n_pieces = 0;
    bis_mesh out;

    for (size_t i = 0; i < n; i++) {
        const size_t k = pieces(m, corner[i], size);
        n_vertices += (k + 1) * (k + 1);
        n_pieces += k * k;
    }
    bis_status status = n_pieces <= (size_t)1 << 29
                            ? bis_grid_room(&out, n_vertices, 2 * n_pieces, at, diag)
                            : bis_error(diag, BIS_INPUT, at, "the patches make more than 2^30 triangles: "
                                        "give fewer of them to a shape");
    if (!status)
        for (size_t i = 0; i < n; i++) {
            const size_t k = pieces(m, corner[i], size);
            bis_grid_add(&out, k, k, patch_at, &(patch){m, corner[i]});
        }
    bis_mesh_clear(m);
    if (!status) *m = out;
    return status;
}

/* ---- height fields ---- */

typedef struct heights {
    const double *z;
    size_t nu, nv;
} heights;

static void height_at(bis_grid_point *out, const void *surface, double s, double t)
{
    const heights *h = surface;
    const size_t i = (size_t)(s * (double)(h->nu - 1) + 0.5), j = (size_t)(t * (double)(h->nv - 1) + 0.5);
    *out = (bis_grid_point){.p = {s, t, h->z[j * h->nu + i]}, .uv = {(float)s, (float)t}};
}

bis_status bis_make_height_field(bis_mesh *m, const double *z, size_t nu, size_t nv, bis_loc at, bis_diag *diag)
{
    const heights h = {z, nu, nv};
    const bis_status status = bis_grid_room(m, nu * nv, 2 * (nu - 1) * (nv - 1), at, diag);

    if (status) return status;
    bis_grid_add(m, nu - 1, nv - 1, height_at, &h);
    bis_free(m->n); /* its triangles are flat */
    m->n = NULL;
    return BIS_OK;
}

/* ---- NURBS ---- */

/* The B-splines of parameter `of` that are not 0 at x, b[order], and their derivatives d[order]; first: the number of
 * b[0]. de Boor's recursion, from order 1 up; a part with a knot interval of length 0 is 0. */
static void b_splines(double *b, double *d, size_t *first, const bis_nurbs *surface, int of, double x)
{
    const double *knot = surface->knots[of];
    const size_t n = surface->n[of], order = surface->order[of];
    size_t k = order - 1;

    while (k + 1 < n && x >= knot[k + 1]) k++; /* x lies in [knot[k], knot[k + 1]) */
    while (k > order - 1 && knot[k] == knot[k + 1]) k--; /* x is the last knot of several */
    *first = k + 1 - order;
    for (size_t i = 0; i < order; i++) b[i] = d[i] = 0;
    b[order - 1] = 1;
    for (size_t p = 1; p < order; p++) /* degree p of the splines k - p to k */
        for (size_t i = order - 1 - p; i < order; i++) {
            const double *t = knot + *first + i;
            const double left = t[p] - t[0], right = t[p + 1] - t[1], next = i + 1 < order ? b[i + 1] : 0;
            const double up = left > 0 ? b[i] / left : 0, down = right > 0 ? next / right : 0;
            d[i] = (double)p * (up - down); /* of the last degree this stays */
            b[i] = (x - t[0]) * up + (t[p + 1] - x) * down;
        }
}

/* A sum of 16 x 16 products loses 256 halves of a last bit at most, and its point as much again. */
#define NURBS_NOISE 0x1p-44

static void nurbs_at(bis_grid_point *out, const void *surface, double s, double t)
{
    const bis_nurbs *x = surface;
    const double w[2] = {(1 - s) * x->end[0][0] + s * x->end[0][1], (1 - t) * x->end[1][0] + t * x->end[1][1]};
    double b[2][BIS_MAKE_MAX_ORDER], d[2][BIS_MAKE_MAX_ORDER], h[3][4] = {{0}}, tangent[2][3];
    double size[2][4] = {{0}}, noise[2] = {0}; /* size: the sums of the tangents' parts without their signs */
    size_t first[2];

    assert(x->order[0] <= BIS_MAKE_MAX_ORDER && x->order[1] <= BIS_MAKE_MAX_ORDER);
    for (int k = 0; k < 2; k++) b_splines(b[k], d[k], &first[k], x, k, w[k]);
    for (size_t j = 0; j < x->order[1]; j++)
        for (size_t i = 0; i < x->order[0]; i++)
            for (int c = 0; c < 4; c++) {
                const double p = x->point[(first[1] + j) * x->n[0] + first[0] + i][c];
                h[0][c] += b[0][i] * b[1][j] * p;
                h[1][c] += d[0][i] * b[1][j] * p;
                h[2][c] += b[0][i] * d[1][j] * p;
                size[0][c] += fabs(d[0][i] * b[1][j] * p);
                size[1][c] += fabs(b[0][i] * d[1][j] * p);
            }
    for (int c = 0; c < 3; c++) {
        out->p[c] = h[0][c] / h[0][3];
        for (int k = 0; k < 2; k++) {
            tangent[k][c] = (h[k + 1][c] - out->p[c] * h[k + 1][3]) / h[0][3];
            noise[k] = fmax(noise[k], NURBS_NOISE * (size[k][c] + fabs(out->p[c]) * size[k][3]) / h[0][3]);
        }
    }
    out->uv = (bis_uv){(float)w[0], (float)w[1]};
    bis_grid_normal(out->n, tangent[0], tangent[1], noise);
}

bis_status bis_make_nurbs(bis_mesh *m, const bis_nurbs *s, bis_loc at, bis_diag *diag)
{
    enum { N = BIS_MAKE_NURBS };
    const bis_status status = bis_grid_room(m, (N + 1) * (N + 1), 2 * N * N, at, diag);

    if (!status) bis_grid_add(m, N, N, nurbs_at, s);
    return status;
}
