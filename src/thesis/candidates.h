/* candidates: what rejection (thesis 4.3) and SIR (4.4) have in common. Draw M candidates from a proposal q and weigh
 * them against the product (eq. 4.4); resample N of them in proportion to their weights; trace the chosen. For
 * integrators alone. */
#ifndef BIS_CANDIDATES_H
#define BIS_CANDIDATES_H

#include "bis/thesis/integrator.h"

/* What proposals with these settings need of the light: BIS_NEED_*. */
unsigned bis_candidates_light_needs(bis_proposal proposal, bool stratify);

/* c of figure 4.4 for em or brdf: phat/q never exceeds it (docs/errata.md E27; L_ns is not needed):
 * max f cos * max I/q_L for candidates from the map, max f cos/q_f * max I for those from the BRDF, I = Le.r + Le.g +
 * Le.b. */
double bis_candidates_bound(const bis_point *pt, bis_proposal proposal);

/* bis_candidates_set_needs returns how many stratified directions from the map these settings take for one estimate:
 * M with proposals "em" and "mix", else 0. */
uint32_t bis_candidates_set_needs(const bis_settings *s);

/* Who draws how many of the M candidates, and the density of what comes out: q = beta q_L + (1 - beta) q_f. */
typedef struct bis_mixture {
    uint32_t n_em, n_brdf;
    double beta;
} bis_mixture;

bis_mixture bis_candidates_divide(uint32_t M, bis_proposal proposal, const bis_point *pt, bis_stream *stream);

/* Number i of n directions evenly spread over a set of M: every (M/n)-th from a random phase, so that each has the same
 * chance. In integers of 2^-32 of a direction: exact, and below M, since n <= M <= 2^14. */
static inline uint32_t bis_one_of_set(uint32_t i, uint32_t n, uint32_t M, uint32_t phase)
{
    return (uint32_t)((((uint64_t)i << 32 | phase) * M / n) >> 32);
}

/* Draw c[M] from the proposal (em, brdf or mix), in the order of a space-filling curve when stratify. Returns W, the
 * sum of the weights, 0 when there is no light or no reflection. sets: shared sets of M stratified directions from the map,
 * or NULL: the point draws its own. The mean of C over the candidates estimates L_ns (eq. 4.5) in RGB, W/M its
 * intensity. */
double bis_candidates_draw(bis_candidate *c, uint32_t M, bis_proposal proposal, bool stratify, const bis_sets *sets, const bis_point *pt,
                           bis_stream *stream);

/* Choose N of c[M] with probabilities w/W, W > 0 as bis_candidates_draw returned it; chosen[N] ascends, repeats are
 * neighbours, and no candidate of weight 0 is ever among them. */
void bis_candidates_resample(uint32_t *chosen, uint32_t N, const bis_candidate *c, uint32_t M, double W, bis_resampling resampling, bis_stream *stream);

/* Z * sum_j (F/phat)(wi_j) V(wi_j) over the chosen (their weights must be > 0): eq. 4.6 in RGB (docs/errata.md E6), Z
 * for L_ns/N. A candidate that was chosen k times in a row is traced once and counts k times (E32). */
rgbd bis_candidates_trace(const bis_point *pt, const bis_candidate *c, const uint32_t *chosen, uint32_t N, double Z);

/* L_ns of eq. 4.5 in RGB: the mean of C. */
rgbd bis_candidates_unoccluded(const bis_candidate *c, uint32_t M);

#endif
