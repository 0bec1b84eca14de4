/* bsdf_lanes: a material seen from many directions at once. Proposals and resampling (src/beyond/batch.c) use it. */
#pragma once

#include "bis/beyond/lanes.h"
#include "bis/thesis/bsdf.h"

typedef struct bis_bsdf_lanes bis_bsdf_lanes;

/* What resampling (src/beyond/batch.c) asks of a material for n directions at once. Arrays hold whole blocks of
 * lanes; they are read and written to the end of the last block. The material is not black. */
struct bis_bsdf_lanes {
    /* weigh stores the weights w = phat/q. phat = f cos (Le.r + Le.g + Le.b); q = beta q_L + (1 - beta) q_f, where
     * q_f is the density of bis_bsdf_sample. w is 0 below the horizon. Its unit is that of the result over the
     * light's mean radiance, so that materials and maps of any size fit into floats. */
    double (*weigh)(float *w, const bis_bsdf *b, const bis_lanes *y, uint32_t n, double beta);

    /* colour replaces the radiance r, g, b of y by the shares of the three channels in f Le: F/phat of eq. 4.6. Their
     * sum is 1, or 0 if nothing is reflected. */
    void (*colour)(const bis_bsdf *b, const bis_lanes *y, uint32_t n);

    /* reach stores in w a bound of f cos (energy.r + energy.g + energy.b) over each of n cones, in some unit. A cone
     * (bis/beyond/clusters.h) has its axis in x, y, z, the cosine of its half angle in q_L, and its energy in r, g,
     * b. The bound is positive wherever f cos is positive. */
    void (*reach)(float *w, const bis_bsdf *b, const bis_lanes *cone, const float *sine, uint32_t n);

    /* sample stores in x, y, z of y the directions that bis_propose_brdf draws at the points (u1, u2) in [0,1)^2. */
    void (*sample)(const bis_lanes *y, const bis_bsdf *b, const float *u1, const float *u2, uint32_t n);
};

/* bis_bsdf_lanes_of returns these functions for a model, or NULL if nobody has written them. The directions of such a
 * model are computed one at a time. */
const bis_bsdf_lanes *bis_bsdf_lanes_of(const bis_bsdf_model *model);
