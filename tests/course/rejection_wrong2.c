/* SPDX-License-Identifier: BSD-2-Clause */
/* Accepting ends when there are enough to trace (E22), here four, and the first N are traced; the larger bound is
 * preferred. */
/* loses: candidates_of_the_brdf_are_accepted_with_probability_w_over_B */
/* loses: the_smaller_bound_is_chosen_more_often */
/* loses: fewer_rays_than_accepted_are_right */
/* [choose-proposal] */
static bis_proposal choose_proposal(const bis_settings *s, const bis_point *pt, bis_stream *stream)
{
    if (s->proposal != BIS_PROPOSAL_CHOOSE) return s->proposal;

    double c_em = bis_candidates_bound(pt, BIS_PROPOSAL_EM), c_brdf = bis_candidates_bound(pt, BIS_PROPOSAL_BRDF);
    return bis_stream_random(stream) * (c_em + c_brdf) < c_em ? BIS_PROPOSAL_EM : BIS_PROPOSAL_BRDF;
}
/* [end] */
/* [accept] */
static uint32_t accept(bis_set *x, double B, bis_stream *stream)
{
    uint32_t A = 0;

    for (uint32_t i = 0; i < x->choice.n && A < 4; i++) {
        const double w = bis_set_weight(x, i);
        if (w > 0 && bis_stream_random(stream) * B < w) x->choice.item[A++] = i;
    }
    return A;
}
/* [end] */
