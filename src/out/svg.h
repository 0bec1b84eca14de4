/* SPDX-License-Identifier: BSD-2-Clause */
/* svg: a drawing as SVG 1.1 (and `href` of SVG 2): boxes, lines, discs, text, and pictures of pixels inside it. A
 * browser shows it and scales it; text is text, in the reader's own font.
 *
 * Places and sizes are in the drawing's units, pixels where it is shown as large as it is; (0, 0) is the upper left
 * corner, y points down. Colours are linear, as everywhere, and are written as sRGB. All functions print at once, in
 * the order of the calls: what comes later lies above. */
#pragma once

#include "bis/base/image.h"

#include <stdio.h>

/* bis_svg_begin opens a drawing on white paper, bis_svg_end closes it. */
void bis_svg_begin(FILE *svg, double width, double height);
void bis_svg_end(FILE *svg);

void bis_svg_box(FILE *svg, double x, double y, double width, double height, rgb colour);
void bis_svg_line(FILE *svg, double x0, double y0, double x1, double y1, double thickness, rgb colour);
void bis_svg_disc(FILE *svg, double x, double y, double radius, rgb colour);
void bis_svg_ring(FILE *svg, double x, double y, double radius, double thickness, rgb colour);

/* bis_svg_curve draws straight lines through n points. */
void bis_svg_curve(FILE *svg, const double *x, const double *y, int n, double thickness, rgb colour);

/* bis_svg_text prints text on the base line y; its left end, middle or right end is at x. size is the height of a
 * capital. What stands behind '^' is raised and what stands behind '`' is lowered, up to the next blank, comma or
 * closing parenthesis (10^-3, q`L). bis_svg_text_on draws an outline in colour ground below it, so that the text can be
 * read on a picture. */
typedef enum bis_svg_end_at { BIS_SVG_LEFT, BIS_SVG_MIDDLE, BIS_SVG_RIGHT } bis_svg_end_at;
void bis_svg_text(FILE *svg, double x, double y, double size, bis_svg_end_at at, rgb colour, const char *text);
void bis_svg_text_on(FILE *svg, double x, double y, double size, bis_svg_end_at at, rgb colour, rgb ground,
                     const char *text);

/* bis_svg_picture puts a picture's pixels into the drawing, width x height units large, without showing it.
 * bis_svg_show shows the picture of that name with its upper left corner at (x, y), any number of times. Errors:
 * BIS_NOMEM. */
bis_status bis_svg_picture(FILE *svg, const char *name, double width, double height, const bis_image *image,
                           bis_diag *diag);
void bis_svg_show(FILE *svg, const char *name, double x, double y);
