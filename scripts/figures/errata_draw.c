/* SPDX-License-Identifier: BSD-2-Clause */
/* errata_draw: axes, lines and words of a drawing, for the pictures of docs/errata.md. */
#include "errata_plots.h"

#include "drawing.h"
#include "out/palette.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

static const double letters = 8; /* height of a capital, in pixels */

rgb errata_ink(void) { return bis_palette_srgb(0.12, 0.13, 0.16); }
rgb errata_faint(void) { return bis_palette_srgb(0.45, 0.47, 0.52); }
rgb errata_printed(void) { return bis_palette_srgb(0.85, 0.38, 0.04); }
rgb errata_right(void) { return bis_palette_srgb(0.13, 0.36, 0.72); }
rgb errata_grey(double v) { return bis_palette_srgb(v, v, v); }

void errata_heads(FILE *svg, const char *printed, const char *right)
{
    const double quarter = ERRATA_WIDTH / 4.0;

    drawing_text(svg, quarter, 16, 9, DRAWING_MIDDLE, errata_printed(), "as printed");
    drawing_text(svg, 3 * quarter, 16, 9, DRAWING_MIDDLE, errata_right(), "right");
    if (printed) drawing_text(svg, quarter, 31, letters, DRAWING_MIDDLE, errata_faint(), printed);
    if (right) drawing_text(svg, 3 * quarter, 31, letters, DRAWING_MIDDLE, errata_faint(), right);
}

void errata_say(FILE *svg, double x, double y, rgb colour, const char *format, ...)
{
    char text[160];
    va_list args;

    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    drawing_text(svg, x, y, letters, DRAWING_LEFT, colour, text);
}

void errata_say_middle(FILE *svg, double x, double y, rgb colour, const char *format, ...)
{
    char text[160];
    va_list args;

    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    drawing_text(svg, x, y, letters, DRAWING_MIDDLE, colour, text);
}

bis_image errata_field(int width, int height)
{
    bis_image field;

    errata_check(bis_image_init(&field, width, height, NULL));
    for (int i = 0; i < width * height; i++) field.pixels[i] = errata_grey(1);
    return field;
}

void errata_show(FILE *svg, int x, int y, bis_image *field)
{
    char name[32];

    snprintf(name, sizeof name, "at-%d-%d", x, y);
    errata_check(drawing_picture(svg, name, field->width, field->height, field, NULL));
    drawing_show(svg, name, x, y);
    bis_image_clear(field);
}

errata_plane errata_plane_over(FILE *svg, double x0, double x1, double y0, double y1)
{
    return (errata_plane){svg, 46, 30, ERRATA_WIDTH - 66, ERRATA_HEIGHT - 66, x0, x1, y0, y1, false, false};
}

static double share(double v, double v0, double v1, bool in_log)
{
    return in_log ? log(v / v0) / log(v1 / v0) : (v - v0) / (v1 - v0);
}

double errata_x(const errata_plane *p, double x) { return p->x + p->w * share(x, p->x0, p->x1, p->log_x); }
double errata_y(const errata_plane *p, double y) { return p->y + p->h * (1 - share(y, p->y0, p->y1, p->log_y)); }

/* The next number of *ticks and how to write it; false at the end. */
static bool next_tick(const char **ticks, double *value, char text[16])
{
    char *end;
    int exponent;

    *value = strtod(*ticks, &end);
    if (end == *ticks) return false;
    while (**ticks == ' ') (*ticks)++;
    if (sscanf(*ticks, "1e%d", &exponent) == 1)
        snprintf(text, 16, "10^%d", exponent);
    else
        snprintf(text, 16, "%.*s", (int)(end - *ticks), *ticks);
    *ticks = end;
    return true;
}

void errata_axes(const errata_plane *p, const char *x_name, const char *x_ticks, const char *y_name, const char *y_ticks)
{
    const double bottom = p->y + p->h;
    char text[16];
    double v;

    while (next_tick(&x_ticks, &v, text)) {
        drawing_line(p->svg, errata_x(p, v), p->y, errata_x(p, v), bottom, 1, errata_grey(0.9));
        drawing_text(p->svg, errata_x(p, v), bottom + 14, letters, DRAWING_MIDDLE, errata_faint(), text);
    }
    while (next_tick(&y_ticks, &v, text)) {
        drawing_line(p->svg, p->x, errata_y(p, v), p->x + p->w, errata_y(p, v), 1, errata_grey(0.9));
        drawing_text(p->svg, p->x - 5, errata_y(p, v) + 4, letters, DRAWING_RIGHT, errata_faint(), text);
    }
    drawing_line(p->svg, p->x, bottom, p->x + p->w, bottom, 1.2, errata_ink());
    drawing_line(p->svg, p->x, p->y, p->x, bottom, 1.2, errata_ink());
    drawing_text(p->svg, p->x + p->w, bottom + 29, letters, DRAWING_RIGHT, errata_ink(), x_name);
    drawing_text(p->svg, 6, p->y - 12, letters, DRAWING_LEFT, errata_ink(), y_name);
}

void errata_line(const errata_plane *p, const double *x, const double *y, int n, rgb colour)
{
    for (int i = 1; i < n; i++) {
        const double xa = errata_x(p, x[i - 1]), ya = errata_y(p, y[i - 1]), xb = errata_x(p, x[i]), yb = errata_y(p, y[i]);
        double a = 0, b = 1; /* the part of the way from one point to the next that lies inside */
        if (ya != yb) {
            const double top = (p->y - ya) / (yb - ya), bottom = (p->y + p->h - ya) / (yb - ya);
            a = fmax(0, fmin(top, bottom)), b = fmin(1, fmax(top, bottom));
        }
        if (a < b) drawing_line(p->svg, xa + a * (xb - xa), ya + a * (yb - ya), xa + b * (xb - xa), ya + b * (yb - ya), 2, colour);
    }
}

void errata_dots(const errata_plane *p, const double *x, const double *y, int n, rgb colour)
{
    for (int i = 0; i < n; i++) {
        if (y[i] >= p->y0 && y[i] <= p->y1) drawing_disc(p->svg, errata_x(p, x[i]), errata_y(p, y[i]), 3, colour);
    }
}
