/* SPDX-License-Identifier: BSD-2-Clause */
/* tone: exposure and tone curves, which make a picture for a screen of radiance. Applied before the sRGB curve. */
#pragma once

#include "bis/base/image.h"

typedef enum bis_tone {
    BIS_TONE_NONE,     /* what is brighter than white is white */
    BIS_TONE_REINHARD, /* L/(1 + L) of the luminance; Reinhard et al. 2002, eq. 3 */
    BIS_TONE_FILMIC,   /* K. Narkowicz's fit of the ACES curve (2015), each channel alone */
    BIS_N_TONES
} bis_tone;

/* The curves' names in options, in the order of bis_tone, ended by NULL. */
extern const char *const bis_tone_names[BIS_N_TONES + 1];

/* bis_tone_find returns the curve of this name, or BIS_N_TONES. */
bis_tone bis_tone_find(const char *name);

/* bis_tone_apply multiplies the pixels by 2^ev and bends them by the curve, as they are before alpha dims them.
 * Negative values become 0 by a curve; what is not finite stays as it is. */
void bis_tone_apply(bis_image *image, double ev, bis_tone tone);
