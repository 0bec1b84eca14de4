/* SPDX-License-Identifier: BSD-2-Clause */
/* trade_page: report.html. All that it says of this measurement is one JSON object, written here (docs/live.md says
 * what each member is); page.html has the words, and its script draws them. Numbers are those of the measurement, in
 * seconds and shares: how they are printed and where they stand is the page's affair. */
#include "base/text.h"
#include "trade_files.h"
#include "trade_page.h"
#include "trade_plan.h"
#include "trade_settings.h"
#include "trade_stats.h"

#include "bis/base/file.h"
#include "bis/base/version.h"
#include "out/page.h"

#include <stdlib.h>
#include <string.h>

/* ---- settings ---- */

static void put_point(bis_json *j, const bis_trade *t, const bis_trade_point *p)
{
    const double mean = t->references[bis_trade_judge_of(&t->plan.settings[p->setting])].mean;
    const double error = p->noise > 0 ? sqrt(p->noise) : (double)NAN;

    bis_json_open(j, NULL, '{');
    BIS_JSON_NUMBERS(j, {"passes", p->passes}, {"seconds", p->seconds},
                     {"rays", (p->camera_rays + p->shadow_rays) / ((double)t->plan.width * t->plan.height)},
                     {"error", error}, {"error_se", p->noise_se / (2 * error)}, /* of the root: half the relative one */
                     {"bias", p->bias / mean}, {"bias_se", p->bias_se / mean});
    bis_json_bool(j, "pareto", p->on_front);
    bis_json_close(j);
}

/* What a setting comes to at each of at[n]: the value, and whether it is extrapolated. */
typedef double reach(const bis_trade_result *r, const bis_trade_plan *p, int setting, double at, bool *extrapolated);
typedef struct reached {
    const double *at;
    int n;
    reach *of;
} reached;
static void put_reach(bis_json *j, const char *key, const bis_trade *t, int setting, reached r)
{
    bis_json_open(j, key, '[');
    for (int k = 0; k < r.n; k++) {
        bool extrapolated;
        bis_json_open(j, NULL, '{');
        bis_json_number(j, "value", r.of(&t->result, &t->plan, setting, r.at[k], &extrapolated));
        bis_json_bool(j, "extrapolated", extrapolated);
        bis_json_close(j);
    }
    bis_json_close(j);
}

static void put_setting(bis_json *j, const bis_trade *t, int i)
{
    const bis_trade_setting *s = &t->plan.settings[i];
    const bis_trade_curve *c = &t->result.curves[i];
    double seconds[BIS_TRADE_COLUMNS], errors[BIS_TRADE_COLUMNS];

    bis_json_open(j, NULL, '{');
    bis_json_text(j, "name", s->name);
    bis_json_text(j, "method", s->settings.integrator->name);
    bis_json_bool(j, "biased", s->is_biased);
    bis_json_bool(j, "own", s->is_scenes);
    bis_json_bool(j, "head", bis_trade_is_head(t, i));
    BIS_JSON_NUMBERS(j, {"cost_variance", c->cost_variance}, {"cost_variance_se", c->cost_variance_se},
                     {"slope", c->slope}, {"slope_se", c->slope_se});
    bis_json_open(j, "points", '[');
    for (int k = 0; k < c->n; k++) put_point(j, t, &t->result.points[c->first + k]);
    bis_json_close(j);
    put_reach(j, "error_at", t, i, (reached){seconds, bis_trade_times(t, seconds), bis_trade_error_at});
    put_reach(j, "seconds_to", t, i, (reached){errors, bis_trade_errors(t, errors), bis_trade_seconds_to});
    bis_json_close(j);
}

static void put_list(bis_json *j, const char *key, const double *v, int n)
{
    bis_json_open(j, key, '[');
    for (int i = 0; i < n; i++) bis_json_number(j, NULL, v[i]);
    bis_json_close(j);
}

/* In the order of cost x variance, as bars and tables have them. */
static void put_settings(bis_json *j, const bis_trade *t)
{
    const bis_trade_curve *c = t->result.curves;
    int order[BIS_TRADE_SETTINGS], n = 0;
    double v[BIS_TRADE_COLUMNS];

    for (int i = 0; i < t->plan.n_settings; i++) {
        if (!c[i].n) continue;
        int at = n++;
        for (; at > 0 && c[order[at - 1]].cost_variance > c[i].cost_variance; at--) order[at] = order[at - 1];
        order[at] = i;
    }
    put_list(j, "times", v, bis_trade_times(t, v));
    put_list(j, "errors", v, bis_trade_errors(t, v));
    bis_json_text(j, "best", t->result.best < 0 ? NULL : t->plan.settings[t->result.best].name);
    bis_json_open(j, "settings", '[');
    for (int i = 0; i < n; i++) put_setting(j, t, order[i]);
    bis_json_close(j);
}

static void put_left_out(bis_json *j, const bis_trade *t)
{
    bis_json_open(j, "left_out", '[');
    for (int i = 0; i < t->plan.n_settings; i++) {
        const bis_trade_setting *s = &t->plan.settings[i];
        if (!s->is_swept || s->levels) continue;
        bis_json_open(j, NULL, '{');
        bis_json_text(j, "name", s->name);
        bis_json_number(j, "pass_seconds", s->pass_seconds);
        bis_json_close(j);
    }
    bis_json_close(j);
}

/* ---- advice ---- */

/* The command's options, or where it has none for the setting, the scene's line. */
static void put_advice(bis_json *j, const bis_trade *t, const bis_trade_advice *a)
{
    bis_json_open(j, NULL, '{');
    bis_json_text(j, "purpose", a->purpose);
    bis_json_text(j, "setting", a->setting < 0 ? NULL : t->plan.settings[a->setting].name);
    if (a->setting >= 0) {
        const bis_trade_setting *s = &t->plan.settings[a->setting];
        const bis_settings *v = &s->settings;
        const bool by_candidates = v->integrator == &bis_sir || v->integrator == &bis_rejection;
        char options[128], line[256];
        bis_trade_option_text(options, s, t->desc->light.area_exponent);
        bis_trade_scene_text(line, s, t->desc->light.area_exponent);
        bis_json_text(j, "method", v->integrator->name);
        BIS_JSON_NUMBERS(j, {"candidates", by_candidates ? v->candidates : (double)NAN},
                         {"shadowrays", by_candidates ? v->shadowrays : (double)NAN},
                         {"samples", by_candidates ? (double)NAN : v->samples}, {"error", a->expected_error},
                         {"seconds", a->seconds}, {"passes", a->passes});
        bis_json_bool(j, "extrapolated", a->is_extrapolated);
        bis_json_text(j, "options", options);
        bis_json_text(j, "line", options[0] ? "" : line);
    }
    bis_json_close(j);
}

/* ---- how it was measured ---- */

static void put_reference(bis_json *j, const bis_trade *t, int k)
{
    static const char *const judged[] = {"sir and rejection", "em, brdf and mis"};
    const bis_trade_reference *ref = &t->references[k];

    if (t->plan.reference[k] < 0 || !ref->is_ready) return;
    bis_json_open(j, NULL, '{');
    bis_json_text(j, "judges", judged[k]);
    bis_json_text(j, "name", t->plan.settings[t->plan.reference[k]].name);
    BIS_JSON_NUMBERS(j, {"renders", BIS_TRADE_REPLICATES}, {"passes", t->plan.reference_passes[k]}, {"mean", ref->mean},
                     {"se", ref->mean > 0 ? ref->se / ref->mean : 0}, {"noise", sqrt(ref->relmse)});
    bis_json_close(j);
}

static void put_references(bis_json *j, const bis_trade *t)
{
    const bis_trade_reference *a = &t->references[0], *b = &t->references[1];
    const bool agree = !t->plan.is_given && a->is_ready && b->is_ready && a->mean > 0;

    bis_json_open(j, "references", '[');
    for (int k = 0; k < 2; k++) put_reference(j, t, k);
    bis_json_close(j);
    bis_json_bool(j, "given", t->plan.is_given);
    BIS_JSON_NUMBERS(j, {"noise", sqrt(t->both.relmse)},
                     {"difference", agree ? fabs(a->mean - b->mean) / a->mean : (double)NAN},
                     {"difference_se", agree ? hypot(a->se, b->se) / a->mean : (double)NAN});
}

static void put_method(bis_json *j, const bis_trade *t)
{
    const bis_trade_plan *p = &t->plan;

    BIS_JSON_OBJECT(j, "film", {"width", p->width}, {"height", p->height}, {"full_width", p->full_width},
                    {"full_height", p->full_height}, {"step", p->step});
    BIS_JSON_NUMBERS(j, {"run_seconds", p->run_seconds}, {"seeds", p->n_seeds}, {"threads", t->n_threads});
    put_references(j, t);
    put_left_out(j, t);
}

/* ---- the page ---- */

/* All values, an object. */
static bis_status put_values(FILE *out, const bis_trade *t, bis_diag *diag)
{
    bis_json j = {.out = out};

    bis_json_open(&j, NULL, '{');
    bis_json_text(&j, "scene", t->o.scene);
    bis_json_text(&j, "version", BIS_VERSION);
    bis_json_bool(&j, "complete", t->is_complete);
    BIS_JSON_NUMBERS(&j, {"runs", (double)t->n_runs}, {"planned", (double)bis_trade_planned_runs(&t->plan)});
    bis_json_open(&j, "advice", '[');
    for (int i = 0; i < BIS_TRADE_ADVICE; i++) put_advice(&j, t, &t->result.advice[i]);
    bis_json_close(&j);
    put_settings(&j, t);
    put_method(&j, t);
    const bis_status status = bis_trade_put_pictures(&j, t, diag);
    bis_json_close(&j);
    return status;
}

/* For a browser without JavaScript. */
static void put_text(FILE *out, const bis_trade *t)
{
    char time[BIS_DURATION], error[BIS_PERCENT];

    bis_trade_print_summary(out, t);
    fprintf(out, "\n%-32s %8s %10s %10s %s\n", "setting", "passes", "time", "error", "on the Pareto front");
    for (const bis_trade_point *p = t->result.points; p < t->result.points + t->result.n_points; p++)
        fprintf(out, "%-32s %8u %10s %10s %s\n", t->plan.settings[p->setting].name, (unsigned)p->passes,
                bis_duration(time, p->seconds), p->noise > 0 ? bis_percent(error, sqrt(p->noise)) : "-",
                p->on_front ? "yes" : "");
}

void bis_trade_print_summary(FILE *out, const bis_trade *t)
{
    char text[256], time[24], error[24];
    int n = 0;

    for (int i = 0; i < BIS_TRADE_ADVICE; i++) {
        const bis_trade_advice *a = &t->result.advice[i];
        if (a->setting < 0) continue;
        n++;
        const bis_trade_setting *s = &t->plan.settings[a->setting];
        bis_trade_option_text(text, s, t->desc->light.area_exponent);
        if (!text[0]) bis_trade_scene_text(text, s, t->desc->light.area_exponent);
        fprintf(out, "%-14s error %-5s %s%-8s %s --spp %u\n", a->purpose, bis_percent(error, a->expected_error),
                a->is_extrapolated ? "~" : " ", bis_duration(time, a->seconds), text, (unsigned)a->passes);
    }
    if (!n) fputs("no advice: no setting has enough runs; give --resume --time more\n", out);
    fprintf(out, "%zu of %zu runs in %s/report.html\n", t->n_runs, bis_trade_planned_runs(&t->plan), t->o.folder);
}

bis_status bis_trade_write_report(const bis_trade *t, bis_diag *diag)
{
    static const char what[] = "the report";
    char path[4096];
    bis_page page;
    bis_status status = bis_page_begin(&page, what, diag);

    if (status) return status;
    status = put_values(page.json, t, diag);
    put_text(page.text, t);
    return bis_page_end(&page, status, bis_trade_path(path, t, "report.html"), bis_trade_page, what, diag);
}
