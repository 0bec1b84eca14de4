/* SPDX-License-Identifier: BSD-2-Clause */
/* embree: Intel's ray tracing kernels behind bis/accel.h. For accel.c only. Built in where BIS_EMBREE is 3 or 4. */
#pragma once

#include "bis/shape/accel.h"

/* bis_embree_new builds Embree's tree. Errors: BIS_INPUT (not built in, or Embree refuses this processor: the message
 * names the way out), BIS_NOMEM. */
bis_status bis_embree_new(bis_accel **out, const bis_geometry *g, int n_threads, bis_diag *diag);
