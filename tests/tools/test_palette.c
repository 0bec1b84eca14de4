/* SPDX-License-Identifier: BSD-2-Clause */
/* Tests of palette: its stops as they appear, and that hotter is lighter. */
#include "claim.h"
#include "map_help.h"
#include "out/palette.h"

#include <string.h>

/* The seven stops of the scale as codes of sRGB, and half way between two stops; a code is off by half at most. */
static void the_scale_of_heat_has_seven_stops(void **state)
{
    static const struct { double t; int code[3]; } cases[] = {
        {0, {0x0d, 0x08, 0x33}}, {1 / 6.0, {0x40, 0x12, 0x6e}}, {2 / 6.0, {0x87, 0x21, 0x6b}},
        {4 / 6.0, {0xf2, 0x78, 0x1f}},
        {5 / 6.0, {0xfa, 0xc2, 0x38}}, {1, {0xff, 0xfc, 0xcc}}, {1 / 12.0, {0x26, 0x0d, 0x50}},
        {5 / 12.0, {0xaa, 0x2f, 0x5c}},
        {0.75, {0xf6, 0x9d, 0x2b}}, {11 / 12.0, {0xfc, 0xdf, 0x82}}, {-1, {0x0d, 0x08, 0x33}}, {2, {0xff, 0xfc, 0xcc}}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const int *c = cases[i].code;
        const rgb is = bis_palette_heat(cases[i].t),
                  lo = bis_palette_srgb((c[0] - 0.51) / 255, (c[1] - 0.51) / 255, (c[2] - 0.51) / 255);
        const rgb hi = bis_palette_srgb((c[0] + 0.51) / 255, (c[1] + 0.51) / 255, (c[2] + 0.51) / 255);
        assert_true(is.r >= lo.r && is.r <= hi.r && is.g >= lo.g && is.g <= hi.g && is.b >= lo.b && is.b <= hi.b);
    }
    assert_near((double)bis_palette_srgb(0.04, 0.5, 1).r, 0.04 / 12.92, 1e-8); /* the straight part */
    assert_near((double)bis_palette_srgb(0.04, 0.5, 1).g, 0.2140411, 1e-6);
    assert_true(bis_palette_srgb(0, 0.5, 1).b == 1 && bis_palette_srgb(0, 0.5, 1).r == 0);
}

static void hotter_is_lighter(void **state)
{
    double last = -1;
    for (int i = 0; i <= 1000; i++) {
        const rgb c = bis_palette_heat(i / 1000.0);
        const double grey = 0.2126 * (double)c.r + 0.7152 * (double)c.g + 0.0722 * (double)c.b;
        assert_true(grey > last);
        last = grey;
    }
    assert_true(memcmp(&(rgb){bis_palette_heat(-3).r, bis_palette_heat(-3).g, bis_palette_heat(-3).b},
                       &(rgb){bis_palette_heat(0).r, bis_palette_heat(0).g, bis_palette_heat(0).b}, sizeof(rgb)) == 0);
    assert_near((double)bis_palette_srgb(0.5, 0, 0).r, 0.21404, 1e-5); /* IEC 61966-2-1 */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hotter_is_lighter),
        cmocka_unit_test(the_scale_of_heat_has_seven_stops),
    };
    return cmocka_run_group_tests_name("palette", tests, NULL, NULL);
}
