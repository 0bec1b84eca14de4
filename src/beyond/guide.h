/* guide: proposal "product" and learned visibility as the steps of a set (src/thesis/set.h), and what a render can make
 * use of beyond the thesis. */
#pragma once

#include "bis/beyond/clusters.h"
#include "bis/beyond/pool.h"
#include "bis/beyond/visibility.h"
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

/* What one thread has. */
typedef struct bis_product_guide {
    bis_guide steps;               /* the first member: a set knows only this */
    bis_product product;
    const bis_clusters *clusters;  /* borrowed, shared by all threads */
    bis_visibility *visibility;    /* borrowed, shared by all threads; NULL: nothing is learned */
    bis_foresight foresight;       /* what the cell at hand has learned */
} bis_product_guide;

/* bis_product_guide_init makes a thread's guide. visibility may be NULL. Errors: BIS_NOMEM. */
bis_status bis_product_guide_init(bis_product_guide *g, const bis_clusters *clusters, bis_visibility *visibility,
                                  bis_diag *diag);

/* bis_product_guide_clear frees it. */
void bis_product_guide_clear(bis_product_guide *g);

/* bis_product_guide_bytes returns the bytes that it takes without visibility; bis_foresight_bytes those beside. */
size_t bis_product_guide_bytes(void);

/* bis_product_guide_look stores what is known of visibility in a cell of the picture (bis/beyond/visibility.h). Points
 * that are drawn afterwards must be in this cell. Without visibility it does nothing. */
void bis_product_guide_look(bis_product_guide *g, size_t cell);
