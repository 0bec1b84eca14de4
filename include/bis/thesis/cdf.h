/* cdf: sampling a discrete distribution by inverting its cumulative distribution function, thesis 3.2.2.
 *
 * C[0] = 0, C[i+1] = C[i] + w[i] in double (compensated), normalised so that C[n] = 1 exactly; an index is found as the
 * largest i with C[i] <= u, so that an item of weight 0 is never returned (docs/errata.md E8). A guide table (Chen and
 * Asau 1974) makes the expected search O(1): it only tells where to start, so it rounds no probability (E10).
 * Monotone in u: stratified and low-discrepancy numbers keep their structure, which the alias method destroys (E12).
 * Build O(n), sample O(1) expected; 8 bytes an item and 4 a guide entry. */
#ifndef BIS_CDF_H
#define BIS_CDF_H

#include "bis/base/status.h"

#include <stddef.h>
#include <stdint.h>

typedef struct bis_cdf {
    size_t n;
    double total;    /* sum of the weights as given; 0: nothing can be drawn; infinite where it exceeds DBL_MAX, which harms nothing */
    double *c;       /* c[n + 1], c[0] = 0, c[n] = 1 */
    uint32_t *guide; /* guide[g] = index of u = g / n_guide; guide[n_guide] = last item of positive probability */
    size_t n_guide;  /* a power of two, so that u n_guide is exact */
} bis_cdf;

/* w[n], each finite and >= 0 (asserted), n < 2^32. Copies what it needs. total = 0 is legal: "no light".
 * Errors: BIS_NOMEM, *c is cleared. */
bis_status bis_cdf_init(bis_cdf *c, const double *w, size_t n, bis_diag *diag);
void bis_cdf_clear(bis_cdf *c);

/* u in [0,1). *remainder (may be NULL): where u lies between C[i] and C[i+1], uniform in [0,1) given i; it has
 * 53 + log2(pmf(i)) good bits. total must be > 0. */
size_t bis_cdf_sample(const bis_cdf *c, double u, double *remainder);

/* Probability of item i. */
double bis_cdf_pmf(const bis_cdf *c, size_t i);
size_t bis_cdf_bytes(const bis_cdf *c);

#endif
