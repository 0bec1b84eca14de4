/* SPDX-License-Identifier: BSD-2-Clause */
/* exact: eq. 3.2 as it stands. Source: thesis 3.1. The sphere is a set of patches of constant radiance, and every lit
 * patch is visited.
 *
 *     L = sum_i Le_i sum_k f(wi_ik, wo) cos theta_ik V(wi_ik) dOmega_i / K,
 *     wi_ik uniform in patch i, k < K = perpatch
 *
 * Inside a patch f, cos and V vary. One ray at the centre of each patch would therefore be biased, and the edge of a
 * shadow would show steps (docs/errata.md E2). A ray at a random place in the patch is unbiased, for every K >= 1.
 * The only noise is that inside single patches, which is far below that of all other integrators. Cost: K rays for
 * every lit patch above the horizon: ground truth for small maps. */
#include "proposal.h"

#include "bis/base/curve.h"

static unsigned light_needs(const bis_settings *s)
{
    (void)s;
    return 0;
}

static void scratch_needs(const bis_settings *s, bis_needs *need)
{
    (void)s;
    (void)need;
}

/* Adds the sum over k for patch i to *sum. It takes one point in each K-th part of a Hilbert curve through the patch.
 */
static void add_patch(rgbd *sum, const bis_point *pt, size_t i, uint32_t K, bis_stream *stream)
{
    for (uint32_t k = 0; k < K; k++) {
        double u[2];
        bis_light_point y;
        bis_curve_hilbert(bis_stratum(k, bis_stream_random(stream), K), u);
        bis_light_patch(pt->light, i, u, &y);
        if (rgb_is_black(y.Le)) break;

        double cos_theta = bis_bsdf_cos(&pt->bsdf, y.wi);
        if (cos_theta <= 0) continue;
        rgbd C = bis_estimate(bis_bsdf_f(&pt->bsdf, y.wi), y.Le, cos_theta, (double)K * y.pdf); /* y.pdf = 1 / dOmega */
        if (rgbd_sum(C) > 0) bis_point_add(sum, pt, y.wi, C, NULL);
    }
}

static rgb Lo(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch)
{
    rgbd sum = {0, 0, 0};

    (void)scratch;
    if (bis_bsdf_is_black(&pt->bsdf) || bis_light_is_black(pt->light)) return (rgb){0, 0, 0};
    for (size_t i = 0, n = bis_light_patches(pt->light); i < n; i++)
        add_patch(&sum, pt, i, s->perpatch, stream);
    return rgbd_round(sum);
}

const bis_integrator bis_exact = {.name = "exact", .words = "every lit pixel of the map: ground truth for small maps",
    .claim = "unbiased: every lit patch, noise only inside patches",
    .light_needs = light_needs, .scratch_needs = scratch_needs, .Lo = Lo};
