/* SPDX-License-Identifier: BSD-2-Clause */
/* All M candidates are traced: right in the mean, with less noise, and M rays where N were allowed. */
/* loses: unbiased_for_few_candidates */
/* loses: unbiased_for_many_candidates */
/* loses: rays_add_no_noise_where_nothing_is_hidden */
    /* [sir-estimate] */
    uint32_t n = 0;
    (void)N;
    for (uint32_t i = 0; i < x->choice.n; i++) {
        if (x->choice.w[i] > 0) x->choice.item[n++] = i;
    }
    for (uint32_t k = 0; k < n; k++) {
        const uint32_t i = x->choice.item[0] = x->choice.item[k];
        bis_set_take(x, 1);
        L = bis_set_trace(L, x, pt, bis_set_weight(x, i) / M);
    }
    /* [end] */
