/* SPDX-License-Identifier: BSD-2-Clause */
/* box: fork, limits, exec; then poll the pipe and the clock until the child has ended. */
#include "box.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { MOST_PRINTED = 1 << 20 };

static volatile sig_atomic_t running; /* the process group to end with us */

static void end_all(int number)
{
    if (running) {
        kill(-(pid_t)running, SIGKILL);
        kill((pid_t)running, SIGKILL); /* it has no group yet, perhaps */
    }
    _exit(128 + number);
}

/* The signals that end us wait while `running` does not say yet what has begun, because end_all would end nothing: the
 * child would die with us by PR_SET_PDEATHSIG, but what it has forked by then would not. */
static sigset_t hold_signals(void)
{
    sigset_t ours, before;

    sigemptyset(&ours);
    sigaddset(&ours, SIGINT);
    sigaddset(&ours, SIGTERM);
    sigaddset(&ours, SIGHUP);
    sigprocmask(SIG_BLOCK, &ours, &before);
    return before;
}

void box_end_with_us(void)
{
    const struct sigaction action = {.sa_handler = end_all};

    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    sigaction(SIGHUP, &action, NULL);
    prctl(PR_SET_PDEATHSIG, SIGTERM);
}

double box_now(void)
{
    struct timespec t;

    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* A macro, because the type of RLIMIT_* has no name that every libc knows. */
#define LIMIT(resource, value) setrlimit(resource, &(struct rlimit){(rlim_t)(value), (rlim_t)(value)})

static _Noreturn void become(const box_limits *l, char *const words[], int output, int channel, const sigset_t *mask)
{
    const struct rlimit cpu = {(rlim_t)(l->cpu + 0.999),
                               (rlim_t)(l->cpu + 0.999) + 1}; /* SIGXCPU, a second later SIGKILL */
    const int nothing = open("/dev/null", O_RDONLY);

    prctl(PR_SET_PDEATHSIG, SIGKILL);
    setsid();
    signal(SIGINT, SIG_DFL);
    signal(SIGTERM, SIG_DFL);
    signal(SIGHUP, SIG_DFL);
    signal(SIGQUIT, SIG_DFL);
    sigprocmask(SIG_SETMASK, mask, NULL);
    dup2(nothing, STDIN_FILENO);
    dup2(output, STDOUT_FILENO);
    dup2(output, STDERR_FILENO);
    if (channel < 0)
        close(BOX_CHANNEL);
    else if (channel != BOX_CHANNEL)
        dup2(channel, BOX_CHANNEL);
    else
        fcntl(channel, F_SETFD, 0);
    for (int fd = BOX_CHANNEL + 1; fd < 256; fd++)
        close(fd);
    setrlimit(RLIMIT_CPU, &cpu);
    LIMIT(RLIMIT_CORE, 0);
    LIMIT(RLIMIT_FSIZE, l->file);
    LIMIT(RLIMIT_NOFILE, 256);
    if (l->memory) LIMIT(RLIMIT_AS, l->memory);
    execvp(words[0], words);
    fprintf(stderr, "cannot run %s: %s\n", words[0], strerror(errno));
    _exit(127);
}

/* What is too much for the buffer is read, too, lest its writer wait; beyond a million bytes the writer gets SIGPIPE.
 */
static void read_output(box_end *end, int *fd)
{
    char chunk[4096];
    ssize_t got;

    while (*fd >= 0 && (got = read(*fd, chunk, sizeof chunk)) > 0) {
        const size_t room = sizeof end->output - 1 - end->n, taken = (size_t)got < room ? (size_t)got : room;
        memcpy(end->output + end->n, chunk, taken);
        end->n += taken;
        end->printed += (size_t)got;
        if (end->printed < MOST_PRINTED) continue;
        close(*fd);
        *fd = -1;
    }
    end->output[end->n] = '\0';
}

/* The subreaper inherits every orphan: kill and collect until none is left. */
static void kill_the_rest(pid_t group)
{
    if (group) kill(-group, SIGKILL);
    for (int round = 0; round < 1000; round++) {
        FILE *f = fopen("/proc/thread-self/children", "r");
        int pid, n = 0;
        if (f) {
            while (fscanf(f, "%d", &pid) == 1) {
                kill(pid, SIGKILL);
                n++;
            }
            fclose(f);
        }
        while ((pid = waitpid(-1, NULL, n ? 0 : WNOHANG)) > 0)
            n = 0;
        if (pid < 0) return; /* ECHILD */
    }
}

bool box_start(box *b, const box_limits *limits, char *const words[], int channel)
{
    int ends[2];

    *b = (box){.limits = *limits, .begin = box_now()};
    if (pipe2(ends, O_CLOEXEC) != 0) return false;
    prctl(PR_SET_CHILD_SUBREAPER, 1);
    fflush(NULL);
    const sigset_t mask = hold_signals();
    const pid_t child = fork();
    if (child == 0) become(limits, words, ends[1], channel, &mask);
    if (child > 0) running = child;
    sigprocmask(SIG_SETMASK, &mask, NULL);
    close(ends[1]);
    if (channel >= 0) close(channel);
    b->output = ends[0];
    fcntl(ends[0], F_SETFL, O_NONBLOCK);
    if (child < 0) {
        close(ends[0]);
        return false;
    }
    b->child = child;
    return true;
}

bool box_wait(box *b, int fd, short events)
{
    struct pollfd fds[] = {{b->output, POLLIN, 0}, {fd, events, 0}};

    if (b->child == 0 || waitpid(b->child, &b->end.status, WNOHANG) != 0) {
        b->child = 0;
        return false;
    }
    if (box_now() - b->begin > b->limits.wall) {
        b->end.late = true;
        return false;
    }
    poll(fds, 2, 2);
    if (fds[0].revents) read_output(&b->end, &b->output);
    if (fds[0].revents & POLLHUP && b->output >= 0 && !(fds[0].revents & POLLIN)) { /* nothing will come */
        close(b->output);
        b->output = -1;
    }
    return true;
}

void box_finish(box *b)
{
    if (b->child) {
        kill(-b->child, SIGKILL);
        kill(b->child, SIGKILL);
        waitpid(b->child, &b->end.status, 0);
    }
    kill_the_rest(running);
    running = b->child = 0;
    read_output(&b->end, &b->output);
    if (b->output >= 0) close(b->output);
    b->output = -1;
}

bool box_run(box *b, const box_limits *limits, char *const words[])
{
    if (!box_start(b, limits, words, -1)) return false;
    while (box_wait(b, -1, 0))
        continue;
    box_finish(b);
    return true;
}
