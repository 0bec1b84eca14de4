/* SPDX-License-Identifier: BSD-2-Clause */
/* json_check: recursive descent; every function returns the place behind what it read, NULL when it was not there. */
#include "json_check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_DEPTH = 64 };

static const char *skip(const char *s) { return s + strspn(s, " \t\r\n"); }

static const char *hex4(const char *s) { return strspn(s, "0123456789abcdefABCDEF") >= 4 ? s + 4 : NULL; }

static const char *string(const char *s)
{
    if (*s++ != '"') return NULL;
    while (s && *s != '"') {
        if ((unsigned char)*s < 0x20) return NULL; /* the end of the text, too */
        if (*s != '\\') {
            s++;
            continue;
        }
        s++;
        if (*s == 'u')
            s = hex4(s + 1);
        else
            s = *s && strchr("\"\\/bfnrt", *s) ? s + 1 : NULL;
    }
    return s ? s + 1 : NULL;
}

static const char *digits(const char *s)
{
    size_t n = strspn(s, "0123456789");
    return n ? s + n : NULL;
}

static const char *number(const char *s)
{
    if (*s == '-') s++;
    s = *s == '0' ? s + 1 : digits(s);
    if (s && *s == '.') s = digits(s + 1);
    if (s && (*s == 'e' || *s == 'E')) {
        s++;
        if (*s == '+' || *s == '-') s++;
        s = digits(s);
    }
    return s;
}

static const char *value(const char *s, int depth);

/* Members of an object or array behind its opening bracket. */
static const char *members(const char *s, char close, int depth)
{
    s = skip(s);
    if (*s == close) return s + 1;
    for (;;) {
        if (close == '}') {
            s = string(skip(s));
            if (!s) return NULL;
            s = skip(s);
            if (*s++ != ':') return NULL;
        }
        s = value(s, depth + 1);
        if (!s) return NULL;
        s = skip(s);
        if (*s == close) return s + 1;
        if (*s++ != ',') return NULL;
    }
}

static const char *value(const char *s, int depth)
{
    s = skip(s);
    if (depth > MAX_DEPTH) return NULL;
    if (*s == '{') return members(s + 1, '}', depth);
    if (*s == '[') return members(s + 1, ']', depth);
    if (*s == '"') return string(s);
    if (strncmp(s, "true", 4) == 0 || strncmp(s, "null", 4) == 0) return s + 4;
    if (strncmp(s, "false", 5) == 0) return s + 5;
    return number(s);
}

bool json_is_valid(const char *text)
{
    const char *end = value(text, 0);
    return end && *skip(end) == '\0';
}

/* The value of member `key` of the object at s, or NULL; with `keys`, all names are appended there. */
static const char *find_member(const char *s, const char *key, size_t length, char *keys, size_t size)
{
    s = skip(s);
    if (*s != '{') return NULL;
    for (s = skip(s + 1); *s == '"';) {
        const char *name = s + 1, *end = string(s);
        size_t n = (size_t)(end - name) - 1;
        if (keys) snprintf(keys + strlen(keys), size - strlen(keys), "%.*s ", (int)n, name);
        const char *v = skip(skip(end) + 1);
        if (key && n == length && strncmp(name, key, n) == 0) return v;
        s = skip(value(v, 0));
        if (*s == ',') s = skip(s + 1);
    }
    return NULL;
}

/* The k-th value, from 0, of the array at s, or NULL. */
static const char *find_item(const char *s, size_t k)
{
    s = skip(skip(s) + 1);
    for (size_t i = 0; *s != ']'; i++) {
        if (i == k) return s;
        s = skip(value(s, 0));
        if (*s == ',') s = skip(s + 1);
    }
    return NULL;
}

static const char *find(const char *text, const char *path)
{
    while (text && *path) {
        const char *whole = find_member(text, path, strlen(path), NULL, 0); /* a last key may hold a dot */
        if (whole) return whole;
        size_t n = strcspn(path, ".");
        text = *skip(text) == '[' ? find_item(text, strtoul(path, NULL, 10)) : find_member(text, path, n, NULL, 0);
        path += n;
        if (*path == '.') path++;
    }
    return text;
}

const char *json_keys(char *buf, size_t size, const char *text, const char *path)
{
    const char *object = json_is_valid(text) ? find(text, path) : NULL;
    buf[0] = '\0';
    if (object) find_member(object, NULL, 0, buf, size);
    return buf;
}

double json_number(const char *text, const char *path)
{
    char buf[64], *end;
    const double v = strtod(json_value(buf, sizeof buf, text, path), &end);

    return *buf && !*end ? v : (double)NAN;
}

const char *json_value(char *buf, size_t size, const char *text, const char *path)
{
    const char *v = json_is_valid(text) ? find(text, path) : NULL;
    buf[0] = '\0';
    if (v) snprintf(buf, size, "%.*s", (int)(value(v, 0) - v), v);
    return buf;
}
