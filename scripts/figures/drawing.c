/* SPDX-License-Identifier: BSD-2-Clause */
/* drawing: each shape is one item of the list. Nothing is kept between calls: a comma stands before each item. */
#include "drawing.h"

#include "out/json.h"
#include "out/page.h"

#include <math.h>
#include <stdlib.h>

static unsigned srgb(float linear)
{
    const double v = fmin(fmax((double)linear, 0), 1);
    return (unsigned)lround(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055)); /* IEC 61966-2-1 */
}

static bis_json begin_item(FILE *out)
{
    bis_json j = {.out = out};
    fputs(",\n", out);
    bis_json_open(&j, NULL, '{');
    return j;
}

static void put_numbers(bis_json *j, const char *key, const double *v, int n)
{
    bis_json_open(j, key, '[');
    for (int i = 0; i < n; i++) bis_json_number(j, NULL, v[i]);
    bis_json_close(j);
}

static void put_colour(bis_json *j, const char *key, rgb c)
{
    char text[8];
    snprintf(text, sizeof text, "#%02x%02x%02x", srgb(c.r), srgb(c.g), srgb(c.b));
    bis_json_text(j, key, text);
}

void drawing_begin(FILE *out, double width, double height)
{
    fprintf(out, "{\"width\": %g, \"height\": %g, \"items\": [null", width, height);
}

void drawing_end(FILE *out) { fputs("]}\n", out); }

void drawing_box(FILE *out, double x, double y, double width, double height, rgb colour)
{
    bis_json j = begin_item(out);
    put_numbers(&j, "box", (const double[]){x, y, width, height}, 4);
    put_colour(&j, "fill", colour);
    bis_json_close(&j);
}

void drawing_curve(FILE *out, const double *x, const double *y, int n, double thickness, rgb colour)
{
    bis_json j = begin_item(out);
    bis_json_open(&j, "line", '[');
    for (int i = 0; i < n; i++) put_numbers(&j, NULL, (const double[]){x[i], y[i]}, 2);
    bis_json_close(&j);
    bis_json_number(&j, "width", thickness);
    put_colour(&j, "stroke", colour);
    bis_json_close(&j);
}

void drawing_line(FILE *out, double x0, double y0, double x1, double y1, double thickness, rgb colour)
{
    drawing_curve(out, (const double[]){x0, x1}, (const double[]){y0, y1}, 2, thickness, colour);
}

void drawing_disc(FILE *out, double x, double y, double radius, rgb colour)
{
    bis_json j = begin_item(out);
    put_numbers(&j, "disc", (const double[]){x, y, radius}, 3);
    put_colour(&j, "fill", colour);
    bis_json_close(&j);
}

void drawing_ring(FILE *out, double x, double y, double radius, double thickness, rgb colour)
{
    bis_json j = begin_item(out);
    put_numbers(&j, "ring", (const double[]){x, y, radius}, 3);
    bis_json_number(&j, "width", thickness);
    put_colour(&j, "stroke", colour);
    bis_json_close(&j);
}

void drawing_text(FILE *out, double x, double y, double size, drawing_end_at at, rgb colour, const char *text)
{
    static const char *const anchors[] = {"start", "middle", "end"};
    bis_json j = begin_item(out);
    bis_json_text(&j, "text", text);
    put_numbers(&j, "at", (const double[]){x, y}, 2);
    bis_json_number(&j, "size", size);
    bis_json_text(&j, "anchor", anchors[at]);
    put_colour(&j, "fill", colour);
    bis_json_close(&j);
}

bis_status drawing_picture(FILE *out, const char *name, double width, double height, const bis_image *image,
                           bis_diag *diag)
{
    char *png = bis_page_png(image, 0, diag);
    if (!png) return BIS_NOMEM;
    bis_json j = begin_item(out);
    bis_json_text(&j, "picture", name);
    put_numbers(&j, "size", (const double[]){width, height}, 2);
    bis_json_text(&j, "png", png);
    bis_json_close(&j);
    free(png);
    return BIS_OK;
}

void drawing_show(FILE *out, const char *name, double x, double y)
{
    bis_json j = begin_item(out);
    bis_json_text(&j, "show", name);
    put_numbers(&j, "at", (const double[]){x, y}, 2);
    bis_json_close(&j);
}
