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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_method_runs_the_files_that_teach_it),
    };

    return cmocka_run_group_tests(tests, make_program, NULL);
}
