/* SPDX-License-Identifier: BSD-2-Clause */
/* auto_fit: cost and variance as functions of M and N, fitted to a few measurements, and the M and N that are best.
 * For src/tools/auto/auto.c. */
#pragma once

#include <stdint.h>

/* constant + M by_M + N by_N (cost), or constant + by_M/M + by_N/N^1.5 (variance); no coefficient is negative. A
 * method without candidates has M = 0 and by_M = 0. */
typedef struct bis_auto_model {
    double constant, by_M, by_N;
} bis_auto_model;

typedef struct bis_auto_measured {
    uint32_t M, N;
    double cost, variance; /* of a camera sample; > 0 */
} bis_auto_measured;

/* bis_auto_fit_cost fits by least squares of relative deviations, with coefficients >= 0, to n >= 1 measurements. With
 * fewer than three that tell M and N apart, what cannot be told is 0. */
bis_auto_model bis_auto_fit_cost(const bis_auto_measured *m, int n);
bis_auto_model bis_auto_fit_variance(const bis_auto_measured *m, int n);

/* bis_auto_cost returns the cost that the model says, bis_auto_variance the variance. */
double bis_auto_cost(const bis_auto_model *c, uint32_t M, uint32_t N);
double bis_auto_variance(const bis_auto_model *v, uint32_t M, uint32_t N);

typedef struct bis_auto_limits {
    uint32_t min_M, max_M, min_N, max_N;
} bis_auto_limits;

/* bis_auto_best stores M and N of least cost x variance within the limits, see auto_fit.c. *M = 0 where limits.max_M is
 * 0. */
void bis_auto_best(uint32_t *M, uint32_t *N, const bis_auto_model *cost, const bis_auto_model *variance,
                   const bis_auto_limits *limits);
