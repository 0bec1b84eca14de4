/* SPDX-License-Identifier: BSD-2-Clause */
/* parameters: the table of the integrators' parameters. It says of each its name, type, default, range, help and the
 * integrators that read it (src/scene/parameters.c). The parser, the command line, --help, --plan, the headers of
 * pictures, `bis pixel`, `bis trade` and `bis verify` read this table and know no parameter themselves. */
#pragma once

#include "bis/base/status.h"
#include "bis/thesis/settings.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

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

/* bis_settings_replace puts `by` in the place of *s, but for as_printed, because an Option sets that, no integrator. */
void bis_settings_replace(bis_settings *s, bis_settings by);

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
