/* sir: sampling-importance resampling. Source: thesis 4.4.
 *
 * M candidates x_i are drawn from a proposal q, each with its weight w_i = phat/q. N of them, y_j, are drawn with
 * probability w_i / sum w, and only these are traced:
 *
 *     L = (Zhat/N) sum_{j<=N} F(y_j)/phat(y_j) V(y_j),     Zhat = (1/M) sum_{i<=M} w_i
 *
 * This is eq. 4.6 with L_ns estimated from the same candidates, in RGB (docs/errata.md E6). The cheap candidates
 * carry all the noise of light and material; the rays carry only that of V.
 *
 * The estimate is unbiased for every M >= 1 and N >= 1, not only in the limit (E21), because E[Zhat V(y) | x] = (1/M)
 * sum w_i V(x_i). With L_ns from any other source it is biased. M = N = 1 is plain importance sampling, as the thesis
 * says (E24). If no weight is positive, the estimate is 0, which is part of the mean (E25).
 *
 * Variance (E31): about Var(Zhat) Vbar^2 + L_ns^2 Var(V)/N. Where nothing is shadowed, only the first term remains.
 * Cost: M candidates and at most N rays (repeats are traced once). A renderer may run the same estimator for all
 * candidates of a point at once (src/beyond/batch.c); tests compare it with this file. */
#include "sir.h"

#include "bis/thesis/errata.h"
#include "as_printed.h"
#include "candidates.h"

static unsigned light_needs(const bis_settings *s)
{
    return bis_candidates_light_needs(s->proposal, s->stratify);
}

static void scratch_needs(const bis_settings *s, bis_needs *need)
{
    need->n_candidates = s->candidates;
    need->n_set = bis_candidates_set_needs(s);
    need->n_chosen = s->shadowrays;
}

rgbd bis_sir_estimate(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch,
                      double *sum_of_weights)
{
    const uint32_t M = s->candidates, N = s->shadowrays;
    bis_candidate *x = scratch->candidates;
    const double other_Zhat = s->as_printed & BIS_E21 ? bis_as_printed_Zhat(s, pt, stream, scratch) : 0;

    double W = bis_candidates_draw(x, M, s->proposal, s->stratify, scratch->sets, pt, stream);
    if (s->as_printed) W = bis_as_printed_weights(s, x, W, pt); /* E6, E23 */
    *sum_of_weights = W;
    if (W <= 0) return (rgbd){0, 0, 0};

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

    return rgbd_round(bis_sir_estimate(s, pt, stream, scratch, &W));
}

const bis_integrator bis_sir = {.name = "sir",
    .words = "candidates, of which a few are resampled in proportion to the product (thesis 4.4)",
    .claim = "unbiased for every M, N >= 1",
    .light_needs = light_needs, .scratch_needs = scratch_needs, .Lo = Lo};
