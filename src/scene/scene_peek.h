/* SPDX-License-Identifier: BSD-2-Clause */
/* scene_peek: what a file holds and how large that is, by a look at its first bytes. For plan.c, which loads nothing,
 * and for the parser, which is given a map or a mesh now and then. A wrong or strange file gives false; the loaders
 * will say why. */
#pragma once

#include "files/obj.h"

#include <stdbool.h>
#include <stddef.h>

/* bis_scene_peek_image stores the size of an image: .hdr, .pfm, .exr (the first part's data window), .png, .jpg,
 * .bmp, .tga. */
bool bis_scene_peek_image(const char *path, long *width, long *height);

/* bis_scene_peek_ply stores what the header of a .ply claims. */
bool bis_scene_peek_ply(const char *path, long *n_vertices, long *n_faces);

/* bis_scene_peek_is_text returns whether an .obj begins with text, as far as one looks. */
bool bis_scene_peek_is_text(const char *path);

/* bis_scene_peek_obj reads what an .obj says of materials. Here a strange file is an error, as for
 * bis_obj_read_materials. */
bis_status bis_scene_peek_obj(bis_obj_materials *out, const char *path, bis_loc at, bis_diag *diag);

/* bis_scene_peek_text reads a scene's text whole, expanded if it is compressed by gzip. *data receives *size bytes and
 * one zero byte after them, for bis_free. Errors: those of bis_gzip_read. */
bis_status bis_scene_peek_text(unsigned char **data, size_t *size, const char *path, bis_loc at, bis_diag *diag);

typedef enum bis_stranger_kind {
    BIS_STRANGER_MAP,
    BIS_STRANGER_PLY,
    BIS_STRANGER_OBJ,
    BIS_STRANGER_OTHER
} bis_stranger_kind;

/* bis_scene_peek_stranger tells whether the file at path is surely no scene, by its first bytes or its ending. It
 * returns what the file is, "a Radiance map", and sets *kind to what can be done with it. NULL: it may be a scene, or
 * it is no regular file, or it cannot be read. */
const char *bis_scene_peek_stranger(const char *path, bis_stranger_kind *kind);

/* bis_scene_peek_bytes returns the bytes of the whole file, or 0 if they are unknown. */
size_t bis_scene_peek_bytes(const char *path);
