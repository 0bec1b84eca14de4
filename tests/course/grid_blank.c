/* SPDX-License-Identifier: BSD-2-Clause */
/* [grid-clip] */
static inline BIS_INLINE bool clip(double lo, double hi, double o, double d, double t[2])
{
    /* Yours to write. False: the ray misses the slab. */
    (void)lo, (void)hi, (void)o, (void)d, (void)t;
    return false;
}
/* [end] */
/* [grid-axis] */
static inline BIS_INLINE axis start_axis(const bis_grid *g, int a, double p, double d, ptrdiff_t stride, size_t *cell)
{
    /* Yours to write: the walk's state along axis a, at coordinate p; *cell grows by stride for each cell that p lies
     * beyond the box's wall. */
    (void)g, (void)a, (void)p, (void)d, (void)stride, (void)cell;
    return (axis){(double)INFINITY, 0, 0, 0};
}
/* [end] */
/* [grid-walk] */
static inline BIS_INLINE bool walk(const bis_grid *g, search *s, const bool any)
{
    /* Yours to write: clip the ray s->r, start the three axes, go from cell to cell. test_cell tests what lies in a
     * cell and keeps the nearest hit in s->best; it returns true if something is hit and any hit will do: then return
     * true, too. In all other cases return false. */
    (void)g, (void)s, (void)any, (void)clip, (void)start_axis;
    return false;
}
/* [end] */
