/* SPDX-License-Identifier: BSD-2-Clause */
/* bench_light: what it costs to get a map ready, to draw from it, and to look it up; and the points of each sampler.
 *
 *     bench_light [WIDTH]      default 4096: a WIDTH x WIDTH/2 map, log-uniform over six decades with a few lamps
 *
 * Prints one figure a line: seconds to build each table, bytes a pixel, ns a draw. One thread: OMP_NUM_THREADS=1. */
#include "bis/base/clock.h"
#include "bis/thesis/importance.h"
#include "bis/base/mem.h"
#include "bis/thesis/regions.h"
#include "bis/thesis/rng.h"
#include "bis/thesis/sampler.h"
#include "bis/thesis/warp.h"
#include "bis/base/image.h"

#include "thesis/light_many.h"

#include <stdio.h>
#include <stdlib.h>

static bis_status make_map(bis_envmap *em, int width, bis_diag *diag)
{
    bis_image image;
    bis_status status = bis_image_init(&image, width, width / 2, diag);
    if (status) return status;
    bis_rng rng;
    bis_rng_init(&rng, 1, 0, 0, 0);
    for (size_t i = 0; i < (size_t)width * (size_t)(width / 2); i++) {
        double l = exp(13.8 * bis_rng_double(&rng) - 7) * (bis_rng_double(&rng) < 1e-4 ? 1e4 : 1);
        image.pixels[i] = rgb_from(l, 0.8 * l, 0.5 * l);
    }
    return bis_envmap_from_latlong(em, &image, diag);
}

static void bench_table(const char *name, const bis_envmap *em, const bis_importance_options *options)
{
    enum { DRAWS = 4000000 };
    bis_diag diag = {0};
    bis_importance *im;
    double pixels = (double)em->width * em->height, t = bis_clock_now();
    if (bis_importance_new(&im, em, options, &diag)) exit(1);
    printf("%-18s build_seconds %.3f  bytes_per_pixel %.2f", name, bis_clock_now() - t,
        (double)bis_importance_bytes(im) / pixels);

    bis_rng rng;
    bis_rng_init(&rng, 2, 0, 0, 0);
    bis_map_sample s;
    double sum = 0;
    t = bis_clock_now();
    for (int i = 0; i < DRAWS; i++) {
        double u[4] = {bis_rng_double(&rng), bis_rng_double(&rng), bis_rng_double(&rng), bis_rng_double(&rng)};
        bool drawn = options->curve ? bis_importance_sample_curve(im, (i % 800 + u[0]) / 800, u + 2, &s)
                                    : bis_importance_sample(im, u, &s);
        if (drawn) sum += (double)s.w_local.z;
    }
    printf("  ns_per_draw %.1f  (mean z %.3f)\n", (bis_clock_now() - t) / DRAWS * 1e9, sum / DRAWS);
    bis_importance_free(im);
}

/* 256 random directions, again and again: one after the other, and all at once. */
static void bench_look_up(const bis_envmap *em)
{
    enum { N = 256, TIMES = 20000 };
    static const vec3 axis[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    static float floats[BIS_LANES_ARRAYS * N];
    static uint32_t pixel[N];
    const bis_lanes y = bis_lanes_in(floats, N);
    uint64_t sum = 0;
    bis_rng rng;
    bis_rng_init(&rng, 3, 0, 0, 0);
    for (int i = 0; i < N; i++) {
        const vec3 w = bis_warp_sphere(bis_rng_double(&rng), bis_rng_double(&rng));
        y.x[i] = w.x, y.y[i] = w.y, y.z[i] = w.z;
    }
    double t = bis_clock_now();
    for (int k = 0; k < TIMES; k++) sum += bis_envmap_pixel(em, (vec3){y.x[k % N], y.y[k % N], y.z[k % N]});
    printf("%-18s ns_one_by_one %.1f", "pixel of direction", (bis_clock_now() - t) / TIMES * 1e9);
    t = bis_clock_now();
    for (int k = 0; k < TIMES; k++, sum += pixel[k % N]) bis_envmap_pixels(em, axis, pixel, &y, N);
    printf("  ns_of_many %.2f  (sum %llu)\n", (bis_clock_now() - t) / TIMES / N * 1e9, (unsigned long long)sum);
}

/* Sets of 16 points, of which a pixel has 64. */
static void bench_points(bis_sampler_kind kind)
{
    enum { N = 16, SETS = 100000 };
    bis_sampler sampler = {.kind = kind, .seed = 1, .jitter = true};
    double u[N][2], sum = 0, t = bis_clock_now();
    bis_sampler_set_spp(&sampler, 64);
    for (uint64_t k = 0; k < SETS; k++) {
        bis_stream stream;
        bis_stream_init(&stream, &sampler, k / 64, k % 64);
        bis_stream_points(&stream, 1, N, u);
        sum += u[k % N][0];
    }
    printf("%-18s ns_per_point %.1f  (mean %.3f)\n", bis_sampler_name(kind), (bis_clock_now() - t) / SETS / N * 1e9,
           sum / SETS);
}

int main(int argc, char **argv)
{
    int width = argc > 1 ? atoi(argv[1]) : 4096;
    bis_diag diag = {0};
    bis_envmap em;
    bis_regions regions;
    if (width < 2 || make_map(&em, width, &diag)) return 1;
    printf("map %dx%d\n", em.width, em.height);

    double t = bis_clock_now();
    if (bis_regions_init(&regions, &em, 8, &diag)) return 1;
    printf("%-18s build_seconds %.3f  regions %u\n", "components", bis_clock_now() - t, regions.n);
    bis_regions_clear(&regions);

    bench_table("alias", &em, &(bis_importance_options){.table = true, .levels = 8});
    bench_table("alias, b = 0.15", &em, &(bis_importance_options){.table = true, .area_exponent = 0.15, .levels = 8});
    bench_table("cdf", &em, &(bis_importance_options){.table = true, .table_kind = BIS_TABLE_CDF, .levels = 8});
    bench_table("curve", &em, &(bis_importance_options){.curve = true, .levels = 8});
    bench_table("curve, b = 0.15", &em, &(bis_importance_options){.curve = true, .area_exponent = 0.15, .levels = 8});
    bench_look_up(&em);
    for (int kind = BIS_SAMPLER_RANDOM; kind <= BIS_SAMPLER_HALTON; kind++) bench_points((bis_sampler_kind)kind);
    bis_envmap_clear(&em);
    return 0;
}
