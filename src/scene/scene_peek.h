/* SPDX-License-Identifier: BSD-2-Clause */
/* scene_peek: what a file holds and how large that is, by a look at its first bytes. For plan.c, which loads nothing,
 * and for the parser, which is given a map or a mesh now and then. A wrong or strange file gives false; the loaders
 * will say why. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* bis_scene_peek_image stores the size of an image: .hdr, .pfm, .exr (the first part's data window), .png, .jpg,
 * .bmp, .tga. */
bool bis_scene_peek_image(const char *path, long *width, long *height);

/* bis_scene_peek_ply stores what the header of a .ply claims. */
bool bis_scene_peek_ply(const char *path, long *n_vertices, long *n_faces);

/* bis_scene_peek_is_text returns whether an .obj begins with text, as far as one looks. */
bool bis_scene_peek_is_text(const char *path);

typedef enum bis_stranger_kind {
    BIS_STRANGER_MAP,
    BIS_STRANGER_PLY,
    BIS_STRANGER_OBJ,
    BIS_STRANGER_MODEL, /* of another format: BIS_MODEL_ADVICE says the way */
    BIS_STRANGER_OTHER
} bis_stranger_kind;

#define BIS_MODEL_ADVICE \
    "convert it to OBJ, by `assimp export MODEL model.obj` (Debian's assimp-utils) or, where images are inside of " \
    "it, by Python's trimesh: trimesh.load(\"MODEL\").export(\"model.obj\"); then Shape \"objmesh\" \"string " \
    "filename\" \"model.obj\" \"bool materials\" true (README, \"Your own model under your own map\")"

/* bis_scene_peek_stranger tells whether the file at path is surely no scene, by its first bytes or its ending. It
 * returns what the file is, "a Radiance map", and sets *kind to what can be done with it. NULL: it may be a scene, or
 * it is no regular file, or it cannot be read. */
const char *bis_scene_peek_stranger(const char *path, bis_stranger_kind *kind);

/* bis_scene_peek_bytes returns the bytes of the whole file, or 0 if they are unknown. */
size_t bis_scene_peek_bytes(const char *path);
