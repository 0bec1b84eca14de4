/* weights: how cdf and alias bring any weights, 1e-300 or 1e300, into reach of a sum that cannot overflow. Private to
 * these.
 *
 * The largest weight is scaled into [1/2, 1) by a power of two, which rounds nothing. */
#ifndef BIS_WEIGHTS_H
#define BIS_WEIGHTS_H

#include <assert.h>
#include <math.h>
#include <stddef.h>

/* A weight times half1 times half2; two factors, because 2^1074, for the least double, is none. Both 0 when all weights
 * are. */
typedef struct weight_scale {
    double half1, half2;
    int exponent; /* half1 * half2 = 2^-exponent */
} weight_scale;

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

static inline double weight_scaled(weight_scale s, double w) { return w * s.half1 * s.half2; }

#endif
