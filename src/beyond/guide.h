/* SPDX-License-Identifier: BSD-2-Clause */
/* guide: proposal "product" and learned visibility as the steps of a set (src/thesis/set.h), and what a render can make
 * use of beyond the thesis. */
#pragma once

#include "bis/beyond/clusters.h"
#include "bis/beyond/pool.h"
#include "bis/beyond/visibility.h"
#include "portal.h"
#include "product.h"
#include "thesis/set.h"

/* What settings can make use of. */
typedef struct bis_beyond_needs {
    uint32_t n_pool; /* directions in a set of a pool; 0: none */
    bool clusters;   /* of proposal "product" */
    bool visibility; /* learned */
} bis_beyond_needs;

/* bis_beyond_needs_of returns what a render with these settings can make use of. */
bis_beyond_needs bis_beyond_needs_of(const bis_settings *s);

/* bis_beyond_needs_under returns the same for a light that is known: nothing under one of which nothing can be
 * drawn, nor under a constant light if nothing is learned. The light must be built for these settings. */
bis_beyond_needs bis_beyond_needs_under(const bis_settings *s, const bis_light *light);

/* What one thread has. */
typedef struct bis_product_guide {
    bis_guide steps;               /* the first member: a set knows only this */
    bis_product product;
    const bis_clusters *clusters;  /* borrowed, shared by all threads */
    bis_visibility *visibility;    /* borrowed, shared by all threads; NULL: nothing is learned */
    bis_visibility_guess guess;        /* what the cell at hand has learned */
    bis_portals portals;           /* as the point at hand sees them */
} bis_product_guide;

/* bis_product_guide_init makes a thread's guide. visibility may be NULL. Errors: BIS_NOMEM. */
bis_status bis_product_guide_init(bis_product_guide *g, const bis_clusters *clusters, bis_visibility *visibility,
                                  bis_diag *diag);

/* bis_product_guide_clear frees it. */
void bis_product_guide_clear(bis_product_guide *g);

/* bis_product_guide_bytes returns the bytes that it takes; an empty one takes none. */
size_t bis_product_guide_bytes(const bis_product_guide *g);

/* bis_product_guide_look stores what is known of visibility in a cell of the picture (bis/beyond/visibility.h). Points
 * that are drawn afterwards must be in this cell. Without visibility it does nothing. */
void bis_product_guide_look(bis_product_guide *g, size_t cell);

/* What one thread needs to look at single points as a render looks at them, but with nothing learned: a workspace, and
 * clusters of its own if proposal "product" makes use of them. It must not be moved. */
typedef struct bis_probe {
    bis_scratch scratch;
    bis_clusters clusters; /* n = 0: none */
    bis_product_guide guide;
} bis_probe;

/* bis_probe_init allocates all that integrator s makes use of under this light. Errors: BIS_NOMEM. */
bis_status bis_probe_init(bis_probe *p, const bis_settings *s, const bis_light *light, bis_diag *diag);

/* bis_probe_clear frees it. */
void bis_probe_clear(bis_probe *p);

/* bis_probe_begin_pass draws the directions of the clusters anew, as a render draws them for this pass. Estimates of
 * one pass share them, and so their noise. It must be called before the first estimate. */
void bis_probe_begin_pass(bis_probe *p, const bis_light *light, uint64_t seed, uint32_t pass);
