/* SPDX-License-Identifier: BSD-2-Clause */
/* Tests of importance: what the tables give is the density that is told, for every map; directions fit it inside the
 * pixels (docs/errata.md E2, E3, E4, E14-E17). */
#include "bis/thesis/importance.h"

#include "bis/base/mem.h"
#include "bis/base/image.h"
#include "bis/thesis/regions.h"
#include "bis/thesis/rng.h"
#include "bis/files/image_file.h"
#include "claim.h"
#include "map_help.h"
#include "stat.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

#ifdef _OPENMP
#include <omp.h>
#endif

/* Fifteen statistical tests in this file, a false alarm of any of them once in 1000. */
static double alpha(void) { return stat_level(1e-3, 9); }

static bis_importance_options both(bis_table_kind kind, double b)
{
    return (bis_importance_options){.table = true, .curve = true, .table_kind = kind, .area_exponent = b, .levels = 8};
}

static bis_importance *importance_of(const bis_envmap *em, bis_importance_options o)
{
    bis_importance *im;
    assert_int_equal(bis_importance_new(&im, em, &o, NULL), BIS_OK);
    return im;
}

/* ---- what should be drawn, by thesis 3.3 and 3.4 ---- */

/* P of each pixel in long double: I dO min(0.01, A)^b / sum, A from the regions' labels. */
static double *expected_pmf(const bis_envmap *em, double b, bool compensate)
{
    bis_regions r;
    assert_int_equal(bis_regions_init(&r, em, 8, NULL), BIS_OK);
    const size_t n = map_n(em);
    double *pmf = malloc(n * sizeof *pmf);
    long double mean = 0, sum = 0;
    for (size_t i = 0; compensate && i < n; i++)
        mean += (long double)map_intensity(em, i) * (long double)map_solid_angle(em, i) / (long double)(4 * PI);
    for (size_t i = 0; i < n; i++) {
        const long double intensity = (long double)map_intensity(em, i) - mean;
        pmf[i] = 0;
        if (intensity <= 0) continue;
        pmf[i] = (double)(intensity * (long double)map_solid_angle(em, i));
        if (b > 0) pmf[i] *= pow(fmin(0.01, r.solid_angle[r.label[i]]), b);
    }
    for (size_t i = 0; i < n; i++) sum += (long double)pmf[i];
    for (size_t i = 0; i < n && sum > 0; i++) pmf[i] = (double)((long double)pmf[i] / sum);
    bis_regions_clear(&r);
    return pmf;
}

/* The table's implied pmf is pdf * dO to 1e-8, and both are the expected pmf: to the rounding of the float area factors
 * where b > 0. */
static void check_tables(const bis_envmap *em, const char *what)
{
    const double exponents[] = {0, 0.15};
    const size_t n = map_n(em);
    double *implied = malloc(n * sizeof *implied);
    for (int k = 0; k < 8; k++) {
        const double b = exponents[k & 1];
        bis_importance_options o = both(k & 2 ? BIS_TABLE_CDF : BIS_TABLE_ALIAS, b);
        o.compensate = k & 4;
        bis_importance *im = importance_of(em, o);
        double *expected = expected_pmf(em, b, false);
        if (o.compensate) {
            double *compensated = expected_pmf(em, b, true);
            double mass = 0;
            for (size_t i = 0; i < n; i++) mass += compensated[i];
            if (mass > 0 && bis_importance_max_ratio(im) == (double)INFINITY) {
                free(expected);
                expected = compensated;
            } else {
                free(compensated); /* nothing exceeds the mean: drawn as if uncompensated */
            }
        }
        assert_int_equal(bis_importance_implied_pmf(im, implied, NULL), BIS_OK);
        double sum = 0;
        for (size_t i = 0; i < n; i++) {
            const double p = bis_importance_pdf_pixel(im, i) * map_solid_angle(em, i);
            /* CDFs round each step to 2^-53 of 1, alias tables relative to the item */
            const double slack = o.table_kind == BIS_TABLE_CDF ? 4 * DBL_EPSILON : 0;
            const bool ok = (expected[i] == 0) == (p == 0) && fabs(p - expected[i]) <= 2e-7 * expected[i] &&
                            fabs(implied[i] - p) <= 1e-8 * p + slack && (p > 0 || implied[i] == 0);
            if (!ok)
                fail_msg("%s, b %g, kind %d, pixel %zu: told %g, drawn %g, expected %g", what, b, o.table_kind, i, p,
                    implied[i], expected[i]);
            sum += p;
        }
        assert_near(sum, expected[0] >= 0 && bis_envmap_power(em) > 0 ? 1 : 0, 1e-9);
        free(expected);
        bis_importance_free(im);
    }
    free(implied);
}

static void tables_give_exactly_the_density_that_is_told(void **state)
{
    const int sizes[][2] = {{1, 1}, {2, 1}, {1, 2}, {1, 9}, {9, 1}, {7, 5}, {64, 32}};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        bis_envmap em = map_random(sizes[i][0], sizes[i][1], 7, 0.2, 40 + i);
        check_tables(&em, "random");
        bis_envmap_clear(&em);
    }
}

static void tables_hold_for_extreme_maps(void **state)
{
    bis_envmap em = map_random(32, 16, 12, 0, 1);
    check_tables(&em, "contrast 1e12");
    for (int x = 0; x < 32; x++) em.pixels[5 * 32 + x] = em.pixels[15 * 32 + x] = em.pixels[x] = (rgb){0, 0, 0};
    check_tables(&em, "zero rows");
    for (size_t i = 0; i < map_n(&em); i++) em.pixels[i] = (rgb){3e38f, i % 2 ? 3e38f : 0, 3e38f};
    check_tables(&em, "3e38");
    for (size_t i = 0; i < map_n(&em); i++) em.pixels[i] = (rgb){FLT_TRUE_MIN * (float)(1 + i % 3), 0, 0};
    check_tables(&em, "denormals");
    for (size_t i = 0; i < map_n(&em); i++) em.pixels[i] = (rgb){i == 100 ? FLT_MAX : FLT_TRUE_MIN, 0, 0};
    check_tables(&em, "the whole range of floats");
    for (size_t i = 0; i < map_n(&em); i++) em.pixels[i] = (rgb){1, 1, 1};
    check_tables(&em, "constant");
    bis_envmap_clear(&em);
}

static void one_lit_pixel_anywhere_is_always_drawn(void **state)
{
    bis_envmap em = map_new(8, 4);
    bis_rng g;
    bis_rng_init(&g, 9, 0, 0, 0);
    for (size_t lit = 0; lit < map_n(&em); lit++) {
        em.pixels[lit].g = 7e4f;
        check_tables(&em, "one lit pixel");
        for (int kind = 0; kind < 2; kind++) {
            bis_importance *im = importance_of(&em, both(kind ? BIS_TABLE_CDF : BIS_TABLE_ALIAS, 0.15));
            for (int i = 0; i < 100; i++) {
                bis_map_sample s;
                double u[4];
                for (int k = 0; k < 4; k++) u[k] = i == 0 ? 0 : i == 1 ? 1 - 0x1p-53 : bis_rng_double(&g);
                assert_true(bis_importance_sample(im, u, &s) && s.pixel == lit);
                assert_near(s.pdf * map_solid_angle(&em, lit), 1, 1e-12);
                assert_near(length(s.w_local), 1, 2e-7);
                assert_true(bis_importance_sample_curve(im, u[0], u + 2, &s) && s.pixel == lit);
            }
            bis_importance_free(im);
        }
        em.pixels[lit].g = 0;
    }
    bis_envmap_clear(&em);
}

static void a_map_without_light_draws_nothing(void **state)
{
    bis_envmap em = map_new(8, 4);
    const double u[4] = {0.5, 0.5, 0.5, 0.5};
    for (int k = 0; k < 8; k++) {
        bis_importance_options o = both(k & 1 ? BIS_TABLE_CDF : BIS_TABLE_ALIAS, k & 2 ? 0.15 : 0);
        o.compensate = k & 4;
        bis_importance *im = importance_of(&em, o);
        bis_map_sample s;
        assert_false(bis_importance_sample(im, u, &s));
        assert_false(bis_importance_sample_curve(im, 0.5, u, &s));
        assert_true(bis_importance_pdf_pixel(im, 3) == 0);
        assert_true(bis_importance_max_ratio(im) == 0);
        bis_importance_free(im);
    }
    bis_envmap_clear(&em);
}

/* ---- directions ---- */

typedef enum drawing { ALIAS, CDF, CURVE } drawing;
typedef enum twin { RIGHT, NO_SOLID_ANGLE, CENTRE_ONLY, UPSIDE_DOWN, NO_AREA } twin;

/* A dim background with black pixels and a black row; lamps of one pixel, 0.0007 sr, near both poles; lights at the
 * seam. */
static bis_envmap chi_square_map(void)
{
    bis_envmap em = map_random(80, 40, 0.5, 0.15, 3);
    for (int x = 0; x < 80; x++) em.pixels[2 * 80 + x] = (rgb){0, 0, 0};
    for (int x = 0; x < 80; x += 4) em.pixels[80 + x] = em.pixels[38 * 80 + x + 1] = (rgb){100, 100, 100};
    em.pixels[19 * 80] = em.pixels[19 * 80 + 79] = em.pixels[39 * 80 + 79] = (rgb){90, 10, 10};
    return em;
}

/* Directions counted in 4 x 4 cells of equal solid angle inside each pixel. One in float within 1e-7 of an edge may
 * lie in the black pixel beyond: about 1 in 10^5 here. */
static void count_cells(const bis_envmap *em, drawing how, double b, twin wrong, int n, double *observed)
{
    bis_envmap drawn_from = map_new(em->width, em->height);
    memcpy(drawn_from.pixels, em->pixels, map_n(em) * sizeof *em->pixels);
    for (size_t i = 0; wrong == NO_SOLID_ANGLE && i < map_n(em); i++) {
        drawn_from.pixels[i] =
            rgb_scale(em->pixels[i], 1 / map_solid_angle(em, i)); /* P ~ I, as the thesis prints it */
    }
    bis_importance *im =
        importance_of(&drawn_from, both(how == CDF ? BIS_TABLE_CDF : BIS_TABLE_ALIAS, wrong == NO_AREA ? 0 : b));
    bis_rng g;
    bis_rng_init(&g, 17, 0, 0, 0);
    memset(observed, 0, 16 * map_n(em) * sizeof *observed);
    int rounded = 0;
    for (int i = 0; i < n; i++) {
        double u[4];
        bis_map_sample s;
        for (int k = 0; k < 4; k++) u[k] = bis_rng_double(&g);
        assert_true(how == CURVE ? bis_importance_sample_curve(im, u[0], u + 2, &s) : bis_importance_sample(im, u, &s));
        const size_t width = (size_t)em->width;
        if (wrong == CENTRE_ONLY)
            s.w_local = bis_envmap_direction(em, (int)(s.pixel % width), (int)(s.pixel / width), 0.5, 0.5);
        if (wrong == UPSIDE_DOWN) s.w_local.z = -s.w_local.z;

        /* Where it lies, from the direction alone: theta, then z between the row's edges; phi in turns. */
        const double theta = atan2(hypot((double)s.w_local.x, (double)s.w_local.y), (double)s.w_local.z);
        const int y = (int)fmin(theta / PI * em->height, em->height - 1);
        const double top = cos(PI * y / em->height), bottom = cos(PI * (y + 1) / em->height);
        const int v = (int)fmin(fmax(4 * (top - cos(theta)) / (top - bottom), 0), 3);
        const double phi = atan2((double)s.w_local.y, (double)s.w_local.x);
        const int column = (int)(4 * em->width * (phi < 0 ? phi + 2 * PI : phi) / (2 * PI)) % (4 * em->width);
        if (wrong == RIGHT && map_intensity(em, (size_t)y * width + (size_t)column / 4) == 0) {
            rounded++;
            continue;
        }
        observed[(size_t)(4 * y + v) * 4 * width + (size_t)column]++;
    }
    assert_true(rounded <= 10);
    bis_importance_free(im);
    bis_envmap_clear(&drawn_from);
}

static void expected_cells(const bis_envmap *em, double b, int n, double *expected)
{
    double *pmf = expected_pmf(em, b, false);
    for (size_t i = 0; i < map_n(em); i++) {
        const size_t x = i % (size_t)em->width, y = i / (size_t)em->width;
        for (size_t k = 0; k < 16; k++) {
            expected[(4 * y + k / 4) * 4 * (size_t)em->width + 4 * x + k % 4] = n * pmf[i] / 16;
        }
    }
    free(pmf);
}

static void check_directions(drawing how, double b, twin wrong, const char *name)
{
    const int n = 500000;
    bis_envmap em = chi_square_map();
    const size_t cells = 16 * map_n(&em);
    double *observed = malloc(cells * sizeof *observed), *expected = malloc(cells * sizeof *expected);
    count_cells(&em, how, b, wrong, n, observed);
    expected_cells(&em, b, n, expected);
    if (wrong == RIGHT) {
        stat_assert_fit(name, 17, observed, expected, cells, alpha());
    } else {
        stat_assert_no_fit(name, 17, observed, expected, cells, alpha());
    }
    free(observed);
    free(expected);
    bis_envmap_clear(&em);
}

static void directions_fit_the_density_inside_the_pixels(void **state)
{
    check_directions(ALIAS, 0, RIGHT, "alias_b0");
    check_directions(ALIAS, 0.15, RIGHT, "alias_b15");
    check_directions(CDF, 0, RIGHT, "cdf_b0");
    check_directions(CDF, 0.15, RIGHT, "cdf_b15");
    check_directions(CURVE, 0, RIGHT, "curve_b0");
    check_directions(CURVE, 0.15, RIGHT, "curve_b15");
}

static void wrong_samplers_are_rejected_by_the_same_check(void **state)
{
    for (drawing how = ALIAS; how <= CURVE; how++) {
        check_directions(how, 0.15, NO_SOLID_ANGLE, "twin_no_solid_angle");
        check_directions(how, 0.15, CENTRE_ONLY, "twin_centre_only");
        check_directions(how, 0.15, UPSIDE_DOWN, "twin_upside_down");
        check_directions(how, 0.15, NO_AREA, "twin_no_area");
    }
}

/* E3: constant map, irradiance pi for surfaces that look up, down and sideways; printed weights give 4 and 0.811 pi. */
static void a_constant_map_gives_irradiance_pi_on_every_side_E3(void **state)
{
    bis_envmap em = map_new(16, 8);
    for (size_t i = 0; i < map_n(&em); i++) em.pixels[i] = (rgb){1, 0, 0};
    bis_importance *im = importance_of(&em, both(BIS_TABLE_ALIAS, 0.15));
    const vec3 normals[] = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}};
    for (int k = 0; k < 3; k++) {
        bis_rng g;
        bis_rng_init(&g, 30, (uint64_t)k, 0, 0);
        stat_moments m = {0};
        for (int i = 0; i < 300000; i++) {
            double u[4];
            bis_map_sample s;
            for (int j = 0; j < 4; j++) u[j] = bis_rng_double(&g);
            bis_importance_sample(im, u, &s);
            stat_add(&m, map_intensity(&em, s.pixel) * fmax(0, dot(normals[k], s.w_local)) / s.pdf);
        }
        stat_assert_mean("irradiance", 30, &m, PI, alpha());
        stat_assert_not_mean("irradiance_twin", 30, &m, PI * 1.02, alpha());
    }
    bis_importance_free(im);
    bis_envmap_clear(&em);
}

static void the_density_of_a_direction_is_that_of_its_pixel(void **state)
{
    bis_envmap em = map_random(64, 32, 5, 0.3, 8);
    bis_importance *im = importance_of(&em, both(BIS_TABLE_CDF, 0.15));
    bis_rng g;
    bis_rng_init(&g, 2, 0, 0, 0);
    for (int i = 0; i < 10000; i++) {
        double u[4];
        bis_map_sample s;
        for (int j = 0; j < 4; j++) u[j] = bis_rng_double(&g);
        bis_importance_sample(im, u, &s);
        assert_true(s.pdf > 0 && s.pdf == bis_importance_pdf_pixel(im, s.pixel));
        if (bis_envmap_pixel(&em, s.w_local) == s.pixel) assert_true(bis_importance_pdf(im, s.w_local) == s.pdf);
    }
    bis_importance_free(im);
    bis_envmap_clear(&em);
}

/* ---- the curve ---- */

/* The second map is drawn from by tiles that its sides do not divide. */
static void equal_steps_along_the_curve_are_equal_shares_in_order(void **state)
{
    const int sizes[][2] = {{37, 19}, {301, 250}};
    for (int k = 0; k < 2; k++) {
        bis_envmap em = map_random(sizes[k][0], sizes[k][1], 4, 0.3, 12);
        const size_t n = map_n(&em);
        bis_importance *im = importance_of(&em, both(BIS_TABLE_ALIAS, 0.15));
        double *count = calloc(n, sizeof *count);
        bool *left = calloc(n, sizeof *left);
        const int steps = 1000000;
        size_t last = n;
        for (int i = 0; i < steps; i++) {
            const double u[2] = {0.5, 0.5};
            bis_map_sample s;
            assert_true(bis_importance_sample_curve(im, (i + 0.5) / steps, u, &s));
            assert_true(s.pdf > 0);
            if (s.pixel != last) {
                if (last < n) left[last] = true;
                assert_false(left[s.pixel]); /* never comes back: monotone */
                last = s.pixel;
            }
            count[s.pixel]++;
        }
        for (size_t i = 0; i < n; i++) {
            const double share = bis_importance_pdf_pixel(im, i) * map_solid_angle(&em, i) * steps;
            assert_true(fabs(count[i] - share) <= 1.001);
        }
        free(count);
        free(left);
        bis_importance_free(im);
        bis_envmap_clear(&em);
    }
}

/* Evenly spread numbers through CDFs stay even on the sphere, through alias tables they do not. A lattice of
 * 4096 points (Kronecker, golden section's two-dimensional sister), smooth integrand. */
static void cdfs_keep_even_points_even_and_alias_tables_do_not_E12(void **state)
{
    bis_envmap em = map_random(64, 32, 2, 0, 5);
    double error[2];
    double truth = 0;
    for (size_t i = 0; i < map_n(&em); i++) {
        for (int k = 0; k < 64; k++) { /* quadrature in the pixel */
            const vec3 w =
                bis_envmap_direction(&em, (int)(i % 64), (int)(i / 64), (k % 8 + 0.5) / 8, (k / 8 + 0.5) / 8);
            truth +=
                map_intensity(&em, i) * map_solid_angle(&em, i) / 64 * fmax(0, 0.6 * (double)w.x + 0.8 * (double)w.z);
        }
    }
    for (int kind = 0; kind < 2; kind++) {
        bis_importance *im = importance_of(&em, both(kind ? BIS_TABLE_CDF : BIS_TABLE_ALIAS, 0));
        bis_rng g;
        bis_rng_init(&g, 4, 0, 0, 0);
        error[kind] = 0;
        for (int run = 0; run < 40; run++) {
            const double shift[2] = {bis_rng_double(&g), bis_rng_double(&g)};
            double sum = 0;
            for (int i = 0; i < 4096; i++) {
                const double a = i * 0.7548776662466927 + shift[0], b = i * 0.5698402909980532 + shift[1];
                const double u[4] = {a - floor(a), b - floor(b), bis_rng_double(&g), bis_rng_double(&g)};
                bis_map_sample s;
                bis_importance_sample(im, u, &s);
                sum += map_intensity(&em, s.pixel) * fmax(0, 0.6 * (double)s.w_local.x + 0.8 * (double)s.w_local.z) /
                       s.pdf;
            }
            error[kind] += pow(sum / 4096 / truth - 1, 2) / 40;
        }
        bis_importance_free(im);
    }
    print_message("relative RMSE with 4096 even points: alias %.5f, CDF %.5f\n", sqrt(error[0]), sqrt(error[1]));
    assert_true(sqrt(error[1]) < 0.5 * sqrt(error[0]));
    bis_envmap_clear(&em);
}

/* ---- area weighting ---- */

/* Sides of two square lights in pixels of 1.4e-4 sr: both below 0.01 sr, both above, one above and one larger still. */
enum { N_PAIRS = 4 };
static const int sides[N_PAIRS][2] = {{2, 6}, {3, 8}, {30, 60}, {12, 60}};

static bis_envmap two_lights(const int side[2], double area[2], double flux[2])
{
    bis_envmap em = map_new(512, 256);
    for (int light = 0; light < 2; light++) {
        area[light] = flux[light] = 0;
        for (int i = 0; i < side[light] * side[light]; i++) {
            const int x = (light ? 300 : 20) + i % side[light], y = 100 + i / side[light];
            em.pixels[y * 512 + x].g = light ? 30.0f : 1000.0f;
            area[light] += em.row_solid_angle[y];
            flux[light] += em.row_solid_angle[y] * (light ? 30 : 1000);
        }
    }
    return em;
}

/* Probability per unit of flux goes as (A1/A2)^b below 0.01 sr and not at all above. weights: I for all to be drawn
 * by, in any unit. */
static bool pair_is_weighted_by_area(const double *weights, const double area[2], const double flux[2], double b)
{
    double sum[2] = {0, 0};
    for (size_t i = 0; i < 512 * 256; i++) sum[i % 512 >= 256] += weights[i];
    const double ratio = sum[0] / flux[0] / (sum[1] / flux[1]);
    const double expected = area[0] < 0.01 ? pow(area[0] / fmin(area[1], 0.01), b) : 1;
    return fabs(ratio - expected) <= 2e-7;
}

static void a_black_map_draws_no_pixel(void **state)
{
    bis_envmap em = map_new(4, 2);
    bis_importance *im = importance_of(&em, both(BIS_TABLE_ALIAS, 0.15));
    double pmf[8] = {1, 1, 1, 1, 1, 1, 1, 1};
    assert_int_equal(bis_importance_implied_pmf(im, pmf, NULL), BIS_OK);
    for (int i = 0; i < 8; i++) assert_true(pmf[i] == 0);
    bis_importance_free(im);
    bis_envmap_clear(&em);
}

static void small_lights_lose_importance_by_the_ratio_of_areas_to_the_b_E17(void **state)
{
    for (int k = 0; k < N_PAIRS; k++) {
        double area[2], flux[2];
        bis_envmap em = two_lights(sides[k], area, flux);
        bis_importance *im = importance_of(&em, both(BIS_TABLE_ALIAS, 0.15));
        double *pmf = malloc(map_n(&em) * sizeof *pmf);
        assert_true((k >= 2) == (area[0] > 0.01) && (k >= 2) == (area[1] > 0.01));
        assert_int_equal(bis_importance_implied_pmf(im, pmf, NULL), BIS_OK);
        assert_true(pair_is_weighted_by_area(pmf, area, flux, 0.15));
        free(pmf);
        bis_importance_free(im);
        bis_envmap_clear(&em);
    }
}

/* Section 3.4 prints two formulas and no unit. What else they could mean: dOmega of the pixel for that of the
 * component; the pixel's own solid angle gone; 0.01 of the sphere; no limit. Each is rejected by the check that ours
 * passes. */
static void other_readings_of_the_area_formula_are_rejected_E17(void **state)
{
    enum { OURS, PIXELS_OWN, OWN_GONE, OF_THE_SPHERE, NO_LIMIT, N_READINGS };
    double *weights = malloc(512 * 256 * sizeof *weights);
    for (int reading = OURS; reading < N_READINGS; reading++) {
        int right = 0;
        for (int k = 0; k < N_PAIRS; k++) {
            double area[2], flux[2];
            bis_envmap em = two_lights(sides[k], area, flux);
            const double limit = reading == OF_THE_SPHERE ? 0.01 * 4 * PI : reading == NO_LIMIT ? HUGE_VAL : 0.01;
            for (size_t i = 0; i < map_n(&em); i++) {
                const double own = map_solid_angle(&em, i), A = reading == PIXELS_OWN ? own : area[i % 512 >= 256];
                weights[i] = map_intensity(&em, i) * (reading == OWN_GONE ? 1 : own) * pow(fmin(limit, A), 0.15);
            }
            right += pair_is_weighted_by_area(weights, area, flux, 0.15);
            bis_envmap_clear(&em);
        }
        assert_true((reading == OURS) == (right == N_PAIRS));
    }
    free(weights);
}

/* ---- bounds, compensation ---- */

static void no_ratio_of_intensity_to_density_exceeds_its_bound(void **state)
{
    for (uint64_t seed = 0; seed < 40; seed++) {
        bis_envmap em = map_random(31, 17, seed % 2 ? 10 : 0.01, 0.1, seed);
        bis_importance *im = importance_of(&em, both(BIS_TABLE_ALIAS, 0.05 * (double)(seed % 5)));
        const double bound = bis_importance_max_ratio(im);
        double most = 0;
        for (size_t i = 0; i < map_n(&em); i++) {
            if (map_intensity(&em, i) > 0) most = fmax(most, map_intensity(&em, i) / bis_importance_pdf_pixel(im, i));
        }
        assert_true(most <= bound && most >= bound * (1 - 1e-12));
        bis_importance_free(im);
        bis_envmap_clear(&em);
    }
}

static void compensation_leaves_only_what_exceeds_the_mean(void **state)
{
    bis_envmap em = map_random(32, 16, 3, 0.1, 6);
    bis_importance_options o = both(BIS_TABLE_ALIAS, 0);
    o.compensate = true;
    bis_importance *im = importance_of(&em, o);
    const double mean = bis_envmap_power(&em) / (4 * PI);
    double sum = 0;
    for (size_t i = 0; i < map_n(&em); i++) {
        const double pdf = bis_importance_pdf_pixel(im, i);
        assert_true((pdf > 0) == (map_intensity(&em, i) > mean));
        sum += pdf * map_solid_angle(&em, i);
    }
    assert_near(sum, 1, 1e-12);
    assert_true(bis_importance_max_ratio(im) == (double)INFINITY);
    for (int k = -1; k <= 1; k += 2) { /* whatever the exposure: a power of two rounds nothing */
        bis_envmap scaled = map_random(32, 16, 3, 0.1, 6);
        for (size_t i = 0; i < map_n(&em); i++) scaled.pixels[i] = rgb_scale(scaled.pixels[i], ldexp(1, 70 * k));
        bis_importance *other = importance_of(&scaled, o);
        for (size_t i = 0; i < map_n(&em); i++)
            assert_true(bis_importance_pdf_pixel(other, i) == bis_importance_pdf_pixel(im, i));
        bis_importance_free(other);
        bis_envmap_clear(&scaled);
    }
    bis_importance_free(im);

    for (size_t i = 0; i < map_n(&em); i++) em.pixels[i] = (rgb){0.1f, 0.7f, 0.3f};
    im = importance_of(&em, o); /* nothing exceeds the mean */
    assert_near(bis_importance_pdf_pixel(im, 7) * 4 * PI, 1, 1e-12);
    bis_importance_free(im);
    em.pixels[40].g = nextafterf(0.7f, 1); /* the least step of a float exceeds it */
    im = importance_of(&em, o);
    assert_near(bis_importance_pdf_pixel(im, 40) * map_solid_angle(&em, 40), 1, 1e-12);
    bis_importance_free(im);
    bis_envmap_clear(&em);
}

/* ---- cost ---- */

static void sixteen_bytes_a_pixel_are_enough(void **state)
{
    bis_envmap em = map_random(1024, 512, 5, 0, 2);
    for (int k = 0; k < 6; k++) {
        bis_importance_options o = both(k == 1 ? BIS_TABLE_CDF : BIS_TABLE_ALIAS, k < 3 ? 0.15 : 0);
        o.table = k % 3 < 2;
        o.curve = !o.table;
        bis_importance *im = importance_of(&em, o);
        const double bytes = (double)bis_importance_bytes(im) / (double)map_n(&em);
        print_message("%s, b = %g: %.2f bytes a pixel\n",
            o.curve ? "curve"
            : k % 3 ? "cdf"
                    : "alias",
            o.area_exponent, bytes);
        assert_true(bytes <= 16);
        bis_importance_free(im);
    }
    bis_envmap_clear(&em);
}

/* What a render does not draw with is not built: 10 bytes a pixel of alias tables, 1.5 of the curve. */
static void only_what_is_asked_for_is_built(void **state)
{
    bis_envmap em = map_random(1024, 512, 5, 0, 2);
    const double n = (double)map_n(&em);
    bis_importance_options o = both(BIS_TABLE_ALIAS, 0.15);
    bis_importance *im = importance_of(&em, o);
    assert_near((double)bis_importance_bytes(im) / n, 4 + 10 + 1.5, 0.05);
    bis_importance_free(im);
    o.table = false;
    im = importance_of(&em, o);
    assert_near((double)bis_importance_bytes(im) / n, 4 + 1.5, 0.05);
    bis_importance_free(im);
    o.area_exponent = 0;
    im = importance_of(&em, o);
    assert_near((double)bis_importance_bytes(im) / n, 1.5, 0.05);
    bis_importance_free(im);
    bis_envmap_clear(&em);
}

/* Every pixel of a map with tiles that are cut off has the share of the curve that its density says: exactly, by the
 * ends of its piece, which halving finds. A black pixel has none. */
static void a_piece_of_the_curve_is_as_long_as_its_pixel_is_probable(void **state)
{
    bis_envmap em = map_random(259, 255, 8, 0.3, 21);
    bis_importance_options o = both(BIS_TABLE_ALIAS, 0.15);
    o.table = false;
    bis_importance *im = importance_of(&em, o);
    double begin = 0;
    size_t n_lit = 0, n_found = 0;
    for (size_t i = 0; i < map_n(&em); i++) n_lit += bis_importance_pdf_pixel(im, i) > 0;
    while (begin < 1) {
        bis_map_sample s, t;
        assert_true(bis_importance_sample_curve(im, begin, (double[]){0.5, 0.5}, &s));
        double in = begin, beyond = 1;
        const double p = s.pdf * map_solid_angle(&em, s.pixel);
        if (begin + 2 * p < 1) beyond = begin + 2 * p;
        for (;;) {
            const double middle = in + (beyond - in) / 2;
            if (middle <= in || middle >= beyond) break;
            bis_importance_sample_curve(im, middle, (double[]){0.5, 0.5}, &t);
            if (t.pixel == s.pixel) in = middle;
            else beyond = middle;
        }
        assert_true(p > 0);
        assert_near(beyond - begin, p, 4 * DBL_EPSILON); /* two ends, rounded near 1, and p's own rounding */
        n_found++;
        begin = beyond;
    }
    /* some are less probable than a rounding */
    assert_true(n_found <= n_lit && (double)n_found > 0.999 * (double)n_lit);
    bis_importance_free(im);
    bis_envmap_clear(&em);
}

/* The tiles of 66 rows of 1000 pixels, of which the last two make tiles of their own. A tile of rows y to y + n spans
 * 4 columns of 1000 and cos(theta) from pi y/66 to pi (y + n)/66. Its end on the curve, less the one before, is the sum
 * of its pixels' probabilities. */
static void a_tile_has_the_solid_angle_and_the_share_of_its_pixels(void **state)
{
    bis_envmap em = map_random(1000, 66, 8, 0.3, 5);
    bis_importance *im = importance_of(&em, both(BIS_TABLE_ALIAS, 0.15));
    uint32_t side;
    double before = 0;
    assert_int_equal(bis_importance_n_tiles(im, &side), 250 * 17);
    assert_int_equal(side, 4);
    for (size_t i = 0; i < 250 * 17; i++) {
        const bis_curve_tile t = bis_importance_tile(im, i);
        const uint32_t y = t.tile / 250 * 4, x = t.tile % 250 * 4, rows = y == 64 ? 2 : 4;
        double share = 0;
        for (uint32_t k = 0; k < 4 * rows; k++) {
            const size_t pixel = (size_t)(y + k / 4) * 1000 + x + k % 4;
            share += bis_importance_pdf_pixel(im, pixel) * map_solid_angle(&em, pixel);
        }
        assert_near(t.solid_angle, 2 * PI * 4 / 1000 * (cos(PI * y / 66) - cos(PI * (y + rows) / 66)), 1e-12);
        assert_near(t.end - before, share, 4 * DBL_EPSILON);
        before = t.end;
    }
    assert_true(before == 1);
    bis_importance_free(im);
    bis_envmap_clear(&em);
}

static void any_number_of_threads_builds_the_same_bits(void **state)
{
#ifdef _OPENMP
    enum { DRAWS = 5000, EACH = 2 }; /* of a draw: pixel and density */
    const int before = omp_get_max_threads();
    const int sizes[][2] = {{200, 100}, {401, 203}}; /* pixel by pixel; in tiles, some of which are cut off */
    for (int m = 0; m < 2; m++) {
        bis_envmap em = map_random(sizes[m][0], sizes[m][1], 8, 0.2, 13);
        const size_t n = 2 * map_n(&em) + EACH * DRAWS;
        double *answer[3];
        for (int k = 0; k < 3; k++) {
            omp_set_num_threads(k == 0 ? 1 : k == 1 ? 2 : 7);
            bis_importance *im = importance_of(&em, both(BIS_TABLE_ALIAS, 0.15));
            double *a = answer[k] = calloc(n, sizeof *a);
            assert_int_equal(bis_importance_implied_pmf(im, a, NULL), BIS_OK);
            a += map_n(&em);
            for (size_t i = 0; i < map_n(&em); i++) *a++ = bis_importance_pdf_pixel(im, i);
            for (int i = 0; i < DRAWS; i++) {
                bis_map_sample s;
                assert_true(bis_importance_sample_curve(im, (i + 0.3) / DRAWS, (double[]){0.5, 0.5}, &s));
                *a++ = (double)s.pixel;
                *a++ = s.pdf;
            }
            bis_importance_free(im);
            assert_memory_equal(answer[0], answer[k], n * sizeof **answer);
        }
        omp_set_num_threads(before);
        for (int k = 0; k < 3; k++) free(answer[k]);
        bis_envmap_clear(&em);
    }
#else
    skip();
#endif
}

static void real_maps_are_drawn_as_told(void **state)
{
    const char *names[] = {"env/grace_latlong_fyp_extreme.hdr", "env/uffizi_latlong_1200x600.hdr", "env/spot1Lux.hdr"};
    if (!shared_data(names[0])) {
        print_message("no shared test data (BIS_SHARED)\n");
        skip();
    }
    for (int k = 0; k < 3; k++) {
        bis_image image;
        bis_envmap em;
        assert_int_equal(bis_image_read(&image, shared_data(names[k]), (bis_loc){0}, NULL), BIS_OK);
        assert_int_equal(bis_envmap_from_latlong(&em, &image, NULL), BIS_OK);
        check_tables(&em, names[k]);
        bis_envmap_clear(&em);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tables_give_exactly_the_density_that_is_told),
        cmocka_unit_test(tables_hold_for_extreme_maps),
        cmocka_unit_test(one_lit_pixel_anywhere_is_always_drawn),
        cmocka_unit_test(a_map_without_light_draws_nothing),
        cmocka_unit_test(directions_fit_the_density_inside_the_pixels),
        cmocka_unit_test(wrong_samplers_are_rejected_by_the_same_check),
        cmocka_unit_test(a_constant_map_gives_irradiance_pi_on_every_side_E3),
        cmocka_unit_test(the_density_of_a_direction_is_that_of_its_pixel),
        cmocka_unit_test(equal_steps_along_the_curve_are_equal_shares_in_order),
        cmocka_unit_test(cdfs_keep_even_points_even_and_alias_tables_do_not_E12),
        cmocka_unit_test(a_black_map_draws_no_pixel),
        cmocka_unit_test(small_lights_lose_importance_by_the_ratio_of_areas_to_the_b_E17),
        cmocka_unit_test(other_readings_of_the_area_formula_are_rejected_E17),
        cmocka_unit_test(no_ratio_of_intensity_to_density_exceeds_its_bound),
        cmocka_unit_test(compensation_leaves_only_what_exceeds_the_mean),
        cmocka_unit_test(sixteen_bytes_a_pixel_are_enough),
        cmocka_unit_test(only_what_is_asked_for_is_built),
        cmocka_unit_test(a_piece_of_the_curve_is_as_long_as_its_pixel_is_probable),
        cmocka_unit_test(a_tile_has_the_solid_angle_and_the_share_of_its_pixels),
        cmocka_unit_test(any_number_of_threads_builds_the_same_bits),
        cmocka_unit_test(real_maps_are_drawn_as_told),
    };
    return cmocka_run_group_tests_name("importance", tests, NULL, NULL);
}
