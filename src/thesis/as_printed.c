/* SPDX-License-Identifier: BSD-2-Clause */
/* as_printed: those equations of chapters 3 and 4 that give another picture if the code follows them as printed.
 * docs/errata.md explains what is wrong with each. E3, E13 and E20 leave out a factor of the importance, and stand
 * where that is; E29 is one of the fallbacks of rejection.c. */
#include "bis/thesis/errata.h"
#include "as_printed.h"

#include "proposal.h"

/* E23, from the map: w = f, where it is f cos. */
static void forget_cosines(bis_set *set, const bis_point *pt)
{
    const bis_lanes *y = &set->map.x;

    for (uint32_t i = 0; i < set->map.n; i++) {
        const double cos_theta = bis_bsdf_cos(&pt->bsdf, (vec3){y->x[i], y->y[i], y->z[i]});
        /* a weight above 0 has a cosine above 0 */
        if (set->choice.w[i] > 0) set->choice.w[i] = (float)((double)set->choice.w[i] / cos_theta);
    }
}

/* E23, from the BRDF: w = L, as if q_f were f cos over the albedo. */
static void weigh_by_albedo(bis_set *set, const bis_point *pt)
{
    const rgb albedo = rgb_add(pt->bsdf.material->Kd, pt->bsdf.material->Ks);
    const bis_lanes *y = &set->brdf.x;

    set->unit_of_f = 1;
    for (uint32_t i = 0, number = set->brdf.first; i < set->brdf.n; i++, number++) {
        if (set->choice.w[number] <= 0) continue;
        set->F[0][number] = albedo.r * y->r[i];
        set->F[1][number] = albedo.g * y->g[i];
        set->F[2][number] = albedo.b * y->b[i];
        set->choice.w[number] = set->F[0][number] + set->F[1][number] + set->F[2][number];
    }
}

double bis_as_printed_weights(bis_set *set, bis_proposal proposal, const bis_point *pt)
{
    if (proposal == BIS_PROPOSAL_EM) forget_cosines(set, pt);
    else if (proposal == BIS_PROPOSAL_BRDF || bis_light_is_constant(pt->light)) weigh_by_albedo(set, pt);
    set->W = bis_choice_sum(&set->choice, set->choice.n);
    return set->W / set->M * set->unit_of_f * set->unit_of_Le;
}

void bis_as_printed_colours(bis_set *set)
{
    const rgbd mean = bis_set_mean(set);
    const double sum = rgbd_sum(mean);

    for (uint32_t j = 0; j < set->choice.n_chosen; j++) {
        set->y.r[j] = (float)(mean.r / sum);
        set->y.g[j] = (float)(mean.g / sum);
        set->y.b[j] = (float)(mean.b / sum);
    }
}

double bis_as_printed_Zhat(const bis_settings *s, const bis_point *pt, const bis_stream *stream, bis_set *set)
{
    bis_stream others;

    bis_stream_init(&others, stream->sampler, ~stream->pixel, stream->sample); /* no pixel of a picture has ~pixel */
    if (!bis_set_draw(set, s->candidates, s->proposal, s->stratify, pt, &others)) return 0;
    return bis_set_weigh(set, pt);
}

uint32_t bis_as_printed_until(const bis_set *set, uint32_t N, double *Zhat)
{
    const uint32_t M = set->choice.item[N - 1] + 1;
    double W = 0;

    for (uint32_t i = 0; i < M; i++) W += bis_set_weight(set, i);
    *Zhat = W / M;
    return M;
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
