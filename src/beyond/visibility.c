/* visibility: counts, and what they say. */
#include "bis/beyond/visibility.h"

#include "bis/base/mem.h"

#include <math.h>

enum { PARTS = BIS_VISIBILITY_PARTS, LARGE = 1 << 23 /* pixels; smaller cells would take 64 bytes for each */ };

bis_status bis_visibility_init(bis_visibility *v, size_t n_tiles, uint64_t n_pixels, bis_diag *diag)
{
    *v = (bis_visibility){.n_tiles = n_tiles, .cells = n_pixels > LARGE ? 1 : BIS_VISIBILITY_CELLS};
    v->known = bis_alloc(n_tiles * v->cells, sizeof *v->known);
    v->counted = bis_alloc(n_tiles * v->cells, sizeof *v->counted);
    if (v->known && v->counted) return BIS_OK;
    bis_visibility_clear(v);
    return bis_error(diag, BIS_NOMEM, (bis_loc){0},
                     "no memory for the visibility learned in %zu tiles; \"bool learn\" false needs none", n_tiles);
}

void bis_visibility_clear(bis_visibility *v)
{
    bis_free(v->known);
    bis_free(v->counted);
    *v = (bis_visibility){0};
}

size_t bis_visibility_bytes(const bis_visibility *v) { return 2 * v->n_tiles * v->cells * sizeof *v->known; }

/* ---- what a cell knows ---- */

/* The sums over the cells of a tile. */
typedef struct tile_sums {
    uint32_t rays[PARTS], seen[PARTS];
} tile_sums;

BIS_LANES
static void add_cell(tile_sums *restrict sum, const bis_seen *restrict cell)
{
#pragma omp simd
    for (int i = 0; i < PARTS; i++) sum->rays[i] += cell->rays[i];
#pragma omp simd
    for (int i = 0; i < PARTS; i++) sum->seen[i] += cell->seen[i];
}

/* For each part, h and g/h.
 *
 * The mean of V in the tile is worth as much as two rays of the cell. While the tile has few counts, its mean for h is
 * drawn towards 3/4 by two rays. g is not: where all rays of a tile came through g is 1, where none did it is 0, and
 * there the control leaves no noise.
 *
 * With the control, what is left of V has variance v (1 - v), and the best h is its root. Without it the best h is the
 * root of the second moment, v. Points of both kinds share one h between the two: h^2 = v (1 - 0.8 v) + 0.01. 0.8
 * lies nearer to 1, because diffuse points lose more by a smaller number than narrow lobes gain. h is never 0, because
 * a part that no ray has seen may still be visible. */
BIS_LANES
static void foresee(float *restrict h, float *restrict control, const bis_seen *restrict cell,
                    const tile_sums *restrict tile)
{
#pragma omp simd
    for (int i = 0; i < PARTS; i++) {
        const float rays = (float)(int32_t)tile->rays[i], seen = (float)(int32_t)tile->seen[i];
        const float r = cell->rays[i], s = cell->seen[i];
        const float mean = (seen + 1.5f) / (rays + 2), known = seen / (rays > 0 ? rays : 1);
        const float v = (s + 2 * mean) / (r + 2), g = (s + 2 * known) / (r + 2);
        h[i] = sqrtf(v * (1 - 0.8f * v) + 0.01f);
        control[i] = g / h[i];
    }
}

size_t bis_foresight_bytes(uint32_t n) { return 2 * (size_t)bis_lanes_round_up(n) * sizeof(float); }

bis_status bis_foresight_init(bis_foresight *f, uint32_t n, bis_diag *diag)
{
    const size_t padded = bis_lanes_round_up(n);

    *f = (bis_foresight){.memory = bis_alloc(2 * padded, sizeof *f->memory)};
    if (!f->memory)
        return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for the visibility of %u clusters", (unsigned)n);
    f->h = f->memory;
    f->control = f->memory + padded;
    for (uint32_t k = 0; k < n; k++) f->h[k] = 0.5f;
    return BIS_OK;
}

void bis_foresight_clear(bis_foresight *f)
{
    bis_free(f->memory);
    *f = (bis_foresight){0};
}

void bis_foresight_look(bis_foresight *f, uint32_t n, const bis_visibility *v, size_t cell)
{
    const size_t first = cell / v->cells * v->cells;
    tile_sums tile = {{0}, {0}};
    float h[PARTS], control[PARTS];

    for (size_t i = first; i < first + v->cells; i++) add_cell(&tile, &v->known[i]);
    for (size_t i = first; i < cell; i++) add_cell(&tile, &v->counted[i]);
    foresee(h, control, &v->known[cell], &tile);
    for (uint32_t k = 0; k < n; k++) {
        const uint32_t part = bis_visibility_part(k, n);
        f->h[k] = h[part];
        f->control[k] = control[part];
    }
    f->knows = false;
    for (int i = 0; i < PARTS; i++) f->knows |= tile.rays[i] > 0;
    f->counted = &v->counted[cell];
}

uint16_t *bis_foresight_count(const bis_foresight *f, uint32_t k, uint32_t n)
{
    const uint32_t part = bis_visibility_part(k, n);

    if (!f->counted || f->counted->rays[part] == UINT16_MAX) return NULL;
    f->counted->rays[part]++;
    return &f->counted->seen[part];
}

static bool is_empty(const bis_seen *counted)
{
    uint32_t rays = 0;
    for (int i = 0; i < PARTS; i++) rays |= counted->rays[i];
    return rays == 0;
}

/* Counts that would not fit are halved first: old rays then count less, and their mean stays. */
static void learn_cell(bis_seen *known, bis_seen *counted)
{
    for (int i = 0; i < PARTS; i++) {
        uint32_t rays = (uint32_t)known->rays[i] + counted->rays[i], seen = (uint32_t)known->seen[i] + counted->seen[i];
        for (; rays > UINT16_MAX; rays /= 2) seen /= 2;
        known->rays[i] = (uint16_t)rays;
        known->seen[i] = (uint16_t)seen;
    }
    *counted = (bis_seen){{0}, {0}};
}

/* In a large picture a cell that has counted nothing, as where the background is seen, is not written to: it then takes
 * no memory. */
void bis_visibility_learn(bis_visibility *v, const int *tiles, size_t n, int n_threads)
{
    (void)n_threads;
    if (!v->n_tiles) return;
#pragma omp parallel for num_threads(n_threads)
    for (size_t i = 0; i < n; i++) {
        const size_t first = (tiles ? (size_t)tiles[i] : i) * v->cells;
        if (v->cells == 1 && is_empty(&v->counted[first])) continue;
        for (size_t k = first; k < first + v->cells; k++) learn_cell(&v->known[k], &v->counted[k]);
    }
}
