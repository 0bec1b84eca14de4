/* SPDX-License-Identifier: BSD-2-Clause */
/* verify_picture: is what `bis SCENE` renders what it should be?
 *
 * bis_render itself makes many small pictures, with the scene's own settings, sampler and edge samples, several passes
 * each: pool, clusters and learned visibility are shared by the pixels as in the picture. Such a render is a replicate:
 * it has a seed of its own, and nothing in common with another. The film is thin, it has one of each k x k pixels, so
 * that few pixels lie all over the picture. verify_pixels.c tells what these should be.
 *
 * What is compared are weighted sums over pixels, one number a replicate: all pixels; those of one material; those that
 * an outline crosses; and the outlines again, times the slope of the picture inside the pixel. The last finds camera
 * samples that lie to one side: they change a pixel in proportion to its slope, so that all these changes add up, where
 * their plain sum cancels. A pixel weighs 1/(r + mean r), r being the root of the mean square of its samples: relative
 * errors count, and a highlight counts little more than another pixel. Weights, slopes and outlines come from batches
 * of the reference that nothing else uses. So each sum, of renders and of the reference, is right on average if the
 * code is, and both scatter independently: Welch's t tells the chance of their difference, with the skewness of both
 * (bis_verify_t).
 *
 * What no mean can show is not found: passes that share their random numbers have the right mean, and a scatter that is
 * too large. */
#include "verify.h"

#include "bis/base/mem.h"

#include <stdio.h>
#include <string.h>

enum {
    PIXELS = 1024,
    FEWEST_PIXELS = 16,
    PASSES = 2,
    PASSES_TO_LEARN = 4,
    MOST_PASSES = 256, /* of a film of few pixels */
    FEWEST_RENDERS = 32,
    MOST_RENDERS = 128,
    BATCHES = 32,
    PILOTS = 8, /* batches for weights, slopes and outlines alone */
    MOST_SAMPLES = 4096, /* of a pixel, in a batch */
    OF_OUTLINES = 8,     /* times as many in pixels that an outline crosses: they are few */
    MAX_SUMS = 12,
    FIRST_MATERIAL = 4
};

static const double budget = 1 << 25;    /* of all renders, in units of bis_verify_cost */
static const double samples = 1 << 21;   /* of all batches */
static const double rounding = 2e-6;     /* floats of renders, and unit vectors (verify_view.c) */

/* ---- the film ---- */

/* The smallest k that leaves no more than `most` pixels, and one at least. */
static int step_for(const bis_film_desc *f, double most)
{
    int step = 1;
    for (;; step++) {
        const bis_film film = bis_film_place(f->width, f->height, f->crop, step),
                       next = bis_film_place(f->width, f->height, f->crop, step + 1);
        if ((double)film.width * film.height <= most || next.width <= 0 || next.height <= 0) return step;
    }
}

typedef struct picture {
    const bis_scene *scene;
    const bis_scene_desc *desc;
    bis_view view;
    int step;
    uint32_t passes, n_renders;
    bis_film film;  /* where the pixels are; its sums are not used */
    size_t n;       /* pixels */
    double *weight; /* weight[MAX_SUMS][n] */
    double size[MAX_SUMS]; /* the sum of |weight| times pixel; 0: the sum is not looked at */
    char name[MAX_SUMS][32];
    bis_verify_moments rendered[MAX_SUMS], expected[MAX_SUMS];
    uint64_t nonfinite;
} picture;

/* Of the pool and the clusters of a pass, about one unit a direction. */
static double cost_of_fill(const bis_settings *s)
{
    if (!bis_parameter_of(s->integrator, "candidates")) return 0;
    return fmin(s->candidates * 256.0, 1 << 18) + (s->proposal == BIS_PROPOSAL_PRODUCT ? 1 << 15 : 0);
}

/* False: too dear, however few the draws. */
static bool plan(picture *p, unsigned halvings)
{
    const bis_settings *s = &p->view.settings;
    const double all = budget / (1 << halvings), wanted = fmax(PIXELS >> halvings, FEWEST_PIXELS);
    const double fewest = s->learn ? PASSES_TO_LEARN : PASSES;
    const double sample = bis_verify_cost(s, bis_light_patches(p->scene->light));
    const double renders = FEWEST_RENDERS * fewest * sample; /* of one pixel */

    if (budget / renders < FEWEST_PIXELS) return false;
    p->step = step_for(&p->view.film, fmin(wanted, fmax(all / renders, FEWEST_PIXELS)));
    p->film = bis_film_place(p->view.film.width, p->view.film.height, p->view.film.crop, p->step);
    p->n = (size_t)p->film.width * (size_t)p->film.height;
    const double passes = all / ((double)p->n * sample + cost_of_fill(s)); /* of all renders */
    p->n_renders = (uint32_t)fmin(fmax(round(passes / fewest), FEWEST_RENDERS), MOST_RENDERS);
    p->passes = (uint32_t)fmin(fmax(round(passes / p->n_renders), fewest), MOST_PASSES);
    return true;
}

/* ---- the sums ---- */

/* Material k of the scene's list, -1: the pixel is no part of one. */
static int material_of(const bis_verify_pixel *p, const uint32_t *number)
{
    return p->is_outline || p->material == BIS_NO_NUMBER ? -1 : (int)number[p->material];
}

static void name_sums(picture *p)
{
    static const char *const names[FIRST_MATERIAL] = {"all pixels", "outlines", "outlines, left to right",
                                                      "outlines, up and down"};
    for (int k = 0; k < FIRST_MATERIAL; k++) snprintf(p->name[k], sizeof p->name[k], "%s", names[k]);
    for (int k = FIRST_MATERIAL; k < MAX_SUMS; k++)
        snprintf(p->name[k], sizeof p->name[k], "material %d", k - FIRST_MATERIAL + 1);
}

static void set_weights(picture *p, const double *mean, const bis_verify_pixel *pixels, const uint32_t *number)
{
    double typical = 0;
    size_t outlines = 0;

    for (size_t i = 0; i < p->n; i++) outlines += pixels[i].is_outline;
    for (size_t i = 0; i < p->n; i++) typical += sqrt(pixels[i].square) / (double)p->n;
    for (size_t i = 0; i < p->n && typical > 0; i++) {
        const bis_verify_pixel *x = &pixels[i];
        const double w = 1 / (sqrt(x->square) + typical);
        const int material = material_of(x, number);
        p->weight[i] = w;
        if (x->is_outline) {
            p->weight[p->n + i] = w;
            for (size_t d = 0; d < 2 && outlines > 1; d++) p->weight[(2 + d) * p->n + i] = w * x->slope[d];
        }
        if (material >= 0 && material < MAX_SUMS - FIRST_MATERIAL)
            p->weight[(size_t)(FIRST_MATERIAL + material) * p->n + i] = w;
    }
    for (int k = 0; k < MAX_SUMS; k++)
        for (size_t i = 0; i < p->n; i++) p->size[k] += fabs(p->weight[(size_t)k * p->n + i]) * mean[i];
}

static void add_sums(bis_verify_moments m[MAX_SUMS], const picture *p, const double *pixel)
{
    for (int k = 0; k < MAX_SUMS; k++) {
        double sum = 0;
        for (size_t i = 0; i < p->n; i++) sum += p->weight[(size_t)k * p->n + i] * pixel[i];
        bis_verify_add(&m[k], sum);
    }
}

/* ---- the reference ---- */

/* What the reference is made with; arrays of n pixels. */
typedef struct workspace {
    bis_verify_table table;
    uint32_t *samples, *number;
    double *mean, *batch;
    bis_verify_pixel *pixels, *seen;
} workspace;

static bis_status workspace_init(workspace *w, const picture *p, unsigned halvings, bis_diag *diag)
{
    const double n = round(samples / (1 << halvings) / BATCHES / (double)p->n);
    uint32_t n_numbers;

    *w = (workspace){.samples = bis_alloc(p->n, sizeof *w->samples),
                     .mean = bis_alloc(p->n, sizeof *w->mean),
                     .batch = bis_alloc(p->n, sizeof *w->batch),
                     .pixels = bis_alloc(p->n, sizeof *w->pixels),
                     .seen = bis_alloc(p->n, sizeof *w->seen)};
    if (!(w->samples && w->mean && w->batch && w->pixels && w->seen))
        return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for %zu pixels", p->n);
    for (size_t i = 0; i < p->n; i++) w->samples[i] = (uint32_t)fmin(fmax(n, 1), MOST_SAMPLES);
    const bis_status status = bis_verify_table_init(&w->table, p->scene->light, diag);
    return status ? status : bis_scene_number_materials(&w->number, &n_numbers, p->desc, diag);
}

static void workspace_clear(workspace *w)
{
    bis_verify_table_clear(&w->table);
    bis_free(w->samples);
    bis_free(w->number);
    bis_free(w->mean);
    bis_free(w->batch);
    bis_free(w->pixels);
    bis_free(w->seen);
}

/* One of PILOTS batches, in w->batch and w->seen. */
static void add_pilot(workspace *w, size_t n, bool is_first)
{
    for (size_t i = 0; i < n; i++) {
        const bis_verify_pixel *seen = &w->seen[i];
        bis_verify_pixel *x = &w->pixels[i];
        if (is_first) *x = (bis_verify_pixel){.material = seen->material};
        w->mean[i] += w->batch[i] / PILOTS;
        x->square += seen->square / PILOTS;
        for (int d = 0; d < 2; d++) x->slope[d] += seen->slope[d] / PILOTS;
        x->is_outline |= seen->is_outline || seen->material != x->material;
    }
}

static bis_status expect(picture *p, const bis_verify *v, bis_diag *diag)
{
    workspace w;
    const bis_status status = workspace_init(&w, p, v->halvings, diag);
    const bis_verify_eye e = {p->scene,  p->desc,   &p->view,
                              &p->film, &w.table, p->view.settings.integrator->without_shadows};

    for (int b = 0; b < PILOTS && !status; b++) {
        bis_verify_means(w.batch, w.seen, &e, w.samples, bis_verify_seed(v, "picture: pilot %d", b));
        add_pilot(&w, p->n, b == 0);
    }
    if (!status) set_weights(p, w.mean, w.pixels, w.number);
    for (size_t i = 0; i < p->n && !status; i++) w.samples[i] *= w.pixels[i].is_outline ? OF_OUTLINES : 1;
    for (int b = 0; b < BATCHES && !status && p->size[0] > 0; b++) {
        bis_verify_means(w.batch, NULL, &e, w.samples, bis_verify_seed(v, "picture: batch %d", b));
        add_sums(p->expected, p, w.batch);
    }
    workspace_clear(&w);
    return status;
}

/* ---- the renders ---- */

static bis_status render_one(picture *p, double *pixel, bis_verify_render *render, uint64_t seed, bis_diag *diag)
{
    const bis_film_desc *f = &p->view.film;
    const bis_render_options options = {.budget.spp = p->passes};
    bis_render_result result;
    bis_film film;

    p->view.sampler.seed = seed;
    bis_status status = bis_film_init_thin(&film, f->width, f->height, f->crop, p->step, (bis_loc){0}, diag);
    if (status) return status;
    status = render(&result, &film, p->scene, &p->view, &options, diag);
    for (size_t i = 0; i < p->n && !status; i++) {
        const double *sum = film.sum + 3 * i, scale = 1 / film.weight;
        pixel[i] = bis_verify_measure((rgbd){sum[0] * scale, sum[1] * scale, sum[2] * scale});
    }
    p->nonfinite += result.counters.nonfinite;
    bis_film_clear(&film);
    return status;
}

static bis_status render_all(picture *p, bis_verify_render *render, const bis_verify *v, bis_diag *diag)
{
    double *pixel = bis_alloc(p->n, sizeof *pixel);
    bis_status status = BIS_OK;

    if (!pixel) return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for %zu pixels", p->n);
    for (uint32_t r = 0; r < p->n_renders && !status; r++) {
        status = render_one(p, pixel, render, bis_verify_seed(v, "picture: render %u", (unsigned)r), diag);
        if (!status) add_sums(p->rendered, p, pixel);
    }
    bis_free(pixel);
    return status;
}

/* ---- the verdict ---- */

/* The variance of a mean. */
static double variance_of(const bis_verify_moments *m) { return m->m2 / (m->n - 1) / m->n; }

static void judge(bis_verify *v, const picture *p, int k)
{
    const bis_verify_moments *a = &p->rendered[k], *b = &p->expected[k];
    const double va = variance_of(a), vb = variance_of(b), se = sqrt(va + vb), d = a->mean - b->mean;
    const double excess = fmax(0, fabs(d) - rounding * p->size[k]);
    const double of_a = se > 0 ? va / (va + vb) : 1, of_b = 1 - of_a; /* shares of the variance */
    const double dof = 1 / (of_a * of_a / (a->n - 1) + of_b * of_b / (b->n - 1)); /* Welch and Satterthwaite */
    const double skewness = bis_verify_skewness_beside(a, b, of_a);
    const double percent = p->size[k] > 0 ? 100 / p->size[k] : 0; /* of a black picture */
    bis_verify_test *t = bis_verify_new(v, "picture", "%s: %s", p->name[k], p->view.settings.integrator->name);
    char note[120];

    snprintf(note, sizeof note, "z; %+.2g %% +- %.2g %%; %u renders of %zu pixels, %u passes", percent * d,
             percent * se, (unsigned)p->n_renders, p->n, (unsigned)p->passes);
    if (isnan(d)) {
        bis_verify_p(t, d, 0, "not a number");
    } else if (excess == 0) {
        bis_verify_p(t, 0, 1, note);
    } else if (skewness > BIS_VERIFY_MOST_SKEWNESS) {
        bis_verify_skip(t, "a few renders outweigh all others here: too few to judge");
    } else {
        const double z = copysign(se > 0 ? excess / se : (double)INFINITY, d);
        bis_verify_p(t, z, se > 0 ? bis_verify_t(z, dof, skewness) : 0, note);
    }
}

static void skip(bis_verify *v, const picture *p, const char *why)
{
    bis_verify_skip(bis_verify_new(v, "picture", "all pixels: %s", p->view.settings.integrator->name), why);
}

bis_status bis_verify_picture(bis_verify *v, bis_verify_render *render, const bis_scene *scene,
                              const bis_settings *settings, bool *tested, bis_diag *diag)
{
    picture p = {.scene = scene, .desc = scene->desc, .view = scene->desc->view};

    *tested = false;
    p.view.settings = *settings;
    p.view.sampler.jitter = true; /* without it the mean of a pixel is that of some places, not of its area */
    if (!plan(&p, v->halvings)) {
        skip(v, &p, "too dear for so many renders: see its points below");
        return BIS_OK;
    }
    bis_verify_begin(v, "picture");
    name_sums(&p);
    p.weight = bis_alloc(p.n, MAX_SUMS * sizeof *p.weight);
    bis_status status =
        p.weight ? BIS_OK : bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for %zu pixels", p.n);
    if (!status) status = expect(&p, v, diag);
    *tested = !status && p.size[0] > 0;
    if (!status && !*tested) skip(v, &p, "next to no light reaches the eye");
    if (*tested) status = render_all(&p, render, v, diag);
    if (*tested && !status) {
        for (int k = 0; k < MAX_SUMS; k++)
            if (p.size[k] > 0) judge(v, &p, k);
        bis_verify_bound(bis_verify_new(v, "picture", "not a number: %s", settings->integrator->name),
                         (double)p.nonfinite, 0, "estimates that are no numbers");
    }
    bis_free(p.weight);
    return status;
}
