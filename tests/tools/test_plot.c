/* SPDX-License-Identifier: BSD-2-Clause */
/* Tests of docs/live/plot.js under node: numbers against printf and the program's own words, drawings against places
 * that were worked out by hand. Without node they are skipped. */
#include "base/text.h"
#include "claim.h"
#include "file_help.h"
#include "html_check.h"
#include "program.h"

#include "bis/base/image.h"
#include "bis/files/image_file.h"
#include "bis/thesis/rng.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DIR "build/test_plot"

static char said[1 << 18];

/* What node prints, in `said`. */
static void ask(const char *arguments)
{
    char command[300];
    if (system("command -v node > /dev/null") != 0) {
        print_message("no node here: scripts/setup.sh --web installs it\n");
        skip();
    }
    snprintf(command, sizeof command, "node tests/tools/plot.js %s > " DIR "/said", arguments);
    assert_int_equal(system(command), 0);
    read_text(said, sizeof said, DIR "/said");
}

static int setup(void **state)
{
    program_folder(DIR);
    return 0;
}

/* Halves, quarters and tenths, where rounding is a matter of convention, and numbers of all sizes. */
static double value(bis_rng *rng, int i)
{
    const double v = bis_rng_double(rng);
    if (i % 3 == 0) return floor(4000 * v) / 8;
    if (i % 3 == 1) return floor(4000 * v) / 10;
    return (i % 2 ? -1 : 1) * pow(10, 36 * v - 12);
}

static void numbers_are_printed_as_c_prints_them(void **state)
{
    enum { N = 3000 };
    static char wanted[N][200];
    bis_rng rng;

    bis_rng_init(&rng, 29, 0, 0, 0);
    FILE *f = fopen(DIR "/numbers", "w");
    assert_non_null(f);
    for (int i = 0; i < N; i++) {
        const double v = value(&rng, i);
        const int digits = 1 + i % 6;
        char fixed[64] = "-", percent[BIS_PERCENT], duration[BIS_DURATION];
        fprintf(f, "%.17g %d\n", v, digits);
        if (fabs(v) < 1e20) snprintf(fixed, sizeof fixed, "%.*f", digits, v);
        snprintf(wanted[i], sizeof *wanted, "%.*g|%s|%s|%s", digits, v, fixed, bis_percent(percent, fabs(v)),
                 bis_duration(duration, fabs(v)));
    }
    fclose(f);
    ask("numbers < " DIR "/numbers");
    char *line = strtok(said, "\n");
    for (int i = 0; i < N; i++, line = strtok(NULL, "\n")) assert_string_equal(line, wanted[i]);
}

static void draw(const char *name)
{
    char why[200], arguments[40];
    snprintf(arguments, sizeof arguments, "drawing %s", name);
    ask(arguments);
    if (!html_is_well_formed(said, why, sizeof why)) fail_msg("%s: %s\n%s", name, why, said);
    assert_int_equal(html_count(said, "role=\"img\""), 1);
    assert_int_equal(html_count(said, "</title>"), 1);
}

/* The axis is drawn as M left top V bottom H right. */
static void read_axis(double *left, double *top, double *bottom, double *right)
{
    const char *at = strstr(said, "class=\"p-axis\" d=\"M");
    assert_non_null(at);
    assert_int_equal(sscanf(at, "class=\"p-axis\" d=\"M%lf %lfV%lfH%lf", left, top, bottom, right), 4);
}

static void assert_place(double is, double wanted)
{
    if (!(fabs(is - wanted) <= 0.0051)) fail_msg("%g is not %g", is, wanted); /* written to a hundredth */
}

/* 1, 10, 100 on a logarithmic axis are its start, middle and end; 0 has no logarithm and makes a gap, so that the last
 * point stands alone. */
static void a_line_goes_through_its_places(void **state)
{
    double left, top, bottom, right, x[3], y[3];
    draw("line");
    read_axis(&left, &top, &bottom, &right);
    const char *line = strstr(said, "<g data-series=\"0\"");
    assert_non_null(line);
    assert_int_equal(
        sscanf(strstr(line, " d=\"M"), " d=\"M%lf %lfL%lf %lfM%lf %lf", x, y, x + 1, y + 1, x + 2, y + 2), 6);
    assert_place(x[0], left), assert_place(y[0], top);
    assert_place(x[1], (left + right) / 2), assert_place(y[1], (top + bottom) / 2);
    assert_place(x[2], right), assert_place(y[2], bottom);
    assert_int_equal(html_count(strstr(said, "<g data-series=\"1\""), "data-i="), 1); /* NaN has no place */
    assert_int_equal(html_count(said, "A &amp; B</title>"), 1);
    assert_int_equal(html_count(said, "falls</desc>"), 1);
    assert_int_equal(html_count(said, ">b&lt;</text>"), 1);
    assert_int_equal(html_count(said, "var(--plot-em,"), 2); /* the curve and its line in the legend */
}

static void bars_and_steps_stand_on_the_axis(void **state)
{
    double left, top, bottom, right, x, y, w, h, end, second;
    draw("bars");
    read_axis(&left, &top, &bottom, &right);
    const char *bar = strstr(strstr(said, "<g data-series"), "<rect");
    assert_int_equal(sscanf(bar, "<rect x=\"%lf\" y=\"%lf\" width=\"%lf\" height=\"%lf\"", &x, &y, &w, &h), 4);
    assert_place(x, left + (right - left) / 8), assert_place(w, (right - left) / 4);
    assert_place(y, (top + bottom) / 2), assert_place(y + h, bottom);
    draw("steps");
    read_axis(&left, &top, &bottom, &right);
    const char *steps = strstr(strstr(said, "<g data-series"), " d=\"M");
    assert_int_equal(sscanf(steps, " d=\"M%lf %lfL%lf %lfH%lfL%*f %lfH%lf", &x, &h, &w, &y, &end, &second, &w), 7);
    assert_place(x, left), assert_place(h, bottom), assert_place(y, top), assert_place(end, (left + right) / 2);
    assert_place(second, (top + bottom) / 2), assert_place(w, right);
}

static void what_is_missing_leaves_an_empty_drawing(void **state)
{
    draw("nothing");
    assert_null(strstr(said, "NaN"));
    draw("alone");
    assert_null(strstr(said, "NaN"));
    assert_int_equal(html_count(said, "xmlns=\"http://www.w3.org/2000/svg\""), 1);
    assert_int_equal(html_count(said, "prefers-color-scheme:dark"), 1);
    assert_int_equal(html_count(said, ">here</text>"), 1);
}

/* The ends of the heat, (0.05, 0.03, 0.20) and (1, 0.99, 0.80) of 255; half way is its fourth stop. Night is 5, 5, 13.
 */
static void a_field_has_the_colours_of_its_values(void **state)
{
    ask("drawing pixels");
    assert_string_equal(said, "255 252 204 204 61 77 13 8 51 5 5 13 255 252 204 5 5 13\n");
    draw("field");
    assert_int_equal(html_count(said, "href=\"data:image/png;base64,iVBORw0KGgo"), 1);
    assert_int_equal(html_count(said, "width=\"300\" height=\"200\" preserveAspectRatio"), 1);
}

/* Our own reader, with libpng behind it, checks every sum and length in the file. */
static void a_png_reads_back(void **state)
{
    static const int wanted[6][3] = {
        {255, 252, 204}, {204, 61, 77}, {13, 8, 51}, {5, 5, 13}, {255, 252, 204}, {5, 5, 13}};
    bis_image image;
    ask("drawing png");
    assert_int_equal(system("sed 's/.*,//' " DIR "/said | base64 -d > " DIR "/field.png"), 0);
    assert_int_equal(bis_image_read_colours(&image, DIR "/field.png", 1, (bis_loc){0}, NULL), BIS_OK);
    assert_true(image.width == 3 && image.height == 2);
    for (int i = 0; i < 6; i++) {
        const double code[3] = {
            255 * (double)image.pixels[i].r, 255 * (double)image.pixels[i].g, 255 * (double)image.pixels[i].b};
        for (int k = 0; k < 3; k++) assert_int_equal(lround(code[k]), wanted[i][k]);
    }
    bis_image_clear(&image);
}

/* The elements as SVG 1.1 has them; places have two decimals; capitals of 18 are those of a font of 18/.72 = 25. */
static void a_list_of_shapes_becomes_elements(void **state)
{
    static const char *const parts[] = {
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"320\" height=\"200\" viewBox=\"0 0 320 200\"",
        "<rect x=\"-1\" y=\"2.25\" width=\"30\" height=\"0.5\" fill=\"#ffffff\"/>\n",
        "<rect x=\"0.33\" y=\"0.67\" width=\"1234.57\" height=\"0\" fill=\"#000000\"/>\n",
        "<path d=\"M1 2L1000.5 -4\" stroke=\"#000000\" stroke-width=\"1.5\" fill=\"none\"/>\n",
        "<polyline points=\"0,1 10,2 20.5,3\" stroke=\"#000000\" stroke-width=\"1\" fill=\"none\"/>\n",
        "<circle cx=\"3\" cy=\"4\" r=\"5\" fill=\"#ff0000\"/>\n",
        "<circle cx=\"3\" cy=\"4\" r=\"5\" stroke=\"#0000ff\" stroke-width=\"2\" fill=\"none\"/>\n",
        "<text x=\"30\" y=\"80\" font-size=\"25\" fill=\"#000000\">a&lt;b &amp; &quot;c&quot;</text>\n",
        "<text x=\"30\" y=\"80\" font-size=\"25\" text-anchor=\"middle\" fill=\"#000000\">HIH</text>\n",
        "text-anchor=\"end\"",
        "<image id=\"map\" width=\"30\" height=\"20\"", "href=\"data:image/png;base64,AAAA\"/></defs>\n",
        "<use href=\"#map\" x=\"7\" y=\"8\"/>\n</svg>\n"};
    char why[200];
    const char *at = said;
    ask("drawing list");
    if (!html_is_well_formed(said, why, sizeof why)) fail_msg("%s", why);
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        at = strstr(at, parts[i]);
        if (!at) fail_msg("%s is not in its place in %s", parts[i], said);
    }
}

/* Where each span's base line is above that of the text: the sum of all dy up to it, as a reader of SVG adds them. */
static void exponents_are_raised_and_indices_lowered_to_the_next_blank(void **state)
{
    static const struct {
        const char *letter;
        double lift;
    } wanted[] = {{">A", 0}, {">B<", 5.5}, {"> C<", 0}, {">D<", -2.5}, {">,E", 0}, {">F<", -2.5}, {">)G", 0},
        {">H<", 5.5}, {">I<", -2.5}, {"> J", 0}};
    ask("drawing list");
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
        double sum = 0;
        const char *at = strstr(said, wanted[i].letter);
        if (!at) fail_msg("%s not in %s", wanted[i].letter, said);
        for (const char *p = said; (p = strstr(p, "dy=\"")) && p < at; p++) sum -= atof(p + 4);
        if (!(fabs(sum - wanted[i].lift) < 1e-9)) fail_msg("%s is lifted by %g", wanted[i].letter, sum);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_are_printed_as_c_prints_them),
        cmocka_unit_test(a_line_goes_through_its_places),
        cmocka_unit_test(bars_and_steps_stand_on_the_axis),
        cmocka_unit_test(what_is_missing_leaves_an_empty_drawing),
        cmocka_unit_test(a_field_has_the_colours_of_its_values),
        cmocka_unit_test(a_png_reads_back),
        cmocka_unit_test(a_list_of_shapes_becomes_elements),
        cmocka_unit_test(exponents_are_raised_and_indices_lowered_to_the_next_blank),
    };
    return cmocka_run_group_tests_name("plot", tests, setup, NULL);
}
