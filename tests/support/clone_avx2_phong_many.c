/* SPDX-License-Identifier: BSD-2-Clause */
/* clone_avx2_phong_many: see clones.h. */
#define CLONE_AVX2
#include "clone_phong_many.c"
