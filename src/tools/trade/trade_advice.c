/* SPDX-License-Identifier: BSD-2-Clause */
/* trade_advice: what to use. Errors at a time, times to an error, the best of each integrator, and three
 * recommendations.
 *
 * Between two budgets of a curve log error is linear in log seconds; beyond the last one an unbiased method goes on
 * by the root law, error ~ seconds^-1/2 (errata.md E9), which is said wherever such a figure is shown. A biased one
 * has a floor that nobody has seen: no figure. Below one pass there is no picture. For the advice passes are counted,
 * since a render has whole ones, on a square grid: the fewest that reach the error by cost x variance, of whatever
 * setting needs the least time for them, standard error added, in the full picture. Half of a pixel's value will do
 * for a preview, and 5% for the eye. */
#include "trade_advice.h"
#include "trade_stats.h"

#include <string.h>

static const double most_extrapolation = 64; /* in time: an eighth of the error */

static bool is_measured(const bis_trade *t, int setting) { return t->result.curves[setting].n > 0; }

/* Log-log interpolation of y over x between a and b at `at`; a's y where one has no logarithm. */
static double between(double xa, double ya, double xb, double yb, double at)
{
    if (!(xa > 0 && ya > 0 && yb > 0 && xb > xa)) return ya;
    const double s = log(at / xa) / log(xb / xa);
    return ya * pow(yb / ya, s);
}

static double error_of(const bis_trade_point *p) { return sqrt(fmax(0, p->noise)); }

double bis_trade_error_at(const bis_trade_result *r, const bis_trade_plan *plan, int setting, double seconds,
                          bool *extrapolated)
{
    const bis_trade_curve *c = &r->curves[setting];
    const bis_trade_point *p = r->points + c->first;

    *extrapolated = false;
    if (c->n == 0 || seconds < p[0].seconds) return (double)NAN;
    for (int i = 0; i + 1 < c->n; i++)
        if (seconds < p[i + 1].seconds)
            return between(p[i].seconds, error_of(&p[i]), p[i + 1].seconds, error_of(&p[i + 1]), seconds);
    const double factor = seconds / p[c->n - 1].seconds;
    *extrapolated = factor > 1;
    if (factor > most_extrapolation || (plan->settings[setting].is_biased && factor > 1)) return (double)NAN;
    return error_of(&p[c->n - 1]) / sqrt(factor);
}

double bis_trade_seconds_to(const bis_trade_result *r, const bis_trade_plan *plan, int setting, double error,
                            bool *extrapolated)
{
    const bis_trade_curve *c = &r->curves[setting];
    const bis_trade_point *p = r->points + c->first;

    *extrapolated = false;
    if (c->n == 0) return (double)NAN;
    if (error_of(&p[0]) <= error) return p[0].seconds;
    for (int i = 0; i + 1 < c->n; i++) {
        if (error_of(&p[i + 1]) > error) continue;
        return between(error_of(&p[i + 1]), p[i + 1].seconds, error_of(&p[i]), p[i].seconds, error);
    }
    const double factor = pow(error_of(&p[c->n - 1]) / error, 2);
    *extrapolated = true;
    if (factor > most_extrapolation || plan->settings[setting].is_biased) return (double)NAN;
    return p[c->n - 1].seconds * factor;
}

/* ---- the best ---- */

/* cost x variance and its standard error: of thirty settings the least figure is often that of the luckiest, which has
 * a large one. */
static double rank_of(const bis_trade *t, int setting)
{
    const bis_trade_curve *c = &t->result.curves[setting];
    return c->cost_variance + (c->cost_variance_se > 0 ? c->cost_variance_se : 0);
}

int bis_trade_best_of(const bis_trade *t, const char *integrator)
{
    int best = -1;
    for (int i = 0; i < t->plan.n_settings; i++) {
        if (!is_measured(t, i)) continue;
        if (integrator && strcmp(t->plan.settings[i].settings.integrator->name, integrator) != 0) continue;
        if (!integrator && t->plan.settings[i].is_biased) continue;
        if (best < 0 || rank_of(t, i) < rank_of(t, best)) best = i;
    }
    return best;
}

int bis_trade_heads(const bis_trade *t, int setting[BIS_TRADE_STRIP])
{
    int n = 0;
    for (int i = 0; i < t->plan.n_settings && n < BIS_TRADE_STRIP; i++) {
        const bis_trade_setting *s = &t->plan.settings[i];
        if (is_measured(t, i) && (s->is_scenes || bis_trade_best_of(t, s->settings.integrator->name) == i))
            setting[n++] = i;
    }
    return n;
}

bool bis_trade_is_head(const bis_trade *t, int setting)
{
    int heads[BIS_TRADE_STRIP];
    for (int i = bis_trade_heads(t, heads) - 1; i >= 0; i--)
        if (heads[i] == setting) return true;
    return false;
}

/* ---- advice ---- */

/* Of a pass of the full picture: what any pass takes, and the rest in proportion to the pixels. */
static double full_pass_seconds(const bis_trade *t, int setting)
{
    const bis_trade_plan *plan = &t->plan;
    const double pixels = (double)plan->full_width * plan->full_height / ((double)plan->width * plan->height);
    const double pass = t->result.curves[setting].pass_seconds, fill = fmin(plan->settings[setting].fill_seconds, pass);

    return fill + (pass - fill) * pixels;
}

uint32_t bis_trade_square_passes(const bis_trade *t, double least)
{
    const double most = 1e9, n = fmin(fmax(ceil(least), 1), most);
    if (t->desc->view.sampler.kind != BIS_SAMPLER_STRATIFIED) return (uint32_t)n;
    const double side = ceil(sqrt(n));
    return (uint32_t)(side * (side - 1) >= n ? side * (side - 1) : side * side);
}

/* The least time in which a setting has the error, in whole passes: cost x variance is what an error costs, whatever
 * the budget. */
static bis_trade_advice advice_of(const bis_trade *t, int setting, const char *purpose, double error)
{
    const bis_trade_curve *c = &t->result.curves[setting];
    const double variance = fmax(0, c->cost_variance) / c->pass_seconds, least = variance / (error * error);
    const uint32_t passes = bis_trade_square_passes(t, least);

    return (bis_trade_advice){
        .purpose = purpose,
        .error = error,
        .setting = least < 1e9 ? setting : -1,
        .passes = passes,
        .seconds = passes * full_pass_seconds(t, setting),
        .expected_error = sqrt(variance / passes),
        .is_extrapolated = passes > t->result.points[c->first + c->n - 1].passes,
    };
}

static bis_trade_advice advise_for(const bis_trade *t, const char *purpose, double error)
{
    bis_trade_advice best = {.purpose = purpose, .error = error, .setting = -1};
    double least = 0;

    for (int i = 0; i < t->plan.n_settings; i++) {
        if (!is_measured(t, i) || t->plan.settings[i].is_biased) continue;
        const bis_trade_advice a = advice_of(t, i, purpose, error);
        const double doubt =
            t->result.curves[i].cost_variance > 0 ? rank_of(t, i) / t->result.curves[i].cost_variance : 1;
        if (a.setting < 0 || (best.setting >= 0 && a.seconds * doubt >= least)) continue;
        best = a;
        least = a.seconds * doubt;
    }
    return best;
}

void bis_trade_advise(bis_trade *t)
{
    const double final = t->o.error > 0 ? t->o.error : 0.05;

    t->result.best = bis_trade_best_of(t, NULL);
    t->result.advice[0] = advise_for(t, "preview", fmax(0.5, final));
    t->result.advice[1] = advise_for(t, "good picture", fmax(0.15, final));
    t->result.advice[2] = advise_for(t, "final picture", final);
}

/* ---- columns ---- */

/* Halves of the longest runs' time, as far as some setting has a picture by then. */
int bis_trade_times(const bis_trade *t, double seconds[BIS_TRADE_COLUMNS])
{
    double least = t->plan.run_seconds;
    int n = 0;

    for (int i = 0; i < t->result.n_points; i++) least = fmin(least, t->result.points[i].seconds);
    for (int i = 0; i < BIS_TRADE_COLUMNS; i++) {
        const double at = t->plan.run_seconds * exp2(1 + i - BIS_TRADE_COLUMNS);
        if (at >= least) seconds[n++] = at;
    }
    return n;
}

/* Of 1, 2, 5, 10, ... percent, those that some setting reaches with what was measured or a little more. */
int bis_trade_errors(const bis_trade *t, double error[BIS_TRADE_COLUMNS])
{
    static const double steps[] = {0.001, 0.002, 0.005, 0.01, 0.02, 0.03, 0.05, 0.1, 0.15, 0.2, 0.3, 0.5, 1, 2, 5};
    double least = 1e30;
    int n = 0;

    for (int i = 0; i < t->result.n_points; i++)
        if (t->result.points[i].noise > 0) least = fmin(least, error_of(&t->result.points[i]));
    for (size_t i = 0; i < sizeof steps / sizeof *steps && n < BIS_TRADE_COLUMNS; i++)
        if (steps[i] >= least / 4) error[n++] = steps[i];
    return n;
}
