/* SPDX-License-Identifier: BSD-2-Clause */
/* cdf: sampling a discrete distribution by inverting its cumulative distribution function. Source: thesis 3.2.2.
 *
 * C[0] = 0 and C[i+1] = C[i] + w[i], summed in double with compensation and normalised so that C[n] = 1 exactly. The
 * index of u is the largest i with C[i] <= u, because then an item of weight 0 is never returned (docs/errata.md E8).
 * A guide table (Chen and Asau 1974) makes the expected search O(1). It only says where the search starts, so it
 * rounds no probability (E10).
 *
 * The index is monotone in u. Stratified and low-discrepancy numbers therefore keep their structure, which the alias
 * method destroys (E12). Building costs O(n), sampling O(1) expected. A table takes 8 bytes an item and 4 bytes a
 * guide entry. */
#pragma once

#include "bis/base/status.h"

#include <stddef.h>
#include <stdint.h>

typedef struct bis_cdf {
    size_t n;
    /* the sum of the given weights. 0: nothing can be drawn. Infinite if the sum exceeds DBL_MAX; the table is right
     * even then */
    double total;
    double *c;       /* c[n + 1], c[0] = 0, c[n] = 1 */
    uint32_t *guide; /* guide[g]: the index of u = g / n_guide. guide[n_guide]: the last item of positive probability */
    size_t n_guide;  /* a power of two, because u n_guide is then exact */
} bis_cdf;

/* bis_cdf_init builds the table for the weights w[n] and copies what it needs. Each weight must be finite and >= 0
 * (asserted), and n < 2^32. A total of 0 is legal: it means "no light", and nothing can be drawn. Errors: BIS_NOMEM.
 * *c is then empty. */
bis_status bis_cdf_init(bis_cdf *c, const double *w, size_t n, bis_diag *diag);

/* bis_cdf_clear frees the table. *c is empty afterwards. */
void bis_cdf_clear(bis_cdf *c);

/* bis_cdf_sample returns an item, drawn with its probability. u is uniform in [0,1). *remainder (may be NULL)
 * receives the place of u between C[i] and C[i+1]: given i, it is uniform in [0,1) and has 53 + log2(pmf(i)) good
 * bits. c->total must be > 0. */
size_t bis_cdf_sample(const bis_cdf *c, double u, double *remainder);

/* bis_cdf_part returns the part of the guide that u, in [0,1), lies in: the search begins at guide[it] and ends at or
 * before guide[it + 1]. */
static inline size_t bis_cdf_part(const bis_cdf *c, double u)
{
    return (size_t)(u * (double)c->n_guide); /* exact: n_guide is a power of two */
}

/* bis_cdf_pmf returns the probability of item i, which is < n. */
double bis_cdf_pmf(const bis_cdf *c, size_t i);

/* bis_cdf_bytes returns the bytes that the table takes. */
size_t bis_cdf_bytes(const bis_cdf *c);
