/* SPDX-License-Identifier: BSD-2-Clause */
/* clone_microfacet: see clones.h. */
#include "clone.h"
#define bis_microfacet_model CLONE(microfacet_model)
#define bis_plastic_model CLONE(plastic_model)
#define bis_microfacet CLONE(microfacet)
#define bis_microfacet_metal CLONE(microfacet_metal)
#define bis_plastic CLONE(plastic)
#include "beyond/microfacet.c"
