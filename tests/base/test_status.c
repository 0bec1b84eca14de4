/* SPDX-License-Identifier: BSD-2-Clause */
/* status: messages name their place; they survive the words they were made of; a lost one is still counted. */
#include "bis/base/mem.h"
#include "bis/base/status.h"
#include "claim.h"

#include <string.h>

static void a_message_names_as_much_of_its_place_as_is_known(void **state)
{
    bis_diag d = {0};
    assert_int_equal(bis_error(&d, BIS_INPUT, (bis_loc){"s.txt", 7, 12}, "\"%s\" is %d", "exponent", -3), BIS_INPUT);
    bis_warn(&d, (bis_loc){"s.txt", 7, 0}, "w");
    assert_int_equal(bis_error(&d, BIS_IO, (bis_loc){"s.txt", 0, 0}, "gone"), BIS_IO);
    assert_int_equal(bis_error(&d, BIS_NOMEM, (bis_loc){0}, "no memory"), BIS_NOMEM);

    assert_int_equal(d.n, 4);
    assert_int_equal(d.n_errors, 3);
    assert_string_equal(d.messages[0].text, "s.txt:7:12: error: \"exponent\" is -3");
    assert_string_equal(d.messages[1].text, "s.txt:7: warning: w");
    assert_string_equal(d.messages[2].text, "s.txt: error: gone");
    assert_string_equal(d.messages[3].text, "error: no memory");
    assert_string_equal(d.messages[0].body, "\"exponent\" is -3");
    assert_string_equal(d.messages[1].body, "w");
    assert_true(d.messages[0].is_error);
    assert_false(d.messages[1].is_error);
    bis_diag_clear(&d);
    assert_int_equal(d.n, 0);
    bis_diag_clear(&d);
    bis_diag_clear(NULL);
}

static void nobody_needs_to_listen(void **state)
{
    assert_int_equal(bis_error(NULL, BIS_IO, (bis_loc){0}, "x"), BIS_IO);
    bis_warn(NULL, (bis_loc){0}, "x");
}

static void a_thousand_long_messages_are_kept_in_order(void **state)
{
    char word[5000];
    bis_diag d = {0};
    memset(word, 'x', sizeof word);
    word[sizeof word - 1] = '\0';
    for (int i = 0; i < 1000; i++)
        bis_warn(&d, (bis_loc){"f", i + 1, 1}, "%d%s", i, word);
    memset(word, 'y', sizeof word - 1);
    assert_int_equal(d.n, 1000);
    assert_int_equal(d.n_errors, 0);
    assert_int_equal(strncmp(d.messages[999].text, "f:1000:1: warning: 999xxx", 25), 0);
    assert_int_equal(strlen(d.messages[999].text), strlen("f:1000:1: warning: 999") + sizeof word - 1);
    bis_diag_clear(&d);
}

static void the_nearest_name_is_found_up_to_a_third_of_the_word(void **state)
{
    const char *const names[] = {"Shape", "Sampler", "candidates", "shadowrays", "N", ""};
    const size_t n = sizeof names / sizeof *names;
    assert_string_equal(bis_nearest_name("candidtes", names, n), "candidates");   /* removed */
    assert_string_equal(bis_nearest_name("candiddates", names, n), "candidates"); /* inserted */
    assert_string_equal(bis_nearest_name("Shqpe", names, n), "Shape");            /* replaced */
    assert_string_equal(bis_nearest_name("Shpae", names, n), "Shape");            /* swapped: one mistake, not two */
    assert_string_equal(bis_nearest_name("SHADOWRAYS", names, n), "shadowrays");  /* case is no mistake */
    assert_string_equal(bis_nearest_name("M", names, n), "N");                    /* at least one mistake */
    assert_null(bis_nearest_name("Shxyz", names, n));
    assert_null(bis_nearest_name("integrator", names, n));
    assert_null(bis_nearest_name("Shape", names, 0));
    char huge[1000] = {0};
    memset(huge, 'a', sizeof huge - 1);
    assert_null(bis_nearest_name(huge, names, n));
}

static void of_two_names_the_nearer_is_meant_and_of_equals_the_first(void **state)
{
    const char *const names[] = {"xsamplers", "xsamples", "ysamples"};
    assert_string_equal(bis_nearest_name("xsample", names, 3), "xsamples");
    assert_string_equal(bis_nearest_name("zsamples", names, 3), "xsamples");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_message_names_as_much_of_its_place_as_is_known),
        cmocka_unit_test(nobody_needs_to_listen),
        cmocka_unit_test(a_thousand_long_messages_are_kept_in_order),
        cmocka_unit_test(the_nearest_name_is_found_up_to_a_third_of_the_word),
        cmocka_unit_test(of_two_names_the_nearer_is_meant_and_of_equals_the_first),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
