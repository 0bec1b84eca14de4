/* SPDX-License-Identifier: BSD-2-Clause */
/* cdf: the transformation method for discrete distributions. Source: thesis 3.2.2, "Discrete Distributions".
 *
 *     p[i] = f[i] / sum of f            C[0] = 0,  C[i+1] = C[i] + p[i],  C[N] = 1
 *     x = the index i with C[i] <= u < C[i+1]
 *
 * The thesis writes C as an inclusive sum over a reused index. With the exclusive sum the search is right at u = 0,
 * and it never returns an item of weight 0, because the interval of such an item is empty (docs/errata.md E8).
 *
 * The thesis gives two hints for speed: "use floor(u N) as a starting point" and "pre-inverting C". Here one guide
 * table does both. It holds the inverse of C at equidistant u, and the search continues from there, so no probability
 * is rounded to a multiple of 1/N (E10). The expected cost is O(1), because the N steps of C fall into at least N/4
 * guide cells; the worst case is O(log N). */
#include "bis/thesis/cdf.h"
#include "bis/base/mem.h"
#include "weights.h"

#include <assert.h>
#include <float.h>
#include <math.h>

/* Computes C[i+1] = C[i] + f[i], scaled but not yet normalised, and returns C[N]. `low` collects what each addition
 * rounds off (Neumaier 1974), because a million small items after a large one would otherwise vanish one by one. C
 * stays monotone: an f that changes `sum` is far larger than all errors of `low`, and an f that does not change `sum`
 * can only raise `low`. */
/* [cdf-sum] */
static double accumulate(double *c, const double *f, size_t n, weight_scale s)
{
    double sum = 0, low = 0;
    c[0] = 0;
    for (size_t i = 0; i < n; i++) {
        double p = weight_scaled(s, f[i]), next = sum + p, added = next - sum;
        low += (sum - (next - added)) + (p - added);
        sum = next;
        c[i + 1] = sum + low;
    }
    return c[n];
}
/* [end] */

/* Stores the inverse of C at u = g / n_guide, by one walk along C. At u = 1 it is the last item that can be drawn. */
static void fill_guide(uint32_t *guide, size_t n_guide, const double *c, size_t n)
{
    size_t last = n - 1, i = 0;
    while (c[last] == 1)
        last--;
    for (size_t g = 0; g <= n_guide; g++) {
        double u = (double)g / (double)n_guide;
        while (i < last && c[i + 1] <= u)
            i++;
        guide[g] = (uint32_t)i;
    }
}

bis_status bis_cdf_init(bis_cdf *c, const double *w, size_t n, bis_diag *diag)
{
    weight_scale scale = weight_scale_of(w, n);

    *c = (bis_cdf){.n = n};
    assert(n <= UINT32_MAX);
    if (scale.half1 == 0) return BIS_OK;
    for (c->n_guide = 1; 4 * c->n_guide <= n;) /* at most 10 bytes an item: a row of a map may not take more */
        c->n_guide *= 2;
    c->c = bis_alloc(n + 1, sizeof *c->c);
    c->guide = bis_alloc(c->n_guide + 1, sizeof *c->guide);
    if (!c->c || !c->guide) {
        bis_cdf_clear(c);
        return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for a distribution of %zu items", n);
    }
    double sum = accumulate(c->c, w, n, scale);
    for (size_t i = 1; i <= n; i++)
        c->c[i] /= sum; /* C[N] = 1 exactly, and so is every C after the last positive weight */
    c->total = ldexp(sum, scale.exponent);
    fill_guide(c->guide, c->n_guide, c->c, n);
    return BIS_OK;
}

void bis_cdf_clear(bis_cdf *c)
{
    bis_free(c->c);
    bis_free(c->guide);
    *c = (bis_cdf){0};
}

/* [cdf-search] */
size_t bis_cdf_sample(const bis_cdf *c, double u, double *remainder)
{
    assert(c->total > 0 && u >= 0 && u < 1);
    size_t g = bis_cdf_part(c, u);
    size_t i = c->guide[g], last = c->guide[g + 1];
    while (i < last) {
        size_t middle = i + (last - i + 1) / 2;
        if (c->c[middle] <= u)
            i = middle;
        else
            last = middle - 1;
    }
    if (remainder) {
        double r = (u - c->c[i]) / (c->c[i + 1] - c->c[i]);
        *remainder = fmin(r, 1 - DBL_EPSILON / 2); /* the two differences may round to the same number */
    }
    return i;
}
/* [end] */

double bis_cdf_pmf(const bis_cdf *c, size_t i) { return c->total > 0 ? c->c[i + 1] - c->c[i] : 0; }

size_t bis_cdf_bytes(const bis_cdf *c)
{
    return c->total > 0 ? (c->n + 1) * sizeof *c->c + (c->n_guide + 1) * sizeof *c->guide : 0;
}
