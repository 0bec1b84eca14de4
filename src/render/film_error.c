/* SPDX-License-Identifier: BSD-2-Clause */
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
 * of one sample in each pair of cells.) Noise falls as 1/n, so its part of the difference is V(n) itself. The error at
 * an edge through the pixel falls as n^-3/2 (Owen 1997), so that its part is 2^(3/2) - 1 times V(n).
 *
 * The edges' share of the difference. A picture has both. The film keeps its mean at a quarter of the samples, too. The
 * quarters of the first half tell V(n/4) - V(n/2) in the same way, and the ratio of the two sums over the picture is 2
 * if all is noise and 2^(3/2) if all is edges. A small picture's ratio is noisy. Before it is seen, the share is taken
 * for 0.7, give or take 0.25; the ratio changes this as far as its own noise lets it (see fit). With 0.35 the ratio
 * said more than it knows: the error at edges falls by steps, because the camera's points mirror each other
 * (sampler.c). n^(3/2) V(n) of 100 000 lines at random through pixels is .087 .095 .091 .099 .107 .095 .090 for n = 4,
 * 8, ... 256, and .093 to .095 for points that are not mirrored. A model with these steps was no better, because pixels
 * on outlines have 8 samples for one of others. Smooth radiance falls faster, but soon leaves the error to edges and
 * noise: the share is never above 1.
 *
 * n need not be a power of two: where the end is known, the film chooses a half of a third to two thirds (see blocks).
 * Where it is not known (--error), the second part may be a few samples, whose difference says little. The quarters
 * then say most, and an earlier estimate remembers what the quarters of the quarters said.
 *
 * The truth. The scatter of passes is weighed by the geometric mean of two stand-ins for b^2: mean^2, which holds the
 * variance as well, so that a lone bright sample hides behind its own brightness (scene.txt at 4 passes: estimate 0.35,
 * truth 0.70); and mean^2 less the variance, right in expectation, but 0 just there, as if the pixel were black. Noise
 * that is small beside the mean does not see it. The halves are weighed by what the pixels around say, too: b is the
 * mean, drawn towards the median of 3 x 3 pixels by variance / (mean - median)^2, all the way where noise alone can
 * explain that the two differ, and hardly at an edge. Where rare samples carry the light, as in a room with a small
 * window, bright pixels then no longer hide, and the figure is 0.8 of the truth in place of 0.65.
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

/* The variance by the difference of A, the mean of samples of weight P, and B, the mean of those that follow, W in all:
 * (A - B)^2 P (W - P) / W^2, where A - B = (A - both) W / (W - P). */
static double variance_of_halves(double A, double both, double P, double W)
{
    return (A - both) * (A - both) * (P / (W - P));
}

/* What is expected of a film of W samples. */
typedef struct expected {
    double whole;  /* variance of the mean of all */
    double halves; /* of the variance by the halves */
} expected;

/* The same if the mean over a block of n camera samples has the variance n^-p. W samples are a block of P and m = W - P
 * others, about as many. Those of them that lie in the block of P that follows have with the first the covariance of
 * the two halves of 2P samples, (2^(1-p) - 1) P^-p, because a scrambled sequence treats all parts of a half alike;
 * later ones that of the halves of 4P, 2^-p times as much. */
static expected blocks(double P, double W, double p)
{
    const double m = W - P, first = pow(P, -p), rest = pow(m, -p), next = fmin(m, P);
    const double cov = (exp2(1 - p) - 1) * first * (next + (m - next) * exp2(-p)) / m;

    return (expected){.whole = (P * P * first + 2 * P * m * cov + m * m * rest) / (W * W),
                      .halves = (first + rest - 2 * cov) * P * m / (W * W)};
}

/* The same if V(n/2) - V(n) is 1 for n = unit, and edges have this share of it. */
static expected expect(double P, double W, double share, double unit)
{
    const expected noise = blocks(P, W, 1), edges = blocks(P, W, 1.5);
    const double a = (1 - share) * unit, b = share * pow(unit, 1.5) / (exp2(1.5) - 1);

    return (expected){a * noise.whole + b * edges.whole, a * noise.halves + b * edges.halves};
}

/* A pixel's expected (a-b)^2 / (b^2 + m^2/100), the mean over its channels, with one variance after another in place of
 * (a-b)^2. */
enum { QUARTERS, HALVES, PASSES, N_VARIANCES };

typedef struct pixel_error {
    double by[N_VARIANCES];
} pixel_error;

/* The median of the means of pixel i and its neighbours in channel c; beyond the border its own pixels count again. */
static double median_around(const bis_film *f, size_t i, size_t c)
{
    const int x = (int)(i % (size_t)f->width), y = (int)(i / (size_t)f->width);
    double sorted[9];
    int n = 0;

    for (int dy = -1; dy <= 1; dy++) {
        for (int dx = -1; dx <= 1; dx++, n++) {
            const int nx = x + dx < 0 ? 0 : x + dx < f->width ? x + dx : f->width - 1;
            const int ny = y + dy < 0 ? 0 : y + dy < f->height ? y + dy : f->height - 1;
            const double sum = f->sum[3 * ((size_t)ny * (size_t)f->width + (size_t)nx) + c];
            int k = n;
            for (; k > 0 && sorted[k - 1] > sum; k--) sorted[k] = sorted[k - 1];
            sorted[k] = sum;
        }
    }
    return sorted[4] / f->weight;
}

static pixel_error error_of_pixel(const bis_film *f, size_t i, double floor)
{
    pixel_error e = {0};

    for (size_t c = 0; c < 3; c++) {
        const size_t k = 3 * i + c;
        const double mean = f->sum[k] / f->weight, variance = bis_film_variance(f, k), half = (double)f->half[k];
        /* Where estimates are not negative, variance <= mean^2. A control variate may leave some that are. */
        const double square = mean * mean, less = fmax(0, square - variance);
        e.by[PASSES] += variance / (3 * sqrt(square + floor) * sqrt(less + floor)); /* a product may underflow */
        if (f->independent) continue;
        const double apart = median_around(f, i, c) - mean, noise = fmax(variance, apart * apart);
        const double truth = mean + (noise > 0 ? variance / noise * apart : 0), scale = 3 * (truth * truth + floor);
        e.by[HALVES] += variance_of_halves(half, mean, f->half_weight, f->weight) / scale;
        if (f->quarter_weight == 0) continue;
        e.by[QUARTERS] += variance_of_halves((double)f->quarter[k], half, f->quarter_weight, f->half_weight) / scale;
    }
    return e;
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

/* A sum over pixels of one of their errors, and what its own noise is. */
typedef struct total {
    double sum;
    double doubt; /* relative variance of the sum, if the samples of a pixel are normal and its channels alike */
} total;

/* An error X of a pixel with `dof` degrees of freedom has E X^2 = (1 + 2/dof) Y^2 and the variance 2 Y^2/dof, where Y
 * is its expectation. Pixels have independent random numbers, so the variance of the sum is 2/(dof + 2) times the sum
 * of X^2. Where the samples are not normal, X^2 holds more and the doubt grows, too. */
static void add_up(total t[N_VARIANCES], double dof_of_passes, const double squares[N_VARIANCES])
{
    for (int v = 0; v < N_VARIANCES; v++) {
        const double dof = v == PASSES ? dof_of_passes : 1;
        t[v].doubt = t[v].sum > 0 ? squares[v] / t[v].sum / t[v].sum * (2 / (dof + 2)) : 0;
    }
}

/* Threads find the terms, which are added in the order of the pixels: any number of threads gives the same bits. */
static void sum_over(const bis_film *f, double floor, total t[N_VARIANCES])
{
    enum { BLOCK = 1024 };
    const size_t n = (size_t)f->width * (size_t)f->height;
    double squares[N_VARIANCES] = {0};

    for (int v = 0; v < N_VARIANCES; v++) t[v] = (total){0};
#pragma omp parallel for ordered schedule(dynamic)
    for (size_t first = 0; first < n; first += BLOCK) {
        const size_t end = first + BLOCK < n ? first + BLOCK : n;
        pixel_error e[BLOCK];
        for (size_t i = first; i < end; i++) e[i - first] = error_of_pixel(f, i, floor);
#pragma omp ordered
        for (size_t i = 0; i < end - first; i++) {
            for (int v = 0; v < N_VARIANCES; v++) {
                t[v].sum += e[i].by[v];
                squares[v] += e[i].by[v] * e[i].by[v];
            }
        }
    }
    add_up(t, f->passes - 1.0, squares);
}

enum { MOST_PAIRS = 3 };

/* May a sum of that doubt be weighed? Squares of tiny terms underflow; a forged file may hold anything. */
static bool is_weighable(double doubt) { return doubt > 0 && isfinite(doubt); }

/* What is taken for the share before the picture tells: `middle`, give or take `spread`. */
typedef struct prior {
    double middle, spread;
} prior;

/* A pair as the fit takes it: log(sum) = log(c) + log(halves), whose last term is taken for a line in the share, so
 * that log(c) = level - slope (share - middle). weight: 1 / doubt. */
typedef struct datum {
    double level, slope, weight;
} datum;

static datum datum_of(const bis_film_pair *pair, prior share, double unit)
{
    const double here = log(expect(pair->P, pair->W, share.middle, unit).halves);
    const double beside = log(expect(pair->P, pair->W, share.middle + share.spread, unit).halves);

    return (datum){log(pair->sum) - here, (beside - here) / share.spread, 1 / pair->doubt};
}

/* What the film tells of the sum over pixels of V(n): its logarithm, and the variance of that. */
typedef struct verdict {
    double log_sum, doubt;
} verdict;

/* Least squares: log(c) and the share minimize
 *     sum over pairs of (log(sum) - log(c) - log(halves))^2 / doubt + (share - middle)^2 / spread^2.
 * With the data centred at their weighted means, the two have errors that do not depend on each other. */
static verdict fit(const bis_film *f, const bis_film_pair *pairs, int n, prior share)
{
    const double here = log(expect(f->half_weight, f->weight, share.middle, f->weight).whole);
    const double beside = log(expect(f->half_weight, f->weight, share.middle + share.spread, f->weight).whole);
    double weight = 0, level = 0, slope = 0, precision = 1 / (share.spread * share.spread), pull = 0;
    datum d[MOST_PAIRS];

    for (int k = 0; k < n; k++) {
        d[k] = datum_of(&pairs[k], share, f->weight);
        weight += d[k].weight;
        level += d[k].weight * d[k].level;
        slope += d[k].weight * d[k].slope;
    }
    level /= weight;
    slope /= weight;
    for (int k = 0; k < n; k++) {
        const double lever = d[k].slope - slope;
        precision += d[k].weight * lever * lever;
        pull += d[k].weight * lever * (d[k].level - level);
    }
    const double change = fmax(-share.middle, fmin(1 - share.middle, pull / precision));
    const double of_change = (beside - here) / share.spread - slope; /* of log(V) */
    return (verdict){level + here + of_change * change, 1 / weight + of_change * of_change / precision};
}

/* Stores the pairs that the film and the memory have in pairs[MOST_PAIRS], returns their number, and remembers the
 * quarters. Quarters of a single sample are left out because V(1) - V(2) is no measure: the first two samples of a
 * pixel mirror each other. */
static int pairs_of(const bis_film *f, const total t[N_VARIANCES], bis_film_pair pairs[MOST_PAIRS],
                    bis_film_memory *memory)
{
    const double two_samples = 2;

    pairs[0] = (bis_film_pair){f->half_weight, f->weight, t[HALVES].sum, t[HALVES].doubt};
    if (f->quarter_weight < two_samples || !is_weighable(t[QUARTERS].doubt)) return 1;
    pairs[1] = (bis_film_pair){f->quarter_weight, f->half_weight, t[QUARTERS].sum, t[QUARTERS].doubt};
    if (!memory) return 2;
    if (memory->now.W != f->half_weight) memory->before = memory->now;
    memory->now = pairs[1];
    if (memory->before.W != f->quarter_weight || !is_weighable(memory->before.doubt)) return 2;
    pairs[2] = memory->before;
    return 3;
}

/* Let R be the mean of the pixels' errors: the estimate of relMSE. Two things part R from the error that this very
 * picture has: R is itself an estimate, and the error is one draw. A pixel's squared error of expectation Y has the
 * variance 2 Y^2 (normal, its channels alike). An error of one degree of freedom has the same, so the draw has the
 * doubt of such a sum. The bound is e to 1.645 standard deviations of both times R, where all is taken for
 * noise before the picture says otherwise.
 *
 * But with few samples R is too low where noise is skewed: pixels whose mean came out low show little scatter,
 * and are weighed most. The loss falls with 1/n; R (1 + 1.5/n) made good for it with exponential noise of 40% on every
 * third pixel (tests/render/test_film_error.c).
 *
 * The figure is known where the standard deviation of the squared error is at most 0.2, of its root half of that: the
 * error of this picture is then within a fifth of the figure in 95 of 100 renders, if it is right (docs/budgets.md).
 * With fewer than 8 samples a third must do, and 0.3. The bound has room for doubt, and holds to 0.4. Beyond that
 * few pixels carry most of R, and in pictures of this kind R itself is often wrong. Neither holds where R is more
 * than (1/2)^2: pixels that have not yet found their light look black and exact, so that the means of the pixels
 * cannot stand for the truth. */
bis_film_error bis_film_estimate_error(const bis_film *f, bis_film_memory *memory)
{
    const double n = (double)f->width * f->height, nan = (double)NAN, skew = 1.5, most_rmse = 0.5;
    const double doubt_of_figure = f->weight < 8 ? 0.3 : 0.2, doubt_of_bound = 0.4;
    const prior usual = {0.7, 0.25}, cautious = {0, 0.35};
    total t[N_VARIANCES];

    if (f->passes < 2) return (bis_film_error){nan, nan, false, false};
    const double floor = floor_of(f);
    if (floor == 0) return (bis_film_error){0, 0, true, true}; /* black, hence without scatter */
    sum_over(f, floor, t);
    const total *seen = &t[f->independent ? PASSES : HALVES];
    if (seen->sum == 0) return (bis_film_error){0, 0, true, true};
    if (!is_weighable(seen->doubt)) return (bis_film_error){nan, nan, false, false};
    verdict middle = {log(seen->sum), seen->doubt}, high = middle;
    if (!f->independent) {
        bis_film_pair pairs[MOST_PAIRS];
        const int n_pairs = pairs_of(f, t, pairs, memory);
        middle = fit(f, pairs, n_pairs, usual);
        high = fit(f, pairs, n_pairs, cautious);
    }
    const double draw = seen->doubt * (f->independent ? f->passes - 1.0 : 1), bias = 1 + skew / f->weight;
    const double rmse = sqrt(exp(middle.log_sum) / n), doubt = sqrt(middle.doubt + draw);
    return (bis_film_error){
        .relative_rmse = rmse,
        .upper = sqrt(exp(high.log_sum) / n * bias * exp(normal_95 * sqrt(high.doubt + draw))),
        .is_known = doubt <= doubt_of_figure && rmse <= most_rmse,
        .is_bounded = doubt <= doubt_of_bound && rmse <= most_rmse};
}
