/* SPDX-License-Identifier: BSD-2-Clause */
/* obj: meshes in Wavefront's text format. For scene.c and tests. */
#pragma once

#include "base/names.h"
#include "bis/shape/geometry.h"

/* bis_obj_read reads v, vn and f (polygons as fans; v, v/vt, v//vn, v/vt/vn; negative indices count from the last one)
 * and skips all else.
 * A vertex that faces use with several normals is split, so that each (v, vn) pair is one vertex; vertices keep the
 * file's order, the further pairs follow. Every index is in range and every coordinate finite on return. On failure m
 * is empty. `at`: the scene line that named the file, or {0}. Errors: BIS_IO, BIS_INPUT (the message names the line),
 * BIS_NOMEM. */
bis_status bis_obj_read(bis_mesh *m, const char *path, bis_loc at, bis_diag *diag);

/* bis_obj_read_uv does the same and keeps texture coordinates: a vertex that faces use with several vt or vn is split,
 * so that each (v, vt, vn) is one vertex. m->uv is NULL where no face uses any. */
bis_status bis_obj_read_uv(bis_mesh *m, const char *path, bis_loc at, bis_diag *diag);

/* bis_obj_read_parts does the same, with texture coordinates if wants_uv, and sets m->part: 0 for faces before the
 * first usemtl, k for those behind the k-th name that a usemtl mentions first. *n_parts is the number of these names.
 */
bis_status bis_obj_read_parts(bis_mesh *m, size_t *n_parts, const char *path, bool wants_uv, bis_loc at,
                              bis_diag *diag);

/* A file that mtllib names, and the line of that. */
typedef struct bis_obj_library {
    char *name;
    int line;
} bis_obj_library;

/* What an OBJ says of materials. */
typedef struct bis_obj_materials {
    bis_names parts;  /* names of usemtl, with their parts' numbers */
    bool *is_shown;   /* is_shown[n_shown]: does part k have a face? Those beyond have none */
    size_t n_shown, capacity_shown;
    bis_obj_library *libraries;
    size_t n_libraries, capacity_libraries;
} bis_obj_materials;

/* bis_obj_read_materials reads these and nothing else. The file may be compressed. Errors: those of bis_gzip_read;
 * BIS_NOMEM. */
bis_status bis_obj_read_materials(bis_obj_materials *out, const char *path, bis_loc at, bis_diag *diag);
void bis_obj_materials_clear(bis_obj_materials *m);
