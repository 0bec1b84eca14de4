/* SPDX-License-Identifier: BSD-2-Clause */
/* weights: scaling of weights, so that cdf and alias can sum any of them, 1e-300 or 1e300, without overflow.
 *
 * A power of two scales the largest weight into [1/2, 1). This rounds nothing. */
#pragma once

#include <assert.h>
#include <math.h>
#include <stddef.h>

/* A scaled weight is the weight times half1 times half2. There are two factors, because one factor for the least
 * double would be 2^1074, which is no double. Both are 0 if all weights are 0. */
typedef struct weight_scale {
    double half1, half2;
    int exponent; /* half1 * half2 = 2^-exponent */
} weight_scale;

/* weight_scale_of returns the scale of n weights >= 0. */
static inline weight_scale weight_scale_of(const double *w, size_t n)
{
    double largest = 0;
    int e;
    for (size_t i = 0; i < n; i++) {
        assert(isfinite(w[i]) && w[i] >= 0);
        largest = w[i] > largest ? w[i] : largest;
    }
    if (largest == 0) return (weight_scale){0};
    frexp(largest, &e);
    return (weight_scale){ldexp(1, -(e / 2)), ldexp(1, -(e - e / 2)), e};
}

/* weight_scaled returns a weight, scaled. */
static inline double weight_scaled(weight_scale s, double w) { return w * s.half1 * s.half2; }
