/* image_exr: OpenEXR. For src/files/image_file.c alone (and image_exr_*.c among themselves). */
#pragma once

#include "image_io.h"

#include <stdio.h>

bool bis_exr_is_mine(const unsigned char *data, size_t size);
bis_status bis_exr_read(bis_image *image, const image_input *in);

/* Errors: BIS_INPUT (the name of an attribute that OpenEXR reserves), BIS_NOMEM, BIS_IO. */
bis_status bis_exr_write(FILE *stream, const bis_picture *picture, const char *path, bis_diag *diag);
