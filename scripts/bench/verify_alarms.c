/* SPDX-License-Identifier: BSD-2-Clause */
/* verify_alarms: how often does `bis verify` accuse what is right? Runs all its checks on a scene with many seeds, each
 * with fewer draws (bis_verify.halvings), and counts the runs in which a test failed. For
 * scripts/bench/verify_alarms.sh.
 *
 *     verify_alarms HALVINGS FIRST RUNS WIDTH [--printed | --picture | --product] SCENE ...
 *
 * WIDTH: maps are averaged to so many columns, a power of 2, because a sum over 10^6 patches takes seconds. --printed:
 * with the thesis's E6 and E21 as printed, which should be found. --picture: the pictures alone; --product: these, by
 * sir with proposal product, learned visibility and edge samples in place of the scene's own settings. A row for each
 * scene: name, runs, runs with an alarm, tests in a run, skipped among them, least p; then the failed tests. */
#include "bis/base/mem.h"
#include "bis/base/image.h"
#include "bis/files/image_file.h"
#include "tools/verify/verify.h"

#include <libgen.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The mean of each block of k x k pixels. */
static bis_status shrink(bis_image *image, int width)
{
    const int k = image->width / width;
    bis_image small;

    if (k < 2) return BIS_OK;
    const bis_status status = bis_image_init(&small, image->width / k, image->height / k, NULL);
    if (status) return status;
    for (int y = 0; y < small.height; y++) {
        for (int x = 0; x < small.width; x++) {
            rgbd sum = {0, 0, 0};
            for (int i = 0; i < k * k; i++) {
                const rgb c = image->pixels[(size_t)(y * k + i / k) * (size_t)image->width + (size_t)(x * k + i % k)];
                sum = rgbd_add(sum, (rgbd){(double)c.r, (double)c.g, (double)c.b});
            }
            small.pixels[y * small.width + x] = rgbd_round(rgbd_scale(sum, 1.0 / (k * k)));
        }
    }
    bis_image_clear(image);
    *image = small;
    return BIS_OK;
}

/* The scene's map, smaller, in a file of its own. */
static bis_status shrink_map(bis_scene_desc *desc, int width, const char *path)
{
    bis_image image;
    bis_status status = BIS_OK;

    if (!desc->light.filename || desc->light.mapping != BIS_MAPPING_LATLONG) return BIS_OK;
    status = bis_image_read(&image, desc->light.filename, desc->light.loc, NULL);
    if (status) return status;
    status = shrink(&image, width);
    if (!status) status = bis_image_save(&image, path, NULL);
    bis_image_clear(&image);
    bis_free(desc->light.filename);
    desc->light.filename = bis_strdup(path);
    return status;
}

/* All that learns and shares. */
static void set_product(bis_view *view)
{
    view->settings = bis_settings_default(&bis_sir);
    view->settings.proposal = BIS_PROPOSAL_PRODUCT;
    view->settings.candidates = 64;
    view->settings.shadowrays = 16;
    view->settings.learn = true;
    view->sampler.kind = BIS_SAMPLER_SOBOL;
    view->edge_samples = 4;
}

static bis_status verify(
    bis_verify *v, const bis_scene *scene, const bis_scene_desc *desc, const bis_settings *settings, bool picture)
{
    bool tested;
    return picture ? bis_verify_picture(v, bis_render, scene, settings, &tested, NULL)
                   : bis_verify_scene(v, scene, desc, settings, NULL);
}

static void run_all(const bis_scene *scene, const bis_scene_desc *desc, const char *name, unsigned halvings,
    uint64_t first, uint64_t runs, const bis_settings *settings, bool picture)
{
    size_t alarms = 0, tests = 0, skipped = 0;
    double least = 1;

    for (uint64_t seed = first; seed < first + runs; seed++) {
        bis_verify v = {.seed = seed, .halvings = halvings};
        if (verify(&v, scene, desc, settings, picture) || bis_verify_judge(&v, NULL)) exit(1);
        alarms += v.n_failed > 0;
        tests = v.n;
        skipped += v.n_skipped;
        for (size_t i = 0; i < v.n; i++) {
            const bis_verify_test *t = &v.tests[i];
            if (!isnan(t->p)) least = fmin(least, t->p);
            if (t->verdict == BIS_VERDICT_FAILED)
                printf("#   seed %llu: %s: %s (%g, p %g)\n", (unsigned long long)seed, t->name, t->note, t->statistic,
                    t->p);
        }
        bis_verify_clear(&v);
    }
    printf("%-24s %6llu %6zu %6zu %8.1f %10.2g\n", name, (unsigned long long)runs, alarms, tests,
        (double)skipped / (double)runs, least);
    fflush(stdout);
}

int main(int argc, char **argv)
{
    if (argc < 6) return 2;
    const unsigned halvings = (unsigned)atoi(argv[1]);
    const uint64_t first = strtoull(argv[2], NULL, 10), runs = strtoull(argv[3], NULL, 10);
    const int width = atoi(argv[4]);
    const bool printed = strcmp(argv[5], "--printed") == 0, product = strcmp(argv[5], "--product") == 0;
    const bool picture = product || strcmp(argv[5], "--picture") == 0;
    char map[64];

    snprintf(map, sizeof map, "build/verify_alarms-%ld.pfm", (long)getpid());
    for (int i = printed || picture ? 6 : 5; i < argc; i++) {
        bis_scene_desc *desc = NULL;
        bis_scene *scene = NULL;
        bis_diag diag = {0};
        if (bis_scene_parse(&desc, argv[i], &diag)) return 1;
        desc->light_needs = BIS_VERIFY_LIGHT_NEEDS;
        if (product) set_product(&desc->view);
        if (printed) desc->view.settings.as_printed = BIS_E6 | BIS_E21;
        if (shrink_map(desc, width, map) || bis_scene_build(&scene, desc, &diag)) return 1;
        run_all(scene, desc, basename(argv[i]), halvings, first, runs, &desc->view.settings, picture);
        bis_scene_free(scene);
        bis_scene_desc_free(desc);
    }
    unlink(map);
    return 0;
}
