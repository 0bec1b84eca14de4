/* SPDX-License-Identifier: BSD-2-Clause */
/* compare: the figures of `bis compare --help`, by hand, by the formulas written out, and at the edges.
 */
#include "bis/tools/compare.h"
#include "bis/thesis/rng.h"

#include "claim.h"
#include "stat.h"

#include <math.h>

static void init(bis_image *image, int width, int height, double scale, uint64_t seed)
{
    bis_rng rng;
    bis_rng_init(&rng, seed, 0, 0, 0);
    assert_int_equal(bis_image_init(image, width, height, NULL), BIS_OK);
    for (int i = 0; i < width * height; i++) {
        double r = bis_rng_double(&rng), g = bis_rng_double(&rng), b = bis_rng_double(&rng);
        image->pixels[i] = rgb_from(scale * r, scale * g, scale * b);
    }
}

static void assert_near(double a, double b)
{
    if (!(fabs(a - b) <= 1e-12 * fabs(b))) fail_msg("%.17g is not %.17g", a, b);
}

static void equal_images_differ_by_nothing(void **state)
{
    bis_image a, b;
    bis_comparison c;
    init(&a, 5, 3, 1, 1);
    init(&b, 5, 3, 1, 1);
    assert_int_equal(bis_compare(&c, &a, &b, NULL), BIS_OK);
    assert_true(c.bias == 0 && c.bias_se == 0 && c.rmse == 0 && c.relmse == 0 && c.max_abs == 0);
    assert_true(c.mean_a == c.mean_b && c.mean_a > 0);
    assert_int_equal(c.pixels, 15);
    assert_int_equal(c.nonfinite, 0);
    bis_image_clear(&a);
    bis_image_clear(&b);
}

/* a = (1,2,3) (4,4,4); b = (1,1,1) (5,5,5): m = 3, m^2/100 = 0.09. */
static void two_pixels_give_what_the_formulas_give_by_hand(void **state)
{
    rgb pa[2] = {{1, 2, 3}, {4, 4, 4}}, pb[2] = {{1, 1, 1}, {5, 5, 5}};
    const bis_image a = {2, 1, pa, NULL}, b = {2, 1, pb, NULL};
    bis_comparison c;
    assert_int_equal(bis_compare(&c, &a, &b, NULL), BIS_OK);
    assert_near(c.mean_a, 3);
    assert_near(c.mean_b, 3);
    assert_true(fabs(c.bias) < 1e-15);
    assert_near(c.bias_se, sqrt(2) / sqrt(2)); /* differences 1 and -1 */
    assert_near(c.rmse, sqrt((0 + 1 + 4 + 3) / 6.0));
    assert_near(c.relmse, (5 / 1.09 + 3 / 25.09) / 6);
    assert_near(c.max_abs, 2);
}

static void random_images_give_the_formulas_of_the_contract(void **state)
{
    bis_image a, b;
    bis_comparison c;
    init(&a, 17, 11, 2, 1);
    init(&b, 17, 11, 1, 2);
    assert_int_equal(bis_compare(&c, &a, &b, NULL), BIS_OK);

    const float *va = &a.pixels[0].r, *vb = &b.pixels[0].r;
    double mean_a = 0, mean_b = 0, rmse = 0, relmse = 0;
    int n = 3 * 17 * 11;
    stat_moments difference = {0};
    for (int i = 0; i < n; i++) {
        mean_a += (double)va[i] / n;
        mean_b += (double)vb[i] / n;
    }
    for (int i = 0; i < n; i++) {
        double d = (double)va[i] - (double)vb[i], v = (double)vb[i];
        rmse += d * d / n;
        relmse += d * d / (v * v + mean_b * mean_b / 100) / n;
    }
    for (int i = 0; i < n / 3; i++) stat_add(&difference, (rgb_sum(a.pixels[i]) - rgb_sum(b.pixels[i])) / 3);
    assert_near(c.mean_a, mean_a);
    assert_near(c.mean_b, mean_b);
    assert_near(c.bias, mean_a - mean_b);
    assert_near(c.rmse, sqrt(rmse));
    assert_near(c.relmse, relmse);
    assert_near(c.bias_se, sqrt(stat_variance(&difference) / (n / 3)));
    bis_image_clear(&a);
    bis_image_clear(&b);
}

static void exchanging_the_images_changes_relmse_since_b_is_the_reference(void **state)
{
    bis_image a, b;
    bis_comparison ab, ba;
    init(&a, 9, 9, 3, 1);
    init(&b, 9, 9, 1, 2);
    bis_compare(&ab, &a, &b, NULL);
    bis_compare(&ba, &b, &a, NULL);
    assert_true(ab.bias == -ba.bias && ab.rmse == ba.rmse);
    assert_true(ab.relmse > 2 * ba.relmse);
    bis_image_clear(&a);
    bis_image_clear(&b);
}

static void pixels_that_are_not_finite_are_counted_and_left_out(void **state)
{
    bis_image a, b;
    bis_comparison c, without;
    init(&a, 4, 2, 1, 1);
    init(&b, 4, 2, 1, 2);
    const bis_image first_a = {4, 1, a.pixels, NULL}, first_b = {4, 1, b.pixels, NULL};
    bis_compare(&without, &first_a, &first_b, NULL);
    a.pixels[4].r = NAN;
    a.pixels[5].g = INFINITY;
    b.pixels[6].b = -INFINITY;
    b.pixels[7].r = NAN;
    a.pixels[7].g = NAN;
    assert_int_equal(bis_compare(&c, &a, &b, NULL), BIS_OK);
    assert_int_equal(c.nonfinite, 4);
    assert_int_equal(c.pixels, 4);
    assert_true(c.relmse == without.relmse && c.bias == without.bias && c.mean_b == without.mean_b &&
                c.bias_se == without.bias_se);
    bis_image_clear(&a);
    bis_image_clear(&b);
}

static void no_comparable_pixel_gives_nan_not_agreement(void **state)
{
    rgb pa[1] = {{NAN, 0, 0}}, pb[1] = {{0, 0, 0}};
    const bis_image a = {1, 1, pa, NULL}, b = {1, 1, pb, NULL};
    bis_comparison c;
    assert_int_equal(bis_compare(&c, &a, &b, NULL), BIS_OK);
    assert_true(isnan(c.relmse) && isnan(c.rmse) && isnan(c.bias) && isnan(c.max_abs));
    assert_int_equal(c.nonfinite, 1);
}

static void a_black_reference_is_infinitely_far_from_all_but_itself(void **state)
{
    rgb pa[2] = {{0, 0, 0}, {0, 1, 0}}, pb[2] = {{0, 0, 0}, {0, 0, 0}};
    const bis_image a = {2, 1, pa, NULL}, b = {2, 1, pb, NULL};
    bis_comparison c;
    bis_compare(&c, &a, &b, NULL);
    assert_true(isinf(c.relmse) && c.relmse > 0);
    bis_compare(&c, &b, &b, NULL);
    assert_true(c.relmse == 0);
}

static void images_of_other_sizes_are_refused_by_name_of_the_sizes(void **state)
{
    bis_image a, b, picture;
    bis_comparison c;
    bis_diag diag = {0};
    init(&a, 4, 2, 1, 1);
    init(&b, 2, 4, 1, 1);
    assert_int_equal(bis_compare(&c, &a, &b, &diag), BIS_INPUT);
    assert_string_equal(
        diag.messages[0].text, "error: images of 4 x 2 and 2 x 4 pixels cannot be compared; sizes must be equal");
    assert_int_equal(bis_compare_picture(&picture, &a, &b, &diag), BIS_INPUT);
    bis_diag_clear(&diag);
    bis_image_clear(&a);
    bis_image_clear(&b);
}

/* With b = 1 everywhere the relative difference is (a - 1)/sqrt(1.01). */
static void colours_run_from_black_over_blue_red_yellow_to_white(void **state)
{
    enum { N = 7 };
    const double error[N] = {0, 1e-3, 1e-2, 1e-1, 1, 10, 1000};
    const rgb colour[N] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {1, 1, 0}, {1, 1, 1}, {1, 1, 1}};
    bis_image a, b, picture;
    bis_image_init(&a, N + 1, 1, NULL);
    bis_image_init(&b, N + 1, 1, NULL);
    for (int i = 0; i < N; i++) {
        double v = 1 + error[i] * sqrt(1.01);
        a.pixels[i] = rgb_from(v, v, v);
        b.pixels[i] = (rgb){1, 1, 1};
    }
    a.pixels[N].r = NAN;
    assert_int_equal(bis_compare_picture(&picture, &a, &b, NULL), BIS_OK);
    for (int i = 0; i < N; i++) { /* the smallest error has lost 4 digits in 1 + error as float */
        assert_true(fabs((double)(picture.pixels[i].r - colour[i].r)) < 1e-3);
        assert_true(fabs((double)(picture.pixels[i].g - colour[i].g)) < 1e-3);
        assert_true(fabs((double)(picture.pixels[i].b - colour[i].b)) < 1e-3);
    }
    assert_true(
        picture.pixels[N].r == 1 && picture.pixels[N].g == 0 && picture.pixels[N].b == 1); /* magenta: not finite */
    bis_image_clear(&a);
    bis_image_clear(&b);
    bis_image_clear(&picture);
}

/* bias / bias_se is a standard normal where both images have the same mean; tested at 0.01, with a twin of which a is
 * 2% brighter. */
static void bias_se_is_the_standard_error_of_the_bias(void **state)
{
    const uint64_t seed = 11;
    stat_moments z = {0}, z_squared = {0}, twin = {0};
    for (uint64_t i = 0; i < 400; i++) {
        bis_image a, b;
        bis_comparison c;
        init(&a, 32, 32, 1, seed + 2 * i);
        init(&b, 32, 32, 1, seed + 2 * i + 1);
        bis_compare(&c, &a, &b, NULL);
        stat_add(&z, c.bias / c.bias_se);
        stat_add(&z_squared, c.bias / c.bias_se * (c.bias / c.bias_se));
        stat_add(&twin, c.bias / c.bias_se + 0.02 * 0.5 / c.bias_se);
        bis_image_clear(&a);
        bis_image_clear(&b);
    }
    const double alpha = stat_level(0.01, 2);
    stat_assert_mean("compare_bias", seed, &z, 0, alpha);
    stat_assert_mean("compare_bias_squared", seed, &z_squared, 1, alpha);
    stat_assert_not_mean("compare_bias_twin", seed, &twin, 0, alpha);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_images_differ_by_nothing),
        cmocka_unit_test(two_pixels_give_what_the_formulas_give_by_hand),
        cmocka_unit_test(random_images_give_the_formulas_of_the_contract),
        cmocka_unit_test(exchanging_the_images_changes_relmse_since_b_is_the_reference),
        cmocka_unit_test(pixels_that_are_not_finite_are_counted_and_left_out),
        cmocka_unit_test(no_comparable_pixel_gives_nan_not_agreement),
        cmocka_unit_test(a_black_reference_is_infinitely_far_from_all_but_itself),
        cmocka_unit_test(images_of_other_sizes_are_refused_by_name_of_the_sizes),
        cmocka_unit_test(colours_run_from_black_over_blue_red_yellow_to_white),
        cmocka_unit_test(bias_se_is_the_standard_error_of_the_bias),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
