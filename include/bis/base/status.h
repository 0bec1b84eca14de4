/* SPDX-License-Identifier: BSD-2-Clause */
/* status: the one type that carries an error from the byte where it arose to the line that the user reads.
 *
 * Library code never prints, exits or aborts. A function that can fail returns a bis_status and appends a message to
 * the caller's bis_diag. This is a list, because a parser continues after the first mistake. Only the command line
 * prints it. */
#pragma once

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>

typedef enum bis_status {
    BIS_OK,
    BIS_IO,    /* a failure of the disk: cannot open, read, write or rename; the program exits with 1 */
    BIS_NOMEM, /* no memory; the program exits with 1 */
    /* a mistake in the input: syntax, range, a damaged file; the program exits with 2 for scenes
     * (docs/command-line.md) */
    BIS_INPUT
} bis_status;

/* A place in a file. line and column count from 1. line 0 means the whole file, file NULL no file at all. */
typedef struct bis_loc {
    const char *file;
    int line, column;
} bis_loc;

typedef struct bis_message {
    bool is_error; /* false: a warning */
    char *text;    /* "FILE:LINE:COLUMN: error: ..." without a newline; owned by the list */
    const char *body; /* what of text follows "error: " or "warning: " */
} bis_message;

/* A list of messages. Initialise it with {0} and release it with bis_diag_clear. */
typedef struct bis_diag {
    bis_message *messages;
    size_t n, capacity;
    size_t n_errors;
    size_t n_lost; /* messages dropped for lack of memory */
} bis_diag;

#define BIS_PRINTF(fmt_index, first) __attribute__((format(printf, fmt_index, first)))

/* bis_error adds "FILE:LINE:COLUMN: error: MESSAGE" to diag (may be NULL) and returns code: `return bis_error(...)`.
 * A good message names the thing, the value, the rule and the way out. */
bis_status bis_error(bis_diag *diag, bis_status code, bis_loc at, const char *fmt, ...) BIS_PRINTF(4, 5);

/* bis_verror does the same with the arguments of a function that has its own `...`. */
bis_status bis_verror(bis_diag *diag, bis_status code, bis_loc at, const char *fmt, va_list args) BIS_PRINTF(4, 0);

/* bis_warn adds "FILE:LINE:COLUMN: warning: MESSAGE" to diag (may be NULL). */
void bis_warn(bis_diag *diag, bis_loc at, const char *fmt, ...) BIS_PRINTF(3, 4);

/* bis_diag_clear frees all messages; diag may be NULL. diag is empty and usable afterwards. */
void bis_diag_clear(bis_diag *diag);

/* bis_nearest_name returns the name in names[0..n-1] that is nearest to word, or NULL, for messages like `did you
 * mean "X"?`. The edit distance is at most a third of the length of word, but at least 1 is allowed. Case is
 * ignored. */
const char *bis_nearest_name(const char *word, const char *const *names, size_t n);
