/* SPDX-License-Identifier: BSD-2-Clause */
/* further: integrators that somebody has added behind ours, as docs/extending.md says. Tables by hand leave them out,
 * so that the tests pass with them, too. */
#ifndef TESTS_FURTHER_H
#define TESTS_FURTHER_H

#include "bis/scene/parameters.h"

#include <stdbool.h>
#include <stddef.h>

enum { OUR_INTEGRATORS = 7 };

/* How many. */
static inline int n_further(void)
{
    int n = 0;
    while (bis_integrators[n]) n++;
    return n - OUR_INTEGRATORS;
}

static inline bool is_further(const bis_integrator *i)
{
    for (int k = 0; k < n_further(); k++)
        if (bis_integrators[OUR_INTEGRATORS + k] == i) return true;
    return false;
}

#endif
