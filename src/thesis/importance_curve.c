/* SPDX-License-Identifier: BSD-2-Clause */
/* importance_curve: draws a pixel by one number, along a curve that visits all lit pixels.
 *
 * Neighbours on the curve (bis/base/curve.h) are neighbours in the map. N equal steps of s are therefore N compact
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
 * The sums need no scale (weights.h): a pixel's weight is a float's intensity, at least 2^-149 and below 2^130, times
 * an area factor, which is a float, too, and a solid angle. No sum of such numbers leaves the range of double.
 *
 * Build O(W H), draw O(1). Monotone in s. */
#include "bis/base/curve.h"
#include "bis/base/mem.h"
#include "importance_parts.h"

#include <assert.h>

static const size_t tiled_from = 1 << 16; /* pixels */

/* Finds the tiles in the order of the curve. */
static bis_status find_tiles(bis_curve *t)
{
    const uint32_t width = (uint32_t)t->weights.em->width, height = (uint32_t)t->weights.em->height;
    t->side = (size_t)width * height < tiled_from ? 1 : 4;
    t->across = (width + t->side - 1) / t->side;
    const uint32_t down = (height + t->side - 1) / t->side;
    t->n_tiles = (size_t)t->across * down;
    t->tile = bis_alloc(t->n_tiles, sizeof *t->tile);
    if (!t->tile) return BIS_NOMEM;
    bis_curve_rectangle(t->tile, t->across, down);
    return BIS_OK;
}

/* The pixels of a tile. At the map's right or lower edge it may have fewer. */
typedef struct block {
    uint32_t x, y, columns, rows;
} block;

static uint32_t least(uint32_t a, uint32_t b) { return a < b ? a : b; }

static block block_of(const bis_curve *t, uint32_t tile)
{
    const uint32_t width = (uint32_t)t->weights.em->width, height = (uint32_t)t->weights.em->height;
    const uint32_t x = t->side * (tile % t->across), y = t->side * (tile / t->across);
    return (block){x, y, least(t->side, width - x), least(t->side, height - y)};
}

/* Adds a pixel's weight, as accumulate of cdf.c does. */
static void add_weight(bis_curve_sum *s, double weight)
{
    const double next = s->sum + weight, added = next - s->sum;
    s->low += (s->sum - (next - added)) + (weight - added);
    s->sum = next;
}

static bis_curve_sum plus(bis_curve_sum a, bis_curve_sum b)
{
    add_weight(&a, b.sum);
    a.low += b.low;
    return a;
}

/* The weight of the pixel in column x of row y. */
static double weight_at(const bis_curve *t, uint32_t x, uint32_t y)
{
    return bis_weight(&t->weights, (size_t)y * (size_t)t->weights.em->width + x);
}

/* Adds up the pixels of a tile, and adds each to the weight of its row. */
static bis_curve_sum sum_tile(const bis_curve *t, uint32_t tile, double *row_weight)
{
    const block b = block_of(t, tile);
    bis_curve_sum sum = {0, 0};
    for (uint32_t y = b.y; y < b.y + b.rows; y++) {
        const double measure = bis_row_measure(&t->weights, y);
        double row = row_weight[y];
        for (uint32_t x = b.x; x < b.x + b.columns; x++) {
            const double weight = weight_at(t, x, y);
            row += weight;
            add_weight(&sum, weight * measure);
        }
        row_weight[y] = row;
    }
    return sum;
}

/* The share of the importance that this sum is; 0 where the map is black, from which nothing is drawn. */
static double share_of(const bis_curve *t, bis_curve_sum s)
{
    const bis_curve_sum *end = &t->before[t->n_tiles];
    const double all = end->sum + end->low;
    return all > 0 ? (s.sum + s.low) / all : 0;
}

/* The share of the importance that lies before tile i. */
static double share_before(const bis_curve *t, size_t i) { return share_of(t, t->before[i]); }

/* Finds the sums before all tiles, and of all rows. The tiles themselves are summed row by row, on all threads, because
 * along the curve each would wait for memory. */
static bis_status sum_tiles(bis_curve *t, double *row_weight)
{
    const uint32_t height = (uint32_t)t->weights.em->height;
    bis_curve_sum *sum = bis_alloc(t->n_tiles, sizeof *sum);

    t->before = bis_alloc(t->n_tiles + 1, sizeof *t->before);
    if (!sum || !t->before) {
        bis_free(sum);
        return BIS_NOMEM;
    }
#pragma omp parallel for
    for (uint32_t y = 0; y < height; y += t->side) {
        const uint32_t first = y / t->side * t->across;
        for (uint32_t i = y; i < y + t->side && i < height; i++) row_weight[i] = 0;
        for (uint32_t i = first; i < first + t->across; i++) sum[i] = sum_tile(t, i, row_weight);
    }
    for (size_t i = 0; i < t->n_tiles; i++) t->before[i + 1] = plus(t->before[i], sum[t->tile[i]]);
    bis_free(sum);
    return BIS_OK;
}

/* The guide of cdf.c, over tiles: guide[g] is the last tile that begins at g / n_guide or before. */
static bis_status make_guide(bis_curve *t)
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

bis_status bis_curve_init(bis_curve *t, const bis_weights *w, double *row_weight, bis_diag *diag)
{
    *t = (bis_curve){.weights = *w};
    bis_status status = find_tiles(t);
    if (!status) status = sum_tiles(t, row_weight);
    if (!status) status = make_guide(t);
    if (!status) return BIS_OK;
    return bis_error(diag, status, (bis_loc){0}, "no memory for the curve through a %d x %d environment map",
                     w->em->width, w->em->height);
}

void bis_curve_clear(bis_curve *t)
{
    bis_free(t->tile);
    bis_free(t->before);
    bis_free(t->guide);
    *t = (bis_curve){0};
}

/* The last tile that begins at s or before. */
static size_t find_tile(const bis_curve *t, double s)
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

/* The pixel of tile i that lies at s. All of the tile's pixels add up to the sum before the next tile, bit for bit, and
 * that lies beyond s: so a pixel is found, and it is not black. */
static size_t find_pixel(const bis_curve *t, size_t i, double s)
{
    const size_t width = (size_t)t->weights.em->width;
    const block b = block_of(t, t->tile[i]);
    bis_curve_sum sum = {0, 0};
    uint32_t x = 0, y = 0;

    for (;;) {
        add_weight(&sum, weight_at(t, b.x + x, b.y + y) * bis_row_measure(&t->weights, b.y + y));
        if (share_of(t, plus(t->before[i], sum)) > s) return (b.y + y) * width + b.x + x;
        if (++x == b.columns) {
            x = 0;
            y++;
        }
        assert(y < b.rows);
    }
}

size_t bis_curve_draw(const bis_curve *t, double s)
{
    assert(t->n_tiles > 0 && s >= 0 && s < 1);
    const size_t i = find_tile(t, s);
    return t->side == 1 ? t->tile[i] : find_pixel(t, i, s);
}

size_t bis_curve_bytes(const bis_curve *t)
{
    _Static_assert(sizeof *t->tile + sizeof *t->before + sizeof *t->guide == BIS_CURVE_BYTES &&
                   sizeof *t->before == BIS_CURVE_SUM_BYTES, "importance.h promises it");
    return t->n_tiles * (sizeof *t->tile + sizeof *t->before) + t->n_guide * sizeof *t->guide;
}

double bis_curve_in_tile(const bis_curve *t, double s)
{
    const size_t i = find_tile(t, s);
    const double begin = share_before(t, i), end = share_before(t, i + 1);
    return fmin((s - begin) / (end - begin), 1 - 0x1p-53);
}

bis_curve_tile bis_curve_tile_at(const bis_curve *t, size_t i)
{
    const block b = block_of(t, t->tile[i]);
    double solid_angle = 0;

    for (uint32_t y = b.y; y < b.y + b.rows; y++) solid_angle += b.columns * t->weights.em->row_solid_angle[y];
    return (bis_curve_tile){t->tile[i], share_before(t, i + 1), solid_angle};
}
