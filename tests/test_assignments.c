/* assignments: each of them marks as it should (scripts/check_assignments.sh: blank, ours, two wrong solutions); a starter kit is the project but for
 * its blanks; a grade adds up. The library and objects of the present build are used: make test says which. */
#include "json_check.h"
#include "program.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

#define DIR "build/test_assignments"

static const char *const names[] = {"cdf", "alias", "envmap", "regions", "phong", "mis", "rejection", "sir", "grid", "open"};
enum { N_NAMES = sizeof names / sizeof *names };

static int shell(const char *command)
{
    fflush(stdout);
    int status = system(command);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

static char *contents(const char *path)
{
    static char text[1 << 16];
    FILE *f = fopen(path, "r");

    if (!f) return NULL;
    text[fread(text, 1, sizeof text - 1, f)] = '\0';
    fclose(f);
    return text;
}

static void assert_has(const char *text, const char *what)
{
    if (!text || !strstr(text, what)) fail_msg("no \"%s\" in: %s", what, text ? text : "(nothing)");
}

static void clean_folder(void)
{
    assert_int_equal(shell("rm -rf " DIR), 0);
    program_folder(DIR);
}

static void need_a_compiler(void)
{
    if (getenv("BIS_COMPILE")) return;
    print_message("run by make test, which tells how to compile\n");
    skip();
}

/* All at once, two at a time; the tests below read what it found. */
static int prove(void **state)
{
    (void)state;
    if (getenv("BIS_COMPILE")) shell("rm -rf \"$BIS_BUILD/assignments\"; sh scripts/check_assignments.sh > /dev/null 2>&1");
    return 0;
}

static void blank_fails_ours_passes_and_wrong_ones_get_part_marks(void **state)
{
    char path[1024], proved[64];

    need_a_compiler();
    snprintf(path, sizeof path, "%s/assignments/%s/verdict", getenv("BIS_BUILD"), (const char *)*state);
    snprintf(proved, sizeof proved, "%s: as it should be", (const char *)*state);
    assert_has(contents(path), proved);
}

static void each_has_its_handout_and_its_line_for_the_teacher(void **state)
{
    char handout[128], reference[128];

    (void)state;
    for (int i = 0; i < N_NAMES; i++) {
        snprintf(handout, sizeof handout, "docs/assignments/%s.md", names[i]);
        snprintf(reference, sizeof reference, "](%s.md)", names[i]);
        assert_true(program_exists(handout));
        assert_has(contents("docs/assignments/README.md"), reference);
        const char *text = contents(handout);
        const char *parts[] = {"**Time**", "**Thesis**", "## What you learn", "## What to write", "## Hints", "## How it is marked", "## A stretch"};
        for (size_t k = 0; k < sizeof parts / sizeof *parts; k++) {
            if (!strstr(text, parts[k])) fail_msg("%s has no \"%s\"", handout, parts[k]);
        }
    }
    assert_int_equal(shell("ls tests/assignments | sed -n 's/_blank\\.c$//p' > build/test_assignments.out"), 0);
    int n = 0;
    for (const char *c = contents("build/test_assignments.out"); *c; c++) n += *c == '\n';
    assert_int_equal(n, N_NAMES); /* none that is not proved above */
}

static void a_kit_is_the_project_but_for_its_blanks(void **state)
{
    (void)state;
    clean_folder();
    for (int i = 0; i < N_NAMES; i++) {
        char command[1024];
        snprintf(command, sizeof command,
                 "rm -rf " DIR "/kit; sh scripts/assignment.sh %s " DIR "/kit > " DIR "/out && "
                 "diff -rq include " DIR "/kit/include && cmp Makefile " DIR "/kit/Makefile && "
                 "diff -rq src " DIR "/kit/src | sed 's|^Files \\(.*\\) and .*|\\1|;s|^Only in \\(.*\\): |\\1/|' | sort > " DIR "/differ",
                 names[i]);
        assert_int_equal(shell(command), 0);
        /* What is handed in, what is hidden, and what the kit does without. */
        snprintf(command, sizeof command,
                 "{ sed -n '2,$p' " DIR "/kit/assignment; h=tests/assignments/%s_hidden.c; mkdir " DIR "/spliced; "
                 "[ ! -f $h ] || { sh scripts/splice.sh $h " DIR "/spliced | sed 's|^|src/|'; "
                 "for f in $(sed -n 's|^/\\* without: \\(.*\\) \\*/$|\\1|p' $h); do test ! -e " DIR "/kit/$f && echo $f; done; }; } | "
                 "grep ^src/ | sort -u | diff - " DIR "/differ && rm -r " DIR "/spliced", names[i]);
        assert_int_equal(shell(command), 0);
        snprintf(command, sizeof command, "cmp docs/assignments/%s.md " DIR "/kit/ASSIGNMENT.md && cmp tests/assignments/%s.c " DIR "/kit/tests/test_assignment.c", names[i], names[i]);
        assert_int_equal(shell(command), 0);
        assert_int_equal(shell("test \"$(ls " DIR "/kit/tests/test_*)\" = " DIR "/kit/tests/test_assignment.c && test ! -e " DIR "/kit/tests/assignments"), 0);
        /* no page and no script quotes a line that is blank now */
        assert_int_equal(shell("diff -r src " DIR "/kit/src | sed -n 's/^< *//p' | awk 'length > 30 && !/^for \\(/' > " DIR "/secret && test -s " DIR "/secret && "
                               "! grep -rIF -f " DIR "/secret " DIR "/kit/docs " DIR "/kit/scripts " DIR "/kit/include " DIR "/kit/README.md"), 0);
    }
}

/* Where the kit of sir draws N of the M: in the student's file, and nowhere else. */
static void the_kit_of_sir_has_no_other_copy_of_its_answer(void **state)
{
    (void)state;
    clean_folder();
    assert_int_equal(shell("sh scripts/assignment.sh sir " DIR "/kit > " DIR "/out && "
                           "! grep -rE 'bis_candidates_trace\\(.*Zhat|bis_blocks_choose' " DIR "/kit/src " DIR "/kit/docs " DIR "/kit/scripts"), 0);
}

static void what_cannot_be_made_is_refused_with_the_way_out(void **state)
{
    (void)state;
    clean_folder();
    assert_int_equal(shell("sh scripts/assignment.sh 2> " DIR "/err"), 1);
    assert_has(contents(DIR "/err"), "make assignment A=alias DEST=");
    assert_int_equal(shell("sh scripts/assignment.sh quux " DIR "/kit 2> " DIR "/err"), 1);
    assert_has(contents(DIR "/err"), "there is no assignment \"quux\" (there are: alias cdf");
    assert_int_equal(shell("sh scripts/assignment.sh alias . 2> " DIR "/err"), 1);
    assert_has(contents(DIR "/err"), ". exists and is not empty");
    assert_int_equal(shell("sh scripts/grade.sh " DIR " 2> " DIR "/err"), 1);
    assert_has(contents(DIR "/err"), "is this a folder of make assignment?");
}

static void an_untouched_kit_is_worth_nothing(void **state)
{
    (void)state;
    need_a_compiler();
    clean_folder();
    assert_int_equal(shell("sh scripts/assignment.sh alias " DIR "/kit > /dev/null && sh scripts/grade.sh " DIR "/kit > " DIR "/out"), 0);
    assert_has(contents(DIR "/out"), "\n  0 of 100  alias\n");
    assert_has(contents(DIR "/kit/grade.json"), "\"points\": 0,\n  \"of\": 100,\n  \"warnings\": 0,");
    assert_true(json_is_valid(contents(DIR "/kit/grade.json")));
}

/* Ours, but for ten doubles that nobody frees. */
static void a_right_solution_that_leaks_loses_the_points_for_memory_alone(void **state)
{
    (void)state;
    need_a_compiler();
    if (strstr(getenv("BIS_COMPILE"), "-fsanitize")) {
        print_message("all claims are compiled with a sanitizer here, and each would find the leak\n");
        skip();
    }
    clean_folder();
    assert_int_equal(shell("sh scripts/assignment.sh alias " DIR "/kit > /dev/null && "
                           "sed 's|^    while (s->n_large > 0 && s->n_small > 0) {|    double *waste = bis_alloc(10, sizeof *waste);\\n    if (waste) waste[s->n % 10] = 1;\\n&|' "
                           "src/thesis/alias.c > " DIR "/kit/src/thesis/alias.c && sh scripts/grade.sh " DIR "/kit > " DIR "/out"), 0);
    assert_has(contents(DIR "/out"), " 20 of  20  every_table_gives_the_weights\n");
    assert_has(contents(DIR "/out"), "times our time\n");
    assert_has(contents(DIR "/out"), "  0 of  10  clean memory: ");
    assert_true(json_is_valid(contents(DIR "/kit/grade.json")));
}

/* A loop, a crash and an exit, each in one claim; a test and a header of the student's own, which nobody asked for. */
static void what_ends_badly_costs_the_claim_that_it_happens_in_and_changed_tests_change_nothing(void **state)
{
    (void)state;
    need_a_compiler();
    clean_folder();
    assert_int_equal(shell("sh scripts/assignment.sh alias " DIR "/kit > /dev/null && "
                           "sed -e 's|^    while (s->n_large > 0 && s->n_small > 0) {|    if (s->n == 17) exit(0);\\n&|' "
                           "-e 's|^    assert(u >= 0 && u < 1);|    if (u == 0.99) while (1);\\n    if (n == 4 \\&\\& u == 0) abort();|' "
                           "-e 's/^#include <math.h>/&\\n#include <stdlib.h>/' src/thesis/alias.c > " DIR "/kit/src/thesis/alias.c && "
                           "echo 'int main(void) { return 0; }' > " DIR "/kit/tests/test_assignment.c && mkdir " DIR "/kit/src/bis && "
                           "echo '#error not ours' > " DIR "/kit/src/bis/alias.h && BIS_CLAIM_SECONDS=1 sh scripts/grade.sh " DIR "/kit > " DIR "/out"), 0);
    assert_has(contents(DIR "/out"), "  0 of  20  every_table_gives_the_weights: it ended before the test did: a call of exit?\n");
    assert_has(contents(DIR "/out"), "  0 of  15  the_bin_and_the_coin_come_from_one_u: no answer in the time allowed: a loop without end?\n");
    assert_has(contents(DIR "/out"), "  0 of  10  an_item_of_weight_0_is_not_drawn_even_when_the_coin_is_0: it was aborted");
    assert_has(contents(DIR "/out"), "\n 45 of 100  alias\n");
}

static void what_does_not_compile_is_worth_nothing(void **state)
{
    (void)state;
    need_a_compiler();
    clean_folder();
    assert_int_equal(shell("sh scripts/assignment.sh alias " DIR "/kit > /dev/null && echo 'int x = ;' >> " DIR "/kit/src/thesis/alias.c && "
                           "sh scripts/grade.sh " DIR "/kit > " DIR "/out 2> /dev/null"), 0);
    assert_has(contents(DIR "/out"), "  0 of 100  alias\n");
}

int main(void)
{
    struct CMUnitTest tests[N_NAMES + 8];
    char labels[N_NAMES][96];

    for (int i = 0; i < N_NAMES; i++) {
        snprintf(labels[i], sizeof labels[i], "blank_fails_ours_passes_and_wrong_ones_get_part_marks: %s", names[i]);
        tests[i] = (struct CMUnitTest){.name = labels[i], .test_func = blank_fails_ours_passes_and_wrong_ones_get_part_marks};
        tests[i].initial_state = (void *)(uintptr_t)names[i];
    }
    const struct CMUnitTest others[] = {
        cmocka_unit_test(each_has_its_handout_and_its_line_for_the_teacher),
        cmocka_unit_test(a_kit_is_the_project_but_for_its_blanks),
        cmocka_unit_test(the_kit_of_sir_has_no_other_copy_of_its_answer),
        cmocka_unit_test(what_cannot_be_made_is_refused_with_the_way_out),
        cmocka_unit_test(an_untouched_kit_is_worth_nothing),
        cmocka_unit_test(a_right_solution_that_leaks_loses_the_points_for_memory_alone),
        cmocka_unit_test(what_ends_badly_costs_the_claim_that_it_happens_in_and_changed_tests_change_nothing),
        cmocka_unit_test(what_does_not_compile_is_worth_nothing),
    };
    memcpy(tests + N_NAMES, others, sizeof others);
    return cmocka_run_group_tests(tests, prove, NULL);
}
