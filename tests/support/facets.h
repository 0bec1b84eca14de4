/* SPDX-License-Identifier: BSD-2-Clause */
/* facets: what microfacets of GGX must do, by quadrature over facets and by the papers' formulas, sharing nothing with
 * src: for the tests of microfacet.c. */
#ifndef TESTS_FACETS_H
#define TESTS_FACETS_H

#include "lit.h"

/* Cells of the facets that mirror wo to wi, about the normal: RINGS of equal quantiles of a, in SECTORS. */
enum { FACETS_RINGS = 24, FACETS_SECTORS = 24, FACETS_CELLS = FACETS_RINGS * FACETS_SECTORS };

/* How many of `count` visible facets lie in each cell. The view is at `degrees` from the normal, above (0.6, 0.8) of
 * the frame's x and y. */
void facets_expect(double expected[FACETS_CELLS], double a, double degrees, double count);

/* The cell of the facet between wi and the view. */
int facets_cell(const bis_bsdf *b, double a, vec3 wi);

/* Cells of equal solid angle about the normal (0, 0, 1), below the horizon too. */
enum { MIXTURE_Z = 24, MIXTURE_PHI = 16, MIXTURE_CELLS = MIXTURE_Z * MIXTURE_PHI };

/* How many of `count` draws from the mixture of m lie in each cell, by midpoints of lit_f's density. Exact enough for
 * views at 60 degrees: what mirrors can send lies above cos = -1/2, an edge of the cells. */
void mixture_expect(double expected[MIXTURE_CELLS], const bis_material *m, double degrees, double count);
int mixture_cell(vec3 wi);

/* The albedo of white facets, no direction in float: the mean of G2/G1 over what is seen. */
double facets_albedo_of_white(double a, double degrees);

#endif
