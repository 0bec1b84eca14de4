/* SPDX-License-Identifier: BSD-2-Clause */
/* bench_cost: where the time of SIR goes, one thread, and what a second thread is worth.
 *
 *     bench_cost cost|threads SCENE           a template (measure.h)
 *
 * For each material, 15 shadow rays and M = 400, 800, 1600 candidates, --spp 1, the smallest of several renders:
 *   - the rays of M = 800 are recorded and cast again, one after the other, by the same accelerator: their time alone;
 *   - a candidate's cost is the slope of time over M, with the rays that repeats save put back: drawing (the pool's
 *   share included), weighing,
 *     resampling. Once at the scene's size, once with four times the pixels, where the pool, drawn once a pass, hardly
 *     counts;
 *   - a black material costs camera rays and film: what remains of M = 800 is the time of SIR.
 * Output: lines of words for scripts/bench/bench_table.awk. */
#include "measure.h"

#include "bis/base/mem.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const measure_setting sir[] = {
    {"400", "Sampler \"stratified\" Integrator \"sir\" \"integer candidates\" 400 \"integer shadowrays\" 15"},
    {"800", "Sampler \"stratified\" Integrator \"sir\" \"integer candidates\" 800 \"integer shadowrays\" 15"},
    {"1600", "Sampler \"stratified\" Integrator \"sir\" \"integer candidates\" 1600 \"integer shadowrays\" 15"},
};
enum { FEW, MEDIUM, MANY, REPEATS = 5, RAYS = 1024 }; /* RAYS: as many at once as src/render/wave.c hands over */

/* An accelerator that remembers the rays which it hands on. */
typedef struct recorder {
    bis_accel base;
    const bis_accel *inner;
    ray *rays;
    size_t n, capacity;
} recorder;

static bool recorder_intersect(const bis_accel *a, const ray *r, bis_hit *hit)
{
    return bis_accel_intersect(((const recorder *)a)->inner, r, hit);
}
static size_t recorder_bytes(const bis_accel *a) { return bis_accel_bytes(((const recorder *)a)->inner); }
static void recorder_free(bis_accel *a) { bis_free(((recorder *)a)->rays); }

static bool recorder_occluded(const bis_accel *a, const ray *r)
{
    recorder *rec = (recorder *)a; /* made by us, not const, and one thread renders */

    if (rec->n < rec->capacity) rec->rays[rec->n++] = *r;
    return bis_accel_occluded(rec->inner, r);
}

/* Without functions for many rays at once: rays then come one by one. */
static const bis_accel_ops recorder_ops = {.name = "recorder",
    .intersect = recorder_intersect,
    .occluded = recorder_occluded,
    .bytes = recorder_bytes,
    .free = recorder_free};

static double best_of(
    int repeats, bis_film *film, const bis_scene *scene, bis_scene_desc *desc, int threads, bis_render_result *result)
{
    double best = (double)INFINITY;
    uint32_t spp = (uint32_t)desc->view.sampler.spp;

    for (int i = 0; i < repeats; i++) best = fmin(best, measure_render(film, scene, desc, 1, spp, threads, result));
    return best;
}

/* Seconds that the render's own shadow rays take, one by one; *packets receives those of RAYS at a time. */
static double replay(double *packets, bis_film *film, bis_scene *scene, bis_scene_desc *desc, size_t n_rays)
{
    recorder rec = {.base = {&recorder_ops, scene->accel->geometry}, .inner = scene->accel, .capacity = n_rays};
    double best = (double)INFINITY;
    size_t occluded = 0, in_packets = 0;

    *packets = (double)INFINITY;
    rec.rays = bis_alloc(n_rays, sizeof *rec.rays);
    if (!rec.rays) {
        fprintf(stderr, "no memory for %zu rays\n", n_rays);
        exit(1);
    }
    bis_accel *own = scene->accel;
    scene->accel = &rec.base;
    measure_render(film, scene, desc, 1, 1, 1, NULL);
    scene->accel = own;
    for (int i = 0; i < REPEATS; i++) {
        double start = measure_clock();
        for (size_t k = 0; k < rec.n; k++) occluded += bis_accel_occluded(own, &rec.rays[k]);
        best = fmin(best, measure_clock() - start);
        start = measure_clock();
        for (size_t k = 0; k < rec.n; k += RAYS) {
            const uint32_t n = (uint32_t)(rec.n - k < RAYS ? rec.n - k : RAYS);
            bool answer[RAYS];
            bis_accel_occluded_many(own, &rec.rays[k], n, answer);
            for (uint32_t l = 0; l < n; l++) in_packets += answer[l];
        }
        *packets = fmin(*packets, measure_clock() - start);
    }
    if (rec.n != n_rays) fprintf(stderr, "%zu rays recorded of %zu\n", rec.n, n_rays);
    if (in_packets != occluded) fprintf(stderr, "%zu rays are occluded, %zu in packets\n", occluded, in_packets);
    recorder_free(&rec.base);
    return best;
}

/* Nanoseconds for one more candidate, from FEW to MANY. */
static double candidate_ns(
    bis_film *film, bis_scene *const *scene, const char *path, const char *material, int scale, double ray_seconds)
{
    double t[3];
    bis_render_result result[3];

    for (int k = FEW; k <= MANY; k += 2) {
        bis_scene_desc *desc = measure_parse(path, sir[k].text, 0, material);
        desc->view.film.width *= scale;
        desc->view.film.height *= scale;
        bis_sampler_set_spp(&desc->view.sampler, 1);
        t[k] = best_of(scale == 1 ? REPEATS : 2, film, scene[k], desc, 1, &result[k]);
        bis_scene_desc_free(desc);
    }
    double saved = ((double)result[FEW].counters.shadow_rays - (double)result[MANY].counters.shadow_rays) * ray_seconds;
    return 1e9 * (t[MANY] - t[FEW] + saved) /
           ((double)result[MANY].counters.candidates - (double)result[FEW].counters.candidates);
}

/* cost MATERIAL us_sir us_camera rays_per_pixel ns_ray ns_candidate ns_candidate_large sir:rays ns_ray_in_packets */
static void cost(bis_film *film, bis_scene *const *scene, const char *path, int m)
{
    const char *material = measure_materials[m].text;
    bis_scene_desc *desc = measure_parse(path, sir[MEDIUM].text, 0, material);
    bis_scene_desc *black = measure_parse(path, "Sampler \"stratified\" Integrator \"em\" \"integer samples\" 1", 0,
                                          measure_materials[MEASURE_MATERIALS].text);
    bis_render_result result;

    bis_sampler_set_spp(&desc->view.sampler, 1);
    bis_sampler_set_spp(&black->view.sampler, 1);
    double camera = best_of(REPEATS, film, scene[MEDIUM], black, 1, NULL);
    double all = best_of(REPEATS, film, scene[MEDIUM], desc, 1, &result);
    const double rays = (double)result.counters.shadow_rays, pixels = (double)measure_shaded(film);
    double packets, alone = replay(&packets, film, scene[MEDIUM], desc, result.counters.shadow_rays);
    double candidate = candidate_ns(film, scene, path, material, 1, packets / rays);
    double candidate_large = candidate_ns(film, scene, path, material, 2, packets / rays);
    printf("cost %s %.3f %.3f %.2f %.1f %.3f %.3f %.3f %.1f\n", measure_materials[m].name,
        1e6 * (all - camera) / pixels, 1e6 * camera / pixels, rays / pixels, 1e9 * alone / rays, candidate,
        candidate_large, (all - camera) / alone, 1e9 * packets / rays);
    fflush(stdout);
    bis_scene_desc_free(desc);
    bis_scene_desc_free(black);
}

/* threads MATERIAL seconds_1 seconds_2 ratio busy: by the clock on the wall, four passes, in turns. busy: the ratio
 * that the processors' clock would allow, twice the seconds of one thread over those of two: what is lost on an idle
 * machine, too. */
static void threads(bis_film *film, const bis_scene *scene, const char *path, int m)
{
    bis_scene_desc *desc = measure_parse(path, sir[MEDIUM].text, 0, measure_materials[m].text);
    double wall[3] = {0, (double)INFINITY, (double)INFINITY}, cpu[3] = {0, (double)INFINITY, (double)INFINITY};

    for (int i = 0; i < REPEATS; i++) {
        for (int n = 1; n <= 2; n++) {
            bis_render_result result;
            cpu[n] = fmin(cpu[n], measure_render(film, scene, desc, 1, 4, n, &result));
            wall[n] = fmin(wall[n], result.seconds);
        }
    }
    printf("threads %s %.3f %.3f %.3f %.3f\n", measure_materials[m].name, wall[1], wall[2], wall[1] / wall[2],
        2 * cpu[1] / cpu[2]);
    fflush(stdout);
    bis_scene_desc_free(desc);
}

int main(int argc, char **argv)
{
    bis_scene_desc *desc[3];
    bis_scene *scene[3];
    bis_film film = {0};

    if (argc != 3) {
        fprintf(stderr, "usage: bench_cost cost|threads SCENE\n");
        return 2;
    }
    const bool count_threads = strcmp(argv[1], "threads") == 0;
    for (int k = 0; k < 3; k++) {
        desc[k] = measure_parse(argv[2], sir[k].text, 0, measure_materials[0].text);
        scene[k] = measure_build(desc[k]);
    }
    for (int m = 0; m < MEASURE_MATERIALS; m++) {
        if (count_threads) threads(&film, scene[MEDIUM], argv[2], m);
        else cost(&film, scene, argv[2], m);
    }
    for (int k = 0; k < 3; k++) {
        bis_scene_free(scene[k]);
        bis_scene_desc_free(desc[k]);
    }
    bis_film_clear(&film);
    return 0;
}
