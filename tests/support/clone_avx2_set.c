/* SPDX-License-Identifier: BSD-2-Clause */
/* clone_avx2_set: see clones.h. */
#define CLONE_AVX2
#include "clone_set.c"
