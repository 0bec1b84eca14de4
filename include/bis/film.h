/* film: the sums behind the pixels. A pass adds one camera sample to every pixel; the picture is the mean over the passes. */
#ifndef BIS_FILM_H
#define BIS_FILM_H

#include "bis/image.h"
#include "bis/status.h"
#include "bis/vec.h"

#include <stdint.h>

/* [x0, x1) x [y0, y1) of the full image. */
typedef struct bis_film {
    int full_width, full_height;
    int x0, y0, width, height; /* the crop */
    double *sum;               /* sum[height][width][3] of radiance over passes */
    double *sum_squares;       /* the same of the squares: the error estimate */
    uint32_t *hits;            /* hits[height][width]: camera samples that hit geometry */
    uint32_t passes;           /* complete passes; all pixels have as many samples */
} bis_film;

/* crop[4] = x0, x1, y0, y1 in [0,1] (pbrt's rounding: ceil(full * x)). Errors: BIS_INPUT (empty crop), BIS_NOMEM. */
bis_status bis_film_init(bis_film *f, int full_width, int full_height, const double crop[4], bis_loc at, bis_diag *diag);
void bis_film_clear(bis_film *f);

/* One camera sample; each pixel belongs to one thread at a time. L must be finite. */
void bis_film_add(bis_film *f, int x, int y, rgb L, bool hit);

/* rgba[height][width][4]: means, and the share of samples that hit. */
void bis_film_resolve(const bis_film *f, float *rgba);

/* Estimated relative RMSE of the picture, sqrt(relMSE) of SPEC 5 with the picture's own pixels in place of the reference, from the scatter of the passes
 * (docs/errata.md E32); *upper (may be NULL): an upper 95% bound of it. NAN with fewer than 2 passes. The scatter overestimates the error of stratified and low-discrepancy passes. */
double bis_film_relative_rmse(const bis_film *f, double *upper);
size_t bis_film_bytes(const bis_film *f);

#endif
