/* SPDX-License-Identifier: BSD-2-Clause */
/* palette: colours that a lecture hall can tell apart, for pictures of numbers. Chosen as they appear (sRGB), returned
 * as what images here hold (linear light). */
#pragma once

#include "bis/base/vec.h"

/* bis_palette_srgb returns a colour as it appears: its components in [0,1] are those of sRGB. */
rgb bis_palette_srgb(double r, double g, double b);

/* bis_palette_heat returns dark blue over purple, red and orange to pale yellow for t in [0,1] (beyond: the ends). Each
 * is lighter than the one before, so that it reads in grey print, too. */
rgb bis_palette_heat(double t);
