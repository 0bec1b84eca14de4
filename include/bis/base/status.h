/* status: one type that carries every complaint from the byte where it arose to the line that the user reads.
 *
 * Library code never prints, exits or aborts. A function that can fail returns a bis_status, and appends a message to
 * the caller's bis_diag, which is a list because a parser goes on after the first mistake. Only the cli prints it. */
#ifndef BIS_STATUS_H
#define BIS_STATUS_H

#include <stdbool.h>
#include <stddef.h>

typedef enum bis_status {
    BIS_OK,
    BIS_IO,    /* the disk's fault: cannot open, read, write, rename; the cli exits with 1 */
    BIS_NOMEM, /* no memory; the cli exits with 1 */
    BIS_INPUT  /* the input's fault: syntax, range, damaged file; the cli exits with 2 for scenes, see SPEC 5 */
} bis_status;

/* A place in a file. line and column count from 1; line 0: the whole file; file NULL: no file at all. */
typedef struct bis_loc {
    const char *file;
    int line, column;
} bis_loc;

typedef struct bis_message {
    bool is_error; /* else a warning */
    char *text;    /* "FILE:LINE:COLUMN: error: ..." without a newline; owned by the list */
} bis_message;

/* Zero-initialise ({0}) before use, bis_diag_clear after. */
typedef struct bis_diag {
    bis_message *messages;
    size_t n, capacity;
    size_t n_errors;
    size_t n_lost; /* messages dropped for lack of memory */
} bis_diag;

#define BIS_PRINTF(fmt_index, first) __attribute__((format(printf, fmt_index, first)))

/* Add "FILE:LINE:COLUMN: error: MESSAGE" to diag (may be NULL) and return code: `return bis_error(...)`.
 * A good message names the thing, the value, the rule and the way out. */
bis_status bis_error(bis_diag *diag, bis_status code, bis_loc at, const char *fmt, ...) BIS_PRINTF(4, 5);

/* Add "FILE:LINE:COLUMN: warning: MESSAGE" to diag (may be NULL). */
void bis_warn(bis_diag *diag, bis_loc at, const char *fmt, ...) BIS_PRINTF(3, 4);

/* Free all messages; diag is empty and usable afterwards. NULL is fine. */
void bis_diag_clear(bis_diag *diag);

/* The name in names[0..n-1] nearest to word (edit distance at most a third of its length, at least 1), or NULL: for
 * `did you mean "X"?`. Case is ignored. */
const char *bis_nearest_name(const char *word, const char *const *names, size_t n);

#endif
