/* SPDX-License-Identifier: BSD-2-Clause */
/* visibility: what share of the shadow rays towards each part of the map came through, in each cell of the picture, as
 * earlier passes measured it, and in this pass the cells of the tile that come before.
 *
 * If the product is known, all that remains of the noise is that of V (docs/errata.md E31), and neighbouring pixels
 * have similar V. What was counted is used twice (src/beyond/guide.c): rays go where V is uncertain, and the mean of V,
 * which is known by then, needs no rays.
 *
 * The estimates are unbiased: whatever the counts are, the mean over a point's own random numbers is right. A point
 * uses the counts of earlier passes and of other pixels, which have other random numbers (all pixels of a pass draw
 * from the same clusters, but these decide neither the marks nor the mean). The weight of a pass does not depend on
 * what it found.
 *
 * Nothing is known before the first rays. So the picture is looked around in, coarse to fine: squares of many tiles,
 * squares in these, and at last each tile before its first samples (src/render/survey.c). That costs a 48th of a pass
 * where light arrives, and up to a third where it is hard to find. What is known of a part comes from its own rays,
 * from those of the parts around it on the map, from the tile around the cell, and from the squares around the tile.
 *
 * A part is a run of clusters (bis/beyond/clusters.h), so it is compact. A cell is a square of 4 x 4 pixels, or, in
 * pictures of more than 2^23 pixels, a whole tile. A cell takes 1 KB in memory, and a square 2 KB. */
#pragma once

#include "bis/beyond/clusters.h"

enum {
    BIS_VISIBILITY_PARTS = 128,
    BIS_VISIBILITY_CELLS = 16,     /* of a tile, at most */
    /* pixels: in a larger picture a cell is a tile, because cells of 4 x 4 take 64 bytes a pixel, 512 MiB there */
    BIS_VISIBILITY_LARGE = 1 << 23
};

/* The rays of a cell towards each part, and those of them that came through. */
typedef struct bis_seen {
    uint16_t rays[BIS_VISIBILITY_PARTS], seen[BIS_VISIBILITY_PARTS];
} bis_seen;

/* What is expected in a square of many tiles, of each part: the mean of V, and the best h. */
typedef struct bis_square {
    float mean[BIS_VISIBILITY_PARTS], h[BIS_VISIBILITY_PARTS]; /* h is above 0 once the square is closed */
} bis_square;

enum { BIS_NO_SQUARE = UINT32_MAX };

/* A place is a tile, or square k as place n_tiles + k. A square has one cell, and these follow those of the tiles. */
typedef struct bis_visibility {
    size_t n_tiles, n_squares;
    size_t cells;      /* of a tile: 16 or 1 */
    bis_seen *known;   /* known[n_tiles][cells], known[n_squares]: counted by the passes or looks before this one */
    bis_seen *counted; /* the same: counted by this pass or look */
    uint32_t *above;   /* above[n_tiles + n_squares]: the square around a place, or BIS_NO_SQUARE; by the renderer */
    bis_square *squares;
} bis_visibility;

/* What a cell knows of each cluster, and what a point in it makes of that. Arrays are as long as the clusters, in
 * whole blocks of lanes. */
typedef struct bis_visibility_guess {
    float *own;        /* > 0, below 0.71: the best h as far as the cell knows */
    float *g;          /* in [0,1]: the mean of V */
    float *of_square;  /* the best h as far as the square around it knows */
    float *left;       /* E[(V - g)^2] */
    bool has_square;   /* there is one */
    float *h;          /* > 0: what the weights of the point's candidates are multiplied by */
    float *control;    /* g/h */
    float *noise;      /* left/h^2 */
    bool knows;        /* something was counted */
    bool is_dark;      /* most of the tile's rays were hidden */
    float *memory;     /* what holds all arrays */
    bis_seen *counted; /* borrowed: of the cell; NULL: do not count */
} bis_visibility_guess;

/* bis_visibility_init allocates the counts of n_tiles tiles and n_squares squares, all 0, for a picture of n_pixels. No
 * place is in a square. Errors: BIS_NOMEM. */
bis_status bis_visibility_init(bis_visibility *v, size_t n_tiles, size_t n_squares, uint64_t n_pixels, bis_diag *diag);

/* bis_visibility_clear frees the counts. *v is empty afterwards. */
void bis_visibility_clear(bis_visibility *v);

/* bis_visibility_bytes returns the bytes that the counts take. */
size_t bis_visibility_bytes(const bis_visibility *v);

/* bis_visibility_part returns the part that cluster k of n belongs to. */
static inline uint32_t bis_visibility_part(uint32_t k, uint32_t n)
{
    return n <= BIS_VISIBILITY_PARTS ? k : (uint32_t)((uint64_t)k * BIS_VISIBILITY_PARTS / n);
}

/* bis_guess_init allocates the arrays for n clusters; all h are equal, and no g is known. Errors: BIS_NOMEM. */
bis_status bis_guess_init(bis_visibility_guess *f, uint32_t n, bis_diag *diag);

/* bis_guess_bytes returns the bytes that the arrays for n clusters take. */
size_t bis_guess_bytes(uint32_t n);

/* bis_guess_clear frees the arrays. */
void bis_guess_clear(bis_visibility_guess *f);

/* bis_visibility_first_cell returns the number of a place's first cell. */
static inline size_t bis_visibility_first_cell(const bis_visibility *v, size_t place)
{
    return place < v->n_tiles ? place * v->cells : v->n_tiles * v->cells + (place - v->n_tiles);
}

/* bis_guess_look stores what the counts say about each of n clusters in cell number `cell`, and lets f->counted lead to
 * this cell's counts. What this pass counted is used from the cells of the tile with smaller numbers, so these must be
 * complete. The square around it must be closed. */
void bis_guess_look(bis_visibility_guess *f, uint32_t n, const bis_visibility *v, size_t cell);

/* bis_guess_mix makes h, control and noise for a point, of whose product with cluster k of n b[k] is a bound, W their
 * sum, and multiplies b by h. 8 of 15 candidates then go where the cell alone would send them, 4 where the square
 * around it would, and 3 where it would go without knowledge. Without a square it is 4 of 5 and 1 of 5. */
void bis_guess_mix(bis_visibility_guess *f, float *b, double W, uint32_t n);

/* bis_visibility_close makes *square of what was counted in square k, for n clusters. The square around it must be
 * closed. */
void bis_visibility_close(bis_visibility *v, size_t k, uint32_t n);

/* bis_guess_count counts a ray towards cluster k of n. It returns where another 1 is to be added if light arrives,
 * or NULL if nothing is to be counted. */
uint16_t *bis_guess_count(const bis_visibility_guess *f, uint32_t k, uint32_t n);

/* bis_visibility_counted stores how many rays this pass counted in a place, and how many of them came through. */
void bis_visibility_counted(uint32_t *rays, uint32_t *seen, const bis_visibility *v, int place);

/* bis_visibility_learn ends a pass or a look: what it counted in places[n] is added to what is known. places is NULL:
 * in the first n. Without visibility it does nothing. */
void bis_visibility_learn(const bis_visibility *v, const int *places, size_t n, int n_threads);
