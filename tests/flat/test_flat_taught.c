/* SPDX-License-Identifier: BSD-2-Clause */
/* flat_taught: the thesis's steps on arrays. Expected values are the thesis's own tables, sums by hand, and closed
 * forms. What a browser makes of the same calls is in tests/web. */
#include "flat_claims.h"

#include "bis/base/vec.h"
#include "bis/scene/light_load.h"
#include "bis/thesis/errata.h"
#include "program.h"
#include "tools/verify/verify.h"

#define DIR "build/test_flat_taught"

/* white: 16 x 8 pixels of radiance 1. row: shares of 0.1, 0.2, 0.4, 0.3. */
static int setup(void **state)
{
    float ones[3 * 16 * 8];

    program_folder(DIR);
    for (size_t i = 0; i < N_OF(ones); i++) ones[i] = 1;
    write_pfm(DIR "/white.pfm", 16, 8, ones);
    write_pfm(DIR "/row.pfm", 4, 1, F(1, 0, 0, 2, 0, 0, 4, 0, 0, 3, 0, 0));
    return 0;
}

static bis_light *map_of(const char *name, const char *const *settings)
{
    char path[64];
    bis_light *light;

    snprintf(path, sizeof path, DIR "/%s.pfm", name);
    GIVES(light_open_as, &light, path, settings);
    return light;
}

/* ---- numbers, hashes ---- */

/* FNV-1a's own test vector for 64 bits; of nothing, the offset basis. */
static void a_hash_goes_on_where_it_ended(void **state)
{
    uint32_t hash[2] = {0, 0};

    bis_flat_fnv(hash, 3, (const uint8_t *)"foo");
    bis_flat_fnv(hash, 3, (const uint8_t *)"bar");
    assert_true(((uint64_t)hash[1] << 32 | hash[0]) == UINT64_C(0x85944171f73967e8));
    hash[0] = hash[1] = 0;
    bis_flat_fnv(hash, 0, NULL);
    assert_true(((uint64_t)hash[1] << 32 | hash[0]) == UINT64_C(0xcbf29ce484222325));
}

/* The library's own generator and its own rows are the other road; the sentinel is where nothing may be written. */
static void numbers_and_hashes_are_the_librarys(void **state)
{
    double u[4] = {0, 0, 0, 7};
    uint32_t hash[2 * BIS_FLAT_BITS], expected[2 * BIS_FLAT_BITS], n = 0;
    uint8_t name[64 * BIS_FLAT_BITS];
    bis_bits rows[BIS_N_BITS];
    bis_rng rng;

    bis_rng_init(&rng, 5, 6, 0, 0);
    bis_flat_uniform(5, 6, 3, u);
    for (int i = 0; i < 3; i++) assert_true(u[i] == bis_rng_double(&rng));
    assert_true(u[3] == 7);
    assert_int_equal(bis_verify_bits(rows, NULL), BIS_OK);
    GIVES(bits, hash, expected, name, &n);
    assert_int_equal(n, BIS_N_BITS);
    for (size_t i = 0; i < BIS_N_BITS; i++) {
        assert_true(((uint64_t)hash[2 * i + 1] << 32 | hash[2 * i]) == rows[i].hash);
        assert_true(((uint64_t)expected[2 * i + 1] << 32 | expected[2 * i]) == rows[i].expected);
        assert_string_equal((const char *)name + 64 * i, rows[i].name);
    }
    NO("n is NULL", bits, hash, expected, name, NULL);
}

static void a_histogram_counts_each_value_once(void **state)
{
    static const double v[8] = {-1, 0, 0.49, 0.5, 0.99, 1, 7, (double)INFINITY}, w[5] = {0.1, 0.3, 0.5, 0.7, 0.5};
    const double largest[1] = {nextafter(3, 0)};
    /* no width: all in the last cell; below the last edge; five cells of a fifth, and a count that is left alone */
    const struct { const double *v; size_t n; double unit, most; size_t cells; uint32_t right[6]; } rows[] = {
        {v, 8, 0.5, 2, 2, {3, 5, 9, 9, 9, 9}}, {v, 8, 0, 2, 2, {1, 7, 9, 9, 9, 9}},
        {largest, 1, 0.5, 6, 2, {0, 1, 9, 9, 9, 9}}, {w, 5, 0.25, 4, 5, {1, 1, 2, 1, 0, 9}},
        {w, 5, 0.5, 0, 5, {0, 0, 0, 0, 5, 9}}, {w, 5, 0.5, 1, 1, {5, 9, 9, 9, 9, 9}}};
    const struct { double unit, most; size_t cells; const char *text; } bad[] = {
        {-1, 1, 2, "2 cells from 0 to 1 times -1: give a cell or more, and numbers >= 0"},
        {0.5, 2, 0, "0 cells from 0 to 2 times 0.5"}, {0.5, -2, 3, "3 cells from 0 to -2 times 0.5"},
        {-0.5, -2, 3, "3 cells from 0 to -2 times -0.5"}, {-0.5, 0, 3, "3 cells from 0 to 0 times -0.5"},
        {HUGE_VAL, 2, 3, "3 cells from 0 to 2 times inf"}, {0.5, HUGE_VAL, 3, "3 cells from 0 to inf times 0.5"}};
    uint32_t count[6];

    for (size_t i = 0; i < N_OF(rows); i++) {
        for (int k = 0; k < 6; k++) count[k] = 9;
        GIVES(histogram, rows[i].n, rows[i].v, &rows[i].unit, rows[i].most, rows[i].cells, count);
        assert_memory_equal(count, rows[i].right, sizeof count);
    }
    for (size_t i = 0; i < N_OF(bad); i++)
        NO(bad[i].text, histogram, 5, w, &bad[i].unit, bad[i].most, bad[i].cells, count);
    NO("value 1 is no number", histogram, 2, D(1, (double)NAN), D(0.5), 2, 2, count);
}

/* ---- thesis 3.2 ---- */

static void marsaglias_list_is_the_thesiss(void **state)
{
    uint32_t list[10], length;

    GIVES(marsaglia, 4, U(1, 2, 4, 3), 10, list, &length);
    assert_int_equal(length, 10);
    assert_memory_equal(list, U(0, 1, 1, 2, 2, 2, 2, 3, 3, 3), sizeof list);
    NO("the list has 10 items, the array has room for 9", marsaglia, 4, U(1, 2, 4, 3), 9, list, &length);
}

static void alias_tables_are_those_of_the_thesis(void **state)
{
    double prob[4], total;
    uint32_t alias[4], item[4];

    GIVES(alias_build, 4, D(0.1, 0.2, 0.4, 0.3), prob, alias, &total);
    assert_true(fabs(prob[0] - 0.4) < 1e-12 && fabs(prob[1] - 0.8) < 1e-12 && prob[2] >= 1 - 1e-12);
    assert_true(alias[0] == 2 && alias[1] == 3 && fabs(total - 1) < 1e-12);
    /* bin 0 below and above its prob of 0.4, bin 1, bin 3 */
    GIVES(alias_sample, 4, prob, alias, 4, D(0.09, 0.11, 0.25, 0.99), item);
    assert_memory_equal(item, U(0, 2, 1, 3), sizeof item);
    /* of 3 each: bin 1 is all bin 0's; bin 2 its own; bin 0 is full */
    GIVES(alias_build, 3, D(6, 0, 3), prob, alias, &total);
    assert_about(total, 9, 1e-12);
    for (int i = 0; i < 3; i++) assert_about(prob[i], i != 1, 1e-12);
    assert_int_equal(alias[1], 0);
    GIVES(alias_sample, 3, prob, alias, 2, D(0.5, 0.9), item);
    assert_true(item[0] == 0 && item[1] == 2);
    GIVES(alias_sample, 3, prob, alias, 0, NULL, item);
    GIVES(alias_build, 1, D(1e-300), prob, alias, &total);
    assert_about(total, 1e-300, 1e-312);
}

/* Tables and weights come from callers, too: what they hold must not lead out of them. The largest number of bins is
 * one: the first of them is looked at. */
static void weights_and_tables_of_the_caller_are_checked(void **state)
{
    const struct { size_t n; double w[3]; const char *text; } weights[] = {
        {2, {1, HUGE_VAL}, "weight 1 is inf"}, {0, {1}, "0 weights"}, {2, {0, 0}, "all weights are 0"},
        {3, {1, 1, -1e-9}, "weight 2 is -1e-09: give finite numbers >= 0"},
        {3, {1, (double)NAN, 1}, "weight 1 is nan: give finite numbers >= 0"}, {UINT32_MAX, {-1}, "weight 0 is -1"},
        {(size_t)1 << 32, {1}, "there are 4294967296 weights: give 1 to 4294967295"}};
    const struct { size_t n; double prob[3]; uint32_t alias[3]; double u; const char *text; } tables[] = {
        {0, {0}, {0}, 0, "the tables are empty: there is nothing to draw"},
        {3, {0.5, (double)NAN, 1}, {2, 0, 1}, 0.1, "prob of bin 1 is"},
        {3, {0.5, 1.01, 1}, {2, 0, 1}, 0.1, "prob of bin 1 is"},
        {3, {0.5, -0.01, 1}, {2, 0, 1}, 0.1, "prob of bin 1 is"},
        {3, {0.5, HUGE_VAL, 1}, {2, 0, 1}, 0.1, "prob of bin 1 is"},
        {3, {0.5, 1, 0}, {2, 0, 3}, 0.1, "alias of bin 2 is 3: give items below 3"},
        {3, {0.5, 1, 0}, {UINT32_MAX, 0, 1}, 0.1, "alias of bin 0 is 4294967295"},
        {3, {0.5, 1, 0}, {2, 0, 1}, 1, "u of sample 0 is 1"}, {3, {0.5, 1, 0}, {2, 0, 1}, -0.1, "u of sample 0"},
        {(size_t)1 << 33, {0.5, 1, 0}, {2, 0, 1}, 0.1, "there are 8589934592 bins: give 1 to 4294967295"},
        {UINT32_MAX, {-1}, {0}, 0.1, "prob of bin 0 is -1: give numbers in [0, 1]"}};
    double prob[3], total;
    uint32_t alias[3], item[4];

    for (size_t i = 0; i < N_OF(weights); i++)
        NO(weights[i].text, alias_build, weights[i].n, weights[i].w, prob, alias, &total);
    for (size_t i = 0; i < N_OF(tables); i++)
        NO(tables[i].text, alias_sample, tables[i].n, tables[i].prob, tables[i].alias, 1, &tables[i].u, item);
    GIVES(alias_sample, 3, D(0.5, 1, 0), U(2, 0, 1), 4, D(0.1, 0.3, 0.5, 0.9), item);
    assert_memory_equal(item, U(0, 2, 1, 1), sizeof item);
}

/* N P is 1/3, 2/3, 1, 4/3, 5/3 at first; each step fills one bin, the sum of what is there stays N less what was given.
 */
static void the_stages_lead_from_NP_to_the_table(void **state)
{
    const double w[5] = {1, 2, 3, 4, 5};
    double prob[5], height[5], before[5], total;
    uint32_t alias[5], order[5], seen = 0;

    GIVES(alias_build, 5, w, prob, alias, &total);
    GIVES(alias_stage, 5, w, 0, order, height);
    for (int i = 0; i < 5; i++) {
        assert_about(height[i], w[i] / 3, 1e-14);
        seen |= 1u << order[i];
    }
    assert_int_equal(seen, 31);
    for (size_t k = 1; k <= 5; k++) {
        memcpy(before, height, sizeof before);
        GIVES(alias_stage, 5, w, k, order, height);
        for (size_t j = 0; j < k; j++) assert_true(height[order[j]] == prob[order[j]]);
        const uint32_t bin = order[k - 1]; /* what it lacked is its alias's no more */
        if (alias[bin] != bin) before[alias[bin]] -= 1 - prob[bin];
        for (int i = 0; i < 5; i++) assert_about(height[i], before[i], 1e-14);
    }
    NO("nothing to draw", alias_stage, 2, D(0, 0), 0, order, height);
}

static void the_cdf_is_the_running_sum(void **state)
{
    const double w[4] = {1, 0, 2, 1}, bad[3] = {1, -0.001, (double)NAN};
    double c[5];
    uint32_t guide[10] = {9, 9, 9, 9}, n_guide, item[3], part[3], first[3];

    GIVES(cdf_build, 4, w, c, guide, &n_guide);
    assert_memory_equal(guide, U(0, 2, 3, 9), 4 * sizeof *guide);
    assert_memory_equal(c, D(0, 0.25, 0.25, 0.75, 1), sizeof c);
    GIVES(cdf_sample, 4, w, 3, D(0.2, 0.25, 0.8), item, part, first);
    assert_memory_equal(item, U(0, 2, 3), sizeof item);
    /* the guide's two halves begin at what u = 0 and u = 0.5 give */
    assert_int_equal(n_guide, 2);
    assert_memory_equal(part, U(0, 0, 1), sizeof part);
    assert_memory_equal(first, U(0, 0, 2), sizeof first);
    for (int i = 0; i < 3; i++) {
        char text[64];
        snprintf(text, sizeof text, "u of sample 1 is %g: give numbers in [0, 1)", bad[i]);
        NO(text, cdf_sample, 4, w, 2, D(0, bad[i]), item, part, first);
    }
}

/* 10 and 30 of 40, where 20 each are due: (100 + 100)/20 = 10, and the twin of 20 and 20: 0. */
static void the_fit_is_pearsons(void **state)
{
    uint32_t item[40];
    double observed[2], fit[3];

    for (uint32_t i = 0; i < 40; i++) item[i] = i >= 10;
    GIVES(fit, 2, D(0.5, 0.5), 40, item, observed, fit);
    assert_true(observed[0] == 10 && observed[1] == 30 && fit[0] == 10 && fit[1] == 1 && fit[2] < 0.01);
    for (uint32_t i = 0; i < 40; i++) item[i] = i % 2;
    GIVES(fit, 2, D(0.5, 0.5), 40, item, observed, fit);
    assert_true(fit[0] == 0 && fit[2] > 0.9);
    NO("item 1 is 1, not below 1", fit, 1, D(1), 40, item, observed, fit);
    NO("weight 1 is nan", fit, 2, D(0.5, (double)NAN), 40, item, observed, fit);
}

/* 8 items, the even ones of weight 0, and u of 3 + k bits: the fraction of a black bin has 2^k values, of which the 0
 * alone returns the item as printed. Right: never. With as many bits as bins need there is one draw a bin, so all black
 * ones. */
static void few_bits_draw_what_is_impossible_as_printed_E14(void **state)
{
    const double w[8] = {0, 1, 0, 1, 0, 1, 0, 1};
    double printed[8], right[8], impossible[2];

    for (int k = 0; k <= 10; k++) {
        double dark[2] = {0, 0}, all[2] = {0, 0};
        GIVES(alias_few_bits, 8, w, 3 + k, printed, right, impossible);
        for (int i = 0; i < 8; i++) {
            all[0] += printed[i], all[1] += right[i];
            if (i % 2 == 0) dark[0] += printed[i], dark[1] += right[i];
        }
        assert_true(all[0] == 1 && all[1] == 1 && dark[0] == ldexp(0.5, -k) && dark[1] == 0);
        assert_true(impossible[0] == ldexp(1, -k) && impossible[1] == 0);
    }
    NO("numbers of 25 bits: give 0 to 24", alias_few_bits, 8, w, 25, printed, right, impossible);
    NO("numbers of -1 bits: give 0 to 24", alias_few_bits, 8, w, -1, printed, right, impossible);
}

/* Of 1 and 3 bin 0 is half item 0's, and bin 1 is all item 1's: of four u, 0 and 1/4 lie in bin 0, and only the second
 * test takes 1/4 for the upper half. No item has weight 0. One u of no bits is 0, which lies in bin 0: that of weight 0
 * is returned as printed. The most bits. */
static void few_bits_are_counted_by_hand_E14(void **state)
{
    double printed[3] = {7, 7, 7}, right[3] = {7, 7, 7}, impossible[2] = {7, 7};

    GIVES(alias_few_bits, 2, D(1, 3), 2, printed, right, impossible);
    assert_memory_equal(printed, D(0.5, 0.5, 7), sizeof printed);
    assert_memory_equal(right, D(0.25, 0.75, 7), sizeof right);
    assert_true(impossible[0] == 0 && impossible[1] == 0);
    GIVES(alias_few_bits, 2, D(0, 3), 0, printed, right, impossible);
    assert_memory_equal(printed, D(1, 0, 7), sizeof printed);
    assert_memory_equal(right, D(0, 1, 7), sizeof right);
    assert_true(impossible[0] == 1 && impossible[1] == 0);
    GIVES(alias_few_bits, 1, D(3), 24, printed, right, impossible);
    assert_true(printed[0] == 1 && right[0] == 1 && printed[1] == 0 && impossible[0] == 0);
}

/* The sum is 8, so that all numbers are exact: each pmf is the weight's own. */
static void a_table_of_eighths_gives_the_weights_own_probabilities(void **state)
{
    const double right[4] = {0.125, 0.5, 0.25, 0.125};
    double pmf[4], P[4];

    GIVES(alias_pmf, 4, D(1, 4, 2, 1), pmf, P);
    assert_memory_equal(pmf, right, sizeof right);
    assert_memory_equal(P, right, sizeof right);
    NO("nothing to draw", alias_pmf, 2, D(0, 0), pmf, P);
}

/* ---- thesis 3.3, 3.4 ---- */

/* A white map is one component of 4 pi, drawn with 1/(4 pi) everywhere. */
static void a_white_map_is_one_light(void **state)
{
    bis_light *light = map_of("white", LIST("kind=cdf", "levels=4"));
    double pdf[128], peak, share[8], area[128], factor[128], polar[2], sum = 0;
    uint32_t label[128], level[128], count[8], n;

    GIVES(light_density, light, pdf, &peak, share);
    GIVES(light_regions, light, 4, 0.5, label, level, area, factor, &n);
    assert_int_equal(n, 1);
    for (int i = 0; i < 128; i++)
        assert_true(fabs(pdf[i] - 1 / (4 * PI)) < 1e-12 && fabs(area[i] - 4 * PI) < 1e-12 && factor[i] == 1);
    for (int y = 0; y < 8; y++) {
        sum += share[y];
        assert_about(share[y], (cos(PI / 8 * y) - cos(PI / 8 * (y + 1))) / 2, 1e-12);
    }
    assert_true(fabs(sum - 1) < 1e-12 && fabs(peak - 1 / (4 * PI)) < 1e-12);
    /* Rows whose middle is within so many degrees of a pole: the two of 11.25, which are caps of 22.5; none; all. */
    const double cap = 4 * (1 - cos(PI / 8));
    const double rows[4][3] = {{30, 3, cap}, {11.25, 3, cap}, {11.2, 0, 0}, {90, 4, 4}};
    for (int k = 0; k < 4; k++) {
        GIVES(light_rows, light, 4, U(0, 15, 16, 127), rows[k][0], count, polar);
        assert_memory_equal(count, U(2, 1, 0, 0, 0, 0, 0, 1), sizeof count);
        assert_true(polar[0] == rows[k][1] && fabs(polar[1] - rows[k][2]) < 1e-12);
    }
    NO("pixel 1 is 128, not below 128", light_rows, light, 2, U(127, 128), 30, count, polar);
    NO("degrees is not a number", light_rows, light, 1, U(0), (double)NAN, count, polar);
    bis_flat_light_close(light);
    /* without the solid angle each row is drawn equally often, so that 1/16 is the middle of row 0, else in row 1 */
    float w[3], L[3];
    light = map_of("white", LIST("kind=cdf", "as_printed=E3"));
    GIVES(light_sample, light, 1, D(1 / 16., 0, 0, 0), w, L, pdf);
    assert_about((double)w[2], (1 + cos(PI / 8)) / 2, 1e-6);
    bis_flat_light_close(light);
}

/* 4 x 2 pixels: a black one, six of intensity 3 and one of 300 in a corner below. By two levels the bright one is a
 * component of its own, by one level it belongs to the others. Each pixel has pi/2 sr, far above 0.01: all factors are
 * 1 but that of the black one. Components are counted from the first row on. */
static void components_are_told_pixel_by_pixel(void **state)
{
    float file[24];
    const uint32_t dark = UINT32_MAX;
    uint32_t label[9], level[9], n = 7;
    double area[9], factor[9];

    for (int i = 0; i < 24; i++) file[i] = i / 3 == 0 ? 100 : i / 3 == 6 ? 0 : 1;
    write_pfm(DIR "/two.pfm", 4, 2, file);
    bis_light *light = map_of("two", NONE);
    for (int levels = 1; levels <= 2; levels++) {
        label[8] = level[8] = 7, area[8] = factor[8] = 7;
        GIVES(light_regions, light, levels, 2, label, level, area, factor, &n);
        assert_int_equal(n, levels);
        for (uint32_t i = 0; i < 8; i++) {
            const bool is_black = i == 2, bright = levels == 2 && i == 4;
            assert_int_equal(label[i], is_black ? dark : bright);
            assert_int_equal(level[i], is_black ? dark : bright);
            const int pixels = is_black ? 0 : bright ? 1 : 8 - levels;
            assert_true(fabs(area[i] - pixels * PI / 2) < 1e-12 && factor[i] == !is_black);
        }
        assert_true(label[8] == 7 && level[8] == 7 && area[8] == 7 && factor[8] == 7);
    }
    const struct { int levels; double b; const char *text; } cases[] = {
        {254, 10, NULL}, {1, 0, NULL}, {0, 0.5, "0 levels and exponent 0.5: give 1 to 254 and 0 to 10"},
        {255, 0.5, "255 levels and exponent 0.5"}, {4, -0.01, "4 levels and exponent -0.01"},
        {4, 10.5, "4 levels and exponent 10.5"}, {4, (double)NAN, "4 levels and exponent nan"},
    };
    for (size_t i = 0; i < N_OF(cases); i++)
        if (cases[i].text)
            NO(cases[i].text, light_regions, light, cases[i].levels, cases[i].b, label, level, area, factor, &n);
        else GIVES(light_regions, light, cases[i].levels, cases[i].b, label, level, area, factor, &n);
    bis_flat_light_close(light);
}

/* The library's own description of the light is the other road: the densities of what settings say are its densities,
 * and the twin without them has others. */
static void the_settings_of_a_map_are_those_of_its_light(void **state)
{
    static const struct { const char *settings[5]; double b; int levels; unsigned as_printed; } rows[] = {
        {{NULL}, BIS_AREA_EXPONENT, BIS_LEVELS, 0},
        {{"area_exponent=2", "levels=3", NULL}, 2, 3, 0},
        {{"levels=1", "area_exponent=10", NULL}, 10, 1, 0},
        {{"levels=254", "area_exponent=0.5", NULL}, 0.5, 254, 0},
        {{"as_printed=E3", "as_printed=E20", "area_exponent=2", NULL}, 2, BIS_LEVELS, BIS_E3 | BIS_E20},
        {{"area_exponent=0", NULL}, 0, BIS_LEVELS, 0},
    };
    static float file[32 * 64 * 3];
    static double pdf[32 * 64], share[32], first[32 * 64];
    double peak;

    for (int i = 0; i < 32 * 64 * 3; i++) file[i] = (float)(1 + i / 3 % 29 * (i / 192 % 7));
    write_pfm(DIR "/waves.pfm", 64, 32, file);
    for (size_t k = 0; k < N_OF(rows); k++) {
        char name[] = DIR "/waves.pfm";
        bis_light_desc desc = bis_light_desc_default();
        bis_light *light = map_of("waves", rows[k].settings), *own;
        desc.filename = name;
        desc.area_exponent = rows[k].b;
        desc.levels = rows[k].levels;
        desc.as_printed = rows[k].as_printed;
        assert_int_equal(bis_light_load(&own, &desc, BIS_NEED_TABLE, NULL, NULL), BIS_OK);
        GIVES(light_density, light, pdf, &peak, share);
        double most = 0;
        for (size_t i = 0; i < 32 * 64; i++) {
            assert_true(pdf[i] == bis_importance_pdf_pixel(bis_light_importance(own), i));
            most = fmax(most, pdf[i]);
        }
        assert_true(peak == most);
        if (k == 0) memcpy(first, pdf, sizeof first);
        else assert_memory_not_equal(first, pdf, sizeof first);
        bis_flat_light_close(light);
        bis_light_free(own);
    }
}

static void a_setting_of_a_map_has_its_limits(void **state)
{
#define TABLE(name) {"kind=" name, "there is no table \"" name "\": give \"alias\" or \"cdf\""}
#define EXPONENT(b) {"area_exponent=" b, "area_exponent is " b ": give a number in [0, 10]"}
    static const char *const good[] = {"kind=alias", "kind=cdf", "area_exponent=0", "area_exponent=10",
        "mapping=latlong", "width=1", "width=65536", "levels=1", "levels=254", "as_printed=E13", "as_printed=E3"};
    static const char *const none[] = {"area_exponent=", "area_exponent=1x", "width=0", "width=65537", "width=1.5",
        "width=", "levels=0", "levels=255", "levels=2.5", "levels=4x", "levels=", "levels", "as_printed=E999",
        "as_printed", "kin=cdf", "area=1", "1", "level=1"};
    static const struct { const char *setting, *text; } wrong[] = {
        TABLE("list"), TABLE(""), TABLE("alias2"), EXPONENT("-0.1"), EXPONENT("10.1"), EXPONENT("nan"),
        {"mapping=", "there is no mapping \"\": give latlong, angular, equalarea, mirrorball, verticalcross, "
                     "horizontalcross or cubestrip"}};
    bis_light *light;

    for (size_t i = 0; i < N_OF(good); i++) bis_flat_light_close(map_of("white", LIST(good[i])));
    for (size_t i = 0; i < N_OF(wrong); i++)
        NO(wrong[i].text, light_open_as, &light, DIR "/white.pfm", LIST(wrong[i].setting));
    for (size_t i = 0; i < N_OF(none); i++) {
        char text[300];
        snprintf(text, sizeof text, "\"%s\" is no setting of a map: give kind=alias or cdf, area_exponent=0 to 10, "
            "levels=1 to 254, mapping=latlong or another, width=1 to 65536, as_printed=E3", none[i]);
        NO(text, light_open_as, &light, DIR "/white.pfm", LIST(none[i]));
        assert_null(light);
    }
    /* 0.35 is pixel 2 of a CDF, in [0.3, 0.7); pixel 1 of the alias table of thesis figure 3.4, below its prob. The
     * alias table is the usual one. A pixel of a row alone has pi sr. */
    for (int k = 0; k < 4; k++) {
        const char *const settings[] = {k == 0 ? "kind=cdf" : "kind=alias", "area_exponent=0", NULL};
        float w[3], L[3];
        double pdf;
        if (k < 3) light = map_of("row", settings + (k == 2));
        else GIVES(light_open, &light, DIR "/row.pfm", "cdf", 0, NULL);
        GIVES(light_sample, light, 1, D(0.35, 0.35, 0.35, 0.35), w, L, &pdf);
        assert_true(L[0] == (k % 3 ? 2 : 4) && L[1] == 0);
        assert_about(pdf, (k % 3 ? 2 : 4) / 10. / PI, 1e-6);
        bis_flat_light_close(light);
    }
}

/* The mean over four white pixels is white; a map is not made larger; one pixel is a square, and no light probe. */
static void a_shrunk_map_keeps_its_light(void **state)
{
    const int rows[3][3] = {{8, 8, 4}, {99, 16, 8}, {1, 1, 1}};
    bis_light *light = map_of("white", NONE), *small;
    int shape[2];

    for (int k = 0; k < 3; k++) {
        GIVES(light_shrink, &small, light, rows[k][0]);
        bis_flat_light_shape(small, shape);
        assert_true(shape[0] == rows[k][1] && shape[1] == rows[k][2]);
        assert_about(bis_flat_light_power(small), 12 * PI, 1e-5);
        bis_flat_light_close(small);
    }
    NO("0 columns: give 1 or more", light_shrink, &small, light, 0);
    assert_null(small);
    bis_flat_light_close(light);
}

/* A NaN must not become an index, and a direction of any length is one: an azimuth of 225 degrees is column 10 of 16,
 * 125.3 degrees from the zenith row 5 of 8. */
static void directions_of_the_caller_are_checked(void **state)
{
    bis_light *light = map_of("white", NONE);
    uint32_t at;

    GIVES(light_find, light, 1, F(-1e30f, -1e30f, -1e30f), &at);
    assert_int_equal(at, 5 * 16 + 10);
    NO("direction 0 is", light_find, light, 1, F(NAN, 0, 1), &at);
    NO("direction 0 is", light_find, light, 1, F(0, 0, 0), &at);
    bis_flat_light_close(light);
}

/* ---- thesis 3.5 ---- */

static const double up[3] = {0, 0, 1}, half[3] = {0.5, 0.5, 0.5}, black[3] = {0, 0, 0};

static bis_bsdf *phong(const double *Kd, const double *Ks, double n, const double *normal, const double *wo)
{
    bis_bsdf *b;
    GIVES(bsdf_open, &b, "phong", Kd, Ks, n, normal, wo);
    return b;
}

/* Phong with Kd alone reflects Kd, and nothing lies below the horizon; quadrature by 200 x 200 midpoints is exact to
 * 1e-5. One cell: the cosine is 1/2, its solid angle 2 pi. */
static void a_diffuse_material_loses_nothing(void **state)
{
    bis_bsdf *b = phong(half, black, 1, up, up);
    double sum[3];

    GIVES(bsdf_albedo, b, up, 200, sum);
    assert_true(fabs(sum[0] - 0.5) < 1e-5 && fabs(sum[2]) < 1e-5);
    GIVES(bsdf_albedo, b, up, 1, sum);
    assert_true(fabs(sum[0] - 2 * PI * 0.5 * 0.5 / PI) < 1e-6 && fabs(sum[1] - 2 * PI * 0.5 / PI) < 1e-6);
    NO("n is 0: give 1 to 4096", bsdf_albedo, b, up, 0, sum);
    NO("n is 4097: give 1 to 4096", bsdf_albedo, b, up, 4097, sum);
    NO("normal is (0, 0, 0)", bsdf_albedo, b, black, 4, sum);
    bis_flat_bsdf_close(b);
}

/* A lobe of exponent 0 is a hemisphere about the mirror's direction, of density 1/(2 pi). At 60 degrees two thirds of
 * it lie above the horizon, and the integral of the cosine over these is pi/2 (1 + cos 60 degrees), by projection: 3/8
 * is reflected for a Ks of 1, here of 0.6 in the mean. The normal is any. By 400 x 400 midpoints, whose edge cells are
 * a thousandth. */
static void a_hemisphere_as_a_lobe_loses_a_third_at_60_degrees(void **state)
{
    const double n[3] = {2, 4, 4};
    double wo[3], sum[4] = {0, 0, 0, 7};

    /* a vector across the normal, (2, -2, 1)/3 */
    for (int k = 0; k < 3; k++) wo[k] = n[k] / 6 / 2 + sqrt(0.75) * D(2, -2, 1)[k] / 3;
    bis_bsdf *b = phong(black, D(0.3, 0.5, 1), 0, n, wo);
    GIVES(bsdf_albedo, b, n, 400, sum);
    assert_true(fabs(sum[0] - 0.6 * 3 / 8) < 1e-3 && fabs(sum[1] - 2.0 / 3) < 2e-3 && sum[2] == 1 - sum[1]);
    assert_true(sum[3] == 7);
    bis_flat_bsdf_close(b);
}

/* The diffuse term is the same on both sides: Kd/pi cos, by a density of cos/pi. A lobe peaks at the mirror's angle,
 * away from the eye, with (n + 1)/(2 pi); the twin is the eye's own side. Straight down there is a plane, too. */
static void the_plane_of_the_eye_shows_the_lobe_at_the_mirrors_angle(void **state)
{
    const double eye[2][3] = {{-sqrt(3), 0, 1}, {0, 0, 1}}, at[4] = {-60, 0, 60, 120};
    double f_cos[4], pdf[4];

    for (int k = 0; k < 2; k++) {
        bis_bsdf *b = phong(half, black, 1, up, eye[k]);
        GIVES(bsdf_plane, b, D(0, 0, 2), 4, at, f_cos, pdf);
        for (int i = 0; i < 4; i++) {
            const double cosine = fmax(0, cos(at[i] * PI / 180));
            assert_true(fabs(f_cos[i] - 0.5 * cosine / PI) < 1e-6 && fabs(pdf[i] - cosine / PI) < 1e-6);
        }
        bis_flat_bsdf_close(b);
    }
    bis_bsdf *b = phong(black, D(1, 1, 1), 100, up, eye[0]);
    GIVES(bsdf_plane, b, up, 4, at, f_cos, pdf);
    assert_true(fabs(pdf[2] / (101 / (2 * PI)) - 1) < 1e-4 && fabs(f_cos[2] / pdf[2] - 0.5) < 1e-4 && pdf[0] < 1e-6);
    NO("angle 1 is nan: give a number", bsdf_plane, b, up, 2, D(1, (double)NAN), f_cos, pdf);
    NO("normal is (0, 0, 0)", bsdf_plane, b, black, 1, D(0), f_cos, pdf);
    bis_flat_bsdf_close(b);
}

static void what_lies_below_the_horizon_is_counted(void **state)
{
    bis_bsdf *b = phong(half, half, 1, up, up);
    uint8_t below[4];
    uint32_t count;

    /* above, on it, below, above */
    GIVES(bsdf_below, b, 4, F(0, 0, 1, 1, 0, 0, 0, 0.6f, -0.8f, 0, 0.6f, 0.8f), below, &count);
    assert_memory_equal(below, ((uint8_t[]){0, 1, 1, 0}), sizeof below);
    assert_int_equal(count, 2);
    NO("direction 1 is no number", bsdf_below, b, 2, F(0, 0, 1, 0, NAN, 0), below, &count);
    bis_flat_bsdf_close(b);
}

/* ---- no memory, NULL ---- */

/* One step of those that take memory; what it makes is freed. */
static int step_without_memory(int k, void *of)
{
    bis_light *light = of;
    const double w[3] = {1, 2, 3};
    static double v[128], x[128], y[128];
    static uint32_t i[128], j[128], n;
    bis_light *small = NULL;

    switch (k) {
    case 0: return bis_flat_marsaglia(3, U(1, 2, 3), 9, i, &n, SAY);
    case 1: return bis_flat_alias_stage(3, w, 1, i, v, SAY);
    case 2: return bis_flat_alias_pmf(3, w, v, x, SAY);
    case 3: return bis_flat_alias_few_bits(3, w, 3, v, x, y, SAY);
    case 4: return bis_flat_cdf_build(3, w, v, i, &n, SAY);
    case 5: return bis_flat_cdf_sample(3, w, 1, D(0.5), i, j, &n, SAY);
    case 6: return bis_flat_fit(3, D(0.5, 0.25, 0.25), 4, U(0, 0, 1, 2), v, x, SAY);
    case 7: return bis_flat_light_regions(light, 2, 1, i, j, v, x, &n, SAY);
    case 8: return bis_flat_compare(1, 1, F(1, 1, 1, 1), F(1, 1, 1, 1), v, SAY);
    }
    const int status = k == 9 ? bis_flat_light_shrink(&small, light, 8, SAY)
                          : bis_flat_light_open_as(&small, DIR "/white.pfm", NONE, SAY);
    assert_true((status == BIS_OK) == (small != NULL));
    bis_flat_light_close(small);
    return status;
}

static void without_memory_a_step_says_so_and_keeps_none(void **state)
{
    bis_light *light = map_of("white", NONE);

    assert_steps_without_memory(step_without_memory, 11, light);
    bis_flat_light_close(light);
}

/* Where there is no status, a NULL is left alone. */
static void null_is_left_alone_where_there_is_no_status(void **state)
{
    uint32_t hash[2] = {1, 0};

    bis_flat_uniform(1, 1, 3, NULL);
    bis_flat_fnv(NULL, 1, (const uint8_t *)"");
    bis_flat_fnv(hash, 1, NULL);
    assert_int_equal(hash[0], 1);
}

/* Two pixels of 2 in each channel are the reference, and one channel of 6 is 3 more: the squares' mean is 9/6, the
 * relative one's (9/(4 + 4/100))/6, the bias 3/6. The fourth channel is not looked at. The twin: equal pictures. */
static void two_pictures_are_compared_as_the_program_does(void **state)
{
    const float a[8] = {2, 5, 2, 1, 2, 2, 2, 1}, b[8] = {2, 2, 2, 9, 2, 2, 2, 9};
    const float c[16] = {1, 2, 3, 9, 1, 2, 3, 9, 1, 2, 3, 9, 1, 2, 3, 9};
    double sum[3];

    GIVES(compare, 2, 1, a, b, sum);
    assert_true(fabs(sum[0] - sqrt(1.5)) < 1e-12 && fabs(sum[1] - 1.5 / 4.04) < 1e-12 && fabs(sum[2] - 0.5) < 1e-12);
    GIVES(compare, 1, 2, b, b, sum);
    assert_true(sum[0] == 0 && sum[1] == 0 && sum[2] == 0);
    for (int i = 12; i < 15; i++) { /* the last pixel, and its last channel */
        float d[16];
        memcpy(d, c, sizeof d);
        d[i] += 6;
        GIVES(compare, 2, 2, c, d, sum);
        assert_true(fabs(sum[0] - sqrt(36 / 12.0)) < 1e-12 && fabs(sum[2] + 0.5) < 1e-12);
    }
    NO("0 x 2", compare, 0, 2, a, b, sum);
    NO("b is NULL", compare, 2, 1, a, NULL, sum);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_hash_goes_on_where_it_ended),
        cmocka_unit_test(numbers_and_hashes_are_the_librarys),
        cmocka_unit_test(a_histogram_counts_each_value_once),
        cmocka_unit_test(marsaglias_list_is_the_thesiss),
        cmocka_unit_test(alias_tables_are_those_of_the_thesis),
        cmocka_unit_test(weights_and_tables_of_the_caller_are_checked),
        cmocka_unit_test(the_stages_lead_from_NP_to_the_table),
        cmocka_unit_test(the_cdf_is_the_running_sum),
        cmocka_unit_test(the_fit_is_pearsons),
        cmocka_unit_test(few_bits_draw_what_is_impossible_as_printed_E14),
        cmocka_unit_test(few_bits_are_counted_by_hand_E14),
        cmocka_unit_test(a_table_of_eighths_gives_the_weights_own_probabilities),
        cmocka_unit_test(a_white_map_is_one_light),
        cmocka_unit_test(components_are_told_pixel_by_pixel),
        cmocka_unit_test(the_settings_of_a_map_are_those_of_its_light),
        cmocka_unit_test(a_setting_of_a_map_has_its_limits),
        cmocka_unit_test(a_shrunk_map_keeps_its_light),
        cmocka_unit_test(directions_of_the_caller_are_checked),
        cmocka_unit_test(a_diffuse_material_loses_nothing),
        cmocka_unit_test(a_hemisphere_as_a_lobe_loses_a_third_at_60_degrees),
        cmocka_unit_test(the_plane_of_the_eye_shows_the_lobe_at_the_mirrors_angle),
        cmocka_unit_test(what_lies_below_the_horizon_is_counted),
        cmocka_unit_test(without_memory_a_step_says_so_and_keeps_none),
        cmocka_unit_test(null_is_left_alone_where_there_is_no_status),
        cmocka_unit_test(two_pictures_are_compared_as_the_program_does),
    };
    return cmocka_run_group_tests_name("flat taught", tests, setup, NULL);
}
