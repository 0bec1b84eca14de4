/* SPDX-License-Identifier: BSD-2-Clause */
/* text: what strings are asked that is not about one file format: UTF-8, appending, a hash. */
#pragma once

#include "bis/base/status.h"

#include <stdint.h>

/* bis_utf8_continues returns whether a byte continues a UTF-8 character. */
static inline bool bis_utf8_continues(char c) { return ((unsigned char)c & 0xc0) == 0x80; }

/* bis_utf8_length returns the number of bytes of the UTF-8 character at s, before end; 0 if it is ill-formed (RFC 3629:
 * no overlong forms, no surrogates, at most U+10FFFF). */
size_t bis_utf8_length(const char *s, const char *end);

/* bis_append appends to the text in buf[size]. What does not fit is cut off. */
void bis_append(char *buf, size_t size, const char *fmt, ...) BIS_PRINTF(3, 4);

enum { BIS_HINT = 128 };

/* bis_hint writes ` (did you mean "NEAREST"?)` to buf, or "" for NULL, and returns it. */
const char *bis_hint(char buf[BIS_HINT], const char *nearest);

enum { BIS_DURATION = 24 };

/* bis_duration writes a duration to buf, with two to three digits in the unit that keeps the number small, and returns
 * it: "42 ms", "3.1 s", "90 s", "6.5 min", "2.5 h", "12 days". */
const char *bis_duration(char buf[BIS_DURATION], double seconds);

enum { BIS_PERCENT = 24 };

/* bis_percent writes a share >= 0 to buf in percent as a person does, with two digits or as a whole number, and returns
 * it: "0.034%", "3.4%", "12%", "170%"; "below 0.0001%" and "over 1000000%" beyond these. */
const char *bis_percent(char buf[BIS_PERCENT], double share);

/* bis_percent_above does the same for a bound, which it rounds up. */
const char *bis_percent_above(char buf[BIS_PERCENT], double bound);

#define BIS_FNV1A UINT64_C(0xcbf29ce484222325)

/* bis_fnv1a returns the hash h (BIS_FNV1A at first) after n more bytes. Source: FNV-1a of Fowler, Noll, Vo. */
uint64_t bis_fnv1a(uint64_t h, const void *bytes, size_t n);
