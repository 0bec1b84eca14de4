/* SPDX-License-Identifier: BSD-2-Clause */
/* Tests of envmap (src/thesis/envmap.c) and envmap_angular: geometry by quadrature and closed forms, lookups by another
 * formula, E2, E4, E7. */
#include "bis/beyond/mapping.h"
#include "bis/thesis/envmap.h"

#include "bis/base/mem.h"
#include "bis/thesis/rng.h"
#include "bis/thesis/warp.h"
#include "bis/files/image_file.h"
#include "claim.h"
#include "map_help.h"
#include "stat.h"

#include <float.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Eight statistical tests in this file, a false alarm of any of them once in 1000. */
static double alpha(void) { return stat_level(1e-3, 8); }

static bis_rng rng_of(uint64_t seed)
{
    bis_rng r;
    bis_rng_init(&r, seed, 0, 0, 0);
    return r;
}

/* ---- solid angles ---- */

static void solid_angles_sum_to_4_pi_E2(void **state)
{
    const int sizes[][2] = {{1, 1}, {2, 1}, {1, 2}, {3, 2}, {7, 5}, {1024, 512}, {1000, 333}, {2, 8192}, {1, 16384}};
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        bis_envmap em = map_new(sizes[k][0], sizes[k][1]);
        double sum = 0;
        for (int y = 0; y < em.height; y++) sum += em.row_solid_angle[y] * em.width;
        assert_near(sum / (4 * PI), 1, 1e-12);
        assert_true(em.cos_edge[0] == 1 && em.cos_edge[em.height] == -1);
        bis_envmap_clear(&em);
    }
}

/* Integral of sin(theta) over a row by three-point Gauss-Legendre quadrature, exact to 1e-15 for rows this thin. */
static void row_solid_angles_agree_with_quadrature_at_the_poles_too(void **state)
{
    bis_envmap em = map_new(16, 8192);
    const double node = sqrt(0.6), half = PI / (2.0 * em.height);
    for (int y = 0; y < em.height; y++) {
        const int from_pole = y < em.height / 2 ? y : em.height - 1 - y;
        const double mid = (2 * from_pole + 1) * half;
        const double mean = (5 * sin(mid - node * half) + 8 * sin(mid) + 5 * sin(mid + node * half)) / 18;
        const double expected = 2 * PI / em.width * 2 * half * mean;
        assert_near(em.row_solid_angle[y] / expected, 1, 1e-13);
    }
    /* What the difference of cosines in float makes of the first row: the reason for all this. */
    const double naive = 2 * PI / em.width * (double)(1 - (float)cos(PI / em.height));
    assert_true(fabs(naive / em.row_solid_angle[0] - 1) > 0.1);
    bis_envmap_clear(&em);
}

/* ---- lookups ---- */

static vec3 at(double phi, double theta) { return vec3_from(sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)); }

static void pixel_centres_look_up_to_themselves(void **state)
{
    const int sizes[][2] = {{1, 1}, {2, 1}, {1, 7}, {3, 2}, {7, 5}, {64, 32}, {1024, 512}};
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        bis_envmap em = map_new(sizes[k][0], sizes[k][1]);
        for (int y = 0; y < em.height; y++) {
            for (int x = 0; x < em.width; x++) {
                const vec3 w = at(2 * PI * (x + 0.5) / em.width, PI * (y + 0.5) / em.height);
                assert_int_equal(bis_envmap_pixel(&em, w), y * em.width + x);
            }
        }
        bis_envmap_clear(&em);
    }
}

static void a_hair_west_of_the_seam_is_the_last_column(void **state)
{
    const int widths[] = {1, 2, 3, 5, 1024, 16384};
    const float west[] = {-1e-9f, -1e-20f, -FLT_MIN, -FLT_TRUE_MIN, -1e-6f};
    for (size_t k = 0; k < sizeof widths / sizeof *widths; k++) {
        bis_envmap em = map_new(widths[k], 2);
        for (size_t i = 0; i < sizeof west / sizeof *west; i++) {
            assert_int_equal(bis_envmap_pixel(&em, (vec3){1, west[i], 0.1f}), widths[k] - 1);
            assert_int_equal(bis_envmap_pixel(&em, (vec3){1, -west[i], 0.1f}), 0);
        }
        assert_int_equal(bis_envmap_pixel(&em, (vec3){1, 0.0f, 0.1f}), 0);
        assert_int_equal(bis_envmap_pixel(&em, (vec3){1, -0.0f, 0.1f}), 0);
        assert_int_equal(bis_envmap_pixel(&em, (vec3){-1, 0.0f, 0.1f}), widths[k] / 2);
        assert_int_equal(bis_envmap_pixel(&em, (vec3){-1, -0.0f, 0.1f}), widths[k] / 2);
        bis_envmap_clear(&em);
    }
}

/* North to south, west to east: what stratified or low-discrepancy u are laid out by. */
static void directions_go_south_and_east_as_u_grows(void **state)
{
    for (int height = 1; height <= 6; height++) {
        bis_envmap em = map_new(8, height);
        for (int y = 0; y < height; y++) {
            double z = 2;
            for (int i = 0; i < 8; i++) {
                const vec3 w = bis_envmap_direction(&em, 0, y, 0.5, i / 8.0),
                           e = bis_envmap_direction(&em, 0, y, 0.6, i / 8.0);
                assert_true((double)w.z < z);
                assert_true(w.x * e.y >= w.y * e.x);
                z = (double)w.z;
            }
        }
        bis_envmap_clear(&em);
    }
}

static void poles_and_axes_have_their_pixels(void **state)
{
    bis_envmap em = map_new(8, 4);
    const float signs[] = {0.0f, -0.0f};
    for (int i = 0; i < 2; i++) {
        for (int j = 0; j < 2; j++) {
            assert_int_equal(bis_envmap_pixel(&em, (vec3){signs[i], signs[j], 1}) / 8, 0);
            assert_int_equal(bis_envmap_pixel(&em, (vec3){signs[i], signs[j], -1}) / 8, 3);
        }
    }
    /* u = p/(2 pi), v = t/pi: +x is column 0, +y column W/4, the equator the first row of the lower half. */
    assert_int_equal(bis_envmap_pixel(&em, (vec3){1, 0, 0}), 2 * 8 + 0);
    assert_int_equal(bis_envmap_pixel(&em, (vec3){0, 1, 0}), 2 * 8 + 2);
    assert_int_equal(bis_envmap_pixel(&em, (vec3){-1, 0, 0}), 2 * 8 + 4);
    assert_int_equal(bis_envmap_pixel(&em, (vec3){0, -1, 0}), 2 * 8 + 6);
    bis_envmap_clear(&em);
}

/* A direction in float is off by at most about 2^-24 in each component, an angle by 1e-7: it may look up to a neighbour
 * when it lies nearer than that to an edge, which happens at a rate of 1e-7 times a few edges over a pixel's width. */
static void directions_look_up_to_their_pixel_but_for_rounding_at_edges(void **state)
{
    const int sizes[][2] = {{16, 8}, {1024, 512}, {4096, 2048}, {8, 16384}};
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        bis_envmap em = {0};
        bis_image image = {sizes[k][0], sizes[k][1], NULL, NULL};
        assert_int_equal(bis_image_init(&image, sizes[k][0], sizes[k][1], NULL), BIS_OK);
        assert_int_equal(bis_envmap_from_latlong(&em, &image, NULL), BIS_OK);
        bis_rng r = rng_of(11);
        const int n = 200000;
        int missed = 0;
        for (int i = 0; i < n; i++) {
            const int x = (int)bis_rng_below(&r, (uint64_t)em.width);
            const int y = i % 4 ? (int)bis_rng_below(&r, (uint64_t)em.height) : (i & 4 ? 0 : em.height - 1);
            const vec3 w = bis_envmap_direction(&em, x, y, bis_rng_double(&r), bis_rng_double(&r));
            assert_near(length(w), 1, 2e-7);
            const size_t pixel = bis_envmap_pixel(&em, w);
            if (pixel == (size_t)y * (size_t)em.width + (size_t)x) continue;
            missed++;
            const int dx = abs((int)(pixel % (size_t)em.width) - x), dy = abs((int)(pixel / (size_t)em.width) - y);
            assert_true(dy <= 1 && (dx <= 1 || dx == em.width - 1));
        }
        const double bound = 1e-7 * (2 * em.width / (2 * PI) + 2 * em.height / PI) * n;
        print_message("%d x %d: %d of %d directions look up to a neighbour (bound %.0f)\n", em.width, em.height, missed,
            n, bound + 5);
        assert_true(missed <= bound + 5);
        bis_envmap_clear(&em);
    }
}

/* ---- directions in a patch, E2 ---- */

/* Count directions of pixel (x, y) in 4 x 4 cells of equal solid angle; how: the right way, or one of two wrong
 * ones. */
typedef enum how { RIGHT, UNIFORM_IN_THETA, CENTRE_ONLY } how;

static void count_in_patch(const bis_envmap *em, int x, int y, how way, int n, double observed[16], double expected[16])
{
    bis_rng r = rng_of(5);
    memset(observed, 0, 16 * sizeof *observed);
    for (int i = 0; i < n; i++) {
        double u1 = bis_rng_double(&r), u2 = bis_rng_double(&r);
        if (way == CENTRE_ONLY) u1 = u2 = 0.5;
        vec3 w = bis_envmap_direction(em, x, y, u1, u2);
        if (way == UNIFORM_IN_THETA) w = at(2 * PI * (x + u1) / em->width, PI * (y + u2) / em->height);

        /* The height in the patch from theta, not from z: sin^2(theta/2) = (1 - z)/2 without cancellation. */
        const double theta = atan2(hypot((double)w.x, (double)w.y), (double)w.z);
        const double top = pow(sin(PI * y / (2.0 * em->height)), 2),
                     bottom = pow(sin(PI * (y + 1) / (2.0 * em->height)), 2);
        const double v = (pow(sin(theta / 2), 2) - top) / (bottom - top);
        const double turn = atan2((double)w.y, (double)w.x) / (2 * PI) * em->width - x;
        const double u = turn - floor(turn / em->width) * em->width;
        const int i1 = (int)(4 * u), i2 = (int)floor(4 * v);
        if (i1 >= 0 && i1 < 4 && i2 >= 0 && i2 < 4) observed[4 * i2 + i1]++;
    }
    double total = 0;
    for (int i = 0; i < 16; i++) total += observed[i];
    assert_true(total > 0.999 * n);
    for (int i = 0; i < 16; i++) expected[i] = total / 16;
}

static void directions_are_uniform_in_their_patch_at_pole_seam_and_equator_E2(void **state)
{
    const int places[][2] = {{0, 0}, {15, 7}, {15, 3}, {8, 4}};
    bis_envmap em = map_new(16, 8);
    double observed[16], expected[16];
    for (int i = 0; i < 4; i++) {
        char name[64];
        snprintf(name, sizeof name, "patch_%d_%d", places[i][0], places[i][1]);
        count_in_patch(&em, places[i][0], places[i][1], RIGHT, 100000, observed, expected);
        stat_assert_fit(name, 5, observed, expected, 16, alpha());
    }
    bis_envmap_clear(&em);
}

static void the_first_row_of_8192_is_sampled_uniformly_in_float_directions(void **state)
{
    bis_envmap em = map_new(16, 8192);
    double observed[16], expected[16];
    count_in_patch(&em, 3, 0, RIGHT, 100000, observed, expected);
    stat_assert_fit("patch_pole_8192", 5, observed, expected, 16, alpha());
    count_in_patch(&em, 3, 8191, RIGHT, 100000, observed, expected);
    stat_assert_fit("patch_south_pole_8192", 5, observed, expected, 16, alpha());
    bis_envmap_clear(&em);
}

static void twins_uniform_in_theta_and_centre_only_are_rejected_E2(void **state)
{
    bis_envmap em = map_new(16, 8);
    double observed[16], expected[16];
    count_in_patch(&em, 2, 0, UNIFORM_IN_THETA, 100000, observed, expected);
    stat_assert_no_fit("patch_twin_theta", 5, observed, expected, 16, alpha());
    count_in_patch(&em, 8, 4, CENTRE_ONLY, 100000, observed, expected);
    stat_assert_no_fit("patch_twin_centre", 5, observed, expected, 16, alpha());
    bis_envmap_clear(&em);
}

/* E4: what uniform directions see of one lit pixel is its radiance times its solid angle: a bilinear lookup would lose
 * or add to it. */
static void one_lit_pixel_seen_by_uniform_directions_has_its_solid_angle_E4(void **state)
{
    bis_envmap em = map_new(16, 8);
    em.pixels[2 * 16 + 15] = (rgb){1, 2, 3};
    bis_rng r = rng_of(8);
    stat_moments m = {0};
    for (int i = 0; i < 400000; i++) {
        const double u1 = bis_rng_double(&r), u2 = bis_rng_double(&r);
        stat_add(&m, 4 * PI * rgb_sum(bis_envmap_Le(&em, bis_warp_sphere(u1, u2))));
    }
    stat_assert_mean("one_pixel_uniform", 8, &m, 6 * em.row_solid_angle[2], alpha());
    assert_near(bis_envmap_power(&em), 6 * em.row_solid_angle[2], 1e-15);
    bis_envmap_clear(&em);
}

/* The twin of E4: between the centres of pixels, as images are looked up; 0 beyond the first and last row. */
static rgb bilinear(const bis_envmap *em, vec3 w)
{
    const double u = atan2((double)w.y, (double)w.x) / (2 * PI) * em->width - 0.5, x = floor(u);
    const double v = acos((double)w.z) / PI * em->height - 0.5, y = floor(v);
    rgb sum = {0, 0, 0};
    for (int k = 0; k < 4; k++) {
        const int column = ((int)x + k % 2 + em->width) % em->width, row = (int)y + k / 2;
        const double weight = (k % 2 ? u - x : 1 - (u - x)) * (k / 2 ? v - y : 1 - (v - y));
        if (row < 0 || row >= em->height) continue;
        sum = rgb_add(sum, rgb_scale(em->pixels[row * em->width + column], weight));
    }
    return sum;
}

/* Drawn by the table, the one lit pixel is certain, and a direction in it has the density 1/(solid angle). With a
 * bilinear lookup there is light outside, where nothing is ever drawn: (3/4)^2 of the flux is left. */
static void one_lit_pixel_drawn_by_its_density_has_its_flux_and_by_a_bilinear_lookup_9_16_of_it_E4(void **state)
{
    bis_envmap em = map_new(128, 64);
    em.pixels[31 * 128 + 100] = (rgb){1, 2, 3};
    const double solid_angle = em.row_solid_angle[31], flux = 6 * solid_angle;
    bis_rng r = rng_of(9);
    stat_moments nearest = {0}, twin = {0};
    for (int i = 0; i < 40000; i++) {
        /* off the edges, where a float's rounding decides */
        const double u1 = 1e-6 + (1 - 2e-6) * bis_rng_double(&r), u2 = 1e-6 + (1 - 2e-6) * bis_rng_double(&r);
        const vec3 w = bis_envmap_direction(&em, 100, 31, u1, u2);
        stat_add(&nearest, rgb_sum(bis_envmap_Le(&em, w)) * solid_angle);
        stat_add(&twin, rgb_sum(bilinear(&em, w)) * solid_angle);
    }
    stat_assert_mean("one_pixel_drawn", 9, &nearest, flux, alpha());
    stat_assert_not_mean("one_pixel_bilinear", 9, &twin, flux, alpha());
    assert_near(twin.mean / flux, 9.0 / 16, 0.005); /* five standard errors */
    bis_envmap_clear(&em);
}

/* ---- values ---- */

static void bad_values_are_set_to_zero_counted_by_kind_and_the_first_is_named_E7(void **state)
{
    bis_image image;
    assert_int_equal(bis_image_init(&image, 8, 4, NULL), BIS_OK);
    for (int i = 0; i < 32; i++) image.pixels[i] = (rgb){1, 1, 1};
    image.pixels[8 + 3].b = NAN;
    image.pixels[8 + 4] = (rgb){-1, INFINITY, -INFINITY};
    image.pixels[3 * 8 + 7] = (rgb){-NAN, -0.0f, FLT_MAX};
    image.pixels[2 * 8].g = -FLT_TRUE_MIN;
    bis_envmap em;
    assert_int_equal(bis_envmap_from_latlong(&em, &image, NULL), BIS_OK);
    assert_null(image.pixels);
    assert_int_equal(em.defects.n_nan, 2);
    assert_int_equal(em.defects.n_infinite, 2);
    assert_int_equal(em.defects.n_negative, 2);
    assert_int_equal(em.defects.first_x, 3);
    assert_int_equal(em.defects.first_y, 1);
    assert_int_equal(em.defects.first_channel, 'B');
    const double share = 2 * em.row_solid_angle[1] + em.row_solid_angle[2] + em.row_solid_angle[3];
    assert_near(em.defects.solid_angle, share, 1e-15);
    for (size_t i = 0; i < 32; i++) {
        const rgb c = em.pixels[i];
        assert_true(rgb_is_finite(c) && c.r >= 0 && c.g >= 0 && c.b >= 0);
    }
    assert_true(em.pixels[8 + 3].r == 1 && em.pixels[8 + 3].b == 0);
    assert_true(em.pixels[3 * 8 + 7].b == FLT_MAX);
    bis_envmap_clear(&em);
}

/* What a map of ones but for pixel 11 sends out in one channel, which the bad value has taken from that pixel. */
static bool flux_is_that_of_a_black_pixel(const bis_envmap *em, const float *red)
{
    double flux = 0;
    for (int i = 0; i < 32; i++) flux += (double)red[i] * em->row_solid_angle[i / 8];
    return fabs(flux - (4 * PI - em->row_solid_angle[1])) <= 1e-12; /* false for a NaN */
}

/* E7, both ways: the map's own pixels pass; the file's values kept as they are do not, whatever the defect. */
static void a_bad_value_that_is_kept_spoils_the_light_of_the_whole_map_E7(void **state)
{
    const float bad[] = {NAN, -NAN, INFINITY, -INFINITY, -1, -FLT_MAX};
    for (int k = 0; k < 6; k++) {
        bis_image image;
        bis_envmap em;
        float ours[32], kept[32];
        assert_int_equal(bis_image_init(&image, 8, 4, NULL), BIS_OK);
        for (int i = 0; i < 32; i++) {
            image.pixels[i] = (rgb){1, 1, 1};
            kept[i] = i == 11 ? bad[k] : 1;
        }
        image.pixels[11].r = bad[k];
        assert_int_equal(bis_envmap_from_latlong(&em, &image, NULL), BIS_OK);
        for (int i = 0; i < 32; i++) ours[i] = em.pixels[i].r;
        assert_true(flux_is_that_of_a_black_pixel(&em, ours));
        assert_false(flux_is_that_of_a_black_pixel(&em, kept));
        assert_int_equal(em.defects.n_nan + em.defects.n_infinite + em.defects.n_negative, 1);
        assert_int_equal(k < 2 ? em.defects.n_nan : k < 4 ? em.defects.n_infinite : em.defects.n_negative, 1);
        assert_near(em.defects.solid_angle, em.row_solid_angle[1], 1e-15);
        assert_near(bis_envmap_power(&em), 12 * PI - em.row_solid_angle[1], 1e-12);
        bis_envmap_clear(&em);
    }
}

static void power_of_huge_and_of_denormal_maps_is_right(void **state)
{
    bis_envmap em = map_new(64, 32);
    for (size_t i = 0; i < map_n(&em); i++) em.pixels[i] = (rgb){FLT_MAX, FLT_MAX, FLT_MAX};
    assert_near(bis_envmap_power(&em) / (12 * PI * (double)FLT_MAX), 1, 1e-12);
    assert_true(bis_envmap_max_intensity(&em) == 3 * (double)FLT_MAX);
    for (size_t i = 0; i < map_n(&em); i++) em.pixels[i] = (rgb){0, FLT_TRUE_MIN, 0};
    assert_near(bis_envmap_power(&em) / (4 * PI * (double)FLT_TRUE_MIN), 1, 1e-12);
    bis_envmap_clear(&em);
}

/* Maps of more rows than are summed together: all count once, and the brightest may be in any. */
static void power_of_a_high_map_counts_every_row(void **state)
{
    static const int heights[] = {1023, 1024, 1025, 2047, 2048, 2049, 3000};
    for (size_t k = 0; k < sizeof heights / sizeof *heights; k++) {
        bis_envmap em = map_new(2, heights[k]);
        double power = 0;
        for (int i = 0; i < 2 * heights[k]; i++) {
            em.pixels[i] = (rgb){(float)(1 + i % 7), (float)(i % 3), 0.5f};
            power += (1.5 + i % 7 + i % 3) * em.row_solid_angle[i / 2];
        }
        assert_near(bis_envmap_power(&em), power, 1e-12 * power);
        const int places[] = {0, 1, 2 * heights[k] - 1, 2 * (heights[k] / 1024 * 1024) - 1, 2 * heights[k] / 2};
        for (int j = 0; j < 5; j++) {
            rgb *const brightest = &em.pixels[places[j] < 0 ? 7 : places[j]], before = *brightest;
            *brightest = (rgb){1, 2, (float)(20 + j)};
            assert_true(bis_envmap_max_intensity(&em) == 23 + j);
            *brightest = before;
        }
        bis_envmap_clear(&em);
    }
}

static void scaling_multiplies_channels_and_refuses_to_overflow(void **state)
{
    bis_envmap em = map_new(4, 2);
    em.pixels[5] = (rgb){1e30f, 2, 3};
    assert_int_equal(bis_envmap_scale(&em, (rgb){1, 0.5f, 10}, NULL), BIS_OK);
    assert_true(em.pixels[5].r == 1e30f && em.pixels[5].g == 1 && em.pixels[5].b == 30);
    bis_diag diag = {0};
    em.pixels[2] = (rgb){5, 6, 4}; /* the largest of each channel, wherever it is */
    assert_int_equal(bis_envmap_scale(&em, (rgb){1e10f, 7, 8}, &diag), BIS_INPUT);
    em.pixels[2] = (rgb){0, 0, 0};
    assert_int_equal(diag.n_errors, 1);
    assert_non_null(
        strstr(diag.messages[0].text, "the largest radiance of the map, (1e+30 6 30), times (1e+10 7 8) exceeds "
                                      "the largest float, 3.40282e+38; choose a smaller scale"));
    assert_true(em.pixels[5].r == 1e30f && em.pixels[5].b == 30);
    bis_diag_clear(&diag);
    bis_envmap_clear(&em);
}

/* ---- angular maps ---- */

static bis_image probe_new(int side)
{
    bis_image image;
    assert_int_equal(bis_image_init(&image, side, side, NULL), BIS_OK);
    return image;
}

/* The formula of Debevec's light probes, and the pixel's centre on the disc. */
static vec3 probe_direction(int side, int x, int y, double *r)
{
    const double right = (2 * x + 1.0) / side - 1, up = 1 - (2 * y + 1.0) / side;
    const double a = atan2(up, right);
    *r = hypot(right, up);
    return vec3_from(-cos(PI * *r), -sin(PI * *r) * cos(a), sin(PI * *r) * sin(a));
}

static size_t brightest(const bis_envmap *em)
{
    size_t best = 0;
    for (size_t i = 1; i < map_n(em); i++) {
        if (map_intensity(em, i) > map_intensity(em, best)) best = i;
    }
    return best;
}

static void a_constant_probe_makes_a_constant_map(void **state)
{
    const int sides[] = {1, 2, 3, 8, 33};
    for (size_t k = 0; k < sizeof sides / sizeof *sides; k++) {
        bis_image image = probe_new(sides[k]);
        bis_envmap em;
        for (int i = 0; i < sides[k] * sides[k]; i++) image.pixels[i] = (rgb){0.25f, 1, 4};
        assert_int_equal(bis_envmap_from_mapping(&em, &image, BIS_MAPPING_ANGULAR, 0, NULL), BIS_OK);
        assert_int_equal(em.width, 2 * sides[k]);
        assert_int_equal(em.height, sides[k]);
        for (size_t i = 0; i < map_n(&em); i++) {
            assert_true(em.pixels[i].r == 0.25f && em.pixels[i].g == 1 && em.pixels[i].b == 4);
        }
        bis_envmap_clear(&em);
        bis_image_clear(&image);
    }
}

static void the_picture_is_not_mirrored(void **state)
{
    /* Disc centre: the lat-long's centre; disc right: to its right; disc up: towards row 0. */
    const int side = 101;
    const int lit[][2] = {{50, 50}, {75, 50}, {50, 25}};
    for (int k = 0; k < 3; k++) {
        bis_image image = probe_new(side);
        bis_envmap em;
        image.pixels[lit[k][1] * side + lit[k][0]] = (rgb){1, 1, 1};
        assert_int_equal(bis_envmap_from_mapping(&em, &image, BIS_MAPPING_ANGULAR, 200, NULL), BIS_OK);
        const size_t best = brightest(&em);
        const double u = ((double)(best % 200) + 0.5) / 200, v = ((double)(best / 200) + 0.5) / 100;
        /* r = 0.495 of the disc is 89 degrees off the centre. */
        const double expected_u[] = {0.5, 0.7475, 0.5}, expected_v[] = {0.5, 0.5, 0.005};
        if (k != 2) assert_near(u, expected_u[k], 0.011); /* near the pole any column is right */
        assert_near(v, expected_v[k], 0.011);
        bis_envmap_clear(&em);
        bis_image_clear(&image);
    }
}

static void one_lit_probe_pixel_keeps_its_energy_and_its_place(void **state)
{
    const int side = 64;
    bis_rng r = rng_of(21);
    double worst = 0;
    for (int k = 0; k < 60; k++) {
        const int x = (int)bis_rng_below(&r, (uint64_t)side), y = (int)bis_rng_below(&r, (uint64_t)side);
        double radius;
        const vec3 w = probe_direction(side, x, y, &radius);
        if (radius > 1) continue;
        bis_image image = probe_new(side);
        bis_envmap em;
        image.pixels[y * side + x] = (rgb){1e6f, 2e6f, 0};
        assert_int_equal(bis_envmap_from_mapping(&em, &image, BIS_MAPPING_ANGULAR, 0, NULL), BIS_OK);

        /* The pixel's solid angle by the midpoint rule on 64 x 64 parts of it. */
        double solid_angle = 0;
        for (int i = 0; i < 64 * 64; i++) {
            const double right = 2 * (x + (i % 64 + 0.5) / 64) / side - 1,
                         up = 1 - 2 * (y + (i / 64 + 0.5) / 64) / side;
            const double t = PI * hypot(right, up);
            solid_angle += t < PI ? PI * PI * sin(t) / t * 4 / side / side / 4096 : 0;
        }
        const double off = fabs(em.power_after / em.power_before - 1);
        if (radius < 1 - 4.0 / side) { /* the two outermost pixels subtend next to nothing, and are cut by the rim */
            assert_near(em.power_before / (3e6 * solid_angle), 1, 0.01);
            assert_true(off < 1e-3);
            worst = fmax(worst, off);
        }
        const size_t best = brightest(&em);
        assert_true(
            dot(bis_envmap_direction(&em, (int)(best % 128), (int)(best / 128), 0.5, 0.5), w) > cos(2.5 * PI / side));
        bis_envmap_clear(&em);
        bis_image_clear(&image);
    }
    print_message("largest change of energy, one lit pixel: %.3f%%\n", 100 * worst);
}

static void a_smooth_probe_is_resampled_to_its_formula(void **state)
{
    const int side = 200;
    bis_image image = probe_new(side);
    for (int y = 0; y < side; y++) {
        for (int x = 0; x < side; x++) {
            double r;
            const vec3 w = probe_direction(side, x, y, &r);
            image.pixels[y * side + x] =
                r > 1 ? (rgb){1e9f, NAN, -1} : rgb_from(2 + (double)w.x, 2 + (double)w.y, 2 + (double)w.z);
        }
    }
    bis_envmap em;
    assert_int_equal(
        bis_envmap_from_mapping(&em, &image, BIS_MAPPING_ANGULAR, 127, NULL), BIS_OK); /* odd: rounded up */
    assert_int_equal(em.width, 128);
    assert_int_equal(em.height, 64);
    assert_int_equal(em.defects.n_nan + em.defects.n_negative, 0); /* the corners are no part of the map */
    for (int y = 0; y < em.height; y++) {
        for (int x = 0; x < em.width; x++) {
            const vec3 w = bis_envmap_direction(&em, x, y, 0.5, 0.5);
            const rgb c = em.pixels[y * em.width + x];
            assert_near((double)c.r, 2 + (double)w.x, 0.03);
            assert_near((double)c.g, 2 + (double)w.y, 0.03);
            assert_near((double)c.b, 2 + (double)w.z, 0.03);
        }
    }
    assert_near(em.power_after / (24 * PI), 1, 1e-3);
    assert_near(em.power_before / (24 * PI), 1, 1e-3);
    bis_envmap_clear(&em);
    bis_image_clear(&image);
}

static void bad_values_of_a_probe_are_counted_inside_the_disc(void **state)
{
    bis_image image = probe_new(16);
    for (int i = 0; i < 256; i++) image.pixels[i] = (rgb){1, 1, 1};
    image.pixels[0].r = NAN; /* a corner */
    image.pixels[8 * 16 + 5].g = -1;
    bis_envmap em;
    assert_int_equal(bis_envmap_from_mapping(&em, &image, BIS_MAPPING_ANGULAR, 0, NULL), BIS_OK);
    assert_int_equal(em.defects.n_nan, 0);
    assert_int_equal(em.defects.n_negative, 1);
    assert_int_equal(em.defects.first_x, 5);
    assert_int_equal(em.defects.first_y, 8);
    assert_int_equal(em.defects.first_channel, 'G');
    assert_true(em.defects.solid_angle > 0 && em.defects.solid_angle < 0.2);
    bis_envmap_clear(&em);
    bis_image_clear(&image);
}

static void a_probe_that_is_not_square_is_an_error(void **state)
{
    bis_image image;
    bis_envmap em;
    bis_diag diag = {0};
    assert_int_equal(bis_image_init(&image, 8, 4, NULL), BIS_OK);
    assert_int_equal(bis_envmap_from_mapping(&em, &image, BIS_MAPPING_ANGULAR, 0, &diag), BIS_INPUT);
    assert_non_null(strstr(diag.messages[0].text, "square"));
    assert_non_null(strstr(diag.messages[0].text, "8 x 4"));
    bis_diag_clear(&diag);
    bis_image_clear(&image);
}

/* The derived map was made from the same probe by another program (bilinear lookups, half floats). */
static void grace_probe_agrees_with_the_map_derived_from_it_elsewhere(void **state)
{
    const char *path = shared_data("env/probe/grace_probe.hdr");
    bis_image probe, derived;
    if (!path) {
        print_message("no shared test data (BIS_SHARED)\n");
        skip();
    }
    assert_int_equal(bis_image_read(&probe, path, (bis_loc){0}, NULL), BIS_OK);
    assert_int_equal(
        bis_image_read(&derived, shared_data("env/derived/grace_1024x512.exr"), (bis_loc){0}, NULL), BIS_OK);
    bis_envmap em, other;
    assert_int_equal(bis_envmap_from_mapping(&em, &probe, BIS_MAPPING_ANGULAR, 1024, NULL), BIS_OK);
    assert_int_equal(bis_envmap_from_latlong(&other, &derived, NULL), BIS_OK);
    print_message("Grace: energy %g -> %g (%+.3f%%), the other program %g\n", em.power_before, em.power_after,
                  100 * (em.power_after / em.power_before - 1), bis_envmap_power(&other));
    assert_near(em.power_after / em.power_before, 1, 1e-3);

    /* Correlation of log intensities: as it is, and mirrored left to right as the control. */
    double as_is[5] = {0}, mirrored[5] = {0};
    for (int y = 0; y < 512; y++) {
        for (int x = 0; x < 1024; x++) {
            const double a = log(map_intensity(&em, (size_t)(y * 1024 + x)) + 1e-3);
            const double b = log(map_intensity(&other, (size_t)(y * 1024 + x)) + 1e-3);
            const double c = log(map_intensity(&other, (size_t)(y * 1024 + 1023 - x)) + 1e-3);
            const double s[] = {a, b, a * a, b * b, a * b}, t[] = {a, c, a * a, c * c, a * c};
            for (int i = 0; i < 5; i++) as_is[i] += s[i] / (512 * 1024), mirrored[i] += t[i] / (512 * 1024);
        }
    }
    const double r1 =
        (as_is[4] - as_is[0] * as_is[1]) / sqrt((as_is[2] - as_is[0] * as_is[0]) * (as_is[3] - as_is[1] * as_is[1]));
    const double r2 = (mirrored[4] - mirrored[0] * mirrored[1]) /
                      sqrt((mirrored[2] - mirrored[0] * mirrored[0]) * (mirrored[3] - mirrored[1] * mirrored[1]));
    print_message("Grace: correlation %.5f, mirrored %.5f\n", r1, r2);
    assert_true(r1 > 0.99 && r2 < 0.9);
    bis_envmap_clear(&em);
    bis_envmap_clear(&other);
    bis_image_clear(&probe);
}

/* ---- memory ---- */

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(solid_angles_sum_to_4_pi_E2),
        cmocka_unit_test(row_solid_angles_agree_with_quadrature_at_the_poles_too),
        cmocka_unit_test(pixel_centres_look_up_to_themselves),
        cmocka_unit_test(a_hair_west_of_the_seam_is_the_last_column),
        cmocka_unit_test(directions_go_south_and_east_as_u_grows),
        cmocka_unit_test(poles_and_axes_have_their_pixels),
        cmocka_unit_test(directions_look_up_to_their_pixel_but_for_rounding_at_edges),
        cmocka_unit_test(directions_are_uniform_in_their_patch_at_pole_seam_and_equator_E2),
        cmocka_unit_test(the_first_row_of_8192_is_sampled_uniformly_in_float_directions),
        cmocka_unit_test(twins_uniform_in_theta_and_centre_only_are_rejected_E2),
        cmocka_unit_test(one_lit_pixel_seen_by_uniform_directions_has_its_solid_angle_E4),
        cmocka_unit_test(one_lit_pixel_drawn_by_its_density_has_its_flux_and_by_a_bilinear_lookup_9_16_of_it_E4),
        cmocka_unit_test(bad_values_are_set_to_zero_counted_by_kind_and_the_first_is_named_E7),
        cmocka_unit_test(a_bad_value_that_is_kept_spoils_the_light_of_the_whole_map_E7),
        cmocka_unit_test(power_of_huge_and_of_denormal_maps_is_right),
        cmocka_unit_test(power_of_a_high_map_counts_every_row),
        cmocka_unit_test(scaling_multiplies_channels_and_refuses_to_overflow),
        cmocka_unit_test(a_constant_probe_makes_a_constant_map),
        cmocka_unit_test(the_picture_is_not_mirrored),
        cmocka_unit_test(one_lit_probe_pixel_keeps_its_energy_and_its_place),
        cmocka_unit_test(a_smooth_probe_is_resampled_to_its_formula),
        cmocka_unit_test(bad_values_of_a_probe_are_counted_inside_the_disc),
        cmocka_unit_test(a_probe_that_is_not_square_is_an_error),
        cmocka_unit_test(grace_probe_agrees_with_the_map_derived_from_it_elsewhere),
    };
    return cmocka_run_group_tests_name("envmap", tests, NULL, NULL);
}
