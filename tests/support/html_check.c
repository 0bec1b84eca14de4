/* SPDX-License-Identifier: BSD-2-Clause */
/* html_check: one pass over the tags with a stack of open elements. */
#include "html_check.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DEPTH = 64, NAME = 32 };

typedef struct checker {
    const char *page, *at;
    char open[DEPTH][NAME];
    int depth;
    char *why;
    size_t size;
} checker;

static bool wrong(checker *c, const char *what)
{
    int line = 1;
    for (const char *p = c->page; p < c->at; p++) line += *p == '\n';
    snprintf(c->why, c->size, "line %d: %s at \"%.40s\"", line, what, c->at);
    return false;
}

/* "name" of a tag or attribute; false where there is none. */
static bool read_name(checker *c, char name[NAME])
{
    size_t n = 0;
    while ((isalnum((unsigned char)*c->at) || *c->at == '-' || *c->at == ':') && n + 1 < NAME) name[n++] = *c->at++;
    name[n] = '\0';
    return n > 0;
}

static void skip_blanks(checker *c)
{
    while (isspace((unsigned char)*c->at)) c->at++;
}

/* name="value", quoted, without < in it. */
static bool read_attribute(checker *c)
{
    char name[NAME];
    if (!read_name(c, name)) return wrong(c, "no attribute");
    if (strncmp(c->at, "=\"", 2) != 0) return wrong(c, "an attribute without quotes");
    for (c->at += 2; *c->at != '"'; c->at++) {
        if (!*c->at || *c->at == '<') return wrong(c, "an attribute that does not end");
    }
    c->at++;
    return true;
}

static bool read_end_tag(checker *c)
{
    char name[NAME];
    c->at += 2;
    if (!read_name(c, name) || *c->at != '>') return wrong(c, "a broken end tag");
    if (c->depth == 0 || strcmp(c->open[c->depth - 1], name) != 0) return wrong(c, "an end tag that closes nothing");
    c->depth--;
    c->at++;
    return true;
}

static bool read_tag(checker *c)
{
    char name[NAME], end[NAME + 4];

    c->at++;
    if (!read_name(c, name)) return wrong(c, "a bare <");
    for (skip_blanks(c); *c->at != '>' && *c->at != '/'; skip_blanks(c)) {
        if (!read_attribute(c)) return false;
    }
    if (*c->at == '/') {
        if (c->at[1] != '>') return wrong(c, "a broken tag");
        c->at += 2;
        return true;
    }
    c->at++;
    if (c->depth == DEPTH) return wrong(c, "too deep");
    snprintf(c->open[c->depth++], NAME, "%s", name);
    if (strcmp(name, "style") != 0 && strcmp(name, "script") != 0) return true;
    snprintf(end, sizeof end, "</%s>", name);
    const char *close = strstr(c->at, end);
    if (!close) return wrong(c, "no end of style or script");
    c->at = close;
    return true;
}

static bool read_entity(checker *c)
{
    const char *end = strchr(c->at, ';');
    if (!end || end - c->at > 8 || end - c->at < 3) return wrong(c, "a bare &");
    for (const char *p = c->at + 1; p < end; p++) {
        if (!isalnum((unsigned char)*p) && *p != '#') return wrong(c, "a bare &");
    }
    c->at = end + 1;
    return true;
}

bool html_is_well_formed(const char *page, char *why, size_t size)
{
    static const char doctype[] = "<!DOCTYPE html>";
    checker c = {.page = page, .at = page, .why = why, .size = size};

    if (strncmp(page, doctype, sizeof doctype - 1) != 0) return wrong(&c, "no doctype");
    c.at += sizeof doctype - 1;
    while (*c.at) {
        bool ok = true;
        if (strncmp(c.at, "</", 2) == 0) ok = read_end_tag(&c);
        else if (*c.at == '<') ok = read_tag(&c);
        else if (*c.at == '&') ok = read_entity(&c);
        else if (*c.at == '>') ok = wrong(&c, "a bare >");
        else c.at++;
        if (!ok) return false;
    }
    return c.depth == 0 || wrong(&c, "elements left open at the end");
}

int html_count(const char *page, const char *what)
{
    int n = 0;
    for (const char *p = page; (p = strstr(p, what)) != NULL; p++) n++;
    return n;
}

/* All places of `what` are followed by one of the two. */
static bool always_before(const char *page, const char *what, const char *a, const char *b)
{
    for (const char *p = page; (p = strstr(p, what)) != NULL;) {
        p += strlen(what);
        if (strncmp(p, a, strlen(a)) != 0 && strncmp(p, b, strlen(b)) != 0) return false;
    }
    return true;
}

/* The page without what is between <script> and its end, and the scripts without the rest, in two new texts. */
static void split(const char *page, char *rest, char *scripts)
{
    while (*page) {
        const char *begin = strstr(page, "<script"), *end = begin ? strstr(begin, "</script>") : NULL;
        if (!end) break;
        begin += strcspn(begin, ">");
        rest += sprintf(rest, "%.*s", (int)(begin - page), page);
        scripts += sprintf(scripts, "%.*s", (int)(end - begin), begin);
        page = end;
    }
    strcpy(rest, page);
    *scripts = '\0';
}

static bool holds(const char *text, const char *const *foreign, size_t n, char *why, size_t size)
{
    for (size_t i = 0; i < n; i++) {
        if (!strstr(text, foreign[i])) continue;
        snprintf(why, size, "the page holds \"%s\"", foreign[i]);
        return true;
    }
    return false;
}

bool html_is_self_contained(const char *page, char *why, size_t size)
{
    static const char *const foreign[] = {"http", "@import", "src=", "href="};
    static const char *const calls[] = {
        "@import", "https:", "fetch(", "XMLHttpRequest", "import(", "new Worker", "sendBeacon"};
    const size_t n = strlen(page) + 1;
    char *rest = malloc(2 * n), *scripts = rest + n;

    split(page, rest, scripts);
    bool ok = !holds(rest, foreign, sizeof foreign / sizeof *foreign, why, size) &&
              !holds(scripts, calls, sizeof calls / sizeof *calls, why, size);
    if (ok && !always_before(rest, "url(", "data:", "\"data")) {
        snprintf(why, size, "a url( that is no data:");
        ok = false;
    }
    free(rest);
    return ok;
}
