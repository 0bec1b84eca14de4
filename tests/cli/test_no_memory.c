/* SPDX-License-Identifier: BSD-2-Clause */
/* Commands with each allocation failing in turn: exit status 1, one line that says so, no half of an answer on standard
 * output, no file that was not there, nothing that stays allocated; and with enough memory again an answer. */
#include "cli/cli.h"

#include "bis/base/image.h"
#include "bis/base/mem.h"
#include "bis/files/image_file.h"
#include "claim.h"
#include "file_help.h"
#include "program.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define DIR "build/test_starved"
#define OUT DIR "/said.txt"
#define ERR DIR "/complained.txt"

typedef struct answer {
    int exit_status;
    long allocations;
    char output[1 << 16], messages[1 << 12];
} answer;

/* Allocation k fails; 0: none. */
static void run(answer *a, int command(int argc, char **argv), const char *arguments, long k)
{
    char text[512], *argv[32];
    int argc = 0, saved[2];
    snprintf(text, sizeof text, "%s", arguments);
    for (char *at = strtok(text, " "); at; at = strtok(NULL, " ")) argv[argc++] = at;
    argv[argc] = NULL;
    fflush(stdout);
    fflush(stderr);
    for (int i = 0; i < 2; i++) saved[i] = dup(i + 1);
    assert_true(freopen(OUT, "w", stdout) && freopen(ERR, "w", stderr));
    bis_mem_fail_at(k ? k : 1L << 60);
    a->exit_status = command(argc, argv);
    a->allocations = bis_mem_count();
    bis_mem_fail_at(0);
    fflush(stdout);
    fflush(stderr);
    for (int i = 0; i < 2; i++) {
        dup2(saved[i], i + 1);
        close(saved[i]);
    }
    read_text(a->output, sizeof a->output, OUT);
    read_text(a->messages, sizeof a->messages, ERR);
}

static int lines_with(const char *text, const char *word)
{
    int n = 0;
    for (const char *at = text; (at = strstr(at, word)) != NULL; at++) n++;
    return n;
}

/* The files are those of a run that has enough. Beyond the first `each` allocations some fail, each a quarter
 * further than the one before. */
static void each_may_fail(int command(int argc, char **argv), const char *arguments, long each)
{
    static answer whole, a;
    const long live = bis_mem_live();
    run(&whole, command, arguments, 0);
    if (whole.exit_status != 0) fail_msg("%s: %s", arguments, whole.messages);
    const int files = program_count_files(DIR);
    for (long k = 1; k <= whole.allocations; k += k < each ? 1 : k / 4) {
        run(&a, command, arguments, k);
        if (a.exit_status != BIS_EXIT_FAILED || a.output[0] || lines_with(a.messages, "error:") != 1 ||
            (!strstr(a.messages, "memory") && !strstr(a.messages, "allocate"))) /* OpenEXR's word */
            fail_msg("%s, allocation %ld of %ld: status %d, \"%s\", \"%s\"", arguments, k, whole.allocations,
                     a.exit_status, a.output, a.messages);
        const long stay = bis_mem_live() - live;
        const int new = program_count_files(DIR) - files;
        if (stay || new) fail_msg("%s, allocation %ld: %ld blocks stay, %d new files", arguments, k, stay, new);
    }
    run(&a, command, arguments, 0);
    assert_int_equal(a.exit_status, 0);
}

static void compare_says_so(void **state)
{
    each_may_fail(bis_cmd_compare, DIR "/a.exr " DIR "/b.pfm --diff " DIR "/d.png", 1000);
    each_may_fail(bis_cmd_compare, "--json " DIR "/a.exr " DIR "/b.pfm", 1000);
}

static void render_says_so(void **state)
{
    each_may_fail(bis_cmd_render, DIR "/scene.txt --quiet --spp 2 --nthreads 1 --accelerator grid --layers all "
                                  "--stats " DIR "/r.json --outfile " DIR "/r.exr --outfile " DIR "/r.pfm", 1000);
}

/* The options that have files of their own. */
static void a_light_of_its_own_says_so(void **state)
{
    each_may_fail(bis_cmd_render, DIR "/scene.txt --quiet --spp 1 --nthreads 1 --accelerator grid --light " DIR
                                  "/b.pfm --outfile " DIR "/r.pfm", 1000);
}

static void merge_says_so(void **state)
{
    static answer part;
    for (int k = 1; k <= 2; k++) {
        char arguments[256];
        snprintf(arguments, sizeof arguments, DIR "/scene.txt --quiet --spp 1 --part %d/2 --outfile " DIR
                 "/p%d.bispart", k, k);
        run(&part, bis_cmd_render, arguments, 0);
        if (part.exit_status != 0) fail_msg("%s", part.messages);
    }
    each_may_fail(bis_cmd_merge, DIR "/p1.bispart " DIR "/p2.bispart --quiet --stats " DIR "/r.json --outfile " DIR
                                 "/r.pfm", 1000);
}

static void verify_says_so(void **state)
{
    each_may_fail(bis_cmd_verify, DIR "/map.pfm --json", 1000);
    each_may_fail(bis_cmd_verify, DIR "/dark.txt", 16);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(compare_says_so),
        cmocka_unit_test(render_says_so),
        cmocka_unit_test(a_light_of_its_own_says_so),
        cmocka_unit_test(merge_says_so),
        cmocka_unit_test(verify_says_so),
    };
    rgb pixels[32];
    const bis_image image = {8, 4, pixels, NULL};
    assert_int_equal(system("rm -rf " DIR), 0);
    program_folder(DIR);
    program_write_scene(DIR, "");
    for (int i = 0; i < 32; i++) pixels[i] = (rgb){(float)i, 1, 2};
    assert_int_equal(bis_image_save(&image, DIR "/a.exr", NULL), BIS_OK);
    pixels[3].r = 100;
    assert_int_equal(bis_image_save(&image, DIR "/b.pfm", NULL), BIS_OK);
    program_write_file(DIR "/dark.txt", "WorldBegin Material \"diffuse\" \"float reflectance\" 0 Shape \"sphere\"\n");
    return cmocka_run_group_tests(tests, NULL, NULL);
}
