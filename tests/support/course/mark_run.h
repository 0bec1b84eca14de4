/* SPDX-License-Identifier: BSD-2-Clause */
/* mark_run: one claim of a program of claims (mark.h), judged in a process of its own, which asks a
 * student's process. Three processes: who asks for the mark, the claim, and the student's code. */
#ifndef TESTS_MARK_RUN_H
#define TESTS_MARK_RUN_H

#include "box.h"

#include <stdint.h>

typedef struct mark_order {
    const char *judge;          /* the program of claims */
    const char *const *student; /* the words that start the student's process, up to a NULL */
    size_t claim;               /* its number, or MARK_WORK: the load whose time is compared */
    uint64_t secret;            /* 0: seeds and sizes of the starter kit */
    double cpu;                 /* seconds of the processor for the student's process */
    bool sanitized;             /* it is: it takes as much address space as there is */
} mark_order;

#define MARK_WORK ((size_t)-1)

typedef enum mark_verdict { MARK_HOLDS, MARK_WRONG, MARK_DIED, MARK_SLOW, MARK_BUSY } mark_verdict;

typedef struct mark_outcome {
    mark_verdict verdict; /* MARK_DIED: the student's process ended; MARK_SLOW: it was ended, without an answer;
                           * MARK_BUSY: the machine gave it no time, so nothing is known of it */
    double seconds;       /* of the processor, that the student's process took for the load */
    char text[4096];      /* why not, with the beginning of what the student's code printed; or a note (mark.h) */
} mark_outcome;

/* mark_judge judges a claim. */
void mark_judge(mark_outcome *o, const mark_order *order);

/* mark_seconds returns the seconds of the processor for a claim: 20, or BIS_CLAIM_SECONDS. */
double mark_seconds(void);

/* mark_claim_main is a claim's process: `words` are what mark_judge has written behind --claim or --work. It starts the
 * student's process, calls check, and ends with one of the statuses below; what it prints is the outcome's text. */
_Noreturn void mark_claim_main(char *const words[], void (*check)(void));
enum { MARK_STATUS = 8 }; /* and a mark_verdict */

/* mark_conclude ends a claim's process. */
_Noreturn void mark_conclude(mark_verdict verdict, const char *why);

/* mark_secret returns the secret that the claim's process was given. */
uint64_t mark_secret(void);

uint64_t mark_mix(uint64_t x); /* a bijection: the end of splitmix64 */

#endif
