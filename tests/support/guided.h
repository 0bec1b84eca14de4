/* SPDX-License-Identifier: BSD-2-Clause */
/* guided: a thread's guide with all that it borrows, at the only cell of a picture of one tile. For the tests of what
 * is beyond the thesis; what the cell knows is theirs to write. */
#ifndef TESTS_GUIDED_H
#define TESTS_GUIDED_H

#include "beyond/guide.h"

#include "lit.h"

/* What one thread has, and what all share. */
typedef struct workspace {
    bis_clusters c;
    bis_visibility v;
    bis_product_guide guide;
    bis_scratch scratch;
} workspace;

static inline void guided_open(workspace *w, const bis_light *light, const bis_settings *s, bool learned)
{
    *w = (workspace){.v = {.n_tiles = 0}};
    assert_true(bis_beyond_needs_of(s).clusters);
    assert_int_equal(bis_clusters_init(&w->c, light, s->candidates, NULL), BIS_OK);
    if (learned) assert_int_equal(bis_visibility_init(&w->v, 1, 0, 1, NULL), BIS_OK);
    assert_int_equal(bis_product_guide_init(&w->guide, &w->c, learned ? &w->v : NULL, NULL), BIS_OK);
    bis_product_guide_look(&w->guide, 0);
    assert_int_equal(bis_scratch_init(&w->scratch, s, NULL), BIS_OK);
    bis_scratch_share(&w->scratch, NULL, &w->guide.steps);
}

static inline void guided_close(workspace *w)
{
    bis_scratch_clear(&w->scratch);
    bis_product_guide_clear(&w->guide);
    bis_visibility_clear(&w->v);
    bis_clusters_clear(&w->c);
}

#endif
