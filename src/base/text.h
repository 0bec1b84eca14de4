/* text: what is a character of a file's text or of a name. */
#ifndef BIS_TEXT_H
#define BIS_TEXT_H

#include <stddef.h>

/* bis_utf8_length returns the number of bytes of the well-formed UTF-8 sequence at s, which ends before end > s, and 0
 * if there is none (RFC 3629: no overlong form, no surrogate, at most U+10FFFF). */
size_t bis_utf8_length(const char *s, const char *end);

#endif
