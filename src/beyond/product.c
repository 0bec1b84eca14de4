/* product: proposal "product", q_P(wi) = q_L(wi) s_k for wi in cluster k, s_k = (w_k/W)/share_k.
 *
 * The w_k bound the integral of f cos Le over cluster k: its energy times the largest f cos over a cone around it
 * (bis/clusters.h). n marks, equally spaced over their running sum, say how many candidates come from each cluster;
 * within it they are evenly spread over the directions that this pass has drawn there. The density is exact whatever
 * the bound is worth; a bound of 0 only where f cos is 0 makes it positive wherever it must be.
 * Unbiased as every proposal: each candidate, seen alone, has density q_P. Cost: a nanosecond a cluster, 10 a
 * candidate. */
#include "product.h"

#include "bis/base/mem.h"

#include <assert.h>

static uint32_t most_clusters(void) { return bis_lanes_round_up(2 * BIS_CLUSTERS + 2); }

bool bis_product_init(bis_product *p, uint32_t M)
{
    const uint32_t m = bis_lanes_round_up(M);

    *p = (bis_product){.W = 0};
    p->floats = bis_alloc(BIS_LANES_ARRAYS * (size_t)m, sizeof *p->floats);
    p->cluster = bis_alloc(m, sizeof *p->cluster);
    if (p->floats && p->cluster && bis_blocks_init(&p->clusters, most_clusters(), M)) {
        p->y = bis_lanes_in(p->floats, m);
        return true;
    }
    bis_product_clear(p);
    return false;
}

void bis_product_clear(bis_product *p)
{
    bis_free(p->floats);
    bis_free(p->cluster);
    bis_blocks_clear(&p->clusters);
    *p = (bis_product){.W = 0};
}

size_t bis_product_bytes(uint32_t M)
{
    return bis_lanes_round_up(M) * (BIS_LANES_ARRAYS * sizeof(float) + sizeof(uint16_t)) +
           bis_blocks_bytes(most_clusters(), M);
}

BIS_LANES
static void multiply(float *restrict w, const float *restrict factor, uint32_t n)
{
#pragma omp simd
    for (uint32_t k = 0; k < n; k++) w[k] *= factor[k];
}

bool bis_product_weigh(bis_product *p, const bis_clusters *c, const float *h, const bis_point *pt)
{
    bis_bsdf_reach(p->clusters.w, &pt->bsdf, &c->cone, c->n);
    if (h) multiply(p->clusters.w, h, bis_lanes_round_up(c->n));
    p->W = bis_blocks_sum(&p->clusters, bis_lanes_round_up(c->n));
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

void bis_product_draw(bis_product *p, const bis_clusters *c, uint32_t n, double offset, double phase, uint64_t pixel)
{
    enum { D = BIS_CLUSTER_DIRECTIONS };
    const uint64_t turn = (uint64_t)(phase * (D << 16));
    const bis_cluster_point nothing = {.q_L = 1};
    uint32_t i = 0;

    bis_blocks_choose_systematic(&p->clusters, n, p->W, offset);
    for (uint32_t j = 0; j < p->clusters.n_chosen; j++) {
        const uint32_t k = p->clusters.lane[j], times = p->clusters.times[j];
        const bis_cluster_point *y = c->y + (size_t)k * D;
        const float scale = (float)bis_product_scale(p, c, k);
        /* evenly spread: every (D/times)-th from a random one, in 2^-16 of a direction. Each cluster begins elsewhere
         */
        const uint64_t first = bis_hash(pixel * (2 * BIS_CLUSTERS + 2) + k) % ((uint64_t)D << 16) + turn;
        for (uint32_t m = 0; m < times; m++, i++) {
            put(&p->y, i, &y[(first + ((uint64_t)m << 16) * D / times) >> 16 & (D - 1)], scale);
            p->cluster[i] = (uint16_t)k;
        }
    }
    assert(i == n);
    for (; i < bis_lanes_round_up(n); i++) put(&p->y, i, &nothing, 1);
}
