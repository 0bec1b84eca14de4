/* film: crops, means, and what the scatter of the passes says about the error. Family-wise significance of the one
 * statistical test: 0.01. */
#include "bis/render/film.h"
#include "bis/base/mem.h"
#include "bis/thesis/rng.h"
#include "threads.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <stdio.h>

#include <cmocka.h>

#include <math.h>

static const double whole[4] = {0, 1, 0, 1};

static void init(bis_film *f, int width, int height)
{
    assert_int_equal(bis_film_init(f, width, height, whole, (bis_loc){0}, NULL), BIS_OK);
    f->independent = true;
}

static void neighbouring_crops_share_no_pixel_and_leave_no_gap(void **state)
{
    (void)state;
    for (int full = 1; full < 40; full++) {
        for (int cut = 1; cut < 20; cut++) {
            double x = cut / 20.0;
            bis_film left, right;
            bis_status a = bis_film_init(&left, full, 1, (double[4]){0, x, 0, 1}, (bis_loc){0}, NULL);
            bis_status b = bis_film_init(&right, full, 1, (double[4]){x, 1, 0, 1}, (bis_loc){0}, NULL);
            assert_true(a == BIS_OK || b == BIS_OK); /* one of them may hold nothing */
            assert_int_equal(left.width + right.width, full);
            if (!b) assert_int_equal(right.x0, left.width);
            bis_film_clear(&left);
            bis_film_clear(&right);
        }
    }
}

/* pbrt-v4, film.cpp: pixelBounds = (ceil(full * x0), ceil(full * x1)). */
static void crop_is_rounded_as_pbrt_does(void **state)
{
    (void)state;
    bis_film f;
    assert_int_equal(bis_film_init(&f, 10, 9, (double[4]){0.25, 0.75, 0.5, 1}, (bis_loc){0}, NULL), BIS_OK);
    assert_int_equal(f.x0, 3);
    assert_int_equal(f.width, 5);
    assert_int_equal(f.y0, 5);
    assert_int_equal(f.height, 4);
    bis_film_clear(&f);
}

/* Every pixel of every crop of 13 x 7 lies in one tile of the crop, and that is the picture's: which pixels share one
 * depends on their places in the picture alone. */
static void the_tiles_of_a_crop_are_those_of_its_picture(void **state)
{
    enum { W = 13, H = 7, SIDE = 4 };
    (void)state;
    for (int i = 0; i < W * W * H * H; i++) {
        const bis_rect r = {i % W, i / W % H, i / (W * H) % W + 1, i / (W * H * W) + 1};
        const bis_film f = {.full_width = W, .full_height = H, .x0 = r.x0, .y0 = r.y0, .width = r.x1 - r.x0, .height = r.y1 - r.y0};
        int across, met = 0;
        if (f.width <= 0 || f.height <= 0) continue;
        const int n = bis_film_tiles(&f, SIDE, &across);
        for (int t = 0; t < n; t++) {
            const bis_rect all = bis_film_tile(&f, SIDE, t), part = bis_film_tile_of_crop(&f, SIDE, t);
            assert_true(all.x0 % SIDE == 0 && all.y0 % SIDE == 0 && (all.x1 == all.x0 + SIDE || all.x1 == W) && (all.y1 == all.y0 + SIDE || all.y1 == H));
            assert_true(part.x0 == fmax(all.x0, r.x0) && part.x1 == fmin(all.x1, r.x1) && part.y0 == fmax(all.y0, r.y0) && part.y1 == fmin(all.y1, r.y1));
            assert_true(part.x1 > part.x0 && part.y1 > part.y0);
            met += (part.x1 - part.x0) * (part.y1 - part.y0);
            if (t >= across) assert_true(bis_film_tile(&f, SIDE, t - across).y1 == all.y0);
        }
        assert_int_equal(met, f.width * f.height);
    }
}

static void a_crop_without_pixels_or_outside_is_refused(void **state)
{
    (void)state;
    const double bad[][4] = {{0.5, 0.5, 0, 1}, {0.6, 0.4, 0, 1}, {0, 1, 0.91, 0.99}, {-0.1, 1, 0, 1}, {0, 1.1, 0, 1}, {0, (double)NAN, 0, 1}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        bis_film f;
        bis_diag diag = {0};
        assert_int_equal(bis_film_init(&f, 10, 10, bad[i], (bis_loc){0}, &diag), BIS_INPUT);
        assert_int_equal(diag.n_errors, 1);
        assert_null(f.sum);
        bis_diag_clear(&diag);
    }
}

/* A thin film of each 2 x 2 has pixels 1, 3, 5, 7 of 8; a crop from 0.8 to 0.96 of a pixel has none of any film. */
static void a_crop_without_pixels_of_a_thin_film_says_so(void **state)
{
    (void)state;
    static const char rest[] = "; it reads x0, x1, y0, y1 with x0 < x1, y0 < y1";
    static const struct { int step; double x0, x1; const char *thin; } cases[] = {
        {1, 0.1, 0.12, ""}, {2, 0, 0.1, " that a thin film has"}, {3, 0, 0.1, " that a thin film has"}};
    for (int i = 0; i < 3; i++) {
        char expected[256];
        bis_film f;
        bis_diag diag = {0};
        const double crop[4] = {cases[i].x0, cases[i].x1, 0, 1};
        assert_int_equal(bis_film_init_thin(&f, 8, 8, crop, cases[i].step, (bis_loc){0}, &diag), BIS_INPUT);
        snprintf(expected, sizeof expected, "error: the crop window %g, %g, 0, 1 holds no pixel of 8 x 8%s%s", crop[0], crop[1],
                 cases[i].thin, rest);
        assert_string_equal(diag.messages[0].text, expected);
        bis_diag_clear(&diag);
    }
}

/* Two passes with values a and b in each channel: mean (a + b)/2, its variance (a - b)^2/4, the mean's square less that a b. A
 * crop of 6 x 5 pixels, from (3, 2) on, in tiles of 4: 1, 4 and 1 columns, 2 and 3 rows. All tiles together are the picture's
 * relMSE. Dark pictures have small floors. */
static void a_tiles_error_is_the_sum_over_its_pixels(void **state)
{
    (void)state;
    for (int dark = 0; dark < 2; dark++) {
        const double scale = dark ? 0x1p-10 : 4, crop[4] = {0.25, 0.75, 0.25, 0.875};
        double mean = 0, errors[6], expected[6] = {0}, all = 0;
        bis_film f;
        assert_int_equal(bis_film_init(&f, 12, 8, crop, (bis_loc){0}, NULL), BIS_OK);
        f.independent = true;
        assert_true(f.x0 == 3 && f.y0 == 2 && f.width == 6 && f.height == 5);
        for (int pass = 0; pass < 2; pass++) {
            for (int y = 2; y < 7; y++)
                for (int x = 3; x < 9; x++) {
                    const float v = (float)(scale * (pass ? x + 2 * y : 3 + x * y % 5));
                    bis_film_add(&f, x, y, (rgb){v, v, v}, 1, 1);
                }
            bis_film_end_pass(&f, 1);
        }
        for (int k = 0; k < 2; k++) /* the mean, then what is weighed by it */
            for (int y = 2; y < 7; y++)
                for (int x = 3; x < 9; x++) {
                    const double a = scale * (x + 2 * y), b = scale * (3 + x * y % 5), m = (a + b) / 2, floor = mean * mean / 100;
                    if (k == 0) mean += m / 30;
                    else expected[y / 4 * 3 + x / 4] += (a - b) * (a - b) / 4 / sqrt((m * m + floor) * (a * b + floor));
                }
        bis_film_tile_errors(&f, 4, errors);
        for (int t = 0; t < 6; t++) {
            if (!(fabs(errors[t] - expected[t]) <= 1e-9 * expected[t])) fail_msg("tile %d: %g, not %g", t, errors[t], expected[t]);
            all += expected[t];
        }
        assert_true(fabs(bis_film_estimate_error(&f).relative_rmse / sqrt(all / 30) - 1) < 1e-9);
        bis_film_clear(&f);
    }
}

static void pixels_are_means_and_alpha_the_share_of_hits(void **state)
{
    (void)state;
    bis_film f;
    float rgba[4 * 6];
    init(&f, 3, 2);
    for (int pass = 0; pass < 4; pass++) {
        for (int y = 0; y < 2; y++) {
            for (int x = 0; x < 3; x++) {
                bis_film_add(&f, x, y, (rgb){(float)(pass * x), (float)y, 1.0f / 3}, pass < x, 1);
            }
        }
        bis_film_end_pass(&f, 1);
    }
    bis_film_resolve(&f, rgba);
    for (int i = 0; i < 6; i++) {
        assert_true(rgba[4 * i] == (float)(1.5 * (i % 3)));
        assert_true(rgba[4 * i + 1] == (float)(i / 3));
        assert_true(rgba[4 * i + 2] == 1.0f / 3);
        assert_true(rgba[4 * i + 3] == (float)(i % 3) / 4);
    }
    bis_film_clear(&f);
}

/* Alpha of one pixel after `passes` passes of weight 1 and this share of hits. */
static double alpha_after(uint32_t passes, double share)
{
    bis_film f;
    float rgba[4];
    init(&f, 1, 1);
    for (uint32_t pass = 0; pass < passes; pass++) {
        bis_film_add(&f, 0, 0, (rgb){1, 1, 1}, share, 1);
        bis_film_end_pass(&f, 1);
    }
    bis_film_resolve(&f, rgba);
    bis_film_clear(&f);
    return (double)rgba[3];
}

/* Eighths need 24 bits up to 2^21 whole ones. One more whole one and an eighth do not fit. */
static void alpha_of_eighths_is_exact_for_two_million_camera_samples(void **state)
{
    (void)state;
    for (int eighths = 1; eighths <= 8; eighths++)
        assert_true(alpha_after(1 << 20, eighths / 8.0) == eighths / 8.0);
    assert_true(alpha_after(1 << 21, 7 / 8.0) == 7 / 8.0);
    assert_true(alpha_after(1 << 22, 7 / 8.0) != 7 / 8.0); /* the test can see a rounding */
}

/* A third of weight 1 is rounded in each pass, in one direction as long as the sum has the same exponent. By hand: the
 * sum lies in [2^e, 2^(e+1)) for 3 2^e passes and has steps of u = 2^(e-23), so that each pass adds u round(1/(3u))
 * instead of 1/3, an error of u/3: with e even too much, with e odd too little. (The drift itself moves the powers of two by 70
 * of 10^5 passes, each of which then errs by u/3 + u/6 otherwise: 0.6 % of the whole.) The bound is that of film.c,
 * 2^-25 (1/3) (n + 1), and half a step of float for the quotient. */
static void alpha_of_thirds_errs_by_less_than_the_bound(void **state)
{
    (void)state;
    static const uint32_t passes[] = {10, 1000, 10000, 100000};
    for (size_t i = 0; i < sizeof passes / sizeof *passes; i++) {
        const double n = passes[i], error = alpha_after(passes[i], 1 / 3.0) - 1 / 3.0;
        double drift = 0, left = n;
        for (int e = -2; left > 0; e++) {
            const double here = fmin(left, 3 * ldexp(1, e));
            drift += here * (e % 2 ? -1 : 1) * ldexp(1, e - 23) / 3;
            left -= here;
        }
        const double bound = ldexp(1 / 3.0, -25) * (n + 1) + ldexp(1, -26);
        if (!(fabs(error) <= bound)) fail_msg("%g passes: alpha errs by %g, bound %g", n, error, bound);
        if (n >= 1e5 && !(fabs(error / (drift / n) - 1) < 0.01)) fail_msg("alpha errs by %g, by hand %g", error, drift / n);
    }
}

static void a_film_without_passes_is_black(void **state)
{
    (void)state;
    bis_film f;
    float rgba[4] = {1, 1, 1, 1};
    init(&f, 1, 1);
    bis_film_resolve(&f, rgba);
    for (int k = 0; k < 4; k++) assert_true(rgba[k] == 0);
    bis_film_clear(&f);
}

/* Two grey pixels: the passes of the first are given, those of the second are all 4. */
static double rmse_of(const float *first, int passes, double *upper)
{
    bis_film f;
    init(&f, 2, 1);
    for (int pass = 0; pass < passes; pass++) {
        const float v = first[pass];
        bis_film_add(&f, 0, 0, (rgb){v, v, v}, true, 1);
        bis_film_add(&f, 1, 0, (rgb){4, 4, 4}, true, 1);
        bis_film_end_pass(&f, 1);
    }
    const bis_film_error error = bis_film_estimate_error(&f);
    if (upper) *upper = error.upper;
    bis_film_clear(&f);
    return error.relative_rmse;
}

/* Passes {1, 3}: means 2 and 4, m = 3, variance of the first mean 2/2 = 1. In place of the truth's square stand 2^2 and
 * 2^2 - 1. */
static void relative_rmse_is_what_the_formula_gives_by_hand(void **state)
{
    (void)state;
    double upper;
    const double expected = sqrt(0.5 / sqrt(4.09 * 3.09));
    assert_true(fabs(rmse_of((float[]){1, 3}, 2, &upper) - expected) < 1e-14);
    assert_true(upper > expected);
}

/* Passes {0, 0, 0, 8}: mean 2, of variance 16/4 = 4. The twin, 4/(2^2 + m^2/100), calls it an error of 70%, however bright
 * the sample. */
static void a_lone_bright_sample_does_not_hide_behind_its_own_brightness(void **state)
{
    (void)state;
    const double rmse = rmse_of((float[]){0, 0, 0, 8}, 4, NULL), twin = sqrt(0.5 * 4 / 4.09);
    /* the deviation is float: 2^-24 of the variance, which the difference 2^2 - 4 makes 4 * 2^-24 / 0.09 / 2 of the square */
    assert_true(fabs(rmse - sqrt(0.5 * 4 / sqrt(4.09 * 0.09))) < 3e-6);
    assert_true(rmse > 2.5 * twin);
}

static void relative_rmse_is_unknown_before_two_passes_and_zero_without_scatter(void **state)
{
    (void)state;
    const float values[] = {0, 1, 0.1f, 3.4e38f, 1e-38f};
    for (size_t i = 0; i < 2 * (sizeof values / sizeof *values); i++) {
        bis_film f;
        const float value = values[i / 2];
        init(&f, 1, 1);
        f.independent = i % 2;
        for (int pass = 0; pass < 7; pass++) {
            const bis_film_error e = bis_film_estimate_error(&f);
            assert_true(pass < 2 ? isnan(e.relative_rmse) && isnan(e.upper) : e.relative_rmse < 1e-7 && e.upper < 1e-7);
            assert_true(pass >= 2 || !e.is_known);
            bis_film_add(&f, 0, 0, (rgb){value, value, value}, true, 1);
            bis_film_end_pass(&f, 1);
        }
        bis_film_clear(&f);
    }
}

/* 5300 pixels, noise: the threads' shares meet in other orders each time. All pixels as tiles of one make the sum. */
static void any_number_of_threads_finds_the_same_errors(void **state)
{
    (void)state;
    enum { W = 100, H = 53, TIMES = 100 };
    static double alone[W * H], together[W * H];
    static float rgba[2][4 * W * H];
    const int before = use_threads(1);
    double sum = 0;
    bis_film f;
    bis_rng rng;

    bis_rng_init(&rng, 8, 0, 0, 0);
    init(&f, W, H);
    for (int pass = 0; pass < 3; pass++) {
        for (int i = 0; i < W * H; i++) {
            const float v = (float)bis_rng_double(&rng), w = (float)bis_rng_double(&rng);
            bis_film_add(&f, i % W, i / W, (rgb){v, w, v * w}, (double)w, 1);
        }
        bis_film_end_pass(&f, 1);
    }
    const bis_film_error error = bis_film_estimate_error(&f);
    bis_film_tile_errors(&f, 1, alone);
    bis_film_resolve(&f, rgba[0]);
    for (int i = 0; i < W * H; i++) sum += alone[i];
    assert_true(fabs(error.relative_rmse / sqrt(sum / (W * H)) - 1) < 1e-12);
    for (int i = 0; i < TIMES; i++) {
        use_threads(2 + i % 7);
        const bis_film_error again = bis_film_estimate_error(&f);
        assert_true(again.relative_rmse == error.relative_rmse && again.upper == error.upper);
        bis_film_tile_errors(&f, 1, together);
        assert_memory_equal(together, alone, sizeof alone);
        bis_film_resolve(&f, rgba[1]);
        assert_memory_equal(rgba[1], rgba[0], sizeof rgba[0]);
    }
    use_threads(before);
    bis_film_clear(&f);
}

static void exposure_does_not_change_the_relative_rmse(void **state)
{
    (void)state;
    double rmse[3], smaller;
    const double scale[3] = {1, 1e-20, 1e20};
    for (int s = 0; s < 3; s++) {
        bis_film f;
        bis_rng rng;
        bis_rng_init(&rng, 1, 0, 0, 0);
        init(&f, 8, 8);
        for (int pass = 0; pass < 5; pass++) {
            for (int i = 0; i < 64; i++) {
                double v = scale[s] * bis_rng_double(&rng);
                bis_film_add(&f, i % 8, i / 8, rgb_from(v, v / 2, v / 3), true, 1);
            }
            bis_film_end_pass(&f, 1);
        }
        rmse[s] = bis_film_estimate_error(&f).relative_rmse;
        for (int k = 0; k < 3 * 64; k++) f.sum[k] *= 0x1p-40, f.deviation[k] *= 0x1p-40f, f.half[k] *= 0x1p-40f;
        smaller = bis_film_estimate_error(&f).relative_rmse; /* a power of 2 rounds nothing */
        assert_true(fabs(smaller / rmse[s] - 1) < 1e-15);
        bis_film_clear(&f);
    }
    /* The samples are rounded to float after scaling: 2^-24 each. */
    for (int s = 1; s < 3; s++) assert_true(fabs(rmse[s] - rmse[0]) < 1e-6 * rmse[0]);
}

/* A film of 12 x 12 pixels whose means are known and whose noise is uniform, triangular or (heavy) exponential; returns
 * the true relative RMSE of this very picture. */
static double noisy_film(bis_film *f, uint64_t seed, int passes)
{
    bis_rng rng;
    double truth[144], m = 0, total = 0;

    bis_rng_init(&rng, seed, 0, 0, 0);
    init(f, 12, 12);
    for (int i = 0; i < 144; i++) truth[i] = 0.5 + (i % 7);
    for (int pass = 0; pass < passes; pass++) {
        for (int i = 0; i < 144; i++) {
            double u = bis_rng_double(&rng), v = bis_rng_double(&rng);
            double noise = i % 3 == 0 ? u - 0.5 : i % 3 == 1 ? u - v : -log1p(-u) - 1;
            double L = truth[i] * (1 + 0.4 * noise);
            bis_film_add(f, i % 12, i / 12, rgb_from(L, L, L), true, 1);
        }
        bis_film_end_pass(f, 1);
    }
    for (int i = 0; i < 144; i++) m += truth[i] / 144;
    for (int i = 0; i < 144; i++) {
        double d = f->sum[3 * i] / passes - truth[i];
        total += d * d / (truth[i] * truth[i] + m * m / 100) / 144;
    }
    return sqrt(total);
}

/* Misses in n renders, when at most 5% of them may miss: mean 0.05 n, 2.33 standard deviations are passed once in a
 * hundred. */
static bool too_many_misses(int misses, int n) { return misses > 0.05 * n + 2.33 * sqrt(n * 0.05 * 0.95); }

static void upper_bound_holds_in_95_renders_of_100(void **state)
{
    (void)state;
    enum { N = 2000 };
    for (int passes = 4; passes <= 64; passes *= 4) {
        int misses = 0, twin_misses = 0;
        double mean_upper = 0, mean_truth = 0;
        for (int i = 0; i < N; i++) {
            bis_film f;
            const double truth = noisy_film(&f, 100 + (uint64_t)i, passes);
            const bis_film_error e = bis_film_estimate_error(&f);
            misses += truth > e.upper;
            twin_misses += truth > e.relative_rmse; /* the estimate alone is a bound every other time */
            mean_upper += e.upper / N;
            mean_truth += truth / N;
            bis_film_clear(&f);
        }
        assert_false(too_many_misses(misses, N));
        assert_true(too_many_misses(twin_misses, N));
        /* A bound of twice the error would make --error waste four times the work. */
        assert_true(mean_upper < 1.3 * mean_truth);
    }
}

static void every_failing_allocation_is_reported_and_leaves_nothing(void **state)
{
    (void)state;
    for (long k = 1;; k++) {
        bis_film f;
        bis_diag diag = {0};
        bis_mem_fail_at(k);
        bis_status status = bis_film_init(&f, 8, 6, whole, (bis_loc){0}, &diag);
        bis_mem_fail_at(0);
        bis_film_clear(&f);
        if (status == BIS_OK) {
            assert_true(k > 4);
            return;
        }
        assert_int_equal(status, BIS_NOMEM);
        if (diag.n) assert_string_equal(diag.messages[0].text, "error: no memory for a picture of 8 x 6 pixels");
        bis_diag_clear(&diag);
    }
}

/* Two passes, weights 1 and 3, 2 x 1 pixels: means -0.25 and 0.5 in red, 1 and 1 in green, 0 in blue. */
static void a_mean_below_0_becomes_0_and_is_told(void **state)
{
    const double crop[4] = {0, 1, 0, 1};
    bis_film f;
    float rgba[8];

    (void)state;
    assert_int_equal(bis_film_init(&f, 2, 1, crop, (bis_loc){0}, NULL), BIS_OK);
    bis_film_add(&f, 0, 0, (rgb){-1, 1, 0}, 1, 1);
    bis_film_add(&f, 1, 0, (rgb){2, 1, 0}, 1, 1);
    bis_film_end_pass(&f, 1);
    bis_film_add(&f, 0, 0, (rgb){0, 1, 0}, 1, 3);
    bis_film_add(&f, 1, 0, (rgb){0, 1, 0}, 1, 3);
    bis_film_end_pass(&f, 3);
    bis_film_resolve(&f, rgba);
    assert_true(rgba[0] == 0);
    assert_true(rgba[1] == 1);
    assert_true(rgba[4] == 0.5f);
    assert_true(fabs(bis_film_raised(&f) - 0.25 / (0.25 + 1 + 0.5 + 1)) < 1e-12);
    bis_film_clear(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(neighbouring_crops_share_no_pixel_and_leave_no_gap),
        cmocka_unit_test(crop_is_rounded_as_pbrt_does),
        cmocka_unit_test(the_tiles_of_a_crop_are_those_of_its_picture),
        cmocka_unit_test(a_crop_without_pixels_or_outside_is_refused),
        cmocka_unit_test(a_crop_without_pixels_of_a_thin_film_says_so),
        cmocka_unit_test(a_tiles_error_is_the_sum_over_its_pixels),
        cmocka_unit_test(pixels_are_means_and_alpha_the_share_of_hits),
        cmocka_unit_test(alpha_of_eighths_is_exact_for_two_million_camera_samples),
        cmocka_unit_test(alpha_of_thirds_errs_by_less_than_the_bound),
        cmocka_unit_test(a_film_without_passes_is_black),
        cmocka_unit_test(relative_rmse_is_what_the_formula_gives_by_hand),
        cmocka_unit_test(a_lone_bright_sample_does_not_hide_behind_its_own_brightness),
        cmocka_unit_test(relative_rmse_is_unknown_before_two_passes_and_zero_without_scatter),
        cmocka_unit_test(any_number_of_threads_finds_the_same_errors),
        cmocka_unit_test(exposure_does_not_change_the_relative_rmse),
        cmocka_unit_test(upper_bound_holds_in_95_renders_of_100),
        cmocka_unit_test(every_failing_allocation_is_reported_and_leaves_nothing),
        cmocka_unit_test(a_mean_below_0_becomes_0_and_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
