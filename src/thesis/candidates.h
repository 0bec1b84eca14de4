/* SPDX-License-Identifier: BSD-2-Clause */
/* candidates: how M candidates are divided between the map and the BRDF (thesis 4.2 to 4.4), and the bounds that
 * rejection and this division need. Only integrators and sets include this header. */
#pragma once

#include "bis/thesis/integrator.h"

/* bis_candidates_light_needs returns what this proposal needs of the light, a set of BIS_NEED_*. */
unsigned bis_candidates_light_needs(bis_proposal proposal, bool stratify);

/* bis_candidates_bound returns c of figure 4.4 for proposal em or brdf: phat/q never exceeds it (docs/errata.md E27;
 * L_ns is not needed). It is max f cos * max I/q_L for candidates from the map, and max f cos/q_f * max I for those
 * from the BRDF, with I = Le.r + Le.g + Le.b. */
double bis_candidates_bound(const bis_point *pt, bis_proposal proposal);

/* bis_candidates_set_needs returns how many stratified directions from the map one estimate takes with these
 * settings: M with proposals "em" and "mix", otherwise 0. */
uint32_t bis_candidates_set_needs(const bis_settings *s);

/* How many of the M candidates come from the map and how many from the BRDF, and the density of the whole set: q =
 * beta q_L + (1 - beta) q_f. */
typedef struct bis_mixture {
    uint32_t n_em, n_brdf;
    double beta;
} bis_mixture;

/* bis_candidates_in_lobe returns how many of M directions, spread evenly over the sphere, would fall into the lobe
 * about R: k = M/(4 pi q_f(R)). */
double bis_candidates_in_lobe(uint32_t M, const bis_point *pt);

/* bis_candidates_divide divides M candidates between the map and the BRDF. "product" is divided as "mix"; a guide may
 * know better (src/thesis/set.h). It takes a random number only if M = 1. */
bis_mixture bis_candidates_divide(uint32_t M, bis_proposal proposal, const bis_point *pt, bis_stream *stream);

/* bis_one_of_set returns the index of the i-th of n directions that are evenly spread over a set of M: every (M/n)-th
 * from a random phase, so that each direction has the same chance. It computes in integer units of 2^-32 of a
 * direction, which is exact, and the result is < M because n <= M <= 2^14. */
static inline uint32_t bis_one_of_set(uint32_t i, uint32_t n, uint32_t M, uint32_t phase)
{
    return (uint32_t)((((uint64_t)i << 32 | phase) * M / n) >> 32);
}
