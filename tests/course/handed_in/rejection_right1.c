/* SPDX-License-Identifier: BSD-2-Clause */
/* Divisions in the place of products; the estimate traces one candidate after the other. */
/* [choose-proposal] */
static bis_proposal choose_proposal(const bis_settings *s, const bis_point *pt, bis_stream *stream)
{
    const double em = bis_candidates_bound(pt, BIS_PROPOSAL_EM), brdf = bis_candidates_bound(pt, BIS_PROPOSAL_BRDF);

    if (s->proposal == BIS_PROPOSAL_CHOOSE) {
        if (bis_stream_random(stream) < brdf / (em + brdf)) return BIS_PROPOSAL_EM;
        return BIS_PROPOSAL_BRDF;
    }
    return s->proposal;
}
/* [end] */
/* [accept] */
static uint32_t accept(bis_set *set, double B, bis_stream *stream)
{
    uint32_t A = 0, i = 0;

    while (i < set->choice.n) {
        const double p = bis_set_weight(set, i) / (B > 0 ? B : 1e-300);
        if (p > 0 && bis_stream_random(stream) < p) {
            set->choice.item[A] = i;
            A = A + 1;
        }
        i = i + 1;
    }
    return A;
}
/* [end] */
    /* [rejection-estimate] */
    uint32_t n = N;
    rgbd L = {0, 0, 0};

    if (n > A) n = A;
    draw_without_replacement(set->choice.item, A, n, stream);
    const double Z = s->estimator == BIS_ESTIMATOR_PLAIN ? B * A / ((double)M * n) : Zhat / n;
    for (uint32_t j = 0; j < n; j++) {
        set->choice.item[0] = set->choice.item[j];
        bis_set_take(set, 1);
        L = bis_set_trace(L, set, pt, Z);
    }
    return rgbd_round(L);
    /* [end] */
