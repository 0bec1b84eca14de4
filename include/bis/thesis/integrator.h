/* integrator: estimators of reflected radiance at a point, thesis chapters 3 and 4: one file each, src/thesis/em.c, brdf.c,
 * mis.c, rejection.c, sir.c, exact.c, unoccluded.c. All see the scene through bis_point and their numbers through
 * bis_stream. */
#ifndef BIS_INTEGRATOR_H
#define BIS_INTEGRATOR_H

#include "bis/thesis/point.h"
#include "bis/thesis/sampler.h"

#include <stdint.h>

typedef enum bis_proposal { BIS_PROPOSAL_EM, BIS_PROPOSAL_BRDF, BIS_PROPOSAL_MIX, BIS_PROPOSAL_CHOOSE, BIS_PROPOSAL_PRODUCT } bis_proposal;
typedef enum bis_heuristic { BIS_HEURISTIC_BALANCE, BIS_HEURISTIC_POWER } bis_heuristic;
typedef enum bis_resampling { BIS_RESAMPLING_SYSTEMATIC, BIS_RESAMPLING_MULTINOMIAL } bis_resampling;
typedef enum bis_estimator { BIS_ESTIMATOR_RATIO, BIS_ESTIMATOR_PLAIN } bis_estimator;
typedef enum bis_fallback { BIS_FALLBACK_RESAMPLE, BIS_FALLBACK_SUBSET, BIS_FALLBACK_UNOCCLUDED } bis_fallback;

typedef struct bis_integrator bis_integrator;

/* The parameters of all integrators (SPEC 3); each reads its own. */
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
    double split;    /* mis: the EM's share */
    bool compensate; /* mis */
    bool stratify;   /* em, mis, sir: samples of the map along its curve */
    bool learn;      /* sir, proposal "product": from the visibility that earlier passes have found */
    bool vectorize;  /* sir: many candidates at once where that is possible (src/beyond/batch.c) */
    bool only_sir;   /* auto: choose among sir's settings alone */
    unsigned as_printed; /* all: BIS_E* of bis/thesis/errata.h, equations to follow to the letter; 0: none */
} bis_settings;

/* A candidate direction of chapter 4: drawn, weighed, perhaps traced. C is what it would be worth by plain importance
 * sampling (eq. 4.8), its sum w = phat/q is the weight of eq. 4.9, and C/w = F/phat carries the colour. w = 0 below the
 * horizon; C is then 0, too. */
typedef struct bis_candidate {
    vec3 wi;
    rgbd C;   /* F/q, F = f cos Le in RGB: double, because f Le alone may exceed a float */
    double w; /* C.r + C.g + C.b */
} bis_candidate;

/* What an integrator needs of a thread's workspace: numbers of candidates, sample points and chosen candidates. n_set:
 * how many stratified directions from the map one estimate takes; a renderer may give it sets of so many. */
typedef struct bis_needs {
    uint32_t n_candidates, n_points, n_chosen, n_set;
} bis_needs;

/* Sets of n_set stratified directions from the map, which many points share. choose returns one of them. */
typedef struct bis_sets bis_sets;
struct bis_sets {
    const bis_light_point *(*choose)(const bis_sets *sets, bis_stream *stream);
};

/* A thread's workspace, allocated once before rendering. */
typedef struct bis_scratch {
    bis_candidate *candidates; /* [n_candidates] */
    double (*u)[2];            /* [n_points] */
    uint32_t *chosen;          /* [n_chosen] */
    const bis_sets *sets;      /* borrowed; NULL: each point draws its own directions */
    struct bis_fast *fast;     /* borrowed; src/beyond/batch.h alone looks into it; NULL: none */
} bis_scratch;

struct bis_integrator {
    const char *name;
    const char *claim; /* "unbiased", or how and when biased: shown by --plan and in the docs */

    /* BIS_NEED_* of the light, and the workspace. *need begins with zeros. */
    unsigned (*light_needs)(const bis_settings *s);
    void (*scratch_needs)(const bis_settings *s, bis_needs *need);

    /* One estimate of reflected radiance at pt. */
    rgb (*Lo)(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch);
};

extern const bis_integrator bis_em, bis_brdf, bis_mis, bis_rejection, bis_sir, bis_exact, bis_unoccluded;

/* Not an estimator but the wish that one be chosen: where nobody chooses (src/tools/auto/auto.c), it is sir with its defaults. Not
 * in the list below. */
extern const bis_integrator bis_auto;

/* All of them, ended by NULL, and by name (NULL: no such; "auto" is found, too). */
extern const bis_integrator *const bis_integrators[];
const bis_integrator *bis_integrator_find(const char *name);

/* The defaults of SPEC 3 for one integrator. */
bis_settings bis_settings_default(const bis_integrator *integrator);

/* sir with 0 candidates is auto, among sir's settings alone. For the parser and the command line. */
void bis_settings_leave_open(bis_settings *s);

/* Are the values allowed? at: where to complain. E.g. mis with N = 1 is an error that names em and brdf. */
bis_status bis_settings_check(const bis_settings *s, bis_loc at, bis_diag *diag);

/* "em", "brdf", "mix", "choose" and the like. */
const char *bis_proposal_name(bis_proposal p);

/* bis_scratch_init allocates what the integrator of s needs. Errors: BIS_NOMEM. bis_scratch_clear frees it. */
bis_status bis_scratch_init(bis_scratch *scratch, const bis_settings *s, bis_diag *diag);
void bis_scratch_clear(bis_scratch *scratch);

/* bis_scratch_bytes returns the bytes that a thread's workspace takes with these settings. */
size_t bis_scratch_bytes(const bis_settings *s);

#endif
