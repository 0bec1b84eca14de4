/* SPDX-License-Identifier: BSD-2-Clause */
/* quadric: spheres and discs under an affine transformation. Private to row 3; bis_quadric_intersect is public. */
#pragma once

#include "bis/shape/geometry.h"

/* World-space box, rounded outwards. */
bis_box bis_quadric_bounds(const bis_quadric *q);

/* The surface where r, which an accelerator found to hit q, meets it. */
void bis_quadric_surface(const bis_quadric *q, const ray *r, bis_surface *s);

/* The texture coordinates there, as bis_geometry_uv says. */
void bis_quadric_uv(const bis_quadric *q, const ray *r, double uv[2]);

/* How it lies there, as bis_geometry_tangents says. */
void bis_quadric_tangents(const bis_quadric *q, const ray *r, bis_tangents *t);

/* False only if no point of q lies in the box about `centre` (world space) with these half extents: lets the grid leave
 * a sphere out of the cells in its inside and its box's corners. */
bool bis_quadric_may_touch(const bis_quadric *q, const double centre[3], const double half[3]);
