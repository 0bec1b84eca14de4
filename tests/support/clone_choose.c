/* SPDX-License-Identifier: BSD-2-Clause */
/* clone_choose: see clones.h. */
#include "clone.h"
#include "clone_sets.h"
#include "thesis/choose.c"
