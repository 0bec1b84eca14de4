/* SPDX-License-Identifier: BSD-2-Clause */
/* walk: one walk over the fields of a file, in its order, that writes or reads or hashes them. For the files of
 * src/render. Numbers are little-endian. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

enum { BIS_WALK_NAME = 16 }; /* bytes of a name in the file */

/* Exactly one of out and in is set, or none: then the fields are only hashed. */
typedef struct bis_walk {
    FILE *out;
    const unsigned char *in, *end;
    bool bad;      /* in: a field lies beyond the end, or cannot be right */
    uint64_t hash; /* of what has been flushed; BIS_FNV1A at first */
    size_t n;
    unsigned char buffer[1 << 15];
} bis_walk;

/* bis_walk_flush hashes what is in the buffer and, where there is a file, writes it. */
void bis_walk_flush(bis_walk *w);

/* bis_walk_take_hash returns the hash so far; the next one begins. */
uint64_t bis_walk_take_hash(bis_walk *w);

/* bis_walk_field walks over a number of n_bytes <= 8 bytes and returns it: v, or what the file has. */
static inline uint64_t bis_walk_field(bis_walk *w, uint64_t v, unsigned n_bytes)
{
    if (w->in) {
        v = 0;
        if ((size_t)(w->end - w->in) < n_bytes) w->bad = true;
        else
            for (unsigned i = 0; i < n_bytes; i++) v |= (uint64_t)*w->in++ << 8 * i;
        return v;
    }
    if (w->n + n_bytes > sizeof w->buffer) bis_walk_flush(w);
    for (unsigned i = 0; i < n_bytes; i++) w->buffer[w->n++] = (unsigned char)(v >> 8 * i);
    return v;
}

/* bis_walk_u64, bis_walk_u32, bis_walk_f64, and bis_walk_f64s and bis_walk_f32s walk over one number, or n of them. */
void bis_walk_u64(bis_walk *w, uint64_t *v);
void bis_walk_u32(bis_walk *w, uint32_t *v);
void bis_walk_f64(bis_walk *w, double *v);
void bis_walk_f64s(bis_walk *w, double *v, size_t n);
void bis_walk_f32s(bis_walk *w, float *v, size_t n);

/* bis_walk_name walks over a name of fewer than BIS_WALK_NAME bytes, with zeros behind it. */
void bis_walk_name(bis_walk *w, char text[BIS_WALK_NAME]);

/* bis_walk_text walks over a text of fewer than `size` bytes, its length before it. Read: one that is longer, or has
 * control characters, is bad. Written: a control character becomes '?'. */
void bis_walk_text(bis_walk *w, char *text, size_t size);
