/* peek: how large is what a file holds, by a look at its first bytes. For plan.c, which loads nothing. A wrong or strange file gives false; the
 * loaders will say why. */
#ifndef BIS_PEEK_H
#define BIS_PEEK_H

#include <stdbool.h>
#include <stddef.h>

/* .hdr, .pfm, .exr (the first part's data window). */
bool bis_peek_image(const char *path, long *width, long *height);

/* .ply: what the header claims. */
bool bis_peek_ply(const char *path, long *n_vertices, long *n_faces);

/* Of the whole file; 0: unknown. */
size_t bis_peek_bytes(const char *path);

#endif
