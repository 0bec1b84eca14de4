/* SPDX-License-Identifier: BSD-2-Clause */
/* bis-mpi: any number of ranks makes the picture of `bis`, byte for byte, under all budgets, and a checkpoint goes on
 * with another number; a rank that fails ends the job with a message. Skipped where there is no mpirun, or where
 * bis-mpi is not built. Ranks are many more than processors here, so they yield to each other while they wait, and all
 * are on one machine, so they need no network, which Open MPI 5 misses aloud. */

#include "claim.h"
#include "file_help.h"
#include "json_check.h"
#include "program.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#define DIR "build/test_mpi"
#define SCENE DIR "/scene.txt"
#define STATE DIR "/state"
#define MPIRUN "timeout 120 mpirun --oversubscribe --bind-to none --mca mpi_yield_when_idle 1 --mca btl '^tcp'"

/* The program beside the one under test. */
static const char *mpi_program(void)
{
    static char path[1024];
    const char *program = getenv("BIS_PROGRAM");
    snprintf(path, sizeof path, "%s-mpi", program && *program ? program : "build/release/bis");
    return path;
}

static bool is_there(void)
{
    static int there = -1;
    if (there < 0) there = program_exists(mpi_program()) && system("command -v mpirun > /dev/null") == 0;
    return there;
}

static void skip_without_mpi(void)
{
    if (is_there()) return;
    print_message("no bis-mpi, or no mpirun: `scripts/setup.sh --mpi` and `make MPI=1`\n");
    skip();
}

static int setup(void **state)
{
    setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
    setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
    setenv("OMP_NUM_THREADS", "1", 1);
    setenv("ASAN_OPTIONS", "detect_leaks=0", 0); /* the library's own */
    program_folder(DIR);
    program_write_scene(DIR, "");
    return 0;
}

static char text[1 << 16];

static int shell(const char *command)
{
    fflush(stdout);
    const int status = system(command);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

/* Runs so many ranks; what they say on standard error is in text[] then. Returns the exit status. */
static int mpi(int ranks, const char *arguments)
{
    char command[4096];
    snprintf(command, sizeof command, MPIRUN " -n %d %s %s > " DIR "/out 2> " DIR "/err", ranks, mpi_program(),
             arguments);
    const int status = shell(command);
    read_text(text, sizeof text, DIR "/err");
    return status;
}

static void expect_mpi(int ranks, const char *arguments)
{
    const int status = mpi(ranks, arguments);
    if (status) fail_msg("%d ranks, %s: exit status %d\n%s", ranks, arguments, status, text);
}

/* ---- the same bits ---- */

/* A picture of 4 x 3 tiles, with learned visibility, edges and layers, and less. */
static void any_number_of_ranks_makes_the_bits_of_one_process(void **state)
{
    static const struct {
        const char *options;
        int ranks;
    } cases[] = {
        {"--spp 9 --integrator sir --proposal product --learn on --layers all", 3},
        {"--spp 6 --integrator sir --proposal product --learn on --cropwindow 0.1,0.7,0.2,0.9", 5},
        {"--spp 7 --integrator mis --nthreads 2", 2},
        {"--error 20% --integrator sir --proposal product --learn on --layers stderr,albedo", 3},
        {"--spp 24 --layers samples", 5},
        {"--spp 3 --integrator em --disable-pixel-jitter", 14}, /* rank 0 leads only; one of the other 13 has no tile */
    };
    static const char *const keys[] = {
        "spp", "rays.camera", "rays.shadow", "candidates_drawn", "estimated_relative_rmse"};
    static char whole[1 << 16];
    char arguments[2048], a[256], b[256];
    program_run r;

    skip_without_mpi();
    program_write_scene(DIR, "Sampler \"sobol\" \"integer pixelsamples\" 4 \"integer edgesamples\" 3\n");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        program_expect(&r, 0, SCENE " --resolution 60x40 %s --stats - --outfile " DIR "/a.exr", cases[i].options);
        memcpy(whole, r.output, sizeof whole);
        snprintf(arguments, sizeof arguments, SCENE " --resolution 60x40 %s --stats - --outfile " DIR "/b.exr",
                 cases[i].options);
        expect_mpi(cases[i].ranks, arguments);
        if (strncmp(text, "bis: wrote " DIR "/b.exr: ", strlen("bis: wrote " DIR "/b.exr: ")) != 0 ||
            strchr(text, '\n')[1])
            fail_msg("%s: %s", cases[i].options, text);
        assert_same_exr(DIR "/a.exr", DIR "/b.exr");
        read_text(text, sizeof text, DIR "/out");
        for (size_t k = 0; k < sizeof keys / sizeof *keys; k++) {
            json_value(a, sizeof a, whole, keys[k]);
            json_value(b, sizeof b, text, keys[k]);
            if (strcmp(a, b) != 0) fail_msg("%s: %s is %s instead of %s", cases[i].options, keys[k], b, a);
        }
    }
}

/* With a portal, and where it is found. */
static void ranks_draw_through_the_same_portal(void **state)
{
    static const char *const commands[] = {
        "cp data/scenes/pbrt/window-v4.txt " DIR "/window.txt",
        "sed '/point3 portal/d' data/scenes/pbrt/window-v4.txt > " DIR "/window.txt",
    };
    program_run r;

    skip_without_mpi();
    assert_int_equal(system("mkdir -p " DIR "/maps && cp data/maps/outdoor.hdr " DIR "/maps"), 0);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(system(commands[i]), 0);
        assert_int_equal(system("sed -i 's|../../maps|maps|' " DIR "/window.txt"), 0);
        program_expect(&r, 0, DIR "/window.txt --resolution 60x40 --spp 5 --outfile " DIR "/%c.pfm", 'a' + i);
        expect_mpi(3, DIR "/window.txt --resolution 60x40 --spp 5 --outfile " DIR "/c.pfm");
        assert_same_file(DIR "/a.pfm", DIR "/c.pfm");
    }
    assert_same_file(DIR "/a.pfm", DIR "/b.pfm");
}

/* 3 ranks, then one process, then 2, then 5 ranks. */
static void a_checkpoint_goes_on_with_another_number_of_ranks(void **state)
{
    static const char line[] = SCENE " --quiet --resolution 60x40 --integrator sir --proposal product --learn on ";
    char arguments[2048];
    program_run r;

    skip_without_mpi();
    unlink(STATE);
    program_expect(&r, 0, "%s --spp 18 --outfile " DIR "/a.pfm", line);
    snprintf(arguments, sizeof arguments, "%s --spp 4 --resume " STATE " --outfile " DIR "/b.pfm", line);
    expect_mpi(3, arguments);
    program_expect(&r, 0, "%s --spp 8 --resume " STATE " --outfile " DIR "/b.pfm", line);
    snprintf(arguments, sizeof arguments, "%s --spp 12 --resume " STATE " --outfile " DIR "/b.pfm", line);
    expect_mpi(2, arguments);
    assert_int_not_equal(differing_bytes(DIR "/a.pfm", DIR "/b.pfm"), 0);
    snprintf(arguments, sizeof arguments, "%s --spp 18 --resume " STATE " --outfile " DIR "/b.pfm", line);
    expect_mpi(5, arguments);
    assert_same_file(DIR "/a.pfm", DIR "/b.pfm");
    snprintf(arguments, sizeof arguments, "%s --spp 18 --seed 8 --resume " STATE " --outfile " DIR "/b.pfm", line);
    assert_int_equal(mpi(3, arguments), 2);
    assert_non_null(strstr(text, "These differ: the sampler, or its seed. "));
}

static void with_a_time_the_ranks_end_together(void **state)
{
    program_run r;
    unsigned long spp;

    skip_without_mpi();
    expect_mpi(2, SCENE " --time 0.3 --stats - --outfile " DIR "/b.pfm");
    read_text(text, sizeof text, DIR "/out");
    spp = (unsigned long)json_number(text, "spp");
    program_expect(&r, 0, SCENE " --spp %lu --outfile " DIR "/a.pfm", spp);
    assert_same_file(DIR "/a.pfm", DIR "/b.pfm");
}

/* ---- what fails ---- */

/* Each rank's own command: $RANK is its number, its process is noted in DIR/pidRANK. */
static void write_script(const char *scene_of_rank)
{
    char script[2048];
    snprintf(script, sizeof script, "RANK=${OMPI_COMM_WORLD_RANK:-$PMI_RANK}\necho $$ > " DIR "/pid$RANK.new\n"
             "mv " DIR "/pid$RANK.new " DIR "/pid$RANK\nscene=" SCENE "\n%s\nexec %s $scene \"$@\"\n", scene_of_rank,
             mpi_program());
    program_write_file(DIR "/rank.sh", script);
}

static int run_script(int ranks, const char *arguments)
{
    char command[4096];
    snprintf(command, sizeof command, MPIRUN " -n %d sh " DIR "/rank.sh %s > " DIR "/out 2> " DIR "/err", ranks,
             arguments);
    const int status = shell(command);
    read_text(text, sizeof text, DIR "/err");
    return status;
}

static void count_once(const char *words)
{
    const char *at = strstr(text, words);
    if (!at || strstr(at + 1, words)) fail_msg("not once \"%s\" in: %s", words, text);
}

static void a_rank_that_has_another_scene_or_none_is_named(void **state)
{
    skip_without_mpi();
    read_text(text, sizeof text, SCENE);
    char *exponent = strstr(text, "\"float exponent\" 20");
    assert_non_null(exponent);
    exponent[strlen("\"float exponent\" 2")] = '1';
    program_write_file(DIR "/other.txt", text);
    unlink(DIR "/b.pfm");

    write_script("[ $RANK = 2 ] && scene=" DIR "/other.txt");
    assert_int_equal(run_script(3, "--spp 2 --outfile " DIR "/b.pfm"), 2);
    count_once("bis: error: rank 2 on \"");
    count_once("These differ: the materials, or their textures. Give all machines the same files");

    write_script("[ $RANK = 1 ] && scene=" DIR "/none.txt");
    assert_int_equal(run_script(3, "--spp 2 --outfile " DIR "/b.pfm"), 1);
    count_once("bis: error: rank 1 on \"");
    count_once("cannot open \"" DIR "/none.txt\"");

#ifndef __SANITIZE_ADDRESS__ /* which takes more addresses than the limit leaves */
    write_script("[ $RANK = 1 ] && ulimit -v 1000000"); /* 24 million pixels take more */
    assert_int_equal(run_script(3, "--resolution 6000x4000 --spp 1 --outfile " DIR "/b.pfm"), 1);
    count_once("bis: error: rank 1 on \"");
    count_once("cannot go on: no memory for a picture of 6000 x 4000 pixels");
#endif

    write_script("scene=" DIR "/none.txt"); /* all of them: one message, as without MPI */
    assert_int_equal(run_script(3, "--spp 2 --outfile " DIR "/b.pfm"), 1);
    count_once("cannot open \"" DIR "/none.txt\"");
    assert_null(strstr(text, "rank 1 on"));

    assert_int_equal(mpi(3, SCENE " --spq 2"), 2);
    count_once("unknown option \"--spq\" (did you mean \"--spp\"?)");
    assert_int_equal(mpi(2, SCENE " --part 1/2 --outfile " DIR "/x.bispart"), 2);
    count_once("cannot have MPI: its ranks share the tiles already. Leave out --part");
    assert_int_equal(mpi(2, SCENE " --spp 2 --outfile " DIR "/none/b.pfm"), 1);
    count_once("No such file or directory");
    assert_false(program_exists(DIR "/b.pfm"));

    expect_mpi(3, "help sir"); /* nothing is said twice */
    read_text(text, sizeof text, DIR "/out");
    count_once("from `bis help integrators`:");
    expect_mpi(2, SCENE " --plan");
    read_text(text, sizeof text, DIR "/out");
    count_once("sampler      sobol");
}

static long read_pid(int rank)
{
    char path[128];
    snprintf(path, sizeof path, DIR "/pid%d", rank);
    read_text(text, sizeof text, path);
    return atol(text);
}

/* A rank that is killed ends the job, and the last checkpoint is whole; a signal to rank 0 ends it with the picture. */
static void a_rank_that_is_killed_ends_the_job_and_leaves_a_checkpoint(void **state)
{
    static const int victims[] = {2, 1, 0}, signals[] = {SIGKILL, SIGKILL, SIGTERM};
    static const char line[] =
        "--spp 1000000 --seed 3 --checkpoint-every 0 --checkpoint " STATE " --outfile " DIR "/c.pfm";
    program_run r;

    skip_without_mpi();
    for (int i = 0; i < 3; i++) {
        unlink(STATE);
        unlink(DIR "/c.pfm");
        for (int k = 0; k < 3; k++) {
            char path[128];
            snprintf(path, sizeof path, DIR "/pid%d", k);
            unlink(path);
        }
        write_script("");
        fflush(stdout);
        const pid_t child = fork();
        assert_true(child >= 0);
        if (child == 0) _exit(run_script(3, line));
        for (int k = 0; k < 60000 && !program_exists(STATE); k++) usleep(1000);
        assert_true(program_exists(STATE));
        assert_int_equal(kill((pid_t)read_pid(victims[i]), signals[i]), 0);
        int status;
        assert_int_equal(waitpid(child, &status, 0), child);
        assert_true(WIFEXITED(status) && WEXITSTATUS(status) != 0);
        assert_int_equal(program_exists(DIR "/c.pfm"), signals[i] == SIGTERM);
        read_text(text, sizeof text, DIR "/err");
        if (signals[i] == SIGTERM) {
            unsigned long spp;
            assert_int_equal(WEXITSTATUS(status), 130);
            assert_int_equal(sscanf(text, "bis: interrupted after %lu camera sample", &spp), 1);
            program_expect(&r, 0, SCENE " --seed 3 --spp %lu --outfile " DIR "/a.pfm", spp);
            assert_same_file(DIR "/a.pfm", DIR "/c.pfm");
        }
        program_expect(&r, 0, SCENE " --time 1e-9 --seed 3 --resume " STATE " --stats - --outfile " DIR "/b.pfm");
        const unsigned long spp = (unsigned long)json_number(r.output, "spp");
        program_expect(&r, 0, SCENE " --seed 3 --spp %lu --outfile " DIR "/a.pfm", spp);
        assert_same_file(DIR "/a.pfm", DIR "/b.pfm");
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_number_of_ranks_makes_the_bits_of_one_process),
        cmocka_unit_test(ranks_draw_through_the_same_portal),
        cmocka_unit_test(a_checkpoint_goes_on_with_another_number_of_ranks),
        cmocka_unit_test(with_a_time_the_ranks_end_together),
        cmocka_unit_test(a_rank_that_has_another_scene_or_none_is_named),
        cmocka_unit_test(a_rank_that_is_killed_ends_the_job_and_leaves_a_checkpoint),
    };
    return cmocka_run_group_tests(tests, setup, NULL);
}
