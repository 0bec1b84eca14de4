/* SPDX-License-Identifier: BSD-2-Clause */
/* trade_check: what error does the advised number of passes really leave?
 *
 * The advice comes from the mean cost x variance of a curve's budgets, most of them far shorter than what is advised.
 * The root law that leads from there to the advice is that of independent samples. A stratified camera does better:
 * at an edge the error falls faster, and what the short budgets say is too much. So the advised setting is rendered
 * with the advised passes, in the pixels of the sweep, with seeds of its own: twice, and more often while there is
 * time. The scatter of these renders is the error, since only unbiased settings are advised. (Their distance from the
 * references is not used: these are often noisier than what is advised, and what was left after their share had been
 * subtracted was up to half too large on scene.txt.) relMSE divides by the square of the right pixel, which nobody
 * has. A noisy stand-in is too dark in most pixels, and what is divided by its square comes out too large: twice the
 * error with a reference of 4 passes. So it is the mean of the references and these renders, weighted by 1/variance.
 * A pixel at an outline may see a lamp with one camera ray of many. A render that meets it may have three times the
 * error that most have. What is promised is what half of the pictures have at most. What a picture meets with
 * probability 1/2 is met log 2 times in the mean, and r log 2 times by renders with as many pixels as r pictures. So
 * the worst r log 2 pixels, rounded down, are left out: one of 8 renders of a quarter of the pixels, none if r < 1.45.
 * The scatter says how many passes are right. When these are others by more than `close_enough`, they are rendered in
 * turn. Where two such renders take too long, they get the passes that there is time for, and the rest is a law's,
 * which is said: the relMSE of n passes falls as n^-p. Noise falls as 1/n, the error at edges as n^-3/2 (film_error.c),
 * so p is in [1, 3/2], and two measured numbers of passes tell it. The first one is an eighth, rendered four times, so
 * that it takes a quarter of the time. (The root law, p = 1, promised 5% where 4% came out: fine checks, from some 10
 * passes to 33.) Time that one advice does not need is the next one's. With --passes, which asks for no clock,
 * there are eight renders, or so many that all together have at most 64 times the passes of the longest budget, two at
 * least, of that many passes at most, however long they take. */
#include "trade_advice.h"
#include "trade_scene.h"

#include "bis/base/mem.h"

enum { LEAST_RENDERS = 2, FIRST_RENDERS = 4, MOST_RENDERS = 8, MOST_TURNS = 6, MOST_BUDGETS = 64 };

static const double check_share = 0.03;   /* of the time, for each advice */
static const double close_enough = 1.15;  /* in passes: 7% in error */
static const double first_share = 0.125;  /* of the passes that there is time for, if the advice has more */
static const double noise_falls = 1, edges_fall = 1.5; /* p */

typedef struct check {
    double end, turn_end; /* on bis_clock_now's clock */
    int advice, turn;
    bool is_short; /* fewer passes than the advice has */
} check;

static double left(const check *c) { return c->end - bis_clock_now(); }

/* Is there time for one more render after n of them? A turn leaves half of the time to the next ones. */
static bool goes_on(const bis_trade *t, const check *c, int n, uint32_t passes, double each)
{
    if (bis_trade_interrupted(t) || n == MOST_RENDERS) return false;
    if (n < LEAST_RENDERS) return true;
    if (c->is_short && n == (c->turn ? LEAST_RENDERS : FIRST_RENDERS)) return false;
    return t->o.passes ? (n + 1.0) * passes <= MOST_BUDGETS * (double)t->o.passes
                       : c->turn_end - bis_clock_now() > each;
}

static double channel(const bis_image *image, size_t i)
{
    return bis_trade_channel(image->pixels[i / 3], (int)(i % 3));
}

static double mean_of(const bis_image *images, int n, size_t i)
{
    double sum = 0;
    for (int k = 0; k < n; k++) sum += channel(&images[k], i);
    return sum / n;
}

/* b = w reference + (1 - w) mean of the renders. */
static double scatter(const bis_image *images, int n, int spared, const bis_image *reference, double w)
{
    const size_t size = 3 * (size_t)reference->width * (size_t)reference->height;
    double m = 0, sum = 0, worst[BIS_TRADE_MOST_SPARED] = {0}; /* descending */

    for (size_t i = 0; i < size; i++) m += (w * channel(reference, i) + (1 - w) * mean_of(images, n, i)) / (double)size;
    for (size_t pixel = 0; pixel < size; pixel += 3) {
        double error = 0;
        for (size_t i = pixel; i < pixel + 3; i++) {
            const double mean = mean_of(images, n, i), b = w * channel(reference, i) + (1 - w) * mean;
            double squares = 0;
            for (int k = 0; k < n; k++) squares += pow(channel(&images[k], i) - mean, 2);
            if (squares > 0) error += squares / (n - 1) / (b * b + m * m / 100);
        }
        for (int k = 0; k < spared; k++) {
            const double worse = fmax(worst[k], error);
            error = fmin(worst[k], error);
            worst[k] = worse;
        }
        sum += error;
    }
    return sum / (double)size;
}

double bis_trade_scatter(const bis_image *images, int n, int spared, const bis_trade_reference *reference)
{
    const double of_mean = scatter(images, n, 0, &reference->image, 0) / n;
    const double w = of_mean > 0 ? of_mean / (of_mean + reference->relmse) : 1;
    return scatter(images, n, spared, &reference->image, w);
}

/* *relmse: the scatter of renders of job.passes; NAN: fewer than two were complete. a_pass: its seconds. */
static bis_status measure(double *relmse, bis_trade *t, const check *c, bis_trade_job job, double a_pass,
                          bis_diag *diag)
{
    const double each = job.passes * a_pass;
    bis_image images[MOST_RENDERS] = {{0}};
    bis_status status = BIS_OK;
    bool complete = true;
    int n = 0;

    while (!status && complete && goes_on(t, c, n, job.passes, each)) {
        bis_render_result result;
        const int place = (c->advice * MOST_TURNS + c->turn) * MOST_RENDERS + n;
        job.seed = bis_trade_seed(&t->plan, 3, (uint64_t)place);
        status = bis_trade_render(t, &job, &images[n], &result, diag);
        complete = !status && !result.interrupted;
        n += complete;
    }
    const int spared = (int)(log(2) * n * bis_trade_pixels(t, job.step) / bis_trade_pixels(t, 1));
    *relmse = n < LEAST_RENDERS ? (double)NAN : bis_trade_scatter(images, n, spared, &t->both);
    for (int k = 0; k < MOST_RENDERS; k++) bis_image_clear(&images[k]);
    return status;
}

/* What so many passes leave; 0: none were measured. */
typedef struct point {
    uint32_t passes;
    double relmse;
} point;

/* p by two points; that of noise if they do not tell. */
static double exponent(point a, point b)
{
    if (!a.passes || a.passes == b.passes) return noise_falls;
    const double p = log(a.relmse / b.relmse) / log((double)b.passes / a.passes);
    return fmin(fmax(p, noise_falls), edges_fall);
}

/* The passes of the next renders: the advice's, or as many as there is time for. */
static uint32_t passes_of(const bis_trade *t, uint32_t wanted, double most, int turn)
{
    if (wanted <= most) return wanted;
    return bis_trade_square_passes(t, fmax(1, turn ? most / close_enough : most * first_share));
}

static bis_status check_advice(bis_trade_advice *a, bis_trade *t, check *c, bis_diag *diag)
{
    const bis_trade_setting *s = &t->plan.settings[a->setting];
    const double a_pass = t->result.curves[a->setting].pass_seconds, full_pass = a->seconds / a->passes;
    bis_status status = BIS_OK;
    uint32_t too_few = 0; /* passes that left more than the error; 0: none was measured */
    point first = {0, 0}, now = {0, 0}, enough = {0, 0};

    for (c->turn = 0; c->turn < MOST_TURNS && (c->turn == 0 || t->o.passes || left(c) > 0); c->turn++) {
        const double most = t->o.passes ? (double)MOST_BUDGETS * t->o.passes : left(c) / (LEAST_RENDERS * a_pass);
        const uint32_t passes = passes_of(t, a->passes, most, c->turn);
        c->is_short = passes < a->passes;
        c->turn_end = c->end - left(c) / 2;
        if (c->is_short && passes <= now.passes) break; /* there is no time for more */
        now.passes = passes;
        status = measure(&now.relmse, t, c, (bis_trade_job){s, t->plan.step, passes, 0}, a_pass, diag);
        if (status || !(now.relmse > 0)) break; /* interrupted, or without noise: the curve's word stands */
        const double p = exponent(first, now);
        uint32_t needed = bis_trade_square_passes(t, passes * pow(now.relmse / (a->error * a->error), 1 / p));
        if (c->turn == 0) first = now;
        if (needed > passes) too_few = passes;
        else enough = now;
        point by = now; /* what tells the error of `needed` */
        if (needed <= too_few || (enough.passes && needed > enough.passes)) {
            /* one measured number says that another, measured before, will do, or will not */
            needed = enough.passes;
            by = enough;
        }
        a->passes = needed;
        a->expected_error = sqrt(by.relmse * pow((double)by.passes / needed, p));
        a->is_extrapolated =
            needed != enough.passes && (needed > close_enough * passes || passes > close_enough * needed);
        if (!a->is_extrapolated) break;
    }
    a->seconds = a->passes * full_pass;
    return status;
}

/* A check may find that the advice for another error keeps this one, too, in less time. */
static void take_cheapest(bis_trade_advice *a, const bis_trade_advice *others)
{
    for (const bis_trade_advice *b = others; b < others + BIS_TRADE_ADVICE; b++) {
        const bool is_cheaper =
            b->seconds < a->seconds || (b->seconds == a->seconds && b->expected_error < a->expected_error);
        if (a->setting < 0 || b->setting < 0 || b->expected_error > a->error || !is_cheaper) continue;
        if (b->is_extrapolated && !a->is_extrapolated) continue;
        const bis_trade_advice for_a = *a;
        *a = *b;
        a->purpose = for_a.purpose;
        a->error = for_a.error;
    }
}

bis_status bis_trade_check_advice(bis_trade *t, bis_diag *diag)
{
    const double start = bis_clock_now(), share = check_share * t->o.seconds;
    bis_status status = BIS_OK;

    for (int i = 0; i < BIS_TRADE_ADVICE && !status && !bis_trade_interrupted(t); i++) {
        bis_trade_advice *a = &t->result.advice[i];
        check c = {.end = start + share * (i + 1), .advice = i};
        if (a->setting < 0) continue;
        bis_trade_tell(t, "error of the advice", (double)i / BIS_TRADE_ADVICE, share * (BIS_TRADE_ADVICE - i));
        status = check_advice(a, t, &c, diag);
    }
    for (int i = 0; i < BIS_TRADE_ADVICE; i++) take_cheapest(&t->result.advice[i], t->result.advice);
    return status;
}
