/* SPDX-License-Identifier: BSD-2-Clause */
/* cdf: thesis 3.2.2 by its definition: the index with C[i] <= u < C[i+1], found by a linear search, is the other road.
 * Family-wise significance 0.01. */
#include "bis/thesis/cdf.h"
#include "bis/base/mem.h"
#include "bis/thesis/rng.h"
#include "claim.h"
#include "stat.h"

#include <float.h>
#include <math.h>
#include <string.h>

static double alpha(void) { return stat_level(0.01, 3); }
static const double LAST_U = 1 - 0x1p-53;

/* Each C is off by half an ulp of its own, of the sum and of the quotient; a pmf is a difference of two. */
static const double PMF_ERROR = 3 * 0x1p-53 + 3 * 0x1p-53;

static bis_cdf cdf_of(const double *w, size_t n)
{
    bis_cdf c;
    assert_int_equal(bis_cdf_init(&c, w, n, NULL), BIS_OK);
    return c;
}

static size_t by_definition(const bis_cdf *c, double u)
{
    size_t i = c->n;
    while (c->c[--i] > u) {
    }
    return i;
}

/* Weights over 12 decades, every fifth one 0. */
static void fill_contrasty(double *w, size_t n, uint64_t seed)
{
    bis_rng r;
    bis_rng_init(&r, seed, 0, 0, 0);
    for (size_t i = 0; i < n; i++)
        w[i] = bis_rng_below(&r, 5) == 0 ? 0 : exp(27 * bis_rng_double(&r));
}

static void E8_the_thesis_example_is_drawn_with_its_probabilities(void **state)
{
    const double p[] = {.1, .2, .4, .3};
    double observed[4] = {0}, off_by_one[4] = {0}, expected[4];
    bis_cdf c = cdf_of(p, 4);
    bis_rng r;
    bis_rng_init(&r, 1, 0, 0, 0);
    for (int k = 0; k < 100000; k++) {
        size_t i = bis_cdf_sample(&c, bis_rng_double(&r), NULL);
        observed[i]++;
        off_by_one[(i + 1) % 4]++; /* the twin: the inclusive sum, 1-based */
    }
    for (int i = 0; i < 4; i++)
        expected[i] = 100000 * p[i];
    stat_assert_fit("cdf_thesis", 1, observed, expected, 4, alpha());
    stat_assert_no_fit("cdf_thesis_twin", 1, off_by_one, expected, 4, alpha());
    bis_cdf_clear(&c);
}

static void E8_items_of_weight_0_are_never_drawn_wherever_they_stand(void **state)
{
    const double cases[][5] = {{0, 0, 1, 2, 3}, {1, 0, 0, 2, 3}, {1, 2, 3, 0, 0}, {0, 1, 0, 1, 0}, {0, 0, 1, 0, 0},
                               {1e-300, 0, 1, 0, 0}};
    for (int k = 0; k < 6; k++) {
        bis_cdf c = cdf_of(cases[k], 5);
        for (int i = 0; i <= 1000; i++) {
            double u = fmin(i / 1000.0, LAST_U);
            assert_true(cases[k][bis_cdf_sample(&c, u, NULL)] > 0);
        }
        for (int i = 0; i < 5; i++) { /* each step of C, from both sides */
            if (c.c[i] < 1) assert_true(cases[k][bis_cdf_sample(&c, c.c[i], NULL)] > 0);
            if (c.c[i] > 0) assert_true(cases[k][bis_cdf_sample(&c, nextafter(c.c[i], 0), NULL)] > 0);
        }
        bis_cdf_clear(&c);
    }
}

static void E8_u_0_draws_the_first_and_u_near_1_the_last_positive_item(void **state)
{
    const double w[] = {0, 0, 3, 1, 2, 0, 0, 0};
    bis_cdf c = cdf_of(w, 8);
    double remainder;
    assert_int_equal(bis_cdf_sample(&c, 0, &remainder), 2);
    assert_true(remainder == 0);
    assert_int_equal(bis_cdf_sample(&c, LAST_U, &remainder), 4);
    assert_true(remainder < 1 && remainder > 1 - 1e-15);
    bis_cdf_clear(&c);
}

static void E10_the_guide_table_rounds_no_probability(void **state)
{
    const size_t sizes[] = {1, 2, 3, 4, 5, 63, 64, 65, 1000};
    double w[1000];
    bis_rng r;
    bis_rng_init(&r, 2, 0, 0, 0);
    for (int s = 0; s < 9; s++) {
        size_t n = sizes[s];
        fill_contrasty(w, n, 100 + n);
        w[n / 2] = 1;
        bis_cdf c = cdf_of(w, n);
        for (size_t i = 0; i < n; i++) {
            if (c.c[i + 1] == c.c[i]) continue;
            assert_int_equal(bis_cdf_sample(&c, c.c[i], NULL), i);
            assert_int_equal(bis_cdf_sample(&c, nextafter(c.c[i + 1], 0), NULL), i);
        }
        for (int k = 0; k < 2000; k++) {
            double u = bis_rng_double(&r);
            assert_int_equal(bis_cdf_sample(&c, u, NULL), by_definition(&c, u));
        }
        bis_cdf_clear(&c);
    }
}

/* The twin of E10: the guide alone, "pre-inverting C". An item of probability 1/(4 N) is never drawn or four times too
 * often. */
static void E10_a_preinverted_table_without_a_search_is_rejected(void **state)
{
    double w[64], searched[64] = {0}, preinverted[64] = {0}, expected[64], sum = 0;
    for (int i = 0; i < 64; i++)
        sum += w[i] = i % 2 ? 1 : 0.1;
    bis_cdf c = cdf_of(w, 64);
    bis_rng r;
    bis_rng_init(&r, 3, 0, 0, 0);
    for (int k = 0; k < 100000; k++) {
        double u = bis_rng_double(&r);
        searched[bis_cdf_sample(&c, u, NULL)]++;
        preinverted[c.guide[(size_t)(u * (double)c.n_guide)]]++;
    }
    for (int i = 0; i < 64; i++)
        expected[i] = 100000 * w[i] / sum;
    stat_assert_fit("cdf_guide", 3, searched, expected, 64, alpha());
    stat_assert_no_fit("cdf_guide_twin", 3, preinverted, expected, 64, alpha());
    bis_cdf_clear(&c);
}

static void E10_the_pmf_is_exact_to_the_last_bits_of_u(void **state)
{
    static double w[100000];
    const size_t n = 100000;
    fill_contrasty(w, n, 7);
    long double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += (long double)w[i];
    bis_cdf c = cdf_of(w, n);
    for (size_t i = 0; i < n; i++) {
        double exact = (double)((long double)w[i] / sum), pmf = bis_cdf_pmf(&c, i);
        assert_true(fabs(pmf - exact) <= PMF_ERROR);
        assert_true(w[i] > 0 || pmf == 0);
        if (exact >= 1e-7) assert_true(fabs(pmf - exact) <= 1e-8 * exact);
    }
    assert_true(fabs(c.total - (double)sum) <= 2 * DBL_EPSILON * c.total);
    bis_cdf_clear(&c);
}

static void a_million_small_items_after_a_large_one_do_not_vanish(void **state)
{
    const size_t n = 1000001;
    double *w = bis_alloc(n, sizeof *w);
    w[0] = 1;
    for (size_t i = 1; i < n; i++)
        w[i] = 1e-17; /* a plain sum in double would leave 1, and never draw any of them */
    bis_cdf c = cdf_of(w, n);
    assert_true(fabs((c.c[n] - c.c[1]) - 1e-11) <= PMF_ERROR);
    assert_true(bis_cdf_sample(&c, LAST_U, NULL) > n - 100);
    bis_cdf_clear(&c);
    bis_free(w);
}

static void c_is_monotone_from_0_to_1_for_any_weights(void **state)
{
    double w[1000];
    bis_rng r;
    bis_rng_init(&r, 4, 0, 0, 0);
    for (int k = 0; k < 300; k++) {
        for (int i = 0; i < 1000; i++)
            w[i] = bis_rng_below(&r, 4) == 0 ? 0 : pow(10, (2 * bis_rng_double(&r) - 1) * (k + 1));
        bis_cdf c = cdf_of(w, 1000);
        assert_true(c.c[0] == 0 && c.c[1000] == 1);
        for (int i = 0; i < 1000; i++) {
            assert_true(c.c[i + 1] >= c.c[i]);
            assert_true(w[i] > 0 || c.c[i + 1] == c.c[i]);
        }
        bis_cdf_clear(&c);
    }
}

static void weights_of_any_size_are_summed_without_overflow(void **state)
{
    const double sizes[] = {5e-324, 1e-310, 1e-300, 1, 1e300, 4e307, DBL_MAX / 1.1};
    for (int k = 0; k < 7; k++) {
        const double w[] = {sizes[k], 0, sizes[k], 0, sizes[k], sizes[k]};
        bis_cdf c = cdf_of(w, 6);
        for (size_t i = 0; i < 6; i++)
            assert_true(w[i] > 0 ? fabs(bis_cdf_pmf(&c, i) - 0.25) <= PMF_ERROR : bis_cdf_pmf(&c, i) == 0);
        assert_true(c.total > 0);
        bis_cdf_clear(&c);
    }
}

static void inversion_is_monotone_in_u(void **state)
{
    double w[500];
    fill_contrasty(w, 500, 8);
    bis_cdf c = cdf_of(w, 500);
    size_t last = 0;
    for (int k = 0; k < 100000; k++) {
        size_t i = bis_cdf_sample(&c, k / 100000.0, NULL);
        assert_true(i >= last);
        last = i;
    }
    bis_cdf_clear(&c);
}

static void the_remainder_is_uniform_within_each_item(void **state)
{
    const double w[] = {1, 5, 2, 8};
    double observed[4 * 16] = {0}, expected[4 * 16];
    bis_cdf c = cdf_of(w, 4);
    bis_rng r;
    bis_rng_init(&r, 9, 0, 0, 0);
    for (int k = 0; k < 200000; k++) {
        double remainder;
        size_t i = bis_cdf_sample(&c, bis_rng_double(&r), &remainder);
        assert_true(remainder >= 0 && remainder < 1);
        observed[16 * i + (size_t)(16 * remainder)]++;
    }
    for (int i = 0; i < 64; i++)
        expected[i] = 200000 * w[i / 16] / 16 / 16;
    stat_assert_fit("cdf_remainder", 9, observed, expected, 64, alpha());
    for (size_t i = 0; i < 4; i++) { /* up to the item's last number */
        double remainder;
        assert_int_equal(bis_cdf_sample(&c, nextafter(c.c[i + 1], 0), &remainder), i);
        assert_true(remainder < 1);
    }
    bis_cdf_clear(&c);
}

static void nothing_one_and_all_zero_are_legal(void **state)
{
    const double zeros[3] = {0}, one[] = {1e-9};
    bis_cdf none = cdf_of(NULL, 0), black = cdf_of(zeros, 3), single = cdf_of(one, 1);
    assert_true(none.total == 0 && black.total == 0);
    assert_true(bis_cdf_pmf(&black, 1) == 0);
    assert_int_equal(bis_cdf_bytes(&black), 0);
    assert_true(single.total == 1e-9 && bis_cdf_pmf(&single, 0) == 1);
    assert_int_equal(bis_cdf_sample(&single, 0, NULL), 0);
    assert_int_equal(bis_cdf_sample(&single, LAST_U, NULL), 0);
    bis_cdf_clear(&none), bis_cdf_clear(&black), bis_cdf_clear(&single);
    bis_cdf_clear(&single);
}

static void twelve_bytes_an_item_are_enough(void **state)
{
    static double w[4096];
    fill_contrasty(w, 4096, 10);
    bis_cdf c = cdf_of(w, 4096);
    assert_in_range(bis_cdf_bytes(&c), 4096 * 8, 4096 * 12 + 12);
    bis_cdf_clear(&c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(E8_the_thesis_example_is_drawn_with_its_probabilities),
        cmocka_unit_test(E8_items_of_weight_0_are_never_drawn_wherever_they_stand),
        cmocka_unit_test(E8_u_0_draws_the_first_and_u_near_1_the_last_positive_item),
        cmocka_unit_test(E10_the_guide_table_rounds_no_probability),
        cmocka_unit_test(E10_a_preinverted_table_without_a_search_is_rejected),
        cmocka_unit_test(E10_the_pmf_is_exact_to_the_last_bits_of_u),
        cmocka_unit_test(a_million_small_items_after_a_large_one_do_not_vanish),
        cmocka_unit_test(c_is_monotone_from_0_to_1_for_any_weights),
        cmocka_unit_test(weights_of_any_size_are_summed_without_overflow),
        cmocka_unit_test(inversion_is_monotone_in_u),
        cmocka_unit_test(the_remainder_is_uniform_within_each_item),
        cmocka_unit_test(nothing_one_and_all_zero_are_legal),
        cmocka_unit_test(twelve_bytes_an_item_are_enough),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
