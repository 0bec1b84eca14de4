/* SPDX-License-Identifier: BSD-2-Clause */
/* tone: see the header. */
#include "tone.h"

#include <math.h>
#include <string.h>

const char *const bis_tone_names[BIS_N_TONES + 1] = {"none", "reinhard", "filmic", NULL};

bis_tone bis_tone_find(const char *name)
{
    int i = 0;
    while (i < BIS_N_TONES && strcmp(bis_tone_names[i], name) != 0) i++;
    return (bis_tone)i;
}

static double filmic(double x)
{
    return x > 0 ? x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14) : 0;
}

static rgb bend(const double v[3], bis_tone tone)
{
    if (tone == BIS_TONE_FILMIC) return rgb_from(filmic(v[0]), filmic(v[1]), filmic(v[2]));
    if (tone == BIS_TONE_NONE) return rgb_from(v[0], v[1], v[2]);
    const double L = 0.2126 * v[0] + 0.7152 * v[1] + 0.0722 * v[2], s = L > 0 ? 1 / (1 + L) : 1;
    return rgb_from(fmax(v[0], 0) * s, fmax(v[1], 0) * s, fmax(v[2], 0) * s);
}

void bis_tone_apply(bis_image *image, double ev, bis_tone tone)
{
    const double scale = exp2(ev);

    for (size_t i = 0; i < (size_t)image->width * (size_t)image->height; i++) {
        const rgb c = image->pixels[i];
        const double a = image->alpha && image->alpha[i] > 0 ? (double)image->alpha[i] : 1, s = scale / a;
        const double v[3] = {s * (double)c.r, s * (double)c.g, s * (double)c.b};
        if (rgb_is_finite(c)) image->pixels[i] = a == 1 ? bend(v, tone) : rgb_scale(bend(v, tone), a);
    }
}
