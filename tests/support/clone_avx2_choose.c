/* SPDX-License-Identifier: BSD-2-Clause */
/* clone_avx2_choose: see clones.h. */
#define CLONE_AVX2
#include "clone_choose.c"
