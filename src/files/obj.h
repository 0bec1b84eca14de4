/* obj: meshes in Wavefront's text format. For scene.c and tests. */
#pragma once

#include "bis/shape/geometry.h"

/* v, vn and f are read (polygons as fans; v, v/vt, v//vn, v/vt/vn; negative indices count from the last one); all else
 * is skipped.
 * A vertex that faces use with several normals is split, so that each (v, vn) pair is one vertex; vertices keep the
 * file's order, the further pairs follow. Every index is in range and every coordinate finite on return. On failure m
 * is empty. `at`: the scene line that named the file, or {0}. Errors: BIS_IO, BIS_INPUT (the message names the line),
 * BIS_NOMEM. */
bis_status bis_obj_read(bis_mesh *m, const char *path, bis_loc at, bis_diag *diag);

/* bis_obj_read_uv does the same and keeps texture coordinates: a vertex that faces use with several vt or vn is split,
 * so that each (v, vt, vn) is one vertex. m->uv is NULL where no face uses any. */
bis_status bis_obj_read_uv(bis_mesh *m, const char *path, bis_loc at, bis_diag *diag);
