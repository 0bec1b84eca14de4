/* edges: the pixels that an outline crosses, found before anything is rendered. For the files of src/render. */
#pragma once

#include "bis/render/render.h"
#include "bis/scene/scene.h"

/* One bit a pixel of an area (pixels of the film's full picture), tile by tile: a tile has bytes of its own, so threads
 * may look at different tiles. */

/* bis_edges_bytes returns the bytes of an area. */
size_t bis_edges_bytes(bis_rect area);

/* bis_edges_bit returns the number of pixel (x, y) among the bits. */
static inline size_t bis_edges_bit(bis_rect area, int x, int y)
{
    enum { SIDE = BIS_RENDER_TILE };
    const size_t across = (size_t)((area.x1 - 1) / SIDE - area.x0 / SIDE + 1);
    const size_t tile = (size_t)(y / SIDE - area.y0 / SIDE) * across + (size_t)(x / SIDE - area.x0 / SIDE);
    return (tile * SIDE + (size_t)(y % SIDE)) * SIDE + (size_t)(x % SIDE);
}

/* bis_edges_has returns whether pixel (x, y) is an edge. */
static inline bool bis_edges_has(const unsigned char *edge, bis_rect area, int x, int y)
{
    const size_t bit = bis_edges_bit(area, x, y);
    return edge[bit / 8] >> bit % 8 & 1;
}

/* bis_edges_find sets the bits of the pixels of rect, a part of the area, where the picture changes abruptly between
 * the pixel's corners; the others stay as they are. It traces one ray a pixel, four with a thin film. False: no
 * memory. */
bool bis_edges_find(unsigned char *edge, bis_rect area, bis_rect rect, const bis_film *film, const bis_scene *scene,
                    const bis_view *view, int n_threads);

/* bis_edges_rays returns the number of corners of rect's pixels; of those that the next rectangle of the area has as
 * well, none. Over rectangles that tile the area they sum up to those of the area. */
uint64_t bis_edges_rays(const bis_film *film, bis_rect area, bis_rect rect);
