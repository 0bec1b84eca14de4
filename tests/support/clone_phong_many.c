/* SPDX-License-Identifier: BSD-2-Clause */
/* clone_phong_many: see clones.h. */
#include "clone.h"
#define bis_phong_many CLONE(phong_many)
#include "thesis/phong_many.c"
