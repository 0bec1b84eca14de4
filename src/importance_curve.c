/* importance_curve: drawing a pixel by one number, along a curve that visits all lit pixels.
 *
 * Neighbours on the curve (bis/curve.h) are neighbours in the map, so N equal steps of s are N compact pieces of the map of equal importance.
 * One stratified set of numbers then fills the map evenly in both dimensions, for any N, which two passes cannot do; chapter 4's
 * systematic resampling walks along the same curve.
 *
 * A CDF over single pixels would cost 12 bytes each. We keep one over blocks of 16 successive pixels, and find the pixel in its block by adding up
 * their weights, which are computed anyway for the density: as exact, 12/16 bytes, and the scan touches what a search would have to fetch.
 * Build O(W H), draw O(1). Monotone in s. */
#include "bis/curve.h"
#include "bis/mem.h"
#include "importance_parts.h"

#include <assert.h>

enum { BLOCK = 16 };

/* Probability of a pixel, times the sum of all. */
static double pixel_weight(const bis_weights *w, uint32_t pixel)
{
    return bis_weight(w, pixel) * w->em->row_solid_angle[pixel / (uint32_t)w->em->width];
}

static size_t n_blocks(const bis_trail *t) { return (t->n_lit + BLOCK - 1) / BLOCK; }

static size_t block_end(const bis_trail *t, size_t block)
{
    const size_t end = (block + 1) * BLOCK;
    return end < t->n_lit ? end : t->n_lit;
}

/* All pixels in the curve's order, then only those that can be drawn. */
static bis_status find_order(bis_trail *t, const bis_weights *w)
{
    const size_t n = (size_t)w->em->width * (size_t)w->em->height;
    t->order = bis_alloc(n, sizeof *t->order);
    if (!t->order) return BIS_NOMEM;
    bis_curve_rectangle(t->order, (uint32_t)w->em->width, (uint32_t)w->em->height);
    for (size_t i = 0; i < n; i++) {
        if (bis_weight(w, t->order[i]) > 0) t->order[t->n_lit++] = t->order[i];
    }
    uint32_t *shorter = bis_realloc(t->order, t->n_lit, sizeof *t->order);
    if (!shorter) return BIS_NOMEM;
    t->order = shorter;
    return BIS_OK;
}

static bis_status sum_blocks(bis_trail *t, const bis_weights *w)
{
    double *weight = bis_alloc(n_blocks(t), sizeof *weight);
    if (!weight) return BIS_NOMEM;
#pragma omp parallel for
    for (size_t block = 0; block < n_blocks(t); block++) {
        for (size_t i = block * BLOCK; i < block_end(t, block); i++) weight[block] += pixel_weight(w, t->order[i]);
    }
    const bis_status status = bis_cdf_init(&t->blocks, weight, n_blocks(t), NULL);
    bis_free(weight);
    return status;
}

bis_status bis_trail_init(bis_trail *t, const bis_weights *w, bis_diag *diag)
{
    *t = (bis_trail){0};
    bis_status status = find_order(t, w);
    if (!status) status = sum_blocks(t, w);
    if (!status) return BIS_OK;
    bis_trail_clear(t);
    return bis_error(diag, status, (bis_loc){0}, "no memory for the curve through a %d x %d environment map", w->em->width,
                     w->em->height);
}

void bis_trail_clear(bis_trail *t)
{
    bis_free(t->order);
    bis_cdf_clear(&t->blocks);
    *t = (bis_trail){0};
}

size_t bis_trail_draw(const bis_trail *t, const bis_weights *w, double s)
{
    double rest;
    const size_t block = bis_cdf_sample(&t->blocks, s, &rest);
    const size_t begin = block * BLOCK, end = block_end(t, block);
    double weight[BLOCK], sum = 0;
    for (size_t i = begin; i < end; i++) sum += weight[i - begin] = pixel_weight(w, t->order[i]);
    rest *= sum;
    for (size_t i = begin; i + 1 < end; i++) {
        if (rest < weight[i - begin]) return t->order[i];
        rest -= weight[i - begin];
    }
    return t->order[end - 1]; /* what is left, rounding included; its weight is positive like all in the order */
}

size_t bis_trail_bytes(const bis_trail *t) { return t->n_lit * sizeof *t->order + bis_cdf_bytes(&t->blocks); }
