/* SPDX-License-Identifier: BSD-2-Clause */
/* What floats of Embree cannot reach: where it is only the default, the grid takes over and says so; where it was asked
 * for, the program refuses. Expected messages are written out; expected pictures come from the grid. */
#include "bis/shape/accel.h"
#include "claim.h"
#include "mesh_help.h"
#include "program.h"

#include <stdio.h>
#include <string.h>

#define FOLDER "build/test_reach"
#define WAY_OUT ": scale the scene, or use the accelerator \"grid\" (--accelerator grid)"

/* A ball of this radius seen from its outside by a camera placed by `place`. */
static void write_scene(const char *place, const char *camera, const char *shape)
{
    char text[2000];

    snprintf(text, sizeof text,
             "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 6 \"string filename\" "
             "\"" FOLDER "/film.pfm\"\n"
             "Sampler \"random\" \"integer pixelsamples\" 1\nIntegrator \"brdf\" \"integer samples\" 1\n%s\nCamera %s\n"
             "WorldBegin\nLightSource \"infinite\" \"rgb L\" [1 1 1]\nMaterial \"phong\" \"rgb Kd\" [0.5 0.5 "
             "0.5]\nShape %s\n", place, camera, shape);
    program_write_file(FOLDER "/scene.txt", text);
}

static const char perspective[] = "\"perspective\" \"float fov\" 40";
static const char orthographic[] = "\"orthographic\" \"float screenwindow\" [-3e38 3e38 -1 1]";
static const char ball[] = "\"sphere\" \"float radius\" 1";
static const char floor_of[] =
    "\"trianglemesh\" \"point3 P\" [-%s -%s 0  %s -%s 0  %s %s 0] \"integer indices\" [0 1 2]";

/* Among the lines of a render there is this warning and no other, but for that of a black picture: cameras of some rows
 * stand in the ball. */
static void expect_warning(const program_run *r, const char *text)
{
    static const char black[] = "bis: warning: the picture is black";
    const char *at = strstr(r->messages, "bis: warning:");

    if (!text && at && strncmp(at, black, strlen(black)) == 0) return;

    if (text && !(at && strncmp(at, text, strlen(text)) == 0)) fail_msg("%s\nis not in\n%s", text, r->messages);
    if (!text && at) fail_msg("%s", at);
}

/* limit: what Embree cannot; NULL: it can. never: the error of both accelerators. */
static void expect(const char *limit, const char *never)
{
    char expected[1000];
    program_run r;

    if (never) {
        snprintf(expected, sizeof expected, FOLDER "/scene.txt: error: %s\n", never);
        program_expect(&r, 2, FOLDER "/scene.txt");
        assert_string_equal(r.messages, expected);
        program_expect(&r, 2, FOLDER "/scene.txt --accelerator grid");
        assert_string_equal(r.messages, expected);
        return;
    }
    program_expect(&r, 0, FOLDER "/scene.txt --accelerator grid --outfile " FOLDER "/grid.pfm");
    expect_warning(&r, NULL);
    program_expect(&r, 0, FOLDER "/scene.txt");
    if (!bis_accel_embree_version()) return;
    snprintf(expected, sizeof expected, "bis: warning: %s: the grid is used instead\n", limit);
    expect_warning(&r, limit ? expected : NULL);
    program_expect(&r, limit ? 2 : 0, FOLDER "/scene.txt --accelerator embree --outfile " FOLDER "/embree.pfm");
    snprintf(expected, sizeof expected, "bis: error: %s" WAY_OUT "\n", limit ? limit : "");
    if (limit) assert_string_equal(r.messages, expected);
    program_expect(
        &r, 0, "compare " FOLDER "/grid.pfm " FOLDER "/%s --tolerance 1e-9", limit ? "film.pfm" : "embree.pfm");
}

static void a_camera_out_of_reach(void **state)
{
    static const struct {
        const char *place, *camera, *limit, *never;
    } rows[] = {
        {"LookAt 0 -5 0 0 0 0 0 0 1", perspective, NULL, NULL},
        {"LookAt 0 -2.9e12 0 0 0 0 0 0 1", perspective, NULL, NULL},
        {"LookAt 0 -3.2e12 0 0 0 0 0 0 1", perspective,
         "the scene and its camera measure 3.2e+12 along y, and Embree loses triangles beyond 3e+12", NULL},
        {"LookAt 1.9e18 0 0 0 0 0 0 0 1", perspective,
         "the scene or its camera reaches to x = 1.9e+18, and Embree works up to 1.8e+18", NULL},
        {"LookAt 0 0 -3e38 0 0 0 0 1 0", perspective, "the scene or its camera reaches to z = -3e+38, and Embree works "
         "up to 1.8e+18", NULL},
        {"LookAt 1e39 0 0 0 0 0 0 0 1", perspective, NULL,
         "the camera stands at x = 1e+39, beyond the largest float, 3.40282e+38: scale the scene"},
        {"LookAt 0 1e300 0 0 0 0 0 0 1", perspective, NULL,
         "the camera stands at y = 1e+300, beyond the largest float, 3.40282e+38: scale the scene"},
        {"Translate 0 0 1e39", perspective, NULL, "the camera stands at z = -1e+39, beyond the largest float, "
         "3.40282e+38: scale the scene"},
        {"Scale 1e-39 1e-39 1e-39 LookAt 1 0 0 0 0 0 0 0 1", perspective, NULL, NULL},
        {"Scale 1e-39 1e-39 1e-39 Translate 0 0 1e-20", perspective, NULL, NULL},
        {"Translate 0 0 1 Scale 1e-39 1e-39 1e-39", perspective, NULL,
         "the camera stands at z = -1e+39, beyond the largest float, 3.40282e+38: scale the scene"},
        {"", orthographic, "the scene or its camera reaches to x = -3e+38, and Embree works up to 1.8e+18", NULL},
        {"Scale .5 .5 .5", orthographic, NULL, "the camera stands at x = -6e+38, beyond the largest float, "
         "3.40282e+38: scale the scene"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        write_scene(rows[i].place, rows[i].camera, ball);
        expect(rows[i].limit, rows[i].never);
    }
}

static void geometry_out_of_reach(void **state)
{
    static const struct {
        const char *size, *limit;
    } rows[] = {
        {"1e-11", "the scene and its camera measure 4e-11, and Embree loses triangles below 1e-10"},
        {"1e-9", NULL},
        {"1e6", NULL},
        {"7e11", NULL},
        {"1e13", "the scene and its camera measure 4e+13 along z, and Embree loses triangles beyond 3e+12"},
        {"1.9e18", "the scene or its camera reaches to z = 7.6e+18, and Embree works up to 1.8e+18"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const char *s = rows[i].size;
        char shape[500], place[100];
        double size;
        assert_int_equal(sscanf(s, "%lf", &size), 1);
        snprintf(place, sizeof place, "LookAt %g %g %g 0 0 0 1 0 0", size, .5 * size, 4 * size);
        snprintf(shape, sizeof shape, floor_of, s, s, s, s, s, s);
        write_scene(place, perspective, shape);
        expect(rows[i].limit, NULL);
        snprintf(shape, sizeof shape, "\"sphere\" \"float radius\" %s", s);
        write_scene("", perspective, shape); /* around the camera */
        program_run r;
        program_expect(&r, 0, FOLDER "/scene.txt");
        program_expect(&r, 0, FOLDER "/scene.txt --accelerator grid --outfile " FOLDER "/grid.pfm");
        program_expect(&r, 0, "compare " FOLDER "/grid.pfm " FOLDER "/film.pfm --tolerance 1e-9");
    }
}

/* The limits are below what Embree can: at them it finds what the grid finds, in the largest triangles that fit. */
static void at_its_limits_embree_sees_what_the_grid_sees(void **state)
{
    const double sizes[] = {.2 * BIS_EMBREE_MOST, BIS_EMBREE_LEAST};
    uint64_t seed = 31;
    if (!bis_accel_embree_version()) skip();
    for (int k = 0; k < 2; k++) {
        for (int kind = 0; kind < 2; kind++) {
            const bis_xform t = bis_xform_scale(sizes[k], sizes[k], sizes[k]);
            bis_mesh m = kind ? sphere_mesh(8) : soup_mesh(40, 1, 5);
            bis_geometry g = {0};
            bis_accel *a[2];
            add_mesh(&g, &m, &t, 0);
            for (int i = 0; i < 2; i++) {
                const bis_accel_options o = {.kind = i ? BIS_ACCEL_EMBREE : BIS_ACCEL_GRID, .n_threads = 1};
                assert_int_equal(bis_accel_new(&a[i], &g, &o, NULL), BIS_OK);
            }
            int differ = 0, hits = 0;
            for (int n = 0; n < 20000; n++) {
                const vec3 at = mul(random_direction(&seed), sizes[k] * random_double(&seed)),
                           d = random_direction(&seed);
                const ray r = {add(at, mul(d, -.3 * sizes[k])), d, INFINITY};
                bis_hit h[2] = {{-1, 0}, {-1, 0}};
                for (int i = 0; i < 2; i++) bis_accel_intersect(a[i], &r, &h[i]);
                hits += h[0].t > 0;
                differ += fabs((double)h[0].t - (double)h[1].t) > 1e-3 * sizes[k];
            }
            assert_true(hits > 5000 && differ <= 1);
            for (int i = 0; i < 2; i++) bis_accel_free(a[i]);
            bis_geometry_clear(&g);
        }
    }
}

static int make_folder(void **state)
{
    program_folder(FOLDER);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_camera_out_of_reach),
        cmocka_unit_test(geometry_out_of_reach),
        cmocka_unit_test(at_its_limits_embree_sees_what_the_grid_sees),
    };
    return cmocka_run_group_tests(tests, make_folder, NULL);
}
