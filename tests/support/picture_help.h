/* SPDX-License-Identifier: BSD-2-Clause */
/* picture_help: reads a picture inside an SVG drawing back. */
#ifndef TESTS_PICTURE_HELP_H
#define TESTS_PICTURE_HELP_H

#include "bis/base/image.h"

/* picture_in reads what the picture `name` inside a drawing shows, linear. It is base64 (RFC 4648) of a PNG. The caller
 * clears it. */
void picture_in(bis_image *image, const char *drawing, const char *name);

#endif
