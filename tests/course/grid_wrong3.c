/* Brute force: all triangles, no cell. */
/* loses: only_the_cells_on_the_way_are_looked_at */
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
    bis_grid_best best = {(double)r->tmax, BIS_NO_PRIM};

    (void)start_axis;
    for (uint32_t i = 0; i < g->base.geometry->n_triangles; i++) {
        double found;
        if (!meets(g, i, &sheared, r, best.t, &found)) continue;
        if (any) return true;
        bis_grid_take(&best, found, i);
    }
    if (any || best.prim == BIS_NO_PRIM) return false;
    *hit = (bis_hit){(float)best.t, best.prim};
    return true;
}
/* [end] */
