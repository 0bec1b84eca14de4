/* SPDX-License-Identifier: BSD-2-Clause */
/* Tests of page and json: pages filled by hand, JSON letter by letter, pictures read back. */
#include "claim.h"
#include "map_help.h"
#include "out/json.h"
#include "out/page.h"

#include "bis/base/file.h"
#include "bis/base/mem.h"
#include "bis/files/image_file.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define TEXT "<pre id=\"text\">"
#define DATA "<script type=\"application/json\" id=\"data\">"

static bis_status filled(char **text, const char *page, const char *json, const char *words, bis_diag *diag)
{
    size_t n;
    FILE *out = open_memstream(text, &n);
    const bis_status status = bis_page_write(out, page, json, words, diag);
    fclose(out);
    return status;
}

/* Both places are filled and nothing else is touched. In the data a < is an escape, which reads back as itself. */
static void a_page_gets_its_data_and_its_text(void **state)
{
    char *text;
    assert_int_equal(
        filled(&text, "<p>null" TEXT "</pre>" DATA "null</script>null", "{\"a\": \"</script>\"}\n", "a < b\n", NULL),
        BIS_OK);
    assert_string_equal(text, "<p>null" TEXT "a &lt; b\n</pre>" DATA "{\"a\": \"\\u003c/script>\"}\n</script>null");
    free(text);
}

static void a_page_without_a_place_is_refused(void **state)
{
    static const char *const pages[] = {"", TEXT "</pre>", DATA "null</script>"};
    for (size_t i = 0; i < sizeof pages / sizeof *pages; i++) {
        char *text;
        bis_diag diag = {0};
        assert_int_equal(filled(&text, pages[i], "{}", "", &diag), BIS_INPUT);
        assert_int_equal(diag.n, 1);
        assert_non_null(strstr(diag.messages[0].text, "no place"));
        bis_diag_clear(&diag);
        free(text);
    }
}

static void a_page_without_a_place_leaves_no_file(void **state)
{
    static const char path[] = "build/test_page.html";
    bis_page p;
    bis_diag diag = {0};
    unlink(path);
    assert_int_equal(bis_page_begin(&p, "a page", &diag), BIS_OK);
    assert_int_equal(bis_page_end(&p, BIS_OK, path, TEXT "</pre>", "a page", &diag), BIS_INPUT);
    assert_int_equal(access(path, F_OK), -1);
    bis_diag_clear(&diag);
}

/* Each of the 255 bytes that a text may hold alone; UTF-8 of one to four bytes stays. */
static void each_byte_of_a_text_is_itself_an_entity_or_replaced(void **state)
{
    static const char *const rows[][2] = {{"\xe2\x82\xac", "\xe2\x82\xac"}, {"\xe2\x82", "\xef\xbf\xbd\xef\xbf\xbd"},
        {"\xc3\xa9<", "\xc3\xa9&lt;"}, {"\xed\xa0\x80", "\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd"}, {"", ""}};
    char *text, wanted[200], letter[8];

    for (int c = 1; c < 256 + 5; c++) {
        const char byte[2] = {(char)c, 0}, *const entity = c == '&'   ? "&amp;"
                                                           : c == '<' ? "&lt;"
                                                           : c == '>' ? "&gt;"
                                                                      : NULL;
        const char *const is = c < 256 ? byte : rows[c - 256][0];
        snprintf(letter, sizeof letter, "%c", c);
        const char *const becomes = c >= 256                            ? rows[c - 256][1]
                                    : entity                            ? entity
                                    : c == '\n' || (c >= 32 && c < 127) ? letter
                                                                        : "\xef\xbf\xbd";
        snprintf(wanted, sizeof wanted, TEXT "%s</pre>" DATA "1</script>", becomes);
        assert_int_equal(filled(&text, TEXT "</pre>" DATA "null</script>", "1", is, NULL), BIS_OK);
        assert_string_equal(text, wanted);
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
    unsigned paddings = 0;

    for (int width = 1; width < 40; width++) {
        bis_image image;
        unsigned char *file, here[1024];
        size_t size;
        assert_int_equal(bis_image_init(&image, width, 1, NULL), BIS_OK);
        for (int i = 0; i < width; i++)
            image.pixels[i] = (rgb){0.01f * (float)(i * i * 37 % 101), 0.5f, 0.02f * (float)i};
        char *text = bis_page_png(&image, 0, NULL);
        assert_int_equal(bis_image_save_colours(&image, "build/test_page.png", NULL), BIS_OK);
        assert_int_equal(bis_file_read(&file, &size, "build/test_page.png", (bis_loc){0}, NULL), BIS_OK);
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

static const char json_by_hand[] =
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

/* What the writer makes, letter by letter (RFC 8259). */
static void json_is_written_as_by_hand(void **state)
{
    char *text = NULL;
    size_t n;
    FILE *out = open_memstream(&text, &n);
    bis_json j = {.out = out};

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
    assert_string_equal(text, json_by_hand);
    free(text);
}

/* Twice as bright are the codes of twice the radiance (IEC 61966-2-1: 0.25 is 137, 0.5 is 188, 1 is 255). */
static void the_exposure_of_a_picture_is_seen_in_its_codes(void **state)
{
    static const char *const path = "build/test_page.png";
    static const int exposures[] = {0, 1, 2};
    static const double codes[][3] = {{137, 188, 0}, {188, 255, 0}, {255, 255, 0}};

    for (int i = 0; i < 3; i++) {
        bis_image image;
        unsigned char bytes[1024];
        assert_int_equal(bis_image_init(&image, 2, 1, NULL), BIS_OK);
        for (int k = 0; k < 2; k++) image.pixels[k] = (rgb){0.25f, 0.5f, 0};
        char *text = bis_page_png(&image, exposures[i], NULL);
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
        cmocka_unit_test(a_page_gets_its_data_and_its_text),
        cmocka_unit_test(a_page_without_a_place_is_refused),
        cmocka_unit_test(a_page_without_a_place_leaves_no_file),
        cmocka_unit_test(each_byte_of_a_text_is_itself_an_entity_or_replaced),
        cmocka_unit_test(json_is_written_as_by_hand),
        cmocka_unit_test(texts_are_utf8),
        cmocka_unit_test(the_exposure_of_a_picture_is_seen_in_its_codes),
        cmocka_unit_test(a_picture_in_the_page_is_that_of_the_file),
    };
    return cmocka_run_group_tests_name("page", tests, NULL, NULL);
}
