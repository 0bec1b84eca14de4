/* visibility: how often shadow rays towards each part of the map came through, in each tile of the picture, as earlier
 * passes have found.
 *
 * With the product known, all that is left of the noise is that of V (docs/errata.md E31), and V is alike for
 * neighbours. The best weights for N rays go as the product times the root of the second moment of V, which is the root
 * of its mean v (V is 0 or 1). A tile that has counted multiplies the product by g = sqrt(v + 0.02): never 0, since
 * what was never seen may be seen.
 * Unbiased: what a pass uses was counted by earlier passes alone, which share no random number with it, and all passes
 * weigh the same.
 *
 * The parts are runs of clusters (bis/clusters.h), which are compact. 16 bytes a part and tile. */
#ifndef BIS_VISIBILITY_H
#define BIS_VISIBILITY_H

#include "bis/beyond/clusters.h"

enum { BIS_VISIBILITY_PARTS = 128 };

typedef struct bis_seen {
    uint32_t rays, seen;
} bis_seen;

typedef struct bis_visibility {
    size_t n_tiles;
    bis_seen (*known)[BIS_VISIBILITY_PARTS];  /* by the passes before this one */
    bis_seen (*counted)[BIS_VISIBILITY_PARTS]; /* by this one */
} bis_visibility;

/* Errors: BIS_NOMEM. */
bis_status bis_visibility_init(bis_visibility *v, size_t n_tiles, bis_diag *diag);
void bis_visibility_clear(bis_visibility *v);
size_t bis_visibility_bytes(const bis_visibility *v);

/* The part that cluster k of n belongs to. */
static inline uint32_t bis_visibility_part(uint32_t k, uint32_t n) { return (uint32_t)((uint64_t)k * BIS_VISIBILITY_PARTS / n); }

/* g of a tile for each of n clusters: g[n], each in (0.1, 1.01). Before anything was counted, all the same. */
void bis_visibility_factors(float *g, uint32_t n, const bis_visibility *v, size_t tile);

/* The pass is complete: what it counted is known. */
void bis_visibility_learn(bis_visibility *v, int n_threads);

#endif
