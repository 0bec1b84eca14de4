/* SPDX-License-Identifier: BSD-2-Clause */
/* primaries: colours of other primaries as those of Rec. 709. For src/files alone. */
#pragma once

#include "image_io.h"

/* Where red, green, blue and white lie in the CIE diagram: rx, ry, gx, gy, bx, by, wx, wy. */
extern const float bis_rec709[8], bis_xyz[8];

/* bis_primaries_matrix stores in m what takes R, G, B of these primaries to those of Rec. 709, by way of XYZ. White is
 * not adapted: R = G = B of a white other than D65 becomes a tint, as in Mitsuba and pbrt-v4. Returns false if the
 * primaries lie on a line or the white's y is 0. */
bool bis_primaries_matrix(double m[3][3], const float c[8]);

/* bis_primaries_convert turns the colours of an image into those of Rec. 709, and says so. What was nowhere negative
 * and becomes so, because it lies outside of Rec. 709, is set to 0, with a remark. */
void bis_primaries_convert(bis_image *image, const double m[3][3], const image_input *in);
