/* SPDX-License-Identifier: BSD-2-Clause */
/* mem: all heap memory is allocated here, so that a test can make the k-th allocation fail (k = 1, 2, ... until a
 * load works).
 *
 * Sizes are checked for overflow before they are multiplied. Whoever allocates a block frees it with bis_free. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* bis_alloc returns n items of `size` bytes, zeroed and aligned to 64 bytes. Returns NULL if n*size overflows or
 * memory is short. n*size = 0 gives a valid pointer. The system delivers large blocks as zero pages, so zeroing them
 * costs nothing until they are used. */
void *bis_alloc(size_t n, size_t size);

/* bis_realloc grows or shrinks a block of bis_alloc to n items of `size` bytes; p may be NULL. New bytes are
 * undefined. Returns NULL on failure; the old block then still exists. */
void *bis_realloc(void *p, size_t n, size_t size);

/* The blocks that one thing holds. A function that claims them one by one serves twice: it allocates them, or with
 * only_count it says how many bytes they would take. */
typedef struct bis_claims {
    size_t bytes;    /* claimed so far */
    bool only_count; /* nothing is allocated */
    bool failed;     /* a block could not be allocated */
} bis_claims;

/* bis_claim adds n items of `size` bytes to the claims and returns them as bis_alloc does. Returns NULL if only_count,
 * or if memory is short; c->failed is then true. */
void *bis_claim(bis_claims *c, size_t n, size_t size);

/* bis_strdup returns a copy of the string, or NULL without memory. */
char *bis_strdup(const char *s);

/* bis_strndup returns a copy of the first n bytes of the string with a zero after them, or NULL without memory. */
char *bis_strndup(const char *s, size_t n);

/* bis_free frees a block; NULL is allowed. */
void bis_free(void *p);

/* bis_mem_fail_at makes the k-th allocation from now fail, once (k = 1: the next one); 0 turns this off. For tests.
 * Its counters are the only mutable globals of the library outside the command line. They are atomic and are used
 * only by allocations, and nothing allocates while rendering. */
void bis_mem_fail_at(long k);

/* bis_mem_count returns the number of allocations since the last call of bis_mem_fail_at. With it a test sees that k
 * has passed the last allocation. */
long bis_mem_count(void);

/* bis_mem_failures returns the number of allocations that have ever failed, for whatever reason. It is for callers of
 * a library that allocates through this module and does not say why it gave up. */
long bis_mem_failures(void);

/* bis_mem_live returns the number of blocks that are not freed yet. It is 0 when a program ends: every test program
 * checks that (tests/support/every.c), and so does bis itself. */
long bis_mem_live(void);
