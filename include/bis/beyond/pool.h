/* pool: directions from the map, drawn once for many pixels.
 *
 * Drawing a stratified set of M directions anew for each pixel costs most of a candidate: a search along the curve, a
 * handful of cache lines, a sine and a cosine. A pool holds many such sets, drawn once per pass; each pixel takes one
 * of them at random. A set's directions have the light's density, as if drawn for that pixel alone, so every estimate
 * stays unbiased. What it costs: pixels that take the same set share its noise; with at least 16, mostly 256 sets
 * neighbours rarely do, and the next pass has other sets. */
#ifndef BIS_POOL_H
#define BIS_POOL_H

#include "bis/beyond/lanes.h"
#include "bis/thesis/integrator.h"
#include "bis/thesis/rng.h"
#include "bis/base/status.h"

#include <stdint.h>

/* A set of more directions than this is drawn for each pixel alone: its noise is small, and few sets would fit into the
 * caches. */
#define BIS_POOL_MAX_SET ((uint32_t)1 << 14)

typedef struct bis_pool {
    bis_sets sets; /* the pool as an integrator sees it (bis_scratch) */
    uint32_t n_sets, M;
    bis_light_point *y; /* y[n_sets][M]: each set along the light's curve, one direction in each M-th of its importance */
    float *lanes;       /* lanes[n_sets][BIS_LANES_ARRAYS][M, whole blocks]: the same for src/beyond/batch.c; NULL: not asked for */
} bis_pool;

/* bis_pool_needs returns the size of the sets that an integrator with these settings takes, n_set of its needs.
 * 0: none, or more than BIS_POOL_MAX_SET. */
uint32_t bis_pool_needs(const bis_settings *s);

/* Room for sets of M directions, 1 <= M <= BIS_POOL_MAX_SET: 256 of them, fewer where that would be over 2^18
 * directions, 8 MiB. Errors: BIS_NOMEM. */
bis_status bis_pool_init(bis_pool *p, uint32_t M, bool lanes, bis_diag *diag);
void bis_pool_clear(bis_pool *p);
size_t bis_pool_bytes(const bis_pool *p);

/* Draw all sets anew, as a function of (seed, pass). The light must be able to sample its curve, and not be black. */
void bis_pool_fill(bis_pool *p, const bis_light *light, uint64_t seed, uint32_t pass, int n_threads);

/* The number of a set, each as probable; its directions, y[M]; the same as lanes, filled up with what gives no
 * light. */
static inline uint32_t bis_pool_choose(const bis_pool *p, bis_rng *rng) { return (uint32_t)bis_rng_below(rng, p->n_sets); }
static inline const bis_light_point *bis_pool_set(const bis_pool *p, uint32_t set) { return p->y + (size_t)set * p->M; }
static inline bis_lanes bis_pool_lanes(const bis_pool *p, uint32_t set)
{
    const uint32_t n = bis_lanes_round_up(p->M);
    return bis_lanes_in(p->lanes + (size_t)set * BIS_LANES_ARRAYS * n, n);
}

#endif
