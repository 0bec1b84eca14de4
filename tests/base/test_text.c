/* SPDX-License-Identifier: BSD-2-Clause */
/* text: durations at every border of a unit, all of UTF-8 by counting, the published values of the hash, and what does
 * not fit. */
#include "base/text.h"
#include "claim.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Each unit ends where its rounded text would need one digit more than the next unit. */
static void a_duration_has_the_unit_that_keeps_it_short(void **state)
{
    static const struct { double seconds; const char *text; } cases[] = {
        {0, "0 s"}, {1e-6, "0.001 ms"}, {0.00042, "0.42 ms"}, {0.042, "42 ms"}, {0.0994, "99 ms"}, {0.09949, "99 ms"},
        {0.09951, "0.1 s"}, {0.5, "0.5 s"}, {3.14, "3.1 s"}, {9.94, "9.9 s"}, {9.949, "9.9 s"}, {9.951, "10 s"},
        {12.4, "12 s"}, {99.4, "99 s"}, {99.49, "99 s"}, {99.5, "1.7 min"}, {120, "2.0 min"}, {390, "6.5 min"},
        {596.9, "9.9 min"}, {597, "10 min"}, {597.1, "10 min"}, {600, "10 min"}, {3600, "60 min"}, {5399, "90 min"},
        {5400, "1.5 h"}, {9000, "2.5 h"}, {86400, "24.0 h"}, {172799, "48.0 h"}, {172800, "2 days"}, {1e6, "11.6 days"},
        {12 * 86400.0, "12 days"}, {365 * 86400.0, "365 days"}};
    char text[BIS_DURATION];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_ptr_equal(bis_duration(text, cases[i].seconds), text);
        assert_string_equal(text, cases[i].text);
    }
}

/* No figure has an exponent, because the reader is a person. */
static void a_percentage_is_written_as_a_person_writes_it(void **state)
{
    static const struct { double share; const char *text; } cases[] = {
        {0, "0%"}, {1e-9, "below 0.0001%"}, {9.9e-7, "below 0.0001%"}, {1.01e-6, "0.0001%"}, {0.00034, "0.034%"},
        {0.0123, "1.2%"},
        {0.0994, "9.9%"}, {0.0996, "10%"}, {0.12, "12%"}, {0.994, "99%"}, {0.996, "100%"}, {1.7, "170%"},
        {1.704, "170%"}, {123.4, "12340%"},
        {9999.9, "999990%"}, {10000, "1000000%"}, {10001, "over 1000000%"}, {1e300, "over 1000000%"},
        {(double)INFINITY, "over 1000000%"}};
    char text[BIS_PERCENT];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_ptr_equal(bis_percent(text, cases[i].share), text);
        assert_string_equal(text, cases[i].text);
    }
}

static void a_bound_in_percent_is_rounded_up(void **state)
{
    static const struct { double bound; const char *text; } cases[] = {
        {0, "0%"}, {0.00121, "0.13%"}, {0.012, "1.2%"}, {0.0121, "1.3%"}, {0.0991, "10%"}, {0.12, "12%"},
        {0.1201, "13%"},        {1, "100%"}, {(double)INFINITY, "over 1000000%"}};
    char text[BIS_PERCENT];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_string_equal(bis_percent_above(text, cases[i].bound), cases[i].text);
}

static size_t length_of(const unsigned char *c, size_t n)
{
    return bis_utf8_length((const char *)c, (const char *)c + n);
}

/* Every character, written by RFC 3629's table of bits, has its length if all of it is there, and none if a byte lacks.
 * What is no character: a byte that continues nothing, one that is not continued, a longer form than is needed, what
 * lies beyond the last code point. */
static void utf8_is_what_rfc_3629_says(void **state)
{
    static const char *const none[] = {"\x80zzz", "\xbfzzz", "\xc2zzz", "\xc0\x80zz", "\xc1\xbfzz", "\xe0\x9f\xbfz",
        "\xe1\x80zz", "\xe1z\x80z", "\xf0\x8f\xbf\xbf", "\xf1\x80\x80z", "\xf4\x90\x80\x80", "\xf5\x80\x80\x80",
        "\xffzzz"};
    for (uint32_t c = 0; c <= 0x10ffff; c++) {
        unsigned char b[4];
        const size_t n = c < 0x80 ? 1 : c < 0x800 ? 2 : c < 0x10000 ? 3 : 4;
        static const unsigned char lead[] = {0, 0, 0xc0, 0xe0, 0xf0};
        uint32_t rest = c;
        for (size_t i = n; i-- > 1; rest >>= 6) b[i] = (unsigned char)(0x80 | (rest & 0x3f));
        b[0] = (unsigned char)(lead[n] | rest);
        const size_t expected = c >= 0xd800 && c <= 0xdfff ? 0 : n;
        if (length_of(b, n) != expected) fail_msg("U+%04X", (unsigned)c);
        for (size_t cut = 1; cut < n; cut++) assert_true(length_of(b, cut) == 0);
    }
    for (size_t i = 0; i < sizeof none / sizeof *none; i++)
        if (length_of((const unsigned char *)none[i], 4) != 0) fail_msg("text %zu is taken for a character", i);
}

static void a_byte_continues_if_its_two_bits_say_so(void **state)
{
    for (int c = 0; c < 256; c++) assert_true(bis_utf8_continues((char)c) == (c >= 128 && c < 192));
}

static void what_is_appended_stays_in_its_place(void **state)
{
    char room[12] = {0};
    room[9] = 'x'; /* behind the 9 bytes that are ours */
    bis_append(room, 9, "%s", "ab");
    assert_string_equal(room, "ab");
    bis_append(room, 9, "%d-%d", 12, 3);
    assert_string_equal(room, "ab12-3");
    bis_append(room, 9, "%s", "long tail");
    assert_string_equal(room, "ab12-3lo");
    bis_append(room, 9, "%s", "more");
    assert_string_equal(room, "ab12-3lo");
    assert_true(room[9] == 'x');
}

/* The test vectors of the authors' page, 64 bit FNV-1a; in parts, too. */
static void the_hash_has_its_published_values(void **state)
{
    assert_true(bis_fnv1a(BIS_FNV1A, "", 0) == UINT64_C(0xcbf29ce484222325));
    assert_true(bis_fnv1a(BIS_FNV1A, "a", 1) == UINT64_C(0xaf63dc4c8601ec8c));
    assert_true(bis_fnv1a(BIS_FNV1A, "foobar", 6) == UINT64_C(0x85944171f73967e8));
    assert_true(bis_fnv1a(bis_fnv1a(BIS_FNV1A, "foo", 3), "bar", 3) == UINT64_C(0x85944171f73967e8));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_duration_has_the_unit_that_keeps_it_short),
        cmocka_unit_test(a_percentage_is_written_as_a_person_writes_it),
        cmocka_unit_test(a_bound_in_percent_is_rounded_up),
        cmocka_unit_test(utf8_is_what_rfc_3629_says),
        cmocka_unit_test(a_byte_continues_if_its_two_bits_say_so),
        cmocka_unit_test(what_is_appended_stays_in_its_place),
        cmocka_unit_test(the_hash_has_its_published_values),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
