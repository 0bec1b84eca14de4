/* SPDX-License-Identifier: BSD-2-Clause */
/* trade_seconds: how long what is advised takes for the full picture.
 *
 * A pixel of a thin film costs more than one of the full picture: pools and clusters are made for every pass, whatever
 * its size, and thousands of pixels share what each of the map's pieces costs to fetch. On scene.txt the sweep's 100 x
 * 75 pixels said 93 s for what took 39. So a pass of each advised setting is rendered at the full size, or of as many
 * of its pixels as take `timing_share` of the measurement's time, which leaves little to extrapolate. */
#include "trade_advice.h"
#include "trade_scene.h"

/* Each of the advised settings takes so much of the time for a pass. */
static const double timing_share = 0.02;

/* 1, the full picture, or as much thinner as its pass is to take less. */
static int timing_step(const bis_trade *t, double pass)
{
    return (int)fmax(1, ceil(sqrt(pass / (timing_share * t->o.seconds))));
}

static bis_status time_advice(bis_trade_advice *a, bis_trade *t, bis_diag *diag)
{
    const bis_trade_setting *s = &t->plan.settings[a->setting];
    const int step = timing_step(t, a->seconds / a->passes);
    bis_render_result result;

    if (step >= t->plan.step) return BIS_OK; /* the sweep knows as much */
    bis_status status = bis_trade_render(t, &(bis_trade_job){s, step, 1, t->o.seed}, NULL, &result, diag);
    if (status || result.interrupted) return status;
    const double pixels = bis_trade_pixels(t, 1) / bis_trade_pixels(t, step);
    const double fill = fmin(s->fill_seconds, result.seconds);
    a->seconds = a->passes * (fill + (result.seconds - fill) * pixels);
    return BIS_OK;
}

bool bis_trade_take_known_seconds(bis_trade_advice *all, int i)
{
    for (int k = 0; k < i; k++) {
        if (all[k].setting != all[i].setting) continue;
        all[i].seconds = all[i].passes * (all[k].seconds / all[k].passes);
        return true;
    }
    return false;
}

bis_status bis_trade_time_advice(bis_trade *t, bis_diag *diag)
{
    bis_status status = BIS_OK;

    for (int i = 0; i < BIS_TRADE_ADVICE && !status && !bis_trade_interrupted(t); i++) {
        bis_trade_advice *a = &t->result.advice[i];
        if (a->setting < 0) continue;
        bis_trade_tell(t, "seconds of the full picture", (double)i / BIS_TRADE_ADVICE, (double)NAN);
        if (!bis_trade_take_known_seconds(t->result.advice, i)) status = time_advice(a, t, diag);
    }
    return status;
}
