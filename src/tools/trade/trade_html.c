/* trade_html: the figures of the page: bars of cost x variance, the tables, the front; and how numbers are said. */
#include "trade.h"

#include <string.h>

void bis_trade_put_text(FILE *out, const char *text)
{
    for (const unsigned char *c = (const unsigned char *)text; *c; c++) {
        if (*c == '&') fputs("&amp;", out);
        else if (*c == '<') fputs("&lt;", out);
        else if (*c == '>') fputs("&gt;", out);
        else if (*c == '"') fputs("&quot;", out);
        else if (*c == '\'') fputs("&#39;", out);
        else if (*c < 0x20 || *c >= 0x7f) fputc('?', out); /* file names may hold any byte */
        else fputc(*c, out);
    }
}

const char *bis_trade_duration(char buf[24], double seconds)
{
    if (seconds < 0.0995) snprintf(buf, 24, "%.2g ms", 1e3 * seconds);
    else if (seconds < 9.95) snprintf(buf, 24, "%.2g s", seconds);
    else if (seconds < 99.5) snprintf(buf, 24, "%.0f s", seconds);
    else if (seconds < 5400) snprintf(buf, 24, "%.*f min", seconds < 597 ? 1 : 0, seconds / 60);
    else if (seconds < 48 * 3600) snprintf(buf, 24, "%.1f h", seconds / 3600);
    else snprintf(buf, 24, "%.3g days", seconds / 86400);
    return buf;
}

const char *bis_trade_percent(char buf[24], double v)
{
    const double p = 100 * v;
    if (p < 9.95) snprintf(buf, 24, "%.2g%%", p);
    else snprintf(buf, 24, "%.0f%%", p);
    return buf;
}

/* Measured settings in the order of cost x variance. */
static int by_cost(const bis_trade *t, int order[BIS_TRADE_SETTINGS])
{
    const bis_trade_curve *c = t->result.curves;
    int n = 0;

    for (int i = 0; i < t->plan.n_settings; i++) {
        if (!c[i].n) continue;
        int at = n++;
        for (; at > 0 && c[order[at - 1]].cost_variance > c[i].cost_variance; at--) order[at] = order[at - 1];
        order[at] = i;
    }
    return n;
}

static void put_name(FILE *out, const bis_trade_setting *s)
{
    bis_trade_put_text(out, s->name);
    if (s->is_scenes && !strstr(s->name, "own")) fputs(" <em>the scene&#39;s</em>", out);
    if (s->is_biased) fputs(" <em>biased</em>", out);
}

/* ---- bars ---- */

/* Length in percent of the longest, on a logarithmic scale that begins at half the best. */
static double length_of(double v, double best, double worst) { return 100 * log(2 * v / best) / log(2 * worst / best); }

void bis_trade_put_costs(FILE *out, const bis_trade *t)
{
    const bis_trade_curve *c = t->result.curves;
    int order[BIS_TRADE_SETTINGS];
    const int n = by_cost(t, order);
    double best = t->result.best >= 0 ? c[t->result.best].cost_variance : 0, worst = 0;

    for (int i = 0; i < n; i++) {
        worst = fmax(worst, c[order[i]].cost_variance);
        if (c[order[i]].cost_variance > 0) best = fmin(best, c[order[i]].cost_variance);
    }
    if (!(best > 0)) {
        fputs("<p class=\"empty\">No noise was measured: all methods are exact here.</p>\n", out);
        return;
    }
    fputs("<div class=\"bars\">\n", out);
    for (int i = 0; i < n; i++) {
        const bis_trade_setting *s = &t->plan.settings[order[i]];
        const double v = c[order[i]].cost_variance, se = c[order[i]].cost_variance_se, low = fmax(v - se, best / 2), high = fmin(v + se, worst);
        fprintf(out, "<div class=\"row k-%s%s\"><span>", s->settings.integrator->name, s->is_biased ? " biased" : "");
        put_name(out, s);
        fprintf(out, "</span><span class=\"track\"><i style=\"width:%.1f%%\"></i>", v > 0 ? fmax(length_of(v, best, worst), 0) : 0);
        if (se > 0 && high > low) {
            fprintf(out, "<b style=\"left:%.1f%%;width:%.1f%%\"></b>", length_of(low, best, worst), length_of(high, best, worst) - length_of(low, best, worst));
        }
        fprintf(out, "</span><span>%.*f&#215;</span></div>\n", v / best < 9.95 ? 1 : 0, v / best);
    }
    fputs("</div>\n", out);
}

/* ---- tables ---- */

static void open_table(FILE *out, const char *first) { fprintf(out, "<div class=\"scroll\"><table><thead><tr><th>%s</th>", first); }

/* The better, the stronger the colour: share 1 is the column's best. */
static void put_cell(FILE *out, const char *text, double strength, bool extrapolated)
{
    fprintf(out, "<td style=\"--s:%.0f%%\">%s%s</td>", 100 * fmin(fmax(strength, 0), 1), extrapolated ? "~" : "", text);
}

typedef double (*cell)(const bis_trade_result *r, const bis_trade_plan *plan, int setting, double at, bool *extrapolated);
typedef const char *(*words)(char buf[24], double v);

static double least_in(const bis_trade *t, cell value, double at)
{
    double least = 1e300;
    for (int i = 0; i < t->plan.n_settings; i++) {
        bool extrapolated;
        const double v = value(&t->result, &t->plan, i, at, &extrapolated);
        if (v < least) least = v;
    }
    return least;
}

static bool is_head(const bis_trade *t, int setting)
{
    int heads[BIS_TRADE_STRIP];
    const int n = bis_trade_heads(t, heads);
    for (int i = 0; i < n; i++) {
        if (heads[i] == setting) return true;
    }
    return false;
}

static void put_rows(FILE *out, const bis_trade *t, cell value, words say, const double *at, int n, bool all)
{
    int order[BIS_TRADE_SETTINGS];
    const int n_rows = by_cost(t, order);

    for (int i = 0; i < n_rows; i++) {
        if (!all && !is_head(t, order[i])) continue;
        fprintf(out, "<tr><th class=\"k-%s\">", t->plan.settings[order[i]].settings.integrator->name);
        put_name(out, &t->plan.settings[order[i]]);
        fputs("</th>", out);
        for (int k = 0; k < n; k++) {
            bool extrapolated;
            char text[24];
            const double v = value(&t->result, &t->plan, order[i], at[k], &extrapolated);
            if (isnan(v)) fputs("<td class=\"none\">&#8211;</td>", out);
            else put_cell(out, say(text, v), v > 0 ? 1 - log2(v / least_in(t, value, at[k])) / 2 : 1, extrapolated);
        }
        fputs("</tr>\n", out);
    }
    fputs("</tbody></table></div>\n", out);
}

static void put_table(FILE *out, const bis_trade *t, const char *corner, words say_column, const double *at, int n, cell value, words say, bool all)
{
    char text[24];
    open_table(out, corner);
    for (int k = 0; k < n; k++) fprintf(out, "<th>%s</th>", say_column(text, at[k]));
    fputs("</tr></thead><tbody>\n", out);
    put_rows(out, t, value, say, at, n, all);
}

/* The best of each integrator, and all of them for those who ask. */
static void put_tables(FILE *out, const bis_trade *t, const char *corner, words say_column, const double *at, int n, cell value, words say)
{
    put_table(out, t, corner, say_column, at, n, value, say, false);
    fputs("<details><summary>All settings</summary>\n", out);
    put_table(out, t, corner, say_column, at, n, value, say, true);
    fputs("</details>\n", out);
}

void bis_trade_put_equal_times(FILE *out, const bis_trade *t)
{
    double at[BIS_TRADE_COLUMNS];
    const int n = bis_trade_times(t, at);
    put_tables(out, t, "error after", bis_trade_duration, at, n, bis_trade_error_at, bis_trade_percent);
}

void bis_trade_put_equal_errors(FILE *out, const bis_trade *t)
{
    double at[BIS_TRADE_COLUMNS], descending[BIS_TRADE_COLUMNS];
    const int n = bis_trade_errors(t, at);
    for (int k = 0; k < n; k++) descending[k] = at[n - 1 - k];
    put_tables(out, t, "time to an error of", bis_trade_percent, descending, n, bis_trade_seconds_to, bis_trade_duration);
}

/* ---- the front ---- */

void bis_trade_put_front(FILE *out, const bis_trade *t)
{
    const bis_trade_result *r = &t->result;
    const bis_trade_point *last = NULL;
    char time[24], error[24], bias[24];

    fputs("<div class=\"scroll\"><table><thead><tr><th>setting</th><th>passes</th><th>time</th><th>error</th><th>bias</th></tr></thead><tbody>\n", out);
    for (;;) {
        const bis_trade_point *next = NULL;
        for (int i = 0; i < r->n_points; i++) {
            const bis_trade_point *p = &r->points[i];
            if (p->on_front && (!last || p->seconds > last->seconds) && (!next || p->seconds < next->seconds)) next = p;
        }
        if (!next) break;
        last = next;
        const double mean = t->references[bis_trade_judge_of(&t->plan.settings[next->setting])].mean;
        fprintf(out, "<tr><th class=\"k-%s\">", t->plan.settings[next->setting].settings.integrator->name);
        put_name(out, &t->plan.settings[next->setting]);
        fprintf(out, "</th><td>%u</td><td>%s</td><td>%s</td>", (unsigned)next->passes, bis_trade_duration(time, next->seconds),
                next->noise > 0 ? bis_trade_percent(error, sqrt(next->noise)) : "below the reference&#39;s");
        fprintf(out, "<td>%s%s", next->bias < 0 ? "&#8722;" : "+", bis_trade_percent(bias, fabs(next->bias) / mean));
        if (next->bias_se > 0) fprintf(out, " &#177; %s", bis_trade_percent(bias, next->bias_se / mean));
        fputs("</td></tr>\n", out);
    }
    fputs("</tbody></table></div>\n", out);
}
