/* SPDX-License-Identifier: BSD-2-Clause */
/* bench_error: what error at what time? One thread, in this process, against a reference (scripts/bench/measure.h).
 *
 *     bench_error reference SECONDS SCENE    makes the four materials' references, so that nothing else waits for them
 *     bench_error equal SECONDS SCENE        the settings `contest`, N tuned to 20 us a shaded pixel
 *     bench_error resample SECONDS SCENE     the settings `resamplers` as they are
 *     bench_error steps SECONDS SCENE        the settings `steps`, 16 antialiased camera samples each
 *
 * SCENE is a template (measure.h), SECONDS what its references may take. Output: lines of words for
 * scripts/bench/bench_table.awk.
 *
 * Equal time. N is found by the clock alone, with seeds that measure nothing, before any error is known: the seconds of
 * the render phase, camera rays and film included, per pixel that shows geometry. Then five fresh seeds. Each setting
 * is as it stands here, for every scene and material. */
#include "measure.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The contest; `@` is tuned. `ours` is what the table judges, `mix` stands beside it, the others are rivals. It was
 * chosen by five seeds of all pairs; those that measure here (FIRST_SEED and on) are others. */
static const measure_setting contest[] = {
    {"mis-iid", "Sampler \"random\" Integrator \"mis\" \"integer samples\" @"},
    {"mis-50", "Sampler \"sobol\" Integrator \"mis\" \"integer samples\" @ \"bool stratify\" true"},
    {"mis-90", "Sampler \"sobol\" Integrator \"mis\" \"integer samples\" @ \"float split\" 0.9 \"bool stratify\" true"},
    {"em", "Sampler \"sobol\" Integrator \"em\" \"integer samples\" @ \"bool stratify\" true"},
    {"brdf", "Sampler \"sobol\" Integrator \"brdf\" \"integer samples\" @"},
    {"mix", "Sampler \"stratified\" Integrator \"sir\" \"integer candidates\" 1600 \"integer shadowrays\" @"},
    {"ours", "Sampler \"stratified\" Integrator \"sir\" \"integer candidates\" 256 \"integer shadowrays\" @ \"string "
     "proposal\" \"product\""},
};

/* Both levers together against none, at the same M and N. */
static const measure_setting resamplers[] = {
    {"independent", "Sampler \"stratified\" Integrator \"sir\" \"integer candidates\" 800 \"integer shadowrays\" 50 "
                    "\"bool stratify\" false \"string resampling\" \"multinomial\""},
    {"ours", "Sampler \"stratified\" Integrator \"sir\" \"integer candidates\" 800 \"integer shadowrays\" 50"},
};

/* What each part of the default is worth; then the other integrators, and the camera sample alone. The empty setting is
 * the default itself. */
#define SIR "Integrator \"sir\" "
#define PRODUCT SIR "\"string proposal\" \"product\" \"integer candidates\" 64 \"integer shadowrays\" 24 "
#define EDGES "Sampler \"sobol\" \"integer edgesamples\" 8 \"float edgelight\" 0.25 "
static const measure_setting steps[] = {
    {"thesis", "Sampler \"stratified\" " SIR},
    {"sobol", "Sampler \"sobol\" " SIR},
    {"edges", EDGES SIR},
    {"product", EDGES PRODUCT},
    {"learn", EDGES PRODUCT "\"bool learn\" true"},
    {"default", ""},
    {"em", "Sampler \"stratified\" Integrator \"em\""},
    {"brdf", "Sampler \"stratified\" Integrator \"brdf\""},
    {"mis", "Sampler \"stratified\" Integrator \"mis\""},
    {"unoccluded", "Sampler \"stratified\" Integrator \"unoccluded\" \"integer candidates\" 1"},
};

enum { STEPS = sizeof steps / sizeof *steps, STEP_SPP = 16, STEP_SEEDS = 2 };
enum { SEEDS = 5, FIRST_SEED = 21, PILOT_SEED = 101, MIN_N = 2, MAX_N = 4096,
    N_CONTEST = sizeof contest / sizeof *contest, N_RESAMPLERS = 2 };
static const double us_per_pixel = 20;

typedef struct job {
    const char *scene; /* template */
    measure_reference ref[MEASURE_MATERIALS];
    bis_film film;
} job;

static bis_scene_desc *parse(const job *j, const measure_setting *s, unsigned N, int material)
{
    return measure_parse(j->scene, s->text, N, measure_materials[material].text);
}

/* ---- the clock ---- */

/* The smaller of two renders. */
static double time_of(job *j, const bis_scene *scene, const measure_setting *s, unsigned N, int material)
{
    bis_scene_desc *desc = parse(j, s, N, material);
    double best = (double)INFINITY;

    for (int i = 0; i < 2; i++) best = fmin(best, measure_render(&j->film, scene, desc, PILOT_SEED, 1, 1, NULL));
    bis_scene_desc_free(desc);
    return 1e6 * best / (double)measure_shaded(&j->film);
}

/* Time is nearly linear in N: from the cost at MIN_N and the last N, the next; at most four times the last, since
 * repeats that are traced once bend the line. */
static unsigned tune(job *j, const bis_scene *scene, const measure_setting *s, int material, unsigned guess)
{
    const double t0 = time_of(j, scene, s, MIN_N, material);
    unsigned N = guess;

    for (int i = 0; i < 4; i++) {
        double t = time_of(j, scene, s, N, material);
        if (fabs(t / us_per_pixel - 1) < 0.03) break;
        double next = t > t0 ? MIN_N + (N - MIN_N) * (us_per_pixel - t0) / (t - t0) : 4.0 * N;
        N = (unsigned)round(fmax(MIN_N, fmin(fmin(next, 4.0 * N), MAX_N)));
    }
    return N;
}

/* ---- errors ---- */

/* One line: scene setting material N us error own-error-of-the-reference trimmed seed-by-seed. */
static void measure_seeds(job *j, const bis_scene *scene, const measure_setting *s, unsigned N, int material)
{
    bis_scene_desc *desc = parse(j, s, N, material);
    const char *slash = strrchr(j->scene, '/');
    measure_error e[SEEDS];
    double seconds = (double)INFINITY, mean = 0, trimmed = 0;

    for (int i = 0; i < SEEDS; i++) {
        seconds = fmin(seconds, measure_render(&j->film, scene, desc, FIRST_SEED + (uint64_t)i, 1, 1, NULL));
        e[i] = measure_relmse(&j->film, &j->ref[material], false);
        mean += e[i].mean / SEEDS;
        trimmed += e[i].trimmed / SEEDS;
    }
    printf("%s %s %s %u %.2f %.3e %.1e %.3e", slash ? slash + 1 : j->scene, measure_materials[material].name, s->name,
        N, 1e6 * seconds / (double)measure_shaded(&j->film), mean, j->ref[material].error, trimmed);
    for (int i = 0; i < SEEDS; i++) printf(" %.3e", e[i].mean);
    printf("\n");
    fflush(stdout);
    bis_scene_desc_free(desc);
}

static void compare_settings(job *j, const measure_setting *settings, int n, bool tuned)
{
    for (int i = 0; i < n; i++) {
        unsigned N = 32;
        bis_scene_desc *desc = parse(j, &settings[i], N, 0);
        bis_scene *scene = measure_build(desc);
        for (int material = 0; material < MEASURE_MATERIALS; material++) {
            if (tuned) N = tune(j, scene, &settings[i], material, N > MIN_N ? N : 32);
            measure_seeds(j, scene, &settings[i], N, material);
        }
        bis_scene_free(scene);
        bis_scene_desc_free(desc);
    }
}

/* ---- the steps to the default ---- */

/* A line for each setting: steps material setting seconds us-a-camera-sample relMSE relMSE-x-seconds. Seeds are the
 * outer loop, so that what the machine does besides meets all settings. */
static void measure_steps(job *j, int material)
{
    double seconds[STEPS], error[STEPS] = {0};

    for (int seed = 0; seed < STEP_SEEDS; seed++) {
        for (int i = 0; i < STEPS; i++) {
            bis_scene_desc *desc = parse(j, &steps[i], 0, material);
            bis_scene *scene = measure_build(desc);
            double t = measure_render(&j->film, scene, desc, FIRST_SEED + (uint64_t)seed, STEP_SPP, 1, NULL);
            seconds[i] = seed ? fmin(seconds[i], t) : t;
            error[i] += (measure_relmse(&j->film, &j->ref[material], true).mean - j->ref[material].error) / STEP_SEEDS;
            bis_scene_free(scene);
            bis_scene_desc_free(desc);
        }
    }
    for (int i = 0; i < STEPS; i++)
        printf("steps %s %s %.3f %.3f %.2e %.2e\n", measure_materials[material].name, steps[i].name, seconds[i],
               1e6 * seconds[i] / (STEP_SPP * (double)j->film.width * j->film.height), error[i], error[i] * seconds[i]);
    fflush(stdout);
}

/* ---- */

static void print_reference(const job *j, int material)
{
    const measure_reference *r = &j->ref[material];
    const char *slash = strrchr(j->scene, '/');

    printf("%s %s %.1e %.2f %+.4f %g\n", slash ? slash + 1 : j->scene, measure_materials[material].name, r->error,
        r->disagree, r->difference, r->seconds);
    fflush(stdout);
}

int main(int argc, char **argv)
{
    if (argc != 4) {
        fprintf(stderr, "usage: bench_error reference|equal|resample|steps SECONDS SCENE\n");
        return 2;
    }
    const char *what = argv[1];
    job j = {.scene = argv[3]};

    for (int m = 0; m < MEASURE_MATERIALS; m++) {
        j.ref[m] = measure_reference_get(j.scene, measure_materials[m].text, atof(argv[2]));
        if (strcmp(what, "reference") == 0) print_reference(&j, m);
    }
    if (strcmp(what, "equal") == 0) compare_settings(&j, contest, N_CONTEST, true);
    if (strcmp(what, "resample") == 0) compare_settings(&j, resamplers, N_RESAMPLERS, false);
    for (int m = 0; strcmp(what, "steps") == 0 && m < MEASURE_MATERIALS; m++) measure_steps(&j, m);
    for (int m = 0; m < MEASURE_MATERIALS; m++) measure_reference_free(&j.ref[m]);
    bis_film_clear(&j.film);
    return 0;
}
