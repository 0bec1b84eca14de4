/* SPDX-License-Identifier: BSD-2-Clause */
/* The first cell with a hit ends the walk, although the hit may lie in a later cell, with a nearer one before it. */
/* loses: small_triangles_from_outside_are_met */
/* loses: small_triangles_from_inside_are_met */
/* loses: the_nearest_of_large_triangles_is_found */
/* loses: rays_along_an_axis_are_met */
/* loses: tmax_ends_the_ray */
/* loses: far_origins_are_met */
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
            if (s->best.prim != BIS_NO_PRIM) return false;
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
