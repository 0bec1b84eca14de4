/* edges: the pixels that an outline crosses, found before anything is rendered. For src/render/render.c. */
#ifndef BIS_EDGES_H
#define BIS_EDGES_H

#include "bis/render/film.h"
#include "bis/scene/scene.h"

/* edge[height][width] of the area, pixels of the film's full picture: 1 where the picture changes abruptly between the pixel's corners. One ray a
 * pixel, four with a thin film. bis_free it. NULL: no memory. */
unsigned char *bis_edges_find(const bis_film *film, bis_rect area, const bis_scene *scene, const bis_scene_desc *desc, int n_threads);

/* How many rays that takes. */
uint64_t bis_edges_rays(const bis_film *film, bis_rect area);

#endif
