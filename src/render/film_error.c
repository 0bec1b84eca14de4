/* SPDX-License-Identifier: BSD-2-Clause */
/* film_error: what the passes of a film say about its error.
 *
 * The error is the relative RMSE of docs/trust.md, "Error": the root of the mean, over pixels and channels, of
 * (a-b)^2 / (b^2 + m^2/100). a is the picture, b the truth, m the mean of b. The variance of each pixel's mean stands
 * in for (a-b)^2, and means of the picture for b.
 *
 * The variance. If the camera samples of a pixel are independent, the scatter of the passes tells it (eq. 3.9;
 * docs/errata.md E32). Otherwise a sequence spreads them over the pixel: each pass fills gaps that earlier ones left,
 * and the scatter is too large, at edges twofold and more. Two things are then known.
 *
 * Halves. Let A and B be the means of the two halves of a pixel's samples. Both have the variance V(n/2), because a
 * scrambled sequence treats its two halves alike, and their mean has V(n) = (V(n/2) + cov(A, B))/2. Therefore
 *     E (A - B)^2 / 4 = (V(n/2) - cov(A, B))/2 = V(n/2) - V(n).
 * (The same holds for one sample in each of n cells whose halves interleave as sampler.c has it: V(n/2) is then that
 * of one sample in each pair of cells.) All pixels say so, and they say it of this very picture: a rare bright sample
 * adds as much to the difference as to the error. But V(n) is not the difference. Noise falls as 1/n, so its part of
 * the difference is V(n) itself; the error at an edge through the pixel falls as n^-3/2 (Owen 1997), so that its part
 * is 2^(3/2) - 1 times V(n); and the error at edges falls by steps, because the camera's points mirror each other
 * (sampler.c), and checks of a third of a pixel are seen by 8 samples and not by 4. n need not be a power of two: where
 * the end is known, the film chooses a half of a third to two thirds (see blocks).
 *
 * Twins (film_twins.c). Some pixels are rendered twice, with random numbers of their own. Let A and B be the means of
 * the two: E (A - B)^2 / 2 is the variance of A, whatever the sequence does. Twins are few, and bright samples are
 * rare, so the sum of these squares is known badly. But what is missing is one number of the picture, V(n) over the
 * difference of the halves, and twins tell it well (see of_twins). Where they say little, edges are taken for 0.7 of
 * the difference.
 *
 * The truth. If the pixel's own mean stood for b, a rare bright sample would hide behind its own brightness. If the
 * mean of the pixels around it did, edges and fine texture would be wrong. Let d part the two. Where the pixel is the
 * brighter one, d^2 is too large by the variance, and one bright sample makes all of it; so d^2 less the variance is
 * taken, and its root added to the mean around. A darker pixel stands for itself. How far apart the picture's sums are
 * with the pixel's square in place of b^2 and with that square less its variance, tells how far this may be off.
 * Between bright pixels a rare sample still hides. So where the halves of a pixel differ far more than those of the
 * pixels around it, the figure must hold with the darker half for b, too (see is_alone).
 *
 * What pixels have in common. All pixels of a pass share directions (bis/beyond/clusters.h), which may be wrong for all
 * of them in the same way. The error of one picture is then not the mean of many independent ones. The halves of
 * neighbours tell that part, because they differ alike (see in_common).
 *
 * No estimate knows of lights that no pass has found yet. */
#include "bis/render/film.h"

#include <assert.h>
#include <math.h>

static const double normal_95 = 1.645; /* the 95% point of a normal */

/* What edges are taken to have of the difference of the halves. */
static const double usual_share = 0.7;

/* Standard deviation of what the halves are off then, a logarithm of the squared error; measured (docs/trust.md). */
static const double halves_spread = 0.25;

/* No pixel counts for more than this many times the mean in what twins tell, nor in what noise does to the sum. */
static const double most_of_mean = 20;

/* How many times as much the halves of a pixel differ that holds a rare sample: a normal value's square exceeds this
 * many times its mean once in 130,000. */
static const double far_more = 20;

/* Relative variance of what stands for b^2 where single pixels have large errors, measured (docs/trust.md). */
static const double truth_spread = 0.4;

/* The variance of the mean of value i if the n > 1 passes are independent (eq. 3.9). A pass of weight w is the mean
 * of w camera samples: its variance is v/w, sum w (L - mean)^2 over n - 1 estimates v, and the mean over a weight W
 * has the variance v/W. */
double bis_film_variance(const bis_film *f, size_t i)
{
    const double deviation = (double)f->deviation[i];
    return deviation * deviation / (f->passes - 1.0);
}

/* The covariance of the means of two values, whose first halves differ from them by a and b: see below. */
static double covariance_of_halves(double a, double b, double P, double W) { return a * b * (P / (W - P)); }

/* The variance by the difference of A, the mean of samples of weight P, and B, the mean of those that follow, W in all:
 * (A - B)^2 P (W - P) / W^2, where A - B = (A - both) W / (W - P). */
static double variance_of_halves(double A, double both, double P, double W)
{
    return covariance_of_halves(A - both, A - both, P, W);
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

/* m^2/100 of relMSE, m the mean of the picture; 0 where it is black. */
static double floor_of(const bis_film *f)
{
    const size_t n = (size_t)f->width * (size_t)f->height;
    double mean = 0;

    for (size_t i = 0; i < 3 * n; i++) mean += f->sum[i];
    mean /= 3 * (double)n * f->weight;
    return mean * mean / 100;
}

/* By how much the first half of value k differs from the mean. */
static double apart(const bis_film *f, size_t k) { return (double)f->half[k] - f->sum[k] / f->weight; }

static double apart_squared(const bis_film *f, size_t i)
{
    double sum = 0;
    for (size_t c = 0; c < 3; c++) sum += apart(f, 3 * i + c) * apart(f, 3 * i + c);
    return sum;
}

/* The pixels around one, at most 8; the pixel itself where there are none. */
typedef struct surroundings {
    double mean[3], apart_squared; /* means; the latter is 0 where samples are independent */
} surroundings;

static surroundings around(const bis_film *f, size_t i)
{
    const size_t width = (size_t)f->width, height = (size_t)f->height, x = i % width, y = i / width;
    const size_t x0 = x ? x - 1 : 0, x1 = x + 1 < width ? x + 2 : width;
    surroundings a = {0};
    double n = 0;

    for (size_t v = y ? y - 1 : 0; v < height && v <= y + 1; v++)
        for (size_t u = x0; u < x1; u++) {
            if (u == x && v == y) continue;
            for (size_t c = 0; c < 3; c++) a.mean[c] += f->sum[3 * (v * width + u) + c];
            if (!f->independent) a.apart_squared += apart_squared(f, v * width + u);
            n++;
        }
    for (size_t c = 0; c < 3; c++) a.mean[c] = (n > 0 ? a.mean[c] / n : f->sum[3 * i + c]) / f->weight;
    a.apart_squared = n > 0 ? a.apart_squared / n : HUGE_VAL;
    return a;
}

/* Does a rare sample make pixel i bright? */
static bool is_alone(const bis_film *f, size_t i, const surroundings *a)
{
    return !f->independent && apart_squared(f, i) > far_more * a->apart_squared;
}

/* What stands for b^2, where a mean has this variance, and the pixels around it have the mean `around`. */
static double truth(double mean, double variance, double mean_around)
{
    const double more = mean - mean_around;
    const double b = more > 0 ? mean_around + sqrt(fmax(0, more * more - variance)) : mean;
    return b * b;
}

/* Expected (a-b)^2 / (b^2 + m^2/100) of a pixel or a picture; then with the two ends for b^2; the first one by the
 * scatter of the passes; with the darker half for b where the pixel is alone; and its part that the pixel has in common
 * with those beside it. */
typedef struct errors {
    double likely, least, most, scatter, alone, common;
} errors;

/* The square of the darker half of value k. */
static double darker(const bis_film *f, size_t k)
{
    const double P = f->half_weight, W = f->weight, A = (double)f->half[k], B = (f->sum[k] - P * A) / (W - P);
    return fmin(A * A, B * B);
}

/* The variance that value c of pixel i has in common with those of the pixels on its right and below, by the halves. */
static double in_common(const bis_film *f, size_t i, size_t c)
{
    const size_t width = (size_t)f->width;
    double sum = 0;

    if (i % width + 1 < width) sum += apart(f, 3 * (i + 1) + c);
    if (i / width + 1 < (size_t)f->height) sum += apart(f, 3 * (i + width) + c);
    return covariance_of_halves(apart(f, 3 * i + c), sum / 2, f->half_weight, f->weight);
}

/* Those of a pixel, the means over its channels, by its passes or its halves. */
static errors errors_of_pixel(const bis_film *f, size_t i, double floor)
{
    const surroundings a = around(f, i);
    const bool alone = is_alone(f, i, &a);
    errors e = {0};

    for (size_t c = 0; c < 3; c++) {
        const size_t k = 3 * i + c;
        const double mean = f->sum[k] / f->weight, square = mean * mean, scatter = bis_film_variance(f, k);
        const double variance = f->independent ? scatter : variance_of_halves((double)f->half[k], mean, f->half_weight,
                                                                               f->weight);
        const double larger = fmax(scatter, variance), b2 = truth(mean, larger, a.mean[c]), scale = 3 * (b2 + floor);
        e.likely += variance / scale;
        e.alone += variance / (3 * ((alone ? fmin(b2, darker(f, k)) : b2) + floor));
        if (!f->independent) e.common += in_common(f, i, c) / scale;
        e.scatter += scatter / scale;
        e.least += variance / (3 * (square + floor));
        e.most += variance / (3 * (fmax(0, square - larger) + floor));
    }
    return e;
}

/* Sums over pixels. */
typedef struct total {
    errors sum; /* the common ones with errors of at most `most` */
    double q;   /* of the likely errors, none above `most`: the sum of their squares over the square of their sum */
    double q_alone; /* the same of all errors, with those of pixels that are alone */
} total;

/* Threads find the terms, which are added in the order of the pixels: any number of threads gives the same bits. */
static total sum_over(const bis_film *f, double floor, double most)
{
    enum { BLOCK = 1024 };
    const size_t n = (size_t)f->width * (size_t)f->height;
    errors all = {0};
    double sum = 0, squares = 0, squares_alone = 0;

#pragma omp parallel for ordered schedule(dynamic)
    for (size_t first = 0; first < n; first += BLOCK) {
        const size_t end = first + BLOCK < n ? first + BLOCK : n;
        errors e[BLOCK];
        for (size_t i = first; i < end; i++) e[i - first] = errors_of_pixel(f, i, floor);
#pragma omp ordered
        for (size_t i = 0; i < end - first; i++) {
            const double counts = fmin(e[i].likely, most);
            all.likely += e[i].likely;
            all.least += e[i].least;
            all.most += e[i].most;
            all.scatter += e[i].scatter;
            all.alone += e[i].alone;
            if (e[i].likely > 0) all.common += e[i].common * counts / e[i].likely;
            sum += counts;
            squares += counts * counts;
            squares_alone += e[i].alone * e[i].alone;
        }
    }
    return (total){all, sum > 0 ? squares / sum / sum : 0, sum > 0 ? squares_alone / all.alone / all.alone : 0};
}

/* May a sum of that doubt be weighed? Squares of tiny terms underflow; a forged file may hold anything. */
static bool is_weighable(double doubt) { return doubt > 0 && isfinite(doubt); }

/* A logarithm, and its variance. */
typedef struct verdict {
    double log, doubt;
} verdict;

/* V(n) over the variance by the halves, as the twins tell it: the sums of both over all twins. A twin has two means of
 * halves, which lie as far from its two means as the error of both wants, so that a bright sample in one of the two
 * adds as much to either sum. Twins whose errors are above `most` are scaled down to it, because a few of them would
 * otherwise tell the ratio. A difference of normal values of expected square Y has the variance 2 Y^2, the mean of two
 * Y^2: a twin's share of the ratio has 3 Y^2, which is what q counts of a pixel (see sum_over and
 * bis_film_estimate_error), so the relative variance is N q/n with n twins of N pixels. All pixels tell q: where few
 * pixels carry the error, few twins have often met none of them, and agree. */
static verdict of_twins(const bis_film *f, double q, double floor, double most)
{
    const double P = f->half_weight, W = f->weight;
    double error = 0, halves = 0, n = 0;

    for (bis_twin t = {0}; f->twin && bis_film_next_twin(f, bis_film_crop(f), &t); n++) {
        const size_t i = (size_t)(t.y - f->y0) * (size_t)f->width + (size_t)(t.x - f->x0);
        const double *const twin = f->twin + BIS_TWIN_VALUES * t.at;
        const surroundings a = around(f, i);
        double of_twin = 0, of_halves = 0;
        for (size_t c = 0; c < 3; c++) {
            const double A = f->sum[3 * i + c] / W, B = twin[c] / W, mean = (A + B) / 2;
            const double variance = (A - B) * (A - B) / 4; /* of this mean; that of A is twice as large */
            const double weight = 1 / (truth(mean, variance, a.mean[c]) + floor);
            of_twin += 2 * variance * weight / 3;
            of_halves += (variance_of_halves((double)f->half[3 * i + c], A, P, W) +
                          variance_of_halves(twin[3 + c], B, P, W)) * weight / 6;
        }
        const double both = of_twin + of_halves, scale = both > most ? most / both : 1;
        error += of_twin * scale;
        halves += of_halves * scale;
    }
    if (!(error > 0 && halves > 0)) return (verdict){0, HUGE_VAL}; /* they say nothing, or there are none */
    return (verdict){log(error / halves), (double)f->width * f->height * q / n};
}

/* The same, if edges have this share of what the halves differ. For noise and for edges each is scaled so that
 * V(n/2) - V(n) is 1 for n = W. */
static verdict of_halves(const bis_film *f, double share)
{
    const double W = f->weight, a = (1 - share) * W, b = share * pow(W, 1.5) / (exp2(1.5) - 1);
    const expected noise = blocks(f->half_weight, W, 1), edges = blocks(f->half_weight, W, 1.5);
    const double whole = a * noise.whole + b * edges.whole, halves = a * noise.halves + b * edges.halves;

    return (verdict){log(whole / halves), halves_spread * halves_spread};
}

/* The mean of the two, each weighed by one over its doubt. b may say nothing. */
static verdict both(verdict a, verdict b)
{
    if (!isfinite(b.log) || !is_weighable(b.doubt)) return a;
    const double of_a = b.doubt / (a.doubt + b.doubt);
    return (verdict){of_a * a.log + (1 - of_a) * b.log, of_a * a.doubt};
}

/* Let R be the mean of the pixels' errors: the estimate of relMSE. What parts R from the error that this very picture
 * has? With d degrees of freedom a pixel's variance X of expectation Y has the variance 2 Y^2/d, and its squared error
 * Z has 2 Y^2, if all is normal. Where samples are not, as where few are bright, X and Z both have more, but Z - X has
 * the same (2 + 2/d) Y^2: of the means A and B of two halves it is A B, and E (A B)^2 = E A^2 E B^2. The mean of X^2 is
 * (1 + 2/d) Y^2 for normal values, and more otherwise; so errors count for at most 20 times their mean there.
 * Four things add to it: what is known of the ratio; the truth of single pixels, by how much more these carry if they
 * count in full, and those that are alone with the darker half for b; the truth of all, by the width between the two
 * ends, which is taken for 10 standard deviations; and what pixels have in common. If all of them had a share r of the
 * squared error in common, as one normal value, this would have the variance 2 r^2, which is taken. The bound is e to
 * 1.645 standard deviations of all times R, where halves count as if all were noise.
 *
 * But with few samples R is too low where noise is skewed: pixels whose mean came out low show little scatter,
 * and are weighed most. The loss falls with 1/n; R (1 + 0.5/n) made good for it with exponential noise of 40% on every
 * third pixel (tests/render/test_film_error.c).
 *
 * The figure is known where the standard deviation of the squared error is at most 0.2, of its root half of that: the
 * error of this picture is then within a fifth of the figure in 95 of 100 renders, if it is right (docs/trust.md).
 * With fewer than 8 samples a third must do, and 0.3. The bound has room for doubt, and holds where the figure is not
 * known (docs/trust.md), but a render ends by it only where its doubt is up to 0.4. What pixels have
 * in common, and those that are alone, are no part of this 0.4, because --error would not end where more samples do not
 * make them less. Neither holds where R is more than (1/2)^2: pixels that have not yet found their light look black and
 * exact, so that the means of the pixels cannot stand for the truth. */
bis_film_error bis_film_estimate_error(const bis_film *f)
{
    const double n = (double)f->width * f->height, nan = (double)NAN, skew = 0.5, most_rmse = 0.5;
    const double doubt_of_figure = f->weight < 8 ? 0.3 : 0.2, doubt_of_bound = 0.4;
    const double dof = f->independent ? f->passes - 1.0 : 1;

    if (f->passes < 2) return (bis_film_error){nan, nan, nan, false, false, false};
    const double floor = floor_of(f);
    if (floor == 0) return (bis_film_error){0, 0, 0, true, true, true}; /* black, hence without scatter */
    const total all = sum_over(f, floor, HUGE_VAL);
    if (all.sum.likely == 0) return (bis_film_error){0, 0, 0, true, true, true};
    const double most = most_of_mean * all.sum.likely / n;
    const total capped = sum_over(f, floor, most);
    const double q = capped.q, r = fmax(0, capped.sum.common / all.sum.likely);
    if (!is_weighable(q)) return (bis_film_error){nan, nan, nan, false, false, false};
    verdict ratio = {0, 0}, high = {0, 0};
    if (!f->independent) {
        const verdict twins = of_twins(f, q, floor, most);
        ratio = both(of_halves(f, usual_share), twins);
        high = both(of_halves(f, 0), twins);
    }
    const double mean = all.sum.likely / n, rmse = sqrt(mean * exp(ratio.log));
    const double noise = q / (1 + 2 / dof) * (2 + 2 / dof), ends = log(all.sum.most / all.sum.least) / 10;
    const double usual = noise + ratio.doubt + truth_spread * fmax(0, all.q - q) + ends * ends;
    const double doubt = sqrt(usual + truth_spread * fmax(0, all.q_alone - all.q) + 2 * r * r);
    const double upper = sqrt(mean * exp(high.log + normal_95 * doubt) * (1 + skew / f->weight));
    return (bis_film_error){.relative_rmse = rmse,
                            .upper = upper,
                            .scatter = sqrt(all.sum.scatter / n),
                            .is_known = doubt <= doubt_of_figure && rmse <= most_rmse,
                            .has_upper = upper <= 1 && rmse <= most_rmse,
                            .is_bounded = sqrt(usual) <= doubt_of_bound && rmse <= most_rmse};
}
