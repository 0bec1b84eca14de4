/* SPDX-License-Identifier: BSD-2-Clause */
/* One random number for all candidates: in the mean as many are accepted, but all or none. */
/* loses: candidates_of_the_map_are_accepted_with_probability_w_over_B */
/* loses: candidates_of_the_brdf_are_accepted_with_probability_w_over_B */
/* loses: the_ratio_estimator_is_right_to_two_percent */
/* [accept] */
static uint32_t accept(bis_set *x, double B, bis_stream *stream)
{
    const double u = bis_stream_random(stream);
    uint32_t A = 0;

    for (uint32_t i = 0; i < x->choice.n; i++) {
        if (u * B < bis_set_weight(x, i)) x->choice.item[A++] = i;
    }
    return A;
}
/* [end] */
