/* SPDX-License-Identifier: BSD-2-Clause */
/* PNG: written by bis, read back by libpng. */
#include "bis/base/mem.h"
#include "bis/files/image_file.h"
#include "files/image_png.h"
#include "claim.h"
#include "image_help.h"

#include <math.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { W = 5, H = 3 };

/* The picture's R, G, B bytes as libpng reads them; the caller frees. */
static unsigned char *read_png(const char *path, int width, int height)
{
    png_image png = {.version = PNG_IMAGE_VERSION};
    assert_true(png_image_begin_read_from_file(&png, path));
    assert_int_equal(png.width, width);
    assert_int_equal(png.height, height);
    assert_int_equal(png.format, PNG_FORMAT_RGB); /* 8 bit, sRGB: no conversion on the way */
    unsigned char *row = malloc(PNG_IMAGE_SIZE(png));
    assert_non_null(row);
    assert_true(png_image_finish_read(&png, NULL, row, 0, NULL));
    return row;
}

/* Write a W x H picture of one channel set, each pixel (r, g, b), and return what libpng reads. */
static unsigned char *through_png(const rgb *pixels, bool has_exposure, double exposure)
{
    const bis_channel channels[3] = {{"R", &pixels->r, 3}, {"G", &pixels->g, 3}, {"B", &pixels->b, 3}};
    const bis_picture picture = {.width = W, .height = H, .full_width = W, .full_height = H, .channels = channels,
                                 .n_channels = 3, .has_exposure = has_exposure, .exposure = exposure};
    bis_diag diag = {0};
    assert_int_equal(bis_image_write(scratch("a.png"), &picture, &diag), BIS_OK);
    assert_int_equal(diag.n, 0);
    return read_png(scratch("a.png"), W, H);
}

static void fill(rgb pixels[W * H], rgb v)
{
    for (int i = 0; i < W * H; i++)
        pixels[i] = v;
}

static void a_given_exposure_and_the_srgb_curve_give_the_bytes(void **state)
{
    /* sRGB of 2^-6 ... 1, from the tables of IEC 61966-2-1: 8 bit code of linear 1/64, 1/8, 1/2; 0.001 lies on the
     * straight part */
    const struct {
        float v;
        double ev;
        int code;
    } cases[] = {{1, 0, 255}, {0.5f, 0, 188}, {0.125f, 0, 99}, {0.125f, 2, 188}, {8, -4, 188}, {0.001f, 0, 3},
        {0, 0, 0}, {2, 0, 255}, {-1, 0, 0}, {0.21404f, 0, 127}, {0.21586f, 0, 128}, {1e30f, 1000, 255}, {0, 2000, 0}};
    rgb pixels[W * H];
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        fill(pixels, (rgb){cases[i].v, 0, cases[i].v});
        unsigned char *found = through_png(pixels, true, cases[i].ev);
        for (int k = 0; k < W * H; k++) {
            assert_int_equal(found[3 * k], cases[i].code);
            assert_int_equal(found[3 * k + 1], 0);
            assert_int_equal(found[3 * k + 2], cases[i].code);
        }
        free(found);
    }
}

static void the_log_average_lands_on_a_grey_of_18_percent_at_any_brightness(void **state)
{
    const float scales[] = {1e-38f, 1e-6f, 1, 4e4f, 1e37f};
    rgb pixels[W * H];
    for (size_t i = 0; i < sizeof scales / sizeof scales[0]; i++) {
        for (int k = 0; k < W * H;
            k++) { /* 7 pixels darker, 7 brighter by the same factor, one in the middle, which gets 18% */
            float v = scales[i] * (k == 7 ? 1 : k < 7 ? 0.25f : 4);
            pixels[k] = (rgb){v, v, v};
        }
        unsigned char *found = through_png(pixels, false, 99);
        assert_int_equal(found[3 * 7], 118); /* sRGB of 0.18 is 0.4613 */
        assert_int_equal(found[0], 60);      /* 0.045: 0.2353 */
        assert_int_equal(found[3 * 14], 221); /* 0.72: 0.8650 */
        free(found);
    }
}

/* What the picture is but for its first pixels, and the codes of these and of the rest. 118: 18% of grey. */
static void black_nan_and_infinity_do_not_change_the_exposure(void **state)
{
    static const struct {
        float rest, first[3];
        int code, codes[3];
    } cases[] = {{0, {0, 0, 7}, 0, {0, 0, 118}}, {0, {0, 0, 0}, 0, {0, 0, 0}},
                 {2, {NAN, INFINITY, -INFINITY}, 118, {0, 255, 0}}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        rgb pixels[W * H];
        fill(pixels, (rgb){cases[i].rest, cases[i].rest, cases[i].rest});
        for (int k = 0; k < 3; k++) pixels[k] = (rgb){cases[i].first[k], cases[i].first[k], cases[i].first[k]};
        unsigned char *found = through_png(pixels, false, 0);
        for (int k = 0; k < 3 * W * H; k++) assert_int_equal(found[k], k < 9 ? cases[i].codes[k / 3] : cases[i].code);
        free(found);
    }
}

/* The picture is metered where its subject is; where that is nowhere, this tells nothing. */
static void the_exposure_is_metered_on_the_subject(void **state)
{
    float planes[2][W * H];
    for (int i = 0; i < W * H; i++) {
        planes[0][i] = i < 5 ? 7 : 1e-6f;
        planes[1][i] = i < 5;
    }
    const bis_channel channels[3] = {{"R", planes[0], 1}, {"G", planes[0], 1}, {"B", planes[0], 1}};
    const bis_channel subject = {"", planes[1], 1};
    const bis_picture picture = {.width = W, .height = H, .full_width = W, .full_height = H, .channels = channels,
                                 .n_channels = 3, .subject = &subject};
    assert_int_equal(bis_image_write(scratch("m.png"), &picture, NULL), BIS_OK);
    unsigned char *found = read_png(scratch("m.png"), W, H);
    assert_int_equal(found[0], 118);
    free(found);
    for (int i = 0; i < W * H; i++) planes[1][i] = 0;
    assert_int_equal(bis_image_write(scratch("m.png"), &picture, NULL), BIS_OK);
    found = read_png(scratch("m.png"), W, H);
    assert_int_equal(found[0], 255);
    free(found);
    /* what stands behind the last pixel is none of the picture */
    float longer[W * H + 1] = {0};
    longer[W * H] = 1;
    const bis_channel guarded = {"", longer, 1};
    bis_picture again = picture;
    again.subject = &guarded;
    assert_true(bis_png_exposure(&again) == bis_png_exposure(&picture));
}

static void channels_may_be_planes_of_their_own(void **state)
{
    float planes[3][W * H];
    for (int i = 0; i < W * H; i++)
        for (int k = 0; k < 3; k++)
            planes[k][i] = k == i % 3;
    const bis_channel channels[3] = {{"R", planes[0], 1}, {"G", planes[1], 1}, {"B", planes[2], 1}};
    const bis_picture picture = {.width = W, .height = H, .full_width = W, .full_height = H, .channels = channels,
                                 .n_channels = 3, .has_exposure = true};
    assert_int_equal(bis_image_write(scratch("p.png"), &picture, NULL), BIS_OK);
    unsigned char *found = read_png(scratch("p.png"), W, H);
    for (int i = 0; i < 3 * W * H; i++)
        assert_int_equal(found[i], i % 3 == i / 3 % 3 ? 255 : 0);
    free(found);
}

/* The bytes of a file of one colour; the caller frees them by bis_free. */
static unsigned char *file_of(rgb colour, size_t *n)
{
    rgb pixels[W * H];
    fill(pixels, colour);
    free(through_png(pixels, true, 0));
    return read_bytes(scratch("a.png"), n);
}

static void the_file_says_that_it_is_srgb(void **state)
{
    size_t n;
    unsigned char *data = file_of((rgb){1, 1, 1}, &n);
    assert_true(memmem(data, n, "sRGB", 4) && memmem(data, n, "gAMA", 4));
    bis_free(data);
}

/* A file of one pixel, code 128, whose gAMA chunk says so many 1/100000. */
static void write_gamma(png_fixed_point encoded)
{
    FILE *out = fopen(scratch("gamma.png"), "wb");
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, out);
    png_set_IHDR(png, info, 1, 1, 8, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    png_set_gAMA_fixed(png, info, encoded);
    png_write_info(png, info);
    png_write_row(png, (png_byte[]){128});
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    fclose(out);
}

/* Of a file without sRGB the chunk counts, from 0.1 to 10: 128/255 to the power of 1 over it; what lies beyond is a
 * slip, and the file is sRGB, whose code 128 is 0.215861. */
static void the_gamma_of_a_file_counts_where_it_can_be_meant(void **state)
{
    static const struct {
        png_fixed_point encoded;
        double value;
    } cases[] = {{9000, 0.215861}, {10000, 0.00101554}, {100000, 0.501961}, {1000000, 0.933398}, {1050000, 0.215861}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bis_image image;
        write_gamma(cases[i].encoded);
        assert_int_equal(
            bis_image_read_colours(&image, scratch("gamma.png"), BIS_GAMMA_FILE, (bis_loc){0}, NULL), BIS_OK);
        if (fabs((double)image.pixels[0].g / cases[i].value - 1) > 1e-5)
            fail_msg("gAMA %d: %.8g", (int)cases[i].encoded, (double)image.pixels[0].g);
        bis_image_clear(&image);
    }
}

/* Numbers that a pixel of this kind has. */
static int samples_of(int kind)
{
    return kind == PNG_COLOR_TYPE_RGB ? 3 : kind == PNG_COLOR_TYPE_RGBA ? 4 : kind == PNG_COLOR_TYPE_GRAY_ALPHA ? 2 : 1;
}

/* Sample k of pixel i, below 2^depth. */
static unsigned sample_of(int i, int k, int depth)
{
    return (unsigned)(i * 7919 + k * 4099 + i * k * 31) % (1u << depth);
}

/* A W x H picture of any kind. Entry j of the palette is 3 j, 250 - j, j. */
static void write_kind(int kind, int depth, bool interlaced)
{
    FILE *out = fopen(scratch("kind.png"), "wb");
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    const int n = samples_of(kind);
    png_byte rows[H][W * 8];
    png_bytep row[H];
    png_color palette[256];
    for (int j = 0; j < 256; j++) palette[j] = (png_color){(png_byte)(3 * j), (png_byte)(250 - j), (png_byte)j};
    for (int i = 0; i < W * H; i++)
        for (int k = 0; k < n; k++) {
            const unsigned v = sample_of(i, k, depth);
            png_byte *const at = rows[i / W] + (i % W * n + k) * (depth == 16 ? 2 : 1);
            at[0] = (png_byte)(depth == 16 ? v >> 8 : v);
            if (depth == 16) at[1] = (png_byte)v;
        }
    for (int y = 0; y < H; y++) row[y] = rows[y];
    png_init_io(png, out);
    png_set_IHDR(png, info, W, H, depth, kind, interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (kind == PNG_COLOR_TYPE_PALETTE) png_set_PLTE(png, info, palette, 1 << depth);
    png_write_info(png, info);
    png_set_packing(png);
    png_write_image(png, row);
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    fclose(out);
}

static const struct { int kind, depth; } kinds[] = {
    {PNG_COLOR_TYPE_GRAY, 1}, {PNG_COLOR_TYPE_GRAY, 2}, {PNG_COLOR_TYPE_GRAY, 4}, {PNG_COLOR_TYPE_GRAY, 8},
    {PNG_COLOR_TYPE_GRAY, 16}, {PNG_COLOR_TYPE_GRAY_ALPHA, 8}, {PNG_COLOR_TYPE_GRAY_ALPHA, 16}, {PNG_COLOR_TYPE_RGB, 8},
    {PNG_COLOR_TYPE_RGB, 16}, {PNG_COLOR_TYPE_RGBA, 8}, {PNG_COLOR_TYPE_RGBA, 16}, {PNG_COLOR_TYPE_PALETTE, 1},
    {PNG_COLOR_TYPE_PALETTE, 2}, {PNG_COLOR_TYPE_PALETTE, 4}, {PNG_COLOR_TYPE_PALETTE, 8}};
enum { N_KINDS = sizeof kinds / sizeof *kinds };

/* With a gamma of 1 a value is its number over the largest. */
static void each_kind_of_png_has_its_colours(void **state)
{
    for (int c = 0; c < 2 * N_KINDS; c++) {
        const int kind = kinds[c / 2].kind, depth = kinds[c / 2].depth;
        bis_image image;
        write_kind(kind, depth, c % 2);
        assert_int_equal(bis_image_read_colours(&image, scratch("kind.png"), 1, (bis_loc){0}, NULL), BIS_OK);
        assert_true(image.width == W && image.height == H);
        for (int i = 0; i < W * H; i++)
            for (int k = 0; k < 3; k++) {
                const int j = (int)sample_of(i, 0, depth), colour[3] = {3 * j % 256, 250 - j, j};
                const double e = kind == PNG_COLOR_TYPE_PALETTE ? (colour[k] & 255) / 255.
                                 : sample_of(i, samples_of(kind) < 3 ? 0 : k, depth) / ((1 << depth) - 1.);
                if (fabs((double)(&image.pixels[i].r)[k] - e) > 1e-6)
                    fail_msg("kind %d of %d bits: channel %d of pixel %d is %g, not %g", kind, depth, k, i,
                             (double)(&image.pixels[i].r)[k], e);
            }
        bis_image_clear(&image);
    }
}

/* White alone, a bit a pixel: deflate makes nearly 1032 bytes of one, and each of them is 24 of our numbers. */
static void a_blank_sheet_of_one_bit_is_read(void **state)
{
    enum { SIDE = 1000 };
    png_byte row[SIDE / 8];
    FILE *out = fopen(scratch("blank.png"), "wb");
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    memset(row, 0xff, sizeof row);
    png_init_io(png, out);
    png_set_IHDR(png, info, SIDE, SIDE, 1, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    png_write_info(png, info);
    for (int y = 0; y < SIDE; y++) png_write_row(png, row);
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    fclose(out);
    bis_image image;
    assert_int_equal(bis_image_read_colours(&image, scratch("blank.png"), 1, (bis_loc){0}, NULL), BIS_OK);
    assert_true(image.width == SIDE && image.height == SIDE);
    for (int i = 0; i < SIDE * SIDE; i++) assert_true(image.pixels[i].r == 1);
    bis_image_clear(&image);
}

static void a_png_is_no_source_of_light(void **state)
{
    size_t n;
    bis_free(file_of((rgb){1, 1, 1}, &n));
    expect_refusal(scratch("a.png"), BIS_INPUT, "it is a PNG: 8 bits for a screen, no radiance; take an .exr, .pfm "
        "or .hdr (`bis SCENE --outfile NAME.exr` writes one)");
}

/* 8 bits there and back: the value is that of the nearest code, half a step off at most. Half a step of sRGB is at most
 * 1/2/255 times its steepest slope, 2.4/1.055 (at 1). */
static void what_was_written_is_read_back_as_colours(void **state)
{
    rgb pixels[W * H];
    bis_image image;
    for (int i = 0; i < W * H; i++) pixels[i] = (rgb){(float)i / (W * H), (float)(i * i) / (W * W * H * H), 1};
    free(through_png(pixels, true, 0));
    keep_as_seed(scratch("a.png"));
    assert_int_equal(bis_image_read_colours(&image, scratch("a.png"), BIS_GAMMA_SRGB, (bis_loc){0}, NULL), BIS_OK);
    assert_true(image.width == W && image.height == H);
    for (int i = 0; i < W * H; i++) {
        const double limit = 0.5 / 255 * 2.4 / 1.055 + 1e-6;
        assert_true(fabs((double)(image.pixels[i].r - pixels[i].r)) < limit);
        assert_true(fabs((double)(image.pixels[i].g - pixels[i].g)) < limit);
        assert_true(image.pixels[i].b == 1);
    }
    bis_image_clear(&image);
}

/* Each prefix without all pixels is refused, and no change of up to four bytes does harm. */
static void damaged_pictures_are_survived(void **state)
{
    uint32_t seed = 5;
    size_t n;
    unsigned char *data = file_of((rgb){0.3f, 0.7f, 0.1f}, &n), changed[4096];
    for (size_t k = 0; k < n + 2000; k++) {
        bis_image image;
        bis_diag diag = {0};
        memcpy(changed, data, n);
        for (uint32_t i = 0; k >= n && i < 1 + next_random(&seed) % 4; i++)
            changed[next_random(&seed) % n] = (unsigned char)next_random(&seed);
        store(scratch("b.png"), changed, k < n ? k : n);
        const bis_status status = bis_image_read_colours(&image, scratch("b.png"), 1, (bis_loc){0}, &diag);
        if (k + 12 < n) assert_int_equal(status, BIS_INPUT); /* the last chunk has 12 bytes */
        assert_true((status == BIS_OK) == (image.pixels != NULL) && (status == BIS_OK) == (diag.n_errors == 0));
        bis_image_clear(&image);
        bis_diag_clear(&diag);
    }
    bis_free(data);
}

/* libpng's own words reach the user: a byte of the pixels is another, so the checksum behind them does not fit. */
static void what_libpng_says_of_damage_is_told(void **state)
{
    bis_image image;
    bis_diag diag = {0};
    size_t n;
    unsigned char *data = file_of((rgb){0.3f, 0.7f, 0.1f}, &n), *const chunk = memmem(data, n, "IDAT", 4);
    assert_non_null(chunk);
    const size_t length = (size_t)chunk[-4] << 24 | (size_t)chunk[-3] << 16 | (size_t)chunk[-2] << 8 | chunk[-1];
    chunk[4 + length] ^= 1;
    store(scratch("b.png"), data, n);
    assert_int_equal(bis_image_read_colours(&image, scratch("b.png"), 1, (bis_loc){0}, &diag), BIS_INPUT);
    if (!strstr(diag.messages[0].text, "the PNG is damaged: IDAT: CRC error")) fail_msg("%s", diag.messages[0].text);
    bis_diag_clear(&diag);
    bis_free(data);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_given_exposure_and_the_srgb_curve_give_the_bytes),
        cmocka_unit_test(the_log_average_lands_on_a_grey_of_18_percent_at_any_brightness),
        cmocka_unit_test(black_nan_and_infinity_do_not_change_the_exposure),
        cmocka_unit_test(the_exposure_is_metered_on_the_subject),
        cmocka_unit_test(channels_may_be_planes_of_their_own),
        cmocka_unit_test(the_file_says_that_it_is_srgb),
        cmocka_unit_test(the_gamma_of_a_file_counts_where_it_can_be_meant),
        cmocka_unit_test(each_kind_of_png_has_its_colours),
        cmocka_unit_test(a_blank_sheet_of_one_bit_is_read),
        cmocka_unit_test(a_png_is_no_source_of_light),
        cmocka_unit_test(what_was_written_is_read_back_as_colours),
        cmocka_unit_test(damaged_pictures_are_survived),
        cmocka_unit_test(what_libpng_says_of_damage_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, scratch_remove);
}
