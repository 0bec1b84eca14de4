/* SPDX-License-Identifier: BSD-2-Clause */
/* Brute force: all triangles, no cell. */
/* loses: only_the_cells_on_the_way_are_looked_at */
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
    (void)start_axis;
    for (uint32_t i = 0; i < g->base.geometry->n_triangles; i++) {
        double found;
        if (!meets(g->base.geometry, i, s, &found)) continue;
        if (any) return true;
        bis_grid_take(&s->best, found, i);
    }
    return false;
}
/* [end] */
