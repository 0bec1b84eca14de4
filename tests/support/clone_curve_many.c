/* SPDX-License-Identifier: BSD-2-Clause */
/* clone_curve_many: see clones.h. */
#include "clone.h"
#define bis_curve_points CLONE(curve_points)
#include "thesis/curve_many.c"
