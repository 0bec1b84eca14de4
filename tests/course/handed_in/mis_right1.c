/* SPDX-License-Identifier: BSD-2-Clause */
/* Sums in float, one for each technique; the weights by pow, as they are written; rays last. */
/* [mis-weight] */
static double weight(bis_heuristic heuristic, double own, double other)
{
    const double beta = heuristic == BIS_HEURISTIC_POWER ? 2 : 1, mine = pow(own, beta);

    return mine / (mine + pow(other, beta));
}

static rgb plus(rgb a, rgb b) { return (rgb){a.r + b.r, a.g + b.g, a.b + b.b}; }
/* [end] */
/* [mis-em] */
static void add_em(rgbd *sum, const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch,
                   uint32_t n_em, uint32_t n_brdf)
{
    bis_em_samples samples = bis_em_samples_start(n_em, s, stream, scratch);
    rgb all = {0, 0, 0};

    for (uint32_t j = 0; j < n_em; j++) {
        bis_light_point y;
        double q2;
        if (!bis_em_sample(&y, &samples, j, pt->light, stream)) return;
        const double c = dot(pt->n, y.wi), n1q1 = (double)n_em * y.pdf;
        const rgb f = bis_bsdf_f_pdf(&pt->bsdf, y.wi, &q2);
        if (c <= 0 || rgb_is_black(f) || rgb_is_black(y.Le) || !bis_point_sees(pt, y.wi)) continue;
        const float h = (float)(weight(s->heuristic, n1q1, (double)n_brdf * q2) * c / n1q1);
        all = plus(all, (rgb){f.r * y.Le.r * h, f.g * y.Le.g * h, f.b * y.Le.b * h});
    }
    *sum = rgbd_add(*sum, (rgbd){(double)all.r, (double)all.g, (double)all.b});
}
/* [end] */
/* [mis-brdf] */
static void add_brdf(rgbd *sum, const bis_settings *s, const bis_point *pt, bis_stream *stream, double (*u)[2],
                     uint32_t n_em, uint32_t n_brdf)
{
    rgb all = {0, 0, 0};

    bis_stream_points(stream, BIS_DIM_BRDF, n_brdf, u);
    for (uint32_t j = 0; j < n_brdf; j++) {
        vec3 wi;
        double q1, q2;
        if (!bis_bsdf_draw(&pt->bsdf, u[j], &wi)) return;
        const double c = dot(pt->n, wi);
        const rgb f = bis_bsdf_f_pdf(&pt->bsdf, wi, &q2), Le = bis_light_Le_pdf(pt->light, wi, &q1);
        if (c <= 0 || q2 <= 0 || rgb_is_black(f) || rgb_is_black(Le) || !bis_point_sees(pt, wi)) continue;
        const float h = (float)(weight(s->heuristic, n_brdf * q2, n_em * q1) * c / (n_brdf * q2));
        all = plus(all, (rgb){f.r * Le.r * h, f.g * Le.g * h, f.b * Le.b * h});
    }
    *sum = rgbd_add(*sum, (rgbd){(double)all.r, (double)all.g, (double)all.b});
}
/* [end] */
