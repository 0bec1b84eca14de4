/* bsdf_lanes: a material seen from many directions at once: what proposals and resampling (src/beyond/batch.c) ask. */
#ifndef BIS_BSDF_LANES_H
#define BIS_BSDF_LANES_H

#include "bis/beyond/lanes.h"
#include "bis/thesis/bsdf.h"

typedef struct bis_bsdf_lanes bis_bsdf_lanes;

/* What resampling (src/beyond/batch.c) asks of a material for n directions at once; arrays hold whole blocks, and are read and
 * written to the last one's end. The material is not black. */
struct bis_bsdf_lanes {
    /* w = phat/q, phat = f cos (Le.r + Le.g + Le.b), q = beta q_L + (1 - beta) q_f, q_f the density of bis_bsdf_sample;
     * 0 below the horizon.
     * In units of the result times the light's mean radiance: materials and maps of any size fit into floats. */
    double (*weigh)(float *w, const bis_bsdf *b, const bis_lanes *y, uint32_t n, double beta);

    /* r, g, b of y, radiance, become the shares of the three channels in f Le: F/phat of eq. 4.6, sum 1, or 0 where
     * nothing is reflected. */
    void (*colour)(const bis_bsdf *b, const bis_lanes *y, uint32_t n);

    /* w: a bound of f cos (energy.r + ...) over each of n cones (bis/clusters.h: axis in x, y, z, cosine of the half
     * angle in q_L, energy in r, g, b), in some unit. Positive wherever f cos is. */
    void (*reach)(float *w, const bis_bsdf *b, const bis_lanes *cone, const float *sine, uint32_t n);

    /* x, y, z of y: directions drawn by bis_propose_brdf at the points (u1, u2) in [0,1)^2. */
    void (*sample)(const bis_lanes *y, const bis_bsdf *b, const float *u1, const float *u2, uint32_t n);
};

/* bis_bsdf_lanes_of returns these functions for a model. NULL: nobody wrote them, so its directions go one by one. */
const bis_bsdf_lanes *bis_bsdf_lanes_of(const bis_bsdf_model *model);

#endif
