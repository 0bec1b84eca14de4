/* proposal: the two ways to propose a direction, from the map (q_L, thesis 3.3) and from the BRDF (q_f, 3.5), and what
 * a direction is worth when it was drawn with density q: F/q (eq. 4.8). The integrators of chapters 3 and 4 differ in
 * what they do with it. For integrators alone. */
#ifndef BIS_PROPOSAL_H
#define BIS_PROPOSAL_H

#include "bis/thesis/integrator.h"

/* The dimension pairs of a bis_stream: who proposes from what uses the same numbers in every integrator (docs/errata.md
 * E24). */
enum { BIS_DIM_EM, BIS_DIM_BRDF };

/* F/q = f Le cos/q, in RGB: with q for the scalar importance, the colour stays (E5). q > 0. */
static inline rgbd bis_estimate(rgb f, rgb Le, double cos_theta, double q)
{
    double s = cos_theta / q;

    return (rgbd){(double)f.r * (double)Le.r * s, (double)f.g * (double)Le.g * s, (double)f.b * (double)Le.b * s};
}

/* Draw y from the map's importance: u, a point of a set, picks the pixel, plain random numbers the place in it. False:
 * no light. */
bool bis_propose_em(bis_light_point *y, const bis_light *light, bis_stream *stream, const double u[2]);

/* The n samples of the map in one estimate: points of the sampler through the table; or, with settings->stratify, one
 * in each n-th of the curve, from a shared set where there is one. */
typedef struct bis_em_samples {
    uint32_t n;
    double (*u)[2];             /* points; NULL: stratified */
    const bis_light_point *set; /* shared, or NULL */
} bis_em_samples;

/* What that asks of the light, BIS_NEED_*, and of the workspace. */
unsigned bis_em_samples_light_needs(const bis_settings *s);
void bis_em_samples_scratch_needs(uint32_t n, const bis_settings *s, bis_needs *need);

bis_em_samples bis_em_samples_start(uint32_t n, const bis_settings *s, bis_stream *stream, bis_scratch *scratch);

/* Sample j. False: no light. */
bool bis_em_sample(bis_light_point *y, const bis_em_samples *samples, uint32_t j, const bis_light *light, bis_stream *stream);

/* Draw wi from the BRDF: u[0] picks the lobe, and where it lies between that lobe's limits is again uniform, so that
 * (that, u[1]) is the place in it. A well-spread set of points then gives each lobe its share almost exactly (E35: less
 * noise than a coin, as unbiased). False: black. */
bool bis_propose_brdf(vec3 *wi, const bis_bsdf *bsdf, const double u[2]);

#endif
