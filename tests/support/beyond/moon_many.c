/* SPDX-License-Identifier: BSD-2-Clause */
/* moon_many: dust in many directions at once. */
#include "thesis/real_float.h"

#include "beyond/moon_formulas.h"

#define MODEL moon
#include "thesis/model_many.h"

const bis_bsdf_many bis_moon_many = {.f = f_many, .sample = sample_many};
