/* image_pfm: portable float maps. For src/files/image_file.c alone. */
#pragma once

#include "image_io.h"

#include <stdio.h>

bool bis_pfm_is_mine(const unsigned char *data, size_t size);
bis_status bis_pfm_read(bis_image *image, const image_input *in);

/* Errors: BIS_NOMEM; the stream keeps those of the disk. */
bis_status bis_pfm_write(FILE *stream, const bis_picture *picture, const char *path, bis_diag *diag);
