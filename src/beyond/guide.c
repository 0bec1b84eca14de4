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
 * rays: more are cast where V is not known, or little light is expected, because there the relative error is largest.
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

/* Of a constant light, unless most of it is hidden, or it has portals. */
static bool brdf_draws_all(const bis_product_guide *g)
{
    return g->clusters->as_map && !g->guess.is_dark && g->clusters->n_parts == g->clusters->n;
}

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
     * over that of the clusters' draw: in a room .7, a glossy statue .4.) */
    if (brdf_draws_all(g)) return (bis_mixture){0, M, 0};
    /* no stream: with M > 1 nothing is drawn */
    if (bis_clusters_are_wide(g->clusters) && M > 1 && !g->clusters->as_map)
        return bis_candidates_divide(M, BIS_PROPOSAL_MIX, pt, NULL);
    const double share = pt->bsdf.p_specular / 2 / (1 + 64 * bis_candidates_in_lobe(M, pt));
    const uint32_t n_brdf = (uint32_t)floor(share * M); /* < M: share <= 1/2 */
    return (bis_mixture){M - n_brdf, n_brdf, (double)(M - n_brdf) / M};
}

/* ---- draw, density ---- */

/* The clusters of candidates whose pixels are known, or of those of a constant light; and q, the product's density. */
static void find_clusters(const bis_product_guide *g, const bis_lanes *x, uint32_t *pixel, uint16_t *part, uint32_t n)
{
    const bis_clusters *c = g->clusters;
    vec3 axis[3];

    if (c->as_map) {
        bis_light_axes(c->as_map, axis);
        bis_envmap_pixels(bis_light_envmap(c->as_map), axis, pixel, x, n);
        for (uint32_t i = 0; i < n; i++) x->q[i] = (float)(1 / (4 * PI));
    }
    for (uint32_t i = 0; i < n; i++) {
        part[i] = (uint16_t)bis_cluster_of_pixel(c, pixel[i]);
        x->q[i] *= (float)bis_product_scale(&g->product, c, part[i]);
    }
}

/* The part of what passes a portal in square `place`: n + n place/all, rounded up, so that bis_visibility_part tells
 * squares from each other and from clusters; else the cluster. */
static uint16_t part_of(const bis_product_guide *g, uint32_t place, uint16_t cluster)
{
    const uint32_t n = g->clusters->n, all = g->portals.n * BIS_PORTAL_SQUARES;

    return place == UINT32_MAX ? cluster : (uint16_t)(n + (place * n + all - 1) / all);
}

/* q of n candidates becomes the density of product and portals together. drawn: as in bis_portals_pass. */
static void mix_portals(const bis_product_guide *g, bis_set *set, const bis_lanes *x, uint16_t *part, uint32_t n,
                        uint32_t drawn)
{
    float *q = set->u1; /* it has served, and so have the pixels */

    bis_portals_pass(&g->portals, q, set->pixel, x, n, drawn);
    for (uint32_t i = 0; i < n; i++) {
        x->q[i] = (float)g->portals.of_product * x->q[i] + q[i];
        part[i] = part_of(g, set->pixel[i], part[i]);
    }
}

/* What lies behind a portal is seen as the portal is: so the product draws from its clusters. */
static void favour_portals(bis_product_guide *g)
{
    const bis_cones *c = &g->clusters->cone;
    const bis_lanes axes = {.x = c->x, .y = c->y, .z = c->z, .q = c->sine};
    float q[BIS_CLUSTERS_MOST], *w = g->product.clusters.w;
    uint32_t place[BIS_CLUSTERS_MOST];

    bis_portals_pass(&g->portals, q, place, &axes, g->clusters->n, BIS_PORTALS_CONES);
    for (uint32_t k = 0; k < g->clusters->n; k++)
        if (place[k] != UINT32_MAX) w[k] *= g->guess.h[part_of(g, place[k], (uint16_t)k)] / g->guess.h[k];
    g->product.W = bis_choice_sum(&g->product.clusters, g->product.clusters.n);
}

/* Draws n candidates through portals, behind those of the product. */
static void draw_through(const bis_product_guide *g, bis_set *set, uint32_t n, const bis_point *pt, bis_stream *stream)
{
    const uint32_t first = set->map.n, all = first + n;
    const bis_lanes x = bis_lanes_from(&set->own, first);

    bis_portals_draw(&g->portals, &x, set->u1, set->u2, &stream->rng);
    bis_light_look(pt->light, &x, set->pixel, n);
    find_clusters(g, &x, set->pixel, set->part + first, n);
    mix_portals(g, set, &set->own, set->part, first, BIS_PORTALS_MAX);
    for (uint32_t j = 0, i = first; j < g->portals.n; i = first + g->portals.end[j++]) {
        const bis_lanes of_portal = bis_lanes_from(&set->own, i);
        mix_portals(g, set, &of_portal, set->part + i, first + g->portals.end[j] - i, j);
    }
    for (uint32_t i = first; i < all; i++) set->stands_for[i] = 1;
    for (uint32_t i = all; i < bis_lanes_round_up(all); i++) bis_lanes_put(&set->own, i, NULL, 1);
    set->map.n = all;
}

static bool draw(bis_guide *guide, bis_set *set, uint32_t n, const bis_point *pt, bis_stream *stream)
{
    bis_product_guide *g = (bis_product_guide *)guide;
    double marks[1][2], phase[1][2]; /* over the camera samples of a pixel evenly spread */

    if (n == 0) return true; /* all from the BRDF: bis_product_guide_look has made h */
    if (!bis_product_weigh(&g->product, g->clusters, &pt->bsdf)) return false;
    if (g->visibility && !bis_product_guess(&g->product, g->clusters, &g->guess)) return false;
    const uint32_t n_through = bis_portals_look(&g->portals, g->clusters->portals, g->clusters->n_portals, pt, n);
    if (n_through && g->visibility) favour_portals(g);
    bis_stream_points(stream, BIS_DIM_MARKS, 1, marks);
    bis_stream_points(stream, BIS_DIM_PHASE, 1, phase);
    const uint32_t drawn = bis_product_draw(&g->product, g->clusters, &set->own, set->part,
                                            guide->weigh ? set->stands_for : NULL, n - n_through, marks[0][0],
                                            phase[0][0], stream->pixel);
    set->map = (bis_half){set->own, drawn, 0};
    if (n_through) draw_through(g, set, n_through, pt, stream);
    set->mark = marks[0][1];
    return true;
}

static void density(bis_guide *guide, bis_set *set)
{
    const bis_product_guide *g = (const bis_product_guide *)guide;
    uint16_t *part = set->part + set->brdf.first;

    find_clusters(g, &set->brdf.x, set->pixel, part, set->brdf.n);
    if (g->portals.of_product < 1) mix_portals(g, set, &set->brdf.x, part, set->brdf.n, BIS_PORTALS_MAX);
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
        set->y.seen[j] = guide->learns ? bis_guess_count(&g->guess, k, g->clusters->n_parts) : NULL;
    }
}

/* Is V's mean known, and of use? Not under a mirror's lobe, for which the BRDF draws beside the map: it sees few
 * clusters, which the marks divide well enough. */
static bool knows(const bis_guide *guide, const bis_set *set)
{
    return ((const bis_product_guide *)guide)->guess.knows && !(set->map.n && set->brdf.n);
}

static bool has_control(const bis_guide *guide, const bis_set *set, const bis_point *pt)
{
    return knows(guide, set) && !rgb_is_black(pt->bsdf.material->Kd);
}

/* With A = sum w g/h, which is M times the light that is expected, N marks leave a relative squared error of
 * W sum w E[(V - g)^2]/h^2 / (N A^2) at most, and without the control of (W/A)^2/N. Points share their rays best in
 * proportion to its root (Neyman 1934). So a point gets fewer rays where V is known, and more where little light is
 * expected. The unit 3.5 was measured as visibility.c says. (2.8: 1.01; 5.5: 1.01.) Never fewer than N/4, because what
 * is known may be wrong, nor more than 3 N, which choose nearly all of the candidates that the weights make likely. */
static uint32_t rays(const bis_guide *guide, const bis_set *set, const bis_point *pt, uint32_t N)
{
    const bis_product_guide *g = (const bis_product_guide *)guide;
    const bool control = has_control(guide, set, pt);
    const double unit = 3.5;
    double A = 0, B = 0;

    if (!knows(guide, set)) return N;
    for (uint32_t i = 0; i < set->choice.n; i++) {
        const double w = (double)set->choice.w[i];
        A += w * (double)g->guess.control[set->part[i]];
        B += w * (double)g->guess.noise[set->part[i]];
    }
    const double share = control ? unit * sqrt(set->W * B) : set->W, least = control ? 0.25 : 1;
    if (BIS_MORE_RAYS * A <= share) return BIS_MORE_RAYS * N;
    return (uint32_t)ceil(N * fmax(share / A, least));
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

    *g = (bis_product_guide){.clusters = clusters, .visibility = visibility, .portals.of_product = 1};
    g->steps = (bis_guide){.divide = divide, .draw = draw, .density = density, .learns = true};
    bis_product_claim(&g->product, &claims);
    if (claims.failed) status = bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for a thread's clusters");
    if (!status && visibility) {
        status = bis_guess_init(&g->guess, clusters->n_parts, diag);
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
    return claims.bytes + (g->visibility ? bis_guess_bytes(g->clusters->n_parts) : 0);
}

void bis_product_guide_look(bis_product_guide *g, size_t cell)
{
    if (!g->visibility) return;
    bis_guess_look(&g->guess, g->clusters->n_parts, g->visibility, cell);
    if (!brdf_draws_all(g)) return;
    for (uint32_t k = 0; k < g->clusters->n; k++) g->product.clusters.w[k] = 1;
    g->product.W = g->clusters->n;
    bis_product_guess(&g->product, g->clusters, &g->guess);
}

/* ---- single points ---- */

bis_status bis_probe_init(bis_probe *p, const bis_settings *s, const bis_light *light, bis_diag *diag)
{
    *p = (bis_probe){.clusters = {.n = 0}};
    bis_status status = bis_scratch_init(&p->scratch, s, diag);
    bis_settings alone = *s; /* a point alone learns nothing: under a constant light the BRDF draws all */
    alone.learn = false;
    if (status || !bis_beyond_needs_under(&alone, light).clusters) return status;
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
