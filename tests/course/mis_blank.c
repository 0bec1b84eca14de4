/* [mis-weight] */
static double weight(bis_heuristic heuristic, double own, double other)
{
    /* Yours to write: h of the technique with n q = own against the other's. */
    (void)heuristic, (void)own, (void)other;
    return 0;
}
/* [end] */
/* [mis-em] */
static rgbd sum_em(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch, uint32_t n_em, uint32_t n_brdf)
{
    /* Yours to write: the sum over n_em samples of the map. src/thesis/em.c shows how they are drawn; src/thesis/proposal.h has bis_estimate, F/q. */
    (void)s, (void)pt, (void)stream, (void)scratch, (void)n_em, (void)n_brdf, (void)weight;
    return (rgbd){0, 0, 0};
}
/* [end] */
/* [mis-brdf] */
static rgbd sum_brdf(const bis_settings *s, const bis_point *pt, bis_stream *stream, double (*u)[2], uint32_t n_em, uint32_t n_brdf)
{
    /* Yours to write: the sum over n_brdf samples of the BRDF, as in src/thesis/brdf.c. */
    (void)s, (void)pt, (void)stream, (void)u, (void)n_em, (void)n_brdf;
    return (rgbd){0, 0, 0};
}
/* [end] */
