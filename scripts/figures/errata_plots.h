/* SPDX-License-Identifier: BSD-2-Clause */
/* errata_plots: the parts of the program that draws, for items of docs/errata.md without a switch, what is printed
 * beside what is right. "Right" comes from the library's own functions; "as printed" is a few lines beside them.
 * Nothing here returns an error: what cannot go on prints why and exits with 1. */
#ifndef ERRATA_PLOTS_H
#define ERRATA_PLOTS_H

#include "bis/base/image.h"
#include "bis/thesis/integrator.h"
#include "bis/thesis/envmap.h"
#include "bis/thesis/importance.h"

#include <stdio.h>

enum { ERRATA_WIDTH = 480, ERRATA_HEIGHT = 240, ERRATA_SEED = 34 };

/* ---- drawing (scripts/figures/errata_draw.c) ---- */

rgb errata_ink(void);
rgb errata_faint(void);
rgb errata_printed(void); /* orange: as printed */
rgb errata_right(void);   /* blue: right */
rgb errata_grey(double v); /* as it appears, 0 to 1 */

/* "as printed" and "right" over two halves of the picture, each with a line of its own below them (may be NULL). */
void errata_heads(FILE *svg, const char *printed, const char *right);

/* White pixels, to be filled; shown with their upper left corner at (x, y), and freed. */
bis_image errata_field(int width, int height);
void errata_show(FILE *svg, int x, int y, bis_image *field);

/* printf on a picture, with its left end or its middle at x. */
void errata_say(FILE *svg, double x, double y, rgb colour, const char *format, ...) __attribute__((format(printf, 5, 6)));
void errata_say_middle(FILE *svg, double x, double y, rgb colour, const char *format, ...) __attribute__((format(printf, 5, 6)));

/* A plane with axes: the box of pixels (x, y, w, h) shows [x0, x1] x [y0, y1], in logarithms where asked for. */
typedef struct errata_plane {
    FILE *svg;
    double x, y, w, h, x0, x1, y0, y1;
    bool log_x, log_y;
} errata_plane;

/* Nearly the whole picture, with room for a line of words above; linear. */
errata_plane errata_plane_over(FILE *svg, double x0, double x1, double y0, double y1);

/* Axes with ticks, as in "1 10 1e2" (1e2 is written 10^2), and a name each. */
void errata_axes(const errata_plane *p, const char *x_name, const char *x_ticks, const char *y_name, const char *y_ticks);
double errata_x(const errata_plane *p, double x);
double errata_y(const errata_plane *p, double y);

/* A polygon through n points; a disc at each. What lies above or below the plane is cut off. */
void errata_line(const errata_plane *p, const double *x, const double *y, int n, rgb colour);
void errata_dots(const errata_plane *p, const double *x, const double *y, int n, rgb colour);

/* ---- a point under a map (scripts/figures/errata_point.c) ---- */

/* The map's radiance at pixel (x, y) of width x height. */
typedef rgb errata_paint(int x, int y, int width, int height);

void errata_map(bis_envmap *em, int width, int height, errata_paint *paint);
bis_light *errata_light(int width, int height, errata_paint *paint, bis_table_kind kind);

/* A point that sees the whole sky, or only that half of it where y < 0. */
typedef struct errata_spot {
    bis_accel accel; /* first: what bis_accel_occluded sees */
    bis_material material;
    bis_counters counters;
    bis_point pt;
} errata_spot;

/* Seen at `degrees` from the normal. s must stay where it is (pt points into it). */
void errata_spot_init(errata_spot *s, const bis_light *light, bis_material m, vec3 n, double degrees, bool half_hidden);

/* Mean and variance of r+g+b of `runs` independent estimates. */
typedef struct errata_moments {
    double mean, variance;
} errata_moments;

errata_moments errata_run(errata_spot *s, const bis_settings *settings, uint32_t runs);
void errata_check(bis_status status);

/* ---- the items ---- */

typedef void errata_plot(FILE *svg);

errata_plot errata_E1, errata_E2, errata_E4, errata_E5, errata_E17, errata_E18, errata_E19;           /* errata_maps.c */
errata_plot errata_E8, errata_E10, errata_E11, errata_E12, errata_E14, errata_E15;                                /* errata_tables.c */
errata_plot errata_E9, errata_E24, errata_E25, errata_E26, errata_E28, errata_E30, errata_E31, errata_E32;       /* errata_estimators.c */
errata_plot errata_E33, errata_E35, errata_E36, errata_E37;                                          /* errata_surfaces.c */

#endif
