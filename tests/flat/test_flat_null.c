/* SPDX-License-Identifier: BSD-2-Clause */
/* flat: a pointer that is NULL is an error that names it, the first of several; arrays of no items may be
 * NULL. A row is a call and the names of its pointers in their order, "*": an array of n items. */
#include "bis/flat/stage.h"
#include "claim.h"
#include "program.h"

#include <stdio.h>
#include <string.h>

#define DIR "build/test_flat_null"
#define SCENE "text=Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\nLookAt 0 -4 2 0 0 0 0 0 1\n" \
    "Camera \"perspective\"\nWorldBegin\nLightSource \"infinite\" \"string filename\" \"" DIR "/white.pfm\"\n" \
    "Shape \"disk\" \"float radius\" 5\n"

/* What is hidden: pointer k, and with `rest` all behind it. */
static int hidden;
static bool rest;
static size_t n, found;
#define P(k, pointer) ((k) == hidden || (rest && (k) > hidden) ? NULL : (pointer))

static bis_light *light, *other;
static bis_bsdf *bsdf, *none;
static bis_flat_stage *stage, *empty;
static bis_flat_scene *scene, *closed;
static uint64_t many[3];
static const char *text;
static bis_flat_picture *picture;
static const char *const no[] = {NULL};
static float f[16] = {0, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
static double d[16] = {1, 1, 1}, u[16] = {0.5, 0.5, 0.5, 0.5};
static uint32_t k[256] = {1}, small[2];
static uint8_t b[16];
static char say[512];
#define SAY say, sizeof say

#define CALLS                                                                                                     \
    ROW("light path kind", light_open(P(0, &other), P(1, "m.hdr"), P(2, "cdf"), 0, NULL, SAY))                    \
    ROW("light pixels kind", light_make(P(0, &other), 1, 1, P(1, f), P(2, "cdf"), 0, NULL, SAY))                  \
    ROW("light *u *w *L *pdf", light_sample(P(0, light), n, P(1, u), P(2, f), P(3, f), P(4, d), SAY))             \
    ROW("light *w *L *pdf", light_look(P(0, light), n, P(1, f), P(2, f), P(3, d), SAY))                      \
    ROW("w prob alias total", alias_build(1, P(0, d), P(1, u), P(2, small), P(3, d + 1), SAY))                    \
    ROW("prob alias *u *item", alias_sample(1, P(0, d), P(1, small), n, P(2, u), P(3, small + 1), SAY))           \
    ROW("bsdf model Kd Ks normal wo",                                                                             \
        bsdf_open(P(0, &none), P(1, "phong"), P(2, u), P(3, u), 9, P(4, u), P(5, u), SAY))                        \
    ROW("bsdf eta k normal wo", bsdf_metal(P(0, &none), P(1, u), P(2, u), 1, P(3, u), P(4, u), SAY))              \
    ROW("bsdf *u *wi *lobe", bsdf_sample(P(0, bsdf), n, P(1, u), P(2, f), P(3, b), SAY))                          \
    ROW("bsdf *wi *f *pdf", bsdf_look(P(0, bsdf), n, P(1, f), P(2, f), P(3, d), SAY))                        \
    ROW("picture scene settings", render(P(0, &picture), P(1, SCENE), P(2, no), NULL, SAY))                       \
    ROW("picture scene settings", render_with(P(0, &picture), P(1, SCENE), P(2, no), light, NULL, NULL, NULL, SAY)) \
    ROW("unit count *values", histogram(n, P(2, d), P(0, d), 1, 1, P(1, k), SAY))                                 \
    ROW("hash expected name n", bits(P(0, k), P(1, k), P(2, b), P(3, k), SAY))                                    \
    ROW("w list length", marsaglia(1, P(0, k), 1, P(1, small), P(2, small + 1), SAY))                             \
    ROW("w order height", alias_stage(1, P(0, d), 1, P(1, small), P(2, u), SAY))                                  \
    ROW("w pmf P", alias_pmf(1, P(0, d), P(1, u), P(2, u), SAY))                                                  \
    ROW("w printed right impossible", alias_few_bits(1, P(0, d), 1, P(1, u), P(2, u), P(3, u), SAY))              \
    ROW("w c guide n_guide", cdf_build(1, P(0, d), P(1, u), P(2, k), P(3, small), SAY))                           \
    ROW("w *u *item *part *first", cdf_sample(1, P(0, d), n, P(1, u), P(2, k), P(3, k), P(4, k), SAY))            \
    ROW("P observed fit *item", fit(1, P(0, d), n, P(3, small), P(1, u), P(2, u), SAY))                           \
    ROW("light path settings", light_open_as(P(0, &other), P(1, "m.hdr"), P(2, no), SAY))                         \
    ROW("light *w *pixel", light_find(P(0, light), n, P(1, f), P(2, k), SAY))                                     \
    ROW("small light", light_shrink(P(0, &other), P(1, light), 1, SAY))                                           \
    ROW("light pdf peak share", light_density(P(0, light), P(1, d), P(2, d), P(3, d), SAY))                       \
    ROW("light count polar *pixel", light_rows(P(0, light), n, P(3, k), 1, P(1, k), P(2, d), SAY))                \
    ROW("light label level area factor n", light_regions(P(0, light), 1, 1, P(1, k), P(2, k), P(3, d), P(4, d),   \
                                                         P(5, k), SAY))                                           \
    ROW("bsdf normal sum", bsdf_albedo(P(0, bsdf), P(1, d), 1, P(2, d), SAY))                                     \
    ROW("bsdf normal *degrees *f_cos *pdf", bsdf_plane(P(0, bsdf), P(1, d), n, P(2, d), P(3, d), P(4, d), SAY))   \
    ROW("bsdf count *wi *below", bsdf_below(P(0, bsdf), n, P(2, f), P(3, b), P(1, k), SAY))                       \
    ROW("a b sum", compare(1, 1, P(0, f), P(1, f), P(2, d), SAY))                                                 \
    ROW("stage scene settings", stage_open(P(0, &empty), P(1, SCENE), P(2, no), SAY))                             \
    ROW("stage found", stage_at(P(0, stage), 0, 0, P(1, d), SAY))                                                 \
    ROW("stage value", stage_exact(P(0, stage), 1, P(1, d), SAY))                                                 \
    ROW("stage q_L q_f product seen peak",                                                                        \
        stage_densities(P(0, stage), 1, 1, P(1, f), P(2, f), P(3, f), P(4, f), P(5, f), SAY))                     \
    ROW("stage *wi *cell", stage_find(P(0, stage), 1, 1, n, P(1, f), P(2, k), SAY))                               \
    ROW("stage settings wi w chosen kind sum",                                                                    \
        stage_candidates(P(0, stage), P(1, no), 1, 1, P(2, f), P(3, d), P(4, k), P(5, k), P(6, d), SAY))          \
    ROW("stage settings L sum", stage_runs(P(0, stage), P(1, no), 1, 2, P(2, d), P(3, d), SAY))                   \
    ROW("stage settings sum", stage_mis(P(0, stage), P(1, no), 1, 2, P(2, d), SAY))                               \
    ROW("stage settings sum", stage_noises(P(0, stage), P(1, no), 1, 2, P(2, d), SAY))                            \
    ROW("stage bound", stage_bounds(P(0, stage), P(1, d), SAY))                                                   \
    ROW("stage proposal accepted *w *u *height *taken",                                                           \
        stage_accept(P(0, stage), P(1, "em"), n, P(3, d), P(4, d), P(5, d), P(6, k), P(2, k), SAY))               \
    ROW("stage settings count", stage_accepted(P(0, stage), P(1, no), 1, 2, P(2, d), SAY))                        \
    ROW("kind *u", points(P(0, "sobol"), 1, 0, 0, 1, 0, n, P(1, d), SAY))                                         \
    ROW("bsdf text normal wo", bsdf_read(P(0, &none), P(1, "Material \"matte\""), P(2, u), P(3, u), SAY))         \
    ROW("scene path settings", scene_open(P(0, &closed), P(1, SCENE), P(2, no), NULL, SAY))                       \
    ROW("picture scene settings", scene_render(P(0, &picture), P(1, scene), P(2, no), NULL, NULL, NULL, NULL, SAY)) \
    ROW("stage scene", stage_of(P(0, &empty), P(1, scene), NULL, SAY))                                            \
    ROW("stage text", stage_about(P(0, stage), P(1, &text), SAY))                                                 \
    ROW("stage value moments count", stage_truth(P(0, stage), 1, P(1, d), P(2, d), P(3, many), SAY))              \
    ROW("stage settings L value figures",                                                                         \
        stage_method(P(0, stage), P(1, no), 1, 2, NULL, P(2, f), P(3, d), P(4, d), SAY))                          \
    ROW("stage settings wi w count sum",                                                                          \
        stage_estimate(P(0, stage), P(1, no), 1, 1, P(2, f), P(3, d), P(4, k), P(5, d), SAY))                     \
    ROW("stage settings n *wi *which",                                                                            \
        stage_rays(P(0, stage), P(1, no), 1, 1, n, P(3, f), P(4, k), P(2, &found), SAY))                          \
    ROW("stage *wi *density", stage_look(P(0, stage), n, P(1, f), P(2, d), SAY))                                  \
    ROW("stage *wi *seen", stage_sees(P(0, stage), n, P(1, f), P(2, b), SAY))                                     \
    ROW("stage *wi *angle", stage_angles(P(0, stage), n, P(1, f), P(2, d), SAY))                                  \
    ROW("stage field", stage_sphere(P(0, stage), 1, 1, 1, P(1, f), SAY))

/* Names of `row`, and its status unless that is NULL; false behind the last. */
static bool call(int row, const char **names, int *status)
{
    int i = 0;
#define ROW(of, function) if (i++ == row) { *names = of; if (status) *status = bis_flat_##function; return true; }
    CALLS
#undef ROW
    return false;
}

static int setup(void **state)
{
    program_folder(DIR);
    FILE *out = fopen(DIR "/white.pfm", "wb");
    if (!out) return 1;
    fprintf(out, "PF\n2 1\n-1.0\n");
    fwrite((float[]){1, 1, 1, 1, 1, 1}, sizeof(float), 6, out);
    fclose(out);
    if (bis_flat_light_make(&light, 2, 1, (float[]){1, 1, 1, 1, 1, 1}, "alias", 0, NULL, SAY)) return 1;
    if (bis_flat_bsdf_open(&bsdf, "phong", u, u, 9, u, u, SAY)) return 1;
    if (bis_flat_scene_open(&scene, "scene", (const char *[]){SCENE, NULL}, NULL, SAY)) return 1;
    if (bis_flat_stage_of(&stage, scene, NULL, SAY)) return 1;
    return bis_flat_stage_at(stage, 4, 4, (double[8]){0}, SAY);
}

static int teardown(void **state)
{
    bis_flat_light_close(light);
    bis_flat_bsdf_close(bsdf);
    bis_flat_stage_close(stage);
    bis_flat_scene_close(scene);
    return 0;
}

static void a_pointer_that_is_null_is_named_but_for_arrays_of_no_items(void **state)
{
    const char *names = "";
    int status = 0;
    for (int row = 0; call(row, &names, NULL); row++) {
        char list[80], wanted[80];
        snprintf(list, sizeof list, "%s", names);
        hidden = 0;
        for (const char *name = strtok(list, " "); name; name = strtok(NULL, " "), hidden++) {
            snprintf(wanted, sizeof wanted, "error: %s is NULL", name + (*name == '*'));
            for (int i = 0; i < 2; i++) {
                rest = i, n = 1;
                call(row, &names, &status);
                if (status != BIS_INPUT || !strstr(say, wanted))
                    fail_msg("row %d (%s): %d, \"%s\", not \"%s\"", row, names, status, say, wanted);
                n = 0;
                if (*name == '*') call(row, &names, &status);
                if (*name == '*' && status) fail_msg("row %d (%s) of no items: %s", row, names, say);
            }
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_pointer_that_is_null_is_named_but_for_arrays_of_no_items)};
    return cmocka_run_group_tests_name("flat null", tests, setup, teardown);
}
