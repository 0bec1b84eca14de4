/* SPDX-License-Identifier: BSD-2-Clause */
/* Nothing guards a component of 0, and a walk upwards ends one cell early. */
/* loses: small_triangles_from_outside_are_met */
/* loses: small_triangles_from_inside_are_met */
/* loses: the_nearest_of_large_triangles_is_found */
/* loses: only_the_cells_on_the_way_are_looked_at */
/* loses: rays_along_an_axis_are_met */
/* loses: the_last_cell_is_visited */
/* loses: far_origins_are_met */
/* [grid-axis] */
static inline BIS_INLINE axis start_axis(const bis_grid *g, int a, double p, double d, ptrdiff_t stride, size_t *cell)
{
    const int n = g->n[a];
    const double at = (p - g->lo[a]) * g->inv_cell[a];
    const int i = at > 0 ? (at < n ? (int)at : n - 1) : 0;

    *cell += (size_t)(i * stride);
    const double wall = g->lo[a] + (d > 0 ? i + 1 : i) * g->cell[a];
    return (axis){
        (wall - p) / d, g->cell[a] / fabs(d), d > 0 ? stride : -stride, d > 0 ? (i < n - 1 ? n - 2 - i : 0) : i};
}
/* [end] */
