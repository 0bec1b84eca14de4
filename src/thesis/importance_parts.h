/* SPDX-License-Identifier: BSD-2-Clause */
/* importance_parts: the three parts of src/thesis/importance.c: the weight of a pixel, and the two ways of drawing by
 * these weights. Only src/thesis/importance*.c include it. */
#pragma once

#include "bis/thesis/alias.h"
#include "bis/thesis/cdf.h"
#include "bis/thesis/importance.h"
#include "bis/thesis/errata.h"

/* The importance per steradian, w = max(0, I - mean) * area. It is never stored. The same function builds the tables
 * and computes the density, so that the two agree to the last bits. */
typedef struct bis_weights {
    const bis_envmap *em;
    float *area; /* area[height * width], > 0: the pixel's area factor of thesis 3.4; NULL if b = 0 */
    double mean; /* 0 except for MIS compensation */
    unsigned as_printed; /* BIS_E* */
} bis_weights;

/* bis_weight returns the importance per steradian of a pixel. */
static inline double bis_weight(const bis_weights *w, size_t pixel)
{
    const double excess = rgb_sum(w->em->pixels[pixel]) - w->mean;
    if (excess <= 0) return 0;
    return w->area ? excess * (double)w->area[pixel] : excess;
}

/* bis_row_measure returns the factor by which a weight becomes a probability in row y: the solid angle of one pixel.
 * Without it the poles would get too much (docs/errata.md E3). */
static inline double bis_row_measure(const bis_weights *w, size_t y)
{
    if (w->as_printed & BIS_E3) return 1;
    return w->em->row_solid_angle[y];
}

/* A pixel that was drawn, and the place in it: u[0] of phi, u[1] of cos(theta). */
typedef struct bis_drawn {
    size_t x, y;
    double u[2];
} bis_drawn;

/* The two passes of the thesis. Alias tables take BIS_TABLE_BYTES a pixel. */
typedef struct bis_table {
    bis_table_kind kind;
    size_t width, height;
    bis_alias row_alias; /* pass 1: a scanline */
    bis_cdf row_cdf;
    double *prob;        /* pass 2, alias: prob[height][width] */
    uint16_t *alias;     /* alias[height][width]: columns. Half the size of bis_alias's items, because a row is short */
    bis_cdf *columns;    /* pass 2, CDFs: columns[height]; rows of weight 0 stay empty */
} bis_table;

/* bis_table_init builds the tables. row_weight[height] is the sum of weight * solid angle over each row. Errors:
 * BIS_NOMEM; what was built is then still to be freed. */
bis_status bis_table_init(bis_table *t, const bis_weights *w, const double *row_weight, bis_table_kind kind,
                          bis_diag *diag);

/* bis_table_clear frees the tables. */
void bis_table_clear(bis_table *t);

/* bis_table_draw draws a pixel. u[4] are the numbers of bis_importance_sample. */
bis_drawn bis_table_draw(const bis_table *t, const double u[4]);

/* bis_table_bytes returns the bytes that the tables take. */
size_t bis_table_bytes(const bis_table *t);

/* bis_table_implied_pmf computes the probabilities pmf[height * width] that the tables really give. Errors:
 * BIS_NOMEM. */
bis_status bis_table_implied_pmf(const bis_table *t, double *pmf, bis_diag *diag);

/* A sum of weights, and what its additions have rounded off. */
typedef struct bis_curve_sum {
    double sum, low;
} bis_curve_sum;

/* One CDF along a space-filling curve. It takes BIS_CURVE_BYTES a tile. */
typedef struct bis_curve {
    bis_weights weights; /* em and area are borrowed */

    uint32_t side;        /* pixels along a tile's side: 1 or 4 */
    uint32_t across;      /* tiles in a row of tiles */
    uint32_t *tile;       /* tile[n_tiles] in the order of the curve: column + across * row of each tile */
    size_t n_tiles;
    bis_curve_sum *before; /* before[n_tiles + 1]: the weights of all pixels before a tile of the curve */
    uint32_t *guide; /* guide[n_guide + 1]: see bis_cdf */
    size_t n_guide;
} bis_curve;

/* bis_curve_init builds the curve, and stores in row_weight[height] the sum of the weights of each row, because it adds
 * up all pixels. Errors: BIS_NOMEM; what was built is then still to be freed. */
bis_status bis_curve_init(bis_curve *t, const bis_weights *w, double *row_weight, bis_diag *diag);

/* bis_curve_clear frees the curve. */
void bis_curve_clear(bis_curve *t);

/* bis_curve_draw returns the pixel at s in [0,1), the share of the importance that lies before it on the curve. */
size_t bis_curve_draw(const bis_curve *t, double s);

/* bis_curve_bytes returns the bytes that the curve takes. */
size_t bis_curve_bytes(const bis_curve *t);

/* bis_curve_tile_at does the work of bis_importance_tile. */
bis_curve_tile bis_curve_tile_at(const bis_curve *t, size_t i);

/* bis_curve_in_tile does the work of bis_importance_in_tile. */
double bis_curve_in_tile(const bis_curve *t, double s);
