/* SPDX-License-Identifier: BSD-2-Clause */
/* png_failure: how libpng gives up, for those who write PNGs (image_png.c) and read them (image_png_read.c): it leaves
 * by longjmp, and what it said stays here. */
#pragma once

#include "bis/base/mem.h"

#include <png.h>
#include <stdbool.h>
#include <stdio.h>

typedef struct png_failure {
    char reason[80]; /* libpng's, when it gave up */
    bool out_of_memory;
} png_failure;

/* png_on_error keeps what libpng says when it gives up, and leaves it. */
static void png_on_error(png_structp png, png_const_charp text)
{
    png_failure *failure = png_get_error_ptr(png);
    snprintf(failure->reason, sizeof failure->reason, "%s", text);
    png_longjmp(png, 1);
}

/* png_on_warning says nothing: what libpng warns of does not change the picture. */
static void png_on_warning(png_structp png, png_const_charp text)
{
    (void)png;
    (void)text;
}

/* png_allocate gives libpng memory by bis/base/mem.h, and remembers if there is none. */
static png_voidp png_allocate(png_structp png, png_alloc_size_t size)
{
    png_failure *failure = png_get_mem_ptr(png);
    void *p = bis_alloc(size, 1);
    if (!p) failure->out_of_memory = true;
    return p;
}

/* png_release frees it. */
static void png_release(png_structp png, png_voidp p)
{
    (void)png;
    bis_free(p);
}
