/* box: run a program that nobody trusts, within limits, and be rid of it for certain: it and whatever it started.
 *
 * The program is in a process group and a session of its own. When it ends, or its time is up, all descendants are
 * killed, those that left the group, too (Linux: PR_SET_CHILD_SUBREAPER), so a forked child that keeps a pipe open
 * keeps nobody waiting. */
#ifndef TESTS_BOX_H
#define TESTS_BOX_H

#include <stdbool.h>
#include <stddef.h>

typedef struct box_limits {
    double cpu, wall; /* seconds of the processor, a process; seconds of the clock, all together */
    size_t memory;    /* bytes of address space a process; 0: as much as there is, which the address sanitizer needs */
    size_t file;      /* bytes a file may grow to */
} box_limits;

typedef struct box_end {
    bool late;         /* the clock ended it */
    int status;        /* as of waitpid */
    size_t n, printed; /* bytes in output; bytes that came */
    char output[8192]; /* the beginning of what came on standard output and standard error, then '\0' */
} box_end;

enum { BOX_CHANNEL = 3 };

/* Run words[], whose last is NULL; standard input is empty. The other end of the SOCK_SEQPACKET socket `channel` (or
 * -1) is BOX_CHANNEL there; hear(state) is called when something came on it. Returns false where nothing could be
 * started. */
bool box_run(box_end *end, const box_limits *limits, char *const words[], int channel[2], void (*hear)(void *state),
             void *state);

/* SIGINT, SIGTERM and SIGHUP end what runs and then this program, by _exit(128 + signal). */
void box_end_with_us(void);

#endif
