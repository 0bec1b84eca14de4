/* SPDX-License-Identifier: BSD-2-Clause */
/* edges: the pixels in which the picture changes abruptly, found before anything is rendered. For the files of
 * src/render. */
#pragma once

#include "bis/render/render.h"
#include "bis/scene/scene.h"

/* What changes between the corners of a pixel: nothing much; what the material's lobe sees; what there is to see. */
enum { BIS_EDGE_NONE, BIS_EDGE_TURN, BIS_EDGE_OUTLINE, BIS_EDGE_KINDS };

/* bis_edges_samples returns how many camera samples a pixel of this kind has for each one of other pixels. */
static inline uint32_t bis_edges_samples(int kind, uint32_t edge_samples)
{
    return kind == BIS_EDGE_NONE ? 1 : kind == BIS_EDGE_TURN ? (edge_samples + 1) / 2 : edge_samples;
}

/* bis_edges_turns returns turns[n_materials], to be freed: for each material the cosine of the angle between two
 * normals of a pixel from which on it is a BIS_EDGE_TURN. With textures, it is that of the values that they replace.
 * NULL: no memory. */
double *bis_edges_turns(const bis_scene_desc *desc);

/* Two bits a pixel of an area (pixels of the film's full picture), tile by tile: a tile has bytes of its own, so
 * threads may look at different tiles. */

/* bis_edges_bytes returns the bytes of an area. */
size_t bis_edges_bytes(bis_rect area);

/* bis_edges_place returns the number of pixel (x, y) among the pairs of bits. */
static inline size_t bis_edges_place(bis_rect area, int x, int y)
{
    enum { SIDE = BIS_RENDER_TILE };
    const size_t across = (size_t)((area.x1 - 1) / SIDE - area.x0 / SIDE + 1);
    const size_t tile = (size_t)(y / SIDE - area.y0 / SIDE) * across + (size_t)(x / SIDE - area.x0 / SIDE);
    return (tile * SIDE + (size_t)(y % SIDE)) * SIDE + (size_t)(x % SIDE);
}

/* bis_edges_kind returns BIS_EDGE_* of pixel (x, y). */
static inline int bis_edges_kind(const unsigned char *edge, bis_rect area, int x, int y)
{
    const size_t place = bis_edges_place(area, x, y);
    return edge[place / 4] >> 2 * (place % 4) & 3;
}

/* Who looks at what. */
typedef struct bis_edge_eye {
    const bis_film *film;
    const bis_scene *scene;
    const bis_view *view;
    const double *turns; /* of bis_edges_turns */
} bis_edge_eye;

/* bis_edges_find sets the bits of the pixels of rect, a part of the area, which must be 0; those of other pixels stay
 * as they are. It traces one ray a pixel, four with a thin film. False: no memory. */
bool bis_edges_find(unsigned char *edge, bis_rect area, bis_rect rect, const bis_edge_eye *from, int n_threads);

/* bis_edges_rays returns the number of corners of rect's pixels; of those that the next rectangle of the area has as
 * well, none. Over rectangles that tile the area they sum up to those of the area. */
uint64_t bis_edges_rays(const bis_film *film, bis_rect area, bis_rect rect);
