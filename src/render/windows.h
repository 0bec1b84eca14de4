/* SPDX-License-Identifier: BSD-2-Clause */
/* windows: openings of a room, found from its shapes and a few rays. For workspace.c. */
#pragma once

#include "bis/render/film.h"
#include "bis/scene/scene.h"

/* bis_windows_find stores in windows[4] the rectangles through which light reaches what the film's whole
 * picture shows, and their number in *n: 0 where more than a quarter of all rays escapes, where fewer than three
 * quarters of those that escape pass a rectangle, or where there are more than four. It depends on the scene and the
 * camera alone. Errors: BIS_NOMEM. */
bis_status bis_windows_find(bis_portal *windows, uint32_t *n, const bis_scene *scene, const bis_camera *camera,
                            const bis_film *film, bis_diag *diag);
