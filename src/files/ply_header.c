/* SPDX-License-Identifier: BSD-2-Clause */
/* ply_header: lines of words. "ply", "format F 1.0", then elements ("element NAME COUNT"), each followed by its
 * properties ("property TYPE NAME" or "property list COUNT-TYPE TYPE NAME"), comments anywhere, "end_header".
 *
 * Line ends: \n, \r\n and \r are all met, and a file may mix them. After "end_header\r" a \n belongs to the line's end
 * unless all lines end with \r alone: then it is the first byte of the body. A \n after "end_header\n" always is.
 * Source: Greg Turk's description of the format (1994), and the files of the wild. */
#include "ply_header.h"

#include "base/grow.h"
#include "bis/base/file.h"

#include <string.h>

enum { MAX_WORDS = 5 };

/* A line as words; words beyond MAX_WORDS (of a comment) are dropped. */
typedef struct line {
    ply_word words[MAX_WORDS];
    int n, number;
} line;

bool ply_word_is(ply_word w, const char *text)
{
    return (size_t)w.length == strlen(text) && memcmp(w.text, text, (size_t)w.length) == 0;
}

static bool is_blank(char c) { return c == ' ' || c == '\t'; }

/* Read the line at *p and move to its end (on \n, \r or the file's end). */
static void split_line(line *l, const unsigned char **p, const unsigned char *end)
{
    const char *c = (const char *)*p, *stop = c;

    while (stop < (const char *)end && *stop != '\n' && *stop != '\r') stop++;
    *p = (const unsigned char *)stop;
    l->n = 0;
    for (;;) {
        while (c < stop && is_blank(*c)) c++;
        if (c == stop) return;
        const char *start = c;
        while (c < stop && !is_blank(*c)) c++;
        if (l->n < MAX_WORDS) l->words[l->n++] = (ply_word){start, c - start < 64 ? (int)(c - start) : 64};
    }
}

static ply_type parse_type(ply_word w)
{
    static const char *const names[][2] = {{"char", "int8"},     {"uchar", "uint8"},   {"short", "int16"},
                                           {"ushort", "uint16"}, {"int", "int32"},     {"uint", "uint32"},
                                           {"float", "float32"}, {"double", "float64"}};

    for (int i = 0; i < PLY_NO_TYPE; i++)
        if (ply_word_is(w, names[i][0]) || ply_word_is(w, names[i][1])) return (ply_type)i;
    return PLY_NO_TYPE;
}

static bool parse_count(ply_word w, size_t *count)
{
    *count = 0;
    for (int i = 0; i < w.length; i++) {
        if (w.text[i] < '0' || w.text[i] > '9' || *count > (SIZE_MAX - 9) / 10) return false;
        *count = 10 * *count + (size_t)(w.text[i] - '0');
    }
    return w.length > 0;
}

static bis_status read_format(ply_header *h, const line *l, const mesh_input *in)
{
    static const char *const names[] = {[PLY_ASCII] = "ascii", [PLY_LITTLE] = "binary_little_endian",
                                        [PLY_BIG] = "binary_big_endian"};

    for (int f = PLY_ASCII; l->n == 3 && f <= PLY_BIG; f++) {
        if (ply_word_is(l->words[1], names[f]) && ply_word_is(l->words[2], "1.0")) {
            h->format = (ply_format)f;
            return BIS_OK;
        }
    }
    return bis_mesh_refuse(in, l->number, BIS_INPUT,
                           "the format must be ascii, binary_little_endian or binary_big_endian, and the version 1.0");
}

static const char no_memory[] = "no memory for the header";

static bis_status read_element(ply_header *h, const line *l, const mesh_input *in)
{
    ply_element e = {.first_property = h->n_properties};

    if (l->n != 3 || !parse_count(l->words[2], &e.count))
        return bis_mesh_refuse(in, l->number, BIS_INPUT,
                               "an element is \"element NAME COUNT\", COUNT a whole number >= 0");
    e.name = l->words[1];
    if (!BIS_ROOM(h->elements, h->capacity_elements, h->n_elements))
        return bis_mesh_refuse(in, 0, BIS_NOMEM, "%s", no_memory);
    h->elements[h->n_elements++] = e;
    return BIS_OK;
}

static bis_status read_property(ply_header *h, const line *l, const mesh_input *in)
{
    const bool list = l->n > 1 && ply_word_is(l->words[1], "list");
    ply_property p = {.count_type = PLY_NO_TYPE};

    if (h->n_elements == 0) return bis_mesh_refuse(in, l->number, BIS_INPUT, "a property before the first element");
    if (l->n != (list ? 5 : 3))
        return bis_mesh_refuse(in, l->number, BIS_INPUT,
                               "a property is \"property TYPE NAME\" or \"property list COUNT-TYPE TYPE NAME\"");
    p.name = l->words[l->n - 1];
    p.type = parse_type(l->words[l->n - 2]);
    if (list) p.count_type = parse_type(l->words[2]);
    const bool bad_count = list && p.count_type >= PLY_F32;
    if (bad_count || p.type == PLY_NO_TYPE) {
        const ply_word w = l->words[bad_count ? 2 : l->n - 2];
        return bis_mesh_refuse(in, l->number, BIS_INPUT,
                               "\"%.*s\" is no type%s: char, uchar, short, ushort, int, uint%s", w.length, w.text,
                               bad_count ? " of a list's count" : "", bad_count ? "" : ", float, double");
    }
    if (!BIS_ROOM(h->properties, h->capacity_properties, h->n_properties))
        return bis_mesh_refuse(in, 0, BIS_NOMEM, "%s", no_memory);
    h->properties[h->n_properties++] = p;
    h->elements[h->n_elements - 1].n_properties++;
    return BIS_OK;
}

static bis_status read_line(ply_header *h, const line *l, const mesh_input *in)
{
    const ply_word word = l->words[0];

    if (ply_word_is(word, "comment") || ply_word_is(word, "obj_info")) return BIS_OK;
    if (ply_word_is(word, "format")) return read_format(h, l, in);
    if (ply_word_is(word, "element")) return read_element(h, l, in);
    if (ply_word_is(word, "property")) return read_property(h, l, in);
    return bis_mesh_refuse(in, l->number, BIS_INPUT, "unknown word \"%.*s\" in the header", word.length, word.text);
}

/* Behind the line's end at p. */
static const unsigned char *next_line(const unsigned char *p, const unsigned char *end, bool cr_alone)
{
    if (p < end && *p == '\r' && (p[1] != '\n' || cr_alone)) return p + 1;
    if (p < end && *p == '\r') p++;
    return p < end ? p + 1 : p;
}

bis_status bis_ply_header_read(ply_header *h, const mesh_input *in)
{
    const unsigned char *p = in->data + bis_byte_order_mark(in->data, in->size), *end = in->data + in->size;
    line l = {.number = 1};

    split_line(&l, &p, end);
    if (in->size == 0) return bis_mesh_refuse(in, 0, BIS_INPUT, "the file is empty");
    if (l.n != 1 || !ply_word_is(l.words[0], "ply"))
        return bis_mesh_refuse(in, 0, BIS_INPUT, "not a PLY file: its first line must be \"ply\"");
    const bool cr_alone = p < end && *p == '\r' && p[1] != '\n';
    while (p < end) {
        p = next_line(p, end, cr_alone);
        l.number++;
        split_line(&l, &p, end);
        if (l.n == 0) continue;
        if (ply_word_is(l.words[0], "end_header")) {
            h->body = next_line(p, end, cr_alone);
            if (h->format == PLY_NO_FORMAT)
                return bis_mesh_refuse(in, 0, BIS_INPUT, "the header has no line \"format\"");
            return BIS_OK;
        }
        bis_status status = read_line(h, &l, in);
        if (status) return status;
    }
    return bis_mesh_refuse(in, 0, BIS_INPUT, "the header has no line \"end_header\": is the file cut off?");
}

void bis_ply_header_clear(ply_header *h)
{
    bis_free(h->elements);
    bis_free(h->properties);
    *h = (ply_header){0};
}

size_t bis_ply_least_row(const ply_header *h, const ply_element *e)
{
    size_t bytes = 0;

    for (size_t i = 0; i < e->n_properties; i++) {
        const ply_property *p = &h->properties[e->first_property + i];
        bytes += h->format == PLY_ASCII ? 2 : ply_size(ply_is_list(p) ? p->count_type : p->type);
    }
    return bytes;
}
