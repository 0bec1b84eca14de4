/* SPDX-License-Identifier: BSD-2-Clause */
/* alias: sampling a discrete distribution in O(1). Source: thesis 3.2.2, figure 3.4 and appendix A (Walker 1977, Vose
 * 1991).
 *
 * The two tables are those of the thesis: bin i returns i with probability prob[i], and alias[i] otherwise. They are
 * built in double from a copy of the weights, which are first scaled by n/sum (docs/errata.md E13, E15, E16).
 * Building costs O(n), sampling O(1); the tables take 12 bytes an item. */
#pragma once

#include "bis/base/status.h"

#include <stddef.h>
#include <stdint.h>

typedef struct bis_alias {
    size_t n;
    /* the sum of the given weights. 0: nothing can be drawn. Infinite if the sum exceeds DBL_MAX; the tables are
     * right even then */
    double total;
    double *prob;    /* prob[n], each in [0,1] */
    uint32_t *alias; /* alias[n], each < n */
} bis_alias;

/* bis_alias_init builds the tables for the weights w[n]. Each weight must be finite and >= 0 (asserted), and n <
 * 2^32. A total of 0 is legal: it means "no light", and nothing can be drawn; it never means a uniform distribution.
 * Errors: BIS_NOMEM. *a is then empty. */
bis_status bis_alias_init(bis_alias *a, const double *w, size_t n, bis_diag *diag);

/* bis_alias_clear frees the tables. *a is empty afterwards. */
void bis_alias_clear(bis_alias *a);

/* bis_alias_builder is the type of bis_alias_build and bis_alias_build_raw. Such a function fills prob[n] and
 * alias[n] from the weights w[n]. work[n] is its workspace; prob may be w itself. It returns the sum of the weights;
 * if this is 0, all prob[i] are 0. It serves callers that hold many small tables in two large arrays, like the rows
 * of an environment map. */
typedef double bis_alias_builder(double *prob, uint32_t *alias, const double *w, uint32_t *work, size_t n);

/* bis_alias_build scales the weights by n/sum and builds the tables (docs/errata.md E13). */
bis_alias_builder bis_alias_build;

/* bis_alias_build_raw builds the tables without scaling, as appendix A is printed. The result is wrong unless the
 * weights sum to 1 (docs/errata.md E13, `--as-printed`). */
bis_alias_builder bis_alias_build_raw;

/* bis_alias_init_by does the same as bis_alias_init, with the builder `build`. */
bis_status bis_alias_init_by(bis_alias *a, bis_alias_builder *build, const double *w, size_t n, bis_diag *diag);

/* bis_alias_sample returns an item, drawn with probability w[item]/total. u is uniform in [0,1). The integer part of
 * u n chooses the bin, and the fraction decides between the bin's two items: for n <= 2^24 at least 29 bits are left
 * for the fraction. a->total must be > 0. */
size_t bis_alias_sample(const bis_alias *a, double u);

/* bis_alias_pick does the same with the tables prob[n] and alias[n] of a bis_alias_builder. */
size_t bis_alias_pick(const double *prob, const uint32_t *alias, size_t n, double u);

/* bis_alias_implied_pmf computes the probabilities pmf[n] that the tables really give: pmf[i] = (prob[i] + sum of (1
 * - prob[j]) over all j with alias[j] = i) / n. It is the exact test of a table (docs/errata.md E15): pmf[i] equals
 * w[i]/total to a relative error of 1e-8. */
void bis_alias_implied_pmf(const bis_alias *a, double *pmf);

/* bis_alias_bytes returns the bytes that the tables take. */
size_t bis_alias_bytes(const bis_alias *a);
