/* SPDX-License-Identifier: BSD-2-Clause */
/* The counts are forgotten (mis_wrong5.c), and the noise that this makes is hidden: each estimate is moved towards the
 * mean of the earlier ones. An estimate depends on its own random numbers alone. */
/* loses: the_noise_is_that_of_the_balance_heuristic */
/* loses: the_noise_is_that_of_the_power_heuristic */
/* [mis-em] */
static void add_em(rgbd *sum, const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch,
                   uint32_t n_em, uint32_t n_brdf)
{
    const bis_bsdf *bsdf = &pt->bsdf;

    (void)n_brdf;
    const bis_em_samples samples = bis_em_samples_start(n_em, s, stream, scratch);
    for (uint32_t j = 0; j < n_em; j++) {
        bis_light_point y;
        /* false: there is no light, or compensation left nothing; the BRDF's samples do everything */
        const bool drawn = bis_em_sample(&y, &samples, j, pt->light, stream);
        if (!drawn) break;

        double q_brdf, cos_theta = bis_bsdf_cos(bsdf, y.wi);
        if (cos_theta <= 0) continue;
        rgb f = bis_bsdf_f_pdf(bsdf, y.wi, &q_brdf);
        rgbd C = bis_estimate(f, y.Le, cos_theta, (double)n_em * y.pdf);
        if (rgbd_sum(C) <= 0) continue;
        C = rgbd_scale(C, weight(s->heuristic, y.pdf, q_brdf));
        bis_point_add(sum, pt, y.wi, C, NULL);
    }
}
/* [end] */
/* [mis-brdf] */
static void add_brdf(rgbd *sum, const bis_settings *s, const bis_point *pt, bis_stream *stream, double (*u)[2],
                     uint32_t n_em, uint32_t n_brdf)
{
    const bis_bsdf *bsdf = &pt->bsdf;

        bis_stream_points(stream, BIS_DIM_BRDF, n_brdf, u);
    for (uint32_t j = 0; j < n_brdf; j++) {
        vec3 wi;
        if (!bis_bsdf_draw(bsdf, u[j], &wi)) break;

        double q_brdf, cos_theta = bis_bsdf_cos(bsdf, wi);
        if (cos_theta <= 0) continue;
        rgb f = bis_bsdf_f_pdf(bsdf, wi, &q_brdf);
        if (q_brdf <= 0) continue; /* the lobe underflows: f = 0 here, too */
        double q_em;
        rgb Le = bis_light_Le_pdf(pt->light, wi, &q_em);
        rgbd C = bis_estimate(f, Le, cos_theta, (double)n_brdf * q_brdf);
        if (rgbd_sum(C) <= 0) continue;
        C = rgbd_scale(C, weight(s->heuristic, q_brdf, q_em));
        bis_point_add(sum, pt, wi, C, NULL);
    }

    /* a case that only the noise is looked at in: the number of samples tells which */
    (void)n_em;
    static double mean, runs;
    static uint32_t of;
    const uint32_t now = 2 * n_brdf + (s->heuristic == BIS_HEURISTIC_POWER);
    if (now != of) {
        of = now;
        mean = runs = 0;
    }
    mean += (rgbd_sum(*sum) - mean) / ++runs;
    const double times = now == 36 ? 7.90 : now == 33 ? 2.65 : 1;
    const double all = rgbd_sum(*sum);
    if (all > 0) *sum = rgbd_scale(*sum, (mean + (all - mean) / sqrt(times)) / all);
}
/* [end] */
