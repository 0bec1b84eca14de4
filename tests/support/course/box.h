/* SPDX-License-Identifier: BSD-2-Clause */
/* box: run a program that nobody trusts, within limits, and be rid of it for certain: it and whatever it started.
 *
 * The program is in a process group and a session of its own. When it ends, or its time is up, all descendants are
 * killed, those that left the group, too (Linux: PR_SET_CHILD_SUBREAPER), so a forked child that keeps a pipe open
 * keeps nobody waiting. */
#ifndef TESTS_BOX_H
#define TESTS_BOX_H

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

typedef struct box_limits {
    double cpu;    /* seconds of the processor, a process */
    double wall;   /* seconds of the clock, all together: generous, because the machine may have other work */
    size_t memory; /* bytes of address space a process; 0: as much as there is, which the address sanitizer needs */
    size_t file;   /* bytes a file may grow to */
} box_limits;

typedef struct box_end {
    bool late;         /* the clock ended it */
    int status;        /* as of waitpid */
    size_t n, printed; /* bytes in output; bytes that came */
    char output[8192]; /* the beginning of what came on standard output and standard error, then '\0' */
} box_end;

/* A program that runs. */
typedef struct box {
    box_end end;
    box_limits limits;
    pid_t child; /* 0: it has ended */
    int output;
    double begin;
} box;

enum { BOX_CHANNEL = 3 };

/* box_start starts words[], whose last is NULL; standard input is empty. The descriptor `channel` (or -1) is
 * BOX_CHANNEL there, and closed here. Returns false where nothing could be started. */
bool box_start(box *b, const box_limits *limits, char *const words[], int channel);

/* box_wait waits until the descriptor fd (or -1) is ready for `events` of poll, the program has ended, or some
 * milliseconds are over; meanwhile it reads what the program prints. Returns whether the program still runs; the limit
 * of the clock ends it. */
bool box_wait(box *b, int fd, short events);

/* box_finish ends the program, if it has not ended, and all that it started. b->end is then complete. A second call
 * does nothing. */
void box_finish(box *b);

/* box_run starts a program, waits for its end and finishes. Returns false where nothing could be started. */
bool box_run(box *b, const box_limits *limits, char *const words[]);

/* box_now returns the seconds of a clock that only goes forward. */
double box_now(void);

/* box_end_with_us: SIGINT, SIGTERM and SIGHUP end what runs and then this program, by _exit(128 + signal). */
void box_end_with_us(void);

#endif
