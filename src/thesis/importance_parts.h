/* importance_parts: the three parts of src/thesis/importance.c: what a pixel weighs, and the two ways of drawing by these
 * weights.
 * For src/thesis/importance*.c alone. */
#ifndef BIS_IMPORTANCE_PARTS_H
#define BIS_IMPORTANCE_PARTS_H

#include "bis/thesis/alias.h"
#include "bis/thesis/cdf.h"
#include "bis/thesis/importance.h"
#include "bis/thesis/errata.h"

/* The importance per steradian, w = max(0, I - mean) * area. Never stored itself: the tables are made from, and the
 * density is computed from, the very same function, so that they agree to the last bits. */
typedef struct bis_weights {
    const bis_envmap *em;
    float *area; /* area[height * width], > 0: the pixel's area factor of thesis 3.4; NULL where b = 0 */
    double mean; /* 0 but for MIS compensation */
    unsigned as_printed; /* BIS_E* */
} bis_weights;

static inline double bis_weight(const bis_weights *w, size_t pixel)
{
    const double excess = rgb_sum(w->em->pixels[pixel]) - w->mean;
    if (excess <= 0) return 0;
    return w->area ? excess * (double)w->area[pixel] : excess;
}

/* By what a row's pixels are multiplied to be drawn: their solid angle, without which the poles get too much
 * (docs/errata.md E3). */
static inline double bis_row_measure(const bis_weights *w, size_t y)
{
    if (w->as_printed & BIS_E3) return 1;
    return w->em->row_solid_angle[y];
}

/* A pixel drawn, and where in it: u[0] of phi, u[1] of cos(theta). */
typedef struct bis_drawn {
    size_t x, y;
    double u[2];
} bis_drawn;

/* The thesis's two passes. With alias tables 10 bytes a pixel, with CDFs 8 and the guides. */
typedef struct bis_table {
    bis_table_kind kind;
    size_t width, height;
    bis_alias row_alias; /* pass 1: a scanline */
    bis_cdf row_cdf;
    double *prob;        /* pass 2, alias: prob[height][width] */
    uint16_t *alias;     /* alias[height][width], columns; half the size of bis_alias's because a row is short */
    bis_cdf *columns;    /* pass 2, CDFs: columns[height]; rows of weight 0 are left empty */
} bis_table;

/* row_weight[height]: the sum of weight * solid angle over each row. Errors: BIS_NOMEM. */
bis_status bis_table_init(bis_table *t, const bis_weights *w, const double *row_weight, bis_table_kind kind, bis_diag *diag);
void bis_table_clear(bis_table *t);
bis_drawn bis_table_draw(const bis_table *t, const double u[4]);
size_t bis_table_bytes(const bis_table *t);

/* pmf[height * width] that the tables really give. Errors: BIS_NOMEM. */
bis_status bis_table_implied_pmf(const bis_table *t, double *pmf, bis_diag *diag);

/* One CDF along a space-filling curve. 9 to 10 bytes a pixel, guide included. */
typedef struct bis_trail {
    uint32_t *tile;   /* tile[n_tiles]: along the curve, the pixel (y * width + x) in a tile's upper left corner */
    size_t n_tiles;
    uint32_t side;    /* pixels along a tile's side: 1 or 4 */
    bis_cdf pixels;   /* cell k: pixel (k % side, k / side % side) of tile k / side^2; weight 0 beyond the map's edge */
} bis_trail;

/* Errors: BIS_NOMEM. */
bis_status bis_trail_init(bis_trail *t, const bis_weights *w, bis_diag *diag);
void bis_trail_clear(bis_trail *t);

/* s in [0,1): the share of the importance that lies before the pixel on the curve. */
size_t bis_trail_draw(const bis_trail *t, size_t width, double s);
size_t bis_trail_bytes(const bis_trail *t);

/* bis_importance_cut. */
bis_status bis_trail_cut(const bis_trail *trail, const bis_envmap *em, uint32_t K, uint32_t *n, double **t, uint16_t **of_tile);

#endif
