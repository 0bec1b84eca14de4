/* canvas: shapes by their distance. A pixel's coverage is how far its centre lies inside the shape, from half a pixel
 * outside (0) to half a pixel inside (1): right for straight edges along an axis, good to the eye for all others.
 * Letters are strokes of a round pen: of all strokes of a letter the nearest counts, so that they join without a seam.
 * Colours blend in linear light. */
#include "canvas.h"

#include <assert.h>
#include <float.h>
#include <string.h>

/* ---- shapes ---- */

void bis_canvas_blend(bis_image *image, int x, int y, rgb colour, double alpha)
{
    if (x < 0 || y < 0 || x >= image->width || y >= image->height || alpha <= 0) return;
    rgb *p = &image->pixels[(size_t)y * (size_t)image->width + (size_t)x];
    *p = rgb_add(rgb_scale(*p, 1 - fmin(alpha, 1)), rgb_scale(colour, fmin(alpha, 1)));
}

void bis_canvas_box(bis_image *image, int x, int y, int width, int height, rgb colour)
{
    for (int j = y; j < y + height; j++) {
        for (int i = x; i < x + width; i++) bis_canvas_blend(image, i, j, colour, 1);
    }
}

/* From (x0, y0) to (x1, y1); a point where these are equal. */
typedef struct segment {
    double x0, y0, x1, y1;
} segment;

static double distance(const segment *s, double x, double y)
{
    const double dx = s->x1 - s->x0, dy = s->y1 - s->y0, squared = dx * dx + dy * dy;
    const double t = squared > 0 ? fmin(fmax(((x - s->x0) * dx + (y - s->y0) * dy) / squared, 0), 1) : 0;
    return hypot(x - s->x0 - t * dx, y - s->y0 - t * dy);
}

/* A round pen of this thickness along all segments at once. */
static void draw_segments(bis_image *image, const segment *s, size_t n, double thickness, rgb colour)
{
    double left = DBL_MAX, right = -DBL_MAX, top = DBL_MAX, bottom = -DBL_MAX;
    for (size_t k = 0; k < n; k++) {
        left = fmin(left, fmin(s[k].x0, s[k].x1));
        right = fmax(right, fmax(s[k].x0, s[k].x1));
        top = fmin(top, fmin(s[k].y0, s[k].y1));
        bottom = fmax(bottom, fmax(s[k].y0, s[k].y1));
    }
    if (n == 0) return;
    const double reach = thickness / 2 + 1;
    const int x0 = (int)fmax(left - reach, 0), x1 = (int)fmin(right + reach, image->width - 1);
    const int y0 = (int)fmax(top - reach, 0), y1 = (int)fmin(bottom + reach, image->height - 1);
    for (int y = y0; y <= y1; y++) {
        for (int x = x0; x <= x1; x++) {
            double d = DBL_MAX;
            for (size_t k = 0; k < n; k++) d = fmin(d, distance(&s[k], x + 0.5, y + 0.5));
            bis_canvas_blend(image, x, y, colour, thickness / 2 + 0.5 - d);
        }
    }
}

void bis_canvas_line(bis_image *image, double x0, double y0, double x1, double y1, double thickness, rgb colour)
{
    draw_segments(image, &(segment){x0, y0, x1, y1}, 1, thickness, colour);
}

void bis_canvas_disc(bis_image *image, double x, double y, double radius, rgb colour)
{
    draw_segments(image, &(segment){x, y, x, y}, 1, 2 * radius, colour);
}

void bis_canvas_ring(bis_image *image, double x, double y, double radius, double thickness, rgb colour)
{
    const double reach = radius + thickness;
    for (int j = (int)floor(y - reach); j <= (int)ceil(y + reach); j++) {
        for (int i = (int)floor(x - reach); i <= (int)ceil(x + reach); i++) {
            const double d = fabs(hypot(i + 0.5 - x, j + 0.5 - y) - radius);
            bis_canvas_blend(image, i, j, colour, thickness / 2 + 0.5 - d);
        }
    }
}

/* ---- letters ---- */

/* A letter is a list of strokes, divided by blanks. The first character tells the kind: '/' corners joined by straight
 * lines, '~' a curve and '@' a closed curve, drawn by such corners (quadratic B-splines: they touch the middle of each
 * side). Each corner is two characters: x in units of a half as 0..9, A.., and y as a letter, d the base line, j the
 * height of x, m that of a capital, a the depth of p. */
static const char *const letters['~' - '!' + 1] = {
    ['!' - '!'] = "/1m1g /1d1e",
    ['"' - '!'] = "/0m0k /4m4k",
    ['%' - '!'] = "@0j4j4m0m /Am0d @6dAdAg6g",
    ['\'' - '!'] = "/0m0k",
    ['(' - '!'] = "~4n0k0e4b",
    [')' - '!'] = "~0n4k4e0b",
    ['*' - '!'] = "/2i8l /8i2l /5h5m",
    ['+' - '!'] = "/0gAg /5d5j",
    [',' - '!'] = "/2e0b",
    ['-' - '!'] = "/0g6g",
    ['.' - '!'] = "/0d0d",
    ['/' - '!'] = "/0c8n",
    ['0' - '!'] = "@0dAdAm0m",
    ['1' - '!'] = "/0k4m4d",
    ['2' - '!'] = "~0k0mAmAi0d /0dAd",
    ['3' - '!'] = "~0l0mAmAi4i ~4iBiBd0d0f",
    ['4' - '!'] = "/8d8m0fBf",
    ['5' - '!'] = "/9m1m0i ~0i1jAkAd0d0f",
    ['6' - '!'] = "@0dAdAj0j ~7m0l0g",
    ['7' - '!'] = "/0mAm3d",
    ['8' - '!'] = "@0dAdAi0i @1i9i9m1m",
    ['9' - '!'] = "@0gAgAm0m ~3dAeAj",
    [':' - '!'] = "/0d0d /0i0i",
    [';' - '!'] = "/2e0b /1i1i",
    ['<' - '!'] = "/8j0g8d",
    ['=' - '!'] = "/0fAf /0hAh",
    ['>' - '!'] = "/0j8g0d",
    ['?' - '!'] = "~0k0m9m9i4i4g /4d4d",
    ['A' - '!'] = "/0d6mCd /2gAg",
    ['B' - '!'] = "/5d0d0m5m ~5mBmBi5i /5i0i ~5iCiCd5d",
    ['C' - '!'] = "~BkAm0m0dAdBf",
    ['D' - '!'] = "/4d0d0m4m ~4mCmCd4d",
    ['E' - '!'] = "/Am0m0dAd /0i8i",
    ['F' - '!'] = "/Am0m0d /0i8i",
    ['G' - '!'] = "~BkAm0m0dBdBh /Bh6h",
    ['H' - '!'] = "/0m0d /AmAd /0iAi",
    ['I' - '!'] = "/0m0d",
    ['J' - '!'] = "/8m8g ~8g8d0d0g",
    ['K' - '!'] = "/0m0d /Am0g /4iAd",
    ['L' - '!'] = "/0m0d9d",
    ['M' - '!'] = "/0d0m6fCmCd",
    ['N' - '!'] = "/0d0mAdAm",
    ['O' - '!'] = "@0dCdCm0m",
    ['P' - '!'] = "/0d0m5m ~5mBmBh5h /5h0h",
    ['Q' - '!'] = "@0dCdCm0m /7fDc",
    ['R' - '!'] = "/0d0m5m ~5mBmBh5h /5h0h /5hBd",
    ['S' - '!'] = "~AkAm0m0iAiAd0d0f",
    ['T' - '!'] = "/0mCm /6m6d",
    ['U' - '!'] = "/0m0g ~0g0dAdAg /AgAm",
    ['V' - '!'] = "/0m6dCm",
    ['W' - '!'] = "/0m4d8mCdGm",
    ['X' - '!'] = "/0mAd /Am0d",
    ['Y' - '!'] = "/0m5iAm /5i5d",
    ['Z' - '!'] = "/0mAm0dAd",
    ['[' - '!'] = "/4n0n0b4b",
    [']' - '!'] = "/0n4n4b0b",
    ['_' - '!'] = "/0cAc",
    ['a' - '!'] = "@0dAdAj0j /AjAd",
    ['b' - '!'] = "@0dAdAj0j /0m0d",
    ['c' - '!'] = "~9i8j0j0d8d9e",
    ['d' - '!'] = "@0dAdAj0j /AmAd",
    ['e' - '!'] = "/0gAg ~AgAj0j0d8d9e",
    ['f' - '!'] = "~7m3m3j /3j3d /0j6j",
    ['g' - '!'] = "@0dAdAj0j /AjAd ~AdAa1a0b",
    ['h' - '!'] = "/0m0d ~0g0jAjAg /AgAd",
    ['i' - '!'] = "/0j0d /0m0m",
    ['j' - '!'] = "/4j4c ~4c4a0a /4m4m",
    ['k' - '!'] = "/0m0d /9j0f /3h9d",
    ['l' - '!'] = "/0m0d",
    ['m' - '!'] = "/0j0d ~0g0j8j8g /8g8d ~8g8jGjGg /GgGd",
    ['n' - '!'] = "/0j0d ~0g0jAjAg /AgAd",
    ['o' - '!'] = "@0dAdAj0j",
    ['p' - '!'] = "@0dAdAj0j /0j0a",
    ['q' - '!'] = "@0dAdAj0j /AjAa",
    ['r' - '!'] = "/0j0d ~0g1j4j6j",
    ['s' - '!'] = "~9i8j0j0gAgAd1d0e",
    ['t' - '!'] = "/3l3f ~3f3d7d /0j6j",
    ['u' - '!'] = "/0j0g ~0g0dAdAg /AjAd",
    ['v' - '!'] = "/0j5dAj",
    ['w' - '!'] = "/0j4d8jCdGj",
    ['x' - '!'] = "/0jAd /Aj0d",
    ['y' - '!'] = "/0j5d /Aj3a",
    ['z' - '!'] = "/0jAj0dAd",
    ['|' - '!'] = "/0n0a",
    ['~' - '!'] = "~0g3j6d9g",
};

enum { CAPITAL = 9, GAP_HALVES = 5, BLANK_HALVES = 8, STEPS = 6, MAX_CORNERS = 12, MAX_SEGMENTS = 128 };

typedef struct outline {
    segment s[MAX_SEGMENTS]; /* in units of the letter, base line at y = 0, y up */
    size_t n;
    double width;
} outline;

static double x_of(char c) { return (c <= '9' ? c - '0' : c - 'A' + 10) / 2.0; }

static void add_segment(outline *o, const double a[2], const double b[2])
{
    assert(o->n < MAX_SEGMENTS);
    o->s[o->n++] = (segment){a[0], a[1], b[0], b[1]};
}

/* The parabola from a to b whose tangents there meet in c. */
static void add_parabola(outline *o, const double a[2], const double c[2], const double b[2])
{
    double last[2] = {a[0], a[1]};
    for (int i = 1; i <= STEPS; i++) {
        const double t = (double)i / STEPS, s = 1 - t;
        const double p[2] = {s * s * a[0] + 2 * s * t * c[0] + t * t * b[0],
                             s * s * a[1] + 2 * s * t * c[1] + t * t * b[1]};
        add_segment(o, last, p);
        memcpy(last, p, sizeof last);
    }
}

static void add_curve(outline *o, double corner[][2], int n, bool closed)
{
    for (int i = closed ? 0 : 1; i < (closed ? n : n - 1); i++) {
        const double *before = corner[(i + n - 1) % n], *c = corner[i], *after = corner[(i + 1) % n];
        double a[2], b[2];
        for (int k = 0; k < 2; k++) {
            a[k] = !closed && i == 1 ? before[k] : (before[k] + c[k]) / 2;
            b[k] = !closed && i == n - 2 ? after[k] : (c[k] + after[k]) / 2;
        }
        add_parabola(o, a, c, b);
    }
}

/* One stroke; returns what follows it. */
static const char *add_stroke(outline *o, const char *text)
{
    double corner[MAX_CORNERS][2];
    const char kind = *text++;
    int n = 0;
    for (; *text && *text != ' '; text += 2) {
        assert(n < MAX_CORNERS);
        corner[n][0] = x_of(text[0]);
        corner[n][1] = text[1] - 'd';
        o->width = fmax(o->width, corner[n++][0]);
    }
    if (kind != '/') add_curve(o, corner, n, kind == '@');
    else if (n == 1) add_segment(o, corner[0], corner[0]);
    for (int i = 1; kind == '/' && i < n; i++) add_segment(o, corner[i - 1], corner[i]);
    return *text ? text + 1 : text;
}

/* What has no letter is a '?'. */
static void outline_of(outline *o, char c)
{
    *o = (outline){.n = 0};
    if (c == ' ') {
        o->width = (BLANK_HALVES - GAP_HALVES) / 2.0;
        return;
    }
    const char *text = c >= '!' && c <= '~' && letters[c - '!'] ? letters[c - '!'] : letters['?' - '!'];
    while (*text) text = add_stroke(o, text);
}

/* image NULL: the width alone. */
static double text_on(bis_image *image, double x, double y, double size, double pen, rgb colour, const char *text)
{
    const double start = x;
    double lift = 0; /* of exponents and indices */
    for (; *text; text++) {
        outline o;
        if (*text == '^' || *text == '`') {
            lift = *text == '^' ? 0.55 * size : -0.25 * size;
            continue;
        }
        if (*text == ' ' || *text == ',' || *text == ')') lift = 0;
        outline_of(&o, *text);
        const double unit = (lift != 0 ? 0.7 : 1) * size / CAPITAL, base = y - lift;
        for (size_t k = 0; k < o.n; k++) {
            o.s[k] =
                (segment){x + unit * o.s[k].x0, base - unit * o.s[k].y0, x + unit * o.s[k].x1, base - unit * o.s[k].y1};
        }
        if (image) draw_segments(image, o.s, o.n, pen, colour);
        x += unit * (o.width + GAP_HALVES / 2.0);
    }
    return x - start;
}

static double pen_of(double size) { return fmax(size / 7.5, 1.25); }

double bis_canvas_text(bis_image *image, double x, double y, double size, rgb colour, const char *text)
{
    return text_on(image, x, y, size, pen_of(size), colour, text);
}

double bis_canvas_text_width(double size, const char *text)
{
    return text_on(NULL, 0, 0, size, 0, (rgb){0, 0, 0}, text);
}

void bis_canvas_text_right(bis_image *image, double x, double y, double size, rgb colour, const char *text)
{
    bis_canvas_text(image, x - bis_canvas_text_width(size, text), y, size, colour, text);
}

void bis_canvas_text_middle(bis_image *image, double x, double y, double size, rgb colour, const char *text)
{
    bis_canvas_text(image, x - bis_canvas_text_width(size, text) / 2, y, size, colour, text);
}

void bis_canvas_text_halo(bis_image *image, double x, double y, double size, rgb colour, rgb halo, const char *text)
{
    text_on(image, x, y, size, pen_of(size) + 4, halo, text);
    bis_canvas_text(image, x, y, size, colour, text);
}
