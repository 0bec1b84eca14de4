/* SPDX-License-Identifier: BSD-2-Clause */
/* Tests of svg and palette: the elements of a drawing, written by hand as SVG 1.1 has them, and what a reader of XML
 * says of the whole. */
#include "html_check.h"
#include "map_help.h"
#include "out/palette.h"
#include "out/svg.h"

#include "bis/base/mem.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const rgb white = {1, 1, 1}, black = {0, 0, 0};

/* What has been drawn since the last call, to be freed. */
static FILE *paper;
static char *drawn;
static size_t drawn_n;

static FILE *open_paper(void) { return paper = open_memstream(&drawn, &drawn_n); }

static void assert_drawn(const char *wanted)
{
    fclose(paper);
    assert_string_equal(drawn, wanted);
    free(drawn);
}

static void shapes_are_elements(void **state)
{
    (void)state;
    bis_svg_box(open_paper(), -1, 2.25, 30, 0.5, white);
    assert_drawn("<rect x=\"-1\" y=\"2.25\" width=\"30\" height=\"0.5\" fill=\"#ffffff\"/>\n");
    bis_svg_line(open_paper(), 1, 2, 1000.5, -4, 1.5, black);
    assert_drawn("<path d=\"M1 2L1000.5 -4\" stroke=\"#000000\" stroke-width=\"1.5\" fill=\"none\"/>\n");
    bis_svg_disc(open_paper(), 3, 4, 5, (rgb){1, 0, 0});
    assert_drawn("<circle cx=\"3\" cy=\"4\" r=\"5\" fill=\"#ff0000\"/>\n");
    bis_svg_ring(open_paper(), 3, 4, 5, 2, (rgb){0, 0, 1});
    assert_drawn("<circle cx=\"3\" cy=\"4\" r=\"5\" stroke=\"#0000ff\" stroke-width=\"2\" fill=\"none\"/>\n");
    bis_svg_curve(open_paper(), (const double[]){0, 10, 20.5}, (const double[]){1, 2, 3}, 3, 1, black);
    assert_drawn("<polyline points=\"0,1 10,2 20.5,3\" stroke=\"#000000\" stroke-width=\"1\" fill=\"none\"/>\n");
    bis_svg_show(open_paper(), "map", 7, 8);
    assert_drawn("<use href=\"#map\" x=\"7\" y=\"8\"/>\n");
}

static void places_have_two_decimals(void **state)
{
    (void)state;
    bis_svg_box(open_paper(), 1.0 / 3, 2.0 / 3, 1234.567, 1e-9, black);
    assert_drawn("<rect x=\"0.33\" y=\"0.67\" width=\"1234.57\" height=\"0\" fill=\"#000000\"/>\n");
}

/* IEC 61966-2-1: linear 0.21404 is 0.5 of sRGB, 127.5 of 255; 0.002 is on the straight part: 12.92 * 0.002 * 255 =
 * 6.6. What is out of range is cut. */
static void colours_are_written_as_srgb(void **state)
{
    (void)state;
    bis_svg_disc(open_paper(), 0, 0, 1, (rgb){0.2142f, 0.002f, 7});
    assert_drawn("<circle cx=\"0\" cy=\"0\" r=\"1\" fill=\"#8007ff\"/>\n");
    bis_svg_disc(open_paper(), 0, 0, 1, (rgb){-1, 0.2139f, 1});
    assert_drawn("<circle cx=\"0\" cy=\"0\" r=\"1\" fill=\"#007fff\"/>\n");
    bis_svg_disc(open_paper(), 0, 0, 1, bis_palette_srgb(0x12 / 255.0, 0x34 / 255.0, 0xfe / 255.0));
    assert_drawn("<circle cx=\"0\" cy=\"0\" r=\"1\" fill=\"#1234fe\"/>\n");
}

/* Capitals of 18 are those of a font of 18/.72 = 25. */
static void text_stands_where_it_is_put(void **state)
{
    (void)state;
    bis_svg_text(open_paper(), 30, 80, 18, BIS_SVG_LEFT, black, "a<b & \"c\"");
    assert_drawn("<text x=\"30\" y=\"80\" font-size=\"25\" fill=\"#000000\">a&lt;b &amp; &quot;c&quot;</text>\n");
    bis_svg_text(open_paper(), 30, 80, 18, BIS_SVG_MIDDLE, black, "HIH");
    assert_drawn("<text x=\"30\" y=\"80\" font-size=\"25\" text-anchor=\"middle\" fill=\"#000000\">HIH</text>\n");
    bis_svg_text_on(open_paper(), 30, 80, 18, BIS_SVG_RIGHT, white, black, "n");
    assert_drawn("<text x=\"30\" y=\"80\" font-size=\"25\" text-anchor=\"end\" fill=\"#ffffff\" stroke=\"#000000\" "
                 "stroke-width=\"4\" paint-order=\"stroke\">n</text>\n");
}

/* Where each span's base line is above that of the text: the sum of all dy up to it, as a reader of SVG adds them. */
static double lift_of(const char *span)
{
    double sum = 0;
    const char *at = strstr(drawn, span);
    assert_non_null(at);
    for (const char *p = drawn; (p = strstr(p, "dy=\"")) && p < at; p++) sum -= atof(p + 4);
    return sum;
}

static void exponents_are_raised_and_indices_lowered_to_the_next_blank(void **state)
{
    (void)state;
    bis_svg_text(open_paper(), 0, 0, 10, BIS_SVG_LEFT, black, "A^B C`D,E`F)G^H`I^ J");
    fclose(paper);
    static const struct {
        const char *letter;
        double lift;
    } wanted[] = {{">A", 0}, {">B<", 5.5}, {"> C<", 0}, {">D<", -2.5}, {">,E", 0}, {">F<", -2.5}, {">)G", 0}, {">H<", 5.5}, {">I<", -2.5}, {"> J", 0}};
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
        if (!strstr(drawn, wanted[i].letter)) fail_msg("%s not in %s", wanted[i].letter, drawn);
        assert_near(lift_of(wanted[i].letter), wanted[i].lift, 1e-9);
    }
    free(drawn);
}

static void a_drawing_is_well_formed_and_holds_its_pictures(void **state)
{
    (void)state;
    char why[200], page[64] = "<!DOCTYPE html>"; /* the checker of pages wants one */
    bis_image image;
    assert_int_equal(bis_image_init(&image, 3, 2, NULL), BIS_OK);
    for (int i = 0; i < 6; i++) image.pixels[i] = white;
    FILE *svg = open_paper();
    fputs(page, svg);
    bis_svg_begin(svg, 320, 200);
    assert_int_equal(bis_svg_picture(svg, "map", 30, 20, &image, NULL), BIS_OK);
    bis_svg_show(svg, "map", 10, 20);
    bis_svg_text(svg, 1, 2, 10, BIS_SVG_LEFT, black, "\xff<\x01>&' 10^-3, q`L");
    bis_svg_end(svg);
    fclose(paper);
    if (!html_is_well_formed(drawn, why, sizeof why)) fail_msg("%s", why);
    assert_int_equal(html_count(drawn, "<image id=\"map\" width=\"30\" height=\"20\""), 1);
    assert_int_equal(html_count(drawn, "href=\"data:image/png;base64,iVBORw0KGgo"), 1);
    assert_int_equal(html_count(drawn, "width=\"320\" height=\"200\" viewBox=\"0 0 320 200\""), 1);
    assert_int_equal(html_count(drawn, "\xef\xbf\xbd&lt;\xef\xbf\xbd&gt;&amp;&#39;"), 1); /* what XML forbids is U+FFFD */
    free(drawn);
    bis_image_clear(&image);
}

static void every_allocation_of_a_picture_may_fail(void **state)
{
    (void)state;
    bis_image image;
    bis_status status = BIS_NOMEM;
    long k = 0;
    assert_int_equal(bis_image_init(&image, 300, 200, NULL), BIS_OK);
    while (status) {
        bis_diag diag = {0};
        FILE *svg = open_paper();
        bis_mem_fail_at(++k);
        status = bis_svg_picture(svg, "map", 30, 20, &image, &diag);
        const bool failed = bis_mem_count() >= k;
        bis_mem_fail_at(0);
        fclose(paper);
        assert_int_equal(status, failed ? BIS_NOMEM : BIS_OK);
        assert_int_equal(diag.n_errors + diag.n_lost, failed);
        assert_int_equal(html_count(drawn, "<image"), !failed);
        free(drawn);
        bis_diag_clear(&diag);
    }
    assert_true(k > 3);
    bis_image_clear(&image);
}

/* The seven stops of the scale as codes of sRGB, and half way between two stops. */
static void the_scale_of_heat_has_seven_stops(void **state)
{
    (void)state;
    static const struct { double t; const char *code; } cases[] = {
        {0, "#0d0833"}, {1 / 6.0, "#40126e"}, {2 / 6.0, "#87216b"}, {4 / 6.0, "#f2781f"}, {5 / 6.0, "#fac238"}, {1, "#fffccc"},
        {1 / 12.0, "#260d50"}, {5 / 12.0, "#aa2f5c"}, {0.75, "#f69d2b"}, {11 / 12.0, "#fcdf82"}, {-1, "#0d0833"}, {2, "#fffccc"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char wanted[100];
        bis_svg_disc(open_paper(), 0, 0, 1, bis_palette_heat(cases[i].t));
        snprintf(wanted, sizeof wanted, "<circle cx=\"0\" cy=\"0\" r=\"1\" fill=\"%s\"/>\n", cases[i].code);
        assert_drawn(wanted);
    }
    assert_near((double)bis_palette_srgb(0.04, 0.5, 1).r, 0.04 / 12.92, 1e-8); /* the straight part */
    assert_near((double)bis_palette_srgb(0.04, 0.5, 1).g, 0.2140411, 1e-6);
    assert_true(bis_palette_srgb(0, 0.5, 1).b == 1 && bis_palette_srgb(0, 0.5, 1).r == 0);
}

static void hotter_is_lighter(void **state)
{
    (void)state;
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
        cmocka_unit_test(shapes_are_elements),
        cmocka_unit_test(places_have_two_decimals),
        cmocka_unit_test(colours_are_written_as_srgb),
        cmocka_unit_test(text_stands_where_it_is_put),
        cmocka_unit_test(exponents_are_raised_and_indices_lowered_to_the_next_blank),
        cmocka_unit_test(a_drawing_is_well_formed_and_holds_its_pictures),
        cmocka_unit_test(every_allocation_of_a_picture_may_fail),
        cmocka_unit_test(hotter_is_lighter),
        cmocka_unit_test(the_scale_of_heat_has_seven_stops),
    };
    return cmocka_run_group_tests_name("svg", tests, NULL, NULL);
}
