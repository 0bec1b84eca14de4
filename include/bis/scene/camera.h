/* camera: from a place on the film to a ray, with pbrt's conventions (left-handed, x right, y up, z forward; fov along
 * the shorter side). */
#ifndef BIS_CAMERA_H
#define BIS_CAMERA_H

#include "bis/base/vec.h"
#include "bis/base/xform.h"

#include <stdbool.h>

typedef struct bis_camera {
    bool orthographic;
    double fov_deg;           /* perspective, (0, 180) */
    bool has_screen;          /* screenwindow given */
    double screen[4];         /* x0, x1, y0, y1; else from the aspect ratio, [-1,1] along the shorter side */
    double frame_aspect;      /* 0: width / height of the film */
    bis_xform to_world;       /* camera space to world */
} bis_camera;

/* x in [0, width], y in [0, height] of the full image, y down. The ray's d is unit, tmax infinite. */
ray bis_camera_ray(const bis_camera *c, int width, int height, double x, double y);

/* Where rays of the camera start: the corners {x0, y0, z0, x1, y1, z1} of their box in world space, in double: a
 * transformation may put it beyond the largest float. */
void bis_camera_eyes(const bis_camera *c, int width, int height, double box[6]);

#endif
