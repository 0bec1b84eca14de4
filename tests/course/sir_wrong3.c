/* SPDX-License-Identifier: BSD-2-Clause */
/* All M candidates are traced: right in the mean, with less noise, and M rays where N were allowed. */
/* loses: unbiased_for_few_candidates */
/* loses: unbiased_for_many_candidates */
/* loses: rays_add_no_noise_where_nothing_is_hidden */
    /* [sir-estimate] */
    uint32_t n = 0;
    (void)N;
    for (uint32_t i = 0; i < set->choice.n; i++) {
        if (set->choice.w[i] > 0) set->choice.item[n++] = i;
    }
    for (uint32_t k = 0; k < n; k++) {
        const uint32_t i = set->choice.item[0] = set->choice.item[k];
        bis_set_take(set, 1);
        L = bis_set_trace(L, set, pt, bis_set_weight(set, i) / M);
    }
    /* [end] */
