/* sir: one plain estimate by sampling-importance resampling, for callers that show its parts (`bis pixel`). All
 * others use the integrator bis_sir. */
#pragma once

#include "bis/thesis/integrator.h"

/* bis_sir_estimate returns one estimate of the reflected radiance at pt, as bis_sir does without vectorize: it uses
 * the same random numbers, gives the same bits before rounding to float, and follows the printed equations that
 * s->as_printed names. scratch comes from bis_scratch_init with s. Afterwards scratch->candidates[M] are the weighed
 * candidates in the order in which they were drawn, *W is the sum of their weights, and scratch->chosen[N] are the
 * indices of those that were traced. If no candidate has a positive weight, *W is 0, the estimate is black, and
 * scratch->chosen is not set. */
rgbd bis_sir_estimate(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch, double *W);
