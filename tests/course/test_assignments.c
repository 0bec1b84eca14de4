/* SPDX-License-Identifier: BSD-2-Clause */
/* assignments: each of them marks as it should (scripts/course/check_assignments.sh: blank, ours, wrong solutions);
 * a starter kit is the project but for its blanks; a grade adds up. The library and objects of the present build are
 * used: make test says which. */
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
#define SHOP "build/test_assignments_shop"
#define GRADE "BIS_SHOP=\"$PWD/" SHOP "\" sh scripts/course/grade.sh alias"

static const char *const names[] = {"cdf", "alias",     "envmap", "regions", "phong",
                                    "mis", "rejection", "sir",    "grid",    "open"};
enum { N_NAMES = sizeof names / sizeof *names };

static int shell(const char *command)
{
    fflush(stdout);
    int status = system(command);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

static char *contents(const char *path)
{
    static char text[1 << 18];
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

/* All at once, two at a time; the tests below read what it found. BIS_TEST may name one of the others. */
static int prove(void **state)
{
    const char *chosen = getenv("BIS_TEST");

    (void)state;
    if (getenv("BIS_COMPILE")) {
        if (!chosen || strncmp(chosen, "blank", 5) == 0)
            shell("rm -rf \"$BIS_BUILD/assignments\"; sh scripts/course/check_assignments.sh > /dev/null 2>&1");
        shell("rm -rf " SHOP "; sh scripts/course/grade_shop.sh alias \"$PWD/" SHOP "\"");
    }
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
        const char *parts[] = {"**Time**", "**Thesis**", "## What you learn",     "## On paper, before you write",
                               "## What to write", "## Hints", "## How it is marked", "## In your own run",
                               "## A stretch"};
        for (size_t k = 0; k < sizeof parts / sizeof *parts; k++) {
            if (!strstr(text, parts[k])) fail_msg("%s has no \"%s\"", handout, parts[k]);
        }
        char command[256]; /* rows "| 10 + 5 | for what |": 80 for the tests, 10 for speed, 10 for memory */
        snprintf(command, sizeof command,
                 "awk -F '|' '/^[|] *[0-9]/ { n = split($2, a, \"+\"); for (i = 1; i <= n; i++) all += a[i] } "
                 "END { exit all != 100 }' %s", handout);
        if (shell(command) != 0) fail_msg("the points in %s do not sum to 100", handout);
        snprintf(command, sizeof command,
                 "sed -n '/^## %s$/,/^## /p' docs/assignments/answers.md | "
                 "grep -c '^1\\. \\|^\\*Own run\\*\\|^\\*By word of mouth\\*' | grep -qx 3", names[i]);
        if (shell(command) != 0) fail_msg("the written half of %s has no answers", names[i]);
    }
    assert_int_equal(shell("ls tests/course | sed -n 's/_blank\\.c$//p' > build/test_assignments.out"), 0);
    int n = 0;
    for (const char *c = contents("build/test_assignments.out"); *c; c++)
        n += *c == '\n';
    assert_int_equal(n, N_NAMES); /* none that is not proved above */
}

static void a_kit_is_the_project_but_for_its_blanks(void **state)
{
    (void)state;
    clean_folder();
    for (int i = 0; i < N_NAMES; i++) {
        char command[1024];
        snprintf(command, sizeof command,
                 "rm -rf " DIR "/kit; sh scripts/course/assignment.sh %s " DIR "/kit > " DIR "/out && "
                 "diff -rq include " DIR "/kit/include && cmp Makefile " DIR "/kit/Makefile && "
                 "diff -rq src " DIR "/kit/src | sed 's|^Files \\(.*\\) and .*|\\1|;s|^Only in \\(.*\\): |\\1/|' | "
                     "sort > " DIR "/differ",
                 names[i]);
        assert_int_equal(shell(command), 0);
        /* What is handed in, what is hidden, and what the kit does without. */
        snprintf(command, sizeof command,
                 "{ sed -n '2,$p' " DIR "/kit/assignment; h=tests/course/%s_hidden.c; mkdir " DIR "/spliced; "
                 "[ ! -f $h ] || { sh scripts/course/splice.sh $h " DIR "/spliced | sed 's|^|src/|'; "
                 "for f in $(sed -n 's|^/\\* without: \\(.*\\) \\*/$|\\1|p' $h); do test ! -e " DIR "/kit/$f && echo "
                     "$f; done; }; } | "
                 "grep ^src/ | sort -u | diff - " DIR "/differ && rm -r " DIR "/spliced", names[i]);
        assert_int_equal(shell(command), 0);
        snprintf(command, sizeof command,
                 "cmp docs/assignments/form.txt " DIR "/kit/form.txt && "
                 "grep -q 'left out' " DIR "/kit/docs/assignments/answers.md && "
                 "sed 's|](written|](docs/assignments/written|' docs/assignments/%s.md | cmp - " DIR
                 "/kit/ASSIGNMENT.md && cmp tests/course/%s.c " DIR
                 "/kit/tests/test_assignment.c",
                 names[i], names[i]);
        assert_int_equal(shell(command), 0);
        assert_int_equal(shell("test \"$(ls " DIR "/kit/tests/test_*)\" = " DIR
                               "/kit/tests/test_assignment.c && test ! -e " DIR "/kit/tests/course"),
                         0);
        /* no page and no script quotes a line that is blank now */
        assert_int_equal(shell("diff -r src " DIR
                               "/kit/src | sed -n 's/^< *//p' | awk 'length > 30 && !/^(for|return bis_error) ?\\(/' "
                                   "> " DIR
                               "/secret && test -s " DIR "/secret && "
                               "! grep -rIF -f " DIR "/secret " DIR "/kit/docs " DIR "/kit/scripts " DIR
                               "/kit/include " DIR "/kit/README.md"),
                         0);
    }
}

/* Where the kit of sir makes an estimate of N of the M: in the student's file, and nowhere else. */
static void the_kit_of_sir_has_no_other_copy_of_its_answer(void **state)
{
    (void)state;
    clean_folder();
    assert_int_equal(shell("sh scripts/course/assignment.sh sir " DIR "/kit > " DIR "/out && "
                           "! grep -rE 'bis_set_trace\\(.*Zhat / N' " DIR "/kit/src " DIR "/kit/docs "
                               "" DIR "/kit/scripts"), 0);
}

static void what_cannot_be_made_is_refused_with_the_way_out(void **state)
{
    (void)state;
    clean_folder();
    assert_int_equal(shell("sh scripts/course/assignment.sh 2> " DIR "/err"), 1);
    assert_has(contents(DIR "/err"), "make assignment A=alias DEST=");
    assert_int_equal(shell("sh scripts/course/assignment.sh quux " DIR "/kit 2> " DIR "/err"), 1);
    assert_has(contents(DIR "/err"), "there is no assignment \"quux\" (there are: alias cdf");
    assert_int_equal(shell("sh scripts/course/assignment.sh alias . 2> " DIR "/err"), 1);
    assert_has(contents(DIR "/err"), ". exists and is not empty");
    assert_int_equal(shell("sh scripts/course/grade.sh alias 2> " DIR "/err"), 1);
    assert_has(contents(DIR "/err"), "make grade A=alias DEST=");
    assert_int_equal(shell("sh scripts/course/grade.sh ../alias " DIR " 2> " DIR "/err"), 1);
    assert_has(contents(DIR "/err"), "there is no assignment \"../alias\"");
    assert_int_equal(shell("sh scripts/course/grade_class.sh alias " DIR "/none 2> " DIR "/err"), 1);
    assert_has(contents(DIR "/err"), "is no folder");
    assert_int_equal(shell("sh scripts/course/grade_class.sh alias " DIR " 0 2> " DIR "/err"), 1);
    assert_has(contents(DIR "/err"), "JOBS is a number");
}

static void an_untouched_kit_is_worth_nothing(void **state)
{
    (void)state;
    need_a_compiler();
    clean_folder();
    assert_int_equal(
        shell("sh scripts/course/assignment.sh alias " DIR "/kit > /dev/null && " GRADE " " DIR "/kit > " DIR "/out"),
            0);
    assert_has(contents(DIR "/out"), "\n  0 of 100  alias\n");
    assert_has(contents(DIR "/kit/grade.json"),
               "\"points\": 0,\n  \"of\": 100,\n  \"warnings\": 0,\n  \"remarks\": [],");
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
    assert_int_equal(shell("sh scripts/course/assignment.sh alias " DIR "/kit > /dev/null && "
                           "sed 's|^    while (s->n_large > 0 && s->n_small > 0) {|    double *waste = bis_alloc(10, "
                           "sizeof *waste);\\n    if (waste) waste[s->n % 10] = 1;\\n&|' "
                           "src/thesis/alias.c > " DIR "/kit/src/thesis/alias.c && " GRADE " " DIR "/kit > " DIR
                           "/out"),
                     0);
    assert_has(contents(DIR "/out"), " 20 of  20  every_table_gives_the_weights\n");
    assert_has(contents(DIR "/out"), "times our time\n");
    assert_has(contents(DIR "/out"), "  0 of  10  clean memory: ");
    assert_true(json_is_valid(contents(DIR "/kit/grade.json")));
}

/* Ours, but for tables of the size that is timed, which are left as they come. */
static void a_load_that_is_skipped_is_worth_nothing(void **state)
{
    (void)state;
    need_a_compiler();
    clean_folder();
    assert_int_equal(
        shell("sh scripts/course/assignment.sh alias " DIR "/kit > /dev/null && "
              "sed 's|^    while (s->n_large > 0 && s->n_small > 0) {|    if (s->n >= 100000 \\&\\& s->n <= "
              "125000) s->n_large = 0;\\n&|' "
              "src/thesis/alias.c > " DIR "/kit/src/thesis/alias.c && " GRADE " " DIR "/kit > " DIR "/out"),
        0);
    assert_has(contents(DIR "/out"), " 10 of  10  tables_hold_for_a_contrast_of_1e12_and_a_million_items\n");
    assert_has(contents(DIR "/out"), "  0 of  10  speed: bin "); /* which one, depends on the secret weights */
}

/* A loop, a call of abort, an assertion and an exit, each in one claim; a test and a header of the student's own, which
 * nobody asked for. */
static void what_ends_badly_costs_the_claim_that_it_happens_in_and_changed_tests_change_nothing(void **state)
{
    (void)state;
    need_a_compiler();
    clean_folder();
    assert_int_equal(
        shell(
            "sh scripts/course/assignment.sh alias " DIR "/kit > /dev/null && "
            "sed -e 's|^    while (s->n_large > 0 && s->n_small > 0) {|    if (s->n >= 17 \\&\\& s->n <= 21) "
            "exit(0);\\n&|' "
            "-e 's|^    assert(u >= 0 && u < 1);|    if (u == 0.99) while (1);\\n    if (n == 4 \\&\\& u == 0) "
            "abort();\\n    assert(n != 50);|' "
            "-e 's/^#include <math.h>/&\\n#include <stdlib.h>/' src/thesis/alias.c > " DIR "/kit/src/thesis/alias.c && "
            "echo 'int main(void) { return 0; }' > " DIR "/kit/tests/test_assignment.c && mkdir " DIR "/kit/src/bis && "
            "echo '#error not ours' > " DIR "/kit/src/bis/alias.h && BIS_CLAIM_SECONDS=1 " GRADE " " DIR "/kit > " DIR
            "/out"),
        0);
    assert_has(contents(DIR "/out"),
               "  0 of  20  every_table_gives_the_weights: it ended before the test did: a call of exit?\n");
    assert_has(
        contents(DIR "/out"),
        "  0 of  15  the_bin_and_the_coin_come_from_one_u: no answer in the time allowed: a loop without end?\n");
    assert_has(
        contents(DIR "/out"),
        "  0 of  10  an_item_of_weight_0_is_not_drawn_even_when_the_coin_is_0: it was aborted: a call of abort?");
    assert_has(contents(DIR "/out"),
               "  0 of  10  items_are_drawn_with_their_probabilities: it was aborted: an assertion "
               "failed, see there what it demands It printed: ");
    assert_has(contents(DIR "/out"), "\n 28 of 100  alias\n");
    assert_has(contents(DIR "/out"), "  3 of  10  clean memory: in the share of the tests that pass\n");
}

/* The compiler's own end, too, has its words. */
static void what_the_compiler_has_no_memory_for_is_said(void **state)
{
    (void)state;
    need_a_compiler();
    clean_folder();
    assert_int_equal(shell("sh tests/course/handed_in/make.sh " DIR "/all && " GRADE " " DIR "/all/*macro?bomb.c > " DIR
                           "/out 2> /dev/null"),
                     0);
    assert_has(contents(DIR "/out"), "remark: it does not compile: ");
    assert_has(contents(DIR "/out"), " memory");
}

static void what_does_not_compile_is_worth_nothing(void **state)
{
    (void)state;
    need_a_compiler();
    clean_folder();
    assert_int_equal(shell("sh scripts/course/assignment.sh alias " DIR "/kit > /dev/null && echo 'int x = ;' >> " DIR
                           "/kit/src/thesis/alias.c && "
                           "" GRADE " " DIR "/kit > " DIR "/out 2> /dev/null"),
                     0);
    assert_has(contents(DIR "/out"), "  0 of 100  alias\n");
}

/* The seeds and sizes of a claim: the kit's without a secret, others with one. */
static void hidden_seeds_and_sizes_are_the_kits_without_a_secret_alone(void **state)
{
    (void)state;
    need_a_compiler();
    clean_folder();
    program_write_file(
        DIR "/claims.c",
        "#include \"mark.h\"\n"
        "static void sizes(void) { for (size_t k = 0; k < 1000; k++) { size_t n = mark_size(k); if (n < k || n > k + k "
        "/ 4) mark_wrong(\"size %zu\", n); } }\n"
        "static void show(void) { mark_wrong(\"%llu %zu.\", (unsigned long long)mark_seed(7), mark_size(1000000)); }\n"
        "static void work(void) {}\n"
        "int main(int argc, char **argv) { const mark_claim c[] = {{\"sizes\", 1, sizes}, {\"show\", 2, show}}; return "
        "mark_main(argc, argv, c, 2, work, 1); }\n");
    assert_int_equal(shell("cd " DIR " && mkdir seeds && P=\"$OLDPWD\" && cd \"$P\" && $BIS_COMPILE -c -o " DIR
                           "/claims.o " DIR "/claims.c && "
                           "$BIS_LINK -o " DIR "/claims " DIR "/claims.o $BIS_OBJECTS $BIS_LIBS && for s in 0 1 2; do "
                           "BIS_SANDBOX=none \"$BIS_BUILD/grade\" claims -s $s \"$PWD/" SHOP "/ours\" " DIR "/claims "
                               "> " DIR
                           "/seeds/$s || exit 1; done"),
                     0);
    assert_string_equal(contents(DIR "/seeds/0"), "ok\t1\tsizes\t\nwrong\t2\tshow\t7 1000000.\n");
    assert_int_equal(
        shell("cd " DIR "/seeds && grep -q '^ok.*sizes' 1 && grep -q '^ok.*sizes' 2 && cat 0 1 2 | tr -c '0-9\\n' ' ' "
                        "| awk 'NF == 3 { if (s[$2]++ || n[$3]++) exit 1; k++ } END { exit k != 3 }'"),
        0);
}

/* tests/course/handed_in/cheats, without the scan that refuses most of them: no claim holds, whatever is done to the
 * process that answers. The page for teachers has their number. */
static void no_cheat_is_worth_a_point(void **state)
{
    (void)state;
    need_a_compiler();
    clean_folder();
    assert_int_equal(
        shell("set -e; n=0; for f in tests/course/handed_in/cheats/*.c; do c=$(basename $f .c); mkdir " DIR "/$c; "
              "sh scripts/course/splice.sh $f " DIR "/$c > " DIR "/spliced; "
              "$BIS_COMPILE -w -iquote src/thesis -c -o " DIR "/$c/o.o " DIR "/$c/thesis/alias.c; "
              "$BIS_LINK -Wl,-z,muldefs -o " DIR "/$c/student $BIS_SERVER " DIR "/$c/o.o " SHOP "/lib.a $BIS_LIBS; "
              "BIS_CLAIM_SECONDS=0.1 BIS_SANDBOX=none \"$BIS_BUILD/grade\" claims -s 1 \"$PWD/" DIR "/$c/student\" "
                  "" SHOP
              "/claims > " DIR "/$c/marks; "
              "awk -F '\t' '$1 != \"wrong\" || length($4) > 600 { exit 1 } END { exit NR != 6 }' " DIR "/$c/marks || "
              "{ echo $c >&2; cat " DIR "/$c/marks >&2; exit 1; }; "
              "n=$((n + 1)); done; test $n -ge 30; grep -q \"^$n ways to cheat\" docs/assignments/README.md"),
        0);
    assert_int_equal(shell("grep -q 'no work either: does it wait' " DIR "/*_wait_for_ever/marks && "
                           "grep -q 'a loop without end' " DIR "/*_loop/marks"), 0);
}

/* No name that is refused: what stops or ends who marks or writes the marks while the sanitizers look, and what sleeps
 * under a name that reads as if it worked. */
static void no_cheat_reaches_out_while_the_sanitizers_look(void **state)
{
    (void)state;
    need_a_compiler();
    clean_folder();
    if (shell("test -x " SHOP "/ours-clean") != 0) {
        print_message("no sanitizers\n");
        skip();
    }
    assert_int_equal(
        shell("set -e; for c in 24_trace_the_judge 25_kill_the_judge 33_write_by_our_library 34_find_the_c_library "
              "35_signal_by_a_descriptor 36_a_name_that_runs; do mkdir " DIR "/$c; "
              "sh scripts/course/splice.sh tests/course/handed_in/cheats/$c.c " DIR "/$c > " DIR "/spliced; "
              "$BIS_COMPILE $BIS_SANITIZE -w -iquote src/thesis -c -o " DIR "/$c/o.o " DIR "/$c/thesis/alias.c; "
              "$BIS_LINK $BIS_SANITIZE -o " DIR "/$c/student $BIS_SERVER " DIR "/$c/o.o " SHOP "/lib.a $BIS_LIBS; "
              "case $c in 36*) export BIS_CLAIM_SECONDS=0.03 ;; esac; "
              "BIS_SANDBOX=none \"$BIS_BUILD/grade\" claims -a -s 1 \"$PWD/" DIR "/$c/student\" "
              SHOP "/claims > " DIR
              "/$c/marks; test \"$(grep -c '^wrong' " DIR "/$c/marks)\" -eq 6; test ! -e " DIR "/$c/lines; "
              "! grep 'attached\\|came to no end' " DIR "/$c/marks >&2; done; "
              "grep -q 'no work either' " DIR "/36*/marks"),
        0);
}

/* Lines that compilers do not read alike, or not as we do: what goes to one has neither comments nor continued lines,
 * so that no reading hides anything. The last two are refused, the first where it is no comment. */
static void the_compiler_gets_what_was_looked_at(void **state)
{
    static const char *const ends[] = {
        "// \\ \r \n__asm__(\"\");\n", "// \\ \r\nint x;\n", "/* *\\ \n/ int x; /* */\n", "// \\\f\nint x;\n",
        "// \\\r\r\nint x;\n", "// \r int x;\n", "// what??" "/\nint x;\n", "#define TWO \\ \n 2\n",
        "char *s = \"??" "/\", \" }; x { \", /* \" /* */ }\n", "/* */ __asm__(\"\");\n"};
    enum { N = sizeof ends / sizeof *ends };
    static char text[1 << 19];

    (void)state;
    need_a_compiler();
    clean_folder();
    for (int i = 0; i < N; i++) {
        snprintf(text, sizeof text, "%s%s", contents("src/thesis/alias.c"), ends[i]);
        program_write_file(DIR "/file.c", text);
        const int status = shell("\"$BIS_BUILD/grade\" look src/thesis/alias.c " DIR "/file.c " DIR "/prints " DIR
                                 "/plain.c > " DIR "/out && ! grep '/[*/]\\|[\\]$\\|asm\\|\r' " DIR "/plain.c");
        if (status != (i < N - 2 ? 0 : i < N - 1 ? 4 : 5)) fail_msg("%s: %d", ends[i], status);
    }
}

/* Right solutions of alias, each in a style of its own (the first line of the file says which): all have 100 points,
 * but for those of speed, which a test cannot know; what is left out of them, or made static, is said. */
static void right_solutions_of_any_style_are_right(void **state)
{
    (void)state;
    need_a_compiler();
    clean_folder();
    assert_int_equal(shell("for f in tests/course/handed_in/styles/*.c tests/course/handed_in/sanitizer.c; do "
                           "sh scripts/course/splice.sh $f " DIR " > /dev/null && mkdir -p " DIR "/in && "
                           "mv " DIR "/thesis/alias.c " DIR "/in/${f##*/} || exit 1; done; "
                           "BIS_SHOP=\"$PWD/" SHOP "\" sh scripts/course/grade_class.sh alias " DIR "/in 2 > " DIR
                           "/out && "
                           "awk -F , '/^\"[01]/ { n++; if ($2 < 90 || $NF ~ /stopped/) { print; bad = 1 } } "
                           "END { exit bad || n != 15 }' " DIR "/in.alias.csv >&2"), 0);
    const char *table = contents(DIR "/in.alias.csv");
    assert_has(strstr(table, "05_"), "\"\"fill\"\" is not static; it is marked as if it were");
    assert_has(strstr(table, "11_"), "\"\"#pragma GCC unroll 4\"\" is refused; marked is the rest, without that line");
    assert_has(strstr(table, "12_"), "\"\"fopen\"\" is refused; a test that calls it ends there");
    assert_has(strstr(table, "sanitizer.c"), "asan_interface.h\"\"\"\" is refused"); /* a header of the system */
}

/* Eight others want the one processor that it has: a loop is still a loop, because time that others took is not
 * counted. */
static void a_busy_machine_changes_no_word(void **state)
{
    (void)state;
    need_a_compiler();
    clean_folder();
    if (shell("taskset -c 0 true 2> /dev/null && test -r /proc/self/schedstat") != 0) {
        print_message("no taskset, or no account of who waits\n");
        skip();
    }
    assert_int_equal(shell("mkdir " DIR "/loop && sh scripts/course/splice.sh tests/course/handed_in/cheats/*_loop.c "
                           "" DIR "/loop > " DIR "/spliced && "
                           "$BIS_COMPILE -w -iquote src/thesis -c -o " DIR "/o.o " DIR "/loop/thesis/alias.c && "
                           "$BIS_LINK -o " DIR "/student $BIS_SERVER " DIR "/o.o " SHOP "/lib.a $BIS_LIBS && "
                           "printf 'left\\nleft\\nleft\\nok\\t\\nleft\\nleft\\n' > " DIR "/one"),
                     0);
    assert_int_equal(shell("hogs=; for k in 1 2 3 4 5 6 7 8; do taskset -c 0 sh -c 'while :; do :; done' & "
                           "hogs=\"$hogs $!\"; done; "
                           "BIS_CLAIM_SECONDS=0.3 BIS_SANDBOX=none taskset -c 0 \"$BIS_BUILD/grade\" claims -k "
                               "" DIR "/one -s 1 "
                           "\"$PWD/" DIR "/student\" " SHOP "/claims > " DIR "/out; kill $hogs; wait"),
                     0);
    assert_has(contents(DIR "/out"), "no answer in the time allowed: a loop without end?");
}

/* The judge says 75 where the machine gave it no time; here a script says so at once. */
static void what_a_busy_machine_could_not_judge_is_not_marked_and_never_0(void **state)
{
    (void)state;
    need_a_compiler();
    clean_folder();
    assert_int_equal(shell("set -e; b=$(realpath \"$BIS_BUILD\"); mkdir " DIR "/in " DIR "/busy; "
                           "cp src/thesis/alias.c " DIR "/in/right.c; ln -s \"$b\"/* " DIR "/busy; cd " DIR "/busy; "
                           "rm grade; printf '#!/bin/sh\\n[ $1 != claims ] || exit 75\\nexec %s/grade \"$@\"\\n' "
                           "\"$b\" > grade; chmod 755 grade"),
                     0);
    assert_int_equal(shell("BIS_BUILD=" DIR "/busy BIS_SHOP=\"$PWD/" SHOP "\" sh scripts/course/grade.sh alias " DIR
                           "/in/right.c > " DIR "/out 2>&1"),
                     1);
    assert_has(contents(DIR "/out"), "not marked: the machine was too busy to judge it; mark it again");
    assert_int_equal(shell("BIS_BUILD=" DIR "/busy BIS_SHOP=\"$PWD/" SHOP "\" sh scripts/course/grade_class.sh alias "
                           DIR "/in 1 moodle > " DIR "/out 2>&1"),
                     0);
    assert_has(contents(DIR "/out"), "right.c: not marked");
    assert_has(contents(DIR "/in.alias.csv"), "\"right.c\",not marked,,,,");
    assert_has(contents(DIR "/in.alias.moodle.csv"), "\"right.c\",,100,,");
}

/* What is huge, deep, packed or linked is found out before it is read: 20 s of the processor and 400 MB are enough
 * for all. */
static void what_is_handed_in_is_bounded_before_it_is_read(void **state)
{
    (void)state;
    need_a_compiler();
    clean_folder();
    assert_int_equal(
        shell("set -e; cd " DIR "; mkdir -p in/huge/src/thesis in/name in/zero 'in/deep' in/many in/packed; truncate "
              "-s 3G in/huge/assignment "
              "in/huge/src/thesis/alias.c in/huge.c; truncate -s 3G in/name/assignment; cp ../../src/thesis/alias.c "
                  "in/name; "
              "ln -s /dev/zero in/zero/assignment; ln -s /dev/zero in/zero/alias.c; "
              "d=in/deep; for k in $(seq 100); do d=$d/deeper; done; mkdir -p $d; cp ../../src/thesis/alias.c $d; "
              "(cd in/many; seq -f '%04.0f.c' 3000 | xargs touch); printf 'PK\\003\\004' > in/packed/alias.zip; cp "
                  "in/packed/alias.zip in/alias.c; mkdir in/bz2 in/tbz2; printf 'BZh9' | tee in/bz2/alias.tar.bz2 "
                  "in/tbz2/alias.tbz2 > in/bz.c; for e in tar.zst tar.Z txz; do mkdir in/$e; echo x > in/$e/alias.$e; "
                  "done; printf '(\\265/\\375' > in/zst.c"),
        0);
    assert_int_equal(shell("(ulimit -t 20; ulimit -v 400000; for f in " DIR "/in/*; do echo \"== $f\"; " GRADE " "
                           "\"$f\" || exit 1; done) > " DIR "/out 2>&1 || true"), 0);
    const char *out = contents(DIR "/out");
    assert_has(out, "remark: it is an archive: unpack it, and mark the folder");
    assert_has(strstr(out, "in/bz.c"), "\nremark: it is an archive: unpack it, and mark the folder");
    assert_has(out, "remark: alias.zip is an archive: unpack it, and mark the folder");
    assert_has(out, "remark: alias.tar.bz2 is an archive: unpack it, and mark the folder");
    assert_has(out, "remark: alias.tbz2 is an archive: unpack it, and mark the folder");
    assert_has(out, "remark: alias.tar.zst is an archive: unpack it, and mark the folder");
    assert_has(out, "remark: alias.tar.Z is an archive: unpack it, and mark the folder");
    assert_has(out, "remark: alias.txz is an archive: unpack it, and mark the folder");
    assert_has(strstr(out, "in/zst.c"), "\nremark: it is an archive: unpack it, and mark the folder");
    assert_has(out, "alias.c is missing (or a link, of more than a million bytes, or deeper than 12 levels)");
    assert_has(out, "remark: it has more than a million bytes");
    assert_has(out, "remark: there are more than 2000 files");
    assert_int_equal(shell("test $(grep -c '^== ' " DIR "/out) -eq 15 && test $(grep -c ' of 100  alias' " DIR "/out) "
                           "-eq 15"), 0);
}

/* A folder whose name is no UTF-8, as a ZIP of Windows has it; an archive that has the name of the file. */
static void a_folder_of_any_name_is_looked_at_and_a_renamed_archive_is_named(void **state)
{
    (void)state;
    need_a_compiler();
    clean_folder();
    assert_int_equal(shell("cd " DIR " && d=$(printf 'in/J\\374rgen\\n2') && mkdir -p \"$d\" zip && "
                           "cp ../../src/thesis/alias.c \"$d\" && printf 'PK\\003\\004\\000' > zip/alias.c"), 0);
    assert_int_equal(shell("export LC_ALL=C.UTF-8; for d in in zip; do " GRADE " " DIR "/$d; done > " DIR "/out"), 0);
    assert_has(contents(DIR "/out"), " 20 of  20  every_table_gives_the_weights\n");
    assert_has(contents(DIR "/out"), "remark: alias.c: it is an archive: unpack it, and mark the folder\n");
}

/* What `make check` runs in a kit: ours has all points, but for those of speed, which a test cannot know. */
static void points_can_be_seen_before_handing_in(void **state)
{
    (void)state;
    need_a_compiler();
    clean_folder();
    assert_int_equal(shell(SHOP "/claims --check > " DIR "/out"), 0);
    assert_has(contents(DIR "/out"), "20 of 20  every_table_gives_the_weights\n");
    assert_has(contents(DIR "/out"), " of 10  speed: about ");
    assert_int_equal(shell(SHOP "/claims --clean > " DIR "/out"), 0);
    assert_has(contents(DIR "/out"), "10 of 10  clean memory");
}

/* The message says where the picture is. */
static void a_chi_square_that_fails_is_drawn(void **state)
{
    (void)state;
    need_a_compiler();
    clean_folder();
    assert_int_equal(shell("mkdir " DIR "/build && sh scripts/course/splice.sh tests/course/cdf_wrong2.c " DIR
                           " > /dev/null && $BIS_COMPILE -w -iquote src/thesis -c -o " DIR "/cdf.o " DIR
                           "/thesis/cdf.c && $BIS_COMPILE -w -c -o " DIR "/claims.o tests/course/cdf.c && $BIS_LINK "
                           "-o " DIR "/claims " DIR "/claims.o " DIR "/cdf.o $BIS_OBJECTS $BIS_LIBS && cd " DIR
                           " && ./claims --check > out"),
                     0);
    assert_has(contents(DIR "/out"), "beside expected (blue), as square roots: build/items_are_drawn_with");
    assert_int_equal(shell("./bis compare " DIR "/build/items*.png " DIR "/build/items*.png > " DIR
                           "/compared && test \"$(ls " DIR "/build | wc -l)\" -eq 1"), 0);
}

/* In a kit: a cheat, a file of a link, a file that is too large, nothing, ours. */
static void what_make_grade_refuses_make_check_tells(void **state)
{
    (void)state;
    need_a_compiler();
    clean_folder();
    assert_int_equal(shell("set -e; root=$PWD; sh scripts/course/assignment.sh alias " DIR "/kit > /dev/null; "
                           "sh scripts/course/splice.sh tests/course/handed_in/cheats/21_*.c " DIR " > /dev/null; "
                           "case $BIS_BUILD in /*) ;; *) BIS_BUILD=$root/$BIS_BUILD ;; esac; cd " DIR
                           "/kit; f=src/thesis/alias.c; "
                           "look() { echo \"== $1\"; sh scripts/course/check.sh || true; }; "
                           "{ look nothing; cp ../thesis/alias.c $f; look cheat; ln -sf $root/$f $f; look link; rm $f; "
                           "truncate -s 3M $f; look size; cp $root/$f $f; look ours; } > ../check 2>&1; cd $root; "
                           "cp " DIR "/thesis/alias.c " DIR "/kit/src/thesis; " GRADE " " DIR "/kit > " DIR "/out; "
                           "grep '^remark' " DIR "/out > " DIR "/refused; grep -c . " DIR "/refused"),
                     0);
    assert_int_equal(shell("sed -n '/== cheat/,/== link/p' " DIR "/check | grep '^remark' | diff " DIR "/refused -"),
                     0);
    assert_has(contents(DIR "/check"), "== nothing\nmake grade will give no points: nothing is written\n");
    assert_has(contents(DIR "/check"), "== link\nremark: alias.c is missing (or a link");
    assert_has(contents(DIR "/check"), "== size\nremark: alias.c is missing (or a link");
    assert_has(contents(DIR "/check"), "== ours\n");
    assert_null(strstr(strstr(contents(DIR "/check"), "== ours\n"), "remark"));
}

static void what_is_left_behind_is_ended(void **state)
{
    (void)state;
    need_a_compiler();
    clean_folder();
    for (int i = 0; i < 2; i++) { /* the sleepers keep the pipe; one has left its group */
        char command[512];
        snprintf(command, sizeof command,
                 "BIS_SANDBOX=%s \"$BIS_BUILD/grade\" run -- sh -c 'sleep 31415926 & setsid sleep 31415926 & echo "
                 "started' > " DIR "/out",
                 i ? "none" : "$(cat " SHOP "/sandbox)");
        assert_int_equal(shell(command), 0);
        assert_has(contents(DIR "/out"), "started");
        assert_int_equal(shell("n=0; while grep -lsa '3141592[6]' /proc/[0-9]*/cmdline > " DIR
                               "/left; do n=$((n + 1)); [ $n -lt 100 ] || exit 1; sleep 0.1; done"),
                         0);
    }
}

/* Points of `student` in the table of DIR/in. */
static int points_of(const char *student)
{
    char start[300];

    snprintf(start, sizeof start, "\n\"%s\",", student);
    const char *row = strstr(contents(DIR "/in.alias.csv"), start);
    if (!row) fail_msg("no row of %s", student);
    return (int)strtol(row + strlen(start), NULL, 10);
}

/* Right, wrong, empty, copied and hostile ones (tests/course/handed_in/make.sh), but for some that take long to
 * fail. */
static void a_class_is_marked_whatever_is_handed_in(void **state)
{
    (void)state;
    need_a_compiler();
    clean_folder();
    assert_int_equal(shell("mkdir " DIR "/tmp && sh tests/course/handed_in/make.sh " DIR "/in && cd " DIR
                           "/in && rm right[1345]* =odd5* odd6* wrong2* copy*right1* *?bomb* *memory* *flood* *loop* "
                               "*limits*"),
                     0);
    assert_int_equal(shell("TMPDIR=\"$PWD/" DIR "/tmp\" BIS_SHOP=\"$PWD/" SHOP
                           "\" BIS_CLAIM_SECONDS=5 sh scripts/course/grade_class.sh alias " DIR "/in/ 2 > " DIR "/out "
                               "2>&1"),
                     0);
    assert_int_equal(shell("test -z \"$(ls -A " DIR "/tmp)\" && ! ls | grep '^x$'"), 0);

    /* whatever is no solution is worth nothing, and there is a row for each */
    assert_int_equal(shell("ls -d " DIR "/in/attack* " DIR "/in/nothing* | wc -l > " DIR "/n && "
                           "grep -c '^\"\\(attack\\|nothing\\)[^\"]*\",0,0,0,0,0,0,0,0,0,' " DIR
                           "/in.alias.csv | diff -w " DIR "/n -"),
                     0);
    assert_true(points_of("wrong1.c") >= 25 && points_of("wrong1.c") < 90);
    const char *right[] = {"right2.c",
                           "right6, with a helper and an include outside of the marks.c",
                           "odd1, Jürgen Groß",
                           "'-odd4, lines as in DOS.c",
                           "odd7, changed outside of the marks.c",
                           "copy of right2.c"};
    for (size_t i = 0; i < sizeof right / sizeof *right; i++) {
        if (points_of(right[i]) < 90)
            fail_msg("%s: %d", right[i], points_of(right[i])); /* 10 are for speed, which a test cannot know */
        assert_true(points_of(right[i]) <= 100);
    }
    assert_int_equal(points_of("odd2, \"\"quoted\"\" & <b>it's; $(touch x) `touch x`.c"),
                     0); /* nothing, of odd names */
    assert_int_equal(points_of("odd3,\\ntwo lines.txt"), 0);
    assert_has(contents(DIR "/out"), "100 %: copy of right2.c, right2.c\n");
    assert_null(strstr(contents(DIR "/out"), ": right2.c, right6")); /* written by two */
    assert_has(contents(DIR "/out"),
               " %: nothing8, does not compile.c, right6, with a helper and an include outside of "
               "the marks.c, wrong1.c, our own solution\n");
    const char *page = contents(DIR "/in.alias.html");
    assert_has(page, "odd2, &quot;quoted&quot; &amp; &lt;b&gt;it&#39;s; $(touch x) `touch x`.c");
    assert_null(strstr(page, "<b>"));
}

/* Nine right solutions, of which no two are alike, though four are the obvious one; and a copy of each, with its
 * letters changed, its functions in another order, and twenty functions that nobody calls in front. */
static void a_copy_is_found_and_who_wrote_alone_is_not(void **state)
{
    (void)state;
    need_a_compiler();
    clean_folder();
    assert_int_equal(
        shell(
            "for k in 1 2 3 4 5 6 7 8 9; do f=" DIR
            "/$k.c; if [ $k -eq 9 ]; then sed -n '/\\[alias-build\\]/,/\\[end\\]/p; /\\[alias-sample\\]/,/\\[end\\]/p' "
            "src/thesis/alias.c > $f; else "
            "cp tests/course/handed_in/right$k.c $f; fi; "
            "awk '/alias-sample/ { later = 1 } { if (later) print; else first = first $0 \"\\n\" } END { printf "
            "\"%s\", first }' $f | "
            "sed 's/\\<u\\>/v/g; s/^ *//' > " DIR "/copy; { sed -n 1p " DIR
            "/copy; for n in $(seq ${k}001 ${k}020); do "
            "echo \"static int pad$n(int x) { for (int i = $n; i < x; i++) x -= i / $n; return x * x % $n; }\"; done; "
            "sed 1d " DIR "/copy; } > " DIR "/copy$k.c; "
            "for who in $k copy$k; do mkdir " DIR "/$who && sh scripts/course/splice.sh " DIR "/$who.c " DIR
            "/$who > /dev/null && "
            "\"$BIS_BUILD/grade\" look src/thesis/alias.c " DIR "/$who/thesis/alias.c " DIR
            "/$who.prints || exit 1; done; done; cd " DIR " && "
            "P=\"[1-9].prints copy[1-9].prints\" && case $BIS_BUILD in /*) ;; *) BIS_BUILD=../../$BIS_BUILD ;; esac && "
            "\"$BIS_BUILD/grade\" alike 0.4 ../../" SHOP "/blank.prints $P > pairs && cat pairs >&2 && awk 'NF != 4 "
            "|| $4 != $3 + "
            "9 || $1 < 60 { exit 1 } END { exit NR != 9 }' pairs"),
        0);
}

/* A hand-in that fails, prints what JSON, HTML and spreadsheets take for their own, and is not ours outside of the
 * marks, as DIR/kit. */
static void make_hostile_kit(void)
{
    program_write_file(
        DIR "/hostile.sed",
        "s|^    while (s->n_large > 0 \\&\\& s->n_small > 0) {|    fputs(\"=1+1,\\\\\"<b>\\\\\\\\;\\\\001\\\\303\\\\n"
        "{\\\\t</script>'\", stderr);\\\n    int spare;\\\n    abort();\\\n&|\n"
        "s|^/\\* \\[alias-build\\] \\*/|&\\\n#include <stdio.h>\\\n#include <stdlib.h>|\n"
        "s/pairwise_sum/sum_by_halves/g\n");
    assert_int_equal(shell("sh scripts/course/assignment.sh alias " DIR "/kit > /dev/null && sed -f " DIR
                           "/hostile.sed "
                           "src/thesis/alias.c > " DIR "/kit/src/thesis/alias.c"),
                     0);
}

/* The sum of the points in report DIR/report, which stand behind `score`, and the marks of DIR/out, are `total`. */
static void assert_scores(const char *score, const char *total)
{
    char command[400];

    assert_true(json_is_valid(contents(DIR "/report")));
    snprintf(
        command, sizeof command,
        "awk -v s='\"%s\": ' -v t='\"%s\": ' '{ i = index($0, s); if (/name/) sum += substr($0, i + length(s)); "
        "else if (index($0, t)) all = substr($0, index($0, t) + length(t)) + 0 } END { print all; exit !(sum == all "
        "&& all > 0) }' " DIR "/report > " DIR "/sum && grep -q \"^ *$(cat " DIR "/sum) of 100  alias$\" " DIR "/out",
        score, total);
    assert_int_equal(shell(command), 0);
}

static void gradescope_and_classroom_50_get_the_same_marks(void **state)
{
    (void)state;
    need_a_compiler();
    clean_folder();
    make_hostile_kit();
    assert_int_equal(shell(GRADE " " DIR "/kit gradescope " DIR "/report > " DIR "/out"), 0);
    assert_scores("score", "score");
    const char *report = contents(DIR "/report");
    assert_has(report, "\"output\": \"alias.c: what is line ");
    assert_has(report, "\"max_score\": 20, \"output\": \"it was aborted: a call of abort?");
    assert_has(report, "It printed: =1+1,\\\"<b>\\\\;");
    assert_has(report, "\"visibility\": \"visible\"");
    assert_false(program_exists(DIR "/kit/grade.json"));

    assert_int_equal(
        shell("CLASSROOM='a \"b\"' ASSIGNMENT=alias SUBMISSION_TAG=submit/1 COMMIT_URL=https://c RELEASE_URL=https://r "
              "REVIEW_URL=https://v " GRADE " " DIR "/kit classroom50 " DIR "/report > " DIR "/out"),
        0);
    assert_scores("score", "score");
    report = contents(DIR "/report");
    const char *must[] = {"\"schema\": \"classroom50/result/v1\"",
                          "\"classroom\": \"a \\\"b\\\"\"",
                          "\"assignment\": \"alias\"",
                          "\"submission\": \"submit/1\"",
                          "\"commit\": \"https://c\"",
                          "\"release\": \"https://r\"",
                          "\"review\": \"https://v\"",
                          "\"datetime\": \"20",
                          "\"max-score\": 100,",
                          "\"passed\": false",
                          "\"passed\": true"};
    for (size_t i = 0; i < sizeof must / sizeof *must; i++)
        assert_has(report, must[i]);
    assert_int_equal(shell(GRADE " " DIR "/kit quux " DIR "/report 2> " DIR "/err"), 1);
    assert_has(contents(DIR "/err"), "there is no report for \"quux\"");
}

/* What its grading worksheet needs, and no other text than that of the marks. */
static void moodle_gets_the_same_marks(void **state)
{
    (void)state;
    need_a_compiler();
    clean_folder();
    make_hostile_kit();
    assert_int_equal(shell("sed 's/^hours.*/& =7/; s/^what was hard:/What was hard:\\nthe\\n  loop/' "
                           "docs/assignments/form.txt > " DIR "/kit/form.txt && "
                           "mkdir " DIR "/in && mv " DIR "/kit '" DIR
                           "/in/A, B_12_assignsubmission_file_4711_assignsubmission_file' && "
                           "cp src/thesis/alias.c '" DIR "/in/=me@example.org' && "
                           "BIS_SHOP=\"$PWD/" SHOP "\" sh scripts/course/grade_class.sh alias " DIR
                           "/in 2 moodle > " DIR "/out"),
                     0);
    const char *table = contents(DIR "/in.alias.moodle.csv");
    assert_has(table,
               "Identifier,Grade,Maximum Grade,Last modified (grade),Feedback comments\r\n\"'=me@example.org\",");
    assert_has(table, "\r\n\"Participant 4711\","); /* and not 12, which the name has */
    assert_has(table, "0 of 20  every_table_gives_the_weights<br>");
    assert_null(strstr(table, "like")); /* who else wrote so is for the teacher alone */
    assert_has(contents(DIR "/in.alias.csv"), " % like ");
    assert_has(contents(DIR "/in.alias.form.csv"), "student,\"hours for the code\",\"hours for the written half\","
               "\"what was hard\"\r\n\"'=me@example.org\",\"\",\"\",\"\"\r\n");
    assert_has(contents(DIR "/in.alias.form.csv"), "_4711_assignsubmission_file\",\"'=7\",\"'=7\",\"the loop\"\r\n");
    table = contents(DIR "/in.alias.moodle.csv");
    assert_has(table, "It printed: =1+1,&quot;&lt;b&gt;\\;");
    assert_has(table, "; 1 compiler warning\"\r\n"); /* behind what failed */
    assert_null(strstr(table, "<b>"));
    assert_int_equal(shell("for kind in moodle. ''; do sed 's/^\"[^\"]*\",\\([0-9]*\\),.*/\\1/' " DIR
                           "/in.alias.${kind}csv | sed 1d > " DIR "/points.$kind; done; cmp " DIR "/points.moodle. " DIR
                           "/points. && test -s " DIR "/points."),
                     0);
}

/* By variance times time; who has not all points for speed to be measured has no place. */
static void a_leaderboard_is_by_error_and_time(void **state)
{
    (void)state;
    clean_folder();
    program_write_file(DIR "/lines",
                       "N\tAnn\nL\t10\t10\tit_is_nearly_as_good_as_visible_normals\t1.50 times the variance\n"
                       "L\t10\t10\tspeed\t1.00 times our time\nN\tBen\n"
                       "L\t10\t10\tit_is_nearly_as_good_as_visible_normals\t0.50 times the variance\n"
                       "L\t5\t10\tspeed\t2.00 times our time\nN\tCem\n"
                       "L\t10\t10\tit_is_nearly_as_good_as_visible_normals\t0.10 times the variance\n"
                       "L\t0\t10\tspeed\tmeasured once all tests pass\n");
    assert_int_equal(shell("awk -v kind=leaderboard -f scripts/course/short.awk -f scripts/course/grade_table.awk "
                           DIR "/lines > " DIR "/out"), 0);
    assert_string_equal(contents(DIR "/out"), "place,student,variance times time (visible normals: 1)\r\n"
                                              "1,\"Ben\",1.00\r\n2,\"Ann\",1.50\r\n");
}

/* Fifty remarks of three words of 96 letters: each is cut at 200 characters on its last word, a cell of the CSV holds
 * one of them, cut to the room behind who wrote the same, and says how many more there are. The page and Moodle have
 * all. */
static void a_flood_of_remarks_fits_into_a_cell(void **state)
{
    (void)state;
    clean_folder();
    assert_int_equal(
        shell("work=$PWD/" DIR " && . scripts/course/accept.sh && w=$(printf %096d 7) && n=0 && "
              "while [ $n -lt 50 ]; do n=$((n + 1)); remark \"$w $w\n$w\"; done && "
              "{ echo 'C\t10\tspeed'; for who in Ann Ben; do echo \"N\t$who\"; sed 's/^/R\t/' $work/remarks; "
              "echo 'L\t5\t10\tspeed\t2 times our time'; done; echo 'A\t70\t70\t1\t2'; } > $work/all && "
              "for kind in csv moodle html; do "
              "awk -v kind=$kind -f scripts/course/short.awk -f scripts/course/grade_table.awk $work/all "
              "> $work/$kind || exit 1; done"),
        0);
    char cut[256], row[1024];
    snprintf(cut, sizeof cut, "%096d %096d ...", 7, 7);
    snprintf(row, sizeof row, "\"Ann\",5,5,\"70 %% like Ben; %096d ...; and 50 more, in the .html\"\r\n", 7);
    assert_has(contents(DIR "/csv"), row);
    snprintf(row, sizeof row, "%s; %s; %s", cut, cut, cut);
    assert_has(contents(DIR "/html"), row);
    assert_has(contents(DIR "/moodle"), row);
    assert_has(contents(DIR "/html"), "; speed: 2 times our time</td>");
    assert_int_equal(shell("sed 's/^A.*//' " DIR "/all | "
                           "awk -v kind=csv -f scripts/course/short.awk -f scripts/course/grade_table.awk > " DIR
                           "/csv"), 0);
    snprintf(row, sizeof row, "\"Ben\",5,5,\"%s; and 50 more, in the .html\"\r\n", cut);
    assert_has(contents(DIR "/csv"), row);
    /* what the judge says is whole, but for the cell */
    assert_int_equal(
        shell("work=$PWD/" DIR " && w=$(printf %096d 7) && "
              "printf 'N\\tAnn\\nL\\t0\\t10\\tx\\t%s %s a hint\\n' $w $w > $work/one && for kind in csv html; do "
              "awk -v kind=$kind -f scripts/course/short.awk -f scripts/course/grade_table.awk $work/one "
              "> $work/$kind || exit 1; done"),
        0);
    snprintf(row, sizeof row, "x: %096d %096d a hint", 7, 7);
    assert_has(contents(DIR "/html"), row);
    snprintf(row, sizeof row, "x: %096d ...\"\r\n", 7);
    assert_has(contents(DIR "/csv"), row);
}

/* The program of bis trade has no filter of the kernel: what is handed in could write its own report. */
static void bis_trade_is_not_run_without_a_sandbox(void **state)
{
    (void)state;
    need_a_compiler();
    clean_folder();
    assert_int_equal(shell("mkdir " DIR "/in && cp src/beyond/microfacet.c src/beyond/microfacet_formulas.h " DIR "/in "
                           "&& BIS_SANDBOX=none sh scripts/course/grade.sh open " DIR "/in > " DIR "/out"), 0);
    assert_has(contents(DIR "/out"), "bis trade is not run: it needs bubblewrap\n");
    assert_false(program_exists(DIR "/in/trade-mine"));
}

/* Of no assignment a right solution is refused, by its text or by its object: open has loops for AVX2, which are chosen
 * when the program is loaded. */
static void what_we_have_written_is_accepted_in_each(void **state)
{
    char command[1024];

    (void)state;
    need_a_compiler();
    clean_folder();
    assert_int_equal(shell("sh scripts/course/headers.sh " DIR "/headers"), 0);
    for (int i = 0; i < N_NAMES; i++) {
        snprintf(command, sizeof command,
                 "{ name=%s; shop=$PWD/" DIR "/$name; given=$shop/in; work=$shop/work; tool=$BIS_BUILD/grade; "
                 "BIS_SANDBOX=none; export BIS_SANDBOX; sh scripts/course/given.sh $name \"$shop\" && "
                 "mkdir $shop/in $work && cp -R " DIR "/headers $shop && for f in $(cat $shop/files); do "
                 "sed '/^ *#pragma GCC unroll/d' src/$f > $shop/in/${f##*/}; "
                 "case $f in *.h) cp $shop/blank/$f $shop/headers/src/$f ;; esac; done && "
                 ". scripts/course/accept.sh && accept || { echo $reason; cat $work/remarks; exit 1; }; } > "
                 DIR "/said 2>&1",
                 names[i]);
        if (shell(command) != 0) fail_msg("%s: %s", names[i], contents(DIR "/said"));
    }
}

/* All that Gradescope unpacks and calls is in the archive, and no other assignment's solution test. */
static void what_a_service_needs_is_in_its_kit(void **state)
{
    (void)state;
    clean_folder();
    assert_int_equal(shell("sh scripts/course/kit.sh alias quux " DIR "/x 2> " DIR "/err"), 1);
    assert_has(contents(DIR "/err"), "FOR is gradescope, classroom50 or moodle");
    assert_int_equal(
        shell("sh scripts/course/kit.sh alias classroom50 " DIR "/box > /dev/null && cd " DIR "/box && "
              "test -f autograder.py -a -f setup.sh -a -f bis/tests/course/alias.c -a ! -e bis/tests/course/cdf.c && "
              "make -n -C bis grader A=alias > /dev/null"),
        0);
    /* what a student has put there is no result, not even where the marking fails */
    assert_int_equal(
        shell("command -v python3 > /dev/null || exit 0; mkdir " DIR "/checkout && cd " DIR "/checkout && "
              "echo '{\"score\": 100}' > result.json && mv ../box/setup.sh .. && echo 'exit 1' > ../box/setup.sh && "
              "! python3 ../box/autograder.py 2> ../err && test ! -e result.json && mv ../setup.sh ../box"),
        0);
    if (shell("command -v zip > /dev/null && command -v unzip > /dev/null") != 0) {
        print_message("no zip\n");
        skip();
    }
    assert_int_equal(
        shell("sh scripts/course/kit.sh alias gradescope " DIR "/box.zip > /dev/null && mkdir " DIR "/zip && "
              "cd " DIR
              "/zip && unzip -q ../box.zip && test -x run_autograder -a -x setup.sh && "
              "diff -r -x build bis ../box/bis"),
        0);
}

static void a_class_that_is_stopped_leaves_nothing_behind(void **state)
{
    (void)state;
    need_a_compiler();
    clean_folder();
    assert_int_equal(shell("mkdir " DIR "/tmp && sh tests/course/handed_in/make.sh " DIR "/all && mkdir " DIR "/in && "
                           "cp " DIR
                           "/all/*loop.c " DIR "/in && cd \"$PWD\" && "
                           "{ TMPDIR=\"$PWD/" DIR "/tmp\" BIS_SHOP=\"$PWD/" SHOP
                           "\" sh scripts/course/grade_class.sh alias " DIR "/in > " DIR "/out 2>&1 & } ; p=$!; "
                           "until ls " DIR "/tmp/*/*/marks > /dev/null 2>&1; do kill -0 $p || exit 3; sleep 0.05; "
                                           "done; kill $p; wait $p; test $? -eq 143 && test -z \"$(ls -A " DIR
                           "/tmp)\""),
                     0);
    /* of this run alone: on one machine several may be tested */
    assert_int_equal(shell("echo \"$PWD/" DIR "/tmp\" > " DIR "/path; n=0; "
                           "while grep -lsaFf " DIR "/path /proc/[0-9]*/cmdline > " DIR
                           "/left; do n=$((n + 1)); [ $n -lt 100 ] || exit 1; sleep 0.1; done"),
                     0);
}

int main(void)
{
    const struct CMUnitTest others[] = {
        cmocka_unit_test(each_has_its_handout_and_its_line_for_the_teacher),
        cmocka_unit_test(a_kit_is_the_project_but_for_its_blanks),
        cmocka_unit_test(the_kit_of_sir_has_no_other_copy_of_its_answer),
        cmocka_unit_test(what_cannot_be_made_is_refused_with_the_way_out),
        cmocka_unit_test(an_untouched_kit_is_worth_nothing),
        cmocka_unit_test(a_right_solution_that_leaks_loses_the_points_for_memory_alone),
        cmocka_unit_test(a_load_that_is_skipped_is_worth_nothing),
        cmocka_unit_test(what_ends_badly_costs_the_claim_that_it_happens_in_and_changed_tests_change_nothing),
        cmocka_unit_test(what_the_compiler_has_no_memory_for_is_said),
        cmocka_unit_test(what_does_not_compile_is_worth_nothing),
        cmocka_unit_test(hidden_seeds_and_sizes_are_the_kits_without_a_secret_alone),
        cmocka_unit_test(no_cheat_is_worth_a_point),
        cmocka_unit_test(no_cheat_reaches_out_while_the_sanitizers_look),
        cmocka_unit_test(the_compiler_gets_what_was_looked_at),
        cmocka_unit_test(right_solutions_of_any_style_are_right),
        cmocka_unit_test(a_busy_machine_changes_no_word),
        cmocka_unit_test(what_a_busy_machine_could_not_judge_is_not_marked_and_never_0),
        cmocka_unit_test(what_is_handed_in_is_bounded_before_it_is_read),
        cmocka_unit_test(what_we_have_written_is_accepted_in_each),
        cmocka_unit_test(bis_trade_is_not_run_without_a_sandbox),
        cmocka_unit_test(a_folder_of_any_name_is_looked_at_and_a_renamed_archive_is_named),
        cmocka_unit_test(points_can_be_seen_before_handing_in),
        cmocka_unit_test(a_chi_square_that_fails_is_drawn),
        cmocka_unit_test(what_make_grade_refuses_make_check_tells),
        cmocka_unit_test(what_is_left_behind_is_ended),
        cmocka_unit_test(a_class_is_marked_whatever_is_handed_in),
        cmocka_unit_test(a_copy_is_found_and_who_wrote_alone_is_not),
        cmocka_unit_test(gradescope_and_classroom_50_get_the_same_marks),
        cmocka_unit_test(moodle_gets_the_same_marks),
        cmocka_unit_test(a_leaderboard_is_by_error_and_time),
        cmocka_unit_test(a_flood_of_remarks_fits_into_a_cell),
        cmocka_unit_test(what_a_service_needs_is_in_its_kit),
        cmocka_unit_test(a_class_that_is_stopped_leaves_nothing_behind),
    };
    struct CMUnitTest tests[N_NAMES + sizeof others / sizeof *others];
    char labels[N_NAMES][96];

    for (int i = 0; i < N_NAMES; i++) {
        snprintf(labels[i], sizeof labels[i], "blank_fails_ours_passes_and_wrong_ones_get_part_marks: %s", names[i]);
        tests[i] =
            (struct CMUnitTest){.name = labels[i], .test_func = blank_fails_ours_passes_and_wrong_ones_get_part_marks};
        tests[i].initial_state = (void *)(uintptr_t)names[i];
    }
    memcpy(tests + N_NAMES, others, sizeof others);
    return cmocka_run_group_tests(tests, prove, NULL);
}
