/* SPDX-License-Identifier: BSD-2-Clause */
/* mem: aligned, zeroed, checked for overflow, and told when to fail. */
#include "bis/base/mem.h"
#include "claim.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

static void every_block_is_aligned_and_zero_to_its_last_byte(void **state)
{
    const size_t sizes[] = {1, 15, 16, 63, 64, 65, 4095, 4097, 131071, 131072, 131073, 1000003};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        for (int repeat = 0; repeat < 3; repeat++) { /* also when the heap hands out used memory */
            unsigned char *p = bis_alloc(sizes[i], 1);
            assert_non_null(p);
            assert_int_equal((uintptr_t)p % 64, 0);
            for (size_t j = 0; j < sizes[i]; j++)
                assert_int_equal(p[j], 0);
            memset(p, 0xab, sizes[i]);
            bis_free(p);
        }
}

static void a_size_that_overflows_is_refused(void **state)
{
    assert_null(bis_alloc(SIZE_MAX, 2));
    assert_null(bis_alloc(SIZE_MAX / 2 + 1, SIZE_MAX / 2 + 1));
    assert_null(bis_alloc(SIZE_MAX, 1));
    assert_null(bis_alloc(1, PTRDIFF_MAX));
    assert_null(bis_alloc(SIZE_MAX / 4 + 1, 4)); /* each is small enough, and the product wraps to 0 */
    char *p = bis_alloc(3, 1);
    p[2] = 'x';
    assert_null(bis_realloc(p, SIZE_MAX / 2, 4));
    assert_int_equal(p[2], 'x');
    bis_free(p);
}

static void realloc_keeps_contents_and_alignment(void **state)
{
    unsigned *p = NULL;
    for (size_t n = 1; n < 3000000; n = n * 3 + 1) {
        size_t old = (n - 1) / 3;
        p = bis_realloc(p, n, sizeof *p);
        assert_non_null(p);
        assert_int_equal((uintptr_t)p % 64, 0);
        for (size_t i = 0; i < old; i++)
            assert_int_equal(p[i], (unsigned)i * 2654435761u);
        for (size_t i = 0; i < n; i++)
            p[i] = (unsigned)i * 2654435761u;
    }
    p = bis_realloc(p, 5, sizeof *p);
    for (size_t i = 0; i < 5; i++)
        assert_int_equal(p[i], (unsigned)i * 2654435761u);
    bis_free(p);
}

static void the_kth_allocation_fails_once_and_all_are_counted(void **state)
{
    for (long k = 1; k <= 4; k++) {
        bis_mem_fail_at(k);
        void *p[4] = {bis_alloc(1, 1), bis_realloc(NULL, 1, 1), bis_strdup("x"), bis_strndup("x", 1)};
        assert_int_equal(bis_mem_count(), 4);
        for (long i = 0; i < 4; i++) {
            assert_true((p[i] == NULL) == (i + 1 == k));
            bis_free(p[i]);
        }
    }
    const long before = bis_mem_failures();
    bis_mem_fail_at(1);
    char *q = bis_alloc(1, 1);
    assert_null(q);
    assert_int_equal(bis_mem_failures(), before + 1);
    bis_mem_fail_at(0);
    assert_int_equal(bis_mem_count(), 0);
    q = bis_alloc(1, 1);
    assert_non_null(q);
    bis_mem_fail_at(1);
    assert_null(bis_realloc(q, 100, 1));
    q[0] = 'x'; /* the old block survives */
    bis_mem_fail_at(0);
    bis_free(q);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_block_is_aligned_and_zero_to_its_last_byte),
        cmocka_unit_test(a_size_that_overflows_is_refused),
        cmocka_unit_test(realloc_keeps_contents_and_alignment),
        cmocka_unit_test(the_kth_allocation_fails_once_and_all_are_counted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
