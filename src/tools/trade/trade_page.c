/* trade_page: report.html. All that it says of this measurement is one JSON object, written here member by member in
 * the order of the page; page.html has the words, the looks and the places, and out/template.h puts both together. */
#include "trade_page.h"

#include "bis/base/file.h"
#include "bis/base/version.h"
#include "out/template.h"

#include <stdlib.h>
#include <string.h>

/* ---- words ---- */

/* "1 seed", "4 seeds". */
static void say_count(bis_json *j, const char *key, int n, const char *what)
{
    bis_trade_say(j, key, "%d %s%s", n, what, n == 1 ? "" : "s");
}

static void say_duration(bis_json *j, const char *key, double seconds)
{
    char text[24];
    bis_json_text(j, key, bis_trade_duration(text, seconds));
}

static void say_percent(bis_json *j, const char *key, double v)
{
    char text[24];
    bis_json_text(j, key, bis_trade_percent(text, v));
}

/* ---- advice ---- */

/* Each "--name value" is an item of its own, and stays on one line. */
static void put_options(bis_json *j, const char *options)
{
    for (const char *at = options; *at;) {
        const char *next = strstr(at + 1, " --");
        const int n = next ? (int)(next - at) : (int)strlen(at);
        bis_trade_say(j, NULL, "%.*s", n, at);
        at += next ? n + 1 : n;
    }
}

/* The command, or where it has no options for the setting, the scene's line. */
static void put_recipe(bis_json *j, const bis_trade *t, const bis_trade_advice *a)
{
    const bis_trade_setting *s = &t->plan.settings[a->setting];
    const double scenes_b = t->desc->light.area_exponent;
    char options[128], text[256];

    bis_trade_option_text(options, s, scenes_b);
    bis_trade_scene_text(text, s, scenes_b);
    bis_json_text(j, "line", options[0] ? "" : text);
    bis_json_text(j, "scene", t->o.scene);
    bis_json_open(j, "options", '[');
    put_options(j, options);
    bis_trade_say(j, NULL, "--spp %u", (unsigned)a->passes);
    bis_json_close(j);
}

static void put_advice(bis_json *j, const bis_trade *t, const bis_trade_advice *a)
{
    bis_json_open(j, NULL, '{');
    bis_json_text(j, "purpose", a->purpose);
    if (a->setting < 0) {
        bis_json_text(j, "method", "");
        bis_json_close(j);
        return;
    }
    const bis_trade_setting *s = &t->plan.settings[a->setting];
    const bis_settings *v = &s->settings;
    const char *space = strchr(s->name, ' '), *variant = space ? strchr(space + 1, ' ') : NULL;

    bis_json_text(j, "method", v->integrator->name);
    bis_json_bool(j, "extrapolated", a->is_extrapolated);
    say_duration(j, "time", a->seconds);
    say_percent(j, "error", a->expected_error);
    if (v->integrator == &bis_sir || v->integrator == &bis_rejection) {
        bis_trade_say(j, "amounts", "%u candidates and %u shadow ray%s", (unsigned)v->candidates,
                      (unsigned)v->shadowrays, v->shadowrays == 1 ? "" : "s");
    } else {
        say_count(j, "amounts", (int)v->samples, "light sample");
    }
    if (variant) bis_trade_say(j, "variant", " (%s)", variant + 1);
    else bis_json_text(j, "variant", "");
    say_count(j, "samples", (int)a->passes, "sample");
    bis_trade_say(j, "size", "%d × %d", t->plan.full_width, t->plan.full_height);
    put_recipe(j, t, a);
    bis_json_close(j);
}

/* ---- bars ---- */

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

/* Length in percent of the longest, on a logarithmic scale that begins at half the best; to a tenth. */
static double length_of(double v, double best, double worst)
{
    return round(1000 * log(2 * v / best) / log(2 * worst / best)) / 10;
}

static void put_bar(bis_json *j, const bis_trade_setting *s, const bis_trade_curve *c, double best, double worst)
{
    const double v = c->cost_variance, se = c->cost_variance_se;
    const double low = fmax(v - se, best / 2), high = fmin(v + se, worst), left = length_of(low, best, worst);

    bis_json_open(j, NULL, '{');
    bis_trade_put_name(j, s);
    bis_json_text(j, "class", s->is_biased ? " biased" : "");
    bis_json_number(j, "length", v > 0 ? fmax(length_of(v, best, worst), 0) : 0);
    if (se > 0 && high > low) {
        bis_json_open(j, "whisker", '{');
        bis_json_number(j, "left", left);
        bis_trade_say(j, "width", "%.1f", length_of(high, best, worst) - left);
        bis_json_close(j);
    } else {
        bis_json_null(j, "whisker");
    }
    bis_trade_say(j, "times", "%.*f", v / best < 9.95 ? 1 : 0, v / best);
    bis_json_close(j);
}

static void put_bars(bis_json *j, const bis_trade *t)
{
    const bis_trade_curve *c = t->result.curves;
    int order[BIS_TRADE_SETTINGS];
    const int n = by_cost(t, order);
    double best = t->result.best >= 0 ? c[t->result.best].cost_variance : 0, worst = 0;

    for (int i = 0; i < n; i++) {
        worst = fmax(worst, c[order[i]].cost_variance);
        if (c[order[i]].cost_variance > 0) best = fmin(best, c[order[i]].cost_variance);
    }
    bis_json_open(j, "bars", '[');
    for (int i = 0; best > 0 && i < n; i++) put_bar(j, &t->plan.settings[order[i]], &c[order[i]], best, worst);
    bis_json_close(j);
}

/* ---- tables ---- */

/* A table of equal time or of equal error: what stands over it, and in a cell. */
typedef struct table {
    const bis_trade *t;
    bool is_time;
    const char *corner;
    double at[BIS_TRADE_COLUMNS];
    int n;
    double (*value)(const bis_trade_result *r, const bis_trade_plan *plan, int setting, double at, bool *extrapolated);
    const char *(*say_column)(char buf[24], double v), *(*say)(char buf[24], double v);
} table;

static double least_in(const table *b, double at)
{
    double least = 1e300;
    for (int i = 0; i < b->t->plan.n_settings; i++) {
        bool extrapolated;
        const double v = b->value(&b->t->result, &b->t->plan, i, at, &extrapolated);
        if (v < least) least = v;
    }
    return least;
}

/* The better, the stronger the colour: 100 is the column's best, 0 four times as much. */
static void put_cell(bis_json *j, const table *b, int setting, double at)
{
    bool extrapolated;
    char text[24];
    const double v = b->value(&b->t->result, &b->t->plan, setting, at, &extrapolated);

    bis_json_open(j, NULL, '{');
    if (isnan(v)) {
        bis_json_text(j, "text", "");
    } else {
        const double share = v > 0 ? 1 - log2(v / least_in(b, at)) / 2 : 1;
        bis_trade_say(j, "strength", "%.0f", 100 * fmin(fmax(share, 0), 1));
        bis_trade_say(j, "text", "%s%s", extrapolated ? "~" : "", b->say(text, v));
    }
    bis_json_close(j);
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

/* The best of each integrator, or all of them. */
static void put_version(bis_json *j, const table *b, bool all)
{
    int order[BIS_TRADE_SETTINGS];
    const int n_rows = by_cost(b->t, order);
    char text[24];

    bis_json_open(j, NULL, '{');
    bis_json_bool(j, "all", all);
    bis_json_text(j, "corner", b->corner);
    bis_json_open(j, "columns", '[');
    for (int k = 0; k < b->n; k++) bis_json_text(j, NULL, b->say_column(text, b->at[k]));
    bis_json_close(j);
    bis_json_open(j, "rows", '[');
    for (int i = 0; i < n_rows; i++) {
        if (!all && !is_head(b->t, order[i])) continue;
        bis_json_open(j, NULL, '{');
        bis_trade_put_name(j, &b->t->plan.settings[order[i]]);
        bis_json_open(j, "cells", '[');
        for (int k = 0; k < b->n; k++) put_cell(j, b, order[i], b->at[k]);
        bis_json_close(j);
        bis_json_close(j);
    }
    bis_json_close(j);
    bis_json_close(j);
}

static void put_table(bis_json *j, const table *b)
{
    bis_json_open(j, NULL, '{');
    bis_json_bool(j, "time", b->is_time);
    bis_json_open(j, "versions", '[');
    put_version(j, b, false);
    put_version(j, b, true);
    bis_json_close(j);
    bis_json_close(j);
}

static void put_tables(bis_json *j, const bis_trade *t)
{
    table times = {t, true, "error after", {0}, 0, bis_trade_error_at, bis_trade_duration, bis_trade_percent};
    table errors = {t, false, "time to an error of", {0}, 0, bis_trade_seconds_to, bis_trade_percent,
                    bis_trade_duration};
    double ascending[BIS_TRADE_COLUMNS];

    times.n = bis_trade_times(t, times.at);
    errors.n = bis_trade_errors(t, ascending);
    for (int k = 0; k < errors.n; k++) errors.at[k] = ascending[errors.n - 1 - k];
    bis_json_open(j, "tables", '[');
    put_table(j, &times);
    put_table(j, &errors);
    bis_json_close(j);
}

/* ---- the front ---- */

static void put_front(bis_json *j, const bis_trade *t)
{
    char error[24], bias[24], se[24];

    bis_json_open(j, "front", '[');
    for (const bis_trade_point *p = NULL; (p = bis_trade_next_on_front(&t->result, p));) {
        const bis_trade_setting *s = &t->plan.settings[p->setting];
        const double mean = t->references[bis_trade_judge_of(s)].mean;
        bis_json_open(j, NULL, '{');
        bis_trade_put_name(j, s);
        bis_json_count(j, "passes", p->passes);
        say_duration(j, "time", p->seconds);
        bis_json_text(j, "error",
                      p->noise > 0 ? bis_trade_percent(error, sqrt(p->noise)) : "below the reference's");
        bis_trade_say(j, "bias", "%s%s%s%s", p->bias < 0 ? "−" : "+", bis_trade_percent(bias, fabs(p->bias) / mean),
                      p->bias_se > 0 ? " ± " : "", p->bias_se > 0 ? bis_trade_percent(se, p->bias_se / mean) : "");
        bis_json_close(j);
    }
    bis_json_close(j);
}

/* ---- how it was measured ---- */

static void put_reference(bis_json *j, const bis_trade *t, int k, const char *judged)
{
    const bis_trade_reference *ref = &t->references[k];

    if (t->plan.reference[k] < 0 || !ref->is_ready) return;
    bis_json_open(j, NULL, '{');
    bis_json_text(j, "judged", judged);
    bis_json_text(j, "name", t->plan.settings[t->plan.reference[k]].name);
    bis_json_count(j, "renders", BIS_TRADE_REPLICATES);
    bis_json_count(j, "passes", t->plan.reference_passes[k]);
    bis_trade_say(j, "mean", "%.5g", ref->mean);
    say_percent(j, "se", ref->mean > 0 ? ref->se / ref->mean : 0);
    say_percent(j, "noise", sqrt(ref->relmse));
    bis_json_close(j);
}

static void put_references(bis_json *j, const bis_trade *t)
{
    const bis_trade_reference *a = &t->references[0], *b = &t->references[1];
    char difference[24], se[24];

    bis_json_open(j, "references", '[');
    put_reference(j, t, 0, "sir and rejection");
    put_reference(j, t, 1, "em, brdf and mis");
    bis_json_close(j);
    bis_json_bool(j, "given", t->plan.is_given);
    say_percent(j, "noise", sqrt(t->both.relmse));
    if (t->plan.is_given || !a->is_ready || !b->is_ready || !(a->mean > 0)) {
        bis_json_null(j, "agreement");
        return;
    }
    bis_trade_say(j, "agreement", "%s ± %s", bis_trade_percent(difference, fabs(a->mean - b->mean) / a->mean),
                  bis_trade_percent(se, hypot(a->se, b->se) / a->mean));
}

static void put_left_out(bis_json *j, const bis_trade *t)
{
    char list[BIS_TRADE_SETTINGS * (BIS_TRADE_NAME + 40)] = "";
    size_t n = 0;

    for (int i = 0; i < t->plan.n_settings; i++) {
        const bis_trade_setting *s = &t->plan.settings[i];
        char time[24];
        if (!s->is_swept || s->levels) continue;
        n += (size_t)snprintf(list + n, sizeof list - n, "%s%s (%s a pass)", n ? ", " : "", s->name,
                              bis_trade_duration(time, s->pass_seconds));
    }
    bis_json_text(j, "left_out", list);
}

static void put_method(bis_json *j, const bis_trade *t)
{
    bis_json_bool(j, "thin", t->plan.step > 1);
    bis_json_count(j, "width", (uint64_t)t->plan.width);
    bis_json_count(j, "height", (uint64_t)t->plan.height);
    bis_trade_say(j, "full", "%d × %d", t->plan.full_width, t->plan.full_height);
    bis_trade_say(j, "of_each", "%d × %d", t->plan.step, t->plan.step);
    say_duration(j, "longest", t->plan.run_seconds);
    say_count(j, "seeds", t->plan.n_seeds, "seed");
    say_count(j, "threads", t->n_threads, "thread");
    put_references(j, t);
    put_left_out(j, t);
    bis_json_text(j, "version", BIS_VERSION);
}

/* ---- the page ---- */

static bis_status put_values(FILE *out, const bis_trade *t, bis_diag *diag)
{
    bis_json j = {.out = out};
    const char *slash = strrchr(t->o.scene, '/');

    bis_json_open(&j, NULL, '{');
    bis_json_bool(&j, "example", false);
    bis_json_text(&j, "title", slash ? slash + 1 : t->o.scene);
    bis_json_bool(&j, "incomplete", !t->is_complete);
    bis_json_count(&j, "runs", t->n_runs);
    bis_json_count(&j, "planned", bis_trade_planned_runs(&t->plan));
    bis_json_open(&j, "advice", '[');
    for (int i = 0; i < BIS_TRADE_ADVICE; i++) put_advice(&j, t, &t->result.advice[i]);
    bis_json_close(&j);
    bis_json_bool(&j, "measured", t->result.n_points > 0);
    bis_json_open(&j, "plots", '[');
    for (int by_rays = 0; by_rays < 2; by_rays++) bis_trade_put_plot(&j, t, by_rays);
    bis_json_close(&j);
    put_bars(&j, t);
    bis_trade_put_strip(&j, t);
    put_tables(&j, t);
    put_front(&j, t);
    put_method(&j, t);
    const bis_status status = bis_trade_put_pictures(&j, t, diag);
    bis_json_close(&j);
    return status;
}

bis_status bis_trade_write_report(const bis_trade *t, bis_diag *diag)
{
    char path[4096], *values = NULL;
    size_t n = 0;
    bis_outfile *file;
    FILE *memory = open_memstream(&values, &n);

    if (!memory) return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for the report");
    bis_status status = put_values(memory, t, diag);
    if (fclose(memory) != 0 && !status) status = bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for the report");
    if (!status) status = bis_outfile_open(&file, bis_trade_path(path, t, "report.html"), diag);
    if (!status) {
        status = bis_template_fill(bis_outfile_stream(file), bis_trade_page, values, diag);
        if (!status) status = bis_outfile_commit(file, diag);
        else bis_outfile_abort(file);
    }
    free(values); /* the C library's, not ours */
    return status;
}
