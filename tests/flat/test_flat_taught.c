/* SPDX-License-Identifier: BSD-2-Clause */
/* flat_taught: the thesis's steps on arrays. Expected values are the thesis's own tables, sums by hand, and closed forms. What a browser
 * makes of the same calls is in tests/web. */
#include "bis/flat/taught.h"
#include "bis/base/vec.h"
#include "program.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

#define DIR "build/test_flat_taught"
#define SCENE                                                                                                        \
    "text=Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\nLookAt 0 -4 2  0 0 0  0 0 1\n"            \
    "Camera \"perspective\" \"float fov\" 20\nWorldBegin\nLightSource \"infinite\" \"string filename\" \"" DIR         \
    "/white.pfm\"\nMaterial \"phong\" \"float Kd\" 0.5 \"float Ks\" 0\nShape \"disk\" \"float radius\" 5\n"

static char say[512];
#define SAY say, sizeof say

/* A map of 16 x 8 pixels of radiance 1. */
static int setup(void **state)
{
    (void)state;
    program_folder(DIR);
    FILE *out = fopen(DIR "/white.pfm", "wb");
    if (!out) return 1;
    fprintf(out, "PF\n16 8\n-1.0\n");
    for (int i = 0; i < 3 * 16 * 8; i++) fwrite(&(float){1}, sizeof(float), 1, out);
    return fclose(out);
}

static void refuses(int status, const char *text)
{
    assert_int_equal(status, BIS_INPUT);
    if (!strstr(say, text)) fail_msg("no \"%s\" in: %s", text, say);
}

static void marsaglias_list_is_the_thesiss(void **state)
{
    (void)state;
    const uint32_t right[10] = {0, 1, 1, 2, 2, 2, 2, 3, 3, 3};
    uint32_t list[10], length;

    assert_int_equal(bis_flat_marsaglia(4, (uint32_t[]){1, 2, 4, 3}, 10, list, &length, SAY), 0);
    assert_int_equal(length, 10);
    assert_memory_equal(list, right, sizeof right);
    refuses(bis_flat_marsaglia(4, (uint32_t[]){1, 2, 4, 3}, 9, list, &length, SAY), "room for 9");
}

/* N P is 1/3, 2/3, 1, 4/3, 5/3 at first; each step fills one bin, the sum of what is there stays N less what was given. */
static void the_stages_lead_from_NP_to_the_table(void **state)
{
    (void)state;
    const double w[5] = {1, 2, 3, 4, 5};
    double prob[5], height[5], total;
    uint32_t alias[5], order[5], seen = 0;

    assert_int_equal(bis_flat_alias_build(5, w, prob, alias, &total, SAY), 0);
    assert_int_equal(bis_flat_alias_stage(5, w, 0, order, height, SAY), 0);
    for (int i = 0; i < 5; i++) assert_true(fabs(height[i] - w[i] / 3) < 1e-14);
    for (int i = 0; i < 5; i++) seen |= 1u << order[i];
    assert_int_equal(seen, 31);
    for (size_t k = 1; k <= 5; k++) {
        assert_int_equal(bis_flat_alias_stage(5, w, k, order, height, SAY), 0);
        for (size_t j = 0; j < k; j++) assert_true(height[order[j]] == prob[order[j]]);
    }
    refuses(bis_flat_alias_stage(2, (double[]){0, 0}, 0, order, height, SAY), "nothing to draw");
}

static void the_cdf_is_the_running_sum(void **state)
{
    (void)state;
    const double w[4] = {1, 0, 2, 1}, right[5] = {0, 0.25, 0.25, 0.75, 1};
    double c[5];
    uint32_t guide[10], n_guide, item[3];

    assert_int_equal(bis_flat_cdf_build(4, w, c, guide, &n_guide, SAY), 0);
    for (int i = 0; i < 5; i++) assert_true(c[i] == right[i]);
    assert_int_equal(bis_flat_cdf_sample(4, w, 3, (double[]){0.2, 0.25, 0.8}, item, SAY), 0);
    assert_memory_equal(item, ((uint32_t[]){0, 2, 3}), sizeof item);
    refuses(bis_flat_cdf_sample(4, w, 1, (double[]){1}, item, SAY), "numbers in [0, 1)");
}

/* 10 and 30 of 40, where 20 each are due: (100 + 100)/20 = 10, and the twin of 20 and 20: 0. */
static void the_fit_is_pearsons(void **state)
{
    (void)state;
    uint32_t item[40];
    double observed[2], fit[3];

    for (uint32_t i = 0; i < 40; i++) item[i] = i >= 10;
    assert_int_equal(bis_flat_fit(2, (double[]){0.5, 0.5}, 40, item, observed, fit, SAY), 0);
    assert_true(observed[0] == 10 && observed[1] == 30 && fit[0] == 10 && fit[1] == 1 && fit[2] < 0.01);
    for (uint32_t i = 0; i < 40; i++) item[i] = i % 2;
    assert_int_equal(bis_flat_fit(2, (double[]){0.5, 0.5}, 40, item, observed, fit, SAY), 0);
    assert_true(fit[0] == 0 && fit[2] > 0.9);
    refuses(bis_flat_fit(1, (double[]){1}, 40, item, observed, fit, SAY), "not below 1");
}

/* A white map is one component of 4 pi, drawn with 1/(4 pi) everywhere. */
static void a_white_map_is_one_light(void **state)
{
    (void)state;
    bis_light *light;
    double pdf[128], share[8], area[128], factor[128], sum = 0;
    uint32_t label[128], level[128], n;

    assert_int_equal(bis_flat_light_open_as(&light, DIR "/white.pfm", (const char *[]){"kind=cdf", "levels=4", NULL}, SAY), 0);
    assert_int_equal(bis_flat_light_density(light, pdf, share, SAY), 0);
    assert_int_equal(bis_flat_light_regions(light, 4, 0.5, label, level, area, factor, &n, SAY), 0);
    assert_int_equal(n, 1);
    for (int i = 0; i < 128; i++) assert_true(fabs(pdf[i] - 1 / (4 * PI)) < 1e-12 && fabs(area[i] - 4 * PI) < 1e-12 && factor[i] == 1);
    for (int y = 0; y < 8; y++) sum += 16 * share[y] / 16;
    assert_true(fabs(sum - 1) < 1e-12);
    bis_flat_light_close(light);
    refuses(bis_flat_light_open_as(&light, DIR "/white.pfm", (const char *[]){"kind=list", NULL}, SAY), "no setting of a map");
}

/* A diffuse floor under radiance 1 in R, G and B reflects 3 Kd = 1.5 everywhere, and nothing hides the light. */
static void a_point_of_a_diffuse_floor_is_known(void **state)
{
    (void)state;
    bis_flat_stage *stage;
    double found[8], value[4], sum[6], L[64], w[64], bound[2];
    float wi[192];
    uint32_t chosen[64], kind[64], n = 0;
    const char *const sir[] = {"integrator=sir", "candidates=64", "shadowrays=8", "proposal=mix", "learn=false", NULL};

    assert_int_equal(bis_flat_stage_open(&stage, "scene", (const char *[]){SCENE, NULL}, SAY), 0);
    refuses(bis_flat_stage_exact(stage, 1, value, SAY), "no point was chosen");
    assert_int_equal(bis_flat_stage_at(stage, 4, 4, found, SAY), 0);
    assert_true(found[0] == 1 && fabs(found[6] - 1) < 1e-6);
    assert_int_equal(bis_flat_stage_exact(stage, 1, value, SAY), 0);
    assert_true(fabs(value[0] - 1.5) <= 6 * value[1] + 1e-6 && fabs(value[2] - 1.5) <= 6 * value[3] + 1e-6);
    assert_int_equal(bis_flat_stage_runs(stage, sir, 1, 64, L, sum, SAY), 0);
    assert_true(fabs(sum[0] - 1.5) <= 6 * sum[1] / 8 + 1e-6);
    assert_int_equal(bis_flat_stage_candidates(stage, sir, 1, 64, wi, w, chosen, kind, sum, SAY), 0);
    for (int i = 0; i < 64; i++) n += chosen[i];
    assert_int_equal(n, 8);
    assert_int_equal(bis_flat_stage_bounds(stage, bound, SAY), 0);
    for (int i = 0; i < 64; i++) assert_true(w[i] <= fmax(bound[0], bound[1]) * (1 + 1e-5));
    refuses(bis_flat_stage_candidates(stage, sir, 1, 63, wi, w, chosen, kind, sum, SAY), "do not fit");
    refuses(bis_flat_stage_candidates(stage, (const char *[]){"integrator=em", NULL}, 1, 64, wi, w, chosen, kind, sum, SAY), "give sir");
    refuses(bis_flat_stage_at(stage, 8, 0, found, SAY), "outside 8 x 8");
    bis_flat_stage_close(stage);
}

/* Nothing hides a white map from a floor: which candidates are chosen changes nothing but roundings. A wall hides a part: the
 * noises are uncorrelated, so their squares add up to the square of the whole; the sample's covariance of n = 4000 pairs has a
 * standard deviation of about a b/sqrt(n), and 6 of these, twice, are allowed. The twin: were the noise of the rays left
 * out, the sum would miss by more than that. */
static void the_two_noises_add_up_E31(void **state)
{
    (void)state;
    const char *const sir[] = {"integrator=sir", "candidates=16", "shadowrays=2", "proposal=mix", "learn=false", NULL};
    const char *const scenes[2] = {SCENE, SCENE "Shape \"trianglemesh\" \"point3 P\" [-3 .3 0  3 .3 0  0 .3 4] \"integer indices\" [0 1 2]\n"};
    bis_flat_stage *stage;
    double found[8], sum[5];

    for (int k = 0; k < 2; k++) {
        assert_int_equal(bis_flat_stage_open(&stage, "scene", (const char *[]){scenes[k], NULL}, SAY), 0);
        assert_int_equal(bis_flat_stage_at(stage, 4, 5, found, SAY), 0);
        assert_int_equal(bis_flat_stage_noises(stage, sir, 7, 4000, sum, SAY), 0);
        const double all = sum[1] * sum[1], a = sum[2], b = sum[3], allowed = 12 * a * b / sqrt(4000);
        if (k == 0) assert_true(b < 1e-5 * sum[0]);
        else assert_true(fabs(all - a * a - b * b) <= allowed && fabs(all - a * a) > allowed && fabs(all - b * b) > 0);
        bis_flat_stage_close(stage);
    }
}

/* Phong with Kd alone reflects Kd, and nothing lies below the horizon; quadrature by 200 x 200 midpoints is exact to 1e-5. */
static void a_diffuse_material_loses_nothing(void **state)
{
    (void)state;
    const double up[3] = {0, 0, 1}, Kd[3] = {0.5, 0.5, 0.5}, Ks[3] = {0, 0, 0};
    bis_bsdf *bsdf;
    double sum[3];

    assert_int_equal(bis_flat_bsdf_open(&bsdf, "phong", Kd, Ks, 1, up, up, SAY), 0);
    assert_int_equal(bis_flat_bsdf_albedo(bsdf, up, 200, sum, SAY), 0);
    assert_true(fabs(sum[0] - 0.5) < 1e-5 && fabs(sum[2]) < 1e-5);
    refuses(bis_flat_bsdf_albedo(bsdf, up, 0, sum, SAY), "1 to 4096");
    bis_flat_bsdf_close(bsdf);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(marsaglias_list_is_the_thesiss),
        cmocka_unit_test(the_stages_lead_from_NP_to_the_table),
        cmocka_unit_test(the_cdf_is_the_running_sum),
        cmocka_unit_test(the_fit_is_pearsons),
        cmocka_unit_test(a_white_map_is_one_light),
        cmocka_unit_test(a_point_of_a_diffuse_floor_is_known),
        cmocka_unit_test(the_two_noises_add_up_E31),
        cmocka_unit_test(a_diffuse_material_loses_nothing),
    };
    return cmocka_run_group_tests(tests, setup, NULL);
}
