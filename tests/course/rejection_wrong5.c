/* SPDX-License-Identifier: BSD-2-Clause */
/* Weights as they lie in the set, in a unit that is not that of B. */
/* loses: candidates_of_the_map_are_accepted_with_probability_w_over_B */
/* loses: candidates_of_the_brdf_are_accepted_with_probability_w_over_B */
/* loses: the_smaller_bound_is_chosen_more_often */
/* loses: one_candidate_and_one_ray_are_right */
/* loses: many_rays_are_right */
/* loses: fewer_rays_than_accepted_are_right */
/* [accept] */
static uint32_t accept(bis_set *x, double B, bis_stream *stream)
{
    uint32_t A = 0;

    for (uint32_t i = 0; i < x->choice.n; i++) {
        const double w = (double)x->choice.w[i];
        if (w > 0 && bis_stream_random(stream) * B < w) x->choice.item[A++] = i;
    }
    return A;
}
/* [end] */
