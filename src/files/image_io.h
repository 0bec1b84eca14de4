/* image_io: what the readers of .hdr, .exr and .pfm share. For src/files/image*.c alone. */
#pragma once

#include "bis/files/image_file.h"

/* A whole file in memory, with one zero byte behind it, and where to complain. */
typedef struct image_input {
    const unsigned char *data;
    size_t size;
    const char *path;
    bis_loc at; /* the scene line that named the file, else the file itself */
    bis_diag *diag;
} image_input;

/* The error `cannot read "PATH": TEXT`; returns code. */
bis_status bis_image_refuse(const image_input *in, bis_status code, const char *fmt, ...) BIS_PRINTF(3, 4);

/* The warning `"PATH": TEXT`. */
void bis_image_remark(const image_input *in, const char *fmt, ...) BIS_PRINTF(2, 3);

/* Allocate *image after its size was held against BIS_IMAGE_MAX_SIDE; the caller has held it against the file's size.
 * Errors: BIS_INPUT, BIS_NOMEM. */
bis_status bis_image_make(bis_image *image, const image_input *in, long long width, long long height);
