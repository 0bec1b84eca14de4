/* SPDX-License-Identifier: BSD-2-Clause */
/* film_twins: the pixels that are rendered a second time, with random numbers of their own. The picture does not get
 * what comes of it. It tells by how much two renders of such a pixel differ, and thus the error (film_error.c), without
 * a model of how the error falls.
 *
 * One pixel of each K x K pixels has a twin, at a place that a hash chooses: a regular grid would see a pattern of the
 * scene as it is at one phase. The squares are those of the full picture, so a crop, a part or a tile has the twins
 * that the picture has there. 768 twins told the error to 4 % where noise is spread evenly, and to 14 % where only
 * outlines and edges of shadows are wrong (standard deviations; checks-fine and sun in docs/trust.md). ENOUGH is
 * twice as many. They take 4 % of the camera samples of 240 x 180 pixels, and 0.05 % of those of 1408 x 1984. A small
 * picture has fewer, one for 9 pixels. */
#include "bis/render/film.h"

#include "bis/base/hash.h"
#include "bis/base/mem.h"

#include <math.h>

enum { LEAST_SIDE = 3, ENOUGH = 1500 };

/* The squares that the pixels [x0, x1) x [y0, y1) touch. */
typedef struct squares {
    int x0, y0, across, down;
} squares;

static squares touched(int side, bis_rect r)
{
    const int x0 = r.x0 / side, y0 = r.y0 / side;
    return (squares){x0, y0, (r.x1 - 1) / side - x0 + 1, (r.y1 - 1) / side - y0 + 1};
}

int bis_film_twin_side(const bis_film *f)
{
    const int side = (int)sqrt((double)f->full_width * (double)f->full_height / ENOUGH);
    return side > LEAST_SIDE ? side : LEAST_SIDE;
}

size_t bis_film_twins(const bis_film *f)
{
    const squares all = touched(bis_film_twin_side(f), bis_film_crop(f));
    return (size_t)all.across * (size_t)all.down;
}

bool bis_film_next_twin(const bis_film *f, bis_rect r, bis_twin *t)
{
    const int side = bis_film_twin_side(f);
    const squares all = touched(side, bis_film_crop(f)), these = touched(side, r);

    while (t->next < these.across * these.down) {
        const int i = t->next++, x = these.x0 + i % these.across, y = these.y0 + i / these.across;
        const uint64_t place = bis_hash(bis_hash((uint64_t)y) + (uint64_t)x);
        t->x = x * side + (int)((place >> 32) * (uint64_t)side >> 32);
        t->y = y * side + (int)((place & UINT32_MAX) * (uint64_t)side >> 32);
        t->at = (size_t)(y - all.y0) * (size_t)all.across + (size_t)(x - all.x0);
        if (bis_is_in(r, t->x, t->y)) return true;
    }
    return false;
}

bis_status bis_film_want_twins(bis_film *f, bis_diag *diag)
{
    f->twin = bis_alloc(bis_film_twins(f), BIS_TWIN_VALUES * sizeof *f->twin);
    return f->twin ? BIS_OK : bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for the pixels that tell the error");
}
