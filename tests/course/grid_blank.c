/* [grid-clip] */
static inline bool clip(double lo, double hi, double o, double d, double t[2])
{
    /* Yours to write. False: the ray misses the slab. */
    (void)lo, (void)hi, (void)o, (void)d, (void)t;
    return false;
}
/* [end] */
/* [grid-axis] */
static inline axis start_axis(const bis_grid *g, int a, double p, double d, ptrdiff_t stride, size_t *cell)
{
    /* Yours to write: the walk's state along axis a, at coordinate p; *cell grows by stride for each cell that p lies beyond the box's wall. */
    (void)g, (void)a, (void)p, (void)d, (void)stride, (void)cell;
    return (axis){(double)INFINITY, 0, 0, 0};
}
/* [end] */
/* [grid-walk] */
static inline __attribute__((always_inline)) bool walk(const bis_grid *g, const ray *r, bis_hit *hit, const bool any)
{
    /* Yours to write: clip the ray, start the three axes, go from cell to cell. The primitives of cell c are g->items[i] for i from g->offsets[c] to
     * g->offsets[c + 1] - 1. Of use: shear_ray, meets, bis_grid_take. any: the first hit will do, *hit is not wanted (NULL). */
    (void)g, (void)r, (void)hit, (void)any, (void)clip, (void)start_axis, (void)meets;
    return false;
}
/* [end] */
