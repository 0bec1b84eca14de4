/* SPDX-License-Identifier: BSD-2-Clause */
/* image: RGB pixels in memory, in linear radiance. bis/files/image_file.h reads and writes them as files. */
#pragma once

#include "bis/base/status.h"
#include "bis/base/vec.h"

/* pixels[height][width], row 0 at the top. The values are those of the file: they may be NaN, infinite or negative.
 * alpha[height][width], by which they are premultiplied; NULL: the image is opaque, or its reader was not asked. */
typedef struct bis_image {
    int width, height;
    rgb *pixels;
    float *alpha;
} bis_image;

/* The largest side that is accepted. 2^15 squared pixels of 12 bytes are 12 GiB. A reader allocates only after it has
 * compared the size in the header with this limit and with the size of the file. */
#define BIS_IMAGE_MAX_SIDE 32768

/* The exponent that stands for the curve of sRGB, where values of a file are turned into linear ones. */
#define BIS_GAMMA_SRGB 0
#define BIS_GAMMA_FILE (-1) /* of a .png: as its gAMA chunk says, else as BIS_GAMMA_SRGB */

/* bis_image_to_linear returns what a number v in [0,1] of a file stands for: v^gamma, or the curve of sRGB
 * (BIS_GAMMA_SRGB). bis_image_from_linear is its inverse. */
double bis_image_to_linear(double v, double gamma);
double bis_image_from_linear(double v, double gamma);

/* bis_image_init allocates width x height black pixels. Errors: BIS_INPUT (a side below 1 or above
 * BIS_IMAGE_MAX_SIDE), BIS_NOMEM. *image is then empty. */
bis_status bis_image_init(bis_image *image, int width, int height, bis_diag *diag);

/* bis_image_add_alpha allocates alpha, all 0. Errors: BIS_NOMEM. */
bis_status bis_image_add_alpha(bis_image *image, bis_diag *diag);

/* bis_image_clear frees the pixels. *image is empty afterwards. */
void bis_image_clear(bis_image *image);

/* One plane to be written. Pixel (x, y) is data[(y * width + x) * stride]. */
typedef struct bis_channel {
    const char *name; /* "R", "G", "B", "A", "stderr.R", ... */
    const float *data;
    int stride; /* in floats */
} bis_channel;
