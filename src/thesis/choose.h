/* SPDX-License-Identifier: BSD-2-Clause */
/* choose: resampling (thesis 4.4): of n weights w_i, N are chosen with probabilities w_i/W, where W = sum w_i.
 *
 * N marks lie on the running sum S_i = w_1 + ... + w_i, and item i gets the marks between S_(i-1) and S_i. Systematic
 * marks are equally spaced, (j + offset)/N of W with one random offset for all. Multinomial marks are N independent
 * random numbers. In both cases the expected number of marks on item i is N w_i/W. */
#pragma once

#include "bis/base/mem.h"
#include "bis/thesis/lanes.h"
#include "bis/thesis/sampler.h"

/* Weights, whole blocks of lanes, and what was chosen of them: item[j] got times[j] > 0 marks, j < n_chosen. The items
 * ascend. */
typedef struct bis_choice {
    float *w;               /* [n] */
    float *sum;             /* [blocks]: of the weights of each block */
    uint32_t *item, *times; /* [n + 1]: one more may be written than is chosen */
    uint32_t n, n_chosen;
} bis_choice;

/* bis_choice_claim allocates room for n weights, a whole number of blocks, as claims say. */
void bis_choice_claim(bis_choice *c, uint32_t n, bis_claims *claims);

/* bis_choice_clear frees the arrays. */
void bis_choice_clear(bis_choice *c);

/* bis_choice_sum returns W, the sum of w[n], and stores the sums of the blocks. n is a whole number of blocks, at most
 * as claimed. The order of the sums is the same for all widths of vectors. */
double bis_choice_sum(bis_choice *c, uint32_t n);

/* bis_choose_systematic chooses by N equally spaced marks. W > 0 is what bis_choice_sum has returned. offset is in
 * [0,1); N is at most 2^24. An item of weight 0 is never chosen. */
void bis_choose_systematic(bis_choice *c, uint32_t N, double W, double offset);

/* bis_choose_multinomial chooses by N independent marks. W > 0 is what bis_choice_sum has returned. */
void bis_choose_multinomial(bis_choice *c, uint32_t N, double W, bis_stream *stream);
