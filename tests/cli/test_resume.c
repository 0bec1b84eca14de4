/* SPDX-License-Identifier: BSD-2-Clause */
/* --checkpoint and --resume with the program: killed at any moment and run again until it is done, it makes the picture
 * of one run, byte for byte, and leaves nothing but that and the checkpoint. What is refused is in
 * tests/data/expect/resume, what is rendered together with checkpoints in tests/render/test_checkpoint.c. 20 kills;
 * BIS_LONG=1 in the environment: 100. */
#include "bis/base/clock.h"
#include "bis/base/mem.h"

#include "claim.h"
#include "expect.h"
#include "file_help.h"
#include "program.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define DIR "build/test_resume"
#define SCENE DIR "/scene.txt"
#define STATE DIR "/state"

static int setup(void **state)
{
    program_folder(DIR);
    program_write_scene(DIR, "");
    return 0;
}

static int clean(void **state)
{
    unlink(STATE);
    return 0;
}

static void wait_seconds(double s)
{
    nanosleep(&(struct timespec){(time_t)s, (long)(1e9 * (s - (double)(time_t)s))}, NULL);
}

/* One line serves the first run and all later ones. The moments of the kills are uniform over a whole run, whose time
 * is measured only for that; most of a run of so small a picture is writing, at an interval of 0. */
static void killed_at_any_moment_it_goes_on_to_the_same_picture(void **state)
{
    static const char line[] =
        SCENE " --spp 63 --quiet --checkpoint-every 0 --resume " STATE " --outfile " DIR "/b.pfm";
    const int kills = getenv("BIS_LONG") ? 100 : 20;
    program_run r;
    int n = 0;

    program_expect(&r, 0, SCENE " --spp 63 --outfile " DIR "/a.pfm");
    const double before = bis_clock_now();
    program_expect(&r, 0, "%s", line);
    const double whole = bis_clock_now() - before;
    assert_same_file(DIR "/a.pfm", DIR "/b.pfm");
    const int n_files = program_count_files(DIR);
    srand(7);
    while (n < kills) {
        unlink(STATE);
        unlink(DIR "/b.pfm");
        do {
            const pid_t pid = program_start(line);
            wait_seconds(whole * rand() / ((double)RAND_MAX + 1));
            if (n < kills) kill(pid, SIGKILL);
            program_finish(&r, pid);
            n += r.exit_status == 128 + SIGKILL;
        } while (r.exit_status == 128 + SIGKILL);
        assert_int_equal(r.exit_status, 0);
        assert_string_equal(r.messages, "");
        assert_same_file(DIR "/a.pfm", DIR "/b.pfm");
        assert_int_equal(program_count_files(DIR), n_files);
    }
}

static void after_a_signal_it_goes_on_with_more_samples(void **state)
{
    static const int signals[] = {SIGINT, SIGTERM};
    static const char line[] =
        SCENE " --spp 1000000 --checkpoint-every 0 --checkpoint " STATE " --outfile " DIR "/b.pfm";
    program_run r;
    unsigned long spp;

    for (size_t i = 0; i < 2; i++) {
        unlink(STATE);
        const pid_t pid = program_start(line);
        program_wait_for_handler(pid, signals[i]);
        while (!program_exists(STATE)) wait_seconds(1e-3);
        assert_int_equal(kill(pid, signals[i]), 0);
        program_finish(&r, pid);
        assert_int_equal(r.exit_status, 130);
        assert_int_equal(sscanf(r.messages, "bis: interrupted after %lu camera sample", &spp), 1);
        program_expect(&r, 0, SCENE " --spp %lu --outfile " DIR "/a.pfm", spp);
        assert_same_file(DIR "/a.pfm", DIR "/b.pfm");
        program_expect(&r, 0, SCENE " --spp %lu --outfile " DIR "/a.pfm", spp + 7);
        program_expect(&r, 0, SCENE " --spp %lu --nthreads 1 --resume " STATE " --outfile " DIR "/b.pfm", spp + 7);
        assert_same_file(DIR "/a.pfm", DIR "/b.pfm");
    }
}

static void a_disk_that_is_full_costs_the_checkpoint_alone(void **state)
{
    program_run r;
    size_t n, m;

    program_expect(&r, 0, SCENE " --spp 4 --checkpoint " STATE " --outfile " DIR "/a.pfm");
    unsigned char *before = read_bytes(STATE, &n);
    program_expect(&r, 0, SCENE " --spp 12 --outfile " DIR "/a.pfm");
    const int n_files = program_count_files(DIR);
    program_run_limited(&r, (long)n - 1,
                        SCENE " --spp 12 --checkpoint-every 0 --resume " STATE " --outfile " DIR "/b.pfm");
    assert_int_equal(r.exit_status, 1);
    assert_non_null(strstr(r.messages, "bis: warning: no checkpoint was written, the render goes on: "));
    assert_non_null(strstr(r.messages, "bis: error: the last checkpoint could not be written to \"" STATE "\""));
    assert_same_file(DIR "/a.pfm", DIR "/b.pfm");
    assert_int_equal(program_count_files(DIR), n_files);
    unsigned char *after = read_bytes(STATE, &m);
    assert_int_equal(n, m);
    assert_memory_equal(before, after, n);
    bis_free(before);
    bis_free(after);
}

/* The map under another name is the same map; with one other byte under the same name it is another. */
static void a_map_counts_by_what_it_holds(void **state)
{
    program_run r;
    program_expect(&r, 0, SCENE " --spp 4 --checkpoint " STATE " --outfile " DIR "/b.pfm");
    size_t n, size;
    unsigned char *map = read_bytes(DIR "/map.pfm", &n), *text = read_bytes(SCENE, &size);
    store(DIR "/pam.pfm", map, n);
    memcpy(strstr((char *)text, "map.pfm"), "pam", 3);
    program_write_file(DIR "/other.txt", (char *)text);
    program_expect(&r, 0, DIR "/other.txt --spp 8 --resume " STATE " --outfile " DIR "/b.pfm");
    map[n - 2] ^= 1;
    store(DIR "/pam.pfm", map, n);
    program_expect(&r, 2, DIR "/other.txt --spp 8 --resume " STATE " --outfile " DIR "/b.pfm");
    assert_non_null(strstr(r.messages, "These differ: the pixels of the map. "));
    bis_free(map);
    bis_free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(killed_at_any_moment_it_goes_on_to_the_same_picture, clean),
        cmocka_unit_test_teardown(after_a_signal_it_goes_on_with_more_samples, clean),
        cmocka_unit_test_teardown(a_disk_that_is_full_costs_the_checkpoint_alone, clean),
        cmocka_unit_test_teardown(a_map_counts_by_what_it_holds, clean),
    };
    static const expect_text texts[] = {{"scene", SCENE}, {"folder", DIR}, {NULL, NULL}};
    return expect_run("resume", tests, sizeof tests / sizeof *tests, setup, NULL,
                      &(expect_folder){"tests/data/expect/resume", NULL, texts});
}
