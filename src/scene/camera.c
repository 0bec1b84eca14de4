/* SPDX-License-Identifier: BSD-2-Clause */
/* camera: pbrt's cameras, the pinhole and the parallel projection, in double.
 *
 * The screen is the plane z = 1 of camera space (x right, y up, z forward: left-handed). Its window is [-1,1] along the
 * shorter side of the frame, or what `screenwindow` says; the film's row 0 lies at the window's y1. For a perspective
 * camera the window is scaled by tan(fov/2), so that fov spans the shorter side. Source: pbrt-v3 6.2, whose matrices
 * come to the same. */
#include "bis/scene/camera.h"

#include <stddef.h>

/* x0, x1, y0, y1 on the screen. */
static void window(const bis_camera *c, int width, int height, double w[4])
{
    if (c->has_screen) {
        for (int i = 0; i < 4; i++) w[i] = c->screen[i];
        return;
    }
    const double aspect = c->frame_aspect > 0 ? c->frame_aspect : (double)width / height;
    w[1] = aspect > 1 ? aspect : 1;
    w[3] = aspect > 1 ? 1 : 1 / aspect;
    w[0] = -w[1];
    w[2] = -w[3];
}

ray bis_camera_ray(const bis_camera *c, int width, int height, double x, double y)
{
    if (c->points) return c->points[(size_t)y * (size_t)width + (size_t)x];

    double w[4];
    window(c, width, height, w);
    const double sx = w[0] + (w[1] - w[0]) * (x / width);
    const double sy = w[3] + (w[2] - w[3]) * (y / height);
    const double half = c->orthographic ? 0 : tan(c->fov_deg * (PI / 360));
    const double origin[3] = {c->orthographic ? sx : 0, c->orthographic ? sy : 0, 0};
    const double direction[3] = {sx * half, sy * half, 1};

    double o[3], d[3];
    for (int i = 0; i < 3; i++) {
        const double *row = c->to_world.m[i];
        o[i] = row[0] * origin[0] + row[1] * origin[1] + row[2] * origin[2] + row[3];
        d[i] = row[0] * direction[0] + row[1] * direction[1] + row[2] * direction[2];
    }
    /* hypot only where a square would leave the range of a double: it takes a fiftieth of a camera sample */
    const double square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    const double norm = square > 1e-280 && square < 1e280 ? sqrt(square) : hypot(hypot(d[0], d[1]), d[2]);
    return (ray){vec3_from(o[0], o[1], o[2]), vec3_from(d[0] / norm, d[1] / norm, d[2] / norm), INFINITY};
}

static void box_of_points(const ray *points, size_t n, double box[6])
{
    for (size_t i = 0; i < n; i++) {
        const double o[3] = {(double)points[i].o.x, (double)points[i].o.y, (double)points[i].o.z};
        for (int k = 0; k < 3; k++) {
            box[k] = i == 0 ? o[k] : fmin(box[k], o[k]);
            box[3 + k] = i == 0 ? o[k] : fmax(box[3 + k], o[k]);
        }
    }
}

/* Origins are an affine function of the place on the film: their extremes lie at its corners. */
void bis_camera_eyes(const bis_camera *c, int width, int height, double box[6])
{
    if (c->points) {
        box_of_points(c->points, (size_t)width * (size_t)height, box);
        return;
    }

    double w[4];
    window(c, width, height, w);
    for (int i = 0; i < 3; i++) {
        const double *row = c->to_world.m[i];
        box[i] = (double)INFINITY;
        box[3 + i] = -(double)INFINITY;
        for (int corner = 0; corner < 4; corner++) {
            const double x = c->orthographic ? w[corner & 1] : 0, y = c->orthographic ? w[2 + (corner >> 1)] : 0;
            const double o = row[0] * x + row[1] * y + row[3];
            box[i] = fmin(box[i], o);
            box[3 + i] = fmax(box[3 + i], o);
        }
    }
}
