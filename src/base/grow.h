/* SPDX-License-Identifier: BSD-2-Clause */
/* grow: room for one more item at the end of an array, in amortised constant time. */
#pragma once

#include "bis/base/mem.h"

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

/* bis_grow returns a block of at least `needed` items of `size` bytes that starts with p's old content, or NULL without
 * memory (p then lives on). *capacity is what the block holds, in items. */
static inline void *bis_grow(void *p, size_t *capacity, size_t needed, size_t size)
{
    if (p && needed <= *capacity) return p;
    size_t n = *capacity > SIZE_MAX / 4 ? needed : 2 * *capacity;
    if (n < needed) n = needed;
    if (n < 8) n = 8;
    void *grown = bis_realloc(p, n, size);
    if (grown) *capacity = n;
    return grown;
}

/* bis_room does that to the pointer that `array` is the address of. False: no memory, and nothing changed. */
static inline bool bis_room(void *array, size_t *capacity, size_t needed, size_t size)
{
    void *p;
    memcpy(&p, array, sizeof p);
    p = bis_grow(p, capacity, needed, size);
    if (p) memcpy(array, &p, sizeof p);
    return p != NULL;
}

/* BIS_ROOM makes room for array[n]. */
#define BIS_ROOM(array, capacity, n) bis_room(&(array), &(capacity), (n) + 1, sizeof *(array))
