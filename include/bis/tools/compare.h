/* compare: how far is one image from another (SPEC 5, `bis compare`), b being the reference. */
#ifndef BIS_COMPARE_H
#define BIS_COMPARE_H

#include "bis/base/image.h"

typedef struct bis_comparison {
    double mean_a, mean_b;  /* over pixels and channels */
    double bias, bias_se;   /* mean_a - mean_b; standard deviation of the per-pixel differences / sqrt(pixels) */
    double rmse, relmse;    /* relmse: mean of (a-b)^2 / (b^2 + m^2/100), m = mean_b */
    double max_abs;
    size_t pixels;          /* that were compared */
    size_t nonfinite;       /* pixels with a NaN or infinity in either, left out */
} bis_comparison;

/* Errors: BIS_INPUT: other sizes. */
bis_status bis_compare(bis_comparison *c, const bis_image *a, const bis_image *b, bis_diag *diag);

/* A false-colour picture of |a-b| relative to sqrt(b^2 + m^2/100): black, blue, red, yellow, white on a logarithmic
 * scale from 1e-3 to 10. */
bis_status bis_compare_picture(bis_image *out, const bis_image *a, const bis_image *b, bis_diag *diag);

#endif
