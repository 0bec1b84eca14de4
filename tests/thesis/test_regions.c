/* SPDX-License-Identifier: BSD-2-Clause */
/* Tests of regions: levels by their definition, components against a union of all pairs of neighbours, symmetries (E18,
 * E19). */
#include "bis/thesis/regions.h"

#include "bis/base/mem.h"
#include "bis/thesis/rng.h"
#include "claim.h"
#include "map_help.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

#ifdef _OPENMP
#include <omp.h>
#else
#define omp_set_num_threads(n)
#endif

static bis_regions regions_of(const bis_envmap *em, int levels)
{
    bis_regions r;
    assert_int_equal(bis_regions_init(&r, em, levels, NULL), BIS_OK);
    return r;
}

static double sum_of(const bis_regions *r)
{
    double sum = 0;
    for (uint32_t k = 0; k < r->n; k++) sum += r->solid_angle[k];
    return sum;
}

/* ---- levels ---- */

static void levels_are_equal_steps_of_the_logarithm_E18(void **state)
{
    bis_envmap em = map_new(4, 2);
    em.pixels[0].g = 1;
    em.pixels[1].g = 65536;
    const bis_levels l = bis_levels_of(&em, 8);
    assert_int_equal(bis_level_of_intensity(&l, 0), BIS_LEVEL_NONE);
    assert_int_equal(bis_level_of_intensity(&l, 1), 0);
    assert_int_equal(bis_level_of_intensity(&l, 65536), 7);
    for (int bin = 0; bin < 8; bin++) { /* a level is a factor of 4 */
        assert_int_equal(bis_level_of_intensity(&l, pow(4, bin) * 1.001), bin);
        assert_int_equal(bis_level_of_intensity(&l, pow(4, bin) * 3.999), bin);
    }
    bis_envmap_clear(&em);
}

static void a_constant_map_is_one_region_of_4_pi_E18(void **state)
{
    const int sizes[][2] = {{1, 1}, {2, 1}, {1, 5}, {7, 4}, {64, 32}};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        bis_envmap em = map_new(sizes[i][0], sizes[i][1]);
        for (size_t k = 0; k < map_n(&em); k++) em.pixels[k] = (rgb){1, 2, 3};
        bis_regions r = regions_of(&em, 8);
        assert_int_equal(r.n, 1);
        assert_int_equal(r.level[0], 0);
        assert_near(r.solid_angle[0] / (4 * PI), 1, 1e-12);
        bis_regions_clear(&r);
        bis_envmap_clear(&em);
    }
}

static void black_pixels_belong_to_no_region(void **state)
{
    bis_envmap em = map_new(8, 4);
    bis_regions r = regions_of(&em, 8);
    assert_int_equal(r.n, 0);
    for (size_t i = 0; i < map_n(&em); i++) assert_true(r.label[i] == BIS_REGION_NONE);
    bis_regions_clear(&r);
    em.pixels[11].b = FLT_TRUE_MIN;
    r = regions_of(&em, 8);
    assert_int_equal(r.n, 1);
    assert_int_equal(r.label[11], 0);
    assert_near(r.solid_angle[0], em.row_solid_angle[1], 1e-15);
    bis_regions_clear(&r);
    bis_envmap_clear(&em);
}

static void contrast_of_the_whole_float_range_fills_all_levels(void **state)
{
    bis_envmap em = map_new(256, 1);
    for (int x = 0; x < 256; x++) em.pixels[x].r = (float)pow(2, -149 + 276.9 * x / 255);
    bis_regions r = regions_of(&em, 254);
    bool seen[254] = {false};
    for (uint32_t k = 0; k < r.n; k++) seen[r.level[k]] = true;
    int n = 0;
    for (int i = 0; i < 254; i++) n += seen[i];
    assert_true(n > 200);
    assert_true(seen[0] && seen[253]);
    bis_regions_clear(&r);
    bis_envmap_clear(&em);
}

/* 1000 is no power of two: values near a level's edge may round across it, so the map keeps away from edges. */
static void labels_do_not_change_with_exposure_E18(void **state)
{
    bis_envmap em = map_new(32, 16);
    bis_rng g;
    bis_rng_init(&g, 3, 0, 0, 0);
    for (size_t i = 0; i < map_n(&em); i++) em.pixels[i].g = (float)pow(10, 0.25 + 0.5 * (double)bis_rng_below(&g, 17));
    em.pixels[0].g = (float)pow(10, 0.0);
    em.pixels[1].g = (float)pow(10, 8.5);
    bis_regions before = regions_of(&em, 17);
    for (size_t i = 0; i < map_n(&em); i++) em.pixels[i].g *= 1000;
    bis_regions after = regions_of(&em, 17);
    assert_int_equal(before.n, after.n);
    assert_memory_equal(before.label, after.label, map_n(&em) * sizeof *before.label);
    assert_memory_equal(before.level, after.level, before.n);
    bis_regions_clear(&before);
    bis_regions_clear(&after);
    bis_envmap_clear(&em);
}

/* The twin of E18: 0 has no logarithm, so equal bins in log(1 + I), from 0 on. */
static int level_of_log_1_plus(const bis_levels *l, double intensity, double most)
{
    return (int)fmin(17 * log1p(intensity) / log1p(most), 16);
}

static int level_of_log(const bis_levels *l, double intensity, double most)
{
    return bis_level_of_intensity(l, intensity);
}

/* How many pixels change their level when a map of 8.5 decades is exposed 1000 times as long. */
static int changed_levels(int (*level)(const bis_levels *l, double intensity, double most))
{
    bis_envmap em = map_new(18, 1);
    int before[18] = {0}, changed = 0;
    for (int longer = 0; longer < 2; longer++) {
        for (int x = 0; x < 18; x++) { /* away from the levels' edges, but for the ends */
            em.pixels[x].g = (float)pow(10, 0.5 * x + (x == 0 || x == 17 ? 0 : 0.25) + 3 * longer);
        }
        const bis_levels l = bis_levels_of(&em, 17);
        for (int x = 0; x < 18; x++) {
            const int now = level(&l, map_intensity(&em, (size_t)x), map_intensity(&em, 17));
            changed += longer && now != before[x];
            before[x] = now;
        }
    }
    bis_envmap_clear(&em);
    return changed;
}

static void bins_in_log_of_1_plus_I_change_with_exposure_E18(void **state)
{
    assert_int_equal(changed_levels(level_of_log), 0);
    assert_true(changed_levels(level_of_log_1_plus) > 5);
}

/* ---- components ---- */

/* The definition without any cleverness: each pair of neighbours is joined until nothing changes. */
static bool are_neighbours(const bis_envmap *em, size_t a, size_t b, bool wrap)
{
    const int w = em->width, h = em->height;
    const int xa = (int)a % w, ya = (int)a / w, xb = (int)b % w, yb = (int)b / w;
    if (ya == yb && (ya == 0 || ya == h - 1)) return true;
    if (xa == xb) return abs(ya - yb) == 1;
    return ya == yb && (abs(xa - xb) == 1 || (wrap && abs(xa - xb) == w - 1));
}

static size_t root(const size_t *parent, size_t i)
{
    while (parent[i] != i) i = parent[i];
    return i;
}

static size_t *brute_force(const bis_envmap *em, int levels, bool wrap)
{
    const bis_levels l = bis_levels_of(em, levels);
    const size_t n = map_n(em);
    size_t *parent = malloc(n * sizeof *parent);
    for (size_t i = 0; i < n; i++) parent[i] = i;
    for (size_t a = 0; a < n; a++) {
        for (size_t b = a + 1; b < n; b++) {
            if (map_intensity(em, a) == 0 || map_intensity(em, b) == 0) continue;
            if (bis_level_of_intensity(&l, map_intensity(em, a)) != bis_level_of_intensity(&l, map_intensity(em, b)))
                continue;
            if (are_neighbours(em, a, b, wrap)) parent[root(parent, a)] = root(parent, b);
        }
    }
    return parent;
}

/* Do labels and parents divide the lit pixels in the same way? */
static bool same_partition(const bis_envmap *em, const bis_regions *r, const size_t *parent)
{
    for (size_t a = 0; a < map_n(em); a++) {
        for (size_t b = 0; b < a; b++) {
            if (map_intensity(em, a) == 0 || map_intensity(em, b) == 0) continue;
            if ((r->label[a] == r->label[b]) != (root(parent, a) == root(parent, b))) return false;
        }
    }
    return true;
}

static void components_are_those_of_joining_all_neighbours_E19(void **state)
{
    const int sizes[][2] = {{1, 1}, {2, 2}, {1, 9}, {9, 1}, {8, 4}, {7, 5}, {16, 8}, {5, 9}, {13, 3},
                            {3, 150}, {6, 130}}; /* the last two are several bands of rows, which are searched apart */
    int twin_caught = 0;
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        for (uint64_t seed = 0; seed < 30; seed++) {
            bis_envmap em = map_random(sizes[i][0], sizes[i][1], 6, seed % 3 ? 0.2 : 0, seed);
            const int levels = 1 + (int)(seed % 5);
            bis_regions r = regions_of(&em, levels);
            size_t *parent = brute_force(&em, levels, true), *twin = brute_force(&em, levels, false);
            assert_true(same_partition(&em, &r, parent));
            twin_caught += !same_partition(&em, &r, twin);

            /* Each label is used, each region's pixels have its level and add up to its solid angle. */
            const bis_levels l = bis_levels_of(&em, levels);
            double *area = calloc(r.n + 1, sizeof *area);
            uint32_t seen = 0; /* labels are numbered in the order of their first pixels */
            for (size_t k = 0; k < map_n(&em); k++) {
                if (r.label[k] != BIS_REGION_NONE && r.label[k] >= seen) assert_int_equal(r.label[k], seen++);
                assert_true((r.label[k] == BIS_REGION_NONE) == (map_intensity(&em, k) == 0));
                if (r.label[k] == BIS_REGION_NONE) continue;
                assert_true(r.label[k] < r.n);
                assert_int_equal(r.level[r.label[k]], bis_level_of_intensity(&l, map_intensity(&em, k)));
                area[r.label[k]] += map_solid_angle(&em, k);
            }
            for (uint32_t k = 0; k < r.n; k++) assert_near(area[k], r.solid_angle[k], 1e-14);
            free(area);
            free(parent);
            free(twin);
            bis_regions_clear(&r);
            bis_envmap_clear(&em);
        }
    }
    assert_true(twin_caught > 20); /* without the joined edges the same comparison fails */
}

static void a_light_on_the_seam_is_one_region_E19(void **state)
{
    bis_envmap em = map_new(16, 8);
    em.pixels[4 * 16].r = em.pixels[4 * 16 + 15].r = 5;
    bis_regions r = regions_of(&em, 8);
    assert_int_equal(r.n, 1);
    assert_near(r.solid_angle[0], 2 * em.row_solid_angle[4], 1e-15);
    /* twin: ended at the seam these are two, each with the factor of half the area, 0.5^0.15 = 0.90 */
    size_t *twin = brute_force(&em, 8, false);
    assert_false(same_partition(&em, &r, twin));
    const double A = r.solid_angle[0] / 100; /* below the clamp of 0.01 sr */
    assert_near(bis_area_factor(A / 2, 0.15) / bis_area_factor(A, 0.15), 0.90, 0.002);
    free(twin);
    bis_regions_clear(&r);
    bis_envmap_clear(&em);
}

static void pixels_around_a_pole_touch_there_and_nowhere_else_E19(void **state)
{
    for (int y = 0; y < 8; y++) {
        bis_envmap em = map_new(15, 8); /* odd: "the pixel opposite" would not even exist */
        em.pixels[y * 15 + 2].r = em.pixels[y * 15 + 8].r = em.pixels[y * 15 + 12].r = 5;
        bis_regions r = regions_of(&em, 8);
        assert_int_equal(r.n, y == 0 || y == 7 ? 1 : 3);
        bis_regions_clear(&r);
        bis_envmap_clear(&em);
    }
}

/* Two levels alternate around the pole: all of one level are one region, all of the other another. */
static void levels_do_not_mix_at_the_pole(void **state)
{
    bis_envmap em = map_new(64, 2);
    for (int x = 0; x < 64; x++) em.pixels[x].g = x % 2 ? 1.0f : 1000.0f;
    bis_regions r = regions_of(&em, 4);
    assert_int_equal(r.n, 2);
    assert_near(r.solid_angle[0], r.solid_angle[1], 1e-12);
    bis_regions_clear(&r);
    bis_envmap_clear(&em);
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void rolling_the_map_changes_no_area_and_areas_sum_to_4_pi_E19(void **state)
{
    const int widths[] = {32, 31, 2, 1};
    for (int i = 0; i < 4; i++) {
        bis_envmap em = map_random(widths[i], 16, 7, 0, 77);
        bis_regions r = regions_of(&em, 4);
        assert_near(sum_of(&r) / (4 * PI), 1, 1e-12);
        qsort(r.solid_angle, r.n, sizeof *r.solid_angle, by_size);
        for (int k = 0; k < widths[i]; k++) {
            bis_envmap rolled = map_rolled(&em, k);
            bis_regions s = regions_of(&rolled, 4);
            assert_int_equal(s.n, r.n);
            qsort(s.solid_angle, s.n, sizeof *s.solid_angle, by_size);
            for (uint32_t j = 0; j < r.n; j++) assert_near(s.solid_angle[j] / r.solid_angle[j], 1, 1e-12);
            bis_regions_clear(&s);
            bis_envmap_clear(&rolled);
        }
        bis_regions_clear(&r);
        bis_envmap_clear(&em);
    }
}

/* The label is the number of the component in the order of first pixels, whatever the bands and the threads. */
static void labels_are_in_the_order_of_first_pixels(void **state)
{
    bis_envmap em = map_random(40, 300, 5, 0.2, 9);
    uint32_t *first = NULL;
    for (int threads = 1; threads <= 7; threads += 3) {
        omp_set_num_threads(threads);
        bis_regions r = regions_of(&em, 3);
        uint32_t n = 0;
        for (size_t i = 0; i < map_n(&em); i++) {
            if (r.label[i] == BIS_REGION_NONE) continue;
            assert_true(r.label[i] <= n);
            n += r.label[i] == n;
        }
        assert_int_equal(n, r.n);
        if (first) assert_memory_equal(first, r.label, map_n(&em) * sizeof *first);
        else first = memcpy(malloc(map_n(&em) * sizeof *first), r.label, map_n(&em) * sizeof *first);
        bis_regions_clear(&r);
    }
    omp_set_num_threads(2);
    free(first);
    bis_envmap_clear(&em);
}

/* Two combs, with teeth that point up and down: components of a band are many, and joined by the next one alone. */
static void combs_are_joined_across_bands(void **state)
{
    for (int up = 0; up < 2; up++) {
        bis_envmap em = map_new(301, 200);
        for (int y = 1; y < 199; y++)
            for (int x = 1; x < 300; x++) em.pixels[y * 301 + x].g = x % 2 == 0 || y == (up ? 198 : 1) ? 1 : 0;
        bis_regions r = regions_of(&em, 8);
        assert_int_equal(r.n, 1);
        double area = 0; /* 149 teeth, and 150 pixels between them and beside them */
        for (int y = 1; y < 199; y++) area += 149 * em.row_solid_angle[y];
        assert_near(r.solid_angle[0], area + 150 * em.row_solid_angle[1], 1e-11);
        bis_regions_clear(&r);
        bis_envmap_clear(&em);
    }
}

/* A snake of one level through the whole map: a recursive search would need as many frames as pixels. */
static void a_long_winding_region_is_found_without_recursion(void **state)
{
    bis_envmap em = map_new(2048, 1025);
    for (int y = 0; y < em.height; y++) {
        for (int x = 0; x < em.width; x++) {
            const bool path = y % 2 == 0 ? x > 0 : x == (y % 4 == 1 ? em.width - 1 : 1);
            em.pixels[(size_t)y * 2048 + (size_t)x].r = path ? 100.0f : 1.0f;
        }
    }
    bis_regions r = regions_of(&em, 2);
    size_t bright = 0;
    for (uint32_t k = 0; k < r.n; k++) bright += r.level[k] == 1;
    assert_int_equal(bright, 1);
    bis_regions_clear(&r);
    bis_envmap_clear(&em);
}

static void the_area_factor_is_clamped_at_a_hundredth_steradian(void **state)
{
    assert_near(bis_area_factor(0.01, 0.15), 1, 0);
    assert_near(bis_area_factor(12, 0.15), 1, 0);
    assert_near(bis_area_factor(0.005, 0.2) / bis_area_factor(0.0025, 0.2), pow(2, 0.2), 1e-14);
    assert_near(bis_area_factor(1e-9, 0), 1, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(levels_are_equal_steps_of_the_logarithm_E18),
        cmocka_unit_test(a_constant_map_is_one_region_of_4_pi_E18),
        cmocka_unit_test(black_pixels_belong_to_no_region),
        cmocka_unit_test(contrast_of_the_whole_float_range_fills_all_levels),
        cmocka_unit_test(labels_do_not_change_with_exposure_E18),
        cmocka_unit_test(bins_in_log_of_1_plus_I_change_with_exposure_E18),
        cmocka_unit_test(components_are_those_of_joining_all_neighbours_E19),
        cmocka_unit_test(a_light_on_the_seam_is_one_region_E19),
        cmocka_unit_test(pixels_around_a_pole_touch_there_and_nowhere_else_E19),
        cmocka_unit_test(levels_do_not_mix_at_the_pole),
        cmocka_unit_test(rolling_the_map_changes_no_area_and_areas_sum_to_4_pi_E19),
        cmocka_unit_test(labels_are_in_the_order_of_first_pixels),
        cmocka_unit_test(combs_are_joined_across_bands),
        cmocka_unit_test(a_long_winding_region_is_found_without_recursion),
        cmocka_unit_test(the_area_factor_is_clamped_at_a_hundredth_steradian),
    };
    return cmocka_run_group_tests_name("regions", tests, NULL, NULL);
}
