/* SPDX-License-Identifier: BSD-2-Clause */
/* first_light: something of all the picture, long before its first pass is complete. */
#include "first_light.h"

#include <string.h>

enum { STRIDE = 8 };

/* The place is counted from the film's corner, so that a crop's first pixel has one. */
bool bis_first_light_glimpses(const bis_film *f, int x, int y)
{
    return (x - f->x0) % STRIDE == 0 && (y - f->y0) % STRIDE == 0;
}

/* The index of the pixel of the pass that pixel (x, y) of the film shows: itself, if its tile is whole. */
static size_t shown(const bis_workspace *w, int x, int y)
{
    const bis_film *f = w->film;

    if (w->fine[bis_film_tile_at(f, BIS_RENDER_TILE, f->x0 + x, f->y0 + y)] != BIS_TILE_WHOLE)
        x -= x % STRIDE, y -= y % STRIDE;
    return (size_t)y * (size_t)f->width + (size_t)x;
}

static bool has_glimpse(const bis_workspace *w)
{
    for (int t = 0; t < w->n_tiles; t++)
        if (w->fine[t] == BIS_TILE_MISSING) return false;
    return true;
}

/* In reading order a pixel comes after the one that it shows, which is never filled itself. */
bool bis_first_light_fill(bis_workspace *w, double *missing)
{
    const bis_film *f = w->film;
    const size_t values = (size_t)f->layers.n_values * sizeof *w->pass_layers;
    size_t n = 0;

    if (!has_glimpse(w)) return false;
    for (int y = 0; y < f->height; y++) {
        for (int x = 0; x < f->width; x++) {
            const size_t i = (size_t)y * (size_t)f->width + (size_t)x, from = shown(w, x, y);
            if (from == i) continue;
            w->pass[i] = w->pass[from];
            if (values) memset(bis_workspace_layers(w, i), 0, values);
            n++;
        }
    }
    *missing = (double)n / ((double)f->width * (double)f->height);
    return true;
}
