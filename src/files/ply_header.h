/* SPDX-License-Identifier: BSD-2-Clause */
/* ply_header: the self-description at the head of a PLY file. For ply.c alone. */
#pragma once

#include "mesh_io.h"

typedef enum ply_format { PLY_NO_FORMAT, PLY_ASCII, PLY_LITTLE, PLY_BIG } ply_format;
typedef enum ply_type { PLY_I8, PLY_U8, PLY_I16, PLY_U16, PLY_I32, PLY_U32, PLY_F32, PLY_F64, PLY_NO_TYPE } ply_type;

/* ply_size returns the bytes of a number in a binary file. */
static inline size_t ply_size(ply_type type)
{
    static const unsigned char size[] = {1, 1, 2, 2, 4, 4, 4, 8};
    return size[type];
}

/* Words point into the file. */
typedef struct ply_word {
    const char *text;
    int length;
} ply_word;

typedef struct ply_property {
    ply_word name;
    ply_type type, count_type; /* count_type: lists only, else PLY_NO_TYPE */
} ply_property;

/* ply_is_list returns whether the property is a list. */
static inline bool ply_is_list(const ply_property *p) { return p->count_type != PLY_NO_TYPE; }

typedef struct ply_element {
    ply_word name;
    size_t count, first_property, n_properties;
} ply_element;

typedef struct ply_header {
    ply_format format;
    ply_element *elements;
    ply_property *properties;
    size_t n_elements, n_properties, capacity_elements, capacity_properties;
    const unsigned char *body;
} ply_header;

/* ply_word_is returns whether a word is this text. */
bool ply_word_is(ply_word w, const char *text);

/* bis_ply_header_read reads the header. Counts are held against the file's size by the body's reader, not here. Errors:
 * BIS_INPUT, BIS_NOMEM. */
bis_status bis_ply_header_read(ply_header *h, const mesh_input *in);

/* bis_ply_header_clear frees it. */
void bis_ply_header_clear(ply_header *h);

/* bis_ply_least_row returns the least number of bytes that a row of e takes in the file: in binary its numbers (an
 * empty list is its count), in ascii a digit and a white space for each. */
size_t bis_ply_least_row(const ply_header *h, const ply_element *e);
