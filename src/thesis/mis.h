/* SPDX-License-Identifier: BSD-2-Clause */
/* mis: how integrator "mis" splits its samples, for src/tools/pixel, which computes what its weights can reach. */
#pragma once

#include "bis/thesis/settings.h"

/* bis_mis_samples_em returns how many of the samples come from the map, 1 to samples - 1; the others come from the
 * BRDF. samples >= 2. */
uint32_t bis_mis_samples_em(const bis_settings *s);
