/* SPDX-License-Identifier: BSD-2-Clause */
/* mis: multiple importance sampling (Veach and Guibas 1995), which chapter 5 compares with.
 *
 * Of N samples, n_em come from the map and n_brdf = N - n_em from the BRDF. Each contributes F/(n_i q_i), times a
 * weight. The weight says how well this technique finds the direction, compared with the other technique. For every
 * direction the weights of the two add up to 1:
 *
 *     L = sum_i sum_j  h_i(wi_ij) F(wi_ij) V(wi_ij) / (n_i q_i(wi_ij)),
 *     h_i = n_i q_i / sum_k n_k q_k  (balance)    or    (n_i q_i)^2 / sum_k (n_k q_k)^2  (power).
 *
 * `compensate` concentrates the map's samples on its bright parts: q_em is built from max(0, Le - mean) (Karlik et
 * al. 2019). It is 0 over the dark parts, where the BRDF's samples then have all the weight.
 *
 * The estimate is unbiased for every N >= 2 and every split, compensated or not. Cost: N draws with two densities
 * each, and at most N shadow rays. */
#include "mis.h"
#include "proposal.h"

uint32_t bis_mis_samples_em(const bis_settings *s)
{
    double n = round(s->split * (double)s->samples);

    return (uint32_t)fmin(fmax(n, 1), (double)s->samples - 1); /* each technique gets at least one sample */
}

static unsigned light_needs(const bis_settings *s)
{
    return bis_em_samples_light_needs(s) | (s->compensate ? BIS_NEED_COMPENSATED : 0);
}

static void scratch_needs(const bis_settings *s, bis_needs *need)
{
    uint32_t n_em = bis_mis_samples_em(s), n_brdf = s->samples - n_em;

    need->n_points = n_brdf;
    bis_em_samples_scratch_needs(n_em, s, need);
}

/* Returns h of the technique with n q = own against the other technique. It works with their ratio, because one form
 * then serves both heuristics; a ratio of Inf is correct. */
/* [mis-weight] */
static double weight(bis_heuristic heuristic, double own, double other)
{
    double r = other / own;

    return 1 / (1 + (heuristic == BIS_HEURISTIC_POWER ? r * r : r));
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
        rgbd C = bis_estimate(f, y.Le, cos_theta, (double)n_em * y.pdf);
        if (rgbd_sum(C) <= 0) continue;
        C = rgbd_scale(C, weight(s->heuristic, (double)n_em * y.pdf, (double)n_brdf * q_brdf));
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
        C = rgbd_scale(C, weight(s->heuristic, (double)n_brdf * q_brdf, (double)n_em * q_em));
        bis_point_add(sum, pt, wi, C, NULL);
    }
}
/* [end] */

static rgb Lo(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch)
{
    const uint32_t n_em = bis_mis_samples_em(s), n_brdf = s->samples - n_em;
    rgbd sum = {0, 0, 0};

    if (bis_bsdf_is_black(&pt->bsdf) || bis_light_is_black(pt->light)) return (rgb){0, 0, 0};
    add_em(&sum, s, pt, stream, scratch, n_em, n_brdf);
    add_brdf(&sum, s, pt, stream, scratch->u, n_em, n_brdf);
    return rgbd_round(sum);
}

const bis_integrator bis_mis = {.name = "mis", .words = "both, combined by a heuristic",
    .claim = "unbiased", .light_needs = light_needs, .scratch_needs = scratch_needs, .Lo = Lo};
