/* SPDX-License-Identifier: BSD-2-Clause */
/* first_light: something of all the picture, long before its first pass is complete. For pass.c and render.c.
 *
 * Before the first pass, every 8th pixel of every 8th row of the film is rendered: a glimpse, for a 64th of the pass.
 * It leaves nothing to the pass, neither pixels nor what was learned nor counted, so a finished pass has the bits that
 * it has without. While the pass goes on, a pixel of a tile that is not done shows the colour of its glimpse. So a
 * viewer has a picture, and a render that must end within its first pass leaves one. */
#pragma once

#include "workspace.h"

/* What w->fine[t] says of tile t. */
enum { BIS_TILE_MISSING, BIS_TILE_GLIMPSED, BIS_TILE_WHOLE };

/* bis_first_light_glimpses returns whether a glimpse has the pixel at column x and row y of the picture. */
bool bis_first_light_glimpses(const bis_film *f, int x, int y);

/* bis_first_light_put stores what a pass has made of a pixel. A viewer may read it at the same time, so each value is
 * stored whole, and read whole by bis_first_light_show. */
static inline void bis_first_light_put(bis_pixel_mean *to, bis_pixel_mean mean)
{
    __atomic_store(&to->L.r, &mean.L.r, __ATOMIC_RELAXED);
    __atomic_store(&to->L.g, &mean.L.g, __ATOMIC_RELAXED);
    __atomic_store(&to->L.b, &mean.L.b, __ATOMIC_RELAXED);
    __atomic_store(&to->hit, &mean.hit, __ATOMIC_RELAXED);
}

/* bis_first_light_show writes the first pass as far as it is: rgba[height][width][4]. Other threads may be rendering.
 * It returns false, and writes nothing, before the glimpse is complete. */
bool bis_first_light_show(const bis_workspace *w, float *rgba);

/* bis_first_light_fill gives each pixel that is missing the colour of its glimpse, and 0 in all layers. The threads are
 * at rest. *missing receives the share of such pixels. It returns false, and does nothing, if the glimpse is not
 * complete. */
bool bis_first_light_fill(bis_workspace *w, double *missing);
