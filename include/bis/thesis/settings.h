/* SPDX-License-Identifier: BSD-2-Clause */
/* settings: the list of integrators, and the values of their parameters. The names, defaults and ranges of the
 * parameters stand in bis/scene/parameters.h. */
#pragma once

#include <stdbool.h>
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

typedef struct bis_integrator bis_integrator; /* bis/thesis/integrator.h */

extern const bis_integrator bis_em, bis_brdf, bis_mis, bis_rejection, bis_sir, bis_exact, bis_unoccluded;

/* All integrators. NULL ends the list. */
extern const bis_integrator *const bis_integrators[];

/* bis_integrator_find returns the integrator with this name, or NULL if there is none. */
const bis_integrator *bis_integrator_find(const char *name);

/* The values of all parameters (docs/scene-format.md, "Integrator"). Each integrator reads its own. A field has the
 * name of its parameter. */
typedef struct bis_settings {
    const bis_integrator *integrator;
    uint32_t samples, candidates, shadowrays, perpatch;
    bis_proposal proposal;
    bis_heuristic heuristic;
    bis_resampling resampling;
    bis_estimator estimator;
    bis_fallback fallback;
    double split;
    bool compensate, stratify, learn;
    unsigned as_printed; /* all: BIS_E* of bis/thesis/errata.h, the equations to follow as printed; 0: none */
} bis_settings;
