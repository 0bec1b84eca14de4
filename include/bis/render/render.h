/* render: passes over tiles by threads, until a budget of samples, time or error is used up. */
#ifndef BIS_RENDER_H
#define BIS_RENDER_H

#include "bis/render/film.h"
#include "bis/scene/scene.h"

#include <signal.h>
#include <stdbool.h>

enum { BIS_RENDER_TILE = 16 }; /* side, in pixels, of what threads take, of what learns together, and of adaptive sampling's choices */

/* Whichever comes first ends the render; one pass is always completed. All three 0: desc->sampler.spp passes. */
typedef struct bis_budget {
    uint32_t spp;     /* camera samples a pixel; 0: not limited by spp */
    double seconds;   /* of the render phase; 0: not limited */
    double error;     /* upper 95% bound of the relative RMSE; 0: not limited; at least 4 passes. Passes are then independent: other random numbers */
} bis_budget;

typedef struct bis_progress {
    uint32_t passes_done, passes_total; /* total 0: unknown */
    double share;                       /* of the budget used, in [0,1] */
    double seconds, seconds_left;       /* left: NAN while unknown */
} bis_progress;

/* What an error budget will take in all, from the pilot (the first 4 passes). */
typedef struct bis_forecast {
    double error;           /* the upper bound now */
    double spp, seconds;
} bis_forecast;

/* Where the time goes: seconds[g] is raised by the processor seconds of shading points of materials of group g, by half
 * of what reading the clock takes, twice for each point; points[g] by their number. */
typedef struct bis_meter {
    const unsigned char *group; /* group[desc->n_materials] */
    double *seconds;
    uint64_t *points;
} bis_meter;

typedef struct bis_render_options {
    bis_budget budget;
    int n_threads;                             /* 0: all */
    double footprint;                          /* share of a pixel's width, about its centre, that camera rays pass through; 0: all of it. 1/k: a film k times smaller sees every k-th pixel */
    bis_meter *meter;                          /* of one thread (n_threads is 1); NULL: nothing is measured */
    const volatile sig_atomic_t *interrupted;  /* set by a signal handler: stop soon; NULL: never */
    void (*progress)(const bis_progress *p, void *user); /* called from one thread, a few times a second; may be NULL */
    void (*forecast)(const bis_forecast *f, void *user); /* called once, unless the pilot is enough or there is no error budget; may be NULL */
    void *user;
} bis_render_options;

typedef struct bis_render_result {
    bis_counters counters;
    double seconds;
    double relative_rmse; /* NAN: unknown */
    double error_bound;   /* upper 95% bound of it; NAN: unknown */
    bool interrupted;     /* the picture then has the passes that were complete; black where there are none */
    uint64_t spp;         /* camera samples a pixel, with adaptive sampling in the mean (nearly): the budget that makes this picture again */
    uint32_t passes;      /* complete ones; 0 only where the first was interrupted (the film then has passes = 1) */
    int n_threads;
    size_t bytes;         /* of workspace beside the film: the pass under way, the threads' scratch */
} bis_render_result;

/* How many threads that is. */
int bis_render_threads(const bis_render_options *options);

/* Render into film (initialised by the caller). The bits of the film depend on desc and the number of passes, never on
 * threads or time. Errors: BIS_NOMEM. */
bis_status bis_render(bis_render_result *result, bis_film *film, const bis_scene *scene, const bis_scene_desc *desc,
                      const bis_render_options *options, bis_diag *diag);

#endif
