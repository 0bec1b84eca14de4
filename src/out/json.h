/* json: a small writer that cannot produce anything but valid JSON: it keeps the commas and braces, escapes strings,
 * prints numbers independent of the locale, and null for NaN and infinity. For the cli alone.
 *
 *     bis_json j = {.out = stdout};
 *     bis_json_open(&j, NULL, '{');
 *     bis_json_number(&j, "rmse", 0.5);
 *     bis_json_close(&j);             // {"rmse": 0.5} and a newline, since it was the outermost */
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#define BIS_JSON_DEPTH 16

typedef struct bis_json {
    FILE *out;
    int depth;
    char close[BIS_JSON_DEPTH]; /* '}' or ']' of the open levels */
    bool any[BIS_JSON_DEPTH];   /* has the level a member yet? */
} bis_json;

/* key: the member's name, NULL inside an array and for the outermost value. kind: '{' or '['. */
void bis_json_open(bis_json *j, const char *key, char kind);
void bis_json_close(bis_json *j);

/* NaN and infinities become null; -0.0 is kept; the shortest text that reads back as the same double. */
void bis_json_number(bis_json *j, const char *key, double v);
void bis_json_count(bis_json *j, const char *key, uint64_t v);
void bis_json_bool(bis_json *j, const char *key, bool v);
void bis_json_null(bis_json *j, const char *key);

/* NULL becomes null. Bytes that are not UTF-8 (a file name may hold any) become U+FFFD. */
void bis_json_text(bis_json *j, const char *key, const char *v);
