/* mark_run: one claim of a program of claims (tests/support/mark.h), judged from outside, by a process that has no
 * student's code in it.
 *
 * The claim's process holds a socket. On it come, first, the secret of the run (which hidden seeds and sizes are made
 * of) and a key. It answers when the check has returned, is given a random number then, and must send the number that
 * the two make (mark_proof). A process that ends before its check does cannot. Whatever it prints is a remark at most.
 */
#ifndef TESTS_MARK_RUN_H
#define TESTS_MARK_RUN_H

#include "box.h"

#include <stdint.h>

typedef struct mark_order {
    const char *const *before; /* the words of a sandbox, up to a NULL; NULL: none */
    const char *program;
    size_t claim;    /* its number, or MARK_WORK: the load whose time is compared */
    uint64_t secret; /* 0: seeds and sizes of the starter kit */
    box_limits limits;
} mark_order;

#define MARK_WORK ((size_t)-1)

typedef enum mark_verdict { MARK_HOLDS, MARK_WRONG, MARK_DIED } mark_verdict;

typedef struct mark_outcome {
    mark_verdict verdict;
    double seconds;  /* of the processor, that check or load took */
    char text[4096]; /* why not; with what the program printed, unless it holds */
} mark_outcome;

void mark_judge(mark_outcome *o, const mark_order *order);

/* 20 s of the processor for a claim (BIS_CLAIM_SECONDS overrides), six times that by the clock. */
box_limits mark_limits(void);

/* What both ends of the socket know. */
typedef struct mark_greeting {
    uint64_t secret, key;
} mark_greeting;
typedef struct mark_message {
    enum { MARK_SAYS_DONE = 1, MARK_SAYS_WRONG, MARK_SAYS_PROOF } kind;
    double seconds;
    uint64_t proof;
    char text[2000];
} mark_message;

uint64_t mark_mix(uint64_t x); /* a bijection: the end of splitmix64 */
uint64_t mark_proof(uint64_t key, uint64_t number);

/* From the system; never 0. */
uint64_t mark_random(void);

/* The process's exit status after a check that holds: not 0, which a student's exit(0) would give. */
enum { MARK_STATUS_HOLDS = 8, MARK_STATUS_WRONG = 9 };

#endif
