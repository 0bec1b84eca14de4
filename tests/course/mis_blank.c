/* SPDX-License-Identifier: BSD-2-Clause */
/* [mis-weight] */
static double weight(bis_heuristic heuristic, double own, double other)
{
    /* Yours to write: h of the technique with n q = own against the other's. */
    (void)heuristic, (void)own, (void)other;
    return 0;
}
/* [end] */
/* [mis-em] */
static void add_em(rgbd *sum, const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch,
    uint32_t n_em, uint32_t n_brdf)
{
    /* Yours to write: add the samples of the map, n_em of them, to *sum. src/thesis/em.c shows how they are drawn;
     * src/thesis/proposal.h has bis_estimate, F/q. */
    (void)sum, (void)s, (void)pt, (void)stream, (void)scratch, (void)n_em, (void)n_brdf, (void)weight;
}
/* [end] */
/* [mis-brdf] */
static void add_brdf(rgbd *sum, const bis_settings *s, const bis_point *pt, bis_stream *stream, double (*u)[2],
    uint32_t n_em, uint32_t n_brdf)
{
    /* Yours to write: add the samples of the BRDF, n_brdf of them, to *sum, as in src/thesis/brdf.c. */
    (void)sum, (void)s, (void)pt, (void)stream, (void)u, (void)n_em, (void)n_brdf;
}
/* [end] */
