/* SPDX-License-Identifier: BSD-2-Clause */
/* names: thousands of names against an array of them, replaced values, the nearest of them. */
#include "base/names.h"
#include "bis/base/mem.h"
#include "claim.h"

#include <stdio.h>
#include <string.h>

/* More than the first thousand, so that the table grows eight times. The twin has each letter in another place. */
static void thousands_of_names_have_their_values(void **state)
{
    enum { N = 3000 };
    bis_names t = {0};
    uint32_t value = 7;
    char name[32];
    for (int round = 0; round < 2; round++)
        for (uint32_t i = 0; i < N; i++) {
            snprintf(name, sizeof name, "n%u", (unsigned)i);
            assert_true(bis_names_find(&t, name, &value) == (round > 0));
            if (round == 0 || i % 2) assert_true(bis_names_set(&t, name, (3 + 2 * (uint32_t)round) * i));
            snprintf(name, sizeof name, "%un", (unsigned)i);
            assert_false(bis_names_find(&t, name, &value));
        }
    assert_int_equal(t.n, N);
    for (uint32_t i = 0; i < N; i++) {
        snprintf(name, sizeof name, "n%u", (unsigned)i);
        assert_true(bis_names_find(&t, name, &value) && value == (i % 2 ? 5 : 3) * i);
        assert_string_equal(t.names[i], name);
    }
    bis_names_clear(&t);
    assert_int_equal(bis_mem_live(), 0);
}

/* Among the first thousand; the others are too many to compare. */
static void the_nearest_of_the_first_thousand_is_found(void **state)
{
    bis_names t = {0};
    char name[32];
    assert_null(bis_names_nearest(&t, "colour"));
    for (uint32_t i = 0; i < 999; i++) {
        snprintf(name, sizeof name, "%u", 10000000 + (unsigned)i);
        assert_true(bis_names_set(&t, name, i));
    }
    assert_null(bis_names_nearest(&t, "colour"));
    assert_true(bis_names_set(&t, "color", 0));
    assert_string_equal(bis_names_nearest(&t, "colour"), "color");
    assert_true(bis_names_set(&t, "texture", 0));
    assert_null(bis_names_nearest(&t, "textures"));
    bis_names_clear(&t);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(thousands_of_names_have_their_values),
        cmocka_unit_test(the_nearest_of_the_first_thousand_is_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
