/* SPDX-License-Identifier: BSD-2-Clause */
/* lexer: tokens and their places. Expected values are counted by hand from the text in the test. */
#include "claim.h"
#include "image_help.h"
#include "parse/lexer.h"

#include <stdio.h>
#include <string.h>

/* A lexer over one file with this content. */
static void open_text(bis_lexer *l, bis_diag *diag, const char *text, size_t n)
{
    const char *path = scratch("lexer.txt");
    *diag = (bis_diag){0};
    *l = (bis_lexer){.diag = diag};
    store(path, text, n);
    assert_int_equal(bis_lexer_push(l, path, (bis_loc){0}), BIS_OK);
}

static void assert_token(bis_lexer *l, bis_token_kind kind, const char *text, int line, int column)
{
    bis_token t = bis_lexer_next(l);
    assert_int_equal(t.kind, kind);
    assert_int_equal(t.at.line, line);
    assert_int_equal(t.at.column, column);
    if (!text) return;
    assert_int_equal(t.length, strlen(text));
    assert_memory_equal(t.text, text, t.length);
}

static void done(bis_lexer *l, bis_diag *diag, size_t n_errors)
{
    assert_int_equal(diag->n_errors, n_errors);
    bis_lexer_clear(l);
    bis_diag_clear(diag);
}

static void every_kind_of_token_has_its_line_and_column(void **state)
{
    static const char text[] = "Film \"rgb\"\n  [ 1 -2.5e1 ] true # [ 3 ]\n\tWorldEnd";
    bis_lexer l;
    bis_diag diag;
    open_text(&l, &diag, text, strlen(text));
    assert_token(&l, BIS_TOKEN_WORD, "Film", 1, 1);
    assert_token(&l, BIS_TOKEN_STRING, "rgb", 1, 6);
    assert_token(&l, BIS_TOKEN_OPEN, "[", 2, 3);
    assert_token(&l, BIS_TOKEN_NUMBER, "1", 2, 5);
    assert_token(&l, BIS_TOKEN_NUMBER, "-2.5e1", 2, 7);
    assert_token(&l, BIS_TOKEN_CLOSE, "]", 2, 14);
    assert_token(&l, BIS_TOKEN_WORD, "true", 2, 16);
    assert_token(&l, BIS_TOKEN_WORD, "WorldEnd", 3, 2);
    assert_token(&l, BIS_TOKEN_END, NULL, 3, 10);
    assert_token(&l, BIS_TOKEN_END, NULL, 3, 10);
    done(&l, &diag, 0);
}

static void columns_count_characters_and_not_bytes(void **state)
{
    static const char text[] =
        "\"\xc3\xa9\xe2\x82\xac\xf0\x9f\x98\x80\" a # \xc3\xa9\n b \"\xc3\xa9\xc3\xa9\" \"\xc3\xa9\" c";
    bis_lexer l;
    bis_diag diag;
    open_text(&l, &diag, text, strlen(text));
    assert_token(&l, BIS_TOKEN_STRING, NULL, 1, 1);
    assert_token(&l, BIS_TOKEN_WORD, "a", 1, 7);
    assert_token(&l, BIS_TOKEN_WORD, "b", 2, 2);
    assert_token(&l, BIS_TOKEN_STRING, NULL, 2, 4);
    assert_token(&l, BIS_TOKEN_STRING, NULL, 2, 9);
    assert_token(&l, BIS_TOKEN_WORD, "c", 2, 13);
    done(&l, &diag, 0);
}

/* A byte order mark alone, and parts of one, which are letters. */
static void a_mark_alone_is_an_empty_file(void **state)
{
    bis_lexer l;
    bis_diag diag;
    open_text(&l, &diag, "\xef\xbb\xbf", 3);
    assert_token(&l, BIS_TOKEN_END, NULL, 1, 1);
    done(&l, &diag, 0);
    open_text(&l, &diag, "\xef\xbb", 2);
    assert_token(&l, BIS_TOKEN_BAD, NULL, 1, 1);
    done(&l, &diag, 1);
    open_text(&l, &diag, "", 0);
    assert_token(&l, BIS_TOKEN_END, NULL, 1, 1);
    done(&l, &diag, 0);
}

static void dos_line_ends_and_a_byte_order_mark_are_white_space(void **state)
{
    static const char text[] = "\xef\xbb\xbf" "a\r\n\r\n b # c\r\nd\r\n";
    bis_lexer l;
    bis_diag diag;
    open_text(&l, &diag, text, strlen(text));
    assert_token(&l, BIS_TOKEN_WORD, "a", 1, 1);
    assert_token(&l, BIS_TOKEN_WORD, "b", 3, 2);
    assert_token(&l, BIS_TOKEN_WORD, "d", 4, 1);
    assert_token(&l, BIS_TOKEN_END, NULL, 5, 1);
    done(&l, &diag, 0);
}

static void numbers_are_read_in_every_form_that_pbrt_scenes_use(void **state)
{
    static const struct {
        const char *text;
        double value;
    } cases[] = {{"0", 0},        {"-0", -0.0},    {"+7", 7},      {".5", 0.5},       {"-.25", -0.25}, {"5.", 5},
                 {"1e3", 1000},   {"1E-2", 0.01},  {"1.5e+2", 150}, {"123456789", 123456789}, {"0.1", 0.1},
                 {"1e-400", 0},   {"9007199254740993", 9007199254740992.0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bis_lexer l;
        bis_diag diag;
        open_text(&l, &diag, cases[i].text, strlen(cases[i].text));
        bis_token t = bis_lexer_next(&l);
        assert_int_equal(t.kind, BIS_TOKEN_NUMBER);
        assert_true(t.number == cases[i].value);
        assert_int_equal(t.length, strlen(cases[i].text));
        done(&l, &diag, 0);
    }
}

static void what_only_looks_like_a_number_is_refused_whole(void **state)
{
    static const char *const cases[] = {"0x10", "1e", "1e+", "1.2.3", "1-2", "--1", "+", "-", ".", "1a", "-inf", "+nan",
                                        "1e999", "-.e1", "1_000"};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[32];
        bis_lexer l;
        bis_diag diag;
        snprintf(text, sizeof text, "%s 3", cases[i]);
        open_text(&l, &diag, text, strlen(text));
        assert_int_equal(bis_lexer_next(&l).kind, BIS_TOKEN_BAD);
        assert_token(&l, BIS_TOKEN_NUMBER, "3", 1, (int)strlen(cases[i]) + 2);
        done(&l, &diag, 1);
    }
}

static void tokens_need_no_space_where_brackets_and_quotes_part_them(void **state)
{
    static const char text[] = "a[1]\"s\"2#x\n[\"t\"]";
    bis_lexer l;
    bis_diag diag;
    open_text(&l, &diag, text, strlen(text));
    assert_token(&l, BIS_TOKEN_WORD, "a", 1, 1);
    assert_token(&l, BIS_TOKEN_OPEN, NULL, 1, 2);
    assert_token(&l, BIS_TOKEN_NUMBER, "1", 1, 3);
    assert_token(&l, BIS_TOKEN_CLOSE, NULL, 1, 4);
    assert_token(&l, BIS_TOKEN_STRING, "s", 1, 5);
    assert_token(&l, BIS_TOKEN_NUMBER, "2", 1, 8);
    assert_token(&l, BIS_TOKEN_OPEN, NULL, 2, 1);
    assert_token(&l, BIS_TOKEN_STRING, "t", 2, 2);
    assert_token(&l, BIS_TOKEN_CLOSE, NULL, 2, 5);
    done(&l, &diag, 0);
}

static void escapes_in_strings_are_pbrts(void **state)
{
    static const char text[] = "\"a\\\"b\\\\c\\n\\t\\'\"";
    char buf[32];
    bis_lexer l;
    bis_diag diag;
    open_text(&l, &diag, text, strlen(text));
    bis_token t = bis_lexer_next(&l);
    assert_int_equal(t.kind, BIS_TOKEN_STRING);
    assert_int_equal(bis_token_unescape(buf, &t), 8);
    assert_string_equal(buf, "a\"b\\c\n\t'");
    done(&l, &diag, 0);
}

static void a_bad_string_is_skipped_and_the_next_token_is_in_place(void **state)
{
    static const struct {
        const char *text;
        int line;
    } cases[] = {{"\"a\\q\" b", 1}, {"\"a\nb", 2}, {"\"\xff\" b", 1}, {"\"\xc3\" b", 1}, {"\"\xe2\x82\" b", 1},
                 {"\"\xed\xa0\x80\" b", 1}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bis_lexer l;
        bis_diag diag;
        open_text(&l, &diag, cases[i].text, strlen(cases[i].text));
        assert_int_equal(bis_lexer_next(&l).kind, BIS_TOKEN_BAD);
        bis_token t = bis_lexer_next(&l);
        assert_int_equal(t.kind, BIS_TOKEN_WORD);
        assert_memory_equal(t.text, "b", 1);
        assert_int_equal(t.at.line, cases[i].line);
        done(&l, &diag, 1);
    }
}

static void any_bytes_give_tokens_and_an_end(void **state)
{
    char text[4096];
    unsigned x = 12345;
    for (int round = 0; round < 50; round++) {
        bis_lexer l;
        bis_diag diag;
        for (size_t i = 0; i < sizeof text; i++) text[i] = (char)((x = x * 1664525u + 1013904223u) >> 24);
        open_text(&l, &diag, text, sizeof text);
        int n = 0;
        while (bis_lexer_next(&l).kind != BIS_TOKEN_END) assert_true(++n <= 4096);
        bis_lexer_clear(&l);
        bis_diag_clear(&diag);
    }
}

static void an_included_file_is_read_in_between(void **state)
{
    bis_lexer l;
    bis_diag diag;
    const char *inner = scratch("lexer-inner.txt");
    store(inner, "x\ny", 3);
    open_text(&l, &diag, "a b", 3);
    assert_token(&l, BIS_TOKEN_WORD, "a", 1, 1);
    assert_int_equal(bis_lexer_push(&l, inner, (bis_loc){0}), BIS_OK);
    assert_token(&l, BIS_TOKEN_WORD, "x", 1, 1);
    assert_token(&l, BIS_TOKEN_WORD, "y", 2, 1);
    assert_token(&l, BIS_TOKEN_END, NULL, 2, 2);
    assert_true(bis_lexer_pop(&l));
    assert_token(&l, BIS_TOKEN_WORD, "b", 1, 3);
    assert_false(bis_lexer_pop(&l));
    done(&l, &diag, 0);
}

static void sixty_four_includes_are_nested_and_one_more_is_refused(void **state)
{
    bis_lexer l;
    bis_diag diag;
    open_text(&l, &diag, "a", 1);
    for (int i = 1; i <= BIS_INCLUDE_DEPTH + 1; i++) {
        static char names[BIS_INCLUDE_DEPTH + 1][64];
        char name[32];
        snprintf(name, sizeof name, "deep%d.txt", i);
        snprintf(names[i - 1], sizeof names[0], "%s", scratch(name));
        store(names[i - 1], "b", 1);
        assert_int_equal(bis_lexer_push(&l, names[i - 1], (bis_loc){0}), i <= BIS_INCLUDE_DEPTH ? BIS_OK : BIS_INPUT);
    }
    done(&l, &diag, 1);
}

static void a_cycle_is_seen_through_another_name_of_the_file(void **state)
{
    bis_lexer l;
    bis_diag diag;
    char other[256];
    open_text(&l, &diag, "a", 1);
    snprintf(other, sizeof other, "./%s", l.sources[0].name);
    assert_int_equal(bis_lexer_push(&l, other, (bis_loc){0}), BIS_INPUT);
    done(&l, &diag, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_kind_of_token_has_its_line_and_column),
        cmocka_unit_test(columns_count_characters_and_not_bytes),
        cmocka_unit_test(a_mark_alone_is_an_empty_file),
        cmocka_unit_test(dos_line_ends_and_a_byte_order_mark_are_white_space),
        cmocka_unit_test(numbers_are_read_in_every_form_that_pbrt_scenes_use),
        cmocka_unit_test(what_only_looks_like_a_number_is_refused_whole),
        cmocka_unit_test(tokens_need_no_space_where_brackets_and_quotes_part_them),
        cmocka_unit_test(escapes_in_strings_are_pbrts),
        cmocka_unit_test(a_bad_string_is_skipped_and_the_next_token_is_in_place),
        cmocka_unit_test(any_bytes_give_tokens_and_an_end),
        cmocka_unit_test(an_included_file_is_read_in_between),
        cmocka_unit_test(sixty_four_includes_are_nested_and_one_more_is_refused),
        cmocka_unit_test(a_cycle_is_seen_through_another_name_of_the_file),
    };
    return cmocka_run_group_tests_name("lexer", tests, NULL, scratch_remove);
}
