/* SPDX-License-Identifier: BSD-2-Clause */
/* vec: each function by numbers that were worked out by hand. No two components are alike and each product counts, so
 * that an exchanged component or a wrong sign shows. Small integers and their halves are exact in a float. */
#include "bis/base/vec.h"

#include "bis/thesis/rng.h"
#include "claim.h"

#include <float.h>

static void assert_vec(vec3 a, double x, double y, double z)
{
    assert_true((double)a.x == x && (double)a.y == y && (double)a.z == z);
}

static void assert_rgb(rgb a, double r, double g, double b)
{
    assert_true((double)a.r == r && (double)a.g == g && (double)a.b == b);
}

static void assert_rgbd(rgbd a, double r, double g, double b) { assert_true(a.r == r && a.g == g && a.b == b); }

/* (2, 3, 5) x (7, -11, 13) = (3 13 + 5 11, 5 7 - 2 13, -2 11 - 3 7). */
static void vectors_are_calculated_with_by_component(void **state)
{
    const vec3 a = {2, 3, 5}, b = {7, -11, 13};
    assert_vec(vec3_from(0.1, -0.2, 0.3), (double)0.1f, (double)-0.2f, (double)0.3f);
    assert_vec(add(a, b), 9, -8, 18);
    assert_vec(sub(a, b), -5, 14, -8);
    assert_vec(neg(b), -7, 11, -13);
    assert_vec(mul(b, -0.5), -3.5, 5.5, -6.5);
    assert_true(dot(a, b) == 14 - 33 + 65);
    assert_vec(cross(a, b), 94, 9, -43);
    assert_true(length((vec3){2, -3, 6}) == 7);
    assert_vec(normalize((vec3){2, -3, 6}), (double)(2 / 7.f), (double)(-3 / 7.f), (double)(6 / 7.f));
}

/* Products of floats are exact in double: in float these would be 0, inf and inf. */
static void what_floats_cannot_hold_doubles_do(void **state)
{
    const float e = 0x1p-100f, big = 0x1p100f;
    assert_true(dot((vec3){e, 0, 0}, (vec3){e, 0, 0}) == 0x1p-200);
    assert_true(dot((vec3){big, 0, 0}, (vec3){big, 0, 0}) == 0x1p200);
    assert_true(length((vec3){0, 3 * big, 4 * big}) == 0x5p100);
    assert_true(rgb_sum((rgb){FLT_MAX, FLT_MAX, FLT_MAX}) == 3.0 * (double)FLT_MAX);
}

static void colours_are_calculated_with_by_channel(void **state)
{
    const rgb a = {2, 3, 5}, b = {7, 11, 13};
    assert_rgb(rgb_from(0.1, 0.2, 0.3), (double)0.1f, (double)0.2f, (double)0.3f);
    assert_rgb(rgb_add(a, b), 9, 14, 18);
    assert_rgb(rgb_mul(a, b), 14, 33, 65);
    assert_rgb(rgb_scale(b, 0.5), 3.5, 5.5, 6.5);
    assert_true(rgb_sum(b) == 31);
    const rgbd c = {2, 3, 5}, d = {7, 11, 13};
    assert_rgbd(rgbd_add(c, d), 9, 14, 18);
    assert_rgbd(rgbd_scale(d, 0.1), 7 * 0.1, 11 * 0.1, 13 * 0.1);
    assert_true(rgbd_sum(d) == 31);
    assert_rgb(rgbd_round((rgbd){0.1, 0.2, 0.3}), (double)0.1f, (double)0.2f, (double)0.3f);
}

/* What is asked of all three components is asked of each. */
static void each_component_is_asked(void **state)
{
    assert_true(vec3_is_finite((vec3){1, 2, FLT_MAX}) && rgb_is_finite((rgb){1, 2, FLT_MAX}));
    assert_true(rgb_is_black((rgb){0, -0.f, 0}));
    for (int k = 0; k < 3; k++) {
        const float bad[2] = {NAN, INFINITY};
        float c[3] = {1, 2, 3};
        for (int i = 0; i < 2; i++) {
            c[k] = bad[i];
            assert_false(vec3_is_finite((vec3){c[0], c[1], c[2]}));
            assert_false(rgb_is_finite((rgb){c[0], c[1], c[2]}));
        }
        c[k] = 9;
        assert_true(rgb_max((rgb){c[0], c[1], c[2]}) == 9);
        assert_false(rgb_is_black((rgb){(float)(k == 0), (float)(k == 1), (float)(k == 2)}));
    }
}

/* In the frame of x = +y, y = +z, z = +x the vector (2, 3, 5) is (3, 5, 2). */
static void a_frame_s_coordinates_are_the_parts_along_its_axes(void **state)
{
    const frame f = {{0, 1, 0}, {0, 0, 1}, {1, 0, 0}};
    assert_vec(to_local(&f, (vec3){2, 3, 5}), 3, 5, 2);
    assert_vec(to_world(&f, (vec3){3, 5, 2}), 2, 3, 5);
}

static void assert_basis(vec3 z)
{
    const frame f = frame_about(z);
    const vec3 w = to_world(&f, to_local(&f, (vec3){2, 3, 5})), third = sub(cross(f.x, f.y), f.z);
    assert_true(f.z.x == z.x && f.z.y == z.y && f.z.z == z.z);
    assert_true(fabs(length(f.x) - 1) < 1e-6 && fabs(length(f.y) - 1) < 1e-6);
    assert_true(fabs(dot(f.x, f.y)) < 1e-6 && fabs(dot(f.x, f.z)) < 1e-6 && fabs(dot(f.y, f.z)) < 1e-6);
    assert_true(length(third) < 2e-6); /* right-handed; three components, each wrong by 1e-6 */
    assert_true(length(sub(w, (vec3){2, 3, 5})) < 4e-5); /* length 6.2, six components of 1e-6 each */
}

/* Directions all around, the poles, and directions beside them, where other formulas fail. */
static void a_frame_about_any_direction_is_orthonormal_and_right_handed(void **state)
{
    bis_rng g;
    bis_rng_init(&g, 5, 0, 0, 0);
    for (int i = 0; i < 20000; i++) {
        double c[3];
        for (int k = 0; k < 3; k++) c[k] = 2 * bis_rng_double(&g) - 1;
        assert_basis(normalize(vec3_from(c[0], c[1], c[2])));
        const double small = pow(10, -12 * bis_rng_double(&g)); /* from the pole on */
        assert_basis(normalize(vec3_from(small * c[0], small * c[1], i % 2 ? 1 : -1)));
    }
    assert_basis((vec3){0, 0, 1});
    assert_basis((vec3){0, 0, -1});
    assert_basis((vec3){0, 1, -0.f});
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(vectors_are_calculated_with_by_component),
        cmocka_unit_test(what_floats_cannot_hold_doubles_do),
        cmocka_unit_test(colours_are_calculated_with_by_channel),
        cmocka_unit_test(each_component_is_asked),
        cmocka_unit_test(a_frame_s_coordinates_are_the_parts_along_its_axes),
        cmocka_unit_test(a_frame_about_any_direction_is_orthonormal_and_right_handed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
