/* SPDX-License-Identifier: BSD-2-Clause */
/* image_png: 8 bit sRGB pictures to look at, written by libpng, and colours for textures, read by it. For
 * src/files/image_file.c, and src/flat/flat_image.c, whose pictures stand in a page. */
#pragma once

#include "bis/files/image_file.h"

#include "image_io.h"

#include <stdio.h>

/* bis_png_exposure returns the logarithm to base 2 of what radiance is multiplied by before it becomes sRGB: the
 * picture's own exposure where it has one, else what takes its log-average, weighted by channel "A", to middle grey. */
double bis_png_exposure(const bis_picture *picture);

/* bis_png_write writes a picture with 8 bits a channel. Errors: BIS_NOMEM, BIS_IO. */
bis_status bis_png_write(FILE *stream, const bis_picture *picture, const char *path, bis_diag *diag);

/* bis_png_is_mine returns whether a file is a PNG; bis_png_read reads its colours, as bis_image_read_colours says.
 * Errors: BIS_INPUT, BIS_NOMEM. */
bool bis_png_is_mine(const unsigned char *data, size_t size);
bis_status bis_png_read(bis_image *image, const image_input *in, double gamma);
