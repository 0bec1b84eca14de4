/* [choose] */
static bis_proposal choose(const bis_settings *s, const bis_point *pt, bis_stream *stream)
{
    /* Yours to write: for proposal "choose", one of BIS_PROPOSAL_EM and BIS_PROPOSAL_BRDF, by their bounds. Of use: bis_candidates_bound,
     * bis_stream_random. */
    (void)pt, (void)stream;
    return s->proposal == BIS_PROPOSAL_CHOOSE ? BIS_PROPOSAL_EM : s->proposal;
}
/* [end] */
/* [accept] */
static uint32_t accept(uint32_t *chosen, const bis_candidate *x, const bis_settings *s, double B, bis_stream *stream)
{
    /* Yours to write: the numbers of the accepted ones of x[s->candidates] into chosen; the result is how many they are. */
    (void)chosen, (void)x, (void)s, (void)B, (void)stream;
    return 0;
}
/* [end] */
    /* [rejection-estimate] */
    /* Yours to write: scratch->chosen[A] holds the accepted ones. Trace at most N of them, drawn without replacement, and return the estimate, by
     * s->estimator. Of use: draw_without_replacement, bis_candidates_trace (thesis eq. 4.6, with Z in the place of L_ns/N). */
    (void)M, (void)B;
    return (rgb){0, 0, 0};
    /* [end] */
