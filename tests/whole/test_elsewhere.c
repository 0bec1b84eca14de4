/* SPDX-License-Identifier: BSD-2-Clause */
/* elsewhere: scenes that other people published, judged by scripts/check/elsewhere.sh and tests/data/elsewhere.tsv
 * where they are on disk; what `bis` says of some like them. */
#include "claim.h"
#include "program.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
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

/* ---- what --approximate says of scenes of our own ---- */

static const struct {
    const char *name, *text, *plan; /* plan: what --plan --approximate says, NULL: it is refused */
} scenes[] = {
    {"inside.pbrt", "WorldBegin LightSource \"infinite\" Translate 0 0 3 Shape \"sphere\"\n", ""},
    {"near.pbrt", "WorldBegin LightSource \"point\" Translate 0 0 3 Shape \"sphere\" Shape \"curve\"\n",
     "a white sky of radiance 1 is used"},
    {"lacking.pbrt", "WorldBegin LightSource \"infinite\" Shape \"sphere\"\nInclude \"no.pbrt\"\n",
     "missing      " OURS "no.pbrt"},
    {"room.pbrt", "WorldBegin LightSource \"point\" Shape \"sphere\" \"float radius\" 9\n", "no light from infinity"},
    {"broken.pbrt", "WorldBegin Shap \"sphere\"\n", NULL},
};
enum { N_SCENES = sizeof scenes / sizeof *scenes };

static int make_scenes(void **state)
{
    if (system("rm -rf " DIR " && mkdir -p " OURS)) return 1;
    for (int i = 0; i < N_SCENES; i++) {
        char path[128];
        snprintf(path, sizeof path, OURS "%s", scenes[i].name);
        program_write_file(path, scenes[i].text);
    }
    return 0;
}

static void what_a_scene_lacks_or_is_not_is_planned(void **state)
{
    for (int i = 0; i < N_SCENES; i++) {
        program_run r;
        program_expect(&r, scenes[i].plan ? 0 : 2, "--approximate --plan " OURS "%s", scenes[i].name);
        if (scenes[i].plan && !strstr(r.output, scenes[i].plan) && !strstr(r.messages, scenes[i].plan))
            fail_msg("%s: no \"%s\" in %s%s", scenes[i].name, scenes[i].plan, r.output, r.messages);
    }
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
        cmocka_unit_test(what_a_scene_lacks_or_is_not_is_planned),
        cmocka_unit_test(a_render_says_that_its_picture_is_black),
        cmocka_unit_test(scenes_of_others_are_accepted_as_the_list_says),
    };
    return cmocka_run_group_tests(tests, make_scenes, NULL);
}
