/* SPDX-License-Identifier: BSD-2-Clause */
/* settings: the integrators and their parameters. One table (src/thesis/settings.c) says of each parameter its name,
 * type, default, range, help and the integrators that read it. The parser, the command line, --help, --plan, the
 * headers of pictures, `bis pixel`, `bis trade` and `bis verify` read this table and know no parameter themselves. */
#pragma once

#include "bis/base/status.h"

#include <stdbool.h>
#include <stddef.h>
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

typedef enum bis_parameter_type {
    BIS_PARAMETER_COUNT,    /* uint32_t */
    BIS_PARAMETER_FRACTION, /* double */
    BIS_PARAMETER_BOOL,
    BIS_PARAMETER_CHOICE    /* an enum, whose values have names */
} bis_parameter_type;

/* A parameter of those integrators that read it in the same way. Where the default or the range depends on the
 * integrator, several rows of the table have one name. */
typedef struct bis_parameter {
    const char *name;
    bis_parameter_type type;
    size_t offset;            /* of the field in bis_settings */
    double usual, lo, hi;     /* the default; the range, ends included. Not for CHOICE: lo, hi */
    const char *const *names; /* CHOICE: the names of all values of the enum, by value */
    unsigned choices;         /* CHOICE: bit v is set if these integrators take value v */
    bool is_option;           /* `bis render` has the option --NAME */
    const char *demand;       /* COUNT below lo: what the integrator needs, for the message; NULL: lo says it */
    const char *note;         /* what `bis help` says behind the default; may be NULL */
    const char *words;        /* what the parameter is, for --help; in the first row of a name */
    const bis_integrator *readers[4]; /* NULL ends the list, unless it is full */
} bis_parameter;

enum { BIS_MAX_CHOICES = 5 }; /* values of an enum */

/* All rows, in the order of docs/scene-format.md. A row without a name ends the table. */
extern const bis_parameter bis_parameters[];

/* bis_parameter_reads returns whether the integrator reads this row. */
bool bis_parameter_reads(const bis_parameter *p, const bis_integrator *integrator);

/* bis_parameter_next returns the row after p that the integrator reads, the first one if p is NULL, or NULL if there
 * is none. An integrator reads at most one row of a name. */
const bis_parameter *bis_parameter_next(const bis_integrator *integrator, const bis_parameter *p);

/* bis_parameter_of returns the row with this name that the integrator reads, or NULL if it reads none. */
const bis_parameter *bis_parameter_of(const bis_integrator *integrator, const char *name);

/* bis_parameter_get returns the value of a parameter: a count, a fraction, 0 or 1, or the value of an enum. */
double bis_parameter_get(const bis_parameter *p, const bis_settings *s);

/* bis_parameter_set sets the value of a parameter. v has the type's range; the row's range is not tested. */
void bis_parameter_set(const bis_parameter *p, bis_settings *s, double v);

/* bis_parameter_text returns the value v as text, as a scene holds it: "800", "0.5", "true", "mix". The text is in
 * buf or static. */
const char *bis_parameter_text(char buf[32], const bis_parameter *p, double v);

/* bis_parameter_list writes the names that a CHOICE takes to buf: em, brdf or choose. Each stands between two
 * `quote`s. */
const char *bis_parameter_list(char buf[128], const bis_parameter *p, const char *quote);

/* bis_settings_default returns the default settings of one integrator (docs/scene-format.md, "Integrator"). Those of
 * sir, rejection and mis are the thesis's. */
bis_settings bis_settings_default(const bis_integrator *integrator);

/* bis_settings_unnamed returns the settings of a scene that names no integrator: sir with proposal product, 64
 * candidates, 24 shadow rays, learn true (docs/integrators.md, "A scene without an Integrator"). */
bis_settings bis_settings_unnamed(void);

/* bis_settings_thin returns the settings of a camera sample that has only a share of the light samples, share in (0,1]:
 * so much of samples and shadowrays, and of the candidates that proposal product draws for each point alone, rounded
 * up. As many candidates as fill a vector stay, because fewer take as long. Stratified samples, and the candidates of
 * other proposals, stay as many as they are: many points share a set of them, and a part of a set sees only a part of
 * the map. */
bis_settings bis_settings_thin(const bis_settings *s, double share);

/* bis_settings_equal returns whether a and b have the same integrator and the same values of what it reads. */
bool bis_settings_equal(const bis_settings *a, const bis_settings *b);

/* bis_settings_check returns whether the values are allowed. `at` is the place that messages name. Errors: BIS_INPUT.
 * Example: mis with N = 1 is an error, and its message names em and brdf. */
bis_status bis_settings_check(const bis_settings *s, bis_loc at, bis_diag *diag);

/* bis_proposal_name returns "em", "brdf", "mix", "choose" or "product". */
const char *bis_proposal_name(bis_proposal p);
