/* SPDX-License-Identifier: BSD-2-Clause */
/* candidates: from which proposal M candidates come. Their weights are made in set.c.
 *
 * q is q_L, q_f, or their mixture q = beta q_L + (1 - beta) q_f with beta = M_em/M. A candidate of a mixture has this
 * density, whichever of the two it came from (docs/errata.md E26). No weight then exceeds min(phat/(beta q_L),
 * phat/((1-beta) q_f)), so neither a sun nor a narrow lobe spoils the estimate. beta may depend on the material and the
 * light, which are known before anything is drawn (share_of_brdf). It must never depend on what was drawn.
 *
 * Order. Stratified candidates from the map take one direction in each equal part of the importance along a
 * space-filling curve. Those from the BRDF take one in each equal part of a Hilbert curve over (u1, u2). Neighbours in
 * the set are then neighbours in direction, and N equally spaced marks over the running sum of weights reach all parts
 * of the product evenly. Only stratified candidates and equally spaced marks together pay
 * (docs/trust.md, "Efficiency").
 *
 * Sets. The stratified directions from the map may come from sets that all pixels of a pass share. This is 10 times
 * cheaper than drawing them. The estimate has the same distribution, but pixels with the same set share their luck. */
#include "candidates.h"

#include <math.h>

/* ---- the proposal ---- */

/* c_em and c_brdf of figure 4.4. */
double bis_candidates_bound(const bis_point *pt, bis_proposal proposal)
{
    if (proposal == BIS_PROPOSAL_EM) return bis_bsdf_max_f_cos(&pt->bsdf) * bis_light_max_ratio(pt->light);
    return bis_bsdf_max_ratio(&pt->bsdf) * bis_light_max_intensity(pt->light);
}

double bis_candidates_in_lobe(uint32_t M, const bis_point *pt)
{
    return M / (4 * PI * bis_bsdf_pdf(&pt->bsdf, pt->bsdf.r));
}

/* Returns the BRDF's share of a mixture.
 *
 * The thesis's own measure (4.3) compares the proposals' bounds: the smaller a bound, the larger the share. Here the
 * shares go by the squares of the bounds, because these compare variances. Under a smooth sky the BRDF gets nearly
 * everything.
 *
 * Under a sun it would get nothing, although the rest of the map needs it if the lobe is narrow. Of M candidates
 * spread evenly over the sphere, k = M/(4 pi q_f(R)) would fall into the lobe about R. If k is small, the BRDF
 * therefore gets up to half.
 *
 * Every share is unbiased. With this one, the error of independent candidates stays within 1.5 times that of the
 * better proposal alone (tests/thesis/test_sir.c, E26). */
static double share_of_brdf(uint32_t M, const bis_point *pt)
{
    double c_em = bis_candidates_bound(pt, BIS_PROPOSAL_EM), c_brdf = bis_candidates_bound(pt, BIS_PROPOSAL_BRDF);
    double k = bis_candidates_in_lobe(M, pt), r = c_brdf / c_em;

    return fmax(1 / (1 + r * r), pt->bsdf.p_specular / 2 / (1 + k));
}

/* Under a constant light q_f alone is nearly the product, so all candidates come from the BRDF. A specular lobe
 * always gets at least one candidate. A diffuse surface gets none if its share rounds to 0. M = 1 cannot be divided:
 * its technique is drawn at random, and the density is that of the mixture. */
bis_mixture bis_candidates_divide(uint32_t M, bis_proposal proposal, const bis_point *pt, bis_stream *stream)
{
    const bis_mixture em = {M, 0, 1}, brdf = {0, M, 0};

    if (proposal == BIS_PROPOSAL_EM) return em;
    if (proposal == BIS_PROPOSAL_BRDF || bis_light_is_constant(pt->light)) return brdf;

    const double share = share_of_brdf(M, pt);
    const bool always = pt->bsdf.p_specular > 0;
    if (M == 1) {
        uint32_t n_brdf = bis_stream_random(stream) < share;
        return (bis_mixture){1 - n_brdf, n_brdf, 1 - share};
    }
    const uint32_t n_brdf = (uint32_t)fmax(always, fmin(round(share * M), M - 1));
    return (bis_mixture){M - n_brdf, n_brdf, (double)(M - n_brdf) / M};
}

unsigned bis_candidates_light_needs(bis_proposal proposal, bool stratify)
{
    if (proposal == BIS_PROPOSAL_BRDF) return 0;
    return stratify ? BIS_NEED_CURVE : BIS_NEED_TABLE;
}

uint32_t bis_candidates_set_needs(const bis_settings *s)
{
    const bool from_map = s->proposal == BIS_PROPOSAL_EM || s->proposal == BIS_PROPOSAL_MIX;

    return s->stratify && from_map ? s->candidates : 0;
}
