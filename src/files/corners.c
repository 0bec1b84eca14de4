/* SPDX-License-Identifier: BSD-2-Clause */
/* corners: a hash table with linear probing. */
#include "corners.h"

#include "bis/base/mem.h"

static size_t hash(uint32_t v, uint32_t a, uint32_t b)
{
    /* Knuth's multiplicative hashing, 2^64 / golden ratio */
    uint64_t h = (((uint64_t)v << 32 | b) ^ (uint64_t)a << 16) * 0x9e3779b97f4a7c15;
    return (size_t)(h ^ h >> 29);
}

static split_corner *find(split_corner *table, size_t size, uint32_t v, uint32_t a, uint32_t b)
{
    size_t i = hash(v, a, b) & (size - 1);

    while (table[i].vertex != CORNER_FREE && (table[i].v != v || table[i].a != a || table[i].b != b))
        i = (i + 1) & (size - 1);
    return &table[i];
}

static bool grow(split_corners *s)
{
    const size_t size = s->size ? 2 * s->size : 1024;
    split_corner *table = bis_alloc(size, sizeof *table);

    if (!table) return false;
    for (size_t i = 0; i < size; i++) table[i].vertex = CORNER_FREE;
    for (size_t i = 0; i < s->size; i++) {
        const split_corner *old = &s->table[i];
        if (old->vertex != CORNER_FREE) *find(table, size, old->v, old->a, old->b) = *old;
    }
    bis_free(s->table);
    s->table = table;
    s->size = size;
    return true;
}

split_corner *bis_corners_find(split_corners *s, uint32_t v, uint32_t a, uint32_t b)
{
    if (2 * s->n >= s->size && !grow(s)) return NULL;
    split_corner *c = find(s->table, s->size, v, a, b);
    if (c->vertex == CORNER_FREE) {
        *c = (split_corner){v, a, b, CORNER_FREE};
        s->n++;
    }
    return c;
}
