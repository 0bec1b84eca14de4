/* SPDX-License-Identifier: BSD-2-Clause */
/* set_help: the candidates of a set (src/thesis/set.h) one after the other, for tests. */
#ifndef TESTS_SET_HELP_H
#define TESTS_SET_HELP_H

#include "thesis/candidates.h"
#include "thesis/set.h"

/* set_size returns how many directions a set has: M, and the unused ones of a shared set. */
static inline uint32_t set_size(const bis_set *x) { return x->map.n + x->brdf.n; }

/* set_number returns the number of the i-th of them: first those from the map, then those of the BRDF. */
static inline uint32_t set_number(const bis_set *x, uint32_t i)
{
    return i < x->map.n ? i : x->brdf.first + i - x->map.n;
}

/* set_direction returns wi of the candidate with this number. */
static inline vec3 set_direction(const bis_set *x, uint32_t number)
{
    uint32_t i;
    const bis_lanes *y = &bis_set_half(x, number, &i)->x;

    return (vec3){y->x[i], y->y[i], y->z[i]};
}

/* set_is_used returns whether a candidate is one of the M. */
static inline bool set_is_used(const bis_set *x, uint32_t number)
{
    for (uint32_t j = 0; j < x->n_unused; j++) {
        if (number == bis_one_of_set(j, x->n_unused, x->M, x->phase)) return false;
    }
    return true;
}

/* block_bytes returns the bytes of a block of bis_alloc, which stand in front of it (src/base/mem.c); of NULL 0. */
static inline size_t block_bytes(const void *p) { return p ? ((const size_t *)p)[-1] : 0; }

#endif
