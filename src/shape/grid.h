/* SPDX-License-Identifier: BSD-2-Clause */
/* grid: the thesis's voxel grid, as a state-of-the-art uniform grid. For accel.c and the grid's own tests only. */
#pragma once

#include "bis/shape/accel.h"

/* Cells per primitive, by default. Surfaces leave most cells empty, and an empty cell costs a bit's look-up. A packed
 * grid is as fast from 1 to 8 cells on the dragon (871k triangles), but space grows. One
 * that is not packed gains up to 8. */
#define BIS_GRID_DENSITY 2.0
#define BIS_GRID_PLAIN_DENSITY 8.0

/* No axis has more cells: the walk's accumulated rounding stays below GRID_SLACK cells. */
#define BIS_GRID_MAX_RES 4096

/* Cells are enlarged by this share of their size on each side when primitives are put into them. The walk computes in
 * double: from an origin at a distance of up to 2^27 boxes it enters at a point that is wrong by at most 4 roundings of
 * 2^-53 * 2^27 = 2^-26 boxes, and each of at most 3 * 4096 steps adds 2^-53 boxes. A cell is at least 2^-12 boxes
 * wide, so that is 2^-12 cells in all. What a ray meets is therefore always found in a cell that the walk visits, even
 * when it lies in the wall between two. */
#define BIS_GRID_SLACK 0x1p-10

/* Triangles of a block: block[3 i + a][k] is coordinate a of vertex i of the k-th. */
enum { BIS_GRID_LANES = 8 };
typedef float bis_grid_block[9][BIS_GRID_LANES];

typedef struct bis_grid {
    bis_accel base;
    double lo[3], hi[3], cell[3], inv_cell[3]; /* the box, a cell's size, 1 / size */
    /* cells along each axis; cell (i, j, k) is number (k n[1] + j) n[0] + i */
    int n[3];
    size_t n_cells;
    /* offsets[n_cells + 2]: cell c holds items[offsets[c] ... offsets[c+1] - 1]. One more cell after the last, number
     * n_cells, holds what is set aside: up to 8 primitives that reach far out of the box */
    uint32_t *offsets;
    uint32_t *items;                           /* primitives, ascending in each cell */
    uint64_t *occupied;                        /* one bit a cell: is there any item? Empty space costs an L2 access */
    /* block b: the triangles of items 8 b ... 8 b + 7; NULL: the grid is not packed */
    bis_grid_block *blocks;
    float *reach;                              /* no vertex of block b is farther from its first one, along any axis */
} bis_grid;

/* bis_grid_items returns the number of items of all cells, with those that are set aside. */
static inline size_t bis_grid_items(const bis_grid *g) { return g->offsets[g->n_cells + 1]; }

/* The nearest hit so far; t is not rounded. Of hits at the same t the first primitive counts, so that it does not
 * matter which is found first. */
typedef struct bis_grid_best {
    double t;
    uint32_t prim;
} bis_grid_best;

/* bis_grid_take makes (t, prim) the best hit if it comes before the best so far; true if it did. */
static inline bool bis_grid_take(bis_grid_best *best, double t, uint32_t prim)
{
    if (t > best->t || (t == best->t && prim >= best->prim)) return false;
    *best = (bis_grid_best){t, prim};
    return true;
}

/* bis_grid_new builds a grid with `density` cells a primitive; 0: the default. It is packed where mesh and grid then
 * stay below 150 bytes a triangle: not where most triangles are much larger than a cell. Errors: BIS_NOMEM. */
bis_status bis_grid_new(bis_accel **out, const bis_geometry *g, double density, int n_threads, bis_diag *diag);

/* bis_grid_intersect and bis_grid_occluded are the grid's two queries (bis/shape/accel.h): grid_walk.c. */
bool bis_grid_intersect(const bis_accel *a, const ray *r, bis_hit *hit);
bool bis_grid_occluded(const bis_accel *a, const ray *r);
