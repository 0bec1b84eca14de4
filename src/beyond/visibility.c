/* SPDX-License-Identifier: BSD-2-Clause */
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

/* Sums over cells. */
typedef struct seen_sums {
    uint32_t rays[PARTS], seen[PARTS];
} seen_sums;

BIS_LANES
static void add_cell(seen_sums *restrict sum, const bis_seen *restrict cell)
{
#pragma omp simd
    for (int i = 0; i < PARTS; i++) sum->rays[i] += cell->rays[i];
#pragma omp simd
    for (int i = 0; i < PARTS; i++) sum->seen[i] += cell->seen[i];
}

/* The parts that n clusters have. */
static uint32_t parts_of(uint32_t n) { return n < PARTS ? n : PARTS; }

/* The mean of V in each part of a tile.
 *
 * The parts are the leaves of a binary tree over the map's curve, so a node is a compact piece of the map. A node's
 * mean is that of its rays, drawn towards the mean of the node above by three rays for each part below it: what the
 * rays of a few parts say about all others is weak, what a part's own rays say is strong. So a part without rays
 * expects what was found around it. The root stands for all rays of the tile: if S of R came through, (S + 1)/(R + 2)
 * is expected of the next (Laplace's rule of succession). */
static void expect(float *mean, const seen_sums *tile, uint32_t n_parts)
{
    float rays[2 * PARTS], seen[2 * PARTS], m[2 * PARTS]; /* node i is above 2 i and 2 i + 1; 1 is the root */
    uint32_t leaves = 1;

    while (leaves < n_parts) leaves *= 2;
    for (uint32_t i = 0; i < leaves; i++) {
        rays[leaves + i] = (float)tile->rays[i];
        seen[leaves + i] = (float)tile->seen[i];
    }
    for (uint32_t i = leaves - 1; i > 0; i--) {
        rays[i] = rays[2 * i] + rays[2 * i + 1];
        seen[i] = seen[2 * i] + seen[2 * i + 1];
    }
    m[1] = (seen[1] + 1) / (rays[1] + 2);
    for (uint32_t first = 2; first <= leaves; first *= 2) {
        const float a = 3 * (float)(leaves / first);
        for (uint32_t i = first; i < 2 * first; i++) m[i] = (seen[i] + a * m[i / 2]) / (rays[i] + a);
    }
    for (uint32_t i = 0; i < PARTS; i++) mean[i] = i < leaves ? m[leaves + i] : 0;
}

/* g, the mean of V, for each part, and the best h.
 *
 * The mean of V in the tile is worth as much as two rays of the cell. For g it is the mean of the part's own rays, if
 * there are any: where all came through g is 1, where none did it is 0, and there the control leaves no noise.
 *
 * With the control, what is left of V has variance v (1 - v), and the best h is its root. Without it the best h is the
 * root of the second moment, v. Points of both kinds share one h between the two: h^2 = v (1 - 0.8 v). 0.8 lies nearer
 * to 1, because diffuse points lose more by a smaller number than narrow lobes gain. */
BIS_LANES
static void foresee(float *restrict g, float *restrict h, const seen_sums *restrict cell,
                    const seen_sums *restrict tile, const float *restrict mean)
{
#pragma omp simd
    for (int i = 0; i < PARTS; i++) {
        const float R = (float)(int32_t)tile->rays[i], S = (float)(int32_t)tile->seen[i];
        const float r = (float)(int32_t)cell->rays[i], s = (float)(int32_t)cell->seen[i];
        const float none = R > 0 ? 0.0f : 1.0f, known = (S + none * mean[i]) / (R + none);
        const float v = (s + 2 * mean[i]) / (r + 2);
        g[i] = (s + 2 * known) / (r + 2);
        h[i] = sqrtf(v * (1 - 0.8f * v));
    }
}

/* A quarter of the mean of h is added to every h: about a fifth of the candidates and rays then go where they would go
 * if nothing were known (defensive sampling: Hesterberg 1995; Owen and Zhou 2000). So a part that is wrongly held for
 * dark makes a weight at most some five times as large, and the price of what is known is a fifth of the rays at
 * most. */
static void doubt(float *h, uint32_t n_parts)
{
    float sum = 0;

    for (uint32_t i = 0; i < n_parts; i++) sum += h[i];
    for (uint32_t i = 0; i < n_parts; i++) h[i] += sum / (4 * (float)n_parts);
}

size_t bis_guess_bytes(uint32_t n) { return 2 * (size_t)bis_lanes_round_up(n) * sizeof(float); }

bis_status bis_guess_init(bis_visibility_guess *f, uint32_t n, bis_diag *diag)
{
    const size_t padded = bis_lanes_round_up(n);

    *f = (bis_visibility_guess){.memory = bis_alloc(2 * padded, sizeof *f->memory)};
    if (!f->memory)
        return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for the visibility of %u clusters", (unsigned)n);
    f->h = f->memory;
    f->control = f->memory + padded;
    for (uint32_t k = 0; k < n; k++) f->h[k] = 0.5f;
    return BIS_OK;
}

void bis_guess_clear(bis_visibility_guess *f)
{
    bis_free(f->memory);
    *f = (bis_visibility_guess){0};
}

void bis_guess_look(bis_visibility_guess *f, uint32_t n, const bis_visibility *v, size_t cell)
{
    const size_t first = cell / v->cells * v->cells;
    const uint32_t n_parts = parts_of(n);
    seen_sums tile = {{0}, {0}}, own = tile;
    float mean[PARTS], g[PARTS], h[PARTS];

    for (size_t i = first; i < first + v->cells; i++) add_cell(&tile, &v->known[i]);
    for (size_t i = first; i < cell; i++) add_cell(&tile, &v->counted[i]);
    expect(mean, &tile, n_parts);
    add_cell(&own, &v->known[cell]);
    foresee(g, h, &own, &tile, mean);
    doubt(h, n_parts);
    for (uint32_t k = 0; k < n; k++) {
        const uint32_t part = bis_visibility_part(k, n);
        f->h[k] = h[part];
        f->control[k] = g[part] / h[part];
    }
    f->knows = false;
    for (int i = 0; i < PARTS; i++) f->knows |= tile.rays[i] > 0;
    f->counted = &v->counted[cell];
}

uint16_t *bis_guess_count(const bis_visibility_guess *f, uint32_t k, uint32_t n)
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

void bis_visibility_counted(uint32_t *rays, uint32_t *seen, const bis_visibility *v, int tile)
{
    const size_t first = (size_t)tile * v->cells;

    *rays = *seen = 0;
    for (size_t k = first; k < first + v->cells; k++) {
        for (int i = 0; i < PARTS; i++) {
            *rays += v->counted[k].rays[i];
            *seen += v->counted[k].seen[i];
        }
    }
}

/* In a large picture a cell that has counted nothing, as where the background is seen, is not written to: it then takes
 * no memory. */
void bis_visibility_learn(const bis_visibility *v, const int *tiles, size_t n, int n_threads)
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
