/* importance: drawing directions from an environment map, thesis 3.3 and figure 3.5.
 *
 * The importance of a pixel per steradian is its weight w = intensity (r+g+b), times the area factor of its component
 * (3.4) where b > 0;
 * a pixel is drawn with probability P = w * solid angle / sum (docs/errata.md E3), a direction inside it uniformly: the
 * density is w/sum, exactly, whatever b is, and every estimator divides by this density (E20).
 *
 * Two ways of drawing, each built only when asked for:
 * - table: the thesis's two passes (a row, then a pixel in it), by alias tables (O(1)) or by CDFs (keeps
 * stratification);
 * - curve: one CDF over the lit pixels in the order of a space-filling curve, which lets one stratified number fill the
 * map evenly. */
#ifndef BIS_IMPORTANCE_H
#define BIS_IMPORTANCE_H

#include "bis/thesis/envmap.h"
#include "bis/thesis/errata.h"

#include <stdbool.h>

typedef enum bis_table_kind { BIS_TABLE_ALIAS, BIS_TABLE_CDF } bis_table_kind;

/* What to build. */
/* The largest b that a scene or an option may give. At 10 a region of a thousandth of the clamp of 0.01 sr keeps
 * 1e-30 of its importance: more b changes no picture, and would only lead to the end of the doubles. */
#define BIS_AREA_EXPONENT_MAX 10.0

typedef struct bis_importance_options {
    bool table, curve;
    bis_table_kind table_kind;
    double area_exponent; /* b of 3.4, in [0, BIS_AREA_EXPONENT_MAX]; 0: no components are built */
    int levels;           /* of 3.4 */
    bool compensate;      /* MIS compensation (Karlik et al. 2019): w = max(0, I - mean I), for mis alone */
    unsigned as_printed;  /* BIS_E3, BIS_E13, BIS_E20: wrong on purpose */
} bis_importance_options;

typedef struct bis_importance bis_importance;

/* em is borrowed for the life of the result. A map without light is legal: total is 0 and nothing can be drawn.
 * Resident memory at most 16 bytes a pixel with one way of drawing, peak while building at most 40. Errors:
 * BIS_NOMEM. */
bis_status bis_importance_new(bis_importance **out, const bis_envmap *em, const bis_importance_options *options, bis_diag *diag);
void bis_importance_free(bis_importance *im);

/* A direction drawn from the map. */
typedef struct bis_map_sample {
    size_t pixel; /* y * width + x */
    vec3 w_local;
    double pdf; /* 1/sr, > 0 */
} bis_map_sample;

/* u[0] picks the row, u[1] the pixel, u[2], u[3] the place in it (with CDFs u[0] and u[1] do that too, by their
 * remainders, and u[2], u[3] are not used). All uniform in [0,1), independent. False: no light, nothing drawn. Needs
 * table. */
bool bis_importance_sample(const bis_importance *im, const double u[4], bis_map_sample *s);

/* t in [0,1): position along the curve; u[2]: the place in the pixel. Monotone: equal steps of t are equal shares of
 * the importance. Needs curve. */
bool bis_importance_sample_curve(const bis_importance *im, double t, const double u[2], bis_map_sample *s);

/* Density in 1/sr of pixel (y * width + x) or of a direction; 0 where the map is black. */
double bis_importance_pdf_pixel(const bis_importance *im, size_t pixel);
double bis_importance_pdf(const bis_importance *im, vec3 w_local);

/* Cut the curve into pieces: runs of tiles, side x side pixels each, that end when they hold 1/K of the importance or
 * of the sphere. n pieces, each with some importance, at most 2 K + 2 <= 65535; piece k is [t[k], t[k+1]) of the curve;
 * of_tile[rows][columns] tells the piece of each tile of the map. t and of_tile are the caller's (bis_free). Needs
 * curve, and light. Errors: BIS_NOMEM, without a message. */
bis_status bis_importance_cut(const bis_importance *im, uint32_t K, uint32_t *n, double **t, uint16_t **of_tile, uint32_t *side);

/* The largest I/pdf over lit pixels, I = r+g+b (the bound of rejection from the map, E27): sum * max(I/w). INFINITY
 * with compensate. */
double bis_importance_max_ratio(const bis_importance *im);

/* Bytes held (not counting em). */
size_t bis_importance_bytes(const bis_importance *im);

/* Probability of each pixel that the table really gives, pmf[height * width], from the alias tables' implied pmf or the
 * CDFs' steps. For tests and verification. Needs table. */
bis_status bis_importance_implied_pmf(const bis_importance *im, double *pmf, bis_diag *diag);

#endif
