/* The fast walk cuts the ray to the box, too, and could be called in the place of one's own. */
/* [grid-packed] */
/* Left out of this kit: what is packed is walked as any grid, by your code in grid_walk.c. */
bool bis_grid_packed_intersect(const bis_accel *a, const ray *r, bis_hit *hit) { return bis_grid_intersect(a, r, hit); }

bool bis_grid_packed_occluded(const bis_accel *a, const ray *r) { return bis_grid_occluded(a, r); }

size_t bis_grid_packed_bytes(size_t n_cells, size_t n_items)
{
    (void)n_cells, (void)n_items;
    return 0;
}

bis_status bis_grid_pack(bis_grid *g, int n_threads, bis_diag *diag)
{
    (void)g, (void)n_threads, (void)diag;
    return BIS_OK;
}
/* [end] */
