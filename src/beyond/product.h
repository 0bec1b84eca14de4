/* SPDX-License-Identifier: BSD-2-Clause */
/* product: candidates from the map where the product of light and BRDF can be large: proposal "product". */
#pragma once

#include "bis/beyond/visibility.h"
#include "bis/thesis/bsdf.h"
#include "thesis/choose.h"

/* A thread's workspace: the clusters, chosen by the bound of f cos Le over each, and the sum of these bounds. */
typedef struct bis_product {
    bis_choice clusters;
    double W;
} bis_product;

/* bis_product_claim allocates the workspace, as claims say. */
void bis_product_claim(bis_product *p, bis_claims *claims);

/* bis_product_clear frees it. */
void bis_product_clear(bis_product *p);

/* bis_product_weigh weighs the clusters for a material. Returns false if no light can be reflected from any of them. */
bool bis_product_weigh(bis_product *p, const bis_clusters *c, const bis_bsdf *bsdf);

/* bis_product_guess multiplies the weights by what is known of V, as f makes it of them (bis_guess_mix). Returns false
 * if nothing is left of them, because they are near the smallest floats. */
bool bis_product_guess(bis_product *p, const bis_clusters *c, bis_visibility_guess *f);

/* bis_product_draw draws n candidates into x, filled up to whole blocks, and returns how many it has drawn: of a lamp
 * at most four, where stands_for[i] is how many of the n candidate i stands for. stands_for is NULL: each stands for
 * itself. Their density q is q_P = q_L s, with s of bis_product_scale. part[i] is the cluster from which candidate i
 * comes. offset and phase are uniform in [0,1): the place of the marks over the clusters, and that of the candidates in
 * their clusters. */
uint32_t bis_product_draw(bis_product *p, const bis_clusters *c, const bis_lanes *x, uint16_t *part, float *stands_for,
                          uint32_t n, double offset, double phase, uint64_t pixel);

/* bis_product_scale returns s of cluster k: how much more often the product draws from it than the map's importance. */
static inline double bis_product_scale(const bis_product *p, const bis_clusters *c, uint32_t k)
{
    return (double)p->clusters.w[k] / (p->W * bis_cluster_share(c, k));
}
