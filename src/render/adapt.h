/* SPDX-License-Identifier: BSD-2-Clause */
/* adapt: how many camera samples each tile of the picture gets in the next pass. For the files of src/render. */
#pragma once

#include "bis/render/film.h"

enum {
    BIS_ADAPT_SAMPLES = 4, /* camera samples a pixel in a pass, mean over the picture */
    BIS_ADAPT_MOST = 64,   /* in any tile; the least is 1 */
    BIS_ADAPT_PILOT = 2    /* passes before the first choice, all pixels alike */
};

/* tile: side in pixels; tiles are those of bis_film_tiles. */
typedef struct bis_adapt {
    int tile, tiles_x, n_tiles;
    uint32_t *samples; /* samples[n_tiles]: of a pixel, in the pass to come or under way */
    double *inverse;   /* inverse[n_tiles]: sum over complete passes of 1/samples */
    double *noise;     /* noise[n_tiles]: standard deviation of one camera sample, relative as in the film's estimate */
} bis_adapt;

/* Errors: BIS_NOMEM. */
bis_status bis_adapt_init(bis_adapt *a, const bis_film *f, int tile, bis_diag *diag);
void bis_adapt_clear(bis_adapt *a);

/* A pass is complete and in the film: choose for the next one. */
void bis_adapt_next(bis_adapt *a, const bis_film *f);

size_t bis_adapt_bytes(const bis_adapt *a);
