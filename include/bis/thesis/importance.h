/* SPDX-License-Identifier: BSD-2-Clause */
/* importance: drawing directions from an environment map. Source: thesis 3.3 and figure 3.5.
 *
 * The importance of a pixel per steradian is its weight w: the intensity (r+g+b), times the area factor of the
 * pixel's component (thesis 3.4) if b > 0. A pixel is drawn with probability P = w * solid angle / sum
 * (docs/errata.md E3), and a direction inside the pixel uniformly. The density is therefore exactly w/sum, whatever b
 * is, and every estimator divides by this density (E20).
 *
 * There are two ways of drawing. Each is built only on request:
 *   - table: the two passes of the thesis (first a row, then a pixel in it), by alias tables (O(1)) or by CDFs (which
 *     keep stratification);
 *   - curve: one CDF over the lit pixels in the order of a space-filling curve. One stratified number then fills the
 *     map evenly. */
#pragma once

#include "bis/thesis/envmap.h"
#include "bis/thesis/errata.h"

#include <stdbool.h>

typedef enum bis_table_kind { BIS_TABLE_ALIAS, BIS_TABLE_CDF } bis_table_kind;

/* The largest b that a scene or an option may give. At b = 10, a region of a thousandth of the clamp of 0.01 sr keeps
 * 1e-30 of its importance. A larger b would change no picture and could underflow a double. */
#define BIS_AREA_EXPONENT_MAX 10.0
#define BIS_AREA_EXPONENT 0.15 /* the default */

/* The number of levels of thesis 3.4: the default and the largest. */
enum { BIS_LEVELS = 8, BIS_LEVELS_MAX = 254 };

/* What to build. */
typedef struct bis_importance_options {
    bool table, curve;
    bis_table_kind table_kind;
    double area_exponent; /* b of thesis 3.4, in [0, BIS_AREA_EXPONENT_MAX]; 0: no components are built */
    int levels;           /* of thesis 3.4 */
    bool compensate;      /* MIS compensation (Karlik et al. 2019), for mis only: w = max(0, I - mean I) */
    unsigned as_printed;  /* BIS_E3, BIS_E13, BIS_E20: wrong on purpose */
} bis_importance_options;

typedef struct bis_importance bis_importance;

/* Bytes that drawing takes, as bis_importance_new promises and `bis --plan` foretells. A tile of the curve is 4 x 4
 * pixels, in maps below 2^16 pixels one. */
enum {
    BIS_DRAWING_BYTES = 16,       /* a pixel, with one way of drawing, at most, also while it is built */
    BIS_TABLE_BYTES = 8 + 2,      /* a pixel, alias tables: a probability and an alias; CDFs: 8 and their guides */
    BIS_CURVE_BYTES = 4 + 16 + 4, /* a tile: its place, the sum before it and a guide */
    BIS_CURVE_SUM_BYTES = 16,     /* a tile while the curve is made: its own sum */
    BIS_AREA_BYTES = 4            /* a pixel, if b > 0: its area factor */
};

/* bis_importance_new builds what options ask for. em is borrowed for the life of the result. A map without light is
 * legal: nothing can then be drawn. With one way of drawing, the result takes at most BIS_DRAWING_BYTES a pixel; the
 * curve of a map below 2^16 pixels takes more, because there each pixel is a tile. Errors: BIS_NOMEM. */
bis_status bis_importance_new(bis_importance **out, const bis_envmap *em, const bis_importance_options *options,
                              bis_diag *diag);

/* bis_importance_free frees im; NULL is allowed. */
void bis_importance_free(bis_importance *im);

/* A direction that was drawn from the map. */
typedef struct bis_map_sample {
    size_t pixel; /* y * width + x */
    vec3 w_local;
    double pdf; /* 1/sr, > 0 */
} bis_map_sample;

/* bis_importance_sample draws a direction by the table. u[4] are uniform in [0,1) and independent: u[0] selects the
 * row, u[1] the pixel, u[2] and u[3] the place in the pixel. With CDFs, the remainders of u[0] and u[1] give the
 * place, and u[2] and u[3] are not used. Returns false if there is no light; nothing is then drawn. Needs
 * options.table. */
bool bis_importance_sample(const bis_importance *im, const double u[4], bis_map_sample *s);

/* bis_importance_sample_curve draws the direction at position t of the curve. t is uniform in [0,1); u[2], uniform in
 * [0,1)^2, selects the place in the pixel. The position is monotone in t: equal steps of t are equal shares of the
 * importance. Returns false if there is no light. Needs options.curve. */
bool bis_importance_sample_curve(const bis_importance *im, double t, const double u[2], bis_map_sample *s);

/* bis_importance_pdf_pixel returns the density in 1/sr inside pixel (y * width + x). It is 0 where the importance is
 * 0. */
double bis_importance_pdf_pixel(const bis_importance *im, size_t pixel);

/* bis_importance_pdf returns the density in 1/sr at the unit direction w_local of the light's frame. */
double bis_importance_pdf(const bis_importance *im, vec3 w_local);

/* A tile of the curve: pixels that it visits one after the other. */
typedef struct bis_curve_tile {
    uint32_t tile;      /* column + across * row of it among the tiles of the map */
    double end;         /* the share of the importance that lies before the tile's end */
    double solid_angle; /* of its pixels */
} bis_curve_tile;

/* bis_importance_n_tiles returns the number of tiles, and stores the pixels along a tile's side. Needs options.curve
 * and a map with light. */
size_t bis_importance_n_tiles(const bis_importance *im, uint32_t *side);

/* bis_importance_tile returns the i-th tile of the curve. */
bis_curve_tile bis_importance_tile(const bis_importance *im, size_t i);

/* bis_importance_in_tile returns which share of the importance of the tile at position t of the curve lies before t, in
 * [0,1). t is in [0,1). Needs options.curve and a map with light. */
double bis_importance_in_tile(const bis_importance *im, double t);

/* bis_importance_measured stores what bis_envmap_measure found when im was made. A light needs the same numbers, and a
 * pass over a large map takes a tenth of a second. */
void bis_importance_measured(const bis_importance *im, double *power, double *most);

/* bis_importance_max_ratio returns the largest I/pdf over all lit pixels, I = r+g+b. It is the sum times the maximum
 * of I/w. Rejection from the map uses it as its bound (E27). Returns INFINITY with options.compensate. */
double bis_importance_max_ratio(const bis_importance *im);

/* bis_importance_bytes returns the bytes that im takes, without em. */
size_t bis_importance_bytes(const bis_importance *im);

/* bis_importance_implied_pmf computes the probabilities pmf[height * width] that the table really gives to the
 * pixels: from the implied pmf of the alias tables, or from the steps of the CDFs. For tests and verification. Needs
 * options.table. Errors: BIS_NOMEM. */
bis_status bis_importance_implied_pmf(const bis_importance *im, double *pmf, bis_diag *diag);
