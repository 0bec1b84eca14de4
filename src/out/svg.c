/* SPDX-License-Identifier: BSD-2-Clause */
/* svg: each shape is one element. Numbers have two decimals at most: a hundredth of a pixel. */
#include "svg.h"

#include "markup.h"

#include <stdlib.h>
#include <string.h>

/* Of a font without serifs, capitals are about .72 of its size high. */
static const double capital = 0.72;

static double cut(double v) { return round(100 * v) / 100; }

static unsigned srgb(float linear)
{
    const double v = fmin(fmax((double)linear, 0), 1);
    return (unsigned)lround(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055)); /* IEC 61966-2-1 */
}

/* ` NAME="#rrggbb"` */
static void put_colour(FILE *svg, const char *name, rgb c)
{
    fprintf(svg, " %s=\"#%02x%02x%02x\"", name, srgb(c.r), srgb(c.g), srgb(c.b));
}

static void put_pen(FILE *svg, double thickness, rgb colour)
{
    put_colour(svg, "stroke", colour);
    fprintf(svg, " stroke-width=\"%g\" fill=\"none\"/>\n", cut(thickness));
}

void bis_svg_begin(FILE *svg, double width, double height)
{
    fprintf(svg, "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%g\" height=\"%g\" viewBox=\"0 0 %g %g\" "
            "font-family=\"sans-serif\" stroke-linecap=\"round\" stroke-linejoin=\"round\" xml:space=\"preserve\">\n"
            "<rect width=\"100%%\" height=\"100%%\" fill=\"#ffffff\"/>\n", width, height, width, height);
}

void bis_svg_end(FILE *svg) { fputs("</svg>\n", svg); }

void bis_svg_box(FILE *svg, double x, double y, double width, double height, rgb colour)
{
    fprintf(svg, "<rect x=\"%g\" y=\"%g\" width=\"%g\" height=\"%g\"", cut(x), cut(y), cut(width), cut(height));
    put_colour(svg, "fill", colour);
    fputs("/>\n", svg);
}

void bis_svg_line(FILE *svg, double x0, double y0, double x1, double y1, double thickness, rgb colour)
{
    fprintf(svg, "<path d=\"M%g %gL%g %g\"", cut(x0), cut(y0), cut(x1), cut(y1));
    put_pen(svg, thickness, colour);
}

void bis_svg_curve(FILE *svg, const double *x, const double *y, int n, double thickness, rgb colour)
{
    fputs("<polyline points=\"", svg);
    for (int i = 0; i < n; i++) fprintf(svg, "%s%g,%g", i ? " " : "", cut(x[i]), cut(y[i]));
    fputs("\"", svg);
    put_pen(svg, thickness, colour);
}

static void put_circle(FILE *svg, double x, double y, double radius)
{
    fprintf(svg, "<circle cx=\"%g\" cy=\"%g\" r=\"%g\"", cut(x), cut(y), cut(radius));
}

void bis_svg_disc(FILE *svg, double x, double y, double radius, rgb colour)
{
    put_circle(svg, x, y, radius);
    put_colour(svg, "fill", colour);
    fputs("/>\n", svg);
}

void bis_svg_ring(FILE *svg, double x, double y, double radius, double thickness, rgb colour)
{
    put_circle(svg, x, y, radius);
    put_pen(svg, thickness, colour);
}

/* ---- text ---- */

/* A span is moved from the line of the one before it: `dy` adds up, and is the one shift that all browsers know. */
static void put_spans(FILE *svg, double size, const char *text)
{
    double lift = 0, before = 0;
    while (*text) {
        if (*text == '^' || *text == '`') {
            lift = *text++ == '^' ? 0.55 * size : -0.25 * size;
            continue;
        }
        if (strchr(" ,)", *text)) lift = 0;
        const size_t n = 1 + strcspn(text + 1, lift != 0 ? "^` ,)" : "^`");
        const bool is_span = lift != 0 || before != 0;
        if (is_span) fprintf(svg, "<tspan dy=\"%g\"", cut(before - lift));
        if (lift != 0) fprintf(svg, " font-size=\"%g\"", cut(0.7 * size / capital));
        if (is_span) fputs(">", svg);
        bis_markup_text(svg, text, n);
        if (is_span) fputs("</tspan>", svg);
        before = lift;
        text += n;
    }
}

static void put_text(FILE *svg, double x, double y, double size, bis_svg_end_at at, rgb colour, const rgb *ground,
                     const char *text)
{
    static const char *const anchors[] = {"", " text-anchor=\"middle\"", " text-anchor=\"end\""};
    fprintf(svg, "<text x=\"%g\" y=\"%g\" font-size=\"%g\"%s", cut(x), cut(y), cut(size / capital), anchors[at]);
    put_colour(svg, "fill", colour);
    if (ground) {
        put_colour(svg, "stroke", *ground);
        fputs(" stroke-width=\"4\" paint-order=\"stroke\"", svg);
    }
    fputs(">", svg);
    put_spans(svg, size, text);
    fputs("</text>\n", svg);
}

void bis_svg_text(FILE *svg, double x, double y, double size, bis_svg_end_at at, rgb colour, const char *text)
{
    put_text(svg, x, y, size, at, colour, NULL, text);
}

void bis_svg_text_on(FILE *svg, double x, double y, double size, bis_svg_end_at at, rgb colour, rgb ground,
                     const char *text)
{
    put_text(svg, x, y, size, at, colour, &ground, text);
}

/* ---- pictures ---- */

bis_status bis_svg_picture(FILE *svg, const char *name, double width, double height, const bis_image *image,
                           bis_diag *diag)
{
    char *png = bis_markup_png(image, 0, diag);
    if (!png) return BIS_NOMEM;
    fprintf(svg, "<defs><image id=\"%s\" width=\"%g\" height=\"%g\" preserveAspectRatio=\"none\" "
            "style=\"image-rendering:pixelated\" href=\"%s\"/></defs>\n", name, width, height, png);
    free(png);
    return BIS_OK;
}

void bis_svg_show(FILE *svg, const char *name, double x, double y)
{
    fprintf(svg, "<use href=\"#%s\" x=\"%g\" y=\"%g\"/>\n", name, cut(x), cut(y));
}
