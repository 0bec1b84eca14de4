/* SPDX-License-Identifier: BSD-2-Clause */
/* image: pictures in files, and how far one is from another, on arrays. The rules of bis/flat/flat.h hold. pixels are
 * float[height][width][3], linear radiance, row 0 at the top. */
#pragma once

#include "bis/flat/flat.h"

typedef struct bis_flat_image bis_flat_image;

/* bis_flat_image_read reads an .exr, .hdr or .pfm. Errors: those of bis_image_read, BIS_NOMEM. */
int bis_flat_image_read(bis_flat_image **image, const char *path, char *say, size_t size);

/* bis_flat_image_close frees the image; NULL is allowed. */
void bis_flat_image_close(bis_flat_image *image);

/* bis_flat_image_place stores where the pixels lie: width and height in shape[2], and in place[4] the column and the
 * row of the first one, and width and height of the picture that they are a part of. */
void bis_flat_image_place(const bis_flat_image *image, int shape[2], int place[4]);

/* bis_flat_image_pixels stores the pixels. */
void bis_flat_image_pixels(const bis_flat_image *image, float *pixels);

/* bis_flat_image_save writes pixels in the format of the ending of path: .exr (float32), .pfm, .hdr, .png. A .png has
 * the exposure, in EV; NaN: that of its own log-average. Errors: those of bis_image_write, BIS_INPUT (a size). */
int bis_flat_image_save(const char *path, int width, int height, const float *pixels, double exposure, char *say,
                        size_t size);

/* bis_flat_image_exposure stores the exposure in EV of a .png of pixels: what takes its log-average to middle grey.
 * coverage[height][width] in [0,1] is the weight of each pixel; NULL: all weigh alike. Errors: BIS_INPUT (a size),
 * BIS_NOMEM. */
int bis_flat_image_exposure(double *exposure, int width, int height, const float *pixels, const float *coverage,
                            char *say, size_t size);

/* So many figures has bis_flat_image_compare. */
enum { BIS_FLAT_COMPARED = 9 };

/* bis_flat_image_compare stores the figures of `bis compare` of a with the reference b: mean_a, mean_b, bias, bias_se,
 * rmse, relmse, max_abs, the number of pixels that were compared, and that of those left out because they are not
 * finite. Errors: BIS_INPUT (a size), BIS_NOMEM. */
int bis_flat_image_compare(double *figures, int width, int height, const float *a, const float *b, char *say,
                           size_t size);

/* bis_flat_image_errors stores the false colours of `bis compare --diff`. Errors: BIS_INPUT (a size), BIS_NOMEM. */
int bis_flat_image_errors(float *colours, int width, int height, const float *a, const float *b, char *say,
                          size_t size);
