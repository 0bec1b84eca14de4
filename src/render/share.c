/* SPDX-License-Identifier: BSD-2-Clause */
/* share: a picture in n shares, each a fair sample of it.
 *
 * The tiles are counted along a curve that fills the rectangle (bis_curve_rectangle), and every n-th belongs to one
 * share. Neighbours on the curve are neighbours in the picture, so a costly region, whatever its form, is dealt out to
 * all shares like a pack of cards; shares of columns or rows would follow what stands upright or lies in the scene. */
#include "share.h"

#include "bis/base/mem.h"
#include "bis/base/curve.h"

bis_status bis_share_tiles(int **tiles, int *n, const bis_film *f, bis_part part, bis_diag *diag)
{
    int across;
    const int n_tiles = bis_film_tiles(f, BIS_RENDER_TILE, &across);
    uint32_t *order = bis_alloc((size_t)n_tiles, sizeof *order);
    bool *mine = bis_alloc((size_t)n_tiles, sizeof *mine);

    *tiles = bis_alloc((size_t)n_tiles / part.n + 1, sizeof **tiles);
    *n = 0;
    if (*tiles && order && mine) {
        bis_curve_rectangle(order, (uint32_t)across, (uint32_t)(n_tiles / across));
        for (uint64_t i = part.k - 1; i < (uint64_t)n_tiles; i += part.n) mine[order[i]] = true;
        for (int t = 0; t < n_tiles; t++)
            if (mine[t]) (*tiles)[(*n)++] = t;
    }
    const bool fails = !*tiles || !order || !mine;
    bis_free(order);
    bis_free(mine);
    if (!fails) return BIS_OK;
    bis_free(*tiles);
    *tiles = NULL;
    return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for a list of %d tiles", n_tiles);
}
