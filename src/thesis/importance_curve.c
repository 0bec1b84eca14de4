/* SPDX-License-Identifier: BSD-2-Clause */
/* importance_curve: draws a pixel by one number, along a curve that visits all lit pixels.
 *
 * Neighbours on the curve (bis/thesis/curve.h) are neighbours in the map. N equal steps of s are therefore N compact
 * pieces of the map with equal importance. One stratified set of numbers then fills the map evenly in both
 * dimensions, for every N; two passes cannot do this. The systematic resampling of chapter 4 walks along the same
 * curve.
 *
 * The curve visits tiles of 4 x 4 pixels, and each tile is read like a page. This is as compact, and the order costs
 * only 4 bytes a tile. A map below 2^16 pixels is visited pixel by pixel, because there a tile is a large piece of
 * the map.
 *
 * The CDF is over pixels, but only its state before each tile is stored. A draw finds the tile by a search with a
 * guide, as in cdf.c, and adds the weights of its pixels again, in the same order: so it finds the same pixel as a CDF
 * of all pixels would, bit for bit, with 1.5 bytes a pixel instead of 10. It takes six times as long; that does not
 * matter, because a render draws some thousand directions in a pass and shares them.
 *
 * Build O(W H), draw O(1). Monotone in s. */
#include "bis/thesis/curve.h"
#include "bis/base/mem.h"
#include "importance_parts.h"

#include <assert.h>
#include <string.h>

enum { TOGETHER = 4096 /* tiles that are weighed by all threads, and then added by one */, MOST_CELLS = 16 };

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

/* Stores the weights of n tiles from tile `first` on in weight[n * cells]. */
static void weigh_tiles(double *weight, const bis_trail *t, size_t first, size_t n)
{
    const size_t cells = t->side * t->side;
    memset(weight, 0, n * cells * sizeof *weight);
#pragma omp parallel for
    for (size_t i = 0; i < n; i++) weigh_tile(weight + i * cells, t, first + i, &t->weights);
}

/* Adds a pixel of this weight, as accumulate of cdf.c does. */
static void add_weight(bis_trail_sum *s, weight_scale scale, double weight)
{
    const double p = weight_scaled(scale, weight), next = s->sum + p, added = next - s->sum;
    s->low += (s->sum - (next - added)) + (p - added);
    s->sum = next;
}

/* The share of the importance that lies before tile i. */
static double share_before(const bis_trail *t, size_t i)
{
    const bis_trail_sum *s = &t->before[i], *all = &t->before[t->n_tiles];
    return (s->sum + s->low) / (all->sum + all->low);
}

static size_t least(size_t a, size_t b) { return a < b ? a : b; }

/* Finds the scale, by the largest weight, and the sums before all tiles. */
static bis_status sum_tiles(bis_trail *t)
{
    const size_t cells = t->side * t->side;
    double *weight = bis_alloc(TOGETHER * cells, sizeof *weight);
    bis_trail_sum sum = {0, 0};

    t->before = bis_alloc(t->n_tiles + 1, sizeof *t->before);
    if (!weight || !t->before) {
        bis_free(weight);
        return BIS_NOMEM;
    }
    for (size_t first = 0; first < t->n_tiles; first += TOGETHER) {
        const size_t n = least(TOGETHER, t->n_tiles - first);
        weigh_tiles(weight, t, first, n);
        const weight_scale scale = weight_scale_of(weight, n * cells);
        if (scale.half1 > 0 && (t->scale.half1 == 0 || scale.exponent > t->scale.exponent)) t->scale = scale;
    }
    for (size_t first = 0; first < t->n_tiles; first += TOGETHER) {
        const size_t n = least(TOGETHER, t->n_tiles - first);
        weigh_tiles(weight, t, first, n);
        for (size_t i = 0; i < n; i++) {
            for (size_t k = 0; k < cells; k++) add_weight(&sum, t->scale, weight[i * cells + k]);
            t->before[first + i + 1] = sum;
        }
    }
    bis_free(weight);
    return BIS_OK;
}

/* The guide of cdf.c, over tiles: guide[g] is the last tile that begins at g / n_guide or before. */
static bis_status make_guide(bis_trail *t)
{
    size_t i = 0;

    for (t->n_guide = 1; 2 * t->n_guide <= t->n_tiles;) t->n_guide *= 2;
    t->guide = bis_alloc(t->n_guide + 1, sizeof *t->guide);
    if (!t->guide) return BIS_NOMEM;
    for (size_t g = 0; g <= t->n_guide; g++) {
        while (i + 1 < t->n_tiles && share_before(t, i + 1) <= (double)g / (double)t->n_guide) i++;
        t->guide[g] = (uint32_t)i;
    }
    return BIS_OK;
}

bis_status bis_trail_init(bis_trail *t, const bis_weights *w, bis_diag *diag)
{
    *t = (bis_trail){.weights = *w};
    bis_status status = find_tiles(t, w->em);
    if (!status) status = sum_tiles(t);
    if (!status) status = make_guide(t);
    if (!status) return BIS_OK;
    bis_trail_clear(t);
    return bis_error(diag, status, (bis_loc){0}, "no memory for the curve through a %d x %d environment map",
                     w->em->width, w->em->height);
}

void bis_trail_clear(bis_trail *t)
{
    bis_free(t->tile);
    bis_free(t->before);
    bis_free(t->guide);
    *t = (bis_trail){0};
}

/* The last tile that begins at s or before. */
static size_t find_tile(const bis_trail *t, double s)
{
    const size_t g = (size_t)(s * (double)t->n_guide); /* exact: n_guide is a power of two */
    size_t i = t->guide[g], last = t->guide[g + 1];

    while (i < last) {
        const size_t middle = i + (last - i + 1) / 2;
        if (share_before(t, middle) <= s) i = middle;
        else last = middle - 1;
    }
    return i;
}

/* The last cell of tile i that begins at s or before. */
static size_t find_cell(const bis_trail *t, size_t i, double s)
{
    const size_t cells = t->side * t->side;
    const bis_trail_sum *all = &t->before[t->n_tiles];
    bis_trail_sum sum = t->before[i];
    double weight[MOST_CELLS] = {0};
    size_t cell = 0;

    weigh_tile(weight, t, i, &t->weights);
    for (; cell + 1 < cells; cell++) {
        add_weight(&sum, t->scale, weight[cell]);
        if ((sum.sum + sum.low) / (all->sum + all->low) > s) break;
    }
    return cell;
}

size_t bis_trail_draw(const bis_trail *t, size_t width, double s)
{
    assert(t->scale.half1 > 0 && s >= 0 && s < 1);
    const size_t i = find_tile(t, s), cell = t->side == 1 ? 0 : find_cell(t, i, s);
    return t->tile[i] + cell / t->side * width + cell % t->side;
}

size_t bis_trail_bytes(const bis_trail *t)
{
    return t->n_tiles * (sizeof *t->tile + sizeof *t->before) + t->n_guide * sizeof *t->guide;
}

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
    const size_t width = (size_t)em->width, side = trail->side, columns = (width + side - 1) / side;
    double sphere = 0; /* solid angle of the current piece */
    uint32_t k = 0;

    assert(2 * (uint64_t)K + 2 <= UINT16_MAX);
    *t = bis_alloc(2 * (size_t)K + 3, sizeof **t);
    *of_tile = bis_alloc(trail->n_tiles, sizeof **of_tile);
    if (!*t || !*of_tile) return BIS_NOMEM;
    for (size_t i = 0; i < trail->n_tiles; i++) {
        const size_t x = trail->tile[i] % width, y = trail->tile[i] / width;
        const double end = share_before(trail, i + 1);
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
