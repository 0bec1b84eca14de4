/* SPDX-License-Identifier: BSD-2-Clause */
/* sampler: each point is uniform by itself, each set is as even as its kind promises, and different sets are
 * independent.
 * Family-wise significance 0.01. */
#include "bis/base/curve.h"
#include "bis/thesis/sampler.h"
#include "claim.h"
#include "stat.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { KINDS = 4, GRID = 16, CELLS = GRID * GRID, MAX_POINTS = 4096 };

static double alpha(void) { return stat_level(0.01, 73); }

static bis_sampler sampler_of(bis_sampler_kind kind, uint32_t xsamples, uint32_t ysamples)
{
    return (bis_sampler){kind, 42, xsamples * ysamples, xsamples, ysamples, true};
}

static void points_of(const bis_sampler *p, uint64_t pixel, uint32_t sample, unsigned dim, uint32_t n, double (*u)[2])
{
    bis_stream s;
    bis_stream_init(&s, p, pixel, sample);
    bis_stream_points(&s, dim, n, u);
}

static void camera_of(const bis_sampler *p, uint64_t pixel, uint32_t sample, double u[2])
{
    bis_stream s;
    bis_stream_init(&s, p, pixel, sample);
    bis_stream_camera(&s, u);
}

static void clear(double observed[CELLS], double expected[CELLS], double total)
{
    for (int i = 0; i < CELLS; i++) {
        observed[i] = 0;
        expected[i] = total / CELLS;
    }
}

static void count(double observed[CELLS], double x, double y)
{
    assert_true(x >= 0 && x < 1 && y >= 0 && y < 1);
    observed[(int)(x * GRID) * GRID + (int)(y * GRID)]++;
}

/* ---- uniform, one by one ---- */

static void every_point_of_every_kind_is_uniform_over_the_pixels(void **state)
{
    const uint32_t pixels = 100000, n = 7, sizes[] = {0, 3, 6};
    for (int kind = 0; kind < KINDS; kind++) {
        bis_sampler p = sampler_of((bis_sampler_kind)kind, 3, 2);
        double observed[4][CELLS], expected[CELLS], u[7][2], c[2];
        for (int i = 0; i < 4; i++)
            clear(observed[i], expected, pixels);
        for (uint32_t pixel = 0; pixel < pixels; pixel++) {
            points_of(&p, pixel, 4, 1, n, u);
            camera_of(&p, pixel, 4, c);
            /* stratified points are uniform in their part of the curve: one of the set, at random, is uniform in all of
             * it */
            uint32_t any = kind == BIS_SAMPLER_STRATIFIED ? (uint32_t)(bis_hash(pixel + 1) % n) : 0;
            for (int i = 0; i < 3; i++)
                count(observed[i], u[(sizes[i] + any) % n][0], u[(sizes[i] + any) % n][1]);
            count(observed[3], c[0], c[1]);
        }
        for (int i = 0; i < 4; i++)
            stat_assert_fit("sampler_uniform", 42, observed[i], expected, CELLS, alpha());
    }
}

/* All 53 bits are there: below 2^-32, too, each bit is 0 and 1 equally often (E14). */
static void every_kind_has_53_fair_bits(void **state)
{
    static double u[MAX_POINTS][2];
    for (int kind = 0; kind < KINDS; kind++) {
        bis_sampler p = sampler_of((bis_sampler_kind)kind, 4, 4);
        points_of(&p, 5, 0, 0, MAX_POINTS, u);
        for (int axis = 0; axis < 2; axis++)
            for (int bit = 1; bit <= 53; bit++) {
                double ones = 0;
                for (int i = 0; i < MAX_POINTS; i++)
                    ones += fmod(floor(ldexp(u[i][axis], bit)), 2);
                /* 5 standard errors of an independent coin, 424 coins */
                assert_true(fabs(ones - MAX_POINTS / 2.0) <= 5 * sqrt(MAX_POINTS / 4.0));
            }
    }
}

/* ---- even, together ---- */

/* One point in each box of shape cells_x x cells_y = n? */
static bool one_in_each_box(double (*u)[2], uint32_t n, uint32_t cells_x, uint32_t cells_y)
{
    unsigned char seen[MAX_POINTS] = {0};
    for (uint32_t i = 0; i < n; i++)
        seen[(uint32_t)(u[i][0] * cells_x) * cells_y + (uint32_t)(u[i][1] * cells_y)]++;
    for (uint32_t i = 0; i < n; i++)
        if (seen[i] != 1) return false;
    return true;
}

static bool is_net_in_base_2(double (*u)[2], uint32_t n)
{
    for (uint32_t x = 1; x <= n; x *= 2)
        if (!one_in_each_box(u, n, x, n / x)) return false;
    return true;
}

static void sobol_sets_of_2_to_the_k_points_are_nets(void **state)
{
    static double u[MAX_POINTS][2];
    bis_sampler p = sampler_of(BIS_SAMPLER_SOBOL, 4, 4);
    for (uint32_t n = 1; n <= MAX_POINTS; n *= 2)
        for (uint32_t sample = 0; sample < 5; sample++) {
            points_of(&p, 17, sample, 3, n, u);
            assert_true(is_net_in_base_2(u, n));
        }
    bis_sampler random = sampler_of(BIS_SAMPLER_RANDOM, 4, 4); /* the twin */
    points_of(&random, 17, 0, 3, 64, u);
    assert_false(is_net_in_base_2(u, 64));
}

static void sobol_sets_of_successive_samples_continue_each_other(void **state)
{
    static double u[MAX_POINTS][2];
    bis_sampler p = sampler_of(BIS_SAMPLER_SOBOL, 4, 4);
    for (uint32_t sample = 0; sample < 64; sample++) /* the last 48 lie beyond spp */
        points_of(&p, 18, sample, 0, 16, u + 16 * sample);
    for (uint32_t samples = 1; samples <= 64; samples *= 2)
        assert_true(is_net_in_base_2(u, 16 * samples));
}

static void any_prefix_of_2_to_the_k_sobol_camera_samples_is_a_net(void **state)
{
    static double u[256][2];
    bis_sampler p = sampler_of(BIS_SAMPLER_SOBOL, 16, 16);
    for (uint32_t sample = 0; sample < 256; sample++)
        camera_of(&p, 3, sample, u[sample]);
    for (uint32_t n = 1; n <= 256; n *= 2)
        assert_true(is_net_in_base_2(u, n));
}

/* Two successive camera samples are x and 1 - x in both coordinates, to the 32 digits of the sequence: what changes in
 * proportion to the place in the pixel is then found without error. Its twins: sets of light, and the other kinds. */
static void sobol_camera_samples_come_in_pairs_that_mirror_each_other(void **state)
{
    double u[2], v[2], set[2][2], off[KINDS] = {0}, set_off = 0;
    for (int kind = 0; kind < KINDS; kind++) {
        bis_sampler p = sampler_of((bis_sampler_kind)kind, 4, 4);
        for (uint32_t pixel = 0; pixel < 20; pixel++)
            for (uint32_t sample = 0; sample < 100; sample += 2) { /* the last 84 lie beyond spp */
                camera_of(&p, pixel, sample, u);
                camera_of(&p, pixel, sample + 1, v);
                for (int axis = 0; axis < 2; axis++)
                    off[kind] = fmax(off[kind], fabs(u[axis] + v[axis] - 1));
            }
    }
    bis_sampler p = sampler_of(BIS_SAMPLER_SOBOL, 4, 4);
    for (uint32_t pixel = 0; pixel < 20; pixel++) {
        points_of(&p, pixel, 0, 0, 2, set);
        set_off = fmax(set_off, fabs(set[0][0] + set[1][0] - 1));
    }
    assert_true(off[BIS_SAMPLER_SOBOL] <= 0x1p-31);
    assert_true(off[BIS_SAMPLER_RANDOM] > 0.1 && off[BIS_SAMPLER_STRATIFIED] > 0.1 && off[BIS_SAMPLER_HALTON] > 0.1);
    assert_true(set_off > 0.1);
}

/* Samples 4k to 4k + 3 mirror each other within halves, too: in the left half of the pixel lie two of them, which are
 * as far from its middle, on either side; likewise in each half by the other axis. */
static void four_sobol_camera_samples_mirror_each_other_within_halves(void **state)
{
    bis_sampler p = sampler_of(BIS_SAMPLER_SOBOL, 4, 4);
    for (uint32_t pixel = 0; pixel < 20; pixel++)
        for (uint32_t first = 0; first < 64; first += 4) {
            double u[4][2];
            for (uint32_t i = 0; i < 4; i++)
                camera_of(&p, pixel, first + i, u[i]);
            for (int axis = 0; axis < 2; axis++) {
                double low = 0, high = 0;
                for (int i = 0; i < 4; i++)
                    *(u[i][axis] < 0.5 ? &low : &high) += u[i][axis];
                assert_true(fabs(low - 0.5) <= 0x1p-31 && fabs(high - 1.5) <= 0x1p-31);
            }
        }
}

static void halton_sets_have_one_point_in_each_box_of_2_to_the_a_by_3_to_the_b(void **state)
{
    static double u[MAX_POINTS][2];
    const uint32_t powers[][2] = {{1, 1}, {8, 1}, {1, 9}, {8, 9}, {16, 27}, {4, 243}, {256, 3}};
    bis_sampler p = sampler_of(BIS_SAMPLER_HALTON, 3, 3);
    for (int i = 0; i < 7; i++)
        for (uint32_t sample = 0; sample < 12; sample++) {
            uint32_t n = powers[i][0] * powers[i][1];
            points_of(&p, 17, sample, 3, n, u);
            assert_true(one_in_each_box(u, n, powers[i][0], powers[i][1]));
        }
}

static void halton_sets_of_a_pixel_fill_the_boxes_together(void **state)
{
    static double u[MAX_POINTS][2];
    bis_sampler p = sampler_of(BIS_SAMPLER_HALTON, 4, 9);
    for (uint32_t sample = 0; sample < 36; sample++)
        points_of(&p, 19, sample, 0, 36, u + 36 * sample);
    assert_true(one_in_each_box(u, 36 * 36, 16, 81));
    for (uint32_t sample = 0; sample < 36; sample++)
        camera_of(&p, 19, sample, u[sample]);
    assert_true(one_in_each_box(u, 6, 2, 3));
    assert_true(one_in_each_box(u, 36, 4, 9));
}

/* Where on Hilbert's curve a point lies, by halving the curve's cells: another road than bis_curve_hilbert's. */
static double hilbert_parameter(double x, double y)
{
    double t = 0, size = 1;
    for (int level = 0; level < 26; level++) {
        int right = x >= 0.5, up = y >= 0.5, quarter = right ? 3 - up : up;
        double a = 2 * x - right, b = 2 * y - up;
        size /= 4;
        t += quarter * size;
        x = quarter == 0 ? b : quarter == 3 ? 1 - b : a;
        y = quarter == 0 ? a : quarter == 3 ? 1 - a : b;
    }
    return t;
}

static void stratified_sets_have_one_point_in_each_nth_of_hilberts_curve_in_order(void **state)
{
    static double u[MAX_POINTS][2];
    bis_sampler p = sampler_of(BIS_SAMPLER_STRATIFIED, 4, 4);
    const uint32_t sizes[] = {1, 2, 3, 7, 15, 16, 101, 800, 1024, 4096};
    for (int k = 0; k < 10; k++)
        for (uint32_t sample = 0; sample < 3; sample++) {
            uint32_t n = sizes[k];
            points_of(&p, 17, sample, 3, n, u);
            for (uint32_t i = 0; i < n; i++) {
                double t = hilbert_parameter(u[i][0], u[i][1]);
                /* the last level's cell is 2^-52 long; jitter may sit on its far wall */
                assert_true(t >= (double)i / n - 0x1p-51 && t < (i + 1.0) / n + 0x1p-51);
            }
        }
}

static void stratified_camera_samples_visit_each_cell_once_in_each_round(void **state)
{
    double u[21][2];
    bis_sampler p = sampler_of(BIS_SAMPLER_STRATIFIED, 7, 3);
    for (uint64_t pixel = 0; pixel < 50; pixel++)
        for (uint32_t round = 0; round < 3; round++) {
            for (uint32_t i = 0; i < 21; i++)
                camera_of(&p, pixel, 21 * round + i, u[i]);
            assert_true(one_in_each_box(u, 21, 7, 3));
        }
}

static void without_jitter_camera_samples_lie_in_the_middle(void **state)
{
    bis_sampler p = sampler_of(BIS_SAMPLER_STRATIFIED, 4, 2);
    double u[2];
    p.jitter = false;
    for (uint32_t i = 0; i < 8; i++) {
        camera_of(&p, 9, i, u);
        assert_true(fmod(u[0] * 8, 2) == 1 && fmod(u[1] * 4, 2) == 1);
    }
    p = sampler_of(BIS_SAMPLER_STRATIFIED, 1, 1);
    p.jitter = false;
    camera_of(&p, 9, 0, u);
    assert_true(u[0] == 0.5 && u[1] == 0.5);
}

/* Of 2^53 cells in a row the last one's number plus 1/2 or more is no double: it rounds up to 2^53. Digit by digit we
 * find the sample that visits it, the lowest digit first, which decides the half that it lies in. */
static void a_camera_sample_in_the_last_of_many_cells_stays_below_1(void **state)
{
    const uint64_t n = (uint64_t)1 << 53;
    stat_keep_seeds(true); /* of some seeds the search ends in another cell */
    for (uint64_t pixel = 0; pixel < 16; pixel++)
        for (int axis = 0; axis < 2; axis++) {
            const bis_sampler p = {BIS_SAMPLER_STRATIFIED, 42, n, axis ? 1 : n, axis ? n : 1, true};
            uint64_t sample = 0;
            double u[2], width = 1;
            bis_stream s;
            for (uint64_t bit = 1; bit < n; bit *= 2) {
                width /= 2;
                bis_stream_init(&s, &p, pixel, sample);
                bis_stream_camera(&s, u);
                if (u[axis] < 1 - width) sample |= bit;
            }
            bis_stream_init(&s, &p, pixel, sample);
            bis_stream_camera(&s, u);
            assert_true(u[axis] > 1 - 0x1p-48 && u[axis] < 1);
        }
    stat_keep_seeds(false);
}

/* The cell that camera sample i visits. */
static uint64_t cell_of(const bis_sampler *p, uint64_t pixel, uint64_t i)
{
    bis_stream s;
    double u[2];
    bis_stream_init(&s, p, pixel, i);
    bis_stream_camera(&s, u);
    return (uint64_t)(u[0] * (double)p->xsamples) + p->xsamples * (uint64_t)(u[1] * (double)p->ysamples);
}

static int by_number(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return x < y ? -1 : x > y;
}

/* All n samples, or the first and last of them, of orders of any length up to 2^32 and beyond. */
static void no_cell_is_visited_twice_whatever_their_number(void **state)
{
    enum { MOST = 100000 };
    static uint64_t cell[MOST];
    const uint64_t large[] = {1000,    4097,    65536,       99991,               65537,
                              1 << 20, 1000003, 4294967291u, (uint64_t)1 << 32, 4800000000u};
    for (int k = 0; k < 150 + 10; k++) {
        const uint64_t n = k < 150 ? (uint64_t)k + 1 : large[k - 150], most = n < MOST ? n : MOST;
        bis_sampler p = {.kind = BIS_SAMPLER_STRATIFIED, .seed = 42, .jitter = false};
        bis_sampler_set_spp(&p, n);
        for (uint64_t i = 0; i < most; i++) {
            cell[i] = cell_of(&p, 7, i < most / 2 ? i : n - 1 - (i - most / 2));
            assert_true(cell[i] < n);
        }
        qsort(cell, most, sizeof *cell, by_number);
        for (uint64_t i = 1; i < most; i++)
            assert_true(cell[i - 1] < cell[i]);
    }
}

/* Each of the n cells is as likely as any other for one sample. For the twin one cell in seven passes its samples on.
 */
enum { ORDER_PIXELS = 100000 };

static void check_cells(uint64_t n, uint64_t sample, bool shifted)
{
    double *observed = calloc(n, sizeof *observed), *expected = calloc(n, sizeof *expected);
    bis_sampler p = {.kind = BIS_SAMPLER_STRATIFIED, .seed = 42, .jitter = true};
    bis_sampler_set_spp(&p, n);
    for (uint64_t pixel = 0; pixel < ORDER_PIXELS; pixel++) {
        const uint64_t cell = cell_of(&p, pixel, sample);
        observed[shifted && cell % 7 == 3 ? (cell + 1) % n : cell]++;
    }
    for (uint64_t i = 0; i < n; i++) expected[i] = (double)ORDER_PIXELS / (double)n;
    if (shifted) stat_assert_no_fit("sampler_cells_twin", 42, observed, expected, n, alpha());
    else stat_assert_fit("sampler_cells", 42, observed, expected, n, alpha());
    free(observed);
    free(expected);
}

static void every_cell_is_equally_likely_for_every_sample(void **state)
{
    const uint64_t n[] = {2, 3, 4, 5, 6, 7, 9, 13, 16, 21, 33, 36, 64, 100, 1000};
    for (int k = 0; k < 15; k++) {
        check_cells(n[k], 0, false);
        check_cells(n[k], 1, false);
        check_cells(n[k], n[k] - 1, false);
    }
    check_cells(36, 0, true);
}

/* The cells of `count` samples from `first` on lie in as many different boxes of 8 x 8 cells cut into across x down. */
static bool is_spread(const uint64_t cell[64], uint64_t first, uint64_t count, uint64_t across, uint64_t down)
{
    uint64_t seen = 0;
    for (uint64_t i = first; i < first + count; i++) {
        const uint64_t x = cell[i] % 8 * across / 8, y = cell[i] / 8 * down / 8;
        seen |= (uint64_t)1 << (y * across + x);
    }
    return seen == (count == 64 ? ~(uint64_t)0 : ((uint64_t)1 << count) - 1);
}

/* Halves of the samples interleave (film_error.c): each aligned block of 2, 4, 8, 16, 32 of 64 samples has one in each
 * half, quarter, ... of the pixel. An order at random is spread so with probability 4! / 4^4 already for four samples:
 * never in 16 blocks. */
static void the_halves_of_the_camera_samples_interleave(void **state)
{
    enum { PIXELS = 400 };
    int spread = 0, twin = 0;
    bis_sampler p = sampler_of(BIS_SAMPLER_STRATIFIED, 8, 8);
    for (uint64_t pixel = 0; pixel < PIXELS; pixel++) {
        uint64_t cell[64], mixed[64];
        bool good = true, twin_good = true;
        for (uint64_t i = 0; i < 64; i++) cell[i] = cell_of(&p, pixel, i);
        for (uint64_t i = 0; i < 64; i++)
            mixed[i] = cell[i * 19 % 64 / 2 + i % 2 * 32]; /* another order of the same cells */
        for (uint64_t k = 1; k <= 5; k++)
            for (uint64_t first = 0; first < 64; first += (uint64_t)1 << k) {
                const uint64_t across = (uint64_t)1 << (k + 1) / 2, down = (uint64_t)1 << k / 2;
                good = good && is_spread(cell, first, (uint64_t)1 << k, across, down);
                twin_good = twin_good && is_spread(mixed, first, (uint64_t)1 << k, across, down);
            }
        spread += good;
        twin += twin_good;
    }
    if (!(spread == PIXELS && twin == 0)) fail_msg("spread %d, twin %d of %d", spread, twin, PIXELS);
}

/* ---- independent, set by set ---- */

static void the_same_point_of_neighbouring_pixels_and_dims_is_independent(void **state)
{
    const uint32_t pixels = 100000;
    for (int kind = 0; kind < KINDS; kind++) {
        bis_sampler p = sampler_of((bis_sampler_kind)kind, 3, 2);
        double by_pixel[CELLS], by_dim[CELLS], by_sample[CELLS], expected[CELLS], u[2][2], v[2][2];
        clear(by_pixel, expected, pixels);
        clear(by_dim, expected, pixels);
        clear(by_sample, expected, pixels);
        for (uint32_t pixel = 0; pixel < pixels; pixel++) {
            points_of(&p, pixel, 4, 0, 1, u);
            points_of(&p, pixel + 1, 4, 0, 1, v);
            count(by_pixel, u[0][0], v[0][0]);
            points_of(&p, pixel, 4, 1, 1, v);
            count(by_dim, u[0][0], v[0][0]);
            camera_of(&p, pixel, 4, v[0]);
            count(by_sample, u[0][1], v[0][1]);
        }
        stat_assert_fit("sampler_pixels", 42, by_pixel, expected, CELLS, alpha());
        stat_assert_fit("sampler_dims", 42, by_dim, expected, CELLS, alpha());
        stat_assert_fit("sampler_camera", 42, by_sample, expected, CELLS, alpha());
    }
}

/* Root mean square, over pixels, of the mean of sin(2 pi x) sin(2 pi y) over the samples of a pixel: x of one set, y of
 * another. It vanishes if they fill the square, and is 1/2 if x tells y. */
typedef double (*coordinate_fn)(const bis_sampler *p, uint64_t pixel, uint32_t sample);

static double dependence(const bis_sampler *p, coordinate_fn x, coordinate_fn y)
{
    const int pixels = 200;
    const double turn = 2 * acos(-1);
    double square = 0;
    for (uint64_t pixel = 0; pixel < (uint64_t)pixels; pixel++) {
        double sum = 0;
        for (uint32_t i = 0; i < p->spp; i++)
            sum += sin(turn * x(p, pixel, i)) * sin(turn * y(p, pixel, i));
        square += sum / (double)p->spp * sum / (double)p->spp / pixels;
    }
    return sqrt(square);
}

static double of_dim_0(const bis_sampler *p, uint64_t pixel, uint32_t sample)
{
    double u[1][2];
    points_of(p, pixel, sample, 0, 1, u);
    return u[0][0];
}

static double of_dim_1(const bis_sampler *p, uint64_t pixel, uint32_t sample)
{
    double u[1][2];
    points_of(p, pixel, sample, 1, 1, u);
    return u[0][0];
}

static double of_camera(const bis_sampler *p, uint64_t pixel, uint32_t sample)
{
    double u[2];
    camera_of(p, pixel, sample, u);
    return u[0];
}

static double of_another_pixels_camera(const bis_sampler *p, uint64_t pixel, uint32_t sample)
{
    return of_camera(p, pixel + 1000, sample);
}

/* The error of a mean over two dims falls as for random numbers, sqrt(1/4 / spp); Burley's order pairs neighbours two
 * by two, so we grant twice the variance and 4 standard errors of the rms of 200. Scrambling alone does not do it: see
 * the twin, two scramblings of one sequence in the same order, as halton's camera samples of two pixels are. */
static void two_dims_of_one_pixel_fill_the_square_together(void **state)
{
    const double limit = sqrt(2 * 0.25 / 1024) * (1 + 4 / sqrt(2 * 200));
    for (int kind = 0; kind < KINDS; kind++) {
        bis_sampler p = sampler_of((bis_sampler_kind)kind, 32, 32);
        assert_true(dependence(&p, of_dim_0, of_dim_1) < limit);
        assert_true(dependence(&p, of_dim_0, of_camera) < limit);
    }
    bis_sampler p = sampler_of(BIS_SAMPLER_HALTON, 32, 32);
    assert_true(dependence(&p, of_camera, of_another_pixels_camera) > 4 * limit);
}

/* ---- what it is good for ---- */

static double rms_error(bis_sampler_kind kind, uint32_t n, int runs)
{
    static double u[MAX_POINTS][2];
    bis_sampler p = sampler_of(kind, 4, 4);
    double square = 0, exact = (exp(1) - 1) * (exp(1) - 1);
    for (int run = 0; run < runs; run++) {
        double sum = 0;
        points_of(&p, (uint64_t)run, 0, 0, n, u);
        for (uint32_t i = 0; i < n; i++)
            sum += exp(u[i][0] + u[i][1]);
        square += (sum / n - exact) * (sum / n - exact) / runs;
    }
    return sqrt(square);
}

/* Error by the number of points, for a smooth integrand, between N = 64 and N = 4096: N^-1/2 at random, N^-1 stratified
 * by cells, N^-3/2 scrambled nets (Owen 1997), of which sobol's sets are one and halton's a sum of log N; the random
 * one by its variance, in closed form. */
static void the_error_falls_with_the_exponent_of_its_kind(void **state)
{
    const double exponent[KINDS] = {-0.5, -1, -1.5, -1};
    const double e = exp(1), variance = pow((e * e - 1) / 2, 2) - pow(e - 1, 4);
    for (int kind = 0; kind < KINDS; kind++) {
        double coarse = rms_error((bis_sampler_kind)kind, 64, 400), fine = rms_error((bis_sampler_kind)kind, 4096, 400);
        double slope = log(fine / coarse) / log(64);
        if (fabs(slope - exponent[kind]) > 0.2)
            fail_msg("%s: slope %g", bis_sampler_name((bis_sampler_kind)kind), slope);
        if (kind == BIS_SAMPLER_RANDOM)
            assert_true(fabs(fine / sqrt(variance / 4096) - 1) < 0.15); /* 4 standard errors */
    }
}

/* ---- as a function ---- */

static void a_set_depends_on_its_coordinates_and_not_on_what_was_drawn_before(void **state)
{
    for (int kind = 0; kind < KINDS; kind++) {
        bis_sampler p = sampler_of((bis_sampler_kind)kind, 4, 4);
        bis_stream s;
        double first[5][2], again[5][2], other[5][2];
        points_of(&p, 3, 7, 2, 5, first);
        bis_stream_init(&s, &p, 3, 7);
        bis_stream_random(&s);
        bis_stream_camera(&s, other[0]);
        bis_stream_points(&s, 1, 5, other);
        bis_stream_points(&s, 2, 5, again);
        assert_memory_equal(first, again, sizeof first);
        assert_memory_not_equal(first, other, sizeof first);
        points_of(&p, 3, 7 + 16, 2, 5, other); /* beyond spp: fresh */
        assert_memory_not_equal(first, other, sizeof first);
        p.seed++;
        points_of(&p, 3, 7, 2, 5, other);
        assert_memory_not_equal(first, other, sizeof first);
    }
}

/* Each run of 2^32 points is a sequence: it fills the boxes by itself, and no point of it is that of another run. (The
 * first of Halton's has too few digits for that, because one sample was foretold.) */
static void after_2_to_the_32_points_a_sequence_is_new(void **state)
{
    enum { RUNS = 4, N = 36 };
    double u[RUNS][N][2];
    for (int kind = BIS_SAMPLER_SOBOL; kind <= BIS_SAMPLER_HALTON; kind++) {
        const bis_sampler p = {.kind = (bis_sampler_kind)kind, .seed = 42, .spp = 1};
        for (uint64_t run = 0; run < RUNS; run++) {
            for (uint64_t i = 0; i < N; i++) {
                bis_stream s;
                bis_stream_init(&s, &p, 17, run << 32 | i);
                bis_stream_points(&s, 3, 1, &u[run][i]);
                for (uint64_t other = 0; other < run; other++)
                    for (int k = 0; k < 2; k++) assert_true(fabs(u[run][i][k] - u[other][i][k]) > 1e-8);
            }
            if (kind == BIS_SAMPLER_SOBOL) assert_true(is_net_in_base_2(u[run], 32));
            else if (run > 0) assert_true(one_in_each_box(u[run], 36, 4, 9));
        }
    }
}

static void the_last_sample_of_2_to_the_32_is_still_a_net(void **state)
{
    static double u[1024][2];
    bis_sampler p = sampler_of(BIS_SAMPLER_SOBOL, 4, 4);
    points_of(&p, 3, UINT32_MAX, 0, 1024, u); /* index 2^42 - 1024 ... 2^42 - 1 */
    assert_true(is_net_in_base_2(u, 1024));
    p.kind = BIS_SAMPLER_HALTON;
    points_of(&p, 3, UINT32_MAX, 0, 512, u);
    assert_true(one_in_each_box(u, 512, 512, 1));
}

static void kinds_have_their_names_and_sobol_and_halton_are_low_discrepancy(void **state)
{
    const char *const names[] = {"random", "stratified", "sobol", "halton"};
    for (int kind = 0; kind < KINDS; kind++) {
        assert_string_equal(bis_sampler_name((bis_sampler_kind)kind), names[kind]);
        assert_true(bis_sampler_is_low_discrepancy((bis_sampler_kind)kind) == (kind >= 2));
    }
}

/* Camera samples of an outline number up to 1024 times 10^9. The factors, by multiplication; and sample 2^32 + k is not
 * sample k again. */
static void camera_samples_are_counted_beyond_32_bits(void **state)
{
    static const uint64_t spp[] = {
        (uint64_t)1 << 32, 4800000000u, 1024 * UINT64_C(1000000000), 6 * UINT64_C(715827883)};
    static const uint64_t ysamples[] = {65536, 64000, 1000000, 6}; /* the last: 6 times a prime */

    for (int kind = 0; kind < 4; kind++) {
        for (int i = 0; i < 4; i++) {
            bis_sampler s = {.kind = (bis_sampler_kind)kind, .seed = 42, .jitter = true};
            bis_stream near, far;
            double a[2], b[2];
            bis_sampler_set_spp(&s, spp[i]);
            assert_true(s.spp == spp[i] && s.xsamples * s.ysamples == spp[i]);
            assert_true(s.ysamples == ysamples[i]);
            bis_stream_init(&near, &s, 3, 7);
            bis_stream_init(&far, &s, 3, 7 + ((uint64_t)1 << 32));
            bis_stream_camera(&near, a);
            bis_stream_camera(&far, b);
            assert_true(a[0] != b[0] && a[1] != b[1]);
            assert_true(b[0] >= 0 && b[0] < 1 && b[1] >= 0 && b[1] < 1);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(camera_samples_are_counted_beyond_32_bits),
        cmocka_unit_test(every_point_of_every_kind_is_uniform_over_the_pixels),
        cmocka_unit_test(every_kind_has_53_fair_bits),
        cmocka_unit_test(sobol_sets_of_2_to_the_k_points_are_nets),
        cmocka_unit_test(sobol_sets_of_successive_samples_continue_each_other),
        cmocka_unit_test(any_prefix_of_2_to_the_k_sobol_camera_samples_is_a_net),
        cmocka_unit_test(sobol_camera_samples_come_in_pairs_that_mirror_each_other),
        cmocka_unit_test(four_sobol_camera_samples_mirror_each_other_within_halves),
        cmocka_unit_test(halton_sets_have_one_point_in_each_box_of_2_to_the_a_by_3_to_the_b),
        cmocka_unit_test(halton_sets_of_a_pixel_fill_the_boxes_together),
        cmocka_unit_test(stratified_sets_have_one_point_in_each_nth_of_hilberts_curve_in_order),
        cmocka_unit_test(stratified_camera_samples_visit_each_cell_once_in_each_round),
        cmocka_unit_test(without_jitter_camera_samples_lie_in_the_middle),
        cmocka_unit_test(a_camera_sample_in_the_last_of_many_cells_stays_below_1),
        cmocka_unit_test(no_cell_is_visited_twice_whatever_their_number),
        cmocka_unit_test(every_cell_is_equally_likely_for_every_sample),
        cmocka_unit_test(the_halves_of_the_camera_samples_interleave),
        cmocka_unit_test(the_same_point_of_neighbouring_pixels_and_dims_is_independent),
        cmocka_unit_test(two_dims_of_one_pixel_fill_the_square_together),
        cmocka_unit_test(the_error_falls_with_the_exponent_of_its_kind),
        cmocka_unit_test(a_set_depends_on_its_coordinates_and_not_on_what_was_drawn_before),
        cmocka_unit_test(after_2_to_the_32_points_a_sequence_is_new),
        cmocka_unit_test(the_last_sample_of_2_to_the_32_is_still_a_net),
        cmocka_unit_test(kinds_have_their_names_and_sobol_and_halton_are_low_discrepancy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
