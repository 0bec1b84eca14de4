/* text: the one test of UTF-8, for scenes that are read and for JSON, HTML and SVG that are written. */
#include "text.h"

#include <stdbool.h>

size_t bis_utf8_length(const char *s, const char *end)
{
    const unsigned char c = (unsigned char)s[0];
    if (c < 0x80) return 1;
    size_t n = c >= 0xc2 && c <= 0xdf ? 2 : c >= 0xe0 && c <= 0xef ? 3 : c >= 0xf0 && c <= 0xf4 ? 4 : 0;
    if (!n || (size_t)(end - s) < n) return 0;
    for (size_t i = 1; i < n; i++) {
        if (((unsigned char)s[i] & 0xc0) != 0x80) return 0;
    }
    const unsigned char d = (unsigned char)s[1];
    const bool overlong = (c == 0xe0 && d < 0xa0) || (c == 0xf0 && d < 0x90);
    const bool surrogate = c == 0xed && d > 0x9f, too_large = c == 0xf4 && d > 0x8f;
    return overlong || surrogate || too_large ? 0 : n;
}
