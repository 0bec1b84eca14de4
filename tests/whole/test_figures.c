/* SPDX-License-Identifier: BSD-2-Clause */
/* `make figures` knows each figure that the thesis shows as a result or a plot; those that need no scene are drawn
 * again as docs/figures has them. Rendering them all takes minutes and is no part of the tests. */
#include "claim.h"
#include "file_help.h"
#include "program.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

/* " 3.3 3.4 ... ": what the script makes. */
static void read_list(char list[512])
{
    assert_int_equal(system("mkdir -p build && sh scripts/figures/figures.sh --list > build/test_figures.out"), 0);
    list[0] = ' ';
    read_text(list + 1, 511, "build/test_figures.out");
    *strchr(list, '\n') = ' ';
}

/* "5.7" is there as "5.7-n10". */
static bool is_listed(const char *list, const char *name, size_t n)
{
    char word[16];

    if (n + 2 > sizeof word) return false;
    word[0] = ' ';
    memcpy(word + 1, name, n);
    word[n + 1] = '\0';
    for (const char *at = strstr(list, word); at; at = strstr(at + 1, word)) {
        if (at[n + 1] == ' ' || at[n + 1] == '-') return true;
    }
    return false;
}

static const char *const wanted[] = {"3.3", "3.4", "3.5", "3.6", "3.8", "3.9", "4.1", "4.2", "4.3", "4.4", "4.5",
                                     "5.1", "5.2", "5.3", "5.4", "5.5", "5.6", "5.7", "5.8", "5.9"};
enum { WANTED = sizeof wanted / sizeof *wanted };

static void the_script_makes_every_figure_of_the_thesis_that_is_a_result_or_a_plot(void **state)
{
    char list[512];

    read_list(list);
    for (size_t i = 0; i < WANTED; i++) assert_true(is_listed(list, wanted[i], strlen(wanted[i])));
    assert_false(is_listed(list, "3.7", 3)); /* a drawing, neither a result nor a plot */
    assert_false(is_listed(list, "5", 1));
}

/* Takes out what another zlib or libpng writes otherwise: the bytes of pictures, and the names of parts, which are made
 * of all bytes. */
#define STRIP "sed 's/base64,[^\"]*//g; s/[\"#]p[0-9a-f]\\{4,8\\}//g' "

/* Draws build/test_figures/NAME.svg from NAME.json, which edit (of sed) may change, and compares it with what is
 * committed. 0: they are the same. */
static int drawn_otherwise(const char *name, const char *edit)
{
    char command[1200];

    snprintf(command, sizeof command,
             "cd build/test_figures && sed '%s' %s.json > drawn.new && mv drawn.new %s.json && node "
             "../../scripts/figures/still.js %s.json && "
             "for f in thesis results; do g=../../docs/figures/$f-%s.svg; if [ -f $g ]; then "
             STRIP "$g > there && " STRIP "%s.svg | cmp -s - there; exit $?; fi; "
             "done; exit 3",
             edit, name, name, name, name, name);
    return WEXITSTATUS(system(command));
}

static void each_drawing_of_the_docs_is_drawn_again_the_same(void **state)
{
    char names[] = "3.3 3.4 3.8 3.9 4.3 4.4 4.5", command[700];

    if (system("command -v node > /dev/null") != 0) skip();
    snprintf(command, sizeof command,
        "mkdir -p build/test_figures && \"$(dirname \"$BIS_PROGRAM\")\"/figures still build/test_figures %s", names);
    assert_int_equal(system(command), 0);
    for (char *name = strtok(names, " "); name; name = strtok(NULL, " ")) {
        if (drawn_otherwise(name, "") != 0)
            fail_msg("docs/figures has another %s: sh scripts/figures/docs_figures.sh build/release thesis", name);
    }
    assert_int_equal(drawn_otherwise("3.9", "s/\"below\": [0-9]*/\"below\": 7/"), 1); /* twin: another count */
}

static void a_figure_that_is_not_in_the_list_is_bad_usage(void **state)
{
    const int status = system("sh scripts/figures/figures.sh build/none 9.9 2> build/test_figures.err");
    assert_int_equal(WEXITSTATUS(status), 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_script_makes_every_figure_of_the_thesis_that_is_a_result_or_a_plot),
        cmocka_unit_test(each_drawing_of_the_docs_is_drawn_again_the_same),
        cmocka_unit_test(a_figure_that_is_not_in_the_list_is_bad_usage),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
