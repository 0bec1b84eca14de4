/* SPDX-License-Identifier: BSD-2-Clause */
/* trade_stats: from runs to points, curves and the Pareto front.
 *
 * A point is a setting at one budget: the mean over its seeds, and their scatter. Seconds are a median, since what
 * disturbs a clock only ever adds. relMSE = the error of the run + that of the reference, which are independent: of the
 * relMSE from both references' mean their own share, known from their replicates, is subtracted, and what is left is
 * called noise. cost x variance = seconds x noise hardly changes along the curve of an unbiased method (errata.md E9),
 * and is what an error costs: smaller is better. The bias is the mean over seeds of the mean difference; its standard
 * error comes from the seeds and the reference. Pixels of a run share their candidates, so their scatter within one run
 * would say too little. A slope is fitted to each seed by least squares, log error over log seconds: -1/2 for
 * independent samples; its standard error is that of the seeds, and not known from fewer than three. */
#include "trade_advice.h"
#include "trade_files.h"
#include "trade_settings.h"
#include "trade_stats.h"

#include "bis/base/mem.h"

enum {
    LEAST_BUDGETS = 3, /* for a slope */
    LEAST_SLOPES = 3   /* for its standard error: two slopes are often alike by chance, and would claim to be sure */
};

/* ---- sums over seeds ---- */

typedef struct seeds {
    double value[BIS_TRADE_SEEDS];
    int n;
} seeds;

static double mean_of(const seeds *s)
{
    double sum = 0;
    for (int i = 0; i < s->n; i++) sum += s->value[i];
    return sum / s->n;
}

/* Standard error of the mean; NAN from one. */
static double se_of(const seeds *s)
{
    const double mean = mean_of(s);
    double m2 = 0;
    for (int i = 0; i < s->n; i++) m2 += (s->value[i] - mean) * (s->value[i] - mean);
    return s->n > 1 ? sqrt(m2 / (s->n - 1) / s->n) : (double)NAN;
}

static double median_of(seeds s)
{
    for (int i = 1; i < s.n; i++) {
        const double v = s.value[i];
        int at = i;
        for (; at > 0 && s.value[at - 1] > v; at--) s.value[at] = s.value[at - 1];
        s.value[at] = v;
    }
    return (s.value[(s.n - 1) / 2] + s.value[s.n / 2]) / 2;
}

/* ---- points ---- */

static const bis_trade_reference *reference_of(const bis_trade *t, int setting)
{
    return &t->references[bis_trade_judge_of(&t->plan.settings[setting])];
}

/* n = 0 where no seed was measured. */
static bis_trade_point point_of(const bis_trade *t, int setting, int level)
{
    const bis_trade_reference *ref = reference_of(t, setting);
    bis_trade_point p = {.setting = setting, .level = level, .passes = (uint32_t)1 << level};
    seeds seconds = {.n = 0}, relmse = {.n = 0}, both = {.n = 0}, bias = {.n = 0};
    double squares = 0;

    for (size_t i = 0; i < t->n_runs; i++) {
        const bis_trade_run *r = &t->runs[i];
        if (r->setting != setting || r->level != level) continue;
        seconds.value[seconds.n++] = r->seconds;
        relmse.value[relmse.n++] = r->relmse;
        both.value[both.n++] = r->relmse_both;
        bias.value[bias.n++] = r->bias;
        squares += r->rmse * r->rmse;
        p.camera_rays += (double)r->camera_rays;
        p.shadow_rays += (double)r->shadow_rays;
        p.candidates += (double)r->candidates;
    }
    p.n = seconds.n;
    if (p.n == 0) return p;
    p.camera_rays /= p.n;
    p.shadow_rays /= p.n;
    p.candidates /= p.n;
    p.seconds = median_of(seconds);
    p.rmse = sqrt(squares / p.n);
    p.relmse = mean_of(&relmse);
    p.relmse_se = se_of(&relmse);
    p.noise = mean_of(&both) - t->both.relmse;
    p.noise_se = se_of(&both);
    p.bias = mean_of(&bias);
    p.bias_se = hypot(se_of(&bias), ref->se);
    p.cost_variance = p.seconds * p.noise;
    return p;
}

/* Not dominated: no other point is as fast and as right, and better in one of the two. */
static void find_front(bis_trade_result *r)
{
    for (int i = 0; i < r->n_points; i++) {
        bis_trade_point *p = &r->points[i];
        p->on_front = true;
        for (int k = 0; k < r->n_points && p->on_front; k++) {
            const bis_trade_point *q = &r->points[k];
            const bool as_good = q->seconds <= p->seconds && q->noise <= p->noise,
                       better = q->seconds < p->seconds || q->noise < p->noise;
            if (as_good && better) p->on_front = false;
        }
    }
}

/* ---- curves ---- */

/* Of one seed: seconds x noise, mean over its budgets weighted by their passes, since a rare bright sample upsets a
 * short run most; slope of log error over log seconds, NAN where there are too few budgets. Points that the reference's
 * noise all but hides tell nothing of a slope. */
static bool follow_seed(const bis_trade *t, int setting, int replicate, double *cost_variance, double *slope)
{
    const double floor = t->both.relmse;
    double passes = 0, cost = 0, fitted = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;

    for (int level = 0; level < t->plan.settings[setting].levels; level++) {
        const bis_trade_run *r = bis_trade_find_run(t, setting, level, replicate);
        if (!r) continue;
        passes += exp2(level);
        cost += exp2(level) * r->seconds * (r->relmse_both - floor);
        if (!(r->relmse_both - floor > floor / 4) || r->seconds <= 0) continue;
        const double x = log(r->seconds), y = log(r->relmse_both - floor) / 2;
        fitted++;
        sx += x;
        sy += y;
        sxx += x * x;
        sxy += x * y;
    }
    if (!(passes > 0)) return false;
    const double spread = sxx - sx * sx / fmax(fitted, 1);
    *cost_variance = cost / passes;
    *slope = fitted >= LEAST_BUDGETS && spread > 0 ? (sxy - sx * sy / fitted) / spread : (double)NAN;
    return true;
}

static void follow_curve(bis_trade *t, int setting)
{
    bis_trade_curve *c = &t->result.curves[setting];
    seeds cost = {.n = 0}, slope = {.n = 0};

    for (int k = 0; k < t->plan.n_seeds; k++) {
        double cv, m;
        if (!follow_seed(t, setting, k, &cv, &m)) continue;
        cost.value[cost.n++] = cv;
        if (!isnan(m)) slope.value[slope.n++] = m;
    }
    c->cost_variance = mean_of(&cost);
    c->cost_variance_se = se_of(&cost);
    c->slope = slope.n ? mean_of(&slope) : (double)NAN;
    c->slope_se = slope.n >= LEAST_SLOPES ? se_of(&slope) : (double)NAN;
    const bis_trade_point *last = &t->result.points[c->first + c->n - 1];
    c->pass_seconds = last->seconds / last->passes;
}

bis_status bis_trade_summarise(bis_trade *t, bis_diag *diag)
{
    bis_trade_result *r = &t->result;

    r->points = bis_alloc((size_t)BIS_TRADE_SETTINGS * BIS_TRADE_LEVELS, sizeof *r->points);
    if (!r->points) return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for the points of a sweep");
    for (int i = 0; i < t->plan.n_settings; i++) {
        r->curves[i].first = r->n_points;
        for (int level = 0; level < t->plan.settings[i].levels; level++) {
            r->points[r->n_points] = point_of(t, i, level);
            r->n_points += r->points[r->n_points].n > 0;
        }
        r->curves[i].n = r->n_points - r->curves[i].first;
        if (r->curves[i].n) follow_curve(t, i);
    }
    find_front(r);
    bis_trade_advise(t);
    return BIS_OK;
}
