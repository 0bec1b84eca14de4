/* SPDX-License-Identifier: BSD-2-Clause */
/* image_bmp: the colours of a Windows bitmap, for textures: palettes of 1, 4 and 8 bits, and 24 and 32 bits, plain.
 *
 * Rows are padded to four bytes, and run upwards unless the height is negative. The fourth byte of 32 bits is dropped.
 * Run-length coding and 16 bits are refused, because hardly a file has them. Source: Microsoft, "Bitmap Storage" (the
 * structures BITMAPFILEHEADER, BITMAPINFOHEADER). */
#include "bis/base/mem.h"
#include "image_io.h"

#include <stdint.h>
#include <string.h>

enum { FILE_HEADER = 14, LEAST_HEADER = 40, PLAIN = 0, MASKS = 3 };

typedef struct bmp {
    int32_t width, height; /* height > 0 */
    bool from_top;
    unsigned bits;
    const unsigned char *palette, *pixels; /* palette[n_colours][4] */
    size_t n_colours, row;                 /* bytes of a row */
} bmp;

bool bis_bmp_is_mine(const unsigned char *data, size_t size)
{
    return size >= 2 && memcmp(data, "BM", 2) == 0;
}

static uint32_t four_bytes(const unsigned char *p)
{
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

/* The masks of 32 bits that are bytes in the usual order, blue first. */
static bool has_usual_masks(const image_input *in)
{
    const unsigned char *p = in->data + FILE_HEADER + LEAST_HEADER;
    return in->size >= FILE_HEADER + LEAST_HEADER + 12 && four_bytes(p) == 0xff0000 && four_bytes(p + 4) == 0xff00 &&
           four_bytes(p + 8) == 0xff;
}

/* NULL, or what is wrong. */
static const char *read_header(bmp *b, const image_input *in)
{
    const unsigned char *d = in->data, *h = d + FILE_HEADER;

    if (in->size < FILE_HEADER + LEAST_HEADER) return "the file is cut off";
    const uint32_t first = four_bytes(d + 10), size = four_bytes(h), coding = four_bytes(h + 16);
    const int32_t height = (int32_t)four_bytes(h + 8);
    *b = (bmp){.width = (int32_t)four_bytes(h + 4), .height = height < 0 ? (int32_t)-(int64_t)height : height,
               .from_top = height < 0, .bits = (unsigned)h[14] | (unsigned)h[15] << 8};
    if (size < LEAST_HEADER || size > in->size - FILE_HEADER) return "its header is damaged, or older than Windows 3";
    const bool fits = b->bits == 1 || b->bits == 4 || b->bits == 8 || b->bits == 24 || b->bits == 32;
    if (!fits || (coding != PLAIN && !(coding == MASKS && b->bits == 32 && has_usual_masks(in))))
        return "only plain files of 1, 4, 8, 24 and 32 bits are read: save it as PNG";
    if (b->width < 1 || b->height < 1) return "it has no pixels";
    if (b->bits <= 8) {
        const uint32_t said = four_bytes(h + 32);
        b->n_colours = said && said < 1u << b->bits ? said : (size_t)1 << b->bits;
        b->palette = h + size;
        if (in->size - FILE_HEADER - size < 4 * b->n_colours) return "the file is cut off";
    }
    b->row = ((size_t)b->width * b->bits + 31) / 32 * 4;
    if (first > in->size || (in->size - first) / b->row < (size_t)b->height) return "the file is cut off";
    b->pixels = d + first;
    return NULL;
}

/* Blue first; NULL: a colour that the palette does not have. */
static const unsigned char *pixel_at(const bmp *b, const unsigned char *row, size_t x)
{
    if (b->bits >= 24) return row + x * (b->bits / 8);
    const size_t bit = x * b->bits;
    const unsigned i = (unsigned)row[bit / 8] >> (8 - b->bits - bit % 8) & ((1u << b->bits) - 1);
    return i < b->n_colours ? b->palette + 4 * (size_t)i : NULL;
}

static const char *read_pixels(bis_image *image, const bmp *b, const float *table)
{
    const size_t width = (size_t)b->width, height = (size_t)b->height;

    for (size_t y = 0; y < height; y++)
        for (size_t x = 0; x < width; x++) {
            const unsigned char *c = pixel_at(b, b->pixels + (b->from_top ? y : height - 1 - y) * b->row, x);
            if (!c) return "a pixel has a colour that is not in the palette";
            image->pixels[y * width + x] = (rgb){table[c[2]], table[c[1]], table[c[0]]};
        }
    return NULL;
}

bis_status bis_bmp_read(bis_image *image, const image_input *in, double gamma)
{
    bmp b;
    float *table = NULL;
    const char *wrong = read_header(&b, in);

    if (wrong) return bis_image_refuse(in, BIS_INPUT, "the BMP: %s", wrong);
    bis_status status = bis_image_make(image, in, b.width, b.height);
    if (!status) status = bis_image_table(&table, 8, gamma == BIS_GAMMA_FILE ? BIS_GAMMA_SRGB : gamma, in);
    wrong = status ? NULL : read_pixels(image, &b, table);
    if (wrong) status = bis_image_refuse(in, BIS_INPUT, "the BMP: %s", wrong);
    if (status) bis_image_clear(image);
    bis_free(table);
    return status;
}
