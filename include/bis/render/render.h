/* SPDX-License-Identifier: BSD-2-Clause */
/* render: passes over tiles by threads, until a budget of samples, time or error is used up. */
#pragma once

#include "bis/render/film.h"
#include "bis/scene/scene.h"

#include <signal.h>
#include <stdbool.h>

/* Side in pixels of a tile: threads take tiles, a tile learns together. A side touches at most 6 of the squares of 3
 * pixels or more of which each has a twin (film_twins.c). */
enum { BIS_RENDER_TILE = 16, BIS_RENDER_TILE_TWINS = 6 * 6 };

/* The limit that is reached first ends the render. One pass is always completed, unless first_light is set. If all
 * three are 0, view->sampler.spp camera samples of each pixel are rendered. */
typedef struct bis_budget {
    uint32_t spp;     /* camera samples per pixel; 0: no limit */
    double seconds;   /* seconds of the render phase; 0: no limit */
    /* upper 95% bound of the relative RMSE, as bis_film_estimate_error knows it; 0: no limit. At least 3 passes are
     * then rendered */
    double error;
} bis_budget;

typedef struct bis_progress {
    uint32_t passes_done, passes_total; /* passes_total is 0 while unknown */
    double share;                       /* share of the budget that is used, in [0,1] */
    double seconds, seconds_left;       /* seconds_left is NAN while unknown */
} bis_progress;

/* What an error budget will take in total. The first passes after which the error is known predict it. */
typedef struct bis_forecast {
    double error;           /* the upper bound now */
    double spp, seconds;
} bis_forecast;

/* The k-th (1 to n) of n shares of the tiles of a picture; n = 0: the whole picture. */
typedef struct bis_part {
    uint32_t k, n;
} bis_part;

typedef struct bis_ranks bis_ranks;             /* src/render/ranks.h */
typedef struct bis_checkpoint bis_checkpoint; /* src/render/checkpoint.h */

typedef struct bis_render_result {
    bis_counters counters; /* this and all below include what a checkpoint brought */
    double seconds;
    bis_film_error error; /* not known of a part */
    bool interrupted;     /* the picture then has the passes that were complete; it is black if there were none */
    /* camera samples per pixel: the budget that makes this picture again */
    uint64_t spp;
    uint32_t passes;      /* complete passes; 0 only if the first one was interrupted (the film then has passes = 1) */
    /* share of the pixels that the first pass did not reach, because it was ended (first_light): they have no camera
     * sample, and the colour of a neighbour */
    double missing;
    bis_portal portals[BIS_PORTALS_MAX]; /* through which it looked for light: given, or found (src/render/windows.h) */
    uint32_t n_portals;
    int n_threads;
    size_t bytes;         /* of workspace beside the film: the current pass and the scratch of the threads */
} bis_render_result;

typedef struct bis_render_options {
    bis_budget budget;
    int n_threads;                             /* 0: all threads */
    uint32_t pass_size; /* camera samples of a pixel in every pass; 0: 1, 1, 2, then 4 */
    const volatile sig_atomic_t *interrupted;  /* set by a signal handler: the render stops soon; NULL: never */
    void (*progress)(const bis_progress *p, void *user); /* called by one thread, a few times a second; may be NULL */
    /* called once, unless the first passes are enough or there is no error budget; may be NULL */
    void (*forecast)(const bis_forecast *f, void *user);
    /* A glimpse of every 8th pixel of every 8th row comes before the first pass (src/render/first_light.h), which may
     * then end before it is complete: by `seconds` or `interrupted`. Neither with a part or the ranks, nor with a
     * checkpoint, because these hold whole passes only */
    bool first_light;
    /* called between passes by one thread, each time `every` seconds have passed, with the result so far, of which the
     * film is then complete; may be NULL */
    void (*so_far)(const bis_render_result *result, void *user);
    double every;
    void *user;
    bis_part part;              /* only these tiles are rendered, the rest of the film stays 0 */
    bis_ranks *ranks;             /* other processes that take part; NULL: none. All of them call bis_render */
    bis_checkpoint *checkpoint; /* what to go on from, and where to keep the state; NULL: neither */
} bis_render_options;

/* bis_render_threads returns the number of threads that these options use. */
int bis_render_threads(const bis_render_options *options);

/* bis_render renders into film, which the caller has initialised. view says what is seen and how; it may differ from
 * scene->desc->view, but scene must have been built for what its settings need. The bits of the film depend on
 * scene->desc, view and the number of passes, never on threads, time, or checkpoints. *result receives what was done.
 * Errors: BIS_NOMEM, BIS_INPUT (the checkpoint belongs to another render, or has more camera samples than are asked
 * for; there are fewer tiles than parts; a rank renders another scene). With ranks only rank 0 has the result. */
bis_status bis_render(bis_render_result *result, bis_film *film, const bis_scene *scene, const bis_view *view,
                      const bis_render_options *options, bis_diag *diag);
