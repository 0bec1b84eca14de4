/* SPDX-License-Identifier: BSD-2-Clause */
/* camera: rays against pbrt's formulas worked by hand. With `LookAt 0 0 5  0 0 0  0 1 0` the eye stands on +z and looks
 * along -z; in a left-handed world, +x is then on the LEFT of the picture (turn round: what was to the right is to the
 * left). */
#include "bis/scene/camera.h"
#include "claim.h"

#include <string.h>

/* A float has 2^-24 relative error; a unit vector's components at most that. */
#define ULP 0x1p-23

static bis_camera perspective(double fov, const double eye[3], const double look[3], const double up[3])
{
    bis_xform world_to_camera;
    assert_true(bis_xform_look_at(&world_to_camera, eye, look, up));
    return (bis_camera){.fov_deg = fov, .to_world = bis_xform_inverse(&world_to_camera)};
}

static void assert_vec3(vec3 v, double x, double y, double z)
{
    assert_true(fabs((double)v.x - x) <= ULP);
    assert_true(fabs((double)v.y - y) <= ULP);
    assert_true(fabs((double)v.z - z) <= ULP);
}

static const double from_z[3] = {0, 0, 5}, origin[3] = {0, 0, 0}, y_up[3] = {0, 1, 0};

/* fov 90 spans the shorter side: at its rim the ray leaves the axis by 45 degrees; at the longer side's rim the tangent
 * is 4/3. */
static void fov_spans_the_shorter_side(void **state)
{
    bis_camera c = perspective(90, from_z, origin, y_up);
    assert_vec3(bis_camera_ray(&c, 640, 480, 320, 0).d, 0, sqrt(0.5), -sqrt(0.5));
    assert_vec3(bis_camera_ray(&c, 640, 480, 320, 480).d, 0, -sqrt(0.5), -sqrt(0.5));
    assert_vec3(bis_camera_ray(&c, 480, 640, 0, 320).d, sqrt(0.5), 0, -sqrt(0.5));
    assert_vec3(bis_camera_ray(&c, 640, 480, 0, 240).d, 4.0 / 5, 0, -3.0 / 5);
    assert_vec3(bis_camera_ray(&c, 640, 480, 640, 240).d, -4.0 / 5, 0, -3.0 / 5);
}

static void scale_minus_one_mirrors_the_picture(void **state)
{
    bis_xform look, mirror = bis_xform_scale(-1, 1, 1);
    assert_true(bis_xform_look_at(&look, from_z, origin, y_up));
    bis_xform ctm = bis_xform_compose(&mirror, &look); /* Scale -1 1 1, then LookAt */
    bis_camera c = perspective(60, from_z, origin, y_up), m = c;
    m.to_world = bis_xform_inverse(&ctm);
    for (int x = 0; x <= 64; x += 16) {
        ray a = bis_camera_ray(&c, 64, 48, x, 10), b = bis_camera_ray(&m, 64, 48, 64 - x, 10);
        assert_vec3(b.d, (double)a.d.x, (double)a.d.y, (double)a.d.z);
    }
}

/* The centre of pixel (x, y) of w x h at fov f: camera-space direction ((2(x+.5)/w - 1) a, 1 - 2(y+.5)/h, 1/tan(f/2)),
 * a = w/h > 1. */
static void pixel_centres_have_pbrts_directions(void **state)
{
    const int w = 20, h = 10;
    const double fov = 37, depth = 1 / tan(fov * PI / 360);
    bis_camera c = {.fov_deg = fov, .to_world = bis_xform_identity()};
    for (int y = 0; y < h; y++)
        for (int x = 0; x < w; x++) {
            double d[3] = {(2 * (x + 0.5) / w - 1) * w / h, 1 - 2 * (y + 0.5) / h, depth};
            double n = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
            assert_vec3(bis_camera_ray(&c, w, h, x + 0.5, y + 0.5).d, d[0] / n, d[1] / n, d[2] / n);
        }
}

static void a_screen_window_replaces_the_films_shape(void **state)
{
    bis_camera c = {.fov_deg = 90, .has_screen = true, .screen = {0, 1, -0.5, 0.5}, .to_world = bis_xform_identity()};
    assert_vec3(bis_camera_ray(&c, 64, 16, 0, 8).d, 0, 0, 1);
    assert_vec3(bis_camera_ray(&c, 64, 16, 64, 8).d, sqrt(0.5), 0, sqrt(0.5));
}

static void frame_aspect_replaces_width_by_height(void **state)
{
    bis_camera c = {.fov_deg = 90, .frame_aspect = 0.5, .to_world = bis_xform_identity()};
    assert_vec3(bis_camera_ray(&c, 64, 16, 64, 8).d, sqrt(0.5), 0, sqrt(0.5));
    assert_vec3(bis_camera_ray(&c, 64, 16, 32, 0).d, 0, 2 / sqrt(5), 1 / sqrt(5));
}

static void orthographic_rays_are_parallel_and_start_on_the_screen(void **state)
{
    bis_xform look, zoom = bis_xform_scale(0.5, 0.5, 1);
    assert_true(bis_xform_look_at(&look, from_z, origin, y_up));
    bis_xform ctm = bis_xform_compose(&zoom, &look); /* the world halved: the screen shows twice as much */
    bis_camera c = {.orthographic = true, .to_world = bis_xform_inverse(&ctm)};
    for (int y = 0; y <= 100; y += 25)
        for (int x = 0; x <= 200; x += 50) {
            ray r = bis_camera_ray(&c, 200, 100, x, y);
            assert_vec3(r.d, 0, 0, -1);
            assert_true(fabs((double)r.o.x - 2 * (2 - x / 50.0)) <= 4 * ULP);
            assert_true(fabs((double)r.o.y - 2 * (1 - y / 50.0)) <= 4 * ULP);
            assert_true(fabs((double)r.o.z - 5) <= 8 * ULP);
        }
}

/* fov 179.9 and 0.01: neighbouring pixels still differ by what trigonometry says. */
static void extreme_fields_of_view_keep_their_precision(void **state)
{
    for (int k = 0; k < 2; k++) {
        const double fov = k ? 0.01 : 179.9, half = tan(fov * PI / 360);
        bis_camera c = {.fov_deg = fov, .to_world = bis_xform_identity()};
        vec3 d = bis_camera_ray(&c, 100, 100, 51, 50).d;
        assert_true(fabs((double)d.x / (double)d.z / (0.02 * half) - 1) < 4 * ULP);
    }
}

/* Of a window [x0, x1] x [y0, y1] that is turned and moved, each corner is an extreme of some axis: the least of a sum
 * is the sum of the least parts. A perspective camera stands in one point. */
static void the_box_of_the_eyes_holds_each_corner_of_the_window(void **state)
{
    for (int i = 0; i < 12; i++) {
        const bis_xform turn = bis_xform_rotate(30 * i + 10, 1, 2, 5), move = bis_xform_translate(3, -7, 20);
        const bis_camera c = {.orthographic = i % 3 > 0, .fov_deg = 50, .has_screen = true, .screen = {-1, 2, -3, 5},
                              .to_world = bis_xform_compose(&move, &turn)};
        double box[6];
        bis_camera_eyes(&c, 40, 30, box);
        for (int k = 0; k < 3; k++) {
            const double *m = c.to_world.m[k], share = c.orthographic ? 1 : 0;
            const double lo = share * (fmin(-m[0], 2 * m[0]) + fmin(-3 * m[1], 5 * m[1])) + m[3],
                         hi = share * (fmax(-m[0], 2 * m[0]) + fmax(-3 * m[1], 5 * m[1])) + m[3];
            assert_true(fabs(box[k] - lo) < 1e-12 && fabs(box[3 + k] - hi) < 1e-12);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fov_spans_the_shorter_side),
        cmocka_unit_test(the_box_of_the_eyes_holds_each_corner_of_the_window),
        cmocka_unit_test(scale_minus_one_mirrors_the_picture),
        cmocka_unit_test(pixel_centres_have_pbrts_directions),
        cmocka_unit_test(a_screen_window_replaces_the_films_shape),
        cmocka_unit_test(frame_aspect_replaces_width_by_height),
        cmocka_unit_test(orthographic_rays_are_parallel_and_start_on_the_screen),
        cmocka_unit_test(extreme_fields_of_view_keep_their_precision),
    };
    return cmocka_run_group_tests_name("camera", tests, NULL, NULL);
}
