/* SPDX-License-Identifier: BSD-2-Clause */
/* bench_scale: how time and memory grow with the work. One thread, processor seconds of the render phase, the smaller
 * of two where it is short; loading and building by the clock on the wall.
 *
 *     bench_scale sweep SCENE embree|grid         time against M, N, camera samples, pixels; SCENE is a template
 * (measure.h) bench_scale build SCENE embree|grid WHAT X  one size of mesh or map: loading, tables, accelerator, render
 *     bench_scale map WIDTH FILE                  make a WIDTH x WIDTH/2 map: noise over six decades, lamps
 *     bench_scale peak COMMAND...                 run it; bytes that it held at most, as the system counts, on standard
 * output
 *
 * Output: lines `WHAT ACCELERATOR X VALUE` for scripts/bench/bench_plot.awk. */
#include "measure.h"

#include "bis/base/mem.h"
#include "bis/thesis/rng.h"
#include "bis/files/image_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

static const char sir[] =
    "Sampler \"stratified\" Integrator \"sir\" \"integer candidates\" 800 \"integer shadowrays\" 15";

static bis_scene_desc *parse(const char *path, const char *accelerator)
{
    const bool grid = strcmp(accelerator, "grid") == 0;
    bis_scene_desc *desc = measure_parse(path, sir, 0, measure_materials[2].text);

    desc->accel.kind = grid ? BIS_ACCEL_GRID : BIS_ACCEL_EMBREE;
    desc->accel.n_threads = 1;
    bis_sampler_set_spp(&desc->view.sampler, 1);
    return desc;
}

static void print(const char *what, const char *accelerator, double x, double value)
{
    printf("%s %s %g %.6g\n", what, accelerator, x, value);
    fflush(stdout);
}

static double render_seconds(const bis_scene *scene, bis_scene_desc *desc)
{
    bis_film film = {0};
    const uint32_t spp = (uint32_t)desc->view.sampler.spp;
    double best = measure_render(&film, scene, desc, 1, spp, 1, NULL);

    if (best < 2) best = fmin(best, measure_render(&film, scene, desc, 1, spp, 1, NULL));
    bis_film_clear(&film);
    return best;
}

/* ---- sweeps over what needs no other scene ---- */

static void sweep(const char *path, const char *accelerator)
{
    bis_scene_desc *desc = parse(path, accelerator);
    bis_scene *scene = measure_build(desc);
    const bis_settings settings = desc->view.settings;
    const int width = desc->view.film.width, height = desc->view.film.height;

    for (uint32_t M = 50; M <= 12800; M *= 2) {
        desc->view.settings.candidates = M;
        print("candidates", accelerator, M, render_seconds(scene, desc));
    }
    desc->view.settings = settings;
    for (uint32_t N = 1; N <= 1024; N *= 2) {
        desc->view.settings.shadowrays = N;
        print("shadowrays", accelerator, N, render_seconds(scene, desc));
    }
    desc->view.settings = settings;
    for (uint32_t spp = 1; spp <= 32; spp *= 2) {
        bis_sampler_set_spp(&desc->view.sampler, spp);
        print("samples", accelerator, spp, render_seconds(scene, desc));
    }
    bis_sampler_set_spp(&desc->view.sampler, 1);
    for (int k = 1; k <= 16; k *= 2) {
        desc->view.film.width = width * k / 4;
        desc->view.film.height = height * k / 4;
        print(
            "pixels", accelerator, (double)desc->view.film.width * desc->view.film.height, render_seconds(scene, desc));
    }
    bis_scene_free(scene);
    bis_scene_desc_free(desc);
}

/* ---- one size of mesh or map ---- */

/* Loading and building by the clock on the wall, the smallest of up to five. */
static void build(const char *path, const char *accelerator, const char *what, double x)
{
    static const char *const names[] = {"load", "envmap", "accel", "render", "accel_bytes", "light_bytes"};
    bis_scene_desc *desc = parse(path, accelerator);
    bis_scene *scene = measure_build(desc);
    bis_scene_seconds best = scene->seconds;

    for (int i = 0; i < 4 && best.load + best.envmap + best.accel < 1; i++) {
        bis_scene_free(scene);
        scene = measure_build(desc);
        best.load = fmin(best.load, scene->seconds.load);
        best.envmap = fmin(best.envmap, scene->seconds.envmap);
        best.accel = fmin(best.accel, scene->seconds.accel);
    }
    const double values[] = {best.load, best.envmap, best.accel, render_seconds(scene, desc),
                             (double)bis_accel_bytes(scene->accel), (double)bis_light_bytes(scene->light)};

    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        char name[64];
        snprintf(name, sizeof name, "%s_%s", what, names[i]);
        print(name, accelerator, x, values[i]);
    }
    bis_scene_free(scene);
    bis_scene_desc_free(desc);
}

/* ---- maps ---- */

static void make_map(int width, const char *path)
{
    bis_diag diag = {0};
    bis_image image;
    bis_rng rng;

    measure_check(bis_image_init(&image, width, width / 2, &diag), &diag);
    bis_rng_init(&rng, 1, 0, 0, 0);
    for (size_t i = 0; i < (size_t)width * (size_t)(width / 2); i++) {
        double lamp = bis_rng_double(&rng) < 1e-4 ? 1e4 : 1, l = lamp * exp(13.8 * bis_rng_double(&rng) - 7);
        image.pixels[i] = rgb_from(l, 0.8 * l, 0.5 * l);
    }
    measure_check(bis_image_save(&image, path, &diag), &diag);
    bis_image_clear(&image);
}

/* ---- memory ---- */

static int peak(char **command)
{
    struct rusage usage;
    int status;
    pid_t child = fork();

    if (child == 0) {
        execvp(command[0], command);
        perror(command[0]);
        _exit(127);
    }
    if (child < 0 || wait4(child, &status, 0, &usage) != child || status != 0) return 1;
    printf("%.0f\n", 1024.0 * (double)usage.ru_maxrss);
    return 0;
}

int main(int argc, char **argv)
{
    const char *what = argc > 1 ? argv[1] : "";

    if (argc == 4 && strcmp(what, "sweep") == 0) sweep(argv[2], argv[3]);
    else if (argc == 6 && strcmp(what, "build") == 0) build(argv[2], argv[3], argv[4], atof(argv[5]));
    else if (argc == 4 && strcmp(what, "map") == 0) make_map(atoi(argv[2]), argv[3]);
    else if (argc > 2 && strcmp(what, "peak") == 0) return peak(argv + 2);
    else {
        fprintf(stderr, "usage: bench_scale sweep SCENE ACCELERATOR | build SCENE ACCELERATOR WHAT X | map WIDTH FILE "
                        "| peak COMMAND...\n");
        return 2;
    }
    return 0;
}
