/* SPDX-License-Identifier: BSD-2-Clause */
/* clone_avx2_curve_many: see clones.h. */
#define CLONE_AVX2
#include "clone_curve_many.c"
