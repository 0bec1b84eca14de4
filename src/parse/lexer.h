/* SPDX-License-Identifier: BSD-2-Clause */
/* lexer: from the bytes of a scene file to words, quoted strings, numbers and brackets, each with its place. Included
 * by the parser alone. */
#pragma once

#include "bis/base/status.h"

#include <sys/types.h>

#define BIS_INCLUDE_DEPTH 64

typedef enum bis_token_kind {
    BIS_TOKEN_END,    /* of this file; bis_lexer_pop goes back to the file that included it */
    BIS_TOKEN_WORD,   /* a letter, then letters, digits and underscores */
    BIS_TOKEN_STRING, /* without its quotes; escapes still in it */
    BIS_TOKEN_NUMBER, /* finite */
    BIS_TOKEN_OPEN,   /* [ */
    BIS_TOKEN_CLOSE,  /* ] */
    BIS_TOKEN_BAD     /* has been complained about; the lexer stands behind it */
} bis_token_kind;

typedef struct bis_token {
    bis_token_kind kind;
    const char *text; /* text[length], in the file's content: valid until its source is popped */
    size_t length;
    double number;
    bis_loc at; /* columns count characters, not bytes */
    bool has_rest; /* NUMBER: something stands behind it in the same word, as in 60.0f (bis_lexer.takes_rest) */
} bis_token;

/* A file being read. */
typedef struct bis_source {
    const char *name; /* borrowed */
    unsigned char *data;
    const char *next, *end, *line_start;
    int line;
    size_t n_continuation; /* bytes of this line, up to next, that do not start a character */
    dev_t device;          /* what file it is, by whatever name: cycles are seen by this */
    ino_t inode;
} bis_source;

/* Zero-initialise with diag set, bis_lexer_clear after. */
typedef struct bis_lexer {
    bis_source sources[BIS_INCLUDE_DEPTH + 1];
    int n_sources;
    bis_diag *diag; /* may be NULL */
    bool takes_rest;  /* a number may be followed by what is none, as pbrt allows; without it that is BAD */
    bool said_latin1; /* the one warning of it */
} bis_lexer;

/* bis_lexer_push goes on with the file of this name, which must outlive all locs; at: the place that names it. A .gz is
 * expanded. Errors: those of bis_gzip_read; BIS_INPUT: a cycle, too deep. */
bis_status bis_lexer_push(bis_lexer *l, const char *name, bis_loc at);

/* bis_lexer_push_text does the same with text of the caller, which is copied, in the place of a file. Errors:
 * BIS_NOMEM. */
bis_status bis_lexer_push_text(bis_lexer *l, const char *name, const char *text);

/* bis_lexer_pop goes back to the including file. It returns false if there is none. bis_lexer_clear leaves all files.
 */
bool bis_lexer_pop(bis_lexer *l);
void bis_lexer_clear(bis_lexer *l);

/* bis_lexer_next returns the next token of the file on top. */
bis_token bis_lexer_next(bis_lexer *l);

/* bis_token_unescape copies a string token to s, which has room for length + 1 bytes, with escapes resolved. It returns
 * the length. */
size_t bis_token_unescape(char *s, const bis_token *t);

/* bis_token_name writes the token to buf as a person would name it: quoted, cut to 40 characters, unprintable bytes as
 * '?'. */
const char *bis_token_name(char buf[64], const bis_token *t);

/* bis_printable writes text for a message to buf, cut to 100 bytes, with unprintable bytes as '?'. */
const char *bis_printable(char buf[128], const char *text, size_t length);
