/* rejection: sample generation through rejection. Source: thesis 4.3.
 *
 * A candidate drawn from q is accepted with probability phat/(B q) = w/B, where B bounds phat/q over all directions
 * (figure 4.3). The accepted candidates are distributed as the product p (eq. 4.4), and at most N of them are traced.
 * There are two bounds (figure 4.4):
 *
 *     from the map:   phat/q_L <= max f cos * max I/q_L  = c_em
 *     from the BRDF:  phat/q_f <= max f cos/q_f * max I  = c_brdf
 *
 * with I = Le.r + Le.g + Le.b (docs/errata.md E27: L_ns is not needed). "choose" takes one of the two for all M
 * candidates of a point. The smaller bound has the higher probability: P(em) = c_brdf/(c_em + c_brdf).
 *
 * M is fixed, and the number A of accepted candidates is random. If candidates were drawn until N are accepted, as
 * 4.3 reads, the estimate would be too high (E22). There are two estimators over the n = min(A, N) traced candidates:
 *   - plain:  L = (B/M)(A/n) sum F/phat V. It is unbiased for every M, N >= 1: a candidate is accepted with probability
 *     w/B and then traced with probability n/A, so its expected contribution is (1/M) w F/phat V = (1/M) F/q V. The
 *     case A = 0 is part of the mean.
 *   - ratio:  L = Zhat/n sum F/phat V, with Zhat = W/M from all candidates (eq. 4.7, 4.6). Its bias is O(1/M), because
 *     Zhat and the choice are not independent. If nothing is accepted, there are three fallbacks: "resample" the same
 *     candidates by SIR (default: no further bias), trace a "subset" of the candidates, or take the "unoccluded" value,
 *     as printed, which adds light in the shadows of narrow lobes (E29). The last two are biased.
 *
 * Cost: M candidates and at most N rays. On average Zhat/B of the M are accepted: one in thousands under a contrasty
 * map (E28). */
#include "bis/thesis/errata.h"
#include "as_printed.h"
#include "candidates.h"

#include <assert.h>

static unsigned light_needs(const bis_settings *s)
{
    return bis_candidates_light_needs(s->proposal, false);
}

static void scratch_needs(const bis_settings *s, bis_needs *need)
{
    need->n_candidates = s->candidates;
    need->n_chosen = s->candidates > s->shadowrays ? s->candidates : s->shadowrays;
}

/* [choose] */
static bis_proposal choose(const bis_settings *s, const bis_point *pt, bis_stream *stream)
{
    if (s->proposal != BIS_PROPOSAL_CHOOSE) return s->proposal;

    double c_em = bis_candidates_bound(pt, BIS_PROPOSAL_EM), c_brdf = bis_candidates_bound(pt, BIS_PROPOSAL_BRDF);
    return bis_stream_random(stream) * (c_em + c_brdf) < c_brdf ? BIS_PROPOSAL_EM : BIS_PROPOSAL_BRDF;
}
/* [end] */

/* Accepts each candidate with probability w/B, or 1 if B is no bound. Returns A. */
/* [accept] */
static uint32_t accept(uint32_t *chosen, const bis_candidate *x, const bis_settings *s, double B, bis_stream *stream)
{
    uint32_t A = 0;

    for (uint32_t i = 0; i < s->candidates; i++) {
        assert(x[i].w <= B || s->as_printed & BIS_E27);
        if (x[i].w > 0 && bis_stream_random(stream) * B < x[i].w) chosen[A++] = i;
    }
    return A;
}
/* [end] */

/* Moves n of chosen[A], drawn without replacement, to the front (Fisher and Yates 1938). */
static void draw_without_replacement(uint32_t *chosen, uint32_t A, uint32_t n, bis_stream *stream)
{
    for (uint32_t j = 0; j < n; j++) {
        uint32_t k = j + (uint32_t)bis_rng_below(&stream->rng, A - j), swap = chosen[j];
        chosen[j] = chosen[k];
        chosen[k] = swap;
    }
}

static double sum_of_weights(const bis_candidate *x, uint32_t M)
{
    double W = 0;

    for (uint32_t i = 0; i < M; i++) W += x[i].w;
    return W;
}

static uint32_t positive(uint32_t *chosen, const bis_candidate *x, uint32_t M)
{
    uint32_t n = 0;

    for (uint32_t i = 0; i < M; i++) {
        if (x[i].w > 0) chosen[n++] = i;
    }
    return n;
}

/* Returns the ratio estimate when nothing was accepted. W > 0. */
static rgbd fall_back(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch, double W)
{
    const uint32_t M = s->candidates, N = s->shadowrays;
    bis_candidate *x = scratch->candidates;
    double Zhat = W / M;

    pt->counters->fallbacks++;
    if (s->fallback == BIS_FALLBACK_UNOCCLUDED || s->as_printed & BIS_E29) return bis_candidates_unoccluded(x, M);
    /* [fall-back-resample] */
    if (s->fallback == BIS_FALLBACK_RESAMPLE) {
        bis_candidates_resample(scratch->chosen, N, x, M, W, s->resampling, stream);
        return bis_candidates_trace(pt, x, scratch->chosen, N, Zhat / N);
    }
    /* [end] */
    /* [fall-back-subset] */
    uint32_t A = positive(scratch->chosen, x, M), n = A < N ? A : N;
    draw_without_replacement(scratch->chosen, A, n, stream);
    return bis_candidates_trace(pt, x, scratch->chosen, n, Zhat / n);
    /* [end] */
}

static rgb Lo(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch)
{
    const uint32_t N = s->shadowrays;
    uint32_t M = s->candidates;
    bis_candidate *x = scratch->candidates;

    if (bis_bsdf_is_black(&pt->bsdf) || bis_light_is_black(pt->light)) return (rgb){0, 0, 0};
    const bis_proposal proposal = choose(s, pt, stream);
    double B = bis_candidates_bound(pt, proposal);
    double W = bis_candidates_draw(x, M, proposal, false, NULL, pt, stream);
    if (W <= 0) return (rgb){0, 0, 0};
    if (s->as_printed & BIS_E6) bis_as_printed_colours(x, M, W);
    if (s->as_printed & BIS_E27) B = bis_as_printed_bound(pt, proposal, W / M);

    uint32_t A = accept(scratch->chosen, x, s, B, stream);
    if (s->as_printed & BIS_E22 && A >= N) { /* drawing ends with the N-th acceptance */
        A = N;
        M = scratch->chosen[N - 1] + 1;
        W = sum_of_weights(x, M);
    }
    pt->counters->accepted += A;
    if (A == 0)
        return s->estimator == BIS_ESTIMATOR_PLAIN ? (rgb){0, 0, 0} : rgbd_round(fall_back(s, pt, stream, scratch, W));

    /* [rejection-estimate] */
    uint32_t n = A < N ? A : N;
    draw_without_replacement(scratch->chosen, A, n, stream);
    /* plain: B A/M takes the place of Zhat, which it estimates */
    double Z = s->estimator == BIS_ESTIMATOR_PLAIN ? B / M * A : W / M;
    return rgbd_round(bis_candidates_trace(pt, x, scratch->chosen, n, Z / n));
    /* [end] */
}

const bis_integrator bis_rejection = {
    .name = "rejection",
    .words = "candidates, accepted in proportion to the product of map and BRDF (thesis 4.3)",
    .claim = "\"plain\": unbiased; \"ratio\": bias O(1/M), more with fallback \"subset\" or \"unoccluded\"",
    .light_needs = light_needs,
    .scratch_needs = scratch_needs,
    .Lo = Lo,
};
