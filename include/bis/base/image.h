/* image: RGB pixels in linear radiance, in memory. Files of them are read and written by bis/files/image_file.h. */
#ifndef BIS_IMAGE_H
#define BIS_IMAGE_H

#include "bis/base/status.h"
#include "bis/base/vec.h"

#include <stddef.h>

/* pixels[height][width], row 0 at the top. Values are as in the file: NaN, infinite or negative ones included. */
typedef struct bis_image {
    int width, height;
    rgb *pixels;
} bis_image;

/* The largest side we accept; 2^15 squared pixels of 12 bytes are 12 GiB. Nothing is allocated before a header's size
 * has been held against this and against the file's size. */
#define BIS_IMAGE_MAX_SIDE 32768

/* bis_image_init allocates width x height black pixels. Errors: BIS_INPUT (a side below 1 or above
 * BIS_IMAGE_MAX_SIDE), BIS_NOMEM; *image is then empty. */
bis_status bis_image_init(bis_image *image, int width, int height, bis_diag *diag);

/* bis_image_clear frees the pixels; the image is then empty. */
void bis_image_clear(bis_image *image);

/* One plane to be written: pixels data[(y * width + x) * stride]. */
typedef struct bis_channel {
    const char *name; /* "R", "G", "B", "A", "stderr.R", ... */
    const float *data;
    int stride; /* in floats */
} bis_channel;

#endif
