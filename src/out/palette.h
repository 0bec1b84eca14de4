/* SPDX-License-Identifier: BSD-2-Clause */
/* palette: colours that a lecture hall can tell apart, for pictures of numbers. Chosen as they appear (sRGB), returned
 * as what images here hold (linear light). */
#pragma once

#include "bis/base/vec.h"

/* As it appears: components in [0,1] of sRGB. */
rgb bis_palette_srgb(double r, double g, double b);

/* Dark blue over purple, red and orange to pale yellow, t in [0,1] (beyond: the ends), each lighter than the one
 * before: reads in grey print, too. */
rgb bis_palette_heat(double t);
