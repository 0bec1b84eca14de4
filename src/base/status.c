/* SPDX-License-Identifier: BSD-2-Clause */
/* status: a growing list of finished lines.
 *
 * A message is formatted when it is made, because the words it is made of (a token, a file's name) may be gone when it
 * is printed. Where memory is too short for a message the message is lost, but counted: n_errors stays true. */
#include "bis/base/status.h"
#include "grow.h"

#include <stdio.h>
#include <string.h>

/* "FILE:LINE:COLUMN: error: " with what is known of the place. Returns the length, as snprintf does. */
static int format_head(char *text, size_t room, bis_loc at, const char *kind)
{
    if (!at.file) return snprintf(text, room, "%s: ", kind);
    if (at.line <= 0) return snprintf(text, room, "%s: %s: ", at.file, kind);
    if (at.column <= 0) return snprintf(text, room, "%s:%d: %s: ", at.file, at.line, kind);
    return snprintf(text, room, "%s:%d:%d: %s: ", at.file, at.line, at.column, kind);
}

static bis_message make_message(bis_loc at, bool is_error, const char *fmt, va_list args) BIS_PRINTF(3, 0);

/* Head and body in a block of their own; text is NULL without memory. */
static bis_message make_message(bis_loc at, bool is_error, const char *fmt, va_list args)
{
    const char *kind = is_error ? "error" : "warning";
    va_list again;
    va_copy(again, args);
    int head = format_head(NULL, 0, at, kind);
    int body = vsnprintf(NULL, 0, fmt, again);
    va_end(again);
    size_t room = (size_t)head + (size_t)body + 1;
    char *text = head < 0 || body < 0 ? NULL : bis_alloc(room, 1);
    if (!text) return (bis_message){0};
    format_head(text, room, at, kind);
    vsnprintf(text + head, room - (size_t)head, fmt, args);
    return (bis_message){is_error, text, text + head};
}

static void append(bis_diag *diag, bool is_error, bis_loc at, const char *fmt, va_list args) BIS_PRINTF(4, 0);

static void append(bis_diag *diag, bool is_error, bis_loc at, const char *fmt, va_list args)
{
    if (!diag) return;
    if (is_error) diag->n_errors++;
    const bool fits = BIS_ROOM(diag->messages, diag->capacity, diag->n);
    const bis_message made = fits ? make_message(at, is_error, fmt, args) : (bis_message){0};
    if (made.text) diag->messages[diag->n++] = made;
    else diag->n_lost++;
}

bis_status bis_verror(bis_diag *diag, bis_status code, bis_loc at, const char *fmt, va_list args)
{
    append(diag, true, at, fmt, args);
    return code;
}

bis_status bis_error(bis_diag *diag, bis_status code, bis_loc at, const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    bis_verror(diag, code, at, fmt, args);
    va_end(args);
    return code;
}

void bis_warn(bis_diag *diag, bis_loc at, const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    append(diag, false, at, fmt, args);
    va_end(args);
}

void bis_diag_clear(bis_diag *diag)
{
    if (!diag) return;
    for (size_t i = 0; i < diag->n; i++) bis_free(diag->messages[i].text);
    bis_free(diag->messages);
    *diag = (bis_diag){0};
}

/* The library's words are ASCII; tolower would ask the locale. */
static char lower(char c) { return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c; }

static size_t min3(size_t a, size_t b, size_t c)
{
    size_t ab = a < b ? a : b;
    return ab < c ? ab : c;
}

/* The longest word that is compared; longer ones are no typing mistakes. */
enum { WORD = 63 };

/* The least number of letters inserted, removed, replaced, or swapped with their neighbour (each piece at most once)
 * that makes b of a. Three rows of the table d[i][j] = distance of a's first i and b's first j letters are enough. */
static size_t edit_distance(const char *a, size_t na, const char *b, size_t nb)
{
    size_t rows[3][WORD + 1];
    size_t *before = rows[0], *above = rows[1], *row = rows[2];

    for (size_t j = 0; j <= nb; j++) row[j] = j;
    for (size_t i = 1; i <= na; i++) {
        size_t *free_row = before;
        before = above;
        above = row;
        row = free_row;
        row[0] = i;
        for (size_t j = 1; j <= nb; j++) {
            bool same = lower(a[i - 1]) == lower(b[j - 1]);
            row[j] = min3(above[j] + 1, row[j - 1] + 1, above[j - 1] + !same);
            bool swapped = i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]);
            if (swapped && before[j - 2] + 1 < row[j]) row[j] = before[j - 2] + 1;
        }
    }
    return row[nb];
}

const char *bis_nearest_name(const char *word, const char *const *names, size_t n)
{
    size_t length = strlen(word);
    if (length > WORD) return NULL;
    size_t limit = length / 3 > 1 ? length / 3 : 1;
    const char *best = NULL;

    for (size_t i = 0; i < n; i++) {
        size_t name_length = strlen(names[i]);
        if (name_length > WORD) continue;
        size_t distance = edit_distance(word, length, names[i], name_length);
        if (distance > limit || (best && distance == limit)) continue;
        best = names[i];
        limit = distance;
    }
    return best;
}
