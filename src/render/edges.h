/* edges: the pixels in which the picture changes abruptly, found before anything is rendered. For the files of
 * src/render. */
#pragma once

#include "bis/render/film.h"
#include "bis/scene/scene.h"

/* What changes between the corners of a pixel: nothing much; what the material's lobe sees; what there is to see. */
enum { BIS_EDGE_NONE, BIS_EDGE_TURN, BIS_EDGE_OUTLINE, BIS_EDGE_KINDS };

/* bis_edges_samples returns how many camera samples a pixel of this kind has for each one of other pixels. */
static inline uint32_t bis_edges_samples(int kind, uint32_t edge_samples)
{
    return kind == BIS_EDGE_NONE ? 1 : kind == BIS_EDGE_TURN ? (edge_samples + 1) / 2 : edge_samples;
}

/* bis_edges_turns returns turns[n_materials], to be freed: for each material the cosine of the angle between two normals
 * of a pixel from which on it is a BIS_EDGE_TURN. With textures, it is that of the values that they replace. NULL: no
 * memory. */
double *bis_edges_turns(const bis_scene_desc *desc);

/* bis_edges_find sets edge[height][width] of the area (pixels of the film's full picture) for the pixels of rect, a
 * part of it, to one of BIS_EDGE_*; turns are those of bis_edges_turns. It traces one ray a pixel, four
 * with a thin film. False: no memory. */
bool bis_edges_find(unsigned char *edge, bis_rect area, bis_rect rect, const bis_film *film, const bis_scene *scene,
                    const bis_view *view, const double *turns, int n_threads);

/* bis_edges_rays returns the number of corners of rect's pixels; of those that the next rectangle of the area has as
 * well, none. Over rectangles that tile the area they sum up to those of the area. */
uint64_t bis_edges_rays(const bis_film *film, bis_rect area, bis_rect rect);
