/* SPDX-License-Identifier: BSD-2-Clause */
/* --part and `bis merge` with the program: what a user types, and what the messages tell to type, makes the picture of
 * one run; what is refused is in tests/data/expect/merge. What is rendered together with parts is in
 * tests/render/test_part.c. */
#include "bis/base/mem.h"

#include "claim.h"
#include "expect.h"
#include "file_help.h"
#include "json_check.h"
#include "program.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#define DIR "build/test_merge"
#define SCENE DIR "/scene.txt"
#define PARTS DIR "/p3.bispart " DIR "/p1.bispart " DIR "/p2.bispart"

static int setup(void **state)
{
    program_folder(DIR);
    program_write_scene(DIR, "");
    return 0;
}

static void write_parts(const char *options)
{
    program_run r;
    for (int k = 1; k <= 3; k++) {
        program_expect(&r, 0, SCENE " %s --part %d/3 --outfile " DIR "/p%d.bispart", options, k, k);
        if (strncmp(r.messages, "bis: wrote " DIR "/p", strlen("bis: wrote " DIR "/p")) != 0 ||
            !strstr(r.messages, " of 3 of 40 x 16 pixels, "))
            fail_msg("%s", r.messages);
    }
}

/* All outputs of a merge are those of a render, but for seconds and memory; the EXR has seconds in its header. */
static void the_outputs_are_those_of_one_run(void **state)
{
    static const char *const keys[] = {"scene", "integrator", "proposal", "candidates", "shadowrays", "samples", "spp",
                                       "seed", "accelerator", "triangles", "width", "height", "rays.camera",
                                       "rays.shadow", "candidates_drawn", "accepted", "fallbacks", "memory.mesh",
                                       "memory.accel", "memory.envmap", "estimated_relative_rmse", "interrupted"};
    static char whole[1 << 16];
    program_run r;
    char a[256], b[256];

    program_expect(&r, 0,
        SCENE " --resolution 40x16 --spp 9 --seed 4 --layers depth,stderr --stats - --exposure 1 --outfile " DIR
              "/a.exr "
              "--outfile " DIR "/a.pfm --outfile " DIR "/a.png");
    memcpy(whole, r.output, sizeof whole);
    write_parts("--resolution 40x16 --spp 9 --seed 4 --layers depth,stderr");
    program_expect(&r, 0, "merge " PARTS " --stats - --exposure 1 --outfile " DIR "/b.exr --outfile " DIR
                   "/b.pfm --outfile " DIR "/b.png");
    program_expect_only_the_result(&r);
    assert_same_file(DIR "/a.pfm", DIR "/b.pfm");
    assert_same_file(DIR "/a.png", DIR "/b.png");
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
        json_value(a, sizeof a, whole, keys[i]);
        json_value(b, sizeof b, r.output, keys[i]);
        if (strcmp(a, b) != 0) fail_msg("%s is %s instead of %s", keys[i], b, a);
    }
    assert_same_exr(DIR "/a.exr", DIR "/b.exr");
}

/* The command that a message names, run by a shell with $PATH leading to the program. */
static void the_command_in_the_message_makes_the_missing_part(void **state)
{
    static const char odd[] = DIR "/a scene, 'quoted'.txt", mark[] = "this makes it: ";
    char command[8192], link[1024], here[512];
    program_run r;
    const char *program = getenv("BIS_PROGRAM");
    size_t n;

    if (!program || !*program) program = "build/release/bis";
    assert_non_null(getcwd(here, sizeof here));
    snprintf(link, sizeof link, "%s/%s", here, program);
    unlink(DIR "/bis");
    assert_int_equal(symlink(program[0] == '/' ? program : link, DIR "/bis"), 0);
    unsigned char *text = read_bytes(SCENE, &n);
    program_write_file(odd, (char *)text);
    bis_free(text);
    for (int k = 1; k <= 2; k++) {
        snprintf(command, sizeof command,
            "PATH=" DIR ":$PATH; bis --resolution=40x16 --spp=5 \"%s\" --part=%d/3 --stats " DIR "/stats.json "
            "--checkpoint " DIR "/state --quiet --outfile=" DIR "/p%d.bispart --candidates 30",
            odd, k, k);
        assert_int_equal(system(command), 0);
    }
    program_expect(&r, 2, "merge " DIR "/p1.bispart " DIR "/p2.bispart --outfile " DIR "/b.pfm");
    char *at = strstr(r.messages, mark);
    assert_non_null(at);
    at += strlen(mark);
    at[strcspn(at, "\n")] = '\0';
    assert_null(strstr(at, "state"));
    snprintf(command, sizeof command, "PATH=" DIR ":$PATH; %s", at);
    assert_int_equal(system(command), 0);
    program_expect(&r, 0, "merge " DIR "/p1.bispart " DIR "/p2.bispart part-3.bispart --outfile " DIR "/b.pfm");
    unlink("part-3.bispart");
    program_expect(&r, 0, SCENE " --resolution 40x16 --spp 5 --candidates 30 --outfile " DIR "/a.pfm");
    assert_same_file(DIR "/a.pfm", DIR "/b.pfm");
}

/* Each output is compared with each part: the last picture, and the figures. */
static void no_output_replaces_a_part(void **state)
{
    static const char *const outputs[] = {"--outfile " DIR "/b.exr --outfile " DIR "/link.pfm",
                                          "--outfile " DIR "/b.exr --stats " DIR "/p2.bispart"};
    program_run r;
    write_parts("--resolution 40x16 --spp 3");
    unlink(DIR "/link.pfm");
    assert_int_equal(symlink("p2.bispart", DIR "/link.pfm"), 0);
    for (size_t i = 0; i < sizeof outputs / sizeof *outputs; i++) {
        program_expect(&r, 2, "merge " PARTS " %s", outputs[i]);
        assert_non_null(strstr(r.messages, "would replace \"" DIR "/p2.bispart\", which is read"));
    }
    unlink(DIR "/link.pfm");
}

/* A full disk leaves the older file; a signal leaves a checkpoint, with which the part goes on. */
static void a_part_that_cannot_be_finished_is_not_written(void **state)
{
    program_run r;

    program_expect(&r, 0, SCENE " --spp 4 --part 1/2 --outfile " DIR "/q1.bispart");
    program_expect(&r, 0, SCENE " --spp 4 --part 1/2 --outfile " DIR "/before.bispart");
    const int n_files = program_count_files(DIR);
    program_run_limited(&r, 1024, SCENE " --spp 8 --part 1/2 --outfile " DIR "/q1.bispart");
    assert_int_equal(r.exit_status, 1);
    assert_int_equal(program_count_files(DIR), n_files);
    program_expect(&r, 0, SCENE " --spp 4 --part 2/2 --outfile " DIR "/q2.bispart");
    program_expect(&r, 0, "merge " DIR "/q1.bispart " DIR "/q2.bispart --outfile " DIR "/b.pfm");

    unlink(DIR "/state");
    unlink(DIR "/q1.bispart");
    const pid_t pid = program_start(SCENE " --spp 1000000 --part 1/2 --checkpoint-every 0 --checkpoint " DIR
                                    "/state --outfile " DIR "/q1.bispart");
    program_wait_for_handler(pid, SIGTERM);
    while (!program_exists(DIR "/state")) usleep(1000);
    kill(pid, SIGTERM);
    program_finish(&r, pid);
    assert_int_equal(r.exit_status, 130);
    assert_non_null(strstr(r.messages, "bis: interrupted: part 1 of 2 is not complete, nothing was written; --resume"));
    assert_false(program_exists(DIR "/q1.bispart"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_outputs_are_those_of_one_run),
        cmocka_unit_test(the_command_in_the_message_makes_the_missing_part),
        cmocka_unit_test(no_output_replaces_a_part),
        cmocka_unit_test(a_part_that_cannot_be_finished_is_not_written),
    };
    static const expect_text texts[] = {{"scene", SCENE}, {"folder", DIR}, {NULL, NULL}};
    return expect_run("merge", tests, sizeof tests / sizeof *tests, setup, NULL,
                      &(expect_folder){"tests/data/expect/merge", NULL, texts});
}
