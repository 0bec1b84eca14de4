/* SPDX-License-Identifier: BSD-2-Clause */
/* noise: Perlin's gradient noise and sums of it, as pbrt has them. For src/scene alone. */
#pragma once

/* No value of bis_noise exceeds this. tests/scene/test_procedural.c derives it: the worst gradients
 * give 1.037. */
#define BIS_NOISE_MOST 1.1

/* bis_noise returns the noise at p, any finite numbers; 0 at whole ones. Period 256 along each axis. */
double bis_noise(const double p[3]);

/* bis_noise_fbm returns the sum of roughness^i noise(1.99^i p), i = 0 ... octaves - 1. */
double bis_noise_fbm(const double p[3], double roughness, unsigned octaves);

/* bis_noise_turbulence returns the same sum of absolute values, and 0.2 roughness^octaves, which pbrt takes for the
 * mean of the next octave. */
double bis_noise_turbulence(const double p[3], double roughness, unsigned octaves);

/* bis_noise_weights returns the sum of roughness^i. */
double bis_noise_weights(double roughness, unsigned octaves);
