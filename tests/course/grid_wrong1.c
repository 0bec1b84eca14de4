/* The first cell with a hit ends the walk, although the hit may lie in a later cell, with a nearer one before it. */
/* loses: small_triangles_from_outside_are_met */
/* loses: small_triangles_from_inside_are_met */
/* loses: the_nearest_of_large_triangles_is_found */
/* loses: rays_along_an_axis_are_met */
/* loses: tmax_ends_the_ray */
/* loses: far_origins_are_met */
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
            if (best.prim != BIS_NO_PRIM) break;
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
