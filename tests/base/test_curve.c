/* SPDX-License-Identifier: BSD-2-Clause */
/* curve: Hilbert's curve against the recursive definition, rectangles by walking them. */
#include "bis/base/curve.h"
#include "bis/base/mem.h"
#include "bis/thesis/rng.h"
#include "claim.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Another road: the definition. Quarters of the curve are copies of it: mirrored at the diagonal, as it is, as it is,
 * mirrored at the other diagonal. */
static void by_definition(double t, int levels, double u[2])
{
    if (levels == 0) {
        u[0] = u[1] = 0.5;
        return;
    }
    int quarter = (int)(4 * t);
    double v[2];
    by_definition(4 * t - quarter, levels - 1, v);
    switch (quarter) {
    case 0: u[0] = v[1] / 2, u[1] = v[0] / 2; break;
    case 1: u[0] = v[0] / 2, u[1] = v[1] / 2 + 0.5; break;
    case 2: u[0] = v[0] / 2 + 0.5, u[1] = v[1] / 2 + 0.5; break;
    default: u[0] = 1 - v[1] / 2, u[1] = 0.5 - v[0] / 2; break;
    }
}

static void hilbert_follows_the_definition_to_its_last_level(void **state)
{
    bis_rng r;
    bis_rng_init(&r, 1, 0, 0, 0);
    for (int i = 0; i < 20000; i++) {
        double t = bis_rng_double(&r), u[2], v[2];
        bis_curve_hilbert(t, u);
        by_definition(t, 26, v); /* the centre of the cell of which u is the corner */
        assert_true(u[0] + 0x1p-27 == v[0] && u[1] + 0x1p-27 == v[1]);
    }
}

/* 4^k equal intervals go to the 4^k cells of a 2^k grid, each to one, and successive ones to neighbours. */
static void hilbert_is_measure_preserving_and_connected_on_every_grid(void **state)
{
    for (int level = 1; level <= 8; level++) {
        int side = 1 << level, x0 = 0, y0 = 0;
        unsigned char *seen = bis_alloc((size_t)side * (size_t)side, 1);
        for (int i = 0; i < side * side; i++) {
            double u[2];
            bis_curve_hilbert((i + 0.375) / (side * side), u);
            int x = (int)(u[0] * side), y = (int)(u[1] * side);
            assert_int_equal(seen[y * side + x]++, 0);
            if (i) assert_int_equal(abs(x - x0) + abs(y - y0), 1);
            x0 = x, y0 = y;
        }
        bis_free(seen);
    }
}

/* Points a distance d apart on the curve lie within sqrt(6 d) in the plane (Bauman 2006: the best constant for this
 * curve). */
static void neighbours_on_the_curve_are_neighbours_in_the_plane(void **state)
{
    bis_rng r;
    bis_rng_init(&r, 2, 0, 0, 0);
    for (int i = 0; i < 100000; i++) {
        double d = pow(2, -24 * bis_rng_double(&r)), t = (1 - d) * bis_rng_double(&r), u[2], v[2];
        bis_curve_hilbert(t, u);
        bis_curve_hilbert(fmin(t + d, 1 - 0x1p-53), v);
        assert_true(hypot(u[0] - v[0], u[1] - v[1]) <= sqrt(6 * d) + 0x1p-25);
    }
}

/* Walks the curve: every cell once, each step to a 4-neighbour. Returns the number of diagonal steps. */
static int diagonal_steps(uint32_t width, uint32_t height)
{
    size_t n = (size_t)width * height;
    uint32_t *order = bis_alloc(n, sizeof *order);
    unsigned char *seen = bis_alloc(n, 1);
    int diagonals = 0;
    bis_curve_rectangle(order, width, height);
    assert_int_equal(order[0], 0);
    for (size_t i = 0; i < n; i++) {
        assert_true(order[i] < n);
        assert_int_equal(seen[order[i]]++, 0);
        if (i == 0) continue;
        int dx = abs((int)(order[i] % width) - (int)(order[i - 1] % width));
        int dy = abs((int)(order[i] / width) - (int)(order[i - 1] / width));
        assert_true(dx <= 1 && dy <= 1);
        diagonals += dx + dy == 2;
    }
    bis_free(order);
    bis_free(seen);
    return diagonals;
}

/* A path along the longer side must end at its far end: with an odd number of steps along it and an even number across,
 * a chessboard's colours forbid it without one diagonal step. */
static void a_rectangle_is_walked_cell_by_cell(void **state)
{
    for (uint32_t width = 1; width <= 40; width++)
        for (uint32_t height = 1; height <= 40; height++) {
            uint32_t longer = width > height ? width : height, shorter = width > height ? height : width;
            int allowed = longer % 2 == 1 && shorter % 2 == 0;
            assert_in_range(diagonal_steps(width, height), 0, allowed);
        }
    assert_int_equal(diagonal_steps(512, 256), 0);
    assert_in_range(diagonal_steps(1001, 7), 0, 0);
    assert_int_equal(diagonal_steps(5, 1000), 0);
    assert_int_equal(diagonal_steps(1, 5000), 0);
}

/* Cells 64 apart on the curve of a 200 x 120 rectangle are at most a few 8s apart; along rows they would be 64. */
static void a_rectangles_curve_is_compact(void **state)
{
    const uint32_t width = 200, height = 120;
    uint32_t *order = bis_alloc((size_t)width * height, sizeof *order);
    double sum = 0, n = 0;
    bis_curve_rectangle(order, width, height);
    for (uint32_t i = 0; i + 64 < width * height; i++, n++) {
        double dx = (double)(order[i] % width) - (double)(order[i + 64] % width);
        double dy = (double)(order[i] / width) - (double)(order[i + 64] / width);
        assert_true(hypot(dx, dy) < 32);
        sum += hypot(dx, dy);
    }
    assert_true(sum / n < 10);
    bis_free(order);
}

/* (3 + 1/2)/8; a place so near the end of the last stratum that the sum rounds to n stays below 1. */
static void a_stratum_s_place_is_a_number_below_1(void **state)
{
    static const uint32_t n[] = {1, 3, 10, 4096, UINT32_MAX};
    assert_true(bis_stratum(3, 0.5, 8) == 0.4375);
    assert_true(bis_stratum(0, 0, 7) == 0 && bis_stratum(0, 0.25, 1) == 0.25);
    assert_true(bis_stratum(5, 0.75, 1000) == 5.75 / 1000);
    assert_true(bis_stratum(0, 1 - 0x1p-53, 1) == 1 - 0x1p-53);
    for (int i = 1; i < 5; i++) assert_true(bis_stratum(n[i] - 1, 1 - 0x1p-53, n[i]) == 1 - 0x1p-53);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hilbert_follows_the_definition_to_its_last_level),
        cmocka_unit_test(hilbert_is_measure_preserving_and_connected_on_every_grid),
        cmocka_unit_test(neighbours_on_the_curve_are_neighbours_in_the_plane),
        cmocka_unit_test(a_rectangle_is_walked_cell_by_cell),
        cmocka_unit_test(a_rectangles_curve_is_compact),
        cmocka_unit_test(a_stratum_s_place_is_a_number_below_1),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
