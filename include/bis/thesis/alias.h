/* alias: sampling a discrete distribution in O(1), thesis 3.2.2, figure 3.4 and appendix A (Walker 1977, Vose 1991).
 *
 * The two tables are the thesis's: bin i returns i with probability prob[i], else alias[i]. Built in double from a copy
 * of the weights, scaled by n/sum (docs/errata.md E13, E15, E16). Build O(n), sample O(1), 12 bytes an item. */
#ifndef BIS_ALIAS_H
#define BIS_ALIAS_H

#include "bis/base/status.h"

#include <stddef.h>
#include <stdint.h>

typedef struct bis_alias {
    size_t n;
    double total;    /* sum of the weights as given; 0: nothing can be drawn; infinite where it exceeds DBL_MAX, which harms nothing */
    double *prob;    /* prob[n], each in [0,1] */
    uint32_t *alias; /* alias[n], each < n */
} bis_alias;

/* w[n], each finite and >= 0 (asserted), n < 2^32. total = 0 is legal: "no light", never uniform. Errors: BIS_NOMEM. */
bis_status bis_alias_init(bis_alias *a, const double *w, size_t n, bis_diag *diag);
void bis_alias_clear(bis_alias *a);

/* Fill prob[n] and alias[n] for w[n] with a workspace of n uint32; prob may be w itself. Returns the sum of the weights
 * (0: the tables are all prob = 0). For callers that hold many small tables in two large arrays, like the rows of an
 * environment map. */
typedef double bis_alias_builder(double *prob, uint32_t *alias, const double *w, uint32_t *work, size_t n);
bis_alias_builder bis_alias_build;

/* The same without normalising, as appendix A is printed: wrong unless the weights sum to 1 (docs/errata.md E13,
 * `--as-printed`). */
bis_alias_builder bis_alias_build_raw;
bis_status bis_alias_init_by(bis_alias *a, bis_alias_builder *build, const double *w, size_t n, bis_diag *diag);

/* u in [0,1) chooses the bin, its fraction the coin: with n <= 2^24 items, at least 29 bits are left for it. total must
 * be > 0. */
size_t bis_alias_sample(const bis_alias *a, double u);
size_t bis_alias_pick(const double *prob, const uint32_t *alias, size_t n, double u);

/* The probabilities that the tables really give, pmf[n]: (prob[i] + sum over alias[j] = i of (1 - prob[j])) / n. The
 * exact test of a table (docs/errata.md E15): equals w[i]/total to 1e-8 relative. */
void bis_alias_implied_pmf(const bis_alias *a, double *pmf);
size_t bis_alias_bytes(const bis_alias *a);

#endif
