/* SPDX-License-Identifier: BSD-2-Clause */
/* names: a hash table with open addressing and linear probing over an array of names that keeps the order of adding.
 *
 * At most half of the slots are taken, so a free one always ends the search. Nothing is ever removed. */
#include "names.h"

#include "grow.h"
#include "text.h"

#include <string.h>

#define NEAREST_LIMIT 1000 /* an edit distance costs about a microsecond */

/* The slot that holds the name, or the free one where it belongs. */
static size_t probe(const bis_names *t, const char *name)
{
    size_t i = (size_t)bis_fnv1a(BIS_FNV1A, name, strlen(name)) & (t->n_slots - 1);
    while (t->slots[i] && strcmp(t->names[t->slots[i] - 1], name) != 0) i = (i + 1) & (t->n_slots - 1);
    return i;
}

static bool rehash(bis_names *t, size_t n_slots)
{
    uint32_t *slots = bis_alloc(n_slots, sizeof *slots);
    if (!slots) return false;
    bis_free(t->slots);
    t->slots = slots;
    t->n_slots = n_slots;
    for (size_t i = 0; i < t->n; i++) t->slots[probe(t, t->names[i])] = (uint32_t)i + 1;
    return true;
}

static bool reserve(bis_names *t)
{
    if (!BIS_ROOM(t->names, t->capacity_names, t->n) || !BIS_ROOM(t->values, t->capacity_values, t->n)) return false;
    return 2 * (t->n + 1) <= t->n_slots || rehash(t, t->n_slots ? 2 * t->n_slots : 16);
}

void bis_names_clear(bis_names *t)
{
    for (size_t i = 0; i < t->n; i++) bis_free(t->names[i]);
    bis_free(t->names);
    bis_free(t->values);
    bis_free(t->slots);
    *t = (bis_names){0};
}

bool bis_names_find(const bis_names *t, const char *name, uint32_t *value)
{
    if (!t->n) return false;
    uint32_t slot = t->slots[probe(t, name)];
    if (slot && value) *value = t->values[slot - 1];
    return slot != 0;
}

bool bis_names_set(bis_names *t, const char *name, uint32_t value)
{
    if (t->n >= UINT32_MAX - 1 || !reserve(t)) return false;
    size_t i = probe(t, name);
    if (t->slots[i]) {
        t->values[t->slots[i] - 1] = value;
        return true;
    }
    char *copy = bis_strdup(name);
    if (!copy) return false;
    t->names[t->n] = copy;
    t->values[t->n] = value;
    t->slots[i] = (uint32_t)++t->n;
    return true;
}

const char *bis_names_nearest(const bis_names *t, const char *name)
{
    size_t n = t->n < NEAREST_LIMIT ? t->n : NEAREST_LIMIT;
    return n ? bis_nearest_name(name, (const char *const *)t->names, n) : NULL;
}
