/* SPDX-License-Identifier: BSD-2-Clause */
/* tokens: a hand-in as C tokens: what in it is not ours, whether that may be run, and how alike two hand-ins are.
 *
 * Our file, with the fragments under study blank (the template), is cut into items: functions, declarations and
 * directives of the top level. Each must be in the hand-in, in this order, token by token; inside an item a fragment
 * may hold anything. All else in the hand-in is theirs. */
#ifndef SCRIPTS_TOKENS_H
#define SCRIPTS_TOKENS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum token_kind {
    TOKEN_NONE,
    TOKEN_NAME,
    TOKEN_NUMBER,
    TOKEN_STRING,
    TOKEN_MARK,
    TOKEN_DIRECTIVE,
    TOKEN_LINE_END,
    TOKEN_HOLE
} token_kind;

typedef struct token {
    token_kind kind;
    const char *text; /* in the file's own memory */
    size_t n;
    unsigned line;
    bool theirs;
} token;

typedef struct token_item {
    size_t begin, end;
} token_item;

typedef struct token_file {
    char *text;      /* comments are blanks; continued lines are one */
    unsigned *lines; /* of each byte */
    token *tokens;
    token_item *items;
    size_t n, n_items;
    char fault[200]; /* why it cannot be read as tokens, with the line; "" */
} token_file;

enum { TOKEN_BYTES = 1 << 20 }; /* the longest file that is looked at */

/* is_template: what stands between the comments [name] and [end] is one TOKEN_HOLE. Returns false where the file cannot
 * be read; see f->fault. */
bool tokens_read(token_file *f, const char *path, bool is_template);
void tokens_clear(token_file *f);

/* Write the file as it was read, so that a compiler reads nothing else. Lines keep their numbers. */
bool tokens_write(const token_file *f, const char *path);

/* Mark as `theirs` what f has beyond the template. Returns false where something of ours is missing or changed; line:
 * where ours has it. */
bool tokens_compare(token_file *f, const token_file *template, unsigned *line);

/* The first of theirs that no assignment needs and that could reach beyond the functions under study: assembler,
 * attributes, pragmas, conditions about what is ours, reserved names, macros that change our names, headers other than
 * the C library's (but for those that touch the process) and ours, which lie in one of the folders, up to a NULL (no
 * folders: not looked at). NULL: none. */
const char *tokens_refuse(const token_file *f, const token_file *template, char *const *folders, char *text,
                          size_t room);

/* Hashes of all runs of TOKEN_RUN of their tokens within an item; names that a copyist can change are all
 * one. Returns how many, with the array in *prints, to be freed. */
enum { TOKEN_RUN = 8 };
size_t tokens_prints(const token_file *f, const token_file *template, uint64_t **prints);

#endif
