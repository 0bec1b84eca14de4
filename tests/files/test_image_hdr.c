/* SPDX-License-Identifier: BSD-2-Clause */
/* Radiance .hdr: every orientation and every encoding, written here byte by byte; bad files with their messages;
 * the writer against the definition of the nearest RGBE. */
#include "bis/base/mem.h"
#include "bis/files/image_file.h"
#include "claim.h"
#include "image_help.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define HEADER "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n"

static void put_rgbe(bytes *b, int r, int g, int blue, int e)
{
    const unsigned char pixel[4] = {(unsigned char)r, (unsigned char)g, (unsigned char)blue, (unsigned char)e};
    put(b, pixel, 4);
}

#define ONE "\n-Y 1 +X 1\n"
#define NO_FACTOR(value) {HEADER "EXPOSURE=2\nEXPOSURE=" value "\n" ONE, {128, 64, 32, 129}, {.5f, .25f, .125f}, \
    "its EXPOSURE is \"" value "\", which is no factor: 1 is taken (some programs write 0 where they do not know it)"}

#define OTHER_PRIMARIES "its PRIMARIES are not those of Rec. 709; the values are taken as they are"
#define BLANKS_60 "                                                          " /* 58, and two before them */
#define BLANKS BLANKS_60 "     "

static const struct {
    const char *header;
    unsigned char rgbe[4];
    rgb is;
    const char *remark;
} pixels[] = {
    {HEADER ONE, {255, 255, 255, 0}, {0, 0, 0}, NULL}, /* exponent 0 is black */
    /* values are divided by the product of exposures and of colour corrections */
    {HEADER "EXPOSURE=4\nVIEW= -vp 0 0 0\nEXPOSURE= 0.5\nCOLORCORR=1 2 .25\n\tEXPOSURE=100\n" ONE,
     {128, 128, 128, 129}, {.5f, .25f, 2}, NULL},
    {HEADER "EXPOSURE=3\n" ONE, {128, 64, 1, 136}, {128.0f / 3, 64.0f / 3, 1.0f / 3}, NULL},
    {HEADER "EXPOSURE=\t2 \t\r\nCOLORCORR=\t.5\t1  2\t \n" ONE, {128, 128, 128, 129}, {1, .5f, .25f}, NULL},
    {HEADER "COLORCORR=1 2 4\nEXPOSURE=1e-300\nCOLORCORR=4 2 1\nEXPOSURE=1e300\n" ONE, {128, 128, 128, 129},
     {.25f, .25f, .25f}, NULL},
    /* of a long value 60 characters are told */
    {HEADER "EXPOSURE=-1" BLANKS "\n" ONE, {1, 2, 3, 136}, {1, 2, 3}, "its EXPOSURE is \"-1" BLANKS_60
     "\", which is no factor: 1 is taken (some programs write 0 where they do not know it)"},
    /* FreeImage writes EXPOSURE=0, and 0 is no factor; nor is a negative one, or none at all */
    NO_FACTOR("0"), NO_FACTOR("-1"), NO_FACTOR("nan"), NO_FACTOR("inf"), NO_FACTOR(" 0.0"),
    {"#?RGBE\r\nFORMAT=32-bit_rle_rgbe\r\nEXPOSURE=2\r\n\r\n-Y 1 +X 1\r\n", {128, 128, 128, 129}, {.5f, .5f, .5f},
     NULL},
    /* the magic may name any program; blanks around a value */
    {"#?RGBE\nFORMAT=32-bit_rle_rgbe\n" ONE, {1, 2, 3, 136}, {1, 2, 3}, NULL},
    {"#?ANYTHING else\n# a comment\nFORMAT=32-bit_rle_rgbe\n" ONE, {1, 2, 3, 136}, {1, 2, 3}, NULL},
    {"#?RGBE\nFORMAT= \t32-bit_rle_rgbe  \r\n" ONE, {1, 2, 3, 136}, {1, 2, 3}, NULL},
    /* what we cannot honour is a warning */
    {"#?RADIANCE\n" ONE, {1, 2, 3, 136}, {1, 2, 3}, "it has no FORMAT line; 32-bit_rle_rgbe is assumed"},
    {HEADER "PRIMARIES=.7 .3 .2 .7 .1 .05 .333 .333\n" ONE, {1, 2, 3, 136}, {1, 2, 3},
     OTHER_PRIMARIES},
    {HEADER "PRIMARIES=0.640 0.330 0.290 0.600 0.150 0.060 0.333 0.333\n" ONE, {1, 2, 3, 136}, {1, 2, 3}, NULL},
    {HEADER "PRIMARIES=0.64 0.33 0.30 0.60 0.15 0.06 0.3127 0.3290\n" ONE, {1, 2, 3, 136}, {1, 2, 3}, NULL},
    {HEADER "PRIMARIES=0.64 0.33 0.30 0.60 0.15 0.06 0.313 0.329\n" ONE, {1, 2, 3, 136}, {1, 2, 3}, NULL},
    {HEADER "PRIMARIES=.64 .33 .29 .6 .15 .06 .3127 .329\n" ONE, {1, 2, 3, 136}, {1, 2, 3}, OTHER_PRIMARIES},
    {HEADER "PRIMARIES=0 0 0 0 0 0 0 0\n" ONE, {1, 2, 3, 136}, {1, 2, 3}, NULL},
    {HEADER "PRIMARIES=0 0 0 0 0 0 0\n" ONE, {1, 2, 3, 136}, {1, 2, 3}, OTHER_PRIMARIES},
    {HEADER "PRIMARIES=0 0 0 0 0 0 0 0 0\n" ONE, {1, 2, 3, 136}, {1, 2, 3}, OTHER_PRIMARIES},
    {HEADER " PRIMARIES=1 2\nOLD_PRIMARIES=1\nPRIMARIES 1\n" ONE, {1, 2, 3, 136}, {1, 2, 3}, NULL},
    /* a line of one letter is not empty, nor is one that begins with a carriage return */
    {HEADER "x\n\rx\n" ONE, {1, 2, 3, 136}, {1, 2, 3}, NULL},
    /* blanks in the line of the size */
    {HEADER "\n-Y   1   +X   1   \r\n", {1, 2, 3, 136}, {1, 2, 3}, NULL},
};

/* Of a file of a header and one pixel, and what is behind it. */
static void expect_pixel(const char *header, const unsigned char rgbe[4], const char *tail, rgb is, const char *remark)
{
    bytes file = {0};
    bis_image image;
    put_text(&file, header);
    put(&file, rgbe, 4);
    put_text(&file, tail);
    store(scratch("pixel.hdr"), file.data, file.n);
    expect_image(&image, scratch("pixel.hdr"), remark);
    assert_memory_equal(image.pixels, &is, sizeof is);
    bis_image_clear(&image);
    bytes_clear(&file);
}

static void each_header_gives_its_pixel_the_value_beside_it(void **state)
{
    for (size_t i = 0; i < sizeof pixels / sizeof *pixels; i++)
        expect_pixel(pixels[i].header, pixels[i].rgbe, "", pixels[i].is, pixels[i].remark);
    expect_pixel(HEADER ONE, (const unsigned char[]){1, 2, 3, 136}, "tail", (rgb){1, 2, 3},
                 "4 bytes behind the last scanline are ignored");
}

static void a_value_is_mantissa_times_2_to_the_exponent_less_136(void **state)
{
    const unsigned char exponents[] = {1, 2, 100, 127, 128, 129, 136, 200, 255};
    for (size_t i = 0; i < sizeof exponents; i++) {
        const double unit = pow(2, exponents[i] - 136);
        expect_pixel(HEADER ONE, (const unsigned char[]){255, 128, 1, exponents[i]}, "",
                     rgb_from(255 * unit, 128 * unit, unit), NULL);
    }
}

/* The order of the pixels of a 3 x 2 picture in a file, by walking the axes as the resolution line says. */
static void put_in_order(bytes *file, char slow, char fast, bool slow_minus, bool fast_minus)
{
    const int size_x = 3, size_y = 2;
    const int n_slow = slow == 'X' ? size_x : size_y, n_fast = fast == 'X' ? size_x : size_y;
    for (int i = 0; i < n_slow; i++)
        for (int j = 0; j < n_fast; j++) {
            /* X from left to right, Y from bottom to top; minus: the other way round */
            int a = slow_minus ? n_slow - 1 - i : i, b = fast_minus ? n_fast - 1 - j : j;
            int from_left = slow == 'X' ? a : b, from_bottom = slow == 'X' ? b : a;
            put_rgbe(file, 100 + from_left, 200 + size_y - 1 - from_bottom, 7, 136);
        }
}

static void all_eight_orientations_put_every_pixel_in_its_place(void **state)
{
    for (int i = 0; i < 8; i++) {
        const char slow = i & 1 ? 'X' : 'Y', fast = i & 1 ? 'Y' : 'X';
        char line[32];
        bytes file = {0};
        bis_image image;
        snprintf(line, sizeof line, "%c%c %d %c%c %d\n", i & 2 ? '-' : '+', slow, slow == 'X' ? 3 : 2,
            i & 4 ? '-' : '+', fast, fast == 'X' ? 3 : 2);
        put_text(&file, HEADER "\n");
        put_text(&file, line);
        put_in_order(&file, slow, fast, i & 2, i & 4);
        store(scratch("axes.hdr"), file.data, file.n);
        expect_image(&image, scratch("axes.hdr"), NULL);
        assert_int_equal(image.width, 3);
        assert_int_equal(image.height, 2);
        for (int y = 0; y < 2; y++)
            for (int x = 0; x < 3; x++) {
                rgb v = image.pixels[3 * y + x];
                assert_true(v.r == (float)(100 + x) && v.g == (float)(200 + y) && v.b == 7);
            }
        bis_image_clear(&image);
        bytes_clear(&file);
    }
}

/* ---- encodings: a 600 pixel line with a long run, coded in three ways ---- */

enum { WIDTH = 600 };

static int red_of(int x, int y) { return x >= 10 && x < 590 ? 50 : (x + 3 * y) % 128 + 20; }

static void put_flat(bytes *file, int y)
{
    for (int x = 0; x < WIDTH; x++)
        put_rgbe(file, red_of(x, y), 60, 70, 136);
}

/* 580 equal pixels from x = 10 on: one, and a run of 579 = 67 + 2 * 256. */
static void put_old(bytes *file, int y)
{
    for (int x = 0; x <= 10; x++)
        put_rgbe(file, red_of(x, y), 60, 70, 136);
    put_rgbe(file, 1, 1, 1, 67);
    put_rgbe(file, 1, 1, 1, 2);
    for (int x = 590; x < WIDTH; x++)
        put_rgbe(file, red_of(x, y), 60, 70, 136);
}

static void put_new(bytes *file, int y)
{
    const int others[3] = {60, 70, 136};
    put_rgbe(file, 2, 2, WIDTH >> 8, WIDTH & 255);
    put_int(file, 10, 1);
    for (int x = 0; x < 10; x++)
        put_int(file, (uint64_t)red_of(x, y), 1);
    for (int left = 580; left > 0; left -= 127) {
        put_int(file, (uint64_t)(128 + (left < 127 ? left : 127)), 1);
        put_int(file, 50, 1);
    }
    put_int(file, 10, 1);
    for (int x = 590; x < WIDTH; x++)
        put_int(file, (uint64_t)red_of(x, y), 1);
    for (int k = 0; k < 3; k++)
        for (int left = WIDTH; left > 0; left -= 100) { /* runs of 100: shorter than they could be, which is legal */
            put_int(file, 128 + 100, 1);
            put_int(file, (uint64_t)others[k], 1);
        }
}

static void flat_old_and_new_encodings_give_the_same_pixels_also_in_one_file(void **state)
{
    void (*const kinds[])(bytes *, int) = {put_flat, put_old, put_new};
    for (int way = 0; way < 4; way++) { /* 3: every line in another encoding */
        bytes file = {0};
        bis_image image;
        put_text(&file, HEADER "\n-Y 6 +X 600\n");
        for (int y = 0; y < 6; y++)
            kinds[way < 3 ? way : y % 3](&file, y);
        store(scratch("rle.hdr"), file.data, file.n);
        expect_image(&image, scratch("rle.hdr"), NULL);
        for (int i = 0; i < 6 * WIDTH; i++) {
            rgb v = image.pixels[i];
            assert_true(v.r == (float)red_of(i % WIDTH, i / WIDTH) && v.g == 60 && v.b == 70);
        }
        bis_image_clear(&image);
        bytes_clear(&file);
    }
}

#define B16 "\7\7\7\7\7\7\7\7\7\7\7\7\7\7\7\7"
#define B128 B16 B16 B16 B16 B16 B16 B16 B16

/* Scanlines whose exponents are 136, beside what each is: pairs of a value of red and how many pixels have it. Green
 * and blue are 5 and 6, but in the first pixel. */
static const struct {
    const char *bytes;
    size_t n;
    int width;
    const unsigned char red[12]; /* value, how many, ... */
    rgb first;                   /* the first pixel */
} scanlines[] = {
#define AS(width, bytes) BYTES(bytes), width
    /* digits of a run that are 0, and runs after runs; a run to the end */
    {AS(3, "\7\5\6\x88" "\1\1\1\0" "\1\1\1\0" "\1\1\1\0" "\x8\5\6\x88" "\x9\5\6\x88"), {7, 1, 8, 1, 9, 1},
     {7, 5, 6}},
    {AS(3, "\7\5\6\x88" "\1\1\1\1" "\x8\5\6\x88"), {7, 2, 8, 1}, {7, 5, 6}},
    {AS(6, "\7\5\6\x88" "\1\1\1\1" "\x8\5\6\x88" "\1\1\1\2" "\x9\5\6\x88"), {7, 2, 8, 3, 9, 1},
     {7, 5, 6}},
    {AS(256, "\7\5\6\x88" "\1\1\1\xff"), {7, 255, 7, 1}, {7, 5, 6}},
    {AS(259, "\7\5\6\x88" "\1\1\1\2" "\1\1\1\1"), {7, 255, 7, 4}, {7, 5, 6}},
    /* two mantissas of 1 make no run; two of 2 in the first pixel are no new encoding if the third is above 127 or the
     * scanline is short; one of 2 is none, either */
    {AS(3, "\1\1\2\x88" "\1\5\6\x88" "\2\5\6\x88"), {1, 2, 2, 1}, {1, 1, 2}},
    {AS(2, "\1\2\1\x88" "\3\5\6\x88"), {1, 1, 3, 1}, {1, 2, 1}},
    {AS(2, "\2\1\1\x88" "\3\5\6\x88"), {2, 1, 3, 1}, {2, 1, 1}},
    {AS(8, "\2\2\x80\x88" "\3\5\6\x88" "\1\1\1\6"), {2, 1, 3, 7}, {2, 2, 128}},
    {AS(8, "\2\3\0\x88" "\3\5\6\x88" "\1\1\1\6"), {2, 1, 3, 7}, {2, 3, 0}},
    {AS(8, "\3\2\0\x88" "\3\5\6\x88" "\1\1\1\6"), {3, 8}, {3, 2, 0}},
    {AS(7, "\2\2\0\x88" "\3\5\6\x88" "\1\1\1\5"), {2, 1, 3, 6}, {2, 2, 0}},
    /* the new encoding: a literal of 128, runs of 1 and of 127, a literal to the end of the file */
    {AS(8, "\2\2\0\x8" "\x81\7\x87\x8" "\x88\5" "\x88\6" "\x8\x88\x88\x88\x88\x88\x88\x88\x88"), {7, 1, 8, 7},
     {7, 5, 6}},
    {AS(255, "\2\2\0\xff" "\x80" B128 "\xff\x8" "\xff\5\xff\5\x81\5" "\xff\6\xff\6\x81\6"
     "\xff\x88\xff\x88\x81\x88"),
     {7, 128, 8, 127}, {7, 5, 6}},
};

static void each_scanline_has_its_pixels(void **state)
{
    for (size_t i = 0; i < sizeof scanlines / sizeof *scanlines; i++) {
        bytes file = {0};
        bis_image image;
        char line[32];
        put_text(&file, HEADER "\n");
        snprintf(line, sizeof line, "-Y 1 +X %d\n", scanlines[i].width);
        put_text(&file, line);
        put(&file, scanlines[i].bytes, scanlines[i].n);
        store(scratch("scanline.hdr"), file.data, file.n);
        expect_image(&image, scratch("scanline.hdr"), NULL);
        int x = 0;
        for (int k = 0; k < 12; k += 2)
            for (int j = 0; j < scanlines[i].red[k + 1]; j++, x++) {
                const rgb v = image.pixels[x], is = {scanlines[i].red[k], 5, 6};
                const rgb expected = x == 0 ? scanlines[i].first : is;
                if (memcmp(&v, &expected, sizeof v))
                    fail_msg("scanline %zu: pixel %d is %g %g %g", i, x, (double)v.r, (double)v.g, (double)v.b);
            }
        assert_int_equal(x, scanlines[i].width);
        bis_image_clear(&image);
        bytes_clear(&file);
    }
}

/* ---- bad files ---- */

#define ROWS(size) HEADER "\n" size "\n"
#define NO_SIZE(line) {BYTES(ROWS(line) "abcdabcdabcdabcd"), \
    "its resolution line is \"" line "\", must be like \"-Y 512 +X 1024\", with sides from 1 to 32768"}
#define CUT_OFF "the file ends within the header"
#define FACTORS(key, value, what) {BYTES(HEADER key "=" value "\n\n"), \
    key " is \"" value "\", must be " what " above 0, as must be the product of all such lines"}
#define NO_FORMAT(value) {BYTES("#?RADIANCE\nFORMAT=" value "\n\n"), \
    "its FORMAT is \"" value "\", must be 32-bit_rle_rgbe or 32-bit_rle_xyze"}
#define LETTERS_60 "abcdefghijklmnopqrstuvwxyzabcdefghijklmnopqrstuvwxyzabcdefgh"
#define DAMAGE(size, pixels, message) {BYTES(ROWS(size) pixels), "scanline 1 of 1, at byte 45, is damaged: " message}

/* A header is named by its line, a scanline by its number and byte; a size is held against the length of the file. */
static const bad_file damaged[] = {
    {BYTES("#?RADIANCE"), CUT_OFF},
    {BYTES("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n"), CUT_OFF},
    {BYTES(HEADER "\n-Y 2 +X 2"), CUT_OFF},
    {BYTES("#?RADIANCE\nFORMAT=ascii\n\n"), "its FORMAT is \"ascii\", must be 32-bit_rle_rgbe or 32-bit_rle_xyze"},
    FACTORS("EXPOSURE", "dark", "a number"), FACTORS("COLORCORR", "1 2", "three numbers"),
    FACTORS("EXPOSURE", "1 2", "a number"), FACTORS("COLORCORR", "1 2 3 4", "three numbers"),
    FACTORS("COLORCORR", "1 1 inf", "three numbers"), FACTORS("COLORCORR", "", "three numbers"),
    {BYTES(HEADER "EXPOSURE=1e-200\nEXPOSURE=1e-200\n\n"),
     "EXPOSURE is \"1e-200\", must be a number above 0, as must be the product of all such lines"},
    /* 60 characters of a long value are told, and of a long line of the size */
    {BYTES(HEADER "EXPOSURE=" LETTERS_60 "x\n\n"),
     "EXPOSURE is \"" LETTERS_60 "\", must be a number above 0, as must be the product of all such lines"},
    {BYTES("#?RADIANCE\nFORMAT=" LETTERS_60 "x\n\n"),
     "its FORMAT is \"" LETTERS_60 "\", must be 32-bit_rle_rgbe or 32-bit_rle_xyze"},
    {BYTES(ROWS(LETTERS_60 "x") "abcd"), "its resolution line is \"" LETTERS_60
     "\", must be like \"-Y 512 +X 1024\", with sides from 1 to 32768"},
    NO_FORMAT("32-bit_rle_rgbx"), NO_FORMAT("32-bit_rle_rgbe2"), NO_FORMAT("32-bit_rle_rgb"), NO_FORMAT("xyze"),
    {BYTES("#?RADIANCE\nFORMAT= \t \r\n\n"), "its FORMAT is \"\", must be 32-bit_rle_rgbe or 32-bit_rle_xyze"},
    {BYTES(HEADER "EXPOSURE=1e200\nEXPOSURE=1e200\n\n"),
     "EXPOSURE is \"1e200\", must be a number above 0, as must be the product of all such lines"},
    NO_SIZE(""), NO_SIZE("-Y 2"), NO_SIZE("-Y 2 -Y 2"), NO_SIZE("-Y 2 +Z 2"), NO_SIZE("Y 2 X 2"),
    NO_SIZE("-Y 0 +X 2"), NO_SIZE("-Y -2 +X 2"), NO_SIZE("-Y 2 +X 32769"), NO_SIZE("-Y 40000 +X 40000"),
    NO_SIZE("-Y 2 +X 2 3"), NO_SIZE("-Y 2 +X 2x"), NO_SIZE("-Y 99999999999999999999 +X 2"),
    NO_SIZE("-Y2 +X 2"), NO_SIZE("-Y 2 X 2"), NO_SIZE("-Y 2 +X 0"), NO_SIZE(" -Y 2 +X 2"), NO_SIZE("-Y 2+X 2"),
    {BYTES(ROWS("-Y 32768 +X 32768") "abcdabcdabcdabcd"), "32768 scanlines of 32768 pixels need 393216 bytes or more, "
     "but 16 follow the header (the file is cut off)"},
    {BYTES(ROWS("-Y 3 +X 2") "abcdabcdabcdabcdabcdabc"),
     "3 scanlines of 2 pixels need 24 bytes or more, but 23 follow the header (the file is cut off)"},
    {BYTES(ROWS("-Y 3 +X 257") "abcdabcdabcdabcdabcdabcd"),
     "3 scanlines of 257 pixels need 36 bytes or more, but 24 follow the header (the file is cut off)"},
    DAMAGE("-Y 1 +X 8", "\2\2\1\x8" "\0\0\0\0", "its length is not that of the resolution line"),
    {BYTES(ROWS("-Y 1 +X 264") "\2\2\0\x8" "\0\0\0\0\0\0\0\0"),
     "scanline 1 of 1, at byte 47, is damaged: its length is not that of the resolution line"},
    DAMAGE("-Y 1 +X 8", "\2\2\0\x8" "\x9\0\0\0", "a run leads beyond its end"),
    DAMAGE("-Y 1 +X 8", "\2\2\0\x8" "\x88\7" "\x88\7" "\x88\7" "\x87\7", "the file ends within it"),
    DAMAGE("-Y 1 +X 3", "\x9\x9\x9\x9" "\1\1\1\3", "a run leads beyond its end"),
    DAMAGE("-Y 1 +X 3", "\x9\x9\x9\x9" "\x8\x8\x8\x8", "the file ends within it"),
    DAMAGE("-Y 1 +X 8", "\2\2\0\x8" "\0\0\0\0", "it has a run of length 0"),
    DAMAGE("-Y 1 +X 8", "\2\2\0\x8" "\x88\x7\x8\x7", "the file ends within it"),
    {BYTES(ROWS("-Y 3 +X 2") "\x9\x9\x9\x9" "\x9\x9\x9\x9" "\1\1\1\1" "\x9\x9\x9\x9" "abcdabcd"),
     "scanline 2 of 3, at byte 53, is damaged: it begins with a run, which has no pixel to repeat"},
};

static void a_bad_file_is_refused_by_its_line_or_scanline(void **state)
{
    expect_refusals(damaged, sizeof damaged / sizeof *damaged, "bad.hdr");
}

static void no_damage_leads_out_of_the_file(void **state)
{
    void (*const kinds[])(bytes *, int) = {put_old, put_new};
    for (int i = 0; i < 2; i++) {
        bytes file = {0};
        put_text(&file, HEADER "EXPOSURE=2\n\n-Y 2 +X 600\n");
        kinds[i](&file, 0);
        kinds[i](&file, 1);
        try_damage(&file, "damaged.hdr", 2000, 1 + (uint32_t)i);
        bytes_clear(&file);
    }
}

/* ---- writing ---- */

static void save(const bis_image *image, const char *path)
{
    bis_diag diag = {0};
    assert_int_equal(bis_image_save(image, path, &diag), BIS_OK);
    assert_int_equal(diag.n, 0);
}

/* Write the picture; what is read back. */
static bis_image back_from(const bis_image *image)
{
    bis_image back;
    save(image, scratch("back.hdr"));
    expect_image(&back, scratch("back.hdr"), NULL);
    assert_true(back.width == image->width && back.height == image->height);
    return back;
}

static bis_image random_image(int width, int height, uint32_t seed)
{
    bis_image image;
    assert_int_equal(bis_image_init(&image, width, height, NULL), BIS_OK);
    for (int i = 0; i < width * height; i++) {
        float v[3];
        for (int k = 0; k < 3; k++)
            v[k] = ldexpf((float)(next_random(&seed) >> 8), (int)(next_random(&seed) % 40) - 40);
        if (next_random(&seed) % 3 && i) /* runs */
            image.pixels[i] = image.pixels[i - 1];
        else
            image.pixels[i] = (rgb){v[0], v[1], v[2]};
    }
    return image;
}

static double largest(rgb v) { return fmax((double)v.r, fmax((double)v.g, (double)v.b)); }

/* A step of RGBE at a pixel: 2^-8 of the power of two above its largest channel (after rounding: see below). */
static double step_at(rgb v)
{
    int e;
    frexp(largest(v), &e);
    return ldexp(1, e - 8);
}

static void every_channel_comes_back_within_half_a_step_of_its_pixel(void **state)
{
    const int widths[] = {1, 2, 7, 8, 9, 127, 128, 129, 255, 256, 1000, 32767, 32768};
    for (size_t i = 0; i < sizeof widths / sizeof widths[0]; i++) {
        bis_image image = random_image(widths[i], 3, 11), back = back_from(&image);
        for (int k = 0; k < 3 * widths[i]; k++) {
            rgb a = image.pixels[k], b = back.pixels[k];
            /* a mantissa of 255.5 and more rounds up to 256, which doubles the step for the other two */
            double half = step_at(a) * (largest(a) >= 255.5 * step_at(a) ? 1 : 0.5);
            assert_true(fabs((double)a.r - (double)b.r) <= half);
            assert_true(fabs((double)a.g - (double)b.g) <= half);
            assert_true(fabs((double)a.b - (double)b.b) <= half);
            assert_true(fabs(largest(b) - largest(a)) <= largest(a) / 256);
        }
        bis_image_clear(&image);
        bis_image_clear(&back);
    }
}

static void what_rgbe_holds_comes_back_exactly(void **state)
{
    bis_image image;
    assert_int_equal(bis_image_init(&image, 255, 128, NULL), BIS_OK);
    for (int e = 1; e <= 255; e++)
        for (int m = 0; m < 128; m++) /* a largest mantissa of 128 to 255: the form that every writer uses */
            image.pixels[m * 255 + e - 1] = rgb_from(ldexp(128 + m, e - 136), ldexp(m, e - 136), 0);
    bis_image back = back_from(&image);
    assert_memory_equal(image.pixels, back.pixels, 255 * 128 * sizeof(rgb));
    bis_image_clear(&image);
    bis_image_clear(&back);
}

static void values_below_the_smallest_exponent_round_to_its_steps(void **state)
{
    const float step = 0x1p-135f;
    const rgb in[4] = {{step * 100, 0, step}, {step * 0.25f, 0, 0}, {step * 0.75f, 0, 0}, {step, step, step}};
    /* mantissas 1 1 1 are a run in a flat line: one step too bright in blue */
    const rgb out[4] = {in[0], {0, 0, 0}, {step, 0, 0}, {step, step, 2 * step}};
    bis_image image;
    assert_int_equal(bis_image_init(&image, 4, 1, NULL), BIS_OK);
    memcpy(image.pixels, in, sizeof in);
    bis_image back = back_from(&image);
    assert_memory_equal(back.pixels, out, sizeof out);
    bis_image_clear(&image);
    bis_image_clear(&back);
}

static void what_an_hdr_cannot_hold_is_refused_before_anything_is_written(void **state)
{
    const float bad[] = {-1, -1e-30f, NAN, INFINITY, -INFINITY, 3e38f, 255.5f * 0x1p119f};
    bis_image image;
    assert_int_equal(bis_image_init(&image, 3, 2, NULL), BIS_OK);
    store(scratch("old.hdr"), "older", 5);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        char expected[512];
        bis_diag diag = {0};
        int before = scratch_count();
        image.pixels[5].g = bad[i]; /* column 2 of row 1 */
        assert_int_equal(bis_image_save(&image, scratch("old.hdr"), &diag), BIS_INPUT);
        assert_int_equal(diag.n, 1);
        snprintf(expected, sizeof expected,
            "%s: error: cannot write \"%s\": pixel (2, 1) is (0, %g, 0), but an .hdr holds values "
            "from 0 to 1.69e38 only (.exr and .pfm hold any)",
            scratch("old.hdr"), scratch("old.hdr"), (double)bad[i]);
        assert_string_equal(diag.messages[0].text, expected);
        assert_true(holds(scratch("old.hdr"), "older", 5));
        assert_int_equal(scratch_count(), before);
        bis_diag_clear(&diag);
    }
    image.pixels[5].g = 255.4f * 0x1p119f;
    save(&image, scratch("old.hdr"));
    bis_image_clear(&image);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_header_gives_its_pixel_the_value_beside_it),
        cmocka_unit_test(a_value_is_mantissa_times_2_to_the_exponent_less_136),
        cmocka_unit_test(all_eight_orientations_put_every_pixel_in_its_place),
        cmocka_unit_test(flat_old_and_new_encodings_give_the_same_pixels_also_in_one_file),
        cmocka_unit_test(each_scanline_has_its_pixels),
        cmocka_unit_test(a_bad_file_is_refused_by_its_line_or_scanline),
        cmocka_unit_test(no_damage_leads_out_of_the_file),
        cmocka_unit_test(every_channel_comes_back_within_half_a_step_of_its_pixel),
        cmocka_unit_test(what_rgbe_holds_comes_back_exactly),
        cmocka_unit_test(values_below_the_smallest_exponent_round_to_its_steps),
        cmocka_unit_test(what_an_hdr_cannot_hold_is_refused_before_anything_is_written),
    };
    return cmocka_run_group_tests(tests, NULL, scratch_remove);
}
