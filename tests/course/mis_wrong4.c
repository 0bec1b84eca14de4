/* SPDX-License-Identifier: BSD-2-Clause */
/* Always the balance heuristic; rays before anybody asks whether they are worth it. */
/* loses: the_noise_is_that_of_the_power_heuristic */
/* loses: each_sample_casts_one_ray_at_most */
/* [mis-weight] */
static double weight(bis_heuristic heuristic, double own, double other)
{
    (void)heuristic;
    return own / (own + other);
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
        if (q_brdf <= 0) continue; /* where the lobe underflows: f = 0 there, too */
        double q_em;
        rgb Le = bis_light_Le_pdf(pt->light, wi, &q_em);
        rgbd C = bis_estimate(f, Le, cos_theta, (double)n_brdf * q_brdf);
        if (!bis_point_sees(pt, wi)) continue;
        *sum = rgbd_add(*sum, rgbd_scale(C, weight(s->heuristic, (double)n_brdf * q_brdf, (double)n_em * q_em)));
    }
}
/* [end] */
