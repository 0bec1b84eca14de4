/* SPDX-License-Identifier: BSD-2-Clause */
/* image_io: what the readers of .hdr, .exr and .pfm share: messages that name the file, the one allocation whose
 * size comes from a file, and the curve of a screen. */
#include "image_io.h"

#include "bis/base/mem.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

/* Longer than any of our texts; a file's own words (names of channels) are cut to fit where they are quoted. */
#define TEXT_SIZE 512

static void format(char text[TEXT_SIZE], const char *fmt, va_list args) BIS_PRINTF(2, 0);

/* What a damaged file calls its channels must not reach a terminal: '?' for all but printable ASCII. */
static void format(char text[TEXT_SIZE], const char *fmt, va_list args)
{
    vsnprintf(text, TEXT_SIZE, fmt, args);
    for (; *text; text++)
        if (*text < ' ' || *text > '~') *text = '?';
}

bis_status bis_image_refuse(const image_input *in, bis_status code, const char *fmt, ...)
{
    char text[TEXT_SIZE];
    va_list args;
    va_start(args, fmt);
    format(text, fmt, args);
    va_end(args);
    return bis_error(in->diag, code, in->at, "cannot read \"%s\": %s", in->path, text);
}

void bis_image_remark(const image_input *in, const char *fmt, ...)
{
    char text[TEXT_SIZE];
    va_list args;
    va_start(args, fmt);
    format(text, fmt, args);
    va_end(args);
    bis_warn(in->diag, in->at, "\"%s\": %s", in->path, text);
}

bis_status bis_image_make(bis_image *image, const image_input *in, long long width, long long height)
{
    if (width < 1 || height < 1 || width > BIS_IMAGE_MAX_SIDE || height > BIS_IMAGE_MAX_SIDE)
        return bis_image_refuse(in, BIS_INPUT, "its size is %lld x %lld, a side must be 1 to %d pixels", width, height,
                                BIS_IMAGE_MAX_SIDE);
    if (bis_image_init(image, (int)width, (int)height, NULL))
        return bis_image_refuse(in, BIS_NOMEM, "no memory for %lld x %lld pixels", width, height);
    return BIS_OK;
}

bis_status bis_image_table(float **table, int depth, double gamma, const image_input *in)
{
    const size_t n = (size_t)1 << depth;

    *table = bis_alloc(n, sizeof **table);
    if (!*table) return bis_image_refuse(in, BIS_NOMEM, "no memory for a table of %zu colours", n);
    for (size_t i = 0; i < n; i++) (*table)[i] = (float)bis_image_to_linear((double)i / (double)(n - 1), gamma);
    return BIS_OK;
}
