/* SPDX-License-Identifier: BSD-2-Clause */
/* image_foreign: what a file is that no reader of ours knows: formats of pictures by their first bytes, and what stands
 * in the place of a picture when a download went wrong. The message names it, and the way out. */
#include "image_png.h"

#include <string.h>

/* way_out NULL: ImageMagick reads it. Source: each format's own specification; PNM: the man pages of Netpbm. */
static const struct foreign {
    size_t at, n;
    const char *mark, *what, *way_out;
} foreigners[] = {
    {0, 4, "GIF8", "a GIF", NULL},
    {8, 4, "WEBP", "a WebP", NULL},
    {0, 4, "II*\0", "a TIFF", NULL},
    {0, 4, "MM\0*", "a TIFF", NULL},
    {0, 4, "II+\0", "a BigTIFF", NULL},
    {4, 8, "ftypavif", "an AVIF", NULL},
    {4, 7, "ftyphei", "a HEIC", NULL},
    {4, 8, "ftypmif1", "a HEIF", NULL},
    {4, 4, "jP  ", "a JPEG 2000", NULL},
    {0, 4, "\xff\x4f\xff\x51", "a JPEG 2000", NULL},
    {4, 4, "JXL ", "a JPEG XL", NULL},
    {0, 2, "\xff\x0a", "a JPEG XL", NULL},
    {0, 4, "8BPS", "a Photoshop file", NULL},
    {0, 4, "DDS ", "a DDS", NULL},
    {0, 4, "qoif", "a QOI", NULL},
    {0, 2, "P3", "a PPM", NULL},
    {0, 2, "P5", "a PGM", NULL},
    {0, 2, "P6", "a PPM", NULL},
    {0, 7, "\xabKTX 11", "a KTX", "KTX-Software makes a PNG of it"},
    {0, 7, "\xabKTX 20", "a KTX2", "`ktx extract` of KTX-Software makes a PNG of it"},
    {0, 23, "version https://git-lfs", "a pointer of git LFS, not the picture",
     "`git lfs pull` in its repository brings the picture"},
    {0, 1, "<", "a text in HTML or XML, as a page in the place of a picture, or an SVG",
     "take the picture itself, as .png"},
};

static const struct foreign *find(const image_input *in)
{
    for (size_t i = 0; i < sizeof foreigners / sizeof *foreigners; i++) {
        const struct foreign *f = &foreigners[i];
        if (in->size >= f->at + f->n && memcmp(in->data + f->at, f->mark, f->n) == 0) return f;
    }
    return NULL;
}

bis_status bis_image_refuse_unknown(const image_input *in, bool of_colours)
{
    const struct foreign *f = find(in);
    const unsigned char *d = in->data;

    if (in->size == 0) return bis_image_refuse(in, BIS_INPUT, "the file is empty");
    if (f && f->way_out) return bis_image_refuse(in, BIS_INPUT, "it is %s: %s", f->what, f->way_out);
    if (f)
        return bis_image_refuse(in, BIS_INPUT, "it is %s, which is not read: `convert NAME NEW.%s` of ImageMagick "
                                "makes one that is", f->what, of_colours ? "png" : "exr");
    if (in->size < 4) return bis_image_refuse(in, BIS_INPUT, "its %zu bytes are too few for an image", in->size);
    if (of_colours)
        return bis_image_refuse(in, BIS_INPUT,
                                "its format is unknown: a texture must be .png, .jpg, .tga, .bmp, .exr, .hdr or .pfm");
    const char *screen = bis_png_is_mine(d, in->size)    ? "PNG"
                         : bis_jpeg_is_mine(d, in->size) ? "JPEG"
                         : bis_bmp_is_mine(d, in->size)  ? "BMP"
                                                         : NULL;
    if (screen)
        return bis_image_refuse(in, BIS_INPUT, "it is a %s: 8 bits for a screen, no radiance; take an .exr, .pfm or "
                                ".hdr (`bis SCENE --outfile NAME.exr` writes one)", screen);
    return bis_image_refuse(in, BIS_INPUT,
                            "it begins with the bytes %02x %02x %02x %02x, must be a Radiance .hdr (#?), "
                            "OpenEXR (76 2f 31 01) or PFM (PF, Pf)",
                            d[0], d[1], d[2], d[3]);
}
