/* SPDX-License-Identifier: BSD-2-Clause */
/* envelope: the harness itself: it finds what it is there to find. */
#include "claim.h"
#include "envelope.h"

#include <math.h>
#include <stdio.h>

static void the_largest_error_is_kept_and_a_nan_is_worse_than_any(void **state)
{
    envelope e = envelope_row("tries", "error", 0);

    envelope_try(&e, 1e-3, "%d", 1);
    envelope_try(&e, 2e-3, "%d", 2);
    envelope_try(&e, 1e-4, "%d", 3);
    assert_true(e.worst == 2e-3 && e.n_tries == 3);
    assert_string_equal(e.where, "2");
    envelope_try(&e, (double)NAN, "%s", "not a number");
    assert_true(isinf(e.worst));
    assert_string_equal(e.where, "not a number");
}

static void wrong_outcomes_are_counted_and_the_first_is_named(void **state)
{
    envelope e = envelope_row("outcomes", "wrong ones", 0);

    envelope_expect(&e, true, "%d", 1);
    envelope_expect(&e, false, "%d", 2);
    envelope_expect(&e, false, "%d", 3);
    assert_true(e.worst == 2 && e.n_tries == 3);
    assert_string_equal(e.where, "2");
}

static bool page_is_accepted(const char *rows)
{
    const char *path = "build/test_envelope_page.md";
    char complaint[3000];
    FILE *f = fopen(path, "w");

    assert_non_null(f);
    fprintf(f,
            "# Page\n\n## Before\n\n| a | b | 0 | 0 |\n\n## Here\n\n| tried | what is measured | largest | bound |\n"
            "| --- | --- | ---: | ---: |\n%s\n## Behind\n\n| a | b | 0 | 0 |\n",
            rows);
    fclose(f);
    const bool accepted = envelope_agrees_with(path, "Here", complaint, sizeof complaint);
    assert_false(envelope_agrees_with(path, "Nowhere", complaint, sizeof complaint));
    remove(path);
    return accepted;
}

static void a_stale_page_is_rejected(void **state)
{
    envelope one = envelope_row("one thing", "its error", 1e-3), two = envelope_row("the same", "another error", 0);

    envelope_try(&one, 1e-4, "here");
    envelope_expect(&two, true, "here");
    envelope_close(&one);
    envelope_close(&two);
    assert_true(page_is_accepted(
        "| one thing | its error | 1.0e-04 | 0.001 |\n| the same | another error | 0 | 0 |\n"));
    assert_true(page_is_accepted(
        "| one thing | its error | 3.0e-05 | 0.001 |\n| the same | another error | 0 | 0 |\n"));
    assert_false(page_is_accepted(
        "| one thing | its error | 1.0e-04 | 0.002 |\n| the same | another error | 0 | 0 |\n"));
    assert_false(
        page_is_accepted("| a thing | its error | 1.0e-04 | 0.001 |\n| the same | another error | 0 | 0 |\n"));
    assert_false(page_is_accepted("| one thing | its error | 1.0e-04 | 0.001 |\n"));
    assert_false(
        page_is_accepted("| one thing | its error | 1.0e-04 | 0.001 |\n| the same | another error | 0 | 0 |\n"
                         "| a third | error | 0 | 0 |\n"));
    assert_false(page_is_accepted(""));
    assert_true(
        page_is_accepted("| one thing | its error | 1.0e-04 | 0.001 |\n| slow *(long)* | error | 0 | 0 |\n"
                         "| the same | another error | 0 | 0 |\n") != envelope_long());
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_largest_error_is_kept_and_a_nan_is_worse_than_any),
        cmocka_unit_test(wrong_outcomes_are_counted_and_the_first_is_named),
        cmocka_unit_test(a_stale_page_is_rejected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
