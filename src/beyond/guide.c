/* SPDX-License-Identifier: BSD-2-Clause */
/* guide: the steps of a set where more is known than the thesis says.
 *
 * draw: candidates come from where the product can be large (product.c), which pays where the lobe is narrow and the
 * light spotty.
 *
 * weigh, chosen: earlier rays have learned V (bis/beyond/visibility.h). The weights are multiplied by h, which sends
 * rays where V is uncertain. draw makes h for each point: of what its cell knows, of what the square around its tile
 * knows, and, for a small share, of nothing (bis_guess_mix).
 *
 * rays: more are cast where little light is expected, because there the relative error is largest.
 *
 * expected: the mean g of V is known for the neighbourhood of the pixel, and serves as a control variate:
 *     L = (1/M) sum_i F_i/q_i g_i + (Zhat/N) sum_j F/(phat h) (V - g),    Zhat = (1/M) sum_i phat_i h_i/q_i,
 * where the first sum needs no rays. Whatever g and h are, the mean of the second sum is that of F (V - g), so that the
 * estimate is unbiased. It may be below 0 where little light arrives, because g promised more. (Clarberg and
 * Akenine-Moller 2008 use visibility as a control variate in the same way.) */
#include "guide.h"

#include "thesis/light_many.h"

#include "thesis/proposal.h"

#include <math.h>

bis_beyond_needs bis_beyond_needs_of(const bis_settings *s)
{
    const bool product = s->integrator == &bis_sir && s->proposal == BIS_PROPOSAL_PRODUCT && s->stratify &&
                         !s->as_printed;

    return (bis_beyond_needs){
        .n_pool = bis_pool_needs(s), .clusters = product, .visibility = product && s->learn};
}

bis_beyond_needs bis_beyond_needs_under(const bis_settings *s, const bis_light *light)
{
    const bis_beyond_needs needs = bis_beyond_needs_of(s), nothing = {.n_pool = 0};
    bis_light_point any;

    if ((needs.n_pool == 0 && !needs.clusters) || (bis_light_is_constant(light) && !needs.visibility)) return nothing;
    /* false: the light is black, or all of it is compensated away */
    return bis_light_sample_curve(light, 0, (double[2]){0, 0}, &any) ? needs : nothing;
}

/* ---- proposal "product" ---- */

/* The candidates of the product find a lobe by themselves, down to the size of a cluster. The BRDF's share is then as
 * if there were 64 times as many candidates, and the half that it gets at most (candidates.c) shrinks with them. (16
 * times: 1.04 as visibility.c measures, in scene.txt 1.19; 256 times: 0.99, but the error alone is 1.13 in glossy-row.)
 * It may round to none, because a single one costs as much as a whole block. Under wide clusters lobes are not found,
 * and the BRDF gets its share of a mixture. A single candidate comes from the map, because the product reaches all that
 * reflects light, and because its density is known only where it draws. */
static bis_mixture divide(const bis_guide *guide, uint32_t M, const bis_point *pt)
{
    const bis_product_guide *g = (const bis_product_guide *)guide;

    /* Of a constant light the BRDF draws the product, up to V. Where most is hidden the clusters know V. (Error x time
     * beside the clusters' draw everywhere: diffuse 1.2, glossy .3; beside nothing learned: .8 in the open, rooms .07.) */
    if (bis_light_is_constant(pt->light) && !g->guess.is_dark) return (bis_mixture){0, M, 0};
    /* no stream: with M > 1 nothing is drawn */
    if (bis_clusters_are_wide(g->clusters) && M > 1) return bis_candidates_divide(M, BIS_PROPOSAL_MIX, pt, NULL);
    const double share = pt->bsdf.p_specular / 2 / (1 + 64 * bis_candidates_in_lobe(M, pt));
    const uint32_t n_brdf = (uint32_t)floor(share * M); /* < M: share <= 1/2 */
    return (bis_mixture){M - n_brdf, n_brdf, (double)(M - n_brdf) / M};
}

static bool draw(bis_guide *guide, bis_set *set, uint32_t n, const bis_point *pt, bis_stream *stream)
{
    bis_product_guide *g = (bis_product_guide *)guide;
    double marks[1][2], phase[1][2]; /* over the camera samples of a pixel evenly spread */

    if (n == 0) return true; /* all from the BRDF: bis_product_guide_look has made h */
    if (!bis_product_weigh(&g->product, g->clusters, &pt->bsdf)) return false;
    if (g->visibility && !bis_product_guess(&g->product, g->clusters, &g->guess)) return false;
    bis_stream_points(stream, BIS_DIM_MARKS, 1, marks);
    bis_stream_points(stream, BIS_DIM_PHASE, 1, phase);
    const uint32_t drawn = bis_product_draw(&g->product, g->clusters, &set->own, set->part,
                                            guide->weigh ? set->stands_for : NULL, n, marks[0][0], phase[0][0],
                                            stream->pixel);
    set->map = (bis_half){set->own, drawn, 0};
    set->mark = marks[0][1];
    return true;
}

static void density(bis_guide *guide, bis_set *set)
{
    const bis_product_guide *g = (const bis_product_guide *)guide;

    const bis_clusters *c = g->clusters;
    const bis_lanes *x = &set->brdf.x;
    vec3 axis[3];

    if (c->as_map) {
        bis_light_axes(c->as_map, axis);
        bis_envmap_pixels(bis_light_envmap(c->as_map), axis, set->pixel, x, set->brdf.n);
        for (uint32_t i = 0; i < set->brdf.n; i++) x->q[i] = (float)(1 / (4 * PI));
    }
    for (uint32_t i = 0; i < set->brdf.n; i++)
        set->part[set->brdf.first + i] = (uint16_t)bis_cluster_of_pixel(c, set->pixel[i]);
    for (uint32_t i = 0; i < set->brdf.n && set->map.n; i++)
        x->q[i] *= (float)bis_product_scale(&g->product, c, set->part[set->brdf.first + i]);
}

/* ---- learned visibility ---- */

static void weigh_half(bis_set *set, const bis_half *half, const float *h)
{
    const uint16_t *part = set->part + half->first;
    float *w = set->choice.w + half->first;

    for (uint32_t i = 0; i < half->n; i++) w[i] *= h[part[i]];
}

static void weigh(bis_guide *guide, bis_set *set)
{
    const float *h = ((const bis_product_guide *)guide)->guess.h;

    for (uint32_t i = 0; i < set->map.n; i++) set->choice.w[i] *= set->stands_for[i];
    weigh_half(set, &set->map, h);
    weigh_half(set, &set->brdf, h);
}

static void chosen(bis_guide *guide, bis_set *set)
{
    const bis_product_guide *g = (const bis_product_guide *)guide;

    for (uint32_t j = 0; j < set->choice.n_chosen; j++) {
        const uint32_t k = set->part[set->choice.item[j]];
        set->y.h[j] = g->guess.h[k];
        set->y.seen[j] = guide->learns ? bis_guess_count(&g->guess, k, g->clusters->n) : NULL;
    }
}

/* With A = sum w g/h, which is M times the light that is expected, the marks leave a relative squared error of
 * sum w/h^2 v (1 - v) W/(N A^2) at most. h^2 is v (1 - 0.8 v) or more, so it is no more than (W/A)^2/N. Points share
 * their rays best in proportion to the root of this, W/A. N is enough where W/A is 1: where the light is mostly seen.
 * Fewer are never chosen, because there the rays are cheap, and what is known may be wrong. Where nothing is expected
 * W/A has no bound, but 3 N marks choose nearly all of the candidates that the weights make likely. */
static uint32_t rays(const bis_guide *guide, const bis_set *set, uint32_t N)
{
    const bis_product_guide *g = (const bis_product_guide *)guide;
    double A = 0;

    if (!g->guess.knows || (set->map.n && set->brdf.n)) return N; /* nor under a mirror's lobe: see has_control */
    for (uint32_t i = 0; i < set->choice.n; i++) A += (double)(set->choice.w[i] * g->guess.control[set->part[i]]);
    if (BIS_MORE_RAYS * A <= set->W) return BIS_MORE_RAYS * N;
    return A < set->W ? (uint32_t)ceil(N * (set->W / A)) : N;
}

/* Not under a mirror's lobe alone: it sees few clusters, which the marks divide well enough. */
static bool has_control(const bis_guide *guide, const bis_set *set, const bis_point *pt)
{
    const bis_product_guide *g = (const bis_product_guide *)guide;

    return g->guess.knows && !(set->map.n && set->brdf.n) && !rgb_is_black(pt->bsdf.material->Kd);
}

/* Z times the sum of F/(phat h) g over what was chosen. */
static rgbd control_of_chosen(const bis_product_guide *g, const bis_set *set, double Z)
{
    rgbd sum = {0, 0, 0};

    for (uint32_t j = 0; j < set->choice.n_chosen; j++) {
        const float control = g->guess.control[set->part[set->choice.item[j]]];
        const rgbd share = {(double)set->y.r[j], (double)set->y.g[j], (double)set->y.b[j]};
        sum = rgbd_add(sum, rgbd_scale(share, Z * set->choice.times[j] * (double)control));
    }
    return sum;
}

/* w g/h is F/q g: the weight is phat h/q. The result is a float, because where rays are only noted (bis_point_add) it
 * is one, and the bits must be the same. */
static rgbd expected(const bis_guide *guide, const bis_set *set, double Z)
{
    const bis_product_guide *g = (const bis_product_guide *)guide;
    const rgbd all = bis_shares_sum(set, 0, set->choice.n, g->guess.control);
    const rgbd mean = rgbd_scale(all, set->unit_of_f * set->unit_of_Le / set->M);
    const rgbd chosen_only = control_of_chosen(g, set, Z);
    const rgb L = rgbd_round(rgbd_add(mean, rgbd_scale(chosen_only, -1)));

    return (rgbd){(double)L.r, (double)L.g, (double)L.b};
}

/* ---- a thread's guide ---- */

bis_status bis_product_guide_init(bis_product_guide *g, const bis_clusters *clusters, bis_visibility *visibility,
                                  bis_diag *diag)
{
    bis_claims claims = {0};
    bis_status status = BIS_OK;

    *g = (bis_product_guide){.clusters = clusters, .visibility = visibility};
    g->steps = (bis_guide){.divide = divide, .draw = draw, .density = density, .learns = true};
    bis_product_claim(&g->product, &claims);
    if (claims.failed) status = bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for a thread's clusters");
    if (!status && visibility) {
        status = bis_guess_init(&g->guess, clusters->n, diag);
        g->steps.weigh = weigh;
        g->steps.chosen = chosen;
        g->steps.rays = rays;
        g->steps.has_control = has_control;
        g->steps.expected = expected;
    }
    if (status) bis_product_guide_clear(g);
    return status;
}

void bis_product_guide_clear(bis_product_guide *g)
{
    bis_product_clear(&g->product);
    bis_guess_clear(&g->guess);
    *g = (bis_product_guide){.clusters = NULL};
}

size_t bis_product_guide_bytes(const bis_product_guide *g)
{
    bis_claims claims = {.only_count = true};
    bis_product p;

    if (!g->clusters) return 0;
    bis_product_claim(&p, &claims);
    return claims.bytes + (g->visibility ? bis_guess_bytes(g->clusters->n) : 0);
}

void bis_product_guide_look(bis_product_guide *g, size_t cell)
{
    if (!g->visibility) return;
    bis_guess_look(&g->guess, g->clusters->n, g->visibility, cell);
    if (!g->clusters->as_map || g->guess.is_dark) return;
    bis_product_weigh_all(&g->product, g->clusters);
    bis_product_guess(&g->product, g->clusters, &g->guess);
}

/* ---- single points ---- */

bis_status bis_probe_init(bis_probe *p, const bis_settings *s, const bis_light *light, bis_diag *diag)
{
    *p = (bis_probe){.clusters = {.n = 0}};
    bis_status status = bis_scratch_init(&p->scratch, s, diag);
    if (status || !bis_beyond_needs_under(s, light).clusters) return status;
    status = bis_clusters_init(&p->clusters, light, s->candidates, diag);
    if (!status) status = bis_product_guide_init(&p->guide, &p->clusters, NULL, diag);
    if (!status) bis_scratch_share(&p->scratch, NULL, &p->guide.steps);
    else bis_probe_clear(p);
    return status;
}

void bis_probe_clear(bis_probe *p)
{
    bis_scratch_clear(&p->scratch);
    bis_product_guide_clear(&p->guide);
    bis_clusters_clear(&p->clusters);
}

void bis_probe_begin_pass(bis_probe *p, const bis_light *light, uint64_t seed, uint32_t pass)
{
    if (p->clusters.n) bis_clusters_fill(&p->clusters, light, seed, pass, 1);
}
