/* visibility: what share of the shadow rays towards each part of the map came through, in each tile of the picture,
 * as earlier passes measured it.
 *
 * If the product is known, all that remains of the noise is that of V (docs/errata.md E31), and neighbouring pixels
 * have similar V. The best weights for N rays are proportional to the product times the root of the second moment of
 * V, which is the root of its mean v, because V is 0 or 1. A tile that has counted multiplies the product by g =
 * sqrt(v + 0.02). g is never 0, because a part that was never seen may still be visible.
 *
 * The estimates are unbiased: a pass uses only the counts of earlier passes, which share no random number with it,
 * and all passes have equal weight.
 *
 * A part is a run of clusters (bis/beyond/clusters.h), so it is compact. A part takes 16 bytes per tile. */
#pragma once

#include "bis/beyond/clusters.h"

enum { BIS_VISIBILITY_PARTS = 128 };

typedef struct bis_seen {
    uint32_t rays, seen;
} bis_seen;

typedef struct bis_visibility {
    size_t n_tiles;
    bis_seen (*known)[BIS_VISIBILITY_PARTS];  /* counted by the passes before this one */
    bis_seen (*counted)[BIS_VISIBILITY_PARTS]; /* counted by this pass */
} bis_visibility;

/* bis_visibility_init allocates the counts of n_tiles tiles, all 0. Errors: BIS_NOMEM. */
bis_status bis_visibility_init(bis_visibility *v, size_t n_tiles, bis_diag *diag);

/* bis_visibility_clear frees the counts. *v is empty afterwards. */
void bis_visibility_clear(bis_visibility *v);

/* bis_visibility_bytes returns the bytes that the counts take. */
size_t bis_visibility_bytes(const bis_visibility *v);

/* bis_visibility_part returns the part that cluster k of n belongs to. */
static inline uint32_t bis_visibility_part(uint32_t k, uint32_t n)
{
    return (uint32_t)((uint64_t)k * BIS_VISIBILITY_PARTS / n);
}

/* bis_visibility_factors stores the factors g[n] of a tile for n clusters, each in (0.1, 1.01). Before anything was
 * counted, all of them are equal. */
void bis_visibility_factors(float *g, uint32_t n, const bis_visibility *v, size_t tile);

/* bis_visibility_learn ends a pass: what the pass counted is added to what is known. */
void bis_visibility_learn(bis_visibility *v, int n_threads);
