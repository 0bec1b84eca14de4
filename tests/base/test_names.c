/* SPDX-License-Identifier: BSD-2-Clause */
/* names: thousands of names against an array of them, replaced values, and a lack of memory, which changes nothing. */
#include "base/grow.h"
#include "base/names.h"
#include "bis/base/mem.h"
#include "claim.h"

#include <stdio.h>
#include <string.h>

/* More than the first thousand, so that the table grows eight times. The twin has each letter in another place. */
static void thousands_of_names_have_their_values(void **state)
{
    enum { N = 3000 };
    bis_names t = {0};
    uint32_t value = 7;
    char name[32];
    assert_false(bis_names_find(&t, "n0", &value));
    for (uint32_t i = 0; i < N; i++) {
        snprintf(name, sizeof name, "n%u", (unsigned)i);
        assert_false(bis_names_find(&t, name, &value));
        assert_true(bis_names_set(&t, name, 3 * i + 1));
        assert_int_equal(t.n, i + 1);
        assert_string_equal(t.names[i], name);
    }
    assert_int_equal(value, 7);
    for (uint32_t i = 0; i < N; i++) {
        snprintf(name, sizeof name, "n%u", (unsigned)i);
        assert_true(bis_names_find(&t, name, NULL));
        assert_true(bis_names_find(&t, name, &value) && value == 3 * i + 1);
        if (i % 2) assert_true(bis_names_set(&t, name, 5 * i));
        snprintf(name, sizeof name, "%un", (unsigned)i);
        assert_false(bis_names_find(&t, name, &value));
        assert_true(value == 3 * i + 1);
    }
    assert_int_equal(t.n, N);
    for (uint32_t i = 0; i < N; i++) {
        snprintf(name, sizeof name, "n%u", (unsigned)i);
        assert_true(bis_names_find(&t, name, &value) && value == (i % 2 ? 5 * i : 3 * i + 1));
    }
    assert_true(t.n_slots >= 2 * N && t.n_slots < 8 * N && (t.n_slots & (t.n_slots - 1)) == 0);
    bis_names_clear(&t);
    assert_true(t.n == 0 && t.n_slots == 0 && t.names == NULL && t.values == NULL && t.slots == NULL);
    assert_false(bis_names_find(&t, "n0", &value));
    bis_names_clear(&t);
    assert_int_equal(bis_mem_live(), 0);
}

/* At most half of the slots are taken: of 16, eight. */
static void the_table_is_at_most_half_full(void **state)
{
    bis_names t = {0};
    for (uint32_t i = 0; i < 200; i++) {
        char name[8];
        snprintf(name, sizeof name, "%u", (unsigned)i);
        assert_true(bis_names_set(&t, name, i));
        size_t taken = 0;
        for (size_t k = 0; k < t.n_slots; k++) taken += t.slots[k] != 0;
        assert_int_equal(taken, i + 1);
        size_t least = 16;
        while (least < 2 * taken) least *= 2;
        assert_int_equal(t.n_slots, least);
    }
    bis_names_clear(&t);
}

/* Among the first thousand; the others are too many to compare. */
static void the_nearest_of_the_first_thousand_is_found(void **state)
{
    bis_names t = {0};
    char name[32];
    assert_null(bis_names_nearest(&t, "colour"));
    for (uint32_t i = 0; i < 999; i++) {
        snprintf(name, sizeof name, "%u", 10000000 + (unsigned)i);
        assert_true(bis_names_set(&t, name, i));
    }
    assert_null(bis_names_nearest(&t, "colour"));
    assert_true(bis_names_set(&t, "color", 0));
    assert_string_equal(bis_names_nearest(&t, "colour"), "color");
    assert_true(bis_names_set(&t, "texture", 0));
    assert_null(bis_names_nearest(&t, "textures"));
    bis_names_clear(&t);
}

/* Room for at least eight, else for twice as many as before or for what is needed, if that is more. */
static void room_doubles(void **state)
{
    static const struct { size_t needed, capacity; } steps[] = {
        {1, 8}, {8, 8}, {9, 16}, {10, 16}, {16, 16}, {17, 32}, {100, 100}, {100, 100}, {101, 200}, {7, 200}};
    uint16_t *array = NULL;
    size_t capacity = 0;
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
        const size_t before = capacity;
        assert_true(bis_room(&array, &capacity, steps[i].needed, sizeof *array));
        assert_int_equal(capacity, steps[i].capacity);
        for (size_t k = 0; k < before; k++) assert_int_equal(array[k], 3 * k);
        for (size_t k = 0; k < capacity; k++) array[k] = (uint16_t)(3 * k);
    }
    uint16_t *const old = array;
    assert_false(bis_room(&array, &capacity, SIZE_MAX / 2, sizeof *array));
    assert_true(array == old && capacity == 200 && array[199] == 597);
    assert_true(BIS_ROOM(array, capacity, 199) && array == old);
    assert_true(BIS_ROOM(array, capacity, 200) && capacity == 400 && array[199] == 597);
    bis_free(array);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(thousands_of_names_have_their_values),
        cmocka_unit_test(the_table_is_at_most_half_full),
        cmocka_unit_test(the_nearest_of_the_first_thousand_is_found),
        cmocka_unit_test(room_doubles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
