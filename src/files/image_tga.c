/* SPDX-License-Identifier: BSD-2-Clause */
/* image_tga: the colours of a Truevision TGA, for textures: grey (of 16 bits: grey and alpha), true colour and
 * palettes, plain or run-length coded.
 *
 * The format has no mark: bis_tga_is_mine believes a header all of whose fields make sense. Rows run upwards unless bit
 * 5 of the descriptor is set, columns to the right unless bit 4 is. What it says of transparency is dropped. Source:
 * Truevision TGA file format specification 2.0 (1991). */
#include "bis/base/mem.h"
#include "image_io.h"

#include <string.h>

enum { HEADER = 18, PALETTE = 1, TRUE_COLOUR = 2, GREY = 3, CODED = 8, FROM_RIGHT = 0x10, FROM_TOP = 0x20 };

typedef struct tga {
    int kind; /* PALETTE, TRUE_COLOUR, GREY */
    bool is_coded;
    int width, height, bits, descriptor;
    int first, n_colours, colour_bits; /* of the palette */
    const unsigned char *palette, *next, *end;
} tga;

static int two_bytes(const unsigned char *p) { return p[0] | p[1] << 8; }

static bool is_colour_size(int bits) { return bits == 15 || bits == 16 || bits == 24 || bits == 32; }

/* The fields of the header. False: they make no sense. */
static bool read_header(tga *t, const unsigned char *d, size_t size)
{
    if (size < HEADER) return false;
    *t = (tga){.kind = d[2] & ~CODED, .is_coded = d[2] & CODED, .width = two_bytes(d + 12), .height = two_bytes(d + 14),
               .bits = d[16], .descriptor = d[17], .first = two_bytes(d + 3), .n_colours = two_bytes(d + 5),
               .colour_bits = d[7]};
    const bool has_palette = d[1] == 1;
    if (d[1] > 1 || t->width == 0 || t->height == 0 || t->descriptor & 0xc0) return false;
    if (has_palette && !is_colour_size(t->colour_bits)) return false;
    if (!has_palette) t->n_colours = 0;
    if (t->kind == PALETTE) return has_palette && t->bits == 8;
    if (t->kind == TRUE_COLOUR) return is_colour_size(t->bits);
    return t->kind == GREY && (t->bits == 8 || t->bits == 16);
}

bool bis_tga_is_mine(const unsigned char *data, size_t size)
{
    tga t;
    return read_header(&t, data, size);
}

/* Blue first; 15 and 16 bits have five for each. */
static void take_colour(unsigned char c[3], const unsigned char *p, int bits)
{
    if (bits >= 24) {
        for (int k = 0; k < 3; k++) c[k] = p[2 - k];
        return;
    }
    const int v = two_bytes(p);
    for (int k = 0; k < 3; k++) {
        const int five = v >> (10 - 5 * k) & 31;
        c[k] = (unsigned char)(five << 3 | five >> 2);
    }
}

/* False: the number of a colour that the palette does not have. */
static bool take_pixel(unsigned char c[3], const tga *t, const unsigned char *p)
{
    if (t->kind == GREY) {
        c[0] = c[1] = c[2] = p[0];
    } else if (t->kind == TRUE_COLOUR) {
        take_colour(c, p, t->bits);
    } else {
        const int i = p[0] - t->first;
        if (i < 0 || i >= t->n_colours) return false;
        take_colour(c, t->palette + (size_t)i * (size_t)((t->colour_bits + 7) / 8), t->colour_bits);
    }
    return true;
}

/* Where pixel i of the file lies. */
static size_t place_of(const tga *t, size_t i)
{
    const size_t width = (size_t)t->width, height = (size_t)t->height;
    const size_t row = i / width, column = i % width;
    const size_t y = t->descriptor & FROM_TOP ? row : height - 1 - row;
    return y * width + (t->descriptor & FROM_RIGHT ? width - 1 - column : column);
}

/* NULL, or what is wrong. */
static const char *read_pixels(bis_image *image, tga *t, const float *table)
{
    const size_t n = (size_t)t->width * (size_t)t->height, bytes = (size_t)((t->bits + 7) / 8);

    for (size_t i = 0; i < n;) {
        size_t run = 1;
        bool repeats = false;
        if (t->is_coded) {
            if (t->next == t->end) return "the file is cut off";
            repeats = *t->next & 0x80;
            run = (size_t)(*t->next++ & 0x7f) + 1;
        }
        if (run > n - i) return "a run goes beyond the last pixel";
        for (size_t k = 0; k < run; k++) {
            unsigned char c[3];
            if ((size_t)(t->end - t->next) < bytes) return "the file is cut off";
            if (!take_pixel(c, t, t->next)) return "a pixel has a colour that is not in the palette";
            image->pixels[place_of(t, i++)] = (rgb){table[c[0]], table[c[1]], table[c[2]]};
            if (!repeats || k + 1 == run) t->next += bytes;
        }
    }
    return NULL;
}

bis_status bis_tga_read(bis_image *image, const image_input *in, double gamma)
{
    tga t;
    float *table = NULL;

    if (!read_header(&t, in->data, in->size)) return bis_image_refuse(in, BIS_INPUT, "the TGA's header makes no sense");
    const size_t before = HEADER + (size_t)in->data[0]; /* a text may stand there */
    const size_t palette = (size_t)t.n_colours * (size_t)((t.colour_bits + 7) / 8);
    if (in->size < before + palette) return bis_image_refuse(in, BIS_INPUT, "the TGA is damaged: the file is cut off");
    t.palette = in->data + before;
    t.next = t.palette + palette;
    t.end = in->data + in->size;
    const size_t bytes = (size_t)((t.bits + 7) / 8), left = (size_t)(t.end - t.next);
    /* a run of 128 pixels takes a byte and one pixel */
    const double most = t.is_coded ? 128.0 * (double)(left / (1 + bytes) + 1) : (double)(left / bytes);
    if ((double)t.width * t.height > most)
        return bis_image_refuse(in, BIS_INPUT, "%zu bytes cannot hold %d x %d pixels", in->size, t.width, t.height);
    bis_status status = bis_image_make(image, in, t.width, t.height);
    if (!status) status = bis_image_table(&table, 8, gamma == BIS_GAMMA_FILE ? BIS_GAMMA_SRGB : gamma, in);
    const char *wrong = status ? NULL : read_pixels(image, &t, table);
    if (wrong) status = bis_image_refuse(in, BIS_INPUT, "the TGA is damaged: %s", wrong);
    if (status) bis_image_clear(image);
    bis_free(table);
    return status;
}
