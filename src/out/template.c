/* SPDX-License-Identifier: BSD-2-Clause */
/* template: the page is copied up to the next mark; a mark looks its name up in the JSON text itself, which is never
 * turned into anything else: an object is found by walking over the members before it. */
#include "template.h"

#include "markup.h"

#include <stdlib.h>
#include <string.h>

enum { NAME = 32 };

typedef struct filler {
    FILE *out;
    bis_diag *diag;
} filler;

/* ---- JSON ---- */

static const char *skip_blanks(const char *at) { return at + strspn(at, " \n,:"); }

static const char *skip_string(const char *at)
{
    for (at++; *at != '"'; at++) at += *at == '\\';
    return at + 1;
}

/* From the first byte of a value to the one behind it. */
static const char *skip_value(const char *at)
{
    int depth = 0;
    do {
        if (*at == '"') {
            at = skip_string(at);
            continue;
        }
        if (!strchr("{}[]", *at)) {
            if (depth == 0) return at + strcspn(at, ",]}\n");
            at += strcspn(at, "\"{}[]");
            continue;
        }
        depth += *at == '{' || *at == '[' ? 1 : -1;
        at++;
    } while (depth > 0);
    return at;
}

/* The value of a member, or NULL. */
static const char *member(const char *object, const char *name)
{
    const size_t n = strlen(name);
    if (*object != '{') return NULL;
    for (const char *at = skip_blanks(object + 1); *at == '"';) {
        const char *end = skip_string(at), *value = skip_blanks(end);
        if ((size_t)(end - at) == n + 2 && strncmp(at + 1, name, n) == 0) return value;
        at = skip_blanks(skip_value(value));
    }
    return NULL;
}

static bool is_empty(const char *value)
{
    static const char *const empty[] = {"false", "null", "\"\""};
    for (int i = 0; i < 3; i++)
        if (strncmp(value, empty[i], strlen(empty[i])) == 0) return true;
    if (*value == '{' || *value == '[') return strchr("]}", *skip_blanks(value + 1)) != NULL;
    return *value != '"' && *value != 't' && strtod(value, NULL) == 0; /* "true" is the only other word */
}

/* A string without its quotes and escapes, anything else as it stands. */
static void put_value(FILE *out, const char *value)
{
    if (*value != '"') {
        bis_markup_text(out, value, strcspn(value, ",]}\n"));
        return;
    }
    for (const char *at = value + 1; *at != '"';) {
        const size_t n = strcspn(at, "\"\\");
        bis_markup_text(out, at, n);
        at += n;
        if (*at != '\\') continue;
        if (at[1] == 'u') bis_markup_text(out, "\x7f", 1); /* a control character or none at all */
        else bis_markup_text(out, at + 1, 1);
        at += at[1] == 'u' ? 6 : 2;
    }
}

/* ---- the page ---- */

static bis_status wrong(const filler *f, const char *what, const char *name)
{
    return bis_error(f->diag, BIS_INPUT, (bis_loc){0}, "%s \"%s\" of the page", what, name);
}

/* Is text at `at`, before `end`? */
static bool stands(const char *at, const char *end, const char *text)
{
    const size_t n = strlen(text);
    return (size_t)(end - at) >= n && strncmp(at, text, n) == 0;
}

static const char *find(const char *at, const char *end, const char *text)
{
    while (at < end && !stands(at, end, text)) at++;
    return at;
}

/* The value that a name at `at` asks for, or NULL; name: what was looked for. */
static const char *look_up(char name[NAME], const char *at, const char *scope)
{
    snprintf(name, NAME, "%.*s", (int)strcspn(at, "|]*-"), at);
    return strcmp(name, ".") == 0 ? scope : member(scope, name);
}

static bis_status fill(const filler *f, const char *at, const char *end, const char *scope);

/* css: between slash-star and star-slash. *at: behind the word each; then behind the section. */
static bis_status fill_section(const filler *f, const char **at, const char *end, const char *scope, bool css)
{
    const char *const open = css ? "/*" : "<!--", *const close = css ? "*/" : "-->";
    char name[NAME], mark[NAME + 16];
    const char *value = look_up(name, *at, scope);
    bis_status status = BIS_OK;

    if (!value) return wrong(f, "no value for section", name);
    const char *body = find(*at, end, close) + strlen(close);
    snprintf(mark, sizeof mark, "%send %s%s", open, name, close);
    const char *last = find(body, end, mark);
    if (last == end) return wrong(f, "no end of section", name);
    *at = last + strlen(mark);
    snprintf(mark, sizeof mark, "%selse %s%s", open, name, close);
    const char *middle = find(body, last, mark);
    if (is_empty(value)) return middle == last ? BIS_OK : fill(f, middle + strlen(mark), last, scope);
    if (*value != '[') return fill(f, body, middle, *value == '{' ? value : scope);
    for (const char *item = skip_blanks(value + 1); *item != ']' && !status; item = skip_blanks(skip_value(item)))
        status = fill(f, body, middle, item);
    return status;
}

static bis_status fill_hole(const filler *f, const char **at, const char *end, const char *scope)
{
    char name[NAME];
    const char *value = look_up(name, *at + 2, scope);
    if (!value) return wrong(f, "no value for hole", name);
    put_value(f->out, value);
    *at = find(*at, end, "]]") + 2;
    return BIS_OK;
}

static bis_status fill(const filler *f, const char *at, const char *end, const char *scope)
{
    static const char each[] = "<!--each ", css_each[] = "/*each ";
    bis_status status = BIS_OK;

    while (at < end && !status) {
        if (stands(at, end, "[[")) {
            status = fill_hole(f, &at, end, scope);
        } else if (stands(at, end, each)) {
            at += sizeof each - 1;
            status = fill_section(f, &at, end, scope, false);
        } else if (stands(at, end, css_each)) {
            at += sizeof css_each - 1;
            status = fill_section(f, &at, end, scope, true);
        } else if (stands(at, end, "<!--")) {
            at = find(at, end, "-->") + 3;
        } else {
            fputc(*at++, f->out);
        }
    }
    return status;
}

bis_status bis_template_fill(FILE *out, const char *page, const char *json, bis_diag *diag)
{
    const filler f = {out, diag};
    return fill(&f, page, page + strlen(page), json);
}
