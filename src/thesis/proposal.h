/* SPDX-License-Identifier: BSD-2-Clause */
/* proposal: the two ways to propose a direction, from the map (q_L, thesis 3.3) and from the BRDF (q_f, 3.5), and the
 * value of a direction that was drawn with density q: F/q (eq. 4.8). The integrators of chapters 3 and 4 differ in
 * how they use this value. Only integrators include this header. */
#pragma once

#include "bis/thesis/integrator.h"

/* The dimension pairs of a bis_stream. Every integrator uses the same numbers for the same proposal (docs/errata.md
 * E24). */
enum { BIS_DIM_EM, BIS_DIM_BRDF, BIS_DIM_MARKS, BIS_DIM_PHASE };

/* bis_estimate returns F/q = f Le cos/q in RGB. q is the density of the scalar importance, so the quotient keeps the
 * colour (E5). q must be > 0. */
static inline rgbd bis_estimate(rgb f, rgb Le, double cos_theta, double q)
{
    double s = cos_theta / q;

    return (rgbd){(double)f.r * (double)Le.r * s, (double)f.g * (double)Le.g * s, (double)f.b * (double)Le.b * s};
}

/* bis_propose_em draws *y from the map's importance. u, a point of a set, selects the pixel; plain random numbers
 * select the place in it. Returns false if there is no light. */
bool bis_propose_em(bis_light_point *y, const bis_light *light, bis_stream *stream, const double u[2]);

/* bis_propose_stratum draws *y from the i-th of n equal parts of the map's curve, by plain random numbers. Returns
 * false if there is no light. */
bool bis_propose_stratum(bis_light_point *y, const bis_light *light, bis_stream *stream, uint32_t i, uint32_t n);

/* The n samples of the map in one estimate. They are points of the sampler that go through the table. With
 * settings->stratify they are one direction in each n-th part of the curve, from a shared set if there is one. */
typedef struct bis_em_samples {
    uint32_t n;
    double (*u)[2];             /* points; NULL: stratified */
    bool is_shared;
    bis_lanes set;              /* a shared set of directions */
} bis_em_samples;

/* bis_em_samples_light_needs returns what these samples need of the light, a set of BIS_NEED_*. */
unsigned bis_em_samples_light_needs(const bis_settings *s);

/* bis_em_samples_scratch_needs adds what n of these samples need of the workspace to *need. */
void bis_em_samples_scratch_needs(uint32_t n, const bis_settings *s, bis_needs *need);

/* bis_em_samples_start prepares the n samples of one estimate. */
bis_em_samples bis_em_samples_start(uint32_t n, const bis_settings *s, bis_stream *stream, bis_scratch *scratch);

/* bis_em_sample draws sample j, j < n. Returns false if there is no light. */
bool bis_em_sample(bis_light_point *y, const bis_em_samples *samples, uint32_t j, const bis_light *light,
                   bis_stream *stream);
