/* SPDX-License-Identifier: BSD-2-Clause */
/* auto: the pilot. What minimises cost x variance is measured on the scene itself, in less than 5% of the time that the
 * render will take. Where less than six seconds or so are to come, that is not enough to measure anything: nothing is
 * tried, and the settings are those of a scene that names no integrator.
 *
 * Every k-th pixel of the same view is rendered with each of a short list of settings, in replicates of one or two
 * passes (auto_pilot.c). There are three rounds. First: two replicates of each setting. Second: two more for the
 * families (em or brdf where they are safe, mis, sir by mixture, sir by product) whose best is within `behind` of the
 * best of all. Third: cost and variance of such families are fitted, and the M and N that minimise their product
 * (auto_fit.c) are tried, too. The least measured product wins: the fit proposes, the measurement decides. What a scene
 * gets that names no integrator is left only for something that is a tenth better.
 *
 * The measured variance is too low for a method whose error is in fewer than about one sample in a thousand, because a
 * pilot sees too few of these samples. Therefore the variance of mis and em is multiplied by 1 + `unseen`.
 *
 * Renders too short for the fit choose from three settings. How long a render is, is told by its camera samples that
 * will meet a surface, because a sample of the background costs hardly anything. The product always learns, although
 * the pilot, with its one or two passes, sees the price of that and hardly the gain: it judges the product too badly,
 * not too well. */
#include "auto.h"

#include "auto_fit.h"
#include "auto_pilot.h"

#include "render/ranks.h"

#include "bis/base/clock.h"
#include "bis/base/mem.h"

#include <assert.h>
#include <math.h>

/* Families of settings that differ in M and N alone, and where each is tried first. */
typedef struct family {
    const bis_integrator *integrator;
    bis_proposal proposal;
    bis_auto_limits limits;
    struct {
        uint32_t M, N;
    } first[4], quick; /* ended by N = 0; the one setting of a short list */
} family;

enum { N_FAMILIES = 5, MOST_PASSES = 2, REPLICATES = BIS_AUTO_REPLICATES / 2 /* in each of the first two rounds */ };

/* N is not tried beyond 64: a pass should not cost tens of times what it costs by default, whatever the pixel's area
 * is worth. */
static const family families[N_FAMILIES] = {
    {&bis_em, BIS_PROPOSAL_MIX, {0, 0, 2, 64}, {{0, 8}, {0, 48}}, {0, 32}},
    {&bis_brdf, BIS_PROPOSAL_MIX, {0, 0, 2, 64}, {{0, 4}, {0, 24}}, {0, 8}},
    {&bis_mis, BIS_PROPOSAL_MIX, {0, 0, 2, 64}, {{0, 6}, {0, 32}}, {0, 16}},
    {&bis_sir, BIS_PROPOSAL_MIX, {32, 2048, 2, 64}, {{64, 4}, {64, 20}, {256, 8}}, {64, 16}},
    {&bis_sir, BIS_PROPOSAL_PRODUCT, {16, 512, 2, 64}, {{32, 12}, {64, 24}, {64, 8}, {128, 24}}, {64, 24}},
};

static const double behind = 2;

/* Two pilots with other random numbers differ by about as much. */
static const double as_good = 1.1;

/* The pilot has this share of the camera samples that will meet a surface. If it had fewer than `least_samples_quick`,
 * there is none; with fewer than `least_samples`, M and N are not fitted; more than `most_samples` need not be known.
 *
 * These limits keep the pilot below 5% of the time that the default takes. A sample of the pilot takes up to twice as
 * long as one of the render, because slow settings are tried, too: 2.5%. What does not depend on the samples (the pools
 * and clusters of each replicate) takes as long as up to 2.5e4 of the render's samples with the short list, when at
 * least 1.2e6 are to come: 2.1%. With the long list it is 2.4e5 of at least 1.2e7: 2%. (Measured: docs/integrators.md.)
 */
static const double share_of_samples = 0.0125;
static const double least_samples_quick = 1.5e4, least_samples = 1.5e5, most_samples = 6e5;

/* About how many replicates of how many settings there will be, and camera samples a second where time is all that
 * is known. */
static const double expected_renders = 36, expected_renders_quick = 6, samples_a_second = 2e5;

/* A pilot keeps about this many threads busy, because a setting is tried by one thread: half of the work of the short
 * list, or a little more, is that of its slowest setting. */
static const double busy_threads = 1.5;

/* Of mis and em, see above. */
static const double unseen = 0.25;

/* ---- what is best ---- */

double bis_auto_cost_of(const bis_auto_report *r, int i) { return r->tried[i].fill + r->tried[i].cost; }

static double product(const bis_auto_pilot *p, int i)
{
    const bis_auto_tried *t = &p->report->tried[i];
    const bool is_suspect = t->settings.integrator == &bis_mis || t->settings.integrator == &bis_em;

    return bis_auto_cost_of(p->report, i) * t->variance * (is_suspect ? 1 + unseen : 1);
}

/* Of the family, or of all with -1; -1: none was tried. Without any noise the cheapest. */
static int best_of(const bis_auto_pilot *p, int of_family)
{
    const bis_auto_report *r = p->report;
    int best = -1;

    for (int i = 0; i < r->n_tried; i++) {
        if (of_family >= 0 && p->trials[i].family != of_family) continue;
        const double d = best < 0 ? -1 : product(p, i) - product(p, best);
        if (d < 0 || (d == 0 && bis_auto_cost_of(r, i) < bis_auto_cost_of(r, best))) best = i;
    }
    return best;
}

/* The best, but the settings of a scene that names none where they are as good as the measurement can tell. */
static void choose(bis_auto_pilot *p)
{
    bis_auto_report *r = p->report;
    const bis_settings usual = bis_settings_unnamed();
    const int best = best_of(p, -1);

    r->chosen = best;
    r->is_chosen = true;
    for (int i = 0; i < r->n_tried && product(p, best) > 0; i++)
        if (bis_settings_equal(&r->tried[i].settings, &usual) && product(p, i) <= as_good * product(p, best))
            r->chosen = i;
}

/* ---- what is tried ---- */

/* What a scene gets that names no integrator, and all else as it was asked for. */
static bis_settings usual_of(const bis_settings *base)
{
    const bis_settings usual = bis_settings_unnamed();
    bis_settings s = *base;

    s.integrator = usual.integrator;
    s.proposal = usual.proposal;
    s.candidates = usual.candidates;
    s.samples = s.shadowrays = usual.shadowrays;
    s.learn = usual.learn;
    s.only_sir = false;
    return s;
}

static bis_settings settings_of(const bis_auto_pilot *p, int f, uint32_t M, uint32_t N)
{
    bis_settings s = p->base;

    s.integrator = families[f].integrator;
    s.proposal = families[f].proposal;
    s.only_sir = false;
    s.samples = s.shadowrays = N;
    if (M) s.candidates = M;
    if (s.integrator != &bis_sir) s.stratify = true;
    s.learn = s.proposal == BIS_PROPOSAL_PRODUCT;
    return s;
}

/* What a pilot cannot judge is left out: `em` sees a lobe, and `brdf` a lamp, so rarely that a few thousand samples
 * may tell nothing of it (with n = 10 in a hall of small lamps the pilot finds `brdf` 1.5 times as slow as the best;
 * it is 50 to 300 times). So em is for diffuse surfaces, where no sample is worth much more than another, and brdf
 * for a constant light. mis and sir are bounded by the better of the two everywhere. Under a constant light the
 * product is the mixture. */
static bool is_safe(const bis_auto_pilot *p, int f)
{
    const bool constant = bis_light_is_constant(p->scene->light);

    if (p->base.only_sir && families[f].integrator != &bis_sir) return false;
    if (families[f].integrator == &bis_em) return !constant && p->is_diffuse;
    if (families[f].integrator == &bis_brdf) return constant;
    return !(constant && families[f].proposal == BIS_PROPOSAL_PRODUCT);
}

static bis_status try(bis_auto_pilot *p, int f, uint32_t M, uint32_t N, int wanted, bis_diag *diag)
{
    const bis_settings s = settings_of(p, f, M, N);

    return bis_auto_pilot_add(p, f, &s, wanted, diag);
}

static bis_status try_first(bis_auto_pilot *p, bis_diag *diag)
{
    bis_status status = BIS_OK;

    for (int f = 0; f < N_FAMILIES; f++) {
        if (!is_safe(p, f)) continue;
        if (p->is_quick && !status) status = try(p, f, families[f].quick.M, families[f].quick.N, REPLICATES, diag);
        for (int k = 0; !p->is_quick && k < 4 && families[f].first[k].N && !status; k++) {
            status = try(p, f, families[f].first[k].M, families[f].first[k].N, REPLICATES, diag);
        }
    }
    return status;
}

/* Has the family a chance still? */
static bool is_alive(const bis_auto_pilot *p, int f)
{
    const int own = best_of(p, f);

    return own >= 0 && product(p, own) <= behind * product(p, best_of(p, -1));
}

static void want_more(bis_auto_pilot *p)
{
    for (int i = 0; i < p->report->n_tried; i++)
        p->trials[i].wanted = is_alive(p, p->trials[i].family) ? REPLICATES : 0;
}

/* M and N of least product by the fit of what was measured. Nothing to fit where there is no noise. */
static bool fitted_optimum(const bis_auto_pilot *p, int f, uint32_t *M, uint32_t *N)
{
    const bis_auto_report *r = p->report;
    bis_auto_measured m[BIS_AUTO_MOST_TRIED] = {{0}};
    int n = 0;

    for (int i = 0; i < r->n_tried; i++) {
        const bis_auto_tried *t = &r->tried[i];
        const double cost = bis_auto_cost_of(r, i);
        if (p->trials[i].family != f) continue;
        if (!(cost > 0 && t->variance > 0)) return false;
        const uint32_t candidates = t->settings.integrator == &bis_sir ? t->settings.candidates : 0;
        m[n++] = (bis_auto_measured){candidates, t->settings.shadowrays, cost, t->variance};
    }
    const bis_auto_model cost = bis_auto_fit_cost(m, n), variance = bis_auto_fit_variance(m, n);
    bis_auto_best(M, N, &cost, &variance, &families[f].limits);
    return true;
}

static bool is_known(const bis_auto_pilot *p, int f, uint32_t M, uint32_t N)
{
    for (int i = 0; i < p->report->n_tried; i++) {
        const bis_settings *s = &p->report->tried[i].settings;
        const bool same_M = families[f].limits.max_M == 0 || s->candidates == M;
        if (p->trials[i].family == f && same_M && s->shadowrays == N) return true;
    }
    return false;
}

static bis_status try_optima(bis_auto_pilot *p, bis_diag *diag)
{
    bis_status status = BIS_OK;
    uint32_t M, N;

    for (int f = 0; f < N_FAMILIES && !status; f++) {
        if (!is_alive(p, f) || !fitted_optimum(p, f, &M, &N) || is_known(p, f, M, N)) continue;
        status = try(p, f, M, N, 2 * REPLICATES, diag);
    }
    return status ? status : bis_auto_pilot_run(p, diag);
}

/* ---- the pilot ---- */

static bis_status run_rounds(bis_auto_pilot *p, bis_diag *diag)
{
    bis_status status = try_first(p, diag);

    if (!status) status = bis_auto_pilot_run(p, diag);
    if (status || bis_auto_is_interrupted(p)) return status;
    bis_auto_pilot_measure(p);
    choose(p);
    if (p->is_quick) return BIS_OK;
    want_more(p);
    status = bis_auto_pilot_run(p, diag);
    if (status || bis_auto_is_interrupted(p)) return status;
    bis_auto_pilot_measure(p);
    choose(p);
    status = try_optima(p, diag);
    if (status || bis_auto_is_interrupted(p)) return status;
    bis_auto_pilot_measure(p);
    choose(p);
    return BIS_OK;
}

static double pixels_of(const bis_film_desc *f)
{
    return (double)f->width * f->height * (f->crop[1] - f->crop[0]) * (f->crop[3] - f->crop[2]);
}

/* The share of the picture in which a surface is seen, by rays through SIDE x SIDE places of it. */
static double covered(const bis_scene *scene, const bis_view *view)
{
    enum { SIDE = 32 };
    const bis_film_desc *f = &view->film;
    int hits = 0;

    for (int i = 0; i < SIDE * SIDE; i++) {
        const double x = f->crop[0] + (f->crop[1] - f->crop[0]) * (i % SIDE + 0.5) / SIDE;
        const double y = f->crop[2] + (f->crop[3] - f->crop[2]) * (i / SIDE + 0.5) / SIDE;
        const ray eye = bis_camera_ray(&view->camera, f->width, f->height, x * f->width, y * f->height);
        bis_hit hit;
        hits += bis_accel_intersect(scene->accel, &eye, &hit);
    }
    return (double)hits / (SIDE * SIDE);
}

/* Camera samples to come that meet a surface, as far as the budget tells; without an --spp, as many as the scene asks
 * for. Where more threads render than the pilot keeps busy, it has as much less to do, so that it takes its share of
 * the time. */
static double samples_to_come(const bis_auto_pilot *p, const bis_render_options *o)
{
    const bis_view *v = &p->desc->view;
    const double threads = (double)p->n_threads * (o->ranks ? o->ranks->size : 1);
    const double by_spp = pixels_of(&v->film) * (double)(o->budget.spp ? o->budget.spp : v->sampler.spp) * p->covered /
                          fmax(1, threads / busy_threads);

    if (!(o->budget.seconds > 0)) return by_spp;
    const double by_time = o->budget.seconds * samples_a_second;
    return o->budget.spp ? fmin(by_spp, by_time) : by_time;
}

static double pilots_samples(const bis_auto_pilot *p, const bis_render_options *o)
{
    return fmin(most_samples, share_of_samples * samples_to_come(p, o));
}

/* One side of a crop of `full` pixels: if it holds no pixel's middle, the pixel that it lies in. */
static void hold_a_pixel(double side[2], int full)
{
    const double pixel = floor(full * side[0]);

    if (ceil(full * side[1]) > ceil(full * side[0])) return;
    side[0] = fmax(0, (pixel - 0.5) / full); /* a crop begins with the next whole number */
    side[1] = (pixel + 0.5) / full;
}

/* A film k times smaller in each direction, of at most the picture's size. */
static bis_status make_film(bis_film *film, bis_auto_pilot *p, const bis_scene_desc *desc, double pixels,
                            bis_diag *diag)
{
    const bis_film_desc *f = &desc->view.film;
    const double k = fmax(1, sqrt(pixels_of(f) / pixels));
    bis_film_desc *small = &p->view.film;

    small->width = (int)fmax(1, round(f->width / k));
    small->height = (int)fmax(1, round(f->height / k));
    hold_a_pixel(&small->crop[0], small->width);
    hold_a_pixel(&small->crop[2], small->height);
    if (bis_film_init(film, small->width, small->height, small->crop, (bis_loc){0}, NULL))
        return bis_auto_no_memory(desc, diag);
    p->report->width = film->width;
    p->report->height = film->height;
    p->n_pixels = (size_t)film->width * (size_t)film->height;
    p->options.footprint = 1 / k;
    p->scale = pixels_of(f) / (double)p->n_pixels;
    return BIS_OK;
}

static bis_status make_pilot(bis_auto_pilot *p, const bis_scene_desc *desc, const bis_render_options *options,
                             bis_diag *diag)
{
    const uint64_t spp = options->budget.spp ? options->budget.spp : desc->view.sampler.spp;
    bis_auto_report *r = p->report;
    bis_film film;

    p->n_threads = bis_render_threads(options);
    p->covered = 1;
    if (pilots_samples(p, options) >= least_samples_quick) p->covered = covered(p->scene, &desc->view);
    const double samples = pilots_samples(p, options);
    if (samples < least_samples_quick || !(p->covered > 0)) {
        r->reason = p->covered > 0 ? "too short to measure" : "no surface or no light";
        return BIS_OK;
    }
    p->is_quick = samples < least_samples;
    p->passes = p->is_quick || spp < MOST_PASSES ? 1 : MOST_PASSES;
    p->view.film.layers = 0;
    bis_sampler_set_spp(&p->view.sampler, p->passes);
    const double renders = p->is_quick ? expected_renders_quick : expected_renders * p->passes;
    bis_status status = make_film(&film, p, desc, samples / p->covered / renders, diag);
    bis_film_clear(&film);
    if (status) return status;
    p->options = (bis_render_options){
        .budget = {.spp = p->passes},
        .n_threads = 1,
        .footprint = p->options.footprint,
        .interrupted = options->interrupted,
    };
    r->passes = (int)p->passes;
    return bis_auto_pilot_start(p, diag);
}

bool bis_auto_is_wanted(const bis_settings *s) { return s->integrator == &bis_auto; }

bis_status bis_auto_choose(bis_auto_report *report, const bis_scene *scene, const bis_scene_desc *desc,
                           const bis_render_options *options, bis_diag *diag)
{
    const double start = bis_clock_now();
    bis_auto_pilot *p = NULL;
    bis_status status;

    *report = (bis_auto_report){.settings = desc->view.settings};
    if (!bis_auto_is_wanted(&desc->view.settings)) return BIS_OK;
    report->settings = usual_of(&desc->view.settings); /* until something better is known */
    report->reason = "no surface or no light";
    if (!scene->accel || bis_light_is_black(scene->light)) return BIS_OK;
    report->reason = NULL;
    p = bis_alloc(1, sizeof *p);
    if (!p) return bis_auto_no_memory(desc, diag);
    p->scene = scene;
    p->desc = desc;
    p->view = desc->view;
    p->base = desc->view.settings;
    p->report = report;
    status = make_pilot(p, desc, options, diag);
    if (!status && !report->reason && !bis_auto_is_interrupted(p)) status = run_rounds(p, diag);
    if (!status && report->is_chosen) report->settings = report->tried[report->chosen].settings;
    if (!report->is_chosen && !report->reason) report->reason = "interrupted";
    report->seconds = bis_clock_now() - start;
    bis_auto_pilot_clear(p);
    bis_free(p);
    return status;
}
