/* SPDX-License-Identifier: BSD-2-Clause */
/* json_check: is a text valid JSON (RFC 8259), and what stands at a key? A reader of its own, so that the writer is not
 * its own judge. */
#ifndef TESTS_JSON_CHECK_H
#define TESTS_JSON_CHECK_H

#include <stdbool.h>
#include <stddef.h>

/* One JSON value and white space, nothing else. */
bool json_is_valid(const char *text);

/* The keys of the object at the dotted path ("" the outermost, "rays", "seconds"), in order, with a blank after each,
 * in buf. */
const char *json_keys(char *buf, size_t size, const char *text, const char *path);

/* The raw text of the value at the dotted path ("rays.shadow", "levels.2.pixels": the third of a list): `12`, `"abc"`,
 * `null`; "" when there is none. */
const char *json_value(char *buf, size_t size, const char *text, const char *path);

/* The number there, NAN when there is none. */
double json_number(const char *text, const char *path);

#endif
