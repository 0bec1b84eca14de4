/* SPDX-License-Identifier: BSD-2-Clause */
/* truth: the reflected radiance at a point as a sum over the patches of the light (thesis eq. 3.2), with an error that
 * holds. For `bis verify` and `bis pixel`; it shares light, material and accelerator with src/thesis/exact.c, not its
 * code, because `exact` is one of the tested.
 *
 *     bis_truth t;
 *     status = bis_truth_of(&t, &(bis_truth_question){&pt, {1, 1, 1}, 1 << 15, seed, q, 2}, diag);
 *     t.lit.mean[3] +- bis_truth_bound(&t.lit, 1e-7)          // eq. 4.1, r+g+b
 *     t.open.mean[3] +- bis_truth_bound(&t.open, 1e-7)        // eq. 4.5, without V */
#pragma once

#include "bis/thesis/point.h"

/* The density of an estimator's single samples: from_map q_L + from_bsdf q_f + uniform/(4 pi). */
typedef struct bis_truth_density {
    double from_map, from_bsdf, uniform;
} bis_truth_density;

/* Red, green, blue, and their weighted sum. A sum of independent rays: its variance, unbiased, and what one ray can
 * add to the weighted sum at most. */
typedef struct bis_truth_sum {
    double mean[4], variance[4], most;
} bis_truth_sum;

/* What one sample of an estimator is, in the weighted sum: variance and third central moment, and the largest value
 * that was met. */
typedef struct bis_truth_moments {
    double variance, third, most;
} bis_truth_moments;

enum { BIS_TRUTH_MAX_DENSITIES = 16 };
typedef struct bis_truth {
    bis_truth_sum lit, open;       /* eq. 4.1, and without V, eq. 4.5 */
    bis_truth_moments one_ray;     /* of a sum with one ray in each patch: `exact` */
    bis_truth_moments sample[BIS_TRUTH_MAX_DENSITIES]; /* of F V/q for the densities asked for; infinite where q is 0
                                                          and F V is not */
    double worst; /* the largest value of a ray over what it may have in its cell; above 1: `most` was raised to it */
    size_t patches, rays;
} bis_truth;

typedef struct bis_truth_question {
    const bis_point *pt;
    double weight[3]; /* of red, green, blue, >= 0 */
    /* no ray adds more than about a (cells)-th of what were there without shadows; there are so many cells to four
     * times as many, and all patches */
    uint32_t cells;
    uint64_t seed;
    const bis_truth_density *q; /* q[n]; the light must have its table where from_map is not 0 */
    size_t n;                   /* <= BIS_TRUTH_MAX_DENSITIES */
} bis_truth_question;

/* bis_truth_of sums over all patches. The result does not depend on the number of threads. Cost: 15 values of F and 2
 * rays for each cell. Errors: BIS_NOMEM. */
bis_status bis_truth_of(bis_truth *t, const bis_truth_question *asked, bis_diag *diag);

/* bis_truth_bound returns e such that |mean[3] - what it should be| > e has at most that chance, 0 < chance < 1, over
 * the seeds. */
double bis_truth_bound(const bis_truth_sum *s, double chance);

/* bis_truth_deviation returns what the standard deviation alone exceeds with at most that chance. */
double bis_truth_deviation(const bis_truth_sum *s, double chance);
