/* SPDX-License-Identifier: BSD-2-Clause */
/* fuzz_png: the colours of textures: PNG, JPEG, TGA, BMP. The reader goes by the first bytes, so maps' formats are
 * within reach, too. */
#include "bis/files/image_file.h"
#include "input.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    bis_diag diag = {0};
    bis_image image;
    const bis_status status =
        bis_image_read_colours(&image, fuzz_file(data, size), BIS_GAMMA_SRGB, (bis_loc){0}, &diag);

    fuzz_check_diag(status, &diag);
    fuzz_require((status == BIS_OK) == (image.pixels != NULL), "all of the image or none");
    volatile float sum = 0;
    for (size_t i = 0; !status && i < (size_t)image.width * (size_t)image.height; i++) sum = sum + image.pixels[i].b;
    bis_image_clear(&image);
    bis_diag_clear(&diag);
    return 0;
}
