/* SPDX-License-Identifier: BSD-2-Clause */
/* No walk: all triangles are tried, as they come. Every hit is right; what it is for is not. The load takes many times
 * our time, too. */
/* loses: only_the_cells_on_the_way_are_looked_at */
/* [grid-clip] */
static inline BIS_INLINE bool clip(double lo, double hi, double o, double d, double t[2])
{
    (void)lo, (void)hi, (void)o, (void)d, (void)t;
    return true;
}
/* [end] */
/* [grid-axis] */
static inline BIS_INLINE axis start_axis(const bis_grid *g, int a, double p, double d, ptrdiff_t stride, size_t *cell)
{
    (void)g, (void)a, (void)p, (void)d, (void)stride, (void)cell;
    return (axis){(double)INFINITY, 0, 0, 0};
}
/* [end] */
/* [grid-walk] */
static inline BIS_INLINE bool walk(const bis_grid *g, search *s, const bool any)
{
    (void)clip, (void)start_axis;
    for (uint32_t prim = 0; prim < g->base.geometry->n_triangles; prim++) {
        double t;
        if (!meets(g->base.geometry, prim, s, &t)) continue;
        if (any) return true;
        bis_grid_take(&s->best, t, prim);
    }
    return false;
}
/* [end] */
