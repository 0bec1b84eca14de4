/* SPDX-License-Identifier: BSD-2-Clause */
/* walk: fields of a file. */
#include "walk.h"

#include "base/text.h"

#include <string.h>

void bis_walk_flush(bis_walk *w)
{
    w->hash = bis_fnv1a(w->hash, w->buffer, w->n);
    if (w->out) fwrite(w->buffer, 1, w->n, w->out); /* bis_outfile_commit looks for errors */
    w->n = 0;
}

uint64_t bis_walk_take_hash(bis_walk *w)
{
    bis_walk_flush(w);
    const uint64_t hash = w->hash;
    w->hash = BIS_FNV1A;
    return hash;
}

void bis_walk_u64(bis_walk *w, uint64_t *v) { *v = bis_walk_field(w, *v, 8); }
void bis_walk_u32(bis_walk *w, uint32_t *v) { *v = (uint32_t)bis_walk_field(w, *v, 4); }

void bis_walk_f64(bis_walk *w, double *v)
{
    uint64_t bits;
    memcpy(&bits, v, sizeof bits);
    bits = bis_walk_field(w, bits, 8);
    memcpy(v, &bits, sizeof bits);
}

void bis_walk_f64s(bis_walk *w, double *v, size_t n)
{
    for (size_t i = 0; i < n; i++) bis_walk_f64(w, &v[i]);
}

void bis_walk_f32s(bis_walk *w, float *v, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        uint32_t bits;
        memcpy(&bits, &v[i], sizeof bits);
        bis_walk_u32(w, &bits);
        memcpy(&v[i], &bits, sizeof bits);
    }
}

void bis_walk_name(bis_walk *w, char text[BIS_WALK_NAME])
{
    for (int i = 0; i < BIS_WALK_NAME; i++) text[i] = (char)bis_walk_field(w, (unsigned char)text[i], 1);
    if (text[BIS_WALK_NAME - 1]) w->bad = true;
    text[BIS_WALK_NAME - 1] = '\0';
}

static bool is_control(unsigned char c) { return c < 32 || c == 127; }

/* Control characters would reach a terminal or a header of a picture: they are written as ?, and refused when read. */
void bis_walk_text(bis_walk *w, char *text, size_t size)
{
    uint32_t n = (uint32_t)strnlen(text, size - 1);

    bis_walk_u32(w, &n);
    if (n >= size) w->bad = true, n = 0;
    for (uint32_t i = 0; i < n; i++) {
        const unsigned char c = (unsigned char)text[i];
        text[i] = (char)bis_walk_field(w, is_control(c) ? '?' : c, 1);
        w->bad |= is_control((unsigned char)text[i]);
    }
    text[n] = '\0';
}
