/* SPDX-License-Identifier: BSD-2-Clause */
/* ply: meshes in Greg Turk's polygon file format, as scans come in. For scene.c and tests. */
#pragma once

#include "bis/shape/geometry.h"

/* bis_ply_read reads vertices x y z (and nx ny nz), faces (polygons as fans) and tristrips, in ascii and both binary
 * orders, and skips anything else.
 * Every index is in range and every coordinate finite on return; a normal that is not is (0,0,0), with a warning. On
 * failure m is empty.
 * `at`: the scene line that named the file, or {0}. Errors: BIS_IO, BIS_INPUT (damaged: the message names line or
 * face), BIS_NOMEM. */
bis_status bis_ply_read(bis_mesh *m, const char *path, bis_loc at, bis_diag *diag);

/* bis_ply_read_uv does the same and keeps texture coordinates: u v, s t, texture_u texture_v or texture_s texture_t of
 * the vertices. m->uv is NULL where the file has none. */
bis_status bis_ply_read_uv(bis_mesh *m, const char *path, bis_loc at, bis_diag *diag);
