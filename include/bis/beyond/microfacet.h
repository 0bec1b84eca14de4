/* SPDX-License-Identifier: BSD-2-Clause */
/* microfacet: a rough mirror of tiny facets with the GGX distribution, over a diffuse base. The thesis does not have
 * it: its only model is Phong's.
 *
 *     f = F D G2 / (4 cos theta_i cos theta_o) + 28/(23 pi) Kd (1 - Ks) A(cos theta_i) A(cos theta_o)
 *     A(c) = 1 - (1 - c/2)^5
 *
 * D is that of Walter et al. 2007. G2 is the height-correlated masking and shadowing of Smith (Heitz 2014). F = Ks +
 * (1 - Ks)(1 - cos theta_d)^5 (Schlick 1994), or Fresnel's equations for a metal. The base is that of Ashikhmin and
 * Shirley 2000; with it, no Kd and Ks in [0,1] reflect more light than arrives. Directions are drawn from a mixture of
 * the mirror directions of visible facets (Heitz 2018; Dupuy and Benyoub 2023) and a cosine hemisphere. */
#pragma once

#include "bis/thesis/bsdf.h"

/* The smallest roughness. Unit vectors in float do not resolve the lobe of a smoother surface. */
#define BIS_MICROFACET_MIN_ROUGHNESS 0.01

extern const bis_bsdf_model bis_microfacet_model, bis_plastic_model;
extern const bis_bsdf_many bis_microfacet_many, bis_plastic_many; /* their loops over many directions */

/* bis_microfacet returns a microfacet material. Ks (reflectance at normal incidence) and Kd are in [0,1] per channel;
 * a channel with Ks = 0 has no lobe, and a value below 2^-67 = 7e-21 counts as 0. roughness is in
 * [BIS_MICROFACET_MIN_ROUGHNESS, 1]. alpha = roughness^2 (Burley 2012), because equal steps of roughness then look
 * equal. */
bis_material bis_microfacet(rgb Kd, rgb Ks, double roughness);

/* bis_microfacet_metal returns bis_microfacet(0, Ks, roughness) with another F: that of Fresnel's equations with the
 * refractive index eta, finite and >= 0, and the absorption bis_fresnel_k2(Ks, eta), with which F is Ks head on. A
 * channel with eta = 0, or with Ks of 0 or 1, keeps Schlick's F. */
bis_material bis_microfacet_metal(rgb Ks, rgb eta, double roughness);

/* bis_plastic returns pbrt's plastic: the same facets over Lambert's base Kd/pi, with F = Ks times what Fresnel's
 * equations say of glass of the refractive index eta, relative to head on. eta is finite and > 0. As in pbrt, the base
 * loses nothing to the facets: with a large Kd and Ks a surface reflects more than it receives. */
bis_material bis_plastic(rgb Kd, rgb Ks, double eta, double roughness);

/* A of the base for plastic, sqrt(23/28): see microfacet.c. */
#define BIS_PLASTIC_A 0.90632696717496640
