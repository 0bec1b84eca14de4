/* importance_curve: draws a pixel by one number, along a curve that visits all lit pixels.
 *
 * Neighbours on the curve (bis/thesis/curve.h) are neighbours in the map. N equal steps of s are therefore N compact
 * pieces of the map with equal importance. One stratified set of numbers then fills the map evenly in both
 * dimensions, for every N; two passes cannot do this. The systematic resampling of chapter 4 walks along the same
 * curve.
 *
 * The curve visits tiles of 4 x 4 pixels, and each tile is read like a page. This is as compact, and the order costs
 * only 4 bytes a tile. A map below 2^16 pixels is visited pixel by pixel, because there a tile is a large piece of
 * the map. The CDF is over pixels. A draw then costs one search with the guide and touches three or four cache lines.
 * A CDF over tiles with a scan of the 16 weights would need 1 byte a pixel, but it took six times as long.
 *
 * Build O(W H), draw O(1). Monotone in s. */
#include "bis/thesis/curve.h"
#include "bis/base/mem.h"
#include "importance_parts.h"

#include <assert.h>

static const size_t tiled_from = 1 << 16; /* pixels */

/* Finds the tiles in the order of the curve. */
static bis_status find_tiles(bis_trail *t, const bis_envmap *em)
{
    const uint32_t width = (uint32_t)em->width, height = (uint32_t)em->height;
    t->side = (size_t)width * height < tiled_from ? 1 : 4;
    const uint32_t across = (width + t->side - 1) / t->side, down = (height + t->side - 1) / t->side;
    t->n_tiles = (size_t)across * down;
    t->tile = bis_alloc(t->n_tiles, sizeof *t->tile);
    if (!t->tile) return BIS_NOMEM;
    bis_curve_rectangle(t->tile, across, down);
#pragma omp parallel for
    for (size_t i = 0; i < t->n_tiles; i++) {
        const uint32_t x = t->tile[i] % across, y = t->tile[i] / across;
        t->tile[i] = t->side * (y * width + x);
    }
    return BIS_OK;
}

/* Stores weight times solid angle of the pixels of tile i, cell by cell. Cells beyond the map's right or lower edge
 * stay 0. */
static void weigh_tile(double *weight, const bis_trail *t, size_t i, const bis_weights *w)
{
    const size_t width = (size_t)w->em->width, height = (size_t)w->em->height;
    const size_t x0 = t->tile[i] % width, y0 = t->tile[i] / width;
    for (size_t y = 0; y < t->side && y0 + y < height; y++) {
        for (size_t x = 0; x < t->side && x0 + x < width; x++) {
            weight[y * t->side + x] = bis_weight(w, (y0 + y) * width + x0 + x) * bis_row_measure(w, y0 + y);
        }
    }
}

static bis_status sum_pixels(bis_trail *t, const bis_weights *w)
{
    const size_t cells = t->side * t->side;
    double *weight = bis_alloc(t->n_tiles * cells, sizeof *weight);
    if (!weight) return BIS_NOMEM;
#pragma omp parallel for
    for (size_t i = 0; i < t->n_tiles; i++) weigh_tile(weight + i * cells, t, i, w);
    const bis_status status = bis_cdf_init(&t->pixels, weight, t->n_tiles * cells, NULL);
    bis_free(weight);
    return status;
}

bis_status bis_trail_init(bis_trail *t, const bis_weights *w, bis_diag *diag)
{
    *t = (bis_trail){0};
    bis_status status = find_tiles(t, w->em);
    if (!status) status = sum_pixels(t, w);
    if (!status) return BIS_OK;
    bis_trail_clear(t);
    return bis_error(diag, status, (bis_loc){0}, "no memory for the curve through a %d x %d environment map",
                     w->em->width, w->em->height);
}

void bis_trail_clear(bis_trail *t)
{
    bis_free(t->tile);
    bis_cdf_clear(&t->pixels);
    *t = (bis_trail){0};
}

size_t bis_trail_draw(const bis_trail *t, size_t width, double s)
{
    const size_t cell = bis_cdf_sample(&t->pixels, s, NULL);
    if (t->side == 1) return t->tile[cell];
    return t->tile[cell / 16] + cell / 4 % 4 * width + cell % 4;
}

size_t bis_trail_bytes(const bis_trail *t) { return t->n_tiles * sizeof *t->tile + bis_cdf_bytes(&t->pixels); }

/* Returns the solid angle of tile i. */
static double tile_solid_angle(const bis_trail *t, size_t i, const bis_envmap *em)
{
    const size_t x0 = t->tile[i] % (size_t)em->width, y0 = t->tile[i] / (size_t)em->width;
    const size_t columns = (size_t)em->width - x0 < t->side ? (size_t)em->width - x0 : t->side;
    double sum = 0;

    for (size_t y = y0; y < (size_t)em->height && y < y0 + t->side; y++)
        sum += (double)columns * em->row_solid_angle[y];
    return sum;
}

bis_status bis_trail_cut(const bis_trail *trail, const bis_envmap *em, uint32_t K, uint32_t *n, double **t,
                         uint16_t **of_tile)
{
    const size_t width = (size_t)em->width, side = trail->side, cells = side * side,
                 columns = (width + side - 1) / side;
    const double *c = trail->pixels.c;
    double sphere = 0; /* solid angle of the current piece */
    uint32_t k = 0;

    assert(2 * (uint64_t)K + 2 <= UINT16_MAX);
    *t = bis_alloc(2 * (size_t)K + 3, sizeof **t);
    *of_tile = bis_alloc(trail->n_tiles, sizeof **of_tile);
    if (!*t || !*of_tile) return BIS_NOMEM;
    for (size_t i = 0; i < trail->n_tiles; i++) {
        const size_t x = trail->tile[i] % width, y = trail->tile[i] / width;
        const double end = c[(i + 1) * cells];
        (*of_tile)[y / side * columns + x / side] = (uint16_t)k;
        sphere += tile_solid_angle(trail, i, em);
        /* Neither this piece nor the rest may be without importance. */
        if (end > (*t)[k] && end < 1 && ((end - (*t)[k]) * K >= 1 || sphere * K >= 4 * PI)) {
            (*t)[++k] = end;
            sphere = 0;
        }
    }
    *n = k + 1;
    (*t)[*n] = 1;
    return BIS_OK;
}
