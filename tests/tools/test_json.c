/* SPDX-License-Identifier: BSD-2-Clause */
/* Tests of json: letter by letter. */
#include "claim.h"
#include "tools/json.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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
    char text[64] = "";
    FILE *out = fmemopen(text, sizeof text, "w");
    bis_json j = {.out = out, .keeps_bytes = true};
    bis_json_text(&j, NULL, "\xc3\xa9\xff\xa9");
    fclose(out);
    assert_string_equal(text, "\"\xc3\xa9\\udcff\\udca9\"");
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(json_is_written_as_by_hand),
        cmocka_unit_test(texts_are_utf8),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
