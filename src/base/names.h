/* SPDX-License-Identifier: BSD-2-Clause */
/* names: from a name to a number, in constant time. For the parser's named materials, objects, coordinate systems and
 * files: a scene may instance ten thousand objects a million times. Included by the parser alone. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct bis_names {
    char **names;      /* names[n], in the order of adding */
    uint32_t *values;  /* values[n] */
    uint32_t *slots;   /* slots[n_slots]: 1 + index of a name, 0: free. n_slots is 0 or a power of two */
    size_t n, capacity_names, capacity_values, n_slots;
} bis_names;

/* bis_names_clear frees all names. */
void bis_names_clear(bis_names *t);

/* bis_names_find returns whether the name is there, and stores its value. If not, *value is untouched. value may be
 * NULL. */
bool bis_names_find(const bis_names *t, const char *name, uint32_t *value);

/* bis_names_set adds a name, which it copies, or replaces its value. Returns false without memory; nothing has changed
 * then. */
bool bis_names_set(bis_names *t, const char *name, uint32_t value);

/* bis_names_nearest returns the name most like a misspelt one, or NULL. It looks at the first thousand only. */
const char *bis_names_nearest(const bis_names *t, const char *name);
