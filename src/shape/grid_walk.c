/* SPDX-License-Identifier: BSD-2-Clause */
/* grid_walk: a ray through the voxel grid, cell by cell: Amanatides and Woo 1987, "A fast voxel traversal algorithm for
 * ray tracing". Cost: one step per cell, and one test for each eight triangles of the cells that are not empty.
 *
 * The nearest hit so far ends the walk as soon as it lies before the cell's far wall. A hit that was found early, in a
 * triangle that reaches into later cells, is kept but not yet believed. Any hit ends the any-hit walk at once.
 * - Axes are written out, x, y, z: state in arrays indexed by an axis doubled the time of a step, and a pointer to the
 *   axis of the next wall made rays through a scan a quarter slower.
 * - A direction component of 0 or -0 never meets a wall: its next wall is at infinity, no 0/0, no 1/-0.
 * - t counts from the point where the ray enters the box, so that a far origin costs its rounding once, not per step.
 * - The triangles of a cell are tested eight at a time (grid_block.h), where the grid is packed. */
#include "bis/shape/geometry.h"
#include "grid.h"
#include "grid_block.h"

#include <string.h>

/* A ray, and the nearest that it has met so far. best.t begins at the ray's tmax, best.prim at BIS_NO_PRIM. */
typedef struct search {
    const ray *r;
    sheared_ray sheared;
    near_ray near;
    bis_grid_best best;
    uint32_t tested; /* the last block that was tested, because neighbours may share it */
} search;

/* Is primitive prim hit at a float t in (0, tmax), not behind the best? */
static inline BIS_INLINE bool meets(const bis_geometry *g, uint32_t prim, const search *s, double *t)
{
    float v[9], rounded;

    if (prim >= g->n_triangles) {
        if (!bis_quadric_intersect(&g->quadrics[prim - g->n_triangles], s->r, &rounded)) return false;
        *t = (double)rounded;
        return *t <= s->best.t;
    }
    for (size_t i = 0; i < 3; i++) memcpy(v + 3 * i, &g->p[g->index[3 * (size_t)prim + i]], 3 * sizeof *v);
    return shear_hit(&s->sheared, s->r, v, s->best.t, t);
}

/* Test the triangles of a block. True: one is hit, and any will do. */
static inline BIS_INLINE bool test_block(const bis_grid *g, uint32_t block, search *s, const bool any)
{
    for (unsigned mask = may_meet(&s->near, g->blocks[block], g->reach[block]); mask; mask &= mask - 1) {
        const int k = __builtin_ctz(mask);
        float v[9];
        double t;
        for (int i = 0; i < 9; i++) v[i] = g->blocks[block][i][k];
        if (!shear_hit(&s->sheared, s->r, v, s->best.t, &t)) continue;
        if (any) return true;
        bis_grid_take(&s->best, t, g->items[BIS_GRID_LANES * (size_t)block + (size_t)k]);
    }
    return false;
}

/* Test what lies in the cell that the ray leaves at t: triangles by blocks, if there are blocks, and the rest one by
 * one. Quadrics are a cell's last items. True: something is hit, and any hit will do. */
static inline BIS_INLINE bool test_cell(const bis_grid *g, size_t cell, double t, search *s, const bool any)
{
    const float d[3] = {s->r->d.x, s->r->d.y, s->r->d.z};
    const bis_geometry *geometry = g->base.geometry;
    const uint32_t begin = g->offsets[cell], end = g->offsets[cell + 1];

    near_move(&s->near, &s->sheared, (double)d[s->near.kz], t);
    for (uint32_t block = begin / BIS_GRID_LANES; g->blocks && BIS_GRID_LANES * block < end; block++) {
        if (block == s->tested) continue;
        s->tested = block;
        if (test_block(g, block, s, any)) return true;
    }
    if (g->blocks && geometry->n_quadrics == 0) return false;
    for (uint32_t i = end; i-- > begin;) {
        double found;
        if (g->blocks && g->items[i] < geometry->n_triangles) break;
        if (!meets(geometry, g->items[i], s, &found)) continue;
        if (any) return true;
        bis_grid_take(&s->best, found, g->items[i]);
    }
    return false;
}

/* Cut (t[0], t[1]) to the slab lo <= o + t d <= hi. */
/* [grid-clip] */
static inline BIS_INLINE bool clip(double lo, double hi, double o, double d, double t[2])
{
    if (d == 0) return o >= lo && o <= hi;
    const double a = (lo - o) / d, b = (hi - o) / d;
    t[0] = larger(t[0], smaller(a, b));
    t[1] = smaller(t[1], larger(a, b));
    return t[0] <= t[1];
}
/* [end] */

/* One axis of the walk. */
typedef struct axis {
    double next, delta; /* t of the next wall; t between walls */
    ptrdiff_t step;     /* to the next cell's number */
    int left;           /* cells left ahead */
} axis;

/* p: where the walk starts, within rounding inside the box. Clamped, as rounding may leave it by some ulps. */
/* [grid-axis] */
static inline BIS_INLINE axis start_axis(const bis_grid *g, int a, double p, double d, ptrdiff_t stride, size_t *cell)
{
    const int n = g->n[a];
    const double at = (p - g->lo[a]) * g->inv_cell[a];
    const int i = at > 0 ? (at < n ? (int)at : n - 1) : 0;

    *cell += (size_t)(i * stride);
    if (d == 0) return (axis){(double)INFINITY, 0, 0, 0};
    const double wall = g->lo[a] + (d > 0 ? i + 1 : i) * g->cell[a];
    return (axis){(wall - p) / d, g->cell[a] / fabs(d), d > 0 ? stride : -stride, d > 0 ? n - 1 - i : i};
}
/* [end] */

/* The walk of both queries; any is a constant in each. True: something is hit, and any hit will do. */
/* [grid-walk] */
static inline BIS_INLINE bool walk(const bis_grid *g, search *s, const bool any)
{
    const double ox = (double)s->r->o.x, oy = (double)s->r->o.y, oz = (double)s->r->o.z;
    const double dx = (double)s->r->d.x, dy = (double)s->r->d.y, dz = (double)s->r->d.z;
    double t[2] = {0, s->best.t};

    if (!clip(g->lo[0], g->hi[0], ox, dx, t) || !clip(g->lo[1], g->hi[1], oy, dy, t) ||
        !clip(g->lo[2], g->hi[2], oz, dz, t)) {
        return false;
    }
    const ptrdiff_t row = g->n[0], layer = row * g->n[1];
    const double t0 = t[0];
    size_t cell = 0;
    axis x = start_axis(g, 0, ox + t0 * dx, dx, 1, &cell);
    axis y = start_axis(g, 1, oy + t0 * dy, dy, row, &cell);
    axis z = start_axis(g, 2, oz + t0 * dz, dz, layer, &cell);

    for (;;) {
        if (g->occupied[cell >> 6] >> (cell & 63) & 1) {
            const double leaves = t0 + smaller(x.next, smaller(y.next, z.next));
            if (test_cell(g, cell, leaves, s, any)) return true;
        }
        if (x.next <= y.next && x.next <= z.next) {
            if (s->best.t - t0 <= x.next || x.left-- == 0) return false;
            x.next += x.delta;
            cell += (size_t)x.step;
        } else if (y.next <= z.next) {
            if (s->best.t - t0 <= y.next || y.left-- == 0) return false;
            y.next += y.delta;
            cell += (size_t)y.step;
        } else {
            if (s->best.t - t0 <= z.next || z.left-- == 0) return false;
            z.next += z.delta;
            cell += (size_t)z.step;
        }
    }
}
/* [end] */

/* What is set aside comes first, because a hit there ends the walk earlier. */
static inline BIS_INLINE bool search_grid(const bis_grid *g, search *s, const bool any)
{
    const size_t aside = g->n_cells;

    if (g->offsets[aside] < g->offsets[aside + 1] && test_cell(g, aside, 0, s, any)) return true;
    return walk(g, s, any);
}

static inline BIS_INLINE search start_search(const bis_grid *g, const ray *r)
{
    const sheared_ray sheared = shear_ray(r);

    return (search){r, sheared, near_ray_of(g, &sheared), {(double)r->tmax, BIS_NO_PRIM}, UINT32_MAX};
}

BIS_LANES
static bool search_nearest(const bis_grid *g, const ray *r, bis_hit *hit)
{
    search s = start_search(g, r);

    search_grid(g, &s, false);
    if (s.best.prim == BIS_NO_PRIM) return false;
    *hit = (bis_hit){(float)s.best.t, s.best.prim};
    return true;
}

BIS_LANES
static bool search_any(const bis_grid *g, const ray *r)
{
    search s = start_search(g, r);

    return search_grid(g, &s, true);
}

bool bis_grid_intersect(const bis_accel *a, const ray *r, bis_hit *hit)
{
    return search_nearest((const bis_grid *)a, r, hit);
}

bool bis_grid_occluded(const bis_accel *a, const ray *r) { return search_any((const bis_grid *)a, r); }
