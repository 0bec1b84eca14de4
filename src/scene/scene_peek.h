/* scene_peek: how large is what a file holds, by a look at its first bytes. For plan.c, which loads nothing. A wrong or
 * strange file gives false; the loaders will say why. */
#ifndef BIS_SCENE_PEEK_H
#define BIS_SCENE_PEEK_H

#include <stdbool.h>
#include <stddef.h>

/* .hdr, .pfm, .exr (the first part's data window). */
bool bis_scene_peek_image(const char *path, long *width, long *height);

/* .ply: what the header claims. */
bool bis_scene_peek_ply(const char *path, long *n_vertices, long *n_faces);

/* Of the whole file; 0: unknown. */
size_t bis_scene_peek_bytes(const char *path);

#endif
