/* SPDX-License-Identifier: BSD-2-Clause */
/* envelope, discrete distributions and point sets (thesis 3.2.2): weights over 600 powers of ten, one item and 100
 * million, the first and the last random number. The other road: w/sum in long double, whose range and precision exceed
 * double's. */
#include "claim.h"
#include "envelope.h"

#include "bis/thesis/alias.h"
#include "bis/thesis/cdf.h"
#include "bis/base/curve.h"
#include "bis/thesis/marsaglia.h"
#include "bis/base/mem.h"
#include "bis/thesis/sampler.h"
#include "thesis/proposal.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

#define COUNT(a) ((int)(sizeof(a) / sizeof *(a)))

static const double numbers[] = {0, 0x1p-53, 0x1p-24, 0.25, 0.5, 0.75, 1 - 0x1p-24, 1 - 0x1p-53};
static const size_t sizes[] = {1, 2, 3, 7, 64, 1000, 4097, 65536};

/* ---- weights ---- */

typedef enum law { EQUAL, DECADES_600, DENORMAL, LARGEST, ONE_LARGE, ONE_POSITIVE, HALF_ZERO, N_LAWS } law;

static const char *const law_names[] = {
    "equal",        "1e-300 to 1e300",   "5e-324 to 1e-308", "up to 1.8e308", "one of 1e12 times the rest",
    "one positive", "half 0, 1e-12 to 1"};

static double weight(law kind, size_t i, size_t n, bis_rng *r)
{
    const double x = bis_rng_double(r);

    switch (kind) {
    case EQUAL: return 3;
    case DECADES_600: return pow(10, 600 * x - 300);
    case DENORMAL: return 5e-324 + DBL_MIN * x * x * x;
    case LARGEST: return DBL_MAX * x;
    case ONE_LARGE: return i == n / 3 ? 1e12 * (double)n : 0.5 + x;
    case ONE_POSITIVE: return i == n / 2 ? 1e-300 : 0;
    default: return i % 2 == 0 ? pow(10, -12 * x) : 0;
    }
}

static double *new_weights(law kind, size_t n, long double *sum)
{
    double *w = bis_alloc(n, sizeof *w);
    bis_rng r;

    assert_non_null(w);
    bis_rng_init(&r, 1, n, (uint64_t)kind, 0);
    *sum = 0;
    for (size_t i = 0; i < n; i++) {
        w[i] = weight(kind, i, n, &r);
        *sum += (long double)w[i];
    }
    return w;
}

static void alias_tables_imply_their_weights(void **state)
{
    envelope pmf = envelope_row("alias tables of 1 to 65536 weights: equal, 5e-324 to 1.8e308, 1e12 beside 1, "
                                "one positive, half 0",
                                "relative error of implied probabilities of 1e-290 and more (E15)", 1e-8);
    envelope zero = envelope_row("the same", "items of weight 0 that can be drawn, table entries out of range", 0);
    envelope draw = envelope_row("the same; u from 0 to 1 - 2^-53, and beside every bin's edge",
                                 "draws of an item of weight 0 or out of range", 0);

    for (int k = 0; k < N_LAWS * COUNT(sizes); k++) {
        const law kind = (law)(k % N_LAWS);
        const size_t n = sizes[k / N_LAWS];
        long double sum;
        double *w = new_weights(kind, n, &sum), *implied = bis_alloc(n, sizeof *implied);
        bis_alias a;
        assert_int_equal(bis_alias_init(&a, w, n, NULL), BIS_OK);
        bis_alias_implied_pmf(&a, implied);
        for (size_t i = 0; i < n; i++) {
            const long double P = (long double)w[i] / sum;
            if (P >= 1e-290L)
                envelope_try(&pmf, relative_error(implied[i], (double)P), "%s, n %zu, item %zu", law_names[kind], n, i);
            envelope_expect(&zero, (w[i] > 0 || implied[i] == 0) && a.prob[i] >= 0 && a.prob[i] <= 1 && a.alias[i] < n,
                            "%s, n %zu, item %zu", law_names[kind], n, i);
        }
        for (size_t i = 0; i < 3 * n + COUNT(numbers); i++) {
            double u = i < 3 * n ? (double)(i / 3) / (double)n : numbers[i - 3 * n];
            if (i < 3 * n && i % 3 == 1) u = nextafter(u, 1);
            if (i < 3 * n && i % 3 == 2) u = fmax(0, nextafter(u, 0));
            const size_t item = bis_alias_sample(&a, u);
            envelope_expect(&draw, item < n && w[item] > 0, "%s, n %zu, u %.17g", law_names[kind], n, u);
        }
        bis_alias_clear(&a);
        bis_free(w);
        bis_free(implied);
    }
    envelope_close(&pmf);
    envelope_close(&zero);
    envelope_close(&draw);
}

static void cdfs_hold_their_weights(void **state)
{
    envelope pmf = envelope_row("CDFs of the same weights",
                                "absolute error of the probability: what lies below 2^-53 is lost", 0x1p-51);
    envelope zero = envelope_row("the same", "steps down, steps at weight 0, ends other than 0 and 1", 0);
    envelope draw = envelope_row(
        "the same; u from 0 to 1 - 2^-53, and beside every step",
        "draws of an item of weight 0, or of another than the last with C <= u; remainders outside [0, 1)", 0);

    for (int k = 0; k < N_LAWS * COUNT(sizes); k++) {
        const law kind = (law)(k % N_LAWS);
        const size_t n = sizes[k / N_LAWS];
        long double sum;
        double *w = new_weights(kind, n, &sum);
        bis_cdf c;
        assert_int_equal(bis_cdf_init(&c, w, n, NULL), BIS_OK);
        envelope_expect(&zero, c.c[0] == 0 && c.c[n] == 1, "%s, n %zu", law_names[kind], n);
        for (size_t i = 0; i < n; i++) {
            const double p = bis_cdf_pmf(&c, i);
            envelope_try(&pmf, fabs(p - (double)((long double)w[i] / sum)), "%s, n %zu, item %zu", law_names[kind], n,
                         i);
            envelope_expect(&zero, p >= 0 && (w[i] > 0 || p == 0), "%s, n %zu, item %zu", law_names[kind], n, i);
        }
        for (size_t i = 0; i < 3 * n + COUNT(numbers); i++) {
            double u = i < 3 * n ? c.c[i / 3] : numbers[i - 3 * n], rest = -1;
            if (i < 3 * n && i % 3 == 1) u = nextafter(u, 1);
            if (i < 3 * n && i % 3 == 2) u = fmax(0, nextafter(u, 0));
            if (u >= 1) continue;
            const size_t item = bis_cdf_sample(&c, u, &rest);
            envelope_expect(&draw,
                            item < n && w[item] > 0 && c.c[item] <= u && u < c.c[item + 1] && rest >= 0 && rest < 1,
                            "%s, n %zu, u %.17g", law_names[kind], n, u);
        }
        bis_cdf_clear(&c);
        bis_free(w);
    }
    envelope_close(&pmf);
    envelope_close(&zero);
    envelope_close(&draw);
}

/* w[i] without storing it: i spread over 12 powers of ten. */
static double large_weight(size_t i) { return pow(10, 12 * (double)(bis_hash(i) >> 40) * 0x1p-24); }

static void a_hundred_million_items_are_as_right_as_one(void **state)
{
    const size_t n = 100000000;
    if (!envelope_long()) skip();
    envelope pmf =
        envelope_long_row("alias table of 1e8 weights, 1 to 1e12", "relative error of the implied probability", 1e-8);
    envelope cdf = envelope_long_row("CDF of 1e8 weights, 1 to 1e12", "absolute error of a probability", 0x1p-51);
    envelope draw = envelope_long_row("both; u from 0 to 1 - 2^-53, and beside edges of bins",
                                      "draws out of range or of a wrong step", 0);
    double *w = bis_alloc(n, sizeof *w), *implied = bis_alloc(n, sizeof *implied);
    long double sum = 0;
    bis_alias a;
    bis_cdf c;

    assert_true(w && implied);
    for (size_t i = 0; i < n; i++) {
        w[i] = large_weight(i);
        sum += (long double)w[i];
    }
    assert_int_equal(bis_alias_init(&a, w, n, NULL), BIS_OK);
    bis_alias_implied_pmf(&a, implied);
    for (size_t i = 0; i < n; i++)
        envelope_try(&pmf, relative_error(implied[i], (double)((long double)w[i] / sum)), "item %zu", i);
    for (size_t i = 0; i < 1000000 + COUNT(numbers); i++) {
        const double u = i < 1000000 ? (double)(i * 99 + 1) / (double)n : numbers[i - 1000000];
        const size_t one = bis_alias_sample(&a, nextafter(u, 1) < 1 ? nextafter(u, 1) : u),
                     other = bis_alias_sample(&a, u);
        envelope_expect(&draw, one < n && other < n, "alias, u %.17g", u);
    }
    bis_alias_clear(&a);
    bis_free(implied);
    assert_int_equal(bis_cdf_init(&c, w, n, NULL), BIS_OK);
    for (size_t i = 0; i < n; i++)
        envelope_try(&cdf, fabs(bis_cdf_pmf(&c, i) - (double)((long double)w[i] / sum)), "item %zu", i);
    for (size_t i = 0; i < 1000000 + COUNT(numbers); i++) {
        const double u = i < 1000000 ? c.c[i * 99] : numbers[i - 1000000];
        const size_t item = bis_cdf_sample(&c, u, NULL);
        envelope_expect(&draw, item < n && c.c[item] <= u && u < c.c[item + 1], "cdf, u %.17g", u);
    }
    bis_cdf_clear(&c);
    bis_free(w);
    envelope_close(&pmf);
    envelope_close(&cdf);
    envelope_close(&draw);
}

static void marsaglias_list_is_exact_or_refused(void **state)
{
    static const uint64_t weights[][3] = {{1, 0, 0},
                                          {0, 0, 7},
                                          {1, (1 << 24) - 1, 0},
                                          {1, 1, (1 << 24) - 2},
                                          {1u << 30, 1u << 30, 1u << 31},
                                          {UINT64_MAX, 0, UINT64_MAX}};
    static const uint64_t too_long[][3] = {
        {1, 1 << 24, 0}, {UINT64_MAX, 1, 1}, {UINT64_MAX, UINT64_MAX - 1, UINT64_MAX - 2}};
    envelope e = envelope_row("Marsaglia's list, weights to 2^64 - 1; u from 0 to 1 - 2^-53",
                              "wrong probabilities, draws of weight 0; lists over 2^24 that are not refused", 0);

    for (int k = 0; k < COUNT(weights); k++) {
        const uint64_t *w = weights[k];
        const double sum = (double)w[0] + (double)w[1] + (double)w[2];
        bis_marsaglia m;
        assert_int_equal(bis_marsaglia_init(&m, w, 3, NULL), BIS_OK);
        for (size_t i = 0; i < 3; i++)
            envelope_expect(&e, bis_marsaglia_pmf(&m, i) == (double)w[i] / sum, "case %d, item %zu", k, i);
        for (int i = 0; i < COUNT(numbers); i++)
            envelope_expect(&e, w[bis_marsaglia_sample(&m, numbers[i])] > 0, "case %d, u %.17g", k, numbers[i]);
        bis_marsaglia_clear(&m);
    }
    for (int k = 0; k < COUNT(too_long); k++) {
        bis_marsaglia m;
        envelope_expect(&e, bis_marsaglia_init(&m, too_long[k], 3, NULL) == BIS_INPUT, "too long %d", k);
    }
    envelope_close(&e);
}

/* ---- curves and point sets ---- */

static void curves_survive_the_ends_and_the_thinnest_rectangles(void **state)
{
    static const uint32_t rectangles[][2] = {{1, 1}, {2, 1},     {1, 2},     {1, 100000}, {100000, 1},
                                             {3, 3}, {2, 32768}, {32767, 2}, {317, 211},  {3, 10001}};
    envelope e = envelope_row("Hilbert's curve at t from 0 to 1 - 2^-53", "points outside [0, 1)^2", 0);
    envelope cells = envelope_row("curve through rectangles of 1 x 1, 2 x 1, 1 x N, N x 1 to odd sides",
                                  "cells left out or visited twice; steps to a cell that is no neighbour", 0);

    for (int i = 0; i < COUNT(numbers); i++) {
        double u[2];
        bis_curve_hilbert(numbers[i], u);
        envelope_expect(&e, u[0] >= 0 && u[0] < 1 && u[1] >= 0 && u[1] < 1, "t %.17g", numbers[i]);
    }
    for (int k = 0; k < COUNT(rectangles); k++) {
        const uint32_t w = rectangles[k][0], h = rectangles[k][1];
        uint32_t *order = bis_alloc((size_t)w * h, sizeof *order);
        unsigned char *seen = bis_alloc((size_t)w * h, 1);
        assert_true(order && seen);
        bis_curve_rectangle(order, w, h);
        for (uint32_t i = 0; i < w * h; i++) {
            const int dx = i ? abs((int)(order[i] % w) - (int)(order[i - 1] % w)) : 0,
                      dy = i ? abs((int)(order[i] / w) - (int)(order[i - 1] / w)) : 0;
            envelope_expect(&cells, order[i] < w * h && !seen[order[i]]++ && dx <= 1 && dy <= 1, "%u x %u, cell %u", w,
                            h, i);
        }
        bis_free(order);
        bis_free(seen);
    }
    envelope_close(&e);
    envelope_close(&cells);
}

static void point_sets_stay_in_the_square(void **state)
{
    static const uint32_t samples[] = {0, 1, 1000000, UINT32_MAX}, spps[] = {1, 7, UINT32_MAX};
    enum { MOST = 1000000 };
    envelope e = envelope_row("sets of 1 to 1e6 points of every kind, samples 0 to 2^32 - 1 of 1 to 2^32 - 1",
                              "points outside [0, 1)^2", 0);
    envelope strata = envelope_row("the last of n strata, n = 1 to 1e6 and to 2^32 - 1, xi = 1 - 2^-53",
                                   "places that reach 1 or leave their stratum by more than rounding", 0);
    double (*u)[2] = bis_alloc(MOST, sizeof *u);

    assert_non_null(u);
    for (int k = 0; k < 4 * COUNT(samples) * COUNT(spps); k++) {
        const bis_sampler s = {.kind = (bis_sampler_kind)(k % 4),
                               .seed = UINT64_MAX,
                               .spp = spps[k / 16],
                               .xsamples = spps[k / 16],
                               .ysamples = 1,
                               .jitter = true};
        const uint32_t n = k / 4 == 3 ? MOST : (uint32_t)(1 + k % 5);
        bis_stream stream;
        bis_stream_init(&stream, &s, UINT64_MAX, samples[k / 4 % 4]);
        bis_stream_points(&stream, 0, n, u);
        for (uint32_t i = 0; i < n; i++) {
            envelope_expect(&e, u[i][0] >= 0 && u[i][0] < 1 && u[i][1] >= 0 && u[i][1] < 1, "%s, point %u of %u",
                            bis_sampler_name(s.kind), i, n);
        }
        bis_stream_camera(&stream, u[0]);
        envelope_expect(&e, u[0][0] >= 0 && u[0][0] < 1 && u[0][1] >= 0 && u[0][1] < 1, "camera, %s",
                        bis_sampler_name(s.kind));
    }
    for (uint32_t n = 1; n <= MOST + 64; n++) {
        const uint32_t N = n <= MOST ? n : UINT32_MAX - (n - MOST - 1) * 67108859u;
        const double t = bis_stratum(N - 1, 1 - 0x1p-53, N);
        envelope_expect(&strata, t < 1 && t * (double)N >= (double)N - 1, "n %u", N);
    }
    bis_free(u);
    envelope_close(&e);
    envelope_close(&strata);
}

/* Exactly uniform numbers below n, for n whose last block of 2^64 is as small and as large as can be. */
static void numbers_below_n_are_below_n(void **state)
{
    static const uint64_t n[] = {1, 2, 3, (uint64_t)1 << 63, ((uint64_t)1 << 63) + 1, UINT64_MAX};
    envelope e = envelope_row("random numbers below n, n = 1 to 2^64 - 1", "numbers not below n", 0);

    for (int k = 0; k < COUNT(n); k++) {
        bis_rng r;
        bis_rng_init(&r, (uint64_t)k, 0, 0, 0);
        for (int i = 0; i < 1000; i++)
            envelope_expect(&e, bis_rng_below(&r, n[k]) < n[k], "n %llu", (unsigned long long)n[k]);
    }
    envelope_close(&e);
}

static void page_has_the_same_rows(void **state)
{
    envelope_finish(3, "Discrete distributions and point sets");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(alias_tables_imply_their_weights),
        cmocka_unit_test(cdfs_hold_their_weights),
        cmocka_unit_test(a_hundred_million_items_are_as_right_as_one),
        cmocka_unit_test(marsaglias_list_is_exact_or_refused),
        cmocka_unit_test(curves_survive_the_ends_and_the_thinnest_rectangles),
        cmocka_unit_test(point_sets_stay_in_the_square),
        cmocka_unit_test(numbers_below_n_are_below_n),
        cmocka_unit_test(page_has_the_same_rows),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
