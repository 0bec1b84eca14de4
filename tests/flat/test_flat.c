/* SPDX-License-Identifier: BSD-2-Clause */
/* flat: maps, materials and pictures on arrays. Expected values are closed forms, and pictures of the program. What
 * arrays of any size give, and what a NULL does, is in tests/python. Mean within 5 standard errors: 6e-7 a test, 2
 * tests. */
#include "flat_claims.h"

#include "bis/base/clock.h"
#include "bis/base/image.h"
#include "bis/base/mem.h"
#include "bis/base/version.h"
#include "bis/files/image_file.h"
#include "bis/scene/layers.h"
#include "bis/shape/accel.h"
#include "bis/thesis/rng.h"
#include "json_check.h"
#include "lack.h"
#include "program.h"
#include "threads.h"

#include <stdlib.h>

#define DIR "build/test_flat"
#define SCENE DIR "/scene.txt"
#define NAN_ ((double)NAN)

static int setup(void **state)
{
    program_folder(DIR);
    program_write_scene(DIR, "");
    return 0;
}

static void numbers(double *u, size_t n, uint64_t seed)
{
    bis_rng r;

    bis_rng_init(&r, seed, 0, 0, 0);
    for (size_t i = 0; i < n; i++) u[i] = bis_rng_double(&r);
}

/* ---- maps ---- */

/* The mean of Le/pdf is the integral. */
static void a_map_gives_directions_and_their_densities(void **state)
{
    enum { N = 100000 };
    static double u[N][4], pdf[N], again[N];
    static float w[N][3], L[N][3], seen[N][3];
    bis_light *light;
    int shape[2];
    double sum = 0, squares = 0;

    GIVES(light_open, &light, DIR "/map.pfm", "cdf", 0.15, NULL);
    bis_flat_light_shape(light, shape);
    assert_true(shape[0] == 8 && shape[1] == 4);
    numbers(u[0], 4 * N, 1);
    GIVES(light_sample, light, N, u[0], w[0], L[0], pdf);
    GIVES(light_look, light, N, w[0], seen[0], again);
    for (int i = 0; i < N; i++) {
        const double x = ((double)L[i][0] + (double)L[i][1] + (double)L[i][2]) / pdf[i];
        sum += x / N;
        squares += x * x / N;
    }
    const double error = sqrt((squares - sum * sum) / N);
    assert_true(fabs(sum - bis_flat_light_power(light)) <= 5 * error + 1e-9 * sum);
    assert_true(fabs(1.3 * sum - bis_flat_light_power(light)) > 5 * error); /* the twin */
    bis_flat_light_close(light);
    assert_int_equal(bis_flat_light_open(&light, DIR "/none.hdr", "cdf", 0, NULL, SAY), BIS_IO);
    assert_null(light);
    GIVES(light_open, &light, DIR "/map.pfm", "alias", 0, NULL);
    bis_flat_light_close(light);
    assert_int_equal(bis_flat_light_open(&light, DIR "/map.pfm", "alias", 0, NULL, NULL, 99), 0); /* nothing is said */
    bis_flat_light_close(light);
    bis_flat_light_close(NULL);
}

static void a_black_map_has_no_directions(void **state)
{
    bis_light *light;
    float w[3], L[3];
    double pdf;

    GIVES(light_make, &light, 2, 1, F(0, 0, 0, 0, 0, 0), "alias", 0.15, NULL);
    assert_true(bis_flat_light_power(light) == 0);
    NO("the map is black: it has no directions to draw", light_sample, light, 1, D(0, 0, 0, 0), w, L, &pdf);
    GIVES(light_sample, light, 0, NULL, w, L, &pdf);
    bis_flat_light_close(light);
}

/* 4 x 2 pixels, each of pi/2 sr; pixel i has the radiance (i+1) (1, 10, 100). */
static void a_map_of_eight_pixels_by_hand(void **state)
{
    static const float scale[3] = {1, 10, 100};
    float file[2][4][3], pixels[2][4][3], w[3][3], L[8][3];
    double pdf[8], u[32];
    int shape[2];
    bis_light *light;

    for (int i = 0; i < 24; i++) file[1 - i / 12][i / 3 % 4][i % 3] = (float)(i / 3 + 1) * scale[i % 3];
    write_pfm(DIR "/eight.pfm", 4, 2, file[0][0]);
    GIVES(light_open, &light, DIR "/eight.pfm", "alias", 0, NULL);
    assert_string_equal(say, "");
    bis_flat_light_shape(light, shape);
    assert_true(shape[0] == 4 && shape[1] == 2);
    bis_flat_light_pixels(light, pixels[0][0]);
    for (int y = 0; y < 2; y++) assert_memory_equal(pixels[y], file[1 - y], sizeof pixels[y]);
    assert_about(bis_flat_light_power(light), 36 * 111 * PI / 2, 1e-6);
    /* of any length: azimuths of 45, 135 and 225 degrees above, above and below */
    const float look[3][3] = {{1e30f, 1e30f, 1e30f}, {-1e-30f, 1e-30f, 1e-31f}, {-3, -3, -0.5f}};
    const int seen[3] = {0, 1, 6};
    GIVES(light_look, light, 3, look[0], L[0], pdf);
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) assert_true(L[i][k] == (float)(seen[i] + 1) * scale[k]);
        assert_about(pdf[i], (seen[i] + 1) / 36.0 / (PI / 2), 1e-6);
    }
    /* samples: what is stored of each is that of the pixel where the direction lies */
    for (int i = 0; i < 32; i++) u[i] = fmod(0.05 + 0.381966 * i, 1);
    for (int i = 0; i < 8; i += 2) {
        GIVES(light_sample, light, 2, u + 4 * i, w[0], L[0], pdf);
        for (int k = 0; k < 2; k++) {
            const double phi = atan2((double)w[k][1], (double)w[k][0]);
            const int pixel = (w[k][2] < 0 ? 4 : 0) + (int)floor((phi < 0 ? phi + 2 * PI : phi) / (PI / 2));
            for (int c = 0; c < 3; c++) assert_true(L[k][c] == (float)(pixel + 1) * scale[c]);
            assert_about(pdf[k], (pixel + 1) / 36.0 / (PI / 2), 1e-6);
        }
    }
    NO("direction 2 is (1, 1, inf): give finite", light_look, light, 3, F(1, 0, 0, 0, 1, 0, 1, 1, INFINITY), L[0], pdf);
    NO("direction 1 is (inf, 2, 3): give finite", light_look, light, 2, F(1, 0, 0, INFINITY, 2, 3), L[0], pdf);
    NO("direction 0", light_look, light, 1, F(0, NAN, 1), L[0], pdf);
    NO("direction 0", light_look, light, 1, F(0, 0, 0), L[0], pdf);
    NO("nan: give random numbers", light_sample, light, 1, D(0, 0, NAN_, 0), w[0], L[0], pdf);
    for (int i = 0; i < 12; i++) {
        double bad[12] = {0};
        char text[64];
        bad[i] = 1;
        snprintf(text, sizeof text, "u of sample %d is 1: give random numbers in [0, 1)", i / 4);
        NO(text, light_sample, light, 3, bad, w[0], L[0], pdf);
    }
    bis_flat_light_close(light);
    NO("no table \"walker\"", light_open, &light, DIR "/eight.pfm", "walker", 0, NULL);
    static const double bad[3] = {10.000001, (double)NAN, -1};
    static const char *const texts[3] = {"area_exponent is 10: give", "area_exponent is nan", "area_exponent is -1"};
    for (int i = 0; i < 3; i++) NO(texts[i], light_open, &light, DIR "/eight.pfm", "cdf", bad[i], NULL);
}

/* One bright pixel among dim ones is a region of its own of 0.0024 sr: an exponent of 2 divides its weight by the
 * square of 0.01 sr over that (thesis 3.4), and leaves the weight of the others. */
static void an_area_exponent_draws_large_regions_more_often(void **state)
{
    static float file[64 * 128 * 3];
    const float at_lamp[3] = {
        (float)cos(5.5 / 64 * PI), (float)sin(5.5 / 64 * PI), -0.01f}; /* column 5, the first row below */
    const double sr = 2 * PI / 128 * sin(PI / 64), rest = 3 * (4 * PI - sr);

    for (int i = 0; i < 64 * 128 * 3; i++) file[i] = i / 3 == 31 * 128 + 5 ? 1000 : 1;
    write_pfm(DIR "/lamp.pfm", 128, 64, file);
    for (int b = 0; b <= 10; b += b ? 8 : 2) {
        const double weight = 3000 * pow(sr / 0.01, b);
        float L[3];
        double pdf;
        bis_light *light;
        GIVES(light_open, &light, DIR "/lamp.pfm", b ? "cdf" : "alias", b, NULL);
        GIVES(light_look, light, 1, at_lamp, L, &pdf);
        bis_flat_light_close(light);
        assert_true(L[0] == 1000);
        assert_about(pdf, weight / (weight * sr + rest), 1e-4);
    }
}

static void compare_with_program(const bis_flat_picture *p, const char *options)
{
    bis_image image;
    program_run r;
    int shape[2];

    program_expect(&r, 0, SCENE " --outfile " DIR "/out.pfm %s", options);
    assert_int_equal(bis_image_read(&image, DIR "/out.pfm", (bis_loc){0}, NULL), BIS_OK);
    bis_flat_picture_shape(p, shape);
    assert_true(shape[0] == image.width && shape[1] == image.height);
    const size_t n = (size_t)shape[0] * (size_t)shape[1];
    float *rgba = test_malloc(n * 4 * sizeof *rgba);
    bis_flat_picture_pixels(p, rgba);
    for (size_t i = 0; i < n; i++) assert_memory_equal(rgba + 4 * i, &image.pixels[i], sizeof image.pixels[i]);
    test_free(rgba);
    bis_image_clear(&image);
}

/* A map from an array is that map from its file, and over a scene it is --light. */
static void a_light_of_an_array_is_that_of_its_file(void **state)
{
    bis_light *made, *read;
    bis_image image;
    bis_flat_picture *p;
    float w[40][3], L[2][40][3];
    double u[40][4], pdf[2][40];

    assert_int_equal(bis_image_read(&image, DIR "/map.pfm", (bis_loc){0}, NULL), BIS_OK);
    image.pixels[3] = (rgb){5, 6, 7};
    assert_int_equal(bis_image_save(&image, DIR "/other.pfm", NULL), BIS_OK);
    GIVES(light_make, &made, image.width, image.height, &image.pixels[0].r, "cdf", 0.5, NULL);
    GIVES(light_open, &read, DIR "/other.pfm", "cdf", 0.5, "latlong");
    bis_image_clear(&image);
    numbers(u[0], 160, 2);
    GIVES(light_sample, made, 40, u[0], w[0], L[0][0], pdf[0]);
    GIVES(light_sample, read, 40, u[0], w[0], L[1][0], pdf[1]);
    assert_memory_equal(L[0], L[1], sizeof L[0]);
    assert_memory_equal(pdf[0], pdf[1], sizeof pdf[0]);
    GIVES(render_with, &p, SCENE, NONE, made, NULL, NULL, NULL);
    compare_with_program(p, "--light " DIR "/other.pfm");
    bis_flat_picture_close(p);
    bis_flat_light_close(made);
    bis_flat_light_close(read);
    /* what no map can be */
    const struct { int width, height; const char *mapping, *text; } bad[] = {
        {0, 2, NULL, "0 x 2"}, {40000, 1, NULL, "40000 x 1"}, {2, 2, NULL, "\"the array\" is square"},
        {2, 1, "cube", "no mapping \"cube\""}, {2, 1, "equalarea", "must be"}};
    const float grey[12] = {0}, holes[6] = {1, NAN, 1, -1, 1, HUGE_VALF};
    for (size_t i = 0; i < N_OF(bad); i++)
        NO(bad[i].text, light_make, &made, bad[i].width, bad[i].height, grey, "cdf", 0, bad[i].mapping);
    assert_null(made);
    GIVES(light_make, &made, 2, 1, holes, "cdf", 0, NULL);
    assert_non_null(strstr(say, "bad channel values set to 0: 1 NaN, 1 infinite, 1 negative"));
    bis_flat_light_close(made);
}

/* ---- materials ---- */

static const double up[3] = {0, 0, 2}, half[3] = {0.5, 0.5, 0.5}, black[3] = {0, 0, 0}, one[3] = {1, 0, 0};

static void a_material_gives_f_and_density(void **state)
{
    bis_bsdf *b;
    float wi[2][3] = {{0, 0, 5}, {0, 0, -1}}, f[2][3];
    double pdf[2];
    uint8_t lobe[2];

    /* in the mirror direction: Ks (n+1)/(2 pi) + Kd/pi; a density of half lobe, half cosine */
    GIVES(bsdf_open, &b, "phong", half, half, 9, up, up);
    GIVES(bsdf_look, b, 2, wi[0], f[0], pdf);
    assert_true(fabs((double)f[0][1] - (0.5 * 10 / (2 * PI) + 0.5 / PI)) < 1e-6 && f[1][1] == 0);
    GIVES(bsdf_sample, b, 2, D(0, 0.5, 0.5, 0.999, 0.5, 0.5), wi[0], lobe);
    assert_true(lobe[0] == 1 && lobe[1] == 0);
    GIVES(bsdf_sample, b, 2, D(0.499, 0, 0, 0.5, 0, 0), wi[0], lobe); /* up to 1/2, the lobe */
    assert_true(lobe[0] == 1 && lobe[1] == 0);
    for (int i = 0; i < 6; i++) {
        double bad[6] = {0};
        char text[64];
        bad[i] = i % 2 ? 1 : -0.5;
        snprintf(text, sizeof text, "u of sample %d is %g", i / 3, bad[i]);
        NO(text, bsdf_sample, b, 2, bad, wi[0], lobe);
    }
    NO("direction 1 is (0, nan, 0)", bsdf_look, b, 2, F(1, 2, 2, 0, NAN, 0), f[0], pdf);
    bis_flat_bsdf_close(b);
    GIVES(bsdf_open, &b, "microfacet", black, black, 0.5, up, up);
    NO("black", bsdf_sample, b, 1, D(0, 0, 0), wi[0], lobe);
    bis_flat_bsdf_close(b);
    bis_flat_bsdf_close(NULL);
}

/* Head on, a metal is the facets of that reflectance; in the mirror direction of 60 degrees, the ratio to them is
 * Fresnel's reflectance over Schlick's. With k = 0 these are the equations of glass, as in textbooks. */
static void a_metal_reflects_by_fresnels_equations(void **state)
{
    const double aside[3] = {sqrt(0.75), 0, 0.5}, eta[3] = {1.5, 2, 0.2}, k[3] = {0, 0, 3};
    const double Ks[3] = {0.04, 1.0 / 9, (0.64 + 9) / (1.44 + 9)};
    float mirror[2][3] = {{0, 0, 1}, {(float)-sqrt(0.75), 0, 0.5F}}, f[2][3];
    double pdf;
    bis_bsdf *metal, *facets;

    for (int oblique = 0; oblique < 2; oblique++) {
        const double *wo = oblique ? aside : up;
        GIVES(bsdf_metal, &metal, eta, k, 0.5, up, wo);
        GIVES(bsdf_open, &facets, "microfacet", black, Ks, 0.5, up, wo);
        GIVES(bsdf_look, metal, 1, mirror[oblique], f[0], &pdf);
        GIVES(bsdf_look, facets, 1, mirror[oblique], f[1], &pdf);
        for (int i = 0; i < (oblique ? 2 : 3); i++) {
            const double c = 0.5, ct = sqrt(1 - 0.75 / (eta[i] * eta[i]));
            const double rs = (c - eta[i] * ct) / (c + eta[i] * ct), rp = (eta[i] * c - ct) / (eta[i] * c + ct);
            const double schlick = Ks[i] + (1 - Ks[i]) * pow(0.5, 5), fresnel = (rs * rs + rp * rp) / 2;
            assert_about((double)f[0][i] / (double)f[1][i], oblique ? fresnel / schlick : 1, 1e-5);
        }
        bis_flat_bsdf_close(metal);
        bis_flat_bsdf_close(facets);
    }
    const struct { double eta[3], k[3]; const char *text; } bad[] = {
        {{0, 0, 0}, {0, 0, 3}, "eta and k of channel 0 are 0 and 0"},
        {{1, 1, NAN_}, {0, 0, 3}, "eta and k of channel 2 are nan and 3"},
        {{1.5, 2, 0.2}, {1, 1, NAN_}, "eta and k of channel 2 are 0.2 and nan"},
        {{1, 1, 2e15}, {0, 0, 3}, "eta and k of channel 2"},
        {{1.5, 2, 0.2}, {0, -1, 0}, "eta and k of channel 1 are 2 and -1"},
        {{1.5, 2, 0.2}, {0, 0, 2e15}, "channel 2 are 0.2 and 2e+15: give eta in (0, 1e+15] and k in [0, 1e+15]"}};
    for (size_t i = 0; i < N_OF(bad); i++) NO(bad[i].text, bsdf_metal, &metal, bad[i].eta, bad[i].k, 0.5, up, up);
    NO("the roughness is 0.001", bsdf_metal, &metal, eta, k, 0.001, up, up);
    NO("normal is (0, 0, 0)", bsdf_metal, &metal, eta, k, 0.5, black, up);
    assert_null(metal);
    GIVES(bsdf_metal, &metal, D(1e15, 1e-300, 1), D(1e15, 0, 1e15), 1, up, up);
    bis_flat_bsdf_close(metal);
}

static const double Kd[3] = {0.1, 0.2, 0.4}, Ks[3] = {0.5, 0.25, 0.125};

/* Phong: the lobe's value in the mirror direction is Ks (n+1)/(2 pi), the thesis's normalization, and every channel has
 * its own Kd and Ks. The normal is (1, 2, 2)/3; seen along it, so is the mirror direction; perpendicular to the normal
 * nothing is seen. 60 degrees off, the lobe is 2^-n of its peak. */
static void each_channel_of_a_material_is_its_own(void **state)
{
    const double n[3] = {2, 4, 4}, wo[3] = {0.5, 1, 1}, z[3] = {0, 0, 3}, x3z4[3] = {30, 0, 40};
    float wi[3][3] = {{1, 2, 2}, {0, 0, 0}, {-1, -2, -2}}, f[3][3];
    uint8_t lobe[2];
    double pdf[3];
    bis_bsdf *b;

    /* a vector across the normal, (2, -2, 1)/3, for the direction at 60 degrees */
    for (int k = 0; k < 3; k++) wi[1][k] = (float)((n[k] / 6 + sqrt(3) * D(2, -2, 1)[k] / 3) * 7);
    GIVES(bsdf_open, &b, "phong", Kd, Ks, 5, n, wo);
    assert_string_equal(say, "");
    GIVES(bsdf_look, b, 3, wi[0], f[0], pdf);
    for (int k = 0; k < 3; k++) {
        assert_about((double)f[0][k], Kd[k] / PI + Ks[k] * 6 / (2 * PI), 1e-6);
        assert_about((double)f[1][k], Kd[k] / PI + Ks[k] * 6 / (2 * PI) / 32, 1e-5);
        assert_true(f[2][k] == 0);
    }
    assert_true(pdf[0] > pdf[1] && pdf[1] > 0);
    bis_flat_bsdf_close(b);
    /* a sharp lobe from (3, 0, 4)/5 about z goes to (-3, 0, 4)/5; a second sample of the base lies above */
    GIVES(bsdf_open, &b, "phong", Kd, Ks, 1e10, z, x3z4);
    GIVES(bsdf_sample, b, 2, D(0, 0.5, 0.25, 0.9999, 0.25, 0.5), wi[0], lobe);
    assert_true(lobe[0] == 1 && lobe[1] == 0);
    for (int k = 0; k < 3; k++) assert_about((double)wi[0][k], D(-0.6, 0, 0.8)[k], 1e-3);
    assert_true(wi[1][2] > 0 && fabs((double)(wi[1][0] + 0.6f)) > 1e-2);
    bis_flat_bsdf_close(b);
    /* GGX of roughness 0.5 has alpha 0.25; head on D = 1/(pi alpha^2), f = Ks D/4 + 28/(23 pi) Kd (1 - Ks) (31/32)^2 */
    GIVES(bsdf_open, &b, "microfacet", Kd, Ks, 0.5, n, n);
    GIVES(bsdf_look, b, 1, F(1, 2, 2), f[0], pdf);
    for (int k = 0; k < 3; k++)
        assert_about((double)f[0][k],
            Ks[k] * 16 / (4 * PI) + 28 / (23 * PI) * Kd[k] * (1 - Ks[k]) * (31.0 / 32) * (31.0 / 32), 1e-5);
    bis_flat_bsdf_close(b);
}

/* Vectors of which no two components are equal: (2, 3, 6)/7 mirrors (6, -2, 3)/7 to (-198, 242, 141)/343, where a sharp
 * lobe has its peak. What is drawn from it is what the library draws from the same three numbers. */
static void each_component_of_a_vector_is_its_own(void **state)
{
    const double n[3] = {4, 6, 12}, wo[3] = {3, -1, 1.5}, u[6] = {0.3, 0.9, 0.2, 0.95, 0.1, 0.7};
    float f[3], wi[2][3];
    double pdf;
    uint8_t lobe[2];
    bis_bsdf *b;

    GIVES(bsdf_open, &b, "phong", Kd, Ks, 10000, n, wo);
    GIVES(bsdf_look, b, 1, F(-198, 242, 141), f, &pdf);
    for (int k = 0; k < 3; k++) assert_about((double)f[k], Kd[k] / PI + Ks[k] * 10001 / (2 * PI), 1);
    GIVES(bsdf_sample, b, 2, u, wi[0], lobe);
    for (int i = 0; i < 2; i++) {
        vec3 w;
        assert_true(bis_bsdf_sample(b, u[3 * i], u[3 * i + 1], u[3 * i + 2], &w));
        assert_true(wi[i][0] == w.x && wi[i][1] == w.y && wi[i][2] == w.z && lobe[i] == !i);
    }
    bis_flat_bsdf_close(b);
}

static void materials_are_taken_up_to_their_limits(void **state)
{
    const struct { const char *model; double width; const char *text; } rows[] = {
        {"phong", 0, NULL}, {"microfacet", 1, NULL}, {"microfacet", 0.01, NULL},
        {"glass", 1, "no model \"glass\""}, {"phong", -1, "the exponent is -1"},
        {"phong", HUGE_VAL, "the exponent is inf: give a number in [0, 3.4e38]"},
        {"microfacet", NAN_, "the roughness is nan"},
        {"microfacet", 1.001, "the roughness is 1.001: give a number in [0.01, 1]"},
        {"microfacet", 0.0099, "the roughness is 0.0099: give a number in [0.01, 1]"}};
    bis_bsdf *b;

    for (size_t i = 0; i < N_OF(rows); i++) {
        if (rows[i].text) NO(rows[i].text, bsdf_open, &b, rows[i].model, one, one, rows[i].width, up, up);
        else GIVES(bsdf_open, &b, rows[i].model, one, D(0, 0, 1), rows[i].width, up, up);
        bis_flat_bsdf_close(b);
    }
    for (int k = 0; k < 12; k++) {
        const double bad = D(1.5, -0.5, NAN_, HUGE_VAL)[k / 3];
        const char *const name = k < 3 ? "Kd" : k < 6 ? "Ks" : k < 9 ? "wo" : "normal";
        double c[3] = {0.25, 0.5, 0.75};
        char text[128];
        c[k % 3] = bad;
        snprintf(text, sizeof text, "%s is (%g, %g, %g): give %s", name, c[0], c[1], c[2],
            k < 6 ? "numbers in [0, 1]" : "a finite vector that is not 0");
        NO(text, bsdf_open, &b, "phong", k < 3 ? c : Kd, *name == 'K' && k >= 3 ? c : Ks, 1, k >= 9 ? c : up,
            *name == 'w' ? c : up);
    }
    NO("normal is (0, 0, 0)", bsdf_open, &b, "phong", half, half, 1, black, up);
    assert_null(b);
}

/* Of a vector of any length the direction counts, also where its square would be 0 or infinite. */
static void a_vector_may_have_any_length(void **state)
{
    static const double lengths[] = {1, 1e200, 1e-200, 5e-320, 1.7e308};

    for (size_t i = 0; i < N_OF(lengths); i++) {
        const double l = lengths[i];
        bis_bsdf *b;
        float f[3];
        double pdf;
        GIVES(bsdf_open, &b, "phong", Kd, Ks, 20, D(0, 0, l), D(0, l, l));
        GIVES(bsdf_look, b, 1, F(0.1f, 0.2f, 0.9f), f, &pdf);
        /* thesis eq. 2.12: wo at 45 degrees, mirrored at the normal, is (0, -1, 1) / sqrt 2 */
        const double cos_alpha = 0.7 / sqrt(0.86) / sqrt(2);
        for (int c = 0; c < 3; c++)
            assert_about((double)f[c], Kd[c] / PI + Ks[c] * 22 / (2 * PI) * pow(cos_alpha, 20), 1e-6);
        bis_flat_bsdf_close(b);
    }
}

/* ---- pictures ---- */

/* What no pixel shows. */
static void assert_stats_have(const char *stats, const char *const *settings)
{
    static const char *const names[] = {"threads", "accelerator"};
    char value[64], expected[64];

    for (int k = 0; k < 2; k++) {
        const char *const text = json_value(value, sizeof value, stats, names[k]);
        if (k == 0 && threads_of(2) == 1) assert_string_equal(text, "1");
        for (int i = 0; settings[i] && (k > 0 || threads_of(2) == 2); i++) {
            snprintf(expected, sizeof expected, "%s=%.*s", names[k], (int)strcspn(text + k, "\""), text + k);
            if (strncmp(settings[i], names[k], strlen(names[k])) == 0) assert_string_equal(settings[i], expected);
        }
    }
}

/* The whole is more than its parts, and no more than the call took. */
static void assert_seconds(const char *stats, double took)
{
    static const char *const parts[] = {
        "seconds.parse", "seconds.load", "seconds.envmap", "seconds.accel", "seconds.render"};
    double rest = json_number(stats, "seconds.total");

    assert_true(rest < 1.00001 * took + 1e-6);
    for (size_t i = 0; i < N_OF(parts); i++) {
        assert_true(json_number(stats, parts[i]) > 0);
        rest -= json_number(stats, parts[i]);
    }
    assert_true(rest > -1e-6); /* rounding */
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
    char value[64];

    for (size_t k = 0; k < N_OF(cases); k++) {
        bis_flat_picture *p;
        const double begin = bis_clock_now();
        GIVES(render, &p, SCENE, cases[k].settings, NULL);
        const double took = bis_clock_now() - begin;
        const char *stats = bis_flat_picture_stats(p);
        compare_with_program(p, cases[k].options);
        assert_true(json_is_valid(stats));
        assert_string_equal(json_value(value, sizeof value, stats, "integrator"), cases[k].integrator);
        assert_stats_have(stats, cases[k].settings);
        assert_seconds(stats, took);
        bis_flat_picture_close(p);
    }
    /* a scene's own integrator keeps its parameters when it is named again, and a switched erratum stays */
    static const char *const integrators[] = {"sir", "em", "mis"};
    program_write_scene(DIR, "Option \"string asprinted\" \"E3\"\n");
    for (int k = 0; k < 3; k++) {
        bis_flat_picture *p;
        char setting[32], option[32];
        snprintf(setting, sizeof setting, "integrator=%s", integrators[k]);
        snprintf(option, sizeof option, "--integrator %s", integrators[k]);
        GIVES(render, &p, SCENE, LIST(setting), NULL);
        compare_with_program(p, option);
        bis_flat_picture_close(p);
    }
    program_write_scene(DIR, "");
}

static float *pixels_of(const char *scene, const char *const *settings, const bis_light *light, size_t wanted)
{
    bis_flat_picture *p;
    int shape[2];
    float *rgba = test_malloc(wanted * sizeof *rgba);

    GIVES(render_with, &p, scene, settings, light, NULL, NULL, NULL);
    bis_flat_picture_shape(p, shape);
    assert_int_equal(4 * shape[0] * shape[1], wanted);
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
#define TEXT "text=" FILM "Camera \"orthographic\"" WORLD
    enum { N = 4 * 12 * 9 };
    static const char *const settings[3][6] = {
        {TEXT, "camera=" CAMERA, NULL}, /* the last one wins */
        {"text=nonsense", "approximate=x", TEXT, "approximate=false", "camera=" CAMERA, NULL}, {TEXT, NULL}};

    program_write_file(DIR "/whole.txt", FILM CAMERA WORLD);
    float *expected = pixels_of(DIR "/whole.txt", NONE, NULL, N);
    for (int k = 0; k < 3; k++) { /* the third is the twin */
        float *got = pixels_of(DIR "/a scene", settings[k], NULL, N);
        assert_true((memcmp(got, expected, N * sizeof *got) == 0) == (k < 2));
        test_free(got);
    }
    test_free(expected);
}

/* Lights that a scene may not have are no matter under another light; without one, they are refused. A square lat-long
 * map is one, each row of which is half of the sphere: upright, bright above and black below. */
static void a_light_takes_the_place_of_all_lights_of_a_scene(void **state)
{
    static const char *const settings[] = {
        "text=Film \"rgb\" \"integer xresolution\" 2 \"integer yresolution\" 2 LookAt 0 -4 2 0 0 0 0 0 1 Camera "
        "\"perspective\" \"float fov\" 9 WorldBegin LightSource \"point\" LightSource \"infinite\" \"string "
        "filename\" \"gone.exr\" Material \"diffuse\" \"rgb reflectance\" [0.5 0.25 0.125] Shape \"disk\" \"float "
        "radius\" 9", "integrator=brdf", "spp=4", NULL};
    bis_light *light;
    bis_flat_picture *p;

    GIVES(light_make, &light, 2, 2, F(1, 2, 3, 1, 2, 3, 0, 0, 0, 0, 0, 0), "cdf", 0, "latlong");
    float *rgba = pixels_of("scene", settings, light, 16);
    for (int i = 0; i < 16; i++) /* Kd times the radiance from above */
        assert_about((double)rgba[i], D(0.5, 0.5, 0.375, 1)[i % 4], 1e-6);
    test_free(rgba);
    bis_flat_light_close(light);
    NO("LightSource", render, &p, "scene", settings, NULL);
    assert_null(p);
}

/* The floor of the scene is the plane y = -1 and its camera looks along z: where the floor is seen (and no sphere above
 * it), normal and albedo are known, and 1/depth is linear in the row. The layers of the film itself have tests of their
 * own. */
static void layers_are_given_by_name(void **state)
{
    static float albedo[16][24][3], normal[16][24][3], depth[16][24], samples[16][24];
    bis_flat_picture *p;

    GIVES(render, &p, SCENE, LIST("layers=albedo,depth,normal,samples,stderr", "spp=8"), NULL);
    const struct { const char *name; float *values; int n; } layers[] = {
        {"albedo", albedo[0][0], 3}, {"normal", normal[0][0], 3}, {"depth", depth[0], 1}, {"samples", samples[0], 1},
        {"stderr", NULL, 3}, {"visibility", depth[0], 0}, {"Albedo", depth[0], 0}, {NULL, depth[0], 0}};
    for (size_t i = 0; i < N_OF(layers); i++)
        assert_int_equal(bis_flat_picture_layer(p, layers[i].name, layers[i].values), layers[i].n);
    assert_string_equal(bis_flat_layer_name(0), "stderr");
    assert_string_equal(bis_flat_layer_name(BIS_N_LAYERS - 1), "depth");
    assert_true(!bis_flat_layer_name(-1) && !bis_flat_layer_name(BIS_N_LAYERS));
    for (int x = 0; x < 24; x++) {
        for (int k = 0; k < 3; k++) {
            assert_about((double)albedo[15][x][k], D(0.7, 0.6, 0.5)[k], 1e-6);
            assert_about((double)normal[15][x][k], k == 1, 1e-6);
            assert_true(albedo[0][x][k] == 0); /* the sky */
        }
        /* the last row of 16 is seen between the tangents 14/16 and 1 of 30 degrees */
        const double t = tan(30 * PI / 180);
        assert_true((double)depth[15][x] > 1 / t && (double)depth[15][x] < 16 / (14 * t));
        assert_true(samples[15][x] >= 8);
    }
    bis_flat_picture_close(p);
    GIVES(render, &p, SCENE, LIST("layers=stderr", "spp=1"), NULL);
    assert_int_equal(bis_flat_picture_layer(p, "stderr", NULL), 0); /* one pass has no scatter */
    bis_flat_picture_close(p);
}

static void what_is_not_modelled_is_replaced_when_that_is_asked_for(void **state)
{
#define GLASS "text=WorldBegin LightSource \"infinite\" Material \"dielectric\" Shape \"sphere\""
    bis_flat_picture *p;

    NO("scene:1:44: error: Material \"dielectric\"", render, &p, "scene", LIST(GLASS, "spp=1"), NULL);
    GIVES(render, &p, "scene", LIST(GLASS, "width=4", "height=3", "approximate=true"), NULL);
    assert_non_null(strstr(say, "dielectric"));
    bis_flat_picture_close(p);
}

/* A wall that fills the upper half of the picture: there alpha is 1, below it is 0 and the constant light is seen. The
 * middle line lies between two pixels. */
static void alpha_is_the_share_that_hits_a_surface(void **state)
{
    static const char wall[] = "text=Film \"rgb\" \"integer xresolution\" 4 \"integer yresolution\" 6\n"
        "Camera \"perspective\" \"float fov\" 60\n"
        "WorldBegin LightSource \"infinite\" \"rgb L\" [0.25 0.5 2] Material \"diffuse\" \"rgb reflectance\" [0 0 0]\n"
        "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point3 P\" [-99 0 5  99 0 5  99 99 5  -99 99 5]\n";
    float *rgba = pixels_of("scene", LIST(wall, "spp=1"), NULL, 4 * 4 * 6);

    for (int i = 0; i < 4 * 4 * 6; i++) {
        const bool above = i / 16 < 3;
        assert_about((double)rgba[i], i % 4 == 3 ? above : above ? 0 : D(0.25, 0.5, 2)[i % 4], 1e-6);
    }
    test_free(rgba);
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

    GIVES(render_with, &p, SCENE, LIST("seconds=0.25"), NULL, look_on, &w, NULL);
    assert_true(w.n > 0 && !w.falls && w.share > 0);
    bis_flat_picture_close(p);
}

/* No time is tested, only that there is one: no pass takes longer than all of the call. */
static void a_pass_takes_a_part_of_the_time(void **state)
{
    bis_flat_picture *p;
    const double before = bis_clock_now();

    GIVES(render, &p, SCENE, LIST("integrator=em", "spp=4"), NULL);
    const double all = bis_clock_now() - before, pass = bis_flat_picture_pass_seconds(p);
    assert_true(pass > 0 && pass <= all && isnan(bis_flat_picture_pass_seconds(NULL)));
    bis_flat_picture_close(p);
}

/* ---- settings ---- */

static void wrong_settings_are_refused(void **state)
{
#define WHOLE(name, text, range) {name "=" text, name " is \"" text "\": give an integer in " range}
#define REAL(name, text, range) {name "=" text, name " is \"" text "\": give a number in " range}
#define BOOL(name, text) {name "=" text, name " is \"" text "\": give true or false"}
    const struct {
        const char *setting, *text;
    } cases[] = {
        WHOLE("spp", "0", "[1, 4294967295]"), WHOLE("spp", "1.5", "[1, "), WHOLE("spp", "4294967296", "[1, "),
        WHOLE("threads", "0", "[1, 1024]"), WHOLE("threads", "1025", "[1, 1024]"), WHOLE("threads", "2.5", "[1, 1024]"),
        REAL("seconds", "nan", "(0, 100000000]"), REAL("seconds", "-1", "(0, 100000000]"),
        REAL("seconds", "0", "(0, 100000000]"), REAL("seconds", "1.1e9", "(0, 100000000]"),
        REAL("error", "-0.1", "(0, 10]"), REAL("error", "0", "(0, 10]"), REAL("error", "11", "(0, 10]"),
        WHOLE("width", "0", "[1, 32768]"), WHOLE("width", "32769", "[1, 32768]"), WHOLE("height", "0", "[1, 32768]"),
        WHOLE("height", "32769", "[1, 32768]"), WHOLE("height", "1.5", "[1, 32768]"),
        WHOLE("seed", "9007199254740992", "[0, 9007199254740991]"),
        WHOLE("seed", "9007199254740993", "[0, 9007199254740991]"), /* no double: read as 2^53 */
        WHOLE("seed", "-1", "[0, "), WHOLE("seed", "1.5", "[0, "), WHOLE("seed", "", "[0, "),
        WHOLE("seed", "7x", "[0, "), WHOLE("candidates", "1.5", "[0, 4294967295]"),
        WHOLE("candidates", "4294967296", "[0, 4294967295]"), WHOLE("candidates", "1e99", "[0, "),
        BOOL("learn", "yes"), BOOL("learn", ""), BOOL("learn", "truely"),
        BOOL("approximate", ""), BOOL("approximate", "tru"), BOOL("approximate", "1"),
        {"spp", "\"spp\" is no setting"}, {"", "\"\" is no setting: give name=value"},
        {"integrator=si", "no integrator \"si\""},
        {"samples=3", "integrator \"sir\" has no parameter \"samples\""},
        {"=1", "integrator \"sir\" has no parameter \"\"; `bis help integrators` lists what each reads"},
        {"proposal=best", "proposal is \"best\": integrator \"sir\" takes \"em\", \"brdf\", \"mix\" or \"product\""},
        {"proposal=choose", "proposal is \"choose\": integrator \"sir\" takes \"em\""}, /* rejection's */
        {"abcdefghijklmnopqrstuvwxyz-abcdefghijklmnopqrstuvwxyz-abcdefghi=1", /* a name of 63 letters, and 64 */
         "integrator \"sir\" has no parameter \"abcdefghijklmnopqrstuvwxyz-abcdefghijklm\"; `bis help"},
        {"abcdefghijklmnopqrstuvwxyz-abcdefghijklmnopqrstuvwxyz-abcdefghij=1", "\" is no setting: give name=value"},
        {"accelerator=bvh", bis_accel_embree_version() ? "\"bvh\" is not there: give \"grid\" or \"embree\""
                                                       : "\"bvh\" is not there: give \"grid\""},
        {"crop=0.5,0.25,0,1", "crop is \"0.5,0.25,0,1\": give x0,x1,y0,y1 in [0, 1]"},
        {"crop=0,1,0", "crop is \"0,1,0\""}, {"crop=0,1,0,nan", "crop is"},
        {"layers=deth", "layers: there is no layer \"deth\" (did you mean \"depth\"?)"},
        {"camera=Camera \"fisheye\"", "camera:1:8: error"}, {"camera=Shape \"sphere\"", "camera:1:1: error"},
        {"text=WorldBegin Shape \"cube\"", DIR "/scene.txt:1:18: error"},
    };
    static const char *const split[] = {"split=1.5", "split=-0.5", "split=0.5x"};
    bis_flat_picture *p;

    for (size_t k = 0; k < N_OF(cases); k++) NO(cases[k].text, render, &p, SCENE, LIST(cases[k].setting), NULL);
    for (size_t i = 0; i < 3; i++) {
        NO(split[i] + 6, render, &p, SCENE, LIST(split[i], "integrator=mis"), NULL);
        assert_non_null(strstr(say, "give a number in [0, 1]"));
    }
    assert_null(p);
}

/* A render that is to stop at once accepts its settings first. */
static void settings_reach_to_their_limits(void **state)
{
    static const char *const good[] = {"spp=1", "spp=4294967295", "threads=1", "threads=3", "seconds=1e-9",
        "seconds=1e8", "error=1e-9", "error=10", "width=1", "width=32768", "height=1", "height=32768", "seed=0",
        "seed=9007199254740991", "integrator=em", "candidates=1", "accelerator=grid"};
    bis_flat_picture *p;

    for (size_t i = 0; i < N_OF(good); i++) /* small, unless it is the size that is asked for */
        NO("the render was stopped before its first pass was complete", render, &p, SCENE,
            LIST("width=2", "height=1", good[i]), &(sig_atomic_t){1});
    assert_null(p);
    assert_int_equal(bis_flat_render(&p, SCENE, LIST("accelerator=embree", "spp=1"), NULL, SAY),
        bis_accel_embree_version() ? BIS_OK : BIS_INPUT);
    if (p) assert_stats_have(bis_flat_picture_stats(p), LIST("accelerator=embree"));
    bis_flat_picture_close(p);
}

/* Two mistakes are two lines. A buffer that is too small is filled and ended, one of no bytes is left alone, and what
 * did not fit can be asked for. */
static void each_message_has_a_line(void **state)
{
    char small[8], all[400];
    bis_flat_picture *p;

    program_write_file(DIR "/bad.txt", "Film \"rgb\" \"integer xresolution\" 0\nWorldBegin\nShape \"cube\"\n");
    NO(DIR "/bad.txt:1", render, &p, DIR "/bad.txt", NONE, NULL);
    const char *line = strchr(say, '\n');
    assert_non_null(line);
    assert_true(strncmp(line + 1, DIR "/bad.txt:3", strlen(DIR "/bad.txt:3")) == 0);
    assert_true(say[strlen(say) - 1] != '\n' && bis_flat_said(NULL, 0) == 0);
    assert_int_equal(bis_flat_render(&p, DIR "/bad.txt", NONE, NULL, small, sizeof small), BIS_INPUT);
    assert_int_equal(strlen(small), 7);
    assert_int_equal(bis_flat_said(NULL, 0), strlen(say) + 1);
    assert_int_equal(bis_flat_said(all, sizeof all), strlen(say) + 1);
    assert_string_equal(all, say);
    assert_int_equal(bis_flat_said(all, sizeof all), 0);
    assert_int_equal(bis_flat_render(&p, DIR "/none.txt", NONE, NULL, NULL, 0), BIS_IO);
    assert_string_equal(bis_flat_version(), BIS_VERSION);
}

/* What a NULL is where there is no status; tests/python/test_null.py hides each pointer of each function. */
static void null_is_nothing_where_there_is_no_status(void **state)
{
    int shape[2] = {7, 7};
    float v[3];

    bis_flat_light_shape(NULL, shape);
    assert_true(shape[0] == 0 && shape[1] == 0);
    shape[0] = shape[1] = 7;
    bis_flat_picture_shape(NULL, shape);
    assert_true(shape[0] == 0 && shape[1] == 0);
    assert_true(isnan(bis_flat_light_power(NULL)));
    assert_null(bis_flat_picture_stats(NULL));
    assert_int_equal(bis_flat_picture_layer(NULL, "depth", v), 0);
    bis_light *light;
    NO("path is NULL: give what was opened, or an array", light_open, &light, NULL, "cdf", 0, NULL);
    assert_null(light);
}

/* What is opened without memory is none. */
static void when_the_kth_allocation_fails_nothing_is_opened(void **state)
{
    bis_light *light = NULL;
    bis_bsdf *b = NULL;
    bis_flat_picture *p = NULL;
    static const char *const settings[] = {"width=2", "height=2", "spp=1", "threads=1", "accelerator=grid",
        "layers=albedo", "camera=Camera \"orthographic\"", "text=WorldBegin Shape \"sphere\"", NULL};

    FOR_LACK(l) {
        LACK(l, (bis_status)bis_flat_light_make(&light, 2, 1, F(1, 1, 1, 1, 1, 1), "cdf", 0, NULL, SAY));
        assert_true((l.status == BIS_OK) == (light != NULL));
    }
    FOR_LACK(l) {
        LACK(l, (bis_status)bis_flat_render_with(&p, SCENE, settings, light, NULL, NULL, NULL, SAY));
        assert_true((l.status == BIS_OK) == l.over && (l.status == BIS_OK) == (p != NULL));
        bis_flat_picture_close(p);
    }
    for (int metal = 0; metal < 2; metal++) {
        FOR_LACK(l) {
            LACK(l, (bis_status)(metal ? bis_flat_bsdf_metal(&b, D(1, 1, 1), black, 1, up, up, SAY)
                                       : bis_flat_bsdf_open(&b, "phong", one, one, 1, up, up, SAY)));
            assert_true((l.status == BIS_OK) == l.over && (l.status == BIS_OK) == (b != NULL));
            bis_flat_bsdf_close(b);
        }
    }
    bis_flat_light_close(light);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_map_gives_directions_and_their_densities),
        cmocka_unit_test(a_black_map_has_no_directions),
        cmocka_unit_test(a_map_of_eight_pixels_by_hand),
        cmocka_unit_test(an_area_exponent_draws_large_regions_more_often),
        cmocka_unit_test(a_light_of_an_array_is_that_of_its_file),
        cmocka_unit_test(a_material_gives_f_and_density),
        cmocka_unit_test(a_metal_reflects_by_fresnels_equations),
        cmocka_unit_test(each_channel_of_a_material_is_its_own),
        cmocka_unit_test(each_component_of_a_vector_is_its_own),
        cmocka_unit_test(materials_are_taken_up_to_their_limits),
        cmocka_unit_test(a_vector_may_have_any_length),
        cmocka_unit_test(a_picture_has_the_bits_of_the_program),
        cmocka_unit_test(a_scene_is_text_and_a_camera_is_replaced),
        cmocka_unit_test(a_light_takes_the_place_of_all_lights_of_a_scene),
        cmocka_unit_test(layers_are_given_by_name),
        cmocka_unit_test(what_is_not_modelled_is_replaced_when_that_is_asked_for),
        cmocka_unit_test(alpha_is_the_share_that_hits_a_surface),
        cmocka_unit_test(a_watcher_hears_of_the_render),
        cmocka_unit_test(a_pass_takes_a_part_of_the_time),
        cmocka_unit_test(wrong_settings_are_refused),
        cmocka_unit_test(settings_reach_to_their_limits),
        cmocka_unit_test(each_message_has_a_line),
        cmocka_unit_test(null_is_nothing_where_there_is_no_status),
        cmocka_unit_test(when_the_kth_allocation_fails_nothing_is_opened),
    };

    return cmocka_run_group_tests_name("flat", tests, setup, NULL);
}
