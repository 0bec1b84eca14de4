/* SPDX-License-Identifier: BSD-2-Clause */
/* page: a file of HTML that shows a JSON object by its own script and needs nothing but itself. The page is a file of
 * the sources, put by make into the frame of all pages (src/tools/frame.html) with docs/live/plot.js and page.css. The
 * frame has two places to be filled:
 *
 *     <script type="application/json" id="data">null</script>    the object
 *     <pre id="text"></pre>                                      the same as text, for a browser without JavaScript */
#pragma once

#include "bis/base/image.h"
#include "out/json.h"

#include <stdio.h>

/* bis_page_write prints page with both places filled. json: as bis_json has written it. Text that is not UTF-8 becomes
 * U+FFFD. Errors: BIS_INPUT (a place is missing). */
bis_status bis_page_write(FILE *out, const char *page, const char *json, const char *text, bis_diag *diag);

/* A page in the making: the command writes its object to json and its text to text. */
typedef struct bis_page {
    FILE *json, *text;
    char *parts[2]; /* what they hold, once they are closed */
    size_t bytes[2];
} bis_page;

/* bis_page_begin opens both streams. what names the page in a message. Errors: BIS_NOMEM; *p is then freed. */
bis_status bis_page_begin(bis_page *p, const char *what, bis_diag *diag);

/* bis_page_end closes the streams, fills page by bis_page_write into the file at path, whole or not at all, if status
 * is BIS_OK, and frees *p. It returns status if that is an error. Errors: BIS_IO, BIS_NOMEM, BIS_INPUT. */
bis_status bis_page_end(bis_page *p, bis_status status, const char *path, const char *page, const char *what,
                        bis_diag *diag);

/* bis_page_png returns image as the address "data:image/png;base64,...", to be freed by free(). Radiance is multiplied
 * by 2^exposure; with 0 the colours appear as they are. NULL: no memory, as diag says. */
char *bis_page_png(const bis_image *image, double exposure, bis_diag *diag);

/* bis_page_numbers writes v[0..n-1] under key as a text: of each number the lowest `size` bytes (1 to 4), the highest
 * first, in base64 (RFC 4648). Errors: BIS_NOMEM, and diag then names what. */
bis_status bis_page_numbers(bis_json *j, const char *key, const uint32_t *v, size_t n, int size, const char *what,
                            bis_diag *diag);
