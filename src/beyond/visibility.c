/* SPDX-License-Identifier: BSD-2-Clause */
/* visibility: counts, and what they say.
 *
 * Its constants, and those of guide.c, were measured in eight scenes without a Sampler and an Integrator: scene.txt, of
 * data/scenes overcast-diffuse, glossy-row, microfacet, outdoor-sun and figure-5.7-n50, and two closed rooms with one
 * window. For each value `bis SCENE --resolution 96x72 --spp 8 --seed 0` (to 3) was
 * compared with a mean of 192 samples or more. A figure is the relative squared error times the number of shadow rays,
 * over the same with our value: the geometric mean of scenes and seeds, without the worst 0.2 % of the pixels. */
#include "bis/beyond/visibility.h"

#include "bis/base/mem.h"

#include <math.h>

enum { PARTS = BIS_VISIBILITY_PARTS };

bis_status bis_visibility_init(bis_visibility *v, size_t n_tiles, size_t n_squares, uint64_t n_pixels, bis_diag *diag)
{
    *v = (bis_visibility){
        .n_tiles = n_tiles, .n_squares = n_squares,
        .cells = n_pixels > BIS_VISIBILITY_LARGE ? 1 : BIS_VISIBILITY_CELLS};
    v->known = bis_alloc(n_tiles * v->cells + n_squares, sizeof *v->known);
    v->counted = bis_alloc(n_tiles * v->cells + n_squares, sizeof *v->counted);
    v->above = bis_alloc(n_tiles + n_squares, sizeof *v->above);
    v->squares = bis_alloc(n_squares, sizeof *v->squares);
    for (size_t i = 0; v->above && i < n_tiles + n_squares; i++) v->above[i] = BIS_NO_SQUARE;
    if (v->known && v->counted && v->above && v->squares) return BIS_OK;
    bis_visibility_clear(v);
    return bis_error(diag, BIS_NOMEM, (bis_loc){0},
                     "no memory for the visibility learned in %zu tiles; \"bool learn\" false needs none", n_tiles);
}

void bis_visibility_clear(bis_visibility *v)
{
    bis_free(v->known);
    bis_free(v->counted);
    bis_free(v->above);
    bis_free(v->squares);
    *v = (bis_visibility){0};
}

size_t bis_visibility_bytes(const bis_visibility *v)
{
    return 2 * (v->n_tiles * v->cells + v->n_squares) * sizeof *v->known +
           (v->n_tiles + v->n_squares) * sizeof *v->above + v->n_squares * sizeof *v->squares;
}

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

/* The number of leaves of a binary tree over the parts. */
static uint32_t leaves_of(uint32_t n_parts)
{
    uint32_t leaves = 1;

    while (leaves < n_parts) leaves *= 2;
    return leaves;
}

/* The mean of V in each part of a place. above: the same in the square around it; NULL: there is none.
 *
 * The parts are the leaves of a binary tree over the map's curve, so a node is a compact piece of the map. A node's
 * mean is that of its rays, drawn towards the mean of the node above by three rays for each part below it: what the
 * rays of a few parts say about all others is weak, what a part's own rays say is strong. So a part without rays
 * expects what was found around it. (One ray: 1.02, a room with a sun 1.13; nine: 1.04, that room 1.22.) The root
 * stands for all rays of the tile: if S of R came through, (S + 1)/(R + 2) is expected of the next (Laplace's rule of
 * succession).
 * A square knows another thing than the parts around: whether light comes from there in the neighbourhood. A leaf is
 * drawn towards the mean of both. Their product would be 0 if either is, and both are wrong at the edge of a shadow. */
static void expect(float *mean, const seen_sums *place, uint32_t n_parts, const float *above)
{
    float rays[2 * PARTS], seen[2 * PARTS], m[2 * PARTS]; /* node i is above 2 i and 2 i + 1; 1 is the root */
    const uint32_t leaves = leaves_of(n_parts);

    for (uint32_t i = 0; i < leaves; i++) {
        rays[leaves + i] = (float)place->rays[i];
        seen[leaves + i] = (float)place->seen[i];
    }
    for (uint32_t i = leaves - 1; i > 0; i--) {
        rays[i] = rays[2 * i] + rays[2 * i + 1];
        seen[i] = seen[2 * i] + seen[2 * i + 1];
    }
    m[1] = (seen[1] + 1) / (rays[1] + 2);
    for (uint32_t first = 2; first <= leaves; first *= 2) {
        const float a = 3 * (float)(leaves / first);
        for (uint32_t i = first; i < 2 * first; i++) {
            const float other = above && first == leaves ? 0.5f * (above[i - leaves] + m[i / 2]) : m[i / 2];
            m[i] = (seen[i] + a * other) / (rays[i] + a);
        }
    }
    for (uint32_t i = 0; i < PARTS; i++) mean[i] = i < leaves ? m[leaves + i] : 0;
}

/* The best h where the mean of V is v.
 *
 * With the control, what is left of V has variance v (1 - v), and the best h is its root. Without it the best h is the
 * root of the second moment, v. Points of both kinds share one h between the two: h^2 = v (1 - 0.8 v). (0.5: 1.005,
 * from .97 to 1.03; 0.95: 1.03, up to 1.11 in microfacet.) */
static inline BIS_INLINE float best_h(float v) { return sqrtf(v * (1 - 0.8f * v)); }

/* g, the mean of V, for each part, the best h, and left: E[(V - g)^2], which the control leaves.
 *
 * The mean of V in the tile is worth as much as two rays of the cell. (One ray: 1.00; four: 1.01.) For g it is the mean
 * of the part's own rays, if there are any: where all came through g is 1, where none did it is 0, and there the
 * control leaves no noise. */
BIS_LANES
static void guess_parts(float *restrict g, float *restrict h, float *restrict left, const seen_sums *restrict cell,
                        const seen_sums *restrict tile, const float *restrict mean)
{
#pragma omp simd
    for (int i = 0; i < PARTS; i++) {
        const float R = (float)(int32_t)tile->rays[i], S = (float)(int32_t)tile->seen[i];
        const float r = (float)(int32_t)cell->rays[i], s = (float)(int32_t)cell->seen[i];
        const float none = R > 0 ? 0.0f : 1.0f, known = (S + none * mean[i]) / (R + none);
        const float v = (s + 2 * mean[i]) / (r + 2);
        g[i] = (s + 2 * known) / (r + 2);
        h[i] = best_h(v);
        left[i] = v * (1 - v) + (v - g[i]) * (v - g[i]);
    }
}

enum { ARRAYS = 7 };

size_t bis_guess_bytes(uint32_t n) { return ARRAYS * (size_t)bis_lanes_round_up(n) * sizeof(float); }

bis_status bis_guess_init(bis_visibility_guess *f, uint32_t n, bis_diag *diag)
{
    const size_t padded = bis_lanes_round_up(n);

    *f = (bis_visibility_guess){.memory = bis_alloc(ARRAYS * padded, sizeof *f->memory)};
    if (!f->memory)
        return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for the visibility of %u clusters", (unsigned)n);
    f->own = f->memory;
    f->g = f->memory + padded;
    f->h = f->memory + 2 * padded;
    f->control = f->memory + 3 * padded;
    f->of_square = f->memory + 4 * padded;
    f->left = f->memory + 5 * padded;
    f->noise = f->memory + 6 * padded;
    for (uint32_t k = 0; k < n; k++) f->own[k] = 0.5f;
    return BIS_OK;
}

void bis_guess_clear(bis_visibility_guess *f)
{
    bis_free(f->memory);
    *f = (bis_visibility_guess){0};
}

/* The smallest one that is closed; NULL: none. */
static const bis_square *square_around(const bis_visibility *v, size_t place)
{
    uint32_t k = v->above[place];

    while (k != BIS_NO_SQUARE && v->squares[k].h[0] == 0) k = v->above[v->n_tiles + k];
    return k == BIS_NO_SQUARE ? NULL : &v->squares[k];
}

void bis_guess_look(bis_visibility_guess *f, uint32_t n, const bis_visibility *v, size_t cell)
{
    const bool is_tile = cell < v->n_tiles * v->cells;
    const size_t place = is_tile ? cell / v->cells : v->n_tiles + (cell - v->n_tiles * v->cells);
    const size_t first = bis_visibility_first_cell(v, place), end = first + (is_tile ? v->cells : 1);
    const uint32_t n_parts = parts_of(n);
    seen_sums all = {{0}, {0}}, own = all;
    float mean[PARTS], g[PARTS], h[PARTS], left[PARTS];
    const bis_square *around = square_around(v, place);

    for (size_t i = first; i < end; i++) add_cell(&all, &v->known[i]);
    for (size_t i = first; i < cell; i++) add_cell(&all, &v->counted[i]);
    expect(mean, &all, n_parts, around ? around->mean : NULL);
    if (is_tile) add_cell(&own, &v->known[cell]);
    guess_parts(g, h, left, &own, &all, mean);
    for (uint32_t k = 0; k < n; k++) {
        const uint32_t part = bis_visibility_part(k, n);
        f->own[k] = h[part];
        f->g[k] = g[part];
        f->left[k] = left[part];
        f->of_square[k] = around ? around->h[part] : 0;
    }
    uint32_t rays = 0, seen = 0;
    for (int i = 0; i < PARTS; i++) rays += all.rays[i], seen += all.seen[i];
    f->has_square = around != NULL;
    f->knows = f->has_square || rays > 0;
    f->is_dark = 4 * seen < rays;
    f->counted = &v->counted[cell];
}

void bis_visibility_close(bis_visibility *v, size_t k, uint32_t n)
{
    const bis_square *around = square_around(v, v->n_tiles + k);
    bis_square *square = &v->squares[k];
    seen_sums all = {{0}, {0}};

    add_cell(&all, &v->known[bis_visibility_first_cell(v, v->n_tiles + k)]);
    expect(square->mean, &all, parts_of(n), around ? around->mean : NULL);
    for (int i = 0; i < PARTS; i++) square->h[i] = best_h(square->mean[i]);
}

/* ---- what a point makes of it ---- */

enum { BLOCK = BIS_LANES_BLOCK };

/* The sums of b[i] times h[i] of a cell and of its square. The lanes of a block are summed side by side, so no width of
 * vectors changes the order. */
BIS_LANES
static void sum_products(float sum[2], const float *restrict b, const float *restrict own,
                         const float *restrict of_square, uint32_t n)
{
    float lane[2][BLOCK] = {{0}, {0}};

    for (size_t i = 0; i < n; i += BLOCK) { /* size_t: see sum_shares in src/thesis/set.c */
#pragma omp simd
        for (size_t j = 0; j < BLOCK; j++) {
            lane[0][j] += b[i + j] * own[i + j];
            lane[1][j] += b[i + j] * of_square[i + j];
        }
    }
    for (int k = 0; k < 2; k++) sum[k] = bis_lanes_sum(lane[k]);
}

/* What goes into h: the factors of what the cell knows, of what its square knows, and of nothing. */
typedef struct mixture {
    float cell, square, nothing;
} mixture;

BIS_LANES
static void mix(float *restrict b, const bis_visibility_guess *restrict f, mixture m, uint32_t n)
{
    float *restrict h = f->h, *restrict control = f->control, *restrict noise = f->noise;
    const float *own = f->own, *of_square = f->of_square, *g = f->g, *left = f->left;

#pragma omp simd
    for (uint32_t i = 0; i < n; i++) {
        h[i] = m.cell * own[i] + (m.square * of_square[i] + m.nothing);
        control[i] = g[i] / h[i];
        noise[i] = left[i] / (h[i] * h[i]);
        b[i] *= h[i];
    }
}

/* Each knowledge would send candidates in proportion to its own b h: the cell, the square around it, and none, where h
 * is 1. A mixture of these densities sends a fixed share of the candidates where each of them would (defensive
 * sampling: Hesterberg 1995; Owen and Zhou 2000). So what the cell takes for dark by mistake makes no weight more than
 * 15/4 times as large as the square alone would make it, and none more than 5 times as large as without knowledge.
 * Where one ray of a square came through candidates go until the cell itself knows better. (With 6 and 1 for the square
 * and for nothing, half open scenes have rare pixels that are 15 times too bright; rooms gain little.) The sum of b h
 * is 5/4 of that of the cell alone, because W/A, by which a point gets more rays (guide.c), grows with it. (1:
 * 0.995, with 0.97 of the rays; 3/2: 1.02, with 1.03 of them.) */
void bis_guess_mix(bis_visibility_guess *f, float *b, double W, uint32_t n)
{
    const uint32_t padded = bis_lanes_round_up(n);
    const float unit = 1.25f / 15;
    float sum[2];

    sum_products(sum, b, f->own, f->of_square, padded);
    const mixture with = {8 * unit, sum[1] > 0 ? 4 * unit * (sum[0] / sum[1]) : 0, 3 * unit * (sum[0] / (float)W)},
                  alone = {12 * unit, 0, 3 * unit * (sum[0] / (float)W)};

    mix(b, f, f->has_square ? with : alone, padded);
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

void bis_visibility_counted(uint32_t *rays, uint32_t *seen, const bis_visibility *v, int place)
{
    const size_t first = bis_visibility_first_cell(v, (size_t)place),
                 end = bis_visibility_first_cell(v, (size_t)place + 1);

    *rays = *seen = 0;
    for (size_t k = first; k < end; k++) {
        for (int i = 0; i < PARTS; i++) {
            *rays += v->counted[k].rays[i];
            *seen += v->counted[k].seen[i];
        }
    }
}

/* In a large picture a cell that has counted nothing, as where the background is seen, is not written to: it then takes
 * no memory. */
void bis_visibility_learn(const bis_visibility *v, const int *places, size_t n, int n_threads)
{
    (void)n_threads;
    if (!v->n_tiles) return;
#pragma omp parallel for num_threads(n_threads)
    for (size_t i = 0; i < n; i++) {
        const size_t place = places ? (size_t)places[i] : i, first = bis_visibility_first_cell(v, place),
                     end = bis_visibility_first_cell(v, place + 1);
        if (end == first + 1 && is_empty(&v->counted[first])) continue;
        for (size_t k = first; k < end; k++) learn_cell(&v->known[k], &v->counted[k]);
    }
}
