/* SPDX-License-Identifier: BSD-2-Clause */
/* curve: Hilbert's curve (hilbert.h) in double, and a curve of the same kind on rectangles. */
#include "bis/base/curve.h"

#include "hilbert.h"

#include <assert.h>
#include <stddef.h>

enum { LEVELS = 26 };

void bis_curve_hilbert(double t, double u[2])
{
    assert(t >= 0 && t < 1);
    const uint32_t levels = ((uint32_t)1 << LEVELS) - 1;
    const uint64_t digits = (uint64_t)(t * 0x1p52);
    const uint32_t high = (uint32_t)(digits >> 26), low = (uint32_t)digits & ((1u << 26) - 1); /* 13 levels each */
    const uint32_t a = even_bits(high >> 1) << 13 | even_bits(low >> 1), b = even_bits(high) << 13 | even_bits(low);
    const uint32_t x = hilbert_x(a, b, levels), y = hilbert_y(x, b);
    u[0] = (double)x * 0x1p-26;
    u[1] = (double)y * 0x1p-26;
}

/* ---- rectangles ----
 *
 * A block is a corner cell and two sides. Its curve enters at the corner and leaves at the far end of the first side.
 * The parts of a block are blocks again. A long block is cut in two along its first side. Any other block is cut in
 * three: the curve goes up the second side, along the first, and down again. Cuts are made at even lengths where this
 * is possible, so that the ends meet (Cerveny 2018, "gilbert"). One side halves at each level, so the depth of the
 * recursion is at most 2 * 32. */

typedef struct cell {
    int32_t x, y;
} cell;

typedef struct path {
    uint32_t *order;
    size_t n;
    uint32_t width;
} path;

static cell plus(cell a, cell b) { return (cell){a.x + b.x, a.y + b.y}; }
static cell minus(cell a, cell b) { return (cell){a.x - b.x, a.y - b.y}; }
static cell times(cell a, int32_t s) { return (cell){a.x * s, a.y * s}; }
static int32_t sign(int32_t x) { return (x > 0) - (x < 0); }
static cell unit(cell side) { return (cell){sign(side.x), sign(side.y)}; }
static int32_t cells_in(cell side) { return side.x + side.y < 0 ? -side.x - side.y : side.x + side.y; }

/* Returns about half of side: an even number of cells unless the side is too short. */
static cell half(cell side)
{
    int32_t n = cells_in(side) / 2;
    if (n % 2 == 1 && cells_in(side) > 2) n++;
    return times(unit(side), n);
}

static void visit_line(path *p, cell at, cell side)
{
    cell step = unit(side);
    for (int32_t i = cells_in(side); i > 0; i--, at = plus(at, step))
        p->order[p->n++] = (uint32_t)at.y * p->width + (uint32_t)at.x;
}

static void visit_block(path *p, cell corner, cell first, cell second)
{
    int32_t w = cells_in(first), h = cells_in(second);
    if (h == 1) {
        visit_line(p, corner, first);
        return;
    }
    if (w == 1) {
        visit_line(p, corner, second);
        return;
    }
    if (2 * w > 3 * h) {
        cell start = half(first);
        visit_block(p, corner, start, second);
        visit_block(p, plus(corner, start), minus(first, start), second);
        return;
    }
    cell first_half = times(unit(first), w / 2), second_half = half(second);
    cell turn = plus(minus(first, unit(first)), minus(second_half, unit(second)));
    visit_block(p, corner, second_half, first_half);
    visit_block(p, plus(corner, second_half), first, minus(second, second_half));
    visit_block(p, plus(corner, turn), times(second_half, -1), minus(first_half, first));
}

void bis_curve_rectangle(uint32_t *order, uint32_t width, uint32_t height)
{
    path p = {order, 0, width};
    assert(width <= INT32_MAX && height <= INT32_MAX && (uint64_t)width * height <= UINT32_MAX);
    cell corner = {0, 0}, right = {(int32_t)width, 0}, down = {0, (int32_t)height};
    if (width == 0 || height == 0) return;
    if (width >= height)
        visit_block(&p, corner, right, down);
    else
        visit_block(&p, corner, down, right);
}
