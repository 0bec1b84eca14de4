/* errata: the thesis's equations as they are printed, one switch each. `bis` departs from the thesis where
 * docs/errata.md says so; these departures can be undone one by one (`--as-printed E6`), to see what the printed
 * equation does to a picture.
 *
 * A set of switches is an unsigned, 0 for the right picture. It is read where the code meets the equation: grep for
 * BIS_E6. */
#ifndef BIS_ERRATA_H
#define BIS_ERRATA_H

#include <stdbool.h>

enum {
    BIS_E3 = 1 << 0,  /* src/thesis/importance_parts.h */
    BIS_E6 = 1 << 1,  /* src/thesis/as_printed.c */
    BIS_E13 = 1 << 2, /* src/thesis/importance_table.c, src/thesis/alias.c */
    BIS_E20 = 1 << 3, /* src/thesis/importance.c */
    BIS_E21 = 1 << 4, /* src/thesis/as_printed.c */
    BIS_E22 = 1 << 5, /* src/thesis/rejection.c */
    BIS_E23 = 1 << 6, /* src/thesis/as_printed.c */
    BIS_E27 = 1 << 7, /* src/thesis/as_printed.c */
    BIS_E29 = 1 << 8, /* src/thesis/rejection.c */
    BIS_E34 = 1 << 9  /* src/thesis/as_printed.c */
};

typedef struct bis_erratum {
    const char *name; /* "E6", as in docs/errata.md */
    unsigned flag;
    const char *section;     /* of the thesis */
    const char *integrators; /* that meet the equation, separated by blanks */
    const char *effect;      /* on the picture, a phrase */
} bis_erratum;

/* All that can be switched, in the order of their numbers, ended by a name of NULL. */
extern const bis_erratum bis_errata[];

/* NULL: no switch of that name. */
const bis_erratum *bis_erratum_find(const char *name);

/* The name most like a misspelt one, or NULL. */
const char *bis_erratum_nearest(const char *name);

/* Can the switch change anything that this integrator computes? */
bool bis_erratum_reaches(const bis_erratum *e, const char *integrator);

/* The names of a set, separated by blanks: "E6 E20". Returns buf. */
enum { BIS_ERRATA_TEXT = 64 };
const char *bis_errata_text(char buf[BIS_ERRATA_TEXT], unsigned set);

#endif
