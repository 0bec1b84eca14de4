/* SPDX-License-Identifier: BSD-2-Clause */
/* image_screen: pictures of a screen as textures: JPEGs, which libjpeg writes here, and TGAs and BMPs, which are
 * written by hand. */
#include "bis/files/image_file.h"
#include "bis/base/mem.h"
#include "claim.h"
#include "image_help.h"
#include "lack.h"

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

static void a_damaged_tga_is_refused(void **state)
{
    static const struct {
        int of;
        size_t at, n; /* bytes that become these */
        unsigned char bytes[4];
        const char *message;
    } cases[] = {
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

static void a_damaged_or_rare_bmp_is_refused(void **state)
{
    bytes b;
    make_bmp(&b, 8, 2, 1, 4, bmps[3].rest, 8);
    refuse("coded.bmp", b.data, b.n, "only plain files of 1, 4, 8, 24 and 32 bits are read: save it as PNG");
    bytes_clear(&b);
    make_bmp(&b, 256 + 8, 2, 0, 4, bmps[3].rest, 8); /* the number of bits has two bytes */
    refuse("bits.bmp", b.data, b.n, "only plain files");
    bytes_clear(&b);
    make_bmp(&b, 32, 2, 3, 0, (const unsigned char[28]){255}, 28);
    refuse("masks.bmp", b.data, b.n, "only plain files");
    bytes_clear(&b);
    make_bmp(&b, 8, 2, 0, 4, (const unsigned char[8]){4}, 8);
    refuse("palette.bmp", b.data, b.n, "a pixel has a colour that is not in the palette");
    b.data[14] = 12; /* OS/2's header */
    refuse("old.bmp", b.data, b.n, "its header is damaged, or older than Windows 3");
    b.data[14] = 40;
    b.data[25] = 0x80; /* the height is -2^31 + 2 */
    refuse("high.bmp", b.data, b.n, "the file is cut off");
    b.data[22] = b.data[25] = 0;
    refuse("flat.bmp", b.data, b.n, "it has no pixels");
    bytes_clear(&b);
}

/* ---- JPEG ---- */
#ifdef BIS_JPEG
#include <jpeglib.h>

enum { W = 24, H = 16 };

typedef enum { BASELINE, PROGRESSIVE, WHOLE_SCANS } jpeg_kind; /* the last: progressive, without refinements */

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
    static const jpeg_scan_info whole[] = {
        {3, {0, 1, 2}, 0, 0, 0, 0}, {1, {0}, 1, 63, 0, 0}, {1, {1}, 1, 63, 0, 0}, {1, {2}, 1, 63, 0, 0}};
    if (kind == WHOLE_SCANS) {
        jpeg.scan_info = whole;
        jpeg.num_scans = sizeof whole / sizeof *whole;
    }
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

/* Cut off, with holes, far too large for its bytes, of another kind: an error, and never grey. */
static void a_damaged_jpeg_is_refused(void **state)
{
    char said[512];
    unsigned long n;
    for (int progressive = 0; progressive < 2; progressive++) {
        unsigned char *data = make_jpeg(&n, 3, progressive ? PROGRESSIVE : BASELINE, left, right);
        for (unsigned long cut = 3; cut + 2 < n; cut++) { /* without the last mark nothing is missing */
            bis_image image;
            if (read_bytes_as(&image, "cut.jpg", data, cut, said) != BIS_INPUT) fail_msg("%lu of %lu bytes", cut, n);
        }
        unsigned char *sof = memmem(data, n, progressive ? "\xff\xc2" : "\xff\xc0", 2);
        assert_non_null(sof);
        memcpy(sof + 5, "\x70\x71\x70\x70", 4); /* height 28785, width 28784 */
        refuse("huge.jpg", data, n, "bytes cannot hold 28784 x 28785 pixels");
        free(data);
    }
    unsigned char *data = make_jpeg(&n, 4, BASELINE, left, right);
    refuse("cmyk.jpg", data, n, "the JPEG is damaged, or of a kind that is not read: ");
    free(data);
}

/* A progressive file of whole scans, each component's own: the last one may come again and again, and says the same.
 * The file then has n_scans of them. */
static void read_scans(unsigned n_scans, bis_status expected, const char *message)
{
    char said[512];
    unsigned long n;
    unsigned char *data = make_jpeg(&n, 3, WHOLE_SCANS, left, right);
    unsigned char *scan = data, *next;
    unsigned n_found = 0;
    while ((next = memmem(scan + 1, n - (size_t)(scan + 1 - data), "\xff\xda", 2)) != NULL) scan = next, n_found++;
    const size_t length = n - 2 - (size_t)(scan - data), n_more = n_scans - n_found;
    unsigned char *many = malloc(n + n_more * length);
    memcpy(many, data, n - 2);
    for (size_t k = 0; k < n_more; k++) memcpy(many + n - 2 + k * length, scan, length);
    memcpy(many + n - 2 + n_more * length, "\xff\xd9", 2);
    bis_image image;
    assert_int_equal(read_bytes_as(&image, "scans.jpg", many, n + n_more * length, said), expected);
    if (message != NULL) assert_non_null(strstr(said, message));
    bis_image_clear(&image);
    free(many);
    free(data);
}

static void a_jpeg_has_at_most_200_scans(void **state)
{
    read_scans(200, BIS_OK, NULL);
    read_scans(201, BIS_INPUT, "it has more than 200 scans");
}

static void without_memory_there_is_no_picture(void **state)
{
    unsigned long n;
    unsigned char *data = make_jpeg(&n, 3, BASELINE, left, right);
    const struct {
        const char *name;
        const void *data;
        size_t n;
    } files[] = {{"a.jpg", data, n}, {"a.tga", tgas[3].bytes, tgas[3].n}};
    for (int i = 0; i < 2; i++) {
        store(scratch(files[i].name), files[i].data, files[i].n);
        FOR_LACK(l) {
            bis_image image;
            LACK(l, bis_image_read_colours(&image, scratch(files[i].name), 2.2, (bis_loc){0}, NULL));
            bis_image_clear(&image);
        }
    }
    free(data);
    assert_int_equal(bis_mem_live(), 0);
}
#endif

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_kind_of_tga_has_its_colours),
        cmocka_unit_test(a_damaged_tga_is_refused),
        cmocka_unit_test(each_kind_of_bmp_has_its_colours),
        cmocka_unit_test(a_damaged_or_rare_bmp_is_refused),
#ifdef BIS_JPEG
        cmocka_unit_test(each_kind_of_jpeg_has_its_colours),
        cmocka_unit_test(a_damaged_jpeg_is_refused),
        cmocka_unit_test(a_jpeg_has_at_most_200_scans),
        cmocka_unit_test(without_memory_there_is_no_picture),
#endif
    };
    return cmocka_run_group_tests(tests, NULL, scratch_remove);
}
