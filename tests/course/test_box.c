/* SPDX-License-Identifier: BSD-2-Clause */
/* The box ends what it has begun, whenever it is told to end. */
#include "box.h"

#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

enum { BOXES = 400 };

static void sleep_for(long microseconds)
{
    nanosleep(&(struct timespec){.tv_nsec = 1000 * microseconds}, NULL);
}

/* The shell of the box starts a process of its own: it is what a box that forgets its shell leaves behind. */
static _Noreturn void be_a_box(void)
{
    static char *const words[] = {"sh", "-c", "sleep 60 & wait", NULL};
    const box_limits limits = {.cpu = 10, .wall = 60, .file = 1 << 20};
    box b;

    box_end_with_us();
    box_run(&b, &limits, words);
    _exit(0);
}

/* Orphans become our children, because we are the subreaper: whatever is not dead after its box is left behind. */
static int count_left(void)
{
    int left = 0;

    for (int tries = 0; tries < 20; tries++) { /* what was killed needs a moment to die */
        while (waitpid(-1, NULL, WNOHANG) > 0)
            continue;
        if (waitpid(-1, NULL, WNOHANG) < 0) return 0;
        sleep_for(50000);
    }
    FILE *f = fopen("/proc/thread-self/children", "r");
    for (int pid; f && fscanf(f, "%d", &pid) == 1; left++)
        kill(pid, SIGKILL);
    if (f) fclose(f);
    while (waitpid(-1, NULL, 0) > 0)
        continue;
    return left;
}

/* A signal that came between fork() and the note of what was forked ended the shell alone: 8 to 27 of 400 were left. */
static void a_box_that_is_ended_at_any_moment_leaves_nothing(void **state)
{
    (void)state;
    srand(20261124);
    assert_int_equal(prctl(PR_SET_CHILD_SUBREAPER, 1), 0);
    for (int i = 0; i < BOXES; i++) {
        const long moment = rand() % 3000;
        const pid_t child = fork();
        assert_true(child >= 0);
        if (child == 0) be_a_box();
        sleep_for(moment);
        kill(child, SIGTERM);
        assert_int_equal(waitpid(child, NULL, 0), child);
    }
    assert_int_equal(count_left(), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_box_that_is_ended_at_any_moment_leaves_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
