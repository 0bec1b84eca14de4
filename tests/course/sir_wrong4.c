/* SPDX-License-Identifier: BSD-2-Clause */
/* The first N candidates, as plain importance sampling has it: as noisy as N samples, and wrong where candidates are in
 * order. */
/* loses: unbiased_for_few_candidates */
/* loses: unbiased_for_many_candidates */
/* loses: rays_add_no_noise_where_nothing_is_hidden */
    /* [sir-estimate] */
    const uint32_t n = N < M ? N : M;
    for (uint32_t i = 0; i < n; i++) {
        const double w = bis_set_weight(set, i);
        if (w <= 0) continue;
        set->choice.item[0] = i;
        bis_set_take(set, 1);
        L = bis_set_trace(L, set, pt, w / n);
    }
    /* [end] */
