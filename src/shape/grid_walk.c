/* grid_walk: a ray through the voxel grid, cell by cell: Amanatides and Woo 1987, "A fast voxel traversal algorithm for
 * ray tracing". Cost: one step per cell, some 40 flops per triangle in a cell.
 *
 * The nearest hit so far ends the walk as soon as it lies before the cell's far wall, so a hit that was found early, in
 * a triangle that reaches into later cells, is kept but not yet believed. Any hit ends the any-hit walk at once.
 * - Axes are written out, x, y, z: state in arrays indexed by an axis doubled the time of a step.
 * - A direction component of 0 or -0 never meets a wall: its next wall is at infinity, no 0/0, no 1/-0.
 * - t counts from the point where the ray enters the box, so that a far origin costs its rounding once, not per
 * step. */
#include "bis/shape/geometry.h"
#include "grid.h"

#include "triangle.h"

#include <string.h>

/* One axis of the walk. */
typedef struct axis {
    double next, delta; /* t of the next wall; t between walls */
    ptrdiff_t step;     /* to the next cell's number */
    int left;           /* cells left ahead */
} axis;

/* Cut (t[0], t[1]) to the slab lo <= o + t d <= hi. */
/* [grid-clip] */
static inline bool clip(double lo, double hi, double o, double d, double t[2])
{
    if (d == 0) return o >= lo && o <= hi;
    double a = (lo - o) / d, b = (hi - o) / d;
    t[0] = fmax(t[0], fmin(a, b));
    t[1] = fmin(t[1], fmax(a, b));
    return t[0] <= t[1];
}
/* [end] */

/* p: where the walk starts, within rounding inside the box. Clamped, as rounding may leave it by some ulps. */
/* [grid-axis] */
static inline axis start_axis(const bis_grid *g, int a, double p, double d, ptrdiff_t stride, size_t *cell)
{
    const int n = g->n[a];
    double at = (p - g->lo[a]) * g->inv_cell[a];
    int i = at > 0 ? (at < n ? (int)at : n - 1) : 0;

    *cell += (size_t)(i * stride);
    if (d == 0) return (axis){(double)INFINITY, 0, 0, 0};
    double wall = g->lo[a] + (d > 0 ? i + 1 : i) * g->cell[a];
    return (axis){(wall - p) / d, g->cell[a] / fabs(d), d > 0 ? stride : -stride, d > 0 ? n - 1 - i : i};
}
/* [end] */

/* Is primitive prim hit at a float t in (0, tmax), not behind best? */
static inline bool meets(const bis_grid *g, uint32_t prim, const sheared_ray *s, const ray *r, double best, double *t)
{
    const bis_geometry *geometry = g->base.geometry;
    float v[9], rounded;

    if (prim >= geometry->n_triangles) {
        if (!bis_quadric_intersect(&geometry->quadrics[prim - geometry->n_triangles], r, &rounded)) return false;
        *t = (double)rounded;
        return *t <= best;
    }
    for (size_t i = 0; i < 3; i++)
        memcpy(v + 3 * i, &geometry->p[geometry->index[3 * (size_t)prim + i]], 3 * sizeof *v);
    return shear_hit(s, r, v, best, t);
}

/* The walk of both queries; any is a constant in each. */
/* [grid-walk] */
static inline __attribute__((always_inline)) bool walk(const bis_grid *g, const ray *r, bis_hit *hit, const bool any)
{
    const double ox = (double)r->o.x, oy = (double)r->o.y, oz = (double)r->o.z;
    const double dx = (double)r->d.x, dy = (double)r->d.y, dz = (double)r->d.z;
    double t[2] = {0, (double)r->tmax};

    if (!clip(g->lo[0], g->hi[0], ox, dx, t) || !clip(g->lo[1], g->hi[1], oy, dy, t) ||
        !clip(g->lo[2], g->hi[2], oz, dz, t)) {
        return false;
    }
    const sheared_ray sheared = shear_ray(r);
    const ptrdiff_t row = g->n[0], layer = row * g->n[1];
    const double t0 = t[0];
    size_t cell = 0;
    axis x = start_axis(g, 0, ox + t0 * dx, dx, 1, &cell);
    axis y = start_axis(g, 1, oy + t0 * dy, dy, row, &cell);
    axis z = start_axis(g, 2, oz + t0 * dz, dz, layer, &cell);
    bis_grid_best best = {(double)r->tmax, BIS_NO_PRIM};

    for (;;) {
        if (g->occupied[cell >> 6] >> (cell & 63) & 1) {
            const uint32_t end = g->offsets[cell + 1];
            for (uint32_t i = g->offsets[cell]; i < end; i++) {
                double found;
                if (!meets(g, g->items[i], &sheared, r, best.t, &found)) continue;
                if (any) return true;
                bis_grid_take(&best, found, g->items[i]);
            }
        }
        if (x.next <= y.next && x.next <= z.next) {
            if (best.t - t0 <= x.next || x.left-- == 0) break;
            x.next += x.delta;
            cell += (size_t)x.step;
        } else if (y.next <= z.next) {
            if (best.t - t0 <= y.next || y.left-- == 0) break;
            y.next += y.delta;
            cell += (size_t)y.step;
        } else {
            if (best.t - t0 <= z.next || z.left-- == 0) break;
            z.next += z.delta;
            cell += (size_t)z.step;
        }
    }
    if (any || best.prim == BIS_NO_PRIM) return false;
    *hit = (bis_hit){(float)best.t, best.prim};
    return true;
}
/* [end] */

bool bis_grid_intersect(const bis_accel *a, const ray *r, bis_hit *hit)
{
    return walk((const bis_grid *)a, r, hit, false);
}

bool bis_grid_occluded(const bis_accel *a, const ray *r) { return walk((const bis_grid *)a, r, NULL, true); }
