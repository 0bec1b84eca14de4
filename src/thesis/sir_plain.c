/* The oracle: sir in double, candidate by candidate (tests/support after the change). */
#include "sir.h"

#include "bis/thesis/errata.h"
#include "as_printed.h"
#include "candidates.h"

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

