/* SPDX-License-Identifier: BSD-2-Clause */
/* marsaglia: sampling a discrete distribution from a list in which an item stands as often as its probability says.
 * Source: thesis 3.2.2 and figure 3.3 (Marsaglia 1963). For the course. The length of the list is the common
 * denominator of the probabilities, so only small tables of integer weights are accepted. Sampling costs O(1): one
 * look-up. */
#pragma once

#include "bis/base/status.h"

#include <stddef.h>
#include <stdint.h>

#define BIS_MARSAGLIA_MAX_LENGTH ((size_t)1 << 24)

typedef struct bis_marsaglia {
    size_t n, length; /* n: items; length of the list: sum of the weights / their greatest common divisor */
    uint32_t *list;
} bis_marsaglia;

/* bis_marsaglia_init builds the list for the integer weights w[n]. {1, 2, 4, 3} gives the thesis's L = {0, 1, 1, 2,
 * 2, 2, 2, 3, 3, 3}. A sum of 0 is legal: length is then 0, and nothing can be drawn. Errors: BIS_INPUT if the list
 * would exceed BIS_MARSAGLIA_MAX_LENGTH (the message gives the length and names the alias method), BIS_NOMEM. */
bis_status bis_marsaglia_init(bis_marsaglia *m, const uint64_t *w, size_t n, bis_diag *diag);

/* bis_marsaglia_clear frees the list. *m is empty afterwards. */
void bis_marsaglia_clear(bis_marsaglia *m);

/* bis_marsaglia_sample returns the item at position u of the list. u is uniform in [0,1). m->length must be > 0. */
size_t bis_marsaglia_sample(const bis_marsaglia *m, double u);

/* bis_marsaglia_pmf returns the probability of item i, which is < n. It is 0 if the list is empty. */
double bis_marsaglia_pmf(const bis_marsaglia *m, size_t i);
