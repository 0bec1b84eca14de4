/* SPDX-License-Identifier: BSD-2-Clause */
/* product: proposal "product", q_P(wi) = q_L(wi) s_k for wi in cluster k, s_k = (w_k/W)/share_k.
 *
 * The w_k bound the integral of f cos Le over cluster k: its energy times the largest f cos over a cone around it
 * (bis/beyond/clusters.h). n marks, equally spaced over their running sum, say how many candidates come from each
 * cluster; within it they are evenly spread over the directions that this pass has drawn there. The density is exact
 * whatever the bound is worth; a bound of 0 only where f cos is 0 makes it positive wherever it must be.
 * Of a lamp, a cluster as small as the sun, four candidates are enough, because the others would be seen or hidden
 * with these. Each stands for marks/4, which is its factor in the weight. So a lamp gets at most four rays.
 * (Squared error x time under one sun and under three lamps: eight 1.07 and 1.05; two 1.02 and 0.90, but an edge of a
 * shadow then has three greys.)
 *
 * Unbiased as every proposal: each candidate, seen alone, has density q_P. Cost: a nanosecond a cluster, 10 a
 * candidate. */
#include "product.h"

#include "bis/thesis/rng.h"

#include <assert.h>

enum { MOST_PARTS = 2 * BIS_CLUSTERS_MOST, OF_LAMP = 4 };

void bis_product_claim(bis_product *p, bis_claims *claims)
{
    bis_choice_claim(&p->clusters, bis_lanes_round_up(MOST_PARTS), claims);
}

void bis_product_clear(bis_product *p) { bis_choice_clear(&p->clusters); }

bool bis_product_weigh(bis_product *p, const bis_clusters *c, const bis_bsdf *bsdf)
{
    bis_bsdf_reach(p->clusters.w, bsdf, &c->cone, c->n);
    p->W = bis_choice_sum(&p->clusters, bis_lanes_round_up(c->n));
    return p->W > 0;
}

bool bis_product_guess(bis_product *p, const bis_clusters *c, bis_visibility_guess *f)
{
    for (uint32_t k = bis_lanes_round_up(c->n); k < bis_lanes_round_up(c->n_parts); k++) p->clusters.w[k] = 0;
    bis_guess_mix(f, p->clusters.w, p->W, c->n_parts);
    p->W = bis_choice_sum(&p->clusters, bis_lanes_round_up(c->n));
    return p->W > 0;
}

static void put(const bis_lanes *to, uint32_t i, const bis_cluster_point *y, float scale)
{
    to->x[i] = y->wi.x;
    to->y[i] = y->wi.y;
    to->z[i] = y->wi.z;
    to->r[i] = y->Le.r;
    to->g[i] = y->Le.g;
    to->b[i] = y->Le.b;
    to->q[i] = y->q_L * scale;
}

enum { TOGETHER = 64 };

/* Directions that were chosen and not yet read. The rays of the last wave have driven the clusters' directions, 256 KiB
 * of them, out of the fast caches: so all are asked for before the first is read, which else is waited for 60 times.
 * (16 and 128 at once take the same time within 2 %, 4 at once up to 5 % more.) */
typedef struct chosen_points {
    uint32_t n;
    const bis_cluster_point *y[TOGETHER];
    float scale[TOGETHER];
} chosen_points;

/* Puts them to lanes from i on. Returns where the next ones go. */
static uint32_t put_chosen(const bis_lanes *to, uint32_t i, chosen_points *c)
{
    for (uint32_t k = 0; k < c->n; k++) put(to, i + k, c->y[k], c->scale[k]);
    i += c->n;
    c->n = 0;
    return i;
}

/* A lamp: all that was drawn in a cluster lies in a disk no larger than the sun's, whose radius is 0.267 degrees. */
static bool is_lamp(const bis_clusters *c, uint32_t k) { return c->cone.cosine[k] >= 0.99998914f; }

uint32_t bis_product_draw(bis_product *p, const bis_clusters *c, const bis_lanes *x, uint16_t *part, float *stands_for,
                          uint32_t n, double offset, double phase, uint64_t pixel)
{
    const uint64_t D = c->directions, whole = D << 16, turn = (uint64_t)(phase * (double)whole);
    const bis_cluster_point nothing = {.q_L = 1};
    chosen_points ahead;
    uint32_t i = ahead.n = 0;

    bis_choose_systematic(&p->clusters, n, p->W, offset);
    for (uint32_t j = 0; j < p->clusters.n_chosen; j++) {
        const uint32_t k = p->clusters.item[j], marks = p->clusters.times[j];
        const bool few = stands_for && marks > OF_LAMP && is_lamp(c, k);
        const uint32_t times = few ? OF_LAMP : marks;
        const bis_cluster_point *y = c->y + (size_t)k * D;
        const float scale = (float)bis_product_scale(p, c, k);
        /* evenly spread: every (D/times)-th from a random one, in 2^-16 of a direction, rounded down. Each cluster
         * begins elsewhere. One division for a cluster: its remainders are added up, and D is a power of two */
        const uint64_t step = whole / times, left = whole % times;
        uint64_t at = (bis_hash(pixel * (2 * BIS_CLUSTERS + 2) + k) & (whole - 1)) + turn, remainder = 0;
        for (uint32_t m = 0; m < times; m++) {
            ahead.y[ahead.n] = &y[at >> 16 & (D - 1)];
            remainder += left;
            at += step + (remainder >= times);
            remainder -= remainder >= times ? times : 0;
            ahead.scale[ahead.n] = scale;
            part[i + ahead.n] = (uint16_t)k;
            if (stands_for) stands_for[i + ahead.n] = (float)marks / (float)times;
            __builtin_prefetch(ahead.y[ahead.n++]);
            if (ahead.n == TOGETHER) i = put_chosen(x, i, &ahead);
        }
    }
    const uint32_t drawn = put_chosen(x, i, &ahead);
    assert(drawn == n || (stands_for && drawn < n));
    for (i = drawn; i < bis_lanes_round_up(drawn); i++) put(x, i, &nothing, 1);
    return drawn;
}
