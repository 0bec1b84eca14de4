/* integrator: estimators of the reflected radiance at a point. Source: thesis chapters 3 and 4. Each has one file:
 * src/thesis/em.c, brdf.c, mis.c, rejection.c, sir.c, exact.c and unoccluded.c. All of them see the scene through
 * bis_point and take their random numbers from bis_stream. */
#ifndef BIS_INTEGRATOR_H
#define BIS_INTEGRATOR_H

#include "bis/thesis/point.h"
#include "bis/thesis/sampler.h"

#include <stdint.h>

typedef enum bis_proposal {
    BIS_PROPOSAL_EM,
    BIS_PROPOSAL_BRDF,
    BIS_PROPOSAL_MIX,
    BIS_PROPOSAL_CHOOSE,
    BIS_PROPOSAL_PRODUCT
} bis_proposal;

typedef enum bis_heuristic { BIS_HEURISTIC_BALANCE, BIS_HEURISTIC_POWER } bis_heuristic;
typedef enum bis_resampling { BIS_RESAMPLING_SYSTEMATIC, BIS_RESAMPLING_MULTINOMIAL } bis_resampling;
typedef enum bis_estimator { BIS_ESTIMATOR_RATIO, BIS_ESTIMATOR_PLAIN } bis_estimator;
typedef enum bis_fallback { BIS_FALLBACK_RESAMPLE, BIS_FALLBACK_SUBSET, BIS_FALLBACK_UNOCCLUDED } bis_fallback;

typedef struct bis_integrator bis_integrator;

/* The parameters of all integrators (docs/scene-format.md, "Integrator"). Each integrator reads its own. */
typedef struct bis_settings {
    const bis_integrator *integrator;
    uint32_t samples;    /* em, brdf, mis: N, >= 1 */
    uint32_t candidates; /* rejection, sir, unoccluded: M, >= 1 */
    uint32_t shadowrays; /* rejection, sir: N, >= 1 */
    uint32_t perpatch;   /* exact: rays in a patch, >= 1 */
    bis_proposal proposal;
    bis_heuristic heuristic;
    bis_resampling resampling;
    bis_estimator estimator;
    bis_fallback fallback;
    double split;    /* mis: the share of the samples that the EM gets */
    bool compensate; /* mis */
    bool stratify;   /* em, mis, sir: take the map's samples along its curve */
    bool learn;      /* sir with proposal "product": use the visibility that earlier passes measured */
    bool vectorize;  /* sir: compute many candidates at once where possible (src/beyond/batch.c) */
    bool only_sir;   /* auto: choose only among the settings of sir */
    unsigned as_printed; /* all: BIS_E* of bis/thesis/errata.h, the equations to follow as printed; 0: none */
} bis_settings;

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
    struct bis_fast *fast;     /* borrowed; only src/beyond/batch.h looks into it; NULL: none */
} bis_scratch;

struct bis_integrator {
    const char *name;
    const char *claim; /* "unbiased", or how and when it is biased; --plan and the docs show it */

    /* light_needs returns what the integrator needs of the light, a set of BIS_NEED_*. scratch_needs adds what it
     * needs of the workspace; *need is zero before the call. */
    unsigned (*light_needs)(const bis_settings *s);
    void (*scratch_needs)(const bis_settings *s, bis_needs *need);

    /* Lo returns one estimate of the radiance that is reflected at pt towards pt->wo. */
    rgb (*Lo)(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch);
};

extern const bis_integrator bis_em, bis_brdf, bis_mis, bis_rejection, bis_sir, bis_exact, bis_unoccluded;

/* A placeholder and not an estimator: src/tools/auto/auto.c replaces it with the integrator that it selects. If
 * nobody has replaced it, it behaves like sir with default settings. It is not in the list below. */
extern const bis_integrator bis_auto;

/* All integrators. NULL ends the list. */
extern const bis_integrator *const bis_integrators[];

/* bis_integrator_find returns the integrator with this name, or NULL if there is none. It also finds "auto". */
const bis_integrator *bis_integrator_find(const char *name);

/* bis_settings_default returns the default settings of one integrator (docs/scene-format.md, "Integrator"). */
bis_settings bis_settings_default(const bis_integrator *integrator);

/* bis_settings_leave_open changes sir with 0 candidates into auto that chooses only among the settings of sir. Other
 * settings stay as they are. For the parser and the command line. */
void bis_settings_leave_open(bis_settings *s);

/* bis_settings_check returns whether the values are allowed. `at` is the place that messages name. Errors: BIS_INPUT.
 * Example: mis with N = 1 is an error, and its message names em and brdf. */
bis_status bis_settings_check(const bis_settings *s, bis_loc at, bis_diag *diag);

/* bis_proposal_name returns "em", "brdf", "mix", "choose" or "product". */
const char *bis_proposal_name(bis_proposal p);

/* bis_scratch_init allocates what the integrator of s needs. Errors: BIS_NOMEM. */
bis_status bis_scratch_init(bis_scratch *scratch, const bis_settings *s, bis_diag *diag);

/* bis_scratch_clear frees the workspace. */
void bis_scratch_clear(bis_scratch *scratch);

/* bis_scratch_bytes returns the bytes that a thread's workspace takes with these settings. */
size_t bis_scratch_bytes(const bis_settings *s);

#endif
