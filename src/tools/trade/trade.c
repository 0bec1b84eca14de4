/* SPDX-License-Identifier: BSD-2-Clause */
/* trade: the measurement from the scene to the page.
 *
 * The runs of a sweep are made in rounds: all settings at one budget with one seed, then the next seed, then the next
 * budget. What else the machine does meanwhile then hits all settings alike, and a sweep that ends early, by Ctrl-C or
 * because the time is used up, has measured all of them equally far. Each run has a seed of its own, written beside it:
 * no two settings share noise. */
#include "base/text.h"
#include "trade_advice.h"
#include "trade_files.h"
#include "trade_page.h"
#include "trade_pictures.h"
#include "trade_plan.h"
#include "trade_scene.h"
#include "trade_settings.h"
#include "trade_stats.h"
#include "trade_tables.h"

#include "bis/tools/compare.h"
#include "bis/base/mem.h"
#include "bis/files/image_file.h"

#include <string.h>
#include <unistd.h>

static const double pictures_share = 0.2; /* of the time, kept back for the advice, the pictures and the page */
static const double seconds_between_writes = 1;

/* ---- one run ---- */

static bis_status measure_run(bis_trade *t, int setting, int level, int replicate, bool *complete, bis_diag *diag)
{
    const bis_trade_setting *s = &t->plan.settings[setting];
    const int place = (setting * BIS_TRADE_LEVELS + level) * BIS_TRADE_SEEDS + replicate;
    bis_trade_run run = {.setting = setting, .level = level, .replicate = replicate,
                         .seed = bis_trade_seed(&t->plan, 1, (uint64_t)place)};
    bis_image image = {0};
    bis_comparison c, both;
    bis_render_result result;

    const bis_trade_job job = {s, t->plan.step, (uint32_t)1 << level, run.seed};
    bis_status status = bis_trade_render(t, &job, &image, &result, diag);
    *complete = !status && !result.interrupted;
    if (*complete) status = bis_compare(&c, &image, &t->references[bis_trade_judge_of(s)].image, diag);
    if (!status && *complete) status = bis_compare(&both, &image, &t->both.image, diag);
    bis_image_clear(&image);
    if (status || !*complete) return status;
    run.seconds = result.seconds;
    run.camera_rays = result.counters.camera_rays;
    run.shadow_rays = result.counters.shadow_rays;
    run.candidates = result.counters.candidates;
    run.rmse = c.rmse;
    run.relmse = c.relmse;
    run.bias = c.bias;
    run.relmse_both = both.relmse;
    return bis_trade_add_run(t, &run, diag);
}

/* ---- the sweep ---- */

/* Seconds of the runs that are still to be made, as planned. */
static double planned_left(const bis_trade *t)
{
    double sum = 0;
    for (int i = 0; i < t->plan.n_settings; i++) {
        for (int level = 0; level < t->plan.settings[i].levels; level++)
            sum += t->plan.n_seeds * bis_trade_planned_seconds(&t->plan, i, level);
    }
    for (size_t i = 0; i < t->n_runs; i++)
        sum -= bis_trade_planned_seconds(&t->plan, t->runs[i].setting, t->runs[i].level);
    return fmax(sum, 0);
}

typedef struct sweep {
    double start, planned, last_write; /* planned: seconds of what was missing at its start */
    bool is_over;
} sweep;

/* Time left from what the plan thought and what it took so far. */
static void tell_sweep(const bis_trade *t, const sweep *w)
{
    char what[BIS_TRADE_NAME + 32];
    const double left = planned_left(t), done = w->planned - left, spent = bis_clock_now() - w->start;
    snprintf(what, sizeof what, "run %zu of %zu", t->n_runs + 1, bis_trade_planned_runs(&t->plan));
    bis_trade_tell(t, what, w->planned > 0 ? done / w->planned : 1, done > 0 ? left * spent / done : left);
}

/* The runs of one round that are not there yet. */
static bis_status sweep_round(bis_trade *t, sweep *w, int level, int replicate, bis_diag *diag)
{
    const double deadline = t->start + t->o.seconds * (1 - pictures_share);

    for (int i = 0; i < t->plan.n_settings; i++) {
        bool complete;
        if (level >= t->plan.settings[i].levels || bis_trade_find_run(t, i, level, replicate)) continue;
        if (!t->o.passes && bis_clock_now() + bis_trade_planned_seconds(&t->plan, i, level) > deadline) {
            w->is_over = true;
            return BIS_OK;
        }
        tell_sweep(t, w);
        bis_status status = measure_run(t, i, level, replicate, &complete, diag);
        if (status) return status;
        if (!complete) return BIS_OK;
        if (bis_clock_now() - w->last_write < seconds_between_writes) continue;
        w->last_write = bis_clock_now();
        status = bis_trade_write_runs(t, diag);
        if (status) return status;
    }
    return BIS_OK;
}

static bis_status run_sweep(bis_trade *t, bis_diag *diag)
{
    sweep w = {.start = bis_clock_now(), .planned = planned_left(t)};
    bis_status status = BIS_OK;

    for (int level = 0; level < BIS_TRADE_LEVELS; level++) {
        for (int replicate = 0; replicate < t->plan.n_seeds; replicate++) {
            if (status || w.is_over || bis_trade_interrupted(t)) break;
            status = sweep_round(t, &w, level, replicate, diag);
        }
    }
    const bis_status written = bis_trade_write_runs(t, diag); /* what was measured, whatever happened */
    t->is_complete = t->n_runs == bis_trade_planned_runs(&t->plan);
    return status ? status : written;
}

/* ---- a given reference ---- */

static bis_status read_reference(bis_image *full, const bis_trade *t, bis_diag *diag)
{
    const bis_film film = bis_trade_film(t, 1);
    bis_image_place at;
    bis_status status = bis_image_read_part(full, NULL, &at, t->o.reference, (bis_loc){0}, diag);

    if (!status && (at.full_width != full->width || at.full_height != full->height) &&
        (at.x0 != film.x0 || at.y0 != film.y0))
        return bis_error(diag, BIS_INPUT, (bis_loc){t->o.reference, 0, 0},
                         "the reference is the crop at (%d, %d), the scene's is at (%d, %d)", at.x0, at.y0, film.x0,
                         film.y0);
    if (status || (full->width == film.width && full->height == film.height)) return status;
    return bis_error(diag, BIS_INPUT, (bis_loc){t->o.reference, 0, 0},
                     "the reference has %d x %d pixels, the scene's picture has %d x %d; give --resolution %dx%d, or a "
                     "reference of the scene's size",
                     full->width, full->height, film.width, film.height, full->width, full->height);
}

/* The pixels of the given reference that the plan has, stays in the folder. */
static bis_status keep_reference(const bis_trade *t, const bis_image *full, bis_diag *diag)
{
    const bis_film all = bis_trade_film(t, 1), some = bis_trade_film(t, t->plan.step);
    char path[4096];
    bis_image small;

    bis_status status = bis_trade_make_folder(t, "references", diag);
    if (!status) status = bis_trade_thin(&small, full, &all, &some, diag);
    if (status) return status;
    status = bis_image_save(&small, bis_trade_path(path, t, "references/given.exr"), diag);
    bis_image_clear(&small);
    return status;
}

/* Only what is unbiased is advised. That is known before the first pass, so nobody waits for a page without advice. */
static bis_status check_unbiased(const bis_trade *t, bis_diag *diag)
{
    for (int i = 0; i < t->plan.n_settings; i++)
        if (t->plan.settings[i].is_swept && !t->plan.settings[i].is_biased) return BIS_OK;
    return bis_error(diag, BIS_INPUT, (bis_loc){0},
                     "all settings to be measured are biased (the ratio estimator of rejection), so there would be no "
                     "advice; name another integrator, too, by --integrator%s",
                     t->o.quick ? ", or leave out --quick" : "");
}

static bis_status make_plan(bis_trade *t, bis_diag *diag)
{
    bis_image given = {0};
    bis_status status = check_unbiased(t, diag);

    t->plan.full_width = t->desc->view.film.width;
    t->plan.full_height = t->desc->view.film.height;
    if (!status && t->o.reference) status = read_reference(&given, t, diag);
    if (!status) status = bis_trade_make_plan(t, diag);
    if (!status && t->o.reference && !bis_trade_interrupted(t)) status = keep_reference(t, &given, diag);
    if (!status && !bis_trade_interrupted(t)) status = bis_trade_write_plan(t, diag);
    bis_image_clear(&given);
    return status;
}

/* ---- all of it ---- */

static bool references_are_ready(const bis_trade *t)
{
    for (int i = 0; i < t->plan.n_settings; i++) {
        const bis_trade_setting *s = &t->plan.settings[i];
        if (s->levels && !t->references[bis_trade_judge_of(s)].is_ready) return false;
    }
    return true;
}

static bool has_page(const bis_trade *t)
{
    char path[4096];
    return access(bis_trade_path(path, t, "report.html"), F_OK) == 0;
}

/* A page without a run would be a page without an answer. The plan and its references stay for --resume. */
static bis_status nothing_measured(const bis_trade *t, bis_diag *diag)
{
    char need[BIS_DURATION];

    bis_duration(need, bis_clock_now() - t->start + planned_left(t) / (1 - pictures_share));
    return bis_error(diag, BIS_INPUT, (bis_loc){0},
                     "0 of %zu runs: none fitted into %g s, so there is no advice and no page; go on with --resume "
                     "--time for about %s, or measure into another folder with fewer integrators (--integrator)",
                     bis_trade_planned_runs(&t->plan), t->o.seconds, need);
}

static bis_status measure(bis_trade *t, bis_diag *diag)
{
    bis_status status = bis_trade_load(t, diag);
    if (!status && t->o.resume) status = bis_trade_read_plan(t, diag);
    else if (!status) status = make_plan(t, diag);
    if (status || (bis_trade_interrupted(t) && !t->o.resume)) return status;
    if (t->o.resume) status = bis_trade_read_runs(t, diag);
    const size_t known = t->n_runs;
    if (!status) status = bis_trade_make_references(t, diag);
    if (status || !references_are_ready(t)) return status; /* interrupted: a plan without them is none */
    status = run_sweep(t, diag);
    if (status) return status;
    if (!t->n_runs && !bis_trade_interrupted(t)) return nothing_measured(t, diag);
    status = bis_trade_summarise(t, diag);
    if (!status) status = bis_trade_check_advice(t, diag);
    if (!status) status = bis_trade_time_advice(t, diag);
    if (!status) status = bis_trade_make_pictures(t, diag);
    if (bis_trade_interrupted(t) && t->n_runs == known && has_page(t)) return status; /* its advice was proven */
    if (!status) status = bis_trade_write_tables(t, diag);
    if (!status) status = bis_trade_write_report(t, diag);
    t->is_reported = !status;
    return status;
}

bis_status bis_trade_measure(bis_trade *t, const bis_trade_options *o, bool *interrupted, bis_diag *diag)
{
    t->o = *o;
    t->start = bis_clock_now();
    bis_status status = bis_trade_check_folder(t, diag);
    if (!status) status = measure(t, diag);
    *interrupted = bis_trade_interrupted(t);
    if (t->made_folder) rmdir(o->folder); /* goes only where nothing was written */
    return status;
}

void bis_trade_clear(bis_trade *t)
{
    for (int i = 0; i < t->n_strip; i++) bis_image_clear(&t->strip[i].image);
    for (int k = 0; k < 2; k++) bis_image_clear(&t->references[k].image);
    bis_image_clear(&t->both.image);
    bis_free(t->result.points);
    bis_free(t->runs);
    bis_trade_unload(t);
    *t = (bis_trade){.n_runs = 0};
}
