/* SPDX-License-Identifier: BSD-2-Clause */
/* figures: what the figures of docs show, as JSON (docs/live.md): chapter 5 of the thesis, rendered and measured again,
 * and those that need no scene (still.h). For scripts/figures/figures.sh (make figures).
 *
 *     figures still FOLDER [FIGURE...]               FOLDER/FIGURE.json: 3.3, ..., E1, ...; all by default
 *     figures chapter5 SECONDS FOLDER FIGURE SCENE   FOLDER/FIGURE.json; the table `figures` below says what FIGURE is,
 * SCENE is a template (measure.h)
 *     figures price SECONDS SCENE                    prices and noise of candidates and rays, and what M/N should be,
 * for each material
 *
 * SECONDS: processor time for a reference, made once. Each figure of chapter 5 has three rows. "printed": the thesis's
 * numbers of samples. "time": N such that all take what the first method takes with the thesis's number (em, mis in 5.7
 * and 5.8), M/N as in the thesis: em's 12 seconds are the yardstick between the machines of then and now. "rays": N
 * such that all trace as many shadow rays as the thesis's N, M as in the thesis. 5.9, sir against the converged
 * picture, has the first row alone.
 *
 * Time is processor time of one thread, the smallest over the seeds; error is measure.h's, the mean over the seeds.
 * Lines of words go to standard output:
 *     FIGURE row method N M us-per-shaded-pixel rays-per-shaded-pixel relMSE trimmed reference's-own */
#include "still.h"
#include "../bench/measure.h"

#include "bis/base/file.h"
#include "bis/base/mem.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* %u once: N; twice: M, N. */
typedef struct method {
    const char *name, *text;
    double M; /* in units of the figure's M; 0: has none */
} method;

enum { EM, BRDF, MIS, MIS_STRATIFIED, MIS_TODAY, REJECTION, PRINTED, PRINTED_BRDF, OURS, PRODUCT, N_METHODS };

static const method methods[N_METHODS] = {
    {"em", "Integrator \"em\" \"integer samples\" %u", 0},
    {"brdf", "Integrator \"brdf\" \"integer samples\" %u", 0},
    {"mis", "Integrator \"mis\" \"integer samples\" %u", 0},
    {"mis-strat", "Integrator \"mis\" \"integer samples\" %u \"bool stratify\" true", 0},
    {"mis-today", "Integrator \"mis\" \"integer samples\" %u \"bool stratify\" true \"bool compensate\" true", 0},
    {"rejection", "Integrator \"rejection\" \"integer candidates\" %u \"integer shadowrays\" %u", 1},
    {"sir-thesis", "Integrator \"sir\" \"integer candidates\" %u \"integer shadowrays\" %u \"string proposal\" \"em\" "
     "\"string resampling\" \"multinomial\" "
                   "\"bool stratify\" false", 1},
    {"sir-brdf", "Integrator \"sir\" \"integer candidates\" %u \"integer shadowrays\" %u \"string proposal\" \"brdf\" "
     "\"string resampling\" \"multinomial\" "
                 "\"bool stratify\" false", 1},
    {"sir", "Integrator \"sir\" \"integer candidates\" %u \"integer shadowrays\" %u", 1},
    {"product", "Integrator \"sir\" \"integer candidates\" %u \"integer shadowrays\" %u \"string proposal\" "
     "\"product\"", 0.32},
};

typedef struct figure {
    const char *name, *material, *title;
    unsigned em, brdf, M, N, methods;
} figure;

/* Sets of methods; the first of a set is the yardstick of equal time. */
#define SET(m) (1u << (m))
#define SIMPLE (SET(EM) | SET(BRDF) | SET(MIS_TODAY) | SET(REJECTION) | SET(PRINTED) | SET(OURS) | SET(PRODUCT))
#define COMBINED (SET(MIS) | SET(MIS_STRATIFIED) | SET(MIS_TODAY) | SET(PRINTED) | SET(OURS) | SET(PRODUCT))
#define IN_STRIP (SET(EM) | SET(MIS) | SET(MIS_TODAY) | SET(PRINTED) | SET(OURS))
#define PHONG(ks, kd, n) "\"float Ks\" " #ks " \"float Kd\" " #kd " \"float exponent\" " #n

enum { AS_PRINTED, EQUAL_TIME, EQUAL_RAYS, ROWS, SEEDS = 4 };
static const char *const row_names[ROWS] = {"printed", "time", "rays"};

static const figure figures[] = {
    {"5.1", PHONG(1, 0, 10), "5.1: ks 1, kd 0, n 10", 100, 75, 800, 15, SIMPLE | SET(PRINTED_BRDF)},
    {"5.2", PHONG(1, 0, 50), "5.2: ks 1, kd 0, n 50", 100, 75, 800, 15, SIMPLE | SET(PRINTED_BRDF)},
    {"5.3", PHONG(.5, .5, 50), "5.3: ks 0.5, kd 0.5, n 50", 100, 75, 800, 15, SIMPLE},
    {"5.4", PHONG(.5, .5, 50), "5.4: another map; ks 0.5, kd 0.5, n 50", 100, 75, 800, 15, SIMPLE},
    {"5.5", PHONG(0, 1, 1), "5.5: diffuse", 100, 75, 800, 25, SIMPLE},
    {"5.6", PHONG(.5, .5, 50), "5.6: unzoomed; ks 0.5, kd 0.5, n 50", 110, 80, 900, 13,
     SET(EM) | SET(BRDF) | SET(MIS_TODAY) | SET(PRINTED) | SET(OURS) | SET(PRODUCT)},
    {"5.7-n10", PHONG(.5, .5, 10), "5.7, top: ks 0.5, kd 0.5, n 10", 100, 75, 800, 15, COMBINED},
    {"5.7-n50", PHONG(.5, .5, 50), "5.7, bottom: ks 0.5, kd 0.5, n 50", 100, 75, 800, 15, COMBINED},
    {"5.8", PHONG(1, 0, 50), "5.8: ks 1, kd 0, n 50", 100, 75, 800, 15, COMBINED | SET(PRINTED_BRDF)},
    {"5.9", PHONG(.5, .5, 50), "5.9: ks 0.5, kd 0.5, n 50", 100, 75, 3000, 150,
     SET(PRINTED) | SET(OURS) | SET(PRODUCT)},
};

static int n_rows(const figure *fig) { return fig->methods & (SET(EM) | SET(MIS)) ? ROWS : 1; }

/* ---- pictures ---- */

static bis_image exposed(int width, int height, const double *L, double scale)
{
    bis_image image = still_field(width, height);

    for (int i = 0; i < width * height; i++) {
        const double *v = L + 3 * i;
        image.pixels[i] = rgb_from(fmin(1, v[0] * scale), fmin(1, v[1] * scale), fmin(1, v[2] * scale));
    }
    return image;
}

/* The relative error of each pixel; dark ones count as if they were 0.003 of what is shown as white. */
static void put_errors(bis_json *j, const bis_film *film, const measure_reference *ref, double exposure)
{
    bis_json_open(j, "errors", '[');
    for (int i = 0; i < ref->width * ref->height; i++) {
        double difference = 0, truth = 0;
        for (int c = 3 * i; c < 3 * i + 3; c++)
            difference += fabs(film->sum[c] / film->passes - ref->L[c]), truth += fabs(ref->L[c]);
        bis_json_number(j, NULL, (double)(float)(difference / fmax(truth, 0.003 / exposure)));
    }
    bis_json_close(j);
}

/* The mean of the shaded pixels becomes 0.2. */
static double exposure_of(const measure_reference *ref, const bis_film *film)
{
    double sum = 0;

    for (size_t i = 0; i < (size_t)ref->width * (size_t)ref->height; i++)
        sum += film->hits[i] > 0 ? ref->L[3 * i] + ref->L[3 * i + 1] + ref->L[3 * i + 2] : 0;
    return sum > 0 ? 0.2 * 3 * (double)measure_shaded(film) / sum : 1;
}

/* ---- one method at one setting ---- */

typedef struct trial {
    unsigned N, M;
    double us, rays;
    measure_error error;
} trial;

typedef struct job {
    const char *scene;
    const figure *fig;
    measure_reference ref;
    bis_film film;
    bis_scene *built; /* for the method under way */
    bis_json json;
    double exposure, yardstick, us_camera; /* us a shaded pixel */
} job;

static bis_scene_desc *parse(const char *scene, const char *material, const method *m, unsigned N, unsigned M)
{
    char text[512];

    if (m->M > 0) snprintf(text, sizeof text, m->text, M, N);
    else snprintf(text, sizeof text, m->text, N);
    return measure_parse(scene, text, 0, material);
}

/* What the method needs is built whatever M, N and material are. */
static bis_scene *build(const char *scene, const char *material, const method *m)
{
    bis_scene_desc *desc = parse(scene, material, m, 2, 2);
    bis_scene *built = measure_build(desc);

    bis_scene_desc_free(desc);
    return built;
}

/* Several seeds: the least time, the mean error; the film is the last seed's. */
static trial run(bis_film *film, const bis_scene *built, const char *scene, const char *material,
    const measure_reference *ref, const method *m, unsigned N, unsigned M, int seeds)
{
    bis_scene_desc *desc = parse(scene, material, m, N, M);
    trial t = {.N = N, .M = M, .us = (double)INFINITY};

    for (int i = 0; i < seeds; i++) {
        bis_render_result result;
        t.us = fmin(t.us, measure_render(film, built, desc, 1 + (uint64_t)i, 1, 1, &result));
        const measure_error e = measure_relmse(film, ref, false);
        t.error.mean += e.mean / seeds;
        t.error.trimmed += e.trimmed / seeds;
        t.rays += (double)result.counters.shadow_rays / seeds;
    }
    t.us *= 1e6 / (double)measure_shaded(film);
    t.rays /= (double)measure_shaded(film);
    bis_scene_desc_free(desc);
    return t;
}

static trial run_method(job *j, int m, unsigned N, unsigned M, int seeds)
{
    return run(&j->film, j->built, j->scene, j->fig->material, &j->ref, &methods[m], N, M, seeds);
}

/* ---- rows ---- */

static unsigned printed_N(const figure *fig, int m) { return m == BRDF ? fig->brdf : m < REJECTION ? fig->em : fig->N; }
static unsigned printed_M(const figure *fig, int m) { return (unsigned)lround(methods[m].M * fig->M); }

static unsigned at_least_two(double N) { return N < 2 ? 2 : N > 20000 ? 20000 : (unsigned)lround(N); }

/* Seconds are about linear in N while M/N is kept: two steps from what was printed, each corrected by the clock. */
static unsigned tune(job *j, int m, const trial *printed)
{
    const double ratio = methods[m].M * j->fig->M / j->fig->N;
    double N = printed->N, us = printed->us;

    for (int i = 0; i < 2 && fabs(us / j->yardstick - 1) > 0.04; i++) {
        N = at_least_two(N * fmin(8, (j->yardstick - j->us_camera) / fmax(us - j->us_camera, 1e-3 * us)));
        us = run_method(j, m, (unsigned)N, (unsigned)lround(ratio * N), 1).us;
    }
    return at_least_two(N * (j->yardstick - j->us_camera) / fmax(us - j->us_camera, 1e-3 * us));
}

/* A candidate that is chosen twice is traced once, and rejection accepts so many of M and no more: rays may lag behind
 * N. */
static unsigned tune_rays(job *j, int m, const trial *printed)
{
    const unsigned M = printed_M(j->fig, m);
    double N = printed->N, rays = printed->rays;

    for (int i = 0; i < 2 && fabs(rays / j->fig->N - 1) > 0.03; i++) {
        N = fmin(M ? M : 20000, at_least_two(N * j->fig->N / rays));
        rays = run_method(j, m, (unsigned)N, M, 1).rays;
    }
    return (unsigned)N;
}

static void show(job *j, int row, int m, const trial *t)
{
    bis_image image = exposed(j->ref.width, j->ref.height, j->film.sum, j->exposure / j->film.passes);

    printf("%s %s %s %u %u %.2f %.2f %.3e %.3e %.1e\n", j->fig->name, row_names[row], methods[m].name, t->N, t->M,
        t->us, t->rays, t->error.mean, t->error.trimmed, j->ref.error);
    fflush(stdout);
    bis_json_open(&j->json, NULL, '{');
    bis_json_text(&j->json, "row", row_names[row]);
    BIS_JSON_NUMBERS(&j->json, {"N", t->N}, {"M", t->M}, {"us", t->us}, {"rays", t->rays}, {"relmse", t->error.mean},
        {"trimmed", t->error.trimmed});
    still_picture(&j->json, "picture", &image);
    put_errors(&j->json, &j->film, &j->ref, j->exposure);
    bis_json_close(&j->json);
}

/* Camera rays and film: a black material. */
static double camera_us(bis_film *film, const char *scene, const measure_reference *ref)
{
    const char *black = measure_materials[MEASURE_MATERIALS].text;
    bis_scene *built = build(scene, black, &methods[EM]);
    const trial t = run(film, built, scene, black, ref, &methods[EM], 1, 0, 3);

    bis_scene_free(built);
    return t.us;
}

static void show_method(job *j, int m, bool first)
{
    const figure *fig = j->fig;
    trial printed, t;

    j->built = build(j->scene, fig->material, &methods[m]);
    printed = run_method(j, m, printed_N(fig, m), printed_M(fig, m), SEEDS);
    if (first) j->yardstick = printed.us;
    bis_json_open(&j->json, NULL, '{');
    bis_json_text(&j->json, "method", methods[m].name);
    bis_json_bool(&j->json, "in_strip", (IN_STRIP & SET(m)) != 0);
    bis_json_open(&j->json, "trials", '[');
    show(j, AS_PRINTED, m, &printed);
    if (n_rows(fig) > 1) {
        unsigned N = tune(j, m, &printed);
        t = run_method(j, m, N, (unsigned)lround(methods[m].M * fig->M / fig->N * N), SEEDS);
        show(j, EQUAL_TIME, m, &t);
        N = tune_rays(j, m, &printed);
        t = run_method(j, m, N, printed_M(fig, m), SEEDS);
        show(j, EQUAL_RAYS, m, &t);
    }
    bis_json_close(&j->json);
    bis_json_close(&j->json);
    bis_scene_free(j->built);
}

static void chapter5(const figure *fig, const char *scene, double seconds, const char *folder)
{
    job j = {.scene = scene, .fig = fig, .ref = measure_reference_get(scene, fig->material, seconds)};
    bis_outfile *file;
    bool first = true;
    char path[1024];

    snprintf(path, sizeof path, "%s/%s.json", folder, fig->name);
    still_check(bis_outfile_open(&file, path, NULL));
    j.us_camera = camera_us(&j.film, scene, &j.ref);
    j.exposure = exposure_of(&j.ref, &j.film);
    bis_image image = exposed(j.ref.width, j.ref.height, j.ref.L, j.exposure);
    j.json = (bis_json){.out = bis_outfile_stream(file)};
    bis_json_open(&j.json, NULL, '{');
    bis_json_text(&j.json, "title", fig->title);
    BIS_JSON_NUMBERS(&j.json, {"width", j.ref.width}, {"height", j.ref.height}, {"reference_error", j.ref.error});
    still_picture(&j.json, "reference", &image);
    bis_json_open(&j.json, "methods", '[');
    for (int m = 0; m < N_METHODS; m++) {
        if (!(fig->methods & SET(m))) continue;
        show_method(&j, m, first);
        first = false;
    }
    bis_json_close(&j.json);
    bis_json_close(&j.json);
    still_check(bis_outfile_commit(file, NULL));
    bis_film_clear(&j.film);
    measure_reference_free(&j.ref);
}

/* ---- prices ---- */

enum { N_M = 3, N_N = 3, GRID = N_M * N_N };

/* y = p x + q z by least squares of relative errors, both at least 0. */
static void fit(double *p, double *q, const double *x, const double *z, const double *y, int n)
{
    double xx = 0, xz = 0, zz = 0, x1 = 0, z1 = 0;

    for (int i = 0; i < n; i++) {
        const double a = x[i] / y[i], b = z[i] / y[i];
        xx += a * a, xz += a * b, zz += b * b, x1 += a, z1 += b;
    }
    const double det = xx * zz - xz * xz;
    *p = (x1 * zz - z1 * xz) / det;
    *q = (z1 * xx - x1 * xz) / det;
    if (*p < 0) *p = 0, *q = z1 / zz;
    if (*q < 0) *q = 0, *p = x1 / xx;
}

/* price MATERIAL METHOD ns_candidate ns_ray A B M:N relMSE*us-at-15/800 relMSE*us-at-best */
static void price(bis_film *film, const bis_scene *built, const char *scene, const measure_setting *material,
    const measure_reference *ref, const method *m, double us_camera, int seeds)
{
    static const unsigned Ms[N_M] = {64, 256, 1024}, Ns[N_N] = {4, 16, 64};
    double one_M[GRID], one_N[GRID], M[GRID], rays[GRID], us[GRID], e[GRID], A, B, candidate, per_ray;

    for (int i = 0; i < GRID; i++) {
        const trial t = run(film, built, scene, material->text, ref, m, Ns[i % N_N], Ms[i / N_N], seeds);
        one_M[i] = 1.0 / t.M, one_N[i] = 1.0 / t.N;
        M[i] = t.M, rays[i] = t.rays, us[i] = t.us - us_camera, e[i] = t.error.mean - ref->error;
    }
    fit(&A, &B, one_M, one_N, e, GRID);
    fit(&candidate, &per_ray, M, rays, us, GRID);
    const double share = rays[GRID - 1] / Ns[N_N - 1], c_N = per_ray * share,
                 best = pow(sqrt(A * candidate) + sqrt(B * c_N), 2);
    const double fixed = (A / 800 + B / 15) * (800 * candidate + 15 * c_N);
    printf("price %s %s %.2f %.1f %.3g %.3g %.3g %.3g %.3g\n", material->name, m->name, 1e3 * candidate, 1e3 * per_ray,
        A, B, sqrt(A * c_N / (B * candidate)), fixed, best);
    fflush(stdout);
}

static void prices(const char *scene, double seconds)
{
    static const int which[] = {PRINTED, OURS, PRODUCT};
    bis_film film = {0};

    for (int i = 0; i < MEASURE_MATERIALS; i++) {
        const measure_setting *material = &measure_materials[i];
        measure_reference ref = measure_reference_get(scene, material->text, seconds);
        const double us_camera = camera_us(&film, scene, &ref);
        for (int k = 0; k < 3; k++) {
            bis_scene *built = build(scene, material->text, &methods[which[k]]);
            price(&film, built, scene, material, &ref, &methods[which[k]], us_camera, which[k] == PRINTED ? 2 : 8);
            bis_scene_free(built);
        }
        measure_reference_free(&ref);
    }
    bis_film_clear(&film);
}

/* ---- */

int main(int argc, char **argv)
{
    if (argc >= 3 && strcmp(argv[1], "still") == 0 && still_write(argv[2], argv + 3, argc - 3)) return 0;
    if (argc == 4 && strcmp(argv[1], "price") == 0) {
        prices(argv[3], atof(argv[2]));
        return 0;
    }
    for (size_t i = 0; argc == 6 && strcmp(argv[1], "chapter5") == 0 && i < sizeof figures / sizeof *figures; i++) {
        if (strcmp(figures[i].name, argv[4]) != 0) continue;
        chapter5(&figures[i], argv[5], atof(argv[2]), argv[3]);
        return 0;
    }
    fprintf(stderr,
        "usage: figures still FOLDER [FIGURE...] | chapter5 SECONDS FOLDER FIGURE SCENE | price SECONDS SCENE\n");
    return 2;
}
