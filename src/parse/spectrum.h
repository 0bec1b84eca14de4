/* SPDX-License-Identifier: BSD-2-Clause */
/* spectrum: from a function of the wavelength to linear RGB (Rec. 709 primaries, white D65).
 *
 * Sums over 380, 390, ..., 780 nm with the colour matching functions of the CIE 1931 observer and the illuminant D65.
 */
#pragma once

#include "bis/base/vec.h"

#include <stdbool.h>
#include <stddef.h>

/* A spectrum that is linear between pairs[n] of (wavelength in nm, value), wavelengths ascending, and constant outside.
 * n >= 1. It borrows pairs. */
typedef struct bis_spectrum {
    const double (*pairs)[2];
    size_t n;
} bis_spectrum;

/* bis_spectrum_at returns the value at a wavelength in nm. */
double bis_spectrum_at(const bis_spectrum *s, double nm);

/* bis_spectrum_reflected returns the colour of D65 that a surface of this reflectance reflects, relative to white: a
 * constant c gives (c, c, c). A saturated colour may lie outside [0,1]. */
rgbd bis_spectrum_reflected(const bis_spectrum *s);

/* bis_spectrum_conductor stores the same for a smooth conductor of refractive index eta and absorption k: *head_on of
 * light along its normal, *mean of light from all directions alike (bis_fresnel_mean). */
void bis_spectrum_conductor(rgbd *head_on, rgbd *mean, const bis_spectrum *eta, const bis_spectrum *k);

/* bis_spectrum_blackbody returns the colour of a black body of this temperature in kelvin, 500 to 1e6, with luminance
 * 1 (0.2126 r + 0.7152 g + 0.0722 b = 1). Components may be negative. Source: Planck's law, c2 = 14387768.775 nm K. */
rgbd bis_spectrum_blackbody(double kelvin);

/* bis_spectrum_blackbody_peak returns the colour of the spectrum of a black body whose largest value is 1, as pbrt-v1
 * to v3 have it. Source: Wien's displacement law, b = 2897771.955 nm K. */
rgbd bis_spectrum_blackbody_peak(double kelvin);

/* bis_spectrum_emitted returns the colour of light of this spectrum. One that is 1 at all wavelengths has luminance 1,
 * and is not the white of RGB but (1.20, 0.95, 0.91). ends: the spectrum is 0 outside of its wavelengths. */
rgbd bis_spectrum_emitted(const bis_spectrum *s, bool ends);

/* bis_xyz_to_rgb converts CIE XYZ to linear RGB. */
rgbd bis_xyz_to_rgb(double x, double y, double z);
