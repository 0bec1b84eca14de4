/* edges: the pixels that an outline crosses, found before anything is rendered. For the files of src/render. */
#pragma once

#include "bis/render/film.h"
#include "bis/scene/scene.h"

/* bis_edges_find sets edge[height][width] of the area (pixels of the film's full picture) for the pixels of rect, a
 * part of it: 1 where the picture changes abruptly between the pixel's corners, else 0. It traces one ray a pixel, four
 * with a thin film. False: no memory. */
bool bis_edges_find(unsigned char *edge, bis_rect area, bis_rect rect, const bis_film *film, const bis_scene *scene,
                    const bis_view *view, int n_threads);

/* bis_edges_rays returns the number of corners of rect's pixels; of those that the next rectangle of the area has as
 * well, none. Over rectangles that tile the area they sum up to those of the area. */
uint64_t bis_edges_rays(const bis_film *film, bis_rect area, bis_rect rect);
