/* film_error: what the passes of a film say about its error.
 *
 * The error is the relative RMSE of docs/budgets.md, "Error": the root of the mean, over pixels and channels, of
 * (a-b)^2 / (b^2 + m^2/100). a is the picture, b the truth, m the mean of b. The variance of each pixel's mean stands
 * in for (a-b)^2, and the picture itself for b.
 *
 * The variance. If passes were independent, their scatter would tell it (eq. 3.9; docs/errata.md E32). They are not: a
 * sequence spreads the camera samples of a pixel over its area, so each pass fills gaps that earlier ones left, and the
 * scatter is too large, at edges twofold and more. What the strata gain is measured, too. Let A and B be the means of
 * the two halves of a pixel's samples. Both have the variance V(n/2), because a scrambled sequence treats its two halves
 * alike, and their mean has V(n) = (V(n/2) + cov(A, B))/2. Therefore
 *     E (A - B)^2 / 4 = (V(n/2) - cov(A, B))/2 = V(n/2) - V(n).
 * If V(n) falls as n^-p, the difference of the halves tells V(n) = E (A - B)^2 / 4 / (2^p - 1). p is 1 for independent
 * samples and 3/2 for an edge through the pixel (Owen 1997); a picture has both. Over 12 scenes the last doubling of 4
 * to 32 samples had p between 1.08 and 1.53, 1.3 in the middle: with that the figure is 10 % too high at most, and 17 %
 * too low if all is noise. Therefore p is only believed to be above 1 as far as the picture proves it: by the ratio of
 * the difference of the halves to the scatter of the passes, the smallest blocks that a film knows, whose expectation
 * is 1 for independent samples and falls with p. The ratio is taken with its standard error added, which is that of the
 * pixels as a sample. So noise alone is judged as if its passes were independent. (The scatter of the passes says too
 * much of p: the first samples mirror each other, which removes a slope at once, and never again.) n need not be a power
 * of two: the first "half" is then the part up to the last doubling (see `expected`).
 *
 * The truth. In place of b^2 stand two: mean^2, which holds the variance as well, so that a lone bright sample hides
 * behind its own brightness (scene.txt at 4 passes: estimate 0.35, truth 0.70); and mean^2 less the variance, right in
 * expectation, but 0 just there, as if the pixel were black. Their geometric mean serves both: noise that is small
 * beside the mean does not see it.
 *
 * No estimate knows of lights that no pass has found yet. */
#include "bis/render/film.h"

#include <assert.h>
#include <math.h>

/* The variance of the mean of value i if the n > 1 passes are independent (eq. 3.9). A pass of weight w is the mean of w
 * camera samples: its variance is v/w, sum w (L - mean)^2 over n - 1 estimates v, and the mean over a weight W has the
 * variance v/W. */
double bis_film_variance(const bis_film *f, size_t i)
{
    const double deviation = (double)f->deviation[i];
    return deviation * deviation / (f->passes - 1.0);
}

/* The same variance by the difference of A, the mean of the first passes of weight P, and B, the mean of the rest:
 * (A - B)^2 P (W - P) / W^2, where A - B = (A - mean) W / (W - P). */
static double half_variance(const bis_film *f, size_t i)
{
    const double P = f->half_weight, d = (double)f->half[i] - f->sum[i] / f->weight;
    return d * d * (P / (f->weight - P));
}

/* A pixel's expected (a-b)^2 / (b^2 + m^2/100), the mean over its channels, twice. */
typedef struct pixel_error {
    double passes; /* by the scatter of the passes */
    double halves; /* by the difference of the halves */
} pixel_error;

static pixel_error error_of_pixel(const bis_film *f, size_t i, double floor)
{
    pixel_error e = {0};

    for (size_t k = 3 * i; k < 3 * i + 3; k++) {
        const double mean = f->sum[k] / f->weight, variance = bis_film_variance(f, k);
        /* Where estimates are not negative, variance <= mean^2. A control variate may leave some that are. */
        const double square = mean * mean, less = fmax(0, square - variance);
        const double scale = sqrt(square + floor) * sqrt(less + floor); /* the product of the squares may underflow */
        e.passes += variance / scale;
        e.halves += half_variance(f, k) / scale;
    }
    return (pixel_error){e.passes / 3, e.halves / 3};
}

/* m^2/100 of relMSE, m the mean of the picture; 0 where it is black. */
static double floor_of(const bis_film *f)
{
    const size_t n = (size_t)f->width * (size_t)f->height;
    double mean = 0;

    for (size_t i = 0; i < 3 * n; i++) mean += f->sum[i];
    mean /= 3 * (double)n * f->weight;
    return mean * mean / 100;
}

void bis_film_tile_errors(const bis_film *f, int tile, double *errors)
{
    int across;
    const int n = bis_film_tiles(f, tile, &across);
    const double floor = floor_of(f);

    assert(f->passes > 1);
#pragma omp parallel for schedule(dynamic)
    for (int t = 0; t < n; t++) {
        const bis_rect r = bis_film_tile_of_crop(f, tile, t);
        errors[t] = 0;
        for (int y = r.y0; floor > 0 && y < r.y1; y++)
            for (int x = r.x0; x < r.x1; x++) {
                const size_t i = (size_t)(y - f->y0) * (size_t)f->width + (size_t)(x - f->x0);
                errors[t] += error_of_pixel(f, i, floor).passes;
            }
    }
}

/* ---- what strata gain ---- */

static const double most_p = 1.3;

typedef struct model {
    double ratio; /* of the two variances, halves over passes, in expectation */
    double rest;  /* V(W) over the variance by the halves */
} model;

/* What is expected if the mean over a block of n camera samples has the variance n^-p. W samples are a block of P and
 * one of m = W - P <= P, which lies in the block that follows the first. Their covariance is that of the two halves of
 * 2P samples, (2^(1-p) - 1) P^-p, because a scrambled sequence treats all parts of a half alike. A pass counts as a
 * block of W/passes, the mean size. All is in units of P^-p. p = 1 gives 1 and 1. */
static model expected(const bis_film *f, double p)
{
    const double P = f->half_weight, W = f->weight, m = W - P, of_rest = pow(m / P, -p), cov = exp2(1 - p) - 1;
    const double whole = (P * P + 2 * P * m * cov + m * m * of_rest) / (W * W);
    const double passes = (pow(W / f->passes / P, -p) - whole) / (f->passes - 1.0);
    const double halves = (1 + of_rest - 2 * cov) * P * m / (W * W);

    return (model){halves / passes, whole / halves};
}

/* The mean variance, with `passes` and `halves` by the two ways, if their ratio is judged to be `ratio`: p by bisection.
 * If the rest m is small beside the passes, the ratio does not fall with p and says nothing: then nothing is gained. */
static double judged(const bis_film *f, double passes, double halves, double ratio)
{
    double lo = 1, hi = most_p;

    if (f->passes < 3 || ratio >= 1 || expected(f, hi).ratio >= 1) return passes;
    if (ratio <= expected(f, hi).ratio) lo = hi;
    for (int i = 0; i < 50 && lo < hi; i++) {
        const double p = 0.5 * (lo + hi);
        if (expected(f, p).ratio > ratio) lo = p;
        else hi = p;
    }
    return halves * expected(f, lo).rest;
}

/* ---- the figure ---- */

/* Sums over pixels of their pixel_error. */
typedef struct sums {
    double passes, halves, passes_squared, halves_squared, product;
} sums;

/* Threads find the terms, which are added in the order of the pixels: any number of threads gives the same bits. */
static sums sums_over(const bis_film *f, double floor)
{
    enum { BLOCK = 1024 };
    const size_t n = (size_t)f->width * (size_t)f->height;
    sums s = {0};

#pragma omp parallel for ordered schedule(dynamic)
    for (size_t first = 0; first < n; first += BLOCK) {
        const size_t end = first + BLOCK < n ? first + BLOCK : n;
        pixel_error e[BLOCK];
        for (size_t i = first; i < end; i++) e[i - first] = error_of_pixel(f, i, floor);
#pragma omp ordered
        for (size_t i = 0; i < end - first; i++) {
            s.passes += e[i].passes;
            s.halves += e[i].halves;
            s.passes_squared += e[i].passes * e[i].passes;
            s.halves_squared += e[i].halves * e[i].halves;
            s.product += e[i].passes * e[i].halves;
        }
    }
    return s;
}

/* The standard error of the ratio r = sum halves / sum passes: sqrt(sum (halves - r passes)^2) / sum passes (Cochran
 * 1977, section 6.4). */
static double ratio_error(const sums *s)
{
    const double r = s->halves / s->passes;
    const double residuals = s->halves_squared - 2 * r * s->product + r * r * s->passes_squared;
    return sqrt(fmax(0, residuals)) / s->passes; /* fmax: rounding */
}

/* Let X_i be the error of pixel i, R the mean of X over the P pixels: the estimate of relMSE. Pixels have independent
 * random numbers, so two things part R from the error that this very picture has:
 * - R is itself an estimate: var(R) <= sum (X_i - R)^2 / P^2, since the scatter over pixels holds that of their true
 *   variances, too;
 * - the error is one draw: a pixel's squared error of expectation X_i has variance 2 X_i^2 (normal, its channels
 *   alike), that of their mean 2 sum X_i^2 / P^2.
 * The bound is R, with more doubt of what strata gain, plus 1.645 (the 95% point of a normal) times the root of the sum. But with few samples R is too low
 * where noise is skewed: pixels whose mean came out low show little scatter, and are weighed most. The loss falls with
 * 1/n; R (1 + 1.5/n) made good for it with exponential noise of 40% on every third pixel: true errors above the bound
 * in 2.6, 3.3, 2.8% of 2000 renders at 4, 16, 64 passes, without it in 16% at 4 (tests/render/test_film_error.c).
 *
 * If the root is more than R/2, the error of this picture is within a quarter of the figure in two of three renders at
 * best. Few pixels then carry most of R, and in pictures of this kind R itself is often wrong: the figure is unknown. */
bis_film_error bis_film_estimate_error(const bis_film *f)
{
    const double n = (double)f->width * f->height, nan = (double)NAN, normal_95 = 1.645, skew = 1.5, most_doubt = 0.5;

    if (f->passes < 2) return (bis_film_error){nan, nan, 1, false};
    const double floor = floor_of(f);
    if (floor == 0) return (bis_film_error){0, 0, 1, true}; /* black, hence without scatter */
    const sums s = sums_over(f, floor);
    if (s.passes == 0) return (bis_film_error){0, 0, 1, true};
    const double ratio = s.halves / s.passes, error = ratio_error(&s);
    const double R = judged(f, s.passes, s.halves, ratio + error) / n;
    const double most = judged(f, s.passes, s.halves, ratio + (1 + normal_95) * error) / n;
    const double scatter = fmax(0, s.passes_squared - s.passes * s.passes / n); /* fmax: rounding */
    const double doubt = sqrt(scatter + 2 * s.passes_squared) / s.passes;
    return (bis_film_error){.relative_rmse = sqrt(R),
                            .upper = sqrt(most * (1 + skew / f->weight + normal_95 * doubt)),
                            .gain = R * n / s.passes,
                            .is_known = doubt <= most_doubt};
}
