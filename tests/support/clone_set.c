/* SPDX-License-Identifier: BSD-2-Clause */
/* clone_set: see clones.h. */
#include "clone.h"
#include "clone_sets.h"
#include "thesis/set.c"
