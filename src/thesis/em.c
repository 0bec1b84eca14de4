/* SPDX-License-Identifier: BSD-2-Clause */
/* em: importance sampling from the environment map. Source: thesis 3.3 and the estimator L_{N,L} of 4.1.
 *
 *     L = (1/N) sum_j f(wi_j, wo) cos theta_j Le(wi_j) V(wi_j) / q_L(wi_j),     wi_j ~ q_L
 *
 * This is eq. 3.4 for the integral of eq. 4.1, read as eq. 3.3 with p = q_L (eq. 4.2) and the integrand over p for f.
 * The thesis cancels Le/q_L against the integral of the map. We do not: q_L is the density of a table whose entries
 * may be area-weighted (3.4), and Le has three channels where q_L has one. F is therefore divided by the density with
 * which the direction was really drawn (docs/errata.md E5, E20). q_L covers the whole sphere. A direction below the
 * horizon contributes 0 and counts (E1).
 *
 * The estimate is unbiased for every N >= 1. Its noise is that of f cos V, because the map's contrast is divided out:
 * it is good for diffuse surfaces. Cost: N draws and at most N shadow rays. */
#include "proposal.h"

static unsigned light_needs(const bis_settings *s)
{
    return bis_em_samples_light_needs(s);
}

static void scratch_needs(const bis_settings *s, bis_needs *need)
{
    bis_em_samples_scratch_needs(s->samples, s, need);
}

static rgb Lo(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch)
{
    const uint32_t N = s->samples;
    const bis_bsdf *bsdf = &pt->bsdf;
    rgbd sum = {0, 0, 0};

    if (bis_bsdf_is_black(bsdf)) return (rgb){0, 0, 0};
    const bis_em_samples samples = bis_em_samples_start(N, s, stream, scratch);
    /* [em-sum] */
    for (uint32_t j = 0; j < N; j++) {
        bis_light_point y;
        if (!bis_em_sample(&y, &samples, j, pt->light, stream)) break; /* there is no light */

        double cos_theta = bis_bsdf_cos(bsdf, y.wi);
        if (cos_theta <= 0) continue;
        rgbd C = bis_estimate(bis_bsdf_f(bsdf, y.wi), y.Le, cos_theta, (double)N * y.pdf);
        if (rgbd_sum(C) > 0) bis_point_add(&sum, pt, y.wi, C, NULL);
    }
    return rgbd_round(sum);
    /* [end] */
}

const bis_integrator bis_em = {.name = "em", .words = "directions from the map's importance",
    .claim = "unbiased", .light_needs = light_needs, .scratch_needs = scratch_needs, .Lo = Lo};
