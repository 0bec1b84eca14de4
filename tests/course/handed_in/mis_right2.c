/* SPDX-License-Identifier: BSD-2-Clause */
/* The directions are kept first, and looked at from the last to the first. */
/* [mis-weight] */
static double weight(bis_heuristic heuristic, double own, double other)
{
    if (heuristic == BIS_HEURISTIC_POWER) own *= own, other *= other;
    return own / (own + other);
}
/* [end] */
/* [mis-em] */
static void add_em(rgbd *sum, const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch,
                   uint32_t n_em, uint32_t n_brdf)
{
    const bis_em_samples samples = bis_em_samples_start(n_em, s, stream, scratch);
    bis_light_point y[1000];
    uint32_t n = 0;

    while (n < n_em && n < 1000 && bis_em_sample(&y[n], &samples, n, pt->light, stream)) n++;
    while (n-- > 0) {
        double q2;
        const double c = bis_bsdf_cos(&pt->bsdf, y[n].wi);
        const rgb f = bis_bsdf_f_pdf(&pt->bsdf, y[n].wi, &q2);
        const double h = weight(s->heuristic, y[n].pdf * n_em, q2 * n_brdf);
        const rgbd C = bis_estimate(f, y[n].Le, c > 0 ? c * h : 0, y[n].pdf * n_em);
        if (rgbd_sum(C) > 0 && bis_point_sees(pt, y[n].wi)) *sum = rgbd_add(*sum, C);
    }
}
/* [end] */
