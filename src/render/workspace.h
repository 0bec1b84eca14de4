/* SPDX-License-Identifier: BSD-2-Clause */
/* workspace: what the threads of a render work with: the pools and clusters that all points of a pass share, scratch
 * for each thread, room for the pass under way. Made once, when a render is set up. For render.c and pass.c. */
#pragma once

#include "bis/render/render.h"

#include "beyond/guide.h"
#include "edges.h"
#include "wave.h"

#include <stdalign.h>

#ifdef _OPENMP
#include <omp.h>
#endif

/* What one thread has for itself; a cache line of its own, because its counters change with every ray. */
typedef struct bis_worker {
    alignas(64) bis_counters counters; /* of this pass */
    bis_scratch scratch;
    bis_product_guide guide; /* clusters = NULL: none */
    bis_wave *wave;
    bis_pixel_sum pixels[BIS_RENDER_TILE * BIS_RENDER_TILE]; /* of the tile at hand */
} bis_worker;

/* Called by one thread after each of its tiles or squares, with the share of the pass that is done. */
typedef void bis_pass_progress(double share, void *user);

/* What a pass makes of a pixel, kept until the pass is complete: the mean of its camera samples. */
typedef struct bis_pixel_mean {
    rgb L;
    float hit; /* the share that hit geometry */
} bis_pixel_mean;

typedef struct bis_workspace {
    const bis_scene *scene; /* what is rendered: who makes a workspace sets these five */
    const bis_scene_desc *desc;
    const bis_view *view;
    const bis_render_options *options;
    bis_film *film;
    bis_xform to_camera;

    int n_threads;
    bis_worker *workers; /* workers[n_threads] */
    bis_pool pool;            /* M = 0: none */
    bis_clusters clusters;    /* n = 0: none */
    bis_clusters of_twins;    /* the same for the twins, with directions of their own */
    bis_visibility visibility; /* n_tiles = 0: none */
    bool surveyed;             /* its squares are closed, see survey.h */

    int n_tiles;              /* bis_film_tiles */
    int *own, n_own;          /* own[n_own]: the tiles that the film has, ascending; NULL: all n_tiles */
    int *share, n_share;      /* share[n_share]: those of them that this rank renders (team.h); NULL: all */
    bool is_ended;            /* a rank was interrupted in the last pass */
    bool whole_tiles;         /* pixels of a tile beside the crop are rendered as well */
    bis_rect area;            /* what is rendered: the crop, or all of its tiles */
    unsigned char *edge;      /* bits of the area, see edges.h; NULL: all pixels are alike */
    bis_sampler edge_samplers[BIS_EDGE_KINDS]; /* of all camera samples of a pixel, by its kind */
    bis_settings edge_settings; /* of each of them */
    bis_pixel_mean *pass;     /* pass[height][width] of the crop */
    unsigned char *fine;      /* fine[n_tiles] of the first pass, see first_light.h; NULL: it is like all others */
    double late;              /* on bis_clock_now's clock: the first pass ends then, if `fine` is there */
    rgb *pass_twins;          /* pass_twins[bis_film_twins]: what the pass makes of them; NULL: no twins */
    float *pass_layers;       /* pass_layers[height][width][film->layers.n_values]; NULL: no layers */
} bis_workspace;

/* bis_workspace_init makes the rest of *w, but the edges, of which scene, desc, view, options and film are set, and all
 * else is 0. These are borrowed. Errors: BIS_NOMEM, BIS_INPUT (the part that is asked for has no tile); *w can then be
 * cleared. */
bis_status bis_workspace_init(bis_workspace *w, bis_diag *diag);
void bis_workspace_clear(bis_workspace *w);

/* bis_workspace_find_edges traces the rays of edges.h, where there are edges to find. Each rank looks at a
 * share of the tiles. Errors: BIS_NOMEM. */
bis_status bis_workspace_find_edges(bis_workspace *w, bis_diag *diag);

/* bis_workspace_join_edges gives all edges to all ranks, which must all call it. */
void bis_workspace_join_edges(bis_workspace *w);

/* bis_workspace_edge_rays returns how many rays find the edges of what is rendered, by all ranks together. */
uint64_t bis_workspace_edge_rays(const bis_workspace *w);

/* bis_workspace_own returns the i-th of the n_own tiles that the film has. */
static inline int bis_workspace_own(const bis_workspace *w, int i) { return w->own ? w->own[i] : i; }

/* bis_workspace_shared returns how many tiles are rendered here, bis_workspace_share the i-th of them. */
static inline int bis_workspace_shared(const bis_workspace *w) { return w->share ? w->n_share : w->n_own; }
static inline int bis_workspace_share(const bis_workspace *w, int i)
{
    return w->share ? w->share[i] : bis_workspace_own(w, i);
}

/* bis_workspace_thread returns the number of this thread, which is that of its worker. */
static inline int bis_workspace_thread(void)
{
#ifdef _OPENMP
    return omp_get_thread_num();
#else
    return 0;
#endif
}

/* bis_workspace_interrupted returns true once the flag of the options is set, here or on another rank. The read is
 * atomic, because another thread may set it as well as a signal. */
static inline bool bis_workspace_interrupted(const bis_workspace *w)
{
    if (w->is_ended) return true;
    return w->options->interrupted && __atomic_load_n(w->options->interrupted, __ATOMIC_RELAXED);
}

/* bis_workspace_tile returns tile t as it is rendered: whole, or cut by the crop. */
bis_rect bis_workspace_tile(const bis_workspace *w, int t);

/* bis_workspace_layers returns the values of the layers of pixel i of the pass under way; NULL: there are no layers. */
float *bis_workspace_layers(const bis_workspace *w, size_t i);

/* bis_workspace_bytes returns the bytes of *w, without the film and the edges. */
size_t bis_workspace_bytes(const bis_workspace *w);

/* bis_counters_add adds c to *sum. */
void bis_counters_add(bis_counters *sum, const bis_counters *c);
