/* SPDX-License-Identifier: BSD-2-Clause */
/* lexer: tokens and their places. Expected values are counted by hand from the text in the test. */
#include "bis/base/mem.h"
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

static void escapes_in_strings_are_pbrts(void **state)
{
    static const char text[] = "\"a\\\"b\\\\c\\n\\t\\'\\b\\f\\r\"";
    char buf[32];
    bis_lexer l;
    bis_diag diag;
    open_text(&l, &diag, text, strlen(text));
    bis_token t = bis_lexer_next(&l);
    assert_int_equal(t.kind, BIS_TOKEN_STRING);
    assert_int_equal(bis_token_unescape(buf, &t), 11);
    assert_string_equal(buf, "a\"b\\c\n\t'\b\f\r");
    done(&l, &diag, 0);
}

/* What a fault is told as, and where the token behind it stands: counted by hand. A fault is one token, however long,
 * and ends where another one may begin. */
static void each_fault_is_told_in_its_place_and_ends_there(void **state)
{
    static const char escape[] = "unknown escape in a string: a backslash is written \\\\",
                      rest[] = "; with --approximate: the number at its beginning, as in pbrt";
    static const struct {
        const char *text;
        size_t n;
        int column;
        const char *message;
        bis_token_kind next;
        int line, next_column;
    } cases[] = {
        {BYTES("\"a\\q\" b"), 3, escape, BIS_TOKEN_WORD, 1, 7},
        {BYTES("\"\xc3\xa9\\q\xc3\xa9\" b"), 3, escape, BIS_TOKEN_WORD, 1, 8},
        {BYTES("\xc3\xa9"), 1, "unexpected byte 0xc3: a scene is UTF-8 text", BIS_TOKEN_END, 1, 2},
        {BYTES("\"a\0c\" b"), 3, "a zero byte in a string", BIS_TOKEN_WORD, 1, 7},
        {BYTES("\"a\nb"), 1, "string without a closing quote", BIS_TOKEN_WORD, 2, 1},
        {BYTES("\"\\"), 2, "string without a closing quote", BIS_TOKEN_END, 1, 3},
        {BYTES("12\xc3\xa9 b"), 1, "malformed number \"12\xc3\xa9\"", BIS_TOKEN_WORD, 1, 5},
        {BYTES("1a\"s\""), 1, "malformed number \"1a\"", BIS_TOKEN_STRING, 1, 3},
        {BYTES("1a[2"), 1, "malformed number \"1a\"", BIS_TOKEN_OPEN, 1, 3},
        {BYTES("1a#2\n b"), 1, "malformed number \"1a#2\"", BIS_TOKEN_WORD, 2, 2},
        {BYTES("1a\rb"), 1, "malformed number \"1a\"", BIS_TOKEN_WORD, 2, 1},
        {BYTES("-1.#IND b"), 1, "non-finite number \"-1.#IND\"", BIS_TOKEN_WORD, 1, 9},
        {BYTES("0x1 b"), 1, "malformed number \"0x1\"", BIS_TOKEN_WORD, 1, 5},
        {BYTES("+1e400 b"), 1, "non-finite number \"+1e400\"", BIS_TOKEN_WORD, 1, 8},
        {BYTES("1.2.3 b"), 1, "malformed number \"1.2.3\"", BIS_TOKEN_WORD, 1, 7},
        {BYTES("1e+ b"), 1, "malformed number \"1e+\"", BIS_TOKEN_WORD, 1, 5},
        {BYTES("a-b[1"), 1, "malformed word \"a-b\"", BIS_TOKEN_OPEN, 1, 4},
        {BYTES(" ,;~ b"), 2, "unexpected character \",\"", BIS_TOKEN_WORD, 1, 6},
        {BYTES("!\xc3\xa9 b"), 1, "unexpected character \"!\"", BIS_TOKEN_WORD, 1, 4},
        {BYTES("{z"), 1, "unexpected character \"{\"", BIS_TOKEN_WORD, 1, 2},
        {BYTES(":9"), 1, "unexpected character \":\"", BIS_TOKEN_NUMBER, 1, 2},
        {BYTES(",]"), 1, "unexpected character \",\"", BIS_TOKEN_CLOSE, 1, 2},
        {BYTES("\x1f 1"), 1, "unexpected byte 0x1f: a scene is UTF-8 text", BIS_TOKEN_NUMBER, 1, 3},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char message[300];
        bis_lexer l;
        bis_diag diag;
        open_text(&l, &diag, cases[i].text, cases[i].n);
        if (cases[i].text[0] == 'x') assert_token(&l, BIS_TOKEN_WORD, "x", 1, 1);
        const bis_token bad = bis_lexer_next(&l), next = bis_lexer_next(&l);
        assert_int_equal(bad.kind, BIS_TOKEN_BAD);
        if (diag.n != 1) fail_msg("%s: %zu messages", cases[i].text, diag.n);
        const bool is_number = strstr(cases[i].message, "malformed number") && !strpbrk(cases[i].text, "xX");
        snprintf(message, sizeof message, "%s:1:%d: error: %s%s", scratch("lexer.txt"), cases[i].column,
                 cases[i].message, is_number ? rest : "");
        assert_string_equal(diag.messages[0].text, message);
        if (next.kind != cases[i].next || next.at.line != cases[i].line || next.at.column != cases[i].next_column)
            fail_msg("%s: %d at %d:%d", cases[i].text, (int)next.kind, next.at.line, next.at.column);
        done(&l, &diag, 1);
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
        assert_int_equal(
            bis_lexer_push(&l, names[i - 1], (bis_loc){"f", i, 2}), i <= BIS_INCLUDE_DEPTH ? BIS_OK : BIS_INPUT);
    }
    assert_string_equal(diag.messages[0].text, "f:65:2: error: Include deeper than 64 files");
    done(&l, &diag, 1);
}

static void a_cycle_is_seen_through_another_name_of_the_file(void **state)
{
    bis_lexer l;
    bis_diag diag;
    char other[256];
    open_text(&l, &diag, "a", 1);
    const char *inner = scratch("lexer-inner.txt"); /* of two files, and the first again in the second */
    store(inner, "a", 1);
    snprintf(other, sizeof other, "./%s", l.sources[0].name);
    assert_int_equal(bis_lexer_push(&l, inner, (bis_loc){0}), BIS_OK);
    assert_int_equal(bis_lexer_push(&l, other, (bis_loc){"f", 3, 2}), BIS_INPUT);
    assert_int_equal(bis_lexer_push(&l, inner, (bis_loc){"f", 3, 2}), BIS_INPUT);
    assert_int_equal(l.n_sources, 2);
    char message[400];
    snprintf(message, sizeof message, "f:3:2: error: Include cycle: \"%s\" is being read already", other);
    assert_string_equal(diag.messages[0].text, message);
    done(&l, &diag, 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_kind_of_token_has_its_line_and_column),
        cmocka_unit_test(columns_count_characters_and_not_bytes),
        cmocka_unit_test(dos_line_ends_and_a_byte_order_mark_are_white_space),
        cmocka_unit_test(numbers_are_read_in_every_form_that_pbrt_scenes_use),
        cmocka_unit_test(escapes_in_strings_are_pbrts),
        cmocka_unit_test(each_fault_is_told_in_its_place_and_ends_there),
        cmocka_unit_test(an_included_file_is_read_in_between),
        cmocka_unit_test(sixty_four_includes_are_nested_and_one_more_is_refused),
        cmocka_unit_test(a_cycle_is_seen_through_another_name_of_the_file),
    };
    return cmocka_run_group_tests_name("lexer", tests, NULL, scratch_remove);
}
