/* trade_plot: error over time, or over rays, both logarithmic, as SVG that stands in the page.
 *
 * A method of rate n^-1/2 is a straight line of slope -1/2. The best setting of each integrator is drawn in its colour,
 * with error bars from the seeds and its name at the end; all others are thin, in the same colour; the line below all
 * of them is the Pareto front. Colours are classes (trade_style.c), shapes of markers tell integrators apart without
 * them. What has no logarithm, a noise that the reference's own hides, is left out. */
#include "trade.h"

#include <string.h>

enum { WIDTH = 800, HEIGHT = 470, LEFT = 62, RIGHT = 172, TOP = 14, BOTTOM = 50, LABEL = 30 };

typedef struct axis {
    double lo, hi;     /* in values; */
    double from, to;   /* in the picture */
} axis;

typedef struct plot {
    FILE *out;
    const bis_trade *t;
    bool by_rays;
    axis x, y;
} plot;

static double place(const axis *a, double v) { return a->from + (a->to - a->from) * log(v / a->lo) / log(a->hi / a->lo); }

static double x_of(const plot *p, const bis_trade_point *q)
{
    const bis_image *any = &p->t->both.image;
    const double pixels = (double)any->width * any->height;
    return p->by_rays ? (q->camera_rays + q->shadow_rays) / pixels : q->seconds;
}

static double y_of(const bis_trade_point *q) { return sqrt(q->noise); }
static bool is_shown(const bis_trade_point *q) { return q->noise > 0 && q->seconds > 0; }

/* ---- axes ---- */

static void widen(axis *a, double v)
{
    a->lo = fmin(a->lo, v);
    a->hi = fmax(a->hi, v);
}

static void find_axes(plot *p)
{
    const bis_trade_result *r = &p->t->result;

    p->x = (axis){1e300, 0, LEFT, WIDTH - RIGHT};
    p->y = (axis){1e300, 0, HEIGHT - BOTTOM, TOP};
    for (int i = 0; i < r->n_points; i++) {
        if (!is_shown(&r->points[i])) continue;
        widen(&p->x, x_of(p, &r->points[i]));
        widen(&p->y, y_of(&r->points[i]));
    }
    p->x.lo /= 1.25, p->x.hi *= 1.25;
    p->y.lo /= 1.2, p->y.hi *= 1.2;
}

static void tick_text(char text[24], const plot *p, bool is_y, double v)
{
    if (is_y) bis_trade_percent(text, v);
    else if (p->by_rays) snprintf(text, 24, v >= 1e3 ? "%gk" : "%g", v >= 1e3 ? v / 1e3 : v);
    else bis_trade_duration(text, v);
}

static void draw_tick(const plot *p, bool is_y, double v, bool has_text)
{
    char text[24];
    const double at = place(is_y ? &p->y : &p->x, v);

    if (is_y) fprintf(p->out, "<path class=\"grid\" d=\"M%d %.1fH%d\"/>", LEFT, at, WIDTH - RIGHT);
    else fprintf(p->out, "<path class=\"grid\" d=\"M%.1f %dV%d\"/>", at, TOP, HEIGHT - BOTTOM);
    if (!has_text) return;
    tick_text(text, p, is_y, v);
    if (is_y) fprintf(p->out, "<text x=\"%d\" y=\"%.1f\" text-anchor=\"end\">%s</text>", LEFT - 8, at + 4, text);
    else fprintf(p->out, "<text x=\"%.1f\" y=\"%d\" text-anchor=\"middle\">%s</text>", at, HEIGHT - BOTTOM + 18, text);
}

/* 1, 2, 5 of each decade; figures at all of them, or at 1 alone where there are many. */
static void draw_ticks(const plot *p, bool is_y)
{
    const axis *a = is_y ? &p->y : &p->x;
    const double steps[3] = {1, 2, 5};
    const bool all = log10(a->hi / a->lo) < (is_y ? 3 : 2.6);

    for (int e = (int)floor(log10(a->lo)); e <= (int)ceil(log10(a->hi)); e++) {
        for (int k = 0; k < 3; k++) {
            const double v = steps[k] * pow(10, e);
            if (v >= a->lo && v <= a->hi) draw_tick(p, is_y, v, all || k == 0);
        }
    }
}

static void draw_axes(const plot *p)
{
    draw_ticks(p, false);
    draw_ticks(p, true);
    fprintf(p->out, "<path class=\"axis\" d=\"M%d %dV%dH%d\"/>", LEFT, TOP, HEIGHT - BOTTOM, WIDTH - RIGHT);
    fprintf(p->out, "<text class=\"title\" x=\"%d\" y=\"%d\" text-anchor=\"middle\">%s</text>", (LEFT + WIDTH - RIGHT) / 2, HEIGHT - 10,
            p->by_rays ? "rays for each pixel" : "render time");
    fprintf(p->out, "<text class=\"title\" transform=\"translate(14 %d) rotate(-90)\" text-anchor=\"middle\">relative error</text>", (TOP + HEIGHT - BOTTOM) / 2);
}

/* ---- curves ---- */

static void draw_line(const plot *p, const bis_trade_curve *c, const char *class)
{
    const bis_trade_point *q = p->t->result.points + c->first;
    char move = 'M';

    fprintf(p->out, "<path class=\"%s\" d=\"", class);
    for (int i = 0; i < c->n; i++) {
        if (!is_shown(&q[i])) continue;
        fprintf(p->out, "%c%.1f %.1f", move, place(&p->x, x_of(p, &q[i])), place(&p->y, y_of(&q[i])));
        move = 'L';
    }
    fputs(move == 'M' ? "M0 0\"/>" : "\"/>", p->out);
}

static void draw_marker(const plot *p, const char *integrator, double x, double y)
{
    if (strcmp(integrator, "em") == 0) fprintf(p->out, "<path d=\"M%.1f %.1fl5 9h-10z\"/>", x, y - 5.5);
    else if (strcmp(integrator, "brdf") == 0) fprintf(p->out, "<path d=\"M%.1f %.1fh8v8h-8z\"/>", x - 4, y - 4);
    else if (strcmp(integrator, "mis") == 0) fprintf(p->out, "<path d=\"M%.1f %.1fl5 5l-5 5l-5 -5z\"/>", x, y - 5);
    else if (strcmp(integrator, "rejection") == 0) fprintf(p->out, "<path d=\"M%.1f %.1fl5 -9h-10z\"/>", x, y + 5.5);
    else fprintf(p->out, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"4.3\"/>", x, y);
}

/* The standard error of the root is half the relative one of the square. */
static void draw_bar(const plot *p, const bis_trade_point *q)
{
    const double y = y_of(q), half = q->noise_se / (2 * y), x = place(&p->x, x_of(p, q));
    if (!(half > 0)) return;
    const double low = y - half > p->y.lo ? place(&p->y, y - half) : p->y.from;
    fprintf(p->out, "<path class=\"bar\" d=\"M%.1f %.1fV%.1fM%.1f %.1fh8M%.1f %.1fh8\"/>", x, place(&p->y, fmin(y + half, p->y.hi)), low, x - 4,
            place(&p->y, fmin(y + half, p->y.hi)), x - 4, low);
}

static void draw_points(const plot *p, int setting)
{
    const bis_trade_setting *s = &p->t->plan.settings[setting];
    const bis_trade_curve *c = &p->t->result.curves[setting];
    char error[24], time[24];

    for (int i = 0; i < c->n; i++) {
        const bis_trade_point *q = &p->t->result.points[c->first + i];
        if (!is_shown(q)) continue;
        draw_bar(p, q);
        fprintf(p->out, "<g><title>%s, %u pass%s: %s in %s</title>", s->name, (unsigned)q->passes, q->passes == 1 ? "" : "es",
                bis_trade_percent(error, y_of(q)), bis_trade_duration(time, q->seconds));
        draw_marker(p, s->settings.integrator->name, place(&p->x, x_of(p, q)), place(&p->y, y_of(q)));
        fputs("</g>", p->out);
    }
}

/* ---- labels ---- */

typedef struct label {
    int setting;
    double y, x; /* of the curve's end */
} label;

/* Names stand at the right, in the order of the ends, LABEL apart. */
static int place_labels(const plot *p, label *labels, const int *heads, int n)
{
    int count = 0;
    for (int i = 0; i < n; i++) {
        const bis_trade_curve *c = &p->t->result.curves[heads[i]];
        const bis_trade_point *q = &p->t->result.points[c->first + c->n - 1];
        if (!is_shown(q)) continue;
        const label l = {heads[i], place(&p->y, y_of(q)), place(&p->x, x_of(p, q))};
        int at = count++;
        for (; at > 0 && labels[at - 1].y > l.y; at--) labels[at] = labels[at - 1];
        labels[at] = l;
    }
    for (int i = 1; i < count; i++) labels[i].y = fmax(labels[i].y, labels[i - 1].y + LABEL);
    for (int i = count - 1; i >= 0; i--) labels[i].y = fmin(labels[i].y, HEIGHT - BOTTOM - 12 - LABEL * (count - 1 - i));
    return count;
}

static void draw_label(const plot *p, const label *l)
{
    const bis_trade_setting *s = &p->t->plan.settings[l->setting];
    const bis_trade_curve *c = &p->t->result.curves[l->setting];

    fprintf(p->out, "<text class=\"name k-%s\" x=\"%d\" y=\"%.1f\">%s</text>", s->settings.integrator->name, WIDTH - RIGHT + 12, l->y + 1, s->name);
    if (p->by_rays || isnan(c->slope)) return;
    fprintf(p->out, "<text class=\"note\" x=\"%d\" y=\"%.1f\">slope %s%.2f", WIDTH - RIGHT + 12, l->y + 14, c->slope < 0 ? "&#8722;" : "",
            fabs(c->slope));
    if (c->slope_se >= 0.005) fprintf(p->out, " &#177; %.2f", c->slope_se);
    fputs("</text>", p->out);
}

/* ---- what belongs to no setting ---- */

/* Through all points of the front that are shown, in the order of x. */
static void draw_front(const plot *p)
{
    const bis_trade_result *r = &p->t->result;
    double last = 0;
    char move = 'M';

    if (p->by_rays) return; /* the front is one of time */
    fputs("<path class=\"front\" d=\"", p->out);
    for (;;) {
        const bis_trade_point *next = NULL;
        for (int i = 0; i < r->n_points; i++) {
            const bis_trade_point *q = &r->points[i];
            if (q->on_front && is_shown(q) && q->seconds > last && (!next || q->seconds < next->seconds)) next = q;
        }
        if (!next) break;
        last = next->seconds;
        fprintf(p->out, "%c%.1f %.1f", move, place(&p->x, next->seconds), place(&p->y, y_of(next)));
        move = 'L';
    }
    fputs(move == 'M' ? "M0 0\"/>" : "\"/>", p->out);
}

static void draw_law(const plot *p)
{
    const double x0 = p->x.lo, x1 = p->x.hi;
    for (int e = -8; e <= 8; e++) { /* a family of lines of slope -1/2, a factor 4 in error apart */
        const double y0 = p->y.hi * pow(4, e), y1 = y0 * sqrt(x0 / x1);
        if (y0 <= p->y.lo || y1 >= p->y.hi) continue;
        const double from_y = fmin(y0, p->y.hi), to_y = fmax(y1, p->y.lo);
        fprintf(p->out, "<path class=\"law\" d=\"M%.1f %.1fL%.1f %.1f\"/>", place(&p->x, x0 * pow(y0 / from_y, 2)), place(&p->y, from_y),
                place(&p->x, x0 * pow(y0 / to_y, 2)), place(&p->y, to_y));
    }
}

/* The references' own noise, where it is in sight. */
static void draw_floor(const plot *p)
{
    const double floor = sqrt(p->t->both.relmse);
    if (!(floor > p->y.lo && floor < p->y.hi)) return;
    const double y = place(&p->y, floor);
    fprintf(p->out, "<path class=\"floor\" d=\"M%d %.1fH%d\"/><text class=\"note\" x=\"%d\" y=\"%.1f\">noise of the reference, subtracted</text>", LEFT, y,
            WIDTH - RIGHT, LEFT + 8, y - 5);
}

static bool is_among(const int *heads, int n, int setting)
{
    for (int i = 0; i < n; i++) {
        if (heads[i] == setting) return true;
    }
    return false;
}

void bis_trade_plot(FILE *out, const bis_trade *t, bool by_rays)
{
    plot p = {.out = out, .t = t, .by_rays = by_rays};
    int heads[BIS_TRADE_STRIP];
    label labels[BIS_TRADE_STRIP];
    const int n = bis_trade_heads(t, heads);

    find_axes(&p);
    if (!(p.x.hi > p.x.lo && p.y.hi > p.y.lo)) {
        fputs("<p class=\"empty\">No noise was measured: there is nothing to plot.</p>\n", out);
        return;
    }
    fprintf(out, "<svg viewBox=\"0 0 %d %d\" role=\"img\" aria-label=\"relative error over %s, both logarithmic\">\n", WIDTH, HEIGHT, by_rays ? "rays" : "render time");
    draw_law(&p);
    draw_axes(&p);
    draw_floor(&p);
    for (int i = 0; i < t->plan.n_settings; i++) {
        if (!t->result.curves[i].n || is_among(heads, n, i)) continue;
        fprintf(out, "<g class=\"k-%s minor\"><title>%s</title>", t->plan.settings[i].settings.integrator->name, t->plan.settings[i].name);
        draw_line(&p, &t->result.curves[i], "curve");
        fputs("</g>\n", out);
    }
    draw_front(&p);
    for (int i = 0; i < n; i++) {
        fprintf(out, "<g class=\"k-%s major\">", t->plan.settings[heads[i]].settings.integrator->name);
        draw_line(&p, &t->result.curves[heads[i]], "curve");
        draw_points(&p, heads[i]);
        fputs("</g>\n", out);
    }
    const int n_labels = place_labels(&p, labels, heads, n);
    for (int i = 0; i < n_labels; i++) draw_label(&p, &labels[i]);
    fputs("</svg>\n", out);
}
