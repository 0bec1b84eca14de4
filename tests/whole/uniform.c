/* SPDX-License-Identifier: BSD-2-Clause */
/* uniform: directions uniform over the sphere. Unbiased, and as noisy as it looks. */
#include "thesis/proposal.h"

#include "bis/thesis/warp.h"

static unsigned uniform_light_needs(const bis_settings *s)
{
    (void)s;
    return 0; /* no table, no curve: radiance is only looked up */
}

static void uniform_scratch_needs(const bis_settings *s, bis_needs *need)
{
    need->n_points = s->samples;
}

static rgb uniform_Lo(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch)
{
    rgbd sum = {0, 0, 0};

    if (bis_bsdf_is_black(&pt->bsdf)) return (rgb){0, 0, 0};
    bis_stream_points(stream, BIS_DIM_BRDF, s->samples, scratch->u);
    for (uint32_t j = 0; j < s->samples; j++) {
        vec3 wi = bis_warp_sphere(scratch->u[j][0], scratch->u[j][1]);
        double cos_theta = bis_bsdf_cos(&pt->bsdf, wi);
        if (cos_theta <= 0) continue; /* it counts: N, not the number above the horizon, divides the sum */
        rgbd C = bis_estimate(bis_bsdf_f(&pt->bsdf, wi), bis_light_Le(pt->light, wi), cos_theta, s->samples / (4 * PI));
        if (rgbd_sum(C) > 0) bis_point_add(&sum, pt, wi, C, NULL);
    }
    return rgbd_round(sum);
}

const bis_integrator bis_uniform = {.name = "uniform", .words = "directions uniform over the sphere",
    .claim = "unbiased", .light_needs = uniform_light_needs, .scratch_needs = uniform_scratch_needs, .Lo = uniform_Lo};
