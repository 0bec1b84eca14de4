/* product: candidates from the map where the product of light and BRDF can be large. For batch.c. */
#pragma once

#include "bis/beyond/clusters.h"
#include "blocks.h"

/* A thread's workspace. */
typedef struct bis_product {
    bis_blocks clusters; /* by the bound of f cos Le over each */
    bis_lanes y;         /* the candidates, [M] */
    uint16_t *cluster;   /* [M]: where they come from */
    float *floats;
    double W;
} bis_product;

bool bis_product_init(bis_product *p, uint32_t M);
void bis_product_clear(bis_product *p);
size_t bis_product_bytes(uint32_t M);

/* Weigh the clusters at pt, times h[n] unless that is NULL. False: no light can be reflected from any of them. */
bool bis_product_weigh(bis_product *p, const bis_clusters *c, const float *h, const bis_point *pt);

/* Draw n candidates, filled up to whole blocks; their q_L is q_P = q_L s, see bis_product_scale. n <= M. offset and
 * phase are uniform in [0,1): the place of the marks over the clusters, and that of the candidates in their cluster. */
void bis_product_draw(bis_product *p, const bis_clusters *c, uint32_t n, double offset, double phase, uint64_t pixel);

/* s of cluster k: how much more often the product draws from it than the map's importance does. */
static inline double bis_product_scale(const bis_product *p, const bis_clusters *c, uint32_t k)
{
    return (double)p->clusters.w[k] / (p->W * bis_cluster_share(c, k));
}
