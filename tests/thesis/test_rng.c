/* SPDX-License-Identifier: BSD-2-Clause */
/* rng: numbers are uniform, and independent across every coordinate that a stream is keyed by.
 * Family-wise significance 0.01. */
#include "bis/thesis/rng.h"
#include "claim.h"
#include "stat.h"

#include <math.h>
#include <stdlib.h>

enum { GRID = 32, CELLS = GRID * GRID, DRAWS = 1 << 20 };

static double alpha(void) { return stat_level(0.01, 65); }

/* The k-th pair of numbers of a test; each pair must be uniform in the square over all k. */
typedef void pair_fn(double u[2], uint64_t k);

static void count_pairs(double observed[CELLS], double expected[CELLS], pair_fn *pair)
{
    for (int i = 0; i < CELLS; i++) {
        observed[i] = 0;
        expected[i] = (double)DRAWS / CELLS;
    }
    for (uint64_t k = 0; k < DRAWS; k++) {
        double u[2];
        pair(u, k);
        observed[(int)(u[0] * GRID) * GRID + (int)(u[1] * GRID)]++;
    }
}

static void assert_uniform_pairs(const char *name, pair_fn *pair)
{
    double observed[CELLS], expected[CELLS];
    count_pairs(observed, expected, pair);
    stat_assert_fit(name, 0, observed, expected, CELLS, alpha());
}

static double first_of(uint64_t seed, uint64_t pixel, uint64_t sample, uint64_t purpose)
{
    bis_rng r;
    bis_rng_init(&r, seed, pixel, sample, purpose);
    return bis_rng_double(&r);
}

static void successive(double u[2], uint64_t k)
{
    bis_rng r;
    bis_rng_init(&r, 1, 2, 3, 4);
    r.counter = 2 * k;
    u[0] = bis_rng_double(&r);
    u[1] = bis_rng_double(&r);
}

static void numbers_of_a_stream_are_uniform_and_independent_in_pairs(void **state)
{
    assert_uniform_pairs("rng_successive", successive);
}

static void along_seeds(double u[2], uint64_t k)
{
    u[0] = first_of(k, 0, 0, 0);
    u[1] = first_of(k + 1, 0, 0, 0);
}

static void along_pixels(double u[2], uint64_t k)
{
    u[0] = first_of(0, k, 0, 0);
    u[1] = first_of(0, k + 1, 0, 0);
}

static void along_rows(double u[2], uint64_t k)
{
    u[0] = first_of(0, k, 0, 0);
    u[1] = first_of(0, k + 1024, 0, 0);
}

static void along_samples(double u[2], uint64_t k)
{
    u[0] = first_of(0, 7, k, 0);
    u[1] = first_of(0, 7, k + 1, 0);
}

static void along_purposes(double u[2], uint64_t k)
{
    u[0] = first_of(0, 7, 3, k);
    u[1] = first_of(0, 7, 3, k + 1);
}

static void pixel_and_sample(double u[2], uint64_t k)
{
    u[0] = first_of(0, k, k + 1, 0);
    u[1] = first_of(0, k + 1, k, 0);
}

static void streams_are_independent_across_seeds_pixels_samples_and_purposes(void **state)
{
    assert_uniform_pairs("rng_seeds", along_seeds);
    assert_uniform_pairs("rng_pixels", along_pixels);
    assert_uniform_pairs("rng_rows", along_rows);
    assert_uniform_pairs("rng_samples", along_samples);
    assert_uniform_pairs("rng_purposes", along_purposes);
    assert_uniform_pairs("rng_pixel_and_sample", pixel_and_sample);
}

/* The twin: the key is the sum of pixel and sample, unmixed, so that one pixel's next sample is the next pixel's
 * first. */
static void sum_key(double u[2], uint64_t k)
{
    uint64_t pixel = k / 2, sample = k % 2;
    u[0] = first_of(0, pixel + sample, 0, 0);
    u[1] = first_of(0, pixel + 1, 0, 0);
}

static void streams_that_overlap_are_found(void **state)
{
    double observed[CELLS], expected[CELLS];
    count_pairs(observed, expected, sum_key);
    stat_assert_no_fit("rng_twin", 0, observed, expected, CELLS, alpha());
}

/* Each of the 53 bits of a double is fair, and any two neighbours of them are independent. */
static void every_bit_is_fair(void **state)
{
    double observed[53 * 4] = {0}, expected[53 * 4];
    const int n = 200000;
    bis_rng r;
    bis_rng_init(&r, 11, 0, 0, 0);
    for (int k = 0; k < n; k++) {
        uint64_t bits = (uint64_t)(bis_rng_double(&r) * 0x1p53);
        for (int b = 0; b < 53; b++)
            observed[4 * b + (int)(bits >> b & 1) + 2 * (int)(bits >> (b + 1) % 53 & 1)]++;
    }
    for (int b = 0; b < 53; b++) {
        for (int i = 0; i < 4; i++)
            expected[4 * b + i] = n / 4.0;
        stat_assert_fit("rng_bits", 11, observed + 4 * b, expected + 4 * b, 4, alpha());
    }
}

static void numbers_lie_in_0_to_1_and_have_53_bits(void **state)
{
    bis_rng r;
    bis_rng_init(&r, 12, 0, 0, 0);
    uint64_t seen_low_bits = 0;
    for (int k = 0; k < 1000000; k++) {
        double u = bis_rng_double(&r);
        assert_true(u >= 0 && u < 1);
        assert_true(u * 0x1p53 == floor(u * 0x1p53));
        seen_low_bits |= (uint64_t)(u * 0x1p53) & 0xfffff;
    }
    assert_int_equal(seen_low_bits, 0xfffff);
    assert_true((double)(UINT64_MAX >> 11) * 0x1p-53 < 1); /* the largest */
}

static void a_number_is_a_function_of_its_coordinates_alone(void **state)
{
    bis_rng a, b;
    bis_rng_init(&a, 1, 2, 3, 4);
    for (int k = 0; k < 100; k++) {
        uint64_t x = bis_rng_u64(&a);
        bis_rng_init(&b, 1, 2, 3, 4);
        b.counter = (uint64_t)k;
        assert_true(bis_rng_u64(&b) == x);
    }
}

/* Among 10^6 keys of neighbouring coordinates no two are equal: 2^-25 would be the chance of a collision. */
static int compare_u64(const void *a, const void *b)
{
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

static void keys_of_a_million_streams_are_distinct(void **state)
{
    static uint64_t keys[1 << 20];
    size_t n = 0;
    for (uint64_t seed = 0; seed < 4; seed++)
        for (uint64_t pixel = 0; pixel < 4096; pixel++)
            for (uint64_t sample = 0; sample < 16; sample++)
                for (uint64_t purpose = 0; purpose < 4; purpose++) {
                    bis_rng r;
                    bis_rng_init(&r, seed, pixel, sample, purpose);
                    keys[n++] = r.key;
                }
    qsort(keys, n, sizeof *keys, compare_u64);
    for (size_t i = 1; i < n; i++)
        assert_true(keys[i] != keys[i - 1]);
}

static void below_n_is_uniform_for_any_n(void **state)
{
    const uint64_t sizes[] = {2, 3, 7, 100};
    for (int s = 0; s < 4; s++) {
        double observed[100] = {0}, expected[100];
        bis_rng r;
        bis_rng_init(&r, 13, (uint64_t)s, 0, 0);
        for (int k = 0; k < 100000; k++)
            observed[bis_rng_below(&r, sizes[s])]++;
        for (uint64_t i = 0; i < sizes[s]; i++)
            expected[i] = 100000.0 / (double)sizes[s];
        stat_assert_fit("rng_below", 13, observed, expected, sizes[s], alpha());
    }
}

/* n = 3 * 2^62: a plain modulus returns the lower third twice as often, rejection does not. */
static void below_a_huge_n_is_not_folded(void **state)
{
    const uint64_t n = (uint64_t)3 << 62;
    double observed[3] = {0}, folded[3] = {0}, expected[3] = {10000, 10000, 10000};
    bis_rng r;
    bis_rng_init(&r, 14, 0, 0, 0);
    for (int k = 0; k < 30000; k++) {
        observed[bis_rng_below(&r, n) >> 62]++;
        folded[bis_rng_u64(&r) % n >> 62]++;
    }
    stat_assert_fit("rng_below_huge", 14, observed, expected, 3, alpha());
    stat_assert_no_fit("rng_below_huge_twin", 14, folded, expected, 3, alpha());
    assert_int_equal(bis_rng_below(&r, 1), 0);
}

/* ---- exact numbers ---- */

/* Counted from key 0, the numbers are those of SplitMix64 (Steele, Lea and Flood 2014): the published first ones of its
 * seeds 0 and 1234567. */
static void the_mixer_gives_the_published_numbers(void **state)
{
    static const uint64_t of_0[] = {0xe220a8397b1dcdafu, 0x6e789e6aa1b965f4u, 0x06c45d188009454fu};
    static const uint64_t of_1234567[] = {6457827717110365317u, 3203168211198807973u, 9817491932198370423u,
        4593380528125082431u, 16408922859458223821u};
    bis_rng r = {0, 1};
    for (int i = 0; i < 3; i++) assert_true(bis_rng_u64(&r) == of_0[i]);
    for (uint64_t i = 0; i < 5; i++)
        assert_true(bis_hash(1234567 + (i + 1) * UINT64_C(0x9e3779b97f4a7c15)) == of_1234567[i]);
    assert_true(bis_hash(0) == 0);
    r = (bis_rng){0, 1};
    assert_true(bis_rng_double(&r) == (double)(of_0[0] >> 11) / 9007199254740992.0);
}

/* A key is the hash of (the hash of what came before) + a coordinate. With g, whose hash is h, and coordinates g - h,
 * each sum is g again, so that the key is h; the seed has g added. */
static void a_coordinate_is_added_to_the_hash_of_those_before(void **state)
{
    const uint64_t g = 0x9e3779b97f4a7c15u, h = 0xe220a8397b1dcdafu;
    bis_rng r;
    stat_keep_seeds(true);
    bis_rng_init(&r, 0, g - h, g - h, g - h);
    assert_true(r.key == h && r.counter == 0);
    bis_rng_init(&r, 0 - g, 0, 0, g); /* hashes of 0 are 0 */
    stat_keep_seeds(false);
    assert_true(r.key == h && r.counter == 0);
}

/* The number that an odd one takes to 1: each step doubles the bits that are right (Newton). */
static uint64_t reciprocal(uint64_t odd)
{
    uint64_t x = odd;
    for (int i = 0; i < 5; i++) x *= 2 - odd * x;
    return x;
}

/* Undoes x ^ x >> k. */
static uint64_t unshifted(uint64_t x, int k)
{
    uint64_t y = x;
    for (int i = 0; i < 64; i += k) y = x ^ y >> k;
    return y;
}

/* A stream whose first number is x. */
static bis_rng beginning_with(uint64_t x)
{
    x = unshifted(x, 31) * reciprocal(UINT64_C(0x94d049bb133111eb));
    x = unshifted(x, 27) * reciprocal(UINT64_C(0xbf58476d1ce4e5b9));
    return (bis_rng){unshifted(x, 30), 0};
}

/* 2^64 = q n + rest: the last number of the last whole block is q n - 1, and gives n - 1. The one after it is the first
 * that is refused, for the stream's second number. */
static void below_n_refuses_just_the_last_partial_block(void **state)
{
    static const struct { uint64_t n, rest; } cases[] = {{3, 1}, {10, 6}, {UINT64_C(1) << 40, 0}, {UINT64_MAX, 1},
        {(UINT64_C(1) << 63) + 1, (UINT64_C(1) << 63) - 1}, {UINT64_C(3) << 62, UINT64_C(1) << 62}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const uint64_t n = cases[i].n, last = UINT64_MAX - cases[i].rest;
        bis_rng r = beginning_with(last), second;
        assert_true(bis_rng_below(&r, n) == n - 1);
        assert_true(r.counter == 1);
        r = beginning_with(n / 2);
        assert_true(bis_rng_below(&r, n) == n / 2);
        if (!cases[i].rest) continue;
        r = second = beginning_with(last + 1);
        bis_rng_u64(&second);
        const uint64_t after = bis_rng_u64(&second);
        if (after > last) continue; /* refused, too */
        assert_true(bis_rng_below(&r, n) == after % n);
        assert_true(r.counter == 2);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_of_a_stream_are_uniform_and_independent_in_pairs),
        cmocka_unit_test(streams_are_independent_across_seeds_pixels_samples_and_purposes),
        cmocka_unit_test(streams_that_overlap_are_found),
        cmocka_unit_test(every_bit_is_fair),
        cmocka_unit_test(numbers_lie_in_0_to_1_and_have_53_bits),
        cmocka_unit_test(a_number_is_a_function_of_its_coordinates_alone),
        cmocka_unit_test(keys_of_a_million_streams_are_distinct),
        cmocka_unit_test(below_n_is_uniform_for_any_n),
        cmocka_unit_test(below_a_huge_n_is_not_folded),
        cmocka_unit_test(the_mixer_gives_the_published_numbers),
        cmocka_unit_test(a_coordinate_is_added_to_the_hash_of_those_before),
        cmocka_unit_test(below_n_refuses_just_the_last_partial_block),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
