/* SPDX-License-Identifier: BSD-2-Clause */
/* json: a small writer that cannot produce anything but valid JSON: it keeps the commas and braces, escapes strings,
 * prints numbers independent of the locale, and null for NaN and infinity. For the cli, and for what flat tells as
 * text.
 *
 *     bis_json j = {.out = stdout};
 *     bis_json_open(&j, NULL, '{');
 *     bis_json_number(&j, "rmse", 0.5);
 *     BIS_JSON_NUMBERS(&j, {"bias", c->bias}, {"pixels", (double)c->pixels});
 *     bis_json_close(&j);             // {"rmse": 0.5, ...} and a newline, since it was the outermost */
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
    bool keeps_bytes;           /* for Python: a byte b that is no UTF-8 becomes the lone surrogate U+DC00 + b */
} bis_json;

/* bis_json_open opens an object or an array (kind: '{' or '['); bis_json_close closes the last one that is open. key:
 * the member's name, here as in all that follows; NULL inside an array and for the outermost value. */
void bis_json_open(bis_json *j, const char *key, char kind);
void bis_json_close(bis_json *j);

/* bis_json_number writes the shortest text that reads back as the same double. NaN and infinities become null; -0.0 is
 * kept. The next three write a count, true or false, and null. */
void bis_json_number(bis_json *j, const char *key, double v);
void bis_json_count(bis_json *j, const char *key, uint64_t v);
void bis_json_bool(bis_json *j, const char *key, bool v);
void bis_json_null(bis_json *j, const char *key);

typedef struct bis_json_member {
    const char *key;
    double value;
} bis_json_member;

/* bis_json_numbers writes n members that are numbers; a count below 10^15 looks as bis_json_count writes it.
 * bis_json_triple writes an array of three. BIS_JSON_OBJECT writes an object of numbers. */
void bis_json_numbers(bis_json *j, const bis_json_member *members, size_t n);
void bis_json_triple(bis_json *j, const char *key, double x, double y, double z);
#define BIS_JSON_NUMBERS(j, ...)                                                                                       \
    bis_json_numbers(j, (const bis_json_member[]){__VA_ARGS__},                                                        \
                     sizeof((const bis_json_member[]){__VA_ARGS__}) / sizeof(bis_json_member))
#define BIS_JSON_OBJECT(j, key, ...)                                                                                   \
    (bis_json_open(j, key, '{'), BIS_JSON_NUMBERS(j, __VA_ARGS__), bis_json_close(j))

/* bis_json_text writes a string. NULL becomes null. Bytes that are not UTF-8 (a file name may hold any) become U+FFFD,
 * unless keeps_bytes. */
void bis_json_text(bis_json *j, const char *key, const char *v);
