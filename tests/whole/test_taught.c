/* SPDX-License-Identifier: BSD-2-Clause */
/* taught: what is taught is what runs: each method's picture runs the files of src/thesis that teach it
 * (scripts/check/check_taught.sh, by the compiler's counters). */

#include "claim.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>

static const char *build(void) { return getenv("BIS_BUILD"); }

static int check(const char *claim)
{
    char command[1024];

    snprintf(command, sizeof command, "sh scripts/check/check_taught.sh %s %s", build(), claim);
    fflush(stdout);
    const int status = system(command);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

static int make_program(void **state)
{
    static int status;

    status =
        build() && getenv("BIS_COMPILE") ? check("") : 77; /* alone, without make test, nobody says how to compile */
    *state = &status;
    return 0;
}

static void every_method_runs_the_files_that_teach_it(void **state)
{
    const int *status = *state;

    if (*status == 77) skip();
    assert_int_equal(*status, 0);
}

/* The twins: claims that are wrong, of a file that another method runs, and of one that nobody runs. */
static void a_file_that_does_not_run_is_found(void **state)
{
    const int *status = *state;

    if (*status == 77) skip();
    assert_int_equal(check("em '--integrator em' 'thesis/em.c thesis/sir.c'"), 1);
    assert_int_equal(check("sir '--integrator sir' 'thesis/sir.c thesis/nothing.c'"), 1);
    assert_int_equal(check("sir '--integrator sir' 'thesis/sir.c'"), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_method_runs_the_files_that_teach_it),
        cmocka_unit_test(a_file_that_does_not_run_is_found),
    };

    return cmocka_run_group_tests(tests, make_program, NULL);
}
