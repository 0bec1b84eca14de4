/* SPDX-License-Identifier: BSD-2-Clause */
/* `make figures` knows every figure that docs/measured.md speaks of, and each one that the thesis shows as a result or
 * a plot; pictures in that page are there and small. scripts/figures/docs_figures.sh makes every picture that the docs
 * show. Rendering them all takes minutes and is no part of the tests. */
#include "claim.h"
#include "file_help.h"
#include "program.h"

#include <ctype.h>
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>

#define PAGE "docs/measured.md"

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

/* "igure 5.2" or "igures 4.1": the number behind it, or NULL. */
static const char *number_behind(const char *at)
{
    at += strlen("igure");
    if (*at == 's') at++;
    return *at == ' ' && isdigit((unsigned char)at[1]) ? at + 1 : NULL;
}

static void every_figure_that_the_page_of_results_names_is_made(void **state)
{
    static char page[1 << 16];
    char list[512];
    int n = 0;

    read_list(list);
    read_text(page, sizeof page, PAGE);
    for (const char *at = strstr(page, "igure"); at; at = strstr(at + 1, "igure")) {
        const char *name = number_behind(at);
        if (!name) continue;
        size_t length = strspn(name, "0123456789.");
        if (name[length - 1] == '.') length--;
        if (!is_listed(list, name, length))
            fail_msg(PAGE ": figure %.*s is not one of scripts/figures/figures.sh", (int)length, name);
        n++;
    }
    assert_true(n >= 5);
}

static void the_page_of_results_has_a_row_for_every_figure(void **state)
{
    static char page[1 << 16];
    char row[16];

    read_text(page, sizeof page, PAGE);
    for (size_t i = 0; i < WANTED; i++) {
        snprintf(row, sizeof row, "\n| %s | ", wanted[i]);
        if (!strstr(page, row)) fail_msg(PAGE ": no row for figure %s", wanted[i]);
    }
}

static void links_of_the_page_of_results_lead_to_files_and_its_pictures_are_below_100_KB(void **state)
{
    static char page[1 << 16];
    char path[256];
    int n_pictures = 0;

    read_text(page, sizeof page, PAGE);
    for (const char *at = strstr(page, "]("); at; at = strstr(at + 1, "](")) {
        const int n = (int)strcspn(at + 2, ")#");
        struct stat st;
        if (n == 0 || strncmp(at + 2, "http", 4) == 0) continue;
        snprintf(path, sizeof path, "docs/%.*s", n, at + 2);
        if (stat(path, &st) != 0) fail_msg(PAGE ": no %s", path);
        if (strncmp(at + 2, "figures/", 8) != 0) continue;
        assert_in_range(st.st_size, 100, 100000);
        n_pictures++;
    }
    assert_true(n_pictures >= 1);
}

static void every_picture_of_the_docs_has_a_recipe_and_is_below_300_KB(void **state)
{
    char list[4096], path[512];
    int n_files = 0, n_listed = 0;

    assert_int_equal(system("mkdir -p build && sh scripts/figures/docs_figures.sh --list > build/test_figures.out"), 0);
    list[0] = '\n';
    read_text(list + 1, sizeof list - 1, "build/test_figures.out");
    for (const char *at = list + 1; (at = strchr(at, '\n')); at++) n_listed++;
    DIR *folder = opendir("docs/figures");
    assert_non_null(folder);
    for (struct dirent *entry; (entry = readdir(folder));) {
        struct stat st;
        if (entry->d_name[0] == '.') continue;
        snprintf(path, sizeof path, "\n%s\n", entry->d_name);
        if (!strstr(list, path))
            fail_msg("docs/figures/%s: scripts/figures/docs_figures.sh does not make it", entry->d_name);
        snprintf(path, sizeof path, "docs/figures/%s", entry->d_name);
        assert_int_equal(stat(path, &st), 0);
        const bool is_true = strcmp(entry->d_name, "chess.png") == 0 || strcmp(entry->d_name, "methods.png") == 0;
        if (st.st_size > (is_true ? 1200000 : 300000)) fail_msg("%s has %ld bytes", path, (long)st.st_size);
        n_files++;
    }
    closedir(folder);
    assert_int_equal(n_files, n_listed); /* each listed file is there */
}

/* Those that take less than half a second each, but the rest, too, where BIS_LONG is set. */
static const char fast[] =
    "3.3 3.4 3.8 3.9 4.3 4.4 4.5 E1 E2 E4 E8 E10 E11 E12 E15 E17 E18 E19 E24 E25 E33 E35 E36 E37";
static const char slow[] = "E5 E9 E14 E26 E28 E30 E31 E32";

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
             "for f in errata thesis results; do g=../../docs/figures/$f-%s.svg; if [ -f $g ]; then "
             STRIP "$g > there && " STRIP "%s.svg | cmp -s - there; exit $?; fi; "
             "done; exit 3",
             edit, name, name, name, name, name);
    return WEXITSTATUS(system(command));
}

static void each_drawing_of_the_docs_is_drawn_again_the_same(void **state)
{
    char names[512], command[700];

    if (system("command -v node > /dev/null") != 0) skip();
    snprintf(names, sizeof names, "%s %s", fast, getenv("BIS_LONG") ? slow : "");
    snprintf(command, sizeof command,
        "mkdir -p build/test_figures && \"$(dirname \"$BIS_PROGRAM\")\"/figures still build/test_figures %s", names);
    assert_int_equal(system(command), 0);
    for (char *name = strtok(names, " "); name; name = strtok(NULL, " ")) {
        if (drawn_otherwise(name, "") != 0)
            fail_msg(
                "docs/figures has another %s: sh scripts/figures/docs_figures.sh build/release thesis plots", name);
    }
    assert_int_equal(drawn_otherwise("E11", "s/0.45/0.46/"), 1);         /* twin: another P */
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
        cmocka_unit_test(every_figure_that_the_page_of_results_names_is_made),
        cmocka_unit_test(the_page_of_results_has_a_row_for_every_figure),
        cmocka_unit_test(links_of_the_page_of_results_lead_to_files_and_its_pictures_are_below_100_KB),
        cmocka_unit_test(every_picture_of_the_docs_has_a_recipe_and_is_below_300_KB),
        cmocka_unit_test(each_drawing_of_the_docs_is_drawn_again_the_same),
        cmocka_unit_test(a_figure_that_is_not_in_the_list_is_bad_usage),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
