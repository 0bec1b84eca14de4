/* SPDX-License-Identifier: BSD-2-Clause */
/* light_many: what a map says of many directions at once: pixel, radiance, density. */
#pragma once

#include "bis/thesis/lanes.h"
#include "bis/thesis/light.h"
#include "bis/thesis/envmap.h"

/* bis_envmap_pixels finds the pixels of n directions: x, y, z of y, in the world whose axes the map's frame sees as
 * axis[3]. pixel[]: out, to the end of the last block. A direction within a microradian of a pixel's edge may be given
 * to the neighbour. width * height < 2^31. */
void bis_envmap_pixels(const bis_envmap *em, const vec3 axis[3], uint32_t *pixel, const bis_lanes *y, uint32_t n);

/* bis_light_look does what bis_light_Le_pdf does, for n directions: it fills r, g, b and q of y from its x, y, z, which
 * may be off by a microradian. r, g, b are in units of bis_light_mean, which must be > 0. q is 1 for a light without an
 * importance. pixel[]: out, for n, whole blocks: the pixels of a map. */
void bis_light_look(const bis_light *light, const bis_lanes *y, uint32_t *pixel, uint32_t n);

/* bis_lanes_put stores a direction that was drawn from a light as lane i of x. unit is bis_light_mean. If y is NULL,
 * there is none: Le = 0 and q = 1, so that the weight is 0. A density below FLT_MIN, which is drawn once in 10^37,
 * counts as none. */
void bis_lanes_put(const bis_lanes *x, uint32_t i, const bis_light_point *y, double unit);
