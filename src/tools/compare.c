/* SPDX-License-Identifier: BSD-2-Clause */
/* compare: figures that say how far image a is from reference b: `bis compare --help`.
 *
 * relMSE divides each squared difference by b^2 + m^2/100, m the reference's mean: dark and bright pixels weigh alike,
 * black ones do not divide by zero (a tenth of the mean is where "dark" ends). A pixel with a NaN or infinity in either
 * image is counted and left out of everything else. Two passes over the pixels, sums in double. */
#include "bis/tools/compare.h"

static bis_status same_size(const bis_image *a, const bis_image *b, bis_diag *diag)
{
    if (a->width == b->width && a->height == b->height) return BIS_OK;
    return bis_error(diag, BIS_INPUT, (bis_loc){0},
                     "images of %d x %d and %d x %d pixels cannot be compared; sizes must be equal", a->width,
                     a->height, b->width, b->height);
}

static size_t count_pixels(const bis_image *a) { return (size_t)a->width * (size_t)a->height; }

static bool comparable(const bis_image *a, const bis_image *b, size_t i)
{
    return rgb_is_finite(a->pixels[i]) && rgb_is_finite(b->pixels[i]);
}

static void channels(rgb c, double out[3])
{
    out[0] = (double)c.r;
    out[1] = (double)c.g;
    out[2] = (double)c.b;
}

/* Means over pixels and channels, NaN where no pixel can be compared; returns the number of pixels that can. */
static size_t find_means(const bis_image *a, const bis_image *b, double *mean_a, double *mean_b)
{
    double sum_a = 0, sum_b = 0;
    size_t n = 0;

    for (size_t i = 0; i < count_pixels(a); i++) {
        if (!comparable(a, b, i)) continue;
        sum_a += rgb_sum(a->pixels[i]);
        sum_b += rgb_sum(b->pixels[i]);
        n++;
    }
    *mean_a = n ? sum_a / (3 * (double)n) : (double)NAN;
    *mean_b = n ? sum_b / (3 * (double)n) : (double)NAN;
    return n;
}

/* Mean over channels of (a-b)^2 / (b^2 + m^2/100). Equal values differ by 0 even where b = m = 0; others are then
 * infinitely far. */
static double relative_square(rgb a, rgb b, double m)
{
    double va[3], vb[3], total = 0;

    channels(a, va);
    channels(b, vb);
    for (int k = 0; k < 3; k++) {
        double d = va[k] - vb[k], scale = vb[k] * vb[k] + m * m / 100;
        if (d != 0) total += scale > 0 ? d * d / scale : (double)INFINITY;
    }
    return total / 3;
}

bis_status bis_compare(bis_comparison *c, const bis_image *a, const bis_image *b, bis_diag *diag)
{
    *c = (bis_comparison){0};
    bis_status status = same_size(a, b, diag);
    if (status) return status;

    c->pixels = find_means(a, b, &c->mean_a, &c->mean_b);
    c->nonfinite = count_pixels(a) - c->pixels;
    c->bias = c->mean_a - c->mean_b;

    double squares = 0, relative = 0, scatter = 0, n = (double)c->pixels;
    for (size_t i = 0; i < count_pixels(a); i++) {
        double va[3], vb[3], difference = 0;
        if (!comparable(a, b, i)) continue;
        channels(a->pixels[i], va);
        channels(b->pixels[i], vb);
        for (int k = 0; k < 3; k++) {
            double d = va[k] - vb[k];
            squares += d * d;
            difference += d / 3;
            c->max_abs = fmax(c->max_abs, fabs(d));
        }
        scatter += (difference - c->bias) * (difference - c->bias);
        relative += relative_square(a->pixels[i], b->pixels[i], c->mean_b);
    }
    /* No pixel at all is no agreement: NaN. One pixel has no scatter. */
    c->rmse = n > 0 ? sqrt(squares / (3 * n)) : (double)NAN;
    c->relmse = n > 0 ? relative / n : (double)NAN;
    c->bias_se = n > 1 ? sqrt(scatter / (n - 1) / n) : (double)NAN;
    if (c->pixels == 0) c->max_abs = (double)NAN;
    return BIS_OK;
}

/* [0,1] to black, blue, red, yellow, white. */
static rgb false_colour(double t)
{
    static const rgb stops[5] = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {1, 1, 0}, {1, 1, 1}};
    double place = 4 * fmin(fmax(t, 0), 1); /* what is off the scale has the scale's end */
    int i = place < 4 ? (int)place : 3;
    return rgb_add(rgb_scale(stops[i], i + 1 - place), rgb_scale(stops[i + 1], place - i));
}

bis_status bis_compare_picture(bis_image *out, const bis_image *a, const bis_image *b, bis_diag *diag)
{
    double mean_a, mean_b;
    const double log_lo = log(1e-3), log_hi = log(10);
    const rgb magenta = {1, 0, 1}; /* not finite: a colour that the scale has not */

    *out = (bis_image){0};
    bis_status status = same_size(a, b, diag);
    if (status) return status;
    status = bis_image_init(out, a->width, a->height, diag);
    if (status) return status;
    find_means(a, b, &mean_a, &mean_b);
    for (size_t i = 0; i < count_pixels(a); i++) {
        double error = comparable(a, b, i) ? sqrt(relative_square(a->pixels[i], b->pixels[i], mean_b)) : (double)NAN;
        double t = error > 0 ? (log(error) - log_lo) / (log_hi - log_lo) : 0;
        out->pixels[i] = isnan(error) ? magenta : false_colour(t);
    }
    return BIS_OK;
}
