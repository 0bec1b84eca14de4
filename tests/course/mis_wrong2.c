/* SPDX-License-Identifier: BSD-2-Clause */
/* The samples of the map come in full, without their weight: what the BRDF also finds counts twice. */
/* loses: a_diffuse_surface_in_the_open_is_right */
/* [mis-em] */
static void add_em(rgbd *sum, const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch,
    uint32_t n_em, uint32_t n_brdf)
{
    const bis_bsdf *bsdf = &pt->bsdf;

    (void)n_brdf;
    const bis_em_samples samples = bis_em_samples_start(n_em, s, stream, scratch);
    for (uint32_t j = 0; j < n_em; j++) {
        bis_light_point y;
        if (!bis_em_sample(&y, &samples, j, pt->light, stream)) break;
        double cos_theta = bis_bsdf_cos(bsdf, y.wi);
        if (cos_theta <= 0) continue;
        rgbd C = bis_estimate(bis_bsdf_f(bsdf, y.wi), y.Le, cos_theta, (double)n_em * y.pdf);
        if (rgbd_sum(C) <= 0 || !bis_point_sees(pt, y.wi)) continue;
        *sum = rgbd_add(*sum, C);
    }
}
/* [end] */
