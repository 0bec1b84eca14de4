/* SPDX-License-Identifier: BSD-2-Clause */
/* integrator: estimators of the reflected radiance at a point. Source: thesis chapters 3 and 4. Each has one file:
 * src/thesis/em.c, brdf.c, mis.c, rejection.c, sir.c, exact.c and unoccluded.c. All of them see the scene through
 * bis_point and take their random numbers from bis_stream. */
#pragma once

#include "bis/thesis/point.h"
#include "bis/thesis/sampler.h"
#include "bis/thesis/settings.h"

#include <stdint.h>

/* What an integrator needs of a thread's workspace: the numbers of sample points, of candidates, and of candidates that
 * are traced. n_set is the number of stratified directions from the map that one estimate takes. A renderer may offer
 * sets of this size. */
typedef struct bis_needs {
    uint32_t n_points, n_candidates, n_traced, n_set;
} bis_needs;

/* Sets of n_set stratified directions from the map, which many points share. `choose` returns one of the sets. */
typedef struct bis_sets bis_sets;
struct bis_sets {
    bis_lanes (*choose)(const bis_sets *sets, bis_stream *stream);
};

/* A thread's workspace. It is allocated once, before rendering. */
typedef struct bis_scratch {
    double (*u)[2];           /* [n_points] */
    struct bis_set *set;      /* the candidates of chapter 4 (src/thesis/set.h); NULL: n_candidates = 0 */
    const bis_sets *sets;     /* borrowed; NULL: each point draws its own directions */
    struct bis_guide *guide;  /* borrowed; what is known beyond the thesis (src/thesis/set.h); NULL: nothing */
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

/* bis_scratch_init allocates what the integrator of s needs. sets and guide are NULL. Errors: BIS_NOMEM. */
bis_status bis_scratch_init(bis_scratch *scratch, const bis_settings *s, bis_diag *diag);

/* bis_scratch_share lets the workspace use what other points or threads use, too. Both are borrowed and may be NULL. */
void bis_scratch_share(bis_scratch *scratch, const bis_sets *sets, struct bis_guide *guide);

/* bis_scratch_clear frees the workspace. */
void bis_scratch_clear(bis_scratch *scratch);

/* bis_scratch_bytes returns the bytes that a thread's workspace takes with these settings. */
size_t bis_scratch_bytes(const bis_settings *s);
