/* batch: sir.c for all candidates of a point at once, and what a thread needs beyond the thesis: the directions that
 * all points of a pass share (pool, clusters), and the visibility that earlier rays have learned. The choice
 * between this and sir.c is made once, when a render is set up. */
#pragma once

#include "bis/beyond/clusters.h"
#include "bis/beyond/pool.h"
#include "bis/beyond/visibility.h"

typedef struct bis_batch bis_batch;

/* What settings can make use of. */
typedef struct bis_fast_needs {
    uint32_t n_pool; /* directions in a set of a pool; 0: none */
    bool batch;      /* the vector path */
    bool clusters;   /* of proposal "product" */
    bool visibility; /* learned */
} bis_fast_needs;

/* What one thread has of it. Zeros: nothing. */
typedef struct bis_fast {
    bis_batch *batch;             /* its own; NULL: candidates one by one */
    const bis_pool *pool;         /* borrowed; NULL: none */
    const bis_clusters *clusters; /* borrowed; NULL: none, proposal "product" is then "mix" */
    bis_visibility *visibility;   /* borrowed; NULL: nothing is learned */
    bis_foresight foresight;      /* its own: what the cell at hand has learned; h = NULL: nothing */
} bis_fast;

/* bis_fast_needs_of returns what a render with these settings can make use of. */
bis_fast_needs bis_fast_needs_of(const bis_settings *s);

/* bis_fast_init allocates the workspace of the vector path, if the settings need it. Errors: BIS_NOMEM. */
bis_status bis_fast_init(bis_fast *f, const bis_settings *s, bis_diag *diag);
void bis_fast_clear(bis_fast *f);

/* bis_fast_bytes returns the bytes of that workspace. */
size_t bis_fast_bytes(const bis_settings *s);

/* bis_fast_Lo returns the function that renders with these settings: bis_batch_Lo where the vector path can be used,
 * else the integrator's own. */
typedef rgb bis_Lo(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch);
bis_Lo *bis_fast_Lo(const bis_settings *s);

/* bis_batch_Lo returns one estimate, as bis_sir.Lo does. It calls bis_sir.Lo where the point does not fit:
 * scratch->fast has no directions, the material has no vector code, or nothing is reflected. */
rgb bis_batch_Lo(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch);
