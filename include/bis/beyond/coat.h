/* SPDX-License-Identifier: BSD-2-Clause */
/* coat: what a rough layer of varnish over a diffuse base lets through and throws back, as pbrt-v4's random walk in a
 * "coateddiffuse" finds it: facets of GGX with Smith's masking refract and reflect once, and the layer leaves
 * exp(-thickness/cos) of what crosses it. */
#pragma once

/* bis_coat_shares stores two shares of light, both of light from all directions alike: *in of what falls onto the coat
 * arrives at the base, and *back of what leaves the base returns to it. alpha in (0, 1] is that of the facets, eta >= 1
 * the refractive index, thickness >= 0 that of the layer in mean free paths. Both are good to 0.002. A base of
 * reflectance r then shows r in^2/eta^2/(1 - r back): pbrt 4th edition, 14.3. */
void bis_coat_shares(double *in, double *back, double alpha, double eta, double thickness);
