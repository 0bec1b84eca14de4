/* SPDX-License-Identifier: BSD-2-Clause */
/* quadric: spheres and discs under an affine transformation. Private to row 3; bis_quadric_intersect is public. */
#pragma once

#include "bis/shape/geometry.h"

/* bis_quadric_bounds returns the world-space box, rounded outwards. */
bis_box bis_quadric_bounds(const bis_quadric *q);

/* bis_quadric_surface stores the surface where r, which an accelerator found to hit q, meets it. */
void bis_quadric_surface(const bis_quadric *q, const ray *r, bis_surface *s);

/* bis_quadric_uv stores the texture coordinates there, as bis_geometry_uv says. */
void bis_quadric_uv(const bis_quadric *q, const ray *r, double uv[2]);

/* bis_quadric_tangents stores how it lies there, as bis_geometry_tangents says. */
void bis_quadric_tangents(const bis_quadric *q, const ray *r, bis_tangents *t);

/* bis_quadric_may_touch returns false only if no point of q lies in the box about `centre` (world space) with these
 * half extents. So the grid leaves a sphere out of the cells in its inside and its box's corners. */
bool bis_quadric_may_touch(const bis_quadric *q, const double centre[3], const double half[3]);
