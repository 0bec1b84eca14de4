/* SPDX-License-Identifier: BSD-2-Clause */
/* clone_avx2_microfacet: see clones.h. */
#define CLONE_AVX2
#include "clone_microfacet.c"
