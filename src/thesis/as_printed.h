/* as_printed: the equations as the thesis prints them, where bis departs from it, for `--as-printed`
 * (docs/errata.md). The integrators call these functions if the switch is on. Otherwise none of this code runs. */
#pragma once

#include "bis/thesis/integrator.h"

/* bis_as_printed_weights changes the candidates x[M] of sir by E23 and E6, if s has these switches. W is the sum of
 * the weights as drawn; if it is 0, nothing changes. Returns the new sum. */
double bis_as_printed_weights(const bis_settings *s, bis_candidate *x, double W, const bis_point *pt);

/* bis_as_printed_colours (E6) gives each candidate of c[M] the colour of the sum of all C, so that eq. 4.6 becomes an
 * RGB L_ns times the mean of V. The weights and their sum W stay. */
void bis_as_printed_colours(bis_candidate *c, uint32_t M, double W);

/* bis_as_printed_Zhat (E21) returns Zhat from M candidates that are not the resampled ones. It draws them by a stream
 * of its own and overwrites scratch->candidates. */
double bis_as_printed_Zhat(const bis_settings *s, const bis_point *pt, const bis_stream *stream, bis_scratch *scratch);

/* bis_as_printed_bound (E27) returns the printed bound of rejection times L_ns: p < f_max q_L and p < L_max q_f,
 * where f_max and L_max are the largest values of the densities q_f and q_L themselves. q_f is taken as f cos over Kd
 * + Ks. */
double bis_as_printed_bound(const bis_point *pt, bis_proposal proposal, double L_ns);

/* bis_as_printed_above_horizon (E34) draws *wi again while it lies below the horizon, and leaves the density
 * unchanged. At least half of a lobe lies above the horizon. */
void bis_as_printed_above_horizon(vec3 *wi, const bis_bsdf *bsdf, bis_stream *stream);
