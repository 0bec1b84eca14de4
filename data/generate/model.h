/* SPDX-License-Identifier: BSD-2-Clause */
/* model: the shapes of data/models, drawn by formulas. All are closed surfaces, counter-clockwise seen from outside, z
 * up, with vertex normals; a mesh is closed in its indices, too, unless its docstring says that it has several closed
 * parts.
 * For data/generate/make_data.c alone. */
#ifndef MODEL_H
#define MODEL_H

#include "bis/shape/geometry.h"
#include "bis/base/status.h"

#include <stddef.h>

/* --- model_mesh.c: building and writing --- */

enum { MODEL_MAX_OUTLINE = 2048 };

/* An open line from the axis to the axis, (r, z) bottom to top, that is turned about z. */
typedef struct model_profile {
    size_t n;
    double r[MODEL_MAX_OUTLINE], z[MODEL_MAX_OUTLINE];
} model_profile;

/* A corner of a turner's drawing; round: how much of the shorter neighbouring side's half is rounded away, 0 (sharp) to
 * 1. */
typedef struct model_corner {
    double r, z, round;
} model_corner;

/* The profile through corners[n], with no two points further apart than step. */
void model_profile_draw(model_profile *p, const model_corner *corners, size_t n, double step);

/* Where the profile's point (r, z) goes at angle theta, 0 <= theta < 2 pi; data is the caller's. */
typedef vec3 (*model_bend)(const void *data, double r, double z, double theta);

/* The round one. */
vec3 model_round(const void *data, double r, double z, double theta);

/* Turn the profile (its ends lie on the axis) in n_around steps: (p->n - 2) * n_around * 2 triangles. */
bis_status model_turn(
    bis_mesh *m, const model_profile *p, size_t n_around, model_bend bend, const void *data, bis_diag *diag);

/* A closed tube: position(data, u, v), u and v in [0, 1) and periodic, n_u * n_v * 2 triangles. */
typedef vec3 (*model_tube)(const void *data, double u, double v);
bis_status model_tube_mesh(bis_mesh *m, size_t n_u, size_t n_v, model_tube position, const void *data, bis_diag *diag);

/* Append a copy of part, moved by `by`: a mesh of several closed parts. */
bis_status model_append(bis_mesh *m, const bis_mesh *part, vec3 by, bis_diag *diag);

/* Binary little-endian PLY: x y z nx ny nz, triangles with 32-bit indices. Vertex normals are made here, from the
 * faces. */
bis_status model_write(bis_mesh *m, const char *path, bis_diag *diag);

/* --- model_carve.c: reliefs cut from an outline --- */

/* A block that stands in the x-z plane: outline (x[n], z[n], counter-clockwise with x to the right and z up),
 * half_thickness in y, its edge rounded over a width of `edge`. groove (may be NULL) cuts: it is added to the implicit
 * function, positive where matter is taken away. */
typedef struct model_block {
    const double *x, *z;
    size_t n;
    double edge, cell;
    double (*half_thickness)(double x, double z);
    double (*groove)(double x, double y, double z, double inside);
} model_block;

bis_status model_carve(bis_mesh *m, const model_block *block, bis_diag *diag);

/* --- model_chess.c: pieces on squares of side 1; model_knot.c; model_stage.c --- */

bis_status model_king(bis_mesh *m, bis_diag *diag);
bis_status model_queen(bis_mesh *m, bis_diag *diag);
bis_status model_bishop(bis_mesh *m, bis_diag *diag);
bis_status model_knight(bis_mesh *m, bis_diag *diag);
bis_status model_rook(bis_mesh *m, bis_diag *diag);
bis_status model_pawn(bis_mesh *m, bis_diag *diag);

/* A trefoil knot, its tube carved as a braid: at least n_triangles of them (and at most 1% + 1000 more), in one closed
 * part, within a box of about 3.2 x 1.4 x 3.0 about the origin, its face turned to -y. */
bis_status model_knot(bis_mesh *m, size_t n_triangles, bis_diag *diag);

/* The 32 light (or dark) squares of a board in [-4, 4]^2 with their tops at z = 0, each a closed part; and the board
 * that holds them. */
bis_status model_squares(bis_mesh *m, bool dark, bis_diag *diag);
bis_status model_board(bis_mesh *m, bis_diag *diag);

/* A pedestal, top at z = 0, 1.3 wide there; a paving of flagstones, [-8, 8]^2, tops at about z = 0; five louvres, [-1,
 * 1]^2 about the origin, in the x-z plane; a unit sphere of n_around * (n_around - 2) triangles (n_around even). */
bis_status model_pedestal(bis_mesh *m, bis_diag *diag);
bis_status model_paving(bis_mesh *m, bis_diag *diag);
bis_status model_louvres(bis_mesh *m, bis_diag *diag);
bis_status model_sphere(bis_mesh *m, size_t n_around, bis_diag *diag);

#endif
