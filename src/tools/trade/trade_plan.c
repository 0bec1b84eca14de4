/* SPDX-License-Identifier: BSD-2-Clause */
/* trade_plan: how many pixels, passes and seeds fit into the time?
 *
 * A small picture is not a large one made small: its pixels are larger, more of them hold an edge, and each is noisier
 * (scene.txt: 12% at 98 x 74 where 800 x 600 have 8%). So what is measured is a thin film: of each k x k pixels of the
 * full picture one, at its size, with its random numbers.
 * A pilot renders each setting with 3072 pixels or so, fewer where these take too long: what a pixel of a pass costs,
 * c, and what scatter it leaves, v.
 * What is planned from it:
 *   - the setting of least c v of each integrator, and the scene's own, get budgets of up to r seconds; the others r/4:
 *   cost x variance hardly
 *     changes along a curve, so a short one says nearly as much;
 *   - so few pixels that the middle one of the longer curves has some 8 passes, four budgets, at its end;
 *   - r such that all runs fill 50% of what is left of the time; the references get 22%, the pictures 6%, a pass of the
 *   full picture with what is advised as much (trade_seconds.c), as its error does (trade_check.c), and the rest is for
 *   surprises.
 * With --passes all of them get that many instead, however long that takes, and only the pixels depend on the clock, if
 * there are more than LEAST_PIXELS. */
#include "base/text.h"
#include "trade_plan.h"
#include "trade_scene.h"
#include "trade_settings.h"

#include <string.h>

enum { PROBE_PIXELS = 48, PILOT_PIXELS = 3072, LEAST_PIXELS = 4800, MIDDLE_PASSES = 8, MOST_PILOT_PASSES = 256 };

static const double pilot_share = 0.08, sweep_share = 0.5, reference_share = 0.22;
static const double short_curve = 0.25;     /* of r, for settings that are not the best of their integrator */
static const double too_slow = 4;           /* a setting whose single pass takes so many r is left out */

static const char *const reference_settings[2][3] = {
    {"mis 16", "mis 64", ""}, {"sir 64/4", "sir 256/16", "sir 256/16 product"}};

/* ---- the size, and what it takes ---- */

/* The thin film with about `pixels` in its crop; never more than that has, and one of each row and column at least. */
static int step_for(const bis_trade *t, double pixels)
{
    const bis_film all = bis_trade_film(t, 1);
    const double step = round(sqrt(bis_trade_pixels(t, 1) / pixels));
    return (int)fmax(1, fmin(step, fmin(all.width, all.height)));
}

static void set_size(bis_trade *t, double pixels)
{
    t->plan.step = step_for(t, pixels);
    const bis_film film = bis_trade_film(t, t->plan.step);
    t->plan.width = film.full_width;
    t->plan.height = film.full_height;
}

/* `least` are the seconds of a single pass of what is named, with all seeds. */
static bis_status too_few_seconds(const bis_trade *t, const char *what, double least, bis_diag *diag)
{
    char need[BIS_DURATION];

    bis_duration(need, 1.2 * (least / sweep_share + bis_clock_now() - t->start));
    return bis_error(diag, BIS_INPUT, (bis_loc){0},
                     "%g s are too few: a single pass of %s, %d x %d pixels and %d seeds, wants about %s in all; give "
                     "--time more than that, or name fewer integrators by --integrator",
                     t->o.seconds, what, t->plan.width, t->plan.height, t->plan.n_seeds, need);
}

/* ---- the pilot ---- */

bool bis_trade_may_be_reference(const bis_trade_setting *s, int which)
{
    for (int i = 0; i < 3; i++)
        if (strcmp(s->name, reference_settings[which][i]) == 0) return true;
    return false;
}

static bool is_piloted(const bis_trade_setting *s)
{
    return s->is_swept || bis_trade_may_be_reference(s, 0) || bis_trade_may_be_reference(s, 1);
}

/* What a pass costs whatever its size: that of a single pixel. */
static bis_status pilot_fill(bis_trade *t, bis_trade_setting *s, bis_diag *diag)
{
    enum { PASSES = 4 };
    bis_render_result result;

    bis_status status = bis_trade_render(t, &(bis_trade_job){s, 0, PASSES, t->o.seed}, NULL, &result, diag);
    s->fill_seconds = result.seconds / PASSES;
    return status;
}

/* What a pixel of a pass costs, by a film of so few pixels that the slowest setting is no long wait. What a pass costs
 * whatever its size does not count. 0: below what the clock tells. */
static bis_status probe(double *seconds, bis_trade *t, const bis_trade_setting *s, double pixels, bis_diag *diag)
{
    bis_render_result result;
    const int step = step_for(t, pixels);

    const bis_status status = bis_trade_render(t, &(bis_trade_job){s, step, 1, t->o.seed}, NULL, &result, diag);
    *seconds = fmax(0, result.seconds - s->fill_seconds) / bis_trade_pixels(t, step);
    return status;
}

/* The scene's own setting is always measured. If it takes more than the whole time, that is said at once. A second
 * probe confirms it, because the machine may have had other work. */
static bis_status check_scenes_own(bis_trade *t, bis_trade_setting *s, double *seconds, bis_diag *diag)
{
    bis_status status = BIS_OK;

    if (!s->is_scenes || !s->is_swept || t->o.passes) return BIS_OK;
    set_size(t, LEAST_PIXELS);
    const double most = sweep_share * t->o.seconds, passes = t->plan.n_seeds * bis_trade_pixels(t, t->plan.step);
    if (passes * *seconds <= most) return BIS_OK;
    status = probe(seconds, t, s, 4 * PROBE_PIXELS, diag);
    if (status || bis_trade_interrupted(t) || passes * *seconds <= most) return status;
    return too_few_seconds(t, "the scene's own setting", passes * *seconds, diag);
}

/* So many pixels that three passes fit into twice the setting's share of the time, but so many that what a pass costs
 * whatever its size is 1/16 of it, less than the pilot's scatter: it would count as the pixels' else. */
static double pilot_pixels(const bis_trade *t, const bis_trade_setting *s, double of_pixel, double seconds)
{
    if (t->o.passes || !(of_pixel > 0)) return PILOT_PIXELS;
    return fmin(PILOT_PIXELS, fmax(PROBE_PIXELS, fmax(2 * seconds / 3, 16 * s->fill_seconds) / of_pixel));
}

/* A probe, one pass to see what it costs, then as many as the setting's share of the time allows, 2 at least. Seconds
 * are those of a pixel until the size is known. */
static bis_status pilot_setting(bis_trade *t, bis_trade_setting *s, double seconds, bis_diag *diag)
{
    bis_render_result result;
    double of_pixel;

    bis_status status = pilot_fill(t, s, diag);
    if (!status) status = probe(&of_pixel, t, s, PROBE_PIXELS, diag);
    if (!status) status = check_scenes_own(t, s, &of_pixel, diag);
    if (status || bis_trade_interrupted(t)) return status;
    const int step = step_for(t, pilot_pixels(t, s, of_pixel, seconds));
    const double pixels = bis_trade_pixels(t, step);
    status = bis_trade_render(t, &(bis_trade_job){s, step, 1, t->o.seed}, NULL, &result, diag);
    if (status || result.interrupted) return status;
    s->pass_seconds = result.seconds / pixels;
    s->pass_relmse = (double)NAN;
    const uint32_t passes = (uint32_t)fmin(fmax(seconds / result.seconds, 2), MOST_PILOT_PASSES);
    status = bis_trade_render(t, &(bis_trade_job){s, step, passes, t->o.seed + 1}, NULL, &result, diag);
    if (status || result.interrupted) return status;
    s->pass_seconds = result.seconds / pixels / passes;
    s->pass_relmse = result.error.relative_rmse * result.error.relative_rmse * passes;
    return BIS_OK;
}

/* A pilot that takes more than the time for everything is not waited for. */
static bis_status check_pilot(const bis_trade *t, int done, int n, bis_diag *diag)
{
    char need[BIS_DURATION];
    const double elapsed = bis_clock_now() - t->start;

    if (t->o.passes || elapsed < t->o.seconds || bis_trade_interrupted(t)) return BIS_OK;
    bis_duration(need, elapsed / done * n);
    return bis_error(diag, BIS_INPUT, (bis_loc){0},
                     "%g s are too few: the pilot alone, a look at each of %d settings, wants about %s; give --time "
                     "some times that, or name fewer integrators by --integrator", t->o.seconds, n, need);
}

static bis_status run_pilot(bis_trade *t, bis_diag *diag)
{
    bis_trade_plan *plan = &t->plan;
    bis_status status = BIS_OK;
    int n = 0, done = 0;

    for (int i = 0; i < plan->n_settings; i++) n += is_piloted(&plan->settings[i]);
    for (int i = 0; i < plan->n_settings && !status && !bis_trade_interrupted(t); i++) {
        if (!is_piloted(&plan->settings[i])) continue;
        bis_trade_tell(t, "pilot", (double)done / n, (double)NAN);
        status = pilot_setting(t, &plan->settings[i], pilot_share * t->o.seconds / n, diag);
        done++;
        if (!status && done < n) status = check_pilot(t, done, n, diag);
    }
    return status;
}

/* ---- who is the best of the pilot? ---- */

static double pilot_cost(const bis_trade_setting *s) { return s->pass_seconds * s->pass_relmse; }

static bool is_better(const bis_trade_setting *a, const bis_trade_setting *b)
{
    if (a->is_biased != b->is_biased) return !a->is_biased;
    return pilot_cost(a) < pilot_cost(b) || isnan(pilot_cost(b));
}

/* Best of its integrator among the swept, or the scene's own. */
static bool gets_long_curve(const bis_trade_plan *plan, int i)
{
    const bis_trade_setting *s = &plan->settings[i];
    for (int k = 0; k < plan->n_settings; k++) {
        const bis_trade_setting *other = &plan->settings[k];
        if (k == i || !other->is_swept || other->settings.integrator != s->settings.integrator) continue;
        if (is_better(other, s)) return s->is_scenes;
    }
    return true;
}

/* ---- budgets ---- */

static int levels_of(const bis_trade *t, int i, double run_seconds)
{
    const bis_trade_setting *s = &t->plan.settings[i];

    if (!s->is_swept) return 0;
    if (t->o.passes) return ilogb(t->o.passes) + 1;
    const double passes = run_seconds * (gets_long_curve(&t->plan, i) ? 1 : short_curve) / s->pass_seconds;
    const int levels = 1 + (int)floor(log2(fmax(passes, 1)) + 0.5);
    if (passes * too_slow * (gets_long_curve(&t->plan, i) ? 4 : 1) < 1) return 0;
    return levels < BIS_TRADE_LEVELS ? levels : BIS_TRADE_LEVELS;
}

/* Of the whole sweep, were the longest runs to take so long; pass_seconds are of a pixel or of a pass, and so is the
 * sum. */
static double sweep_seconds(const bis_trade *t, double run_seconds)
{
    double sum = 0;
    for (int i = 0; i < t->plan.n_settings; i++)
        sum += t->plan.n_seeds * t->plan.settings[i].pass_seconds * (exp2(levels_of(t, i, run_seconds)) - 1);
    return sum;
}

static double longest_run(const bis_trade *t, double seconds)
{
    double lo = seconds * 1e-9, hi = seconds;
    for (int i = 0; i < 60; i++) {
        const double middle = sqrt(lo * hi);
        if (sweep_seconds(t, middle) <= seconds) lo = middle;
        else hi = middle;
    }
    return lo;
}

/* What the middle one of the long curves costs. */
static double middle_cost(const bis_trade_plan *plan)
{
    double cost[BIS_TRADE_SETTINGS];
    int n = 0;

    for (int i = 0; i < plan->n_settings; i++) {
        if (!plan->settings[i].is_swept || !gets_long_curve(plan, i)) continue;
        int at = n++;
        for (; at > 0 && cost[at - 1] > plan->settings[i].pass_seconds; at--) cost[at] = cost[at - 1];
        cost[at] = plan->settings[i].pass_seconds;
    }
    return cost[(n - 1) / 2];
}

static void choose_size(bis_trade *t, double seconds)
{
    bis_trade_plan *plan = &t->plan;
    const double a_pixel =
        sweep_seconds(t, MIDDLE_PASSES * middle_cost(plan)); /* seconds that each pixel adds to the sweep */
    const double pixels = fmin(fmax(seconds / a_pixel, LEAST_PIXELS), BIS_TRADE_MOST_PIXELS);

    set_size(t, pixels);
    for (int i = 0; i < plan->n_settings; i++) plan->settings[i].pass_seconds *= bis_trade_pixels(t, plan->step);
}

/* ---- references ---- */

static void choose_references(bis_trade *t, double seconds)
{
    bis_trade_plan *plan = &t->plan;
    bool needed[2] = {false, false};

    for (int i = 0; i < plan->n_settings; i++)
        needed[bis_trade_judge_of(&plan->settings[i])] |= plan->settings[i].is_swept;
    for (int k = 0; k < 2; k++) {
        plan->reference[k] = -1;
        if (plan->is_given || !needed[k]) continue;
        for (int i = 0; i < plan->n_settings; i++) {
            const bis_trade_setting *s = &plan->settings[i];
            if (!bis_trade_may_be_reference(s, k)) continue;
            if (plan->reference[k] < 0 || is_better(s, &plan->settings[plan->reference[k]])) plan->reference[k] = i;
        }
        const double share = seconds / (needed[0] + needed[1]) / BIS_TRADE_REPLICATES;
        plan->reference_passes[k] =
            (uint32_t)fmin(fmax(share / plan->settings[plan->reference[k]].pass_seconds, 1), BIS_TRADE_MOST_PASSES);
        if (t->o.passes) plan->reference_passes[k] = BIS_TRADE_REFERENCE_BUDGETS * t->o.passes;
    }
}

/* ---- can it be done? ---- */

/* One pass of each integrator's best for each seed is the least that says anything. */
static bis_status check_time(const bis_trade *t, double seconds, bis_diag *diag)
{
    double least = 0;

    for (int i = 0; i < t->plan.n_settings; i++)
        if (t->plan.settings[i].is_swept && gets_long_curve(&t->plan, i))
            least += t->plan.n_seeds * t->plan.settings[i].pass_seconds;
    if (least <= seconds || t->o.passes) return BIS_OK;
    return too_few_seconds(t, "the best setting of each integrator", least, diag);
}

/* The best of the pilot in one run of the sweep. */
static bis_status check_error(const bis_trade *t, bis_diag *diag)
{
    const bis_trade_plan *plan = &t->plan;
    char need[24], whole[24];
    double seconds = HUGE_VAL;
    int best = 0;

    if (t->o.error <= 0 || t->o.passes) return BIS_OK;
    for (int i = 0; i < plan->n_settings; i++) {
        const bis_trade_setting *s = &plan->settings[i];
        const double it = fmax(1, s->pass_relmse / (t->o.error * t->o.error)) * s->pass_seconds;
        if (!s->is_swept || s->is_biased || !(it < seconds)) continue;
        seconds = it;
        best = i;
    }
    const double slack = 2; /* budgets are doubled, and a pilot is short */
    if (seconds <= slack * plan->run_seconds) return BIS_OK;
    bis_duration(need, seconds);
    bis_duration(whole, t->o.seconds * seconds / plan->run_seconds);
    return bis_error(
        diag, BIS_INPUT, (bis_loc){0},
        "a relative error of %g is out of reach: by the pilot \"%s\", the best, needs about %s for one picture of %d "
        "x %d pixels, and in %g s of measurement a run gets %.2g s. Give --error %.2g or more, or --time for about %s",
        t->o.error, plan->settings[best].name, need, plan->width, plan->height, t->o.seconds, plan->run_seconds,
        t->o.error * sqrt(seconds / plan->run_seconds), whole);
}

size_t bis_trade_planned_runs(const bis_trade_plan *plan)
{
    size_t n = 0;
    for (int i = 0; i < plan->n_settings; i++) n += (size_t)(plan->settings[i].levels * plan->n_seeds);
    return n;
}

double bis_trade_planned_seconds(const bis_trade_plan *plan, int setting, int level)
{
    return plan->settings[setting].pass_seconds * exp2(level);
}

static int seeds_for(const bis_trade_options *o)
{
    if (o->n_seeds) return o->n_seeds;
    if (o->quick) return 2;
    return o->seconds >= 600 ? 5 : 3;
}

bis_status bis_trade_fit_plan(bis_trade *t, double left, bis_diag *diag)
{
    bis_trade_plan *plan = &t->plan;
    const double sweep = sweep_share * left;

    choose_size(t, sweep);
    bis_status status = check_time(t, sweep, diag);
    if (status) return status;
    plan->run_seconds = longest_run(t, sweep);
    double longest = 0;
    for (int i = 0; i < plan->n_settings; i++) {
        plan->settings[i].levels = levels_of(t, i, plan->run_seconds);
        if (plan->settings[i].levels)
            longest = fmax(longest, bis_trade_planned_seconds(plan, i, plan->settings[i].levels - 1));
    }
    if (t->o.passes) plan->run_seconds = longest;
    choose_references(t, reference_share * left);
    return check_error(t, diag);
}

bis_status bis_trade_make_plan(bis_trade *t, bis_diag *diag)
{
    t->plan.is_given = t->o.reference != NULL;
    t->plan.seed = t->o.seed;
    t->plan.n_seeds = seeds_for(&t->o);
    const bis_status status = run_pilot(t, diag);
    if (status || bis_trade_interrupted(t)) return status;
    return bis_trade_fit_plan(t, fmax(t->o.seconds - (bis_clock_now() - t->start), 0.1 * t->o.seconds), diag);
}
