/* SPDX-License-Identifier: BSD-2-Clause */
/* pool: directions from the map that are drawn once for many pixels.
 *
 * Most of the cost of a candidate is drawing a stratified set of M directions anew for each pixel: a search along the
 * curve, some cache lines, a sine and a cosine. A pool holds many such sets, which are drawn once per pass; each
 * pixel takes one of them at random. The directions of a set have the light's density, as if they were drawn for that
 * pixel alone, so every estimate stays unbiased. The price is that pixels with the same set share its noise. A pool
 * has at least 16 sets and mostly 256, so neighbours rarely share one, and the next pass has other sets. */
#pragma once

#include "bis/thesis/lanes.h"
#include "bis/thesis/integrator.h"
#include "bis/thesis/rng.h"
#include "bis/base/status.h"

#include <stdint.h>

/* A larger set is drawn for each pixel alone, because its noise is small and because few sets would fit into the
 * caches. */
#define BIS_POOL_MAX_SET ((uint32_t)1 << 14)

typedef struct bis_pool {
    bis_sets sets; /* the pool as an integrator sees it (bis_scratch) */
    uint32_t n_sets, M;
    /* lanes[n_sets][BIS_LANES_ARRAYS][M, whole blocks]: each set along the light's curve, one direction in each M-th
     * part of its importance; what fills the last block has no radiance */
    float *lanes;
} bis_pool;

/* bis_pool_needs returns n_set of the integrator's needs: the size of the sets that it takes with these settings. 0
 * means none, or more than BIS_POOL_MAX_SET. */
uint32_t bis_pool_needs(const bis_settings *s);

/* bis_pool_init allocates sets of M directions, 1 <= M <= BIS_POOL_MAX_SET: 256 sets, or fewer if these would hold
 * more than 2^18 directions (7 MiB). Errors: BIS_NOMEM. */
bis_status bis_pool_init(bis_pool *p, uint32_t M, bis_diag *diag);

/* bis_pool_clear frees the pool. *p is empty afterwards. */
void bis_pool_clear(bis_pool *p);

/* bis_pool_bytes returns the bytes that the pool takes. */
size_t bis_pool_bytes(const bis_pool *p);

/* bis_pool_fill draws all sets anew, as a function of (seed, pass). The light must have a curve and must not be
 * black. */
void bis_pool_fill(bis_pool *p, const bis_light *light, uint64_t seed, uint32_t pass, int n_threads);

/* bis_pool_choose returns the index of a set, chosen uniformly. */
static inline uint32_t bis_pool_choose(const bis_pool *p, bis_rng *rng)
{
    return (uint32_t)bis_rng_below(rng, p->n_sets);
}

/* bis_pool_set returns the M directions of a set. */
static inline bis_lanes bis_pool_set(const bis_pool *p, uint32_t set)
{
    const uint32_t n = bis_lanes_round_up(p->M);
    return bis_lanes_in(p->lanes + (size_t)set * BIS_LANES_ARRAYS * n, n);
}
