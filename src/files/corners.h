/* SPDX-License-Identifier: BSD-2-Clause */
/* corners: in files, corners of faces name a position and, apart from it, a normal or texture coordinates; our meshes
 * have one index. So a position that faces use with several of these becomes several vertices, found again by a hash
 * table. For src/files/ply.c and src/files/obj.c alone. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { CORNER_FREE = UINT32_MAX };

/* Position v with whatever two numbers a reader tells apart. */
typedef struct split_corner {
    uint32_t v, a, b, vertex; /* vertex CORNER_FREE: an empty slot of the table */
} split_corner;

typedef struct split_corners {
    split_corner *table;      /* table[size]; a power of 2, at most half full */
    size_t size, n;
} split_corners;

/* bis_corners_find returns the entry of (v, a, b), whose vertex is CORNER_FREE if it is new: the caller gives it one.
 * NULL: no memory. It holds until the next call. */
split_corner *bis_corners_find(split_corners *s, uint32_t v, uint32_t a, uint32_t b);
