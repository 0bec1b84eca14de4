/* render: passes until a budget is used up.
 *
 * pass.c renders one pass; workspace.h is what it works with. Here is decided whether another one is begun. Passes take
 * 1, 1, 2, 4, 4, ... camera samples of each pixel. Samples of one pass cost less together, because they find the scene
 * in the cache; but what is learned helps only the next pass, and a short render should not be cut in large pieces. A
 * pass weighs as much as it has camera samples, which is settled before it begins, so the mean stays unbiased.
 *
 * Budgets are looked at between passes. For time: another pass is begun if one of mean speed still fits, with fewer
 * camera samples if it must be; that is then the last one. So a budget of as many camera samples makes the same
 * picture. For error: the estimate costs a sweep over the film, so it is made at passes 4, 5, 6, ... and, from 20 on,
 * each time their number has grown by a twentieth: an unneeded 5% of passes at most, and a number of passes that no
 * clock can change.
 *
 * An error is estimated from the scatter of the passes, which tells the truth only where they are independent
 * replicates (docs/errata.md E32). The camera samples of one pixel are not: a stratified or low-discrepancy sampler
 * spreads them over the pixel, and the scatter overestimates the error, at edges twofold and more. So where an error is
 * asked for, each pass has a seed of its own.
 *
 * Adaptive sampling weighs each tile against the whole picture, of which a crop knows nothing: a pixel of a crop then
 * does not get what it gets in the full picture. */
#include "bis/render/render.h"

#include "bis/base/clock.h"
#include "pass.h"

#include <assert.h>
#include <math.h>

enum { MIN_ERROR_PASSES = 4, MOST_SAMPLES = 4 };

static const double seconds_between_reports = 0.2;

typedef struct render {
    bis_workspace work;
    bis_budget budget;
    uint64_t most; /* camera samples of budget.spp; 0: not limited by it */
    double start, last_report;
    double rmse, rmse_upper; /* as last estimated; NAN: not yet */
    bis_counters counters;
    uint64_t spp; /* camera samples of a pixel in complete passes; with adaptive sampling their mean */
    uint32_t size; /* camera samples of a pixel in the pass under way */
    bool is_last;  /* the pass under way is smaller than its place in the order demands, so that it fits the time */
    uint32_t passes_total; /* that make `most`; 0: unknown */
} render;

/* Camera samples of the pass that follows `spp` of them: 1, 1, 2, 4, 4, ... of `most` in all (0: no limit). With an
 * error to reach 1, 1, 1, 1, 4, 4, ..., because its first estimate needs four passes. */
static uint32_t pass_size(const render *r, uint64_t spp)
{
    const bool single = spp < 1 || (r->budget.error > 0 && spp < MIN_ERROR_PASSES);
    uint64_t n = single ? 1 : spp < MOST_SAMPLES ? spp : MOST_SAMPLES;

    if (r->work.options->pass_size) n = r->work.options->pass_size;
    if (r->work.view->adaptive) n = BIS_ADAPT_SAMPLES;
    if (r->most && spp + n > r->most) n = r->most - spp;
    return (uint32_t)n;
}

/* Passes that make `most` camera samples. */
static uint32_t passes_in(const render *r, uint64_t most)
{
    uint32_t n = 0;

    for (uint64_t spp = 0; spp < most; n++) {
        if (spp >= MOST_SAMPLES) return n + (uint32_t)((most - spp + pass_size(r, spp) - 1) / pass_size(r, spp));
        spp += pass_size(r, spp);
    }
    return n;
}

/* How much of the budget is used up, and how long it will last, with `share` of the pass under way done. */
static void report(render *r, double share)
{
    const bis_render_options *options = r->work.options;
    bis_progress p = {.passes_done = r->work.film->passes,
                      .passes_total = r->passes_total,
                      .seconds_left = (double)NAN};

    if (!options->progress) return;
    r->last_report = bis_clock_now();
    p.seconds = r->last_report - r->start;
    if (r->most) p.share = ((double)r->spp + share * r->size) / (double)r->most;
    if (r->budget.seconds > 0) p.share = fmax(p.share, p.seconds / r->budget.seconds);
    /* The error falls with the root of the number of passes (docs/errata.md E9). */
    if (r->budget.error > 0 && r->rmse_upper > 0) p.share = fmax(p.share, pow(r->budget.error / r->rmse_upper, 2));
    p.share = fmin(p.share, 1); /* the first pass may exceed the time */
    if (p.share > 0) p.seconds_left = p.seconds * (1 - p.share) / p.share;
    options->progress(&p, options->user);
}

/* Called by one thread after each of its tiles. */
static void report_tile(double share, void *user)
{
    render *r = user;
    if (bis_clock_now() - r->last_report > seconds_between_reports) report(r, share);
}

/* What the error budget will take, as far as the pilot knows: the error falls with the root of the number of passes. */
static void forecast(render *r)
{
    const double factor = pow(r->rmse_upper / r->budget.error, 2);
    const bis_forecast f = {
        .error = r->rmse_upper, .spp = factor * (double)r->spp, .seconds = factor * (bis_clock_now() - r->start)};

    if (!r->work.options->forecast) return;
    r->work.options->forecast(&f, r->work.options->user);
}

/* May another pass begin? One has been completed. Its size is r->size. */
static bool budget_left(render *r, uint32_t *next_check)
{
    const bis_budget *b = &r->budget;
    const uint32_t passes = r->work.film->passes;

    if (bis_pass_interrupted(&r->work)) return false;
    if (r->is_last || (r->most && r->spp >= r->most)) return false;
    if (passes == UINT32_MAX) return false;
    const uint32_t size = r->size = pass_size(r, r->spp);
    if (b->seconds > 0) {
        const double spent = bis_clock_now() - r->start, fits = (b->seconds - spent) / (spent / (double)r->spp);
        if (fits < (r->work.view->adaptive ? size : 1)) return false;
        r->is_last = fits < size;
        if (r->is_last) r->size = (uint32_t)fits;
    }
    if (b->error > 0 && passes >= *next_check) {
        bool first = *next_check == MIN_ERROR_PASSES;
        r->rmse = bis_film_relative_rmse(r->work.film, &r->rmse_upper);
        *next_check = passes + 1 + passes / 20;
        if (r->rmse_upper <= b->error) return false;
        if (first) forecast(r);
    }
    return true;
}

static void render_passes(render *r, bis_render_result *result)
{
    uint32_t next_check = MIN_ERROR_PASSES;
    bool complete;

    r->size = pass_size(r, 0);
    do {
        const bis_pass pass = {.number = r->work.film->passes,
                               .n = r->size,
                               .first = r->spp,
                               .weight = r->work.view->adaptive ? 1 : (double)r->size};
        complete = bis_pass_render(&r->work, &pass, report_tile, r);
        if (complete) {
            bis_pass_keep(&r->work, &pass, &r->counters);
            r->spp += r->size;
            if (r->work.adapt.n_tiles) bis_adapt_next(&r->work.adapt, r->work.film);
        }
    } while (complete && budget_left(r, &next_check));
    result->seconds = bis_clock_now() - r->start;
    r->size = 0;
    /* where all passes are done, it came too late */
    result->interrupted = bis_pass_interrupted(&r->work) && !(r->most && r->spp >= r->most);
    report(r, 0);
}

bis_status bis_render(bis_render_result *result, bis_film *film, const bis_scene *scene, const bis_scene_desc *desc,
                      const bis_view *view, const bis_render_options *options, bis_diag *diag)
{
    render r = {.budget = options->budget, .rmse = (double)NAN, .rmse_upper = (double)NAN};
    uint64_t edge_rays;

    *result = (bis_render_result){.relative_rmse = (double)NAN, .error_bound = (double)NAN};
    assert(film->passes == 0);
    if (!r.budget.spp && !(r.budget.seconds > 0) && !(r.budget.error > 0)) r.budget.spp = (uint32_t)view->sampler.spp;
    r.most = r.budget.spp;
    if (view->adaptive) r.most = (r.most + BIS_ADAPT_SAMPLES - 1) / BIS_ADAPT_SAMPLES * BIS_ADAPT_SAMPLES;
    bis_status status = bis_workspace_init(&r.work, film, scene, desc, view, options, diag);
    r.passes_total = passes_in(&r, r.most);
    r.start = r.last_report = bis_clock_now();
    if (!status) status = bis_workspace_find_edges(&r.work, &edge_rays, diag);
    if (!status) {
        r.counters.camera_rays = edge_rays;
        render_passes(&r, result);
        result->counters = r.counters;
        result->relative_rmse = bis_film_relative_rmse(film, &result->error_bound);
        result->passes = film->passes;
        result->spp = r.spp;
        result->n_threads = r.work.n_threads;
        result->bytes = bis_workspace_bytes(&r.work);
    }
    bis_workspace_clear(&r.work);
    return status;
}
