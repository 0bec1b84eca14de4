/* SPDX-License-Identifier: BSD-2-Clause */
/* light_many: bis_envmap_pixel for many directions at once: 6 ns each with AVX2 instead of 55.
 *
 * In float: theta and phi are off by less than 1e-6, so a direction that close to a pixel's edge may be given to the
 * neighbour (a thousandth of a pixel in a map 8192 wide). Who asks takes radiance and density from the same pixel, so
 * that all that is wrong is the direction, by less than a microradian. */
#include "bis/thesis/importance.h"
#include "light_many.h"

#include <assert.h>
#include <float.h>

/* [pixels-of-lanes] */
BIS_LANES
static void find(const vec3 axis[3], float columns, float rows, uint32_t *pixel, const bis_lanes *y, uint32_t n)
{
    const bis_lanes l = *y;
    const vec3 ax = axis[0], ay = axis[1], az = axis[2];
    const float per_column = columns / 6.28318531f, per_row = rows / 3.14159265f;
    const int32_t last_column = (int32_t)columns - 1, last_row = (int32_t)rows - 1, width = (int32_t)columns;

#pragma omp simd
    for (uint32_t i = 0; i < n; i++) {
        const float u = l.x[i] * ax.x + l.y[i] * ax.y + l.z[i] * ax.z;
        const float v = l.x[i] * ay.x + l.y[i] * ay.y + l.z[i] * ay.z;
        const float w = l.x[i] * az.x + l.y[i] * az.y + l.z[i] * az.z;
        const float phi = bis_lanes_atan2(v, u), theta = bis_lanes_atan2(sqrtf(u * u + v * v), w);
        /* (int32_t) cuts towards 0: from 0 up to width/2 in the east, from the last column down in the west. So x is in
         * [0, width) for phi in [-pi, pi] and every width, also by the rounded per_column */
        const int32_t east = (int32_t)(phi * per_column), west = last_column + (int32_t)(phi * per_column);
        const int32_t x = phi < 0 ? west : east, row = (int32_t)(theta * per_row);

        /* theta = pi, the south pole, belongs to the last row */
        pixel[i] = (uint32_t)((row > last_row ? last_row : row) * width + x);
    }
}

void bis_envmap_pixels(const bis_envmap *em, const vec3 axis[3], uint32_t *pixel, const bis_lanes *y, uint32_t n)
{
    find(axis, (float)em->width, (float)em->height, pixel, y, bis_lanes_round_up(n));
}
/* [end] */

static void look_at_map(const bis_light *light, const bis_lanes *y, uint32_t *pixel, uint32_t n)
{
    const bis_envmap *em = bis_light_envmap(light);
    const bis_importance *importance = bis_light_importance(light);
    const double unit = bis_light_mean(light);
    vec3 axis[3];

    bis_light_axes(light, axis);
    bis_envmap_pixels(em, axis, pixel, y, n);
    for (uint32_t i = 0; i < n; i++) {
        const rgb Le = em->pixels[pixel[i]];
        y->r[i] = (float)((double)Le.r / unit);
        y->g[i] = (float)((double)Le.g / unit);
        y->b[i] = (float)((double)Le.b / unit);
    }
    for (uint32_t i = 0; importance && i < n; i++) y->q[i] = (float)bis_importance_pdf_pixel(importance, pixel[i]);
}

static void look_at_constant(const bis_light *light, const bis_lanes *y, uint32_t n)
{
    const rgb Le = rgb_scale(bis_light_Le(light, (vec3){0, 0, 1}), 1 / bis_light_mean(light));

    for (uint32_t i = 0; i < n; i++) {
        y->r[i] = Le.r;
        y->g[i] = Le.g;
        y->b[i] = Le.b;
    }
}

void bis_light_look(const bis_light *light, const bis_lanes *y, uint32_t *pixel, uint32_t n)
{
    assert(bis_light_mean(light) > 0);
    for (uint32_t i = 0; i < n; i++) y->q[i] = 1; /* without an importance: then q_L has no part in q */
    /* constant or map is asked once and not for each direction, so that both loops have no branch */
    if (bis_light_is_constant(light)) look_at_constant(light, y, n);
    else look_at_map(light, y, pixel, n);
    /* what fills the last block weighs nothing, and its q divides nothing by 0 */
    for (uint32_t i = n; i < bis_lanes_round_up(n); i++) {
        y->r[i] = y->g[i] = y->b[i] = 0;
        y->q[i] = 1;
    }
}

void bis_lanes_put(const bis_lanes *x, uint32_t i, const bis_light_point *y, double unit)
{
    const bis_light_point p = y && y->pdf >= (double)FLT_MIN ? *y : (bis_light_point){.pdf = 1};

    x->x[i] = p.wi.x;
    x->y[i] = p.wi.y;
    x->z[i] = p.wi.z;
    x->r[i] = (float)((double)p.Le.r / unit);
    x->g[i] = (float)((double)p.Le.g / unit);
    x->b[i] = (float)((double)p.Le.b / unit);
    x->q[i] = (float)p.pdf;
}
