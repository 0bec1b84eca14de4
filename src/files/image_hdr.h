/* image_hdr: Radiance .hdr pictures. For src/files/image_file.c alone. */
#pragma once

#include "image_io.h"

#include <stdio.h>

bool bis_hdr_is_mine(const unsigned char *data, size_t size);
bis_status bis_hdr_read(bis_image *image, const image_input *in);

/* Can an .hdr hold every R, G, B of the picture? Else BIS_INPUT, naming the first that it cannot. */
bis_status bis_hdr_check(const bis_picture *picture, const char *path, bis_diag *diag);

/* A picture that passed bis_hdr_check. Errors: BIS_NOMEM; the stream keeps those of the disk. */
bis_status bis_hdr_write(FILE *stream, const bis_picture *picture, const char *path, bis_diag *diag);
