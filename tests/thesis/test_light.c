/* SPDX-License-Identifier: BSD-2-Clause */
/* Tests of light: the frame, the trio Le, sample, pdf in world space, constants, and everything that a scene can say
 * wrong about a map. */
#include "bis/base/clock.h"
#include "bis/scene/light_load.h"

#include "bis/base/mem.h"
#include "bis/thesis/rng.h"
#include "bis/files/image_file.h"
#include "claim.h"
#include "map_help.h"
#include "stat.h"

#include <float.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Four statistical tests in this file, a false alarm of any of them once in 1000. */
static double alpha(void) { return stat_level(1e-3, 4); }

static bis_light_desc desc_of(bis_xform to_world)
{
    return (bis_light_desc){.L = {1, 1, 1},
        .scale = 1,
        .area_exponent = 0.15,
        .levels = 8,
        .visible = true,
        .to_world = to_world,
        .loc = {"s.txt", 7, 3}};
}

static bis_light *light_of(bis_envmap *em, bis_light_desc desc, unsigned needs)
{
    bis_light *light;
    assert_int_equal(bis_light_from_envmap(&light, em, &desc, needs, NULL), BIS_OK);
    assert_null(em->pixels);
    return light;
}

static void random4(bis_rng *g, double u[4])
{
    for (int i = 0; i < 4; i++) u[i] = bis_rng_double(g);
}

/* ---- frames ---- */

static void a_rotation_turns_the_light_and_a_reflection_mirrors_it(void **state)
{
    /* World y up from the map's z up, as pbrt scenes do: Rotate -90 1 0 0 maps (x, y, z) to (x, z, -y). */
    const bis_xform frames[] = {bis_xform_identity(), bis_xform_rotate(-90, 1, 0, 0), bis_xform_scale(-1, 1, 1)};
    const vec3 expected[][2] = {
        {{0, 0, 1}, {1, 0, 0}},
        {{0, 1, 0}, {1, 0, 0}},
        {{0, 0, 1}, {-1, 0, 0}},
    };
    for (int k = 0; k < 3; k++) {
        bis_envmap em = map_new(16, 8);
        for (int x = 0; x < 16; x++) em.pixels[x] = (rgb){1, 0, 0};                 /* about +z */
        em.pixels[4 * 16] = em.pixels[4 * 16 + 15] = em.pixels[3 * 16] = em.pixels[3 * 16 + 15] =
            (rgb){0, 1, 0}; /* about +x */
        bis_light *light = light_of(&em, desc_of(frames[k]), 0);
        assert_true(bis_light_Le(light, expected[k][0]).r == 1);
        assert_true(bis_light_Le(light, neg(expected[k][0])).r == 0);
        assert_true(bis_light_Le(light, expected[k][1]).g == 1);
        assert_true(bis_light_Le(light, neg(expected[k][1])).g == 0);
        bis_light_free(light);
    }
}

static void a_frame_that_is_no_rotation_is_an_error_with_its_place(void **state)
{
    const bis_xform wrong[] = {bis_xform_scale(2, 2, 2), bis_xform_scale(1, 1, 1.01)};
    for (int k = 0; k < 2; k++) {
        bis_envmap em = map_new(4, 2);
        bis_light *light;
        bis_diag diag = {0};
        const bis_light_desc desc = desc_of(wrong[k]);
        assert_int_equal(bis_light_from_envmap(&light, &em, &desc, 0, &diag), BIS_INPUT);
        assert_null(light);
        assert_null(em.pixels);
        assert_int_equal(strncmp(diag.messages[0].text, "s.txt:7:3: error: ", 18), 0);
        assert_non_null(strstr(diag.messages[0].text, "rotation"));
        bis_diag_clear(&diag);
    }
}

/* s^2 - 1 of a scale s is the error: 2e-3 is what three digits after the point need. */
static void a_frame_may_be_off_by_two_thousandths(void **state)
{
    static const struct { double scale; bis_status status; } cases[] = {{1.0009, BIS_OK}, {1.0011, BIS_INPUT},
        {0.9991, BIS_OK}, {0.9989, BIS_INPUT}};
    for (int k = 0; k < 4; k++) {
        bis_envmap em = map_new(4, 2);
        bis_light *light;
        const bis_light_desc desc = desc_of(bis_xform_scale(1, cases[k].scale, 1));
        assert_int_equal(bis_light_from_envmap(&light, &em, &desc, 0, NULL), cases[k].status);
        bis_light_free(light);
    }
}

/* A matrix printed with four digits is a rotation to 1e-4; the light makes it one exactly: lengths stay 1. */
static void a_rotation_printed_with_four_digits_is_straightened(void **state)
{
    const double v[16] = {0.7071, 0.7071, 0, 0, -0.7071, 0.7071, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1};
    bis_xform t;
    assert_true(bis_xform_from_columns(&t, v));
    bis_envmap em = map_random(16, 8, 2, 0, 1);
    bis_light *light = light_of(&em, desc_of(t), BIS_NEED_TABLE);
    bis_rng g;
    bis_rng_init(&g, 1, 0, 0, 0);
    for (int i = 0; i < 1000; i++) {
        double u[4];
        bis_light_point s;
        random4(&g, u);
        assert_true(bis_light_sample(light, u, &s));
        assert_near(length(s.wi), 1, 3e-7);
    }
    bis_light_free(light);
}

/* ---- Le, sample, pdf ---- */

static void a_sample_has_the_radiance_and_density_of_its_direction(void **state)
{
    bis_envmap em = map_random(64, 32, 4, 0.2, 5);
    bis_light *light = light_of(&em, desc_of(bis_xform_rotate(37, 1, 2, -0.5)), BIS_NEED_TABLE | BIS_NEED_CURVE);
    bis_rng g;
    bis_rng_init(&g, 3, 0, 0, 0);
    int at_edges = 0;
    const double bound = bis_light_max_ratio(light);
    for (int i = 0; i < 20000; i++) {
        double u[4];
        bis_light_point s;
        random4(&g, u);
        assert_true(i % 2 ? bis_light_sample(light, u, &s) : bis_light_sample_curve(light, u[0], u + 2, &s));
        assert_true(s.pdf > 0 && !rgb_is_black(s.Le));
        assert_true(rgb_sum(s.Le) / s.pdf <= bound && rgb_sum(s.Le) <= bis_light_max_intensity(light));
        const rgb seen = bis_light_Le(light, s.wi);
        if (seen.r == s.Le.r && seen.g == s.Le.g && seen.b == s.Le.b) {
            assert_true(bis_light_pdf(light, s.wi) == s.pdf);
        } else {
            at_edges++; /* rounded over a pixel's edge */
        }
    }
    assert_true(at_edges < 5);
    bis_light_free(light);
}

/* Integral of Le over the sphere: by drawing, by uniform directions, by patches, and the sum. */
static void power_is_the_same_by_every_road(void **state)
{
    for (int constant = 0; constant < 2; constant++) {
        bis_light *light;
        if (constant) {
            assert_int_equal(bis_light_constant(&light, (rgb){0.5f, 1, 2}, NULL), BIS_OK);
            assert_near(bis_light_power(light), 14 * PI, 1e-12);
        } else {
            bis_envmap em = map_random(32, 16, 2, 0.2, 5);
            light = light_of(&em, desc_of(bis_xform_rotate(80, 0, 1, 0)), BIS_NEED_TABLE | BIS_NEED_CURVE);
        }
        bis_rng g;
        bis_rng_init(&g, 6, 0, 0, 0);
        stat_moments red = {0};
        double patches = 0, red_power = 0;
        const double u[2] = {0.3, 0.6};
        bis_light_point s;
        for (size_t i = 0; i < bis_light_patches(light); i++) {
            bis_light_patch(light, i, u, &s);
            patches += rgb_sum(s.Le) / s.pdf;
            red_power += (double)s.Le.r / s.pdf;
            assert_near(length(s.wi), 1, 3e-7);
        }
        assert_near(patches / bis_light_power(light), 1, 1e-10);
        if (constant) red_power = 2 * PI; /* without the rounding of 131072 additions: all draws are equal */
        for (int i = 0; i < 100000; i++) {
            double v[4];
            random4(&g, v);
            assert_true(i % 2 ? bis_light_sample(light, v, &s) : bis_light_sample_curve(light, v[0], v + 2, &s));
            stat_add(&red, (double)s.Le.r / s.pdf);
        }
        stat_assert_mean("light_power_red", 6, &red, red_power, alpha());
        bis_light_free(light);
    }
}

static void patches_of_a_map_are_its_pixels(void **state)
{
    bis_envmap em = map_random(16, 8, 3, 0.3, 5);
    bis_light *light = light_of(&em, desc_of(bis_xform_identity()), 0);
    const bis_envmap *inside = bis_light_envmap(light);
    double sphere = 0;
    assert_int_equal(bis_light_patches(light), 128);
    for (size_t i = 0; i < 128; i++) {
        bis_light_point s;
        const double u[2] = {0.25, 0.75};
        bis_light_patch(light, i, u, &s);
        assert_int_equal(bis_envmap_pixel(inside, s.wi), i);
        sphere += 1 / s.pdf;
    }
    assert_near(sphere, 4 * PI, 1e-12);
    assert_null(bis_light_importance(light)); /* nothing was needed, nothing built */
    bis_light_free(light);
}

static void a_constant_is_drawn_uniformly_over_the_sphere_and_builds_nothing(void **state)
{
    bis_light *light;
    assert_int_equal(bis_light_constant(&light, (rgb){1, 1, 1}, NULL), BIS_OK);
    assert_int_equal(bis_light_patches(light), 512 * 256);
    assert_null(bis_light_importance(light));
    assert_null(bis_light_envmap(light));
    assert_true(bis_light_bytes(light) < 4096);
    for (int curve = 0; curve < 2; curve++) {
        double observed[128] = {0}, expected[128];
        bis_rng g;
        bis_rng_init(&g, 14, 0, 0, 0);
        for (int i = 0; i < 100000; i++) {
            double u[4];
            bis_light_point s;
            random4(&g, u);
            assert_true(curve ? bis_light_sample_curve(light, u[0], u + 2, &s) : bis_light_sample(light, u, &s));
            assert_near(s.pdf * 4 * PI, 1, 1e-15);
            assert_true(bis_light_pdf(light, s.wi) == s.pdf);
            const int z = (int)fmin(8 * (0.5 + 0.5 * (double)s.wi.z), 7);
            const int phi = (int)fmin(16 * (0.5 + atan2((double)s.wi.y, (double)s.wi.x) / (2 * PI)), 15);
            observed[16 * z + phi]++;
        }
        for (int i = 0; i < 128; i++) expected[i] = 100000 / 128.0;
        stat_assert_fit(curve ? "constant_curve" : "constant", 14, observed, expected, 128, alpha());
    }
    assert_true(rgb_sum((rgb){1, 1, 1}) / bis_light_pdf(light, (vec3){0, 0, 1}) <= bis_light_max_ratio(light));
    bis_light_free(light);
}

/* Patch 512 y + x lies between the heights 1 - 2 x/512 and 1 - 2 (x + 1)/512 and in the y-th 256th of a turn. */
static void a_patch_of_a_constant_lies_in_its_ring_and_slice(void **state)
{
    static const struct { int x, y; double u[2]; } cases[] = {{0, 0, {0.5, 0.5}}, {511, 0, {0.25, 0.75}},
        {3, 200, {0.75, 0.125}}, {300, 255, {0.5, 0.25}}, {128, 127, {0, 0}}};
    bis_light *light;
    assert_int_equal(bis_light_constant(&light, (rgb){2, 3, 4}, NULL), BIS_OK);
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        bis_light_point s;
        bis_light_patch(light, (size_t)(512 * cases[k].y + cases[k].x), cases[k].u, &s);
        const double turn = atan2((double)s.wi.y, (double)s.wi.x) / (2 * PI);
        assert_near((double)s.wi.z, 1 - 2 * (cases[k].x + cases[k].u[0]) / 512, 1e-7);
        assert_near(turn < 0 ? turn + 1 : turn, (cases[k].y + cases[k].u[1]) / 256, 1e-6);
        assert_near(s.pdf, 131072 / (4 * PI), 1e-9);
        assert_true(s.Le.r == 2 && s.Le.g == 3 && s.Le.b == 4);
    }
    bis_light_free(light);
}

/* Whatever the radiance, I over the density in double is not above the bound, which is not loose either. */
static void a_constant_s_bound_holds_to_the_last_bit(void **state)
{
    bis_rng g;
    bis_rng_init(&g, 15, 0, 0, 0);
    for (int i = 0; i < 2000; i++) {
        bis_light *light;
        const rgb L = rgb_from(bis_rng_double(&g), bis_rng_double(&g), bis_rng_double(&g));
        assert_int_equal(bis_light_constant(&light, L, NULL), BIS_OK);
        const double ratio = rgb_sum(L) / bis_light_pdf(light, (vec3){0, 0, 1}), bound = bis_light_max_ratio(light);
        assert_true(ratio <= bound && bound <= ratio * (1 + 1e-14));
        assert_true(bis_light_max_intensity(light) == rgb_sum(L));
        bis_light_free(light);
    }
}

/* By u[0] the height and by u[1] the azimuth: z = 1 - 2/4, phi = 60 degrees. The curve begins in the corner of both
 * numbers' zeros, where z is 1, and ends in that of (1, 0), as Hilbert's does. */
static void a_constant_is_drawn_from_by_its_two_numbers(void **state)
{
    const double u[4] = {0.25, 1 / 6.0, 0.9, 0.8};
    bis_light *light;
    bis_light_point s;
    assert_int_equal(bis_light_constant(&light, (rgb){1, 1, 1}, NULL), BIS_OK);
    assert_true(bis_light_sample(light, u, &s));
    assert_near((double)s.wi.x, sqrt(0.75) / 2, 1e-7);
    assert_near((double)s.wi.y, 0.75, 1e-7);
    assert_near((double)s.wi.z, 0.5, 1e-7);
    assert_true(bis_light_sample_curve(light, 0, (double[]){0, 0}, &s) && s.wi.z == 1);
    assert_true(bis_light_sample_curve(light, 1 - 0x1p-53, (double[]){0.5, 0.5}, &s));
    assert_near((double)s.wi.z, -1, 1e-7);
    /* within the last cell, 2^-26 wide: three quarters of it, as a share of the turn */
    assert_true(bis_light_sample_curve(light, 0, (double[]){0.5, 0.75}, &s));
    assert_near(atan2((double)s.wi.y, (double)s.wi.x) / (2 * PI), 0.75 * 0x1p-26, 1e-6 * 0x1p-26);
    assert_near((double)s.wi.x * (double)s.wi.x, 2 * 0x1p-26, 1e-6 * 0x1p-26); /* 4 u (1 - u) of half of it */
    bis_light_free(light);
}

static void lights_without_light_draw_nothing(void **state)
{
    const double u[4] = {0.1, 0.2, 0.3, 0.4};
    for (int constant = 0; constant < 2; constant++) {
        bis_light *light;
        bis_light_point s;
        if (constant) {
            assert_int_equal(bis_light_constant(&light, (rgb){0, 0, 0}, NULL), BIS_OK);
        } else {
            bis_envmap em = map_new(8, 4);
            light = light_of(&em, desc_of(bis_xform_identity()), BIS_NEED_TABLE | BIS_NEED_CURVE);
        }
        assert_true(bis_light_is_black(light));
        assert_false(bis_light_sample(light, u, &s));
        assert_false(bis_light_sample_curve(light, 0.5, u, &s));
        assert_true(bis_light_pdf(light, (vec3){0, 0, 1}) == 0);
        assert_true(bis_light_power(light) == 0 && bis_light_max_ratio(light) == 0);
        bis_light_free(light);
    }
}

/* ---- from files ---- */

static const char *scratch_map(const bis_image *image)
{
    static char path[64];
    mkdir("build", 0777);
    snprintf(path, sizeof path, "build/test_light_%ld.pfm", (long)getpid());
    assert_int_equal(bis_image_save(image, path, NULL), BIS_OK);
    return path;
}

static bis_image grey(int width, int height, float value)
{
    bis_image image;
    assert_int_equal(bis_image_init(&image, width, height, NULL), BIS_OK);
    for (int i = 0; i < width * height; i++) image.pixels[i] = (rgb){value, value, value};
    return image;
}

/* Load image as a light; expect this status and this exact last message (NULL: none at all). %s in the message is the
 * path, twice. */
static bis_light *load(bis_image image, bis_light_desc desc, bis_status expected, const char *message)
{
    char text[1024], path[64];
    bis_diag diag = {0};
    bis_light *light;
    snprintf(path, sizeof path, "%s", scratch_map(&image));
    desc.filename = path;
    double seconds[2] = {-1, -1};
    const double begin = bis_clock_now();
    const bis_status status = bis_light_load(&light, &desc, BIS_NEED_TABLE, seconds, &diag);
    const double end = bis_clock_now();
    assert_int_equal(status, expected);
    assert_true(seconds[0] >= 0 && seconds[1] >= 0);
    assert_true(seconds[0] + seconds[1] <= (end - begin) * 1.000001 + 1e-9); /* two parts of the call */
    assert_int_equal(diag.n, message ? 1 : 0);
    if (message) {
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
        snprintf(text, sizeof text, message, path, path);
#pragma GCC diagnostic pop
        assert_string_equal(diag.messages[0].text, text);
    }
    bis_diag_clear(&diag);
    bis_image_clear(&image);
    unlink(path);
    return light;
}

static void a_good_map_loads_without_a_word_and_is_multiplied(void **state)
{
    bis_light_desc desc = desc_of(bis_xform_identity());
    desc.L = (rgb){1, 2, 3};
    desc.scale = 10;
    bis_light *light = load(grey(8, 4, 0.5f), desc, BIS_OK, NULL);
    const rgb c = bis_light_Le(light, (vec3){0, 0, 1});
    assert_true(c.r == 5 && c.g == 10 && c.b == 15);
    assert_near(bis_light_power(light), 120 * PI, 1e-9);
    bis_light_free(light);
}

static void bad_values_are_one_warning_with_counts_and_share(void **state)
{
    bis_image image = grey(8, 4, 1);
    image.pixels[10].g = NAN;
    image.pixels[11] = (rgb){INFINITY, -INFINITY, -2};
    bis_light *light = load(image, desc_of(bis_xform_identity()), BIS_OK,
                            "s.txt:7:3: warning: \"%s\": bad channel values set to 0: 1 NaN, 2 infinite, 1 negative; "
                            "the first is G of "
                            "pixel (2, 1); they cover 8.8%% of the sphere");
    assert_non_null(light);
    bis_light_free(light);
}

static void a_black_map_warns_that_there_is_no_light(void **state)
{
    bis_light *light = load(grey(8, 4, 0), desc_of(bis_xform_identity()), BIS_OK,
                            "s.txt:7:3: warning: \"%s\" gives no light: none of its pixels is positive");
    assert_true(bis_light_is_black(light));
    bis_light_free(light);
    bis_light_desc nowhere = desc_of(bis_xform_identity()); /* of a map that no line names, the map is the place */
    nowhere.loc = (bis_loc){0};
    light = load(grey(8, 4, 0), nowhere, BIS_OK,
                 "%s: warning: \"%s\" gives no light: none of its pixels is positive");
    bis_light_free(light);
}

static void a_square_map_must_say_its_mapping(void **state)
{
    bis_light_desc desc = desc_of(bis_xform_identity());
    assert_null(load(grey(8, 8, 1), desc, BIS_INPUT,
                     "s.txt:7:3: error: \"%s\" is square, 8 x 8: give its mapping, \"angular\" for a light probe, "
                     "\"equalarea\" for a map of pbrt-v4, \"mirrorball\", or \"latlong\" if that is meant"));
    desc.has_mapping = true;
    bis_light *light = load(grey(8, 8, 1), desc, BIS_OK, NULL);
    assert_int_equal(bis_light_envmap(light)->width, 8);
    bis_light_free(light);
    desc.mapping = BIS_MAPPING_ANGULAR;
    light = load(grey(8, 8, 1), desc, BIS_OK, NULL);
    assert_int_equal(bis_light_envmap(light)->width, 16);
    bis_light_free(light);
    desc.mapping = BIS_MAPPING_LATLONG;
    desc.has_mapping = false;
    desc.is_v4 = true; /* named by "filename": what pbrt-v4 takes it for */
    light = load(grey(8, 8, 1), desc, BIS_OK,
                 "s.txt:7:3: warning: \"%s\" is square, 8 x 8, and named by \"filename\": it is taken for an "
                 "equal-area map, "
                 "as in pbrt-v4; \"string mapping\" says otherwise (\"angular\" for a light probe), or bis envmap "
                 "--mapping angular --to latlong makes a map that needs no word");
    assert_int_equal(bis_light_envmap(light)->width, 16);
    assert_string_equal(bis_light_envmap(light)->resampled_from, "equalarea");
    bis_light_free(light);
    light = load(grey(8, 4, 1), desc, BIS_OK, NULL); /* as it was before pbrt-v4 */
    assert_null(bis_light_envmap(light)->resampled_from);
    bis_light_free(light);
    desc.mapping = BIS_MAPPING_ANGULAR;
    assert_null(load(grey(8, 4, 1), desc, BIS_INPUT,
                     "s.txt:7:3: error: \"%s\" is 8 x 4; a map of mapping \"angular\" must be square (\"latlong\" maps "
                     "are 2:1)"));
}

/* docs/scene-format.md: LightSource "infinite" without parameters. */
static void a_light_without_words_is_white_and_seen(void **state)
{
    const bis_light_desc d = bis_light_desc_default();
    const bis_xform id = bis_xform_identity();

    assert_true(d.L.r == 1 && d.L.g == 1 && d.L.b == 1 && d.scale == 1);
    assert_true(d.area_exponent == 0.15 && d.levels == 8 && d.visible && d.width == 0);
    assert_true(!d.filename && !d.has_mapping && !d.is_v4 && !d.has_table_kind && !d.as_printed);
    assert_memory_equal(&d.to_world, &id, sizeof id);
}

static void a_scale_that_overflows_is_an_error(void **state)
{
    bis_light_desc desc = desc_of(bis_xform_identity());
    desc.scale = 1e30;
    assert_null(load(grey(8, 4, 1e10f), desc, BIS_INPUT,
                     "s.txt:7:3: error: \"%s\" times \"L\" (1 1 1) and \"scale\" 1e+30 exceeds the largest float; "
                     "choose a smaller scale"));
    desc.L = (rgb){1, 2, 3};
    assert_null(load(grey(8, 4, 1e10f), desc, BIS_INPUT,
                     "s.txt:7:3: error: \"%s\" times \"L\" (1 2 3) and \"scale\" 1e+30 exceeds the largest float; "
                     "choose a smaller scale"));
    desc.scale = 1e300;
    bis_light *light;
    bis_diag diag = {0};
    assert_int_equal(bis_light_load(&light, &desc, 0, NULL, &diag), BIS_INPUT);
    assert_null(light);
    assert_int_equal(diag.n_errors, 1);
    assert_string_equal(diag.messages[0].text,
        "s.txt:7:3: error: \"L\" (1 2 3) times \"scale\" 1e+300 exceeds the largest float; choose a smaller scale");
    bis_diag_clear(&diag);
}

static void a_missing_file_is_an_io_error(void **state)
{
    bis_light_desc desc = desc_of(bis_xform_identity());
    char path[] = "build/no_such_map.hdr";
    desc.filename = path;
    bis_light *light;
    bis_diag diag = {0};
    assert_int_equal(bis_light_load(&light, &desc, BIS_NEED_TABLE, NULL, &diag), BIS_IO);
    assert_null(light);
    assert_non_null(strstr(diag.messages[0].text, path));
    bis_diag_clear(&diag);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_rotation_turns_the_light_and_a_reflection_mirrors_it),
        cmocka_unit_test(a_frame_that_is_no_rotation_is_an_error_with_its_place),
        cmocka_unit_test(a_frame_may_be_off_by_two_thousandths),
        cmocka_unit_test(a_rotation_printed_with_four_digits_is_straightened),
        cmocka_unit_test(a_sample_has_the_radiance_and_density_of_its_direction),
        cmocka_unit_test(power_is_the_same_by_every_road),
        cmocka_unit_test(patches_of_a_map_are_its_pixels),
        cmocka_unit_test(a_constant_is_drawn_uniformly_over_the_sphere_and_builds_nothing),
        cmocka_unit_test(a_patch_of_a_constant_lies_in_its_ring_and_slice),
        cmocka_unit_test(a_constant_s_bound_holds_to_the_last_bit),
        cmocka_unit_test(a_constant_is_drawn_from_by_its_two_numbers),
        cmocka_unit_test(lights_without_light_draw_nothing),
        cmocka_unit_test(a_good_map_loads_without_a_word_and_is_multiplied),
        cmocka_unit_test(bad_values_are_one_warning_with_counts_and_share),
        cmocka_unit_test(a_black_map_warns_that_there_is_no_light),
        cmocka_unit_test(a_square_map_must_say_its_mapping),
        cmocka_unit_test(a_light_without_words_is_white_and_seen),
        cmocka_unit_test(a_scale_that_overflows_is_an_error),
        cmocka_unit_test(a_missing_file_is_an_io_error),
    };
    return cmocka_run_group_tests_name("light", tests, NULL, NULL);
}
