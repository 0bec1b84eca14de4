/* SPDX-License-Identifier: BSD-2-Clause */
/* markup: what a page (template.h) and a drawing (svg.h) share: text and pictures inside HTML and SVG. */
#pragma once

#include "bis/base/image.h"

#include <stdio.h>

/* bis_markup_text prints n bytes of text. &, <, >, " and ' become entities. A byte that no UTF-8 holds and a control
 * character become U+FFFD, because a file's name may have any byte. */
void bis_markup_text(FILE *out, const char *text, size_t n);

/* bis_markup_png returns image as the address "data:image/png;base64,...", to be freed by free(). Radiance is
 * multiplied by 2^exposure; with 0 the colours appear as they are. NULL: no memory, as diag says. */
char *bis_markup_png(const bis_image *image, double exposure, bis_diag *diag);
