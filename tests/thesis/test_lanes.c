/* SPDX-License-Identifier: BSD-2-Clause */
/* lanes: functions against the C library in long double, points against Hilbert's curve by another road, pixels against
 * the direction that they were found for, and the same bits from every instruction set. Family-wise significance 1e-3
 * over all statistical tests here. */
#include "thesis/light_many.h"
#include "thesis/curve_many.h"
#include "bis/thesis/lanes.h"

#include "bis/base/curve.h"
#include "bis/base/mem.h"
#include "bis/thesis/rng.h"
#include "bis/base/stats.h"
#include "bis/thesis/warp.h"
#include "bis/base/xform.h"
#include "bis/thesis/cone.h"
#include "bis/thesis/envmap.h"
#include "claim.h"
#include "clones.h"
#include "lit.h"
#include "map_help.h"
#include "stat.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { SEED = 4711 };

/* uniform: 2 claims for each of 7 sizes, and 2 twins; gaps: 2 claims, 2 twins */
static double alpha(void) { return stat_level(1e-3, 2 * 7 + 2); }

/* ---- functions ---- */

/* The largest error over floats from `first` to `last` (>= 0), every `step`-th of them and all of the last thousand:
 * relative to the truth, or absolute. Where the truth is 0, an error is infinite in relation to it. */
static double worst(
    float (*f)(float), long double (*truth)(long double), float first, float last, int step, bool relative)
{
    const int32_t end = bis_bits_of_float(last);
    double most = 0;

    for (int32_t bits = bis_bits_of_float(first); bits <= end; bits += end - bits > 1000 ? step : 1) {
        const float x = bis_float_of_bits(bits);
        const long double t = truth((long double)x), error = fabsl((long double)f(x) - t);
        if (error == 0) continue;
        most = fmax(most, (double)(relative ? error / fabsl(t) : error));
        if (isnan(error)) return (double)NAN;
    }
    return most;
}

static void assert_within(const char *name, double error, double bound)
{
    print_message("%-32s %.3g, stated %.3g\n", name, error, bound);
    if (!(error < bound)) fail_msg("%s: error %.4g, stated %.4g", name, error, bound);
}

static const float below_1 = 0x1.fffffep-1f;

static float log1m(float x) { return bis_lanes_log1m(x); }
static float log1m_off(float x) { return log1m(x) - 1e-5f * x * x * x; } /* 0.33332 in place of 1/3 */
static long double true_log1m(long double x) { return log1pl(-x); }

static void log_of_1_minus_x_is_good_to_2_to_the_minus_22_down_to_x_0(void **state)
{
    assert_within("log1m", worst(log1m, true_log1m, 0, below_1, 997, true), 0x1p-22);
    assert_within("log1m near the change of exponent", worst(log1m, true_log1m, 0.28f, 0.31f, 1, true), 0x1p-22);
    assert_true(log1m(0) == 0);
    assert_true(log1m(FLT_TRUE_MIN) == -FLT_TRUE_MIN && log1m(FLT_MIN) == -FLT_MIN);
    assert_true(worst(log1m_off, true_log1m, 0, below_1, 997, true) >= 0x1p-22);
}

/* e^-x, so that arguments are positive. */
static float exp_minus(float x) { return bis_lanes_exp(-x); }
static long double true_exp_minus(long double x) { return expl(-x); }
static float one_minus_exp_minus(float x) { return bis_lanes_1mexp(-x); }
static long double true_one_minus_exp_minus(long double x) { return -expm1l(-x); }

/* 0.50001 in place of 1/2. */
static float exp_minus_off(float x)
{
    const double k = rint((double)-x / M_LN2), r = (double)-x - k * M_LN2;
    return exp_minus(x) + (float)(1e-5 * r * r * exp2(k));
}
static float one_minus_exp_minus_off(float x) { return one_minus_exp_minus(x) + 1e-5f * fminf(x * x, 0.1f); }

static void exp_is_good_to_2_to_the_minus_22_and_never_below_2_to_the_minus_64(void **state)
{
    static const float beyond[] = {44.361421f, 45, 1e3f, 1e30f, FLT_MAX};

    assert_within("exp", worst(exp_minus, true_exp_minus, 0, 44.3614f, 997, true), 0x1p-22);
    assert_true(bis_lanes_exp(0) == 1 && bis_lanes_exp(-0.0f) == 1 && bis_lanes_exp(-FLT_TRUE_MIN) == 1);
    for (int i = 0; i < 5; i++)
        assert_true(fabs((double)exp_minus(beyond[i]) * 0x1p64 - 1) < 0x1p-17); /* 64 ln 2 as a float */
    assert_true(worst(exp_minus_off, true_exp_minus, 0, 44.3614f, 997, true) >= 0x1p-22);
}

static void one_minus_exp_is_good_to_2_to_the_minus_22_down_to_0(void **state)
{
    assert_within("1mexp", worst(one_minus_exp_minus, true_one_minus_exp_minus, 0, 44.3614f, 997, true), 0x1p-22);
    assert_true(bis_lanes_1mexp(-0.0f) == 0 && bis_lanes_1mexp(-FLT_MAX) == 1 &&
                one_minus_exp_minus(FLT_TRUE_MIN) == FLT_TRUE_MIN);
    assert_true(worst(one_minus_exp_minus_off, true_one_minus_exp_minus, 0, 44.3614f, 997, true) >= 0x1p-22);
}

static float sine(float u)
{
    float s, c;
    bis_lanes_sincos2pi(u, &s, &c);
    return s;
}
static float cosine(float u)
{
    float s, c;
    bis_lanes_sincos2pi(u, &s, &c);
    return c;
}
static const long double pi = 3.14159265358979323846L;
static long double true_sine(long double u) { return sinl(2 * pi * u); }
static long double true_cosine(long double u) { return cosl(2 * pi * u); }
static float left(float u) { return 4 * u - rintf(4 * u); } /* of a quarter turn */
static float sine_off(float u) { return sine(u) + 1e-5f * powf(left(u) * 1.57f, 5); }
static float cosine_off(float u) { return cosine(u) + 1e-5f * powf(left(u) * 1.57f, 4); }

static void sine_and_cosine_are_good_to_2_to_the_minus_22(void **state)
{
    assert_within("sine", worst(sine, true_sine, 0, below_1, 997, false), 0x1p-22);
    assert_within("sine, evenly", worst(sine, true_sine, 0.125f, below_1, 17, false), 0x1p-22);
    assert_within("cosine", worst(cosine, true_cosine, 0, below_1, 997, false), 0x1p-22);
    assert_within("cosine, evenly", worst(cosine, true_cosine, 0.125f, below_1, 17, false), 0x1p-22);
    for (int quarter = 0; quarter < 4; quarter++) {
        assert_true(sine((float)quarter / 4) == (float)(quarter % 2 ? 2 - quarter : 0));
        assert_true(cosine((float)quarter / 4) == (float)(quarter % 2 ? 0 : 1 - quarter));
    }
    assert_true(worst(sine_off, true_sine, 0.125f, below_1, 997, false) >= 0x1p-22);
    assert_true(worst(cosine_off, true_cosine, 0.125f, below_1, 997, false) >= 0x1p-22);
}

static float atan2_off(float y, float x)
{
    const float a = fminf(fabsf(x), fabsf(y)) / fmaxf(fabsf(x), fabsf(y));
    return bis_lanes_atan2(y, x) + 1e-5f * a * a * a;
}

/* All round, at radius r; every denormal has few directions, so the truth is that of the floats. */
static double worst_atan2(float (*f)(float, float), double r, int n)
{
    double most = 0;

    for (int i = 0; i <= n; i++) {
        const double phi = 2 * PI * i / n;
        const float y = (float)(r * sin(phi)), x = (float)(r * cos(phi));
        most = fmax(
            most, (double)fabsl(remainderl((long double)f(y, x) - atan2l((long double)y, (long double)x), 2 * pi)));
    }
    return most;
}

static void atan2_is_good_to_4e_7_at_every_radius_and_on_the_axes(void **state)
{
    static const double radii[] = {1, 3e-3, 1e-30, 1e-38, 1e-44, 1e30, 3e38};
    const float h = 1.57079633f, p = 3.14159265f, least = FLT_TRUE_MIN;

    for (int i = 0; i < 7; i++)
        assert_within("atan2", worst_atan2(bis_lanes_atan2, radii[i], i ? 10000 : 1000000), 4e-7);
    assert_true(bis_lanes_atan2(0, 1) == 0 && bis_lanes_atan2(1, 0) == h && bis_lanes_atan2(0, -1) == p &&
                bis_lanes_atan2(-1, 0) == -h);
    assert_true(bis_lanes_atan2(0, 0) == 0 && bis_lanes_atan2(-0.0f, 0) == 0 && bis_lanes_atan2(0, -0.0f) == 0);
    assert_true(bis_lanes_atan2(-0.0f, -1) == p); /* the C library says -pi: the same direction */
    assert_true(
        bis_lanes_atan2(least, -1) == p && bis_lanes_atan2(-least, -1) == -p && bis_lanes_atan2(-1, least) == -h);
    assert_true(worst_atan2(atan2_off, 1, 10000) >= 4e-7);
}

/* ---- cones ---- */

/* cos max(0, theta - a) for a cone with the half angle a, theta from its axis: never too small, not even where the axes
 * are parallel or opposite and a is nearly a right angle, and never above 1. The square of the sine of theta has up to
 * 2^-19 too much, so the root has 2^-20/sine or 2^-9, whichever is less; that times sin a and 2^-19 may be too much. */
static void the_largest_cosine_of_a_cone_is_that_of_its_nearest_direction(void **state)
{
    bis_rng r;
    bis_rng_init(&r, SEED, 9, 0, 0);
    for (int i = 0; i < 20000; i++) {
        const frame f = frame_about(bis_warp_sphere(bis_rng_double(&r), bis_rng_double(&r)));
        const bool is_opposite = i % 4 == 3;
        const double half = is_opposite ? PI / 2 - 2e-3 * bis_rng_double(&r)
                            : i % 10    ? PI * bis_rng_double(&r)
                                        : 1e-3 * bis_rng_double(&r),
                     theta = is_opposite ? PI - 2e-3 * bis_rng_double(&r)
                             : i % 7     ? PI * bis_rng_double(&r)
                                         : half * (0.9 + 0.2 * (i % 2)),
                     phi = 2 * PI * i / 64;
        const vec3 c = to_world(&f, vec3_from(sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)));
        const double angle = atan2(length(cross(c, f.z)), dot(c, f.z)), expected = cos(fmax(0, angle - half));
        const float found = bis_cone_cosine(f.z, c.x, c.y, c.z, (float)cos(half), (float)sin(half));
        const double slack = sin(half) * fmin(0x1p-9, 0x1p-20 / sin(angle));
        if (!((double)found >= expected && (double)found <= fmin(1, expected + 0x1p-19 + slack)))
            fail_msg("half angle %g, axis at %g: %.8g, must be %.8g", half, angle, (double)found, expected);
    }
    assert_true(bis_cone_cosine((vec3){0, 0, 1}, 0, 0, 1, 0.5f, sqrtf(0.75f)) == 1);
    assert_true(bis_cone_cosine((vec3){0, 0, 1}, 0, 1, 0, 1, 0) == 0x1p-20f); /* a ray across */
}

/* Array after array, n numbers each. */
static void the_arrays_of_lanes_and_cones_lie_one_after_the_other(void **state)
{
    static const uint32_t counts[][2] = {{0, 0}, {1, 1}, {15, 1}, {16, 1}, {17, 2}, {32, 2}, {33, 3}, {1000, 63}};
    float memory[BIS_CONES_ARRAYS * 32];
    const bis_lanes l = bis_lanes_in(memory, 32);
    const bis_cones c = bis_cones_in(memory, 32);
    const float *const lanes[] = {l.x, l.y, l.z, l.r, l.g, l.b, l.q},
                *const cones[] = {c.x, c.y, c.z, c.cosine, c.sine, c.r, c.g, c.b};
    for (int i = 0; i < 7; i++) assert_ptr_equal(lanes[i], memory + 32 * i);
    for (int i = 0; i < 8; i++) assert_ptr_equal(cones[i], memory + 32 * i);
    assert_true(sizeof lanes / sizeof *lanes == BIS_LANES_ARRAYS && sizeof cones / sizeof *cones == BIS_CONES_ARRAYS);
    for (int i = 0; i < 8; i++) {
        assert_int_equal(bis_lanes_blocks(counts[i][0]), counts[i][1]);
        assert_int_equal(bis_lanes_round_up(counts[i][0]), 16 * counts[i][1]);
    }
}

/* ---- points ---- */

enum { LEVELS = 12, SIDE = 1 << LEVELS, CELLS = SIDE * SIDE };

/* The cell's number on Hilbert's curve: quadrant by quadrant from the largest, turning the square so that each begins
 * at its lower left. */
static uint32_t place_on_curve(uint32_t x, uint32_t y)
{
    uint32_t d = 0;

    for (uint32_t s = SIDE / 2; s; s /= 2) {
        const uint32_t right = (x & s) > 0, up = (y & s) > 0;
        d += s * s * ((3 * right) ^ up);
        x &= s - 1;
        y &= s - 1;
        if (up) continue;
        if (right) {
            x = s - 1 - x;
            y = s - 1 - y;
        }
        const uint32_t swap = x;
        x = y;
        y = swap;
    }
    return d;
}

static uint32_t cell_of(float u1, float u2) { return place_on_curve((uint32_t)(u1 * SIDE), (uint32_t)(u2 * SIDE)); }

/* What the points are for: the curve is the same as that of bis_curve_hilbert. */
static void the_curve_of_these_tests_is_that_of_curve(void **state)
{
    bis_rng r;

    bis_rng_init(&r, SEED, 0, 0, 0);
    for (int i = 0; i < 10000; i++) {
        const double t = bis_rng_double(&r);
        double u[2];
        bis_curve_hilbert(t, u);
        assert_int_equal(place_on_curve((uint32_t)(u[0] * SIDE), (uint32_t)(u[1] * SIDE)), (uint32_t)(t * CELLS));
    }
}

static const uint32_t sizes[] = {1, 2, 3, 16, 17, 33, 50, 64, 100, 800, 10007, 1 << 14};
enum { N_SIZES = sizeof sizes / sizeof *sizes, LARGEST = 1 << 14 };

/* Points that are not, within a cell, in their n-th of the curve. */
static uint32_t strays(const float *u1, const float *u2, uint32_t n, uint32_t n_strata)
{
    uint32_t count = 0;

    for (uint32_t i = 0; i < n; i++) {
        const double t = cell_of(u1[i], u2[i]), first = (double)CELLS * i / n_strata,
                     end = (double)CELLS * (i + 1) / n_strata;
        count += !(t > first - 1.5 && t < end + 0.5);
    }
    return count;
}

static void one_point_lies_in_each_nth_of_the_curve_in_its_order(void **state)
{
    float *u = bis_alloc(2 * LARGEST, sizeof *u);

    for (int k = 0; k < N_SIZES; k++) {
        for (uint64_t key = 0; key < 20; key++) {
            bis_curve_points(u, u + LARGEST, sizes[k], key);
            assert_int_equal(strays(u, u + LARGEST, sizes[k], sizes[k]), 0);
            if (sizes[k] >= 16) assert_true(strays(u, u + LARGEST, sizes[k], sizes[k] + 1) > 0); /* twin */
        }
    }
    bis_free(u);
}

static void points_are_a_function_of_the_key_and_fill_the_last_block_and_no_more(void **state)
{
    float a[2][48], b[2][48];

    for (uint32_t n = 1; n <= 32; n++) {
        const uint32_t end = bis_lanes_round_up(n);
        assert_true(end % 16 == 0 && end >= n && end < n + 16);
        for (int i = 0; i < 48; i++) a[0][i] = a[1][i] = b[0][i] = b[1][i] = -1;
        bis_curve_points(a[0], a[1], n, 5);
        bis_curve_points(b[0], b[1], n, 5);
        assert_memory_equal(a, b, sizeof a);
        for (uint32_t i = 0; i < 48; i++) {
            for (int j = 0; j < 2; j++) {
                assert_true(i < end ? a[j][i] >= 0 && a[j][i] < 1 && a[j][i] * 0x1p24f == floorf(a[j][i] * 0x1p24f)
                                    : a[j][i] == -1);
            }
        }
        bis_curve_points(b[0], b[1], n, 6);
        assert_memory_not_equal(a, b, sizeof *a);
    }
}

enum { BINS = 16, DRAWS = 100000 };

/* One point, chosen at random, of each set: independent draws. In the square, and inside its 12-bit cell. */
static void count_points(double *square, double *inside, uint32_t n)
{
    static float u1[LARGEST], u2[LARGEST];
    bis_rng r;

    bis_rng_init(&r, SEED, n, 0, 1);
    for (uint32_t k = 0; k < DRAWS; k++) {
        bis_curve_points(u1, u2, n, bis_rng_u64(&r));
        const uint32_t i = (uint32_t)bis_rng_below(&r, n);
        const float x = u1[i] * SIDE - floorf(u1[i] * SIDE), y = u2[i] * SIDE - floorf(u2[i] * SIDE);
        square[(int)(u1[i] * BINS) * BINS + (int)(u2[i] * BINS)]++;
        inside[(int)(x * BINS) * BINS + (int)(y * BINS)]++;
    }
}

static void points_are_uniform_in_the_square_and_inside_the_last_cells(void **state)
{
    static const uint32_t n[] = {1, 2, 3, 5, 16, 17, 33};
    double expected[BINS * BINS], half[BINS * BINS];

    for (int i = 0; i < BINS * BINS; i++) {
        expected[i] = (double)DRAWS / (BINS * BINS);
        half[i] = expected[i] * (i % 2 ? 1.06 : 0.94);
    }
    for (int k = 0; k < 7; k++) {
        double square[BINS * BINS] = {0}, inside[BINS * BINS] = {0};
        count_points(square, inside, n[k]);
        stat_assert_fit("lanes-square", SEED, square, expected, BINS * BINS, alpha());
        stat_assert_fit("lanes-inside", SEED, inside, expected, BINS * BINS, alpha());
        if (k) continue;
        stat_assert_no_fit(
            "lanes-square-uneven", SEED, square, half, BINS * BINS, alpha()); /* twins: every second cell 6 % less */
        stat_assert_no_fit("lanes-inside-uneven", SEED, inside, half, BINS * BINS, alpha());
    }
}

/* Twin: (i + u)/n in float. Where i >= 2^k, i + u has 23 - k bits left for u: of the 2^24/n cells of a part, up to half
 * are never drawn. */
static uint32_t rounded_cell(uint32_t i, uint32_t n, bis_rng *r)
{
    const float u = (float)(bis_rng_u64(r) >> 40) * 0x1p-24f, t = ((float)i + u) * (1 / (float)n);
    return (uint32_t)(t * 0x1p24f);
}

/* How often a cell of the n-ths from `first` on was drawn, in `sets` sets; the chi-square of that, with as many cells
 * as degrees of freedom. */
static double dispersion(uint32_t n, uint32_t first, uint32_t sets, bool twin, double *dof)
{
    const uint32_t start = (uint32_t)ceil((double)CELLS * first / n), size = CELLS - start;
    uint16_t *times = bis_alloc(size, sizeof *times);
    float *u = bis_alloc(2 * LARGEST, sizeof *u);
    const double expected = (double)sets * n / CELLS;
    double sum = 0;
    bis_rng r;

    bis_rng_init(&r, SEED, n, 0, 2);
    for (uint32_t k = 0; k < sets; k++) {
        if (!twin) bis_curve_points(u, u + LARGEST, n, bis_rng_u64(&r));
        for (uint32_t i = first; i < n; i++) {
            const uint32_t cell = twin ? rounded_cell(i, n, &r) : cell_of(u[i], u[LARGEST + i]);
            if (cell >= start && cell < CELLS) times[cell - start]++;
        }
    }
    for (uint32_t i = 0; i < size; i++) sum += ((double)times[i] - expected) * ((double)times[i] - expected) / expected;
    bis_free(times);
    bis_free(u);
    *dof = size;
    return sum;
}

/* Poisson counts of small mean m have a chi-square of mean dof and variance dof (2 + 1/m). */
static void assert_gaps(uint32_t n, uint32_t first, uint32_t sets)
{
    for (int twin = 0; twin < 2; twin++) {
        double dof;
        const double chi2 = dispersion(n, first, sets, twin, &dof), m = (double)sets * n / CELLS;
        const double z = (chi2 - dof) / sqrt(dof * (2 + 1 / m)), p = bis_stats_normal_p(z);
        print_message(
            "n = %u%s: cells vary by %.4f of chance, p %.2g\n", (unsigned)n, twin ? ", in float" : "", chi2 / dof, p);
        if (!twin) stat_judges(1);
        if (twin) assert_true(p < alpha());
        if (!twin && p < alpha())
            fail_msg("n = %u: cells are not drawn evenly, chi-square %g, dof %g, p %g", (unsigned)n, chi2, dof, p);
    }
}

static void every_cell_is_drawn_as_often_as_any_other(void **state)
{
    assert_gaps(33, 32, 200000);
    assert_gaps(10007, 9900, 20000);
}

/* ---- pixels ---- */

/* How far wi lies from the pixel, in radians: 0 inside. */
static double distance(const bis_envmap *em, uint32_t pixel, const double w[3])
{
    const double x = pixel % (uint32_t)em->width, y = pixel / (uint32_t)em->width;
    const double s = hypot(w[0], w[1]), theta = atan2(s, w[2]);
    const double middle = 2 * PI * (x + 0.5) / em->width, phi = fabs(remainder(atan2(w[1], w[0]) - middle, 2 * PI));
    const double south = fmax(0, fabs(theta - PI * (y + 0.5) / em->height) - PI / 2 / em->height),
                 east = fmax(0, phi - PI / em->width);

    return hypot(south, fmin(s * east, 2 * s));
}

/* Directions that try hard: everywhere, next to edges, poles, seam and axes. */
static vec3 hard_direction(const bis_envmap *em, uint32_t i, bis_rng *r)
{
    static const float ends[] = {0, -0.0f, 1, -1};
    const double a = bis_rng_double(r), b = bis_rng_double(r);
    const double column = floor(a * em->width), row = floor(b * em->height), off = (bis_rng_double(r) - 0.5) * 6e-6;
    double phi = 2 * PI * a, theta = PI * b;

    if (i < 64) {
        const vec3 w = {ends[i % 4], ends[i / 4 % 4], ends[i / 16]};
        return length(w) > 0 ? normalize(w) : (vec3){0, 0, 1};
    }
    switch (i % 5) {
    case 0: return bis_warp_sphere(a, b);
    case 1: phi = 2 * PI * column / em->width + off; break;
    case 2: theta = PI * row / em->height + off; break;
    case 3: theta = i % 2 ? PI - exp(-30 * b) : exp(-30 * b); break; /* poles */
    default: phi = (i % 2 ? PI : 0) + off * exp(-50 * b), theta = PI * bis_rng_double(r); break; /* seam */
    }
    return vec3_from(sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta));
}

/* The largest distance of a direction from its pixel, and what share of the uniform ones gets another pixel than by
 * bis_envmap_pixel. The axes are those of `found` while looking for pixels, of `axis` in truth. */
static double farthest(const bis_envmap *em, const vec3 axis[3], const vec3 found[3], uint32_t n, double *differ)
{
    float *memory = bis_alloc(BIS_LANES_ARRAYS * (size_t)n, sizeof *memory);
    uint32_t *pixel = bis_alloc(n, sizeof *pixel);
    const bis_lanes l = bis_lanes_in(memory, n);
    double most = 0;
    bis_rng r;

    *differ = 0;
    bis_rng_init(&r, SEED, (uint64_t)em->width, 0, 3);
    for (uint32_t i = 0; i < n; i++) {
        const vec3 w = hard_direction(em, i, &r);
        const frame f = {axis[0], axis[1], axis[2]};
        const vec3 world = to_world(&f, w);
        l.x[i] = world.x, l.y[i] = world.y, l.z[i] = world.z;
    }
    bis_envmap_pixels(em, found, pixel, &l, n);
    for (uint32_t i = 0; i < n; i++) {
        const vec3 w = {l.x[i], l.y[i], l.z[i]};
        const double local[3] = {dot(w, axis[0]), dot(w, axis[1]), dot(w, axis[2])};
        assert_true(pixel[i] < (uint32_t)em->width * (uint32_t)em->height);
        most = fmax(most, distance(em, pixel[i], local));
        if (i >= 64 && i % 5 == 0)
            *differ += 5.0 / n * (pixel[i] != bis_envmap_pixel(em, vec3_from(local[0], local[1], local[2])));
    }
    bis_free(memory);
    bis_free(pixel);
    return most;
}

static void pixels_are_those_of_envmap_within_a_microradian_of_their_edges(void **state)
{
    static const int size[][2] = {
        {1, 1}, {2, 1}, {1, 7}, {1, 4096}, {3, 5}, {64, 32}, {1024, 512}, {8192, 4096}, {16384, 8192}, {30011, 20011}};
    const vec3 straight[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const frame f = frame_about(normalize((vec3){0.3f, -0.8f, 0.4f}));
    const vec3 turned[3] = {f.x, f.y, f.z}, mirrored[3] = {{-1, 0, 0}, {0, 0, 1}, {0, 1, 0}};
    const vec3 *const axes[] = {straight, turned, mirrored};
    enum { N = 1 << 15 };

    for (int k = 0; k < 10; k++) {
        const bis_envmap em = {.width = size[k][0], .height = size[k][1]};
        for (int a = 0; a < 3; a++) {
            double differ;
            const double most = farthest(&em, axes[a], axes[a], N, &differ);
            if (k > 5)
                print_message(
                    "%d x %d, axes %d: %.2g rad, %.3f%% differ\n", em.width, em.height, a, most, 100 * differ);
            assert_true(most < 1e-6);
            assert_true(differ < 4e-7 * (em.width + em.height) +
                                     1e-3); /* 2e-7 radians on each side of every column and row, and chance */
        }
    }
    /* twin: axes off by two microradians */
    const bis_envmap em = {.width = 1024, .height = 512};
    const vec3 off[3] = {{1, 2e-6f, 0}, {-2e-6f, 1, 0}, {0, 0, 1}};
    double differ;
    assert_true(farthest(&em, straight, off, N, &differ) > 1e-6);
}

/* Radiance and density of each direction as one asks for them one by one; what fills the last block is black and may be
 * divided by. */
static void a_look_at_the_light_gives_each_direction_its_radiance_and_density(void **state)
{
    enum { N = 37, ROOM = 48 };
    bis_light *light = lit_new_light(LIT_SPOTTY, 3, 0.15, false);
    const double unit = bis_light_mean(light);
    float *memory = bis_alloc(BIS_LANES_ARRAYS * ROOM, sizeof *memory);
    uint32_t *pixel = bis_alloc(ROOM, sizeof *pixel);
    const bis_lanes l = bis_lanes_in(memory, ROOM);
    bis_rng r;

    bis_rng_init(&r, SEED, 5, 0, 4);
    for (uint32_t i = 0; i < ROOM; i++) {
        const vec3 w = bis_warp_sphere(bis_rng_double(&r), bis_rng_double(&r));
        l.x[i] = w.x, l.y[i] = w.y, l.z[i] = w.z;
        l.r[i] = l.g[i] = l.b[i] = l.q[i] = NAN;
    }
    bis_light_look(light, &l, pixel, N);
    for (uint32_t i = 0; i < N; i++) {
        const vec3 w = {l.x[i], l.y[i], l.z[i]};
        const rgb L = bis_light_Le(light, w);
        assert_true(fabs((double)l.r[i] * unit - (double)L.r) <= 1e-6 * (double)L.r &&
                    fabs((double)l.g[i] * unit - (double)L.g) <= 1e-6 * (double)L.g &&
                    fabs((double)l.b[i] * unit - (double)L.b) <= 1e-6 * (double)L.b);
        const double pdf = bis_light_pdf(light, w);
        assert_true(fabs((double)l.q[i] - pdf) <= 1e-6 * pdf);
    }
    for (uint32_t i = N; i < ROOM; i++) assert_true(l.r[i] == 0 && l.g[i] == 0 && l.b[i] == 0 && l.q[i] == 1);
    bis_free(memory);
    bis_free(pixel);
    bis_light_free(light);
}

/* Of a constant each direction has its radiance over its mean, 7/8; of a map for which nothing was built, the density
 * is 1. */
static void a_look_at_a_light_without_an_importance_finds_the_density_1(void **state)
{
    enum { N = 5, ROOM = 16 };
    float memory[BIS_LANES_ARRAYS * ROOM];
    uint32_t pixel[ROOM];
    const bis_lanes l = bis_lanes_in(memory, ROOM);
    const float unit = 0.5f + 0.25f + 0.125f;
    bis_light *light[2];
    bis_envmap em = map_new(4, 2);
    for (int i = 0; i < 8; i++) em.pixels[i] = (rgb){(float)i, 2, (float)(i % 2)};
    assert_int_equal(bis_light_constant(&light[0], (rgb){0.5f, 0.25f, 0.125f}, NULL), BIS_OK);
    const bis_xform straight = bis_xform_identity();
    assert_int_equal(bis_light_new(&light[1], &em, &straight, NULL, NULL), BIS_OK);
    for (int k = 0; k < 2; k++) {
        for (int i = 0; i < BIS_LANES_ARRAYS * ROOM; i++) memory[i] = NAN;
        for (uint32_t i = 0; i < ROOM; i++) l.x[i] = 0.6f, l.y[i] = 0, l.z[i] = i % 2 ? 0.8f : -0.8f;
        bis_light_look(light[k], &l, pixel, N);
        for (uint32_t i = 0; i < ROOM; i++) {
            const double mean = bis_light_mean(light[1]);
            const rgb of_map = i % 2 ? (rgb){0, 2, 0} : (rgb){4, 2, 0};
            const rgb c = i >= N ? (rgb){0, 0, 0} : k ? rgb_scale(of_map, 1 / mean)
                                                      : (rgb){0.5f / unit, 0.25f / unit, 0.125f / unit};
            assert_true(l.q[i] == 1);
            assert_true(fabsf(l.r[i] - c.r) <= 1e-6f && fabsf(l.g[i] - c.g) <= 1e-6f && fabsf(l.b[i] - c.b) <= 1e-6f);
        }
        bis_light_free(light[k]);
    }
}

/* What is drawn too rarely for a float's density, and what is not drawn at all, weighs nothing: Le = 0, q = 1. */
static void a_drawn_direction_becomes_a_lane_if_its_density_is_a_normal_float(void **state)
{
    enum { ROOM = 16 };
    float memory[BIS_LANES_ARRAYS * ROOM];
    const bis_lanes l = bis_lanes_in(memory, ROOM);
    const double least = 0x1p-126, pdfs[] = {3, least, least * 0.999, 0};
    for (int i = 0; i < BIS_LANES_ARRAYS * ROOM; i++) memory[i] = -1;
    for (uint32_t i = 0; i < 5; i++) {
        const bis_light_point y = {{0.36f, 0.48f, 0.8f}, {2, 6, 10}, i < 4 ? pdfs[i] : 0};
        const bool counts = i < 2;
        bis_lanes_put(&l, 3 + i, i < 4 ? &y : NULL, 4);
        assert_true(l.r[3 + i] == (counts ? 0.5f : 0) && l.g[3 + i] == (counts ? 1.5f : 0) &&
                    l.b[3 + i] == (counts ? 2.5f : 0));
        assert_true((double)l.q[3 + i] == (counts ? pdfs[i] : 1));
        if (counts) assert_true(l.x[3 + i] == 0.36f && l.y[3 + i] == 0.48f && l.z[3 + i] == 0.8f);
    }
    const float *const arrays[] = {l.x, l.y, l.z, l.r, l.g, l.b, l.q};
    for (int a = 0; a < BIS_LANES_ARRAYS; a++) assert_true(arrays[a][2] == -1 && arrays[a][8] == -1);
}

/* ---- the same bits ---- */

static void points_and_pixels_have_the_same_bits_on_every_processor(void **state)
{
    enum { N = 1 << 13 };
    clone_points *const points[] = {plain_curve_points, clone_has_avx2() ? avx2_curve_points : plain_curve_points};
    clone_pixels *const pixels[] = {plain_envmap_pixels, clone_has_avx2() ? avx2_envmap_pixels : plain_envmap_pixels};
    const bis_envmap em = {.width = 4096, .height = 2048};
    const frame f = frame_about(normalize((vec3){0.3f, -0.8f, 0.4f}));
    const vec3 axis[3] = {f.x, f.y, f.z};
    float *a = bis_alloc(2 * N, sizeof *a), *b = bis_alloc(2 * N, sizeof *b),
          *memory = bis_alloc(BIS_LANES_ARRAYS * N, sizeof *memory);
    uint32_t *p = bis_alloc(N, sizeof *p), *q = bis_alloc(N, sizeof *q);
    const bis_lanes l = bis_lanes_in(memory, N);
    bis_rng r;

    bis_rng_init(&r, SEED, 0, 0, 4);
    for (uint32_t i = 0; i < N; i++) {
        const vec3 w = hard_direction(&em, i, &r);
        l.x[i] = w.x, l.y[i] = w.y, l.z[i] = w.z;
    }
    bis_envmap_pixels(&em, axis, p, &l, N);
    for (int k = 0; k < 2; k++) {
        pixels[k](&em, axis, q, &l, N);
        assert_memory_equal(p, q, N * sizeof *p);
        for (uint32_t n = 1; n <= N; n = n * 3 + 1) {
            bis_curve_points(a, a + N, n, n);
            points[k](b, b + N, n, n);
            assert_memory_equal(a, b, 2 * N * sizeof *a);
        }
    }
    b[1] = nextafterf(b[1], 2); /* twin */
    assert_memory_not_equal(a, b, 2 * N * sizeof *a);
    bis_free(a);
    bis_free(b);
    bis_free(memory);
    bis_free(p);
    bis_free(q);
}

/* Each of the 64 x 64 squares is one piece of Hilbert's curve, and n points one in each n-th of it: a square holds
 * n/4096 of them, one more or less at either end. More than 2^16 points need products beyond 32 bits. */
static void a_million_points_are_as_even_as_a_hundred(void **state)
{
    static const uint32_t counts[] = {100, 4096, 32768, 32769, 46341, 65537, 100000, 390001, 1 << 20};
    float *u = bis_alloc(2 << 20, sizeof *u);
    int *in_square = bis_alloc(4096, sizeof *in_square);

    for (int k = 0; k < 9; k++) {
        const uint32_t n = counts[k];
        float *u1 = u, *u2 = u + bis_lanes_round_up(n);
        for (int i = 0; i < 4096; i++) in_square[i] = 0;
        bis_curve_points(u1, u2, n, 7);
        for (uint32_t i = 0; i < n; i++) in_square[64 * (int)(u2[i] * 64) + (int)(u1[i] * 64)]++;
        for (int i = 0; i < 4096; i++) {
            if (fabs(in_square[i] - n / 4096.0) > 2) fail_msg("%u points: %d in square %d", n, in_square[i], i);
        }
    }
    bis_free(u);
    bis_free(in_square);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_million_points_are_as_even_as_a_hundred),
        cmocka_unit_test(log_of_1_minus_x_is_good_to_2_to_the_minus_22_down_to_x_0),
        cmocka_unit_test(exp_is_good_to_2_to_the_minus_22_and_never_below_2_to_the_minus_64),
        cmocka_unit_test(one_minus_exp_is_good_to_2_to_the_minus_22_down_to_0),
        cmocka_unit_test(sine_and_cosine_are_good_to_2_to_the_minus_22),
        cmocka_unit_test(atan2_is_good_to_4e_7_at_every_radius_and_on_the_axes),
        cmocka_unit_test(the_largest_cosine_of_a_cone_is_that_of_its_nearest_direction),
        cmocka_unit_test(the_arrays_of_lanes_and_cones_lie_one_after_the_other),
        cmocka_unit_test(the_curve_of_these_tests_is_that_of_curve),
        cmocka_unit_test(one_point_lies_in_each_nth_of_the_curve_in_its_order),
        cmocka_unit_test(points_are_a_function_of_the_key_and_fill_the_last_block_and_no_more),
        cmocka_unit_test(points_are_uniform_in_the_square_and_inside_the_last_cells),
        cmocka_unit_test(every_cell_is_drawn_as_often_as_any_other),
        cmocka_unit_test(a_look_at_the_light_gives_each_direction_its_radiance_and_density),
        cmocka_unit_test(a_look_at_a_light_without_an_importance_finds_the_density_1),
        cmocka_unit_test(a_drawn_direction_becomes_a_lane_if_its_density_is_a_normal_float),
        cmocka_unit_test(pixels_are_those_of_envmap_within_a_microradian_of_their_edges),
        cmocka_unit_test(points_and_pixels_have_the_same_bits_on_every_processor),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
