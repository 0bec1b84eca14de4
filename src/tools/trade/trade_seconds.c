/* trade_seconds: how long what is advised takes for the full picture.
 *
 * A pixel of a small picture costs more than one of a large one: pools and clusters are made for every pass, whatever
 * its size, and thousands of pixels share what each of the map's pieces costs to fetch. On scene.txt the sweep's 100 x 75
 * pixels said 93 s for what took 39. So a pass of each advised setting is rendered at the full size, or at one that takes
 * `timing_share` of the measurement's time and leaves little to extrapolate. */
#include "trade.h"

/* Each of the advised settings takes so much of the time for a pass. */
static const double timing_share = 0.02;

/* The full picture, or as much smaller as its pass is to take less. */
static void timing_size(const bis_trade *t, double pass, int *width, int *height)
{
    const double scale = fmin(1, sqrt(timing_share * t->o.seconds / pass));

    *width = (int)fmax(1, round(t->plan.full_width * scale));
    *height = (int)fmax(1, round(t->plan.full_height * scale));
}

static bis_status time_advice(bis_trade_advice *a, bis_trade *t, bis_diag *diag)
{
    const bis_trade_setting *s = &t->plan.settings[a->setting];
    bis_render_result result;
    int width, height;

    timing_size(t, a->seconds / a->passes, &width, &height);
    if (width <= t->plan.width) return BIS_OK; /* the sweep knows as much */
    bis_status status = bis_trade_render(t, s, width, height, 1, t->o.seed, NULL, &result, diag);
    if (status || result.interrupted) return status;
    const double pixels = (double)t->plan.full_width * t->plan.full_height / ((double)width * height), fill = fmin(s->fill_seconds, result.seconds);
    a->seconds = a->passes * (fill + (result.seconds - fill) * pixels);
    return BIS_OK;
}

/* The earlier advice that takes the same setting, or NULL. */
static const bis_trade_advice *same_before(const bis_trade_advice *all, int i)
{
    for (int k = 0; k < i; k++) {
        if (all[k].setting == all[i].setting) return &all[k];
    }
    return NULL;
}

bis_status bis_trade_time_advice(bis_trade *t, bis_diag *diag)
{
    bis_status status = BIS_OK;

    for (int i = 0; i < BIS_TRADE_ADVICE && !status && !bis_trade_interrupted(t); i++) {
        bis_trade_advice *a = &t->result.advice[i];
        if (a->setting < 0) continue;
        const bis_trade_advice *known = same_before(t->result.advice, i);
        if (known) {
            a->seconds = a->passes * (known->seconds / known->passes);
            continue;
        }
        bis_trade_tell(t, "seconds of the full picture", (double)i / BIS_TRADE_ADVICE, (double)NAN);
        status = time_advice(a, t, diag);
    }
    return status;
}
