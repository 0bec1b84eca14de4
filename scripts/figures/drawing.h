/* SPDX-License-Identifier: BSD-2-Clause */
/* drawing: a figure as JSON, for bisPlot.draw of docs/live/plot.js, which makes SVG of it (scripts/figures/draw.js):
 *
 *     {"width": W, "height": H, "items": [null, ITEM, ...]}
 *
 *     {"box": [x, y, width, height], "fill": C}
 *     {"line": [[x, y], ...], "width": thickness, "stroke": C}
 *     {"disc": [x, y, radius], "fill": C}        {"ring": [x, y, radius], "width": thickness, "stroke": C}
 *     {"text": T, "at": [x, y], "size": S, "anchor": "start", "middle" or "end", "fill": C}
 *     {"picture": T, "size": [width, height], "png": "data:..."}        {"show": T, "at": [x, y]}
 *
 * Places and sizes are in pixels; (0, 0) is the upper left corner, y points down. Colours C are "#rrggbb"; here they
 * are linear, as everywhere. All functions print at once, in the order of the calls: what comes later lies above. */
#ifndef DRAWING_H
#define DRAWING_H

#include "bis/base/image.h"

#include <stdio.h>

/* drawing_begin opens a drawing on white paper, drawing_end closes it. */
void drawing_begin(FILE *out, double width, double height);
void drawing_end(FILE *out);

void drawing_box(FILE *out, double x, double y, double width, double height, rgb colour);
void drawing_line(FILE *out, double x0, double y0, double x1, double y1, double thickness, rgb colour);
void drawing_disc(FILE *out, double x, double y, double radius, rgb colour);
void drawing_ring(FILE *out, double x, double y, double radius, double thickness, rgb colour);

/* drawing_curve draws straight lines through n points. */
void drawing_curve(FILE *out, const double *x, const double *y, int n, double thickness, rgb colour);

/* drawing_text prints text on the base line y; its left end, middle or right end is at x. size is the height of a
 * capital. What stands behind '^' is raised and what stands behind '`' is lowered, up to the next blank, comma or
 * closing parenthesis (10^-3, q`L). */
typedef enum drawing_end_at { DRAWING_LEFT, DRAWING_MIDDLE, DRAWING_RIGHT } drawing_end_at;
void drawing_text(FILE *out, double x, double y, double size, drawing_end_at at, rgb colour, const char *text);

/* drawing_picture puts a picture's pixels into the drawing, width x height units large, without showing it.
 * drawing_show shows the picture of that name with its upper left corner at (x, y), any number of times. Errors:
 * BIS_NOMEM. */
bis_status drawing_picture(FILE *out, const char *name, double width, double height, const bis_image *image,
                           bis_diag *diag);
void drawing_show(FILE *out, const char *name, double x, double y);

#endif
