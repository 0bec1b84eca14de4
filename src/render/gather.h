/* SPDX-License-Identifier: BSD-2-Clause */
/* gather: what layers want to know of one camera sample. For the files of src/render. */
#pragma once

#include "bis/scene/layers.h"
#include "bis/base/xform.h"
#include "bis/thesis/integrator.h"

/* What an integrator was asked of a point, and L, its answer. scratch is used again. */
typedef struct bis_gathered {
    const bis_settings *settings;
    const bis_point *pt;
    bis_stream stream; /* as it was before the integrator drew from it */
    bis_scratch *scratch;
    rgb L;
} bis_gathered;

/* bis_gather_surface adds what is said of the surface that was hit to values[layers->n_values], which begin as zeros.
 * It returns false if an L_ns is not finite and was left out. */
bool bis_gather_surface(float *values, const bis_layers *layers, const bis_xform *to_camera, const bis_gathered *of);

/* bis_gather_counts adds what was counted between before and after. */
void bis_gather_counts(float *values, const bis_layers *layers, const bis_counters *before, const bis_counters *after);

/* bis_gather_mean divides values, which are sums over camera samples, by n, but for counts. */
void bis_gather_mean(float *values, const bis_layers *layers, double n);
