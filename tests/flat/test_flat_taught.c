/* SPDX-License-Identifier: BSD-2-Clause */
/* flat_taught: the thesis's steps on arrays. Expected values are the thesis's own tables, sums by hand, and closed
 * forms. What a browser makes of the same calls is in tests/web. */
#include "bis/base/clock.h"
#include "bis/flat/taught.h"
#include "bis/base/vec.h"
#include "bis/scene/light_load.h"
#include "bis/thesis/errata.h"
#include "claim.h"
#include "lack.h"
#include "program.h"
#include "tools/verify/verify.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define DIR "build/test_flat_taught"
#define SCENE                                                                                                        \
    "text=Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\nLookAt 0 -4 2  0 0 0  0 0 1\n"            \
    "Camera \"perspective\" \"float fov\" 20\nWorldBegin\nLightSource \"infinite\" \"string filename\" \"" DIR \
    "/white.pfm\"\nMaterial \"phong\" \"float Kd\" 0.5 \"float Ks\" 0\nShape \"disk\" \"float radius\" 5\n"

static char say[512];
#define SAY say, sizeof say

/* A map of 16 x 8 pixels of radiance 1. */
static int setup(void **state)
{
    program_folder(DIR);
    FILE *out = fopen(DIR "/white.pfm", "wb");
    if (!out) return 1;
    fprintf(out, "PF\n16 8\n-1.0\n");
    for (int i = 0; i < 3 * 16 * 8; i++) fwrite(&(float){1}, sizeof(float), 1, out);
    return fclose(out);
}

static void refuses(int status, const char *text)
{
    assert_int_equal(status, BIS_INPUT);
    if (!strstr(say, text)) fail_msg("no \"%s\" in: %s", text, say);
}

static void marsaglias_list_is_the_thesiss(void **state)
{
    const uint32_t right[10] = {0, 1, 1, 2, 2, 2, 2, 3, 3, 3};
    uint32_t list[10], length;

    assert_int_equal(bis_flat_marsaglia(4, (uint32_t[]){1, 2, 4, 3}, 10, list, &length, SAY), 0);
    assert_int_equal(length, 10);
    assert_memory_equal(list, right, sizeof right);
    refuses(bis_flat_marsaglia(4, (uint32_t[]){1, 2, 4, 3}, 9, list, &length, SAY),
        "the list has 10 items, the array has room for 9");
}

/* N P is 1/3, 2/3, 1, 4/3, 5/3 at first; each step fills one bin, the sum of what is there stays N less what was given.
 */
static void the_stages_lead_from_NP_to_the_table(void **state)
{
    const double w[5] = {1, 2, 3, 4, 5};
    double prob[5], height[5], total;
    uint32_t alias[5], order[5], seen = 0;

    assert_int_equal(bis_flat_alias_build(5, w, prob, alias, &total, SAY), 0);
    assert_int_equal(bis_flat_alias_stage(5, w, 0, order, height, SAY), 0);
    for (int i = 0; i < 5; i++) assert_true(fabs(height[i] - w[i] / 3) < 1e-14);
    for (int i = 0; i < 5; i++) seen |= 1u << order[i];
    assert_int_equal(seen, 31);
    double before[5];
    for (size_t k = 1; k <= 5; k++) {
        memcpy(before, height, sizeof before);
        assert_int_equal(bis_flat_alias_stage(5, w, k, order, height, SAY), 0);
        for (size_t j = 0; j < k; j++) assert_true(height[order[j]] == prob[order[j]]);
        const uint32_t bin = order[k - 1]; /* what it lacked is its alias's no more */
        if (alias[bin] != bin) before[alias[bin]] -= 1 - prob[bin];
        for (int i = 0; i < 5; i++) assert_true(fabs(height[i] - before[i]) < 1e-14);
    }
    refuses(bis_flat_alias_stage(2, (double[]){0, 0}, 0, order, height, SAY), "nothing to draw");
}

static void the_cdf_is_the_running_sum(void **state)
{
    const double w[4] = {1, 0, 2, 1}, right[5] = {0, 0.25, 0.25, 0.75, 1};
    double c[5];
    uint32_t guide[10] = {9, 9, 9, 9}, n_guide, item[3], part[3], first[3];

    assert_int_equal(bis_flat_cdf_build(4, w, c, guide, &n_guide, SAY), 0);
    assert_memory_equal(guide, ((uint32_t[]){0, 2, 3, 9}), 4 * sizeof *guide);
    for (int i = 0; i < 5; i++) assert_true(c[i] == right[i]);
    assert_int_equal(bis_flat_cdf_sample(4, w, 3, (double[]){0.2, 0.25, 0.8}, item, part, first, SAY), 0);
    assert_memory_equal(item, ((uint32_t[]){0, 2, 3}), sizeof item);
    /* the guide's two halves begin at what u = 0 and u = 0.5 give */
    assert_int_equal(n_guide, 2);
    assert_memory_equal(part, ((uint32_t[]){0, 0, 1}), sizeof part);
    assert_memory_equal(first, ((uint32_t[]){0, 0, 2}), sizeof first);
    const double bad[] = {1, -0.001, (double)NAN};
    for (int i = 0; i < 3; i++) {
        char text[64];
        snprintf(text, sizeof text, "u of sample 1 is %g: give numbers in [0, 1)", bad[i]);
        refuses(bis_flat_cdf_sample(4, w, 2, (double[]){0, bad[i]}, item, part, first, SAY), text);
    }
}

/* 10 and 30 of 40, where 20 each are due: (100 + 100)/20 = 10, and the twin of 20 and 20: 0. */
static void the_fit_is_pearsons(void **state)
{
    uint32_t item[40];
    double observed[2], fit[3];

    for (uint32_t i = 0; i < 40; i++) item[i] = i >= 10;
    assert_int_equal(bis_flat_fit(2, (double[]){0.5, 0.5}, 40, item, observed, fit, SAY), 0);
    assert_true(observed[0] == 10 && observed[1] == 30 && fit[0] == 10 && fit[1] == 1 && fit[2] < 0.01);
    for (uint32_t i = 0; i < 40; i++) item[i] = i % 2;
    assert_int_equal(bis_flat_fit(2, (double[]){0.5, 0.5}, 40, item, observed, fit, SAY), 0);
    assert_true(fit[0] == 0 && fit[2] > 0.9);
    refuses(bis_flat_fit(1, (double[]){1}, 40, item, observed, fit, SAY), "item 1 is 1, not below 1");
    refuses(bis_flat_fit(2, (double[]){0.5, NAN}, 40, item, observed, fit, SAY), "weight 1 is nan");
    refuses(bis_flat_fit(2, (double[]){-0.5, 1.5}, 40, item, observed, fit, SAY), "weight 0 is -0.5");
}

/* 8 items, the even ones of weight 0, and u of 3 + k bits: the fraction of a black bin has 2^k values, of which the 0
 * alone returns the item as printed. Right: never. With as many bits as bins need there is one draw a bin, so all black
 * ones. */
static void few_bits_draw_what_is_impossible_as_printed_E14(void **state)
{
    const double w[8] = {0, 1, 0, 1, 0, 1, 0, 1};
    double printed[8], right[8], impossible[2];

    for (int k = 0; k <= 10; k++) {
        double black[2] = {0, 0}, all[2] = {0, 0};
        assert_int_equal(bis_flat_alias_few_bits(8, w, 3 + k, printed, right, impossible, SAY), 0);
        for (int i = 0; i < 8; i++) {
            all[0] += printed[i], all[1] += right[i];
            if (i % 2 == 0) black[0] += printed[i], black[1] += right[i];
        }
        assert_true(all[0] == 1 && all[1] == 1 && black[0] == ldexp(0.5, -k) && black[1] == 0);
        assert_true(impossible[0] == ldexp(1, -k) && impossible[1] == 0);
    }
    refuses(bis_flat_alias_few_bits(8, w, 25, printed, right, impossible, SAY), "numbers of 25 bits: give 0 to 24");
    refuses(bis_flat_alias_few_bits(8, w, -1, printed, right, impossible, SAY), "numbers of -1 bits: give 0 to 24");
}

/* Of 1 and 3 bin 0 is half item 0's, and bin 1 is all item 1's: of four u, 0 and 1/4 lie in bin 0, and only the second
 * test takes 1/4 for the upper half. No item has weight 0. One u of no bits is 0, which lies in bin 0: that of weight 0
 * is returned as printed. The most bits. */
static void few_bits_are_counted_by_hand_E14(void **state)
{
    double printed[3] = {7, 7, 7}, right[3] = {7, 7, 7}, impossible[2] = {7, 7};

    assert_int_equal(bis_flat_alias_few_bits(2, (double[]){1, 3}, 2, printed, right, impossible, SAY), 0);
    assert_memory_equal(printed, ((double[]){0.5, 0.5, 7}), sizeof printed);
    assert_memory_equal(right, ((double[]){0.25, 0.75, 7}), sizeof right);
    assert_true(impossible[0] == 0 && impossible[1] == 0);
    assert_int_equal(bis_flat_alias_few_bits(2, (double[]){0, 3}, 0, printed, right, impossible, SAY), 0);
    assert_memory_equal(printed, ((double[]){1, 0, 7}), sizeof printed);
    assert_memory_equal(right, ((double[]){0, 1, 7}), sizeof right);
    assert_true(impossible[0] == 1 && impossible[1] == 0);
    assert_int_equal(bis_flat_alias_few_bits(1, (double[]){3}, 24, printed, right, impossible, SAY), 0);
    assert_true(printed[0] == 1 && right[0] == 1 && printed[1] == 0 && impossible[0] == 0);
}

/* The sum is 8, so that all numbers are exact: each pmf is the weight's own. */
static void a_table_of_eighths_gives_the_weights_own_probabilities(void **state)
{
    const double w[4] = {1, 4, 2, 1}, right[4] = {0.125, 0.5, 0.25, 0.125};
    double pmf[4], P[4];

    assert_int_equal(bis_flat_alias_pmf(4, w, pmf, P, SAY), 0);
    assert_memory_equal(pmf, right, sizeof right);
    assert_memory_equal(P, right, sizeof right);
    refuses(bis_flat_alias_pmf(2, (double[]){0, 0}, pmf, P, SAY), "nothing to draw");
}

/* FNV-1a's own test vector for 64 bits. */
static void a_hash_goes_on_where_it_ended(void **state)
{
    uint32_t hash[2] = {0, 0};

    bis_flat_fnv(hash, 3, (const uint8_t *)"foo");
    bis_flat_fnv(hash, 3, (const uint8_t *)"bar");
    assert_true(((uint64_t)hash[1] << 32 | hash[0]) == UINT64_C(0x85944171f73967e8));
    /* of nothing: the offset basis */
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
    assert_int_equal(bis_flat_bits(hash, expected, name, &n, SAY), 0);
    assert_int_equal(n, BIS_N_BITS);
    for (size_t i = 0; i < BIS_N_BITS; i++) {
        assert_true(((uint64_t)hash[2 * i + 1] << 32 | hash[2 * i]) == rows[i].hash);
        assert_true(((uint64_t)expected[2 * i + 1] << 32 | expected[2 * i]) == rows[i].expected);
        assert_string_equal((const char *)name + 64 * i, rows[i].name);
    }
    refuses(bis_flat_bits(hash, expected, name, NULL, SAY), "n is NULL");
}

static void a_histogram_counts_each_value_once(void **state)
{
    const double v[8] = {-1, 0, 0.49, 0.5, 0.99, 1, 7, (double)INFINITY};
    uint32_t count[2];

    const double half = 0.5, none = 0, below = -1, largest = nextafter(3, 0);
    assert_int_equal(bis_flat_histogram(8, v, &half, 2, 2, count, SAY), 0);
    assert_true(count[0] == 3 && count[1] == 5);
    assert_int_equal(bis_flat_histogram(8, v, &none, 2, 2, count, SAY), 0);
    assert_true(count[0] == 1 && count[1] == 7);
    assert_int_equal(bis_flat_histogram(1, &largest, &half, 6, 2, count, SAY), 0);
    assert_true(count[0] == 0 && count[1] == 1);
    refuses(bis_flat_histogram(2, (double[]){1, (double)NAN}, &half, 2, 2, count, SAY), "value 1 is no number");
    refuses(bis_flat_histogram(8, v, &below, 1, 2, count, SAY),
        "2 cells from 0 to 1 times -1: give a cell or more, and numbers >= 0");
    /* five cells of a fifth, and a count that is left alone; no width; one cell */
    const double w[5] = {0.1, 0.3, 0.5, 0.7, 0.5};
    uint32_t five[6] = {9, 9, 9, 9, 9, 9};
    assert_int_equal(bis_flat_histogram(5, w, (double[]){0.25}, 4, 5, five, SAY), 0);
    assert_memory_equal(five, ((uint32_t[]){1, 1, 2, 1, 0, 9}), sizeof five);
    assert_int_equal(bis_flat_histogram(5, w, &half, 0, 5, five, SAY), 0);
    assert_memory_equal(five, ((uint32_t[]){0, 0, 0, 0, 5, 9}), sizeof five);
    assert_int_equal(bis_flat_histogram(5, w, &half, 1, 1, five, SAY), 0);
    assert_int_equal(five[0], 5);
    const struct { double unit, most; size_t cells; const char *text; } bad[] = {
        {0.5, 2, 0, "0 cells from 0 to 2 times 0.5"}, {0.5, -2, 3, "3 cells from 0 to -2 times 0.5"},
        {-0.5, -2, 3, "3 cells from 0 to -2 times -0.5"}, {-0.5, 0, 3, "3 cells from 0 to 0 times -0.5"},
        {HUGE_VAL, 2, 3, "3 cells from 0 to 2 times inf"}, {0.5, HUGE_VAL, 3, "3 cells from 0 to inf times 0.5"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        refuses(bis_flat_histogram(5, w, &bad[i].unit, bad[i].most, bad[i].cells, five, SAY), bad[i].text);
}

/* A white map is one component of 4 pi, drawn with 1/(4 pi) everywhere. */
static void a_white_map_is_one_light(void **state)
{
    bis_light *light;
    double pdf[128], peak, share[8], area[128], factor[128], polar[2], sum = 0;
    uint32_t label[128], level[128], count[8], n;

    assert_int_equal(
        bis_flat_light_open_as(&light, DIR "/white.pfm", (const char *[]){"kind=cdf", "levels=4", NULL}, SAY), 0);
    assert_int_equal(bis_flat_light_density(light, pdf, &peak, share, SAY), 0);
    assert_int_equal(bis_flat_light_regions(light, 4, 0.5, label, level, area, factor, &n, SAY), 0);
    assert_int_equal(n, 1);
    for (int i = 0; i < 128; i++)
        assert_true(fabs(pdf[i] - 1 / (4 * PI)) < 1e-12 && fabs(area[i] - 4 * PI) < 1e-12 && factor[i] == 1);
    for (int y = 0; y < 8; y++) {
        sum += share[y];
        assert_true(fabs(share[y] - (cos(PI / 8 * y) - cos(PI / 8 * (y + 1))) / 2) < 1e-12);
    }
    assert_true(fabs(sum - 1) < 1e-12 && fabs(peak - 1 / (4 * PI)) < 1e-12);
    /* two of the eight rows are within 30 degrees of a pole by their middles: caps of 22.5 degrees */
    assert_int_equal(bis_flat_light_rows(light, 4, (uint32_t[]){0, 15, 16, 127}, 30, count, polar, SAY), 0);
    assert_memory_equal(count, ((uint32_t[8]){2, 1, 0, 0, 0, 0, 0, 1}), sizeof count);
    assert_true(polar[0] == 3 && fabs(polar[1] - 4 * (1 - cos(PI / 8))) < 1e-12);
    /* rows whose middle is 11.25 degrees from a pole; none; all */
    assert_int_equal(bis_flat_light_rows(light, 4, (uint32_t[]){0, 15, 16, 127}, 11.25, count, polar, SAY), 0);
    assert_true(polar[0] == 3 && fabs(polar[1] - 4 * (1 - cos(PI / 8))) < 1e-12);
    assert_int_equal(bis_flat_light_rows(light, 4, (uint32_t[]){0, 15, 16, 127}, 11.2, count, polar, SAY), 0);
    assert_true(polar[0] == 0 && polar[1] == 0);
    assert_int_equal(bis_flat_light_rows(light, 4, (uint32_t[]){0, 15, 16, 127}, 90, count, polar, SAY), 0);
    assert_true(polar[0] == 4 && fabs(polar[1] - 4) < 1e-12);
    refuses(bis_flat_light_rows(light, 2, (uint32_t[]){127, 128}, 30, count, polar, SAY),
        "pixel 1 is 128, not below 128");
    refuses(bis_flat_light_rows(light, 4, (uint32_t[]){0, 15, 16, 127}, NAN, count, polar, SAY),
        "degrees is not a number");
    bis_flat_light_close(light);
    /* without the solid angle each row is drawn equally often, so that 1/16 is the middle of row 0, else in row 1 */
    const char *const printed[] = {"kind=cdf", "as_printed=E3", NULL};
    float w[3], L[3];
    assert_int_equal(bis_flat_light_open_as(&light, DIR "/white.pfm", printed, SAY), 0);
    assert_int_equal(bis_flat_light_sample(light, 1, (double[]){1 / 16., 0, 0, 0}, w, L, pdf, SAY), 0);
    assert_true(fabs((double)w[2] - (1 + cos(PI / 8)) / 2) < 1e-6);
    bis_flat_light_close(light);
}

/* 4 x 2 pixels: a black one, six of intensity 3 and one of 300 in a corner below. By two levels the bright one is a
 * component of its own, by one level it belongs to the others. Each pixel has pi/2 sr, far above 0.01: all factors are
 * 1 but that of the black one. Components are counted from the first row on. */
static void components_are_told_pixel_by_pixel(void **state)
{
    float file[2][4][3];
    const uint32_t dark = UINT32_MAX;
    bis_light *light;

    for (int i = 0; i < 24; i++) file[i / 12][i / 3 % 4][i % 3] = i / 3 == 0 ? 100 : i / 3 == 6 ? 0 : 1;
    FILE *out = fopen(DIR "/two.pfm", "wb");
    assert_non_null(out);
    fprintf(out, "PF\n4 2\n-1.0\n");
    fwrite(file, sizeof file, 1, out);
    assert_int_equal(fclose(out), 0);
    assert_int_equal(bis_flat_light_open_as(&light, DIR "/two.pfm", (const char *[]){NULL}, SAY), 0);
    for (int levels = 1; levels <= 2; levels++) {
        uint32_t label[9], level[9], n = 7;
        double area[9], factor[9];
        label[8] = level[8] = 7, area[8] = factor[8] = 7;
        assert_int_equal(bis_flat_light_regions(light, levels, 2, label, level, area, factor, &n, SAY), 0);
        assert_int_equal(n, levels);
        for (uint32_t i = 0; i < 8; i++) {
            const bool black = i == 2, bright = levels == 2 && i == 4;
            assert_int_equal(label[i], black ? dark : bright);
            assert_int_equal(level[i], black ? dark : bright);
            const int pixels = black ? 0 : bright ? 1 : 8 - levels;
            assert_true(fabs(area[i] - pixels * PI / 2) < 1e-12 && factor[i] == !black);
        }
        assert_true(label[8] == 7 && level[8] == 7 && area[8] == 7 && factor[8] == 7);
    }
    uint32_t label[8], level[8], n;
    double area[8], factor[8];
    const struct { int levels; double b; const char *text; } cases[] = {
        {254, 10, NULL}, {1, 0, NULL}, {0, 0.5, "0 levels and exponent 0.5: give 1 to 254 and 0 to 10"},
        {255, 0.5, "255 levels and exponent 0.5"}, {4, -0.01, "4 levels and exponent -0.01"},
        {4, 10.5, "4 levels and exponent 10.5"}, {4, (double)NAN, "4 levels and exponent nan"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const int status = bis_flat_light_regions(light, cases[i].levels, cases[i].b, label, level, area, factor, &n,
            SAY);
        if (cases[i].text) refuses(status, cases[i].text);
        else assert_int_equal(status, 0);
    }
    bis_flat_light_close(light);
}

/* The library's own description of the light is the other road: the densities of what settings say are its densities,
 * and the twin without them has others. A row of {1, 2, 4, 3}: CDFs draw in order, so 0.35 is pixel 2; of alias tables
 * pixel 1 (thesis figure 3.4). */
static void the_settings_of_a_map_are_those_of_its_light(void **state)
{
    static const struct { const char *settings[5]; bis_light_desc desc; } rows[] = {
        {{NULL}, {.area_exponent = BIS_AREA_EXPONENT, .levels = BIS_LEVELS}},
        {{"area_exponent=2", "levels=3", NULL}, {.area_exponent = 2, .levels = 3}},
        {{"levels=1", "area_exponent=10", NULL}, {.area_exponent = 10, .levels = 1}},
        {{"levels=254", "area_exponent=0.5", NULL}, {.area_exponent = 0.5, .levels = 254}},
        {{"as_printed=E3", "as_printed=E20", "area_exponent=2", NULL},
         {.area_exponent = 2, .levels = BIS_LEVELS, .as_printed = BIS_E3 | BIS_E20}},
        {{"area_exponent=0", NULL}, {.area_exponent = 0, .levels = BIS_LEVELS}},
    };
    static float file[32][64][3];
    static double pdf[32 * 64], share[32], first[32 * 64];
    double peak;

    for (int i = 0; i < 32 * 64 * 3; i++) file[i / 192][i / 3 % 64][i % 3] = (float)(1 + i / 3 % 29 * (i / 192 % 7));
    FILE *out = fopen(DIR "/waves.pfm", "wb");
    assert_non_null(out);
    fprintf(out, "PF\n64 32\n-1.0\n");
    fwrite(file, sizeof file, 1, out);
    assert_int_equal(fclose(out), 0);
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        char name[] = DIR "/waves.pfm";
        bis_light_desc desc = bis_light_desc_default();
        bis_light *light, *own;
        desc.filename = name;
        desc.area_exponent = rows[k].desc.area_exponent;
        desc.levels = rows[k].desc.levels;
        desc.as_printed = rows[k].desc.as_printed;
        assert_int_equal(bis_light_load(&own, &desc, BIS_NEED_TABLE, NULL, NULL), BIS_OK);
        assert_int_equal(bis_flat_light_open_as(&light, name, rows[k].settings, SAY), 0);
        assert_int_equal(bis_flat_light_density(light, pdf, &peak, share, SAY), 0);
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
#define TABLE(name) "there is no table \"" name "\": give \"alias\" or \"cdf\""
#define SHORT(setting, is_good) {setting, is_good, NULL}
#define EXPONENT(b) "area_exponent is " b ": give a number in [0, 10]"
    static const struct { const char *setting; bool is_good; const char *text; } rows[] = {
        SHORT("kind=alias", true), SHORT("kind=cdf", true), {"kind=list", false, TABLE("list")},
        {"kind=", false, TABLE("")}, {"kind=alias2", false, TABLE("alias2")}, SHORT("area_exponent=0", true),
        SHORT("area_exponent=10", true), {"area_exponent=-0.1", false, EXPONENT("-0.1")},
        {"area_exponent=10.1", false, EXPONENT("10.1")}, SHORT("area_exponent=", false),
        SHORT("area_exponent=1x", false), {"area_exponent=nan", false, EXPONENT("nan")},
        SHORT("mapping=latlong", true),
        {"mapping=", false, "there is no mapping \"\"; `bis help lights` lists them, as \"latlong\""},
        SHORT("width=1", true), SHORT("width=65536", true), SHORT("width=0", false), SHORT("width=65537", false),
        SHORT("width=1.5", false), SHORT("width=", false), SHORT("levels=1", true), SHORT("levels=254", true),
        SHORT("levels=0", false), SHORT("levels=255", false), SHORT("levels=2.5", false), SHORT("levels=4x", false),
        SHORT("levels=", false), SHORT("levels", false), SHORT("as_printed=E13", true), SHORT("as_printed=E3", true),
        SHORT("as_printed=E999", false), SHORT("as_printed", false), SHORT("kin=cdf", false), SHORT("area=1", false),
        SHORT("1", false), SHORT("level=1", false),
    };
    bis_light *light;

    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char text[300];
        const int status = bis_flat_light_open_as(&light, DIR "/white.pfm", (const char *[]){rows[i].setting, NULL},
            SAY);
        if (rows[i].text)
            snprintf(text, sizeof text, "%s", rows[i].text);
        else
            snprintf(text, sizeof text, "\"%s\" is no setting of a map: give kind=alias or cdf, area_exponent=0 to "
                "10, levels=1 to 254, mapping=latlong or another, width=1 to 65536, as_printed=E3", rows[i].setting);
        if (rows[i].is_good) assert_int_equal(status, 0);
        else refuses(status, text);
        assert_int_equal(light != NULL, rows[i].is_good);
        bis_flat_light_close(light);
    }
    /* shares of 0.1, 0.2, 0.4, 0.3: 0.35 is pixel 2 of a CDF, pixel 1 of the alias table of thesis figure 3.4 */
    static const float row[4][3] = {{1, 0, 0}, {2, 0, 0}, {4, 0, 0}, {3, 0, 0}};
    FILE *out = fopen(DIR "/row.pfm", "wb");
    assert_non_null(out);
    fprintf(out, "PF\n4 1\n-1.0\n");
    fwrite(row, sizeof row, 1, out);
    assert_int_equal(fclose(out), 0);
    for (int k = 0; k < 3; k++) {
        const char *const settings[] = {k == 0 ? "kind=cdf" : "kind=alias", "area_exponent=0", NULL};
        float w[3], L[3];
        double pdf;
        assert_int_equal(bis_flat_light_open_as(&light, DIR "/row.pfm", settings + (k == 2), SAY), 0);
        assert_int_equal(bis_flat_light_sample(light, 1, (double[]){0.35, 0.35, 0.35, 0.35}, w, L, &pdf, SAY), 0);
        assert_true(L[0] == (k == 0 ? 4 : 2) && L[1] == 0);
        bis_flat_light_close(light);
    }
}

/* A pixel of 4 at the zenith of a white map is a component of 2 pi/64 (1 - cos(pi/32)), which is below 0.01 sr: with b
 * = 1 its density is 4 times that over 0.01 of the others'. */
static void a_small_light_is_drawn_by_its_area(void **state)
{
    enum { W = 64, H = 32 };
    float *pixels = test_malloc(3 * W * H * sizeof *pixels);
    double *pdf = test_malloc(W * H * sizeof *pdf), peak, share[H];
    const double factor = 2 * PI / W * (1 - cos(PI / H)) / 0.01;
    bis_light *light;

    for (int i = 0; i < 3 * W * H; i++) pixels[i] = i / 3 == (H - 1) * W ? 4 : 1; /* from the bottom row */
    FILE *out = fopen(DIR "/small.pfm", "wb");
    assert_non_null(out);
    fprintf(out, "PF\n%d %d\n-1.0\n", W, H);
    fwrite(pixels, 3 * sizeof *pixels, W * H, out);
    assert_int_equal(fclose(out), 0);
    assert_int_equal(
        bis_flat_light_open_as(&light, DIR "/small.pfm", (const char *[]){"area_exponent=1", NULL}, SAY), 0);
    assert_int_equal(bis_flat_light_density(light, pdf, &peak, share, SAY), 0);
    assert_true(fabs(pdf[0] / pdf[1] - 4 * factor) < 1e-6); /* the factor is stored as a float */
    bis_flat_light_close(light);
    test_free(pixels);
    test_free(pdf);
}

/* The mean over four white pixels is white; a map is not made larger. */
static void a_shrunk_map_keeps_its_light(void **state)
{
    bis_light *light, *small, *same;
    int shape[2];

    assert_int_equal(bis_flat_light_open_as(&light, DIR "/white.pfm", (const char *[]){NULL}, SAY), 0);
    assert_int_equal(bis_flat_light_shrink(&small, light, 8, SAY), 0);
    assert_int_equal(bis_flat_light_shrink(&same, light, 99, SAY), 0);
    bis_flat_light_shape(small, shape);
    assert_true(shape[0] == 8 && shape[1] == 4);
    bis_flat_light_shape(same, shape);
    assert_true(shape[0] == 16 && shape[1] == 8);
    assert_true(
        fabs(bis_flat_light_power(small) - 12 * PI) < 1e-5 && fabs(bis_flat_light_power(same) - 12 * PI) < 1e-5);
    bis_light *none;
    refuses(bis_flat_light_shrink(&none, light, 0, SAY), "0 columns: give 1 or more");
    assert_null(none);
    assert_int_equal(bis_flat_light_shrink(&none, light, 1, SAY), 0); /* a square, and no light probe for it */
    bis_flat_light_shape(none, shape);
    assert_true(shape[0] == 1 && shape[1] == 1);
    bis_flat_light_close(none);
    bis_flat_light_close(light);
    bis_flat_light_close(small);
    bis_flat_light_close(same);
}

/* A diffuse floor under radiance 1 in R, G and B reflects 3 Kd = 1.5 everywhere, and nothing hides the light. */
static void a_point_of_a_diffuse_floor_is_known(void **state)
{
    bis_flat_stage *stage;
    double found[8], value[4], sum[6], L[64], w[64], u[64], bound[2], height[64];
    float wi[192];
    uint32_t chosen[64], kind[64], taken[64], accepted, n = 0;
    const char *const sir[] = {"integrator=sir", "candidates=64", "shadowrays=8", "proposal=mix", "learn=false", NULL};

    assert_int_equal(bis_flat_stage_open(&stage, "scene", (const char *[]){SCENE, NULL}, SAY), 0);
    refuses(bis_flat_stage_exact(stage, 1, value, SAY), "no point was chosen");
    assert_int_equal(bis_flat_stage_at(stage, 4, 4, found, SAY), 0);
    assert_true(found[0] == 1 && fabs(found[6] - 1) < 1e-6);
    assert_int_equal(bis_flat_stage_exact(stage, 1, value, SAY), 0);
    assert_true(fabs(value[0] - 1.5) <= 6 * value[1] + 1e-6 && fabs(value[2] - 1.5) <= 6 * value[3] + 1e-6);
    assert_int_equal(bis_flat_stage_runs(stage, sir, 1, 64, L, sum, SAY), 0);
    assert_true(fabs(sum[0] - 1.5) <= 6 * sum[1] / 8 + 1e-6);
    assert_int_equal(bis_flat_stage_candidates(stage, sir, 1, 64, wi, w, chosen, kind, sum, SAY), 0);
    for (int i = 0; i < 64; i++) n += chosen[i];
    assert_int_equal(n, 8);
    /* M, N, and nothing is hidden: the estimate with V is the one without, and each that was chosen has a ray */
    n = 0;
    for (int i = 0; i < 64; i++) n += chosen[i] > 0;
    assert_true(sum[0] == 64 && sum[1] == 8 && sum[2] > 1 && sum[2] <= 64 && sum[5] == n);
    assert_true(fabs(sum[3] - sum[4]) < 1e-6); /* floats */
    n = 0;
    assert_int_equal(bis_flat_stage_bounds(stage, bound, SAY), 0);
    for (int i = 0; i < 64; i++) assert_true(w[i] <= fmax(bound[0], bound[1]) * (1 + 1e-5));
    /* u times the bound of 1 over w itself: every other candidate lies just below its weight, the others just above */
    for (int k = 0; k < 2; k++) {
        const double B = bound[k];
        for (int i = 0; i < 64; i++) u[i] = w[i] / B * (i % 2 ? 1.001 : 0.999);
        assert_int_equal(
            bis_flat_stage_accept(stage, k ? "brdf" : "em", 64, w, u, height, taken, &accepted, SAY), 0);
        n = 0;
        for (int i = 0; i < 64; i++) {
            assert_true(taken[i] == (w[i] > 0 && i % 2 == 0) && fabs(height[i] - u[i] * B) <= 1e-12 * B);
            n += taken[i];
        }
        assert_true(accepted == n && n > 0);
    }
    refuses(bis_flat_stage_accept(stage, "em", 1, (double[]){NAN}, u, height, taken, &accepted, SAY),
        "candidate 0 is no number");
    refuses(bis_flat_stage_accept(stage, "em", 1, w, (double[]){NAN}, height, taken, &accepted, SAY),
        "candidate 0 is no number");
    refuses(bis_flat_stage_accept(stage, "mix", 64, w, u, height, taken, &accepted, SAY),
        "proposal \"mix\" has no bound: give em or brdf");
    refuses(bis_flat_stage_candidates(stage, sir, 1, 63, wi, w, chosen, kind, sum, SAY),
        "64 candidates do not fit into arrays of 63");
    refuses(
        bis_flat_stage_candidates(stage, (const char *[]){"integrator=em", NULL}, 1, 64, wi, w, chosen, kind, sum, SAY),
        "integrator \"em\" has no candidates to show: give sir");
    bis_flat_stage_close(stage);
}

/* Pixel (4, 3) of 8 x 8 lies half a pixel aside and half a pixel above the middle, which is the origin; the camera sees
 * 10 degrees to each side, and looks along (0, 2, -1). Up in its picture is (0, 1, 2), and aside is -x, as in pbrt,
 * whose hands are left ones. A camera that looks at the sky sees nothing. */
static void a_pixel_shows_the_point_on_the_floor(void **state)
{
    static const char *const up[] = {SCENE, "camera=LookAt 0 -4 2  0 -4 9  0 1 0 Camera \"perspective\"", NULL};
    const double a = tan(10 * PI / 180) / 8, l = sqrt(5);
    const double d[3] = {-a, (2 + a) / l, (2 * a - 1) / l}, k = -2 / d[2];
    const double right[8] = {1, k * d[0], k * d[1] - 4, 0, 0, 0, 1,
                             k * sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])};
    const int outside[4][2] = {{8, 0}, {0, 8}, {-1, 3}, {3, -1}};
    bis_flat_stage *stage;
    double found[9] = {7, 7, 7, 7, 7, 7, 7, 7, 7}, bound[2];

    assert_int_equal(bis_flat_stage_open(&stage, "scene", (const char *[]){SCENE, NULL}, SAY), 0);
    assert_int_equal(bis_flat_stage_at(stage, 4, 3, found, SAY), 0);
    for (int i = 0; i < 8; i++) assert_true(fabs(found[i] - right[i]) < 1e-5);
    assert_true(found[8] == 7);
    for (int i = 0; i < 2; i++) assert_int_equal(bis_flat_stage_at(stage, 7 * i, 7 * i, found, SAY), 0);
    for (int i = 0; i < 4; i++) {
        char text[64];
        snprintf(text, sizeof text, "pixel (%d, %d) is outside 8 x 8", outside[i][0], outside[i][1]);
        refuses(bis_flat_stage_at(stage, outside[i][0], outside[i][1], found, SAY), text);
    }
    bis_flat_stage_close(stage);
    assert_int_equal(bis_flat_stage_open(&stage, "scene", up, SAY), 0);
    assert_int_equal(bis_flat_stage_at(stage, 4, 3, found, SAY), 0);
    for (int i = 0; i < 8; i++) assert_true(found[i] == 0);
    refuses(bis_flat_stage_bounds(stage, bound, SAY),
        "no point was chosen, or its pixel sees no surface: choose another one");
    bis_flat_stage_close(stage);
}

/* A wall across the floor behind the point: what goes towards +y is hidden. */
#define WALL \
    "Shape \"trianglemesh\" \"point3 P\" [-9999 .5 -9999  9999 .5 -9999  0 .5 99999] \"integer indices\" [0 1 2]\n"

/* Candidates of a diffuse floor of 0.5 under radiance 1: f cos Le is 1.5 cos/pi, the map draws by 1/(4 pi), the BRDF by
 * cos/pi; a mixture by both, in proportion to what is from the map. So each weight follows from the direction. The wall
 * hides half of the sky: which candidates are seen follows from the direction, too, and the estimate is L_ns times the
 * share of the choices that are. Behind the candidates all is 0. */
static void candidates_are_known_by_their_directions(void **state)
{
    enum { M = 48, N = 6, ROOM = 50 };
    static const char *const proposals[3] = {"proposal=em", "proposal=brdf", "proposal=mix"};
    bis_flat_stage *stage;
    double found[8];

    assert_int_equal(bis_flat_stage_open(&stage, "scene", (const char *[]){SCENE WALL, NULL}, SAY), 0);
    assert_int_equal(bis_flat_stage_at(stage, 4, 4, found, SAY), 0);
    for (int k = 0; k < 3; k++) {
        const char *const sir[] = {
            "integrator=sir", "candidates=48", "shadowrays=6", proposals[k], "learn=false", NULL};
        float wi[3 * ROOM + 1];
        double w[ROOM + 1], sum[7], W = 0, squares = 0, seen = 0, other[ROOM];
        uint32_t chosen[ROOM + 1], kind[ROOM + 1], n = 0, n_map = 0, distinct = 0;
        wi[3 * ROOM] = 7, w[ROOM] = sum[6] = 7, chosen[ROOM] = kind[ROOM] = 7;
        assert_int_equal(bis_flat_stage_candidates(stage, sir, 5, ROOM, wi, w, chosen, kind, sum, SAY), 0);
        for (int i = 0; i < M; i++) n_map += kind[i] & 1;
        const double beta = (double)n_map / M;
        for (int i = 0; i < M; i++) {
            const double z = (double)wi[3 * i + 2], y = (double)wi[3 * i + 1], x = (double)wi[3 * i];
            n += chosen[i];
            distinct += chosen[i] > 0;
            W += w[i];
            squares += w[i] * w[i];
            if (w[i] <= 0) continue;
            assert_true(fabs(x * x + y * y + z * z - 1) < 1e-6);
            assert_true(fabs(w[i] - 6 * z / (beta + 4 * (1 - beta) * z)) < 1e-5);
            if (chosen[i]) assert_int_equal(kind[i] & 2, y < 0 ? 2 : 0);
            if (kind[i] & 2) seen += chosen[i];
        }
        assert_int_equal(n, N);
        assert_true(k == 0 ? n_map == M : k == 1 ? n_map == 0 : n_map > 0 && n_map < M);
        for (int i = M; i < ROOM; i++)
            assert_true(wi[3 * i] == 0 && wi[3 * i + 1] == 0 && wi[3 * i + 2] == 0 && w[i] == 0 && chosen[i] == 0 &&
                        kind[i] == 0);
        assert_true(wi[3 * ROOM] == 7 && w[ROOM] == 7 && sum[6] == 7 && chosen[ROOM] == 7 && kind[ROOM] == 7);
        assert_true(sum[0] == M && sum[1] == N && sum[5] == distinct && fabs(sum[2] - W * W / squares) < 1e-9 * M);
        assert_true(seen > 0 && seen < N);
        assert_true(fabs(sum[4] - W / M) < 1e-5 && fabs(sum[3] - W / M * seen / N) < 1e-5);
        /* the seed is used, and nothing else */
        assert_int_equal(bis_flat_stage_candidates(stage, sir, 5, ROOM, wi, other, chosen, kind, sum, SAY), 0);
        assert_memory_equal(other, w, sizeof other);
        assert_int_equal(bis_flat_stage_candidates(stage, sir, 6, ROOM, wi, other, chosen, kind, sum, SAY), 0);
        if (k != 1) assert_memory_not_equal(other, w, sizeof other);
    }
    bis_flat_stage_close(stage);
}

/* The estimates' own mean and deviation; by the BRDF each has its 7 rays, because none of a diffuse floor go down. Half
 * of the light is hidden. The exact value is another one at another point and by another seed, and it is kept. */
static void runs_are_summed_up_and_the_exact_value_is_of_its_point(void **state)
{
    enum { N = 50 };
    static const char *const brdf[] = {"integrator=brdf", "samples=7", NULL};
    bis_flat_stage *stage;
    double found[8], L[N + 1], sum[4], first[5], again[5], mean = 0, square = 0;

    assert_int_equal(bis_flat_stage_open(&stage, "scene", (const char *[]){SCENE WALL, NULL}, SAY), 0);
    assert_int_equal(bis_flat_stage_at(stage, 4, 4, found, SAY), 0);
    L[N] = sum[3] = first[4] = again[4] = 7;
    assert_int_equal(bis_flat_stage_runs(stage, brdf, 1, N, L, sum, SAY), 0);
    for (int i = 0; i < N; i++) mean += L[i] / N;
    for (int i = 0; i < N; i++) square += (L[i] - mean) * (L[i] - mean) / (N - 1);
    assert_true(fabs(sum[0] - mean) < 1e-12 && fabs(sum[1] - sqrt(square)) < 1e-12 && square > 1e-3 && sum[2] == 7);
    assert_true(L[N] == 7 && sum[3] == 7);
    refuses(bis_flat_stage_runs(stage, brdf, 1, 1, L, sum, SAY), "1 estimates: give 2 to 1000000");
    refuses(bis_flat_stage_runs(stage, brdf, 1, 1000001, L, sum, SAY), "1000001 estimates: give 2 to 1000000");
    assert_int_equal(bis_flat_stage_runs(stage, brdf, 1, 2, L, sum, SAY), 0);
    /* the integrator of a question is forgotten */
    refuses(bis_flat_stage_runs(stage, (const char *[]){"samples=7", NULL}, 1, 2, L, sum, SAY), "no parameter");

    assert_int_equal(bis_flat_stage_exact(stage, 3, first, SAY), 0);
    assert_true(fabs(first[0] - 0.75) <= 6 * first[1] + 1e-3 && first[1] < 1e-3);
    assert_true(fabs(first[2] - 1.5) <= 6 * first[3]);
    assert_int_equal(bis_flat_stage_exact(stage, 3, again, SAY), 0);
    assert_memory_equal(first, again, sizeof first);
    for (uint32_t other = 0; other <= 4; other += 4) { /* 0: a seed as any other */
        assert_int_equal(bis_flat_stage_exact(stage, other, again, SAY), 0);
        assert_true(again[0] != first[0]);
        assert_int_equal(bis_flat_stage_exact(stage, 3, again, SAY), 0);
        assert_memory_equal(first, again, sizeof first);
    }
    assert_int_equal(bis_flat_stage_at(stage, 4, 7, found, SAY), 0);
    assert_int_equal(bis_flat_stage_exact(stage, 3, again, SAY), 0);
    assert_true(again[0] != first[0]);
    assert_int_equal(bis_flat_stage_at(stage, 4, 4, found, SAY), 0);
    assert_int_equal(bis_flat_stage_exact(stage, 3, again, SAY), 0);
    assert_memory_equal(first, again, sizeof first);
    bis_flat_stage_close(stage);
}

/* A grid of 4 columns and 3 rows over the map: directions by phi and theta. The lower pole belongs to the last row, and
 * a phi that rounds to a whole turn to the last column. */
static void a_direction_is_found_in_its_cell(void **state)
{
    const float wi[8 * 3] = {0, 0, 1,      1, 0.1f, 0, 0.1f, 1, 0, -1, 0.1f, 0, 0.1f, -1, 0, 0, 0.1f, -1,
                             0, 0, -1, 1, -1e-30f, 0};
    static const uint32_t wanted[8] = {0, 4, 4, 5, 7, 9, 8, 7};
    bis_flat_stage *stage;
    uint32_t cell[8];
    float unit[8 * 3];
    for (int i = 0; i < 8; i++) {
        const vec3 w = normalize((vec3){wi[3 * i], wi[3 * i + 1], wi[3 * i + 2]});
        unit[3 * i] = w.x, unit[3 * i + 1] = w.y, unit[3 * i + 2] = w.z;
    }
    assert_int_equal(bis_flat_stage_open(&stage, "scene", (const char *[]){SCENE, NULL}, SAY), 0);
    assert_int_equal(bis_flat_stage_find(stage, 4, 3, 8, unit, cell, SAY), 0);
    for (int i = 0; i < 8; i++)
        if (cell[i] != wanted[i]) fail_msg("direction %d: cell %u", i, (unsigned)cell[i]);
    bis_flat_stage_close(stage);
}

/* A candidate from the white map is accepted with the probability E w / c, where E w, the mean weight, is the 1.5 that
 * the floor reflects, and c is the bound. 6 standard deviations of the share of 64 n candidates are allowed. Each
 * accepted candidate has a ray, because 64 are allowed. The twin: the bound of the other proposal gives another share.
 */
static void rejection_accepts_the_mean_weight_over_the_bound(void **state)
{
    const char *const rejection[] = {"integrator=rejection", "candidates=64", "shadowrays=64", "proposal=em", NULL};
    enum { N = 4000 };
    bis_flat_stage *stage;
    double found[8], bound[2], count[3];

    assert_int_equal(bis_flat_stage_open(&stage, "scene", (const char *[]){SCENE, NULL}, SAY), 0);
    assert_int_equal(bis_flat_stage_at(stage, 4, 4, found, SAY), 0);
    assert_int_equal(bis_flat_stage_bounds(stage, bound, SAY), 0);
    assert_int_equal(bis_flat_stage_accepted(stage, rejection, 1, N, count, SAY), 0);
    const double p = 1.5 / bound[0], other = 1.5 / bound[1], allowed = 6 * sqrt(p * (1 - p) / (64. * N));
    assert_true(fabs(count[0] / 64 - p) <= allowed && fabs(other - p) > allowed);
    assert_true(count[1] == 64 && count[2] == count[0]);
    refuses(bis_flat_stage_accepted(stage, rejection, 1, 1, count, SAY), "1 estimates: give 2 to 100000");
    refuses(bis_flat_stage_accepted(stage, rejection, 1, 100001, count, SAY), "100001 estimates: give 2 to 100000");
    bis_flat_stage_close(stage);
}

/* Nothing hides a white map from a floor: which candidates are chosen changes nothing but roundings. A wall hides a
 * part: the noises are uncorrelated, so their squares add up to the square of the whole; the sample's covariance of n =
 * 4000 pairs has a standard deviation of about a b/sqrt(n), and 6 of these, twice, are allowed. The twin: were the
 * noise of the rays left out, the sum would miss by more than that. */
static void the_two_noises_add_up_E31(void **state)
{
    const char *const sir[] = {"integrator=sir", "candidates=16", "shadowrays=2", "proposal=mix", "learn=false", NULL};
    const char *const scenes[2] = {
        SCENE, SCENE "Shape \"trianglemesh\" \"point3 P\" [-3 .3 0  3 .3 0  0 .3 4] \"integer indices\" [0 1 2]\n"};
    bis_flat_stage *stage;
    double found[8], sum[5];

    for (int k = 0; k < 2; k++) {
        assert_int_equal(bis_flat_stage_open(&stage, "scene", (const char *[]){scenes[k], NULL}, SAY), 0);
        assert_int_equal(bis_flat_stage_at(stage, 4, 5, found, SAY), 0);
        assert_int_equal(bis_flat_stage_noises(stage, sir, 7, 4000, sum, SAY), 0);
        const double all = sum[1] * sum[1], a = sum[2], b = sum[3], allowed = 12 * a * b / sqrt(4000);
        if (k == 0) assert_true(b < 1e-5 * sum[0]);
        else assert_true(fabs(all - a * a - b * b) <= allowed && fabs(all - a * a) > allowed && fabs(all - b * b) > 0);
        refuses(bis_flat_stage_noises(stage, sir, 7, 1, sum, SAY), "1 estimates: give 2 to 100000");
        refuses(bis_flat_stage_noises(stage, sir, 7, 100001, sum, SAY), "100001 estimates: give 2 to 100000");
        assert_int_equal(bis_flat_stage_noises(stage, sir, 7, 2, sum, SAY), 0);
        bis_flat_stage_close(stage);
    }
    const char *const constant[] = {"text=WorldBegin LightSource \"infinite\" Shape \"sphere\"", NULL};
    refuses(bis_flat_stage_open(&stage, "scene", constant, SAY), "the light is a constant: give a map");
    assert_null(stage);
}

/* A white sky with a lamp: 4 in two pixels of row 2. */
static void write_lamp(void)
{
    FILE *out = fopen(DIR "/lamp.pfm", "wb");
    if (!out) fail_msg("cannot write the map");
    fprintf(out, "PF\n16 8\n-1.0\n");
    for (int i = 0; i < 128; i++) /* from the bottom row */
        for (int k = 0; k < 3; k++) fwrite(&(float){i / 16 == 5 && i % 16 / 2 == 1 ? 4 : 1}, sizeof(float), 1, out);
    if (fclose(out) != 0) fail_msg("cannot write the map");
}
#define LAMP                                                                                                         \
    "text=Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\nSampler \"random\"\n"                   \
    "LookAt 0 -4 2  0 0 0  0 0 1\nCamera \"perspective\" \"float fov\" 20\nWorldBegin\n"                             \
    "LightSource \"infinite\" \"string filename\" \"" DIR "/lamp.pfm\"\n"                                           \
    "Material \"phong\" \"float Kd\" 0.3 \"float Ks\" 0.4 \"float exponent\" 20\nShape \"disk\" \"float radius\" 5\n"

/* Cells that are the map's pixels, of a light that is turned by 90 degrees about x: what is its (x, y, z) is (x, -z, y)
 * in the world. The map's own densities are the other road. Without a lobe q_f and the product follow from the cosine.
 * The wall hides what goes towards +y. */
static void a_field_has_the_frame_of_its_light(void **state)
{
    enum { W = 16, H = 8, N = W * H };
    static const char turned[] = "text=Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\n"
        "LookAt 0 -4 2  0 0 0  0 0 1\nCamera \"perspective\" \"float fov\" 20\nWorldBegin\n"
        "AttributeBegin Rotate 90 1 0 0 LightSource \"infinite\" \"string filename\" \"" DIR "/lamp.pfm\"\n"
        "AttributeEnd Material \"phong\" \"float Kd\" 0.3 \"float Ks\" 0\nShape \"disk\" \"float radius\" 5\n" WALL;
    float f[4][N + 1], peak[5], world[N][3], local[N][3];
    double pdf[N], most, share[H], found[8];
    uint32_t at[N + 1], wanted[N];
    bis_flat_stage *stage;
    bis_light *light;

    write_lamp();
    assert_int_equal(bis_flat_light_open_as(&light, DIR "/lamp.pfm", (const char *[]){NULL}, SAY), 0);
    assert_int_equal(bis_flat_light_density(light, pdf, &most, share, SAY), 0);
    assert_int_equal(bis_flat_stage_open(&stage, "scene", (const char *[]){turned, NULL}, SAY), 0);
    assert_int_equal(bis_flat_stage_at(stage, 4, 4, found, SAY), 0);
    for (int k = 0; k < 4; k++) f[k][N] = 7;
    peak[4] = 7, at[N] = 7;
    assert_int_equal(bis_flat_stage_densities(stage, W, H, f[0], f[1], f[2], f[3], peak, SAY), 0);
    for (int i = 0; i < N; i++) {
        const double theta = PI * (i / W + 0.5) / H, phi = 2 * PI * (i % W + 0.5) / W;
        const double x = sin(theta) * cos(phi), y = sin(theta) * sin(phi), z = cos(theta), up = fmax(0, y);
        const double lamp = i / W == 2 && i % W / 2 == 1 ? 4 : 1, product = 3 * 0.3 / PI * up * lamp;
        assert_true(f[0][i] == (float)pdf[i] && fabs((double)f[1][i] - up / PI) < 1e-6);
        assert_true(fabs((double)f[2][i] - product) < 1e-6 && f[3][i] == (-z > 0 ? 0 : f[2][i]));
        memcpy(local[i], (float[]){(float)x, (float)y, (float)z}, sizeof local[i]);
        memcpy(world[i], (float[]){(float)(x * 3), (float)(-z * 3), (float)(y * 3)}, sizeof world[i]);
    }
    for (int k = 0; k < 4; k++) {
        float largest = 0;
        for (int i = 0; i < N; i++) largest = fmaxf(largest, f[k][i]);
        assert_true(f[k][N] == 7 && peak[k] == largest && largest > 0);
    }
    assert_true(peak[4] == 7 && peak[0] == (float)most);
    assert_int_equal(bis_flat_light_find(light, N, local[0], wanted, SAY), 0);
    assert_int_equal(bis_flat_stage_find(stage, W, H, N, world[0], at, SAY), 0);
    for (uint32_t i = 0; i < N; i++) assert_true(at[i] == i && wanted[i] == i);
    assert_int_equal(at[N], 7);
    const int sides[4][2] = {{0, 1}, {1, 0}, {4097, 1}, {1, 4097}};
    for (int i = 0; i < 4; i++) {
        char text[64];
        snprintf(text, sizeof text, "a field of %d x %d: give 1 to 4096 each", sides[i][0], sides[i][1]);
        refuses(bis_flat_stage_find(stage, sides[i][0], sides[i][1], 1, world[0], at, SAY), text);
    }
    assert_int_equal(bis_flat_stage_find(stage, 1, 1, N, world[0], at, SAY), 0);
    for (uint32_t i = 0; i < N; i++) assert_int_equal(at[i], 0);
    refuses(bis_flat_stage_find(stage, 1, 1, 2, (float[]){0, 0, 0, 0, 0, NAN}, at, SAY), "direction 1 is (0, 0, nan)");
    bis_flat_stage_close(stage);
    bis_flat_light_close(light);
}

/* The formulas of docs/theory.md, by midpoints of 1024 x 512 cells, 64 x 64 in each pixel, and nothing hidden: mean,
 * standard deviations by balance and best weights, beta, overlap. */
static void best_weights_by_quadrature(double out[5], bis_flat_stage *stage, double n1, double n2)
{
    enum { W = 1024, H = 512 };
    float *f = test_calloc(4 * W * H, sizeof *f), peak[4];
    double a = 0, b1 = 0, b2 = 0, square = 0;
    float most[4] = {0, 0, 0, 0};

    assert_int_equal(bis_flat_stage_densities(stage, W, H, f, f + W * H, f + 2 * W * H, f + 3 * W * H, peak, SAY), 0);
    for (int i = 0; i < W * H; i++) {
        const double q1 = (double)f[i], q2 = (double)f[W * H + i], F = (double)f[2 * W * H + i];
        for (int k = 0; k < 4; k++) most[k] = fmaxf(most[k], f[k * W * H + i]);
        const double area = 2 * PI / W * PI / H * sin(PI * (i / W + 0.5) / H), c = n1 * q1 + n2 * q2;
        a += area * q1 * q2 / c;
        b1 += area * q1 * F / c;
        b2 += area * q2 * F / c;
        square += area * F * F / c;
    }
    assert_memory_equal(peak, most, sizeof peak);
    const double balance = square - n1 * b1 * b1 - n2 * b2 * b2, rest = 1 - (n1 + n2) * a;
    out[0] = n1 * b1 + n2 * b2;
    out[1] = sqrt(balance);
    out[2] = sqrt(balance - a * n1 * n2 * (b1 - b2) * (b1 - b2) / rest);
    out[3] = n1 * n2 / (n1 + n2) * (b1 - b2) / rest; /* alpha_1 = n_1 (b_1 - a I)/(1 - N a), less its part along c */
    out[4] = (n1 + n2) * a;
    test_free(f);
}

/* Three roads: the page's formulas by quadrature, runs of `mis` itself, and a white map over a diffuse floor: there F
 * is in proportion to q_f, so the best weights leave no noise. RUNS estimates of 8 samples: a variance has a relative
 * standard error of 1/sqrt(RUNS) times the root of the kurtosis less 1, below 3 here, so half of that for a standard
 * deviation; 6 of these are allowed, and 6 of the mean's. beta and the overlap are means of numbers below 1, too. The
 * twin: the balance heuristic lies farther from the best weights than is allowed. */
static void the_best_weights_are_what_they_say(void **state)
{
    const char *const mis[] = {"integrator=mis", "samples=8", "heuristic=balance", NULL};
    const char *const uneven[] = {"integrator=mis", "samples=8", "split=0.25", NULL};
    enum { RUNS = 40000 };
    const double allowed = 6 * sqrt(3.0) / 2 / sqrt(RUNS);
    bis_flat_stage *stage;
    double found[8], sum[5], right[5], runs[3], *L = test_calloc(RUNS, sizeof *L);

    write_lamp();
    assert_int_equal(bis_flat_stage_open(&stage, "scene", (const char *[]){LAMP, NULL}, SAY), 0);
    assert_int_equal(bis_flat_stage_at(stage, 4, 4, found, SAY), 0);
    for (int k = 0; k < 2; k++) {
        const char *const *settings = k ? uneven : mis;
        best_weights_by_quadrature(right, stage, k ? 2 : 4, k ? 6 : 4);
        assert_int_equal(bis_flat_stage_mis(stage, settings, 1, RUNS, sum, SAY), 0);
        assert_int_equal(bis_flat_stage_runs(stage, settings, 3, RUNS, L, runs, SAY), 0);
        assert_true(fabs(sum[0] - right[0]) <= 6 * right[1] / sqrt(RUNS));
        assert_true(fabs(sum[1] / right[1] - 1) <= allowed && fabs(runs[1] / right[1] - 1) <= allowed);
        assert_true(fabs(sum[2] / right[2] - 1) <= allowed && fabs(sum[4] - right[4]) <= allowed);
        assert_true(fabs(sum[3] / right[3] - 1) <= 3 * allowed);
        assert_true(right[1] / right[2] - 1 > 1.5 * allowed);
    }
    refuses(bis_flat_stage_mis(stage, (const char *[]){"integrator=em", NULL}, 1, 100, sum, SAY),
        "integrator \"em\" does not combine two techniques: give mis");
    refuses(bis_flat_stage_mis(stage, mis, 1, 1, sum, SAY), "1 estimates: give 2 to 1000000");
    refuses(bis_flat_stage_mis(stage, mis, 1, 1000001, sum, SAY), "1000001 estimates: give 2 to 1000000");
    assert_int_equal(bis_flat_stage_mis(stage, mis, 1, 2, sum, SAY), 0);
    bis_flat_stage_close(stage);
    assert_int_equal(bis_flat_stage_open(&stage, "scene", (const char *[]){SCENE, NULL}, SAY), 0);
    assert_int_equal(bis_flat_stage_at(stage, 4, 4, found, SAY), 0);
    assert_int_equal(bis_flat_stage_mis(stage, mis, 1, 1000, sum, SAY), 0);
    assert_true(sum[1] > 0.1 && sum[2] < 1e-6); /* directions are floats */
    bis_flat_stage_close(stage);
    test_free(L);
}

/* Phong with Kd alone reflects Kd, and nothing lies below the horizon; quadrature by 200 x 200 midpoints is exact to
 * 1e-5. */
static void a_diffuse_material_loses_nothing(void **state)
{
    const double up[3] = {0, 0, 1}, Kd[3] = {0.5, 0.5, 0.5}, Ks[3] = {0, 0, 0};
    bis_bsdf *bsdf;
    double sum[3];

    assert_int_equal(bis_flat_bsdf_open(&bsdf, "phong", Kd, Ks, 1, up, up, SAY), 0);
    assert_int_equal(bis_flat_bsdf_albedo(bsdf, up, 200, sum, SAY), 0);
    assert_true(fabs(sum[0] - 0.5) < 1e-5 && fabs(sum[2]) < 1e-5);
    refuses(bis_flat_bsdf_albedo(bsdf, up, 0, sum, SAY), "n is 0: give 1 to 4096");
    refuses(bis_flat_bsdf_albedo(bsdf, up, 4097, sum, SAY), "n is 4097: give 1 to 4096");
    /* one cell: the cosine is 1/2, its solid angle 2 pi */
    assert_int_equal(bis_flat_bsdf_albedo(bsdf, up, 1, sum, SAY), 0);
    assert_true(fabs(sum[0] - 2 * PI * 0.5 * 0.5 / PI) < 1e-6 && fabs(sum[1] - 2 * PI * 0.5 / PI) < 1e-6);
    bis_flat_bsdf_close(bsdf);
}

/* A lobe of exponent 0 is a hemisphere about the mirror's direction, of density 1/(2 pi). At 60 degrees two thirds of
 * it lie above the horizon, and the integral of the cosine over these is pi/2 (1 + cos 60 degrees), by projection: 3/8
 * is reflected for a Ks of 1, here of 0.6 in the mean. The normal is any. By 400 x 400 midpoints, whose edge cells are
 * a thousandth. */
static void a_hemisphere_as_a_lobe_loses_a_third_at_60_degrees(void **state)
{
    const double n[3] = {2, 4, 4}, Kd[3] = {0, 0, 0}, Ks[3] = {0.3, 0.5, 1};
    double wo[3], sum[4];
    bis_bsdf *bsdf;

    /* a vector across the normal, (2, -2, 1)/3 */
    for (int k = 0; k < 3; k++) wo[k] = n[k] / 6 / 2 + sqrt(0.75) * (const double[]){2, -2, 1}[k] / 3;
    assert_int_equal(bis_flat_bsdf_open(&bsdf, "phong", Kd, Ks, 0, n, wo, SAY), 0);
    sum[3] = 7;
    assert_int_equal(bis_flat_bsdf_albedo(bsdf, n, 400, sum, SAY), 0);
    assert_true(fabs(sum[0] - 0.6 * 3 / 8) < 1e-3 && fabs(sum[1] - 2.0 / 3) < 2e-3 && sum[2] == 1 - sum[1]);
    assert_true(sum[3] == 7);
    bis_flat_bsdf_close(bsdf);
}

/* The diffuse term is the same on both sides: Kd/pi cos, by a density of cos/pi. A lobe peaks at the mirror's angle,
 * away from the eye, with (n + 1)/(2 pi); the twin is the eye's own side. Straight down there is a plane, too. */
static void the_plane_of_the_eye_shows_the_lobe_at_the_mirrors_angle(void **state)
{
    const double up[3] = {0, 0, 2}, half[3] = {0.5, 0.5, 0.5}, one[3] = {1, 1, 1}, black[3] = {0, 0, 0};
    const double eye[2][3] = {{-sqrt(3), 0, 1}, {0, 0, 1}}, at[4] = {-60, 0, 60, 120};
    double f_cos[4], pdf[4];
    bis_bsdf *bsdf;

    for (int k = 0; k < 2; k++) {
        assert_int_equal(bis_flat_bsdf_open(&bsdf, "phong", half, black, 1, up, eye[k], SAY), 0);
        assert_int_equal(bis_flat_bsdf_plane(bsdf, up, 4, at, f_cos, pdf, SAY), 0);
        for (int i = 0; i < 4; i++) {
            const double cosine = fmax(0, cos(at[i] * PI / 180));
            assert_true(fabs(f_cos[i] - 0.5 * cosine / PI) < 1e-6 && fabs(pdf[i] - cosine / PI) < 1e-6);
        }
        bis_flat_bsdf_close(bsdf);
    }
    assert_int_equal(bis_flat_bsdf_open(&bsdf, "phong", black, one, 100, up, eye[0], SAY), 0);
    assert_int_equal(bis_flat_bsdf_plane(bsdf, up, 4, at, f_cos, pdf, SAY), 0);
    assert_true(fabs(pdf[2] / (101 / (2 * PI)) - 1) < 1e-4 && fabs(f_cos[2] / pdf[2] - 0.5) < 1e-4 && pdf[0] < 1e-6);
    refuses(bis_flat_bsdf_plane(bsdf, up, 2, (double[]){1, (double)NAN}, f_cos, pdf, SAY),
        "angle 1 is nan: give a number");
    bis_flat_bsdf_close(bsdf);
}

static void what_lies_below_the_horizon_is_counted(void **state)
{
    const double up[3] = {0, 0, 1}, half[3] = {0.5, 0.5, 0.5};
    const float wi[12] = {0, 0, 1, 1, 0, 0, 0, 0.6f, -0.8f, 0, 0.6f, 0.8f}; /* above, on it, below, above */
    uint8_t below[4];
    uint32_t count;
    bis_bsdf *bsdf;

    assert_int_equal(bis_flat_bsdf_open(&bsdf, "phong", half, half, 1, up, up, SAY), 0);
    assert_int_equal(bis_flat_bsdf_below(bsdf, 4, wi, below, &count, SAY), 0);
    assert_memory_equal(below, ((uint8_t[]){0, 1, 1, 0}), sizeof below);
    assert_int_equal(count, 2);
    refuses(bis_flat_bsdf_below(bsdf, 2, (float[]){0, 0, 1, 0, NAN, 0}, below, &count, SAY),
        "direction 1 is no number");
    bis_flat_bsdf_close(bsdf);
}

/* Two pixels of 2 in each channel are the reference, and one channel of 6 is 3 more: the squares' mean is 9/6, the
 * relative one's (9/(4 + 4/100))/6, the bias 3/6. The fourth channel is not looked at. The twin: equal pictures. */
static void two_pictures_are_compared_as_the_program_does(void **state)
{
    const float a[8] = {2, 5, 2, 1, 2, 2, 2, 1}, b[8] = {2, 2, 2, 9, 2, 2, 2, 9};
    double sum[3];

    assert_int_equal(bis_flat_compare(2, 1, a, b, sum, SAY), 0);
    assert_true(fabs(sum[0] - sqrt(1.5)) < 1e-12 && fabs(sum[1] - 1.5 / 4.04) < 1e-12 && fabs(sum[2] - 0.5) < 1e-12);
    assert_int_equal(bis_flat_compare(1, 2, b, b, sum, SAY), 0);
    assert_true(sum[0] == 0 && sum[1] == 0 && sum[2] == 0);
    const float c[16] = {1, 2, 3, 9, 1, 2, 3, 9, 1, 2, 3, 9, 1, 2, 3, 9}; /* the last pixel, and the last channel */
    float d[16];
    for (int i = 12; i < 15; i++) {
        memcpy(d, c, sizeof d);
        d[i] += 6;
        assert_int_equal(bis_flat_compare(2, 2, c, d, sum, SAY), 0);
        assert_true(fabs(sum[0] - sqrt(36 / 12.0)) < 1e-12 && fabs(sum[2] + 0.5) < 1e-12);
    }
    assert_int_equal(bis_flat_compare(0, 2, a, b, sum, SAY), BIS_INPUT);
    refuses(bis_flat_compare(2, 1, a, NULL, sum, SAY), "b is NULL");
}

/* No time is tested, only that there is one: no pass takes longer than all of the call. How many passes 4 samples make
 * is the scheduler's affair, so that a quarter would be too strict: it failed on a machine that loaded fast. */
static void a_pass_takes_a_part_of_the_time(void **state)
{
    bis_flat_picture *picture;
    const double before = bis_clock_now();

    assert_int_equal(
        bis_flat_render(&picture, "scene", (const char *[]){SCENE, "integrator=em", "spp=4", NULL}, NULL, SAY), 0);
    const double all = bis_clock_now() - before, pass = bis_flat_picture_pass_seconds(picture);
    assert_true(pass > 0 && pass <= all && isnan(bis_flat_picture_pass_seconds(NULL)));
    bis_flat_picture_close(picture);
}

/* The others: test_flat_null.c. */
static void null_is_left_alone_where_there_is_no_status(void **state)
{
    uint32_t k[2] = {1, 0};
    uint8_t byte = 0;

    bis_flat_uniform(1, 1, 3, NULL);
    bis_flat_fnv(NULL, 1, &byte);
    bis_flat_fnv(k, 1, NULL);
    assert_int_equal(k[0], 1);
}

/* One step of those that take memory; what it makes is freed. */
static bis_status step_without_memory(int k, bis_flat_stage **stage, bis_light *light)
{
    static const char *const sir[] = {"integrator=sir", "candidates=16", "shadowrays=2", NULL};
    static const char *const mis[] = {"integrator=mis", "samples=4", NULL};
    const double w[3] = {1, 2, 3}, P[3] = {0.5, 0.25, 0.25};
    const float a[4] = {1, 1, 1, 1};
    static double v[128], x[128], y[128];
    static uint32_t i[128], j[128], n;
    static float f[3 * 16];
    bis_light *small = NULL;
    bis_flat_stage *other = NULL;
    int status = BIS_OK;

    switch (k) {
    case 0: return bis_flat_marsaglia(3, (uint32_t[]){1, 2, 3}, 9, i, &n, SAY);
    case 1: return bis_flat_alias_stage(3, w, 1, i, v, SAY);
    case 2: return bis_flat_alias_pmf(3, w, v, x, SAY);
    case 3: return bis_flat_alias_few_bits(3, w, 3, v, x, y, SAY);
    case 4: return bis_flat_cdf_build(3, w, v, i, &n, SAY);
    case 5: return bis_flat_cdf_sample(3, w, 1, (double[]){0.5}, i, j, &n, SAY);
    case 6: return bis_flat_fit(3, P, 4, (uint32_t[]){0, 0, 1, 2}, v, x, SAY);
    case 7: return bis_flat_light_regions(light, 2, 1, i, j, v, x, &n, SAY);
    case 8: return bis_flat_compare(1, 1, a, a, v, SAY);
    case 9: return bis_flat_stage_candidates(*stage, sir, 1, 16, f, v, i, j, x, SAY);
    case 10: return bis_flat_stage_runs(*stage, sir, 1, 4, v, x, SAY);
    case 11: return bis_flat_stage_mis(*stage, mis, 1, 4, v, SAY);
    case 12: return bis_flat_stage_noises(*stage, sir, 1, 4, v, SAY);
    case 13: return bis_flat_stage_accepted(*stage, (const char *[]){"integrator=rejection", NULL}, 1, 4, v, SAY);
    case 14: status = bis_flat_light_shrink(&small, light, 8, SAY); break;
    case 15: status = bis_flat_light_open_as(&small, DIR "/white.pfm", (const char *[]){NULL}, SAY); break;
    default: status = bis_flat_stage_open(&other, "scene", (const char *[]){SCENE, "threads=1", NULL}, SAY);
    }
    assert_true((status == BIS_OK) == (k == 14 || k == 15 ? small != NULL : other != NULL));
    bis_flat_light_close(small);
    bis_flat_stage_close(other);
    return status;
}

static void without_memory_a_step_says_so_and_keeps_none(void **state)
{
    bis_flat_stage *stage;
    bis_light *light;
    double found[8];

    assert_int_equal(bis_flat_light_open(&light, DIR "/white.pfm", "cdf", 0, NULL, SAY), 0);
    assert_int_equal(bis_flat_stage_open(&stage, "scene", (const char *[]){SCENE, "threads=1", NULL}, SAY), 0);
    assert_int_equal(bis_flat_stage_at(stage, 4, 4, found, SAY), 0);
    for (int k = 0; k < 17; k++) {
        FOR_LACK(l) {
            const long live = bis_mem_live();
            LACK(l, step_without_memory(k, &stage, light));
            if ((l.status == BIS_NOMEM) != (*say != 0)) fail_msg("step %d: %s", k, say);
            assert_int_equal(bis_mem_live(), live);
            assert_true(!l.over || l.k > 1);
        }
    }
    bis_flat_stage_close(stage);
    bis_flat_light_close(light);
}

/* A NaN must not become an index, and a direction of any length is one. */
static void directions_of_the_caller_are_checked(void **state)
{
    const float w[3][3] = {{-1e30f, -1e30f, -1e30f}, {NAN, 0, 1}, {0, 0, 0}};
    const double up[3] = {0, 0, 1}, half[3] = {0.5, 0.5, 0.5}, zero[3] = {0, 0, 0};
    bis_flat_stage *stage;
    bis_light *light;
    bis_bsdf *b;
    uint32_t at;
    double sum[3], degrees = 0, value;

    assert_int_equal(bis_flat_light_open(&light, DIR "/white.pfm", "cdf", 0, NULL, SAY), 0);
    assert_int_equal(bis_flat_bsdf_open(&b, "phong", half, half, 9, up, up, SAY), 0);
    assert_int_equal(bis_flat_stage_open(&stage, "scene", (const char *[]){SCENE, NULL}, SAY), 0);
    /* an azimuth of 225 degrees: column 10 of 16; 125.3 degrees from the zenith: row 5 of 8 */
    assert_int_equal(bis_flat_light_find(light, 1, w[0], &at, SAY), 0);
    assert_int_equal(at, 5 * 16 + 10);
    assert_int_equal(bis_flat_stage_find(stage, 16, 8, 1, w[0], &at, SAY), 0);
    assert_int_equal(at, 5 * 16 + 10);
    for (int i = 1; i < 3; i++) refuses(bis_flat_light_find(light, 1, w[i], &at, SAY), "direction 0 is");
    refuses(bis_flat_stage_find(stage, 16, 8, 1, w[1], &at, SAY), "direction 0 is");
    refuses(bis_flat_stage_find(stage, 4096, 4097, 1, w[0], &at, SAY), "a field of 4096 x 4097");
    refuses(bis_flat_stage_find(stage, 0, 1, 1, w[0], &at, SAY), "a field of 0 x 1");
    assert_int_equal(bis_flat_stage_find(stage, 4096, 4096, 1, w[0], &at, SAY), 0);
    assert_int_equal(bis_flat_stage_find(stage, 16, 8, 1, w[2], &at, SAY), 0); /* no candidate */
    assert_int_equal(at, 0);
    refuses(bis_flat_bsdf_albedo(b, zero, 4, sum, SAY), "normal is (0, 0, 0)");
    refuses(bis_flat_bsdf_plane(b, zero, 1, &degrees, &value, sum, SAY), "normal is (0, 0, 0)");
    bis_flat_stage_close(stage);
    bis_flat_light_close(light);
    bis_flat_bsdf_close(b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(marsaglias_list_is_the_thesiss),
        cmocka_unit_test(the_stages_lead_from_NP_to_the_table),
        cmocka_unit_test(the_cdf_is_the_running_sum),
        cmocka_unit_test(the_fit_is_pearsons),
        cmocka_unit_test(a_white_map_is_one_light),
        cmocka_unit_test(a_point_of_a_diffuse_floor_is_known),
        cmocka_unit_test(a_direction_is_found_in_its_cell),
        cmocka_unit_test(rejection_accepts_the_mean_weight_over_the_bound),
        cmocka_unit_test(the_two_noises_add_up_E31),
        cmocka_unit_test(a_diffuse_material_loses_nothing),
        cmocka_unit_test(the_plane_of_the_eye_shows_the_lobe_at_the_mirrors_angle),
        cmocka_unit_test(what_lies_below_the_horizon_is_counted),
        cmocka_unit_test(two_pictures_are_compared_as_the_program_does),
        cmocka_unit_test(a_pass_takes_a_part_of_the_time),
        cmocka_unit_test(few_bits_draw_what_is_impossible_as_printed_E14),
        cmocka_unit_test(a_table_of_eighths_gives_the_weights_own_probabilities),
        cmocka_unit_test(a_hash_goes_on_where_it_ended),
        cmocka_unit_test(a_small_light_is_drawn_by_its_area),
        cmocka_unit_test(numbers_and_hashes_are_the_librarys),
        cmocka_unit_test(a_histogram_counts_each_value_once),
        cmocka_unit_test(a_shrunk_map_keeps_its_light),
        cmocka_unit_test(the_best_weights_are_what_they_say),
        cmocka_unit_test(null_is_left_alone_where_there_is_no_status),
        cmocka_unit_test(directions_of_the_caller_are_checked),
        cmocka_unit_test(few_bits_are_counted_by_hand_E14),
        cmocka_unit_test(components_are_told_pixel_by_pixel),
        cmocka_unit_test(the_settings_of_a_map_are_those_of_its_light),
        cmocka_unit_test(a_setting_of_a_map_has_its_limits),
        cmocka_unit_test(a_pixel_shows_the_point_on_the_floor),
        cmocka_unit_test(candidates_are_known_by_their_directions),
        cmocka_unit_test(runs_are_summed_up_and_the_exact_value_is_of_its_point),
        cmocka_unit_test(a_field_has_the_frame_of_its_light),
        cmocka_unit_test(a_hemisphere_as_a_lobe_loses_a_third_at_60_degrees),
        cmocka_unit_test(without_memory_a_step_says_so_and_keeps_none),
    };
    return cmocka_run_group_tests(tests, setup, NULL);
}
