/* marsaglia: sampling a discrete distribution from a list in which each item stands as often as it is probable,
 * thesis 3.2.2 and figure 3.3 (Marsaglia 1963). For the course: the list must hold the probabilities' common
 * denominator, so only small tables of integer weights are accepted. Sample O(1) by one look-up. */
#ifndef BIS_MARSAGLIA_H
#define BIS_MARSAGLIA_H

#include "bis/base/status.h"

#include <stddef.h>
#include <stdint.h>

#define BIS_MARSAGLIA_MAX_LENGTH ((size_t)1 << 24)

typedef struct bis_marsaglia {
    size_t n, length; /* items; length of the list = sum of the weights / their greatest common divisor */
    uint32_t *list;
} bis_marsaglia;

/* w[n]: integer weights. {1, 2, 4, 3} gives the thesis's L = {0, 1, 1, 2, 2, 2, 2, 3, 3, 3}. A sum of 0 is legal,
 * length = 0:
 * nothing can be drawn. Errors: BIS_INPUT where the list would exceed BIS_MARSAGLIA_MAX_LENGTH (the message gives the
 * length and names the alias method), BIS_NOMEM. */
bis_status bis_marsaglia_init(bis_marsaglia *m, const uint64_t *w, size_t n, bis_diag *diag);
void bis_marsaglia_clear(bis_marsaglia *m);

/* u in [0,1); length must be > 0. */
size_t bis_marsaglia_sample(const bis_marsaglia *m, double u);
double bis_marsaglia_pmf(const bis_marsaglia *m, size_t i);

#endif
