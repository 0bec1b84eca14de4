/* SPDX-License-Identifier: BSD-2-Clause */
/* phong: the energy-preserving Phong model. Source: thesis 3.5, eq. 3.14 to 3.17.
 *
 *     f(wi, wo) = Ks (n+1)/(2 pi) max(0, cos alpha)^n + Kd/pi
 *
 * alpha is the angle between wi and the mirror direction, which is wo mirrored about the normal. Directions are drawn
 * from a mixture of a lobe about the mirror direction (eq. 3.15, 3.16) and a cosine hemisphere about the normal
 * (docs/errata.md E33 to E36). */
#pragma once

#include "bis/thesis/bsdf.h"

extern const bis_bsdf_model bis_phong_model;
extern const bis_bsdf_many bis_phong_many; /* its loops over many directions */

/* bis_phong returns a phong material. Kd and Ks are in [0,1] per channel; a value below 2^-67 = 7e-21 counts as 0.
 * exponent is finite and >= 0. */
bis_material bis_phong(rgb Kd, rgb Ks, double exponent);

/* bis_phong_lobe_sample draws a direction about +z with density (n+1)/(2 pi) cos^n theta. Source: eq. 3.16.
 *
 *     n        the exponent, finite, >= 0 (0 gives the uniform hemisphere)
 *     u1, u2   uniform in [0,1), independent
 *     wi       out: a unit vector in the lobe's frame, wi.z >= 0
 *     pdf      out: the density at *wi in 1/sr, from the sampler's own angle in double; 0 only if cos^n underflows */
void bis_phong_lobe_sample(vec3 *wi, double *pdf, double n, double u1, double u2);

/* bis_phong_power returns max(0, cos)^n for the angle between the unit directions a and b. It computes n
 * log1p(-|a-b|^2/2), which has no cancellation (docs/errata.md E36). 0^0 is 0 here, because the horizon is dark. */
double bis_phong_power(vec3 a, vec3 b, double n);

/* bis_phong_lobe_pdf returns (n+1)/(2 pi) cos^n in 1/sr, the density of eq. 3.15, for the angle between axis and wi. */
double bis_phong_lobe_pdf(vec3 axis, vec3 wi, double n);
