/* SPDX-License-Identifier: BSD-2-Clause */
/* A slow walk from mark to mark, which is allowed; but marks that rounding leaves beyond the sum are lost, and the
 * offset is the same for all points. */
/* loses: candidates_are_chosen_in_proportion_to_their_weights */
/* loses: unbiased_for_few_candidates */
/* loses: unbiased_for_many_candidates */
/* [choose] */
BIS_LANES
static uint32_t choose_systematic(uint32_t *restrict item, uint32_t *restrict times, const float *restrict w,
                                  const float *restrict sum, uint32_t n_blocks, uint32_t N, double W, double offset)
{
    uint32_t n = 0, i = 0;
    double S = 0;

    (void)sum, (void)offset, (void)marks_below;
    for (uint32_t j = 0; j < N; j++) {
        const double mark = (j + 0.5) / N * W;
        while (i < BLOCK * n_blocks && S + (double)w[i] <= mark) S += (double)w[i++];
        if (i == BLOCK * n_blocks) break;
        if (n == 0 || item[n - 1] != i) {
            item[n] = i;
            times[n++] = 0;
        }
        times[n - 1]++;
    }
    return n;
}
/* [end] */
