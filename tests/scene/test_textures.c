/* SPDX-License-Identifier: BSD-2-Clause */
/* Textures: values worked out by hand, texture coordinates against pbrt's formulas, pictures against the same scene
 * without textures, and what is refused. */
#include "bis/base/mem.h"
#include "bis/beyond/microfacet.h"
#include "bis/files/image_file.h"
#include "bis/scene/scene.h"
#include "bis/thesis/phong.h"

#include "claim.h"
#include "image_help.h"
#include "program.h"
#include "scene_help.h"
#include "tools/verify/verify.h"

#include <dirent.h>
#include <math.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DIR "build/test_textures"

/* ---- help ---- */

/* The last part of a scratch file's name, for a scene beside it. */
static const char *beside(const char *path) { return strrchr(path, '/') + 1; }

/* It is refused, and a message has this in it. */
static void expect_failure(const char *what, const char *fmt, ...) BIS_PRINTF(2, 3);
static void expect_failure(const char *what, const char *fmt, ...)
{
    static char text[1 << 17];
    built b;
    va_list args;
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    assert_int_equal(scene_try(&b, text), BIS_INPUT);
    bool found = false;
    for (size_t i = 0; i < b.diag.n; i++) found |= strstr(b.diag.messages[i].text, what) != NULL;
    if (!found) fail_msg("%s\nnot: %s\n", b.diag.messages[0].text, what);
    assert_non_null(strstr(b.diag.messages[0].text, "scene.txt:"));
    scene_clear(&b);
}

/* 2 x 2, grey: bottom left 0.1, bottom right 0.2, top left 0.4, top right 0.8. A PFM's first row is the bottom. */
static const char *four_as(const char *path)
{
    const float v[4] = {0.1f, 0.2f, 0.4f, 0.8f};
    bytes b = {0};
    put_text(&b, "PF\n2 2\n-1.0\n");
    for (int i = 0; i < 12; i++) put_float(&b, v[i / 3]);
    store(path, b.data, b.n);
    bytes_clear(&b);
    return beside(path);
}

/* 3 x 2 texels; their channels are (n, 2n, 4n)/32 of n = 1, 2, 3 (top row) and 4, 5, 6. */
static void six_as(const char *path)
{
    bytes b = {0};
    put_text(&b, "PF\n3 2\n-1.0\n");
    for (int i = 0; i < 6; i++)
        for (int k = 0; k < 3; k++) put_float(&b, (float)(i < 3 ? 4 + i : i - 2) * (float)(1 << k) / 32);
    store(path, b.data, b.n);
    bytes_clear(&b);
}

static const char *four(void) { return four_as(scratch("four.pfm")); }

#define LIGHT "WorldBegin LightSource \"infinite\" "

/* The value at (u, v), or at a point, of the texture that the first shape's reflectance is. */
static double value_of(const built *b, double u, double v, const double p[3])
{
    const bis_material_textures *m = bis_textures_of(&b->desc->textures, b->desc->shapes[0].material);
    assert_non_null(m);
    return bis_textures_value(&b->desc->textures, b->scene->images, m->Kd, (double[]){u, v},
                              vec3_from(p[0], p[1], p[2])).r;
}

static double value_at(const built *b, const double p[3]) { return value_of(b, 0.9, 0.9, p); }

static void assert_near(double a, double b)
{
    if (!(fabs(a - b) < 1e-6)) fail_msg("%.9g is not %.9g", a, b);
}

/* ---- values ---- */

/* A PNG by libpng's own writer. format: PNG_FORMAT_... */
static const char *store_png(const char *path, int width, int height, png_uint_32 format, const void *pixels)
{
    png_image png = {
        .version = PNG_IMAGE_VERSION, .width = (png_uint_32)width, .height = (png_uint_32)height, .format = format};
    assert_true(png_image_write_to_file(&png, path, 0, pixels, 0, NULL));
    return beside(path);
}

#define IMAGE(type, file, params) \
    "Texture \"t\" \"" type "\" \"imagemap\" \"string filename\" \"../test_textures/" file "\" " params
#define FOUR(params) IMAGE("spectrum", "four.pfm", params)
#define GREY(params) IMAGE("color", "grey.png", params)
#define CHECKED "Texture \"c\" \"spectrum\" \"checkerboard\" \"float tex1\" 0.5 \"float tex2\" 0.25\n"

/* Of a texture t: what it is at some (u, v). 188/255 of the curve of sRGB is 0.502886, from tables of it; the first row
 * of a PNG is the top. */
static const struct {
    const char *texture;
    int n;
    double is[8][3]; /* u, v, value */
} values[] = {
    /* texels stand in the middle of their squares, and v grows upwards; a quarter of the way */
    {FOUR(""), 8, {{0.25, 0.25, 0.1}, {0.75, 0.25, 0.2}, {0.25, 0.75, 0.4}, {0.75, 0.75, 0.8}, {0.5, 0.25, 0.15},
     {0.25, 0.5, 0.25}, {0.5, 0.5, 0.375}, {0.375, 0.25, 0.125}}},
    /* outside an image repeats: between 0.2, which is on the left again, and 0.1 */
    {FOUR(""), 4, {{0, 0.25, 0.15}, {0, 0, 0.375}, {7.25, -3.25, 0.4}, {-0.75, 1.25, 0.1}}},
    {FOUR("\"string wrap\" \"clamp\""), 4, {{0, 0, 0.1}, {-9, 0.25, 0.1}, {3, 3, 0.8}, {0.5, 2, 0.6}}},
    /* half way to black */
    {FOUR("\"string wrap\" \"black\""), 4, {{0, 0.25, 0.05}, {0, 0, 0.025}, {-0.3, 0.5, 0}, {0.5, 1.3, 0}}},
    /* coordinates are scaled, then moved: (0.75, 0.75); values are scaled, then inverted */
    {FOUR("\"float uscale\" 2 \"float udelta\" 0.25 \"float vscale\" 3 \"float vdelta\" -0.75"), 1, {{0.25, 0.5, 0.8}}},
    {FOUR("\"float scale\" 0.5 \"bool invert\" true"), 1, {{0.75, 0.75, 0.6}}},
    /* a PNG is sRGB unless it is said to be linear or a power */
    {GREY(""), 4, {{0.25, 0.75, 0.50288646}, {0.75, 0.75, 1}, {0.25, 0.25, 0}, {0.75, 0.25, 0.12477182}}},
    {GREY("\"string encoding\" \"linear\""), 1, {{0.25, 0.75, 188 / 255.0}}},
    {GREY("\"bool gamma\" false"), 1, {{0.25, 0.75, 188 / 255.0}}},
    {GREY("\"string encoding\" \"gamma 2\""), 1, {{0.25, 0.75, 0.5435448}}}, /* 188^2/255^2 */
    /* 16 bits are kept; the file says that it is linear by a gamma that pbrt and bis do not ask */
    {IMAGE("color", "deep.png", "\"string encoding\" \"linear\""), 2, {{0.25, 0.5, 32768 / 65535.0}, {0.75, 0.5,
     257 / 65535.0}}},
    /* an image that is no square, of n = 1, 2, 3 in the top row and 4, 5, 6 below: of n/32 the red, whose mean over
     * the channels 1, 2 and 4 is 7/3 */
    {IMAGE("spectrum", "six.pfm", ""), 6, {{.5 / 3, .25, 4 / 32.}, {2.5 / 3, .25, 6 / 32.}, {.5 / 3, .75, 1 / 32.},
     {1.5 / 3, .75, 2 / 32.}, {-.5 / 3, 1.25, 6 / 32.}, {.25, .625, 2 / 32.}}},
    {IMAGE("spectrum", "six.pfm", "\"string wrap\" \"clamp\""), 2,
     {{-2.5 / 3, 1.75, 1 / 32.}, {4.5 / 3, .25, 6 / 32.}}},
    {IMAGE("float", "six.pfm", "\"float scale\" 2"), 1, {{.5 / 3, .75, 14 / 96.}}},
    /* a checkerboard alternates also at negative places */
    {"Texture \"t\" \"spectrum\" \"checkerboard\" \"float tex1\" 0.75 \"rgb tex2\" [0.25 0 0] \"float uscale\" 2", 5,
     {{0.25, 0.5, 0.75}, {0.75, 0.5, 0.25}, {0.75, 1.5, 0.75}, {-0.25, 0.5, 0.25}, {-0.25, -0.5, 0.75}}},
    {CHECKED "Texture \"t\" \"spectrum\" \"scale\" \"texture tex\" \"c\" \"float scale\" 0.5", 2,
     {{0.5, 0.5, 0.25}, {1.5, 0.5, 0.125}}},
    {CHECKED "Texture \"t\" \"color\" \"scale\" \"texture tex1\" \"c\" \"rgb tex2\" [0.5 0.5 0.5]", 2,
     {{0.5, 0.5, 0.25}, {1.5, 0.5, 0.125}}},
    {CHECKED "Texture \"t\" \"spectrum\" \"mix\" \"texture tex1\" \"c\" \"float tex2\" 1 \"float amount\" 0.25", 1,
     {{0.5, 0.5, 0.75 * 0.5 + 0.25}}},
    /* the amount may vary as well: from tex1 to tex2 */
    {"Texture \"a\" \"float\" \"checkerboard\" \"float tex1\" 0 \"float tex2\" 1\nTexture \"t\" \"spectrum\" \"mix\" "
     "\"float tex1\" 0.2 \"float tex2\" 0.9 \"texture amount\" \"a\"", 2, {{0.5, 0.5, 0.2}, {1.5, 0.5, 0.9}}},
};

static void a_texture_has_the_values_beside_it(void **state)
{
    const unsigned char grey[4] = {188, 255, 0, 99}; /* top row, bottom row */
    const uint16_t deep[2] = {0x8000, 0x0101}; /* libpng's "linear" formats are 16 bits */
    six_as(DIR "/six.pfm");
    four_as(DIR "/four.pfm");
    store_png(DIR "/grey.png", 2, 2, PNG_FORMAT_GRAY, grey);
    store_png(DIR "/deep.png", 2, 1, PNG_FORMAT_LINEAR_Y, deep);
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        built b = scene_build(LIGHT "%s\nMaterial \"diffuse\" \"texture reflectance\" \"t\" Shape \"sphere\"",
                              values[i].texture);
        for (int k = 0; k < values[i].n; k++) {
            const double *const is = values[i].is[k], found = value_of(&b, is[0], is[1], (double[3]){0});
            if (!(fabs(found - is[2]) < 1e-6)) fail_msg("%s: %.9g, not %.9g", values[i].texture, found, is[2]);
        }
        scene_clear(&b);
    }
}

/* ---- textures of textures ---- */

/* ---- texture coordinates ---- */

/* (u, v) where a ray from p towards the point `at` meets the scene. */
static void look(double uv[2], const built *b, const double p[3], const double at[3])
{
    const double d[3] = {at[0] - p[0], at[1] - p[1], at[2] - p[2]}, l = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    const ray r = {vec3_from(p[0], p[1], p[2]), vec3_from(d[0] / l, d[1] / l, d[2] / l), INFINITY};
    bis_hit hit;
    assert_true(bis_accel_intersect(b->scene->accel, &r, &hit));
    bis_geometry_uv(&b->scene->geometry, hit.prim, &r, uv);
}

static void assert_uv(const double uv[2], double u, double v)
{
    if (!(fabs(uv[0] - u) < 1e-5 && fabs(uv[1] - v) < 1e-5)) fail_msg("(%g, %g) is not (%g, %g)", uv[0], uv[1], u, v);
}

/* u = phi/2 pi counts from x over y; v = 0 at the bottom, z = -r: pbrt's (theta - pi)/(0 - pi). */
static void a_sphere_has_pbrts_coordinates(void **state)
{
    const double s = sqrt(0.5),
                 uv_of[][5] = {{1, 0, 0, 0, 0.5}, {0, 1, 0, 0.25, 0.5}, {-1, 0, 0, 0.5, 0.5}, {0, -1, 0, 0.75, 0.5},
                     {s, s, 0, 0.125, 0.5}, {s, 0, s, 0, 0.75}, {0, s, -s, 0.25, 0.25}, {0.6, -0.8, 0, 0.852416, 0.5}};
    built b = scene_build(LIGHT "Translate 3 0 0 Rotate 90 0 0 1 Shape \"sphere\" \"float radius\" 2");
    for (size_t i = 0; i < sizeof uv_of / sizeof *uv_of; i++) {
        const double *q = uv_of[i];
        /* turned by 90 degrees about z: (x, y) to (-y, x); with radius 2, and moved */
        const double at[3] = {3 - 2 * q[1], 2 * q[0], 2 * q[2]}, from[3] = {3 - 9 * q[1], 9 * q[0], 9 * q[2]};
        double uv[2];
        look(uv, &b, from, at);
        if (q[3] == 0 && uv[0] > 0.5) uv[0] -= 1; /* the seam */
        assert_uv(uv, q[3], q[4]);
    }
    scene_clear(&b);
}

static void a_disk_has_pbrts_coordinates(void **state)
{
    built b = scene_build(LIGHT "Shape \"disk\" \"float radius\" 4 \"float height\" 1");
    const double uv_of[][4] = {{1, 0.001, 0.000159, 0.75}, {0, 2, 0.25, 0.5}, {-3, 0, 0.5, 0.25}, {0, -1, 0.75, 0.75}};
    for (size_t i = 0; i < sizeof uv_of / sizeof *uv_of; i++) {
        double uv[2];
        look(uv, &b, (double[]){0, 0, 9}, (double[]){uv_of[i][0], uv_of[i][1], 1});
        assert_uv(uv, uv_of[i][2], uv_of[i][3]);
    }
    scene_clear(&b);
}

#define TRIANGLE "Shape \"trianglemesh\" \"point3 P\" [0 0 0  1 0 0  0 1 0] "
#define BOARD "Texture \"t\" \"color\" \"checkerboard\" Material \"diffuse\" \"texture reflectance\" \"t\" "

static void a_triangle_interpolates_its_corners_and_without_any_has_pbrts(void **state)
{
    const double from[3] = {0.2, 0.3, 5}, at[3] = {0.2, 0.3, 0}; /* weights 0.5, 0.2, 0.3 */
    static const char *const spellings[] = {
        "\"point2 uv\" [1 2  3 5  7 11]", "\"float uv\" [1 2  3 5  7 11]", "\"float st\" [1 2  3 5  7 11]"};
    double uv[2];
    for (int i = 0; i < 3; i++) {
        built b = scene_build(LIGHT BOARD TRIANGLE "%s", spellings[i]);
        look(uv, &b, from, at);
        assert_uv(uv, 0.5 * 1 + 0.2 * 3 + 0.3 * 7, 0.5 * 2 + 0.2 * 5 + 0.3 * 11);
        assert_int_equal(b.diag.n, 0);
        scene_clear(&b);
    }
    built b = scene_build(LIGHT BOARD TRIANGLE);
    look(uv, &b, from, at); /* (0,0), (1,0), (1,1) */
    assert_uv(uv, 0.2 + 0.3, 0.3);
    assert_int_equal(b.diag.n, 1);
    assert_non_null(strstr(b.diag.messages[0].text, "warning: the mesh has no texture coordinates"));
    scene_clear(&b);
}

/* Meshes with and without coordinates, before and behind each other. */
static void each_mesh_of_a_scene_keeps_its_own(void **state)
{
    built b = scene_build(
        LIGHT TRIANGLE "Translate 10 0 0 " BOARD TRIANGLE "\"point2 uv\" [5 5  6 5  5 6]\nTranslate 10 0 0 " TRIANGLE);
    double uv[2];
    look(uv, &b, (double[]){0.2, 0.3, 5}, (double[]){0.2, 0.3, 0});
    assert_uv(uv, 0.5, 0.3);
    look(uv, &b, (double[]){10.2, 0.3, 5}, (double[]){10.2, 0.3, 0});
    assert_uv(uv, 5.2, 5.3);
    look(uv, &b, (double[]){20.2, 0.3, 5}, (double[]){20.2, 0.3, 0});
    assert_uv(uv, 0.5, 0.3);
    scene_clear(&b);
}

static const char *store_text(const char *name, const char *text)
{
    store(scratch(name), text, strlen(text));
    return beside(scratch(name));
}

/* The corner (1, 1) has other coordinates in each of the two faces: it is split. */
static void an_obj_and_a_ply_bring_theirs(void **state)
{
    double uv[2];
    const char *obj =
        store_text("square.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1 9\nvt 5 5\nvt 7\n"
                                 "f 1/1 2/2 3/3\nf 1/1 3/5 -1/-1\n");
    built b = scene_build(LIGHT BOARD "Shape \"objmesh\" \"string filename\" \"%s\"", obj);
    assert_int_equal(b.scene->geometry.n_vertices, 5);
    look(uv, &b, (double[]){0.75, 0.25, 5}, (double[]){0.75, 0.25, 0});
    assert_uv(uv, 0.75, 0.25);
    look(uv, &b, (double[]){0.25, 0.5, 5}, (double[]){0.25, 0.5, 0}); /* 1/2 (0,0) + 1/4 (5,5) + 1/4 (7,0) */
    assert_uv(uv, 3, 1.25);
    scene_clear(&b);
    b = scene_build(LIGHT "Shape \"objmesh\" \"string filename\" \"%s\"", obj);
    assert_int_equal(b.scene->geometry.n_vertices, 4);
    scene_clear(&b);

    static const char *const names[][2] = {
        {"u", "v"}, {"s", "t"}, {"texture_u", "texture_v"}, {"texture_s", "texture_t"}};
    for (int i = 0; i < 4; i++) {
        char text[512];
        snprintf(text, sizeof text,
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float %s\nproperty float y\nproperty "
            "float z\n"
            "property uchar red\nproperty double %s\nelement face 1\nproperty list uchar int "
            "vertex_indices\nend_header\n"
            "0 1 0 0 9 2\n1 3 0 0 9 5\n0 7 1 0 9 11\n3 0 1 2\n",
            names[i][0], names[i][1]);
        /* behind another mesh, which wants none */
        b = scene_build(LIGHT "AttributeBegin Translate 50 0 0 Shape \"objmesh\" \"string filename\" \"%s\" "
                        "AttributeEnd " BOARD "Shape \"plymesh\" \"string filename\" \"%s\"",
                        beside(scratch("square.obj")), store_text("uv.ply", text));
        look(uv, &b, (double[]){0.2, 0.3, 5}, (double[]){0.2, 0.3, 0});
        assert_uv(uv, 0.5 * 1 + 0.2 * 3 + 0.3 * 7, 0.5 * 2 + 0.2 * 5 + 0.3 * 11);
        assert_int_equal(b.diag.n, 0);
        scene_clear(&b);
    }
}

/* ---- an OBJ with its materials ---- */

#define OBJ "v -2 -1 0\nv -1 -1 0\nv 0 -1 0\nv 1 -1 0\nv -2 1 0\nv -1 1 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 " \
    "1\nvt 0 1\n" \
            "f 1 2 6 5\nusemtl painted wood \nf 2/1 3/2 7/3 6/4\nusemtl red\nusemtl unused\nusemtl red\nf 3 4 8 7\n"
#define MTL \
    "# a library\nnewmtl unused\nKd 7 7 7\r\nnewmtl red\n\tKd 0.75 0.125 0\nKs 0.25\nNs 12.5\nillum 2\nKa 1 1 1\n" \
            "newmtl painted wood\nKd 0.5 0.25 1\nKs 0.9 0.9 0.9\nillum 1\nmap_Kd -s 2 1 1 -o 0.5 0 -clamp on " \
            "four.pfm\nnewmtl red\nKd 0 0 0\n"

#define OBJ_SHAPE(name) "Shape \"objmesh\" \"string filename\" \"../test_textures/" name "\" "
#define PLAIN "Material \"diffuse\" \"float reflectance\" 0.375 "
#define MATERIALS "\"bool materials\" true"

static void write_obj(void)
{
    store(DIR "/four.pfm", "Pf\n1 1\n-1.0\n\0\0\0\x3f", 16); /* 0.5 */
    program_write_file(DIR "/lib.mtl", MTL);
    program_write_file(DIR "/o.obj", "mtllib lib.mtl\n" OBJ);
}

/* The first face has the scene's own material, and lies at x = -1.5; the second one at -0.5, the third at 0.5. */
static void an_obj_brings_its_materials_and_each_part_is_a_shape(void **state)
{
    built b;
    bis_own_material m;
    bis_counters counters = {0};
    bis_point pt;
    write_obj();
    assert_int_equal(scene_try(&b, LIGHT PLAIN OBJ_SHAPE("o.obj") MATERIALS), BIS_OK);
    assert_int_equal(b.diag.n, 0);
    assert_int_equal(b.desc->n_shapes, 3);
    for (int k = 0; k < 3; k++) {
        const ray r = {{-1.5f + (float)k, 0.25f, 5}, {0, 0, -1}, INFINITY};
        bis_hit hit;
        assert_true(bis_scene_point(&pt, &m, b.scene, r, &counters, &hit));
        const bis_material *at = pt.bsdf.material;
        if (k == 0) assert_true(at->Kd.r == 0.375f);
        if (k == 1) assert_true(at->Kd.r == 0.25f && at->Kd.g == 0.125f && at->Kd.b == 0.5f && at->Ks.r == 0);
        if (k == 2) assert_true(at->Kd.r == 0.75f && at->Kd.g == 0.125f && at->Ks.b == 0.25f && at->exponent == 12.5);
    }
    scene_clear(&b);
}

static void instances_of_an_obj_with_materials_are_alike(void **state)
{
    built b;
    write_obj();
    assert_int_equal(scene_try(&b, LIGHT "ObjectBegin \"o\" " OBJ_SHAPE("o.obj") MATERIALS " ObjectEnd\n"
                                   "ObjectInstance \"o\" Translate 10 0 0 ObjectInstance \"o\""), BIS_OK);
    assert_int_equal(b.desc->n_shapes, 6);
    assert_int_equal(b.scene->geometry.n_triangles, 12);
    for (int i = 0; i < 2; i++) {
        double uv[2];
        look(uv, &b, (double[]){-0.75 + 10 * i, 0.5, 5}, (double[]){-0.75 + 10 * i, 0.5, 0});
        assert_uv(uv, 0.25, 0.75);
    }
    scene_clear(&b);
}

/* One face of material a, whose library says this. */
static bis_status build_library(built *b, const char *before, const char *statements)
{
    char mtl[1024], scene[256];
    snprintf(mtl, sizeof mtl, "newmtl a\n%s\n", statements);
    snprintf(scene, sizeof scene, "%s" LIGHT OBJ_SHAPE("o.obj") MATERIALS, before);
    store(DIR "/four.pfm", "Pf\n1 1\n-1.0\n\0\0\0\x3f", 16); /* 0.5 */
    program_write_file(DIR "/o.obj", "mtllib lib.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    program_write_file(DIR "/lib.mtl", mtl);
    return scene_try(b, scene);
}

/* Where a statement is refused, `said` begins "LINE: error: "; where it changes the picture, "LINE: warning: ". With
 * Option approximate nothing is refused but what is no number. NULL: nothing is said of the library. Kd 1/2, Ks 0 and
 * Ns 50 stay where nothing is said. */
static void a_statement_of_a_library_is_taken_ignored_or_refused(void **state)
{
#define USUAL {.5f, .5f, .5f}, {0, 0, 0}, 50
    static const struct { const char *mtl, *said; float Kd[3], Ks[3]; double Ns; } cases[] = {
        {"", NULL, USUAL}, {"Kd 0.25 # grey", NULL, {.25f, .25f, .25f}, {0, 0, 0}, 50},
        {"Ks 0.125 0.25 0.5", NULL, {.5f, .5f, .5f}, {.125f, .25f, .5f}, 50}, {"Ks 0.25\nillum 1", NULL, USUAL},
        {"illum 1\nKs 0.25\nillum 3", NULL, {.5f, .5f, .5f}, {.25f, .25f, .25f}, 50},
        {"Kd 0 1 0.5\rKs 0\r\n\tNs  1000 \t", NULL, {0, 1, .5f}, {0, 0, 0}, 1000},
        {"Kd 1 1 1\nnewmtl a\nKd 0 0 0", NULL, {1, 1, 1}, {0, 0, 0}, 50},
        {"d 1\nTr 0\nKe 0", NULL, USUAL}, {"Ka 1 2 3\nNi 1.5\nTf 1 1 1\nmap_Ka no.png", NULL, USUAL},
        {"d 0.5", "2: warning: d is ignored, which changes shape", USUAL},
        {"Tr 1e-3", "2: warning: Tr is ignored, which changes shape", USUAL},
        {"Ke 0 1 0", "2: warning: Ke is ignored, which changes brightness", USUAL},
        {"map_Ks 1", "2: warning: map_Ks is ignored, which changes highlights", USUAL},
        {"map_d x", "2: warning: map_d is ignored, which changes shape", USUAL},
        {"foo 1\nbar 2", "2: warning: the unknown word \"foo\" is ignored", USUAL},
        {"Kd 0.75 0 0\nKs 0.5 0 0", "1: warning: Kd + Ks is 1.25 in red", {.75f, 0, 0}, {.5f, 0, 0}, 50},
        {"map_Kd -texres 512 four.pfm", "2: warning: -texres of a map is ignored", USUAL},
        {"Kd 0.1 x 0.3", "2: error: Kd is \"0.1 x 0.3\", must be three numbers", USUAL},
        {"Ks 0 1.5 0", "2: error: \"Ks\" is 1.5, must be in [0, 1]", USUAL},
        {"Ns -1", "2: error: \"Ns\" is -1, must be ", USUAL},
        {"Tr x", "2: error: Tr is \"x\", must be a number", USUAL},
        {"map_Kd -s 2 -bm 2 four.pfm", "2: error: the option -bm of a map is not modelled", USUAL},
        {"map_Kd -mm 0 2 four.pfm", "2: error: the option -mm of a map is not modelled", USUAL},
        {"map_Kd -t 0 0 0.1 four.pfm", "2: error: the option -t of a map is not modelled", USUAL},
        {"map_Kd -colorspace AdobeRGB four.pfm", "2: error: the colour space \"AdobeRGB\" of a map", USUAL},
        {"bump -imfchan r four.pfm", "2: error: -imfchan r is not modelled", USUAL},
        {"norm -o 0 0.5 four.pfm", "2: error: the options -s and -o of norm are not modelled", USUAL},
        {"map_Kd no.png", "2: error: cannot read \"", USUAL}, {"norm -o 0 0 -s 1 1 2 four.pfm", NULL, USUAL},
    };
#undef USUAL
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const char *const said = cases[i].said, *found = NULL;
        const bool is_error = said && strstr(said, ": error: "), is_bad = said && strstr(said, "number");
        built b;
        const bis_status status = build_library(&b, "", cases[i].mtl);
        for (size_t k = b.diag.n; k-- > 0;) {
            const char *const of = strstr(b.diag.messages[k].text, "lib.mtl:");
            if (of) found = of + strlen("lib.mtl:");
        }
        if (status != (is_error ? BIS_INPUT : BIS_OK)) fail_msg("%s: status %d", cases[i].mtl, status);
        if (!said != !found || (said && strncmp(found, said, strlen(said)) != 0))
            fail_msg("%s: %s", cases[i].mtl, found ? found : "nothing is said");
        scene_clear(&b);
        if (build_library(&b, "Option \"bool approximate\" true\n", cases[i].mtl) !=
            (is_bad ? BIS_INPUT : BIS_OK))
            fail_msg("%s is not approximated", cases[i].mtl);
        if (!is_error) {
            const bis_material *m = &b.desc->materials[b.desc->shapes[0].material];
            if (memcmp(&m->Kd, cases[i].Kd, sizeof m->Kd) || memcmp(&m->Ks, cases[i].Ks, sizeof m->Ks) ||
                m->exponent != cases[i].Ns)
                fail_msg("%s: Kd %g Ks %g Ns %g", cases[i].mtl, (double)m->Kd.r, (double)m->Ks.r, m->exponent);
        } else if (!is_bad) {
            assert_int_equal(b.desc->n_approximations, 1);
        }
        scene_clear(&b);
    }
}

/* -s and -o have one to three numbers, of which two count; all else keeps its usual value. */
static void options_of_a_map_change_what_they_name_alone(void **state)
{
    static const struct { const char *options; double factor[2], offset[2]; bis_wrap wrap; } cases[] = {
        {"-s 2 ", {2, 1}, {0, 0}, BIS_WRAP_REPEAT}, {"-s 2 3 4 ", {2, 3}, {0, 0}, BIS_WRAP_REPEAT},
        {"-o 5 6 7 -s 2 3 4 ", {2, 3}, {5, 6}, BIS_WRAP_REPEAT}, {"-clamp on ", {1, 1}, {0, 0}, BIS_WRAP_CLAMP},
        {"-clamp on -o 5 -clamp off -s 2 ", {2, 1}, {5, 0}, BIS_WRAP_REPEAT},
        {"-mm 0 1 -t 0 0 0 -bm 1 -t 0 ", {1, 1}, {0, 0}, BIS_WRAP_REPEAT}, /* these change nothing */
        {"-s 2 3", {2, 1}, {0, 0}, BIS_WRAP_REPEAT}, /* of the image 3four.pfm */
        {"..\\test_textures\\", {1, 1}, {0, 0}, BIS_WRAP_REPEAT},
    };
    store(DIR "/3four.pfm", "Pf\n1 1\n-1.0\n\0\0\0\x3f", 16);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[256];
        built b;
        snprintf(text, sizeof text, "Kd 1 1 1\nmap_Kd %sfour.pfm", cases[i].options);
        assert_int_equal(build_library(&b, "", text), BIS_OK);
        const bis_textures *t = &b.desc->textures;
        const bis_material_textures *m = bis_textures_of(t, b.desc->shapes[0].material);
        assert_true(m && t->n == 1);
        const bis_texture *x = &t->list[0];
        assert_memory_equal(x->factor, cases[i].factor, sizeof x->factor);
        assert_memory_equal(x->offset, cases[i].offset, sizeof x->offset);
        assert_true(x->kind == BIS_TEXTURE_IMAGE && x->wrap == cases[i].wrap);
        scene_clear(&b);
    }
}

/* ---- what the parser makes of a texture ---- */

#define HALF "\"imagemap\" \"string filename\" \"../test_textures/half.pfm\"\n"
#define IMAGE_I "Texture \"i\" \"spectrum\" " HALF "Texture \"f\" \"float\" " HALF

/* An image of 0.5 is each part of a texture in turn: it is read, and the mesh must have coordinates for it. */
static void an_image_is_found_in_each_part_of_a_texture(void **state)
{
    static const struct { const char *texture; double value; } cases[] = {
        {"scale\" \"texture tex\" \"i\" \"float scale\" .5", .25},
        {"scale\" \"float tex\" .25 \"texture scale\" \"f\"", .125},
        {"mix\" \"texture tex1\" \"i\" \"float tex2\" .25", .375},
        {"mix\" \"float tex1\" .25 \"texture tex2\" \"i\"", .375},
        {"mix\" \"float tex1\" .25 \"float tex2\" .75 \"texture amount\" \"f\"", .5},
        {"checkerboard\" \"texture tex1\" \"i\" \"string mapping\" \"planar\"", .5},
        {"checkerboard\" \"texture tex2\" \"i\" \"string mapping\" \"planar\" \"float udelta\" 1", .5},
        {"dots\" \"texture outside\" \"i\" \"texture inside\" \"i\" \"string mapping\" \"planar\"", .5},
        {"bilerp\" \"texture v00\" \"i\" \"float v01\" .5 \"float v10\" .5 \"float v11\" .5", .5},
        {"bilerp\" \"texture v11\" \"i\" \"float v01\" .5 \"float v10\" .5 \"float v00\" .5", .5},
    };
    store(DIR "/half.pfm", "Pf\n1 1\n-1.0\n\0\0\0\x3f", 16);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        built b = scene_build(LIGHT IMAGE_I "Texture \"t\" \"spectrum\" \"%s Material \"diffuse\" "
                              "\"texture reflectance\" \"t\" " TRIANGLE, cases[i].texture);
        const double v = value_of(&b, .3, .6, (double[]){.3, .6, 0});
        if (!(fabs(v - cases[i].value) < 1e-6)) fail_msg("%s: %g", cases[i].texture, v);
        assert_int_equal(b.diag.n, 1);
        assert_non_null(strstr(b.diag.messages[0].text, "the mesh has no texture coordinates"));
        scene_clear(&b);
    }
}

static void a_point_has_the_material_of_its_place(void **state)
{
    bis_own_material m;
    bis_counters counters = {0};
    bis_point pt;
    built b = scene_build(LIGHT
        "Texture \"k\" \"color\" \"checkerboard\" \"rgb tex1\" [0.1 0.2 0.3] \"rgb tex2\" [0.4 0.5 0.6]\n"
        "Texture \"r\" \"float\" \"checkerboard\" \"float tex1\" 0.5 \"float tex2\" 0.1\n"
        "Material \"microfacet\" \"texture Ks\" \"k\" \"texture roughness\" \"r\" \"float Kd\" 0.7\n" TRIANGLE
        "\"point2 uv\" [0 0  2 0  0 2]\n"
        "Texture \"n\" \"float\" \"checkerboard\" \"float tex1\" 30 \"float tex2\" 3000\n"
        "Material \"phong\" \"texture Kd\" \"k\" \"texture exponent\" \"n\" \"float Ks\" 0.1 Translate 5 0 0 " TRIANGLE
        "\"point2 uv\" [0 0  2 0  0 2]");
    const ray right = {{0.75f, 0.125f, 5}, {0, 0, -1}, INFINITY}, other = {{5.25f, 0.125f, 5}, {0, 0, -1}, INFINITY};
    assert_true(bis_scene_point(&pt, &m, b.scene, right, &counters, NULL));
    assert_ptr_equal(pt.bsdf.material, &m.own);
    assert_int_equal(m.index, b.desc->shapes[0].material);
    assert_true(m.own.Ks.r == 0.4f && m.own.Ks.b == 0.6f && m.own.Kd.g == 0.7f);
    assert_near(m.own.alpha, 0.01); /* 0.1^2 */
    assert_true(bis_scene_point(&pt, &m, b.scene, other, &counters, NULL));
    assert_true(m.own.Kd.g == 0.2f && m.own.Ks.g == 0.1f && m.own.exponent == 30);
    scene_clear(&b);
}

#define IMAGEMAP "Texture \"t\" \"%s\" \"imagemap\" \"string filename\" \"%s\" "

static void values_out_of_range_are_refused_when_the_image_is_known(void **state)
{
    static const struct { const char *type, *words, *material, *message; } cases[] = {
        {"color", "\"float scale\" 1.5", "\"diffuse\" \"texture reflectance\"",
         ":2:10: error: the texture of \"Kd\" has values up to 1.2, must be in [0, 1]: change it"},
        {"color", "\"float scale\" 1.5", "\"phong\" \"texture Ks\"", "the texture of \"Ks\" has values up to 1.2"},
        {"color", "\"float scale\" 2 \"bool invert\" true", "\"diffuse\" \"texture reflectance\"",
         "the texture of \"Kd\" has values down to -0.6"},
        {"float", "\"string wrap\" \"black\"", "\"microfacet\" \"texture roughness\"",
         "the texture of \"roughness\" has values down to 0, must be in [0.01, 1]"},
        {"float", "\"float scale\" 1.5", "\"microfacet\" \"texture roughness\"", "\"roughness\" has values up to 1.2"},
        {"float", "\"float scale\" 3 \"bool invert\" true", "\"phong\" \"texture exponent\"",
         "the texture of \"exponent\" has values down to -1.4, must be >= 0"},
    };
    const char *name = "../test_textures/four.pfm";
    four_as(DIR "/four.pfm");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        expect_failure(cases[i].message, LIGHT IMAGEMAP "%s\nMaterial %s \"t\" Shape \"sphere\"", cases[i].type, name,
                       cases[i].words, cases[i].material);
    /* the largest of both: 0.8 + 0.3 */
    built b = scene_build(LIGHT "Texture \"t\" \"color\" \"imagemap\" \"string filename\" \"%s\"\n"
                                "Material \"phong\" \"texture Kd\" \"t\" \"float Ks\" 0.3 Shape \"sphere\"", name);
    assert_int_equal(b.diag.n, 1);
    assert_non_null(strstr(b.diag.messages[0].text, "warning: Kd + Ks may reach 1.1 in red"));
    scene_clear(&b);
}

/* 300 scales of each other: 2^300 values, if nobody counted. */
static void textures_of_textures_have_a_limit(void **state)
{
    char *text = malloc(1 << 17);
    int n = sprintf(text, LIGHT "Texture \"t0\" \"float\" \"checkerboard\"\n");
    for (int i = 1; i < 300; i++)
        n += sprintf(text + n,
            "Texture \"t%d\" \"float\" \"scale\" \"texture tex1\" \"t%d\" \"texture tex2\" \"t%d\"\n", i, i - 1, i - 1);
    expect_failure(":8:1: error: a value of texture \"t7\" is made of 510 others, must be at most 255", "%s", text);
    built b;
    assert_int_equal(scene_try(&b, text), BIS_INPUT);
    assert_int_equal(b.diag.n, 1); /* what is made of it is no further mistake */
    scene_clear(&b);
    free(text);
}

/* ---- the program ---- */

#define VIEW "Camera \"orthographic\" Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 16\n" \
             "Option \"bool disablepixeljitter\" true\n"
/* the camera's square, seen from the front: z = 1, x and y in [-1, 1] */
#define SQUARE \
    "Shape \"trianglemesh\" \"point3 P\" [-1 -1 1  1 -1 1  1 1 1  -1 1 1] \"integer indices\" [0 1 2 0 2 3] " \
               "\"point2 uv\" [0 0 1 0 1 1 0 1]\n"

static bis_image rendered(const char *file)
{
    bis_image image;
    bis_diag diag = {0};
    assert_int_equal(bis_image_read(&image, file, (bis_loc){0}, &diag), BIS_OK);
    return image;
}

/* In the light of 1 from everywhere a plane diffuse surface shows its reflectance: brdf has no noise there. The mean of
 * a repeated bilinear image over a regular grid of even parts of a texel is that of its texels, 0.375. And the picture
 * stands upright: its top left pixel, at (1/32, 31/32), has texel weights (9/16, 7/16) in both directions. */
static void in_a_furnace_the_mean_of_the_picture_is_that_of_the_image(void **state)
{
    program_run r;
    char text[2048];
    const char *name = four();
    snprintf(text, sizeof text,
        VIEW "Integrator \"brdf\"\nWorldBegin LightSource \"infinite\" Texture \"t\" \"color\" \"imagemap\" \"string "
             "filename\" "
             "\"../scratch/%s\"\nMaterial \"diffuse\" \"texture reflectance\" \"t\"\n" SQUARE,
        name);
    program_write_file(DIR "/furnace.txt", text);
    program_expect(&r, 0, DIR "/furnace.txt --spp 1 --quiet --outfile " DIR "/furnace.pfm");
    bis_image image = rendered(DIR "/furnace.pfm");
    double sum = 0;
    for (int i = 0; i < 256; i++) sum += (double)image.pixels[i].g;
    assert_near(sum / 256, 0.375);
    const double near = 9 / 16.0, far = 7 / 16.0;
    assert_near((double)image.pixels[0].g, near * (near * 0.4 + far * 0.8) + far * (near * 0.1 + far * 0.2));
    assert_near((double)image.pixels[255].g, near * (near * 0.2 + far * 0.1) + far * (near * 0.8 + far * 0.4));
    bis_image_clear(&image);
}

/* The same nine triangles, coloured by a texture, and cut into two meshes with constant materials: the same bits with
 * every integrator, because points, directions and materials are the same. */
static void a_textured_scene_is_the_scene_cut_into_its_colours(void **state)
{
    static const char product[] = "sir\" \"string proposal\" \"product\" \"integer candidates\" 64 \"bool "
                                  "learn\" true \"string resampling\" \"systematic";
    static const char *const methods[] = {"em", "brdf", "mis", "sir", "rejection", "exact", "unoccluded", product};
    static const char *const ball =
        "Material \"diffuse\" Translate 0.2 0.1 0.7 Shape \"sphere\" \"float radius\" 0.3\n";
    static const char *const dark = "Material \"phong\" \"float Kd\" 0.125 \"float Ks\" 0.5 \"float exponent\" 20\n",
                      *const light = "Material \"phong\" \"float Kd\" 0.5 \"float Ks\" 0.25 \"float exponent\" 80\n";
    char cut[4096] = "", whole[4096] = "", text[8192];
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            char quad[256];
            const double x0 = -1 + 2 / 3.0 * i, y0 = -1 + 2 / 3.0 * j, x1 = x0 + 2 / 3.0, y1 = y0 + 2 / 3.0;
            snprintf(quad, sizeof quad,
                "Shape \"trianglemesh\" \"point3 P\" [%g %g 1 %g %g 1 %g %g 1 %g %g 1] \"integer indices\" [0 1 2 0 2 "
                "3] ",
                x0, y0, x1, y0, x1, y1, x0, y1);
            strcat(strcat(cut, (i + j) % 2 ? dark : light), quad);
            sprintf(whole + strlen(whole), "%s \"point2 uv\" [%d %d %d %d %d %d %d %d]\n", quad, i, j, i + 1, j, i + 1,
                j + 1, i, j + 1);
        }
    }
    for (size_t k = 0; k < sizeof methods / sizeof *methods; k++) {
        program_run r;
        for (int textured = 0; textured < 2; textured++) {
            snprintf(text, sizeof text,
                "Camera \"orthographic\" Film \"rgb\" \"integer xresolution\" 32 \"integer yresolution\" "
                "24\nIntegrator \"%s\"\n"
                "Sampler \"sobol\" \"integer seed\" 3\nWorldBegin LightSource \"infinite\" \"string filename\" "
                "\"../../tests/data/scenes/map.pfm\"\n%s%s%s",
                methods[k],
                textured ? "Texture \"d\" \"color\" \"checkerboard\" \"float tex1\" 0.5 \"float tex2\" 0.125\n"
                           "Texture \"s\" \"color\" \"checkerboard\" \"float tex1\" 0.25 \"float tex2\" 0.5\n"
                           "Texture \"n\" \"float\" \"checkerboard\" \"float tex1\" 80 \"float tex2\" 20\n"
                           "Material \"phong\" \"texture Kd\" \"d\" \"texture Ks\" \"s\" \"texture exponent\" \"n\"\n"
                         : "",
                textured ? whole : cut, ball);
            program_write_file(textured ? DIR "/textured.txt" : DIR "/cut.txt", text);
            program_expect(&r, 0, "%s --spp 4 --quiet --outfile %s", textured ? DIR "/textured.txt" : DIR "/cut.txt",
                           textured ? DIR "/textured.pfm" : DIR "/cut.pfm");
        }
        bis_image a = rendered(DIR "/textured.pfm"), b = rendered(DIR "/cut.pfm");
        assert_memory_equal(a.pixels, b.pixels, 32 * 24 * sizeof(rgb));
        assert_true(rgb_sum(a.pixels[12 * 32 + 16]) > 0);
        bis_image_clear(&a);
        bis_image_clear(&b);
    }
}

static void the_plan_says_what_textures_cost(void **state)
{
    program_run r;
    program_write_file(DIR "/p.pfm", "Pf\n1000 500\n-1.0\nabcd");
    program_write_file(DIR "/p.txt",
        "WorldBegin LightSource \"infinite\"\nTexture \"a\" \"color\" \"imagemap\" \"string filename\" \"p.pfm\"\n"
        "Texture \"b\" \"color\" \"imagemap\" \"string filename\" \"p.pfm\" \"string encoding\" \"linear\"\n"
        "Texture \"c\" \"float\" \"checkerboard\" \"float tex1\" 1 \"float tex2\" 2\n"
        "Material \"phong\" \"texture Kd\" \"a\" \"texture exponent\" \"c\" Shape \"sphere\" " TRIANGLE);
    program_expect(&r, 0, DIR "/p.txt --plan");
    assert_non_null(strstr(r.output, "material     0: phong, Kd texture (p.pfm), Ks 0, exponent texture "
                                     "(checkerboard); 2 shapes\n"));
    assert_non_null(strstr(r.output, "build        texture " DIR "/p.pfm, 1000 x 500: 6.0 MB\n"));
    assert_non_null(strstr(r.output, "skip         texture " DIR "/p.pfm: no shape shows it\n"));
    assert_non_null(strstr(r.output, "build        texture coordinates: 8 bytes for each vertex of the scene\n"));
}

/* All methods at points with several materials, against sums over all patches, and the picture against one that
 * src/render has no part in. */
static void verify_finds_a_textured_scene_right(void **state)
{
    bis_verify v = {.seed = 1, .halvings = 2};
    built b = {0};
    char text[1024];
    snprintf(text, sizeof text,
        "Camera \"orthographic\" Film \"rgb\" \"integer xresolution\" 24 \"integer yresolution\" 24\n"
        "WorldBegin LightSource \"infinite\" \"string filename\" \"../../tests/data/scenes/map.pfm\"\n"
        "Texture \"d\" \"color\" \"checkerboard\" \"rgb tex1\" [0.5 0.1 0.3] \"float tex2\" 0.125 \"float uscale\" 3 "
        "\"float vscale\" 2\n"
        "Texture \"n\" \"float\" \"checkerboard\" \"float tex1\" 80 \"float tex2\" 20\n"
        "Material \"phong\" \"texture Kd\" \"d\" \"float Ks\" 0.25 \"texture exponent\" \"n\"\n" SQUARE);
    store(scratch("scene.txt"), text, strlen(text));
    assert_int_equal(bis_scene_parse(&b.desc, scratch("scene.txt"), &b.diag), BIS_OK);
    b.desc->light_needs = BIS_VERIFY_LIGHT_NEEDS;
    assert_int_equal(bis_scene_build(&b.scene, b.desc, &b.diag), BIS_OK);
    assert_int_equal(bis_verify_scene(&v, b.scene, b.desc, &b.desc->view.settings, &b.diag), BIS_OK);
    assert_int_equal(bis_verify_judge(&v, &b.diag), BIS_OK);
    assert_true(v.n_statistical > 20);
    for (size_t i = 0; i < v.n; i++)
        if (v.tests[i].verdict == BIS_VERDICT_FAILED) print_error("%s: %s\n", v.tests[i].name, v.tests[i].note);
    assert_int_equal(v.n_failed, 0); /* by its own level: 1 %, for one seed */
    bis_verify_clear(&v);
    scene_clear(&b);
}

static int count_of(const char *text, const char *word)
{
    int n = 0;
    for (; (text = strstr(text, word)) != NULL; text += strlen(word)) n++;
    return n;
}

static double mean_of_file(const char *path)
{
    bis_image image = rendered(path);
    double sum = 0;
    for (int k = 0; k < image.width * image.height; k++) sum += rgb_sum(image.pixels[k]);
    sum /= image.width * image.height;
    bis_image_clear(&image);
    return sum;
}

/* The scenes of data/scenes/pbrt, of which no other test knows; those that need --approximate are
 * tests/cli/test_program.c's. */
static void the_shipped_scenes_of_each_version_render(void **state)
{
    struct dirent **entries;
    const int n_entries = scandir("data/scenes/pbrt", &entries, NULL, alphasort);
    int n = 0;

    assert_true(n_entries > 0);
    for (int i = 0; i < n_entries; i++) {
        program_run r;
        const char *name = entries[i]->d_name, *dot = strrchr(name, '.');
        if (!dot || strcmp(dot, ".txt") != 0) continue;
        program_expect(&r, 0, "data/scenes/pbrt/%s --spp 2 --resolution 64x32 --outfile " DIR "/shipped.exr", name);
        const bool equal_area = strcmp(name, "textures-v4.txt") == 0;
        if (count_of(r.messages, "warning: ") != equal_area) fail_msg("%s: %s", name, r.messages);
        assert_true(equal_area == !!strstr(r.messages, "it is taken for an equal-area map, as in pbrt-v4"));
        const double mean = mean_of_file(DIR "/shipped.exr");
        assert_true(isfinite(mean) && mean > 0);
        n++;
    }
    for (int i = 0; i < n_entries; i++) free(entries[i]);
    free(entries);
    assert_true(n >= 8);
    program_run r; /* what bis only replaces; the scene says itself that it may */
    program_expect(&r, 0, "data/scenes/pbrt/every-word.pbrt --resolution 48x24 --spp 1 --outfile " DIR "/shipped.exr");
    assert_true(count_of(r.messages, "approximated: 1 x ") >= 35);
    assert_true(mean_of_file(DIR "/shipped.exr") > 0);
}

/* In the light of 1 a diffuse disk is as bright as its reflectance is, 1/4 in each of the four spellings; beside it is
 * the light itself. */
static void in_the_furnace_four_spellings_of_a_quarter_are_a_quarter(void **state)
{
    program_run r;
    program_expect(&r, 0, "data/scenes/pbrt/colours-v2.txt --quiet --spp 2 --outfile " DIR "/colours.pfm");
    bis_image image = rendered(DIR "/colours.pfm");
    assert_int_equal(image.width, 160);
    for (int i = 0; i < 4; i++) {
        const rgb c = image.pixels[20 * 160 + 20 + 40 * i];
        assert_true(
            fabs((double)c.r - 0.25) < 5e-5 && fabs((double)c.g - 0.25) < 5e-5 && fabs((double)c.b - 0.25) < 5e-5);
    }
    assert_true(image.pixels[0].r == 1);
    bis_image_clear(&image);
}

/* ---- the point in place of (u, v) ---- */

/* Points whose (s, t) is the centre of a texel of four.pfm: 0.1 at (1/4, 1/4), 0.2 at (3/4, 1/4), 0.4 and 0.8 above. */
typedef struct mapped {
    const char *before, *params;
    double p[4][3]; /* of 0.1, 0.2, 0.4, 0.8 */
} mapped;

static const double texels[4] = {0.1, 0.2, 0.4, 0.8};

static void points_are_mapped_by_angles_or_by_a_plane(void **state)
{
    static const mapped cases[] = {
        /* theta 45 or 135 degrees, phi 90 or 270 */
        {"", "\"string mapping\" \"spherical\"", {{0, 1, 1}, {0, 2, -2}, {0, -1, 1}, {0, -0.5, -0.5}}},
        /* phi -90 or 90 degrees; z, which repeats */
        {"", "\"string mapping\" \"cylindrical\"", {{0, -2, 0.25}, {0, 3, 0.25}, {0, -1, 0.75}, {0, 1, 1.75}}},
        {"", "\"string mapping\" \"planar\"", {{0.25, 0.25, 9}, {0.75, 1.25, 0}, {-0.75, 0.75, 0}, {0.75, 0.75, -3}}},
        /* s = z/2 + 1/4, t = x/4 - 1/4 */
        {"", "\"string mapping\" \"planar\" \"vector3 v1\" [0 0 0.5] \"vector v2\" [0.25 0 0] \"float udelta\" 0.25 "
         "\"float vdelta\" -0.25",
         {{2, 0, 0}, {2, 7, 1}, {4, 0, 0}, {4, 0, 1}}},
        /* (x, y, z) of the space of the texture is (1 - 2y, 2 + 2x, 3 + 2z) of the world */
        {"Translate 1 2 3 Rotate 90 0 0 1 Scale 2 2 2", "\"string mapping\" \"spherical\"",
         {{-1, 2, 5}, {-1, 2, 1}, {3, 2, 5}, {3, 2, 1}}},
        {"Translate 1 2 3 Rotate 90 0 0 1 Scale 2 2 2", "\"string mapping\" \"cylindrical\"",
         {{3, 2, 3.5}, {-1, 2, 3.5}, {3, 2, 4.5}, {-1, 2, 4.5}}},
        {"Translate 1 2 3 Rotate 90 0 0 1 Scale 2 2 2", "\"string mapping\" \"planar\"",
         {{0.5, 2.5, 0}, {0.5, 3.5, 0}, {-0.5, 2.5, 0}, {-0.5, 3.5, 0}}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        built b = scene_build(LIGHT
            "AttributeBegin %s Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"%s\" %s AttributeEnd\n"
            "Scale 5 5 5 Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"sphere\"",
            cases[i].before, four(), cases[i].params);
        for (int k = 0; k < 4; k++) assert_near(value_at(&b, cases[i].p[k]), texels[k]);
        assert_true(isfinite(value_at(&b, (double[]){0, 0, 0}))); /* a sphere's centre has no angles */
        if (i == 0) {
            /* theta 120 degrees, phi 90: s = 2/3 is 5/6 of the way from 1/4 to 3/4. theta 45, phi 0: t = 0 is half way
             * between the row below and the repeated one above */
            assert_near(value_at(&b, (double[]){0, 0.8660254037844386, -0.5}), 0.1 + 0.1 * 5 / 6);
            assert_near(value_at(&b, (double[]){1, 0, 1}), 0.25);
        }
        scene_clear(&b);
    }
}

static void a_mapping_that_cannot_be_is_refused(void **state)
{
#define MAPPED "%sTexture \"t\" \"float\" \"checkerboard\" %s"
    static const char *const cases[][3] = { /* before, parameters, message */
        {LIGHT, "\"string mapping\" \"planar\" \"vector v1\" [1 0]", "\"v1\""},
        {LIGHT, "\"string mapping\" \"planar\" \"float v1\" 1", "is of type float, must be vector3"},
        {LIGHT, "\"string mapping\" \"spherical\" \"float uscale\" 2", "unknown parameter \"uscale\""},
        {LIGHT, "\"vector v1\" [1 0 0]", "unknown parameter \"v1\""},
        {LIGHT "Scale 1e-20 1 1 Scale 1e-20 1 1 ", "\"string mapping\" \"spherical\"", "by more than 1e30"},
        {LIGHT "Translate 0 0 2e30 ", "\"string mapping\" \"spherical\"", "by more than 1e30"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        expect_failure(cases[i][2], MAPPED, cases[i][0], cases[i][1]);
}

/* ---- texture.c by hand, without a scene ---- */

static bis_texture_image six(void)
{
    bis_texture_image image;
    bis_texture_file file = {.filename = (char *)(uintptr_t)scratch("six.pfm"), .gamma = 1};
    six_as(file.filename);
    assert_int_equal(bis_textures_load(&image, &file, NULL), BIS_OK);
    return image;
}

static void assert_rgbd(rgbd c, double r, double g, double b)
{
    if (!(fabs(c.r - r) < 1e-6 && fabs(c.g - g) < 1e-6 && fabs(c.b - b) < 1e-6))
        fail_msg("%.9g %.9g %.9g is not %.9g %.9g %.9g", c.r, c.g, c.b, r, g, b);
}

static bis_texture constant_of(double r, double g, double b)
{
    return (bis_texture){.kind = BIS_TEXTURE_CONSTANT, .value = {r, g, b}};
}

/* Of a grid of centres of texels and beyond; the least and the largest values of what has one image are met. */
static void the_range_of_each_kind_holds_its_values(void **state)
{
    bis_texture_image image = six();
    bis_texture list[] = {
        constant_of(0.5, 0.25, 2), {.kind = BIS_TEXTURE_IMAGE, .scale = 1},
        {.kind = BIS_TEXTURE_IMAGE, .scale = 2, .invert = true},
        {.kind = BIS_TEXTURE_IMAGE, .scale = 1, .is_float = true},
        {.kind = BIS_TEXTURE_IMAGE, .scale = 1, .wrap = BIS_WRAP_BLACK},
        {.kind = BIS_TEXTURE_CHECKERBOARD, .of = {0, 1}},
        {.kind = BIS_TEXTURE_CHECKERBOARD, .of = {1, 0}}, {.kind = BIS_TEXTURE_SCALE, .of = {0, 1}},
        {.kind = BIS_TEXTURE_SCALE, .of = {1, 1}}, {.kind = BIS_TEXTURE_COAT, .of = {1}, .scale = 0.5},
        {.kind = BIS_TEXTURE_ALPHA, .of = {1}}, {.kind = BIS_TEXTURE_MIX, .of = {0, 1, 3}}};
    const bis_textures t = {.list = list, .n = sizeof list / sizeof *list};
    for (uint32_t i = 0; i < t.n; i++) {
        rgbd lo, hi, least = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, most = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
        for (int k = 0; k < 2; k++)
            if (list[i].factor[k] == 0) list[i].factor[k] = 1;
        bis_textures_range(&lo, &hi, &t, &image, i);
        for (int k = 0; k < 81; k++) {
            const double uv[2] = {(k % 9 - 3 + 0.5) / 3, (k / 9 - 3 + 0.5) / 2};
            const rgbd c = bis_textures_value(&t, &image, i, uv, (vec3){0, 0, 0});
            least = (rgbd){fmin(least.r, c.r), fmin(least.g, c.g), fmin(least.b, c.b)};
            most = (rgbd){fmax(most.r, c.r), fmax(most.g, c.g), fmax(most.b, c.b)};
        }
        if (list[i].kind == BIS_TEXTURE_MIX) {
            assert_true(lo.r <= least.r && lo.g <= least.g && lo.b <= least.b && lo.r > 0 && hi.r <= 0.5 &&
                        hi.r >= most.r && hi.g >= most.g && hi.b >= most.b);
        } else {
            assert_rgbd(lo, least.r, least.g, least.b);
            assert_rgbd(hi, most.r, most.g, most.b);
        }
    }
    bis_image_clear(&image.image);
}

/* A bad channel of any texel is found, and its place is told. */
static void a_bad_texel_is_told_with_its_place(void **state)
{
    for (int bad = 0; bad < 18; bad++) {
        const float wrong[3] = {-0.25f, INFINITY, NAN};
        char text[100];
        bytes b = {0};
        put_text(&b, "PF\n3 2\n-1.0\n");
        for (int i = 0; i < 18; i++) put_float(&b, i == bad ? wrong[bad % 3] : 0.5f);
        store(scratch("bad.pfm"), b.data, b.n);
        bytes_clear(&b);
        snprintf(text, sizeof text, ": texel (%d, %d), counted from the top left, is ", bad / 3 % 3, bad / 9 == 0);
        expect_failure(text, LIGHT IMAGEMAP "\nMaterial \"diffuse\" \"texture reflectance\" \"t\" Shape \"sphere\"",
                       "color", beside(scratch("bad.pfm")));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_texture_has_the_values_beside_it),
        cmocka_unit_test(a_sphere_has_pbrts_coordinates),
        cmocka_unit_test(a_disk_has_pbrts_coordinates),
        cmocka_unit_test(a_triangle_interpolates_its_corners_and_without_any_has_pbrts),
        cmocka_unit_test(each_mesh_of_a_scene_keeps_its_own),
        cmocka_unit_test(an_obj_and_a_ply_bring_theirs),
        cmocka_unit_test(an_obj_brings_its_materials_and_each_part_is_a_shape),
        cmocka_unit_test(a_statement_of_a_library_is_taken_ignored_or_refused),
        cmocka_unit_test(the_range_of_each_kind_holds_its_values),
        cmocka_unit_test(an_image_is_found_in_each_part_of_a_texture),
        cmocka_unit_test(instances_of_an_obj_with_materials_are_alike),
        cmocka_unit_test(options_of_a_map_change_what_they_name_alone),
        cmocka_unit_test(a_point_has_the_material_of_its_place),
        cmocka_unit_test(values_out_of_range_are_refused_when_the_image_is_known),
        cmocka_unit_test(textures_of_textures_have_a_limit),
        cmocka_unit_test(in_a_furnace_the_mean_of_the_picture_is_that_of_the_image),
        cmocka_unit_test(a_textured_scene_is_the_scene_cut_into_its_colours),
        cmocka_unit_test(the_plan_says_what_textures_cost),
        cmocka_unit_test(verify_finds_a_textured_scene_right),
        cmocka_unit_test(the_shipped_scenes_of_each_version_render),
        cmocka_unit_test(in_the_furnace_four_spellings_of_a_quarter_are_a_quarter),
        cmocka_unit_test(points_are_mapped_by_angles_or_by_a_plane),
        cmocka_unit_test(a_mapping_that_cannot_be_is_refused),
        cmocka_unit_test(a_bad_texel_is_told_with_its_place),
    };
    program_folder(DIR);
    return cmocka_run_group_tests(tests, NULL, scratch_remove);
}
