/* grid: the thesis's voxel grid, as a state-of-the-art uniform grid. For accel.c and the grid's own tests only. */
#ifndef BIS_GRID_H
#define BIS_GRID_H

#include "bis/accel.h"

/* Cells per primitive. Surfaces leave most cells empty, and an empty cell costs a bit's look-up. On the dragon (871k triangles) an
 * any-hit ray passes 47, 51, 65 cells and tests 66, 59, 44 triangles at density 3, 4, 8; from 8 to 12 nothing is won any more
 * (scripts/bench_accel.c). The whole grid takes 80 bytes a triangle at 8, 57 at 3. */
#define BIS_GRID_DENSITY 8.0

/* No axis has more cells: the walk's accumulated rounding stays below GRID_SLACK cells. */
#define BIS_GRID_MAX_RES 4096

/* Cells are enlarged by this share of their size on each side when primitives are put into them. The walk computes in
 * double: from an origin at a distance of up to 2^27 boxes it enters at a point that is wrong by at most 4 roundings of
 * 2^-53 * 2^27 = 2^-26 boxes, and each of at most 3 * 4096 steps adds 2^-53 boxes. A cell is at least 2^-12 boxes
 * wide, so that is 2^-12 cells in all. What a ray meets is therefore always found in a cell that the walk visits, even
 * when it lies in the wall between two. */
#define BIS_GRID_SLACK 0x1p-10

typedef struct bis_grid {
    bis_accel base;
    double lo[3], hi[3], cell[3], inv_cell[3]; /* the box, a cell's size, 1 / size */
    int n[3];                                  /* cells along each axis; cell (i, j, k) is number (k n[1] + j) n[0] + i */
    size_t n_cells;
    uint32_t *offsets;                         /* offsets[n_cells + 1]: cell c holds items[offsets[c] ... offsets[c+1] - 1] */
    uint32_t *items;                           /* primitives, ascending in each cell */
    uint64_t *occupied;                        /* one bit a cell: is there any item? Empty space costs an L2 access */
    float (*triangle)[9];                      /* vertices of each triangle, together */
} bis_grid;

/* density 0: the default. */
bis_status bis_grid_new(bis_accel **out, const bis_geometry *g, double density, int n_threads, bis_diag *diag);

/* The walk, src/grid_walk.c. */
bool bis_grid_intersect(const bis_accel *a, const ray *r, bis_hit *hit);
bool bis_grid_occluded(const bis_accel *a, const ray *r);

#endif
