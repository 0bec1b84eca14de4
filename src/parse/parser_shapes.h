/* SPDX-License-Identifier: BSD-2-Clause */
/* parser_shapes: what the files of shapes know of each other. */
#pragma once

#include "parser.h"

/* bis_parser_add_shape adds a shape to the scene, or to the object that is open (parser_blocks.c). */
void bis_parser_add_shape(bis_parser *p, const bis_shape_desc *shape);

/* bis_parser_override makes, in pbrt-v1 to v3, a material of *material's parameters and of those that the shape gives
 * itself, which are what no one has asked for yet (parser_world.c). */
void bis_parser_override(bis_parser *p, uint32_t *material);

/* bis_parser_add_mesh adds a mesh to the scene, takes over what it owns, and stores its index. Returns false after a
 * complaint (parser_points.c, like the next two). */
bool bis_parser_add_mesh(bis_parser *p, const bis_mesh_desc *mesh, uint32_t *index);

/* bis_parser_points reads P, N and uv of a shape into m. Returns false after a complaint. */
bool bis_parser_points(bis_parser *p, const char *shape, bis_mesh *m);

/* bis_parser_indices reads the faces of a shape, index[n_faces][per_face] from bis_alloc, which is the caller's after a
 * complaint, too. Without "indices" the points are one face. Returns false after a complaint. */
bool bis_parser_indices(bis_parser *p, const char *shape, size_t per_face, size_t n_points, uint32_t **index,
                        size_t *n_faces);

/* Shapes that are made by a formula or of a few points, behind all of bis_shape_kind. */
enum {
    BIS_MADE_SPHERE = 100,
    BIS_MADE_DISK,
    BIS_MADE_CYLINDER,
    BIS_MADE_CONE,
    BIS_MADE_PARABOLOID,
    BIS_MADE_HYPERBOLOID,
    BIS_MADE_LOOP,
    BIS_MADE_PATCHES,
    BIS_MADE_HEIGHTS,
    BIS_MADE_NURBS
};

/* bis_parser_made reads such a shape (parser_made.c): a whole sphere or disk becomes a quadric, all else a mesh.
 * Returns false after a complaint, or if there is nothing of it. */
bool bis_parser_made(bis_parser *p, int made, bis_shape_desc *shape);

/* bis_parser_add_parts adds, of an OBJ with materials, the shapes of its parts (parser_mtl.c). */
void bis_parser_add_parts(bis_parser *p, const bis_shape_desc *shape);
