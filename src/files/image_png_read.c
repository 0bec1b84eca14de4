/* image_png_read: PNG pictures as linear colours, by libpng, for those who compare or convert them; a scene refuses
 * them as maps, because 8 bits for a screen are no radiance.
 *
 * libpng makes 8 bit sRGB of any PNG: of grey, palettes, 16 bit, other gammas; what is transparent lies on black. The
 * picture is allocated only if the file is long enough for it: deflate shrinks at most to a 1032nd, and a row has at
 * least a byte for its filter and a bit for a pixel. */
#include "image_io.h"

#include "bis/base/mem.h"

#include <png.h>
#include <stdint.h>
#include <string.h>

enum { DEFLATE_MOST = 1032 };

bool bis_png_is_mine(const unsigned char *data, size_t size) { return size >= 4 && memcmp(data, "\x89PNG", 4) == 0; }

/* The inverse of the sRGB curve (IEC 61966-2-1). */
static float from_srgb(unsigned char v)
{
    const double s = v / 255.0;
    return (float)(s <= 0.04045 ? s / 12.92 : pow((s + 0.055) / 1.055, 2.4));
}

bis_status bis_png_read(bis_image *image, const image_input *in)
{
    const png_color on_black = {0, 0, 0};
    png_image png = {.version = PNG_IMAGE_VERSION};
    unsigned char *bytes = NULL;
    float linear[256];

    if (!png_image_begin_read_from_memory(&png, in->data, in->size))
        return bis_image_refuse(in, BIS_INPUT, "the PNG is damaged: %s", png.message);
    png.format = PNG_FORMAT_RGB;
    const uint64_t least = (uint64_t)png.height * (1 + ((uint64_t)png.width + 7) / 8) / DEFLATE_MOST;
    bis_status status = least > in->size
                            ? bis_image_refuse(in, BIS_INPUT, "its %zu bytes are too few for %u x %u pixels", in->size,
                                               (unsigned)png.width, (unsigned)png.height)
                            : bis_image_make(image, in, png.width, png.height);
    if (!status) bytes = bis_alloc((size_t)png.width * (size_t)png.height, 3);
    if (!status && !bytes) status = bis_image_refuse(in, BIS_NOMEM, "no memory for its pixels");
    if (!status && !png_image_finish_read(&png, &on_black, bytes, 0, NULL))
        status = bis_image_refuse(in, BIS_INPUT, "the PNG is damaged: %s", png.message);
    png_image_free(&png);
    for (int i = 0; i < 256; i++) linear[i] = from_srgb((unsigned char)i);
    for (size_t i = 0; !status && i < (size_t)image->width * (size_t)image->height; i++)
        image->pixels[i] = (rgb){linear[bytes[3 * i]], linear[bytes[3 * i + 1]], linear[bytes[3 * i + 2]]};
    bis_free(bytes);
    if (status) bis_image_clear(image);
    return status;
}
