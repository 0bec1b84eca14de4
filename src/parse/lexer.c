/* SPDX-License-Identifier: BSD-2-Clause */
/* lexer: pbrt's tokens. White space separates and means nothing else, '#' at the start of a word begins a comment that
 * ends with the line. A line ends with LF, CR LF or CR, each file as it likes, also by turns.
 *
 * Included files form a stack of at most 64, so that no recursion follows the user's input. A token is a view into the
 * file's content: nothing is copied. The column of a token costs O(1): bytes since the line's start less those that
 * continue a UTF-8 character, which can only stand in strings and comments and are counted there. A scene of ten
 * million numbers is as fast as bis_parse_double. */
#include "base/text.h"
#include "lexer.h"

#include "bis/base/file.h"
#include "bis/base/mem.h"
#include "files/gzip.h"

#include <math.h>
#include <string.h>
#include <sys/stat.h>

static bool is_digit(char c) { return c >= '0' && c <= '9'; }
static bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
static bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f' || c == '\v'; }

static bis_loc place(const bis_source *s, const char *at)
{
    size_t column = (size_t)(at - s->line_start) - s->n_continuation + 1;
    return (bis_loc){s->name, s->line, column < INT_MAX ? (int)column : INT_MAX};
}

static void new_line(bis_source *s)
{
    s->line_start = s->next;
    s->n_continuation = 0;
    if (s->line < INT_MAX) s->line++;
}

static bool is_line_end(char c) { return c == '\n' || c == '\r'; }

static void skip_space(bis_source *s)
{
    while (s->next < s->end) {
        char c = *s->next;
        if (c == '#') {
            while (s->next < s->end && !is_line_end(*s->next)) s->n_continuation += bis_utf8_continues(*s->next++);
        } else if (is_space(c)) {
            s->next++;
            if (c == '\n' || (c == '\r' && (s->next == s->end || *s->next != '\n'))) new_line(s);
        } else {
            return;
        }
    }
}

/* Where a bare token ends. */
static const char *bare_end(const bis_source *s)
{
    const char *p = s->next;
    while (p < s->end && !is_space(*p) && *p && *p != '"' && *p != '[' && *p != ']') p++;
    return p;
}

/* way_out: the end of the message. */
static bis_token_kind bad_bare(bis_lexer *l, bis_source *s, bis_token *t, const char *what, const char *way_out)
{
    char buf[128];
    t->has_rest = false;
    t->length = (size_t)(bare_end(s) - t->text);
    s->next = t->text + t->length;
    for (size_t i = 0; i < t->length; i++) s->n_continuation += bis_utf8_continues(t->text[i]);
    bis_error(l->diag, BIS_INPUT, t->at, "%s \"%s\"%s", what, bis_printable(buf, t->text, t->length), way_out);
    return BIS_TOKEN_BAD;
}

/* -1.#IND, 1.#QNAN, 1.#INF, and 1.$ of one digit: what Microsoft's printf made of numbers that are none. */
static bool is_nonfinite(const char *end) { return end[-1] == '.' && (*end == '#' || *end == '$'); }

/* Digits with at most a sign, a point and an exponent. What strtod would also take (0x10, inf, nan) is refused. */
static bis_token_kind number(bis_lexer *l, bis_source *s, bis_token *t)
{
    const char *digits = t->text + (t->text[0] == '-' || t->text[0] == '+');
    const char *end = t->text;

    const bool is_hexadecimal = digits[0] == '0' && (digits[1] | 32) == 'x';
    if ((is_digit(digits[0]) && !is_hexadecimal) || (digits[0] == '.' && is_digit(digits[1])))
        t->number = bis_parse_double(t->text, &end);
    t->has_rest = end != s->end && !is_space(*end) && *end != '"' && *end != '[' && *end != ']';
    if (t->has_rest && end > t->text && is_nonfinite(end)) return bad_bare(l, s, t, "non-finite number", "");
    if (end == t->text) return bad_bare(l, s, t, "malformed number", "");
    if (t->has_rest && !l->takes_rest)
        return bad_bare(l, s, t, "malformed number", "; with --approximate: the number at its beginning, as in pbrt");
    if (!isfinite(t->number)) return bad_bare(l, s, t, "non-finite number", "");
    if (t->has_rest) end = bare_end(s);
    for (const char *c = t->text; t->has_rest && c < end; c++) s->n_continuation += bis_utf8_continues(*c);
    t->length = (size_t)(end - t->text);
    s->next = end;
    return BIS_TOKEN_NUMBER;
}

static bis_token_kind word(bis_lexer *l, bis_source *s, bis_token *t)
{
    const char *p = s->next;
    while (p < s->end && (is_letter(*p) || is_digit(*p))) p++;
    if (p != bare_end(s)) return bad_bare(l, s, t, "malformed word", "");
    t->length = (size_t)(p - t->text);
    s->next = p;
    return BIS_TOKEN_WORD;
}

/* What a backslash and c stand for, 0: nothing. As in pbrt-v4. */
static char escaped(char c)
{
    static const char from[] = "bfnrt\\'\"", to[] = "\b\f\n\r\t\\'\"";
    const char *found = c ? strchr(from, c) : NULL;
    return found ? to[found - from] : 0;
}

/* A string ends on its line. What is wrong with it, or NULL; *at: where. The lexer is moved behind it. */
static const char *scan_string(bis_source *s, const char **at, bool *is_latin1)
{
    const char *wrong = NULL;
    for (s->next++; s->next < s->end && !is_line_end(*s->next) && *s->next != '"';) {
        size_t n = bis_utf8_length(s->next, s->end);
        const char *problem = NULL;
        *is_latin1 |= !n;
        if (*s->next == '\0') problem = "a zero byte in a string";
        if (*s->next == '\\' && (s->next + 1 == s->end || !escaped(s->next[1])))
            problem = "unknown escape in a string: a backslash is written \\\\";
        if (problem && !wrong) {
            wrong = problem;
            *at = s->next;
        }
        if (*s->next == '\\' && s->next + 1 < s->end && !is_line_end(s->next[1])) s->next++;
        s->next += n ? n : 1;
        if (n > 1) s->n_continuation += n - 1;
    }
    if (s->next < s->end && *s->next == '"') return wrong;
    return "string without a closing quote";
}

static bis_token_kind string(bis_lexer *l, bis_source *s, bis_token *t)
{
    const size_t before = s->n_continuation;
    bool is_latin1 = false;
    const char *at = s->next, *wrong = scan_string(s, &at, &is_latin1);

    if (wrong) {
        bis_source there = *s; /* the characters up to the fault */
        there.n_continuation = before;
        for (const char *p = t->text; p < at; p++) there.n_continuation += bis_utf8_continues(*p);
        if (s->next < s->end && *s->next == '"') s->next++;
        bis_error(l->diag, BIS_INPUT, place(&there, at), "%s", wrong);
        return BIS_TOKEN_BAD;
    }
    if (is_latin1 && !l->said_latin1) {
        l->said_latin1 = true;
        bis_warn(l->diag, t->at, "a name is not UTF-8 text; its bytes are taken as they are, which changes nothing but "
                 "how it is printed");
    }
    t->text++;
    t->length = (size_t)(s->next++ - t->text);
    return BIS_TOKEN_STRING;
}

static bis_token_kind stray(bis_lexer *l, bis_source *s, bis_token *t)
{
    const unsigned char c = (unsigned char)*s->next;
    const char *start = s->next;

    /* One complaint for a run of such bytes: a binary file is full of them. */
    while (s->next < s->end && !is_space(*s->next) && !is_letter(*s->next) && !is_digit(*s->next) && *s->next != '"' &&
           *s->next != '[' && *s->next != ']' && *s->next != '#') {
        s->n_continuation += bis_utf8_continues(*s->next);
        s->next++;
    }
    t->length = (size_t)(s->next - start);
    if (c > ' ' && c < 0x7f) bis_error(l->diag, BIS_INPUT, t->at, "unexpected character \"%c\"", c);
    else bis_error(l->diag, BIS_INPUT, t->at, "unexpected byte 0x%02x: a scene is UTF-8 text", c);
    return BIS_TOKEN_BAD;
}

bis_token bis_lexer_next(bis_lexer *l)
{
    bis_source *s = &l->sources[l->n_sources - 1];

    skip_space(s);
    bis_token t = {BIS_TOKEN_END, s->next, 0, 0, place(s, s->next), false};
    if (s->next == s->end) return t;
    const char c = *s->next;
    if (is_digit(c) || c == '-' || c == '+' || c == '.') {
        t.kind = number(l, s, &t);
    } else if (c == '"') {
        t.kind = string(l, s, &t);
    } else if (c == '[' || c == ']') {
        t.kind = c == '[' ? BIS_TOKEN_OPEN : BIS_TOKEN_CLOSE;
        t.length = 1;
        s->next++;
    } else if (is_letter(c)) {
        t.kind = word(l, s, &t);
    } else {
        t.kind = stray(l, s, &t);
    }
    return t;
}

size_t bis_token_unescape(char *s, const bis_token *t)
{
    size_t n = 0;
    for (size_t i = 0; i < t->length; i++) {
        if (t->text[i] == '\\') s[n++] = escaped(t->text[++i]);
        else s[n++] = t->text[i];
    }
    s[n] = '\0';
    return n;
}

const char *bis_printable(char buf[128], const char *text, size_t length)
{
    size_t n = length < 100 ? length : 100;
    while (n < length && n > 0 && bis_utf8_continues(text[n])) n--;
    for (size_t i = 0; i < n;) {
        size_t k = bis_utf8_length(text + i, text + n);
        bool printable = k && ((unsigned char)text[i] >= ' ') && text[i] != 0x7f;
        if (!printable) k = 1;
        for (size_t j = 0; j < k; j++) buf[i + j] = printable ? text[i + j] : '?';
        i += k;
    }
    strcpy(buf + n, n < length ? "..." : "");
    return buf;
}

const char *bis_token_name(char buf[64], const bis_token *t)
{
    char text[128];
    bis_printable(text, t->text, t->length < 40 ? t->length : 40);
    const char *dots = t->length > 40 ? "..." : "";
    if (t->kind == BIS_TOKEN_END) snprintf(buf, 64, "the end of the file");
    else if (t->kind == BIS_TOKEN_STRING) snprintf(buf, 64, "the string \"%.40s%s\"", text, dots);
    else snprintf(buf, 64, "\"%.40s%s\"", text, dots);
    return buf;
}

static bis_status check_cycle(const bis_lexer *l, const struct stat *st, const char *name, bis_loc at)
{
    for (int i = 0; i < l->n_sources; i++)
        if (l->sources[i].device == st->st_dev && l->sources[i].inode == st->st_ino)
            return bis_error(l->diag, BIS_INPUT, at, "Include cycle: \"%s\" is being read already", name);
    if (l->n_sources > BIS_INCLUDE_DEPTH)
        return bis_error(l->diag, BIS_INPUT, at, "Include deeper than %d files", BIS_INCLUDE_DEPTH);
    return BIS_OK;
}

/* Read data[size], which becomes the lexer's. */
static void begin(bis_lexer *l, const char *name, unsigned char *data, size_t size, const struct stat *st)
{
    bis_source *s = &l->sources[l->n_sources++];

    *s = (bis_source){.name = name, .data = data, .line = 1, .device = st->st_dev, .inode = st->st_ino};
    s->next = (const char *)data;
    s->end = s->next + size;
    s->next += bis_byte_order_mark(data, size);
    s->line_start = s->next;
}

bis_status bis_lexer_push_text(bis_lexer *l, const char *name, const char *text)
{
    unsigned char *data = (unsigned char *)bis_strdup(text);

    if (!data) return bis_error(l->diag, BIS_NOMEM, (bis_loc){name, 0, 0}, "no memory for the scene's text");
    begin(l, name, data, strlen(text), &(struct stat){0}); /* no file has device and number 0 */
    return BIS_OK;
}

bis_status bis_lexer_push(bis_lexer *l, const char *name, bis_loc at)
{
    struct stat st = {0};
    bool known = stat(name, &st) == 0; /* else the reader says why */
    bis_status status = known ? check_cycle(l, &st, name, at) : BIS_OK;
    if (status) return status;

    size_t size;
    unsigned char *data;
    status = bis_gzip_read(&data, &size, name, at, l->diag);
    if (status) return status;
    begin(l, name, data, size, &st);
    return BIS_OK;
}

bool bis_lexer_pop(bis_lexer *l)
{
    if (!l->n_sources) return false;
    bis_free(l->sources[--l->n_sources].data);
    return l->n_sources > 0;
}

void bis_lexer_clear(bis_lexer *l)
{
    while (l->n_sources) bis_lexer_pop(l);
}
