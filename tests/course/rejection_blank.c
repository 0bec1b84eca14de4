/* SPDX-License-Identifier: BSD-2-Clause */
/* [choose-proposal] */
static bis_proposal choose_proposal(const bis_settings *s, const bis_point *pt, bis_stream *stream)
{
    /* Yours to write: for proposal "choose", one of BIS_PROPOSAL_EM and BIS_PROPOSAL_BRDF, by their bounds. Of use:
     * bis_candidates_bound, bis_stream_random. */
    (void)pt, (void)stream;
    return s->proposal == BIS_PROPOSAL_CHOOSE ? BIS_PROPOSAL_EM : s->proposal;
}
/* [end] */
/* [accept] */
static uint32_t accept(bis_set *set, double B, bis_stream *stream)
{
    /* Yours to write: the numbers of the accepted ones of set->choice.n candidates into set->choice.item; the result is
     * how many they are. Of use: bis_set_weight, bis_stream_random. */
    (void)set, (void)B, (void)stream;
    return 0;
}
/* [end] */
    /* [rejection-estimate] */
    /* Yours to write: set->choice.item[A] holds the accepted ones. Trace at most N of them, drawn without replacement,
     * and return the estimate, by s->estimator. Of use: draw_without_replacement, bis_set_take, bis_set_trace
     * (thesis eq. 4.6, with Z in the place of L_ns/N). The line that is there belongs between the last two: it makes
     * an erratum of the thesis, if the command line asks for it. */
    (void)M, (void)B, (void)draw_without_replacement;
    if (s->as_printed & BIS_E6) bis_as_printed_colours(set);
    return (rgb){0, 0, 0};
    /* [end] */
