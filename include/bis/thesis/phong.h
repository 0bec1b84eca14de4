/* phong: the energy-preserving Phong model, thesis 3.5, eq. 3.14 to 3.17.
 *
 *     f(wi, wo) = Ks (n+1)/(2 pi) max(0, cos alpha)^n + Kd/pi          alpha: between wi and wo mirrored about the normal
 *
 * sampled as a mixture of a lobe about the mirror direction (eq. 3.15, 3.16) and a cosine hemisphere about the normal
 * (docs/errata.md E33 to E36). */
#ifndef BIS_PHONG_H
#define BIS_PHONG_H

#include "bis/thesis/bsdf.h"

extern const bis_bsdf_model bis_phong_model;

/* Ks, Kd in [0,1] per channel; what is below 2^-67 = 7e-21 counts as 0. */
bis_material bis_phong(rgb Kd, rgb Ks, double exponent);

/* Draw a direction about +z with density (n+1)/(2 pi) cos^n theta, eq. 3.16.
 *
 *   n        exponent, finite, >= 0 (0: the uniform hemisphere)
 *   u1, u2   uniform in [0,1), independent
 *   wi       out: unit, wi.z >= 0, in the lobe's frame
 *   pdf      out: the density at *wi in 1/sr, from the sampler's own double angle; 0 only where cos^n underflows */
void bis_phong_lobe_sample(vec3 *wi, double *pdf, double n, double u1, double u2);

/* max(0, cos)^n for the angle between two unit directions, from |a - b|^2 without cancellation: n log1p(-|a-b|^2/2)
 * (E36). 0^0 = 0: the horizon is dark. */
double bis_phong_power(vec3 a, vec3 b, double n);

/* (n+1)/(2 pi) cos^n, eq. 3.15, in 1/sr. */
double bis_phong_lobe_pdf(vec3 axis, vec3 wi, double n);

#endif
