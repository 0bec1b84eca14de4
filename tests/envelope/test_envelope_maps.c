/* SPDX-License-Identifier: BSD-2-Clause */
/* envelope, maps and radiances: maps of one pixel and of 134 million, single lit texels at the poles and on the seam,
 * contrasts to 1e76, radiances from the least float to the largest, bad texels. The other road: sums and solid angles
 * in long double, and what a lone texel must be. */
#include "claim.h"
#include "envelope.h"
#include "map_help.h"

#include "bis/thesis/importance.h"
#include "bis/thesis/light.h"
#include "bis/beyond/mapping.h"
#include "bis/base/mem.h"
#include "bis/thesis/regions.h"
#include "bis/base/image.h"

#include <float.h>
#include <stdio.h>

#define COUNT(a) ((int)(sizeof(a) / sizeof *(a)))

static const int sizes[][2] = {{1, 1},    {2, 1},    {1, 2},   {3, 1},     {1, 7},     {5, 3},
                               {1, 4096}, {4096, 1}, {64, 32}, {257, 129}, {2, 32768}, {32768, 2}};
static const double numbers[] = {0, 0x1p-53, 0x1p-24, 0.5, 1 - 0x1p-24, 1 - 0x1p-53};

/* (2 pi/W)(cos t_j - cos t_{j+1}) as a product. */
static long double solid_angle(const bis_envmap *em, int y)
{
    const long double pi = acosl(-1), half = pi / 2 / em->height;
    return 2 * pi / em->width * 2 * sinl((2 * y + 1) * half) * sinl(half);
}

/* ---- solid angles ---- */

static void check_solid_angles(const bis_envmap *em, envelope *each, envelope *sum)
{
    double total = 0;

    for (int y = 0; y < em->height; y++) {
        const double found = em->row_solid_angle[y];
        envelope_try(each, relative_error(found, (double)solid_angle(em, y)), "%d x %d row %d", em->width, em->height,
                     y);
        total += found * em->width;
    }
    envelope_try(sum, relative_error(total, 4 * PI), "%d x %d", em->width, em->height);
}

static void solid_angles_of_maps_of_any_size_are_right(void **state)
{
    envelope each = envelope_row("maps of 1 x 1, 2 x 1, 1 x N to 2 x 32768 and N x 1",
                                 "relative error of a pixel's solid angle against long double", 1e-15);
    envelope sum = envelope_row("the same", "relative error of their sum against 4 pi", 1e-13);

    for (int i = 0; i < COUNT(sizes); i++) {
        bis_envmap em = map_new(sizes[i][0], sizes[i][1]);
        check_solid_angles(&em, &each, &sum);
        bis_envmap_clear(&em);
    }
    envelope_close(&each);
    envelope_close(&sum);
}

/* ---- what tables and curve draw ---- */

enum { ALIAS, CDF, N_KINDS };

static bis_importance *new_importance(const bis_envmap *em, int kind, double b, int levels, bool compensate)
{
    const bis_importance_options options = {.table = true,
                                            .curve = !compensate,
                                            .table_kind = kind == CDF ? BIS_TABLE_CDF : BIS_TABLE_ALIAS,
                                            .area_exponent = b,
                                            .levels = levels,
                                            .compensate = compensate};
    bis_importance *im;

    assert_int_equal(bis_importance_new(&im, em, &options, NULL), BIS_OK);
    return im;
}

typedef struct density_rows {
    envelope pdf, alias, cdf;
} density_rows;

/* P = w dO / sum, w = I: what is told and what is drawn. */
static void check_densities(const bis_envmap *em, density_rows *rows, const char *what)
{
    double *pmf = bis_alloc(map_n(em), sizeof *pmf);
    long double sum = 0;

    assert_non_null(pmf);
    for (size_t i = 0; i < map_n(em); i++)
        sum += (long double)map_intensity(em, i) * solid_angle(em, (int)(i / (size_t)em->width));
    for (int kind = 0; kind < N_KINDS; kind++) {
        bis_importance *im = new_importance(em, kind, 0, 8, false);
        assert_int_equal(bis_importance_implied_pmf(im, pmf, NULL), BIS_OK);
        for (size_t i = 0; i < map_n(em); i++) {
            const double P =
                (double)((long double)map_intensity(em, i) * solid_angle(em, (int)(i / (size_t)em->width)) / sum);
            envelope_try(&rows->pdf, relative_error(bis_importance_pdf_pixel(im, i) * map_solid_angle(em, i), P),
                         "%s pixel %zu", what, i);
            if (kind == ALIAS)
                envelope_try(&rows->alias, relative_error(pmf[i], P), "%s pixel %zu: %g %g", what, i, pmf[i], P);
            if (kind == CDF) envelope_try(&rows->cdf, fabs(pmf[i] - P), "%s pixel %zu", what, i);
        }
        bis_importance_free(im);
    }
    bis_free(pmf);
}

static void densities_hold_for_contrasts_of_1_to_1e76(void **state)
{
    static const double decades[] = {0, 1, 6, 12, 76};
    density_rows rows = {
        envelope_row("contrast 1 to 1e12 and 1e76, log-uniform, maps of 1 x 1 to 257 x 129",
                     "relative error of the density against long double", 1e-12),
        envelope_row("the same", "relative error of the alias tables' implied probabilities", 1e-8),
        envelope_row("the same", "absolute error of the CDFs' probabilities: what lies below 2^-53 is lost", 0x1p-51)};
    for (int i = 0; i < COUNT(sizes) * COUNT(decades) * 2; i++) {
        const int *size = sizes[i % COUNT(sizes)];
        const double d = decades[i / COUNT(sizes) % COUNT(decades)];
        char what[64];
        if (size[0] * size[1] > 40000) continue;
        bis_envmap em = map_random(size[0], size[1], d, i / COUNT(sizes) / COUNT(decades) ? 0.5 : 0, (uint64_t)i);
        snprintf(what, sizeof what, "%d x %d, contrast 1e%g", size[0], size[1], d);
        if (bis_envmap_max_intensity(&em) > 0) check_densities(&em, &rows, what);
        bis_envmap_clear(&em);
    }
    envelope_close(&rows.pdf);
    envelope_close(&rows.alias);
    envelope_close(&rows.cdf);
}

/* How far, in radians, w is outside its pixel. */
static double outside(const bis_envmap *em, size_t pixel, vec3 w)
{
    const double x = (double)w.x, y = (double)w.y, z = (double)w.z;
    const double theta = atan2(hypot(x, y), z), phi = atan2(y, x);
    const double row = (double)(pixel / (size_t)em->width), column = (double)(pixel % (size_t)em->width);
    const double middle = 2 * PI * (column + 0.5) / em->width;
    const double off_theta = fmax(PI * row / em->height - theta, theta - PI * (row + 1) / em->height);
    const double off_phi = (fabs(remainder(phi - middle, 2 * PI)) - PI / em->width) * hypot(x, y);

    return fmax(0, fmax(off_theta, off_phi));
}

typedef struct draw_rows {
    envelope legal, place, energy;
} draw_rows;

/* `right`: the radiance over the density of any direction, where the map has one lit texel or one radiance; 0: not
 * known. */
static void check_draw(const bis_envmap *em, const bis_importance *im, const bis_map_sample *s, double right,
                       draw_rows *rows, const char *what)
{
    const double ratio = map_intensity(em, s->pixel) / s->pdf;

    envelope_expect(&rows->legal,
                    s->pixel < map_n(em) && map_intensity(em, s->pixel) > 0 && s->pdf > 0 && isfinite(s->pdf) &&
                        vec3_is_finite(s->w_local) && fabs(length(s->w_local) - 1) < 2e-7,
                    "%s pixel %zu pdf %g", what, s->pixel, s->pdf);
    envelope_try(&rows->place, outside(em, s->pixel, s->w_local), "%s pixel %zu", what, s->pixel);
    if (right > 0) envelope_try(&rows->energy, relative_error(ratio, right), "%s pixel %zu", what, s->pixel);
    assert_true(ratio <= bis_importance_max_ratio(im));
}

/* All combinations of the first and last numbers, by both tables and the curve. */
static void check_draws(const bis_envmap *em, double b, double right, draw_rows *rows, const char *what)
{
    for (int kind = 0; kind < N_KINDS; kind++) {
        bis_importance *im = new_importance(em, kind, b, 8, false);
        for (int i = 0; i < 6 * 6 * 6 * 6; i++) {
            const double u[4] = {numbers[i % 6], numbers[i / 6 % 6], numbers[i / 36 % 6], numbers[i / 216]};
            bis_map_sample s;
            assert_true(bis_importance_sample(im, u, &s));
            check_draw(em, im, &s, right, rows, what);
            if (i >= 216 || kind == CDF) continue;
            assert_true(bis_importance_sample_curve(im, u[0], u + 1, &s));
            check_draw(em, im, &s, right, rows, what);
        }
        bis_importance_free(im);
    }
}

static draw_rows new_draw_rows(const char *tried)
{
    return (draw_rows){
        envelope_row(tried, "draws of a black pixel, of density 0, not unit or not finite", 0),
        envelope_row("the same", "radians by which a direction leaves its pixel", 2e-7),
        envelope_row("the same", "relative error of radiance / density, which is the light's integral", 1e-12)};
}

static void close_draw_rows(draw_rows *rows)
{
    envelope_close(&rows->legal);
    envelope_close(&rows->place);
    envelope_close(&rows->energy);
}

static void one_lit_texel_is_found_at_poles_seam_and_anywhere(void **state)
{
    draw_rows rows = new_draw_rows("one lit texel at each pole, on both sides of the seam, anywhere; maps of 1 x 1 to "
                                   "32768 x 2; u from 0 to 1 - 2^-53");

    for (int i = 0; i < COUNT(sizes) * 7; i++) {
        const int w = sizes[i / 7][0], h = sizes[i / 7][1];
        const int at[7][2] = {{w / 2, 0}, {w / 2, h - 1}, {0, h / 2},    {w - 1, h / 2},
                              {0, 0},     {w - 1, h - 1}, {w / 3, h / 3}};
        const int x = at[i % 7][0], y = at[i % 7][1];
        bis_envmap em = map_new(w, h);
        char what[64];
        em.pixels[y * w + x] = (rgb){1e38f, 0, 1e-38f};
        snprintf(what, sizeof what, "%d x %d, texel %d %d", w, h, x, y);
        check_draws(&em, i % 2 ? 0.15 : 0, (double)1e38f * (double)solid_angle(&em, y), &rows, what);
        bis_envmap_clear(&em);
    }
    close_draw_rows(&rows);
}

static void constant_maps_of_any_size_and_radiance_are_drawn(void **state)
{
    static const float radiances[] = {1e-45f, 1e-38f, 1, 1e38f, FLT_MAX};
    draw_rows rows =
        new_draw_rows("constant maps of 1 x 1 to 32768 x 2, radiance from 1e-45 to 3.4e38; u from 0 to 1 - 2^-53");

    for (int i = 0; i < COUNT(sizes) * COUNT(radiances); i++) {
        const int *size = sizes[i % COUNT(sizes)];
        const float L = radiances[i / COUNT(sizes)];
        bis_envmap em = map_new(size[0], size[1]);
        char what[64];
        for (size_t k = 0; k < map_n(&em); k++) em.pixels[k] = (rgb){L, L, L};
        snprintf(what, sizeof what, "%d x %d, radiance %g", size[0], size[1], (double)L);
        check_draws(&em, 0, 4 * PI * 3 * (double)L, &rows, what);
        bis_envmap_clear(&em);
    }
    close_draw_rows(&rows);
}

/* Contrasty maps, where a number may land anywhere; with absurd b and levels, too. */
static void any_number_draws_light_from_contrasty_maps(void **state)
{
    static const double exponents[] = {0, 0.15, 4, 100};
    draw_rows rows =
        new_draw_rows("contrast 1e12 and 1e76, half of the texels black, b = 0, 0.15, 4, 100; u from 0 to 1 - 2^-53");

    for (int i = 0; i < 2 * 4 * 3; i++) {
        bis_envmap em = map_random(i / 8 % 3 == 0 ? 1 : 37, 19 + i / 8, i % 2 ? 76 : 12, 0.5, (uint64_t)i);
        const double b = exponents[i / 2 % 4];
        char what[64];
        snprintf(what, sizeof what, "%d x %d, contrast 1e%d, b %g", em.width, em.height, i % 2 ? 76 : 12, b);
        check_draws(&em, b, b > 0 ? 0 : bis_envmap_power(&em), &rows, what);
        bis_envmap_clear(&em);
    }
    close_draw_rows(&rows);
}

/* ---- radiances ---- */

/* The same map brighter by a power of two is the same density and draws the same directions, bit for bit. */
static void densities_do_not_depend_on_the_exposure(void **state)
{
    static const int powers[] = {-100, -60, -1, 1, 60, 118};
    envelope e = envelope_row("radiance times 2^-100 to 2^118 (1e-30 to 3e35), b = 0 and 0.15, tables and curve",
                              "draws that differ in any bit", 0);

    for (int i = 0; i < COUNT(powers) * 4; i++) {
        const double b = i % 2 ? 0.15 : 0;
        bis_envmap em = map_random(33, 17, 4, 0.2, 5), scaled = map_random(33, 17, 4, 0.2, 5);
        for (size_t k = 0; k < map_n(&em); k++) scaled.pixels[k] = rgb_scale(em.pixels[k], ldexp(1, powers[i / 4]));
        bis_importance *one = new_importance(&em, i / 2 % 2, b, 8, false),
                       *other = new_importance(&scaled, i / 2 % 2, b, 8, false);
        for (int k = 0; k < 500; k++) {
            const double u[4] = {fmod(k * 0.618, 1), fmod(k * 0.414, 1), 0.3, 0.7};
            bis_map_sample s, t;
            bis_importance_sample(one, u, &s);
            bis_importance_sample(other, u, &t);
            envelope_expect(&e, s.pixel == t.pixel && s.pdf == t.pdf, "2^%d b %g", powers[i / 4], b);
            bis_importance_sample_curve(one, u[0], u + 1, &s);
            bis_importance_sample_curve(other, u[0], u + 1, &t);
            envelope_expect(&e, s.pixel == t.pixel && s.pdf == t.pdf, "curve, 2^%d b %g", powers[i / 4], b);
        }
        bis_importance_free(one);
        bis_importance_free(other);
        bis_envmap_clear(&em);
        bis_envmap_clear(&scaled);
    }
    envelope_close(&e);
}

static void power_is_right_from_the_least_to_the_largest_float(void **state)
{
    static const float radiances[] = {1e-45f, 1e-38f, 1e-20f, 1, 1e20f, 1e38f, FLT_MAX};
    envelope e = envelope_row("maps of 1 x 1 to 32768 x 2, every third texel from 1e-45 to 3.4e38, one other",
                              "relative error of the integral over the sphere against long double", 1e-13);
    for (int i = 0; i < COUNT(sizes) * COUNT(radiances); i++) {
        bis_envmap em = map_new(sizes[i % COUNT(sizes)][0], sizes[i % COUNT(sizes)][1]);
        const float L = radiances[i / COUNT(sizes)];
        long double truth = 0;
        for (size_t k = 0; k < map_n(&em); k += 3) em.pixels[k] = (rgb){L, L / 2, k % 2 ? L : 0};
        em.pixels[map_n(&em) / 2] = (rgb){1, 1e-38f, 1e38f};
        for (size_t k = 0; k < map_n(&em); k++) {
            const rgb c = em.pixels[k];
            truth += ((long double)c.r + (long double)c.g + (long double)c.b) *
                     solid_angle(&em, (int)(k / (size_t)em.width));
        }
        envelope_try(&e, relative_error(bis_envmap_power(&em), (double)truth), "%d x %d, %g", em.width, em.height,
                     (double)L);
        bis_envmap_clear(&em);
    }
    envelope_close(&e);
}

/* ---- bad and missing light ---- */

static void bad_texels_become_black_and_are_counted(void **state)
{
    static const float values[] = {NAN, -NAN, INFINITY, -INFINITY, -1, -1e-45f, -FLT_MAX, -0.0f, 0, 1e-45f, 1, FLT_MAX};
    envelope e =
        envelope_row("texels of NaN, -NaN, Inf, -Inf, -1, -1e-45, -3.4e38, -0, in each channel beside good ones",
                     "texels not finite, negative, or changed though good; wrong counts", 0);
    bis_image image;
    bis_envmap em;

    assert_int_equal(bis_image_init(&image, 12 * 12, 12, NULL), BIS_OK);
    for (int i = 0; i < 12 * 12 * 12; i++)
        image.pixels[i] = (rgb){values[i % 12], values[i / 12 % 12], values[i / 144]};
    assert_int_equal(bis_envmap_from_latlong(&em, &image, NULL), BIS_OK);
    for (int i = 0; i < 12 * 12 * 12; i++) {
        const rgb c = em.pixels[i];
        envelope_expect(&e,
                        (double)c.r == (i % 12 >= 7 ? (double)values[i % 12] : 0) &&
                            (double)c.g == (i / 12 % 12 >= 7 ? (double)values[i / 12 % 12] : 0) &&
                            (double)c.b == (i / 144 >= 7 ? (double)values[i / 144] : 0),
                        "texel %d", i);
    }
    const size_t share = 3 * 144; /* how often each value occurs */
    envelope_expect(&e, em.defects.n_nan == 2 * share, "%zu NaN", em.defects.n_nan);
    envelope_expect(&e, em.defects.n_infinite == 2 * share, "%zu infinite", em.defects.n_infinite);
    envelope_expect(&e, em.defects.n_negative == 3 * share, "%zu negative", em.defects.n_negative);
    bis_importance *im = new_importance(&em, ALIAS, 0.15, 254, false);
    for (size_t i = 0; i < map_n(&em); i++) {
        const double pdf = bis_importance_pdf_pixel(im, i);
        envelope_expect(&e, isfinite(pdf) && pdf >= 0 && (pdf > 0) == (map_intensity(&em, i) > 0),
                        "density of texel %zu", i);
    }
    bis_importance_free(im);
    bis_envmap_clear(&em);
    envelope_close(&e);
}

static void black_maps_draw_nothing(void **state)
{
    envelope e = envelope_row("all-black maps of 1 x 1 to 32768 x 2", "directions drawn, densities other than 0", 0);

    for (int i = 0; i < COUNT(sizes) * 4; i++) {
        bis_envmap em = map_new(sizes[i / 4][0], sizes[i / 4][1]);
        bis_importance *im = new_importance(&em, i % 2, i / 2 % 2 ? 0.15 : 0, 8, false);
        const double u[4] = {0.5, 0.5, 0.5, 0.5};
        bis_map_sample s;
        envelope_expect(&e, !bis_importance_sample(im, u, &s) && !bis_importance_sample_curve(im, 0, u, &s), "%d x %d",
                        em.width, em.height);
        envelope_expect(&e, bis_importance_pdf(im, (vec3){0, 0, 1}) == 0 && bis_importance_max_ratio(im) == 0,
                        "%d x %d", em.width, em.height);
        bis_importance_free(im);
        bis_envmap_clear(&em);
    }
    envelope_close(&e);
}

/* Regions: lit pixels make up all of the sphere; a level is a level; nothing recurses. Compensation: densities
 * integrate to 1. */
static void regions_and_compensation_hold_for_extreme_maps(void **state)
{
    static const int levels[] = {1, 2, 8, 254};
    envelope area = envelope_row("regions of maps of contrast 1 to 1e76, levels 1 to 254, sizes 1 x 1 to 32768 x 2",
                                 "relative error of the sum of their solid angles against 4 pi", 1e-11);
    envelope one =
        envelope_row("compensated tables of the same maps", "difference of the integral of the density from 1", 1e-12);

    for (int i = 0; i < COUNT(sizes) * 4; i++) {
        bis_envmap em =
            map_random(sizes[i / 4][0], sizes[i / 4][1], (const double[]){0, 6, 12, 76}[i % 4], 0, (uint64_t)i);
        bis_regions r;
        double sum = 0, integral = 0;
        assert_int_equal(bis_regions_init(&r, &em, levels[i % 4], NULL), BIS_OK);
        for (uint32_t k = 0; k < r.n; k++) sum += r.solid_angle[k];
        envelope_try(&area, relative_error(sum, 4 * PI), "%d x %d, %d levels", em.width, em.height, levels[i % 4]);
        bis_regions_clear(&r);
        bis_importance *im = new_importance(&em, ALIAS, 0.15, levels[i % 4], true);
        for (size_t k = 0; k < map_n(&em); k++) integral += bis_importance_pdf_pixel(im, k) * map_solid_angle(&em, k);
        envelope_try(&one, fabs(integral - 1), "%d x %d, case %d", em.width, em.height, i % 4);
        bis_importance_free(im);
        bis_envmap_clear(&em);
    }
    envelope_close(&area);
    envelope_close(&one);
}

/* ---- light probes ---- */

static void probes_of_a_few_pixels_are_resampled(void **state)
{
    static const int widths[] = {0, 1, 2, 3, 16};
    envelope e = envelope_row("constant probes of 1 x 1 to 9 x 9, radiance from 1e-38 to 3.4e38, to widths of 2 to 18",
                              "relative error of a pixel", 1e-7);

    for (int i = 0; i < 9 * COUNT(widths) * 3; i++) {
        const int side = i % 9 + 1;
        const float L = (const float[]){1e-38f, 1, FLT_MAX}[i / 9 / COUNT(widths)];
        bis_image image;
        bis_envmap em;
        assert_int_equal(bis_image_init(&image, side, side, NULL), BIS_OK);
        for (int k = 0; k < side * side; k++) image.pixels[k] = (rgb){L, L, L};
        assert_int_equal(
            bis_envmap_from_mapping(&em, &image, BIS_MAPPING_ANGULAR, widths[i / 9 % COUNT(widths)], NULL), BIS_OK);
        for (size_t k = 0; k < map_n(&em); k++) {
            envelope_try(&e, relative_error((double)em.pixels[k].g, (double)L), "side %d, %d x %d, %g: %g", side,
                         em.width, em.height, (double)L, (double)em.pixels[k].g);
        }
        bis_image_clear(&image);
        bis_envmap_clear(&em);
    }
    envelope_close(&e);
}

/* ---- the largest map ---- */

/* The integral of the told density over the sphere, and every thousandth pixel of the implied one. */
static void check_large_map(const bis_envmap *em, envelope *integral, envelope *implied)
{
    bis_importance *im = new_importance(em, ALIAS, 0.15, 8, false);
    double *pmf = bis_alloc(map_n(em), sizeof *pmf);
    long double sum = 0;

    assert_non_null(pmf);
    assert_int_equal(bis_importance_implied_pmf(im, pmf, NULL), BIS_OK);
    for (size_t i = 0; i < map_n(em); i++) {
        const double P = bis_importance_pdf_pixel(im, i) * map_solid_angle(em, i);
        sum += (long double)P;
        if (i % 1009 == 0 && P > 0) envelope_try(implied, relative_error(pmf[i], P), "pixel %zu", i);
    }
    envelope_try(integral, (double)fabsl(sum - 1), "16384 x 8192");
    bis_free(pmf);
    bis_importance_free(im);
}

static void the_largest_map_is_as_right_as_the_smallest(void **state)
{
    if (!envelope_long()) skip();
    envelope each =
        envelope_long_row("map of 16384 x 8192", "relative error of a pixel's solid angle against long double", 1e-15);
    envelope sum = envelope_long_row("the same", "relative error of their sum against 4 pi", 1e-12);
    envelope integral = envelope_long_row("map of 16384 x 8192, contrast 1e12, b = 0.15",
                                          "difference of the integral of the density from 1", 1e-11);
    envelope implied = envelope_long_row("the same", "relative error of the alias tables' implied probabilities", 1e-8);
    bis_envmap em = map_random(16384, 8192, 12, 0.1, 1);
    check_solid_angles(&em, &each, &sum);
    check_large_map(&em, &integral, &implied);

    envelope lone = envelope_long_row("one lit texel of 16384 x 8192 at each pole, on the seam, anywhere",
                                      "draws of another pixel", 0);
    const size_t at[] = {
        0, 16383, (size_t)4096 * 16384, (size_t)4096 * 16384 + 16383, (size_t)8191 * 16384, map_n(&em) - 1, 12345678};
    for (int i = 0; i < COUNT(at); i++) {
        for (size_t k = 0; k < map_n(&em); k++) em.pixels[k] = (rgb){0, 0, 0};
        em.pixels[at[i]] = (rgb){1, 1, 1};
        bis_importance *im = new_importance(&em, i % 2, 0.15, 8, false);
        for (int k = 0; k < 216; k++) {
            const double u[4] = {numbers[k % 6], numbers[k / 6 % 6], numbers[k / 36], 0.5};
            bis_map_sample s, t;
            envelope_expect(
                &lone, bis_importance_sample(im, u, &s) && s.pixel == at[i] && outside(&em, at[i], s.w_local) < 2e-7,
                "pixel %zu", at[i]);
            envelope_expect(&lone, bis_importance_sample_curve(im, u[0], u + 1, &t) && t.pixel == at[i], "pixel %zu",
                            at[i]);
        }
        bis_importance_free(im);
    }
    bis_envmap_clear(&em);
    envelope_close(&each);
    envelope_close(&sum);
    envelope_close(&integral);
    envelope_close(&implied);
    envelope_close(&lone);
}

static void page_has_the_same_rows(void **state)
{
    envelope_finish(2, "Maps and radiances");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(solid_angles_of_maps_of_any_size_are_right),
        cmocka_unit_test(densities_hold_for_contrasts_of_1_to_1e76),
        cmocka_unit_test(one_lit_texel_is_found_at_poles_seam_and_anywhere),
        cmocka_unit_test(constant_maps_of_any_size_and_radiance_are_drawn),
        cmocka_unit_test(any_number_draws_light_from_contrasty_maps),
        cmocka_unit_test(densities_do_not_depend_on_the_exposure),
        cmocka_unit_test(power_is_right_from_the_least_to_the_largest_float),
        cmocka_unit_test(bad_texels_become_black_and_are_counted),
        cmocka_unit_test(black_maps_draw_nothing),
        cmocka_unit_test(regions_and_compensation_hold_for_extreme_maps),
        cmocka_unit_test(probes_of_a_few_pixels_are_resampled),
        cmocka_unit_test(the_largest_map_is_as_right_as_the_smallest),
        cmocka_unit_test(page_has_the_same_rows),
    };
    envelope_one_thread();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
