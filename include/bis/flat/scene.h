/* SPDX-License-Identifier: BSD-2-Clause */
/* scene: a scene that is parsed and built once, and rendered often. The rules of bis/flat/flat.h hold. */
#pragma once

#include "bis/flat/flat.h"

typedef struct bis_flat_scene bis_flat_scene;

/* bis_flat_scene_open parses and builds a scene for all integrators. settings are those of bis_flat_render; light (may
 * be NULL) takes the place of all lights of the scene, and must outlive it. Errors: as bis_flat_render. */
int bis_flat_scene_open(bis_flat_scene **scene, const char *path, const char *const *settings, const bis_light *light,
                        char *say, size_t size);

/* bis_flat_scene_close frees the scene; NULL is allowed. */
void bis_flat_scene_close(bis_flat_scene *scene);

/* bis_flat_scene_render makes a picture of an open scene, to the bits of bis_flat_render. settings change those of the
 * scene for this picture alone; text, approximate and accelerator belong to opening. light (may be NULL) takes the
 * place of the light for this picture. Neither meshes nor accelerator are loaded again. Further settings, here and in
 * bis_flat_render:
 *
 *   step           k: a thin picture, of each k x k pixels one
 *   area_exponent  b of the map's importance (thesis 3.4)
 *   turn           degrees by which the map is turned about its own upright axis
 *   as_printed     errata to follow as printed, as E3,E13; none
 *
 * One picture at a time. Errors: as bis_flat_render. */
int bis_flat_scene_render(bis_flat_picture **picture, bis_flat_scene *scene, const char *const *settings,
                          const bis_light *light, bis_flat_watcher *watcher, void *user,
                          const volatile sig_atomic_t *stop, char *say, size_t size);

/* bis_flat_scene_points puts points into the place of pixels: the pictures of the scene have width x height pixels, and
 * the radiance of each times pi is the irradiance at point[height][width][3] on a surface of this
 * normal[height][width][3], which need not be of length 1. The points need not lie on shapes; one that does should be
 * lifted off its surface by the error of its coordinates. Arrays are copied. 0 x 0: pixels of the scene's own view
 * again; then point (may be NULL) and normal (may be NULL) are not read. Errors: BIS_INPUT (a side outside
 * [1, BIS_IMAGE_MAX_SIDE], a value that is not finite, a normal of length 0, a scene without shapes), BIS_NOMEM. */
int bis_flat_scene_points(bis_flat_scene *scene, int width, int height, const float *point, const float *normal,
                          char *say, size_t size);

/* bis_flat_scene_mesh stores the triangles of an open scene in world space: size[2], the numbers of vertices and faces;
 * point[vertices][3] and normal[vertices][3] (may be NULL; 0 0 0: the vertex has none), face[faces][3] (may be NULL),
 * counterclockwise from outside, and shape[faces] (may be NULL), the number of its shape in the scene. point (may be
 * NULL): to learn the size. */
void bis_flat_scene_mesh(const bis_flat_scene *scene, size_t size[2], float *point, float *normal, uint32_t *face,
                         uint32_t *shape);

/* bis_flat_scene_about returns as JSON what such a picture would be of: the film, the integrator with its parameters,
 * as a line of a scene and as options, the seed, the light. *text belongs to the scene, until the next call. Errors:
 * BIS_INPUT (a setting), BIS_NOMEM. */
int bis_flat_scene_about(const char **text, bis_flat_scene *scene, const char *const *settings, char *say, size_t size);

/* bis_flat_scene_coverage stores in share[height][width] how much of each pixel of such a picture shapes cover: the
 * share of side x side camera rays, evenly spread over the pixel, that meet one. bis_flat_scene_about tells the size,
 * the "film". Errors: BIS_INPUT (a setting, side outside [1, 64]). */
int bis_flat_scene_coverage(bis_flat_scene *scene, const char *const *settings, int side, float *share, char *say,
                            size_t size);

/* bis_flat_about returns as JSON what the library has: integrators with claim and parameters, proposals, layers,
 * accelerators, limits. The text is the library's; NULL: no memory. Not for two threads at once the first time. */
const char *bis_flat_about(void);

/* Figures of a picture. */
enum { BIS_FLAT_FIGURES = 10 };

/* bis_flat_picture_figures stores in figure[BIS_FLAT_FIGURES]: seconds of the render, passes, camera rays, shadow rays,
 * candidates, accepted ones, estimates that were not finite, threads, 1 where it was interrupted, and the relative RMSE
 * that its passes tell of (NaN: fewer than two), whether few pixels carry it or many. */
void bis_flat_picture_figures(const bis_flat_picture *picture, double *figure);
