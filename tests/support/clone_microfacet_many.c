/* SPDX-License-Identifier: BSD-2-Clause */
/* clone_microfacet_many: see clones.h. */
#include "clone.h"
#define bis_microfacet_many CLONE(microfacet_many)
#define bis_plastic_many CLONE(plastic_many)
#include "beyond/microfacet_many.c"
