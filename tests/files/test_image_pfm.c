/* SPDX-License-Identifier: BSD-2-Clause */
/* PFM: both byte orders, rows from the bottom up, a header without tolerance. */
#include "bis/files/image_file.h"
#include "claim.h"
#include "image_help.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void put_float_high_first(bytes *b, float v)
{
    uint32_t bits;
    memcpy(&bits, &v, sizeof bits);
    for (int i = 3; i >= 0; i--)
        put_int(b, bits >> 8 * i & 255, 1);
}

/* A 2 x 2 file whose value in row y (from the top), column x, channel k is 100 y + 10 x + k. */
static void put_pfm(bytes *file, const char *magic, const char *scale, int channels, bool high_first)
{
    put_text(file, magic);
    put_text(file, "\n2 2\n");
    put_text(file, scale);
    put_text(file, "\n");
    for (int y = 1; y >= 0; y--)
        for (int i = 0; i < 2 * channels; i++) {
            float v = (float)(100 * y + 10 * (i / channels) + i % channels);
            high_first ? put_float_high_first(file, v) : put_float(file, v);
        }
}

static void colour_and_grey_of_both_byte_orders_run_from_the_bottom_row_up(void **state)
{
    const char *const scales[] = {"-1", "1.0", "-0.003", "255"}; /* the size of the scale is ignored */
    for (int grey = 0; grey < 2; grey++)
        for (int i = 0; i < 4; i++) {
            bytes file = {0};
            bis_image image;
            put_pfm(&file, grey ? "Pf" : "PF", scales[i], grey ? 1 : 3, scales[i][0] != '-');
            store(scratch("a.pfm"), file.data, file.n);
            expect_image(&image, scratch("a.pfm"), NULL);
            for (int y = 0; y < 2; y++)
                for (int x = 0; x < 2; x++) {
                    rgb v = image.pixels[2 * y + x];
                    float first = (float)(100 * y + 10 * x);
                    assert_true(v.r == first && v.g == first + (grey ? 0 : 1) && v.b == first + (grey ? 0 : 2));
                }
            bis_image_clear(&image);
            bytes_clear(&file);
        }
}

static void any_float_comes_back_bit_by_bit(void **state)
{
    const float odd[] = {0, -0.0f, NAN, INFINITY, -INFINITY, -1, 1e-45f, 3.4e38f};
    bis_image image, back;
    assert_int_equal(bis_image_init(&image, 37, 5, NULL), BIS_OK);
    for (size_t i = 0; i < 37 * 5; i++)
        image.pixels[i] = (rgb){odd[i % 8], (float)i / 3, odd[(i / 8) % 8]};
    assert_int_equal(bis_image_save(&image, scratch("b.pfm"), NULL), BIS_OK);
    expect_image(&back, scratch("b.pfm"), NULL);
    assert_int_equal(back.width, 37);
    assert_int_equal(back.height, 5);
    assert_memory_equal(image.pixels, back.pixels, 37 * 5 * sizeof(rgb));
    bis_image_clear(&image);
    bis_image_clear(&back);
}

#define NO_SIZE(header) {BYTES(header), "the PFM header must give width and height, each 1 to 32768"}
#define NO_SCALE(line) {BYTES("PF\n1 1\n" line), "the PFM header's scale must be a number other than 0 and one white " \
    "space (its sign is the byte order: -1 for the low byte first)"}

/* The pixels must be there. */
static const bad_file bad[] = {
    NO_SIZE("PF\n"), NO_SIZE("PF\n2"), NO_SIZE("PF\n2 \n-1\n"), NO_SIZE("PF\n0 2\n-1\n"), NO_SIZE("PF\n2 -2\n-1\n"),
    NO_SIZE("PF\n2 99999999999\n-1\n"), NO_SIZE("PF\n# remark\n2 2\n-1\n"), NO_SIZE("PF\n2x 2\n-1\n"),
    NO_SIZE("PF\n32769 1\n-1\n"), NO_SIZE("PF\n1 32769\n-1\n"), NO_SIZE("PF\n2 0\n-1\n"), NO_SIZE("PF\nx 2\n-1\n"),
    NO_SIZE("PF\n2 2x\n-1\n"),
    NO_SCALE(""), NO_SCALE("0\n"), NO_SCALE("-0.0\n"), NO_SCALE("nan\n"), NO_SCALE("inf\n"), NO_SCALE("abc\n"),
    NO_SCALE("-1"), NO_SCALE("-1x\n"),
    {BYTES("PF\n1 1\n-1\n0123456789a"),
     "1 x 1 pixels of 12 bytes are 12 bytes, but 11 follow the header (which ends at byte 10)"},
    {BYTES("Pf\n32768 32768\n-1\n0123"),
     "32768 x 32768 pixels of 4 bytes are 4294967296 bytes, but 4 follow the header (which ends at byte 18)"},
};

static void a_bad_header_or_length_is_refused(void **state)
{
    expect_refusals(bad, sizeof bad / sizeof *bad, "bad.pfm");
}

static void no_damage_leads_out_of_the_file(void **state)
{
    bytes file = {0};
    put_pfm(&file, "PF", "-1.0", 3, false);
    try_damage(&file, "damaged.pfm", 2000, 5);
    bytes_clear(&file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(colour_and_grey_of_both_byte_orders_run_from_the_bottom_row_up),
        cmocka_unit_test(any_float_comes_back_bit_by_bit),
        cmocka_unit_test(a_bad_header_or_length_is_refused),
        cmocka_unit_test(no_damage_leads_out_of_the_file),
    };
    return cmocka_run_group_tests(tests, NULL, scratch_remove);
}
