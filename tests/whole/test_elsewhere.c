/* SPDX-License-Identifier: BSD-2-Clause */
/* elsewhere: scenes that other people published, judged by scripts/check/elsewhere.sh and tests/data/elsewhere.tsv
 * where they are on disk, and the script itself on scenes of our own. */
#include "claim.h"
#include "program.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>

#define DIR "build/test_elsewhere"
#define OURS DIR "/scenes/we/ours/"

/* Runs the script on a folder and a list; *said receives what it prints. Returns its exit status. */
static int judge(const char *bis, const char *folder, const char *list, char said[8192])
{
    char command[1024];
    snprintf(command, sizeof command, "sh scripts/check/elsewhere.sh %s %s %s", bis, folder, list);
    fflush(stdout);
    FILE *f = popen(command, "r");
    assert_non_null(f);
    said[fread(said, 1, 8191, f)] = '\0';
    const int status = pclose(f);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

static const char *program(void)
{
    const char *bis = getenv("BIS_PROGRAM");
    return bis ? bis : "build/release/bis";
}

/* ---- the script itself ---- */

enum { INSIDE, NEAR, LACKING, ROOM, BROKEN, N_SCENES };

static const struct {
    const char *name, *text;
    const char *expect[4]; /* accepted, light, shapes kept, missing files: counted by hand */
} scenes[N_SCENES] = {
    [INSIDE] = {"inside.pbrt", "WorldBegin LightSource \"infinite\" Translate 0 0 3 Shape \"sphere\"\n",
                {"plain", "own", "1/1", "0"}},
    [NEAR] = {"near.pbrt", "WorldBegin LightSource \"point\" Translate 0 0 3 Shape \"sphere\" Shape \"curve\"\n",
              {"approximate", "sky", "1/2", "0"}},
    [LACKING] = {"lacking.pbrt", "WorldBegin LightSource \"infinite\" Shape \"sphere\"\nInclude \"no.pbrt\"\n",
                 {"plain", "own", "1/1", "1"}},
    [ROOM] = {"room.pbrt", "WorldBegin LightSource \"point\" Shape \"sphere\" \"float radius\" 9\n",
              {"approximate", "sky", "1/1", "0"}},
    [BROKEN] = {"broken.pbrt", "WorldBegin Shap \"sphere\"\n", {"refused", "-", "-", "0"}},
};

/* The list of the scenes `from` to `to`, without the one that is left out; one column of one line may be wrong. */
static void write_list(int from, int to, int left_out, int wrong, int column, const char *value)
{
    char text[2048] = "";
    for (int i = from; i < to; i++) {
        if (i == left_out) continue;
        char command[256], hash[17] = "";
        snprintf(command, sizeof command, "sha256sum " OURS "%s", scenes[i].name);
        FILE *f = popen(command, "r");
        assert_non_null(f);
        assert_int_equal(fread(hash, 1, 16, f), 16);
        pclose(f);
        size_t n = strlen(text);
        n += (size_t)snprintf(text + n, sizeof text - n, "we/ours/%s\t%s", scenes[i].name, hash);
        for (int k = 0; k < 4; k++)
            n += (size_t)snprintf(text + n, sizeof text - n, "\t%s",
                                  i == wrong && k == column ? value : scenes[i].expect[k]);
        snprintf(text + n, sizeof text - n, "\n");
    }
    program_write_file(DIR "/list.tsv", text);
}

static int make_scenes(void **state)
{
    program_folder(DIR);
    if (mkdir(DIR "/scenes", 0777) || mkdir(DIR "/scenes/we", 0777) || mkdir(DIR "/scenes/we/ours", 0777)) return 1;
    for (int i = 0; i < N_SCENES; i++) {
        char path[128];
        snprintf(path, sizeof path, OURS "%s", scenes[i].name);
        program_write_file(path, scenes[i].text);
    }
    return 0;
}

static void what_the_list_expects_passes(void **state)
{
    char said[8192];
    write_list(0, BROKEN, -1, -1, 0, NULL);
    assert_int_equal(judge(program(), DIR "/scenes", DIR "/list.tsv", said), 0);
    assert_string_equal(said,
        "elsewhere: 4 scenes read, 0 not there: 2 pass as they are, 2 with --approximate, 0 do not\n"
        "elsewhere: 3 lack no file, of which 3 pass (100.0 %); pictures: 2 lit, 1 black and said "
        "to be, 0 black by surprise\n"
        "elsewhere: 0 are other than the list expects\n");
}

/* The twin: each column of each line, wrong, is found. */
static void whatever_is_other_fails(void **state)
{
    static const char *const other[4] = {"refused", "none", "2/2", "7"};
    char said[8192];
    for (int i = 0; i < BROKEN; i++) {
        for (int k = 0; k < 3; k++) {
            write_list(0, BROKEN, -1, i, k, other[k]);
            assert_int_equal(judge(program(), DIR "/scenes", DIR "/list.tsv", said), 1);
            assert_non_null(strstr(said, scenes[i].name));
            assert_non_null(strstr(said, "elsewhere: 1 are other"));
        }
    }
    /* with other files beside it, a scene may keep other shapes, and only whether it is accepted counts */
    write_list(0, BROKEN, -1, LACKING, 3, other[3]);
    assert_int_equal(judge(program(), DIR "/scenes", DIR "/list.tsv", said), 0);
}

static void too_few_that_pass_fail(void **state)
{
    char said[8192];
    write_list(0, N_SCENES, -1, -1, 0, NULL); /* as the list expects, but 3 of 4 is fewer than 95 % */
    assert_int_equal(judge(program(), DIR "/scenes", DIR "/list.tsv", said), 1);
    assert_non_null(strstr(said, "elsewhere: 4 lack no file, of which 3 pass (75.0 %)"));
    assert_non_null(strstr(said, "elsewhere: 0 are other"));
}

/* A bis that keeps silent about a black picture. */
static void a_black_picture_that_nothing_announces_fails(void **state)
{
    char said[8192], text[512];
    snprintf(text, sizeof text, "#!/bin/sh\n%s \"$@\" 2>" DIR "/said\nstatus=$?\n"
             "grep -v 'the picture is black' " DIR "/said >&2\nexit $status\n", program());
    program_write_file(DIR "/silent", text);
    assert_int_equal(chmod(DIR "/silent", 0755), 0);
    write_list(0, BROKEN, -1, -1, 0, NULL);
    assert_int_equal(judge(DIR "/silent", DIR "/scenes", DIR "/list.tsv", said), 1);
    assert_non_null(strstr(said, "room.pbrt: black: "));
    assert_non_null(strstr(said, "2 lit, 0 black and said to be, 1 black by surprise"));
    write_list(0, BROKEN, ROOM, -1, 0, NULL);
    assert_int_equal(judge(DIR "/silent", DIR "/scenes", DIR "/list.tsv", said), 0);
}

static void nothing_there_is_no_success(void **state)
{
    char said[8192];
    program_write_file(DIR "/list.tsv", "we/ours/inside.pbrt\t0123456789abcdef\tplain\town\t1/1\t0\n");
    assert_int_equal(judge(program(), DIR "/scenes", DIR "/list.tsv", said), 3);
    assert_int_equal(judge(program(), DIR "/nowhere", DIR "/list.tsv", said), 2);
}

/* ---- what a render says of a black picture ---- */

static void a_render_says_that_its_picture_is_black(void **state)
{
    program_run r;
    program_expect(&r, 0, "--approximate --resolution 8x6 --outfile " DIR "/a.pfm " OURS "room.pbrt");
    assert_non_null(strstr(r.messages, "the picture is black: no light from infinity reaches what the camera sees"));
    program_write_file(DIR "/away.pbrt", "WorldBegin LightSource \"infinite\" \"bool visible\" false "
                                         "Translate 0 0 -3 Shape \"sphere\"\n");
    program_expect(&r, 0, "--resolution 8x6 --outfile " DIR "/a.pfm " DIR "/away.pbrt");
    assert_non_null(strstr(r.messages, "the picture is black: the camera sees no shape"));
    /* a box of 2 x 2 x 2 lies in a ball of radius sqrt(3), which fills 90 degrees from sqrt(3) / sin(45 degrees) */
    assert_non_null(
        strstr(r.messages, "They lie in x -1 to 1, y -1 to 1, z -4 to -2; \"LookAt 0 0 -5.44949  0 0 -3  0 1 0\" "
                           "as all that moves its Camera sees all of them"));
    program_write_file(DIR "/turned.pbrt",
        "LookAt 0 0 -5.44949  0 0 -3  0 1 0 Camera \"perspective\" WorldBegin LightSource \"infinite\" "
        "\"bool visible\" false Translate 0 0 -3 Shape \"trianglemesh\" \"point3 P\" "
        "[-1 -1 -1  1 -1 -1  0 1 1]\n");
    program_expect(&r, 0, "--resolution 8x6 --stats - --outfile " DIR "/a.pfm " DIR "/turned.pbrt");
    assert_null(strstr(r.messages, "black"));
    assert_non_null(strstr(r.output, "\"extent\": {\n    \"low\": [\n      -1,\n      -1,\n      -4\n    ],\n"
                                     "    \"high\": [\n      1,\n      1,\n      -2\n    ]\n  },\n"));
    program_write_file(DIR "/none.pbrt", "WorldBegin LightSource \"infinite\" \"bool visible\" false\n");
    program_expect(&r, 0, "--resolution 8x6 --stats - --outfile " DIR "/a.pfm " DIR "/none.pbrt");
    assert_non_null(strstr(r.messages, "The scene has none: add a Shape"));
    assert_non_null(strstr(r.output, "\"extent\": null"));
    program_expect(&r, 0, "--resolution 8x6 --outfile " DIR "/a.pfm " OURS "inside.pbrt");
    assert_null(strstr(r.messages, "black"));
}

/* ---- the scenes of others ---- */

static void scenes_of_others_are_accepted_as_the_list_says(void **state)
{
    const char *folder = getenv("BIS_SCENES");
    if (!folder) {
        print_message("no scenes of others: BIS_SCENES names no folder of them (scripts/check/elsewhere.sh says what "
                      "is in it)\n");
        skip();
    }
    char said[8192];
    const int status = judge(program(), folder, "tests/data/elsewhere.tsv", said);
    print_message("%s", said);
    if (status == 3) skip();
    assert_int_equal(status, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_the_list_expects_passes),
        cmocka_unit_test(whatever_is_other_fails),
        cmocka_unit_test(too_few_that_pass_fail),
        cmocka_unit_test(a_black_picture_that_nothing_announces_fails),
        cmocka_unit_test(nothing_there_is_no_success),
        cmocka_unit_test(a_render_says_that_its_picture_is_black),
        cmocka_unit_test(scenes_of_others_are_accepted_as_the_list_says),
    };
    return cmocka_run_group_tests(tests, make_scenes, NULL);
}
