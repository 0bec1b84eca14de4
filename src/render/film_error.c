/* SPDX-License-Identifier: BSD-2-Clause */
/* film_error: what the passes of a film say about its error.
 *
 * The error is the relative RMSE of docs/budgets.md, "Error": the root of the mean, over pixels and channels, of
 * (a-b)^2 / (b^2 + m^2/100). a is the picture, b the truth, m the mean of b. The variance of each pixel's mean stands
 * in for (a-b)^2, and the picture itself for b.
 *
 * The variance. If the camera samples of a pixel are independent, the scatter of the passes tells it (eq. 3.9;
 * docs/errata.md E32). Otherwise a sequence spreads them over the pixel: each pass fills gaps that earlier ones left,
 * and the scatter is too large, at edges twofold and more. Two things are then known.
 *
 * Twins (film_twins.c). Some pixels are rendered twice, with random numbers of their own. Let A and B be the means of
 * the two: E (A - B)^2 / 2 is the variance of A, whatever the sequence does. In place of b stands the mean of both.
 * Nothing is assumed of the sequence, but twins are few: how unevenly the pixels share the error says how far the mean
 * of these errors may be off (see of_twins).
 *
 * Halves. Let A and B be the means of the two halves of a pixel's samples. Both have the variance V(n/2), because a
 * scrambled sequence treats its two halves alike, and their mean has V(n) = (V(n/2) + cov(A, B))/2. Therefore
 *     E (A - B)^2 / 4 = (V(n/2) - cov(A, B))/2 = V(n/2) - V(n).
 * (The same holds for one sample in each of n cells whose halves interleave as sampler.c has it: V(n/2) is then that
 * of one sample in each pair of cells.) All pixels say so, but it must be assumed how V falls: noise falls as 1/n, so
 * its part of the difference is V(n) itself; the error at an edge through the pixel falls as n^-3/2 (Owen 1997), so
 * that its part is 2^(3/2) - 1 times V(n). Edges are taken for 0.7 of the difference. The error at edges falls by
 * steps, because the camera's points mirror each other (sampler.c), and checks of a third of a pixel are seen by 8
 * samples and not by 4: what comes of the halves is off by halves_spread. n need not be a power of two: where the end
 * is known, the film chooses a half of a third to two thirds (see blocks).
 *
 * The two are independent but for A itself, and are weighed as such: the mean of the logarithms, each by one over its
 * variance. In small pictures halves say most, in large ones twins.
 *
 * The truth. Errors are weighed by the geometric mean of two stand-ins for b^2: mean^2, which holds the variance as
 * well, so that a lone bright sample hides behind its own brightness (scene.txt at 4 passes: estimate 0.35, truth
 * 0.70); and mean^2 less the variance, right in expectation, but 0 just there, as if the pixel were black. Noise that
 * is small beside the mean does not see it. Of a twin the mean is that of both.
 *
 * No estimate knows of lights that no pass has found yet. */
#include "bis/render/film.h"

#include <assert.h>
#include <math.h>

static const double normal_95 = 1.645; /* the 95% point of a normal */

/* What edges are taken to have of the difference of the halves. */
static const double usual_share = 0.7;

/* Standard deviation of what the halves are off, a logarithm of the squared error; measured (docs/budgets.md). */
static const double halves_spread = 0.25;

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

/* What stands for b^2 + m^2/100, where a mean has this square and this variance. Where estimates are not negative, the
 * variance is at most the square. A control variate may leave some that are. */
static double truth(double square, double variance, double floor)
{
    return sqrt(square + floor) * sqrt(fmax(0, square - variance) + floor); /* a product may underflow */
}

/* A pixel's expected (a-b)^2 / (b^2 + m^2/100), the mean over its channels, by its passes or its halves. */
static double error_of_pixel(const bis_film *f, size_t i, double floor)
{
    double error = 0;

    for (size_t k = 3 * i; k < 3 * i + 3; k++) {
        const double mean = f->sum[k] / f->weight, scatter = bis_film_variance(f, k);
        const double variance = f->independent ? scatter : variance_of_halves((double)f->half[k], mean, f->half_weight,
                                                                               f->weight);
        error += variance / (3 * truth(mean * mean, scatter, floor));
    }
    return error;
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

/* A sum over pixels of their errors, and what its own noise is. */
typedef struct total {
    double sum;
    double q;     /* the sum of squares over the square of the sum */
    double doubt; /* relative variance of the sum, if the samples of a pixel are normal and its channels alike */
} total;

/* Threads find the terms, which are added in the order of the pixels: any number of threads gives the same bits.
 * An error X of a pixel with `dof` degrees of freedom has E X^2 = (1 + 2/dof) Y^2 and the variance 2 Y^2/dof, where Y
 * is its expectation. Pixels have independent random numbers, so the variance of the sum is 2/(dof + 2) times the sum
 * of X^2. Where the samples are not normal, X^2 holds more and the doubt grows, too. */
static total sum_over(const bis_film *f, double floor)
{
    enum { BLOCK = 1024 };
    const size_t n = (size_t)f->width * (size_t)f->height;
    const double dof = f->independent ? f->passes - 1.0 : 1;
    double sum = 0, squares = 0;

#pragma omp parallel for ordered schedule(dynamic)
    for (size_t first = 0; first < n; first += BLOCK) {
        const size_t end = first + BLOCK < n ? first + BLOCK : n;
        double e[BLOCK];
        for (size_t i = first; i < end; i++) e[i - first] = error_of_pixel(f, i, floor);
#pragma omp ordered
        for (size_t i = 0; i < end - first; i++) {
            sum += e[i];
            squares += e[i] * e[i];
        }
    }
    const double q = sum > 0 ? squares / sum / sum : 0;
    return (total){sum, q, q * (2 / (dof + 2))};
}

/* May a sum of that doubt be weighed? Squares of tiny terms underflow; a forged file may hold anything. */
static bool is_weighable(double doubt) { return doubt > 0 && isfinite(doubt); }

/* What the film tells of the sum over pixels of V(n): its logarithm, and the variance of that. */
typedef struct verdict {
    double log_sum, doubt;
} verdict;

/* The mean over n twins of (A - B)^2 / 2 / (b^2 + m^2/100), times the number of pixels N. Its relative variance is
 * (N q - 1)/n, where q is the sum of squares of the errors of all pixels over the square of their sum. The halves tell
 * q, because a twin's difference has one degree of freedom, as theirs has. The twins could tell it themselves; but
 * where few pixels carry the error, the twins have often met none of them: 4 twins of a picture of 99 pixels agreed
 * that it has a third of its error. */
static verdict of_twins(const bis_film *f, double q, double floor)
{
    const double N = (double)f->width * f->height;
    double sum = 0, n = 0;

    for (bis_twin t = {0}; bis_film_next_twin(f, bis_film_crop(f), &t); n++) {
        const size_t i = 3 * ((size_t)(t.y - f->y0) * (size_t)f->width + (size_t)(t.x - f->x0));
        double error = 0;
        for (size_t c = 0; c < 3; c++) {
            const double A = f->sum[i + c] / f->weight, B = f->twin[BIS_TWIN_VALUES * t.at + c] / f->weight, mean = (A + B) / 2;
            const double variance = (A - B) * (A - B) / 4; /* of this mean; that of A is twice as large */
            error += 2 * variance / (3 * truth(mean * mean, variance, floor));
        }
        sum += error;
    }
    return (verdict){log(sum / n * N), (N * q - 1) / n}; /* a sum of 0 says nothing: its logarithm is infinite */
}

/* The mean of the two, each weighed by one over its doubt. b may say nothing. */
static verdict both(verdict a, verdict b)
{
    if (!isfinite(b.log_sum) || !is_weighable(b.doubt)) return a;
    const double of_a = b.doubt / (a.doubt + b.doubt);
    return (verdict){of_a * a.log_sum + (1 - of_a) * b.log_sum, of_a * a.doubt};
}

/* By the halves alone, if edges have this share of what they differ. whole : halves is what the sum of V is to it; for
 * noise and for edges each is scaled so that V(n/2) - V(n) is 1 for n = W. */
static verdict of_halves(const bis_film *f, total seen, double share)
{
    const double W = f->weight, a = (1 - share) * W, b = share * pow(W, 1.5) / (exp2(1.5) - 1);
    const expected noise = blocks(f->half_weight, W, 1), edges = blocks(f->half_weight, W, 1.5);
    const double whole = a * noise.whole + b * edges.whole, halves = a * noise.halves + b * edges.halves;

    return (verdict){log(seen.sum * (whole / halves)), seen.doubt + halves_spread * halves_spread};
}

/* Let R be the mean of the pixels' errors: the estimate of relMSE. Two things part R from the error that this very
 * picture has: R is itself an estimate, and the error is one draw. A pixel's squared error of expectation Y has the
 * variance 2 Y^2 (normal, its channels alike). An error of one degree of freedom has the same, so the draw has the
 * doubt of such a sum. The bound is e to 1.645 standard deviations of both times R, where halves count as if all were
 * noise: with rare bright samples they are 0.7 to 0.8 of the truth otherwise (rooms with a small window).
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
bis_film_error bis_film_estimate_error(const bis_film *f)
{
    const double n = (double)f->width * f->height, nan = (double)NAN, skew = 1.5, most_rmse = 0.5;
    const double doubt_of_figure = f->weight < 8 ? 0.3 : 0.2, doubt_of_bound = 0.4;

    if (f->passes < 2) return (bis_film_error){nan, nan, false, false};
    const double floor = floor_of(f);
    if (floor == 0) return (bis_film_error){0, 0, true, true}; /* black, hence without scatter */
    const total seen = sum_over(f, floor);
    if (seen.sum == 0) return (bis_film_error){0, 0, true, true};
    if (!is_weighable(seen.doubt)) return (bis_film_error){nan, nan, false, false};
    verdict v = {log(seen.sum), seen.doubt}, high = v;
    if (!f->independent) {
        v = of_halves(f, seen, usual_share);
        high = of_halves(f, seen, 0);
    }
    if (f->twin) {
        const verdict twins = of_twins(f, seen.q, floor);
        v = both(v, twins);
        high = both(high, twins);
    }
    const double draw = seen.doubt * (f->independent ? f->passes - 1.0 : 1), bias = 1 + skew / f->weight;
    const double rmse = sqrt(exp(v.log_sum) / n), doubt = sqrt(v.doubt + draw);
    return (bis_film_error){
        .relative_rmse = rmse,
        .upper = sqrt(exp(high.log_sum) / n * bias * exp(normal_95 * doubt)),
        .is_known = doubt <= doubt_of_figure && rmse <= most_rmse,
        .is_bounded = doubt <= doubt_of_bound && rmse <= most_rmse};
}
