/* SPDX-License-Identifier: BSD-2-Clause */
/* bench_auto: is what Integrator "auto" chooses as good as the best of a sweep? For scripts/bench/bench_auto.sh.
 *
 *     bench_auto PIXELS SCENE [SPP]
 *
 * Renders about PIXELS of the scene's pixels, every k-th, with each of the fixed settings of `table`, then lets auto
 * choose seven times (seven seeds, each pilot as for the whole picture) and renders with what it has chosen. One
 * thread, processor seconds.
 *
 * A setting's time to any given error is its cost x variance: seconds of a pass of the full picture times relMSE
 * (docs/budgets.md, over the pixels that show a surface) of a pass. Variance is the scatter of SEEDS renders of the scene's
 * own spp, relative to the mean of everything that was rendered, each method by the inverse of its error: all are
 * unbiased. Cost at full size is fill + (full pixels)/(pixels) (time - fill), fill the time of a picture of one
 * pixel: pools and clusters cost the same at any size.
 *
 * Output: "setting SCENE METHOD M N us-per-pixel relMSE cost-x-variance ratio-to-best"; "choice SCENE ..."; and at
 * last "auto SCENE mis-seconds S to-best LEAST MEDIAN MOST to-mis LEAST MEDIAN MOST": auto's time for SPP
 * (the scene's own) over the time to the same error of the best fixed setting, and of the best of five stratified mis, which
 * takes S seconds. The pilot is part of auto's time where S >= 1. */
#include "bis/base/mem.h"
#include "bis/render/render.h"
#include "tools/auto/auto.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { SEEDS = 4, CHOICES = 7, MOST = 64 };

/* What is fixed: around what is best anywhere, M and N in steps of two to four. */
static const struct {
    const char *name;
    uint32_t M, N;
} table[] = {
    {"em", 0, 16},       {"em", 0, 64},       {"brdf", 0, 8},      {"brdf", 0, 32},     {"mis", 0, 4},       {"mis", 0, 8},       {"mis", 0, 16},      {"mis", 0, 32},
    {"mis", 0, 64},      {"mix", 64, 4},      {"mix", 64, 8},      {"mix", 64, 16},     {"mix", 64, 32},     {"mix", 256, 4},     {"mix", 256, 16},    {"mix", 256, 64},
    {"mix", 1024, 16},   {"mix", 1024, 64},   {"product", 32, 4},  {"product", 32, 16}, {"product", 64, 8},  {"product", 64, 16}, {"product", 64, 32}, {"product", 128, 16},
    {"product", 128, 32}, {"product", 256, 16}, {"product", 256, 32}, {"product", 256, 64}, {"learn", 64, 16},   {"learn", 128, 32},  {"learn", 256, 32},
};

enum { N_TABLE = sizeof table / sizeof *table };

typedef struct measured {
    bis_settings settings;
    double *mean[SEEDS]; /* [pixels][3] */
    double seconds;      /* of a pass at full size */
    double relmse;       /* of a pass */
} measured;

typedef struct job {
    const char *name;
    bis_scene_desc *desc;
    bis_scene *scene;
    int full_width, full_height, width, height;
    double footprint;
    uint32_t spp; /* of the render that the choice is for */
    bool *shaded; /* [pixels]: shows a surface */
    measured of[MOST];
    int n;
} job;

static void check(bis_status status, bis_diag *diag)
{
    if (!status) return;
    for (size_t i = 0; i < diag->n; i++) fprintf(stderr, "%s\n", diag->messages[i].text);
    exit(1);
}

static double clock_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double render(job *j, bis_film *film, int width, int height, uint64_t seed, uint32_t spp)
{
    const bis_render_options options = {.budget = {.spp = spp}, .n_threads = 1, .footprint = j->footprint};
    bis_diag diag = {0};
    bis_render_result result;

    j->desc->view.sampler.seed = seed;
    bis_film_clear(film);
    check(bis_film_init(film, width, height, j->desc->view.film.crop, (bis_loc){0}, &diag), &diag);
    double start = clock_now();
    check(bis_render(&result, film, j->scene, j->desc, &j->desc->view, &options, &diag), &diag);
    return clock_now() - start;
}

static void measure(job *j, bis_settings settings)
{
    measured *m = &j->of[j->n++];
    bis_film film = {0};
    const uint32_t spp = (uint32_t)j->desc->view.sampler.spp;
    double fill = (double)INFINITY, all = (double)INFINITY;

    m->settings = j->desc->view.settings = settings;
    for (int i = 0; i < SEEDS; i++) {
        fill = fmin(fill, render(j, &film, 1, 1, 1, 1));
        all = fmin(all, render(j, &film, j->width, j->height, 1000 + (uint64_t)i, spp));
        const size_t n = 3 * (size_t)film.width * (size_t)film.height;
        m->mean[i] = bis_alloc(n, sizeof(double));
        for (size_t k = 0; k < n; k++) m->mean[i][k] = film.sum[k] / film.weight;
        for (size_t k = 0; k < n / 3; k++) j->shaded[k] |= film.hits[k] > 0;
    }
    const double scale = (double)j->full_width * j->full_height / ((double)j->width * j->height);
    m->seconds = fill + fmax(0, all / spp - fill) * scale;
    bis_film_clear(&film);
}

/* Against the mean of all: its own share of it, a part in n, is left to lie in it. */
static void judge(job *j)
{
    const size_t n = 3 * (size_t)j->width * (size_t)j->height;
    double *mean = bis_alloc(n, sizeof *mean), *weight = bis_alloc((size_t)j->n, sizeof *weight), m = 0;

    for (int round = 0; round < 3; round++) {
        double total = 0;
        for (int i = 0; i < j->n; i++) total += weight[i] = round ? 1 / fmax(j->of[i].relmse, 1e-12) : 1;
        for (size_t k = 0; k < n; k++) {
            mean[k] = 0;
            for (int i = 0; i < j->n; i++)
                for (int s = 0; s < SEEDS; s++) mean[k] += weight[i] / total * j->of[i].mean[s][k] / SEEDS;
        }
        m = 0;
        size_t shaded = 0;
        for (size_t k = 0; k < n; k++) {
            if (!j->shaded[k / 3]) continue;
            m += mean[k];
            shaded++;
        }
        m /= (double)shaded;
        for (int i = 0; i < j->n; i++) {
            double sum = 0;
            for (size_t k = 0; k < n; k++) {
                double own = 0, v = 0;
                if (!j->shaded[k / 3]) continue;
                for (int s = 0; s < SEEDS; s++) own += j->of[i].mean[s][k] / SEEDS;
                for (int s = 0; s < SEEDS; s++) v += (j->of[i].mean[s][k] - own) * (j->of[i].mean[s][k] - own) / (SEEDS - 1);
                sum += v / (mean[k] * mean[k] + m * m / 100);
            }
            j->of[i].relmse = sum / (double)shaded * (double)j->desc->view.sampler.spp;
        }
    }
    bis_free(mean);
    bis_free(weight);
}

static double product(const measured *m) { return m->seconds * m->relmse; }

/* A pilot as `bis render` would make it at full size. */
static bis_auto_report choose(job *j, uint64_t seed, double *seconds)
{
    const bis_render_options options = {.budget = {.spp = j->spp}, .n_threads = 1};
    bis_diag diag = {0};
    bis_auto_report report;
    bis_film_desc shrunk = j->desc->view.film;

    j->desc->view.film.width = j->full_width;
    j->desc->view.film.height = j->full_height;
    j->desc->view.settings = bis_settings_default(&bis_auto);
    j->desc->view.sampler.seed = seed;
    const double start = clock_now();
    check(bis_auto_choose(&report, j->scene, j->desc, &options, &diag), &diag);
    *seconds = clock_now() - start;
    j->desc->view.film = shrunk;
    return report;
}

static bis_settings settings_of(const char *name, uint32_t M, uint32_t N)
{
    const bool learns = strcmp(name, "learn") == 0, product = learns || strcmp(name, "product") == 0;
    bis_settings s = bis_settings_default(product || strcmp(name, "mix") == 0 ? &bis_sir : bis_integrator_find(name));

    if (M) s.candidates = M;
    s.samples = s.shadowrays = N;
    s.stratify = true;
    s.learn = learns;
    if (product) s.proposal = BIS_PROPOSAL_PRODUCT;
    return s;
}

static bool same_settings(const bis_settings *a, const bis_settings *b)
{
    if (a->integrator != b->integrator || a->shadowrays != b->shadowrays) return false;
    return a->integrator != &bis_sir || (a->candidates == b->candidates && a->proposal == b->proposal && a->learn == b->learn);
}

/* What was measured already is not measured again. */
static int find_or_measure(job *j, const bis_settings *s)
{
    int i = 0;
    while (i < j->n && !same_settings(&j->of[i].settings, s)) i++;
    if (i == j->n) measure(j, *s);
    return i;
}

static void print_method(const bis_settings *s)
{
    const bool sir = s->integrator == &bis_sir;
    printf(" %s %u %u", !sir ? s->integrator->name : s->learn ? "learn" : bis_proposal_name(s->proposal), sir ? (unsigned)s->candidates : 0, (unsigned)s->shadowrays);
}

static void print_setting(const job *j, int i, double best)
{
    const measured *m = &j->of[i];

    printf("setting %s", j->name);
    print_method(&m->settings);
    printf(" %.2f %.3e %.3e %.2f\n", 1e6 * m->seconds / ((double)j->full_width * j->full_height), m->relmse, product(m), product(m) / best);
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

int main(int argc, char **argv)
{
    bis_diag diag = {0};
    static job j;
    int chosen[CHOICES];
    double pilot[CHOICES], to_best[CHOICES], to_mis[CHOICES], best = (double)INFINITY, mis = (double)INFINITY, mis_seconds[CHOICES];

    if (argc < 3 || argc > 4) {
        fprintf(stderr, "usage: bench_auto PIXELS SCENE [SPP]\n");
        return 2;
    }
    j.name = strrchr(argv[2], '/') ? strrchr(argv[2], '/') + 1 : argv[2];
    check(bis_scene_parse(&j.desc, argv[2], &diag), &diag);
    j.spp = argc > 3 ? (uint32_t)strtoul(argv[3], NULL, 10) : (uint32_t)j.desc->view.sampler.spp;
    j.full_width = j.desc->view.film.width;
    j.full_height = j.desc->view.film.height;
    j.footprint = fmin(1, sqrt(atof(argv[1]) / ((double)j.full_width * j.full_height)));
    j.width = (int)round(j.footprint * j.full_width);
    j.height = (int)round(j.footprint * j.full_height);
    j.shaded = bis_alloc((size_t)j.width * (size_t)j.height, sizeof *j.shaded);
    j.desc->view.settings = bis_settings_default(&bis_auto);
    check(bis_scene_build(&j.scene, j.desc, &diag), &diag);

    for (size_t i = 0; i < N_TABLE; i++) {
        const bis_settings s = settings_of(table[i].name, table[i].M, table[i].N);
        measure(&j, s);
    }
    for (int i = 0; i < CHOICES; i++) {
        const bis_auto_report r = choose(&j, 1 + (uint64_t)i, &pilot[i]);
        chosen[i] = find_or_measure(&j, &r.settings);
    }
    judge(&j);
    for (int i = 0; i < N_TABLE; i++) {
        best = fmin(best, product(&j.of[i]));
        if (j.of[i].settings.integrator == &bis_mis) mis = fmin(mis, product(&j.of[i]));
    }
    for (int i = 0; i < j.n; i++) print_setting(&j, i, best);

    /* To the error of the picture that auto makes of the scene with SPP. */
    for (int i = 0; i < CHOICES; i++) {
        const measured *m = &j.of[chosen[i]];
        const double spp = j.spp, error = m->relmse / spp;
        mis_seconds[i] = mis / error;
        const double time = m->seconds * spp + (mis_seconds[i] < 1 ? 0 : pilot[i]);
        to_best[i] = time / (best / error);
        to_mis[i] = time / mis_seconds[i];
        printf("choice %s", j.name);
        print_method(&m->settings);
        printf(" pilot %.2f to-best %.2f to-mis %.2f\n", pilot[i], to_best[i], to_mis[i]);
    }
    qsort(to_best, CHOICES, sizeof *to_best, ascending);
    qsort(mis_seconds, CHOICES, sizeof *mis_seconds, ascending);
    qsort(to_mis, CHOICES, sizeof *to_mis, ascending);
    printf("auto %s mis-seconds %.1f to-best %.2f %.2f %.2f to-mis %.2f %.2f %.2f\n", j.name, mis_seconds[CHOICES / 2], to_best[0], to_best[CHOICES / 2], to_best[CHOICES - 1],
           to_mis[0], to_mis[CHOICES / 2], to_mis[CHOICES - 1]);
    bis_scene_free(j.scene);
    bis_scene_desc_free(j.desc);
    return 0;
}
