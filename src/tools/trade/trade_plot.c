/* SPDX-License-Identifier: BSD-2-Clause */
/* trade_plot: where everything stands in the plots of error over time, or over rays, both logarithmic.
 *
 * A method of rate n^-1/2 is a straight line of slope -1/2. The best setting of each integrator is drawn in its colour,
 * with error bars from the seeds and its name at the end; all others are thin, in the same colour; the broad line below
 * all of them is the Pareto front. Markers have shapes, too, so that integrators can be told apart without colours.
 * What has no logarithm, because the reference's own noise hides it, is left out. page.html draws the axes' lines: the
 * numbers below are those of its picture. */
#include "base/text.h"
#include "trade_page.h"

#include <string.h>

enum { LEFT = 62, RIGHT = 628, TOP = 14, BOTTOM = 420, LABEL = 30 };

typedef struct axis {
    double lo, hi;   /* in values */
    double from, to; /* in the picture */
} axis;

typedef struct plot {
    bis_json *j;
    const bis_trade *t;
    bool by_rays;
    axis x, y;
} plot;

static double place(const axis *a, double v)
{
    return a->from + (a->to - a->from) * log(v / a->lo) / log(a->hi / a->lo);
}

static double x_of(const plot *p, const bis_trade_point *q)
{
    const bis_image *any = &p->t->both.image;
    const double pixels = (double)any->width * any->height;
    return p->by_rays ? (q->camera_rays + q->shadow_rays) / pixels : q->seconds;
}

static double y_of(const bis_trade_point *q) { return sqrt(q->noise); }
static bool is_shown(const bis_trade_point *q) { return q->noise > 0 && q->seconds > 0; }

/* ---- axes ---- */

static void find_axes(plot *p)
{
    const bis_trade_result *r = &p->t->result;

    p->x = (axis){1e300, 0, LEFT, RIGHT};
    p->y = (axis){1e300, 0, BOTTOM, TOP};
    for (int i = 0; i < r->n_points; i++) {
        if (!is_shown(&r->points[i])) continue;
        const double x = x_of(p, &r->points[i]), y = y_of(&r->points[i]);
        p->x = (axis){fmin(p->x.lo, x), fmax(p->x.hi, x), LEFT, RIGHT};
        p->y = (axis){fmin(p->y.lo, y), fmax(p->y.hi, y), BOTTOM, TOP};
    }
    p->x.lo /= 1.25, p->x.hi *= 1.25;
    p->y.lo /= 1.2, p->y.hi *= 1.2;
}

static const char *tick_text(char text[24], const plot *p, bool is_y, double v)
{
    if (is_y) return bis_percent(text, v);
    if (!p->by_rays) return bis_duration(text, v);
    snprintf(text, 24, v >= 1e3 ? "%gk" : "%g", v >= 1e3 ? v / 1e3 : v);
    return text;
}

/* 1, 2, 5 of each decade; figures at all of them, or at 1 alone where there are many. */
static void put_ticks(const plot *p, bool is_y)
{
    const axis *a = is_y ? &p->y : &p->x;
    const double steps[3] = {1, 2, 5};
    const bool all = log10(a->hi / a->lo) < (is_y ? 3 : 2.6);
    char text[24];

    bis_json_open(p->j, is_y ? "y_ticks" : "x_ticks", '[');
    for (int i = 3 * (int)floor(log10(a->lo)); i < 3 * (int)ceil(log10(a->hi)) + 3; i++) {
        const double v = steps[(i % 3 + 3) % 3] * pow(10, floor(i / 3.0));
        if (v < a->lo || v > a->hi) continue;
        bis_trade_say_all(p->j, NULL, "at=%.1f; text_at=%.1f; text=%s", place(a, v), place(a, v) + 4,
                          all || i % 3 == 0 ? tick_text(text, p, is_y, v) : "");
    }
    bis_json_close(p->j);
}

/* ---- curves ---- */

/* "x,y x,y" */
typedef struct points {
    char text[BIS_TRADE_SETTINGS * BIS_TRADE_LEVELS * 24];
    size_t n;
} points;

static void add_point(points *list, const plot *p, const bis_trade_point *q)
{
    if (!is_shown(q)) return;
    list->n += (size_t)snprintf(list->text + list->n, sizeof list->text - list->n, " %.1f,%.1f",
                                place(&p->x, x_of(p, q)), place(&p->y, y_of(q)));
}

static const char *shape_of(const char *integrator)
{
    if (strcmp(integrator, "em") == 0) return "m0 -5.5l5 9h-10z";
    if (strcmp(integrator, "brdf") == 0) return "m-4 -4h8v8h-8z";
    if (strcmp(integrator, "mis") == 0) return "m0 -5l5 5l-5 5l-5 -5z";
    if (strcmp(integrator, "rejection") == 0) return "m0 5.5l5 -9h-10z";
    return "m-4.3 0a4.3 4.3 0 1 0 8.6 0a4.3 4.3 0 1 0 -8.6 0";
}

/* The standard error of the root is half the relative one of the square. */
static void put_bar(const plot *p, const bis_trade_point *q)
{
    const double y = y_of(q), half = q->noise_se / (2 * y);
    if (half > 0)
        bis_trade_say_all(p->j, "bar", "x=%.1f; top=%.1f; bottom=%.1f", place(&p->x, x_of(p, q)),
                          place(&p->y, fmin(y + half, p->y.hi)), place(&p->y, fmax(y - half, p->y.lo)));
    else bis_json_null(p->j, "bar");
}

static void put_mark(const plot *p, const bis_trade_setting *s, const bis_trade_point *q)
{
    char error[24], time[24];

    bis_json_open(p->j, NULL, '{');
    put_bar(p, q);
    bis_trade_say(p->j, "title=%s, %u pass%s: %s in %s; x=%.1f; y=%.1f; shape=%s", s->name, (unsigned)q->passes,
                  q->passes == 1 ? "" : "es", bis_percent(error, y_of(q)), bis_duration(time, q->seconds),
                  place(&p->x, x_of(p, q)), place(&p->y, y_of(q)), shape_of(s->settings.integrator->name));
    bis_json_close(p->j);
}

static void put_curve(const plot *p, int setting)
{
    const bis_trade_setting *s = &p->t->plan.settings[setting];
    const bis_trade_curve *c = &p->t->result.curves[setting];
    const bis_trade_point *q = p->t->result.points + c->first;
    points line = {.n = 0};

    bis_json_open(p->j, NULL, '{');
    bis_trade_put_name(p->j, s);
    for (int i = 0; i < c->n; i++) add_point(&line, p, &q[i]);
    bis_json_text(p->j, "points", line.text);
    bis_json_open(p->j, "marks", '[');
    for (int i = 0; i < c->n; i++)
        if (is_shown(&q[i])) put_mark(p, s, &q[i]);
    bis_json_close(p->j);
    bis_json_close(p->j);
}

/* The heads, or all others that were measured. */
static void put_curves(const plot *p, bool major)
{
    bis_json_open(p->j, major ? "major" : "minor", '[');
    for (int i = 0; i < p->t->plan.n_settings; i++)
        if (p->t->result.curves[i].n && bis_trade_is_head(p->t, i) == major) put_curve(p, i);
    bis_json_close(p->j);
}

/* ---- labels ---- */

typedef struct label {
    int setting;
    double y; /* of the curve's end */
} label;

/* Names stand at the right, in the order of the ends, LABEL apart. */
static int place_labels(const plot *p, label *labels)
{
    int heads[BIS_TRADE_STRIP], count = 0;
    const int n = bis_trade_heads(p->t, heads);
    for (int i = 0; i < n; i++) {
        const bis_trade_curve *c = &p->t->result.curves[heads[i]];
        const bis_trade_point *q = &p->t->result.points[c->first + c->n - 1];
        if (!is_shown(q)) continue;
        const label l = {heads[i], place(&p->y, y_of(q))};
        int at = count++;
        for (; at > 0 && labels[at - 1].y > l.y; at--) labels[at] = labels[at - 1];
        labels[at] = l;
    }
    for (int i = 1; i < count; i++) labels[i].y = fmax(labels[i].y, labels[i - 1].y + LABEL);
    for (int i = count - 1; i >= 0; i--) labels[i].y = fmin(labels[i].y, BOTTOM - 12 - LABEL * (count - 1 - i));
    return count;
}

static void put_labels(const plot *p)
{
    label labels[BIS_TRADE_STRIP];
    const int count = place_labels(p, labels);

    bis_json_open(p->j, "labels", '[');
    for (int i = 0; i < count; i++) {
        const bis_trade_curve *c = &p->t->result.curves[labels[i].setting];
        char se[16] = "";
        if (c->slope_se >= 0.005) snprintf(se, sizeof se, " ± %.2f", c->slope_se);
        bis_json_open(p->j, NULL, '{');
        bis_trade_put_name(p->j, &p->t->plan.settings[labels[i].setting]);
        bis_trade_say(p->j, "y=%.1f; slope_at=%.1f", labels[i].y + 1, labels[i].y + 14);
        if (p->by_rays || isnan(c->slope)) bis_json_null(p->j, "slope");
        else bis_trade_say(p->j, "slope=%s%.2f%s", c->slope < 0 ? "−" : "", fabs(c->slope), se);
        bis_json_close(p->j);
    }
    bis_json_close(p->j);
}

/* ---- what belongs to no setting ---- */

/* Through all points of the front that are shown, in the order of time; none over rays, because the front is one of
 * time. */
static void put_front(const plot *p)
{
    points line = {.n = 0};
    for (const bis_trade_point *q = NULL; !p->by_rays && (q = bis_trade_next_on_front(&p->t->result, q));)
        add_point(&line, p, q);
    bis_json_text(p->j, "front", line.text);
}

/* A family of lines of slope -1/2, a factor 4 in error apart. */
static void put_laws(const plot *p)
{
    const double x0 = p->x.lo, x1 = p->x.hi;

    bis_json_open(p->j, "laws", '[');
    for (int e = -8; e <= 8; e++) {
        const double y0 = p->y.hi * pow(4, e), y1 = y0 * sqrt(x0 / x1);
        if (y0 <= p->y.lo || y1 >= p->y.hi) continue;
        const double from_y = fmin(y0, p->y.hi), to_y = fmax(y1, p->y.lo);
        bis_trade_say_all(p->j, NULL, "x0=%.1f; y0=%.1f; x1=%.1f; y1=%.1f", place(&p->x, x0 * pow(y0 / from_y, 2)),
                          place(&p->y, from_y), place(&p->x, x0 * pow(y0 / to_y, 2)), place(&p->y, to_y));
    }
    bis_json_close(p->j);
}

/* The references' own noise, where it is in sight. */
static void put_floor(const plot *p)
{
    const double floor = sqrt(p->t->both.relmse);
    const double y = place(&p->y, floor);
    if (floor > p->y.lo && floor < p->y.hi) bis_trade_say_all(p->j, "floor", "at=%.1f; text_at=%.1f", y, y - 5);
    else bis_json_null(p->j, "floor");
}

void bis_trade_put_plot(bis_json *j, const bis_trade *t, bool by_rays)
{
    plot p = {.j = j, .t = t, .by_rays = by_rays};
    find_axes(&p);
    bis_json_open(j, NULL, '{');
    bis_json_bool(j, "time", !by_rays);
    if (!(p.x.hi > p.x.lo && p.y.hi > p.y.lo)) {
        bis_json_null(j, "axes");
        bis_json_close(j);
        return;
    }
    bis_json_open(j, "axes", '{');
    bis_json_text(j, "over", by_rays ? "rays for each pixel" : "render time");
    put_laws(&p);
    put_ticks(&p, false);
    put_ticks(&p, true);
    put_floor(&p);
    put_curves(&p, false);
    put_front(&p);
    put_curves(&p, true);
    put_labels(&p);
    bis_json_close(j);
    bis_json_close(j);
}
