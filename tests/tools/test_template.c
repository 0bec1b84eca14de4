/* SPDX-License-Identifier: BSD-2-Clause */
/* Tests of template and markup: pages and values written by hand, and what must come of them. */
#include "map_help.h"
#include "out/json.h"
#include "out/markup.h"
#include "out/template.h"

#include "bis/base/file.h"
#include "bis/base/mem.h"
#include "bis/files/image_file.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* The values: written by bis_json, as everywhere. */
static char *values(void)
{
    char *text = NULL;
    size_t n;
    FILE *out = open_memstream(&text, &n);
    bis_json j = {.out = out};

    bis_json_open(&j, NULL, '{');
    bis_json_text(&j, "odd", "\"</b>&'\\ {[,]} \xc3\xa9 \xff \x01 x");
    bis_json_number(&j, "half", 0.5);
    bis_json_count(&j, "zero", 0);
    bis_json_bool(&j, "yes", true);
    bis_json_bool(&j, "no", false);
    bis_json_null(&j, "nothing");
    bis_json_text(&j, "empty", "");
    bis_json_open(&j, "none", '[');
    bis_json_close(&j);
    bis_json_open(&j, "words", '[');
    bis_json_text(&j, NULL, "a,b");
    bis_json_text(&j, NULL, "c]");
    bis_json_number(&j, NULL, 3);
    bis_json_number(&j, NULL, -4);
    bis_json_close(&j);
    bis_json_open(&j, "rows", '[');
    for (int i = 1; i <= 2; i++) {
        bis_json_open(&j, NULL, '{');
        bis_json_count(&j, "half", (uint64_t)(10 * i)); /* the same name as outside */
        bis_json_open(&j, "cells", '[');
        for (int k = 0; k < i; k++) bis_json_count(&j, NULL, (uint64_t)(10 * i + k));
        bis_json_close(&j);
        bis_json_close(&j);
    }
    bis_json_close(&j);
    bis_json_open(&j, "box", '{');
    bis_json_text(&j, "half", "inside");
    bis_json_close(&j);
    bis_json_text(&j, "last", "end");
    bis_json_close(&j);
    fclose(out);
    return text;
}

static bis_status filled(char **text, const char *page, bis_diag *diag)
{
    char *json = values();
    size_t n;
    FILE *out = open_memstream(text, &n);
    const bis_status status = bis_template_fill(out, page, json, diag);
    fclose(out);
    free(json);
    return status;
}

static const struct {
    const char *page, *wanted;
} cases[] = {
    {"", ""},
    {"no hole: [ ] < > /* */ ]]", "no hole: [ ] < > /* */ ]]"},
    {"[[half|7]][[last|x]]", "0.5end"},
    {"<p title=\"[[half|a b: c]]\">[[zero|]]</p>", "<p title=\"0.5\">0</p>"},
    {"[[odd|x]]", "&quot;&lt;/b&gt;&amp;&#39;\\ {[,]} \xc3\xa9 \xef\xbf\xbd \xef\xbf\xbd x"},
    {"a<!-- [[unknown|x]] -->b<!---->c", "abc"},
    {"<!--each yes-->[[half|x]]<!--end yes-->", "0.5"},
    {"<!--each no-->A<!--end no-->.<!--each no-->A<!--else no-->B<!--end no-->", ".B"},
    {"<!--each yes-->A<!--else yes-->B<!--end yes-->", "A"},
    {"<!--each nothing-->A<!--else nothing-->B<!--end nothing-->", "B"},
    {"<!--each empty-->A<!--else empty-->B<!--end empty-->", "B"},
    {"<!--each none-->A<!--else none-->B<!--end none-->", "B"},
    {"<!--each zero-->A<!--else zero-->B<!--end zero-->", "B"},
    {"<!--each half-->A<!--else half-->B<!--end half-->", "A"},
    {"<!--each words-->([[.|x]])<!--end words-->", "(a,b)(c])(3)(-4)"},
    {"<!--each rows-->[[half|x]]:<!--each cells--> [[.|y]]<!--end cells-->;<!--end rows-->", "10: 10;20: 20 21;"},
    {"<!--each box-->[[half|x]]<!--end box-->", "inside"},
    {"/*each words*/a{b:[[.|c]]}/*end words*//* kept */", "a{b:a,b}a{b:c]}a{b:3}a{b:-4}/* kept */"},
    {"<!--each no-->A<!--each yes-->B<!--else yes-->C<!--end yes--><!--else no-->D<!--end no-->", "D"},
};

static void pages_are_filled_as_by_hand(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char *text;
        assert_int_equal(filled(&text, cases[i].page, NULL), BIS_OK);
        assert_string_equal(text, cases[i].wanted);
        free(text);
    }
}

static void a_mistake_in_a_page_is_told_by_its_name(void **state)
{
    static const char *const wrong[] = {"[[unknown|x]]", "<!--each unknown-->A<!--end unknown-->",
                                        "<!--each yes-->[[half|x]] unknown", "<!--each rows-->[[unknown|x]]<!--end rows-->"};
    (void)state;
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        char *text;
        bis_diag diag = {0};
        assert_int_equal(filled(&text, wrong[i], &diag), BIS_INPUT);
        assert_int_equal(diag.n, 1);
        assert_non_null(strstr(diag.messages[0].text, i == 2 ? "\"yes\"" : "\"unknown\""));
        bis_diag_clear(&diag);
        free(text);
    }
}

/* Bytes from base64, by RFC 4648's own table of digits. Returns their number. */
static size_t decoded(unsigned char *to, const char *text)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    size_t n = 0;
    unsigned long bits = 0;
    for (size_t i = 0; text[i] && text[i] != '='; i++) {
        assert_non_null(strchr(digits, text[i]));
        bits = bits << 6 | (unsigned long)(strchr(digits, text[i]) - digits);
        if (i % 4 > 0) to[n++] = (unsigned char)(bits >> (6 - 2 * (i % 4)));
    }
    return n;
}

/* What stands in the page is the file that bis_image_write would make. */
static void a_picture_in_the_page_is_that_of_the_file(void **state)
{
    (void)state;
    unsigned paddings = 0;

    for (int width = 1; width < 40; width++) {
        bis_image image;
        unsigned char *file, here[1024];
        size_t size;
        assert_int_equal(bis_image_init(&image, width, 1, NULL), BIS_OK);
        for (int i = 0; i < width; i++) image.pixels[i] = (rgb){0.01f * (float)(i * i * 37 % 101), 0.5f, 0.02f * (float)i};
        char *text = bis_markup_png(&image, 0, NULL);
        assert_int_equal(bis_image_save_colours(&image, "build/test_template.png", NULL), BIS_OK);
        assert_int_equal(bis_file_read(&file, &size, "build/test_template.png", (bis_loc){0}, NULL), BIS_OK);
        assert_int_equal(strncmp(text, "data:image/png;base64,", 22), 0);
        assert_int_equal((strlen(text) - 22) % 4, 0);
        assert_int_equal(decoded(here, text + 22), size);
        assert_memory_equal(here, file, size);
        paddings |= 1u << size % 3;
        bis_free(file);
        free(text);
        bis_image_clear(&image);
    }
    assert_int_equal(paddings, 7); /* each number of '=' was met */
}

/* UTF-8 of one to four bytes stays; what is cut off at the end, or no UTF-8, becomes U+FFFD, byte by byte. */
static void texts_are_utf8(void **state)
{
    static const char *const rows[][2] = {
        {"a\xc3\xa9\xe2\x82\xac\xf0\x9f\x99\x82", "a\xc3\xa9\xe2\x82\xac\xf0\x9f\x99\x82"},
        {"x\xc3", "x\\ufffd"},
        {"x\xe2\x82", "x\\ufffd\\ufffd"},
        {"\xa9z", "\\ufffdz"},
    };

    (void)state;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char *text = NULL, expected[64];
        size_t n;
        FILE *out = open_memstream(&text, &n);
        bis_json j = {.out = out};
        bis_json_text(&j, NULL, rows[i][0]);
        fclose(out);
        snprintf(expected, sizeof expected, "\"%s\"", rows[i][1]);
        assert_non_null(strstr(text, expected));
        free(text);
    }
}

/* What the writer makes, letter by letter (RFC 8259). */
static void json_is_written_as_by_hand(void **state)
{
    static const char wanted[] =
        "{\n"
        "  \"a \\\"key\\\"\": -0.25,\n"
        "  \"list\": [\n"
        "    1,\n"
        "    null,\n"
        "    null,\n"
        "    null,\n"
        "    \"\\\\ \\u0009\\u001f\\u007f ~\\ufffd\\ufffd\xc3\xa9\xe2\x82\xac\xf0\x9f\x98\x80\",\n"
        "    [],\n"
        "    {\n"
        "      \"x\": true\n"
        "    },\n"
        "    {}\n"
        "  ],\n"
        "  \"triple\": [\n"
        "    1.5,\n"
        "    -2,\n"
        "    1e+300\n"
        "  ],\n"
        "  \"object\": {\n"
        "    \"b\": 0.1,\n"
        "    \"c\": 3\n"
        "  },\n"
        "  \"most\": 18446744073709551615,\n"
        "  \"no\": false,\n"
        "  \"none\": null,\n"
        "  \"gone\": null\n"
        "}\n";
    char *text = NULL;
    size_t n;
    FILE *out = open_memstream(&text, &n);
    bis_json j = {.out = out};

    (void)state;
    bis_json_open(&j, NULL, '{');
    bis_json_number(&j, "a \"key\"", -0.25);
    bis_json_open(&j, "list", '[');
    bis_json_count(&j, NULL, 1);
    bis_json_number(&j, NULL, (double)NAN);
    bis_json_number(&j, NULL, HUGE_VAL);
    bis_json_number(&j, NULL, -HUGE_VAL);
    bis_json_text(&j, NULL, "\\ \t\x1f\x7f ~\xff\x80\xc3\xa9\xe2\x82\xac\xf0\x9f\x98\x80");
    bis_json_open(&j, NULL, '[');
    bis_json_close(&j);
    bis_json_open(&j, NULL, '{');
    bis_json_bool(&j, "x", true);
    bis_json_close(&j);
    bis_json_open(&j, NULL, '{');
    bis_json_close(&j);
    bis_json_close(&j);
    bis_json_triple(&j, "triple", 1.5, -2, 1e300);
    BIS_JSON_OBJECT(&j, "object", {"b", 0.1}, {"c", 3});
    bis_json_count(&j, "most", UINT64_MAX);
    bis_json_bool(&j, "no", false);
    bis_json_null(&j, "none");
    bis_json_text(&j, "gone", NULL);
    bis_json_close(&j);
    fclose(out);
    assert_string_equal(text, wanted);
    free(text);
}

/* Each of the 256 bytes alone, and a character at the end of what is to be printed. */
static void each_byte_of_a_text_is_itself_an_entity_or_replaced(void **state)
{
    static const struct { const char *text, *wanted; size_t n; } ends[] = {
        {"\xe2\x82\xac", "\xe2\x82\xac", 3}, {"\xe2\x82\xac", "\xef\xbf\xbd\xef\xbf\xbd", 2}, {"a&b", "a", 1}, {"a&b", "a&amp;", 2},
        {"\xc3\xa9<", "\xc3\xa9&lt;", 3}, {"\xed\xa0\x80", "\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd", 3}, {"x", "", 0}};
    char *text, wanted[8];
    size_t n;

    (void)state;
    for (int c = 0; c < 256; c++) {
        const char byte = (char)c;
        const char *entity = c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '"' ? "&quot;" : c == '\'' ? "&#39;" : NULL;
        FILE *out = open_memstream(&text, &n);
        bis_markup_text(out, &byte, 1);
        fclose(out);
        snprintf(wanted, sizeof wanted, "%c", c);
        assert_string_equal(text, entity ? entity : c < 32 || c >= 127 ? "\xef\xbf\xbd" : wanted);
        free(text);
    }
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
        FILE *out = open_memstream(&text, &n);
        bis_markup_text(out, ends[i].text, ends[i].n);
        fclose(out);
        assert_string_equal(text, ends[i].wanted);
        free(text);
    }
}

/* Twice as bright are the codes of twice the radiance (IEC 61966-2-1: 0.25 is 137, 0.5 is 188, 1 is 255). */
static void the_exposure_of_a_picture_is_seen_in_its_codes(void **state)
{
    static const char *const path = "build/test_template.png";
    static const int exposures[] = {0, 1, 2};
    static const double codes[][3] = {{137, 188, 0}, {188, 255, 0}, {255, 255, 0}};

    (void)state;
    for (int i = 0; i < 3; i++) {
        bis_image image;
        unsigned char bytes[1024];
        assert_int_equal(bis_image_init(&image, 2, 1, NULL), BIS_OK);
        for (int k = 0; k < 2; k++) image.pixels[k] = (rgb){0.25f, 0.5f, 0};
        char *text = bis_markup_png(&image, exposures[i], NULL);
        bis_image_clear(&image);
        FILE *out = fopen(path, "wb");
        assert_non_null(out);
        fwrite(bytes, 1, decoded(bytes, text + 22), out);
        fclose(out);
        free(text);
        assert_int_equal(bis_image_read_colours(&image, path, 1, (bis_loc){0}, NULL), BIS_OK);
        for (int k = 0; k < 2; k++) {
            assert_near(255 * (double)image.pixels[k].r, codes[i][0], 1e-3);
            assert_near(255 * (double)image.pixels[k].g, codes[i][1], 1e-3);
            assert_near(255 * (double)image.pixels[k].b, codes[i][2], 1e-3);
        }
        bis_image_clear(&image);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pages_are_filled_as_by_hand),
        cmocka_unit_test(json_is_written_as_by_hand),
        cmocka_unit_test(each_byte_of_a_text_is_itself_an_entity_or_replaced),
        cmocka_unit_test(the_exposure_of_a_picture_is_seen_in_its_codes),
        cmocka_unit_test(a_mistake_in_a_page_is_told_by_its_name),
        cmocka_unit_test(a_picture_in_the_page_is_that_of_the_file),
        cmocka_unit_test(texts_are_utf8),
    };
    return cmocka_run_group_tests_name("template", tests, NULL, NULL);
}
