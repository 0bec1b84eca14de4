/* proposal: the two ways to propose a direction, from the map (q_L, thesis 3.3) and from the BRDF (q_f, 3.5), and what a direction is worth
 * when it was drawn with density q: F/q (eq. 4.8). The integrators of chapters 3 and 4 differ in what they do with it. For integrators alone. */
#ifndef BIS_PROPOSAL_H
#define BIS_PROPOSAL_H

#include "bis/integrator.h"

/* The dimension pairs of a bis_stream: who proposes from what uses the same numbers in every integrator (docs/errata.md E24). */
enum { BIS_DIM_EM, BIS_DIM_BRDF };

/* F/q = f Le cos/q, in RGB: with q for the scalar importance, the colour stays (E5). q > 0. */
static inline rgbd bis_estimate(rgb f, rgb Le, double cos_theta, double q)
{
    double s = cos_theta / q;

    return (rgbd){(double)f.r * (double)Le.r * s, (double)f.g * (double)Le.g * s, (double)f.b * (double)Le.b * s};
}

/* Draw y from the map's importance: u, a point of a set, picks the pixel, plain random numbers the place in it. False: no light. */
bool bis_propose_em(bis_light_point *y, const bis_light *light, bis_stream *stream, const double u[2]);

/* Draw wi from the BRDF: u[0] picks the lobe, and where it lies between that lobe's limits is again uniform, so that (that, u[1]) is the place in
 * it. A well-spread set of points then gives each lobe its share almost exactly (E35: less noise than a coin, as unbiased). False: black. */
bool bis_propose_brdf(vec3 *wi, const bis_bsdf *bsdf, const double u[2]);

#endif
