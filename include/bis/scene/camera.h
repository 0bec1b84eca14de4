/* SPDX-License-Identifier: BSD-2-Clause */
/* camera: from a place on the film to a ray. The conventions are pbrt's: left-handed, x right, y up, z forward, fov
 * along the shorter side. */
#pragma once

#include "bis/base/vec.h"
#include "bis/base/xform.h"

#include <stdbool.h>

typedef struct bis_camera {
    bool orthographic;
    double fov_deg;           /* perspective, (0, 180) */
    bool has_screen;          /* the scene gives screenwindow */
    /* x0, x1, y0, y1; if not given, it follows from the aspect ratio, with [-1,1] along the shorter side */
    double screen[4];
    double frame_aspect;      /* 0: width / height of the film */
    bis_xform to_world;       /* camera space to world */
    /* points[height][width] in the place of all this: pixel by pixel a point o and -n of its surface as d
     * (bis_scene_point_given); borrowed. NULL: a camera */
    const ray *points;
} bis_camera;

/* bis_camera_ray returns the ray through the place (x, y) of the full image, x in [0, width], y in [0, height], y
 * down. The ray's d is unit and its tmax infinite. */
ray bis_camera_ray(const bis_camera *c, int width, int height, double x, double y);

/* bis_camera_eyes stores in box the corners {x0, y0, z0, x1, y1, z1} of a box in world space that contains all places
 * where the camera's rays start. The box is in double, because a transformation may put it beyond the largest float. */
void bis_camera_eyes(const bis_camera *c, int width, int height, double box[6]);
