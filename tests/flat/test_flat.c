/* SPDX-License-Identifier: BSD-2-Clause */
/* flat: the functions for other languages, from C. Expected values are closed forms, the tables of thesis figure 3.4,
 * and pictures of the program. What arrays of any size give is in tests/python. Mean within 5 standard errors: 6e-7 a
 * test, 2 tests. */
#include "bis/base/clock.h"
#include "bis/base/image.h"
#include "bis/base/mem.h"
#include "bis/base/version.h"
#include "bis/files/image_file.h"
#include "bis/flat/flat.h"
#include "bis/scene/layers.h"
#include "bis/shape/accel.h"
#include "bis/thesis/rng.h"
#include "claim.h"
#include "json_check.h"
#include "program.h"

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
    program_folder(DIR);
    program_write_scene(DIR, "");
    return 0;
}

static void refuses(int status, const char *text)
{
    assert_int_equal(status, BIS_INPUT);
    if (!strstr(say, text)) fail_msg("no \"%s\" in: %s", text, say);
}

static void write_pfm(const char *path, int width, int height, const float *rgb_bottom_up)
{
    FILE *out = fopen(path, "wb");
    assert_non_null(out);
    fprintf(out, "PF\n%d %d\n-1.0\n", width, height);
    fwrite(rgb_bottom_up, sizeof *rgb_bottom_up, 3 * (size_t)width * (size_t)height, out);
    fclose(out);
}

static void assert_about(double a, double b, double tolerance)
{
    if (!(fabs(a - b) <= tolerance)) fail_msg("%.12g is not %.12g", a, b);
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

    assert_int_equal(bis_flat_light_open(&light, DIR "/map.pfm", "cdf", 0.15, NULL, SAY), 0);
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
    refuses(bis_flat_light_sample(light, 1, (double[]){0, 0, (double)NAN, 0}, w[0], L[0], pdf, SAY),
        "nan: give random numbers");
    refuses(bis_flat_light_look(light, 1, (float[]){0, NAN, 1}, L[0], pdf, SAY), "direction 0");
    refuses(bis_flat_light_look(light, 1, (float[]){0, 0, 0}, L[0], pdf, SAY), "direction 0");
    bis_flat_light_close(light);
    refuses(bis_flat_light_open(&light, DIR "/map.pfm", "walker", 0, NULL, SAY), "no table \"walker\"");
    refuses(bis_flat_light_open(&light, DIR "/map.pfm", "cdf", -1, NULL, SAY), "area_exponent is -1");
    assert_int_equal(bis_flat_light_open(&light, DIR "/none.hdr", "cdf", 0, NULL, SAY), BIS_IO);
    assert_null(light);
    bis_flat_light_close(NULL);
}

static void a_black_map_has_no_directions(void **state)
{
    static const char black[] = "PF\n2 1\n-1.0\n\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0";
    bis_light *light;
    float w[3], L[3];
    double pdf;

    FILE *out = fopen(DIR "/black.pfm", "wb");
    assert_non_null(out);
    fwrite(black, 1, sizeof black - 1, out);
    fclose(out);
    assert_int_equal(bis_flat_light_open(&light, DIR "/black.pfm", "alias", 0.15, NULL, SAY), 0);
    assert_true(bis_flat_light_power(light) == 0);
    refuses(bis_flat_light_sample(light, 1, (double[]){0, 0, 0, 0}, w, L, &pdf, SAY),
        "the map is black: it has no directions to draw");
    assert_int_equal(bis_flat_light_sample(light, 0, NULL, w, L, &pdf, SAY), 0);
    bis_flat_light_close(light);
}

static void alias_tables_are_those_of_the_thesis(void **state)
{
    double prob[4], total;
    uint32_t alias[4], item[4];

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

/* Tables come from callers, too: what they hold must not lead out of them. */
static void alias_tables_of_the_caller_are_checked(void **state)
{
    const double prob[3] = {0.5, 1, 0},
                 bad[][3] = {{0.5, (double)NAN, 1}, {0.5, 1.01, 1}, {0.5, -0.01, 1}, {0.5, HUGE_VAL, 1}};
    const uint32_t alias[3] = {2, 0, 1}, outside[3] = {2, 0, 3}, far[3] = {UINT32_MAX, 0, 1};
    uint32_t item[4] = {9, 9, 9, 9};

    assert_int_equal(bis_flat_alias_sample(3, prob, alias, 4, (double[]){0.1, 0.3, 0.5, 0.9}, item, SAY), 0);
    assert_true(item[0] == 0 && item[1] == 2 && item[2] == 1 && item[3] == 1);
    for (int i = 0; i < 4; i++)
        refuses(bis_flat_alias_sample(3, bad[i], alias, 1, (double[]){0.1}, item, SAY), "prob of bin 1 is");
    refuses(bis_flat_alias_sample(3, prob, outside, 1, (double[]){0.1}, item, SAY),
        "alias of bin 2 is 3: give items below 3");
    refuses(bis_flat_alias_sample(3, prob, far, 1, (double[]){0.1}, item, SAY), "alias of bin 0 is 4294967295");
    refuses(bis_flat_alias_sample((size_t)1 << 33, prob, alias, 1, (double[]){0.1}, item, SAY),
        "there are 8589934592 bins: give 1 to 4294967295");
    /* the largest number is one: its first bin is looked at */
    refuses(bis_flat_alias_sample(UINT32_MAX, (double[]){-1}, alias, 1, (double[]){0.1}, item, SAY),
        "prob of bin 0 is -1: give numbers in [0, 1]");
}

/* Where a function has no status; the others: test_flat_null.c. */
static void null_is_nothing_where_there_is_no_status(void **state)
{
    bis_light *light;
    bis_flat_picture *p;
    float v[3];
    int shape[2] = {7, 7};

    assert_int_equal(bis_flat_light_open(&light, DIR "/map.pfm", "alias", 0, NULL, NULL, 99), 0); /* say may be NULL */
    bis_flat_light_shape(NULL, shape);
    assert_true(shape[0] == 0 && shape[1] == 0);
    bis_flat_light_pixels(NULL, v);
    bis_flat_light_shape(NULL, NULL);
    bis_flat_light_shape(light, NULL);
    bis_flat_light_pixels(light, NULL);
    assert_true(isnan(bis_flat_light_power(NULL)));
    bis_flat_light_close(light);
    shape[0] = shape[1] = 7;
    bis_flat_picture_shape(NULL, shape);
    assert_true(shape[0] == 0 && shape[1] == 0);
    bis_flat_picture_pixels(NULL, v);
    bis_flat_picture_shape(NULL, NULL);
    assert_int_equal(bis_flat_render(&p, SCENE, (const char *[]){NULL}, NULL, SAY), 0);
    bis_flat_picture_shape(p, NULL);
    bis_flat_picture_pixels(p, NULL);
    bis_flat_picture_close(p);
    assert_null(bis_flat_picture_stats(NULL));
    assert_int_equal(bis_flat_picture_layer(NULL, "depth", v), 0);
    bis_flat_picture_close(NULL);
}

static void a_material_gives_f_and_density(void **state)
{
    const double up[3] = {0, 0, 2}, half[3] = {0.5, 0.5, 0.5}, black[3] = {0, 0, 0};
    bis_bsdf *b;
    float wi[2][3] = {{0, 0, 5}, {0, 0, -1}}, f[2][3];
    double pdf[2];
    uint8_t lobe[2];

    /* in the mirror direction: Ks (n+1)/(2 pi) + Kd/pi; a density of half lobe, half cosine */
    assert_int_equal(bis_flat_bsdf_open(&b, "phong", half, half, 9, up, up, SAY), 0);
    assert_int_equal(bis_flat_bsdf_look(b, 2, wi[0], f[0], pdf, SAY), 0);
    assert_true(fabs((double)f[0][1] - (0.5 * 10 / (2 * PI) + 0.5 / PI)) < 1e-6 && f[1][1] == 0);
    assert_int_equal(bis_flat_bsdf_sample(b, 2, (double[]){0, 0.5, 0.5, 0.999, 0.5, 0.5}, wi[0], lobe, SAY), 0);
    assert_true(lobe[0] == 1 && lobe[1] == 0);
    /* half of the numbers, up to 1/2, draw from the lobe */
    assert_int_equal(bis_flat_bsdf_sample(b, 2, (double[]){0.499, 0, 0, 0.5, 0, 0}, wi[0], lobe, SAY), 0);
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

/* Head on, a metal is the facets of that reflectance; in the mirror direction of 60 degrees, the ratio to them is
 * Fresnel's reflectance over Schlick's. With k = 0 these are the equations of glass, as in textbooks. */
static void a_metal_reflects_by_fresnels_equations(void **state)
{
    const double up[3] = {0, 0, 1}, black[3] = {0, 0, 0}, aside[3] = {sqrt(0.75), 0, 0.5};
    const double eta[3] = {1.5, 2, 0.2}, k[3] = {0, 0, 3}, none[3] = {0, 0, 0}, bad[3] = {1, 1, (double)NAN};
    const double Ks[3] = {0.04, 1.0 / 9, (0.64 + 9) / (1.44 + 9)};
    float mirror[2][3] = {{0, 0, 1}, {(float)-sqrt(0.75), 0, 0.5F}}, f[2][3];
    double pdf;

    for (int oblique = 0; oblique < 2; oblique++) {
        bis_bsdf *metal, *facets;
        const double *wo = oblique ? aside : up;
        assert_int_equal(bis_flat_bsdf_metal(&metal, eta, k, 0.5, up, wo, SAY), 0);
        assert_int_equal(bis_flat_bsdf_open(&facets, "microfacet", black, Ks, 0.5, up, wo, SAY), 0);
        assert_int_equal(bis_flat_bsdf_look(metal, 1, mirror[oblique], f[0], &pdf, SAY), 0);
        assert_int_equal(bis_flat_bsdf_look(facets, 1, mirror[oblique], f[1], &pdf, SAY), 0);
        for (int i = 0; i < (oblique ? 2 : 3); i++) {
            const double c = 0.5, ct = sqrt(1 - 0.75 / (eta[i] * eta[i]));
            const double rs = (c - eta[i] * ct) / (c + eta[i] * ct), rp = (eta[i] * c - ct) / (eta[i] * c + ct);
            const double schlick = Ks[i] + (1 - Ks[i]) * pow(0.5, 5), fresnel = (rs * rs + rp * rp) / 2;
            assert_about((double)f[0][i] / (double)f[1][i], oblique ? fresnel / schlick : 1, 1e-5);
        }
        bis_flat_bsdf_close(metal);
        bis_flat_bsdf_close(facets);
    }
    bis_bsdf *b;
    refuses(bis_flat_bsdf_metal(&b, none, k, 0.5, up, up, SAY), "eta and k of channel 0 are 0 and 0");
    refuses(bis_flat_bsdf_metal(&b, bad, k, 0.5, up, up, SAY), "eta and k of channel 2 are nan and 3");
    refuses(bis_flat_bsdf_metal(&b, eta, bad, 0.5, up, up, SAY), "eta and k of channel 2 are 0.2 and nan");
    refuses(bis_flat_bsdf_metal(&b, (double[]){1, 1, 2e15}, k, 0.5, up, up, SAY), "eta and k of channel 2");
    refuses(
        bis_flat_bsdf_metal(&b, eta, (double[]){0, -1, 0}, 0.5, up, up, SAY), "eta and k of channel 1 are 2 and -1");
    refuses(bis_flat_bsdf_metal(&b, eta, (double[]){0, 0, 2e15}, 0.5, up, up, SAY),
        "eta and k of channel 2 are 0.2 and 2e+15: give eta in (0, 1e+15] and k in [0, 1e+15]");
    refuses(bis_flat_bsdf_metal(&b, eta, k, 0.001, up, up, SAY), "the roughness is 0.001");
    refuses(bis_flat_bsdf_metal(&b, eta, k, 0.5, black, up, SAY), "normal is (0, 0, 0)");
    assert_null(b);
    const double most[3] = {1e15, 1e-300, 1}, to[3] = {1e15, 0, 1e15};
    assert_int_equal(bis_flat_bsdf_metal(&b, most, to, 1, up, up, SAY), 0);
    bis_flat_bsdf_close(b);
}

/* What no pixel shows. */
static void assert_stats_have(const char *stats, const char *const *settings)
{
    static const char *const names[] = {"threads", "accelerator"};
    char value[64], expected[64];

    for (int k = 0; k < 2; k++) {
        const char *const text = json_value(value, sizeof value, stats, names[k]);
        for (int i = 0; settings[i]; i++) {
            snprintf(expected, sizeof expected, "%s=%.*s", names[k], (int)strcspn(text + k, "\""), text + k);
            if (strncmp(settings[i], names[k], strlen(names[k])) == 0) assert_string_equal(settings[i], expected);
        }
    }
}

/* Whatever is said by settings is said to the program by options. */
static void a_picture_has_the_bits_of_the_program(void **state)
{
    const struct {
        const char *settings[5], *options, *integrator;
    } cases[] = {
        {{NULL}, "", "\"sir\""},
        {{"samples=3", "integrator=em", "spp=2", NULL}, "--integrator em --samples 3 --spp 2", "\"em\""},
        {{"proposal=brdf", "seed=12", "accelerator=grid", "threads=1", NULL},
         "--proposal brdf --seed 12 --accelerator grid", "\"sir\""},
        {{"proposal=product", "learn=true", "spp=9", NULL}, "--proposal product --learn on --spp 9", "\"sir\""},
        {{"proposal=product", "learn=false", "spp=9", NULL}, "--proposal product --learn off --spp 9", "\"sir\""},
        {{"width=9", "height=5", "threads=2", "spp=3", NULL}, "--resolution 9x5 --nthreads 2 --spp 3", "\"sir\""},
        {{"error=0.4", "spp=64", "threads=1", NULL}, "--error 0.4 --spp 64 --nthreads 1", "\"sir\""},
        {{"crop=0.25,0.75,0,0.5", "spp=2", NULL}, "--cropwindow 0.25,0.75,0,0.5 --spp 2", "\"sir\""},
        {{"approximate=false", "layers=none", "spp=2", NULL}, "--spp 2", "\"sir\""},
        {{"approximate=true", "layers=albedo,stderr", "spp=2", NULL}, "--spp 2", "\"sir\""},
    };

    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        bis_flat_picture *p;
        bis_image image;
        program_run r;
        int shape[2];
        char value[64];
        const double begin = bis_clock_now();
        if (bis_flat_render(&p, SCENE, cases[k].settings, NULL, SAY)) fail_msg("%s", say);
        const double took = bis_clock_now() - begin;
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
        assert_string_equal(
            json_value(value, sizeof value, bis_flat_picture_stats(p), "integrator"), cases[k].integrator);
        assert_stats_have(bis_flat_picture_stats(p), cases[k].settings);
        /* the whole is more than its parts, and no more than the call */
        assert_true(strtod(json_value(value, sizeof value, bis_flat_picture_stats(p), "seconds.total"), NULL) <
                    1.00001 * took + 1e-6);
        static const char *const parts[] = {
            "seconds.parse", "seconds.load", "seconds.envmap", "seconds.accel", "seconds.render"};
        double rest = strtod(json_value(value, sizeof value, bis_flat_picture_stats(p), "seconds.total"), NULL);
        for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
            const double part = strtod(json_value(value, sizeof value, bis_flat_picture_stats(p), parts[i]), NULL);
            assert_true(part > 0);
            rest -= part;
        }
        assert_true(rest > -1e-6); /* rounding */
        free(rgba);
        bis_image_clear(&image);
        bis_flat_picture_close(p);
    }
    bis_flat_picture_close(NULL);
}

static float *pixels_of(const char *scene, const char *const *settings, const bis_light *light, int *n)
{
    bis_flat_picture *p;
    int shape[2];

    if (bis_flat_render_with(&p, scene, settings, light, NULL, NULL, NULL, SAY)) fail_msg("%s", say);
    bis_flat_picture_shape(p, shape);
    *n = 4 * shape[0] * shape[1];
    float *rgba = malloc((size_t)*n * sizeof *rgba);
    assert_non_null(rgba);
    bis_flat_picture_pixels(p, rgba);
    bis_flat_picture_close(p);
    return rgba;
}

/* The scene as text with another camera is the scene whose file has both. */
static void a_scene_is_text_and_a_camera_is_replaced(void **state)
{
#define CAMERA "LookAt 1 2 -3  0 0 4  0 1 0 Camera \"perspective\" \"float fov\" 50"
#define WORLD \
    "\nWorldBegin LightSource \"infinite\" \"string filename\" \"map.pfm\" Shape \"sphere\" \"float radius\" 2\n"
#define FILM "Film \"rgb\" \"integer xresolution\" 12 \"integer yresolution\" 9\n"
    const char *const as_text[] = {"text=" FILM "Camera \"orthographic\"" WORLD, "camera=" CAMERA, NULL};
    const char *const twin[] = {"text=" FILM "Camera \"orthographic\"" WORLD, NULL};
    int n[4];

    program_write_file(DIR "/whole.txt", FILM CAMERA WORLD);
    float *expected = pixels_of(DIR "/whole.txt", (const char *const[]){NULL}, NULL, &n[0]);
    const char *const last_wins[] = {
        "text=nonsense", "approximate=x", as_text[0], "approximate=false", "camera=" CAMERA, NULL};
    float *got = pixels_of(DIR "/a scene", as_text, NULL, &n[1]), *other = pixels_of(DIR "/a scene", twin, NULL, &n[2]);
    float *last = pixels_of(DIR "/a scene", last_wins, NULL, &n[3]);
    assert_true(n[0] == 4 * 12 * 9 && n[1] == n[0] && n[2] == n[0] && n[3] == n[0]);
    assert_memory_equal(got, expected, (size_t)n[0] * sizeof *got);
    assert_memory_equal(last, expected, (size_t)n[0] * sizeof *got);
    assert_memory_not_equal(other, expected, (size_t)n[0] * sizeof *got);
    free(expected);
    free(got);
    free(last);
    free(other);
}

/* A map from an array is that map from its file, and over a scene it is --light. */
static void a_light_of_an_array_is_that_of_its_file(void **state)
{
    static const char *const none[] = {NULL};
    bis_light *made, *read;
    bis_image image;
    program_run r;
    float w[40][3], L[2][40][3];
    double u[40][4], pdf[2][40];
    bis_rng rng;
    int n;

    assert_int_equal(bis_image_read(&image, DIR "/map.pfm", (bis_loc){0}, NULL), BIS_OK);
    image.pixels[3] = (rgb){5, 6, 7};
    assert_int_equal(bis_image_save(&image, DIR "/other.pfm", NULL), BIS_OK);
    assert_int_equal(
        bis_flat_light_make(&made, image.width, image.height, &image.pixels[0].r, "cdf", 0.5, NULL, SAY), 0);
    assert_int_equal(bis_flat_light_open(&read, DIR "/other.pfm", "cdf", 0.5, "latlong", SAY), 0);
    bis_image_clear(&image);
    bis_rng_init(&rng, 2, 0, 0, 0);
    for (int i = 0; i < 40; i++)
        for (int k = 0; k < 4; k++) u[i][k] = bis_rng_double(&rng);
    assert_int_equal(bis_flat_light_sample(made, 40, u[0], w[0], L[0][0], pdf[0], SAY), 0);
    assert_int_equal(bis_flat_light_sample(read, 40, u[0], w[0], L[1][0], pdf[1], SAY), 0);
    assert_memory_equal(L[0], L[1], sizeof L[0]);
    assert_memory_equal(pdf[0], pdf[1], sizeof pdf[0]);
    float *got = pixels_of(SCENE, none, made, &n);
    program_expect(&r, 0, SCENE " --outfile " DIR "/out.pfm --light " DIR "/other.pfm");
    assert_int_equal(bis_image_read(&image, DIR "/out.pfm", (bis_loc){0}, NULL), BIS_OK);
    for (int i = 0; i < n / 4; i++) assert_memory_equal(got + 4 * i, &image.pixels[i], sizeof image.pixels[i]);
    bis_image_clear(&image);
    free(got);
    bis_flat_light_close(made);
    bis_flat_light_close(read);
    /* what no map can be */
    const float grey[12] = {0};
    refuses(bis_flat_light_make(&made, 0, 2, grey, "cdf", 0, NULL, SAY), "0 x 2");
    refuses(bis_flat_light_make(&made, 40000, 1, grey, "cdf", 0, NULL, SAY), "40000 x 1");
    refuses(bis_flat_light_make(&made, 2, 2, grey, "cdf", 0, NULL, SAY), "\"the array\" is square");
    refuses(bis_flat_light_make(&made, 2, 1, grey, "cdf", 0, "cube", SAY), "no mapping \"cube\"");
    refuses(bis_flat_light_make(&made, 2, 1, grey, "cdf", 0, "equalarea", SAY), "must be");
    assert_null(made);
    const float holes[6] = {1, NAN, 1, -1, 1, HUGE_VALF};
    assert_int_equal(bis_flat_light_make(&made, 2, 1, holes, "cdf", 0, NULL, SAY), 0);
    assert_non_null(strstr(say, "bad channel values set to 0: 1 NaN, 1 infinite, 1 negative"));
    bis_flat_light_close(made);
}

/* Lights that a scene may not have are no matter under another light; without one, they are refused. A square lat-long
 * map is one, each row of which is half of the sphere: upright, bright above and black below. */
static void a_light_takes_the_place_of_all_lights_of_a_scene(void **state)
{
    static const float sky[2][2][3] = {{{1, 2, 3}, {1, 2, 3}}, {{0, 0, 0}, {0, 0, 0}}};
    static const char *const settings[] = {
        "text=Film \"rgb\" \"integer xresolution\" 2 \"integer yresolution\" 2 LookAt 0 -4 2 0 0 0 0 0 1 Camera "
        "\"perspective\" \"float fov\" 9 WorldBegin LightSource \"point\" LightSource \"infinite\" \"string "
        "filename\" \"gone.exr\" Material \"diffuse\" \"rgb reflectance\" [0.5 0.25 0.125] Shape \"disk\" \"float "
        "radius\" 9", "integrator=brdf", "spp=4", NULL};
    bis_light *light;
    bis_flat_picture *p;
    int n;

    assert_int_equal(bis_flat_light_make(&light, 2, 2, sky[0][0], "cdf", 0, "latlong", SAY), 0);
    float *rgba = pixels_of("scene", settings, light, &n);
    assert_int_equal(n, 16);
    for (int i = 0; i < 16; i++) /* Kd times the radiance from above */
        assert_about((double)rgba[i], (const double[]){0.5, 0.5, 0.375, 1}[i % 4], 1e-6);
    free(rgba);
    bis_flat_light_close(light);
    refuses(bis_flat_render(&p, "scene", settings, NULL, SAY), "LightSource");
    assert_null(p);
}

/* The floor of the scene is the plane y = -1 and its camera looks along z: where the floor is seen (and no sphere above
 * it), normal and albedo are known, and 1/depth is linear in the row. The layers of the film itself have tests of their
 * own. */
static void layers_are_given_by_name(void **state)
{
    static const char *const settings[] = {"layers=albedo,depth,normal,samples,stderr", "spp=8", NULL};
    static float albedo[16][24][3], normal[16][24][3], depth[16][24], samples[16][24];
    bis_flat_picture *p;

    assert_int_equal(bis_flat_render(&p, SCENE, settings, NULL, SAY), 0);
    assert_int_equal(bis_flat_picture_layer(p, "albedo", albedo[0][0]), 3);
    assert_int_equal(bis_flat_picture_layer(p, "normal", normal[0][0]), 3);
    assert_int_equal(bis_flat_picture_layer(p, "depth", depth[0]), 1);
    assert_int_equal(bis_flat_picture_layer(p, "samples", samples[0]), 1);
    assert_int_equal(bis_flat_picture_layer(p, "stderr", NULL), 3);
    assert_int_equal(bis_flat_picture_layer(p, "visibility", depth[0]), 0); /* not asked for */
    assert_string_equal(bis_flat_layer_name(0), "stderr");
    assert_string_equal(bis_flat_layer_name(BIS_N_LAYERS - 1), "depth");
    assert_true(!bis_flat_layer_name(-1) && !bis_flat_layer_name(BIS_N_LAYERS));
    assert_int_equal(bis_flat_picture_layer(p, "Albedo", depth[0]), 0);
    assert_int_equal(bis_flat_picture_layer(p, NULL, depth[0]), 0);
    for (int x = 0; x < 24; x++) {
        for (int k = 0; k < 3; k++) {
            assert_about((double)albedo[15][x][k], (const double[]){0.7, 0.6, 0.5}[k], 1e-6);
            assert_about((double)normal[15][x][k], k == 1, 1e-6);
            assert_true(albedo[0][x][k] == 0); /* the sky */
        }
        /* the last row of 16 is seen between the tangents 14/16 and 1 of 30 degrees */
        const double t = tan(30 * PI / 180);
        assert_true((double)depth[15][x] > 1 / t && (double)depth[15][x] < 16 / (14 * t));
        assert_true(samples[15][x] >= 8);
    }
    bis_flat_picture_close(p);
    assert_int_equal(bis_flat_render(&p, SCENE, (const char *const[]){"layers=stderr", "spp=1", NULL}, NULL, SAY), 0);
    assert_int_equal(bis_flat_picture_layer(p, "stderr", NULL), 0); /* one pass has no scatter */
    bis_flat_picture_close(p);
}

static void what_is_not_modelled_is_replaced_when_that_is_asked_for(void **state)
{
#define GLASS "text=WorldBegin LightSource \"infinite\" Material \"dielectric\" Shape \"sphere\""
    bis_flat_picture *p;

    refuses(bis_flat_render(&p, "scene", (const char *const[]){GLASS, "spp=1", NULL}, NULL, SAY),
        "scene:1:44: error: Material \"dielectric\"");
    assert_int_equal(bis_flat_render(&p, "scene",
                         (const char *const[]){GLASS, "width=4", "height=3", "approximate=true", NULL}, NULL, SAY),
        0);
    assert_non_null(strstr(say, "dielectric"));
    bis_flat_picture_close(p);
}

typedef struct watched {
    int n;
    double share;
    bool falls;
} watched;

/* What is left goes with the share: all seconds together are those so far over it. Of a quarter of a second. */
static void look_on(double share, double seconds, double left, void *user)
{
    watched *w = user;
    w->falls |= share < w->share || !(share >= 0 && share <= 1) || !(seconds >= 0) || left < 0;
    w->falls |= share > 0 && !(fabs(left * share - seconds * (1 - share)) <= 1e-9 * seconds);
    w->falls |= share < fmin(1, 4 * seconds) * (1 - 1e-9);
    w->share = share;
    w->n++;
}

static void a_watcher_hears_of_the_render(void **state)
{
    watched w = {0};
    bis_flat_picture *p;

    assert_int_equal(
        bis_flat_render_with(&p, SCENE, (const char *const[]){"seconds=0.25", NULL}, NULL, look_on, &w, NULL, SAY), 0);
    assert_true(w.n > 0 && !w.falls && w.share > 0);
    bis_flat_picture_close(p);
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
        {"proposal=best", "proposal is \"best\": integrator \"sir\" takes \"em\", \"brdf\", \"mix\" or \"product\""},
        {"proposal=choose", "proposal is \"choose\": integrator \"sir\" takes \"em\""}, /* rejection's */
        {"learn=", "learn is \"\": give true or false"},
        {"learn=truely", "learn is \"truely\": give true or false"},
        {"=1", "integrator \"sir\" has no parameter \"\"; `bis help integrators` lists what each reads"},
        {"", "\"\" is no setting: give name=value"},
        {"abcdefghijklmnopqrstuvwxyz-abcdefghijklmnopqrstuvwxyz-abcdefghi=1", /* a name of 63 letters, and 64 */
         "integrator \"sir\" has no parameter \"abcdefghijklmnopqrstuvwxyz-abcdefghijklm\"; `bis help"},
        {"abcdefghijklmnopqrstuvwxyz-abcdefghijklmnopqrstuvwxyz-abcdefghij=1", "\" is no setting: give name=value"},
        {"approximate=", "approximate is \"\": give true or false"},
        {"approximate=tru", "approximate is \"tru\": give true or false"},
        {"accelerator=bvh", "accelerator \"bvh\" is not there"},
        {"approximate=1", "approximate is \"1\": give true or false"},
        {"crop=0.5,0.25,0,1", "crop is \"0.5,0.25,0,1\": give x0,x1,y0,y1 in [0, 1]"},
        {"crop=0,1,0", "crop is \"0,1,0\""},
        {"crop=0,1,0,nan", "crop is"},
        {"layers=deth", "layers: there is no layer \"deth\" (did you mean \"depth\"?)"},
        {"camera=Camera \"fisheye\"", "camera:1:8: error"},
        {"camera=Shape \"sphere\"", "camera:1:1: error"},
        {"text=WorldBegin Shape \"cube\"", DIR "/scene.txt:1:18: error"},
    };
    bis_flat_picture *p;

    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        refuses(bis_flat_render(&p, SCENE, (const char *const[]){cases[k].setting, NULL}, NULL, SAY), cases[k].text);
        assert_null(p);
    }
    refuses(bis_flat_render(&p, SCENE, (const char *const[]){"accelerator=bvh", NULL}, NULL, SAY),
        bis_accel_embree_version() ? "accelerator \"bvh\" is not there: give \"grid\" or \"embree\""
                                   : "accelerator \"bvh\" is not there: give \"grid\"");
    assert_int_equal(bis_flat_render(&p, SCENE, (const char *const[]){"accelerator=embree", "spp=1", NULL}, NULL, SAY),
        bis_accel_embree_version() ? BIS_OK : BIS_INPUT);
    if (p) assert_stats_have(bis_flat_picture_stats(p), (const char *const[]){"accelerator=embree", NULL});
    bis_flat_picture_close(p);
    refuses(bis_flat_render(&p, SCENE, (const char *const[]){NULL}, &(sig_atomic_t){1}, SAY),
        "stopped before its first pass");
    /* a buffer that is too small is filled and ended, one of no bytes is left alone */
    char small[8];
    assert_int_equal(
        bis_flat_render(&p, DIR "/none.txt", (const char *const[]){NULL}, NULL, small, sizeof small), BIS_IO);
    assert_int_equal(strlen(small), 7);
    assert_int_equal(bis_flat_render(&p, DIR "/none.txt", (const char *const[]){NULL}, NULL, NULL, 0), BIS_IO);
}

/* ---- tiny cases by hand ---- */

/* 4 x 2 pixels, each of pi/2 sr; pixel i has the radiance (i+1) (1, 10, 100). */
static void a_map_of_eight_pixels_by_hand(void **state)
{
    float file[2][4][3], pixels[2][4][3], w[3][3], L[8][3];
    double pdf[8], u[32];
    int shape[2];
    bis_light *light;

    for (int y = 0; y < 2; y++)
        for (int x = 0; x < 4; x++)
            for (int k = 0; k < 3; k++) file[1 - y][x][k] = (float)((4 * y + x + 1) * (k == 0 ? 1 : k == 1 ? 10 : 100));
    write_pfm(DIR "/eight.pfm", 4, 2, file[0][0]);
    assert_int_equal(bis_flat_light_open(&light, DIR "/eight.pfm", "alias", 0, NULL, SAY), 0);
    assert_string_equal(say, "");
    bis_flat_light_shape(light, shape);
    assert_true(shape[0] == 4 && shape[1] == 2);
    bis_flat_light_pixels(light, pixels[0][0]);
    for (int y = 0; y < 2; y++) assert_memory_equal(pixels[y], file[1 - y], sizeof pixels[y]);
    assert_about(bis_flat_light_power(light), 36 * 111 * PI / 2, 1e-6);
    /* of any length: azimuths of 45, 135 and 225 degrees above, above and below */
    const float look[3][3] = {{1e30f, 1e30f, 1e30f}, {-1e-30f, 1e-30f, 1e-31f}, {-3, -3, -0.5f}};
    const int seen[3] = {0, 1, 6};
    assert_int_equal(bis_flat_light_look(light, 3, look[0], L[0], pdf, SAY), 0);
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) assert_about((double)L[i][k], (seen[i] + 1) * (k == 0 ? 1 : k == 1 ? 10 : 100), 0);
        assert_about(pdf[i], (seen[i] + 1) / 36.0 / (PI / 2), 1e-6);
    }
    /* samples: what is stored of each is that of the pixel where the direction lies */
    for (int i = 0; i < 32; i++) u[i] = fmod(0.05 + 0.381966 * i, 1);
    for (int i = 0; i < 8; i += 2) {
        assert_int_equal(bis_flat_light_sample(light, 2, u + 4 * i, w[0], L[0], pdf, SAY), 0);
        for (int k = 0; k < 2; k++) {
            const double phi = atan2((double)w[k][1], (double)w[k][0]);
            const int pixel = (w[k][2] < 0 ? 4 : 0) + (int)floor((phi < 0 ? phi + 2 * PI : phi) / (PI / 2));
            assert_about((double)L[k][0], pixel + 1, 0);
            assert_about((double)L[k][1], 10 * (pixel + 1), 0);
            assert_about((double)L[k][2], 100 * (pixel + 1), 0);
            assert_about(pdf[k], (pixel + 1) / 36.0 / (PI / 2), 1e-6);
        }
    }
    refuses(bis_flat_light_look(light, 3, (float[]){1, 0, 0, 0, 1, 0, 1, 1, INFINITY}, L[0], pdf, SAY),
        "direction 2 is (1, 1, inf): give finite vectors");
    refuses(bis_flat_light_look(light, 2, (float[]){1, 0, 0, INFINITY, 2, 3}, L[0], pdf, SAY),
        "direction 1 is (inf, 2, 3): give finite vectors");
    for (int i = 0; i < 12; i++) {
        double bad[12] = {0};
        char text[64];
        bad[i] = 1;
        snprintf(text, sizeof text, "u of sample %d is 1: give random numbers in [0, 1)", i / 4);
        refuses(bis_flat_light_sample(light, 3, bad, w[0], L[0], pdf, SAY), text);
    }
    bis_flat_light_close(light);
    /* the exponent is used, and its limits are in its range */
    assert_int_equal(bis_flat_light_open(&light, DIR "/eight.pfm", "cdf", 10, NULL, SAY), 0);
    bis_flat_light_close(light);
    refuses(bis_flat_light_open(&light, DIR "/eight.pfm", "cdf", 10.000001, NULL, SAY),
        "area_exponent is 10: give a number in [0, 10]");
    refuses(bis_flat_light_open(&light, DIR "/eight.pfm", "cdf", (double)NAN, NULL, SAY),
        "area_exponent is nan: give a number in [0, 10]");
}

/* Shares of 0.1, 0.2, 0.4, 0.3 in one row: by the inverted cdf 0.35 lies in [0.3, 0.7), pixel 2; in the alias table of
 * thesis figure 3.4 it lies in bin 1, below its prob. */
static void the_kind_of_a_table_is_the_one_asked_for(void **state)
{
    static const float row[4][3] = {{1, 0, 0}, {2, 0, 0}, {4, 0, 0}, {3, 0, 0}};
    static const char *const kinds[] = {"cdf", "alias"};
    static const double expected[] = {4, 2};
    float w[3], L[3];
    double pdf;

    write_pfm(DIR "/row.pfm", 4, 1, row[0]);
    for (int i = 0; i < 2; i++) {
        bis_light *light;
        assert_int_equal(bis_flat_light_open(&light, DIR "/row.pfm", kinds[i], 0, NULL, SAY), 0);
        assert_int_equal(bis_flat_light_sample(light, 1, (double[]){0.35, 0.35, 0.35, 0.35}, w, L, &pdf, SAY), 0);
        assert_about((double)L[0], expected[i], 0);
        assert_about(pdf, expected[i] / 10 / PI, 1e-6); /* a pixel of a row alone has pi sr */
        bis_flat_light_close(light);
    }
}

/* One bright pixel among dim ones is a region of its own of 0.0024 sr: an exponent of 2 divides its weight by the
 * square of 0.01 sr over that (thesis 3.4), and leaves the weight of the others. */
static void an_area_exponent_draws_large_regions_more_often(void **state)
{
    static float file[64][128][3];
    const float at_lamp[3] = {
        (float)cos(5.5 / 64 * PI), (float)sin(5.5 / 64 * PI), -0.01f}; /* column 5, the first row below */
    const double sr = 2 * PI / 128 * sin(PI / 64), rest = 3 * (4 * PI - sr);

    for (int i = 0; i < 64 * 128; i++)
        for (int k = 0; k < 3; k++) file[i / 128][i % 128][k] = 1;
    for (int k = 0; k < 3; k++) file[31][5][k] = 1000;
    write_pfm(DIR "/lamp.pfm", 128, 64, file[0][0]);
    for (int b = 0; b <= 2; b += 2) {
        const double weight = 3000 * pow(sr / 0.01, b);
        float L[3];
        double pdf;
        bis_light *light;
        assert_int_equal(bis_flat_light_open(&light, DIR "/lamp.pfm", b ? "cdf" : "alias", b, NULL, SAY), 0);
        assert_int_equal(bis_flat_light_look(light, 1, at_lamp, L, &pdf, SAY), 0);
        bis_flat_light_close(light);
        assert_about((double)L[0], 1000, 0);
        assert_about(pdf, weight / (weight * sr + rest), 1e-4);
    }
}

static void weights_of_a_table_are_checked_and_summed(void **state)
{
    double prob[3], total = -1, w[3] = {6, 0, 3};
    uint32_t alias[3], item[2];

    /* of 3 each: bin 1 is all bin 0's; bin 2 its own; bin 0 is full */
    assert_int_equal(bis_flat_alias_build(3, w, prob, alias, &total, SAY), 0);
    assert_about(total, 9, 1e-12);
    assert_about(prob[0], 1, 1e-12);
    assert_about(prob[1], 0, 1e-12);
    assert_about(prob[2], 1, 1e-12);
    assert_int_equal(alias[1], 0);
    assert_int_equal(bis_flat_alias_sample(3, prob, alias, 2, (double[]){0.5, 0.9}, item, SAY), 0);
    assert_true(item[0] == 0 && item[1] == 2);
    assert_int_equal(bis_flat_alias_build(1, (double[]){1e-300}, prob, alias, &total, SAY), 0);
    assert_about(total, 1e-300, 1e-312);
    refuses(bis_flat_alias_build(3, (double[]){1, 1, -1e-9}, prob, alias, &total, SAY),
        "weight 2 is -1e-09: give finite numbers >= 0");
    refuses(bis_flat_alias_build(3, (double[]){1, (double)NAN, 1}, prob, alias, &total, SAY),
        "weight 1 is nan: give finite numbers >= 0");
    refuses(bis_flat_alias_build(UINT32_MAX, (double[]){-1}, prob, alias, &total, SAY), "weight 0 is -1");
    refuses(bis_flat_alias_build((size_t)1 << 32, w, prob, alias, &total, SAY),
        "there are 4294967296 weights: give 1 to 4294967295");
    refuses(bis_flat_alias_sample(3, prob, alias, 2, (double[]){0, 1}, item, SAY), "u of sample 1 is 1");
    refuses(
        bis_flat_alias_sample(0, prob, alias, 0, NULL, item, SAY), "the tables are empty: there is nothing to draw");
    assert_int_equal(bis_flat_alias_sample(3, prob, alias, 0, NULL, item, SAY), 0);
}

/* Phong: the lobe's value in the mirror direction is Ks (n+2)/(2 pi) with the cosine's normalization of the thesis,
 * (n+1)/(2 pi), and every channel has its own Kd and Ks. The normal is (1, 2, 2)/3; seen along it, so is the mirror
 * direction; perpendicular to the normal nothing is seen. 60 degrees off, the lobe is 2^-n of its peak. */
static void each_channel_of_a_material_is_its_own(void **state)
{
    const double Kd[3] = {0.1, 0.2, 0.4}, Ks[3] = {0.5, 0.25, 0.125}, n[3] = {2, 4, 4}, wo[3] = {0.5, 1, 1};
    const double z[3] = {0, 0, 3}, x3z4[3] = {30, 0, 40};
    float wi[3][3] = {{1, 2, 2}, {0, 0, 0}, {-1, -2, -2}}, f[3][3];
    uint8_t lobe[2];
    double pdf[3];
    bis_bsdf *b;

    /* a vector across the normal, (2, -2, 1)/3, for the direction at 60 degrees */
    for (int k = 0; k < 3; k++) wi[1][k] = (float)((n[k] / 6 + sqrt(3) * (const double[]){2, -2, 1}[k] / 3) * 7);
    assert_int_equal(bis_flat_bsdf_open(&b, "phong", Kd, Ks, 5, n, wo, SAY), 0);
    assert_string_equal(say, "");
    assert_int_equal(bis_flat_bsdf_look(b, 3, wi[0], f[0], pdf, SAY), 0);
    for (int k = 0; k < 3; k++) {
        assert_about((double)f[0][k], Kd[k] / PI + Ks[k] * 6 / (2 * PI), 1e-6);
        assert_about((double)f[1][k], Kd[k] / PI + Ks[k] * 6 / (2 * PI) / 32, 1e-5);
        assert_about((double)f[2][k], 0, 0);
    }
    assert_true(pdf[0] > 0 && pdf[1] > 0 && pdf[0] > pdf[1]);
    refuses(bis_flat_bsdf_look(b, 2, (float[]){1, 2, 2, 0, NAN, 0}, f[0], pdf, SAY), "direction 1 is (0, nan, 0)");
    bis_flat_bsdf_close(b);
    /* a sharp lobe from (3, 0, 4)/5 about z goes to (-3, 0, 4)/5; a second sample of the base lies above */
    assert_int_equal(bis_flat_bsdf_open(&b, "phong", Kd, Ks, 1e10, z, x3z4, SAY), 0);
    assert_int_equal(bis_flat_bsdf_sample(b, 2, (double[]){0, 0.5, 0.25, 0.9999, 0.25, 0.5}, wi[0], lobe, SAY), 0);
    assert_true(lobe[0] == 1 && lobe[1] == 0);
    assert_about((double)wi[0][0], -0.6, 1e-3);
    assert_about((double)wi[0][1], 0, 1e-3);
    assert_about((double)wi[0][2], 0.8, 1e-3);
    assert_true(wi[1][2] > 0 && fabs((double)(wi[1][0] + 0.6f)) > 1e-2);
    for (int i = 0; i < 6; i++) {
        double bad[6] = {0};
        char text[32];
        bad[i] = -0.5;
        snprintf(text, sizeof text, "u of sample %d is -0.5", i / 3);
        refuses(bis_flat_bsdf_sample(b, 2, bad, wi[0], lobe, SAY), text);
    }
    bis_flat_bsdf_close(b);
    /* GGX of roughness 0.5 has alpha 0.25; head on D = 1/(pi alpha^2), f = Ks D/4 + 28/(23 pi) Kd (1 - Ks) (31/32)^2 */
    assert_int_equal(bis_flat_bsdf_open(&b, "microfacet", Kd, Ks, 0.5, n, n, SAY), 0);
    assert_int_equal(bis_flat_bsdf_look(b, 1, (float[]){1, 2, 2}, f[0], pdf, SAY), 0);
    for (int k = 0; k < 3; k++)
        assert_about((double)f[0][k],
            Ks[k] * 16 / (4 * PI) + 28 / (23 * PI) * Kd[k] * (1 - Ks[k]) * (31.0 / 32) * (31.0 / 32), 1e-5);
    bis_flat_bsdf_close(b);
}

/* Vectors of which no two components are equal: (2, 3, 6)/7 mirrors (6, -2, 3)/7 to (-198, 242, 141)/343, where a sharp
 * lobe has its peak. What is drawn from it is what the library draws from the same three numbers. */
static void each_component_of_a_vector_is_its_own(void **state)
{
    const double Kd[3] = {0.1, 0.2, 0.4}, Ks[3] = {0.5, 0.25, 0.125}, n[3] = {4, 6, 12}, wo[3] = {3, -1, 1.5};
    const double u[6] = {0.3, 0.9, 0.2, 0.95, 0.1, 0.7};
    float mirror[3] = {-198, 242, 141}, f[3], wi[2][3];
    double pdf;
    uint8_t lobe[2];
    bis_bsdf *b;

    assert_int_equal(bis_flat_bsdf_open(&b, "phong", Kd, Ks, 10000, n, wo, SAY), 0);
    assert_int_equal(bis_flat_bsdf_look(b, 1, mirror, f, &pdf, SAY), 0);
    for (int k = 0; k < 3; k++) assert_about((double)f[k], Kd[k] / PI + Ks[k] * 10001 / (2 * PI), 1);
    assert_int_equal(bis_flat_bsdf_sample(b, 2, u, wi[0], lobe, SAY), 0);
    for (int i = 0; i < 2; i++) {
        vec3 w;
        assert_true(bis_bsdf_sample(b, u[3 * i], u[3 * i + 1], u[3 * i + 2], &w));
        assert_true(wi[i][0] == w.x && wi[i][1] == w.y && wi[i][2] == w.z && lobe[i] == !i);
    }
    bis_flat_bsdf_close(b);
}

static void materials_are_taken_up_to_their_limits(void **state)
{
    const double Kd[3] = {0.1, 0.2, 0.4}, Ks[3] = {0.5, 0.25, 0.125}, one[3] = {1, 0, 0}, z[3] = {0, 0, 3};
    bis_bsdf *b;

    assert_int_equal(bis_flat_bsdf_open(&b, "phong", one, (double[]){0, 0, 1}, 0, z, z, SAY), 0);
    bis_flat_bsdf_close(b);
    assert_int_equal(bis_flat_bsdf_open(&b, "microfacet", one, one, 1, z, z, SAY), 0);
    bis_flat_bsdf_close(b);
    assert_int_equal(bis_flat_bsdf_open(&b, "microfacet", one, one, 0.01, z, z, SAY), 0);
    bis_flat_bsdf_close(b);
    refuses(bis_flat_bsdf_open(&b, "microfacet", one, one, 1.001, z, z, SAY),
        "the roughness is 1.001: give a number in [0.01, 1]");
    refuses(bis_flat_bsdf_open(&b, "microfacet", one, one, 0.0099, z, z, SAY),
        "the roughness is 0.0099: give a number in [0.01, 1]");
    refuses(bis_flat_bsdf_open(&b, "phong", one, one, HUGE_VAL, z, z, SAY),
        "the exponent is inf: give a number in [0, 3.4e38]");
    for (int k = 0; k < 3; k++) {
        double c[3] = {0.25, 0.5, 0.75};
        char text[128];
        c[k] = 1.5;
        snprintf(text, sizeof text, "Kd is (%g, %g, %g): give numbers in [0, 1]", c[0], c[1], c[2]);
        refuses(bis_flat_bsdf_open(&b, "phong", c, Ks, 1, z, z, SAY), text);
        c[k] = -0.5;
        snprintf(text, sizeof text, "Ks is (%g, %g, %g): give numbers in [0, 1]", c[0], c[1], c[2]);
        refuses(bis_flat_bsdf_open(&b, "phong", Kd, c, 1, z, z, SAY), text);
        c[k] = (double)NAN;
        snprintf(text, sizeof text, "wo is (%g, %g, %g): give a finite vector that is not 0", c[0], c[1], c[2]);
        refuses(bis_flat_bsdf_open(&b, "microfacet", Kd, Ks, 1, z, c, SAY), text);
        c[k] = HUGE_VAL;
        snprintf(text, sizeof text, "normal is (%g, %g, %g): give a finite vector that is not 0", c[0], c[1], c[2]);
        refuses(bis_flat_bsdf_open(&b, "microfacet", Kd, Ks, 1, c, z, SAY), text);
    }
    assert_null(b);
}

/* Of a vector of any length the direction counts, also where its square would be 0 or infinite. */
static void a_vector_may_have_any_length(void **state)
{
    static const double lengths[] = {1, 1e200, 1e-200, 5e-320, 1.7e308};
    const double Kd[3] = {0.1, 0.2, 0.4}, Ks[3] = {0.5, 0.25, 0.125};
    const float wi[3] = {0.1f, 0.2f, 0.9f};
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
        const double l = lengths[i];
        bis_bsdf *b;
        float f[3];
        double pdf;
        assert_int_equal(bis_flat_bsdf_open(&b, "phong", Kd, Ks, 20, (double[]){0, 0, l}, (double[]){0, l, l}, SAY), 0);
        assert_int_equal(bis_flat_bsdf_look(b, 1, wi, f, &pdf, SAY), 0);
        /* thesis eq. 2.12: wo at 45 degrees, mirrored at the normal, is (0, -1, 1) / sqrt 2 */
        const double cos_alpha = 0.7 / sqrt(0.86) / sqrt(2);
        for (int c = 0; c < 3; c++)
            assert_true(fabs((double)f[c] - (Kd[c] / PI + Ks[c] * 22 / (2 * PI) * pow(cos_alpha, 20))) < 1e-6);
        bis_flat_bsdf_close(b);
    }
}

/* ---- pictures by hand ---- */

static void the_version_is_the_headers(void **state) { assert_string_equal(bis_flat_version(), BIS_VERSION); }

/* A wall that fills the upper half of the picture: there alpha is 1, below it is 0 and the constant light is seen. The
 * middle line lies between two pixels. */
static void alpha_is_the_share_that_hits_a_surface(void **state)
{
    bis_flat_picture *p;
    float rgba[6][4][4];
    int shape[2];

    program_write_file(DIR "/half.txt",
        "Film \"rgb\" \"integer xresolution\" 4 \"integer yresolution\" 6 \"string filename\" \"x.pfm\"\nCamera "
        "\"perspective\" \"float fov\" 60\n"
        "WorldBegin LightSource \"infinite\" \"rgb L\" [0.25 0.5 2] Material \"diffuse\" \"rgb reflectance\" [0 0 0]\n"
        "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point3 P\" [-99 0 5  99 0 5  99 99 5  -99 99 5]\n");
    const char *const settings[] = {"spp=1", NULL};
    assert_int_equal(bis_flat_render(&p, DIR "/half.txt", settings, NULL, SAY), 0);
    bis_flat_picture_shape(p, shape);
    assert_true(shape[0] == 4 && shape[1] == 6);
    bis_flat_picture_pixels(p, rgba[0][0]);
    for (int y = 0; y < 6; y++)
        for (int x = 0; x < 4; x++) {
            assert_about((double)rgba[y][x][3], y < 3, 0);
            for (int k = 0; k < 3; k++)
                assert_about((double)rgba[y][x][k], y < 3 ? 0 : (const double[]){0.25, 0.5, 2}[k], 1e-6);
        }
    bis_flat_picture_close(p);
}

/* A render that is to stop at once accepts its settings first. What an option takes at its limits, and what not. */
static void settings_have_their_limits(void **state)
{
    static const char *const good[] = {"spp=1", "spp=4294967295", "threads=1", "threads=3", "seconds=1e-9",
        "seconds=1e8", "error=1e-9", "error=10", "width=1", "width=32768", "height=1", "height=32768", "seed=0",
        "seed=9007199254740991", "integrator=em", "candidates=1", "accelerator=grid"};
    static const struct {
        const char *setting, *text;
    } bad[] = {{"spp=4294967296", "spp is \"4294967296\": give an integer in [1, 4294967295]"},
               {"threads=0", "threads is \"0\": give an integer in [1, 1024]"},
               {"threads=1025", "threads is \"1025\": give an integer in [1, 1024]"},
               {"threads=2.5", "threads is \"2.5\": give an integer in [1, 1024]"},
               {"seconds=-1", "seconds is \"-1\": give a number in (0, 100000000]"},
               {"seconds=0", "seconds is \"0\": give a number in (0, 100000000]"},
               {"seconds=1.1e9", "seconds is \"1.1e9\": give a number in (0, 100000000]"},
               {"error=-0.1", "error is \"-0.1\": give a number in (0, 10]"},
               {"error=0", "error is \"0\": give a number in (0, 10]"},
               {"error=11", "error is \"11\": give a number in (0, 10]"},
               {"width=0", "width is \"0\": give an integer in [1, 32768]"},
               {"width=32769", "width is \"32769\": give an integer in [1, 32768]"},
               {"height=0", "height is \"0\": give an integer in [1, 32768]"},
               {"height=32769", "height is \"32769\": give an integer in [1, 32768]"},
               {"height=1.5", "height is \"1.5\": give an integer in [1, 32768]"},
               {"seed=9007199254740992", "seed is \"9007199254740992\": give an integer in [0, 9007199254740991]"},
               {"seed=9007199254740993", "give an integer in [0, 9007199254740991]"}, /* no double: read as 2^53 */
               {"seed=1.5", "seed is \"1.5\": give an integer in [0, 9007199254740991]"},
               {"seed=", "seed is \"\": give an integer"},
               {"seed=7x", "seed is \"7x\": give an integer"},
               {"candidates=1.5", "candidates is \"1.5\": give an integer in [0, 4294967295]"},
               {"candidates=4294967296", "candidates is \"4294967296\": give an integer in [0, 4294967295]"},
               {"a-name-that-is-longer-than-any-name-of-a-parameter-that-there-is=1",
                "-of-a-parameter-that-ther\" is no setting: give name=value"}};
    bis_flat_picture *p;

    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        /* small, unless it is the size that is asked for */
        const char *settings[] = {"width=2", "height=1", good[i], NULL};
        refuses(bis_flat_render(&p, SCENE, settings, &(sig_atomic_t){1}, SAY),
            "the render was stopped before its first pass was complete");
    }
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        refuses(bis_flat_render(&p, SCENE, (const char *const[]){bad[i].setting, NULL}, &(sig_atomic_t){1}, SAY),
            bad[i].text);
    static const char *const split[] = {"split=1.5", "split=-0.5", "split=0.5x"};
    for (size_t i = 0; i < 3; i++) {
        refuses(bis_flat_render(
                    &p, SCENE, (const char *const[]){split[i], "integrator=mis", NULL}, &(sig_atomic_t){1}, SAY),
            split[i] + 6);
        assert_non_null(strstr(say, "give a number in [0, 1]"));
    }
    assert_null(p);
}

/* A scene's own integrator keeps its parameters when it is named again, and a switched erratum stays for another one.
 */
static void an_integrator_named_again_keeps_what_the_scene_says(void **state)
{
    static const char *const settings[][2] = {
        {"integrator=sir", NULL}, {"integrator=em", NULL}, {"integrator=mis", NULL}};
    static const char *const options[] = {"--integrator sir", "--integrator em", "--integrator mis"};

    program_write_scene(DIR, "Option \"string asprinted\" \"E3\"\n");
    for (int k = 0; k < 3; k++) {
        bis_flat_picture *p;
        bis_image image;
        program_run r;
        float rgba[24 * 16][4];
        if (bis_flat_render(&p, SCENE, settings[k], NULL, SAY)) fail_msg("%s", say);
        program_runf(&r, SCENE " --outfile " DIR "/out.pfm %s", options[k]);
        assert_int_equal(r.exit_status, 0);
        assert_int_equal(bis_image_read(&image, DIR "/out.pfm", (bis_loc){0}, NULL), BIS_OK);
        bis_flat_picture_pixels(p, rgba[0]);
        for (int i = 0; i < 24 * 16; i++) assert_memory_equal(rgba[i], &image.pixels[i], sizeof image.pixels[i]);
        bis_image_clear(&image);
        bis_flat_picture_close(p);
    }
    program_write_scene(DIR, "");
}

/* Two mistakes are two lines. */
static void each_message_has_a_line(void **state)
{
    bis_flat_picture *p;

    program_write_file(DIR "/bad.txt", "Film \"rgb\" \"integer xresolution\" 0\nWorldBegin\nShape \"cube\"\n");
    assert_int_equal(bis_flat_render(&p, DIR "/bad.txt", (const char *const[]){NULL}, NULL, SAY), BIS_INPUT);
    const char *line = strchr(say, '\n');
    assert_true(strncmp(say, DIR "/bad.txt:1", strlen(DIR "/bad.txt:1")) == 0);
    assert_non_null(line);
    assert_true(strncmp(line + 1, DIR "/bad.txt:3", strlen(DIR "/bad.txt:3")) == 0);
    assert_true(say[strlen(say) - 1] != '\n');
}

static void when_the_kth_allocation_fails_there_is_no_picture(void **state)
{
    const float grey[6] = {1, 1, 1, 1, 1, 1};
    bis_light *light;
    bool ended = false;

    assert_int_equal(bis_flat_light_make(&light, 2, 1, grey, "cdf", 0, NULL, SAY), 0);
    for (long k = 1; !ended; k++) {
        static const char *const settings[] = {"width=2", "height=2", "spp=1", "threads=1", "accelerator=grid",
            "layers=albedo", "camera=Camera \"orthographic\"", "text=WorldBegin Shape \"sphere\"", NULL};
        bis_flat_picture *p;
        bis_mem_fail_at(k);
        const int status = bis_flat_render_with(&p, SCENE, settings, light, NULL, NULL, NULL, SAY);
        ended = bis_mem_count() < k;
        bis_mem_fail_at(0);
        if (status != (ended ? BIS_OK : BIS_NOMEM)) fail_msg("allocation %ld: status %d, %s", k, status, say);
        assert_true(!p == !ended);
        bis_flat_picture_close(p);
    }
    const double one[3] = {1, 1, 1};
    bis_bsdf *b;
    bis_mem_fail_at(1);
    assert_int_equal(bis_flat_bsdf_open(&b, "phong", one, one, 1, one, one, SAY), BIS_NOMEM);
    assert_null(b);
    bis_mem_fail_at(1);
    assert_int_equal(bis_flat_bsdf_metal(&b, one, one, 1, one, one, SAY), BIS_NOMEM);
    bis_flat_light_close(light);
    bis_mem_fail_at(1);
    assert_int_equal(bis_flat_light_make(&light, 2, 1, grey, "cdf", 0, NULL, SAY), BIS_NOMEM);
    bis_mem_fail_at(0);
    assert_true(!b && !light);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_map_gives_directions_and_their_densities),
        cmocka_unit_test(a_black_map_has_no_directions),
        cmocka_unit_test(alias_tables_are_those_of_the_thesis),
        cmocka_unit_test(alias_tables_of_the_caller_are_checked),
        cmocka_unit_test(null_is_nothing_where_there_is_no_status),
        cmocka_unit_test(a_material_gives_f_and_density),
        cmocka_unit_test(a_picture_has_the_bits_of_the_program),
        cmocka_unit_test(a_metal_reflects_by_fresnels_equations),
        cmocka_unit_test(a_scene_is_text_and_a_camera_is_replaced),
        cmocka_unit_test(a_light_of_an_array_is_that_of_its_file),
        cmocka_unit_test(a_light_takes_the_place_of_all_lights_of_a_scene),
        cmocka_unit_test(layers_are_given_by_name),
        cmocka_unit_test(what_is_not_modelled_is_replaced_when_that_is_asked_for),
        cmocka_unit_test(a_watcher_hears_of_the_render),
        cmocka_unit_test(wrong_settings_are_refused),
        cmocka_unit_test(a_map_of_eight_pixels_by_hand),
        cmocka_unit_test(the_kind_of_a_table_is_the_one_asked_for),
        cmocka_unit_test(an_area_exponent_draws_large_regions_more_often),
        cmocka_unit_test(weights_of_a_table_are_checked_and_summed),
        cmocka_unit_test(each_channel_of_a_material_is_its_own),
        cmocka_unit_test(each_component_of_a_vector_is_its_own),
        cmocka_unit_test(materials_are_taken_up_to_their_limits),
        cmocka_unit_test(a_vector_may_have_any_length),
        cmocka_unit_test(the_version_is_the_headers),
        cmocka_unit_test(alpha_is_the_share_that_hits_a_surface),
        cmocka_unit_test(settings_have_their_limits),
        cmocka_unit_test(an_integrator_named_again_keeps_what_the_scene_says),
        cmocka_unit_test(each_message_has_a_line),
        cmocka_unit_test(when_the_kth_allocation_fails_there_is_no_picture),
    };

    return cmocka_run_group_tests_name("flat", tests, setup, NULL);
}
