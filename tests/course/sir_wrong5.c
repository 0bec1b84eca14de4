/* SPDX-License-Identifier: BSD-2-Clause */
/* The sum over the rays is taken for their mean: N is forgotten. */
/* loses: unbiased_for_few_candidates */
/* loses: unbiased_for_many_candidates */
/* loses: rays_add_no_noise_where_nothing_is_hidden */
    /* [sir-estimate] */
    bis_set_choose(set, N, s->resampling, stream);
    L = bis_set_trace(L, set, pt, Zhat);
    /* [end] */
