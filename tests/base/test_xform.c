/* SPDX-License-Identifier: BSD-2-Clause */
/* xform: conventions pinned by hand-computed points, inverses by composition. */
#include "bis/thesis/rng.h"
#include "bis/base/xform.h"
#include "claim.h"

#include <float.h>

/* Not by cmocka's assert_float_equal, because that takes NaN for any number. */
static void assert_vec3(vec3 a, double x, double y, double z)
{
    const double tolerance = 4 * (double)FLT_EPSILON;
    assert_true(fabs((double)a.x - x) <= tolerance * (1 + fabs(x)));
    assert_true(fabs((double)a.y - y) <= tolerance * (1 + fabs(y)));
    assert_true(fabs((double)a.z - z) <= tolerance * (1 + fabs(z)));
}

/* Largest element of |m inv - 1| relative to what rounding may leave: |m| |inv| DBL_EPSILON. */
static double inverse_error(const bis_xform *t)
{
    double worst = 0;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) {
            double sum = 0, size = 0;
            for (int k = 0; k < 4; k++) {
                sum += t->m[i][k] * t->inv[k][j];
                size += fabs(t->m[i][k] * t->inv[k][j]);
            }
            if (size > 0) worst = fmax(worst, fabs(sum - (i == j)) / (size * DBL_EPSILON));
        }
    return worst;
}

static void translate_moves_points_and_leaves_vectors_and_normals(void **state)
{
    bis_xform t = bis_xform_translate(1, -2, 3);
    assert_vec3(bis_xform_point(&t, (vec3){10, 10, 10}), 11, 8, 13);
    assert_vec3(bis_xform_vector(&t, (vec3){10, 10, 10}), 10, 10, 10);
    assert_vec3(bis_xform_normal(&t, (vec3){0, 1, 0}), 0, 1, 0);
    bis_xform back = bis_xform_inverse(&t);
    assert_vec3(bis_xform_point(&back, (vec3){11, 8, 13}), 10, 10, 10);
}

static void rotate_turns_x_to_y_about_z_exactly_at_right_angles(void **state)
{
    for (int turns = -8; turns <= 8; turns++) {
        bis_xform t = bis_xform_rotate(90.0 * turns, 0, 0, 5);
        const float x[] = {1, 0, -1, 0}, y[] = {0, 1, 0, -1};
        vec3 v = bis_xform_vector(&t, (vec3){1, 0, 0});
        assert_true(v.x == x[turns & 3] && v.y == y[turns & 3] && v.z == 0);
    }
    bis_xform t = bis_xform_rotate(30, 0, 0, 1);
    assert_vec3(bis_xform_vector(&t, (vec3){1, 0, 0}), sqrt(0.75), 0.5, 0);
    t = bis_xform_rotate(120, 1, 1, 1); /* permutes the axes */
    assert_vec3(bis_xform_point(&t, (vec3){1, 2, 3}), 3, 1, 2);
}

/* Another road: what lies along the axis stays, what lies across it turns in its plane, by the C library's sine and
 * cosine. */
static void any_angle_turns_about_any_axis(void **state)
{
    bis_rng r;
    bis_rng_init(&r, 3, 0, 0, 0);
    for (int i = 0; i < 2000; i++) {
        const double degrees = 2000 * bis_rng_double(&r) - 1000, angle = degrees / 180 * acos(-1.0);
        double k[3], v[3], along = 0, square = 0;
        for (int j = 0; j < 3; j++) {
            k[j] = 2 * bis_rng_double(&r) - 1;
            v[j] = 2 * bis_rng_double(&r) - 1;
            along += k[j] * v[j];
            square += k[j] * k[j];
        }
        const bis_xform t = bis_xform_rotate(degrees, k[0], k[1], k[2]);
        for (int j = 0; j < 3; j++) {
            const int a = (j + 1) % 3, b = (j + 2) % 3;
            const double parallel = along / square * k[j], beside = (k[a] * v[b] - k[b] * v[a]) / sqrt(square);
            const double expected = parallel + (v[j] - parallel) * cos(angle) + beside * sin(angle);
            const double found = t.m[j][0] * v[0] + t.m[j][1] * v[1] + t.m[j][2] * v[2];
            assert_true(fabs(found - expected) < 1e-13);
            assert_true(t.m[j][3] == 0 && t.m[3][j] == 0 && t.inv[j][3] == 0 && t.inv[3][j] == 0);
            for (int l = 0; l < 3; l++) assert_true(t.inv[l][j] == t.m[j][l]);
        }
        assert_true(t.m[3][3] == 1 && t.inv[3][3] == 1);
    }
}

static void normals_stay_perpendicular_to_the_surface(void **state)
{
    bis_rng r;
    bis_rng_init(&r, 1, 0, 0, 0);
    for (int i = 0; i < 1000; i++) {
        double v[16];
        for (int j = 0; j < 16; j++)
            v[j] = 2 * bis_rng_double(&r) - 1;
        v[3] = v[7] = v[11] = 0, v[15] = 1;
        bis_xform t;
        if (!bis_xform_from_columns(&t, v)) continue;
        vec3 tangent = {1, 2, 0}, normal = {2, -1, 3};
        vec3 n = bis_xform_normal(&t, normal), w = bis_xform_vector(&t, tangent);
        assert_true(fabs(dot(n, w)) <= 4 * (double)FLT_EPSILON * length(n) * length(w));
    }
}

static void look_at_follows_pbrts_worked_matrix(void **state)
{
    /* From (3, 4, 1.5) at (.5, .5, 0), up z: the first camera of pbrt-v3's manual. right = up x forward, by hand. */
    const double eye[3] = {3, 4, 1.5}, look[3] = {.5, .5, 0}, up[3] = {0, 0, 1};
    const double f = sqrt(2.5 * 2.5 + 3.5 * 3.5 + 1.5 * 1.5), h = sqrt(2.5 * 2.5 + 3.5 * 3.5);
    bis_xform t;
    assert_true(bis_xform_look_at(&t, eye, look, up));
    assert_vec3(bis_xform_vector(&t, vec3_from(-2.5 / f, -3.5 / f, -1.5 / f)), 0, 0, 1);
    assert_vec3(bis_xform_vector(&t, vec3_from(3.5 / h, -2.5 / h, 0)), 1, 0, 0);
    assert_vec3(bis_xform_vector(&t, vec3_from(-2.5 * 1.5 / (f * h), -3.5 * 1.5 / (f * h), h / f)), 0, 1, 0);
    assert_true(inverse_error(&t) < 8 && bis_xform_is_orthonormal(&t, 1e-15));
    assert_vec3(bis_xform_point(&t, (vec3){3, 4, 1.5f}), 0, 0, 0);
}

static void an_impossible_camera_is_refused(void **state)
{
    const double eye[3] = {.1, .2, .3}, far_eye[3] = {.3, .6, .9}, zero[3] = {0, 0, 0}, up[3] = {.1, .2, .3};
    const double nan_up[3] = {0, nan(""), 1}, oblique[3] = {0, 1, 0};
    bis_xform t;
    assert_false(bis_xform_look_at(&t, eye, eye, oblique));
    assert_false(bis_xform_look_at(&t, eye, far_eye, up)); /* parallel, but not to the last bit */
    assert_false(bis_xform_look_at(&t, zero, up, up));
    assert_false(bis_xform_look_at(&t, eye, zero, zero));
    assert_false(bis_xform_look_at(&t, eye, zero, nan_up));
    assert_true(bis_xform_look_at(&t, eye, far_eye, oblique));
}

static void any_regular_matrix_is_inverted(void **state)
{
    bis_rng r;
    bis_rng_init(&r, 2, 0, 0, 0);
    for (int i = 0; i < 1000; i++) {
        double v[16];
        for (int j = 0; j < 16; j++)
            v[j] = (2 * bis_rng_double(&r) - 1) * pow(10, (double)(i % 5) - 2);
        bis_xform t;
        assert_true(bis_xform_from_columns(&t, v));
        assert_true(inverse_error(&t) < 1000); /* Cramer's rule loses a few digits where det is nearly 0 */
    }
    bis_xform t;
    const double projective[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2, 1, 0, 0, -1, 0};
    assert_true(bis_xform_from_columns(&t, projective));
    assert_vec3(bis_xform_point(&t, (vec3){4, 2, 2}), 2, 1, 1.5);
    assert_true(inverse_error(&t) == 0);
}

static void singular_and_non_finite_matrices_are_refused(void **state)
{
    const double rank2[16] = {1, 4, 7, 0, 2, 5, 8, 0, 3, 6, 9, 0, 0, 0, 0, 1};
    const double zeros[16] = {0};
    const double bad[16] = {nan(""), 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    const double huge[16] = {1e200, 0, 0, 0, 0, 1e200, 0, 0, 0, 0, 1e200, 0, 0, 0, 0, 1};
    bis_xform t;
    assert_false(bis_xform_from_columns(&t, rank2));
    assert_false(bis_xform_from_columns(&t, zeros));
    assert_false(bis_xform_from_columns(&t, bad));
    assert_false(bis_xform_from_columns(&t, huge));
}

static void compose_applies_the_right_one_first(void **state)
{
    bis_xform move = bis_xform_translate(1, 0, 0), grow = bis_xform_scale(2, 3, 4);
    bis_xform t = bis_xform_compose(&move, &grow), s = bis_xform_compose(&grow, &move);
    assert_vec3(bis_xform_point(&t, (vec3){1, 1, 1}), 3, 3, 4);
    assert_vec3(bis_xform_point(&s, (vec3){1, 1, 1}), 4, 3, 4);
    assert_true(inverse_error(&t) <= 1 && inverse_error(&s) <= 1);
}

static void only_rotations_and_reflections_are_orthonormal(void **state)
{
    bis_xform mirror = bis_xform_scale(-1, 1, 1), grow = bis_xform_scale(1, 1, 1.001), one = bis_xform_identity();
    assert_true(bis_xform_is_orthonormal(&mirror, 0));
    assert_true(bis_xform_is_orthonormal(&one, 0));
    assert_false(bis_xform_is_orthonormal(&grow, 1e-3));
    assert_true(bis_xform_is_orthonormal(&grow, 2.1e-3));
    grow.m[0][0] = nan("");
    assert_false(bis_xform_is_orthonormal(&grow, 1));
    bis_xform skew = bis_xform_identity(), move = bis_xform_translate(1, 2, 3);
    skew.m[0][1] = 0.28; /* unit columns of which two are not perpendicular */
    skew.m[1][1] = 0.96;
    assert_false(bis_xform_is_orthonormal(&skew, 0.279));
    assert_true(bis_xform_is_orthonormal(&move, 0));
}

/* A rotation or a reflection with three digits after the point, moved: columns become orthonormal to the last digits,
 * the first keeps its direction, the second stays in the plane of the first two, the third on its side of that. */
static void the_nearest_rotation_keeps_the_first_column_and_the_hand(void **state)
{
    bis_rng g;
    bis_rng_init(&g, 4, 0, 0, 0);
    for (int k = 0; k < 500; k++) {
        bis_xform t = bis_xform_rotate(360 * bis_rng_double(&g), 1, bis_rng_double(&g), bis_rng_double(&g));
        for (int i = 0; i < 3; i++) {
            for (int j = 0; j < 3; j++) t.m[i][j] = round(1000 * t.m[i][j] * (k % 2 && j == 2 ? -1 : 1)) / 1000;
            t.m[i][3] = 5 + i;
        }
        const bis_xform r = bis_xform_rotation(&t);
        double along[3][3]; /* column a of r times column b of t */
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++) {
                double unit = 0;
                along[a][b] = 0;
                for (int i = 0; i < 3; i++) {
                    along[a][b] += r.m[i][a] * t.m[i][b];
                    unit += r.m[i][a] * r.m[i][b];
                }
                assert_true(fabs(unit - (a == b)) < 1e-15);
                assert_true(r.inv[a][b] == r.m[b][a]);
            }
        assert_true(fabs(along[1][0]) < 1e-15 && fabs(along[2][0]) < 1e-15 && fabs(along[2][1]) < 1e-15);
        for (int a = 0; a < 3; a++) {
            assert_true(along[a][a] > 0.99);
            assert_true(r.m[a][3] == 0 && r.inv[a][3] == 0 && r.m[3][a] == 0 && r.inv[3][a] == 0);
        }
        assert_true(r.m[3][3] == 1 && r.inv[3][3] == 1);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(translate_moves_points_and_leaves_vectors_and_normals),
        cmocka_unit_test(rotate_turns_x_to_y_about_z_exactly_at_right_angles),
        cmocka_unit_test(any_angle_turns_about_any_axis),
        cmocka_unit_test(normals_stay_perpendicular_to_the_surface),
        cmocka_unit_test(look_at_follows_pbrts_worked_matrix),
        cmocka_unit_test(an_impossible_camera_is_refused),
        cmocka_unit_test(any_regular_matrix_is_inverted),
        cmocka_unit_test(singular_and_non_finite_matrices_are_refused),
        cmocka_unit_test(compose_applies_the_right_one_first),
        cmocka_unit_test(only_rotations_and_reflections_are_orthonormal),
        cmocka_unit_test(the_nearest_rotation_keeps_the_first_column_and_the_hand),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
