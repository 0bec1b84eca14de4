/* Nothing guards a component of 0, and a walk upwards ends one cell early. */
/* [grid-axis] */
static inline axis start_axis(const bis_grid *g, int a, double p, double d, ptrdiff_t stride, size_t *cell)
{
    const int n = g->n[a];
    double at = (p - g->lo[a]) * g->inv_cell[a];
    int i = at > 0 ? (at < n ? (int)at : n - 1) : 0;

    *cell += (size_t)(i * stride);
    double wall = g->lo[a] + (d > 0 ? i + 1 : i) * g->cell[a];
    return (axis){(wall - p) / d, g->cell[a] / fabs(d), d > 0 ? stride : -stride, d > 0 ? (i < n - 1 ? n - 2 - i : 0) : i};
}
/* [end] */
