/* SPDX-License-Identifier: BSD-2-Clause */
/* clone: what a file that compiles a file of src/ once more says first (clones.h): CLONE(name) is the name's clone, and
 * BIS_LANES is for one processor, for AVX2 after #define CLONE_AVX2. */
#define BIS_ONE_CLONE
#include "bis/thesis/lanes.h"

#if defined(CLONE_AVX2)
#define CLONE(name) avx2_##name
#if defined(__x86_64__)
#undef BIS_LANES
#define BIS_LANES __attribute__((target("avx2")))
#endif
#else
#define CLONE(name) plain_##name
#endif
