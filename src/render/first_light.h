/* SPDX-License-Identifier: BSD-2-Clause */
/* first_light: something of all the picture, long before its first pass is complete. For pass.c and render.c.
 *
 * Before the first pass, every 8th pixel of every 8th row of the film is rendered: a glimpse, for a 64th of the pass.
 * It leaves nothing to the pass, neither pixels nor what was learned nor counted, so a finished pass has the bits that
 * it has without. A pixel of a tile that is not done gets the colour of its glimpse. So a render that must end within
 * its first pass leaves a picture. */
#pragma once

#include "workspace.h"

/* What w->fine[t] says of tile t. */
enum { BIS_TILE_MISSING, BIS_TILE_GLIMPSED, BIS_TILE_WHOLE };

/* bis_first_light_glimpses returns whether a glimpse has the pixel at column x and row y of the picture. */
bool bis_first_light_glimpses(const bis_film *f, int x, int y);

/* bis_first_light_fill gives each pixel that is missing the colour of its glimpse, and 0 in all layers. The threads are
 * at rest. *missing receives the share of such pixels. It returns false, and does nothing, if the glimpse is not
 * complete. */
bool bis_first_light_fill(bis_workspace *w, double *missing);
