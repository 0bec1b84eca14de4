/* integrator: estimators of the reflected radiance at a point. Source: thesis chapters 3 and 4. Each has one file:
 * src/thesis/em.c, brdf.c, mis.c, rejection.c, sir.c, exact.c and unoccluded.c. All of them see the scene through
 * bis_point and take their random numbers from bis_stream. */
#pragma once

#include "bis/thesis/point.h"
#include "bis/thesis/sampler.h"
#include "bis/thesis/settings.h"

#include <stdint.h>

/* A candidate direction of chapter 4. It is drawn, then weighed, and a shadow ray is traced for it if it is chosen. C
 * is its value in plain importance sampling (eq. 4.8). The sum of C's channels is w = phat/q, the weight of eq. 4.9;
 * C/w = F/phat carries the colour. Below the horizon w and C are 0. */
typedef struct bis_candidate {
    vec3 wi;
    rgbd C;   /* F/q with F = f cos Le in RGB; double, because f Le alone may exceed a float */
    double w; /* C.r + C.g + C.b */
} bis_candidate;

/* What an integrator needs of a thread's workspace: the numbers of candidates, sample points and chosen candidates.
 * n_set is the number of stratified directions from the map that one estimate takes. A renderer may offer sets of
 * this size. */
typedef struct bis_needs {
    uint32_t n_candidates, n_points, n_chosen, n_set;
} bis_needs;

/* Sets of n_set stratified directions from the map, which many points share. `choose` returns one of the sets. */
typedef struct bis_sets bis_sets;
struct bis_sets {
    const bis_light_point *(*choose)(const bis_sets *sets, bis_stream *stream);
};

/* A thread's workspace. It is allocated once, before rendering. */
typedef struct bis_scratch {
    bis_candidate *candidates; /* [n_candidates] */
    double (*u)[2];            /* [n_points] */
    uint32_t *chosen;          /* [n_chosen] */
    const bis_sets *sets;      /* borrowed; NULL: each point draws its own directions */
    struct bis_set *set;       /* owned: the candidates side by side */
    struct bis_fast *fast;     /* borrowed; only src/beyond/batch.h looks into it; NULL: none */
} bis_scratch;

struct bis_integrator {
    const char *name;
    const char *words; /* what it does, in a line of `bis help` */
    const char *claim; /* "unbiased", or how and when it is biased; --plan, `bis help` and the docs show it */
    bool without_shadows; /* it estimates L_ns (eq. 4.5) */

    /* light_needs returns what the integrator needs of the light, a set of BIS_NEED_*. scratch_needs adds what it
     * needs of the workspace; *need is zero before the call. */
    unsigned (*light_needs)(const bis_settings *s);
    void (*scratch_needs)(const bis_settings *s, bis_needs *need);

    /* Lo returns one estimate of the radiance that is reflected at pt towards pt->wo. */
    rgb (*Lo)(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch);
};

/* bis_scratch_init allocates what the integrator of s needs. Errors: BIS_NOMEM. */
bis_status bis_scratch_init(bis_scratch *scratch, const bis_settings *s, bis_diag *diag);

/* bis_scratch_clear frees the workspace. */
void bis_scratch_clear(bis_scratch *scratch);

/* bis_scratch_bytes returns the bytes that a thread's workspace takes with these settings. */
size_t bis_scratch_bytes(const bis_settings *s);
