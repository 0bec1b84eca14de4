/* as_printed: those equations of chapters 3 and 4 that give another picture if the code follows them as printed.
 * docs/errata.md explains what is wrong with each. E3, E13 and E20 are not here: they concern the map's importance
 * and stand in its files. */
#include "bis/thesis/errata.h"
#include "as_printed.h"

#include "candidates.h"
#include "proposal.h"
#include "set.h"

/* E23. Candidates from the map get w = f_r, without the cosine. Candidates from the BRDF get w = L, as if q_f were f
 * cos over Kd + Ks. The thesis prints no weight for a mixture, so that remains unchanged. */
static double printed_weights(bis_candidate *c, uint32_t M, bis_proposal proposal, const bis_point *pt)
{
    const bis_material *m = pt->bsdf.material;
    const rgb albedo = rgb_add(m->Kd, m->Ks);
    const bool from_map = proposal == BIS_PROPOSAL_EM,
               from_brdf = proposal == BIS_PROPOSAL_BRDF || (!from_map && bis_light_is_constant(pt->light));
    double W = 0;

    for (uint32_t i = 0; i < M; i++) {
        if (c[i].w > 0 && from_map) c[i].C = rgbd_scale(c[i].C, 1 / bis_bsdf_cos(&pt->bsdf, c[i].wi));
        if (c[i].w > 0 && from_brdf) c[i].C = bis_estimate(albedo, bis_light_Le(pt->light, c[i].wi), 1, 1);
        c[i].w = rgbd_sum(c[i].C);
        W += c[i].w;
    }
    return W;
}

void bis_as_printed_colours(bis_candidate *c, uint32_t M, double W)
{
    rgbd sum = {0, 0, 0};

    for (uint32_t i = 0; i < M; i++) sum = rgbd_add(sum, c[i].C);
    for (uint32_t i = 0; i < M; i++) c[i].C = rgbd_scale(sum, c[i].w / W);
}

double bis_as_printed_weights(const bis_settings *s, bis_candidate *x, double W, const bis_point *pt)
{
    if (W > 0 && s->as_printed & BIS_E23) W = printed_weights(x, s->candidates, s->proposal, pt);
    if (W > 0 && s->as_printed & BIS_E6) bis_as_printed_colours(x, s->candidates, W);
    return W;
}

double bis_as_printed_Zhat(const bis_settings *s, const bis_point *pt, const bis_stream *stream, bis_scratch *scratch)
{
    bis_stream others;

    bis_stream_init(&others, stream->sampler, ~stream->pixel, stream->sample);
    return bis_candidates_draw(scratch->candidates, s->candidates, s->proposal, s->stratify, scratch->sets, pt,
                               &others) /
           s->candidates;
}

double bis_as_printed_bound(const bis_point *pt, bis_proposal proposal, double L_ns)
{
    const bis_material *m = pt->bsdf.material;

    if (proposal == BIS_PROPOSAL_EM) return bis_bsdf_max_f_cos(&pt->bsdf) / rgb_max(rgb_add(m->Kd, m->Ks)) * L_ns;
    return bis_light_max_intensity(pt->light) / bis_light_power(pt->light) * L_ns;
}

void bis_as_printed_above_horizon(vec3 *wi, const bis_bsdf *bsdf, bis_stream *stream)
{
    for (int i = 0; i < 100 && bis_bsdf_cos(bsdf, *wi) <= 0; i++) {
        double u[2] = {bis_stream_random(stream), bis_stream_random(stream)};
        bis_bsdf_draw(bsdf, u, wi);
    }
}

/* ---- on sets ---- */

double bis_as_printed_set_weights(bis_set *x, const bis_settings *s, const bis_point *pt)
{
    const rgb albedo = rgb_add(pt->bsdf.material->Kd, pt->bsdf.material->Ks);
    const bool from_map = s->proposal == BIS_PROPOSAL_EM,
               from_brdf = s->proposal == BIS_PROPOSAL_BRDF || (!from_map && bis_light_is_constant(pt->light));
    const bis_reflected f = bis_set_reflected(x, 0);

    for (uint32_t i = 0; from_map && i < x->n_map; i++)
        if (x->w.w[i] > 0) x->w.w[i] /= f.cos[i];
    if (from_brdf) x->unit = 1;
    for (uint32_t i = 0, k = x->first_brdf; from_brdf && i < x->n_brdf; i++, k++) {
        if (x->w.w[k] <= 0) continue;
        f.r[k] = albedo.r;
        f.g[k] = albedo.g;
        f.b[k] = albedo.b;
        x->w.w[k] = albedo.r * x->brdf.r[i] + albedo.g * x->brdf.g[i] + albedo.b * x->brdf.b[i];
    }
    return bis_blocks_sum(&x->w, x->n_lanes);
}

void bis_as_printed_set_colours(bis_set *x)
{
    const rgbd mean = bis_set_mean(x);
    const double sum = rgbd_sum(mean);

    for (uint32_t j = 0; j < x->w.n_chosen; j++) {
        x->y.r[j] = (float)(mean.r / sum);
        x->y.g[j] = (float)(mean.g / sum);
        x->y.b[j] = (float)(mean.b / sum);
    }
}

double bis_as_printed_set_Zhat(const bis_settings *s, const bis_point *pt, const bis_stream *stream, bis_set *x)
{
    bis_stream others;

    bis_stream_init(&others, stream->sampler, ~stream->pixel, stream->sample);
    if (!bis_set_draw(x, s, s->proposal, pt, &others)) return 0;
    return bis_set_weigh(x, pt) / s->candidates * x->unit * x->mean;
}
