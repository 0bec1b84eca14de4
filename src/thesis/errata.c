/* SPDX-License-Identifier: BSD-2-Clause */
/* errata: the table of equations that can be rendered as printed. docs/errata.md explains what is wrong and why. This
 * table says what one sees. */
#include "bis/thesis/errata.h"

#include "bis/base/status.h"

#include <assert.h>
#include <string.h>

#define FROM_THE_MAP "em mis rejection sir unoccluded"

const bis_erratum bis_errata[] = {
    {"E3", BIS_E3, "3.3", FROM_THE_MAP,
     "importance without solid angle: under a constant map what faces a pole gets 4/pi of its light, what faces the "
     "equator 8/pi^2"},
    {"E6", BIS_E6, "4.1, eq. 4.6", "rejection sir",
     "an RGB L_ns times one mean visibility: coloured shadows turn grey"},
    {"E13", BIS_E13, "appendix A", FROM_THE_MAP,
     "alias tables from raw weights draw nearly all pixels of the map alike: what is lit by small lights is lit from "
     "everywhere"},
    {"E20", BIS_E20, "3.4 with 4.1", FROM_THE_MAP,
     "area-weighted directions over the unweighted density: small lights grow dim, large ones bright"},
    {"E21", BIS_E21, "4.4", "sir",
     "L_ns from other candidates than those resampled: where M is small, shadows too bright and the rest too dark"},
    {"E22", BIS_E22, "4.3, eq. 4.7", "rejection",
     "drawing ends with the N-th acceptance: too bright, most where few are accepted"},
    {"E23", BIS_E23, "4.4", "sir",
     "weights f_r and L (proposal \"em\", \"brdf\") forget the cosine and what q_f really is: grazing surfaces are too "
     "bright"},
    {"E27", BIS_E27, "4.3", "rejection",
     "accepting against f_max or L_max, with \"probabilities\" above 1: rays spread evenly, low occluders darken too "
     "much"},
    {"E29", BIS_E29, "4.3", "rejection",
     "nothing accepted, nothing shadowed: the mirror images of what hides the light vanish"},
    {"E34", BIS_E34, "3.5, eq. 3.16", "brdf",
     "a lobe's directions below the horizon are drawn again: glossy surfaces are too bright at grazing angles"},
    {NULL, 0, NULL, NULL, NULL},
};

enum { N_ERRATA = sizeof bis_errata / sizeof *bis_errata - 1 };

const bis_erratum *bis_erratum_find(const char *name)
{
    for (const bis_erratum *e = bis_errata; e->name; e++) {
        if (strcmp(e->name, name) == 0) return e;
    }
    return NULL;
}

const char *bis_erratum_nearest(const char *name)
{
    const char *names[N_ERRATA];

    for (int i = 0; i < N_ERRATA; i++) names[i] = bis_errata[i].name;
    return bis_nearest_name(name, names, N_ERRATA);
}

/* Searches for the name as a whole word: no integrator's name is part of another's. */
bool bis_erratum_reaches(const bis_erratum *e, const char *integrator)
{
    return strstr(e->integrators, integrator) != NULL;
}

const char *bis_errata_text(char buf[BIS_ERRATA_TEXT], unsigned set)
{
    size_t used = 0;

    buf[0] = '\0';
    for (const bis_erratum *e = bis_errata; e->name; e++) {
        if (!(set & e->flag)) continue;
        size_t length = strlen(e->name);
        assert(used + length + 2 <= BIS_ERRATA_TEXT);
        if (used) buf[used++] = ' ';
        memcpy(buf + used, e->name, length + 1);
        used += length;
    }
    return buf;
}
