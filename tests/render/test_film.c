/* SPDX-License-Identifier: BSD-2-Clause */
/* film: crops, means and alpha. */
#include "bis/render/film.h"
#include "bis/render/render.h"
#include "bis/thesis/rng.h"
#include "claim.h"
#include "threads.h"

#include <stdio.h>

#include <math.h>

static const double whole[4] = {0, 1, 0, 1};

static void init(bis_film *f, int width, int height)
{
    assert_int_equal(bis_film_init(f, width, height, whole, (bis_loc){0}, NULL), BIS_OK);
    f->independent = true;
}

static void neighbouring_crops_share_no_pixel_and_leave_no_gap(void **state)
{
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

/* Four numbers in [0,1], x0 < x1 and y0 < y1, and nothing else. What is refused leaves the crop as it was. */
static void a_crop_is_read_from_four_numbers(void **state)
{
    static const struct {
        const char *text;
        bool is_right;
        double crop[4];
    } cases[] = {
        {"0.25,0.75,0,1", true, {0.25, 0.75, 0, 1}}, {"0,1,0.5,0.625", true, {0, 1, 0.5, 0.625}},
        {"0,0.5,0.5,1", true, {0, 0.5, 0.5, 1}}, {"", false, {0}}, {"0,1,0", false, {0}}, {"0,1,0,", false, {0}},
        {"0,1,0,1,", false, {0}}, {"0,1,0,1,1", false, {0}}, {"0,1,0,1 ", false, {0}}, {"0;1,0,1", false, {0}},
        {"0,1;0,1", false, {0}}, {"0,1,0;1", false, {0}}, {"x,1,0,1", false, {0}}, {"0,1,0,x", false, {0}},
        {",1,0,1", false, {0}}, {"-0.1,1,0,1", false, {0}}, {"0,1.1,0,1", false, {0}}, {"0,1,-0.1,1", false, {0}},
        {"0,1,0,1.1", false, {0}}, {"nan,1,0,1", false, {0}}, {"0.5,0.5,0,1", false, {0}}, {"0,1,0.5,0.5", false, {0}},
        {"0.6,0.5,0,1", false, {0}}, {"0,1,0.6,0.5", false, {0}},
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double crop[4] = {7, 7, 7, 7};
        if (bis_film_read_crop(crop, cases[i].text) != cases[i].is_right) fail_msg("\"%s\"", cases[i].text);
        for (int k = 0; k < 4; k++) assert_true(crop[k] == (cases[i].is_right ? cases[i].crop[k] : 7));
    }
}

/* pbrt-v4, film.cpp: pixelBounds = (ceil(full * x0), ceil(full * x1)). */
static void crop_is_rounded_as_pbrt_does(void **state)
{
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
    for (int i = 0; i < W * W * H * H; i++) {
        const bis_rect r = {i % W, i / W % H, i / (W * H) % W + 1, i / (W * H * W) + 1};
        const bis_film f = {
            .full_width = W, .full_height = H, .x0 = r.x0, .y0 = r.y0, .width = r.x1 - r.x0, .height = r.y1 - r.y0};
        int across, met = 0;
        if (f.width <= 0 || f.height <= 0) continue;
        const int n = bis_film_tiles(&f, SIDE, &across);
        for (int t = 0; t < n; t++) {
            const bis_rect all = bis_film_tile(&f, SIDE, t), part = bis_film_tile_of_crop(&f, SIDE, t);
            assert_true(all.x0 % SIDE == 0 && all.y0 % SIDE == 0 && (all.x1 == all.x0 + SIDE || all.x1 == W) &&
                        (all.y1 == all.y0 + SIDE || all.y1 == H));
            assert_true(part.x0 == fmax(all.x0, r.x0) && part.x1 == fmin(all.x1, r.x1) &&
                        part.y0 == fmax(all.y0, r.y0) && part.y1 == fmin(all.y1, r.y1));
            assert_true(part.x1 > part.x0 && part.y1 > part.y0);
            met += (part.x1 - part.x0) * (part.y1 - part.y0);
            if (t >= across) assert_true(bis_film_tile(&f, SIDE, t - across).y1 == all.y0);
        }
        assert_int_equal(met, f.width * f.height);
    }
}

/* Pixel i of a thin film stands for pixel k i + k/2 of the picture, and a crop has those that it would have there. */
static void a_thin_film_has_the_middle_one_of_each_k_pixels(void **state)
{
    for (int step = 1; step <= 6; step++)
        for (int n = 1; n < 30; n++)
            for (int lo = 0; lo < n; lo += 3) {
                const double crop[4] = {(double)lo / n, 1, 0, (double)(lo + 1) / n};
                const int first = (int)ceil(n * crop[0]), end = (int)ceil((n + 5) * crop[3]);
                int before = 0, all = 0, rows = 0, all_rows = 0;
                for (int at = step / 2; at < n + 5; at += step) {
                    before += at < first, all += at < n;
                    rows += at < end, all_rows++;
                }
                const bis_film f = bis_film_place(n, n + 5, crop, step);
                assert_true(f.full_width == all && f.full_height == all_rows && f.step == step);
                assert_true(f.x0 == before && f.width == all - before && f.y0 == 0 && f.height == rows);
            }
}

/* Passes of weights 1, 1, 2, 4, 4. The deviation is the root of the mean of (L - mean)^2, weighted. The first half is
 * kept before each pass that finds twice the weight of the half before: at 1, 2, 4 and 8, but not at 8 if fewer than 12
 * are to come in all. A twin has its halves likewise. */
static void passes_have_a_deviation_and_a_first_half(void **state)
{
    static const double weights[5] = {1, 1, 2, 4, 4}, values[5] = {3, 1, 7, 2, 5};
    static const struct { double most, half, mean; } cases[] = {
        {0, 8, 26 / 8.0}, {12, 8, 26 / 8.0}, {11, 4, 18 / 4.0}, {40, 8, 26 / 8.0}, {5, 2, 4 / 2.0}};
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        bis_film f;
        double squares = 0;
        init(&f, 1, 1);
        assert_int_equal(bis_film_want_twins(&f, NULL), BIS_OK);
        f.most = cases[n].most;
        for (int k = 0; k < 5; k++) {
            const rgb L = rgb_from(values[k], 2 * values[k], 1);
            bis_film_add(&f, 0, 0, L, 1, weights[k]);
            bis_film_add_twin(&f, &(bis_twin){.at = 0}, rgb_from(1, values[k], 3 * values[k]), weights[k]);
            bis_film_end_pass(&f, weights[k]);
        }
        for (int k = 0; k < 5; k++) squares += weights[k] * pow(values[k] - 46 / 12.0, 2) / 12;
        assert_true(f.sum[0] == 46 && f.sum[1] == 92 && f.sum[2] == 12 && f.weight == 12 && f.passes == 5);
        assert_true(fabs((double)f.deviation[0] - sqrt(squares)) < 1e-6);
        assert_true(fabs((double)f.deviation[1] - 2 * sqrt(squares)) < 1e-6 && f.deviation[2] == 0);
        assert_true(fabs(bis_film_variance(&f, 1) - 4 * squares / 4) < 1e-6);
        assert_true(f.half_weight == cases[n].half);
        assert_true(fabs((double)f.half[0] - cases[n].mean) < 1e-6 && f.half[2] == 1);
        assert_true(f.twin[1] == 46 && f.twin[2] == 138 && fabs(f.twin[4] - cases[n].mean) < 1e-12);
        assert_true(f.twin[3] == 1 && fabs(f.twin[5] - 3 * cases[n].mean) < 1e-12);
        bis_film_clear(&f);
    }
}

/* Of a picture of 400 x 240: sides of sqrt(96000 / 1500) = 8 pixels. All crops and tiles find the twins that the
 * picture has there, each once, and none elsewhere. */
static void crops_and_tiles_have_the_twins_of_their_picture(void **state)
{
    enum { W = 400, H = 240, SQUARES = 50 * 30 };
    static unsigned char has[H][W];
    const double crops[][4] = {{0, 1, 0, 1}, {0.1, 0.9, 0.31, 0.33}, {0.5, 0.503, 0, 1}, {0.999, 1, 0.999, 1}};
    for (size_t c = 0; c < sizeof crops / sizeof *crops; c++) {
        const bis_film f = bis_film_place(W, H, crops[c], 1);
        const bis_rect crop = bis_film_crop(&f);
        static unsigned char taken[SQUARES], again[H][W];
        int across;
        assert_int_equal(bis_film_twin_side(&f), 8);
        assert_true(bis_film_twins(&f) <= SQUARES && (c > 0 || bis_film_twins(&f) == SQUARES));
        memset(taken, 0, sizeof taken);
        memset(again, 0, sizeof again);
        for (bis_twin t = {0}; bis_film_next_twin(&f, crop, &t);) {
            assert_true(bis_is_in(crop, t.x, t.y) && t.at < bis_film_twins(&f) && !taken[t.at]++);
            assert_true(c == 0 || has[t.y][t.x]);
            has[t.y][t.x] = again[t.y][t.x] = 1;
        }
        for (int tile = 0; tile < bis_film_tiles(&f, 16, &across); tile++) {
            const bis_rect r = bis_film_tile_of_crop(&f, 16, tile);
            for (bis_twin t = {0}; bis_film_next_twin(&f, r, &t);) assert_true(again[t.y][t.x]++ == 1);
        }
        for (int i = 0; i < W * H; i++)
            if (bis_is_in(crop, i % W, i / W)) assert_int_equal(again[i / W][i % W], 2 * has[i / W][i % W]);
    }
}

/* At least 3 pixels a side, so that twins take a 9th of the samples, and no tile of 16 pixels has more than 36. */
static void small_pictures_have_a_twin_for_9_pixels(void **state)
{
    const bis_film f = bis_film_place(150, 90, whole, 1), one = bis_film_place(1, 1, whole, 1);
    int across;
    assert_int_equal(bis_film_twin_side(&f), 3);
    assert_int_equal(bis_film_twins(&f), 50 * 30);
    assert_int_equal(bis_film_twins(&one), 1);
    for (int tile = 0; tile < bis_film_tiles(&f, BIS_RENDER_TILE, &across); tile++) {
        int n = 0;
        for (bis_twin t = {0}; bis_film_next_twin(&f, bis_film_tile(&f, BIS_RENDER_TILE, tile), &t);) n++;
        assert_true(n >= 1 && n <= BIS_RENDER_TILE_TWINS);
    }
}

static void a_crop_without_pixels_or_outside_is_refused(void **state)
{
    const double bad[][4] = {{0.5, 0.5, 0, 1}, {0.6, 0.4, 0, 1}, {0, 1, 0.91, 0.99}, {-0.1, 1, 0, 1}, {0, 1.1, 0, 1},
        {0, (double)NAN, 0, 1}};
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
    static const char rest[] = "; it reads x0, x1, y0, y1 with x0 < x1, y0 < y1";
    static const struct { int step; double x0, x1; const char *thin; } cases[] = {
        {1, 0.1, 0.12, ""}, {2, 0, 0.1, " that a thin film has"}, {3, 0, 0.1, " that a thin film has"}};
    for (int i = 0; i < 3; i++) {
        char expected[256];
        bis_film f;
        bis_diag diag = {0};
        const double crop[4] = {cases[i].x0, cases[i].x1, 0, 1};
        assert_int_equal(bis_film_init_thin(&f, 8, 8, crop, cases[i].step, (bis_loc){0}, &diag), BIS_INPUT);
        snprintf(expected, sizeof expected, "error: the crop window %g, %g, 0, 1 holds no pixel of 8 x 8%s%s", crop[0],
            crop[1], cases[i].thin, rest);
        assert_string_equal(diag.messages[0].text, expected);
        bis_diag_clear(&diag);
    }
}

static void pixels_are_means_and_alpha_the_share_of_hits(void **state)
{
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
    for (int eighths = 1; eighths <= 8; eighths++)
        assert_true(alpha_after(1 << 20, eighths / 8.0) == eighths / 8.0);
    assert_true(alpha_after(1 << 21, 7 / 8.0) == 7 / 8.0);
    assert_true(alpha_after(1 << 22, 7 / 8.0) != 7 / 8.0); /* the test can see a rounding */
}

/* A third of weight 1 is rounded in each pass, in one direction as long as the sum has the same exponent. By hand: the
 * sum lies in [2^e, 2^(e+1)) for 3 2^e passes and has steps of u = 2^(e-23), so that each pass adds u round(1/(3u))
 * instead of 1/3, an error of u/3: with e even too much, with e odd too little. (The drift itself moves the powers of
 * two by 70 of 10^5 passes, each of which then errs by u/3 + u/6 otherwise: 0.6 % of the whole.) The bound is that of
 * film.c, 2^-25 (1/3) (n + 1), and half a step of float for the quotient. */
static void alpha_of_thirds_errs_by_less_than_the_bound(void **state)
{
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
        if (n >= 1e5 && !(fabs(error / (drift / n) - 1) < 0.01))
            fail_msg("alpha errs by %g, by hand %g", error, drift / n);
    }
}

static void a_film_without_passes_is_black(void **state)
{
    bis_film f;
    float rgba[4] = {1, 1, 1, 1};
    init(&f, 1, 1);
    bis_film_resolve(&f, rgba);
    for (int k = 0; k < 4; k++) assert_true(rgba[k] == 0);
    bis_film_clear(&f);
}

/* Two passes, weights 1 and 3, 2 x 1 pixels: means -0.25 and 0.5 in red, 1 and 1 in green, 0 in blue. */
static void a_mean_below_0_becomes_0_and_is_told(void **state)
{
    const double crop[4] = {0, 1, 0, 1};
    bis_film f;
    float rgba[8];

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
        cmocka_unit_test(a_crop_is_read_from_four_numbers),
        cmocka_unit_test(crop_is_rounded_as_pbrt_does),
        cmocka_unit_test(the_tiles_of_a_crop_are_those_of_its_picture),
        cmocka_unit_test(a_thin_film_has_the_middle_one_of_each_k_pixels),
        cmocka_unit_test(passes_have_a_deviation_and_a_first_half),
        cmocka_unit_test(crops_and_tiles_have_the_twins_of_their_picture),
        cmocka_unit_test(small_pictures_have_a_twin_for_9_pixels),
        cmocka_unit_test(a_crop_without_pixels_or_outside_is_refused),
        cmocka_unit_test(a_crop_without_pixels_of_a_thin_film_says_so),
        cmocka_unit_test(pixels_are_means_and_alpha_the_share_of_hits),
        cmocka_unit_test(alpha_of_eighths_is_exact_for_two_million_camera_samples),
        cmocka_unit_test(alpha_of_thirds_errs_by_less_than_the_bound),
        cmocka_unit_test(a_film_without_passes_is_black),
        cmocka_unit_test(a_mean_below_0_becomes_0_and_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
