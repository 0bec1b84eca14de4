/* edges: the pixels that an outline crosses, found before anything is rendered. For the files of src/render. */
#pragma once

#include "bis/render/film.h"
#include "bis/scene/scene.h"

/* bis_edges_find returns edge[height][width] of the area (pixels of the film's full picture): 1 where the picture
 * changes abruptly between the pixel's corners. It traces one ray a pixel, four with a thin film. The caller frees the
 * result by bis_free. NULL: no memory. */
unsigned char *bis_edges_find(const bis_film *film, bis_rect area, const bis_scene *scene, const bis_view *view,
                              int n_threads);

/* bis_edges_rays returns the number of rays that bis_edges_find traces. */
uint64_t bis_edges_rays(const bis_film *film, bis_rect area);
