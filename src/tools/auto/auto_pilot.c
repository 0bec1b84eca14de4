/* SPDX-License-Identifier: BSD-2-Clause */
/* auto_pilot: replicates, and what they tell of cost and variance.
 *
 * A replicate of a setting is a render of the pilot's film (every k-th pixel: bis_render with a footprint of 1/k) of
 * one or two passes, with a seed that all settings share: the same camera rays.
 *
 * Cost: processor seconds, the least of the replicates, since whatever disturbs only adds. What a pass costs at any
 * size (pools, clusters) is told apart by a picture of one pixel, its fill; the rest of the time is in proportion to
 * the pixels.
 *
 * Variance: relMSE of docs/budgets.md over the pixels that show a surface, the scatter of the replicates in place of
 * the error, and in place of the reference the mean of all that was rendered, weighted by 1/variance (a median would
 * come out too low where most methods miss a highlight, and blame those that find it). Of the pixels' values the mean
 * is taken in nine cells, and of these the mean, with the largest replaced by the second largest: one firefly in the
 * pilot is forgiven, two are not. (The median of the cells, more robust, forgives so many that a method which makes
 * nothing but fireflies looks like the best: nine times too long on data/scenes/glossy-row.txt. To reject a good
 * method for its bad luck costs far less.) Two passes in a replicate know what a stratified camera makes of the noise
 * of the pixel's area, or half of it. */
#include "auto_pilot.h"

#include "bis/base/clock.h"
#include "bis/base/mem.h"
#include "bis/thesis/rng.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CELLS = 9 };

static const uint64_t purpose_pilot = 0x70696c6f74; /* "pilot" */

bis_status bis_auto_no_memory(const bis_scene_desc *desc, bis_diag *diag)
{
    return bis_error(diag, BIS_NOMEM, desc->integrator_loc,
                     "no memory for the pilot of integrator \"auto\"; a fixed integrator needs none");
}

bool bis_auto_is_interrupted(const bis_auto_pilot *p) { return p->options.interrupted && *p->options.interrupted; }

/* ---- one replicate ---- */

/* Into *film, which is initialised here; *seconds: lowered to what this took. No diag: several threads do this. */
static bis_status render(bis_film *film, double *seconds, const bis_auto_pilot *p, const bis_view *view)
{
    const bis_film_desc *f = &view->film;
    bis_render_result result;
    bis_status status = bis_film_init(film, f->width, f->height, f->crop, (bis_loc){0}, NULL);
    const double start = bis_clock_processor();

    if (!status) status = bis_render(&result, film, p->scene, p->desc, view, &p->options, NULL);
    *seconds = fmin(*seconds, bis_clock_processor() - start);
    return status;
}

static bis_status render_one_pixel(double *seconds, const bis_auto_pilot *p, const bis_view *view)
{
    bis_view small = *view;
    bis_film film;

    small.film = (bis_film_desc){.width = 1, .height = 1, .crop = {0, 1, 0, 1}};
    bis_status status = render(&film, seconds, p, &small);
    bis_film_clear(&film);
    return status;
}

static bis_status replicate(bis_auto_pilot *p, int i)
{
    bis_auto_tried *tried = &p->report->tried[i];
    bis_auto_trial *t = &p->trials[i];
    bis_view view = p->view;
    double seconds = (double)INFINITY;
    bis_film film;
    bis_rng rng;

    /* The same camera rays with all settings: what they do to pixels is no difference. */
    bis_rng_init(&rng, p->view.sampler.seed, (uint64_t)tried->replicates, 0, purpose_pilot);
    view.sampler.seed = bis_rng_u64(&rng);
    view.settings = tried->settings;
    bis_status status = render(&film, &seconds, p, &view);
    if (!status && tried->replicates < BIS_AUTO_REPLICATES / 2) status = render_one_pixel(&t->fill, p, &view);
    if (status || bis_auto_is_interrupted(p)) goto done;
    t->seconds = fmin(t->seconds, seconds);
    for (size_t k = 0; k < 3 * p->n_pixels; k++) {
        const double x = film.sum[k] / film.weight;
        t->sum[k] += x;
        t->squares[k] += x * x;
        if (i == 0) p->shaded[k / 3] |= film.hits[k / 3] > 0;
    }
    tried->replicates++;
done:
    bis_film_clear(&film);
    return status;
}

/* Each setting by one thread: what it costs is then what that thread took. (Threads that wait for each other in one
 * render would be counted as if they worked.) */
bis_status bis_auto_pilot_run(bis_auto_pilot *p, bis_diag *diag)
{
    const int n = p->report->n_tried;

#pragma omp parallel for schedule(dynamic) num_threads(p->n_threads)
    for (int i = 0; i < n; i++) {
        bis_auto_trial *t = &p->trials[i];
        while (t->wanted > 0 && !t->status && !bis_auto_is_interrupted(p)) {
            t->status = replicate(p, i);
            t->wanted--;
        }
    }
    for (int i = 0; i < n; i++)
        if (p->trials[i].status) return bis_auto_no_memory(p->desc, diag);
    return BIS_OK;
}

/* ---- what is tried ---- */

bis_status bis_auto_pilot_add(bis_auto_pilot *p, int family, const bis_settings *s, int wanted, bis_diag *diag)
{
    const int i = p->report->n_tried;
    bis_auto_trial *t = &p->trials[i];

    assert(i < BIS_AUTO_MOST_TRIED);
    *t = (bis_auto_trial){.family = family, .wanted = wanted, .seconds = (double)INFINITY, .fill = (double)INFINITY};
    t->sum = bis_alloc(3 * p->n_pixels, sizeof *t->sum);
    t->squares = bis_alloc(3 * p->n_pixels, sizeof *t->squares);
    p->report->tried[i] = (bis_auto_tried){.settings = *s};
    p->report->n_tried++;
    return t->sum && t->squares ? BIS_OK : bis_auto_no_memory(p->desc, diag);
}

static bool is_diffuse(const bis_scene_desc *d)
{
    for (size_t i = 0; i < d->n_shapes; i++)
        if (!rgb_is_black(d->materials[d->shapes[i].material].Ks)) return false;
    return true;
}

bis_status bis_auto_pilot_start(bis_auto_pilot *p, bis_diag *diag)
{
    p->picture = bis_alloc(3 * p->n_pixels, sizeof *p->picture);
    p->shaded = bis_alloc(p->n_pixels, sizeof *p->shaded);
    if (!p->picture || !p->shaded) return bis_auto_no_memory(p->desc, diag);
    p->is_diffuse = is_diffuse(p->desc);
    return BIS_OK;
}

void bis_auto_pilot_clear(bis_auto_pilot *p)
{
    bis_free(p->picture);
    bis_free(p->shaded);
    for (int i = 0; i < BIS_AUTO_MOST_TRIED; i++) {
        bis_free(p->trials[i].sum);
        bis_free(p->trials[i].squares);
    }
}

/* ---- the figures ---- */

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The mean of all that was rendered, each setting weighted by 1/variance as known so far. */
static void make_picture(bis_auto_pilot *p)
{
    const bis_auto_report *r = p->report;
    double weight[BIS_AUTO_MOST_TRIED], total = 0;

    for (int i = 0; i < r->n_tried; i++) {
        const bis_auto_tried *t = &r->tried[i];
        weight[i] = t->variance > 0 ? t->replicates / t->variance : t->replicates;
        total += weight[i];
    }
    for (int i = 0; i < r->n_tried; i++) weight[i] /= total * r->tried[i].replicates;
    for (size_t k = 0; k < 3 * p->n_pixels; k++) {
        p->picture[k] = 0;
        for (int i = 0; i < r->n_tried; i++) p->picture[k] += weight[i] * p->trials[i].sum[k];
    }
}

/* relMSE's floor, m^2/100, m the mean of what shows a surface. */
static double floor_of(const bis_auto_pilot *p)
{
    double sum = 0;
    size_t n = 0;
    for (size_t k = 0; k < 3 * p->n_pixels; k++) {
        if (!p->shaded[k / 3]) continue;
        sum += p->picture[k];
        n++;
    }
    return n ? sum / (double)n * (sum / (double)n) / 100 : 0;
}

/* The mean of n >= 1 cells, the largest lowered to the second. */
static double forgiving_mean(double *cell, int n)
{
    double sum = 0;

    qsort(cell, (size_t)n, sizeof *cell, ascending);
    if (n > 1) cell[n - 1] = cell[n - 2];
    for (int i = 0; i < n; i++) sum += cell[i];
    return sum / n;
}

static void measure_variance(bis_auto_pilot *p, int i, double floor)
{
    const double n = p->report->tried[i].replicates;
    const bis_auto_trial *t = &p->trials[i];
    double cell[CELLS] = {0};
    size_t members[CELLS] = {0};
    int filled = 0;

    for (size_t k = 0; k < 3 * p->n_pixels; k++) {
        if (!p->shaded[k / 3]) continue;
        const size_t c = bis_hash(k / 3) % CELLS;
        /* fmax: rounding, where all are equal */
        const double scatter = fmax(0, t->squares[k] - t->sum[k] * t->sum[k] / n) / (n - 1);
        members[c]++;
        /* without a floor all is black */
        if (scatter > 0) cell[c] += scatter / (p->picture[k] * p->picture[k] + floor);
    }
    for (int c = 0; c < CELLS; c++)
        if (members[c]) cell[filled++] = cell[c] / (double)members[c];
    p->report->tried[i].variance = filled ? p->passes * forgiving_mean(cell, filled) : 0;
}

/* Variances and weights follow from each other; three turns settle both. */
void bis_auto_pilot_measure(bis_auto_pilot *p)
{
    enum { TURNS = 3 };
    bis_auto_report *r = p->report;

    for (int i = 0; i < r->n_tried; i++) {
        const bis_auto_trial *t = &p->trials[i];
        r->tried[i].fill = t->fill / p->passes;
        r->tried[i].cost = fmax(0, t->seconds - t->fill) * p->scale / p->passes;
        r->tried[i].variance = 0;
    }
    for (int turn = 0; turn < TURNS; turn++) {
        make_picture(p);
        const double floor = floor_of(p);
        for (int i = 0; i < r->n_tried; i++) measure_variance(p, i, floor);
    }
}
