/* SPDX-License-Identifier: BSD-2-Clause */
/* image_screen: pictures of a screen as textures: JPEGs, which libjpeg writes here, and TGAs and BMPs, which are
 * written by hand. */
#include "bis/files/image_file.h"
#include "bis/base/mem.h"
#include "claim.h"
#include "image_help.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* IEC 61966-2-1 */
static double linear(double v) { return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4); }

static bis_status read_bytes_as(bis_image *image, const char *name, const void *data, size_t n, char said[512])
{
    bis_diag diag = {0};
    store(scratch(name), data, n);
    keep_as_seed(scratch(name));
    const bis_status status = bis_image_read_colours(image, scratch(name), BIS_GAMMA_SRGB, (bis_loc){0}, &diag);
    snprintf(said, 512, "%s", diag.n ? diag.messages[0].text : "");
    assert_true((status == BIS_OK) == (image->pixels != NULL));
    bis_diag_clear(&diag);
    return status;
}

static void refuse(const char *name, const void *data, size_t n, const char *message)
{
    char said[512];
    bis_image image;
    assert_int_equal(read_bytes_as(&image, name, data, n, said), BIS_INPUT);
    if (!strstr(said, message)) fail_msg("%s, not %s", said, message);
}

/* ---- TGA ---- */

/* Each makes the picture red, green / blue, grey 51 in reading order, in its own way. */
static const struct {
    const char *what;
    size_t n;
    unsigned char bytes[80];
    double tolerance; /* in codes of 255 */
} tgas[] = {
    {"24 bits, upwards", 30, {0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 2, 0, 24, 0, 255, 0, 0, 51, 51, 51, 0, 0, 255,
     0, 255, 0}, 0},
    {"32 bits, from the top, with a text", 37,
     {3, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 2, 0, 32, 0x28, 'b', 'i', 's', 0, 0, 255, 0, 0, 255, 0, 0, 255, 0, 0, 9,
      51, 51, 51, 9}, 0},
    {"from the right", 30, {0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 2, 0, 24, 0x30, 0, 255, 0, 0, 0, 255, 51, 51, 51,
     255, 0, 0}, 0},
    {"coded", 32, {0, 0, 10, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 2, 0, 24, 0x20, 0x80, 0, 0, 255, 2, 0, 255, 0, 255, 0, 0,
     51, 51, 51}, 0},
    {"a palette that begins at 5", 34,
     {0, 1, 1, 5, 0, 4, 0, 24, 0, 0, 0, 0, 2, 0, 2, 0, 8, 0x20, 0, 0, 255, 0, 255, 0, 255, 0, 0, 51, 51, 51, 5, 6, 7,
      8}, 0},
    {"15 bits", 26, {0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 2, 0, 15, 0x20, 0, 0x7c, 0xe0, 3, 0x1f, 0, 0xc6, 0x18},
     2},
};

static void assert_colours(const bis_image *image, const char *what, double tolerance)
{
    static const int expected[4][3] = {{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {51, 51, 51}};
    assert_true(image->width == 2 && image->height == 2);
    for (int k = 0; k < 12; k++) {
        const double v = (double)(&image->pixels->r)[k], e = expected[k / 3][k % 3];
        const double least = linear(fmax(0, e - tolerance) / 255), most = linear(fmin(255, e + tolerance) / 255);
        if (v < least - 1e-6 || v > most + 1e-6) fail_msg("%s: value %d is %g, not %g", what, k, v, least);
    }
}

static void each_kind_of_tga_has_its_colours(void **state)
{
    char said[512];
    for (size_t i = 0; i < sizeof tgas / sizeof *tgas; i++) {
        bis_image image;
        if (read_bytes_as(&image, "a.tga", tgas[i].bytes, tgas[i].n, said)) fail_msg("%s: %s", tgas[i].what, said);
        assert_colours(&image, tgas[i].what, tgas[i].tolerance);
        bis_image_clear(&image);
    }
    /* grey, and a run of two */
    static const unsigned char grey[] = {0, 0, 11, 0, 0, 0, 0, 0, 0, 0, 0, 0, 3, 0, 1, 0, 8, 0, 0x81, 51, 0, 255};
    bis_image image;
    assert_int_equal(read_bytes_as(&image, "a.tga", grey, sizeof grey, said), BIS_OK);
    for (int x = 0; x < 3; x++) assert_true(fabs((double)image.pixels[x].g - linear((x < 2 ? 51 : 255) / 255.)) < 1e-6);
    bis_image_clear(&image);
}

/* A header of 18 bytes. */
static void put_tga(bytes *b, int kind, int width, int height, int bits, int descriptor)
{
    *b = (bytes){0};
    put_int(b, (uint64_t)kind << 16, 3);
    put_int(b, 0, 9);
    put_int(b, (uint64_t)width, 2);
    put_int(b, (uint64_t)height, 2);
    put_int(b, (uint64_t)bits, 1);
    put_int(b, (uint64_t)descriptor, 1);
}

/* What the colours of a file are, 255 of them the whole. */
static void expect_codes(const char *name, const bytes *b, int width, int height, const unsigned char (*codes)[3])
{
    char said[512];
    bis_image image;
    if (read_bytes_as(&image, name, b->data, b->n, said)) fail_msg("%s", said);
    assert_true(image.width == width && image.height == height);
    for (int i = 0; i < width * height; i++)
        for (int k = 0; k < 3; k++) {
            const double v = (double)(&image.pixels[i].r)[k], e = linear(codes[i][k] / 255.);
            if (fabs(v - e) > 1e-6) fail_msg("%s: channel %d of pixel %d is %g, not %g", name, k, i, v, e);
        }
    bis_image_clear(&image);
}

/* 3 x 2 pixels, whose colours are their numbers in the file, by the two bits of the descriptor: where the first is. */
static void each_corner_may_be_the_first_of_a_tga(void **state)
{
    for (int corner = 0; corner < 4; corner++) {
        unsigned char codes[6][3];
        bytes b;
        put_tga(&b, 3, 3, 2, 8, corner << 4);
        for (int i = 0; i < 6; i++) {
            const int x = corner & 1 ? 2 - i % 3 : i % 3, y = corner & 2 ? i / 3 : 1 - i / 3;
            put_int(&b, (uint64_t)(40 * i), 1);
            for (int k = 0; k < 3; k++) codes[3 * y + x][k] = (unsigned char)(40 * i);
        }
        expect_codes("corner.tga", &b, 3, 2, codes);
        bytes_clear(&b);
    }
}

/* Five bits v of a colour are its upper ones, and its lower three the upper three of v. As pixels and as a palette, of
 * 15 and of 16 bits, whose highest says nothing of the colour. */
static void five_bits_of_a_tga_are_spread_over_eight(void **state)
{
    for (int way = 0; way < 4; way++) {
        const int bits = 15 + way % 2;
        const bool is_palette = way >= 2;
        unsigned char codes[32][3];
        bytes b;
        put_tga(&b, is_palette ? 1 : 2, 32, 1, is_palette ? 8 : bits, 0x20);
        if (is_palette) memcpy(b.data, (const unsigned char[]){0, 1, 1, 0, 0, 32, 0, (unsigned char)bits}, 8);
        for (int i = 0; i < 32; i++) {
            const int five[3] = {i, 31 - i, 7 * i % 32};
            put_int(&b, (uint64_t)(32768 * (i % 2) + 1024 * five[0] + 32 * five[1] + five[2]), 2);
            for (int k = 0; k < 3; k++) codes[i][k] = (unsigned char)(8 * five[k] + five[k] / 4);
        }
        for (int i = 0; is_palette && i < 32; i++) put_int(&b, (uint64_t)i, 1);
        expect_codes("five.tga", &b, 32, 1, codes);
        bytes_clear(&b);
    }
}

/* Runs of 128 and packets of 128, over the ends of rows. */
static void long_runs_of_a_tga_go_over_rows(void **state)
{
    static unsigned char codes[300][3];
    bytes b;
    put_tga(&b, 10, 100, 3, 24, 0x20);
    put(&b, "\xff\1\2\3\x7f", 5);
    for (int i = 0; i < 300; i++) {
        const unsigned char *const c = i < 128 ? (const unsigned char[]){3, 2, 1} :
                                       i < 256 ? (const unsigned char[]){(unsigned char)i, 7, (unsigned char)(i / 2)} :
                                                 (const unsigned char[]){5, 4, 6};
        memcpy(codes[i], c, 3);
        if (i >= 128 && i < 256) put(&b, (const unsigned char[]){c[2], c[1], c[0]}, 3);
    }
    put(&b, "\xab\6\4\5", 4); /* 44 of them */
    expect_codes("runs.tga", &b, 100, 3, codes);
    b.data[b.n - 4]++;
    refuse("long.tga", b.data, b.n, "the TGA is damaged: a run goes beyond the last pixel");
    bytes_clear(&b);
}

/* What makes no sense is no TGA, so it is of no format at all. */
static void a_header_without_sense_is_no_tga(void **state)
{
    static const struct {
        int at, to; /* in a grey picture; a kind of 1 needs a palette, and has 8 bits */
    } cases[] = {{1, 2}, {1, 255}, {2, 0}, {2, 4}, {2, 8}, {2, 1}, {2, 19}, {12, 0}, {14, 0}, {17, 0x40}, {17, 0x80},
                 {16, 7}, {2, 2}, {1, 1}};
    bytes b;
    put_tga(&b, 3, 1, 1, 8, 0);
    put_int(&b, 9, 8);
    expect_codes("grey.tga", &(bytes){b.data, b.n, 0}, 1, 1, (const unsigned char[1][3]){{9, 9, 9}});
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const unsigned char before = b.data[cases[i].at];
        b.data[cases[i].at] = (unsigned char)cases[i].to;
        refuse("no.tga", b.data, b.n, "its format is unknown");
        b.data[cases[i].at] = before;
    }
    refuse("head.tga", b.data, 17, "its format is unknown");
    bytes_clear(&b);
}

static void a_damaged_tga_is_refused(void **state)
{
    static const struct {
        int of;
        size_t at, n; /* bytes that become these */
        unsigned char bytes[4];
        const char *message;
    } cases[] = {
        {1, 0, 1, {19}, "cannot hold 2 x 2 pixels"}, /* a text of 19 bytes ends with the file */
        {1, 0, 1, {20}, "the TGA is damaged: the file is cut off"},
        {0, 12, 4, {255, 255, 254, 255}, "30 bytes cannot hold 65535 x 65534 pixels"},
        {4, 30, 1, {9}, "a pixel has a colour that is not in the palette"},
        {4, 30, 1, {4}, "a pixel has a colour that is not in the palette"},
        {3, 22, 1, {3}, "a run goes beyond the last pixel"}, /* the next: no size of a colour, so no TGA */
        {0, 16, 1, {23}, "its format is unknown: a texture must be .png, .jpg, .tga, .bmp, .exr, .hdr or .pfm"},
    };
    char said[512];
    for (size_t i = 0; i < sizeof tgas / sizeof *tgas; i++)
        for (size_t n = 18; n < tgas[i].n; n++) { /* cut off anywhere */
            bis_image image;
            assert_int_equal(read_bytes_as(&image, "cut.tga", tgas[i].bytes, n, said), BIS_INPUT);
        }
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        unsigned char d[80];
        memcpy(d, tgas[cases[i].of].bytes, sizeof d);
        memcpy(d + cases[i].at, cases[i].bytes, cases[i].n);
        refuse("bad.tga", d, tgas[cases[i].of].n, cases[i].message);
    }
}

/* ---- BMP ---- */

/* The same four colours. palette: n colours, blue first; rows: padded to four bytes. masks: 12 bytes behind the header.
 */
static void make_bmp(
    bytes *b, int bits, int height, int coding, int n_palette, const unsigned char *rest, size_t n_rest)
{
    static const unsigned char palette[16] = {0, 0, 255, 0, 0, 255, 0, 0, 255, 0, 0, 0, 51, 51, 51, 0};
    *b = (bytes){0};
    put_text(b, "BM");
    put_int(b, 0, 8);
    put_int(b, (uint64_t)(14 + 40 + 4 * n_palette + (coding == 3 ? 12 : 0)), 4);
    put_int(b, 40, 4);
    put_int(b, 2, 4);
    put_int(b, (uint32_t)height, 4);
    put_int(b, 1, 2);
    put_int(b, (uint64_t)bits, 2);
    put_int(b, (uint64_t)coding, 4);
    put_int(b, 0, 8);
    put_int(b, 0, 4);
    put_int(b, (uint64_t)n_palette, 4);
    put_int(b, 0, 4);
    put(b, palette, 4 * (size_t)n_palette);
    put(b, rest, n_rest);
}

static const struct {
    const char *what;
    int bits, height, coding, n_palette;
    size_t n;
    unsigned char rest[32];
} bmps[] = {
    {"24 bits, upwards", 24, 2, 0, 0, 16, {255, 0, 0, 51, 51, 51, 0, 0, 0, 0, 255, 0, 255, 0, 0, 0}},
    {"32 bits, from the top", 32, -2, 0, 0, 16, {0, 0, 255, 9, 0, 255, 0, 9, 255, 0, 0, 9, 51, 51, 51, 9}},
    {"32 bits with masks", 32, -2, 3, 0, 28,
     {0, 0, 255, 0, 0, 255, 0, 0, 255, 0, 0, 0, 0, 0, 255, 9, 0, 255, 0, 9, 255, 0, 0, 9, 51, 51, 51, 9}},
    {"8 bits", 8, -2, 0, 4, 8, {0, 1, 0, 0, 2, 3, 0, 0}},
    {"4 bits", 4, -2, 0, 4, 8, {0x01, 0, 0, 0, 0x23, 0, 0, 0}},
};

static void each_kind_of_bmp_has_its_colours(void **state)
{
    char said[512];
    for (size_t i = 0; i < sizeof bmps / sizeof *bmps; i++) {
        bis_image image;
        bytes b;
        make_bmp(&b, bmps[i].bits, bmps[i].height, bmps[i].coding, bmps[i].n_palette, bmps[i].rest, bmps[i].n);
        if (read_bytes_as(&image, "a.bmp", b.data, b.n, said)) fail_msg("%s: %s", bmps[i].what, said);
        assert_colours(&image, bmps[i].what, 0);
        bis_image_clear(&image);
        for (size_t n = 4; n < b.n; n++) /* cut off anywhere */
            assert_int_equal(read_bytes_as(&image, "cut.bmp", b.data, n, said), BIS_INPUT);
        bytes_clear(&b);
    }
    /* black and white, a bit each: the highest is the first */
    bis_image image;
    bytes b;
    make_bmp(&b, 1, -2, 0, 2, (const unsigned char[]){0x40, 0, 0, 0, 0x80, 0, 0, 0}, 8);
    assert_int_equal(read_bytes_as(&image, "a.bmp", b.data, b.n, said), BIS_OK);
    assert_true(image.pixels[0].r == 1 && image.pixels[1].g == 1 && image.pixels[2].g == 1 && image.pixels[3].r == 1);
    bis_image_clear(&image);
    bytes_clear(&b);
}

/* A colour of the palette, and one of 24 bits. */
static void colour_of(unsigned char c[3], int i)
{
    for (int k = 0; k < 3; k++) c[k] = (unsigned char)(i * (5 + 2 * k) + 11 * k);
}

/* A picture of w x 3 pixels, pixel i of the colour 7 i % n: n of the palette, or 256 of those of 24 and 32 bits. more:
 * how many bytes the header has beyond 40, and how many lie between palette and pixels. */
static void put_bmp(bytes *b, unsigned char (*codes)[3], int bits, int width, int n, int said, int more)
{
    const int row = (width * bits + 31) / 32 * 4, head = 14 + 40 + more + (bits <= 8 ? 4 * n : 0);
    *b = (bytes){0};
    put_text(b, "BM");
    put_int(b, 0, 8);
    put_int(b, (uint64_t)(head + more), 4);
    put_int(b, (uint64_t)(40 + more), 4);
    put_int(b, (uint64_t)width, 4);
    put_int(b, (uint32_t)-3, 4);
    put_int(b, 1 + ((uint64_t)bits << 16), 4);
    for (int i = 0; i < 4; i++) put_int(b, 0, 4);
    put_int(b, (uint64_t)said, 4);
    put_int(b, 0, 4);
    for (int i = 0; i < more; i++) put_int(b, 0xee, 1);
    for (int i = 0; bits <= 8 && i < n; i++) {
        unsigned char c[3];
        colour_of(c, i);
        put(b, (const unsigned char[]){c[2], c[1], c[0], 0xee}, 4);
    }
    for (int i = 0; i < more; i++) put_int(b, 0xee, 1);
    for (int y = 0; y < 3; y++) {
        unsigned char line[512] = {0};
        for (int x = 0; x < width; x++) {
            const int i = 7 * (y * width + x) % n;
            unsigned char *const c = codes[y * width + x];
            colour_of(c, i);
            if (bits <= 8) line[x * bits / 8] |= (unsigned char)(i << (8 - bits - x * bits % 8));
            else for (int k = 0; k < 3; k++) line[x * bits / 8 + k] = c[2 - k];
        }
        put(b, line, (size_t)row);
    }
}

/* Every number of bits in widths that fill their rows and that do not; a palette as long as it may be, shorter ones,
 * one of which no length is told, and one that is told to be longer than it may be. */
static void bmps_of_any_width_have_their_colours(void **state)
{
    static const int bits[] = {1, 4, 8, 24, 32}, widths[] = {1, 2, 3, 4, 5, 7, 8, 9, 31, 32, 33};
    static unsigned char codes[3 * 33][3];
    for (int i = 0; i < 5 * 11 * 2 * 3; i++) {
        const int b = bits[i % 5], width = widths[i / 5 % 11], more = i / 55 % 2 ? 84 : 0, most = b < 8 ? 1 << b : 256;
        const int n = i / 110 == 0 ? most - 1 : most, said = i / 110 == 2 ? n + 1 : i / 110 == 1 ? 0 : n;
        bytes file;
        put_bmp(&file, codes, b, width, n, said, more);
        expect_codes("any.bmp", &file, width, 3, codes);
        refuse("cut.bmp", file.data, file.n - 1, "the BMP: the file is cut off");
        bytes_clear(&file);
    }
}

/* Of the words of a header, one at a time. */
static void each_word_of_a_bmp_is_held_against_the_file(void **state)
{
#define RARE "only plain files of 1, 4, 8, 24 and 32 bits are read: save it as PNG"
#define CUT "the file is cut off"
#define OLD "its header is damaged, or older than Windows 3"
#define EMPTY "it has no pixels"
    static const struct {
        size_t at;
        uint32_t to;
        const char *message; /* NULL: it is read */
    } cases[] = {
        {10, 66, NULL}, {10, 67, CUT}, {10, 0xffffffff, CUT}, {14, 39, OLD}, {14, 69, OLD}, {18, 0, EMPTY},
        {18, 0xffffffff, EMPTY}, {22, 0, EMPTY}, {22, 0x80000000, EMPTY}, {22, 3, CUT}, {18, 0x10000002, CUT},
        {30, 1, RARE}, {30, 3, NULL}, {54, 0xff0001, RARE}, {58, 0xff01, RARE}, {62, 0xfe, RARE},
    };
    static const unsigned char rest[28] = {0, 0, 255, 0, 0, 255, 0, 0, 255};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char said[512];
        bytes b;
        bis_image image;
        make_bmp(&b, 32, 2, 3, 0, rest, sizeof rest);
        assert_int_equal(b.n, 82);
        for (size_t k = 0; k < 4; k++) b.data[cases[i].at + k] = (unsigned char)(cases[i].to >> 8 * k);
        if (cases[i].message) {
            refuse("word.bmp", b.data, b.n, cases[i].message);
        } else {
            if (read_bytes_as(&image, "word.bmp", b.data, b.n, said)) fail_msg("case %zu: %s", i, said);
            bis_image_clear(&image);
        }
        bytes_clear(&b);
    }
    bytes b; /* masks are for 32 bits */
    make_bmp(&b, 24, 2, 3, 0, rest, sizeof rest);
    refuse("masks24.bmp", b.data, b.n, RARE);
    bytes_clear(&b);
    make_bmp(&b, 8, 2, 0, 4, (const unsigned char[8]){4}, 8);
    refuse("palette.bmp", b.data, b.n, "a pixel has a colour that is not in the palette");
    bytes_clear(&b);
}

/* ---- JPEG ---- */
#ifdef BIS_JPEG
#include <jpeglib.h>

enum { W = 24, H = 16 };

typedef enum { BASELINE, PROGRESSIVE } jpeg_kind;

/* Left half one colour, right half another, each whole blocks. The caller frees. */
static unsigned char *make_jpeg(
    unsigned long *n, int components, jpeg_kind kind, const unsigned char left[3], const unsigned char right[3])
{
    struct jpeg_compress_struct jpeg;
    struct jpeg_error_mgr errors;
    unsigned char *out = NULL, row[W * 4], *rows = row;
    *n = 0;
    jpeg.err = jpeg_std_error(&errors);
    jpeg_create_compress(&jpeg);
    jpeg_mem_dest(&jpeg, &out, n);
    jpeg.image_width = W;
    jpeg.image_height = H;
    jpeg.input_components = components;
    jpeg.in_color_space = components == 1 ? JCS_GRAYSCALE : components == 3 ? JCS_RGB : JCS_CMYK;
    jpeg_set_defaults(&jpeg);
    jpeg_set_quality(&jpeg, 100, TRUE);
    for (int k = 0; k < components; k++) jpeg.comp_info[k].h_samp_factor = jpeg.comp_info[k].v_samp_factor = 1;
    if (kind != BASELINE) jpeg_simple_progression(&jpeg);
    jpeg_start_compress(&jpeg, TRUE);
    for (int x = 0; x < W; x++)
        for (int k = 0; k < components; k++) row[x * components + k] = (x < 8 ? left : right)[k % 3];
    for (int y = 0; y < H; y++) jpeg_write_scanlines(&jpeg, &rows, 1);
    jpeg_finish_compress(&jpeg);
    jpeg_destroy_compress(&jpeg);
    return out;
}

static const unsigned char left[3] = {200, 40, 90}, right[3] = {10, 250, 130};

/* Flat blocks at quality 100: the colour is off by the rounding of YCbCr alone, two codes at most. */
static void each_kind_of_jpeg_has_its_colours(void **state)
{
    for (int kind = 0; kind < 3; kind++) {
        char said[512];
        unsigned long n;
        bis_image image;
        unsigned char *data = make_jpeg(&n, kind == 2 ? 1 : 3, kind == 1 ? PROGRESSIVE : BASELINE, left, right);
        if (read_bytes_as(&image, kind == 1 ? "progressive.jpg" : "a.jpg", data, n, said))
            fail_msg("%d: %s", kind, said);
        assert_true(image.width == W && image.height == H);
        for (int i = 0; i < W * H; i++)
            for (int k = 0; k < 3; k++) {
                const double v = (double)(&image.pixels[i].r)[k];
                const int code = (i % W < 8 ? left : right)[kind == 2 ? 0 : k];
                assert_true(
                    v >= linear(fmax(0, code - 2) / 255) - 1e-6 && v <= linear(fmin(255, code + 2) / 255) + 1e-6);
            }
        bis_image_clear(&image);
        free(data);
    }
}

/* By the exponent that is asked for, or by the curve of sRGB where the file is to say and does not. */
static void a_gamma_is_for_all_kinds(void **state)
{
    unsigned long n;
    bytes bmp;
    unsigned char *jpeg = make_jpeg(&n, 1, BASELINE, (const unsigned char[3]){51}, (const unsigned char[3]){51});
    make_bmp(&bmp, 8, -2, 0, 4, (const unsigned char[8]){3, 3, 0, 0, 3, 3}, 8);
    const struct {
        const char *name;
        const void *data;
        size_t n;
    } files[] = {{"a.jpg", jpeg, n}, {"a.tga", tgas[3].bytes, tgas[3].n}, {"a.bmp", bmp.data, bmp.n}};
    for (int i = 0; i < 3; i++) {
        bis_image image;
        bool is_screen = false;
        store(scratch(files[i].name), files[i].data, files[i].n);
        assert_int_equal(bis_image_read_colours(&image, scratch(files[i].name), 3, (bis_loc){0}, NULL), BIS_OK);
        assert_true(fabs((double)image.pixels[image.width * image.height - 1].g - 0.008) < 1e-6); /* 0.2^3 */
        bis_image_clear(&image);
        assert_int_equal(bis_image_read_any(&image, &is_screen, scratch(files[i].name), (bis_loc){0}, NULL), BIS_OK);
        assert_true(fabs((double)image.pixels[image.width * image.height - 1].b - linear(0.2)) < 1e-6);
        assert_true(is_screen);
        bis_image_clear(&image);
    }
    free(jpeg);
    bytes_clear(&bmp);
}

/* Cut off, with holes, far too large for its bytes: an error, or words about its last rows. */
static void a_damaged_jpeg_is_refused(void **state)
{
    char said[512];
    unsigned long n;
    for (int progressive = 0; progressive < 2; progressive++) {
        unsigned char *data = make_jpeg(&n, 3, progressive ? PROGRESSIVE : BASELINE, left, right);
        for (unsigned long cut = 3; cut + 2 < n; cut++) { /* without the last mark nothing is missing */
            bis_image image;
            const bis_status status = read_bytes_as(&image, "cut.jpg", data, cut, said);
            if (status != BIS_INPUT && !strstr(said, "in the last 8 rows colours may be made up"))
                fail_msg("%lu of %lu bytes", cut, n);
            bis_image_clear(&image);
        }
        unsigned char *sof = memmem(data, n, progressive ? "\xff\xc2" : "\xff\xc0", 2);
        assert_non_null(sof);
        memcpy(sof + 5, "\x70\x71\x70\x70", 4); /* height 28785, width 28784 */
        refuse("huge.jpg", data, n, "bytes cannot hold 28784 x 28785 pixels");
        free(data);
    }
}

#endif

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_kind_of_tga_has_its_colours),
        cmocka_unit_test(each_corner_may_be_the_first_of_a_tga),
        cmocka_unit_test(five_bits_of_a_tga_are_spread_over_eight),
        cmocka_unit_test(long_runs_of_a_tga_go_over_rows),
        cmocka_unit_test(a_header_without_sense_is_no_tga),
        cmocka_unit_test(a_damaged_tga_is_refused),
        cmocka_unit_test(each_kind_of_bmp_has_its_colours),
        cmocka_unit_test(bmps_of_any_width_have_their_colours),
        cmocka_unit_test(each_word_of_a_bmp_is_held_against_the_file),
#ifdef BIS_JPEG
        cmocka_unit_test(each_kind_of_jpeg_has_its_colours),
        cmocka_unit_test(a_gamma_is_for_all_kinds),
        cmocka_unit_test(a_damaged_jpeg_is_refused),
#endif
    };
    return cmocka_run_group_tests(tests, NULL, scratch_remove);
}
