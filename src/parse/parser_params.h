/* SPDX-License-Identifier: BSD-2-Clause */
/* parser_params: the parameters of a directive: `"type name" value ...` becomes a list, from which directives ask for
 * what they know (parser_ask.h). */
#pragma once

#include "bis/base/status.h"
#include "lexer.h"

#define BIS_MAX_PARAMS 64
#define BIS_MAX_PARAM_NAME 64

typedef struct bis_parser bis_parser; /* parser.h */

/* pbrt's types. v2 and v3 spellings ("color", "point", "vector") are the same. */
enum {
    BIS_TYPE_INTEGER = 1 << 0,
    BIS_TYPE_FLOAT = 1 << 1,
    BIS_TYPE_BOOL = 1 << 2,
    BIS_TYPE_STRING = 1 << 3,
    BIS_TYPE_RGB = 1 << 4,
    BIS_TYPE_POINT3 = 1 << 5,
    BIS_TYPE_VECTOR3 = 1 << 6,
    BIS_TYPE_NORMAL = 1 << 7,
    BIS_TYPE_OTHER = 1 << 8, /* pbrt's types of which bis has no parameter: vector2, ... */
    BIS_TYPE_POINT2 = 1 << 9,
    BIS_TYPE_TEXTURE = 1 << 10,
    BIS_TYPE_SPECTRUM = 1 << 11,
    BIS_TYPE_XYZ = 1 << 12,
    BIS_TYPE_BLACKBODY = 1 << 13,
    BIS_TYPES_OF_COLOUR = BIS_TYPE_SPECTRUM | BIS_TYPE_XYZ | BIS_TYPE_BLACKBODY
};

typedef struct bis_param {
    bis_loc at;            /* of its declaration */
    unsigned type;         /* BIS_TYPE_* */
    const char *type_name; /* as we spell it */
    size_t name;           /* in the parser's text */
    size_t first, n;       /* in the parser's numbers (bools: 0 or 1) or strings */
    bool is_strings, used;
} bis_param;

/* The parameters of one directive. Values of all of them lie in three arrays that the next directive uses again: ten
 * million vertices cost a few reallocations, and nothing has to be freed one by one. */
typedef struct bis_params {
    bis_param list[BIS_MAX_PARAMS];
    size_t n;
    double *numbers;
    size_t n_numbers, capacity_numbers;
    size_t *strings; /* offsets in text */
    size_t n_strings, capacity_strings;
    char *text;
    size_t n_text, capacity_text;
    const char *asked[BIS_MAX_PARAMS]; /* the names that the directive knows, for "did you mean" */
    size_t n_asked;
} bis_params;

/* bis_params_start forgets the last directive's text and numbers. */
void bis_params_start(bis_parser *p);

/* bis_params_clear frees what the parameters of all directives used. */
void bis_params_clear(bis_params *ps);

/* bis_parser_name takes the string that names what a directive is about, after bis_params_start. It stores its place in
 * p->name and p->name_at. Returns false after a complaint, with p->lost. */
bool bis_parser_name(bis_parser *p, const char *directive);

/* bis_parser_peek_name does the same, but the string stays the next token. */
bool bis_parser_peek_name(bis_parser *p, const char *directive);

/* bis_parser_next_name takes a further string and stores its offset in the parser's text and its place. Returns false
 * after a complaint. */
bool bis_parser_next_name(bis_parser *p, const char *directive, size_t *text, bis_loc *at);

/* bis_parser_text returns the string at an offset of the parser's text. It moves when the next string is taken. */
const char *bis_parser_text(const bis_parser *p, size_t offset);

/* bis_params_read reads all "type name" value ... up to the next directive. Returns false after a complaint, with
 * p->lost. */
bool bis_params_read(bis_parser *p);

/* bis_token_is_nonfinite tells whether a word is a number that is not finite, as others write it. The lexer's numbers
 * are finite: it is a word for it, and known here, so that a message can say what it is. */
bool bis_token_is_nonfinite(const bis_token *t);

/* bis_params_find returns the parameter with this name, or NULL if it is not given. */
bis_param *bis_params_find(bis_parser *p, const char *name);

/* bis_param_type_names writes the types of a mask to buf: "rgb or float". */
const char *bis_param_type_names(char buf[64], unsigned mask);
