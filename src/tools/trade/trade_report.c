/* trade_report: report.html, one page that needs nothing else: advice first, then what it rests on.
 *
 * In this order: what to use (three sentences), error over time, cost of an error, the same seconds side by side, two
 * pictures under a slider, the tables, and how all of that was measured. XHTML's rules are kept (every element is
 * closed, every attribute quoted), so that a small checker can hold it well formed, and no address stands in it. */
#include "trade.h"

#include "bis/base/file.h"
#include "bis/base/version.h"

#include <string.h>

static const char *base_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* ---- advice ---- */

/* "sir with 256 candidates and 16 shadow rays", "mis with 16 samples (compensated)". */
static void say_setting(FILE *out, const bis_trade_setting *s)
{
    const bis_settings *v = &s->settings;
    const char *variant = strchr(s->name, ' ');

    variant = variant ? strchr(variant + 1, ' ') : NULL;
    fprintf(out, "<b>%s</b> with ", v->integrator->name);
    if (v->integrator == &bis_sir || v->integrator == &bis_rejection) {
        fprintf(out, "%u candidates and %u shadow ray%s", (unsigned)v->candidates, (unsigned)v->shadowrays, v->shadowrays == 1 ? "" : "s");
    } else {
        fprintf(out, "%u light sample%s", (unsigned)v->samples, v->samples == 1 ? "" : "s");
    }
    if (!variant) return;
    fputs(" (", out);
    bis_trade_put_text(out, variant + 1);
    fputs(")", out);
}

/* Each "--name value" stays on one line. */
static void put_options(FILE *out, const char *options)
{
    for (const char *at = options; *at;) {
        const char *next = strstr(at + 1, " --");
        const int n = next ? (int)(next - at) : (int)strlen(at);
        fprintf(out, " <span>%.*s</span>", n, at);
        at += next ? n + 1 : n;
    }
}

/* The command, or where it has no options for the setting, the scene's line. */
static void put_recipe(FILE *out, const bis_trade *t, const bis_trade_advice *a)
{
    const bis_trade_setting *s = &t->plan.settings[a->setting];
    const double scenes_b = t->desc->light.area_exponent;
    char options[128], text[256];

    bis_trade_option_text(options, s, scenes_b);
    bis_trade_scene_text(text, s, scenes_b);
    fputs("<code>", out);
    if (!options[0]) {
        bis_trade_put_text(out, text);
        fputs("<br/>", out);
    }
    fputs("bis ", out);
    bis_trade_put_text(out, t->o.scene);
    put_options(out, options);
    fprintf(out, " <span>--spp %u</span></code>", (unsigned)a->passes);
}

static void put_advice(FILE *out, const bis_trade *t, const bis_trade_advice *a)
{
    char time[24], error[24];

    if (a->setting < 0) {
        fprintf(out, "<section class=\"card\"><h3>%s</h3><p class=\"big\">?</p><p>No unbiased method was measured.</p></section>\n", a->purpose);
        return;
    }
    const bis_trade_setting *s = &t->plan.settings[a->setting];
    fprintf(out, "<section class=\"card k-%s\"><h3>%s</h3><p class=\"big\">%s%s</p><p>For a %s, with errors of about %s of a pixel&#39;s value, use ",
            s->settings.integrator->name, a->purpose, a->is_extrapolated ? "~ " : "", bis_trade_duration(time, a->seconds), a->purpose,
            bis_trade_percent(error, a->expected_error));
    say_setting(out, s);
    fprintf(out, ", %u sample%s in a pixel: %s for %d &#215; %d pixels%s.</p>", (unsigned)a->passes, a->passes == 1 ? "" : "s", time, t->plan.full_width,
            t->plan.full_height, a->is_extrapolated ? ", extrapolated from shorter runs" : "");
    put_recipe(out, t, a);
    fputs("</section>\n", out);
}

/* ---- what was measured ---- */

static void put_reference(FILE *out, const bis_trade *t, int k, const char *judged)
{
    const bis_trade_reference *ref = &t->references[k];
    char noise[24], se[24];

    if (t->plan.reference[k] < 0 || !ref->is_ready) return;
    fprintf(out, "<dt>reference for %s</dt><dd>%s, %d renders of %u passes with seeds of their own: mean %.5g, standard error %s of it; noise %s. It shows a bias.</dd>\n",
            judged, t->plan.settings[t->plan.reference[k]].name, (int)BIS_TRADE_REPLICATES, (unsigned)t->plan.reference_passes[k], ref->mean,
            bis_trade_percent(se, ref->mean > 0 ? ref->se / ref->mean : 0), bis_trade_percent(noise, sqrt(ref->relmse)));
}

static void put_agreement(FILE *out, const bis_trade *t)
{
    const bis_trade_reference *a = &t->references[0], *b = &t->references[1];
    char difference[24], se[24];

    if (t->plan.is_given) fputs("<dt>reference</dt><dd>as given by --reference; its own noise is not known, and counts as everyone&#39;s.</dd>\n", out);
    else fprintf(out, "<dt>errors</dt><dd>from the mean of both, weighted by 1/noise&#178;; its noise, %s, is subtracted.</dd>\n", bis_trade_percent(difference, sqrt(t->both.relmse)));
    if (t->plan.is_given || !a->is_ready || !b->is_ready || !(a->mean > 0)) return;
    fprintf(out, "<dt>do they agree?</dt><dd>The means of the two references differ by %s &#177; %s.</dd>\n",
            bis_trade_percent(difference, fabs(a->mean - b->mean) / a->mean), bis_trade_percent(se, hypot(a->se, b->se) / a->mean));
}

static void put_left_out(FILE *out, const bis_trade *t)
{
    int n = 0;
    for (int i = 0; i < t->plan.n_settings; i++) {
        const bis_trade_setting *s = &t->plan.settings[i];
        char time[24];
        if (!s->is_swept || s->levels) continue;
        fprintf(out, "%s%s (%s a pass)", n++ ? ", " : "<dt>left out</dt><dd>too slow for this much time: ", s->name, bis_trade_duration(time, s->pass_seconds));
    }
    if (n) fputs(".</dd>\n", out);
}

static void put_method(FILE *out, const bis_trade *t)
{
    char longest[24];

    fputs("<h2>How it was measured</h2><p>Everything here can be made again: <code>runs.csv</code> has each run with its seed.</p>\n<dl>\n", out);
    if (t->plan.step == 1) {
        fprintf(out, "<dt>picture</dt><dd>all %d &#215; %d pixels of the scene.</dd>\n", t->plan.full_width, t->plan.full_height);
    } else {
        fprintf(out, "<dt>picture</dt><dd>%d &#215; %d pixels of the scene&#39;s %d &#215; %d: of each %d &#215; %d the one in the middle, as large and as noisy as it is "
                "in the full picture. (A small picture of the whole would have larger pixels, with more edges in each, and more noise.) Hence the jagged outlines below. "
                "Only what learns from its neighbours does better in the full picture, where they are nearer.</dd>\n",
                t->plan.width, t->plan.height, t->plan.full_width, t->plan.full_height, t->plan.step, t->plan.step);
    }
    fputs("<dt>advice</dt><dd>Its error was measured with its own number of passes, in these pixels; with &#8220;extrapolated&#8221;, with fewer, and scaled by the root of their "
          "number. Its seconds are those of a pass of the full picture, or of as many of its pixels as there was time for, on this machine as it was loaded then.</dd>\n", out);
    fprintf(out, "<dt>runs</dt><dd>%zu of %zu: each setting with 1, 2, 4, ... passes up to %s, %d seed%s each, on %d thread%s.</dd>\n", t->n_runs,
            bis_trade_planned_runs(&t->plan), bis_trade_duration(longest, t->plan.run_seconds), t->plan.n_seeds, t->plan.n_seeds == 1 ? "" : "s", t->n_threads,
            t->n_threads == 1 ? "" : "s");
    fputs("<dt>error</dt><dd>the root of relMSE: the mean over pixels and channels of (a &#8722; b)&#178; / (b&#178; + m&#178;/100), b the "
          "reference, m its mean. "
          "100% means noise as strong as the picture.</dd>\n", out);
    fputs("<dt>cost &#215; variance</dt><dd>seconds &#215; relMSE. Twice the time halves the variance, so it hardly depends on the budget, and is what an error costs: a "
          "method with 2&#215; needs twice as long for the same picture.</dd>\n", out);
    put_reference(out, t, 0, "sir and rejection");
    put_reference(out, t, 1, "em, brdf and mis");
    put_agreement(out, t);
    put_left_out(out, t);
    fputs("<dt>doubt</dt><dd>Standard errors come from the seeds. Small lamps that a method seldom finds make its error look smaller than it is, until it does; "
          "other loads on the machine make everything slower.</dd>\n", out);
    fprintf(out, "<dt>by</dt><dd>bis %s, files trade.csv, pareto.csv, equal_time.csv, equal_error.csv, runs.csv.</dd>\n</dl>\n", BIS_VERSION);
}

/* ---- the page ---- */

static void put_head(FILE *out, const bis_trade *t)
{
    fputs("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n"
          "<title>Speed and accuracy: ", out);
    bis_trade_put_text(out, base_name(t->o.scene));
    fprintf(out, "</title>\n<style>\n%s", bis_trade_style);
}

static void put_top(FILE *out, const bis_trade *t)
{
    fputs("<main>\n<header>\n<p class=\"kicker\">bis trade</p>\n<h1>", out);
    bis_trade_put_text(out, base_name(t->o.scene));
    fputs("</h1>\n<p class=\"lede\">How long does each method take on this scene, and how far from right is the picture then?</p>\n", out);
    if (!t->is_complete) {
        fprintf(out, "<p class=\"note-box\">%zu of %zu planned runs were measured. <code>bis trade --resume</code> goes on.</p>\n", t->n_runs,
                bis_trade_planned_runs(&t->plan));
    }
    fputs("</header>\n<div class=\"advice\">\n", out);
    for (int i = 0; i < BIS_TRADE_ADVICE; i++) put_advice(out, t, &t->result.advice[i]);
    fputs("</div>\n", out);
}

static void put_plots(FILE *out, const bis_trade *t)
{
    fputs("<h2>Error over time</h2><p>Both scales are logarithmic. The lower a curve, the better; named is the best setting of each method, thin lines are the others.</p>\n"
          "<div class=\"panel\">\n", out);
    bis_trade_plot(out, t, false);
    fputs("</div>\n<div class=\"key\"><span>broad: the best at each time (Pareto front)</span><span>dotted: slope &#8722;1/2, four times the work for half the error</span>"
          "<span>bars: standard error from the seeds</span></div>\n", out);
    fputs("<details><summary>The same over rays</summary><p>What the picture would be like if rays were all that costs, as they nearly were in 2004. Candidates are no rays.</p>\n"
          "<div class=\"panel\">\n", out);
    bis_trade_plot(out, t, true);
    fputs("</div></details>\n", out);
    fputs("<h2>What an error costs</h2><p>Time to the same error, in multiples of the best. Scale: logarithmic; whiskers: standard error.</p>\n", out);
    bis_trade_put_costs(out, t);
}

static void put_pictures(FILE *out, const bis_trade *t)
{
    char time[24];

    if (t->n_strip == 0) return;
    fprintf(out, "<h2>The same time for each</h2><p>Each method had about %s. Below the picture two enlarged parts, the ones marked in the "
            "reference, and the error of each pixel.</p>\n",
            bis_trade_duration(time, t->plan.run_seconds));
    bis_trade_put_strips(out, t);
    fputs("<h2>Side by side</h2><p>Drag the line, or use the arrow keys.</p>\n", out);
    bis_trade_put_slider(out, t);
}

static void put_tables(FILE *out, const bis_trade *t)
{
    fputs("<h2>Equal time</h2><p>Relative error of each setting after so many seconds; "
          "~ is extrapolated by the root law; &#8211;: less than one pass, or a bias that forbids to extrapolate.</p>\n", out);
    bis_trade_put_equal_times(out, t);
    fputs("<h2>Equal error</h2><p>Seconds of rendering at the measured size until the relative error is so small.</p>\n", out);
    bis_trade_put_equal_errors(out, t);
    fputs("<h2>The Pareto front</h2><p>No other run was both faster and closer to the reference.</p>\n", out);
    bis_trade_put_front(out, t);
}

static bis_status put_page(FILE *out, const bis_trade *t, bis_diag *diag)
{
    put_head(out, t);
    const bis_status status = bis_trade_put_images(out, t, diag);
    fputs("</style>\n</head>\n<body>\n", out);
    put_top(out, t);
    if (t->result.n_points) {
        put_plots(out, t);
        put_pictures(out, t);
        put_tables(out, t);
    }
    put_method(out, t);
    fprintf(out, "</main>\n<script>\n%s</script>\n</body>\n</html>\n", bis_trade_script);
    return status;
}

bis_status bis_trade_write_report(const bis_trade *t, bis_diag *diag)
{
    char path[4096];
    bis_outfile *file;
    bis_status status = bis_outfile_open(&file, bis_trade_path(path, t, "report.html"), diag);

    if (status) return status;
    status = put_page(bis_outfile_stream(file), t, diag);
    if (!status) return bis_outfile_commit(file, diag);
    bis_outfile_abort(file);
    return status;
}
