/* SPDX-License-Identifier: BSD-2-Clause */
/* image: pictures in files, and how far one is from another, on arrays. The rules of bis/flat/flat.h hold. Pixels are
 * linear radiance, row 0 at the top. */
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

/* bis_flat_image_pixels stores pixels[height][width][3]. */
void bis_flat_image_pixels(const bis_flat_image *image, float *pixels);

/* bis_flat_image_save writes pixels[height][width][3] in the format of the ending of path: .exr (float32), .pfm, .hdr,
 * .png. An .exr and a .png have alpha (may be NULL), alpha[height][width], by which pixels are premultiplied. A .png
 * has the exposure, in EV; NaN: that of its own log-average. An .exr has the attributes (may be NULL), a list of
 * "name=text" that ends with NULL. Errors: those of bis_image_write, BIS_INPUT (a size, an attribute). */
int bis_flat_image_save(const char *path, int width, int height, const float *pixels, const float *alpha,
                        double exposure, const char *const *attributes, char *say, size_t size);

/* bis_flat_image_png makes a PNG of pixels[height][width][3] in bytes[room], of which *length are used, with the
 * exposure in EV. Errors: BIS_INPUT (a size, too little room), BIS_NOMEM. */
int bis_flat_image_png(int width, int height, const float *pixels, double exposure, size_t room, uint8_t *bytes,
                       size_t *length, char *say, size_t size);

/* bis_flat_image_exposure stores *exposure in EV of a .png of pixels[height][width][3]: what takes its log-average to
 * middle grey. coverage (may be NULL: all weigh alike), coverage[height][width] in [0,1], is the weight of each pixel.
 * Errors: BIS_INPUT (a size), BIS_NOMEM. */
int bis_flat_image_exposure(double *exposure, int width, int height, const float *pixels, const float *coverage,
                            char *say, size_t size);

/* So many figures has bis_flat_image_compare. */
enum { BIS_FLAT_COMPARED = 9 };

/* bis_flat_image_compare stores figures[BIS_FLAT_COMPARED] as `bis compare` of a[height][width][3] with the reference
 * b[height][width][3]: mean_a, mean_b, bias, bias_se,
 * rmse, relmse, max_abs, the number of pixels that were compared, and that of those left out because they are not
 * finite. Errors: BIS_INPUT (a size), BIS_NOMEM. */
int bis_flat_image_compare(double *figures, int width, int height, const float *a, const float *b, char *say,
                           size_t size);

/* bis_flat_image_errors stores in colours[height][width][3] the false colours of `bis compare --diff` of
 * a[height][width][3] and b[height][width][3]. Errors: BIS_INPUT (a size), BIS_NOMEM. */
int bis_flat_image_errors(float *colours, int width, int height, const float *a, const float *b, char *say,
                          size_t size);

/* bis_flat_image_of_light makes an image of a map in another mapping (bis_mapping_names); width is that of the image,
 * 0: as many pixels around the sphere as the map has. What lies outside a disc or a cross is black. power[2] receives
 * the integrals of r+g+b over the sphere before and after. Errors: BIS_INPUT (the mapping, a width that it cannot
 * have), BIS_NOMEM. */
int bis_flat_image_of_light(bis_flat_image **image, const bis_light *light, const char *mapping, int width,
                            double *power, char *say, size_t size);
