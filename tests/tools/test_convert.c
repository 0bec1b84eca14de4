/* SPDX-License-Identifier: BSD-2-Clause */
/* convert: pictures from format to format, exposure, tone curves; PNGs read. Expected bytes and values are worked out
 * by hand or by libpng. */
#include "bis/files/image_file.h"
#include "claim.h"
#include "image_help.h"
#include "cli/tone.h"
#include "program.h"

#include <math.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DIR "build/test_convert"

enum { W = 4, H = 2 };
static const float values[W * H] = {0, .0009765625f, .125f, .25f, .5f, 1, 2, 1024};

static int make_pictures(void **state)
{
    rgb pixels[W * H];
    program_folder(DIR);
    for (int i = 0; i < W * H; i++) pixels[i] = (rgb){values[i], values[i] / 2, values[i]};
    const bis_image image = {W, H, pixels, NULL};
    assert_int_equal(bis_image_save(&image, DIR "/a.exr", NULL), BIS_OK);
    return 0;
}

/* A picture without loss in all formats of radiance: all values have few digits. */
static void a_picture_goes_round_through_all_formats(void **state)
{
    program_run r;
    bis_image image;
    program_expect(&r, 0, "convert " DIR "/a.exr " DIR "/a.pfm");
    assert_string_equal(r.output, "wrote " DIR "/a.pfm: 4 x 2 pixels\n");
    program_expect(&r, 0, "convert " DIR "/a.pfm " DIR "/a.hdr");
    program_expect(&r, 0, "convert " DIR "/a.hdr " DIR "/b.exr");
    program_expect(&r, 0, "convert " DIR "/b.exr " DIR "/b.pfm --exposure -1");
    assert_int_equal(bis_image_read(&image, DIR "/b.pfm", (bis_loc){0}, NULL), BIS_OK);
    assert_true(image.width == W && image.height == H);
    for (int i = 0; i < W * H; i++)
        assert_true(image.pixels[i].r == values[i] / 2 && image.pixels[i].g == values[i] / 4 &&
                    image.pixels[i].b == values[i] / 2);
    bis_image_clear(&image);
}

/* IEC 61966-2-1's codes of what the curves make of 1/8, 1/2, 1, 2. */
static void a_png_has_the_exposure_and_the_curve(void **state)
{
    static const struct { const char *options; int code[4]; const char *said; } cases[] = {
        {"--exposure 0", {99, 188, 255, 255}, ", exposure 0, tone none\n"},
        {"--exposure 2", {188, 255, 255, 255}, ", exposure 2, tone none\n"},
        /* Y = (.2126 + .3576 + .0722) v = .6424 v: v / (1 + Y): .1157, .3784, .6089, .8754 */
        {"--exposure 0 --tone reinhard", {96, 165, 205, 240}, ", exposure 0, tone reinhard\n"},
        /* (2.51 x^2 + .03 x)/(2.43 x^2 + .59 x + .14): .1713, .6162, .8038, .9149 */
        {"--exposure 0 --tone filmic", {115, 206, 232, 245}, ", exposure 0, tone filmic\n"},
    };
    static const int at[4] = {2, 4, 5, 6};
    program_run r;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        unsigned char found[W * H * 3];
        png_image png = {.version = PNG_IMAGE_VERSION};
        program_expect(&r, 0, "convert " DIR "/a.exr " DIR "/a.png %s", cases[i].options);
        assert_non_null(strstr(r.output, cases[i].said));
        assert_true(png_image_begin_read_from_file(&png, DIR "/a.png"));
        png.format = PNG_FORMAT_RGB;
        assert_true(png_image_finish_read(&png, NULL, found, 0, NULL));
        for (int k = 0; k < 4; k++) {
            if (found[3 * at[k]] != cases[i].code[k])
                fail_msg("%s, value %g: %d", cases[i].options, (double)values[at[k]], found[3 * at[k]]);
        }
    }
}

/* Each channel by itself; of reinhard the luminance is 0.2126 R + 0.7152 G + 0.0722 B; no light or less stays dark. */
static void a_curve_bends_each_channel(void **state)
{
    static const struct { float in[3]; double ev; bis_tone tone; double out[3]; } cases[] = {
        {{0.5f, -1, 4}, 1, BIS_TONE_NONE, {1, -2, 8}}, {{0.5f, 1, 4}, -2, BIS_TONE_NONE, {0.125, 0.25, 1}},
        {{1, 0, 0}, 0, BIS_TONE_REINHARD, {1 / 1.2126, 0, 0}}, {{0, 1, 0}, 0, BIS_TONE_REINHARD, {0, 1 / 1.7152, 0}},
        {{0, 0, 1}, 0, BIS_TONE_REINHARD, {0, 0, 1 / 1.0722}}, {{1, 2, 4}, 0, BIS_TONE_REINHARD, {1 / 2.9318,
         2 / 2.9318, 4 / 2.9318}},
        {{0.25f, 0.5f, 1}, 2, BIS_TONE_REINHARD, {1 / 2.9318, 2 / 2.9318, 4 / 2.9318}},
        {{0, 0, 0}, 0, BIS_TONE_REINHARD, {0, 0, 0}},
        {{-10, 1, 0}, 0, BIS_TONE_REINHARD, {0, 1, 0}},            /* the luminance is below 0 */
        {{-1, 1, 0.5f}, 0, BIS_TONE_REINHARD, {0, 1 / 1.5387, 0.5 / 1.5387}}, /* 1 - 0.2126 + 0.7152 + 0.0361 */
        {{1, -1, 0.5f}, 0, BIS_TONE_REINHARD, {1, 0, 0.5}}, {{0.5f, 1, -1}, 0, BIS_TONE_REINHARD, {0.5 / 1.7493,
         1 / 1.7493, 0}},
        /* (2.51 x^2 + .03 x)/(2.43 x^2 + .59 x + .14) of 1, 2, 4: 2.54/3.16, 10.1/11.04, 40.28/41.38 */
        {{1, 2, 4}, 0, BIS_TONE_FILMIC, {2.54 / 3.16, 10.1 / 11.04, 40.28 / 41.38}},
        {{8, 2, 4}, -1, BIS_TONE_FILMIC, {40.28 / 41.38, 2.54 / 3.16, 10.1 / 11.04}},
        {{-1, 0, 1}, 0, BIS_TONE_FILMIC, {0, 0, 2.54 / 3.16}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        /* the second pixel of three in two rows: all of them are bent */
        rgb pixels[6];
        for (int k = 0; k < 6; k++) pixels[k] = (rgb){cases[i].in[0], cases[i].in[1], cases[i].in[2]};
        bis_image image = {3, 2, pixels, NULL};
        bis_tone_apply(&image, cases[i].ev, cases[i].tone);
        for (int k = 0; k < 6; k++) {
            const double found[3] = {(double)pixels[k].r, (double)pixels[k].g, (double)pixels[k].b};
            for (int c = 0; c < 3; c++)
                if (fabs(found[c] - cases[i].out[c]) > 1e-6)
                    fail_msg("case %zu, pixel %d, channel %d: %g", i, k, c, found[c]);
        }
    }
    for (int c = 0; c < 3; c++) {
        rgb odd = {c == 0 ? INFINITY : 2, c == 1 ? INFINITY : 2, c == 2 ? INFINITY : 2};
        bis_image image = {1, 1, &odd, NULL};
        bis_tone_apply(&image, 1, BIS_TONE_FILMIC);
        assert_true((c == 0 ? odd.g : odd.r) == 2); /* what is not finite stays as it is */
    }
    for (int i = 0; i < BIS_N_TONES; i++) assert_int_equal(bis_tone_find(bis_tone_names[i]), i);
    assert_null(bis_tone_names[BIS_N_TONES]);
}

static void the_curves_are_monotonous_and_end_at_white(void **state)
{
    for (int tone = 0; tone < BIS_N_TONES; tone++) {
        double before = -1;
        for (double v = 1e-4; v < 1e4; v *= 1.1) {
            rgb pixel = rgb_from(v, v, v);
            bis_image image = {1, 1, &pixel, NULL};
            bis_tone_apply(&image, 0, (bis_tone)tone);
            assert_true((double)pixel.g >= before && pixel.r == pixel.g && (tone == BIS_TONE_NONE || pixel.g < 1.04f));
            before = (double)pixel.g;
        }
    }
    rgb odd[3] = {{-1, 0, 0}, {NAN, 1, 1}, {1e38f, 1e38f, 1e38f}};
    bis_image image = {3, 1, odd, NULL};
    bis_tone_apply(&image, 0, BIS_TONE_REINHARD);
    assert_true(odd[0].r == 0 && isnan(odd[1].r) && (double)odd[2].r > .99 && (double)odd[2].r <= 1);
    assert_int_equal(bis_tone_find("filmic"), BIS_TONE_FILMIC);
    assert_int_equal(bis_tone_find("hable"), BIS_N_TONES);
}

/* A PNG without an option is that of bis_image_save, and again itself. */
static void a_png_stays_itself(void **state)
{
    program_run r;
    bis_image image;
    assert_int_equal(bis_image_read(&image, DIR "/a.exr", (bis_loc){0}, NULL), BIS_OK);
    assert_int_equal(bis_image_save(&image, DIR "/saved.png", NULL), BIS_OK);
    bis_image_clear(&image);
    program_expect(&r, 0, "convert " DIR "/a.exr " DIR "/b.png");
    program_expect(&r, 0, "convert " DIR "/b.png " DIR "/c.png");
    program_expect(&r, 0, "compare --tolerance 0 " DIR "/b.png " DIR "/saved.png");
    program_expect(&r, 0, "compare --tolerance 0 " DIR "/c.png " DIR "/b.png");
    assert_string_equal(r.messages, "");
    program_expect(&r, 0, "convert " DIR "/c.png " DIR "/c.exr");
    assert_string_equal(
        r.messages, DIR "/c.png: warning: it holds what a screen shows, exposed and clipped, no radiance\n");
    program_expect(&r, 0, "compare " DIR "/c.exr " DIR "/c.png");
    assert_string_equal(r.messages,
        DIR "/c.png: warning: it holds what a screen shows, exposed and clipped: compare it with another such\n");
    assert_non_null(strstr(r.output, "max_abs 0\n"));
}

/* Of libpng's own making: grey, a palette's worth of colours with alpha, 16 bit. */
static void any_png_is_read_as_linear_colours(void **state)
{
    bis_image image;
    bool is_screen;
    const unsigned char grey[2] = {0, 188}, clear[8] = {255, 255, 255, 0, 188, 0, 255, 255};
    const unsigned short deep[3] = {65535, 32768, 0};
    const struct { png_uint_32 format; int width; const void *data; } files[] = {
        {PNG_FORMAT_GRAY, 2, grey}, {PNG_FORMAT_RGBA, 2, clear}, {PNG_FORMAT_LINEAR_RGB, 1, deep}};
    for (int i = 0; i < 3; i++) {
        png_image png = {
            .version = PNG_IMAGE_VERSION, .width = (png_uint_32)files[i].width, .height = 1, .format = files[i].format};
        assert_true(png_image_write_to_file(&png, scratch("x.png"), 0, files[i].data, 0, NULL));
        keep_as_seed(scratch("x.png"));
        assert_int_equal(bis_image_read_any(&image, &is_screen, scratch("x.png"), (bis_loc){0}, NULL), BIS_OK);
        assert_true(is_screen && image.width == files[i].width && image.height == 1);
        const rgb c = image.pixels[image.width - 1];
        if (i == 0) assert_true(image.pixels[0].g == 0 && fabs((double)c.r - .5) < .01 && c.r == c.b); /* 188: 0.503 */
        if (i == 1) assert_true(image.alpha[0] == 0 && image.pixels[0].r == 0 && image.alpha[1] == 1);
        if (i == 1) assert_true(fabs((double)c.r - .5) < .01 && c.g == 0 && c.b == 1);
        if (i == 2) assert_true(c.r == 1 && fabs((double)c.g - .5) < .01 && c.b == 0);
        bis_image_clear(&image);
    }
    expect_refusal(scratch("x.png"), BIS_INPUT,
        "it is a PNG: 8 bits for a screen, no radiance; take an .exr, .pfm or .hdr "
        "(`bis SCENE --outfile NAME.exr` writes one)"); /* still no map */
}

static void bad_pngs_and_usage_are_named(void **state)
{
    program_run r;
    FILE *f = fopen(DIR "/b.png", "rb");
    unsigned char data[4096];
    const size_t n = fread(data, 1, sizeof data, f);
    fclose(f);
    for (size_t cut = 4; cut < n - 12; cut += 7) { /* the last chunk has no pixels */
        bis_image image;
        bis_diag diag = {0};
        bool is_screen;
        store(scratch("cut.png"), data, cut);
        is_screen = true;
        assert_int_equal(bis_image_read_any(&image, &is_screen, "no-such-file.png", (bis_loc){0}, NULL), BIS_IO);
        assert_false(is_screen);
        assert_int_equal(bis_image_read_any(&image, &is_screen, scratch("cut.png"), (bis_loc){0}, &diag), BIS_INPUT);
        assert_true(diag.n_errors == 1 && strstr(diag.messages[0].text, "the PNG is damaged: ") && !image.pixels);
        bis_diag_clear(&diag);
    }
    program_expect(&r, 1, "convert " DIR "/none.exr " DIR "/b.png");
    program_expect(&r, 2, "convert " DIR "/a.exr " DIR "/b.gif");
    program_expect(&r, 2, "convert " DIR "/a.exr " DIR "/b.exr --tone filmic");
    assert_string_equal(
        r.messages, "bis: error: --tone is for a .png: the other formats hold radiance, which a curve would spoil\n");
    program_expect(&r, 2, "convert " DIR "/a.exr " DIR "/a.exr");
    program_expect(&r, 2, "convert " DIR "/a.exr");
    program_expect(&r, 2, "convert " DIR "/a.exr " DIR "/b.png --tone loud");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_picture_goes_round_through_all_formats),
        cmocka_unit_test(a_png_has_the_exposure_and_the_curve),
        cmocka_unit_test(the_curves_are_monotonous_and_end_at_white),
        cmocka_unit_test(a_curve_bends_each_channel),
        cmocka_unit_test(a_png_stays_itself),
        cmocka_unit_test(any_png_is_read_as_linear_colours),
        cmocka_unit_test(bad_pngs_and_usage_are_named),
    };
    return cmocka_run_group_tests(tests, make_pictures, scratch_remove);
}
