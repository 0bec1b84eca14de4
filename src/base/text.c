/* SPDX-License-Identifier: BSD-2-Clause */
/* text: one byte after the other. */
#include "text.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

size_t bis_utf8_length(const char *s, const char *end)
{
    const unsigned char c = (unsigned char)s[0];
    if (c < 0x80) return 1;
    size_t n = c >= 0xc2 && c <= 0xdf ? 2 : c >= 0xe0 && c <= 0xef ? 3 : c >= 0xf0 && c <= 0xf4 ? 4 : 0;
    if (!n || (size_t)(end - s) < n) return 0;
    for (size_t i = 1; i < n; i++)
        if (!bis_utf8_continues(s[i])) return 0;
    const unsigned char d = (unsigned char)s[1];
    /* what UTF-8 forbids (RFC 3629): longer forms of a code, halves of UTF-16 pairs, codes above 10FFFF */
    const bool overlong = (c == 0xe0 && d < 0xa0) || (c == 0xf0 && d < 0x90);
    const bool surrogate = c == 0xed && d > 0x9f, too_large = c == 0xf4 && d > 0x8f;
    return overlong || surrogate || too_large ? 0 : n;
}

void bis_append(char *buf, size_t size, const char *fmt, ...)
{
    const size_t used = strlen(buf);
    va_list args;

    va_start(args, fmt);
    vsnprintf(buf + used, size - used, fmt, args);
    va_end(args);
}

const char *bis_hint(char buf[BIS_HINT], const char *nearest)
{
    *buf = '\0';
    /* cut, so that the sentence is whole whatever the name is */
    if (nearest) snprintf(buf, BIS_HINT, " (did you mean \"%.90s\"?)", nearest);
    return buf;
}

const char *bis_duration(char buf[BIS_DURATION], double seconds)
{
    const size_t n = BIS_DURATION;

    /* limits lie where rounding would reach the next form: 9.95 would be "1e+01 s" by %.2g */
    if (seconds > 0 && seconds < 0.0995) snprintf(buf, n, "%.2g ms", 1e3 * seconds);
    else if (seconds < 9.95) snprintf(buf, n, "%.2g s", seconds);
    else if (seconds < 99.5) snprintf(buf, n, "%.0f s", seconds);
    else if (seconds < 5400) snprintf(buf, n, "%.*f min", seconds < 597 ? 1 : 0, seconds / 60);
    else if (seconds < 48 * 3600) snprintf(buf, n, "%.1f h", seconds / 3600);
    else snprintf(buf, n, "%.3g days", seconds / 86400);
    return buf;
}

const char *bis_percent(char buf[BIS_PERCENT], double share)
{
    const double p = 100 * share;
    const size_t n = BIS_PERCENT;

    if (p > 0 && p < 1e-4) snprintf(buf, n, "below 0.0001%%"); /* where %g begins to write 1e-05 */
    else if (p < 9.95) snprintf(buf, n, "%.2g%%", p);
    else if (p > 1e6) snprintf(buf, n, "over 1000000%%");
    else snprintf(buf, n, "%.0f%%", p);
    return buf;
}

const char *bis_percent_above(char buf[BIS_PERCENT], double bound)
{
    const double p = 100 * bound, step = p < 10 ? pow(10, floor(log10(p)) - 1) : 1;

    if (!(p > 0)) return bis_percent(buf, bound);
    /* 0.012 is no double: without the 1e-9 it might become 1.3% */
    return bis_percent(buf, ceil(p / step - 1e-9) * step / 100);
}

uint64_t bis_fnv1a(uint64_t h, const void *bytes, size_t n)
{
    const unsigned char *byte = bytes;

    for (size_t i = 0; i < n; i++) h = (h ^ byte[i]) * UINT64_C(0x100000001b3);
    return h;
}
