/* SPDX-License-Identifier: BSD-2-Clause */
/* render: passes until a budget is used up.
 *
 * pass.c renders one pass; workspace.h is what it works with. Here is decided whether another one is begun. Passes take
 * 1, 1, 2, 4, 4, ... camera samples of each pixel. Samples of one pass cost less together, because they find the scene
 * in the cache; but what is learned helps only the next pass, and a short render should not be cut in large pieces. A
 * pass weighs as much as it has camera samples, which is settled before it begins, so the mean stays unbiased.
 *
 * Budgets are looked at between passes. For time: another pass is begun if one of mean speed still fits, with fewer
 * camera samples if it must be; that is then the last one. So a budget of as many camera samples makes the same
 * picture. For error: the estimate (film_error.c) costs a sweep over the film, so it is made at passes 3, 4, 5, ...
 * and, from 20 on, each time their number has grown by a twentieth: an unneeded 5% of passes at most, and a number of
 * passes that no clock can change. The passes are the same for every budget.
 *
 * The first pass of a large picture takes seconds, so it may end early, if a glimpse came before it
 * (first_light.h). What it did not reach is filled from the glimpse, which no later pass could put right: the render
 * then ends.
 *
 * A checkpoint holds only passes of the size that their place in the order demands. The last pass of a budget may be
 * smaller, and a longer render takes a whole one in its place: so the state before it is kept. */
#include "bis/render/render.h"

#include "bis/base/clock.h"
#include "bis/base/mem.h"
#include "checkpoint.h"
#include "first_light.h"
#include "pass.h"
#include "team.h"

#include <assert.h>
#include <math.h>
#include <string.h>

enum { MIN_ERROR_PASSES = 3, MOST_SAMPLES = 4 };

static const double seconds_between_reports = 0.2;

typedef struct render {
    bis_workspace work;
    bis_budget budget;
    uint64_t most; /* camera samples of budget.spp; 0: not limited by it */
    double start, last_report; /* start: now, less the seconds that earlier processes spent */
    double first_pass;    /* when this process began its first pass */
    uint64_t spp_before;  /* camera samples of earlier processes */
    bis_done done;
    uint32_t kept;    /* passes in the last checkpoint that this process has written */
    double last_kept; /* when that was */
    double last_so_far;
    double missing;   /* share of pixels that the first pass did not reach */
    uint32_t size; /* camera samples of a pixel in the pass under way */
    bool has_forecast; /* what the error will take was told; the figure may become unknown and known again */
    bool is_last;  /* the pass under way is smaller than its place in the order demands, so that it fits the time */
    uint32_t passes_total; /* that make `most`; 0: unknown */
} render;

/* Camera samples of the pass that follows `spp` of them: 1, 1, 2, 4, 4, ... */
static uint32_t whole_size(const render *r, uint64_t spp)
{
    uint32_t n = spp < 2 ? 1 : spp < MOST_SAMPLES ? (uint32_t)spp : MOST_SAMPLES;

    if (r->work.options->pass_size) n = r->work.options->pass_size;
    return n;
}

/* The same of `most` in all (0: no limit). */
static uint32_t pass_size(const render *r, uint64_t spp)
{
    const uint32_t n = whole_size(r, spp);
    return r->most && spp + n > r->most ? (uint32_t)(r->most - spp) : n;
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
    if (r->most) p.share = ((double)r->done.spp + share * r->size) / (double)r->most;
    if (r->budget.seconds > 0) p.share = fmax(p.share, p.seconds / r->budget.seconds);
    /* The error falls with the root of the number of passes (docs/errata.md E9). fmax passes over what is not a number:
     * an error that is not known yet. */
    const double wanted = r->budget.error, found = r->done.rmse_upper;
    if (wanted > 0) p.share = fmax(p.share, found <= wanted ? 1 : pow(wanted / found, 2));
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

/* What the error budget will take, as far as the first passes know: the error falls with the root of the number of
 * passes. */
static void forecast(render *r)
{
    const double factor = pow(r->done.rmse_upper / r->budget.error, 2);
    const bis_forecast f = {.error = r->done.rmse_upper,
                            .spp = factor * (double)r->done.spp,
                            .seconds = factor * (bis_clock_now() - r->start)};

    r->has_forecast = true;
    if (!r->work.options->forecast) return;
    r->work.options->forecast(&f, r->work.options->user);
}

/* Seconds of a camera sample of all pixels. What came before the first pass is not done again, so it does not count. */
static double seconds_a_sample(const render *r)
{
    const uint64_t own = r->done.spp - r->spp_before;
    const double now = bis_clock_now();

    return own ? (now - r->first_pass) / (double)own : (now - r->start) / (double)r->done.spp;
}

/* Camera samples of all pixels that the rest of the time has room for, after the first pass. */
static double samples_that_fit(const render *r)
{
    return (r->budget.seconds - (bis_clock_now() - r->start)) / seconds_a_sample(r);
}

/* May another pass begin? Its size is r->size. */
static bool budget_left(render *r)
{
    const bis_budget *b = &r->budget;
    const uint32_t passes = r->work.film->passes;
    bis_done *done = &r->done;

    if (bis_workspace_interrupted(&r->work)) return false;
    if (r->is_last || (r->most && done->spp >= r->most)) return false;
    if (passes == UINT32_MAX) return false;
    const uint32_t size = r->size = pass_size(r, done->spp);
    if (b->seconds > 0 && passes) {
        const double fits = samples_that_fit(r);
        if (fits < 1) return false;
        r->is_last = fits < size;
        if (r->is_last) r->size = (uint32_t)fits;
    }
    if (b->error > 0 && passes >= done->next_check) {
        const bis_film_error error = bis_film_estimate_error(r->work.film);
        done->rmse_upper = error.is_bounded ? error.upper : HUGE_VAL;
        done->next_check = passes + 1 + passes / 20;
        if (!r->has_forecast && error.is_bounded && error.upper > b->error) forecast(r);
    }
    return !(b->error > 0 && done->rmse_upper <= b->error); /* also where a checkpoint says so */
}

/* Camera samples that are expected in all, as far as the budgets tell; 0: unknown. With an error to reach it is
 * unknown, because the error decides, and must not depend on what earlier processes were asked for. */
static double expected_spp(const render *r)
{
    const double done = (double)r->done.spp;
    double most = r->most ? (double)r->most : HUGE_VAL;

    if (r->budget.error > 0) return 0;
    if (r->budget.seconds > 0 && done > 0) most = fmin(most, done + samples_that_fit(r));
    return isfinite(most) ? fmax(most, done + r->size) : 0;
}

static bool render_pass(render *r)
{
    const bis_pass pass = {.number = r->work.film->passes,
                           .n = r->size,
                           .first = r->done.spp,
                           .weight = (double)r->size};

    r->work.film->most = expected_spp(r);
    if (r->work.share) bis_team_call(&r->work, &pass, BIS_OK);
    const bool is_whole = bis_pass_render(&r->work, &pass, report_tile, r);
    if (r->work.fine && pass.first == 0) {
        if (!bis_first_light_fill(&r->work, &r->missing)) return false;
    } else if (!is_whole) {
        return false;
    }
    bis_pass_keep(&r->work, &pass, &r->done.counters);
    r->done.spp += r->size;
    return true;
}

/* Writes a checkpoint, if there is a pass that this process has not yet kept. */
static void keep(render *r)
{
    const uint32_t passes = r->work.film->passes;

    if (!r->work.options->checkpoint || passes == r->kept) return;
    if (r->work.share) bis_team_gather(&r->work);
    r->done.seconds = bis_clock_now() - r->start;
    bis_checkpoint_save(r->work.options->checkpoint, &r->work, &r->done);
    r->kept = passes;
    r->last_kept = bis_clock_now();
}

/* All of *result that is known between two passes. */
static void fill_result(bis_render_result *result, const render *r)
{
    const bis_film *film = r->work.film;

    result->seconds = bis_clock_now() - r->start;
    result->counters = r->done.counters;
    if (!r->work.options->part.n) result->error = bis_film_estimate_error(film);
    result->missing = r->missing;
    result->n_portals = r->work.clusters.n_portals;
    memcpy(result->portals, r->work.clusters.portals, sizeof result->portals);
    result->passes = film->passes;
    result->spp = r->done.spp;
    result->bytes = bis_workspace_bytes(&r->work);
}

static void tell_so_far(render *r)
{
    const bis_render_options *options = r->work.options;
    bis_render_result result = {.n_threads = r->work.n_threads};

    if (!options->so_far || bis_clock_now() - r->last_so_far < options->every) return;
    fill_result(&result, r);
    options->so_far(&result, options->user);
    r->last_so_far = bis_clock_now();
}

static void render_passes(render *r, bis_render_result *result)
{
    const bis_checkpoint *c = r->work.options->checkpoint;
    bool is_cut = false;

    r->first_pass = bis_clock_now();
    r->spp_before = r->done.spp;
    r->has_forecast = isfinite(r->done.rmse_upper); /* an earlier process told it */
    while (r->missing == 0 && budget_left(r)) {
        is_cut = r->size < whole_size(r, r->done.spp);
        if (c && (is_cut || bis_clock_now() - r->last_kept >= c->every)) keep(r);
        if (!render_pass(r)) break;
        tell_so_far(r);
    }
    if (!is_cut) keep(r);
    fill_result(result, r);
    /* where all passes are done, it came too late */
    const bool is_done = r->most && r->done.spp >= r->most && r->missing == 0;
    result->interrupted = bis_workspace_interrupted(&r->work) && !is_done;
    report(r, 0);
}

/* What a checkpoint holds must be a part of what is asked for. */
static bis_status resume(render *r, bis_diag *diag)
{
    bis_checkpoint *c = r->work.options->checkpoint;
    bis_status status = c ? bis_checkpoint_begin(c, &r->work, &r->done, diag) : BIS_OK;

    if (status || !r->most || r->done.spp <= r->most) return status;
    return bis_error(diag, BIS_INPUT, (bis_loc){c->source, 0, 0},
                     "this checkpoint has %llu camera samples a pixel already: ask for as many or more, not for %llu",
                     (unsigned long long)r->done.spp, (unsigned long long)r->most);
}

/* What all ranks do before the first pass, after bis_workspace_init, which gave `status`; each step is begun by all or
 * by none. */
static bis_status prepare(render *r, bis_status status, int *n_threads, bis_diag *diag)
{
    bis_workspace *w = &r->work;
    bis_ranks *ranks = w->options->ranks;

    r->start = bis_clock_now();
    if (!status) status = bis_workspace_find_edges(w, diag);
    status = bis_ranks_agree(ranks, status, diag);
    if (status) return status;
    bis_workspace_join_edges(w);
    *n_threads = w->n_threads;
    return ranks ? bis_team_meet(w, n_threads, diag) : BIS_OK;
}

static void ignore_progress(double share, void *user) { (void)share, (void)user; }

/* Another rank than 0: the passes that rank 0 asks for. */
static bis_status follow(render *r)
{
    bis_pass pass;
    bis_status status;

    while (bis_team_follow(&r->work, &pass, &status))
        if (bis_pass_render(&r->work, &pass, ignore_progress, NULL)) bis_pass_learn(&r->work);
    return status;
}

static bis_status lead(render *r, bis_render_result *result, bis_diag *diag)
{
    const double start = r->start;

    r->done.counters.camera_rays = bis_workspace_edge_rays(&r->work);
    bis_status status = resume(r, diag);
    if (!status && r->work.share && r->done.spp) bis_team_spread(&r->work);
    r->start = start - r->done.seconds;
    r->last_report = r->last_kept = r->last_so_far = start;
    if (r->budget.seconds > 0) r->work.late = r->start + r->budget.seconds;
    if (!status) render_passes(r, result);
    if (r->work.share) bis_team_call(&r->work, NULL, status);
    return status;
}

bis_status bis_render(bis_render_result *result, bis_film *film, const bis_scene *scene, const bis_view *view,
                      const bis_render_options *options, bis_diag *diag)
{
    const bool leads = bis_rank_leads(options->ranks);
    render r = {.work = {.scene = scene, .desc = scene->desc, .view = view, .options = options, .film = film},
                .budget = options->budget,
                .done = {.next_check = MIN_ERROR_PASSES, .rmse_upper = (double)NAN}};

    *result = (bis_render_result){.error = {.relative_rmse = (double)NAN, .upper = (double)NAN}};
    assert(film->passes == 0);
    film->independent = view->sampler.kind == BIS_SAMPLER_RANDOM;
    assert(!options->first_light || !(options->part.n || options->ranks || options->checkpoint));
    assert(!options->part.n || !(options->budget.error > 0)); /* the error is that of the whole picture */
    if (!r.budget.spp && !(r.budget.seconds > 0) && !(r.budget.error > 0)) r.budget.spp = (uint32_t)view->sampler.spp;
    r.most = r.budget.spp;
    bis_status status = film->independent ? BIS_OK : bis_film_want_twins(film, diag);
    if (!status) status = bis_workspace_init(&r.work, diag);
    status = prepare(&r, status, &result->n_threads, diag);
    if (!status) r.passes_total = passes_in(&r, r.most);
    if (!status) status = leads ? lead(&r, result, diag) : follow(&r);
    bis_workspace_clear(&r.work);
    return status;
}
