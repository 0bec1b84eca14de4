/* SPDX-License-Identifier: BSD-2-Clause */
/* flat_stage: one point of a scene, for the figures of chapter 4 that live. What `bis pixel` prints of a pixel stands
 * here as arrays; src/tools/pixel computes it for both. */
#include "flat/stage.h"

#include "bis/base/mem.h"
#include "bis/thesis/envmap.h"
#include "flat/say.h"
#include "flat/wishes.h"
#include "thesis/candidates.h"
#include "tools/verify/verify.h"

#include <stdlib.h>
#include <string.h>

static const bis_loc nowhere = {0};

/* A stage of a scene that somebody keeps open. What it looks at may have another light. */
static bis_status begin(bis_flat_stage *s, const bis_scene *scene, const bis_light *light, bis_diag *diag)
{
    const bis_flat_wishes w = {.light = light};
    bis_status status = BIS_OK;

    s->scene = *scene;
    s->desc = *scene->desc;
    s->scene.desc = &s->desc;
    if (light) {
        if (!s->desc.light.filename) s->desc.light.to_world = s->desc.upright; /* as bis_scene_parse_as has it */
        status = bis_flat_scene_given(&s->own_light, &s->desc, &w, BIS_VERIFY_LIGHT_NEEDS, diag);
    } else if (s->desc.light_needs & BIS_NEED_COMPENSATED) { /* of one method alone; the others would draw by it, too */
        bis_light_desc *own = &s->desc.light;
        own->as_printed = s->desc.view.settings.as_printed;
        own->table_kind = bis_light_table_kind(own, BIS_VERIFY_LIGHT_NEEDS, s->desc.view.sampler.kind);
        status = bis_light_load(&s->own_light, own, BIS_VERIFY_LIGHT_NEEDS, NULL, NULL);
        if (status) bis_error(diag, status, nowhere, "the light cannot be built without compensation");
    }
    if (s->own_light) s->scene.light = s->own_light;
    return status;
}

int bis_flat_stage_open(bis_flat_stage **stage, const char *scene, const char *const *settings, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, stage, scene, settings);
    bis_flat_stage *s = status ? NULL : bis_alloc(1, sizeof *s);

    if (stage) *stage = NULL;
    if (!status && !s) status = bis_error(&diag, BIS_NOMEM, nowhere, "no memory for a stage");
    if (!status) *s = (bis_flat_stage){0};
    if (!status) status = bis_flat_describe(&s->own_desc, scene, settings, &diag);
    if (!status) {
        s->own_desc->light_needs = BIS_VERIFY_LIGHT_NEEDS;
        status = bis_scene_build(&s->own_scene, s->own_desc, &diag);
    }
    if (!status && !bis_light_envmap(s->own_scene->light))
        status = bis_error(&diag, BIS_INPUT, nowhere, "the light is a constant: give a map");
    if (!status) status = begin(s, s->own_scene, NULL, &diag);
    if (!status) *stage = s;
    else bis_flat_stage_close(s);
    return bis_flat_end(status, &diag, say, size);
}

int bis_flat_stage_of(bis_flat_stage **stage, const bis_flat_scene *scene, const bis_light *light, char *say,
                      size_t size)
{
    bis_diag diag = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, stage, scene);
    bis_flat_stage *s = status ? NULL : bis_alloc(1, sizeof *s);

    if (stage) *stage = NULL;
    if (!status && !s) status = bis_error(&diag, BIS_NOMEM, nowhere, "no memory for a stage");
    if (!status) {
        *s = (bis_flat_stage){0};
        status = begin(s, scene->scene, light, &diag);
    }
    if (!status) *stage = s;
    else bis_flat_stage_close(s);
    return bis_flat_end(status, &diag, say, size);
}

void bis_flat_stage_close(bis_flat_stage *stage)
{
    if (!stage) return;
    bis_light_free(stage->own_light);
    bis_scene_free(stage->own_scene);
    bis_scene_desc_free(stage->own_desc);
    free(stage->about); /* of the C library */
    bis_free(stage);
}

int bis_flat_stage_at(bis_flat_stage *stage, int x, int y, double *found, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, stage, found);

    if (!status) {
        const bis_film_desc *film = &stage->desc.view.film;
        if (!(x >= 0 && x < film->width && y >= 0 && y < film->height))
            status = bis_error(&diag, BIS_INPUT, nowhere, "pixel (%d, %d) is outside %d x %d", x, y, film->width,
                               film->height);
    }
    if (status) return bis_flat_end(status, &diag, say, size);
    memset(found, 0, 8 * sizeof *found);
    stage->knows_exact = false;
    stage->is_chosen = true;
    stage->x = x;
    stage->y = y;
    stage->is_hit = bis_pixel_find(&stage->hit, &stage->pt, &stage->scene, x, y, &stage->counters);
    if (stage->is_hit) {
        const vec3 p = stage->pt.p, n = stage->pt.n;
        const double all[8] = {1, (double)p.x, (double)p.y, (double)p.z, (double)n.x, (double)n.y, (double)n.z,
                               stage->hit.t};
        memcpy(found, all, sizeof all);
    }
    return bis_flat_end(BIS_OK, &diag, say, size);
}

bis_status bis_flat_stage_hit(const bis_flat_stage *stage, bis_diag *diag)
{
    if (stage->is_hit) return BIS_OK;
    return bis_error(diag, BIS_INPUT, nowhere, "no point was chosen, or its pixel sees no surface: choose another one");
}

bis_status bis_flat_stage_know(bis_flat_stage *stage, uint64_t seed, bis_diag *diag)
{
    bis_status status = bis_flat_stage_hit(stage, diag);

    if (status || (stage->knows_exact && stage->exact_seed == seed)) return status;
    status = bis_pixel_exact_of(&stage->exact, &stage->pt, BIS_PIXEL_MAX_PATCHES, seed, diag);
    stage->knows_exact = !status;
    stage->exact_seed = seed;
    return status;
}

int bis_flat_stage_exact(bis_flat_stage *stage, uint32_t seed, double *value, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, stage, value);

    if (!status) status = bis_flat_stage_know(stage, seed, &diag);
    if (!status) {
        const bis_pixel_exact *e = &stage->exact;
        memcpy(value, (double[]){e->lit.mean[3], e->lit.se[3], e->open.mean[3], e->open.se[3]}, 4 * sizeof *value);
    }
    return bis_flat_end(status, &diag, say, size);
}

/* ---- directions of a lat-long field in the light's frame ---- */

/* The axes of the light's frame in world space; a constant has those that the scene gives it. */
static void axes_of(const bis_flat_stage *stage, vec3 axis[3])
{
    const bis_xform *to_world = &stage->desc.light.to_world;

    if (!bis_light_is_constant(stage->scene.light)) bis_light_axes(stage->scene.light, axis);
    else for (int i = 0; i < 3; i++) axis[i] = bis_xform_vector(to_world, vec3_from(i == 0, i == 1, i == 2));
}

/* The middle of a cell in world space. */
static vec3 middle_of(const vec3 axis[3], int columns, int rows, int x, int y)
{
    const double theta = PI * (y + 0.5) / rows, phi = 2 * PI * (x + 0.5) / columns;
    const frame light = {axis[0], axis[1], axis[2]};

    return normalize(to_world(&light, vec3_from(sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta))));
}

bis_status bis_flat_stage_field(int columns, int rows, bis_diag *diag)
{
    if (columns >= 1 && columns <= 4096 && rows >= 1 && rows <= 4096) return BIS_OK;
    return bis_error(diag, BIS_INPUT, nowhere, "a field of %d x %d: give 1 to 4096 each", columns, rows);
}

int bis_flat_stage_densities(bis_flat_stage *stage, int columns, int rows, float *q_L, float *q_f, float *product,
                             float *seen, float *peak, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, stage, q_L, q_f, product, seen, peak);
    vec3 axis[3];

    if (!status) status = bis_flat_stage_field(columns, rows, &diag);
    if (!status) status = bis_flat_stage_hit(stage, &diag);
    if (status) return bis_flat_end(status, &diag, say, size);
    axes_of(stage, axis);
    memset(peak, 0, 4 * sizeof *peak);
    for (int i = 0; i < columns * rows; i++) {
        const vec3 wi = middle_of(axis, columns, rows, i % columns, i / columns);
        q_L[i] = (float)bis_light_pdf(stage->pt.light, wi);
        q_f[i] = (float)bis_bsdf_pdf(&stage->pt.bsdf, wi);
        product[i] = (float)bis_pixel_product(&stage->pt, wi);
        seen[i] = product[i] > 0 && bis_point_sees(&stage->pt, wi) ? product[i] : 0;
        const float all[4] = {q_L[i], q_f[i], product[i], seen[i]};
        for (int k = 0; k < 4; k++) peak[k] = fmaxf(peak[k], all[k]);
    }
    return bis_flat_end(BIS_OK, &diag, say, size);
}

int bis_flat_stage_find(bis_flat_stage *stage, int columns, int rows, size_t n, const float *wi, uint32_t *cell,
                        char *say, size_t size)
{
    bis_diag diag = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, stage);
    vec3 axis[3];

    if (!status && n > 0) status = BIS_FLAT_GIVEN(&diag, wi, cell);
    if (!status) status = bis_flat_stage_field(columns, rows, &diag);
    if (!status) axes_of(stage, axis);
    for (size_t i = 0; !status && i < n; i++) {
        const frame light = {axis[0], axis[1], axis[2]};
        const float *d = wi + 3 * i;
        vec3 w = {0, 0, 0};
        if (d[0] != 0 || d[1] != 0 || d[2] != 0) status = bis_flat_direction(&w, wi, i, &diag);
        if (status) break;
        w = to_local(&light, w);
        const double theta = atan2(hypot((double)w.x, (double)w.y), (double)w.z);
        const double phi = atan2((double)w.y, (double)w.x), turn = phi < 0 ? phi + 2 * PI : phi;
        const int x = (int)(turn / (2 * PI) * columns), y = (int)(theta / PI * rows);
        /* the last edges belong to the last cells, and phi = -tiny rounds to 2 pi */
        cell[i] = (uint32_t)((y < rows ? y : rows - 1) * columns + (x < columns ? x : columns - 1));
    }
    return bis_flat_end(status, &diag, say, size);
}

/* ---- methods ---- */

/* unoccluded draws candidates as sir does. It has no parameter for that in scenes, because it only looks at them. */
static bis_status set_proposal(bis_settings *s, const char *name, bis_diag *diag)
{
    for (bis_proposal p = BIS_PROPOSAL_EM; p <= BIS_PROPOSAL_MIX; p++) {
        if (strcmp(name, bis_proposal_name(p)) != 0) continue;
        s->proposal = p;
        return BIS_OK;
    }
    return bis_error(diag, BIS_INPUT, nowhere, "proposal is \"%.40s\": integrator \"unoccluded\" takes em, brdf or mix",
                     name);
}

bis_status bis_flat_stage_ask(bis_flat_stage *stage, const char *const *settings, bis_diag *diag)
{
    bis_scene_desc *asked = &stage->asked;
    bis_status status = bis_flat_stage_hit(stage, diag);

    *asked = stage->desc; /* which is read alone, and never freed */
    for (int later = 0; later < 2; later++) { /* the integrator first */
        for (const char *const *s = settings; !status && *s; s++) {
            const char *const one[] = {*s, NULL};
            if ((strncmp(*s, "integrator=", 11) != 0) != later) continue;
            if (asked->view.settings.integrator == &bis_unoccluded && strncmp(*s, "proposal=", 9) == 0)
                status = set_proposal(&asked->view.settings, *s + 9, diag);
            else status = bis_flat_apply(asked, one, diag);
        }
    }
    return status;
}

bis_status bis_flat_stage_sir(const bis_flat_stage *stage, size_t room, bis_diag *diag)
{
    const bis_settings *s = &stage->asked.view.settings;

    if (s->integrator != &bis_sir)
        return bis_error(diag, BIS_INPUT, nowhere, "integrator \"%s\" has no candidates to show: give sir",
                         s->integrator->name);
    if (s->candidates > room)
        return bis_error(diag, BIS_INPUT, nowhere, "%u candidates do not fit into arrays of %zu",
                         (unsigned)s->candidates, room);
    return BIS_OK;
}

static bis_status draw(bis_pixel_candidates *c, bis_flat_stage *stage, uint32_t seed, uint64_t run, bis_diag *diag)
{
    bis_sampler sampler = {.kind = BIS_SAMPLER_STRATIFIED, .seed = seed};
    bis_stream stream;

    bis_sampler_set_spp(&sampler, 1);
    bis_stream_init(&stream, &sampler, run, 0);
    return bis_pixel_candidates_draw(c, &stage->pt, &stage->asked.view.settings, &stream, diag);
}

int bis_flat_stage_candidates(bis_flat_stage *stage, const char *const *settings, uint32_t seed, size_t room, float *wi,
                              double *w, uint32_t *chosen, uint32_t *kind, double *sum, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_pixel_candidates c = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, stage, settings, wi, w, chosen, kind, sum);

    if (!status) status = bis_flat_stage_ask(stage, settings, &diag);
    if (!status) status = bis_flat_stage_sir(stage, room, &diag);
    const uint64_t before = status ? 0 : stage->counters.shadow_rays;
    if (!status) status = draw(&c, stage, seed, 0, &diag);
    for (size_t i = 0; !status && i < room; i++) {
        static const bis_pixel_candidate none;
        const bis_pixel_candidate *x = i < c.M ? &c.c[i] : &none;
        wi[3 * i] = x->wi.x;
        wi[3 * i + 1] = x->wi.y;
        wi[3 * i + 2] = x->wi.z;
        w[i] = x->w;
        chosen[i] = x->chosen;
        kind[i] = (x->from_map ? 1u : 0) | (x->seen ? 2u : 0);
    }
    if (!status) /* count_chosen asks for each distinct one once more */
        memcpy(sum, (double[]){c.M, c.N, c.ess, rgbd_sum(c.L), rgbd_sum(c.L_ns),
                               (double)(stage->counters.shadow_rays - before - c.distinct)}, 6 * sizeof *sum);
    bis_pixel_candidates_clear(&c);
    return bis_flat_end(status, &diag, say, size);
}

/* n estimates at the point, 2 to `most` of them, by an integrator with these settings; the caller frees *estimate also
 * after an error. */
static bis_status run(rgb **estimate, bis_counters *counters, bis_flat_stage *stage, const char *const *settings,
                      uint32_t seed, size_t n, size_t most, bis_diag *diag)
{
    if (!(n >= 2 && n <= most))
        return bis_error(diag, BIS_INPUT, nowhere, "%zu estimates: give 2 to %zu", n, most);
    const bis_status status = bis_flat_stage_ask(stage, settings, diag);
    if (status) return status;
    *estimate = bis_alloc(n, sizeof **estimate);
    if (!*estimate) return bis_error(diag, BIS_NOMEM, nowhere, "no memory for %zu estimates", n);
    const bis_view *view = &stage->asked.view;
    const bis_verify_job job = {&stage->pt, &view->settings, view->sampler.kind, (uint32_t)n, seed, NULL};
    return bis_verify_runs(*estimate, &job, counters, diag);
}

static double deviation(const bis_verify_moments *m) { return sqrt(m->m2 / (m->n - 1)); }

int bis_flat_stage_runs(bis_flat_stage *stage, const char *const *settings, uint32_t seed, size_t n, double *L,
                        double *sum, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_counters counters = {0};
    bis_verify_moments all = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, stage, settings, L, sum);

    rgb *estimate = NULL;
    if (!status) status = run(&estimate, &counters, stage, settings, seed, n, 1000000, &diag);
    for (size_t i = 0; !status && i < n; i++) bis_verify_add(&all, L[i] = rgb_sum(estimate[i]));
    if (!status)
        memcpy(sum, (double[]){all.mean, deviation(&all), (double)counters.shadow_rays / (double)n}, 3 * sizeof *sum);
    bis_free(estimate);
    return bis_flat_end(status, &diag, say, size);
}

int bis_flat_stage_mis(bis_flat_stage *stage, const char *const *settings, uint32_t seed, size_t n, double *sum,
                       char *say, size_t size)
{
    bis_diag diag = {0};
    bis_pixel_mis mis;
    bis_status status = BIS_FLAT_GIVEN(&diag, stage, settings, sum);

    if (!status && !(n >= 2 && n <= 1000000))
        status = bis_error(&diag, BIS_INPUT, nowhere, "%zu estimates: give 2 to 1000000", n);
    if (!status) status = bis_flat_stage_ask(stage, settings, &diag);
    const bis_settings *s = status ? NULL : &stage->asked.view.settings;
    if (s && s->integrator != &bis_mis)
        status = bis_error(&diag, BIS_INPUT, nowhere, "integrator \"%s\" does not combine two techniques: give mis",
                           s->integrator->name);
    if (!status) status = bis_pixel_mis_of(&mis, &stage->pt, s, n, seed, &diag);
    if (!status)
        memcpy(sum, (double[]){mis.mean, sqrt(mis.variance[0]), sqrt(mis.variance[1]), mis.beta, mis.overlap},
               5 * sizeof *sum);
    return bis_flat_end(status, &diag, say, size);
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

int bis_flat_stage_noises(bis_flat_stage *stage, const char *const *settings, uint32_t seed, size_t n, double *sum,
                          char *say, size_t size)
{
    bis_diag diag = {0};
    bis_verify_moments all = {0}, of_candidates = {0}, of_rays = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, stage, settings, sum);

    if (!status && !(n >= 2 && n <= 100000))
        status = bis_error(&diag, BIS_INPUT, nowhere, "%zu estimates: give 2 to 100000", n);
    if (!status) status = bis_flat_stage_ask(stage, settings, &diag);
    if (!status) status = bis_flat_stage_sir(stage, SIZE_MAX, &diag);
    const uint64_t before = status ? 0 : stage->counters.shadow_rays;
    double distinct = 0;
    for (size_t i = 0; !status && i < n; i++) {
        bis_pixel_candidates c = {0};
        status = draw(&c, stage, seed, i, &diag);
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
    return bis_flat_end(status, &diag, say, size);
}

/* ---- rejection ---- */

int bis_flat_stage_bounds(bis_flat_stage *stage, double *bound, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, stage, bound);

    if (!status) status = bis_flat_stage_hit(stage, &diag);
    if (!status) {
        bound[0] = bis_candidates_bound(&stage->pt, BIS_PROPOSAL_EM);
        bound[1] = bis_candidates_bound(&stage->pt, BIS_PROPOSAL_BRDF);
    }
    return bis_flat_end(status, &diag, say, size);
}

int bis_flat_stage_accept(bis_flat_stage *stage, const char *proposal, size_t n, const double *w, const double *u,
                          double *height, uint32_t *taken, uint32_t *accepted, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, stage, proposal, accepted);

    if (!status && n > 0) status = BIS_FLAT_GIVEN(&diag, w, u, height, taken);
    if (!status) status = bis_flat_stage_hit(stage, &diag);
    if (!status && strcmp(proposal, "em") != 0 && strcmp(proposal, "brdf") != 0)
        status = bis_error(&diag, BIS_INPUT, nowhere, "proposal \"%.40s\" has no bound: give em or brdf", proposal);
    if (status) return bis_flat_end(status, &diag, say, size);
    const double B = bis_candidates_bound(&stage->pt, *proposal == 'e' ? BIS_PROPOSAL_EM : BIS_PROPOSAL_BRDF);
    *accepted = 0;
    for (size_t i = 0; !status && i < n; i++) {
        height[i] = u[i] * B;
        *accepted += taken[i] = height[i] < w[i];
        if (isnan(u[i]) || isnan(w[i])) status = bis_error(&diag, BIS_INPUT, nowhere, "candidate %zu is no number", i);
    }
    return bis_flat_end(status, &diag, say, size);
}

int bis_flat_stage_accepted(bis_flat_stage *stage, const char *const *settings, uint32_t seed, size_t n, double *count,
                            char *say, size_t size)
{
    bis_diag diag = {0};
    bis_counters counters = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, stage, settings, count);

    rgb *estimate = NULL;
    if (!status) status = run(&estimate, &counters, stage, settings, seed, n, 100000, &diag);
    if (!status)
        memcpy(count, (double[]){(double)counters.accepted / (double)n, stage->asked.view.settings.candidates,
                                 (double)counters.shadow_rays / (double)n}, 3 * sizeof *count);
    bis_free(estimate);
    return bis_flat_end(status, &diag, say, size);
}
