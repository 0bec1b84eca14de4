/* SPDX-License-Identifier: BSD-2-Clause */
/* json: a writer that keeps the commas and braces (RFC 8259), so that every --stats and --json is valid whatever a file
 * is called. */
#include "base/text.h"
#include "json.h"

#include "bis/base/file.h"

#include <assert.h>
#include <math.h>
#include <string.h>

static void print_string(const bis_json *j, const char *text)
{
    FILE *out = j->out;
    const char *s = text, *end = text + strlen(text);

    fputc('"', out);
    while (*s) {
        const size_t n = bis_utf8_length(s, end);
        if (n == 0) { /* a file's name may be any bytes, but JSON is UTF-8 */
            fprintf(out, "\\u%04x", j->keeps_bytes ? 0xdc00u + (unsigned char)*s : 0xfffdu);
            s++;
        } else if (*s == '"' || *s == '\\') {
            fprintf(out, "\\%c", *s++);
        } else if ((unsigned char)*s < 0x20 || *s == 0x7f) {
            fprintf(out, "\\u%04x", (unsigned)*s++);
        } else {
            fwrite(s, 1, n, out);
            s += n;
        }
    }
    fputc('"', out);
}

/* Comma, line break, indentation and key in front of a value. */
static void print_lead(bis_json *j, const char *key)
{
    if (j->depth > 0) {
        int level = j->depth - 1;
        assert((key != NULL) == (j->close[level] == '}'));
        fprintf(j->out, "%s\n%*s", j->any[level] ? "," : "", 2 * j->depth, "");
        j->any[level] = true;
    }
    if (key) {
        print_string(j, key);
        fputs(": ", j->out);
    }
}

void bis_json_open(bis_json *j, const char *key, char kind)
{
    assert(j->depth < BIS_JSON_DEPTH && (kind == '{' || kind == '['));
    print_lead(j, key);
    fputc(kind, j->out);
    j->close[j->depth] = kind == '{' ? '}' : ']';
    j->any[j->depth] = false;
    j->depth++;
}

void bis_json_close(bis_json *j)
{
    assert(j->depth > 0);
    j->depth--;
    if (j->any[j->depth]) fprintf(j->out, "\n%*s", 2 * j->depth, "");
    fputc(j->close[j->depth], j->out);
    if (j->depth == 0) fputc('\n', j->out);
}

void bis_json_number(bis_json *j, const char *key, double v)
{
    char text[32];

    if (!isfinite(v)) { /* JSON has no NaN and no infinity */
        bis_json_null(j, key);
        return;
    }
    print_lead(j, key);
    fputs(bis_format_double(text, v), j->out);
}

void bis_json_numbers(bis_json *j, const bis_json_member *members, size_t n)
{
    for (size_t i = 0; i < n; i++) bis_json_number(j, members[i].key, members[i].value);
}

void bis_json_triple(bis_json *j, const char *key, double x, double y, double z)
{
    bis_json_open(j, key, '[');
    BIS_JSON_NUMBERS(j, {NULL, x}, {NULL, y}, {NULL, z});
    bis_json_close(j);
}

void bis_json_count(bis_json *j, const char *key, uint64_t v)
{
    print_lead(j, key);
    fprintf(j->out, "%llu", (unsigned long long)v);
}

void bis_json_bool(bis_json *j, const char *key, bool v)
{
    print_lead(j, key);
    fputs(v ? "true" : "false", j->out);
}

void bis_json_null(bis_json *j, const char *key)
{
    print_lead(j, key);
    fputs("null", j->out);
}

void bis_json_text(bis_json *j, const char *key, const char *v)
{
    if (!v) {
        bis_json_null(j, key);
        return;
    }
    print_lead(j, key);
    print_string(j, v);
}
