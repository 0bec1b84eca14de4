/* brdf: importance sampling from the BRDF, thesis 3.5 and the estimator L_{N,f} of 4.1.
 *
 *     L = (1/N) sum_j f(wi_j, wo) cos theta_j Le(wi_j) V(wi_j) / q_f(wi_j),     wi_j ~ q_f
 *
 * The thesis cancels f cos/q_f against the albedo. That would need directions drawn from f cos itself (eq. 3.17;
 * normalised, eq. 4.3), for which there is no analytical method; what is drawn is the mixture of the lobes, and its
 * density is what F is divided by (docs/errata.md E23).
 * Directions of a lobe that dips below the horizon contribute 0 and count (E34).
 * Unbiased for every N >= 1. Noise: that of Le V, the map's contrast undivided: good for narrow lobes under smooth
 * skies, hopeless for a diffuse surface under a small sun. Cost: N draws, at most N shadow rays; nothing is built for
 * the light. */
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
        if (!bis_propose_brdf(&wi, bsdf, scratch->u[j])) break; /* black */
        if (s->as_printed & BIS_E34) bis_as_printed_above_horizon(&wi, bsdf, stream);

        double q, cos_theta = bis_bsdf_cos(bsdf, wi);
        if (cos_theta <= 0) continue;
        rgb f = bis_bsdf_f_pdf(bsdf, wi, &q);
        if (q <= 0) continue; /* where the lobe underflows: f = 0 there, too */
        rgbd C = bis_estimate(f, bis_light_Le(pt->light, wi), cos_theta, q);
        if (rgbd_sum(C) > 0 && bis_point_sees(pt, wi)) sum = rgbd_add(sum, C);
    }
    return rgbd_round(rgbd_scale(sum, 1 / (double)N));
    /* [end] */
}

const bis_integrator bis_brdf = {"brdf", "unbiased", light_needs, scratch_needs, Lo};
