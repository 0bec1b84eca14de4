/* SPDX-License-Identifier: BSD-2-Clause */
/* share: which tiles of the picture belong to a part of it. For the files of src/render. */
#pragma once

#include "bis/render/film.h"
#include "bis/render/render.h"

/* bis_share_tiles makes the list of the tiles (of BIS_RENDER_TILE pixels) of share `part` of the film, in ascending
 * order; the caller frees it by bis_free. Shares differ by one tile at most. *n may be 0. Errors: BIS_NOMEM. */
bis_status bis_share_tiles(int **tiles, int *n, const bis_film *f, bis_part part, bis_diag *diag);
