/* SPDX-License-Identifier: BSD-2-Clause */
/* What `bis` says, by hand: each file of tests/data/expect/bis is a test. And that their runner (expect.h) finds what
 * is wrong. */
#include "expect.h"
#include "program.h"

#include <stdlib.h>
#include <string.h>

#define DIR "build/test_expect"

/* `say STATUS` (-1: EXPECT_SKIPPED): the lines that it is given, as they stand; those behind a line "--" are messages.
 */
static int say(const expect_command *c)
{
    const char *const end = strstr(c->input, "--\n");
    fprintf(c->output, "%.*s", (int)(end ? end - c->input : (long)strlen(c->input)), c->input);
    if (end) fputs(end + 3, c->messages);
    return atoi(c->arguments);
}

static const expect_word words[] = {{"say", say}, {NULL, NULL}};
static const expect_text texts[] = {{"seven", "7"}, {"who", "nobody"}, {NULL, NULL}};

/* Each holds. */
static const char *const good[] = {
    "# why\n\n$ say 0\n< a\n< \n<  b\n> a\n>\n>  b\n",
    "$2 say 2\n< --\n< no\n! no\n",
    "$1 ls " DIR "/nothing\n$ ls " DIR "/good.expect\n> " DIR "/good.expect\n",
    "$ ls tests/data/expect/help\n> unknown.expect\n",
    "$ say 0\n< x 1 y 2\n>~ 1\n>~ 2\n>- 3\n",
    "$ say 0\n< ab\n< b\n< c\n< d\n>= b\n>= c\n>~ d\n",
    "$ say 0\n< --\n< x 1 y 2\n!~ y\n!- z\n",
    "$ say 0\n< a,0.5,,nan\n>% a,0.50000000001,,nan\n",
    "$ say 0\n< 7 nobody {w}\n> {seven} {who} {w}\n",
    "$ say -1\n< a\n> b\n",
    "$ say 0\n< any\n< --\n< any\n>~\n!~\n",
};

static const struct { const char *text, *says; } bad[] = {
    {"", "must begin with a command"},
    {"# nothing\n", "must begin with a command"},
    {"> a\n$ say 0\n", "must begin with a command"},
    {"$ sya 0\n", "no such command"},
    {"$ ls " DIR "/nothing\n", "status 1, must with 0"},
    {"$1 ls " DIR "/bad.expect\n> " DIR "/bad.expect\n", "status 0, must with 1"},
    {"$ ls tests/data/expect/help\n", "    + unknown.expect\n"},
    {"$ say 0\na\n", ":2: no line of an .expect: a"},
    {"$ say 0\n>? a\n", ":2: no line of an .expect"},
    {"$ say 0\n>a\n", ":2: no line of an .expect"},
    {"$ say 1\n", "status 1, must with 0"},
    {"$2 say 0\n", "status 0, must with 2"},
    {"$ say 0\n< a\n< b\n< c\n> a\n> x\n> c\n", "      a\n    - x   (line 6)\n    + b\n      c\n"},
    {"$ say 0\n< a\n< b\n> a\n", "    + b\n"},
    {"$ say 0\n< a\n> a\n> b\n", "    - b   (line 4)\n"},
    {"$ say 0\n< a\n", "    + a\n"},
    {"$ say 0\n< a \n> a\n", "    - a   (line 3)\n"},
    {"$ say 0\n< --\n< a\n", "its messages differ"},
    {"$ say 0\n< --\n< a\n! b\n", "    - b   (line 4)\n    + a\n"},
    {"$ say 0\n< 1 2\n>~ 2\n>~ 1\n", "line 4: behind the part before this does not stand in its output: 1"},
    {"$ say 0\n< 1 2\n>~ 3\n", "line 3: this does not stand in its output: 3"},
    {"$ say 0\n< 1 2\n>~\n>- 2\n", "line 4: this stands in its output: 2"},
    {"$ say 0\n< ab\n< bc\n>= b\n", "line 4: this does not stand in its output: b"},
    {"$ say 0\n< a\n< b\n>= b\n>= a\n", "line 5: behind the part before this does not stand in its output: a"},
    {"$ say 0\n< a\n>= a\n>= a\n", "line 4: behind the part before this does not stand in its output: a"},
    {"$ say 0\n< a\n>~ a\n> a\n", "cannot both be expected"},
    {"$ say 0\n< 1,2\n>% 1,2.00000001\n", "    - 1,2.00000001   (line 3)\n"},
    {"$ say 0\n< 1,2\n>% 1\n", "    - 1   (line 3)\n"},
    {"$ say 0\n< 1,2\n> 1,2.0\n", "    - 1,2.0   (line 3)\n"},
    {"$ say 0\n< 8\n> {seven}\n", "    - 7   (line 3)\n"},
    {"$ say 0\n< a\n> a\n$ say 0\n< b\n> a\n", ":4: say 0\n"},
};

static void what_is_expected_is_found(void **state)
{
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        program_write_file(DIR "/good.expect", good[i]);
        char *wrong = expect_file(DIR "/good.expect", words, texts);
        if (wrong) fail_msg("%s", wrong);
    }
}

static void what_is_not_as_expected_fails_and_is_shown(void **state)
{
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        program_write_file(DIR "/bad.expect", bad[i].text);
        char *wrong = expect_file(DIR "/bad.expect", words, texts);
        if (!wrong) fail_msg("taken: %s", bad[i].text);
        if (!strstr(wrong, bad[i].says)) fail_msg("no \"%s\" in %s", bad[i].says, wrong);
        free(wrong);
    }
    char *missing = expect_file(DIR "/missing.expect", words, texts);
    assert_string_equal(missing, DIR "/missing.expect: cannot be read\n");
    free(missing);
}

/* Runs of `bis` are held to the same. */
static void a_wrong_word_of_bis_itself_fails(void **state)
{
    program_write_file(DIR "/bis.expect", "$2 bis help sp\n! bis: error: no command\n");
    char *wrong = expect_file(DIR "/bis.expect", NULL, NULL);
    assert_non_null(wrong);
    assert_non_null(strstr(wrong, "    - bis: error: no command   (line 2)\n    + bis: error: no command, topic or"));
    free(wrong);
}

static const expect_text here[] = {{"end", "\n"}, {"scene", DIR "/scene.txt"}, {"missing", DIR "/missing.txt"},
                                   {"folder", DIR}, {NULL, NULL}};

static int setup(void **state)
{
    program_folder(DIR);
    program_write_scene(DIR, "Sampler \"stratified\"\n");
    program_write_file(DIR "/empty.txt", "WorldBegin LightSource \"infinite\"\n");
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_expected_is_found),
        cmocka_unit_test(what_is_not_as_expected_fails_and_is_shown),
        cmocka_unit_test(a_wrong_word_of_bis_itself_fails),
    };
    return expect_run("expect", tests, sizeof tests / sizeof *tests, setup, NULL,
                      &(expect_folder){"tests/data/expect/bis", NULL, here});
}
