/* SPDX-License-Identifier: BSD-2-Clause */
/* marsaglia: the thesis's own list, and the limits that led to the alias method.
 * Significance of the one statistical test: 0.01. */
#include "bis/thesis/marsaglia.h"
#include "bis/thesis/rng.h"
#include "claim.h"
#include "stat.h"

#include <string.h>

static bis_marsaglia list_of(const uint64_t *w, size_t n)
{
    bis_marsaglia m;
    assert_int_equal(bis_marsaglia_init(&m, w, n, NULL), BIS_OK);
    return m;
}

static void figure_3_3_is_reproduced(void **state)
{
    const uint64_t w[] = {1, 2, 4, 3};
    const uint32_t L[] = {0, 1, 1, 2, 2, 2, 2, 3, 3, 3};
    bis_marsaglia m = list_of(w, 4);
    assert_int_equal(m.length, 10);
    assert_memory_equal(m.list, L, sizeof L);
    for (size_t i = 0; i < 4; i++)
        assert_true(bis_marsaglia_pmf(&m, i) == (double)w[i] / 10);
    for (int k = 0; k < 10; k++)
        assert_int_equal(bis_marsaglia_sample(&m, (k + 0.5) / 10), L[k]);
    assert_int_equal(bis_marsaglia_sample(&m, 0), 0);
    assert_int_equal(bis_marsaglia_sample(&m, 1 - 0x1p-53), 3);
    bis_marsaglia_clear(&m);
}

static void E11_one_in_2953_needs_2953_elements(void **state)
{
    const uint64_t w[] = {1, 2952};
    bis_marsaglia m = list_of(w, 2);
    assert_int_equal(m.length, 2953);
    assert_true(bis_marsaglia_pmf(&m, 0) == 1.0 / 2953);
    bis_marsaglia_clear(&m);
}

static void the_common_divisor_is_cancelled(void **state)
{
    const uint64_t w[] = {0, (uint64_t)3 << 60, (uint64_t)1 << 60, 0};
    bis_marsaglia m = list_of(w, 4);
    assert_int_equal(m.length, 4);
    assert_true(bis_marsaglia_pmf(&m, 0) == 0 && bis_marsaglia_pmf(&m, 1) == 0.75);
    assert_true(bis_marsaglia_pmf(&m, 2) == 0.25 && bis_marsaglia_pmf(&m, 3) == 0);
    bis_marsaglia_clear(&m);
}

static void a_list_too_long_is_refused_with_its_length_and_the_way_out(void **state)
{
    const uint64_t w[] = {1, 16777216}, just_right[] = {1, 16777215};
    const uint64_t beyond_64_bits[] = {UINT64_MAX, UINT64_MAX - 1, 1};
    bis_diag d = {0};
    bis_marsaglia m;
    assert_int_equal(bis_marsaglia_init(&m, w, 2, &d), BIS_INPUT);
    assert_int_equal(m.length, 0);
    assert_string_equal(d.messages[0].text, "error: Marsaglia's list for 2 items would have 16777217 elements, at most "
                                            "16777216 are allowed: use the alias method, whose tables have 2");
    assert_int_equal(bis_marsaglia_init(&m, beyond_64_bits, 3, &d), BIS_INPUT);
    assert_non_null(strstr(d.messages[1].text, "36893488147419103232 elements"));
    bis_diag_clear(&d);
    m = list_of(just_right, 2);
    assert_int_equal(m.length, 16777216);
    assert_int_equal(bis_marsaglia_sample(&m, 1 - 0x1p-53), 1);
    bis_marsaglia_clear(&m);
}

static void items_are_drawn_with_their_probabilities(void **state)
{
    const uint64_t w[] = {5, 0, 1, 30, 7, 0, 12};
    double observed[7] = {0}, twin[7] = {0}, expected[7];
    bis_marsaglia m = list_of(w, 7);
    bis_rng r;
    bis_rng_init(&r, 1, 0, 0, 0);
    for (int k = 0; k < 100000; k++) {
        double u = bis_rng_double(&r);
        observed[bis_marsaglia_sample(&m, u)]++;
        twin[m.list[(size_t)(u * (double)(m.length - 1))]]++; /* the list's last element is forgotten */
    }
    for (int i = 0; i < 7; i++)
        expected[i] = 100000 * (double)w[i] / 55;
    stat_assert_fit("marsaglia", 1, observed, expected, 7, stat_level(0.01, 1));
    stat_assert_no_fit("marsaglia_twin", 1, twin, expected, 7, stat_level(0.01, 1));
    bis_marsaglia_clear(&m);
}

static void nothing_and_all_zero_are_legal(void **state)
{
    const uint64_t zeros[3] = {0};
    bis_marsaglia none = list_of(NULL, 0), black = list_of(zeros, 3);
    assert_int_equal(none.length, 0);
    assert_int_equal(black.length, 0);
    assert_true(bis_marsaglia_pmf(&black, 1) == 0);
    bis_marsaglia_clear(&none), bis_marsaglia_clear(&black);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(figure_3_3_is_reproduced),
        cmocka_unit_test(E11_one_in_2953_needs_2953_elements),
        cmocka_unit_test(the_common_divisor_is_cancelled),
        cmocka_unit_test(a_list_too_long_is_refused_with_its_length_and_the_way_out),
        cmocka_unit_test(items_are_drawn_with_their_probabilities),
        cmocka_unit_test(nothing_and_all_zero_are_legal),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
