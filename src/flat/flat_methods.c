/* SPDX-License-Identifier: BSD-2-Clause */
/* flat_methods: what methods make of one point of a scene: an estimate of sir taken apart, shadow rays, many runs, and
 * the bounds of rejection. */
#include "bis/base/mem.h"
#include "flat/face.h"
#include "flat/stage.h"
#include "thesis/candidates.h"
#include "tools/verify/verify.h"

#include <string.h>

/* ---- settings ---- */

/* unoccluded draws candidates as sir does. It has no parameter for that in scenes, because it only looks at them. */
static bis_status set_proposal(bis_settings *s, const char *name, bis_diag *diag)
{
    for (bis_proposal p = BIS_PROPOSAL_EM; p <= BIS_PROPOSAL_MIX; p++) {
        if (strcmp(name, bis_proposal_name(p)) != 0) continue;
        s->proposal = p;
        return BIS_OK;
    }
    return bis_flat_refuse(diag, "proposal is \"%.40s\": integrator \"unoccluded\" takes em, brdf or mix", name);
}

/* Sets stage->asked to the scene with these settings, if there is a surface. */
static bis_status ask(bis_flat_stage *stage, const char *const *settings, bis_diag *diag)
{
    bis_scene_desc *asked = &stage->asked;
    bis_flat_wishes w = {0}; /* nothing is rendered */
    bis_status status = bis_flat_stage_hit(stage, diag);

    *asked = stage->desc; /* which is read alone, and never freed */
    for (int later = 0; later < 2; later++) { /* the integrator first */
        for (const char *const *s = settings; !status && *s; s++) {
            const char *const one[] = {*s, NULL};
            if ((strncmp(*s, "integrator=", 11) != 0) != later) continue;
            if (asked->view.settings.integrator == &bis_unoccluded && strncmp(*s, "proposal=", 9) == 0)
                status = set_proposal(&asked->view.settings, *s + 9, diag);
            else status = bis_flat_wish(asked, &w, one, diag);
        }
    }
    return status;
}

static bis_status check_count(size_t n, size_t most, bis_diag *diag)
{
    if (n >= 2 && n <= most) return BIS_OK;
    return bis_flat_refuse(diag, "%zu estimates: give 2 to %zu", n, most);
}

/* ---- one estimate of sir ---- */

/* The same of sir, with at most `room` candidates. */
static bis_status ask_sir(bis_flat_stage *stage, const char *const *settings, size_t room, bis_diag *diag)
{
    const bis_settings *s = &stage->asked.view.settings;
    const bis_status status = ask(stage, settings, diag);

    if (status) return status;
    if (s->integrator != &bis_sir)
        return bis_flat_refuse(diag, "integrator \"%s\" has no candidates to show: give sir", s->integrator->name);
    if (s->candidates > room)
        return bis_flat_refuse(diag, "%u candidates do not fit into arrays of %zu", (unsigned)s->candidates, room);
    return BIS_OK;
}

static bis_status draw(bis_pixel_candidates *c, bis_flat_stage *stage, const bis_sampler *sampler, uint64_t pixel,
                       bis_diag *diag)
{
    bis_stream stream;

    bis_stream_init(&stream, sampler, pixel, 0);
    return bis_pixel_candidates_draw(c, &stage->pt, &stage->asked.view.settings, &stream, diag);
}

/* The sampler of figures: each run is the only sample of its pixel. */
static bis_sampler sampler_of(uint64_t seed)
{
    bis_sampler sampler = {.kind = BIS_SAMPLER_STRATIFIED, .seed = seed};
    bis_sampler_set_spp(&sampler, 1);
    return sampler;
}

/* The sampler of the scene with another seed, and the number of the chosen pixel in it. */
static uint64_t pixel_of(bis_sampler *sampler, const bis_flat_stage *stage, uint64_t seed)
{
    *sampler = stage->asked.view.sampler;
    sampler->seed = seed;
    return (uint64_t)stage->y * (uint64_t)stage->asked.view.film.width + (uint64_t)stage->x;
}

bis_status bis_do_stage_candidates(bis_flat_stage *stage, const char *const *settings, uint32_t seed, size_t room,
                                   float *wi, double *w, uint32_t *chosen, uint32_t *kind, double *sum, bis_diag *diag)
{
    const bis_sampler sampler = sampler_of(seed);
    const uint64_t before = stage->counters.shadow_rays;
    bis_pixel_candidates c = {0};
    bis_status status = ask_sir(stage, settings, room, diag);

    if (!status) status = draw(&c, stage, &sampler, 0, diag);
    if (status) return status;
    for (size_t i = 0; i < room; i++) {
        static const bis_pixel_candidate none;
        const bis_pixel_candidate *x = i < c.M ? &c.c[i] : &none;
        memcpy(wi + 3 * i, &x->wi, 3 * sizeof *wi);
        w[i] = x->w;
        chosen[i] = x->chosen;
        kind[i] = (x->from_map ? 1u : 0) | (x->seen ? 2u : 0);
    }
    /* count_chosen asks for each distinct one once more */
    memcpy(sum, (double[]){c.M, c.N, c.ess, rgbd_sum(c.L), rgbd_sum(c.L_ns),
                           (double)(stage->counters.shadow_rays - before - c.distinct)}, 6 * sizeof *sum);
    bis_pixel_candidates_clear(&c);
    return BIS_OK;
}

bis_status bis_do_stage_estimate(bis_flat_stage *stage, const char *const *settings, uint64_t seed, size_t room,
                                 float *wi, double *w, uint32_t *count, double *sum, bis_diag *diag)
{
    bis_pixel_candidates c = {0};
    bis_sampler sampler;
    bis_status status = ask_sir(stage, settings, room, diag);

    if (status) return status;
    const uint64_t pixel = pixel_of(&sampler, stage, seed);
    status = draw(&c, stage, &sampler, pixel, diag);
    if (status) return status;
    for (size_t i = 0; i < c.M; i++) {
        const bis_pixel_candidate *x = &c.c[i];
        memcpy(wi + 3 * i, &x->wi, 3 * sizeof *wi);
        w[i] = x->w;
        memcpy(count + 3 * i, (uint32_t[]){x->from_map, x->chosen, x->seen}, 3 * sizeof *count);
    }
    memcpy(sum, (double[]){c.M, c.N, c.W, c.square_sum, c.ess, c.largest, c.share_em, c.n_map, c.positive, c.distinct,
                           c.seen, c.L.r, c.L.g, c.L.b, c.L_ns.r, c.L_ns.g, c.L_ns.b}, 17 * sizeof *sum);
    bis_pixel_candidates_clear(&c);
    return BIS_OK;
}

/* What the estimate of these candidates is in the mean over the choice of rays: L_ns sum(w V)/sum(w), E31. Its rays are
 * not the estimate's, so they are not counted. */
static double mean_over_choices(const bis_pixel_candidates *c, const bis_point *pt)
{
    bis_counters none = {0};
    bis_point mine = *pt;
    double seen = 0;

    mine.counters = &none;
    for (uint32_t i = 0; i < c->M; i++)
        if (c->c[i].w > 0 && bis_point_sees(&mine, c->c[i].wi)) seen += c->c[i].w;
    return c->W > 0 ? rgbd_sum(c->L_ns) * seen / c->W : 0;
}

static double deviation(const bis_verify_moments *m) { return sqrt(m->m2 / (m->n - 1)); }

bis_status bis_do_stage_noises(bis_flat_stage *stage, const char *const *settings, uint32_t seed, size_t n,
                               double *sum, bis_diag *diag)
{
    const bis_sampler sampler = sampler_of(seed);
    const uint64_t before = stage->counters.shadow_rays;
    bis_verify_moments all = {0}, of_candidates = {0}, of_rays = {0};
    double distinct = 0;
    bis_status status = check_count(n, 100000, diag);

    if (!status) status = ask_sir(stage, settings, SIZE_MAX, diag);
    for (size_t i = 0; !status && i < n; i++) {
        bis_pixel_candidates c = {0};
        status = draw(&c, stage, &sampler, i, diag);
        if (status) break;
        const double L = rgbd_sum(c.L), expected = mean_over_choices(&c, &stage->pt);
        bis_verify_add(&all, L);
        bis_verify_add(&of_candidates, expected);
        bis_verify_add(&of_rays, L - expected);
        distinct += c.distinct;
        bis_pixel_candidates_clear(&c);
    }
    if (!status)
        memcpy(sum, (double[]){all.mean, deviation(&all), deviation(&of_candidates), deviation(&of_rays),
                               ((double)(stage->counters.shadow_rays - before) - distinct) / (double)n},
               5 * sizeof *sum);
    return status;
}

/* ---- any method ---- */

bis_status bis_do_stage_rays(bis_flat_stage *stage, const char *const *settings, uint64_t seed, uint32_t runs,
                             size_t room, float *wi, uint32_t *which, size_t *n, bis_diag *diag)
{
    bis_pixel_rays r = {0};
    bis_sampler sampler;
    bis_status status = ask(stage, settings, diag);

    if (!status && runs > 1 << 20)
        status = bis_flat_refuse(diag, "rays of %u estimates: give 1048576 at most", (unsigned)runs);
    if (status) return status;
    const uint64_t pixel = pixel_of(&sampler, stage, seed);
    status = bis_pixel_rays_record(&r, &stage->pt, &stage->asked.view.settings, &sampler, pixel, runs, diag);
    for (size_t i = 0; !status && i < r.n && i < room; i++) {
        memcpy(wi + 3 * i, &r.ray[i].wi, 3 * sizeof *wi);
        which[2 * i] = r.ray[i].run;
        which[2 * i + 1] = r.ray[i].seen;
    }
    if (!status) *n = r.n;
    bis_pixel_rays_clear(&r);
    return status;
}

/* n estimates at the point by an integrator with these settings; the caller frees *estimate also after an error. */
static bis_status run(rgb **estimate, bis_counters *counters, bis_flat_stage *stage, const char *const *settings,
                      uint32_t seed, size_t n, bis_diag *diag)
{
    const bis_status status = ask(stage, settings, diag);

    if (status) return status;
    *estimate = bis_alloc(n, sizeof **estimate);
    if (!*estimate) return bis_error(diag, BIS_NOMEM, nowhere, "no memory for %zu estimates", n);
    const bis_view *view = &stage->asked.view;
    const bis_verify_job job = {&stage->pt, &view->settings, view->sampler.kind, (uint32_t)n, seed, NULL};
    return bis_verify_runs(*estimate, &job, counters, diag);
}

bis_status bis_do_stage_runs(bis_flat_stage *stage, const char *const *settings, uint32_t seed, size_t n, double *L,
                             double *sum, bis_diag *diag)
{
    bis_counters counters = {0};
    bis_verify_moments all = {0};
    rgb *estimate = NULL;
    bis_status status = check_count(n, 1000000, diag);

    if (!status) status = run(&estimate, &counters, stage, settings, seed, n, diag);
    for (size_t i = 0; !status && i < n; i++) bis_verify_add(&all, L[i] = rgb_sum(estimate[i]));
    if (!status)
        memcpy(sum, (double[]){all.mean, deviation(&all), (double)counters.shadow_rays / (double)n}, 3 * sizeof *sum);
    bis_free(estimate);
    return status;
}

bis_status bis_do_stage_method(bis_flat_stage *stage, const char *const *settings, uint64_t seed, size_t n,
                               const volatile sig_atomic_t *stop, float *L, double *value, double *figures,
                               bis_diag *diag)
{
    bis_status status = ask(stage, settings, diag);

    if (!status) status = check_count(n, 100000000, diag);
    if (!status && !stage->knows_exact) status = bis_flat_refuse(diag, "the truth is not known here: ask for it first");
    if (status) return status;
    const bis_view *view = &stage->asked.view;
    const bis_verify_job job = {&stage->pt, NULL, view->sampler.kind, (uint32_t)n, seed, stop};
    bis_pixel_method m = {.settings = view->settings, .is_open = view->settings.integrator->without_shadows};
    status = bis_pixel_method_run(&m, (rgb *)L, &stage->exact, job, diag);
    if (status) return status;
    memcpy(value, m.L.mean, sizeof m.L.mean);
    memcpy(value + 4, m.L.se, sizeof m.L.se);
    memcpy(figures, (double[]){m.z, m.skewness, m.true_skewness, m.error, m.rays, m.accepted}, 6 * sizeof *figures);
    return BIS_OK;
}

bis_status bis_do_stage_mis(bis_flat_stage *stage, const char *const *settings, uint32_t seed, size_t n, double *sum,
                            bis_diag *diag)
{
    const bis_settings *s = &stage->asked.view.settings;
    bis_pixel_mis mis;
    bis_status status = check_count(n, 1000000, diag);

    if (!status) status = ask(stage, settings, diag);
    if (!status && s->integrator != &bis_mis)
        status = bis_flat_refuse(diag, "integrator \"%s\" does not combine two techniques: give mis",
                                 s->integrator->name);
    if (!status) status = bis_pixel_mis_of(&mis, &stage->pt, s, n, seed, diag);
    if (status) return status;
    memcpy(sum, (double[]){mis.mean, sqrt(mis.variance[0]), sqrt(mis.variance[1]), mis.beta, mis.overlap},
           5 * sizeof *sum);
    return BIS_OK;
}

/* ---- rejection ---- */

bis_status bis_do_stage_bounds(bis_flat_stage *stage, double *bound, bis_diag *diag)
{
    const bis_status status = bis_flat_stage_hit(stage, diag);

    if (status) return status;
    bound[0] = bis_candidates_bound(&stage->pt, BIS_PROPOSAL_EM);
    bound[1] = bis_candidates_bound(&stage->pt, BIS_PROPOSAL_BRDF);
    return BIS_OK;
}

bis_status bis_do_stage_accept(bis_flat_stage *stage, const char *proposal, size_t n, const double *w, const double *u,
                               double *height, uint32_t *taken, uint32_t *accepted, bis_diag *diag)
{
    const bis_status status = bis_flat_stage_hit(stage, diag);
    const bool is_em = strcmp(proposal, "em") == 0;

    if (status) return status;
    if (!is_em && strcmp(proposal, "brdf") != 0)
        return bis_flat_refuse(diag, "proposal \"%.40s\" has no bound: give em or brdf", proposal);
    const double B = bis_candidates_bound(&stage->pt, is_em ? BIS_PROPOSAL_EM : BIS_PROPOSAL_BRDF);
    *accepted = 0;
    for (size_t i = 0; i < n; i++) {
        if (isnan(u[i]) || isnan(w[i])) return bis_flat_refuse(diag, "candidate %zu is no number", i);
        height[i] = u[i] * B;
        *accepted += taken[i] = height[i] < w[i];
    }
    return BIS_OK;
}

bis_status bis_do_stage_accepted(bis_flat_stage *stage, const char *const *settings, uint32_t seed, size_t n,
                                 double *count, bis_diag *diag)
{
    bis_counters counters = {0};
    rgb *estimate = NULL;
    bis_status status = check_count(n, 100000, diag);

    if (!status) status = run(&estimate, &counters, stage, settings, seed, n, diag);
    if (!status)
        memcpy(count, (double[]){(double)counters.accepted / (double)n, stage->asked.view.settings.candidates,
                                 (double)counters.shadow_rays / (double)n}, 3 * sizeof *count);
    bis_free(estimate);
    return status;
}
