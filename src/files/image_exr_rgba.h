/* image_exr_rgba: OpenEXR's older reader. For src/files/image_exr.c alone. */
#pragma once

#include "image_io.h"

/* Read the first part's R, G, B, or Y, RY, BY, with half precision. (x0, y0): the corner of the data window, which the
 * image, already made, fills; OpenEXRCore has read it from the same header. Errors: BIS_INPUT, BIS_NOMEM. */
bis_status bis_exr_read_rgba(bis_image *image, const image_input *in, int x0, int y0);
