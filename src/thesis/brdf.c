/* SPDX-License-Identifier: BSD-2-Clause */
/* brdf: importance sampling from the BRDF. Source: thesis 3.5 and the estimator L_{N,f} of 4.1.
 *
 *     L = (1/N) sum_j f(wi_j, wo) cos theta_j Le(wi_j) V(wi_j) / q_f(wi_j),     wi_j ~ q_f
 *
 * The thesis cancels f cos/q_f against the albedo. This would need directions drawn from f cos itself (eq. 3.17;
 * normalised: eq. 4.3), and no analytical method draws them. The directions are drawn from the mixture of the lobes,
 * and F is divided by the density of this mixture (docs/errata.md E23). A lobe may reach below the horizon. Its
 * directions there contribute 0 and count (E34).
 *
 * The estimate is unbiased for every N >= 1. Its noise is that of Le V, because the map's contrast is not divided
 * out: it is good for narrow lobes under smooth skies and hopeless for a diffuse surface under a small sun. Cost: N
 * draws and at most N shadow rays; nothing is built for the light. */
#include "bis/thesis/errata.h"
#include "as_printed.h"
#include "proposal.h"

static unsigned light_needs(const bis_settings *s)
{
    (void)s;
    return 0;
}

static void scratch_needs(const bis_settings *s, bis_needs *need)
{
    need->n_points = s->samples;
}

static rgb Lo(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch)
{
    const uint32_t N = s->samples;
    const bis_bsdf *bsdf = &pt->bsdf;
    rgbd sum = {0, 0, 0};

    if (bis_light_is_black(pt->light)) return (rgb){0, 0, 0};
    bis_stream_points(stream, BIS_DIM_BRDF, N, scratch->u);
    /* [brdf-sum] */
    for (uint32_t j = 0; j < N; j++) {
        vec3 wi;
        if (!bis_bsdf_draw(bsdf, scratch->u[j], &wi)) break; /* black */
        if (s->as_printed & BIS_E34) bis_as_printed_above_horizon(&wi, bsdf, stream);

        double q, cos_theta = bis_bsdf_cos(bsdf, wi);
        if (cos_theta <= 0) continue;
        rgb f = bis_bsdf_f_pdf(bsdf, wi, &q);
        if (q <= 0) continue; /* the lobe underflows: f = 0 here, too */
        rgbd C = bis_estimate(f, bis_light_Le(pt->light, wi), cos_theta, (double)N * q);
        if (rgbd_sum(C) > 0) bis_point_add(&sum, pt, wi, C, NULL);
    }
    return rgbd_round(sum);
    /* [end] */
}

const bis_integrator bis_brdf = {.name = "brdf", .words = "directions from the BRDF",
    .claim = "unbiased", .light_needs = light_needs, .scratch_needs = scratch_needs, .Lo = Lo};
