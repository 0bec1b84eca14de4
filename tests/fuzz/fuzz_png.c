/* fuzz_png: pictures for a screen, as bis compare and bis convert read them. */
#include "bis/files/image_file.h"
#include "input.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    bis_diag diag = {0};
    bis_image image;
    bool is_screen;
    const bis_status status = bis_image_read_any(&image, &is_screen, fuzz_file(data, size), (bis_loc){0}, &diag);

    fuzz_check_diag(status, &diag);
    fuzz_require((status == BIS_OK) == (image.pixels != NULL), "all of the image or none");
    for (size_t i = 0; !status && is_screen && i < (size_t)image.width * (size_t)image.height; i++)
        fuzz_require(image.pixels[i].r >= 0 && image.pixels[i].g <= 1 && image.pixels[i].b <= 1, "colours of a screen");
    bis_image_clear(&image);
    bis_diag_clear(&diag);
    return 0;
}
