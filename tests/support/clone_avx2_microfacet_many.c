/* SPDX-License-Identifier: BSD-2-Clause */
/* clone_avx2_microfacet_many: see clones.h. */
#define CLONE_AVX2
#include "clone_microfacet_many.c"
