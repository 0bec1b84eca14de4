/* sir: sampling-importance resampling, thesis 4.4, the default.
 *
 * M candidates from a proposal q, each with its weight w = phat/q; N of them are drawn in proportion to w and only
 * these are traced:
 *
 *     L = (Zhat/N) sum_{j<=N} F(y_j)/phat(y_j) V(y_j),     Zhat = (1/M) sum_{i<=M} w_i,     y_j from x_1..x_M with probability w_i / sum w
 *
 * which is eq. 4.6 with L_ns estimated from the same candidates, in RGB (docs/errata.md E6). All the noise of light and
 * material is left to the cheap candidates, the rays see only that of V.
 * Unbiased for every M >= 1 and N >= 1, not only in the limit (E21), because E[Zhat V(y) | x] = (1/M) sum w_i V(x_i);
 * with L_ns from anywhere else it is not. M = N = 1 is plain importance sampling, as the thesis says (E24). No positive
 * weight: 0, part of the mean (E25).
 * Variance (E31): about Var(Zhat) Vbar^2 + L_ns^2 Var(V)/N; where nothing is shadowed, only the first term.
 * Cost: M candidates, at most N rays (repeats are traced once). */
#include "sir.h"

#include "beyond/batch.h"
#include "candidates.h"

static unsigned light_needs(const bis_settings *s)
{
    return bis_candidates_light_needs(s->proposal, s->stratify);
}

static void scratch_needs(const bis_settings *s, bis_scratch *need)
{
    need->n_candidates = s->candidates;
    need->n_pool = bis_candidates_pool_needs(s);
    need->n_chosen = s->shadowrays;
    need->wants_batch = bis_batch_wanted(s);
    need->wants_clusters = need->wants_batch && need->n_pool == 0;
    need->wants_visibility = need->wants_clusters && s->learn;
}

/* Zhat from other candidates than those that are resampled (E21): M new ones, by a stream of their own. They are drawn
 * first, because the scratch has room for M candidates only. */
static double independent_Zhat(const bis_settings *s, const bis_point *pt, const bis_stream *stream, bis_scratch *scratch)
{
    bis_stream others;

    bis_stream_init(&others, stream->sampler, ~stream->pixel, stream->sample);
    return bis_candidates_draw(scratch->candidates, s->candidates, s->proposal, s->stratify, scratch->pool, pt, &others) / s->candidates;
}

rgbd bis_sir_estimate(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch,
                      double *sum_of_weights)
{
    const uint32_t M = s->candidates, N = s->shadowrays;
    bis_candidate *x = scratch->candidates;
    const double other_Zhat = s->as_printed & BIS_E21 ? independent_Zhat(s, pt, stream, scratch) : 0;

    double W = bis_candidates_draw(x, M, s->proposal, s->stratify, scratch->pool, pt, stream);
    if (W > 0 && s->as_printed & BIS_E23) W = bis_candidates_weigh_as_printed(x, M, s->proposal, pt);
    *sum_of_weights = W;
    if (W <= 0) return (rgbd){0, 0, 0};
    if (s->as_printed & BIS_E6) bis_candidates_colour_as_printed(x, M, W);

    /* [sir-estimate] */
    bis_candidates_resample(scratch->chosen, N, x, M, W, s->resampling, stream);
    double Zhat = W / M;
    rgbd L = bis_candidates_trace(pt, x, scratch->chosen, N, Zhat / N);
    /* [end] */
    return s->as_printed & BIS_E21 ? rgbd_scale(L, other_Zhat / Zhat) : L;
}

static rgb Lo(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch)
{
    double W;

    if (bis_batch_fits(pt, scratch)) return bis_batch_Lo(s, pt, stream, scratch); /* the same, faster */
    return rgbd_round(bis_sir_estimate(s, pt, stream, scratch, &W));
}

const bis_integrator bis_sir = {"sir", "unbiased for every M, N >= 1", light_needs, scratch_needs, Lo};
const bis_integrator bis_auto = {"auto", "that of the method which a pilot chooses: unbiased", light_needs, scratch_needs, Lo};
