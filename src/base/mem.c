/* SPDX-License-Identifier: BSD-2-Clause */
/* mem: the one door to the heap.
 *
 * Layout of a block, base being what the C library gave:
 *     base ... | header {base, bytes} | data (64-byte aligned) ... | end
 * Small blocks are placed so that data ends where the C library's block ends: the address sanitizer then sees the first
 * byte written behind them. Large ones come from calloc, which takes them from the kernel as zero pages and does not
 * touch them: a gigabyte of zeros costs a system call. Cost: one header, at most 128 bytes a block. */
#include "bis/base/mem.h"

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum {
    ALIGNMENT = 64,
    LARGE = 1 << 17 /* glibc's calloc leaves the heap for the kernel's zero pages from 128 KiB on */
};

typedef struct header {
    void *base;
    size_t bytes;
} header;

/* The library's only mutable globals: see bis_mem_fail_at, bis_mem_failures and bis_mem_live. */
static atomic_long fail_at, count, failures, live;

void bis_mem_fail_at(long k)
{
    atomic_store(&fail_at, k);
    atomic_store(&count, 0);
}

long bis_mem_count(void) { return atomic_load(&count); }
long bis_mem_failures(void) { return atomic_load(&failures); }
long bis_mem_live(void) { return atomic_load(&live); }

static void *failed(void)
{
    atomic_fetch_add(&failures, 1);
    return NULL;
}

static bool told_to_fail(void)
{
    long k = atomic_fetch_add(&count, 1) + 1;
    return k == atomic_load(&fail_at);
}

static header *header_of(void *p) { return (header *)p - 1; }

/* Data at the first aligned address that leaves room for the header. */
static void *place(void *base, size_t bytes)
{
    uintptr_t shift = ALIGNMENT - (uintptr_t)base % ALIGNMENT;
    if (shift < sizeof(header)) shift += ALIGNMENT;
    void *p = (char *)base + shift;
    *header_of(p) = (header){base, bytes};
    atomic_fetch_add(&live, 1);
    return p;
}

static void *new_block(size_t n, size_t size, bool zeroed)
{
    const size_t room = 2 * ALIGNMENT;
    if (told_to_fail() || (size && n > (PTRDIFF_MAX - room) / size)) return failed();
    size_t bytes = n * size;

    if (zeroed && bytes >= LARGE) {
        void *base = calloc(bytes + room, 1);
        return base ? place(base, bytes) : failed();
    }
    void *base;
    if (posix_memalign(&base, ALIGNMENT, ALIGNMENT + bytes)) return failed();
    void *p = place(base, bytes);
    return zeroed ? memset(p, 0, bytes) : p;
}

void *bis_alloc(size_t n, size_t size) { return new_block(n, size, true); }

void *bis_claim(bis_claims *c, size_t n, size_t size)
{
    c->bytes += n * size;
    if (c->only_count) return NULL;
    void *p = bis_alloc(n, size);
    c->failed |= !p;
    return p;
}

void *bis_realloc(void *p, size_t n, size_t size)
{
    void *grown = new_block(n, size, false);
    if (!grown || !p) return grown;
    size_t old = header_of(p)->bytes, new = n * size;
    memcpy(grown, p, old < new ? old : new);
    bis_free(p);
    return grown;
}

char *bis_strndup(const char *s, size_t n)
{
    size_t length = strnlen(s, n);
    char *copy = new_block(length + 1, 1, false);
    if (!copy) return NULL;
    memcpy(copy, s, length);
    copy[length] = '\0';
    return copy;
}

char *bis_strdup(const char *s) { return bis_strndup(s, strlen(s)); }

void bis_free(void *p)
{
    if (!p) return;
    free(header_of(p)->base);
    atomic_fetch_sub(&live, 1);
}
