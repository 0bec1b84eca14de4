/* SPDX-License-Identifier: BSD-2-Clause */
/* first_light: something of all the picture, long before its first pass is complete.
 *
 * The thread that renders a tile writes w->fine[t] after the tile's pixels, and a reader reads it before them: so a
 * pixel that counts as there is whole. One that a thread is just overwriting belongs to a tile with a glimpse: each of
 * its values is that of the glimpse or of the pixel itself. Both are estimates of the same, so a mixture is one, too,
 * and it lasts until the next look. */
#include "first_light.h"

#include <math.h>
#include <string.h>

enum { STRIDE = 8 };

/* The place is counted from the film's corner, so that a crop's first pixel has one. */
bool bis_first_light_glimpses(const bis_film *f, int x, int y)
{
    return (x - f->x0) % STRIDE == 0 && (y - f->y0) % STRIDE == 0;
}

static int reached(const bis_workspace *w, int t) { return __atomic_load_n(&w->fine[t], __ATOMIC_ACQUIRE); }

/* The index of the pixel of the pass that pixel (x, y) of the film shows: itself, if its tile is whole. */
static size_t shown(const bis_workspace *w, int x, int y)
{
    const bis_film *f = w->film;

    if (reached(w, bis_film_tile_at(f, BIS_RENDER_TILE, f->x0 + x, f->y0 + y)) != BIS_TILE_WHOLE)
        x -= x % STRIDE, y -= y % STRIDE;
    return (size_t)y * (size_t)f->width + (size_t)x;
}

static bool has_glimpse(const bis_workspace *w)
{
    for (int t = 0; t < w->n_tiles; t++)
        if (reached(w, t) == BIS_TILE_MISSING) return false;
    return true;
}

/* One value of a pixel that another thread may be storing. */
static float look(const float *value)
{
    float v;
    __atomic_load(value, &v, __ATOMIC_RELAXED);
    return v;
}

bool bis_first_light_show(const bis_workspace *w, float *rgba)
{
    const bis_film *f = w->film;

    if (!has_glimpse(w)) return false;
    for (int y = 0; y < f->height; y++) {
        for (int x = 0; x < f->width; x++, rgba += 4) {
            const bis_pixel_mean *from = &w->pass[shown(w, x, y)];
            rgba[0] = fmaxf(0, look(&from->L.r)); /* as bis_film_resolve */
            rgba[1] = fmaxf(0, look(&from->L.g));
            rgba[2] = fmaxf(0, look(&from->L.b));
            rgba[3] = look(&from->hit);
        }
    }
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
