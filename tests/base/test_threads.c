/* SPDX-License-Identifier: BSD-2-Clause */
/* threads: as many as the system gives, and none is left. A child with little address space stands for a machine
 * without threads. */
#include "bis/base/threads.h"

#include "bis/base/mem.h"
#include "claim.h"

#include <time.h>

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

static const bis_loc at = {"scene.txt", 0, 0};

/* Threads of this process, by the system's own list. */
static int threads_listed(void)
{
    int n = 0;
    DIR *all = opendir("/proc/self/task");
    if (!all) return 1;
    while (readdir(all)) n++;
    closedir(all);
    return n - 2; /* . and .. */
}

/* Is this the only thread? On a busy machine one that has been joined may stand in the list a moment longer: so it is
 * looked at again, for 10 s at most. */
static bool is_alone(void)
{
    for (int i = 0; i < 10000 && threads_listed() != 1; i++) nanosleep(&(struct timespec){0, 1000000}, NULL);
    return threads_listed() == 1;
}

static void as_many_as_are_asked_for(void **state)
{
    const int counts[] = {0, 1, 2, 60};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        assert_int_equal(bis_threads_check(counts[i], at, NULL), BIS_OK);
    assert_true(is_alone());
    assert_int_equal(bis_mem_live(), 0);
}

/* In a child that has room for some 30 stacks of 8 MB: 0, or the step that went wrong. */
static int in_little_room(void)
{
    char pages[64] = "";
    FILE *f = fopen("/proc/self/statm", "r");
    if (!f || !fgets(pages, sizeof pages, f)) return 1;
    fclose(f);
    const struct rlimit stack = {(rlim_t)8 << 20, (rlim_t)8 << 20};
    const rlim_t used = strtoul(pages, NULL, 10) * (rlim_t)sysconf(_SC_PAGESIZE);
    const struct rlimit room = {used + 30 * stack.rlim_cur, used + 30 * stack.rlim_cur};
    bis_diag diag = {0};
    unsigned started = 0;
    if (setrlimit(RLIMIT_STACK, &stack) || setrlimit(RLIMIT_AS, &room)) return 2;
    if (bis_threads_check(60, at, &diag) != BIS_NOMEM || diag.n != 1) return 3;
    const char *text = diag.messages[0].text;
    if (sscanf(text, "scene.txt: error: the system started %u threads and no more (", &started) != 1) return 4;
    /* Some room goes to malloc's arenas, and glibc uses again up to 40 MB of stacks of earlier tests. Threads that did
     * not live at the same time would all be started. */
    if (started < 8 || started > 35) return 5;
    if (!strstr(text, "), but 60 with Embree's take 118: give --nthreads a smaller number")) return 6;
    bis_diag_clear(&diag);
    /* what was started has ended, and 5 fit */
    return bis_threads_check(5, at, &diag) == BIS_OK && is_alone() ? 0 : 7;
}

static void too_many_are_an_error_and_the_program_goes_on(void **state)
{
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    print_message("a sanitizer needs more address space than this test leaves\n");
    skip();
#endif
#ifndef _OPENMP
    print_message("a compiler without OpenMP has one thread\n");
    skip();
#endif
    int status;
    const pid_t child = fork();
    if (child == 0) _exit(in_little_room());
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);

    /* the same by the program */
    assert_int_equal(
        system("(ulimit -v 600000 && ${BIS_PROGRAM:-build/release/bis} --quiet --accelerator grid --nthreads 300 "
               "--spp 1 --outfile build/test_threads.pfm scene.txt) 2>build/test_threads.txt; test $? -eq 1"),
        0);
    assert_int_equal(system("grep -q '^scene.txt: error: the system started .* threads' build/test_threads.txt"), 0);
    assert_int_equal(system("! test -e build/test_threads.pfm"), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(as_many_as_are_asked_for),
        cmocka_unit_test(too_many_are_an_error_and_the_program_goes_on),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
