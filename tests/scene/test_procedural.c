/* SPDX-License-Identifier: BSD-2-Clause */
/* Patterns: Perlin's noise by the check value of its reference implementation and by what it must be, the textures that
 * are made of it by formulas of the test's own, the others by hand. */
#include "bis/scene/scene.h"
#include "claim.h"
#include "image_help.h"
#include "scene/noise.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The textures of a scene "WorldBegin TEXT Texture "t" ..." whose only shape shows "t". */
static bis_scene_desc *read_status(const char *text, bis_status expected, bis_diag *diag)
{
    char all[4000];
    bis_scene_desc *d;
    snprintf(all, sizeof all, "WorldBegin LightSource \"infinite\" %s Material \"diffuse\" \"texture reflectance\" "
             "\"t\" Shape \"sphere\"", text);
    store(scratch("scene.txt"), all, strlen(all));
    const bis_status status = bis_scene_parse(&d, scratch("scene.txt"), diag);
    if (status != expected && diag)
        for (size_t i = 0; i < diag->n; i++) print_error("%s\n", diag->messages[i].text);
    assert_int_equal(status, expected);
    return d;
}

static bis_scene_desc *read_scene(const char *text)
{
    bis_diag diag = {0};
    bis_scene_desc *d = read_status(text, BIS_OK, &diag);
    bis_diag_clear(&diag);
    return d;
}

static rgbd value(const bis_scene_desc *d, double u, double v, vec3 p)
{
    const bis_material_textures *m = bis_textures_of(&d->textures, d->shapes[0].material);
    assert_non_null(m);
    return bis_textures_value(&d->textures, NULL, m->Kd, (double[]){u, v}, p);
}

static void assert_value(rgbd c, double r, double g, double b, double tolerance)
{
    if (fabs(c.r - r) > tolerance || fabs(c.g - g) > tolerance || fabs(c.b - b) > tolerance)
        fail_msg("%.15g %.15g %.15g, not %.15g %.15g %.15g", c.r, c.g, c.b, r, g, b);
}

static double noise(double x, double y, double z) { return bis_noise((double[]){x, y, z}); }

/* ---- noise ---- */

/* Perlin's reference implementation, noise(3.14, 42, 7), is known to be this; its gradients are pbrt's there. */
static void noise_has_the_published_value(void **state)
{
    assert_true(fabs(noise(3.14, 42, 7) - 0.13691995878400012) < 1e-15);
}

static void noise_is_0_at_whole_numbers_and_repeats_after_256(void **state)
{
    for (int i = -300; i < 300; i += 7) {
        assert_true(noise(i, 3 * i, -i) == 0);
        assert_true(fabs(noise(i + .25, .5, .125) - noise(i + .25 - 256, .5 + 512, .125)) < 1e-12);
    }
    assert_true(noise(1e300, -1e17, 1e9) == 0); /* all whole */
}

/* The gradients at the corner: (+-1, +-1, 0) and its permutations. A row of 256 corners has each of the 12 exactly 16
 * times, or 32 times for the four that pbrt takes twice. For the table is a permutation: what maps the corner's x to a
 * number below 256 is one, too, and the last four bits of the number choose. One wrong number of the table breaks a
 * row. */
static void each_gradient_is_in_its_place_of_the_permutation(void **state)
{
    const double h = 1e-7;
    for (int row = 0; row < 16; row++) {
        int n[27] = {0}, kinds = 0, twice = 0;
        for (int i = 0; i < 256; i++) {
            const double c[3] = {i, row, 5 * row - 8};
            int code = 0, zeros = 0;
            for (int k = 0; k < 3; k++) {
                double p[3] = {c[0], c[1], c[2]};
                p[k] += h;
                const double g = bis_noise(p) / h;
                const int whole = (int)lround(g);
                assert_true(fabs(g - whole) < 1e-5 && abs(whole) <= 1);
                zeros += whole == 0;
                code = 3 * code + whole + 1;
            }
            assert_int_equal(zeros, 1);
            n[code]++;
        }
        for (int i = 0; i < 27; i++) kinds += n[i] == 16 || n[i] == 32, twice += n[i] == 32;
        assert_int_equal(kinds, 12);
        assert_int_equal(twice, 4);
    }
}

/* Between the corners of a cube stands the sum of their gradients times the way from them, by the weights of their
 * distances. A gradient is found beside its corner. */
static void noise_blends_the_gradients_of_eight_corners(void **state)
{
    const double h = 1e-7;
    for (int n = 0; n < 300; n++) {
        const double p[3] = {n * .37 - 40, n * 1.211 - 200, 300 - n * 2.0731};
        double sum = 0;
        for (int c = 0; c < 8; c++) {
            double corner[3], share = 1, slope = 0;
            for (int k = 0; k < 3; k++) {
                const double d = p[k] - floor(p[k]), w = 6 * pow(d, 5) - 15 * pow(d, 4) + 10 * pow(d, 3);
                corner[k] = floor(p[k]) + (c >> k & 1);
                share *= c >> k & 1 ? w : 1 - w;
            }
            for (int k = 0; k < 3; k++) {
                double beside[3] = {corner[0], corner[1], corner[2]};
                beside[k] += h;
                slope += round(bis_noise(beside) / h) * (p[k] - corner[k]);
            }
            sum += share * slope;
        }
        if (!(fabs(bis_noise(p) - sum) < 1e-12)) fail_msg("%d: %.15g, not %.15g", n, bis_noise(p), sum);
    }
}

/* A corner's share is at most its weight times the two largest parts of the way to it. By symmetry an eighth of the
 * cube is enough. From a point of the lattice, which is at most 1/512 away along each axis, the bound changes by at
 * most 8.5 of that for each of the three axes: the weights of all corners change by at most 2 x 15/8 together, times
 * two parts of at most 1 each, and the parts by 1. */
static void noise_stays_below_its_bound(void **state)
{
    enum { N = 128 };
    double most = 0, found = 0;
    for (int i = 0; i <= N; i++)
        for (int j = 0; j <= N; j++)
            for (int k = 0; k <= N; k++) {
                const double d[3] = {.5 * i / N, .5 * j / N, .5 * k / N};
                double sum = 0;
                for (int c = 0; c < 8; c++) {
                    double weight = 1, way[3], least = 2, all = 0;
                    for (int a = 0; a < 3; a++) {
                        const double w = d[a] * d[a] * d[a] * (6 * d[a] * d[a] - 15 * d[a] + 10);
                        weight *= c >> a & 1 ? w : 1 - w;
                        way[a] = c >> a & 1 ? 1 - d[a] : d[a];
                        least = fmin(least, way[a]);
                        all += way[a];
                    }
                    sum += weight * (all - least);
                }
                most = fmax(most, sum);
            }
    for (int i = 0; i < 300000; i++) found = fmax(found, fabs(noise(i * .37, i * .211, i * .0731)));
    print_message("bound %.4f on the lattice, largest of 300000 values %.4f\n", most, found);
    assert_true(found < most && found > .8);
    assert_true(most + 3 * 8.5 / (4 * N) < BIS_NOISE_MOST);
}

/* ---- made of noise ---- */

static double octave_sum(double x, double y, double z, double roughness, int octaves, bool absolute)
{
    double sum = 0;
    for (int i = 0; i < octaves; i++) {
        const double n = noise(pow(1.99, i) * x, pow(1.99, i) * y, pow(1.99, i) * z);
        sum += pow(roughness, i) * (absolute ? fabs(n) : n);
    }
    return sum;
}

static const vec3 points[] = {{.3f, .7f, -1.4f}, {12.1f, -3.3f, .9f}, {-.2f, 5.5f, 2.75f}};

static void patterns_of_noise_are_sums_of_octaves(void **state)
{
    /* twice as large as the world's, and moved */
    bis_scene_desc *fbm = read_scene("Translate 1 2 3 Scale 2 2 2 Texture \"t\" \"spectrum\" \"fbm\"");
    bis_scene_desc *few = read_scene("Texture \"t\" \"float\" \"fbm\" \"integer octaves\" 3 \"float roughness\" 0.7");
    bis_scene_desc *wrinkled = read_scene("Texture \"t\" \"float\" \"wrinkled\" \"integer octaves\" 5");
    bis_scene_desc *windy = read_scene("Texture \"t\" \"float\" \"windy\"");
    for (size_t i = 0; i < sizeof points / sizeof *points; i++) {
        const double x = (double)points[i].x, y = (double)points[i].y, z = (double)points[i].z;
        double e = octave_sum((x - 1) / 2, (y - 2) / 2, (z - 3) / 2, .5, 8, false);
        assert_value(value(fbm, 0, 0, points[i]), e, e, e, 1e-12);
        e = octave_sum(x, y, z, .7, 3, false);
        assert_value(value(few, 0, 0, points[i]), e, e, e, 1e-12);
        e = octave_sum(x, y, z, .5, 5, true) + .2 / 32;
        assert_value(value(wrinkled, 0, 0, points[i]), e, e, e, 1e-12);
        e = fabs(octave_sum(x / 10, y / 10, z / 10, .5, 3, false)) * octave_sum(x, y, z, .5, 6, false);
        assert_value(value(windy, 0, 0, points[i]), e, e, e, 1e-12);
    }
    bis_scene_desc_free(fbm);
    bis_scene_desc_free(few);
    bis_scene_desc_free(wrinkled);
    bis_scene_desc_free(windy);
}

/* Without octaves marble is a curve over sin y. The curve by de Casteljau's construction; its ends are colours that are
 * known: t = 0, 1/2, 1. */
static void marble_is_a_bezier_curve_of_layers(void **state)
{
    static const double c[9][3] = {{.58, .58, .6}, {.58, .58, .6}, {.58, .58, .6}, {.5, .5, .5}, {.6, .59, .58},
                                   {.58, .58, .6}, {.58, .58, .6}, {.2, .2, .33}, {.58, .58, .6}};
    bis_scene_desc *d = read_scene("Texture \"t\" \"spectrum\" \"marble\" \"integer octaves\" 0 \"float scale\" 3");
    bis_scene_desc *bent = read_scene("Texture \"t\" \"spectrum\" \"marble\"");
    for (int i = -40; i < 40; i++) {
        const float y = (float)i / 20;
        double t = (.5 + .5 * sin(3 * (double)y)) * 6, p[4][3];
        const int first = t < 5 ? (int)t : 5;
        t -= first;
        memcpy(p, c[first], sizeof p);
        for (int n = 3; n > 0; n--)
            for (int k = 0; k < n; k++)
                for (int a = 0; a < 3; a++) p[k][a] = (1 - t) * p[k][a] + t * p[k + 1][a];
        assert_value(value(d, 0, 0, (vec3){9, y, 7}), 1.5 * p[0][0], 1.5 * p[0][1], 1.5 * p[0][2], 1e-12);
        /* where noise bends it by as much as the layers are apart from y */
        const double moved = (double)y + .2 * octave_sum(9.5, (double)y, 7.5, .5, 8, false);
        const rgbd same = value(d, 0, 0, vec3_from(0, moved / 3, 0)), other = value(bent, 0, 0, (vec3){9.5f, y, 7.5f});
        assert_value(other, same.r, same.g, same.b, 1e-6); /* a float as the place of one */
    }
    bis_scene_desc_free(d);
    bis_scene_desc_free(bent);
}

/* ---- others ---- */

/* Every cell has no dot or one disc of radius 0.35, that lies in the cell or a little outside. Where its middle is
 * follows from pbrt-v3's formula, which is for a cell (s, t): s + 0.15 noise(s + 1.5, t + 2.8) and t + 0.15 noise(s +
 * 4.5, t + 9.8), in the plane z = 0.5. */
static void dots_are_discs_in_two_fifths_of_the_cells(void **state)
{
    enum { CELLS = 40, N = 60 };
    bis_scene_desc *d = read_scene("Texture \"t\" \"float\" \"dots\" \"float inside\" 0.25 \"float outside\" 0.75 "
                                   "\"float uscale\" 2");
    int n_dots = 0;
    for (int cell = 0; cell < CELLS * CELLS; cell++) {
        const double s0 = cell % CELLS - .5, t0 = cell / CELLS - .5;
        double area = 0, centre[2] = {0, 0}, furthest = 0;
        for (int pass = 0; pass < 2; pass++)
            for (int k = 0; k < N * N; k++) {
                const double s = s0 + (k % N + .5) / N, t = t0 + (k / N + .5) / N;
                const double v = value(d, s / 2, t, (vec3){0, 0, 0}).r;
                assert_true(v == .25 || v == .75);
                if (v == .75) continue;
                if (pass) furthest = fmax(furthest, hypot(s - centre[0] / area, t - centre[1] / area));
                else area += 1, centre[0] += s, centre[1] += t;
            }
        if (!(area > 0)) continue;
        n_dots++;
        /* less than a texel off, and 1 % of the area, where the cell does not cut it */
        const double x = centre[0] / area - s0, y = centre[1] / area - t0;
        if (x > .36 && x < .64 && y > .36 && y < .64) {
            assert_true(fabs(area / (N * N) - PI * .35 * .35) < .02 * PI * .35 * .35);
            assert_true(furthest < .35 + 1.5 / N && furthest > .35 - 2. / N);
            const double s = cell % CELLS, t = cell / CELLS;
            assert_true(fabs(x - .5 - .15 * noise(s + 1.5, t + 2.8, .5)) < .5 / N);
            assert_true(fabs(y - .5 - .15 * noise(s + 4.5, t + 9.8, .5)) < .5 / N);
        }
    }
    /* In the middle of a cell noise is the sum of 16 signs over 16, and > 0 with the probability (1 - C(16,8)/2^16)/2 =
     * 0.402. 5 sigma of a binomial of 1600. */
    print_message("%d of %d cells have a dot\n", n_dots, CELLS * CELLS);
    assert_true(fabs(n_dots - .402 * CELLS * CELLS) < 5 * sqrt(.402 * .598 * CELLS * CELLS));
    bis_scene_desc_free(d);
}

static void uv_bilerp_and_checkers_in_space_by_hand(void **state)
{
    bis_scene_desc *uv = read_scene("Texture \"t\" \"spectrum\" \"uv\" \"float uscale\" 4 \"float vdelta\" -2.25");
    assert_value(value(uv, .3, .5, (vec3){0, 0, 0}), .2, .25, 0, 1e-12);
    bis_scene_desc *lerp = read_scene("Texture \"t\" \"spectrum\" \"bilerp\" \"rgb v00\" [1 0 0] \"rgb v01\" [0 1 0] "
                                      "\"rgb v10\" [0 0 1] \"rgb v11\" [1 1 1]");
    assert_value(value(lerp, 0, 0, (vec3){0, 0, 0}), 1, 0, 0, 1e-12);
    assert_value(value(lerp, 0, 1, (vec3){0, 0, 0}), 0, 1, 0, 1e-12);
    assert_value(value(lerp, 1, 0, (vec3){0, 0, 0}), 0, 0, 1, 1e-12);
    /* (1-s)(1-t), (1-s)t, s(1-t), st = 0.1875 0.5625 0.0625 0.1875 */
    assert_value(value(lerp, .25, .75, (vec3){0, 0, 0}), .375, .75, .25, 1e-12);
    bis_scene_desc *plain = read_scene("Texture \"t\" \"float\" \"bilerp\"");
    assert_value(value(plain, .25, .75, (vec3){0, 0, 0}), .75, .75, .75, 1e-12);
    bis_scene_desc *cubes = read_scene("Scale 2 2 2 Texture \"t\" \"float\" \"checkerboard\" \"integer dimension\" 3 "
                                       "\"float tex1\" 0.2 \"float tex2\" 0.8");
    for (int i = 0; i < 64; i++) {
        const int c[3] = {i % 4 - 2, i / 4 % 4 - 2, i / 16 - 2};
        const double e = (c[0] + c[1] + c[2]) % 2 == 0 ? .2 : .8;
        assert_value(value(cubes, 0, 0, vec3_from(2 * c[0] + .5, 2 * c[1] + 1.5, 2 * c[2] + 1)), e, e, e, 1e-7);
    }
    bis_scene_desc_free(uv);
    bis_scene_desc_free(lerp);
    bis_scene_desc_free(plain);
    bis_scene_desc_free(cubes);
}

static void ranges_hold_all_values(void **state)
{
    static const char marble_dots[] = "Texture \"a\" \"spectrum\" \"marble\" Texture \"t\" \"spectrum\" \"dots\" "
                                      "\"texture inside\" \"a\" \"float outside\" 2";
    static const char *const all[] = {
        "Texture \"t\" \"spectrum\" \"fbm\" \"float roughness\" 0.9", "Texture \"t\" \"float\" \"wrinkled\"",
        "Texture \"t\" \"float\" \"windy\"", "Texture \"t\" \"spectrum\" \"marble\"",
        "Texture \"t\" \"spectrum\" \"uv\"",
        "Texture \"t\" \"spectrum\" \"bilerp\" \"float v01\" -1 \"float v10\" 0.5",
        marble_dots,
    };
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        bis_scene_desc *d = read_scene(all[i]);
        rgbd lo, hi;
        bis_textures_range(&lo, &hi, &d->textures, NULL, d->textures.of_material[d->shapes[0].material].Kd);
        for (int k = 0; k < 20000; k++) {
            const rgbd v = value(d, fmod(k * .317, 1), fmod(k * .1931, 1), vec3_from(k * .37, k * .211, k * .0731));
            const double ulps = 1e-15;
            assert_true(v.r >= lo.r - ulps && v.r <= hi.r + ulps && v.g >= lo.g - ulps && v.g <= hi.g + ulps &&
                        v.b >= lo.b - ulps && v.b <= hi.b + ulps);
        }
        bis_scene_desc_free(d);
    }
}

static void what_leaves_its_range_or_its_type_is_refused(void **state)
{
    static const struct { const char *scene, *text; } rows[] = {
        {"Texture \"t\" \"float\" \"marble\"", "Texture \"marble\" is one of colours: its type must be \"spectrum\" "
         "(or \"color\")"},
        {"Texture \"t\" \"float\" \"fbm\" \"integer octaves\" 65", "\"octaves\" is 65, must be in [0, 64]"},
        {"Texture \"t\" \"float\" \"fbm\" \"float roughness\" -1", "\"roughness\" is -1, must be in [0, 1000]"},
        {"Texture \"t\" \"float\" \"windy\" \"integer octaves\" 4", "octaves"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        bis_diag diag = {0};
        read_status(rows[i].scene, BIS_INPUT, &diag);
        if (!strstr(diag.messages[0].text, rows[i].text)) fail_msg("%s\nnot: %s", diag.messages[0].text, rows[i].text);
        bis_diag_clear(&diag);
    }
    bis_scene *s;
    bis_diag diag = {0};
    bis_scene_desc *d = read_scene("Texture \"t\" \"float\" \"fbm\"");
    assert_int_equal(bis_scene_build(&s, d, &diag), BIS_INPUT);
    assert_non_null(strstr(diag.messages[0].text, "the texture of \"Kd\" has values down to -2.19"));
    bis_diag_clear(&diag);
    bis_scene_desc_free(d);
    /* twin: brought into its range */
    d = read_scene("Texture \"f\" \"float\" \"fbm\" \"integer octaves\" 1 Texture \"t\" \"spectrum\" \"mix\" "
                   "\"float tex1\" 0.5 \"float tex2\" 0.9 \"texture amount\" \"f\"");
    assert_int_equal(bis_scene_build(&s, d, &diag), BIS_OK);
    bis_scene_free(s);
    bis_diag_clear(&diag);
    bis_scene_desc_free(d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(noise_has_the_published_value),
        cmocka_unit_test(noise_is_0_at_whole_numbers_and_repeats_after_256),
        cmocka_unit_test(each_gradient_is_in_its_place_of_the_permutation),
        cmocka_unit_test(noise_blends_the_gradients_of_eight_corners),
        cmocka_unit_test(noise_stays_below_its_bound),
        cmocka_unit_test(patterns_of_noise_are_sums_of_octaves),
        cmocka_unit_test(marble_is_a_bezier_curve_of_layers),
        cmocka_unit_test(dots_are_discs_in_two_fifths_of_the_cells),
        cmocka_unit_test(uv_bilerp_and_checkers_in_space_by_hand),
        cmocka_unit_test(ranges_hold_all_values),
        cmocka_unit_test(what_leaves_its_range_or_its_type_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
