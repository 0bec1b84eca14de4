/* SPDX-License-Identifier: BSD-2-Clause */
/* `bis verify --bits`: this build has the bits of every build, for any number of threads; a build that rounds otherwise
 * is told so, by the first row that it reaches and by how much. */
#include "claim.h"
#include "cli/cli.h"
#include "program.h"
#include "threads.h"
#include "tools/verify/verify.h"

#include <fenv.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define DIR "build/test_verify_bits"

static void this_build_has_the_bits_of_every_build(void **state)
{
    bis_bits rows[BIS_N_BITS];
    const int threads = use_threads(3);
    assert_int_equal(bis_verify_bits(rows, NULL), BIS_OK);
    use_threads(threads);
    for (int i = 0; i < BIS_N_BITS; i++) {
        if (rows[i].hash != rows[i].expected)
            fail_msg(
                "%s: %016llx, relative difference %g", rows[i].name, (unsigned long long)rows[i].hash, rows[i].departs);
        assert_true(rows[i].departs == 0);
    }
}

/* Every method estimates the same picture: the sums agree with that of `exact`, but for noise. So the table holds no
 * bits of a method that was wrong when they were written down. A pixel has a relative standard error of at most some
 * 100 % (brdf: 100 draws, of which one in 50 finds a lamp), so a sum of 768 pixels has 3.6 %. The largest difference is
 * that of mis, 2.8 %. */
static void the_pictures_agree(void **state)
{
    bis_bits rows[BIS_N_BITS];
    const double *exact = NULL;
    assert_int_equal(bis_verify_bits(rows, NULL), BIS_OK);
    for (int i = 0; i < BIS_N_BITS; i++)
        if (strcmp(rows[i].name, "picture, exact") == 0) exact = &rows[i].sum;
    assert_non_null(exact);
    for (int i = 0; i < BIS_N_BITS; i++)
        if (strncmp(rows[i].name, "picture", 7) == 0) assert_true(fabs(rows[i].sum / *exact - 1) < 4 * 0.036);
}

/* The twin: the same code with results that are rounded up. Tables change in their last bits, and their sums by fewer
 * than a thousand roundings of 2^-52. */
static void a_build_that_rounds_otherwise_is_found(void **state)
{
    bis_bits rows[BIS_N_BITS];
    assert_int_equal(fesetround(FE_UPWARD), 0);
    const bis_status status = bis_verify_bits(rows, NULL);
    fesetround(FE_TONEAREST);
    assert_int_equal(status, BIS_OK);
    for (int i = 1; i < 3; i++) {
        assert_true(rows[i].hash != rows[i].expected);
        assert_true(rows[i].departs < 1000 * 0x1p-52);
    }
}

/* The command in this process, its results rounded up. */
static void the_command_names_the_rows_that_differ(void **state)
{
    char text[4096] = "", bits[] = "--bits", *argv[] = {bits, NULL};
    program_folder(DIR);
    fflush(stdout);
    const int saved = dup(STDOUT_FILENO);
    assert_non_null(freopen(DIR "/bits.txt", "w", stdout));
    const int rounding = fesetround(FE_UPWARD), exit_status = bis_cmd_verify(1, argv);
    fesetround(FE_TONEAREST);
    fflush(stdout);
    dup2(saved, STDOUT_FILENO);
    close(saved);
    assert_int_equal(rounding, 0);
    assert_int_equal(exit_status, BIS_EXIT_FAILED);
    FILE *in = fopen(DIR "/bits.txt", "r");
    assert_non_null(in);
    text[fread(text, 1, sizeof text - 1, in)] = '\0';
    fclose(in);
    int n = 0, said = 0;
    for (const char *at = text; (at = strstr(at, " DIFFERS: sum ")) != NULL; at++, n++)
        assert_non_null(strstr(at, " of it\n"));
    assert_true(n >= 2);
    const char *last = strstr(text, "\n\n");
    assert_true(last && sscanf(last, "\n\n%d of 12 differ. Each row rests on those above it: look at the first.\n",
                               &said) == 1 && said == n);
}

static void the_command_says_it(void **state)
{
    program_run r;
    program_folder(DIR);
    program_expect(&r, 0, "verify --bits");
    assert_non_null(strstr(r.output, "all 12 are the same"));
    assert_string_equal(r.messages, "");
    program_expect(&r, 2, "verify");
    assert_non_null(strstr(r.messages, "too few operands"));
    program_expect(&r, 2, "verify --bits scene.txt");
    assert_non_null(strstr(r.messages, "--bits takes no file"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(this_build_has_the_bits_of_every_build),
        cmocka_unit_test(the_pictures_agree),
        cmocka_unit_test(a_build_that_rounds_otherwise_is_found),
        cmocka_unit_test(the_command_names_the_rows_that_differ),
        cmocka_unit_test(the_command_says_it),
    };

    return cmocka_run_group_tests_name("verify_bits", tests, NULL, NULL);
}
