/* SPDX-License-Identifier: BSD-2-Clause */
/* image_exr_rgba: the two kinds of OpenEXR files that OpenEXRCore 3.1.5 cannot turn into R, G, B: DWAA and DWAB
 * compression, and luminance with chroma at a quarter of the resolution (Y, RY, BY). OpenEXR's older C interface can,
 * with half precision: both kinds are lossy codings of halves in the first place.
 *
 * That library sits on C++ and trusts headers more than Core does: it is called only after Core has read the whole
 * header and its data window has been held against the file's size. It opens the file by name a second time; that the
 * file is still the same is checked by its data window. Its exceptions end inside of it; we see codes. */
#include "image_io.h"

#include "bis/base/mem.h"

#include <ImfCRgbaFile.h>
#include <stdint.h>

static bool is_same_window(const ImfInputFile *file, const bis_image *image, int x0, int y0)
{
    int x_min, y_min, x_max, y_max;
    ImfHeaderDataWindow(ImfInputHeader(file), &x_min, &y_min, &x_max, &y_max);
    return x_min == x0 && y_min == y0 && x_max - x_min == image->width - 1 && y_max - y_min == image->height - 1;
}

/* The library wants the address that a pixel (0, 0) would have, inside of the window or not. */
static ImfRgba *origin_of(ImfRgba *first, int width, int x0, int y0)
{
    intptr_t offset = (intptr_t)y0 * width + x0;
    return (ImfRgba *)((intptr_t)first - offset * (intptr_t)sizeof *first);
}

bis_status bis_exr_read_rgba(bis_image *image, const image_input *in, int x0, int y0)
{
    bis_status status = BIS_OK;
    const size_t width = (size_t)image->width, n = width * (size_t)image->height;
    ImfInputFile *file = NULL;
    ImfRgba *pixels = bis_alloc(n, sizeof *pixels);

    if (!pixels) {
        status = bis_image_refuse(in, BIS_NOMEM, "no memory for %d x %d pixels", image->width, image->height);
        goto done;
    }
    file = ImfOpenInputFile(in->path);
    if (!file) {
        status = bis_image_refuse(in, BIS_INPUT, "%s", ImfErrorMessage());
        goto done;
    }
    if (!is_same_window(file, image, x0, y0)) {
        status = bis_image_refuse(in, BIS_IO, "the file changed while it was read");
        goto done;
    }
    if (!ImfInputSetFrameBuffer(file, origin_of(pixels, image->width, x0, y0), 1, width) ||
        !ImfInputReadPixels(file, y0, y0 + image->height - 1)) {
        status = bis_image_refuse(in, BIS_INPUT, "%s", ImfErrorMessage());
        goto done;
    }
    for (size_t i = 0; i < n; i++)
        image->pixels[i] = (rgb){ImfHalfToFloat(pixels[i].r), ImfHalfToFloat(pixels[i].g), ImfHalfToFloat(pixels[i].b)};
    for (size_t i = 0; image->alpha && i < n; i++) image->alpha[i] = ImfHalfToFloat(pixels[i].a);
done:
    if (file) ImfCloseInputFile(file);
    bis_free(pixels);
    return status;
}
