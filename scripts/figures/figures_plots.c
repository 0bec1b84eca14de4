/* SPDX-License-Identifier: BSD-2-Clause */
/* figures_plots: figures 3.3, 3.4, 3.8, 3.9, 4.3, 4.4 and 4.5 of the thesis. Nothing is drawn by hand: lists, tables,
 * directions and densities are those of the library, points are drawn by the same generator as the renderer's, and the
 * rates written beside them are counted or integrated. */
#include "figures.h"
#include "../bench/measure.h"

#include "bis/thesis/alias.h"
#include "bis/thesis/marsaglia.h"
#include "bis/thesis/phong.h"
#include "bis/thesis/rng.h"

#include "drawing.h"
#include "out/palette.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static rgb colour_of(int i)
{
    static const double c[4][3] = {{0.20, 0.38, 0.72}, {0.90, 0.50, 0.13}, {0.22, 0.58, 0.35}, {0.72, 0.22, 0.36}};
    return bis_palette_srgb(c[i][0], c[i][1], c[i][2]);
}

static rgb lighter(rgb c) { return rgb_add(rgb_scale(c, 0.65), rgb_from(0.35, 0.35, 0.35)); }
static rgb light(rgb c) { return rgb_add(rgb_scale(c, 0.35), rgb_from(0.65, 0.65, 0.65)); }

/* ---- 3.3, 3.4: P = {0.1, 0.2, 0.4, 0.3} ---- */

enum { ITEMS = 4 };
static const double P[ITEMS] = {0.1, 0.2, 0.4, 0.3};

static void number(FILE *svg, double x, double y, double size, rgb colour, const char *format, double v)
{
    char text[64];

    snprintf(text, sizeof text, format, v);
    drawing_text(svg, x, y, size, DRAWING_MIDDLE, colour, text);
}

static void bars(FILE *svg, int x0, int y0, double scale)
{
    for (int i = 0; i < ITEMS; i++) {
        const int h = (int)(P[i] * scale);
        drawing_box(svg, x0 + 60 * i, y0 - h, 48, h, colour_of(i));
        number(svg, x0 + 60 * i + 24, y0 - h - 6, 11, figures_ink(), "%.1f", P[i]);
        number(svg, x0 + 60 * i + 24, y0 + 20, 11, figures_ink(), "%.0f", i);
    }
    drawing_line(svg, x0 - 10, y0, x0 + 60 * ITEMS, y0, 1.5, figures_ink());
}

static void marsaglia(const char *folder)
{
    static const uint64_t w[ITEMS] = {1, 2, 4, 3};
    FILE *svg = figures_paper(folder, "3.3", 720, 260);
    bis_marsaglia m;
    bis_diag diag = {0};

    measure_check(bis_marsaglia_init(&m, w, ITEMS, &diag), &diag);
    drawing_text(svg, 30, 30, 12, DRAWING_LEFT, figures_ink(), "P");
    bars(svg, 40, 215, 380);
    drawing_text(svg, 330, 30, 12, DRAWING_LEFT, figures_ink(), "L: one integer in [1, 10] is one look-up");
    for (size_t i = 0; i < m.length; i++) {
        const int x = 330 + 37 * (int)i;
        drawing_box(svg, x, 110, 33, 60, colour_of((int)m.list[i]));
        number(svg, x + 16.5, 147, 14, bis_palette_srgb(1, 1, 1), "%.0f", m.list[i]);
        number(svg, x + 16.5, 192, 10, figures_faint(), "%.0f", (double)i + 1);
    }
    bis_marsaglia_clear(&m);
    figures_save(svg);
}

static void alias(const char *folder)
{
    FILE *svg = figures_paper(folder, "3.4", 660, 290);
    bis_alias a;
    bis_diag diag = {0};
    const int y0 = 240;
    const double scale = 440; /* no number touches the line */

    measure_check(bis_alias_init(&a, P, ITEMS, &diag), &diag);
    drawing_text(svg, 30, 30, 12, DRAWING_LEFT, figures_ink(), "P and the cutoff 1/N");
    bars(svg, 40, y0, scale);
    drawing_line(svg, 30, y0 - 0.25 * scale, 280, y0 - 0.25 * scale, 1.5, figures_faint());
    drawing_text(svg, 286, y0 - 0.25 * scale + 4, 10, DRAWING_LEFT, figures_faint(), "1/N");
    drawing_text(svg, 360, 30, 12, DRAWING_LEFT, figures_ink(), "prob (full) and alias (light)");
    for (int i = 0; i < ITEMS; i++) {
        const int x = 370 + 66 * i, full = 160, h = (int)lround(full * a.prob[i]);
        if (h < full) drawing_box(svg, x, y0 - full, 56, full - h, light(colour_of((int)a.alias[i])));
        drawing_box(svg, x, y0 - h, 56, h, colour_of(i));
        number(svg, x + 28, y0 - h / 2.0 + 5, 11, bis_palette_srgb(1, 1, 1), "%.1f", a.prob[i]);
        if (h < full) number(svg, x + 28, y0 - full + (full - h) / 2.0 + 5, 13, figures_ink(), "%.0f", a.alias[i]);
        number(svg, x + 28, y0 + 20, 11, figures_ink(), "%.0f", i);
    }
    bis_alias_clear(&a);
    figures_save(svg);
}

/* ---- 3.8, 3.9: Phong ---- */

static const vec3 up = {0, 0, 1};

static vec3 in_plane(double angle) { return vec3_from(sin(angle), 0, cos(angle)); }

/* f over the angle, in the plane of incidence, as a polar curve of largest radius 150. */
static void lobe(FILE *svg, double x, double y, double ks, double kd, double n, rgb colour, double scale)
{
    enum { N = 720 };
    const bis_material m = bis_phong(rgb_from(kd, kd, kd), rgb_from(ks, ks, ks), n);
    double px[N + 1], py[N + 1];
    bis_bsdf b;

    bis_bsdf_init(&b, &m, up, in_plane(-PI / 4));
    for (int i = 0; i <= N; i++) {
        const double angle = -PI / 2 + PI * i / N, r = scale * (double)bis_bsdf_f(&b, in_plane(angle)).r;
        px[i] = x + r * sin(angle);
        py[i] = y - r * cos(angle);
    }
    drawing_curve(svg, px, py, N + 1, 2, colour);
}

static void surface_with_axes(FILE *svg, double x, double y, double length)
{
    const double d = length * sqrt(0.5);

    drawing_line(svg, x - length, y, x + length, y, 2, figures_ink());
    drawing_line(svg, x, y, x, y - length, 1, figures_faint());
    drawing_line(svg, x, y, x - d, y - d, 1, figures_faint());
    drawing_line(svg, x, y, x + d, y - d, 1, figures_faint());
    drawing_text(svg, x - 4, y - length - 6, 11, DRAWING_LEFT, figures_faint(), "n");
    drawing_text(svg, x - d - 4, y - d, 11, DRAWING_RIGHT, figures_faint(), "eye");
    drawing_text(svg, x + 1.08 * d, y - 1.08 * d + 4, 11, DRAWING_LEFT, figures_faint(), "R");
}

static void phong(const char *folder)
{
    static const double n[3] = {5, 10, 20};
    FILE *svg = figures_paper(folder, "3.8", 560, 330);
    const double scale = 240 / (21 / (2 * PI));

    surface_with_axes(svg, 240, 290, 210);
    lobe(svg, 240, 290, 0, 1, 0, colour_of(0), scale);
    drawing_text(svg, 420, 60, 11, DRAWING_LEFT, colour_of(0), "diffuse: 1/pi");
    for (int i = 0; i < 3; i++) {
        char text[32];
        lobe(svg, 240, 290, 1, 0, n[i], colour_of(i + 1), scale);
        snprintf(text, sizeof text, "specular, n = %.0f", n[i]);
        drawing_text(svg, 420, 82 + 22 * i, 11, DRAWING_LEFT, colour_of(i + 1), text);
    }
    figures_save(svg);
}

/* Directions that the material draws, from above; those below the horizon are outside the circle's half of space
 * and counted. */
static void draws(FILE *svg, double x, double y, double ks, double kd, const char *title)
{
    enum { N = 300, RADIUS = 120 };
    const bis_material m = bis_phong(rgb_from(kd, kd, kd), rgb_from(ks, ks, ks), 50);
    int specular = 0, below = 0;
    char text[80];
    bis_bsdf b;
    bis_rng r;

    bis_bsdf_init(&b, &m, up, in_plane(-PI / 4));
    bis_rng_init(&r, 1, 0, 0, 0);
    drawing_ring(svg, x, y, RADIUS, 1.5, figures_ink());
    drawing_disc(svg, x, y, 2.5, figures_ink());
    for (int i = 0; i < N; i++) {
        const double u0 = bis_rng_double(&r), u1 = bis_rng_double(&r), u2 = bis_rng_double(&r);
        const bool is_specular = u0 < b.p_specular;
        vec3 wi;
        if (!bis_bsdf_sample(&b, u0, u1, u2, &wi)) continue;
        specular += is_specular;
        below += wi.z <= 0;
        if (wi.z > 0) drawing_disc(svg, x + RADIUS * (double)wi.x, y - RADIUS * (double)wi.y, 2.2, colour_of(is_specular ? 3 : 0));
    }
    drawing_text(svg, x, 32, 12, DRAWING_MIDDLE, figures_ink(), title);
    snprintf(text, sizeof text, "%d specular, %d diffuse, %d below", specular, N - specular, below);
    drawing_text(svg, x, 312, 9, DRAWING_MIDDLE, figures_faint(), text);
}

static void phong_draws(const char *folder)
{
    FILE *svg = figures_paper(folder, "3.9", 840, 330);

    draws(svg, 145, 170, 0, 1, "diffuse");
    draws(svg, 420, 170, 1, 0, "specular, n = 50");
    draws(svg, 695, 170, 0.5, 0.5, "k`s = k`d = 0.5");
    figures_save(svg);
}

/* ---- 4.3 to 4.5: one dimension, x in [0,1) ---- */

enum { X0 = 50, W = 620, H = 250, Y0 = 300 };

static double bump(double x, double centre, double width) { return exp(-0.5 * (x - centre) * (x - centre) / (width * width)); }

typedef double curve(double x);

/* A map: a wide light, two narrow ones, dark between. A BRDF: one broad lobe. */
static double map_light(double x) { return 0.15 + 1.6 * bump(x, 0.28, 0.07) + 3.2 * bump(x, 0.55, 0.018) + 2.4 * bump(x, 0.86, 0.015); }
static double brdf(double x) { return bump(x, 0.5, 0.16); }
static double product(double x) { return map_light(x) * brdf(x); }

static double integral(curve *f)
{
    enum { N = 20000 };
    double sum = 0;

    for (int i = 0; i < N; i++) sum += f((i + 0.5) / N) / N;
    return sum;
}

static double maximum(curve *f)
{
    double most = 0;

    for (int i = 0; i < 20000; i++) most = fmax(most, f((i + 0.5) / 20000));
    return most;
}

static double inverse(curve *f, double u)
{
    enum { N = 4000 };
    const double target = u * integral(f);
    double sum = 0;

    for (int i = 0; i < N; i++) {
        const double step = f((i + 0.5) / N) / N;
        if (sum + step > target) return (i + (target - sum) / step) / N;
        sum += step;
    }
    return 1;
}

static void plot(FILE *svg, curve *f, double factor, double top, double thickness, rgb colour)
{
    double x[W + 1], y[W + 1];

    for (int i = 0; i <= W; i++) {
        x[i] = X0 + i;
        y[i] = Y0 - H * f((double)i / W) * factor / top;
    }
    drawing_curve(svg, x, y, W + 1, thickness, colour);
}

static void axis(FILE *svg) { drawing_line(svg, X0, Y0, X0 + W, Y0, 1.5, figures_ink()); }

/* Candidates from f, accepted with probability product/(bound f). Returns the share that is. */
static double reject(FILE *svg, curve *f, double bound, double top, int n)
{
    int accepted = 0;
    bis_rng r;

    bis_rng_init(&r, 1, 0, 0, 0);
    for (int i = 0; i < n; i++) {
        const double x = inverse(f, bis_rng_double(&r)), y = bis_rng_double(&r) * bound * f(x);
        const bool accept = y < product(x);
        accepted += accept;
        drawing_disc(svg, X0 + W * x, Y0 - H * y / top, 2, accept ? colour_of(2) : lighter(colour_of(3)));
    }
    return (double)accepted / n;
}

static void rejection(const char *folder)
{
    enum { N = 500 };
    FILE *svg = figures_paper(folder, "4.3", 720, 350);
    const double bound = maximum(brdf), top = 1.05 * bound * maximum(map_light), rate = reject(svg, map_light, bound, top, N);
    char text[128];

    plot(svg, map_light, bound, top, 2, figures_faint());
    plot(svg, product, 1, top, 2.5, colour_of(2));
    axis(svg);
    drawing_text(svg, X0, 24, 11, DRAWING_LEFT, figures_faint(), "c q(x)");
    drawing_text(svg, X0 + 60, 24, 11, DRAWING_LEFT, colour_of(2), "p(x)");
    snprintf(text, sizeof text, "%.0f%% of %d candidates accepted; integrated: %.0f%%", 100 * rate, N, 100 * integral(product) / (bound * integral(map_light)));
    drawing_text(svg, X0 + 120, 24, 11, DRAWING_LEFT, figures_ink(), text);
    figures_save(svg);
}

static void bounds(const char *folder)
{
    FILE *svg = figures_paper(folder, "4.4", 720, 350);
    const double f_max = maximum(brdf), L_max = maximum(map_light), top = 1.02 * fmax(f_max * L_max, L_max * f_max), p = integral(product);
    char text[128];

    plot(svg, brdf, L_max, top, 2, colour_of(3));
    plot(svg, map_light, f_max, top, 2, colour_of(0));
    plot(svg, product, 1, top, 2.5, colour_of(2));
    axis(svg);
    snprintf(text, sizeof text, "L`max f: %.0f%% accepted", 100 * p / (L_max * integral(brdf)));
    drawing_text(svg, X0, 24, 11, DRAWING_LEFT, colour_of(3), text);
    snprintf(text, sizeof text, "f`max L: %.0f%% accepted", 100 * p / (f_max * integral(map_light)));
    drawing_text(svg, X0 + 230, 24, 11, DRAWING_LEFT, colour_of(0), text);
    drawing_text(svg, X0 + 460, 24, 11, DRAWING_LEFT, colour_of(2), "f L");
    figures_save(svg);
}

/* M from the BRDF, the area of a disc by its weight L; N = 6 marks on the running sum of the weights. */
static void resampling(const char *folder)
{
    enum { M = 40, N = 6 };
    FILE *svg = figures_paper(folder, "4.5", 720, 350);
    const double top = 1.02 * fmax(maximum(product), 1);
    double x[M], w[M], sum = 0, at = 0;
    int chosen = 0;
    bis_rng r;

    bis_rng_init(&r, 2, 0, 0, 0);
    for (int i = 0; i < M; i++) {
        x[i] = inverse(brdf, (i + bis_rng_double(&r)) / M);
        w[i] = map_light(x[i]);
        sum += w[i];
    }
    plot(svg, brdf, 1, top, 2, figures_faint());
    plot(svg, product, 1, top, 2.5, colour_of(2));
    axis(svg);
    double mark = bis_rng_double(&r) * sum / N;
    for (int i = 0; i < M; i++) {
        int times = 0;
        for (at += w[i]; mark < at; mark += sum / N) times++;
        chosen += times;
        drawing_disc(svg, X0 + W * x[i], Y0 + 20, 2.2 * sqrt(w[i]), times ? colour_of(3) : colour_of(0));
        if (times) drawing_line(svg, X0 + W * x[i], Y0 + 12, X0 + W * x[i], Y0 - H * product(x[i]) / top, 1.5, colour_of(3));
    }
    char text[128];
    snprintf(text, sizeof text, "%d candidates from q`f, areas by weight; %d chosen for rays", M, chosen);
    drawing_text(svg, X0, 24, 11, DRAWING_LEFT, figures_ink(), text);
    drawing_text(svg, X0 + 480, 24, 11, DRAWING_LEFT, figures_faint(), "q`f");
    drawing_text(svg, X0 + 530, 24, 11, DRAWING_LEFT, colour_of(2), "f L");
    figures_save(svg);
}

void figures_plots(const char *folder)
{
    marsaglia(folder);
    alias(folder);
    phong(folder);
    phong_draws(folder);
    rejection(folder);
    bounds(folder);
    resampling(folder);
}
