/* SPDX-License-Identifier: BSD-2-Clause */
/* make_grid: surfaces over the unit square become triangles. For src/shape/make_*.c alone. */
#pragma once

#include "bis/shape/make.h"

/* A point of a surface. n: any length, with the side that pbrt calls outside; (0,0,0): the normal of the face. */
typedef struct bis_grid_point {
    double p[3], n[3];
    bis_uv uv;
} bis_grid_point;

/* What gives the point at (s, t) in [0,1]^2. */
typedef void bis_grid_at(bis_grid_point *out, const void *surface, double s, double t);

/* bis_grid_room makes *m an empty mesh with room for so many vertices and triangles, with normals and (u, v). Errors:
 * BIS_NOMEM. */
bis_status bis_grid_room(bis_mesh *m, size_t n_vertices, size_t n_triangles, bis_loc at, bis_diag *diag);

/* bis_grid_add appends ns x nt pieces of two triangles each to a mesh that has the room. The diagonal runs from the
 * corner of least s and t. */
void bis_grid_add(bis_mesh *m, size_t ns, size_t nt, bis_grid_at *at, const void *surface);

/* bis_grid_normal stores in out along x across, the normal of a surface's two tangents. It stores (0,0,0) where that is
 * rounding noise, as where two sides of a patch cross, or at a pole, because the direction of noise means nothing.
 * noise: how far a part of each tangent may be off. */
void bis_grid_normal(double out[3], const double along[3], const double across[3], const double noise[2]);
