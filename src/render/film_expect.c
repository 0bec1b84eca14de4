/* SPDX-License-Identifier: BSD-2-Clause */
/* film_expect: how the error of a pixel falls with its camera samples.
 *
 * Let V(n) be the variance of the mean of the first n samples. Noise has V(n) = V(1) / n. At an edge through the pixel
 * a scrambled net has V(n) = s(n) n^-3/2 (Owen 1997), where s(n) nears a constant: plain scrambled Sobol points are
 * within 2% of it from 8 samples on. But the camera's points mirror each other by their first two digits (sampler.c),
 * so that fewer of their digits are free, and s rises and falls with each doubling. Nobody has a formula for it. So s
 * was measured: the mean square of what parts the share of the first n points below a line from the area below it, over
 * 100 000 lines at random, each through a pixel of its own. It is known to 1%. tests/render/test_film_expect.c measures
 * it again.
 *
 * A pixel on an outline has `edgesamples` camera samples for each one of others, usually 8. A film does not know which
 * of its pixels they are, so the edges of a picture are taken for a mean of both kinds: s(n) and s(8 n).
 *
 * If n is no power of two, let P be the largest one below it, and m = n - P. The means of two neighbouring blocks of P
 * samples have the variance V(P) and a covariance C with (V(P) + C)/2 = V(2P), because a scrambled sequence treats its
 * blocks alike. Those m samples lie in the second block, are no better and no worse placed than the rest of it, and are
 * the first m of a sequence of their own: so
 *     n^2 V(n) = P^2 V(P) + 2 P m C + m^2 V(m),   C = 2 V(2P) - V(P).
 * This gives 0.1115 for n^(3/2) V(n) at 6 and 0.103 at 12, where lines gave 0.112 and 0.103. */
#include "film_expect.h"

#include <assert.h>
#include <math.h>

typedef double variance_of_mean(double n);

static double noise(double n) { return 1 / n; }

/* n^(3/2) V(n) of lines through a pixel, for n = 2^k samples of the camera. What lies beyond the table is taken for the
 * mean of its last four values. */
static const double step[] = {0.1300, 0.0978, 0.0870, 0.0950, 0.0907, 0.0986, 0.1073,
                              0.0951, 0.0895, 0.0934, 0.0995, 0.0984, 0.0952};
static const double beyond = 0.0966;
enum { STEPS = sizeof step / sizeof *step, OUTLINE = 3 /* 2^3 edgesamples */ };

static double step_of(int k) { return k < STEPS ? step[k] : beyond; }

static double edges(double n)
{
    if (!(n >= 1 && n < 0x1p53)) return beyond * pow(n, -1.5); /* no count of samples: a forged file may hold it */
    const double P = scalbn(1, ilogb(n)), m = n - P;
    if (m == 0) return sqrt(step_of(ilogb(n)) * step_of(ilogb(n) + OUTLINE)) * pow(n, -1.5);

    const double V = edges(P), C = 2 * edges(2 * P) - V;
    return (P * P * V + 2 * P * m * C + m * m * edges(m)) / (n * n);
}

/* P samples are a block, and m = W - P others follow, about as many. Those of them that lie in the block of P that
 * follows have with the first the covariance of the two halves of 2P samples; later ones that of the halves of 4P. */
static bis_film_expected blocks(double P, double W, variance_of_mean *V)
{
    const double m = W - P, next = fmin(m, P), near = 2 * V(2 * P) - V(P), far = 2 * V(4 * P) - V(2 * P);
    const double cov = (near * next + far * (m - next)) / m;

    return (bis_film_expected){.whole = (P * P * V(P) + 2 * P * m * cov + m * m * V(m)) / (W * W),
                               .halves = (V(P) + V(m) - 2 * cov) * P * m / (W * W)};
}

bis_film_expected bis_film_expect(double P, double W, double share, double unit)
{
    assert(P > 0 && W > P);
    const bis_film_expected of_noise = blocks(P, W, noise), of_edges = blocks(P, W, edges);
    const double half = fmax(1, floor(unit / 2));
    const double a = (1 - share) / (noise(half) - noise(2 * half)), b = share / (edges(half) - edges(2 * half));

    return (bis_film_expected){a * of_noise.whole + b * of_edges.whole, a * of_noise.halves + b * of_edges.halves};
}
