/* SPDX-License-Identifier: BSD-2-Clause */
/* palette: sRGB's transfer function (IEC 61966-2-1) and a scale of heat, linear between seven stops. */
#include "palette.h"

#include "bis/base/image.h"

static double to_linear(double v) { return bis_image_to_linear(v, BIS_GAMMA_SRGB); }

rgb bis_palette_srgb(double r, double g, double b) { return rgb_from(to_linear(r), to_linear(g), to_linear(b)); }

rgb bis_palette_heat(double t)
{
    static const double stops[][3] = {
        {0.05, 0.03, 0.20}, {0.25, 0.07, 0.43}, {0.53, 0.13, 0.42}, {0.80, 0.24, 0.30},
        {0.95, 0.47, 0.12}, {0.98, 0.76, 0.22}, {1.0, 0.99, 0.80},
    };
    enum { LAST = sizeof stops / sizeof *stops - 1 };
    const double place = fmin(fmax(t, 0), 1) * LAST;
    const int i = place < LAST ? (int)place : LAST - 1;
    const double f = place - i, *a = stops[i], *b = stops[i + 1];
    return bis_palette_srgb(a[0] + f * (b[0] - a[0]), a[1] + f * (b[1] - a[1]), a[2] + f * (b[2] - a[2]));
}
