/* SPDX-License-Identifier: BSD-2-Clause */
/* every: what every test program does beside its tests.
 *     BIS_TEST='a_disc*' build/release/tests/test_warp      runs only the tests whose name fits
 * And all of the library's blocks must be free when it ends; what a failed test leaves behind does not matter. */
#include "every.h"

#include "bis/base/mem.h"
#include "claim.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

__attribute__((constructor)) static void choose_tests(void)
{
    if (getenv("BIS_TEST")) cmocka_set_test_filter(getenv("BIS_TEST"));
}

bool every_finds_leaks = true;

/* After main and after what the program gave to atexit. A child that a test has forked ends with _exit and is not
 * asked. */
__attribute__((destructor)) static void find_leaks(void)
{
    if (!every_finds_leaks || bis_mem_live() == 0) return;
    fprintf(stderr, "leaks: %ld blocks of bis_alloc were not freed\n", bis_mem_live());
    fflush(NULL);
    _exit(1);
}
