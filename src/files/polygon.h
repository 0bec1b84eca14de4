/* SPDX-License-Identifier: BSD-2-Clause */
/* polygon: faces of four corners and more become triangles. For src/files/ply.c and src/files/obj.c alone.
 *
 * A reader writes a fan about the first corner, because the positions of corners may come later in the file, and notes
 * where it is. When all is read, the fans that do not cover their polygons are replaced. */
#pragma once

#include "mesh_io.h"

/* The triangles [first, first + n) of the mesh are the fan of a polygon of n + 2 corners. */
typedef struct polygon {
    uint32_t first, n;
} polygon;

typedef struct polygons {
    polygon *list;
    size_t n, capacity;
} polygons;

/* bis_polygons_note notes that the triangles of m from `first` on are the fan of a polygon, if there are two or more.
 * Returns false without memory. */
bool bis_polygons_note(polygons *p, const bis_mesh *m, size_t first);

/* bis_polygons_triangulate replaces the fans that overlap themselves by triangles that cover their polygons: as many,
 * turning the same way. Other fans stay as they are. It frees the list, also after an error: BIS_NOMEM. */
bis_status bis_polygons_triangulate(bis_mesh *m, polygons *p, const mesh_input *in);
