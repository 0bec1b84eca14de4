/* SPDX-License-Identifier: BSD-2-Clause */
/* answers: see answers.h. Each function below answers one question. */
#include "answers.h"

#include "bis/base/image.h"
#include "bis/base/mem.h"
#include "bis/beyond/microfacet.h"
#include "bis/shape/geometry.h"
#include "bis/thesis/alias.h"
#include "bis/thesis/cdf.h"
#include "bis/thesis/regions.h"
#include "box.h"
#include "shape/grid.h"
#include "thesis/set.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* n of the parts and their bytes. */
typedef void answer(void *const part[], const size_t bytes[]);

static void need(bool ok)
{
    if (ok) return;
    puts("no memory");
    fflush(stdout);
    _exit(3);
}

/* ---- drawing an item ---- */

static void answer_cdf(void *const part[], const size_t bytes[])
{
    double *total = part[2];
    bis_cdf c;

    need(bis_cdf_init(&c, part[0], bytes[0] / sizeof(double), NULL) == BIS_OK);
    memcpy(part[1], c.c, bytes[1]);
    *total = c.total;
    bis_cdf_clear(&c);
}

static void answer_search(void *const part[], const size_t bytes[])
{
    const double *u = part[2];
    double *remainder = part[4];
    size_t *item = part[3];
    const bis_cdf c = {.c = part[0],
                       .n = bytes[0] / sizeof(double) - 1,
                       .total = 1,
                       .guide = part[1],
                       .n_guide = bytes[1] / sizeof(uint32_t) - 1};

    for (size_t k = 0; k < bytes[2] / sizeof *u; k++)
        item[k] = bis_cdf_sample(&c, u[k], bytes[4] ? &remainder[k] : NULL);
}

static void answer_alias(void *const part[], const size_t bytes[])
{
    bis_alias a;

    need(bis_alias_init(&a, part[0], bytes[0] / sizeof(double), NULL) == BIS_OK);
    memcpy(part[1], a.prob, bytes[1]);
    memcpy(part[2], a.alias, bytes[2]);
    bis_alias_clear(&a);
}

static void answer_pick(void *const part[], const size_t bytes[])
{
    const double *prob = part[0], *u = part[2];
    const uint32_t *alias = part[1];
    size_t *item = part[3];
    const size_t n = bytes[0] / sizeof *prob;

    for (size_t k = 0; k < bytes[2] / sizeof *u; k++)
        item[k] = bis_alias_pick(prob, alias, n, u[k]);
}

/* ---- maps ---- */

/* Black without pixels. */
static bis_envmap map_of(const ask_map *m, const void *pixels, size_t bytes)
{
    bis_image image;
    bis_envmap em;

    need(bis_image_init(&image, m->width, m->height, NULL) == BIS_OK);
    need(bis_envmap_from_latlong(&em, &image, NULL) == BIS_OK);
    if (bytes) memcpy(em.pixels, pixels, bytes);
    return em;
}

static void answer_levels(void *const part[], const size_t bytes[])
{
    const bis_levels *l = part[0];
    const double *intensity = part[1];
    uint8_t *level = part[2];

    for (size_t k = 0; k < bytes[2]; k++)
        level[k] = bis_level_of_intensity(&l[k], intensity[k]);
}

static void answer_regions(void *const part[], const size_t bytes[])
{
    const ask_map *m = part[0];
    uint32_t *n = part[2];
    bis_envmap em = map_of(m, part[1], bytes[1]);
    bis_regions r;

    need(bis_regions_init(&r, &em, m->levels, NULL) == BIS_OK);
    *n = r.n;
    memcpy(part[3], r.label, bytes[3]);
    memcpy(part[4], r.solid_angle, r.n * sizeof(double) < bytes[4] ? r.n * sizeof(double) : bytes[4]);
    bis_regions_clear(&r);
    bis_envmap_clear(&em);
}

static void answer_map(void *const part[], const size_t bytes[])
{
    bis_envmap em = map_of(part[0], NULL, 0);

    memcpy(part[1], em.row_solid_angle, bytes[1]);
    memcpy(part[2], em.cos_edge, bytes[2]);
    bis_envmap_clear(&em);
}

static void answer_directions(void *const part[], const size_t bytes[])
{
    bis_envmap em = map_of(part[0], NULL, 0);
    const ask_place *p = part[1];
    vec3 *w = part[2];

    for (size_t k = 0; k < bytes[1] / sizeof *p; k++)
        w[k] = bis_envmap_direction(&em, p[k].x, p[k].y, p[k].u1, p[k].u2);
    bis_envmap_clear(&em);
}

static void answer_pixels(void *const part[], const size_t bytes[])
{
    bis_envmap em = map_of(part[0], NULL, 0);
    const vec3 *w = part[1];
    size_t *pixel = part[2];

    for (size_t k = 0; k < bytes[1] / sizeof *w; k++)
        pixel[k] = bis_envmap_pixel(&em, w[k]);
    bis_envmap_clear(&em);
}

static void answer_importance(void *const part[], const size_t bytes[])
{
    const ask_map *m = part[0];
    bis_envmap em = map_of(m, part[1], bytes[1]);
    const double(*u)[4] = part[2];
    double *pdf_pixel = part[3], *pdf = part[5];
    ask_drawn *drawn = part[4];
    bis_importance *im;

    need(bis_importance_new(&im, &em, &m->options, NULL) == BIS_OK);
    for (size_t i = 0; i < bytes[3] / sizeof *pdf_pixel; i++)
        pdf_pixel[i] = bis_importance_pdf_pixel(im, i);
    for (size_t k = 0; k < bytes[2] / sizeof *u; k++) {
        drawn[k].drawn = bis_importance_sample(im, u[k], &drawn[k].s);
        if (bytes[5]) pdf[k] = bis_importance_pdf(im, drawn[k].s.w_local);
    }
    bis_importance_free(im);
    bis_envmap_clear(&em);
}

/* ---- materials ---- */

void answers_model(bis_material *m)
{
    m->model = m->alpha > 0 ? &bis_microfacet_model : &bis_phong_model;
}

static void answer_lobe(void *const part[], const size_t bytes[])
{
    const double(*in)[3] = part[0];
    vec3 *wi = part[1];
    double *pdf = part[2];

    for (size_t k = 0; k < bytes[0] / sizeof *in; k++)
        bis_phong_lobe_sample(&wi[k], &pdf[k], in[k][0], in[k][1], in[k][2]);
}

/* The surface of element k: the first for all, where there is one alone. */
static void at_surface(bis_bsdf *b, ask_surface *s, size_t bytes, size_t k)
{
    const bool one = bytes == sizeof *s;

    if (one && k > 0) return;
    answers_model(&s[k].material);
    bis_bsdf_init(b, &s[k].material, s[k].n, s[k].wo);
}

static void answer_f(void *const part[], const size_t bytes[])
{
    const vec3 *wi = part[1];
    rgb *f = part[2];
    double *pdf = part[3], *alone = part[4];
    bis_bsdf b;

    for (size_t k = 0; k < bytes[1] / sizeof *wi; k++) {
        at_surface(&b, part[0], bytes[0], k);
        if (bytes[2]) f[k] = bis_bsdf_f_pdf(&b, wi[k], &pdf[k]);
        if (bytes[4]) alone[k] = bis_bsdf_pdf(&b, wi[k]);
    }
}

static void answer_sample(void *const part[], const size_t bytes[])
{
    const double(*u)[3] = part[1];
    vec3 *wi = part[2];
    uint8_t *drawn = part[3];
    bis_bsdf b;

    for (size_t k = 0; k < bytes[3]; k++) {
        at_surface(&b, part[0], bytes[0], k);
        drawn[k] = bis_bsdf_sample(&b, u[k][0], u[k][1], u[k][2], &wi[k]);
    }
}

static void answer_draw(void *const part[], const size_t bytes[])
{
    const double(*u)[2] = part[1];
    vec3 *wi = part[2];
    uint8_t *drawn = part[3];
    bis_bsdf b;

    for (size_t k = 0; k < bytes[3]; k++) {
        at_surface(&b, part[0], bytes[0], k);
        drawn[k] = bis_bsdf_draw(&b, u[k], &wi[k]);
    }
}

static void answer_bound(void *const part[], const size_t bytes[])
{
    double *bound = part[1];
    bis_bsdf b;

    for (size_t k = 0; k < bytes[1] / sizeof *bound; k++) {
        at_surface(&b, part[0], bytes[0], k);
        bound[k] = bis_bsdf_max_ratio(&b);
    }
}

/* ---- estimates ---- */

void answers_lit(lit *l, const ask_scene *scene)
{
    bis_material m = scene->material;

    answers_model(&m);
    bis_light *light = lit_new_light(scene->map, scene->scale, scene->area_exponent,
                                     scene->settings.compensate);
    lit_init(l, light, m, scene->n, scene->degrees, scene->hidden);
    l->kind = scene->kind;
}

static bis_settings settings_of(const ask_scene *scene)
{
    static const bis_integrator *const integrators[] = {&bis_mis, &bis_rejection, &bis_sir};
    bis_settings s = scene->settings;

    s.integrator = integrators[scene->integrator];
    return s;
}

ask_estimate answers_estimate(lit *l, const bis_settings *settings, bis_scratch *scratch, uint64_t seed, uint64_t run)
{
    ask_estimate e = {.first = {.n = 0}};

    l->counters = (bis_counters){0};
    l->accel.rays = &e.first;
    e.L = lit_once(l, settings, scratch, seed, run);
    l->accel.rays = NULL;
    e.rays = l->counters.shadow_rays;
    e.accepted = l->counters.accepted;
    return e;
}

static void answer_estimates(void *const part[], const size_t bytes[])
{
    const ask_scene *scene = part[0];
    const bis_settings s = settings_of(scene);
    const uint64_t *run = part[1];
    ask_estimate *e = part[2];
    bis_scratch scratch;
    lit l;

    answers_lit(&l, scene);
    need(bis_scratch_init(&scratch, &s, NULL) == BIS_OK);
    for (size_t k = 0; k < bytes[1] / sizeof *run; k++)
        e[k] = answers_estimate(&l, &s, &scratch, scene->seed, run[k]);
    bis_scratch_clear(&scratch);
    bis_light_free(l.light);
}

bis_stream answers_stream(uint64_t seed, uint64_t run, bis_sampler *sampler)
{
    bis_stream stream;

    *sampler = (bis_sampler){
        .kind = BIS_SAMPLER_RANDOM, .seed = seed, .spp = 1, .xsamples = 1, .ysamples = 1, .jitter = true};
    bis_stream_init(&stream, sampler, run, 0);
    return stream;
}

static void answer_weights(void *const part[], const size_t bytes[])
{
    const ask_scene *scene = part[0];
    const bis_settings s = settings_of(scene);
    double *Zhat = part[1];
    bis_sampler sampler;
    bis_scratch scratch;
    lit l;

    answers_lit(&l, scene);
    need(bis_scratch_init(&scratch, &s, NULL) == BIS_OK);
    bis_set *x = scratch.set;
    bis_stream stream = answers_stream(scene->seed, 1, &sampler);
    bis_set_draw(x, s.candidates, s.proposal, s.stratify, &l.pt, &stream);
    *Zhat = bis_set_weigh(x, &l.pt);
    memcpy(part[2], x->choice.w, bytes[2]);
    for (int c = 0; c < 3; c++)
        memcpy(part[3 + c], x->F[c], bytes[3 + c]);
    bis_scratch_clear(&scratch);
    bis_light_free(l.light);
}

static void answer_choices(void *const part[], const size_t bytes[])
{
    const ask_marks *m = part[0];
    const uint32_t items = (uint32_t)(bytes[1] / sizeof(float));
    uint32_t *n = part[2], *item = part[3], *times = part[4];
    bis_choice c = {.n = 0};
    bis_claims claims = {0};

    bis_choice_claim(&c, items, &claims);
    need(!claims.failed);
    memcpy(c.w, part[1], bytes[1]);
    bis_choice_sum(&c, items);
    for (size_t run = 0; run < bytes[2] / sizeof *n; run++) {
        bis_sampler sampler;
        bis_stream stream = answers_stream(m->seed, run, &sampler);
        for (uint32_t k = 0; k <= items; k++)
            c.item[k] = c.times[k] = UINT32_MAX;
        if (m->kind == BIS_RESAMPLING_MULTINOMIAL)
            bis_choose_multinomial(&c, m->N, m->W, &stream);
        else
            bis_choose_systematic(&c, m->N, m->W, bis_stream_random(&stream));
        n[run] = c.n_chosen;
        memcpy(item + run * (items + 1), c.item, (items + 1) * sizeof *item);
        memcpy(times + run * (items + 1), c.times, (items + 1) * sizeof *times);
    }
    bis_choice_clear(&c);
}

/* ---- rays ---- */

/* A geometry takes over what it is made of. */
static void *copy(const void *from, size_t bytes)
{
    void *to = bis_alloc(bytes + 1, 1);

    need(to != NULL);
    return memcpy(to, from, bytes);
}

/* Other vertices, and other things in the cells, than those that the grid was built of. */
static void change(bis_geometry *geometry, bis_grid *g, void *const part[], const size_t bytes[])
{
    memcpy(geometry->p, part[5], bytes[5]);
    bis_free(g->blocks); /* what is packed would still hold the old items */
    bis_free(g->items);
    g->blocks = NULL;
    g->items = copy(part[7], bytes[7]);
    memcpy(g->offsets, part[6], bytes[6]);
    memcpy(g->occupied, part[8], bytes[8]);
}

static void answer_rays(void *const part[], const size_t bytes[])
{
    const double *density = part[2];
    const ray *r = part[3];
    ask_hit *h = part[4];
    const bis_xform identity = bis_xform_identity();
    bis_mesh mesh = {.p = copy(part[0], bytes[0]),
                     .index = copy(part[1], bytes[1]),
                     .n_vertices = bytes[0] / sizeof(vec3),
                     .n_triangles = bytes[1] / (3 * sizeof(uint32_t))};
    bis_geometry geometry = {0};
    bis_accel *grid;

    need(bis_geometry_add_mesh(&geometry, &mesh, &identity, 0, NULL) == BIS_OK);
    need(bis_grid_new(&grid, &geometry, *density, 1, NULL) == BIS_OK);
    if (bytes[5]) change(&geometry, (bis_grid *)grid, part, bytes);
    for (size_t k = 0; k < bytes[3] / sizeof *r; k++) {
        h[k].hit = (bis_hit){-1, BIS_NO_PRIM};
        h[k].found = bis_accel_intersect(grid, &r[k], &h[k].hit);
        h[k].any = bis_accel_occluded(grid, &r[k]);
    }
    bis_accel_free(grid);
    bis_geometry_clear(&geometry);
}

/* ---- the socket ---- */

static answer *const answers[ASK_QUESTIONS] = {
    [ASK_CDF] = answer_cdf,         [ASK_SEARCH] = answer_search,
    [ASK_ALIAS] = answer_alias,     [ASK_PICK] = answer_pick,
    [ASK_LEVELS] = answer_levels,   [ASK_REGIONS] = answer_regions,
    [ASK_MAP] = answer_map,         [ASK_DIRECTIONS] = answer_directions,
    [ASK_PIXELS] = answer_pixels,   [ASK_IMPORTANCE] = answer_importance,
    [ASK_LOBE] = answer_lobe,       [ASK_F] = answer_f,
    [ASK_SAMPLE] = answer_sample,   [ASK_DRAW] = answer_draw,
    [ASK_BOUND] = answer_bound,     [ASK_ESTIMATES] = answer_estimates,
    [ASK_WEIGHTS] = answer_weights, [ASK_CHOICES] = answer_choices,
    [ASK_RAYS] = answer_rays,
};

static bool receive(void *to, size_t n)
{
    for (char *c = to; n > 0;) {
        const ssize_t got = read(BOX_CHANNEL, c, n);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return false;
        c += got;
        n -= (size_t)got;
    }
    return true;
}

static bool give(const void *from, size_t n)
{
    for (const char *c = from; n > 0;) {
        const ssize_t sent = write(BOX_CHANNEL, c, n);
        if (sent < 0 && errno == EINTR) continue;
        if (sent <= 0) return false;
        c += sent;
        n -= (size_t)sent;
    }
    return true;
}

/* A part is a block of its own, so that the address sanitizer sees its ends. */
static bool serve_one(const ask_header *h)
{
    void *part[ASK_PARTS] = {NULL};
    size_t bytes[ASK_PARTS] = {0};
    bool ok = true;

    for (size_t i = 0; i < h->n; i++) {
        bytes[i] = h->bytes[i];
        part[i] = calloc(1, bytes[i] + (bytes[i] == 0));
        need(part[i] != NULL);
        if (!h->taken[i]) ok &= receive(part[i], bytes[i]);
    }
    if (ok) answers[h->question](part, bytes);
    for (size_t i = 0; i < h->n; i++) {
        if (h->taken[i]) ok = ok && give(part[i], bytes[i]);
        free(part[i]);
    }
    return ok;
}

int answers_serve(void)
{
    ask_header h;

    if (!give("", 1)) return 1; /* tells the other end which process this is */
    while (receive(&h, sizeof h)) {
        if (h.question >= ASK_QUESTIONS || h.n > ASK_PARTS || !serve_one(&h)) return 1;
    }
    return 0;
}
