/* SPDX-License-Identifier: BSD-2-Clause */
/* errata: switches for the thesis's equations as they are printed. `bis` departs from the thesis in the items of
 * docs/errata.md. Ten of these departures can be undone one by one (`--as-printed E6`). The picture then shows the
 * effect of the printed equation.
 *
 * A set of switches is an unsigned; 0 gives the right picture. The code reads a switch where it meets the equation:
 * search for BIS_E6. */
#pragma once

#include <stdbool.h>

enum {
    BIS_E3 = 1 << 0,  /* src/thesis/importance_parts.h */
    BIS_E6 = 1 << 1,  /* src/thesis/as_printed.c */
    BIS_E13 = 1 << 2, /* src/thesis/importance_table.c, src/thesis/alias.c */
    BIS_E20 = 1 << 3, /* src/thesis/importance.c */
    BIS_E21 = 1 << 4, /* src/thesis/as_printed.c */
    BIS_E22 = 1 << 5, /* src/thesis/as_printed.c */
    BIS_E23 = 1 << 6, /* src/thesis/as_printed.c */
    BIS_E27 = 1 << 7, /* src/thesis/as_printed.c */
    BIS_E29 = 1 << 8, /* src/thesis/rejection.c */
    BIS_E34 = 1 << 9  /* src/thesis/as_printed.c */
};

typedef struct bis_erratum {
    const char *name; /* "E6", as in docs/errata.md */
    unsigned flag;
    const char *section;     /* of the thesis */
    const char *integrators; /* the integrators that use the equation, separated by blanks */
    const char *effect;      /* the effect on the picture, a phrase */
} bis_erratum;

/* All switches in the order of their numbers. The name NULL ends the list. */
extern const bis_erratum bis_errata[];

/* bis_erratum_find returns the switch with this name ("E6"), or NULL if there is none. */
const bis_erratum *bis_erratum_find(const char *name);

/* bis_erratum_nearest returns the name that is most like the misspelt `name`, or NULL. */
const char *bis_erratum_nearest(const char *name);

/* bis_erratum_reaches returns whether the switch can change anything that this integrator computes. */
bool bis_erratum_reaches(const bis_erratum *e, const char *integrator);

/* The size of a buffer that holds every text of bis_errata_text. */
enum { BIS_ERRATA_TEXT = 64 };

/* bis_errata_text writes the names of a set into buf, separated by blanks: "E6 E20". Returns buf. */
const char *bis_errata_text(char buf[BIS_ERRATA_TEXT], unsigned set);
