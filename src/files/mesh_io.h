/* SPDX-License-Identifier: BSD-2-Clause */
/* mesh_io: what the readers of .ply and .obj share. For src/files/ply*.c and src/files/obj.c alone. */
#pragma once

#include "bis/shape/geometry.h"

/* A whole file in memory, with one zero byte behind it, and where to complain. */
typedef struct mesh_input {
    const unsigned char *data;
    size_t size;
    const char *path;
    bis_loc at; /* the scene line that named the file; file NULL: none */
    bis_diag *diag;
} mesh_input;

/* bis_mesh_refuse adds the error "PATH:LINE: error: TEXT", or "SCENE:LINE:COLUMN: error: PATH:LINE: TEXT" for a mesh
 * that a scene names. line 0: not a line of text. Returns code. */
bis_status bis_mesh_refuse(const mesh_input *in, int line, bis_status code, const char *fmt, ...) BIS_PRINTF(4, 5);

/* bis_mesh_remark adds the same as a warning. */
void bis_mesh_remark(const mesh_input *in, const char *fmt, ...) BIS_PRINTF(2, 3);

/* bis_mesh_line returns the line, from 1, in which byte p of the file stands. Lines end with \n, \r or both. O(p): for
 * messages. */
int bis_mesh_line(const mesh_input *in, const unsigned char *p);

/* bis_mesh_add_triangle appends a triangle; *capacity counts triangles. Errors: BIS_INPUT, BIS_NOMEM. */
bis_status bis_mesh_add_triangle(bis_mesh *m, size_t *capacity, const uint32_t v[3], const mesh_input *in);

/* bis_mesh_finish gives back what the index array has too much, and warns of an empty mesh. Errors: BIS_NOMEM. */
bis_status bis_mesh_finish(bis_mesh *m, size_t capacity, const mesh_input *in);
