/* SPDX-License-Identifier: BSD-2-Clause */
/* fresnel: what a smooth surface of refractive index eta and absorption k reflects of unpolarised light from vacuum.
 * Source: Fresnel's equations with the index eta + i k (Born and Wolf, Principles of Optics, 14.2). k enters as its
 * square k2; 0 is a dielectric, seen from outside. */
#pragma once

/* bis_fresnel returns the reflectance, in [0,1], at cos theta = c in [0,1]. eta >= 0 and k2 >= 0 are below 1e30. With
 * eta = 1 and k2 = 0, which is no surface, c must be above 0. */
double bis_fresnel(double eta, double k2, double c);

/* bis_fresnel_mean returns the mean of light from all directions alike: the integral of 2 c F(c) over c in [0,1]. Its
 * error is below 1e-4 for indices of metals and glass. */
double bis_fresnel_mean(double eta, double k2);

/* bis_fresnel_k2 returns the k2 with which eta reflects R in [0,1) at normal incidence,
 * (R (eta + 1)^2 - (eta - 1)^2)/(1 - R), or 0 if none does. */
double bis_fresnel_k2(double R, double eta);

/* bis_fresnel_eta returns the eta of the surface that reflects R in (0,1) at normal incidence, and `mean` on average;
 * the nearest there is, if there is none. With it, one index stands for those of many wavelengths. */
double bis_fresnel_eta(double R, double mean);
