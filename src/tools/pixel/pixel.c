/* SPDX-License-Identifier: BSD-2-Clause */
/* pixel: the point that a pixel's centre sees; the direct illumination integral there (eq. 4.1 and 4.5); every method
 * against it.
 *
 * The truth is a sum over the patches of the light (eq. 3.2), src/tools/truth.c: unbiased, with its own error. For huge
 * maps a long run of `mis` is the better bargain; it too knows its error. */
#include "pixel.h"

#include "bis/base/mem.h"

#include "tools/describe.h"
#include "tools/truth.h"
#include "tools/verify/verify.h"

#include <string.h>

/* ---- the point ---- */

bool bis_pixel_find(bis_pixel_hit *hit, bis_point *pt, const bis_scene *scene, int x, int y, bis_counters *counters)
{
    const bis_view *view = &scene->desc->view;
    bis_hit h;

    hit->eye = bis_camera_ray(&view->camera, view->film.width, view->film.height, x + 0.5, y + 0.5);
    if (!bis_scene_point(pt, &hit->own, scene, hit->eye, counters, &h)) return false;
    hit->t = (double)h.t;
    hit->material = pt->bsdf.material;
    hit->prim = h.prim;
    hit->shape = bis_scene_shape_of(scene, h.prim, &hit->part);
    return true;
}

/* ---- the truth ---- */

static bis_pixel_value value_from(const bis_truth_sum *s)
{
    bis_pixel_value v = {{0}, {0}};
    for (int k = 0; k < 4; k++) {
        v.mean[k] = s->mean[k];
        v.se[k] = sqrt(s->variance[k]);
    }
    return v;
}

static bis_status sum_patches(bis_pixel_exact *e, const bis_point *pt, uint64_t seed, bis_diag *diag)
{
    static const bis_truth_density q[3] = {{1, 0, 0}, {0, 1, 0}, {0.5, 0.5, 0}};
    bis_truth t;
    const bis_status status = bis_truth_of(&t, &(bis_truth_question){pt, {1, 1, 1}, BIS_PIXEL_CELLS, seed, q, 3}, diag);

    if (status) return status;
    e->rays = t.rays;
    e->lit = value_from(&t.lit);
    e->open = value_from(&t.open);
    for (int k = 0; k < 3; k++) {
        e->variance[k] = t.sample[k].variance;
        e->third[k] = t.sample[k].third;
    }
    return BIS_OK;
}

/* Mean and standard error of n >= 2 estimates. */
static bis_pixel_value value_of_runs(const rgb *estimate, uint32_t n)
{
    bis_pixel_value v = {{0}, {0}};
    for (int k = 0; k < 4; k++) {
        double mean = 0, m2 = 0;
        for (uint32_t i = 0; i < n; i++) {
            const double c[4] = {(double)estimate[i].r, (double)estimate[i].g, (double)estimate[i].b,
                                 rgb_sum(estimate[i])};
            const double d = c[k] - mean;
            mean += d / (i + 1);
            m2 += d * (c[k] - mean);
        }
        v.mean[k] = mean;
        v.se[k] = sqrt(m2 / (n - 1) / n);
    }
    return v;
}

/* Of the mean of n estimates of r+g+b: their own over sqrt(n). */
static double skewness_of_runs(const rgb *estimate, uint32_t n, const bis_pixel_value *v)
{
    const double deviation = v->se[3] * sqrt(n);
    double sum = 0;
    for (uint32_t i = 0; i < n && deviation > 0; i++) sum += pow((rgb_sum(estimate[i]) - v->mean[3]) / deviation, 3);
    return sum / n / sqrt(n);
}

/* The mean of many runs that nobody looks at one by one. */
static bis_status run_many(bis_pixel_value *v, const bis_verify_job *job, bis_diag *diag)
{
    rgb *estimate = bis_alloc(job->n, sizeof *estimate);
    bis_counters counters = {0};
    if (!estimate) return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for %u estimates", (unsigned)job->n);
    const bis_status status = bis_verify_runs(estimate, job, &counters, diag);
    if (!status) *v = value_of_runs(estimate, job->n);
    bis_free(estimate);
    return status;
}

/* Without an accelerator nothing is hidden; and with ng = n nothing above the shading horizon lies below the
 * surface. */
static bis_point without_shadows(const bis_point *pt)
{
    bis_point open = *pt;
    open.accel = NULL;
    open.ng = pt->n;
    return open;
}

bis_status bis_pixel_exact_of(bis_pixel_exact *e, const bis_point *pt, size_t max_patches, uint64_t seed,
                              bis_diag *diag)
{
    *e = (bis_pixel_exact){.by_patches = true, .patches = bis_light_patches(pt->light)};
    if (bis_bsdf_is_black(&pt->bsdf) || bis_light_is_black(pt->light)) return BIS_OK;
    if (e->patches <= max_patches) return sum_patches(e, pt, seed, diag);

    const bis_point open = without_shadows(pt);
    bis_settings mis = bis_settings_default(&bis_mis);
    mis.samples = BIS_PIXEL_MIS_SAMPLES;
    e->by_patches = false;
    const bis_verify_job lit = {pt, &mis, BIS_SAMPLER_STRATIFIED, BIS_PIXEL_MIS_RUNS, bis_hash(seed), NULL};
    const bis_verify_job without = {&open, &mis, BIS_SAMPLER_STRATIFIED, BIS_PIXEL_MIS_RUNS, bis_hash(seed + 1),
                                    NULL};
    const bis_status status = run_many(&e->lit, &lit, diag);
    return status ? status : run_many(&e->open, &without, diag);
}

/* ---- the methods ---- */

/* The defaults, with M, N and samples of the scene's own integrator where that has them: what is compared has equal
 * means. */
static bis_settings settings_of(const bis_integrator *i, const bis_settings *own)
{
    bis_settings s = i == own->integrator ? *own : bis_settings_default(i);
    for (const bis_parameter *p = NULL; (p = bis_parameter_next(i, p)) != NULL;) {
        const bis_parameter *same = bis_parameter_of(own->integrator, p->name);
        if (p->type == BIS_PARAMETER_COUNT && same) bis_parameter_set(p, &s, fmax(bis_parameter_get(same, own), p->lo));
    }
    s.compensate = false; /* it would need a table of its own */
    s.as_printed = own->as_printed;
    return s;
}

size_t bis_pixel_methods(bis_pixel_method list[BIS_PIXEL_MAX_METHODS], const bis_settings *own)
{
    size_t n = 0;
    for (int i = 0; bis_integrators[i] && n + 1 < BIS_PIXEL_MAX_METHODS; i++) {
        const bis_integrator *in = bis_integrators[i];
        if (in == &bis_exact) continue;
        bis_pixel_method *m = &list[n++];
        *m = (bis_pixel_method){.settings = settings_of(in, own), .is_open = in->without_shadows};
        snprintf(m->name, sizeof m->name, "%s", in->name);
        if (!bis_parameter_of(in, "estimator")) continue;
        list[n] = *m;
        m->settings.estimator = BIS_ESTIMATOR_RATIO;
        list[n++].settings.estimator = BIS_ESTIMATOR_PLAIN;
        snprintf(m->name, sizeof m->name, "%s ratio", in->name);
        snprintf(m[1].name, sizeof m[1].name, "%s plain", in->name);
    }
    return n;
}

/* A mean of n repeats by m: what rare and bright directions do to it is known here even when none was hit. */
static double true_skewness(const bis_pixel_method *m, const bis_pixel_exact *e, uint32_t n)
{
    const bis_integrator *const by[3] = {&bis_em, &bis_brdf, &bis_mis};
    int k = 0;
    while (k < 3 && by[k] != m->settings.integrator) k++;
    if (k == 3 || !e->by_patches) return (double)NAN;
    const double variance = e->variance[k];
    if (!(variance > 0 && isfinite(variance))) return (double)NAN;
    return e->third[k] / pow(variance, 1.5) / sqrt((double)n * m->settings.samples);
}

bis_status bis_pixel_method_run(bis_pixel_method *m, rgb *estimate, const bis_pixel_exact *exact, bis_verify_job job,
                                bis_diag *diag)
{
    const bis_pixel_value *truth = m->is_open ? &exact->open : &exact->lit;
    const uint32_t n = job.n;
    bis_counters counters = {0};

    job.settings = &m->settings;
    const bis_status status = bis_verify_runs(estimate, &job, &counters, diag);
    if (status) return status;
    m->L = value_of_runs(estimate, n);
    const double se = hypot(m->L.se[3], truth->se[3]);
    const double difference = m->L.mean[3] - truth->mean[3];
    m->repeats = n;
    m->skewness = skewness_of_runs(estimate, n, &m->L);
    m->true_skewness = true_skewness(m, exact, n);
    m->error = truth->mean[3] > 0 ? hypot(m->L.se[3] * sqrt(n), difference) / truth->mean[3] : (double)NAN;
    m->z = se > 0 ? difference / se : (double)NAN;
    m->rays = (double)counters.shadow_rays / n;
    m->accepted = (double)counters.accepted / n;
    return BIS_OK;
}
