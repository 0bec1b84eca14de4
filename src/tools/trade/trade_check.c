/* trade_check: what error does the advised number of passes really leave?
 *
 * The advice comes from the mean cost x variance of a curve's budgets, most of them far shorter than what is advised. The
 * root law that leads from there to the advice is that of independent samples. A stratified camera does better: at an
 * edge the error falls faster, and what the short budgets say is too much (scene.txt: twice the passes). So the advised
 * setting is rendered with the advised passes, in the pixels of the sweep, with seeds of its own, as often as
 * `check_share` of the time allows. Its noise, as a run's, says how many passes are right; when these are others by more
 * than `close_enough`, they are measured in turn. Where even one such render takes too long, it gets the passes that
 * there is time for, and the rest is the root law's, which is said. With --passes, which asks for no clock, there are two
 * renders of the advised passes, up to 64 times those of the longest budget, however long they take. */
#include "trade.h"

#include "bis/tools/compare.h"

enum { MOST_RENDERS = 8, MOST_TURNS = 4, RENDERS_BY_PASSES = 2, MOST_BUDGETS = 64 };

static const double check_share = 0.03;   /* of the time, for each advice */
static const double close_enough = 1.15;  /* in passes: 7% in error */

static uint64_t seed_of(const bis_trade *t, int advice, int turn, int render)
{
    return bis_hash(bis_hash(t->plan.seed + 3) + (uint64_t)((advice * MOST_TURNS + turn) * MOST_RENDERS + render)) >> 11;
}

typedef struct check {
    double start, seconds; /* allowed */
    int advice, turn;
} check;

static double left(const check *c) { return c->start + c->seconds - bis_clock_now(); }

/* *variance: relMSE times passes, less the references' part, mean over as many renders as there is time for; NAN: none
 * was complete. */
static bis_status measure(double *variance, bis_trade *t, const check *c, const bis_trade_setting *s, uint32_t passes, double each, bis_diag *diag)
{
    bis_status status = BIS_OK;
    double sum = 0;
    int n = 0;

    const int least = t->o.passes ? RENDERS_BY_PASSES : 1;

    for (; n < MOST_RENDERS && !status && !bis_trade_interrupted(t) && (n < least || (!t->o.passes && left(c) > each)); n++) {
        bis_image image = {0};
        bis_render_result result;
        bis_comparison both;
        status = bis_trade_render(t, s, t->plan.step, passes, seed_of(t, c->advice, c->turn, n), &image, &result, diag);
        const bool complete = !status && !result.interrupted;
        if (complete) status = bis_compare(&both, &image, &t->both.image, diag);
        bis_image_clear(&image);
        if (status || !complete) break;
        sum += both.relmse - t->both.relmse;
    }
    *variance = n ? passes * sum / n : (double)NAN;
    return status;
}

static bis_status check_advice(bis_trade_advice *a, bis_trade *t, check *c, bis_diag *diag)
{
    const bis_trade_setting *s = &t->plan.settings[a->setting];
    const double a_pass = t->result.curves[a->setting].pass_seconds, full_pass = a->seconds / a->passes;
    bis_status status = BIS_OK;

    for (c->turn = 0; c->turn < MOST_TURNS && !status && (c->turn == 0 || t->o.passes || left(c) > 0); c->turn++) {
        const double most = t->o.passes ? (double)MOST_BUDGETS * t->o.passes : left(c) / a_pass;
        const uint32_t measured = (uint32_t)fmax(1, fmin(a->passes, most));
        double variance;
        status = measure(&variance, t, c, s, measured, measured * a_pass, diag);
        if (status || !(variance > 0)) break; /* the references are too short to tell: the curve's word stands */
        const double before = a->passes;
        a->passes = (uint32_t)fmin(fmax(1, ceil(variance / (a->error * a->error))), 1e9);
        a->expected_error = sqrt(variance / a->passes);
        a->is_extrapolated = a->passes > close_enough * measured;
        if (a->passes <= close_enough * measured && before <= close_enough * a->passes) break;
    }
    a->seconds = a->passes * full_pass;
    return status;
}

bis_status bis_trade_check_advice(bis_trade *t, bis_diag *diag)
{
    bis_status status = BIS_OK;

    for (int i = 0; i < BIS_TRADE_ADVICE && !status && !bis_trade_interrupted(t); i++) {
        bis_trade_advice *a = &t->result.advice[i];
        check c = {.start = bis_clock_now(), .seconds = check_share * t->o.seconds, .advice = i};
        if (a->setting < 0) continue;
        bis_trade_tell(t, "error of the advice", (double)i / BIS_TRADE_ADVICE, c.seconds * (BIS_TRADE_ADVICE - i));
        status = check_advice(a, t, &c, diag);
    }
    return status;
}
