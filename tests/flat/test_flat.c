/* flat: the functions for other languages, from C. Expected values are closed forms, the tables of thesis figure 3.4, and
 * pictures of the program. What arrays of any size give is in tests/python. Mean within 5 standard errors: 6e-7 a test, 2 tests. */
#include "bis/base/image.h"
#include "bis/files/image_file.h"
#include "bis/flat/flat.h"
#include "bis/thesis/rng.h"
#include "json_check.h"
#include "program.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DIR "build/test_flat"
#define SCENE DIR "/scene.txt"

static char say[512];
#define SAY say, sizeof say

static int setup(void **state)
{
    (void)state;
    program_folder(DIR);
    program_write_scene(DIR, "");
    return 0;
}

static void refuses(int status, const char *text)
{
    assert_int_equal(status, BIS_INPUT);
    if (!strstr(say, text)) fail_msg("no \"%s\" in: %s", text, say);
}

/* The mean of Le/pdf is the integral. */
static void a_map_gives_directions_and_their_densities(void **state)
{
    enum { N = 100000 };
    static double u[N][4], pdf[N], again[N];
    static float w[N][3], L[N][3], seen[N][3];
    bis_light *light;
    int shape[2];
    bis_rng r;
    double sum = 0, squares = 0;

    (void)state;
    assert_int_equal(bis_flat_light_open(&light, DIR "/map.pfm", "cdf", 0.15, SAY), 0);
    bis_flat_light_shape(light, shape);
    assert_int_equal(shape[0], 8);
    assert_int_equal(shape[1], 4);
    bis_rng_init(&r, 1, 0, 0, 0);
    for (int i = 0; i < N; i++)
        for (int k = 0; k < 4; k++) u[i][k] = bis_rng_double(&r);
    assert_int_equal(bis_flat_light_sample(light, N, u[0], w[0], L[0], pdf, SAY), 0);
    assert_int_equal(bis_flat_light_look(light, N, w[0], seen[0], again, SAY), 0);
    for (int i = 0; i < N; i++) {
        const double x = ((double)L[i][0] + (double)L[i][1] + (double)L[i][2]) / pdf[i];
        sum += x / N;
        squares += x * x / N;
    }
    const double error = sqrt((squares - sum * sum) / N);
    assert_true(fabs(sum - bis_flat_light_power(light)) <= 5 * error + 1e-9 * sum);
    /* the twin */
    assert_true(fabs(1.3 * sum - bis_flat_light_power(light)) > 5 * error);
    refuses(bis_flat_light_sample(light, 1, (double[]){0, 0, 1, 0}, w[0], L[0], pdf, SAY), "u of sample 0 is 1");
    refuses(bis_flat_light_sample(light, 1, (double[]){0, 0, (double)NAN, 0}, w[0], L[0], pdf, SAY), "nan: give random numbers");
    refuses(bis_flat_light_look(light, 1, (float[]){0, NAN, 1}, L[0], pdf, SAY), "direction 0");
    refuses(bis_flat_light_look(light, 1, (float[]){0, 0, 0}, L[0], pdf, SAY), "direction 0");
    bis_flat_light_close(light);
    refuses(bis_flat_light_open(&light, DIR "/map.pfm", "walker", 0, SAY), "no table \"walker\"");
    refuses(bis_flat_light_open(&light, DIR "/map.pfm", "cdf", -1, SAY), "area_exponent is -1");
    assert_int_equal(bis_flat_light_open(&light, DIR "/none.hdr", "cdf", 0, SAY), BIS_IO);
    assert_null(light);
    bis_flat_light_close(NULL);
}

static void a_black_map_has_no_directions(void **state)
{
    static const char black[] = "PF\n2 1\n-1.0\n\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0";
    bis_light *light;
    float w[3], L[3];
    double pdf;

    (void)state;
    FILE *out = fopen(DIR "/black.pfm", "wb");
    assert_non_null(out);
    fwrite(black, 1, sizeof black - 1, out);
    fclose(out);
    assert_int_equal(bis_flat_light_open(&light, DIR "/black.pfm", "alias", 0.15, SAY), 0);
    assert_true(bis_flat_light_power(light) == 0);
    refuses(bis_flat_light_sample(light, 1, (double[]){0, 0, 0, 0}, w, L, &pdf, SAY), "the map is black: it has no directions to draw");
    assert_int_equal(bis_flat_light_sample(light, 0, NULL, w, L, &pdf, SAY), 0);
    bis_flat_light_close(light);
}

static void alias_tables_are_those_of_the_thesis(void **state)
{
    double prob[4], total;
    uint32_t alias[4], item[4];

    (void)state;
    assert_int_equal(bis_flat_alias_build(4, (double[]){0.1, 0.2, 0.4, 0.3}, prob, alias, &total, SAY), 0);
    assert_true(fabs(prob[0] - 0.4) < 1e-12 && fabs(prob[1] - 0.8) < 1e-12 && prob[2] >= 1 - 1e-12);
    assert_true(alias[0] == 2 && alias[1] == 3 && fabs(total - 1) < 1e-12);
    /* bin 0 below and above its prob of 0.4, bin 1, bin 3 */
    assert_int_equal(bis_flat_alias_sample(4, prob, alias, 4, (double[]){0.09, 0.11, 0.25, 0.99}, item, SAY), 0);
    assert_true(item[0] == 0 && item[1] == 2 && item[2] == 1 && item[3] == 3);
    refuses(bis_flat_alias_build(2, (double[]){1, HUGE_VAL}, prob, alias, &total, SAY), "weight 1 is inf");
    refuses(bis_flat_alias_build(0, prob, prob, alias, &total, SAY), "0 weights");
    refuses(bis_flat_alias_build(2, (double[]){0, 0}, prob, alias, &total, SAY), "all weights are 0");
    refuses(bis_flat_alias_sample(0, prob, alias, 1, (double[]){0}, item, SAY), "empty");
    refuses(bis_flat_alias_sample(4, prob, alias, 1, (double[]){-0.1}, item, SAY), "u of sample 0");
}

static void a_material_gives_f_and_density(void **state)
{
    const double up[3] = {0, 0, 2}, half[3] = {0.5, 0.5, 0.5}, black[3] = {0, 0, 0};
    bis_bsdf *b;
    float wi[2][3] = {{0, 0, 5}, {0, 0, -1}}, f[2][3];
    double pdf[2];
    uint8_t lobe[2];

    (void)state;
    /* in the mirror direction: Ks (n+1)/(2 pi) + Kd/pi; a density of half lobe, half cosine */
    assert_int_equal(bis_flat_bsdf_open(&b, "phong", half, half, 9, up, up, SAY), 0);
    assert_int_equal(bis_flat_bsdf_look(b, 2, wi[0], f[0], pdf, SAY), 0);
    assert_true(fabs((double)f[0][1] - (0.5 * 10 / (2 * PI) + 0.5 / PI)) < 1e-6 && f[1][1] == 0);
    assert_int_equal(bis_flat_bsdf_sample(b, 2, (double[]){0, 0.5, 0.5, 0.999, 0.5, 0.5}, wi[0], lobe, SAY), 0);
    assert_true(lobe[0] == 1 && lobe[1] == 0);
    refuses(bis_flat_bsdf_sample(b, 1, (double[]){0, 1, 0}, wi[0], lobe, SAY), "u of sample 0");
    bis_flat_bsdf_close(b);
    assert_int_equal(bis_flat_bsdf_open(&b, "microfacet", black, black, 0.5, up, up, SAY), 0);
    refuses(bis_flat_bsdf_sample(b, 1, (double[]){0, 0, 0}, wi[0], lobe, SAY), "black");
    bis_flat_bsdf_close(b);
    refuses(bis_flat_bsdf_open(&b, "glass", half, half, 1, up, up, SAY), "no model \"glass\"");
    refuses(bis_flat_bsdf_open(&b, "phong", half, half, -1, up, up, SAY), "the exponent is -1");
    refuses(bis_flat_bsdf_open(&b, "microfacet", half, half, (double)NAN, up, up, SAY), "the roughness is nan");
    refuses(bis_flat_bsdf_open(&b, "phong", up, half, 1, up, up, SAY), "Kd is (0, 0, 2)");
    refuses(bis_flat_bsdf_open(&b, "phong", half, half, 1, black, up, SAY), "normal is (0, 0, 0)");
    assert_null(b);
    bis_flat_bsdf_close(NULL);
}

/* Whatever is said by settings is said to the program by options. */
static void a_picture_has_the_bits_of_the_program(void **state)
{
    const struct {
        const char *settings[5], *options, *integrator;
    } cases[] = {
        {{NULL}, "", "\"sir\""},
        {{"samples=3", "integrator=em", "spp=2", NULL}, "--integrator em --samples 3 --spp 2", "\"em\""},
        {{"proposal=brdf", "seed=12", "accelerator=grid", "threads=1", NULL}, "--proposal brdf --seed 12 --accelerator grid", "\"sir\""},
        {{"proposal=product", "learn=true", "spp=9", NULL}, "--proposal product --learn on --spp 9", "\"sir\""},
        {{"proposal=product", "learn=false", "spp=9", NULL}, "--proposal product --learn off --spp 9", "\"sir\""},
        {{"width=9", "height=5", "threads=2", "spp=3", NULL}, "--resolution 9x5 --nthreads 2 --spp 3", "\"sir\""},
        {{"error=0.4", "spp=64", "threads=1", NULL}, "--error 0.4 --spp 64 --nthreads 1", "\"sir\""},
    };

    (void)state;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        bis_flat_picture *p;
        bis_image image;
        program_run r;
        int shape[2];
        char value[64];
        if (bis_flat_render(&p, SCENE, cases[k].settings, NULL, SAY)) fail_msg("%s", say);
        program_expect(&r, 0, SCENE " --outfile " DIR "/out.pfm %s", cases[k].options);
        assert_int_equal(bis_image_read(&image, DIR "/out.pfm", (bis_loc){0}, NULL), BIS_OK);
        bis_flat_picture_shape(p, shape);
        assert_true(shape[0] == image.width && shape[1] == image.height);
        const int n = shape[0] * shape[1];
        float *rgba = malloc((size_t)n * 4 * sizeof *rgba);
        assert_non_null(rgba);
        bis_flat_picture_pixels(p, rgba);
        for (int i = 0; i < n; i++) assert_memory_equal(rgba + 4 * i, &image.pixels[i], sizeof image.pixels[i]);
        assert_true(json_is_valid(bis_flat_picture_stats(p)));
        assert_string_equal(json_value(value, sizeof value, bis_flat_picture_stats(p), "integrator"), cases[k].integrator);
        free(rgba);
        bis_image_clear(&image);
        bis_flat_picture_close(p);
    }
    bis_flat_picture_close(NULL);
}

static void wrong_settings_are_refused(void **state)
{
    const struct {
        const char *setting, *text;
    } cases[] = {
        {"spp", "\"spp\" is no setting"},
        {"spp=0", "spp is \"0\": give an integer in [1, "},
        {"spp=1.5", "spp is \"1.5\""},
        {"seconds=nan", "seconds is \"nan\": give a number"},
        {"width=40000", "width is \"40000\""},
        {"seed=-1", "seed is \"-1\""},
        {"integrator=si", "no integrator \"si\""},
        {"samples=3", "integrator \"sir\" has no parameter \"samples\""},
        {"candidates=1e99", "candidates is \"1e99\""},
        {"learn=yes", "learn is \"yes\": give true or false"},
        {"proposal=best", "proposal is \"best\": integrator \"sir\" takes"},
        {"accelerator=bvh", "accelerator \"bvh\" is not there"},
    };
    bis_flat_picture *p;

    (void)state;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        refuses(bis_flat_render(&p, SCENE, (const char *const[]){cases[k].setting, NULL}, NULL, SAY), cases[k].text);
        assert_null(p);
    }
    refuses(bis_flat_render(&p, SCENE, (const char *const[]){NULL}, &(int){1}, SAY), "stopped before its first pass");
    /* a buffer that is too small is filled and ended, one of no bytes is left alone */
    char small[8];
    assert_int_equal(bis_flat_render(&p, DIR "/none.txt", (const char *const[]){NULL}, NULL, small, sizeof small), BIS_IO);
    assert_int_equal(strlen(small), 7);
    assert_int_equal(bis_flat_render(&p, DIR "/none.txt", (const char *const[]){NULL}, NULL, NULL, 0), BIS_IO);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_map_gives_directions_and_their_densities),
        cmocka_unit_test(a_black_map_has_no_directions),
        cmocka_unit_test(alias_tables_are_those_of_the_thesis),
        cmocka_unit_test(a_material_gives_f_and_density),
        cmocka_unit_test(a_picture_has_the_bits_of_the_program),
        cmocka_unit_test(wrong_settings_are_refused),
    };

    return cmocka_run_group_tests_name("flat", tests, setup, NULL);
}
