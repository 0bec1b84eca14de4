/* canvas: drawing on a bis_image: boxes, lines, discs and text with smooth edges, for the figures of reports.
 *
 * Places are in pixels, (0, 0) the picture's upper left corner, y down; pixel (x, y) covers [x, x+1) x [y, y+1).
 * Whatever lies outside is cut off. */
#ifndef BIS_CANVAS_H
#define BIS_CANVAS_H

#include "bis/base/image.h"

void bis_canvas_blend(bis_image *image, int x, int y, rgb colour, double alpha);
void bis_canvas_box(bis_image *image, int x, int y, int width, int height, rgb colour);
void bis_canvas_line(bis_image *image, double x0, double y0, double x1, double y1, double thickness, rgb colour);
void bis_canvas_disc(bis_image *image, double x, double y, double radius, rgb colour);
void bis_canvas_ring(bis_image *image, double x, double y, double radius, double thickness, rgb colour);

/* Text on the base line y from x on; size: the height of a capital. Printable ASCII; what stands behind '^' is raised,
 * what stands behind '`' is lowered, up to the next blank, comma or parenthesis (10^-3, q`L). Returns its width. */
double bis_canvas_text(bis_image *image, double x, double y, double size, rgb colour, const char *text);

/* The same with its right end, or its middle, at x; with a halo around the letters, to be read on any ground. */
void bis_canvas_text_right(bis_image *image, double x, double y, double size, rgb colour, const char *text);
void bis_canvas_text_middle(bis_image *image, double x, double y, double size, rgb colour, const char *text);
void bis_canvas_text_halo(bis_image *image, double x, double y, double size, rgb colour, rgb halo, const char *text);

double bis_canvas_text_width(double size, const char *text);

#endif
