/* SPDX-License-Identifier: BSD-2-Clause */
/* draw: M candidates x_i ~ q, from the map, from the BRDF, or from both (candidates.c says how many of each).
 *
 * From the map they are drawn for this point alone, or taken from a set that many points share, or drawn by a guide.
 * Stratified candidates take one direction in each equal part of the importance along the map's curve. Those of the
 * BRDF take one in each equal part of Hilbert's curve over (u1, u2). Independent ones take plain random numbers. */
#include "set.h"

#include "curve_many.h"
#include "light_many.h"
#include "proposal.h"

/* One of n independent points. If n = 1, it is the set of one point that plain importance sampling uses, because M = N
 * = 1 must give the same direction (E24). */
static void independent_point(double u[2], bis_stream *stream, unsigned dim, uint32_t n)
{
    double set[1][2];

    if (n == 1) bis_stream_points(stream, dim, 1, set);
    u[0] = n == 1 ? set[0][0] : bis_stream_random(stream);
    u[1] = n == 1 ? set[0][1] : bis_stream_random(stream);
}

static bool draw_one_of_map(bis_light_point *y, uint32_t i, uint32_t n, bool stratify, const bis_light *light,
                            bis_stream *stream)
{
    double u[2];

    if (stratify) return bis_propose_stratum(y, light, stream, i, n);
    independent_point(u, stream, BIS_DIM_EM, n);
    return bis_propose_em(y, light, stream, u);
}

static void draw_map(bis_set *set, uint32_t n, bool stratify, const bis_light *light, bis_stream *stream)
{
    bis_light_point y;

    for (uint32_t i = 0; i < n; i++) {
        const bool drawn = draw_one_of_map(&y, i, n, stratify, light, stream);
        bis_lanes_put(&set->own, i, drawn ? &y : NULL, set->unit_of_Le);
    }
    for (uint32_t i = n; i < bis_lanes_round_up(n); i++) bis_lanes_put(&set->own, i, NULL, 1);
    set->map = (bis_half){set->own, n, 0};
}

/* A set has M directions; the n_brdf that the BRDF gets of M are not used (bis_set_weigh leaves them out). Which ones
 * is random, because light from the same parts of every set would be lost else. */
static void draw_shared(bis_set *set, uint32_t n_brdf, bis_stream *stream)
{
    set->map = (bis_half){set->sets->choose(set->sets, stream), set->M, 0};
    set->n_unused = n_brdf;
    set->phase = (uint32_t)(bis_rng_u64(&stream->rng) >> 32);
}

/* The largest float below 1: a double just below 1 would round to 1. */
static float below_1(double u) { return fminf((float)u, 0x1.fffffep-1f); }

static void draw_brdf(bis_set *set, uint32_t n, bool stratify, const bis_point *pt, bis_stream *stream)
{
    const uint32_t padded = bis_lanes_round_up(n);

    if (stratify) { /* one key for all: the points are a function of it and of their number */
        bis_curve_points(set->u1, set->u2, n, bis_rng_u64(&stream->rng));
    } else {
        for (uint32_t i = 0; i < n; i++) {
            double u[2];
            independent_point(u, stream, BIS_DIM_BRDF, n);
            set->u1[i] = below_1(u[0]);
            set->u2[i] = below_1(u[1]);
        }
        /* what fills the last block must be numbers, too: the loop over lanes computes with it */
        for (uint32_t i = n; i < padded; i++) set->u1[i] = set->u2[i] = 0;
    }
    bis_bsdf_sample_many(&set->brdf.x, &pt->bsdf, set->u1, set->u2, n);
    bis_light_look(pt->light, &set->brdf.x, set->pixel, n);
    set->brdf.n = n;
}

static bis_mixture divide(const bis_set *set, uint32_t M, bis_proposal proposal, const bis_point *pt,
                          bis_stream *stream)
{
    const bis_guide *guide = set->guide;

    if (proposal == BIS_PROPOSAL_PRODUCT && guide && guide->divide) return guide->divide(guide, M, pt);
    return bis_candidates_divide(M, proposal, pt, stream);
}

bool bis_set_draw(bis_set *set, uint32_t M, bis_proposal proposal, bool stratify, const bis_point *pt,
                  bis_stream *stream)
{
    set->M = M;
    set->map.n = set->brdf.n = set->n_unused = set->choice.n = set->choice.n_chosen = 0;
    if (bis_bsdf_is_black(&pt->bsdf) || bis_light_is_black(pt->light)) return false;
    pt->counters->candidates += M; /* asked for: of a lamp a guide may draw fewer, each for several */
    const bis_mixture m = divide(set, M, proposal, pt, stream);
    const bool guided = set->guide && set->guide->draw;

    set->beta = m.beta;
    set->unit_of_Le = bis_light_mean(pt->light);
    set->mark = -1; /* none: bis_set_choose draws one */
    if (guided) {
        if (!set->guide->draw(set->guide, set, m.n_em, pt, stream)) return false;
    } else if (m.n_em && set->sets) {
        draw_shared(set, m.n_brdf, stream);
    } else if (m.n_em) {
        draw_map(set, m.n_em, stratify, pt->light, stream);
    }
    set->brdf.first = bis_lanes_round_up(set->map.n); /* each half begins with a block of its own */
    if (m.n_brdf) draw_brdf(set, m.n_brdf, stratify, pt, stream);
    if (m.n_brdf && guided) set->guide->density(set->guide, set);
    return true;
}
