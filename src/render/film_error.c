/* film_error: what the passes of a film say about its error.
 *
 * The error is the relative RMSE of docs/budgets.md, "Error": the root of the mean, over pixels and channels, of
 * (a-b)^2 / (b^2 + m^2/100). a is the picture, b the truth, m the mean of b. The variance of each pixel's mean stands
 * in for (a-b)^2, and the picture itself for b.
 *
 * The variance. If the camera samples of a pixel are independent, the scatter of the passes tells it (eq. 3.9;
 * docs/errata.md E32). Otherwise a sequence spreads them over the pixel: each pass fills gaps that earlier ones left,
 * and the scatter is too large, at edges twofold and more. Let A and B be the means of the two halves of a pixel's
 * samples. Both have the variance V(n/2), because a scrambled sequence treats its two halves alike, and their mean
 * has V(n) = (V(n/2) + cov(A, B))/2. Therefore
 *     E (A - B)^2 / 4 = (V(n/2) - cov(A, B))/2 = V(n/2) - V(n).
 * (The same holds for one sample in each of n cells whose halves interleave as sampler.c has it: V(n/2) is then that
 * of one sample in each pair of cells.) If V(n) falls as n^-p, this is (2^p - 1) V(n). p is 1 where all is noise, and
 * 3/2 for an edge through the pixel (Owen 1997); a picture has both, and its p hardly shows in few samples. With
 * p = 5/4 the figure of two equal halves is right within 16 % for all p between: sqrt((2^1 - 1)/(2^1.25 - 1)) = 0.85,
 * sqrt((2^1.5 - 1)/(2^1.25 - 1)) = 1.15. Patterns that a pixel averages may have a larger p: the figure is then too
 * large. n need not be a power of two: where the end is known, the film chooses a half of a third to two thirds (see
 * expect).
 *
 * The truth. In place of b^2 stand two: mean^2, which holds the variance as well, so that a lone bright sample hides
 * behind its own brightness (scene.txt at 4 passes: estimate 0.35, truth 0.70); and mean^2 less the variance, right
 * in expectation, but 0 just there, as if the pixel were black. Their geometric mean serves both: noise that is small
 * beside the mean does not see it.
 *
 * No estimate knows of lights that no pass has found yet. */
#include "bis/render/film.h"

#include <assert.h>
#include <math.h>

static const double normal_95 = 1.645; /* the 95% point of a normal */

/* The variance of the mean of value i if the n > 1 passes are independent (eq. 3.9). A pass of weight w is the mean
 * of w camera samples: its variance is v/w, sum w (L - mean)^2 over n - 1 estimates v, and the mean over a weight W
 * has the variance v/W. */
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

/* What is expected if the mean over a block of n camera samples has the variance n^-p, p = 5/4. With independent
 * samples, p = 1, both are 1. */
typedef struct expected {
    double left;  /* in the mean of all, of the variance by the halves; 1/(2^p - 1) if the halves have equal sizes */
    double ratio; /* of the variance by the halves to that by the passes */
} expected;

/* W samples are a block of P and m = W - P others, about as many. Those of them that lie in the block of P that
 * follows have with the first the covariance of the two halves of 2P samples, (2^(1-p) - 1) P^-p, because a scrambled
 * sequence treats all parts of a half alike; later ones that of the halves of 4P, 2^-p times as much. A pass counts as
 * a block of W/passes, the mean size. All is divided by P^-p, the variance of the first block. */
static expected expect(const bis_film *f)
{
    const double p = 1.25, P = f->half_weight, W = f->weight, m = W - P;
    const double of_rest = pow(m / P, -p), of_pass = pow(W / f->passes / P, -p), next = fmin(m, P);
    const double cov = (exp2(1 - p) - 1) * (next + (m - next) * exp2(-p)) / m;
    const double whole = (P * P + 2 * P * m * cov + m * m * of_rest) / (W * W);
    const double halves = (1 + of_rest - 2 * cov) * P * m / (W * W), passes = (of_pass - whole) / (f->passes - 1.0);

    return f->independent ? (expected){1, 1} : (expected){whole / halves, halves / passes};
}

/* A pixel's expected (a-b)^2 / (b^2 + m^2/100), the mean over its channels: with the variance by the passes, and with
 * the one that stands for it. */
typedef struct pixel_error {
    double passes, best;
} pixel_error;

static pixel_error error_of_pixel(const bis_film *f, size_t i, double floor, double left)
{
    pixel_error e = {0};

    for (size_t k = 3 * i; k < 3 * i + 3; k++) {
        const double mean = f->sum[k] / f->weight, variance = bis_film_variance(f, k);
        /* Where estimates are not negative, variance <= mean^2. A control variate may leave some that are. */
        const double square = mean * mean, less = fmax(0, square - variance);
        const double scale = sqrt(square + floor) * sqrt(less + floor); /* the product of the squares may underflow */
        e.passes += variance / scale;
        e.best += (f->independent ? variance : half_variance(f, k) * left) / scale;
    }
    return (pixel_error){e.passes / 3, e.best / 3};
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
                errors[t] += error_of_pixel(f, i, floor, 1).passes;
            }
    }
}

/* Sums over pixels of their pixel_error. */
typedef struct sums {
    double passes, passes_squared, best, best_squared, product;
} sums;

/* Threads find the terms, which are added in the order of the pixels: any number of threads gives the same bits. */
static sums sums_over(const bis_film *f, double floor, double left)
{
    enum { BLOCK = 1024 };
    const size_t n = (size_t)f->width * (size_t)f->height;
    sums s = {0};

#pragma omp parallel for ordered schedule(dynamic)
    for (size_t first = 0; first < n; first += BLOCK) {
        const size_t end = first + BLOCK < n ? first + BLOCK : n;
        pixel_error e[BLOCK];
        for (size_t i = first; i < end; i++) e[i - first] = error_of_pixel(f, i, floor, left);
#pragma omp ordered
        for (size_t i = 0; i < end - first; i++) {
            s.passes += e[i].passes;
            s.passes_squared += e[i].passes * e[i].passes;
            s.best += e[i].best;
            s.best_squared += e[i].best * e[i].best;
            s.product += e[i].passes * e[i].best;
        }
    }
    return s;
}

/* How much of the gain from p = 1 to 5/4 the picture proves, from 0 to 1. The ratio of the variance by the halves to
 * that by the passes falls from 1 to what is expected. Its upper 95% bound counts; the standard error of a ratio of
 * sums is sqrt(sum (best - r passes)^2) / sum passes (Cochran 1977, section 6.4). */
static double proven(const sums *s, expected e)
{
    const double r = s->best / s->passes, residuals = s->best_squared - 2 * r * s->product + r * r * s->passes_squared;
    const double most = (r + normal_95 * sqrt(fmax(0, residuals)) / s->passes) / e.left; /* fmax: rounding */

    return e.ratio < 1 ? fmax(0, fmin(1, (1 - most) / (1 - e.ratio))) : 0;
}

/* Let X_i be the error of pixel i, R the mean of X over the P pixels: the estimate of relMSE. Pixels have independent
 * random numbers, so two things part R from the error that this very picture has:
 * - R is itself an estimate: var(R) <= sum (X_i - R)^2 / P^2, since the scatter over pixels holds that of their true
 *   variances, too;
 * - the error is one draw: a pixel's squared error of expectation Y_i has variance 2 Y_i^2 (normal, its channels
 *   alike), that of their mean 2 sum Y_i^2 / P^2. Y is the error by the passes, scaled to the mean R: it has more
 *   degrees of freedom than the difference of two halves.
 *
 * The bound is R, without the part of what strata gain that the picture does not prove, plus 1.645 times the root of
 * the sum. But with few samples R is too low where noise is skewed: pixels whose mean came out low show little scatter,
 * and are weighed most. The loss falls with 1/n; R (1 + 1.5/n) made good for it with exponential noise of 40% on every
 * third pixel: true errors above the bound in 2.6, 3.3, 2.8% of 2000 renders at 4, 16, 64 passes, without it in 16% at
 * 4 (tests/render/test_film.c).
 *
 * If the root is more than R/2, the error of this picture is within a quarter of the figure in two of three renders
 * at best. Few pixels then carry most of R, and in pictures of this kind R itself is often wrong: the figure is
 * unknown. */
bis_film_error bis_film_estimate_error(const bis_film *f)
{
    const double n = (double)f->width * f->height, nan = (double)NAN, skew = 1.5, most_doubt = 0.5;

    if (f->passes < 2) return (bis_film_error){nan, nan, false};
    const double floor = floor_of(f);
    if (floor == 0) return (bis_film_error){0, 0, true}; /* black, hence without scatter */
    const expected e = expect(f);
    const sums s = sums_over(f, floor, e.left);
    if (s.passes == 0 || s.best == 0) return (bis_film_error){0, 0, true};
    const double R = s.best / n, scatter = fmax(0, s.best_squared / (s.best * s.best) - 1 / n); /* fmax: rounding */
    const double draw = 2 * s.passes_squared / (s.passes * s.passes), doubt = sqrt(scatter + draw);
    const double most = R * (1 + (1 - proven(&s, e)) * (1 / e.left - 1));
    return (bis_film_error){.relative_rmse = sqrt(R),
                            .upper = sqrt(most * (1 + skew / f->weight + normal_95 * doubt)),
                            .is_known = doubt <= most_doubt};
}
