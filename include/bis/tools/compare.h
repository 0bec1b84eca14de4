/* SPDX-License-Identifier: BSD-2-Clause */
/* compare: how far one image is from another (docs/command-line.md, "bis compare"). Image b is the reference. */
#pragma once

#include "bis/base/image.h"

typedef struct bis_comparison {
    double mean_a, mean_b;  /* means over pixels and channels */
    double bias, bias_se;   /* mean_a - mean_b; standard deviation of the per-pixel differences / sqrt(pixels) */
    double rmse, relmse;    /* relmse: the mean of (a-b)^2 / (b^2 + m^2/100), m = mean_b */
    double max_abs;
    size_t pixels;          /* pixels that were compared */
    size_t nonfinite;       /* pixels that are left out, because a channel of either image is NaN or infinite */
} bis_comparison;

/* bis_compare compares image a with the reference b. Errors: BIS_INPUT (the sizes differ). */
bis_status bis_compare(bis_comparison *c, const bis_image *a, const bis_image *b, bis_diag *diag);

/* bis_compare_picture makes a false-colour picture of |a-b| relative to sqrt(b^2 + m^2/100): black, blue, red,
 * yellow, white on a logarithmic scale from 1e-3 to 10. Pixels that are not finite are magenta. Errors: BIS_INPUT
 * (the sizes differ), BIS_NOMEM. */
bis_status bis_compare_picture(bis_image *out, const bis_image *a, const bis_image *b, bis_diag *diag);
