/* SPDX-License-Identifier: BSD-2-Clause */
/* proposal: draws one direction from the map or from the BRDF. */
#include "proposal.h"

#include "bis/base/curve.h"

bool bis_propose_em(bis_light_point *y, const bis_light *light, bis_stream *stream, const double u[2])
{
    double v[4] = {u[0], u[1]};

    /* even points serve the choice of the pixel; a pixel is so small that any place in it will do */
    v[2] = bis_stream_random(stream);
    v[3] = bis_stream_random(stream);
    return bis_light_sample(light, v, y);
}

bool bis_propose_stratum(bis_light_point *y, const bis_light *light, bis_stream *stream, uint32_t i, uint32_t n)
{
    const double t = bis_stratum(i, bis_stream_random(stream), n);
    double u[2];

    /* one after the other, because the order of two calls in one initializer is the compiler's choice */
    u[0] = bis_stream_random(stream);
    u[1] = bis_stream_random(stream);
    return bis_light_sample_curve(light, t, u, y);
}

unsigned bis_em_samples_light_needs(const bis_settings *s)
{
    return s->stratify ? BIS_NEED_CURVE : BIS_NEED_TABLE | BIS_NEED_SPREAD;
}

void bis_em_samples_scratch_needs(uint32_t n, const bis_settings *s, bis_needs *need)
{
    if (s->stratify) need->n_set = n;
    if (!s->stratify && need->n_points < n) need->n_points = n; /* mis uses one array for both, in turn */
}

bis_em_samples bis_em_samples_start(uint32_t n, const bis_settings *s, bis_stream *stream, bis_scratch *scratch)
{
    bis_em_samples samples = {.n = n};

    if (!s->stratify) {
        samples.u = scratch->u;
        bis_stream_points(stream, BIS_DIM_EM, n, samples.u);
    } else if (scratch->sets) { /* else each sample is drawn when it is asked for */
        samples.is_shared = true;
        samples.set = scratch->sets->choose(scratch->sets, stream);
    }
    return samples;
}

bool bis_em_sample(bis_light_point *y, const bis_em_samples *samples, uint32_t j, const bis_light *light,
                   bis_stream *stream)
{
    if (samples->u) return bis_propose_em(y, light, stream, samples->u[j]);
    if (samples->is_shared) {
        const bis_lanes *x = &samples->set;
        /* lanes hold the radiance over the mean */
        *y = (bis_light_point){{x->x[j], x->y[j], x->z[j]},
                               rgb_scale((rgb){x->r[j], x->g[j], x->b[j]}, bis_light_mean(light)),
                               (double)x->q[j]};
        return true;
    }
    return bis_propose_stratum(y, light, stream, j, samples->n);
}
