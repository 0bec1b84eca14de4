/* mem: the one door to the heap, so that a test can make the k-th allocation fail (k = 1, 2, ... until a load works).
 *
 * Sizes are checked for overflow before they are multiplied. Memory is freed with bis_free by whoever made it. */
#ifndef BIS_MEM_H
#define BIS_MEM_H

#include <stddef.h>

/* n items of size bytes, zeroed, aligned to 64 bytes; NULL when n*size overflows or memory is short. n*size = 0 gives
 * a valid pointer. Large blocks come as untouched zero pages, so zeroing them costs nothing until they are used. */
void *bis_alloc(size_t n, size_t size);

/* Grow or shrink a block of bis_alloc; the old block survives a failure. New bytes are undefined. p may be NULL. */
void *bis_realloc(void *p, size_t n, size_t size);

/* A copy of the string (or of its first n bytes, plus a zero); NULL without memory. */
char *bis_strdup(const char *s);
char *bis_strndup(const char *s, size_t n);

/* NULL is fine. */
void bis_free(void *p);

/* Test hook: the k-th allocation from now (1: the next one) fails, once; 0 turns it off. The only mutable global of
 * the library, atomic, and read at each allocation only: nothing allocates while rendering. */
void bis_mem_fail_at(long k);

/* The allocations made since the last bis_mem_fail_at call: tells a test when k has passed the last one. */
long bis_mem_count(void);

/* The allocations that ever failed, told to or not. For callers of a library that allocates through us and does not say
 * why it gave up. */
long bis_mem_failures(void);

/* The blocks that are not freed yet. 0 when a program ends: every test program checks that (tests/every.c), and bis
 * itself. */
long bis_mem_live(void);

#endif
