/* SPDX-License-Identifier: BSD-2-Clause */
/* make: meshes of shapes that a scene describes by formulas or by a few points: surfaces of revolution, Loop's
 * subdivision, bilinear patches, height fields, NURBS. All are pbrt's. The accelerators and integrators see triangles
 * with smooth normals, and a scene without such shapes pays nothing.
 *
 * Each function stores in *m a mesh whose arrays come from bis_alloc; after an error *m is empty. `at` is the place of
 * its messages. */
#pragma once

#include "bis/shape/geometry.h"

enum {
    BIS_MAKE_TURN = 256,       /* pieces of a whole turn */
    BIS_MAKE_NURBS = 64,       /* pieces of a NURBS surface along each of its parameters */
    BIS_MAKE_MAX_LEVELS = 10,  /* of subdivision: each makes four triangles of one */
    BIS_MAKE_MAX_ORDER = 16    /* of a NURBS surface: its degree and 1 */
};

/* No point of a surface of revolution's mesh is further from the surface than this share of its largest radius or of
 * its height, whichever is larger: 1 - cos(pi/256) = 7.5e-5 where the profile is straight, and twice that, across the
 * diagonals of square pieces, on a sphere. */
#define BIS_MAKE_REVOLVED_ERROR 1.6e-4

/* No point of a bilinear patch's mesh is further from the patch than this share of the diagonal of the box of all
 * patches of the mesh. */
#define BIS_MAKE_PATCH_ERROR 1e-4

/* What turns about the z axis. */
typedef enum bis_profile {
    BIS_PROFILE_LINE,      /* from p[0] to p[1]: cylinder, cone, ring, hyperboloid */
    BIS_PROFILE_PARABOLA,  /* x = radius sqrt(z/z[1]), from z[0] >= 0 to z[1] > z[0] */
    BIS_PROFILE_CIRCLE     /* x^2 + z^2 = radius^2, from z[0] to z[1], both in [-radius, radius] */
} bis_profile;

/* A surface of revolution. Its u is the angle from the profile over phi_max, its v is 0 at the profile's first end and
 * 1 at its second; pbrt's are the same. */
typedef struct bis_revolved {
    bis_profile profile;
    double p[2][3];
    double radius, z[2];
    double phi_max_deg; /* (0, 360] */
} bis_revolved;

/* How much a mesh will hold. */
typedef struct bis_made_size {
    size_t vertices, triangles;
} bis_made_size;

/* bis_make_revolved_size returns what bis_make_revolved will make. */
bis_made_size bis_make_revolved_size(const bis_revolved *r);

/* bis_make_revolved makes the mesh of a surface of revolution, with normals and (u, v). Errors: BIS_NOMEM. */
bis_status bis_make_revolved(bis_mesh *m, const bis_revolved *r, bis_loc at, bis_diag *diag);

/* bis_make_subdivided_size stores what bis_make_subdivided will make of a control mesh, which it checks: its errors. */
bis_status bis_make_subdivided_size(bis_made_size *size, const bis_mesh *m, unsigned levels, bis_loc at,
                                    bis_diag *diag);

/* bis_make_subdivided replaces the control mesh *m by the mesh that `levels` steps of Loop's subdivision make of it,
 * with all vertices moved to where infinitely many steps would take them, and with the limit surface's normals.
 * levels <= BIS_MAKE_MAX_LEVELS. Normals and (u, v) of the control mesh are dropped.
 * Rules: Loop 1987 with Warren's weights, and cubic B-splines along borders, as in pbrt. The limits are the exact ones
 * of these rules (src/shape/make_subdivided.c says where pbrt's are not).
 * Errors: BIS_NOMEM; BIS_INPUT (an edge of more than two triangles; two triangles that turn against each other; a
 * vertex where two surfaces touch; more than 2^30 triangles). After BIS_INPUT *m is the control mesh. */
bis_status bis_make_subdivided(bis_mesh *m, unsigned levels, bis_loc at, bis_diag *diag);

/* bis_make_patches replaces the points of *m (positions, and where given normals and (u, v)) by the mesh of n bilinear
 * patches between them. corner[n][4] are indices of points, at (u, v) = (0,0), (1,0), (0,1) and (1,1). Errors:
 * BIS_NOMEM, BIS_INPUT (more than 2^30 triangles). */
bis_status bis_make_patches(bis_mesh *m, const uint32_t (*corner)[4], size_t n, bis_loc at, bis_diag *diag);

/* bis_make_height_field makes the mesh of nu x nv heights z[nv][nu] over the unit square, as pbrt does: two flat
 * triangles between four of them, and (u, v) = (x, y). nu, nv >= 2. Errors: BIS_NOMEM. */
bis_status bis_make_height_field(bis_mesh *m, const double *z, size_t nu, size_t nv, bis_loc at, bis_diag *diag);

/* A NURBS surface. point[nv][nu][4] are x w, y w, z w, w as in pbrt's "Pw", w > 0; knots[k] has n[k] + order[k]
 * numbers that do not descend; end[k] are the ends of the parameters, inside the knots [order - 1] and [n]. */
typedef struct bis_nurbs {
    size_t n[2], order[2];
    const double *knots[2];
    const double (*point)[4];
    double end[2][2];
} bis_nurbs;

/* bis_make_nurbs makes the mesh of a NURBS surface, with normals, and its parameters as (u, v). Errors: BIS_NOMEM. */
bis_status bis_make_nurbs(bis_mesh *m, const bis_nurbs *s, bis_loc at, bis_diag *diag);
