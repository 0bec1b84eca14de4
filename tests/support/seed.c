/* SPDX-License-Identifier: BSD-2-Clause */
/* seed: `make test SEED=n` draws every statistical test anew. All random numbers of the project come from
 * bis_rng_init. In test programs the linker puts __wrap_bis_rng_init in its place (--wrap), which adds a multiple of n
 * to each seed, in the library, too. Without SEED the seeds are those that stand in the tests. */
#include "bis/thesis/rng.h"
#include "stat.h"

#include <stdlib.h>

/* The function itself, by --wrap; weak, because a program that is linked without it still links. */
__attribute__((weak)) void __real_bis_rng_init(bis_rng *r, uint64_t seed, uint64_t pixel, uint64_t sample,
                                                uint64_t purpose);
void __wrap_bis_rng_init(bis_rng *r, uint64_t seed, uint64_t pixel, uint64_t sample, uint64_t purpose);

static uint64_t shift;
static bool is_kept;

void stat_keep_seeds(bool as_written) { is_kept = as_written; }

__attribute__((constructor)) static void read_seed(void)
{
    const char *text = getenv("BIS_TEST_SEED");
    if (text) shift = strtoull(text, NULL, 10) * 0x9e3779b97f4a7c15u; /* odd: another n is another shift */
}

void __wrap_bis_rng_init(bis_rng *r, uint64_t seed, uint64_t pixel, uint64_t sample, uint64_t purpose)
{
    __real_bis_rng_init(r, seed + (is_kept ? 0 : shift), pixel, sample, purpose);
}
