/* sir: one plain estimate by sampling-importance resampling, for those who want to see what it is made of (`bis
 * pixel`). Everybody else asks the integrator bis_sir. */
#ifndef BIS_SIR_H
#define BIS_SIR_H

#include "bis/thesis/integrator.h"

/* bis_sir_estimate returns one estimate of the reflected radiance at pt, as bis_sir does without vectorize: the same
 * random numbers, the same bits before rounding to float, equations as printed where s->as_printed says so. Afterwards
 * scratch->candidates[M] are the weighed candidates, in the order in which they were drawn, *W is the sum of their
 * weights, and scratch->chosen[N] are the indices of those that were traced. *W = 0: no candidate weighs anything, the
 * estimate is black, and scratch->chosen is not set. scratch: by bis_scratch_init with s. */
rgbd bis_sir_estimate(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch, double *W);

#endif
