/* SPDX-License-Identifier: BSD-2-Clause */
/* Two slips: the cosine is forgotten in the samples of the map, and the heuristic is always the balance heuristic. The
 * first one counts once, and does not hide the second. */
/* loses: a_diffuse_surface_in_the_open_is_right */
/* loses: the_power_heuristic_is_right */
/* loses: the_noise_is_that_of_the_power_heuristic */
/* [mis-weight] */
static double weight(bis_heuristic heuristic, double own, double other)
{
    (void)heuristic;
    return own / (own + other);
}
/* [end] */
/* [mis-em] */
static void add_em(rgbd *sum, const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch,
                   uint32_t n_em, uint32_t n_brdf)
{
    const bis_bsdf *bsdf = &pt->bsdf;

    const bis_em_samples samples = bis_em_samples_start(n_em, s, stream, scratch);
    for (uint32_t j = 0; j < n_em; j++) {
        bis_light_point y;
        /* false: there is no light, or compensation left nothing; the BRDF's samples do everything */
        const bool drawn = bis_em_sample(&y, &samples, j, pt->light, stream);
        if (!drawn) break;

        double q_brdf, cos_theta = bis_bsdf_cos(bsdf, y.wi);
        if (cos_theta <= 0) continue;
        rgb f = bis_bsdf_f_pdf(bsdf, y.wi, &q_brdf);
        rgbd C = bis_estimate(f, y.Le, 1, (double)n_em * y.pdf);
        if (rgbd_sum(C) <= 0) continue;
        C = rgbd_scale(C, weight(s->heuristic, (double)n_em * y.pdf, (double)n_brdf * q_brdf));
        bis_point_add(sum, pt, y.wi, C, NULL);
    }
}
/* [end] */
