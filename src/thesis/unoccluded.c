/* unoccluded: L_ns of eq. 4.5 alone: the mean of SIR's candidates, without shadow rays.
 *
 *     L = (1/M) sum_j F(wi_j)/q(wi_j)
 *
 * The estimate is unbiased for L_ns. It is therefore too high for L wherever something is in shadow. It serves to
 * look at a scene, and at the first term of SIR's variance (docs/errata.md E31). Cost: M candidates. */
#include "candidates.h"

static unsigned light_needs(const bis_settings *s)
{
    return bis_candidates_light_needs(s->proposal, s->stratify);
}

static void scratch_needs(const bis_settings *s, bis_needs *need)
{
    need->n_candidates = s->candidates;
    need->n_set = bis_candidates_set_needs(s);
}

static rgb Lo(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch)
{
    double W =
        bis_candidates_draw(scratch->candidates, s->candidates, s->proposal, s->stratify, scratch->sets, pt, stream);

    if (W <= 0) return (rgb){0, 0, 0};
    return rgbd_round(bis_candidates_unoccluded(scratch->candidates, s->candidates));
}

const bis_integrator bis_unoccluded = {
    .name = "unoccluded",
    .words = "candidates, and no shadow rays: it leaves out all shadows",
    .claim = "biased: without shadows; unbiased for L_ns",
    .without_shadows = true,
    .light_needs = light_needs,
    .scratch_needs = scratch_needs,
    .Lo = Lo,
};
