/* SPDX-License-Identifier: BSD-2-Clause */
/* trade_page: report.html. All that it says of this measurement is one JSON object, written here member by member in
 * the order of the page; page.html has the words, the looks and the places, and out/template.h puts both together. */
#include "base/text.h"
#include "trade_page.h"

#include "bis/base/file.h"
#include "bis/base/version.h"
#include "out/template.h"

#include <stdlib.h>
#include <string.h>

/* ---- advice ---- */

/* Each "--name value" is an item of its own, and stays on one line. */
static void put_options(bis_json *j, const char *options)
{
    for (const char *at = options; *at;) {
        const char *next = strstr(at + 1, " --");
        const int n = next ? (int)(next - at) : (int)strlen(at);
        char option[64];
        snprintf(option, sizeof option, "%.*s", n, at);
        bis_json_text(j, NULL, option);
        at += next ? n + 1 : n;
    }
}

/* The command, or where it has no options for the setting, the scene's line. */
static void put_recipe(bis_json *j, const bis_trade *t, const bis_trade_advice *a)
{
    const bis_trade_setting *s = &t->plan.settings[a->setting];
    const double scenes_b = t->desc->light.area_exponent;
    char options[128], text[256], spp[24];

    snprintf(spp, sizeof spp, "--spp %u", (unsigned)a->passes);
    bis_trade_option_text(options, s, scenes_b);
    bis_trade_scene_text(text, s, scenes_b);
    bis_json_text(j, "line", options[0] ? "" : text);
    bis_json_text(j, "scene", t->o.scene);
    bis_json_open(j, "options", '[');
    put_options(j, options);
    put_options(j, spp);
    bis_json_close(j);
}

static void put_advice(bis_json *j, const bis_trade *t, const bis_trade_advice *a)
{
    bis_json_open(j, NULL, '{');
    bis_trade_say(j, "purpose=%s; method=%s", a->purpose,
                  a->setting < 0 ? "" : t->plan.settings[a->setting].settings.integrator->name);
    if (a->setting >= 0) {
        const bis_trade_setting *s = &t->plan.settings[a->setting];
        const bis_settings *v = &s->settings;
        const bool by_candidates = v->integrator == &bis_sir || v->integrator == &bis_rejection;
        const unsigned rays = by_candidates ? v->shadowrays : v->samples;
        const char *space = strchr(s->name, ' '), *variant = space ? strchr(space + 1, ' ') : NULL;
        char time[24], error[24], candidates[48] = "";

        if (by_candidates) snprintf(candidates, sizeof candidates, "%u candidates and ", (unsigned)v->candidates);
        bis_json_bool(j, "extrapolated", a->is_extrapolated);
        bis_trade_say(j, "time=%s; error=%s; size=%d × %d", bis_duration(time, a->seconds),
                      bis_percent(error, a->expected_error), t->plan.full_width, t->plan.full_height);
        bis_trade_say(j, "amounts=%s%u %s%s", candidates, rays, by_candidates ? "shadow ray" : "light sample",
                      rays == 1 ? "" : "s");
        bis_trade_say(j, "variant=%s%s%s", variant ? " (" : "", variant ? variant + 1 : "", variant ? ")" : "");
        bis_trade_say(j, "samples=%u sample%s", (unsigned)a->passes, a->passes == 1 ? "" : "s");
        put_recipe(j, t, a);
    }
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

/* Length in percent of the longest, on a logarithmic scale that begins at half the best. */
static double length_of(double v, double best, double worst)
{
    return 100 * log(2 * v / best) / log(2 * worst / best);
}

static void put_bar(bis_json *j, const bis_trade_setting *s, const bis_trade_curve *c, double best, double worst)
{
    const double v = c->cost_variance, se = c->cost_variance_se, low = fmax(v - se, best / 2);
    const double high = fmin(v + se, worst), left = length_of(low, best, worst);

    bis_json_open(j, NULL, '{');
    bis_trade_put_name(j, s);
    bis_trade_say(j, "class=%s; length=%.1f; times=%.*f", s->is_biased ? " biased" : "",
                  v > 0 ? fmax(length_of(v, best, worst), 0) : 0, v / best < 9.95 ? 1 : 0, v / best);
    if (!(se > 0 && high > low)) bis_json_null(j, "whisker");
    else bis_trade_say_all(j, "whisker", "left=%.1f; width=%.1f", left, length_of(high, best, worst) - left);
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
    const double share = v > 0 ? 1 - log2(v / least_in(b, at)) / 2 : 1;

    if (isnan(v)) bis_trade_say_all(j, NULL, "text=");
    else bis_trade_say_all(j, NULL, "strength=%.0f; text=%s%s", 100 * fmin(fmax(share, 0), 1), extrapolated ? "~" : "",
                           b->say(text, v));
}

/* The best of each integrator, or all of them. */
static void put_version(bis_json *j, const table *b, bool all)
{
    int order[BIS_TRADE_SETTINGS];
    const int n_rows = by_cost(b->t, order);
    char text[24];

    bis_json_open(j, NULL, '{');
    bis_json_bool(j, "all", all);
    bis_trade_say(j, "corner=%s", b->corner);
    bis_json_open(j, "columns", '[');
    for (int k = 0; k < b->n; k++) bis_json_text(j, NULL, b->say_column(text, b->at[k]));
    bis_json_close(j);
    bis_json_open(j, "rows", '[');
    for (int i = 0; i < n_rows; i++) {
        if (!all && !bis_trade_is_head(b->t, order[i])) continue;
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
    table times = {t, true, "error after", {0}, 0, bis_trade_error_at, bis_duration, bis_percent};
    table errors = {t, false, "time to an error of", {0}, 0, bis_trade_seconds_to, bis_percent,
                    bis_duration};
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
    char time[24], error[24], bias[24], se[24];

    bis_json_open(j, "front", '[');
    for (const bis_trade_point *p = NULL; (p = bis_trade_next_on_front(&t->result, p));) {
        const bis_trade_setting *s = &t->plan.settings[p->setting];
        const double mean = t->references[bis_trade_judge_of(s)].mean;
        bis_json_open(j, NULL, '{');
        bis_trade_put_name(j, s);
        bis_trade_say(j, "passes=%u; time=%s; error=%s", (unsigned)p->passes, bis_duration(time, p->seconds),
                      p->noise > 0 ? bis_percent(error, sqrt(p->noise)) : "below the reference's");
        bis_trade_say(j, "bias=%s%s%s%s", p->bias < 0 ? "−" : "+", bis_percent(bias, fabs(p->bias) / mean),
                      p->bias_se > 0 ? " ± " : "", p->bias_se > 0 ? bis_percent(se, p->bias_se / mean) : "");
        bis_json_close(j);
    }
    bis_json_close(j);
}

/* ---- how it was measured ---- */

static void put_reference(bis_json *j, const bis_trade *t, int k, const char *judged)
{
    const bis_trade_reference *ref = &t->references[k];
    char se[24], noise[24];

    if (t->plan.reference[k] < 0 || !ref->is_ready) return;
    bis_trade_say_all(j, NULL, "judged=%s; name=%s; renders=%d; passes=%u; mean=%.5g; se=%s; noise=%s", judged,
                      t->plan.settings[t->plan.reference[k]].name, (int)BIS_TRADE_REPLICATES,
                      (unsigned)t->plan.reference_passes[k], ref->mean,
                      bis_percent(se, ref->mean > 0 ? ref->se / ref->mean : 0),
                      bis_percent(noise, sqrt(ref->relmse)));
}

static void put_references(bis_json *j, const bis_trade *t)
{
    const bis_trade_reference *a = &t->references[0], *b = &t->references[1];
    const bool agree = !t->plan.is_given && a->is_ready && b->is_ready && a->mean > 0;
    char difference[24], se[24];

    bis_json_open(j, "references", '[');
    put_reference(j, t, 0, "sir and rejection");
    put_reference(j, t, 1, "em, brdf and mis");
    bis_json_close(j);
    bis_json_bool(j, "given", t->plan.is_given);
    bis_trade_say(j, "noise=%s", bis_percent(difference, sqrt(t->both.relmse)));
    if (!agree) bis_json_null(j, "agreement");
    else bis_trade_say(j, "agreement=%s ± %s", bis_percent(difference, fabs(a->mean - b->mean) / a->mean),
                       bis_percent(se, hypot(a->se, b->se) / a->mean));
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
                              bis_duration(time, s->pass_seconds));
    }
    bis_json_text(j, "left_out", list);
}

static void put_method(bis_json *j, const bis_trade *t)
{
    const bis_trade_plan *plan = &t->plan;
    char longest[24];

    bis_json_bool(j, "thin", plan->step > 1);
    bis_trade_say(j, "width=%d; height=%d; full=%d × %d; of_each=%d × %d", plan->width, plan->height, plan->full_width,
                  plan->full_height, plan->step, plan->step);
    bis_trade_say(j, "longest=%s; seeds=%d seed%s; threads=%d thread%s; version=%s",
                  bis_duration(longest, plan->run_seconds), plan->n_seeds, plan->n_seeds == 1 ? "" : "s",
                  t->n_threads, t->n_threads == 1 ? "" : "s", BIS_VERSION);
    put_references(j, t);
    put_left_out(j, t);
}

/* ---- the page ---- */

static void put_results(bis_json *j, const bis_trade *t)
{
    bis_json_open(j, "plots", '[');
    for (int by_rays = 0; by_rays < 2; by_rays++) bis_trade_put_plot(j, t, by_rays);
    bis_json_close(j);
    put_bars(j, t);
    bis_trade_put_strip(j, t);
    put_tables(j, t);
    put_front(j, t);
}

bis_status bis_trade_put_values(FILE *out, const bis_trade *t, bis_diag *diag)
{
    bis_json j = {.out = out};
    const char *slash = strrchr(t->o.scene, '/');

    bis_json_open(&j, NULL, '{');
    bis_json_bool(&j, "example", false);
    bis_json_text(&j, "title", slash ? slash + 1 : t->o.scene);
    bis_json_bool(&j, "incomplete", !t->is_complete);
    bis_trade_say(&j, "runs=%zu; planned=%zu", t->n_runs, bis_trade_planned_runs(&t->plan));
    bis_json_open(&j, "advice", '[');
    for (int i = 0; i < BIS_TRADE_ADVICE; i++) put_advice(&j, t, &t->result.advice[i]);
    bis_json_close(&j);
    bis_json_bool(&j, "measured", t->result.n_points > 0);
    if (t->result.n_points > 0) put_results(&j, t);
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
    bis_status status = bis_trade_put_values(memory, t, diag);
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
