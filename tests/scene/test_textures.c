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

static built of_file(const char *name)
{
    return scene_build(LIGHT "Texture \"t\" \"color\" \"imagemap\" \"string filename\" \"%s\"\n"
                             "Material \"matte\" \"texture Kd\" \"t\" Shape \"sphere\"", name);
}

/* bis has a reader of its own for each of these through libpng's conversions: colours, palettes, transparency. */
static void every_kind_of_png_has_the_same_colours(void **state)
{
    const unsigned char rgba[8] = {255, 99, 0, 0, 0, 188, 255, 128};
    built b = of_file(store_png(scratch("rgba.png"), 2, 1, PNG_FORMAT_RGBA, rgba));
    const bis_image *im = &b.scene->images[0].image;
    assert_true(im->pixels[0].r == 1 && im->pixels[0].b == 0);
    assert_near((double)im->pixels[0].g, 0.12477182);
    assert_true(im->pixels[1].r == 0 && im->pixels[1].b == 1);
    scene_clear(&b);
    /* a palette of two colours, one bit a pixel: written by hand, 8 x 1, 10101010 */
    png_bytep row = (png_byte[]){0xaa};
    FILE *f = fopen(scratch("palette.png"), "wb");
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, f);
    png_set_IHDR(png, info, 8, 1, 1, PNG_COLOR_TYPE_PALETTE, PNG_INTERLACE_ADAM7, PNG_COMPRESSION_TYPE_DEFAULT,
        PNG_FILTER_TYPE_DEFAULT);
    png_set_PLTE(png, info, (png_color[]){{255, 0, 0}, {0, 255, 188}}, 2);
    png_write_info(png, info);
    for (int pass = png_set_interlace_handling(png); pass > 0; pass--) png_write_row(png, row);
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    fclose(f);
    b = of_file(beside(scratch("palette.png")));
    im = &b.scene->images[0].image;
    assert_int_equal(im->width, 8);
    for (int i = 0; i < 8; i++) assert_true(im->pixels[i].r == (i % 2) && im->pixels[i].g == (i + 1) % 2);
    assert_near((double)im->pixels[0].b, 0.50288646);
    scene_clear(&b);
}

/* ---- textures of textures ---- */

static void a_texture_that_is_the_same_everywhere_is_no_texture(void **state)
{
    built b = scene_build(LIGHT "Texture \"c\" \"float\" \"constant\" \"float value\" 0.5\n"
                          "Texture \"t\" \"spectrum\" \"scale\" \"rgb tex\" [0.5 0.25 1] \"texture scale\" \"c\"\n"
                          "Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"sphere\"");
    const bis_scene_desc *d = b.desc;
    assert_null(bis_textures_of(&d->textures, d->shapes[0].material));
    const bis_material *m = &d->materials[d->shapes[0].material];
    assert_true(m->Kd.r == 0.25f && m->Kd.g == 0.125f && m->Kd.b == 0.5f);
    scene_clear(&b);
}

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

static void without_textures_no_coordinates_are_kept(void **state)
{
#define WITH_UV TRIANGLE "\"point2 uv\" [5 5  6 5  5 6] "
    static const char *const scenes[] = {LIGHT WITH_UV WITH_UV WITH_UV, LIGHT WITH_UV TRIANGLE TRIANGLE,
        LIGHT TRIANGLE WITH_UV TRIANGLE, LIGHT TRIANGLE TRIANGLE WITH_UV};
    for (int k = 0; k < 4; k++) {
        built b = scene_build("%s", scenes[k]);
        for (int i = 0; i < 3; i++) assert_null(b.desc->meshes[i].mesh.uv);
        assert_null(b.scene->geometry.uv);
        assert_int_equal(b.diag.n, 0);
        scene_clear(&b);
    }
#undef WITH_UV
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
static void assert_three_parts(const char *scene)
{
    built b;
    bis_own_material m;
    bis_counters counters = {0};
    bis_point pt;
    assert_int_equal(scene_try(&b, scene), BIS_OK);
    assert_int_equal(b.diag.n, 0);
    assert_int_equal(b.desc->n_shapes, 3);
    assert_int_equal(b.scene->geometry.n_triangles, 6);
    assert_int_equal(b.scene->geometry.n_vertices, 12);
    for (int k = 0; k < 3; k++) {
        const ray r = {{-1.5f + (float)k, 0.25f, 5}, {0, 0, -1}, INFINITY};
        bis_hit hit;
        size_t part;
        assert_true(bis_scene_point(&pt, &m, b.scene, r, &counters, &hit));
        assert_int_equal(bis_scene_shape_of(b.scene, hit.prim, &part), k);
        const bis_material *at = pt.bsdf.material;
        if (k == 0) assert_true(at->Kd.r == 0.375f);
        if (k == 1) assert_true(at->Kd.r == 0.25f && at->Kd.g == 0.125f && at->Kd.b == 0.5f && at->Ks.r == 0);
        if (k == 2) assert_true(at->Kd.r == 0.75f && at->Kd.g == 0.125f && at->Ks.b == 0.25f && at->exponent == 12.5);
    }
    assert_int_equal(b.desc->meshes[0].n_parts, 3);
    for (uint32_t k = 0; k < 3; k++) assert_int_equal(b.desc->shapes[k].part, k);
    const bis_texture *x = &b.desc->textures.list[0], *Kd = x + 1, *product = x + 2; /* map_Kd times Kd */
    assert_int_equal(b.desc->textures.n, 3);
    assert_true(Kd->kind == BIS_TEXTURE_CONSTANT && Kd->steps == 1 && Kd->value.r == 0.5 && Kd->value.g == 0.25 &&
                Kd->value.b == 1);
    assert_true(product->kind == BIS_TEXTURE_SCALE && product->of[0] == 0 && product->of[1] == 1 &&
                product->steps == 3 && product->scale == 1);
    assert_true(product->value.r == 0.25 && product->value.g == 0.125 && product->value.b == 0.5);
    assert_true(x->factor[0] == 2 && x->factor[1] == 1 && x->offset[0] == 0.5 && x->wrap == BIS_WRAP_CLAMP);
    scene_clear(&b);
}

static void an_obj_plain_or_compressed_brings_its_materials_and_each_part_is_a_shape(void **state)
{
    built b;
    write_obj();
    assert_int_equal(system("gzip -c " DIR "/o.obj > " DIR "/o.obj.gz"), 0);
    assert_three_parts(LIGHT PLAIN OBJ_SHAPE("o.obj") MATERIALS);
    assert_three_parts(LIGHT PLAIN OBJ_SHAPE("o.obj.gz") MATERIALS);
    /* without the parameter it is one shape as ever */
    assert_int_equal(scene_try(&b, LIGHT PLAIN OBJ_SHAPE("o.obj")), BIS_OK);
    assert_int_equal(b.desc->n_shapes, 1);
    assert_int_equal(b.scene->geometry.n_vertices, 8);
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

static void mistakes_of_a_library_are_found_in_it(void **state)
{
    static const char scene[] = LIGHT OBJ_SHAPE("o.obj") MATERIALS;
    static const struct { const char *obj, *mtl, *message; } cases[] = {
        {"usemtl a\nmtllib lib.mtl\n", "newmtl a\nKd 0 0\n", "lib.mtl:2: error: Kd is \"0 0\", must be three numbers"},
        {"usemtl a\nmtllib lib.mtl\n", "newmtl a\nKd 0 0 2\n", "lib.mtl:2: error: \"Kd\" is 2, must be in [0, 1]"},
        {"usemtl a\nmtllib lib.mtl\n", "\nKd 0 0 1\n", "lib.mtl:2: error: \"Kd\" stands before the first newmtl"},
        {"usemtl a\nmtllib lib.mtl\n", "newmtl b\n", "material \"a\" of "},
        {"usemtl a\n", "", "material \"a\" of "},
        {"usemtl a\nmtllib no.mtl\n", "", "o.obj:2: error: cannot read \""},
        {"usemtl a\nmtllib lib.mtl\n", "newmtl a\nmap_Kd no.png\n", "lib.mtl:2: error: cannot read \""},
        {"usemtl a\nmtllib lib.mtl\n", "newmtl a\nmap_Kd -mm 1 2 four.pfm\n",
         "lib.mtl:2: error: the option -mm of a map is not modelled"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char obj[1024];
        built b;
        snprintf(obj, sizeof obj, "%sv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", cases[i].obj);
        program_write_file(DIR "/o.obj", obj);
        program_write_file(DIR "/lib.mtl", cases[i].mtl);
        assert_int_equal(scene_try(&b, scene), BIS_INPUT);
        if (!strstr(b.diag.messages[0].text, cases[i].message))
            fail_msg("%s, not %s", b.diag.messages[0].text, cases[i].message);
        if (b.diag.n != 1) fail_msg("%s: and %s", cases[i].message, b.diag.messages[1].text); /* no second mistake */
        scene_clear(&b);
    }
}

/* One face of material a, whose library says this. */
static bis_status build_library(built *b, const char *statements)
{
    char mtl[1024];
    snprintf(mtl, sizeof mtl, "newmtl a\n%s\n", statements);
    store(DIR "/four.pfm", "Pf\n1 1\n-1.0\n\0\0\0\x3f", 16); /* 0.5 */
    store(DIR "/3 four.pfm", "Pf\n1 1\n-1.0\n\0\0\0\x3f", 16);
    program_write_file(DIR "/o.obj", "mtllib lib.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    program_write_file(DIR "/lib.mtl", mtl);
    return scene_try(b, LIGHT OBJ_SHAPE("o.obj") MATERIALS);
}

#define OPAQUE(line, word) line ": warning: " word " is ignored, which changes shape: the material is opaque"
#define DARK "2: warning: Ke is ignored, which changes brightness: no surface gives light"
#define IGNORED(word, rest, changes) {word rest, "2: warning: " word " is ignored, which changes " changes}
#define GLOSS(word) IGNORED(word, " 1\n" word " 2", "highlights: they are as Ks and Ns say")
#define NO_OPTION(map, option) {map, "2: error: the option " option " of a map is not modelled: remove it"}
#define NOT(word, value, what) {word " " value, "2: error: " word " is \"" value "\", must be " what}

/* What it says in vain is told once; numbers are checked. A colour has all channels, and l is the mean. */
static void a_statement_of_a_library_is_taken_ignored_or_refused(void **state)
{
    static const struct {
        const char *mtl, *said; /* behind the library's name: how an error begins, or a warning; NULL: nothing */
    } cases[] = {
        {"d 1", NULL}, {"d 2", NULL}, {"Tr 0", NULL}, {"Tr -1", NULL}, {"Ke 0 0 0", NULL}, {"Ke 0", NULL},
        {"d 1\nTr 0\nKe 0", NULL}, {"Ka 1 2 3\nNi 1.5\nTf 1 1 1\nsharpness 60\nmap_Ka no.png", NULL},
        {"# d 0.5\n\t# x\n\n  \t\n", NULL}, {"d 0.5", OPAQUE("2", "d")}, {"d 0.999", OPAQUE("2", "d")},
        {"d 1\nTr 0.25", OPAQUE("3", "Tr")}, {"Tr 1e-3", OPAQUE("2", "Tr")}, {"d 0.5\nTr 0.5\nd 0", OPAQUE("2", "d")},
        {"Ke 1 -1 0", NULL}, {"Ke -3 1 1", NULL}, {"illum 1\nKd 0.75 0.75 0.75\nKs 0.5 0.5 0.5", NULL},
        {"Kd 0.75 0 0\nKs 0.5 0 0", "1: warning: Kd + Ks is 1.25 in red: the material reflects more light than it "
         "receives. Make one of them smaller"},
        {"Kd 1 1 1\r\nKs 0\r\rd 0.5", OPAQUE("5", "d")}, {"\n\v\fd 0.5\f", OPAQUE("3", "d")},
        {"Ke 1 0 0", DARK}, {"Ke 0 1 0", DARK}, {"Ke 0 0 1", DARK}, {"Ke 0.1\nKe 2 2 2", DARK},
        GLOSS("map_Ks"), GLOSS("map_Ns"), GLOSS("refl"), GLOSS("Pr"), GLOSS("Pm"), GLOSS("Ps"), GLOSS("Pc"),
        GLOSS("map_Pr"), GLOSS("map_Pm"), GLOSS("aniso"), IGNORED("map_d", " x", "shape: there are no holes"),
        IGNORED("map_Ke", " x", "brightness: no surface gives light"),
        IGNORED("decal", " x", "colour: it is as Kd says"), IGNORED("disp", " x", "shape: the mesh stays as it is"),
        {"foo 1\nbar 2", "2: warning: the unknown word \"foo\" is ignored, and others like it"},

        NOT("Kd", "0.1 x 0.3", "three numbers"), NOT("Kd", "", "three numbers"),
        NOT("Kd", "0.1 0.2 nan", "three numbers"), NOT("Kd", "0.1 0.2", "three numbers"),
        NOT("Ks", "0.1 inf 0", "three numbers"), {"Ks 0 1.5 0", "2: error: \"Ks\" is 1.5, must be in [0, 1]"},
        {"Ks -0.5 0 0", "2: error: \"Ks\" is -0.5, must be in [0, 1]"},
        {"Ks 0 0 2", "2: error: \"Ks\" is 2, must be in [0, 1]"}, {"Ns -1", "2: error: \"Ns\" is -1, must be "},
        NOT("Ns", "inf", "a number"), NOT("d", "x", "a number"), NOT("Tr", "", "a number"),
        NOT("illum", "x", "a number"), NOT("Ke", "1 2", "three numbers"),
        NO_OPTION("map_Kd -s 2 -bm 2 four.pfm", "-bm"), NO_OPTION("map_Kd -mm 0.5 four.pfm", "-mm"),
        NO_OPTION("map_Kd -mm 0 2 four.pfm", "-mm"), NO_OPTION("map_Kd -t 0 0 0.1 four.pfm", "-t"),
        {"map_Kd -colorspace AdobeRGB four.pfm",
         "2: error: the colour space \"AdobeRGB\" of a map is not known, must be sRGB or linear"},
        NO_OPTION("map_Kd -what 1 four.pfm", "-what"),
        {"bump -bm x four.pfm", "2: error: -bm is \"x four.pfm\", must be a number"},
        {"bump -bm inf four.pfm", "2: error: -bm is \"inf four.pfm\", must be a number"},
        {"map_bump -imfchan r four.pfm",
         "2: error: -imfchan r is not modelled, because a map of numbers is the mean of red, green and blue: save "
         "the channel as a grey image and remove the option"},
        NO_OPTION("norm -bm 2 four.pfm", "-bm"),
        {"norm -s 2 four.pfm", "2: error: the options -s and -o of norm are not modelled: remove them"},
        {"norm -o 0 0.5 four.pfm", "2: error: the options -s and -o of norm are not modelled: remove them"},
        {"norm -s 1 2 four.pfm", "2: error: the options -s and -o of norm are not modelled: remove them"},
        {"norm -o 0.5 four.pfm", "2: error: the options -s and -o of norm are not modelled: remove them"},
        {"norm -o 0 0 -s 1 1 2 four.pfm", ""},
        {"bump -bm 2 3 four.pfm", ""}, /* an option takes no more numbers than it has: of the image "3 four.pfm" */
        {"map_Kd -bm 1 3 four.pfm", ""}, {"map_Kd -mm 0 1 3 four.pfm", ""}, {"map_Kd -t 0 0 0 3 four.pfm", ""},
        {"map_Kd -s 1 1 1 3 four.pfm", ""},
        {"bump -imfchan abcdefghij four.pfm", "2: error: -imfchan abcdefgh is not modelled, "},
        {"bump -imfchan ll four.pfm", "2: error: -imfchan ll is not modelled, "},
        {"bump -imfchan m four.pfm", "2: error: -imfchan m is not modelled, "},
        NO_OPTION("map_Kd -mm 1 1 four.pfm", "-mm"), NO_OPTION("map_Kd -t 1 four.pfm", "-t"),
        NO_OPTION("map_Kd -t 0 1 0 four.pfm", "-t"), NO_OPTION("map_Kd -bm 0 four.pfm", "-bm"),
        {"map_Kd -clamp", "2: error: cannot read \"build/scratch/../test_textures/\": the name is empty"},
        {"map_Kd -colorspace linear", "2: error: cannot read \"build/scratch/../test_textures/\": the name is empty"},
        {"map_Kd -what", "2: error: the option -what of a map is not modelled: remove it"},
        {"foo", "2: warning: the unknown word \"foo\" is ignored, and others like it"},
        {"map_Kd -imfchan r four.pfm\nbump -imfchan l four.pfm", ""}, /* that the mesh has no coordinates */
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const char *const said = cases[i].said;
        built b;
        const bool is_error = said && strstr(said, ": error: ");
        const bis_status status = build_library(&b, cases[i].mtl);
        if (status != (is_error ? BIS_INPUT : BIS_OK)) fail_msg("%s: status %d", cases[i].mtl, status);
        if (b.diag.n != (said ? 1 : 0)) fail_msg("%s: %zu messages", cases[i].mtl, b.diag.n);
        const char *const text = said && *said ? strstr(b.diag.messages[0].text, "lib.mtl:") : NULL;
        const size_t n = said ? strlen(said) + !is_error : 0; /* a warning is told to its end */
        if (said && *said && (!text || strncmp(text + strlen("lib.mtl:"), said, n) != 0))
            fail_msg("%s: %s", cases[i].mtl, b.diag.messages[0].text);
        scene_clear(&b);
    }
}

/* Kd 1/2, Ks 0, Ns 50 where nothing is said; illum 0 and 1 have no highlight. One number stands for three. */
static void a_librarys_values_are_those_of_the_material(void **state)
{
    static const struct { const char *mtl; float Kd[3], Ks[3]; double Ns; } cases[] = {
        {"", {0.5f, 0.5f, 0.5f}, {0, 0, 0}, 50}, {"Kd 0.25", {0.25f, 0.25f, 0.25f}, {0, 0, 0}, 50},
        {"Kd 0.25 # grey", {0.25f, 0.25f, 0.25f}, {0, 0, 0}, 50}, {"Kd 0.25 1 0 # green", {0.25f, 1, 0}, {0, 0, 0}, 50},
        {"Ks 0.125 0.25 0.5", {0.5f, 0.5f, 0.5f}, {0.125f, 0.25f, 0.5f}, 50},
        {"Ks 0.25\nillum 0", {0.5f, 0.5f, 0.5f}, {0, 0, 0}, 50},
        {"Ks 0.25\nillum 1", {0.5f, 0.5f, 0.5f}, {0, 0, 0}, 50}, {"illum 2\nKs 0.25", {0.5f, 0.5f, 0.5f}, {0.25f, 0.25f,
         0.25f}, 50},
        {"illum 1\nKs 0.25\nillum 3", {0.5f, 0.5f, 0.5f}, {0.25f, 0.25f, 0.25f}, 50},
        {"Ns 0\nKs 0.25", {0.5f, 0.5f, 0.5f}, {0.25f, 0.25f, 0.25f}, 0},
        {"Kd 0 1 0.5\rKs 0\r\n\tNs  1000 \t", {0, 1, 0.5f}, {0, 0, 0}, 1000},
        {"Kd 1 1 1\nnewmtl a\nKd 0 0 0", {1, 1, 1}, {0, 0, 0}, 50},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        built b;
        assert_int_equal(build_library(&b, cases[i].mtl), BIS_OK);
        const bis_material *m = &b.desc->materials[b.desc->shapes[0].material];
        assert_memory_equal(&m->Kd, cases[i].Kd, sizeof m->Kd);
        assert_memory_equal(&m->Ks, cases[i].Ks, sizeof m->Ks);
        if (m->exponent != cases[i].Ns) fail_msg("%s: Ns is %g", cases[i].mtl, m->exponent);
        assert_null(bis_textures_of(&b.desc->textures, b.desc->shapes[0].material));
        scene_clear(&b);
    }
}

/* -s and -o have one to three numbers, of which two count; all else keeps its usual value. */
static void options_of_a_map_change_what_they_name_alone(void **state)
{
    static const struct { const char *options; double factor[2], offset[2]; bis_wrap wrap; } cases[] = {
        {"", {1, 1}, {0, 0}, BIS_WRAP_REPEAT}, {"-s 2 ", {2, 1}, {0, 0}, BIS_WRAP_REPEAT},
        {"-s 2 3 ", {2, 3}, {0, 0}, BIS_WRAP_REPEAT},
        {"-s 2 3 4 ", {2, 3}, {0, 0}, BIS_WRAP_REPEAT}, {"-o 5 ", {1, 1}, {5, 0}, BIS_WRAP_REPEAT},
        {"-o 5 6 ", {1, 1}, {5, 6}, BIS_WRAP_REPEAT},
        {"-o 5 6 7 -s 2 3 4 ", {2, 3}, {5, 6}, BIS_WRAP_REPEAT}, {"-s -2 0.5 4\t-o 5 6 7  ", {-2, 0.5}, {5, 6},
         BIS_WRAP_REPEAT},
        {"-clamp on ", {1, 1}, {0, 0}, BIS_WRAP_CLAMP}, {"-clamp off ", {1, 1}, {0, 0}, BIS_WRAP_REPEAT},
        {"-clamp on -o 5 -clamp off -s 2 ", {2, 1}, {5, 0}, BIS_WRAP_REPEAT},
        {"-s 2 3", {2, 1}, {0, 0}, BIS_WRAP_REPEAT}, /* of the image 3four.pfm */
        {"-s 2 3 4 5", {2, 3}, {0, 0}, BIS_WRAP_REPEAT},
        {"..\\test_textures\\", {1, 1}, {0, 0}, BIS_WRAP_REPEAT},
    };
    store(DIR "/3four.pfm", "Pf\n1 1\n-1.0\n\0\0\0\x3f", 16);
    store(DIR "/5four.pfm", "Pf\n1 1\n-1.0\n\0\0\0\x3f", 16);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[256];
        built b;
        snprintf(text, sizeof text, "Kd 1 1 1\nmap_Kd %sfour.pfm", cases[i].options);
        assert_int_equal(build_library(&b, text), BIS_OK);
        const bis_textures *t = &b.desc->textures;
        const bis_material_textures *m = bis_textures_of(t, b.desc->shapes[0].material);
        assert_true(
            m && t->n == 1 && t->n_files == 1 && m->Kd == 0 && m->Ks == BIS_NO_TEXTURE && m->width == BIS_NO_TEXTURE);
        const bis_texture *x = &t->list[0];
        assert_memory_equal(x->factor, cases[i].factor, sizeof x->factor);
        assert_memory_equal(x->offset, cases[i].offset, sizeof x->offset);
        assert_true(x->kind == BIS_TEXTURE_IMAGE && x->wrap == cases[i].wrap && x->image == 0 && x->scale == 1 &&
                    !x->invert && !x->is_float && x->steps == 1);
        scene_clear(&b);
    }
}

/* Options that change no value pass; -colorspace is as tinyobjloader's users write it. The usual one is that of an
 * image of colours, or of numbers. */
static void options_that_change_no_value_pass(void **state)
{
    static const struct { const char *statement; double gamma; const char *said; } cases[] = {
        {"map_Kd four.pfm", BIS_GAMMA_SRGB, NULL}, {"map_Kd -colorspace sRGB four.pfm", BIS_GAMMA_SRGB, NULL},
        {"map_Kd -colorspace linear -clamp on four.pfm", 1, NULL}, {"map_Kd -colorspace LINEAR four.pfm", 1, NULL},
        {"map_bump four.pfm", 1, NULL}, {"map_bump -colorspace srgb four.pfm", BIS_GAMMA_SRGB, NULL},
        {"map_Kd -mm 0 1 -t 0 0 0 -bm 1 -t 0 four.pfm", BIS_GAMMA_SRGB, NULL},
        {"map_Kd -texres 512 four.pfm", BIS_GAMMA_SRGB,
         ":2: warning: -texres of a map is ignored: images are taken as they are"},
        {"map_Kd -blendu off -blendv on -boost 2 -cc on four.pfm", BIS_GAMMA_SRGB,
         ":2: warning: -blendu of a map is ignored: images are taken as they are"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        built b;
        assert_int_equal(build_library(&b, cases[i].statement), BIS_OK);
        size_t said = 0;
        for (size_t k = 0; k < b.diag.n; k++) {
            const char *text = strstr(b.diag.messages[k].text, "lib.mtl");
            if (!text) continue; /* the mesh has no coordinates */
            said++;
            assert_true(cases[i].said && strcmp(text + strlen("lib.mtl"), cases[i].said) == 0);
        }
        assert_int_equal(said, cases[i].said != NULL);
        assert_int_equal(b.desc->textures.n_files, 1);
        if (b.desc->textures.files[0].gamma != cases[i].gamma)
            fail_msg("%s: %g", cases[i].statement, b.desc->textures.files[0].gamma);
        scene_clear(&b);
    }
}

/* With --approximate an option that is not modelled takes its numbers with it, and the map is shown. */
static void an_option_that_is_left_out_leaves_the_map(void **state)
{
#define NO_MODEL "an option of a map that is not modelled", "ignored"
    static const struct { const char *statement, *kind, *consequence; } cases[] = {
        {"map_Kd -mm 0.1 0.9 four.pfm", NO_MODEL}, {"map_Kd -t 0.5 four.pfm", NO_MODEL},
        {"map_Kd -t 1 2 3 four.pfm", NO_MODEL}, {"map_Kd -bm 2 four.pfm", NO_MODEL},
        {"map_Kd -what 1 four.pfm", NO_MODEL},
        {"map_Kd -colorspace rec2020 four.pfm", "a colour space of a map that is not known", "the usual one"},
        {"norm -s 2 four.pfm", "-s or -o of a normal map", "the map lies as if it had neither"},
        {"bump -imfchan r four.pfm", "-imfchan of a map", "the mean of red, green and blue"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        built b;
        char mtl[256];
        snprintf(mtl, sizeof mtl, "newmtl a\nKd 1 1 1\n%s\n", cases[i].statement);
        store(DIR "/four.pfm", "Pf\n1 1\n-1.0\n\0\0\0\x3f", 16);
        program_write_file(DIR "/o.obj", "mtllib lib.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        program_write_file(DIR "/lib.mtl", mtl);
        assert_int_equal(
            scene_try(&b, "Option \"bool approximate\" true\n" LIGHT OBJ_SHAPE("o.obj") MATERIALS), BIS_OK);
        assert_int_equal(b.desc->n_approximations, 1);
        const bis_approximation *a = b.desc->approximations;
        assert_string_equal(a->kind, cases[i].kind);
        assert_string_equal(a->consequence, cases[i].consequence);
        assert_true(strstr(a->loc.file, "lib.mtl") && a->loc.line == 3 && a->effect == BIS_EFFECT_SHAPE);
        const bis_material_textures *t = bis_textures_of(&b.desc->textures, b.desc->shapes[0].material);
        if (b.desc->textures.n_files != 1 || !t) fail_msg("%s: no image", cases[i].statement);
        const char c = cases[i].statement[0];
        assert_true((t->Kd == 0) == (c == 'm') && (t->bump == 0) == (c == 'b') && (t->normals == 0) == (c == 'n'));
        scene_clear(&b);
    }
#undef NO_MODEL
}

/* Of an image that is not there, and of no height, nothing is left. */
static void a_map_of_nothing_is_none(void **state)
{
    static const char *const statements[] = {"map_Kd no.png", "bump no.png", "norm no.png", "bump -bm 0 four.pfm"};
    for (int i = 0; i < 4; i++) {
        built b;
        assert_int_equal(build_library(&b, statements[i]), i < 3 ? BIS_INPUT : BIS_OK);
        scene_clear(&b);
        assert_int_equal(
            scene_try(&b, "Option \"bool approximate\" true\n" LIGHT OBJ_SHAPE("o.obj") MATERIALS), BIS_OK);
        assert_int_equal(b.desc->n_approximations, i < 3);
        if (i < 3) {
            assert_string_equal(b.desc->approximations[0].kind, "an image of a library that is not there");
            assert_string_equal(b.desc->approximations[0].consequence, "the material without it");
        }
        assert_null(bis_textures_of(&b.desc->textures, b.desc->shapes[0].material));
        assert_int_equal(b.desc->textures.n, 0);
        scene_clear(&b);
    }
}

/* t0: 3 steps, t1: 7, ..., t5: 127; a mix of t5, t5 and a constant has 256 with its own, and that is the most. */
static void a_texture_of_256_steps_is_the_dearest(void **state)
{
    static char text[4096];
    size_t n = (size_t)snprintf(text, sizeof text, LIGHT "Texture \"t0\" \"float\" \"checkerboard\"\n");
    for (int k = 1; k <= 5; k++)
        n += (size_t)snprintf(text + n, sizeof text - n,
            "Texture \"t%d\" \"float\" \"checkerboard\" \"texture tex1\" \"t%d\" \"texture tex2\" \"t%d\"\n", k, k - 1,
            k - 1);
    n += (size_t)snprintf(text + n, sizeof text - n,
        "Texture \"most\" \"float\" \"mix\" \"texture tex1\" \"t5\" \"texture tex2\" \"t5\" \"float amount\" 0.5\n");
    built b = scene_build("%s Shape \"sphere\"", text);
    assert_int_equal(b.desc->textures.list[b.desc->textures.n - 1].steps, 256);
    scene_clear(&b);
    expect_failure(":8:1: error: a value of texture \"more\" is made of 257 others, must be at most 255",
                   "%sTexture \"more\" \"float\" \"checkerboard\" \"texture tex1\" \"most\"\n", text);
}

static void a_bad_part_of_a_texture_is_one_complaint(void **state)
{
    static const char *const textures[] = {"\"checkerboard\" \"string mapping\" \"conical\"",
        "\"mix\" \"float amount\" 2", "\"scale\" \"rgb tex1\" [1 1 1]"};
    for (size_t i = 0; i < sizeof textures / sizeof *textures; i++) {
        char text[512];
        built b;
        snprintf(
            text, sizeof text, LIGHT "Texture \"x\" \"float\" %s\nMaterial \"diffuse\" Shape \"sphere\"", textures[i]);
        const bis_status status = scene_try(&b, text);
        if (status != BIS_INPUT || b.diag.n != 1) {
            for (size_t k = 0; k < b.diag.n; k++) print_error("%s\n", b.diag.messages[k].text);
            fail_msg("%s: %zu messages", textures[i], b.diag.n);
        }
        scene_clear(&b);
    }
}

/* ---- what the parser makes of a texture ---- */

#define MOVED "Translate 1 2 3 Scale 2 4 8 " /* its inverse is ((x - 1)/2, (y - 2)/4, (z - 3)/8) */
#define V3 "Film \"image\" "
#define PLACE {{.5, 0, 0, -.5}, {0, .25, 0, -.5}, {0, 0, .125, -.375}}
#define WORLD {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}
#define OBLIQUE "\"string mapping\" \"planar\" \"vector3 v1\" [1 2 4] \"vector3 v2\" [0 0 2] \"float udelta\" 0.5 " \
                "\"float vdelta\" -1 "
#define SIGNS "\"float\" \"checkerboard\" \"float tex1\" -1 \"float tex2\" -3 Texture \"u\" "
#define FILE_OF(type, params) "\"" type "\" \"imagemap\" \"string filename\" \"../test_textures/four.pfm\" " params

/* The last texture of a scene; where a factor, the scale or the steps are 0 here, they are 1. 0.155 and 0.845 are the
 * shares of dots; the typical value of parts of both signs is that of their sizes. */
static const struct { const char *film, *world, *texture; bis_texture is; } descriptions[] = {
    {"", "", "\"float\" \"checkerboard\"", {.kind = BIS_TEXTURE_CHECKERBOARD, .of = {0, 1}, .value = {.5, .5, .5},
     .is_float = true, .steps = 3}},
    {"", MOVED, "\"spectrum\" \"checkerboard\" \"rgb tex1\" [1 -0.5 0.25] \"rgb tex2\" [-0.5 0.5 0.25] "
     "\"float uscale\" 2 \"float vscale\" 3 \"float udelta\" 4 \"float vdelta\" 5",
     {.kind = BIS_TEXTURE_CHECKERBOARD, .of = {0, 1}, .value = {.75, .5, .25}, .factor = {2, 3}, .offset = {4, 5},
     .steps = 3}},
    {"", "", "\"float\" \"dots\"", {.kind = BIS_TEXTURE_DOTS, .of = {0, 1}, .value = {.155, .155, .155},
     .is_float = true, .steps = 3}},
    {"", "", "\"rgb\" \"dots\" \"rgb inside\" [-1 2 0] \"rgb outside\" [1 0 -2]", {.kind = BIS_TEXTURE_DOTS,
     .of = {0, 1}, .value = {1, .31, 1.69}, .steps = 3}},
    {"", "", "\"float\" \"bilerp\"", {.kind = BIS_TEXTURE_BILERP, .of = {0, 1, 2, 3}, .value = {.5, .5, .5},
     .is_float = true, .steps = 5}},
    {"", MOVED, "\"spectrum\" \"bilerp\" \"rgb v00\" [1 0 0] \"rgb v01\" [0 1 -1] \"rgb v10\" [-1 2 0] \"rgb v11\" "
     "[2 0 0] " OBLIQUE, {.kind = BIS_TEXTURE_BILERP, .of = {0, 1, 2, 3}, .value = {1, .75, .25},
     .mapping = BIS_TEXTURE_PLANAR, .offset = {.5, -1}, .steps = 5,
     .from_world = {{.5, .5, .5, -2.5}, {0, 0, .25, -1.75}, {0, 0, .125, -.375}}}},
    {V3, MOVED, "\"spectrum\" \"uv\" " OBLIQUE, {.kind = BIS_TEXTURE_UV_COLOUR, .value = {.5, .5, .5},
     .mapping = BIS_TEXTURE_PLANAR, .offset = {.5, -1},
     .from_world = {{1, 2, 4, .5}, {0, 0, 2, -1}, {0, 0, 1, 0}}}},
    {V3, MOVED, "\"spectrum\" \"uv\" \"string mapping\" \"planar\"", {.kind = BIS_TEXTURE_UV_COLOUR,
     .value = {.5, .5, .5}, .mapping = BIS_TEXTURE_PLANAR, .from_world = WORLD}},
    {V3, MOVED, "\"spectrum\" \"uv\" \"string mapping\" \"spherical\"", {.kind = BIS_TEXTURE_UV_COLOUR,
     .value = {.5, .5, .5}, .mapping = BIS_TEXTURE_SPHERICAL, .from_world = PLACE}},
    {"", MOVED, "\"spectrum\" \"uv\" \"string mapping\" \"cylindrical\"", {.kind = BIS_TEXTURE_UV_COLOUR,
     .value = {.5, .5, .5}, .mapping = BIS_TEXTURE_CYLINDRICAL, .from_world = PLACE}},
    {"", "", "\"spectrum\" \"uv\" \"float vscale\" -2 \"string mapping\" \"uv\"", {.kind = BIS_TEXTURE_UV_COLOUR,
     .value = {.5, .5, .5}, .factor = {1, -2}}},
    {"", MOVED, "\"float\" \"fbm\"", {.kind = BIS_TEXTURE_FBM, .value = {.5, .5, .5}, .octaves = 8, .roughness = .5,
     .is_float = true, .from_world = PLACE}},
    {V3, MOVED, "\"spectrum\" \"fbm\" \"integer octaves\" 64 \"float roughness\" 0", {.kind = BIS_TEXTURE_FBM,
     .value = {.5, .5, .5}, .octaves = 64, .from_world = {{2, 0, 0, 1}, {0, 4, 0, 2}, {0, 0, 8, 3}}}},
    {"", "", "\"float\" \"wrinkled\" \"integer octaves\" 0 \"float roughness\" 1000", {.kind = BIS_TEXTURE_WRINKLED,
     .value = {.5, .5, .5}, .roughness = 1000, .is_float = true, .from_world = WORLD}},
    {"", "", "\"float\" \"windy\"", {.kind = BIS_TEXTURE_WINDY, .value = {.5, .5, .5}, .roughness = .5,
     .is_float = true, .from_world = WORLD}},
    {"", "", "\"spectrum\" \"marble\"", {.kind = BIS_TEXTURE_MARBLE, .value = {.5, .5, .5}, .octaves = 8,
     .roughness = .5, .variation = .2, .from_world = WORLD}},
    {"", MOVED, "\"spectrum\" \"marble\" \"float scale\" -2 \"float variation\" 3 \"integer octaves\" 3 "
     "\"float roughness\" 0.75", {.kind = BIS_TEXTURE_MARBLE, .value = {.5, .5, .5}, .octaves = 3, .roughness = .75,
     .variation = 3, .scale = -2, .from_world = PLACE}},
    {"", MOVED, "\"float\" \"checkerboard\" \"integer dimension\" 3 \"float tex2\" 0.25",
     {.kind = BIS_TEXTURE_CHECKERBOARD_3D, .of = {0, 1}, .value = {.625, .625, .625}, .is_float = true, .steps = 3,
     .from_world = PLACE}},
    {"", "", FILE_OF("float", ""), {.kind = BIS_TEXTURE_IMAGE, .value = {.5, .5, .5}, .is_float = true}},
    {"", MOVED, FILE_OF("spectrum", "\"string wrap\" \"black\" \"float scale\" -3 \"string mapping\" \"planar\""),
     {.kind = BIS_TEXTURE_IMAGE, .value = {1.5, 1.5, 1.5}, .wrap = BIS_WRAP_BLACK, .scale = -3,
     .mapping = BIS_TEXTURE_PLANAR, .from_world = PLACE}},
    {"", "", FILE_OF("rgb", "\"string wrap\" \"clamp\" \"bool invert\" true \"float scale\" 3 \"float udelta\" 2"),
     {.kind = BIS_TEXTURE_IMAGE, .value = {.5, .5, .5}, .wrap = BIS_WRAP_CLAMP, .scale = 3, .invert = true,
     .offset = {2, 0}}},
    {"", "", FILE_OF("rgb", "\"string wrap\" \"repeat\" \"bool invert\" false"), {.kind = BIS_TEXTURE_IMAGE,
     .value = {.5, .5, .5}}},
    {"", "", "\"float\" \"constant\"", {.value = {1, 1, 1}, .is_float = true}},
    {"", "", "\"spectrum\" \"constant\" \"rgb value\" [1 -2 3]", {.value = {1, -2, 3}}},
    {"", "", "\"spectrum\" \"mix\" \"rgb tex1\" [-1 0 2] \"rgb tex2\" [3 -4 1] \"float amount\" 0.25",
     {.of = {0, 1, 2}, .value = {0, -1, 1.75}}},
    {"", "", "\"spectrum\" \"scale\" \"rgb tex\" [-1 0.5 2] \"rgb scale\" [3 -4 0.25]", {.of = {0, 1},
     .value = {-3, -2, .5}}},
    {"", "", SIGNS "\"float\" \"mix\" \"texture tex1\" \"t\" \"float tex2\" -4 \"float amount\" 0.25",
     {.kind = BIS_TEXTURE_MIX, .of = {2, 3, 4}, .value = {2.5, 2.5, 2.5}, .is_float = true, .steps = 6}},
    {"", "", SIGNS "\"float\" \"mix\" \"texture amount\" \"t\" \"float tex1\" -4 \"float tex2\" 0.75",
     {.kind = BIS_TEXTURE_MIX, .of = {3, 4, 2}, .value = {.75, .75, .75}, .is_float = true, .steps = 6}},
    {"", "", SIGNS "\"spectrum\" \"scale\" \"texture tex\" \"t\" \"rgb scale\" [-0.5 1 -2]",
     {.kind = BIS_TEXTURE_SCALE, .of = {2, 3}, .value = {1, 2, 4}, .steps = 5}},
    {"", "", SIGNS "\"spectrum\" \"scale\" \"rgb tex1\" [-0.5 1 -2] \"texture tex2\" \"t\"",
     {.kind = BIS_TEXTURE_SCALE, .of = {3, 2}, .value = {1, 2, 4}, .steps = 5}},
    {"", "", SIGNS "\"spectrum\" \"dots\" \"texture outside\" \"t\" \"texture inside\" \"t\"",
     {.kind = BIS_TEXTURE_DOTS, .of = {2, 2}, .value = {2, 2, 2}, .steps = 7}},
};

static void assert_numbers(const char *what, const double *found, const double *expected, int n)
{
    for (int i = 0; i < n; i++)
        if (!(fabs(found[i] - expected[i]) <= 1e-12)) fail_msg("%s: %g, not %g", what, found[i], expected[i]);
}

static void each_texture_is_described_as_its_words_say(void **state)
{
    four_as(DIR "/four.pfm");
    for (size_t i = 0; i < sizeof descriptions / sizeof *descriptions; i++) {
        const char *what = descriptions[i].texture;
        char text[1024];
        built b = {0};
        bis_texture is = descriptions[i].is;
        for (int k = 0; k < 2; k++)
            if (is.factor[k] == 0) is.factor[k] = 1;
        if (is.scale == 0) is.scale = 1;
        if (is.steps == 0) is.steps = 1;
        snprintf(text, sizeof text, "%s" LIGHT "%sTexture \"t\" %s",
                 *descriptions[i].film ? descriptions[i].film : "Film \"rgb\" ", descriptions[i].world, what);
        scene_assert(&b, scene_parse(&b, text));
        assert_int_equal(b.diag.n, 0);
        const bis_texture *x = &b.desc->textures.list[b.desc->textures.n - 1];
        assert_numbers(what, &x->value.r, &is.value.r, 3);
        assert_numbers(what, x->factor, is.factor, 2);
        assert_numbers(what, x->offset, is.offset, 2);
        assert_numbers(what, x->from_world[0], is.from_world[0], 12);
        assert_numbers(what, (double[]){x->roughness, x->variation, x->scale},
                       (double[]){is.roughness, is.variation, is.scale}, 3);
        if (x->kind != is.kind || x->mapping != is.mapping || x->wrap != is.wrap || x->octaves != is.octaves ||
            x->invert != is.invert || x->is_float != is.is_float || x->steps != is.steps || x->image != 0 ||
            memcmp(x->of, is.of, sizeof is.of) != 0)
            fail_msg("%s: kind %d, %u steps, of %u %u %u %u", what, (int)x->kind, x->steps, x->of[0], x->of[1],
                     x->of[2], x->of[3]);
        scene_clear(&b);
    }
}

/* ---- materials ---- */

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
    const char *name = four();
    expect_failure(":2:10: error: the texture of \"Kd\" has values up to 1.2, must be in [0, 1]: change it",
        LIGHT IMAGEMAP "\"float scale\" 1.5\nMaterial \"diffuse\" \"texture reflectance\" \"t\" Shape \"sphere\"",
        "color", name);
    expect_failure(":2:10: error: the texture of \"roughness\" has values down to 0, must be in [0.01, 1]",
        LIGHT IMAGEMAP "\"string wrap\" \"black\"\n"
        "Material \"microfacet\" \"texture roughness\" \"t\" Shape \"sphere\"", "float", name);
    expect_failure("the texture of \"exponent\" has values down to -1.4, must be >= 0",
        LIGHT IMAGEMAP "\"float scale\" 3 \"bool invert\" true\n"
        "Material \"phong\" \"texture exponent\" \"t\" Shape \"sphere\"", "float", name);
    /* the largest of both: 0.8 + 0.3 */
    built b = scene_build(LIGHT "Texture \"t\" \"color\" \"imagemap\" \"string filename\" \"%s\"\n"
                                "Material \"phong\" \"texture Kd\" \"t\" \"float Ks\" 0.3 Shape \"sphere\"", name);
    assert_int_equal(b.diag.n, 1);
    assert_non_null(strstr(b.diag.messages[0].text, "warning: Kd + Ks may reach 1.1 in red"));
    scene_clear(&b);
    /* nothing shows it: nothing is read */
    b = scene_build(LIGHT "Texture \"t\" \"color\" \"imagemap\" \"string filename\" \"%s\" \"float scale\" 9\n"
                          "Material \"diffuse\" \"texture reflectance\" \"t\" Material \"diffuse\" Shape \"sphere\"",
                    name);
    assert_null(b.scene->images[0].image.pixels);
    scene_clear(&b);
}

/* A header of 20000 x 20000 pixels and 4 bytes for them; the name of the file. */
static const char *empty_png(const char *path)
{
    png_struct *png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_info *info = png_create_info_struct(png);
    FILE *out = fopen(path, "wb");
    assert_true(png && info && out);
    png_init_io(png, out);
    png_set_IHDR(png, info, 20000, 20000, 8, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    png_write_info(png, info);
    png_write_chunk(png, (const png_byte *)"IDAT", (const png_byte *)"none", 4);
    png_write_chunk(png, (const png_byte *)"IEND", NULL, 0);
    png_destroy_write_struct(&png, &info);
    assert_int_equal(fclose(out), 0);
    return beside(path);
}

static void what_is_no_texture_is_refused(void **state)
{
#define SHOWN LIGHT IMAGEMAP "\nMaterial \"diffuse\" \"texture reflectance\" \"t\" Shape \"sphere\""
    bytes b = {0};
    put_text(&b, "PF\n1 2\n-1.0\n");
    for (int i = 0; i < 6; i++) put_float(&b, i == 4 ? -0.5f : 0.5f);
    store(scratch("bad.pfm"), b.data, b.n);
    bytes_clear(&b);
    expect_failure(":1:66: error: \"", SHOWN, "color", beside(scratch("bad.pfm")));
    expect_failure("texel (0, 0), counted from the top left, is 0.5 -0.5 0.5; those of a texture must be finite and >= "
                   "0", SHOWN, "color", beside(scratch("bad.pfm")));
#ifdef BIS_JPEG
    static const char message[] = "the JPEG is damaged, or of a kind that is not read: ";
#else
    static const char message[] = "it is a JPEG, and this bis is built without libjpeg";
#endif
    expect_failure(message, SHOWN, "color", store_text("a.jpg", "\xff\xd8\xff\xe0 and so on"));
    /* 8 of the mark, 25 of the header, 16 and 12 of the other chunks; one deflated byte becomes at most 1032 */
    expect_failure(": 61 bytes cannot hold 20000 x 20000 pixels", SHOWN, "color", empty_png(scratch("empty.png")));
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

static void materials_with_other_textures_have_other_numbers(void **state)
{
    built b = scene_build(
        LIGHT "Texture \"a\" \"color\" \"checkerboard\" Texture \"b\" \"color\" \"checkerboard\" \"float uscale\" 2\n"
              "Material \"diffuse\" \"texture reflectance\" \"a\" Shape \"sphere\" Material \"diffuse\" \"texture "
              "reflectance\" \"b\" Shape \"sphere\"\n"
              "Material \"diffuse\" \"texture reflectance\" \"a\" Shape \"sphere\"");
    uint32_t *number, n;
    assert_int_equal(bis_scene_number_materials(&number, &n, b.desc, NULL), BIS_OK);
    assert_int_equal(n, 2);
    assert_int_equal(number[b.desc->shapes[0].material], number[b.desc->shapes[2].material]);
    bis_free(number);
    scene_clear(&b);
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

static void write_checkpointed(const char *image, double uv)
{
    char text[2048];
    snprintf(text, sizeof text,
        VIEW "WorldBegin LightSource \"infinite\" Texture \"t\" \"color\" \"imagemap\" \"string filename\" \"%s\"\n"
             "Material \"diffuse\" \"texture reflectance\" \"t\" " TRIANGLE "\"point2 uv\" [0 0 1 0 %g 1]\n",
        image, uv);
    program_write_file(DIR "/c.txt", text);
}

/* A checkpoint belongs to its textures and coordinates, not to their files' names. */
static void a_checkpoint_is_refused_with_other_texels_or_coordinates(void **state)
{
    program_run r;
    const char *resume = DIR "/c.txt --spp 4 --quiet --outfile " DIR "/c.pfm --resume " DIR "/c.ckpt";
    program_write_file(DIR "/a.pfm", "Pf\n1 1\n-1.0\n\x1\x1\x1\x3d");
    program_write_file(DIR "/b.pfm", "Pf\n1 1\n-1.0\n\x1\x1\x1\x3d");
    write_checkpointed("a.pfm", 0.5);
    program_expect(&r, 0, DIR "/c.txt --spp 2 --quiet --outfile " DIR "/c.pfm --checkpoint " DIR "/c.ckpt");
    write_checkpointed("b.pfm", 0.5);
    program_expect(&r, 0, "%s", resume);
    program_expect(&r, 0, DIR "/c.txt --spp 2 --quiet --outfile " DIR "/c.pfm --checkpoint " DIR "/c.ckpt");
    program_write_file(DIR "/b.pfm", "Pf\n1 1\n-1.0\n\x1\x1\x2\x3d");
    program_expect(&r, 2, "%s", resume);
    assert_non_null(strstr(r.messages, "differ: the materials, or their textures. "));
    program_write_file(DIR "/b.pfm", "Pf\n1 1\n-1.0\n\x1\x1\x1\x3d");
    write_checkpointed("b.pfm", 0.625);
    program_expect(&r, 2, "%s", resume);
    assert_non_null(strstr(r.messages, "differ: the shapes. "));
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
    program_write_file(DIR "/q.txt", "WorldBegin LightSource \"infinite\" Texture \"c\" \"float\" \"checkerboard\" "
                                     "\"float tex1\" .1 \"float tex2\" .2\n"
                                     "Material \"coateddiffuse\" \"texture reflectance\" \"c\" Shape \"sphere\" "
                                     "Material \"metal\" \"texture roughness\" \"c\" Shape \"disk\"");
    program_run q;
    program_expect(&q, 0, DIR "/q.txt --plan");
    assert_non_null(strstr(q.output, "Kd texture (scale)"));
    assert_non_null(strstr(q.output, "roughness texture (remapped)"));
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

/* Squares of the plane; parts have mappings of their own; the shapes that do not ask for (u, v) read none. */
static void a_checkerboard_lies_in_its_plane(void **state)
{
    built b = scene_build(
        LIGHT "Texture \"x\" \"spectrum\" \"imagemap\" \"string filename\" \"%s\" \"string mapping\" \"planar\"\n"
              "Texture \"t\" \"spectrum\" \"checkerboard\" \"string mapping\" \"planar\" \"vector v2\" [0 0 1] "
              "\"texture tex1\" \"x\" \"float tex2\" 0.3\n"
              "Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"trianglemesh\" \"point3 P\" [-9 0.25 "
              "-9  9 0.25 -9  9 0.25 9] \"integer indices\" [0 1 2]",
        four());
    assert_int_equal(b.diag.n, 0); /* no warning of missing coordinates */
    assert_near(value_at(&b, (double[]){0.25, 0.25, 0.5}), 0.1);
    assert_near(value_at(&b, (double[]){1.25, 0.25, 0.5}), 0.3);
    assert_near(value_at(&b, (double[]){-0.25, 0.25, -0.5}), 0.2);
    /* what an integrator sees: the material at the hit (0.75, 0.25, 0.5) */
    bis_counters counters = {0};
    bis_own_material m;
    bis_point pt;
    const ray r = {.o = {0.75f, -4, 0.5f}, .d = {0, 1, 0}, .tmax = INFINITY};
    assert_true(bis_scene_point(&pt, &m, b.scene, r, &counters, NULL));
    assert_near((double)pt.bsdf.material->Kd.r, 0.2);
    scene_clear(&b);
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
        {LIGHT "Scale 1 1e-20 1 Scale 1 1e-20 1 ", "\"string mapping\" \"spherical\"", "by more than 1e30"},
        {LIGHT "Scale 1 1 1e-20 Scale 1 1 1e-20 ", "\"string mapping\" \"spherical\"", "by more than 1e30"},
        {LIGHT "Translate 0 0 2e30 ", "\"string mapping\" \"spherical\"", "by more than 1e30"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        expect_failure(cases[i][2], MAPPED, cases[i][0], cases[i][1]);
}

/* ---- texture.c by hand, without a scene ---- */

/* 3 x 2 texels; their channels are (n, 2n, 4n)/32 of n = 1, 2, 3 (top row) and 4, 5, 6. */
static bis_texture_image six(void)
{
    bis_texture_image image;
    bis_texture_file file = {.filename = (char *)(uintptr_t)scratch("six.pfm"), .gamma = 1};
    bytes b = {0};
    put_text(&b, "PF\n3 2\n-1.0\n");
    for (int i = 0; i < 6; i++)
        for (int k = 0; k < 3; k++) put_float(&b, (float)(i < 3 ? 4 + i : i - 2) * (float)(1 << k) / 32);
    store(file.filename, b.data, b.n);
    bytes_clear(&b);
    assert_int_equal(bis_textures_load(&image, &file, NULL), BIS_OK);
    return image;
}

static void assert_rgbd(rgbd c, double r, double g, double b)
{
    if (!(fabs(c.r - r) < 1e-6 && fabs(c.g - g) < 1e-6 && fabs(c.b - b) < 1e-6))
        fail_msg("%.9g %.9g %.9g is not %.9g %.9g %.9g", c.r, c.g, c.b, r, g, b);
}

static void an_image_that_is_no_square_has_its_rows_and_columns(void **state)
{
    static const double n[2][3] = {{4, 5, 6}, {1, 2, 3}}; /* [t][s] */
    bis_texture_image image = six();
    bis_texture x = {.kind = BIS_TEXTURE_IMAGE, .factor = {1, 1}, .scale = 1, .steps = 1};
    const bis_textures t = {.list = &x, .n = 1};
    for (int k = 0; k < 4; k++) {
        assert_near(image.lo[k], (k < 3 ? 1 << k : 7 / 3.0) / 32);
        assert_near(image.hi[k], (k < 3 ? 1 << k : 7 / 3.0) * 6 / 32);
    }
    for (int wrap = BIS_WRAP_REPEAT; wrap <= BIS_WRAP_BLACK; wrap++)
        for (int j = -2; j < 4; j++)
            for (int i = -3; i < 6; i++) {
                const bool outside = i < 0 || i > 2 || j < 0 || j > 1;
                const int ci = i < 0 ? 0 : i > 2 ? 2 : i, cj = j < 0 ? 0 : j > 1 ? 1 : j;
                const double v = wrap == BIS_WRAP_REPEAT             ? n[(j + 2) % 2][(i + 3) % 3]
                                 : wrap == BIS_WRAP_BLACK && outside ? 0
                                                                     : n[cj][ci];
                x.wrap = (bis_wrap)wrap;
                assert_rgbd(
                    bis_textures_value(&t, &image, 0, (double[]){(i + 0.5) / 3, (j + 0.5) / 2}, (vec3){0, 0, 0}),
                    v / 32, v / 16, v / 8);
            }
    /* between four texels, nearer to the first column and to the upper row: 0.75 (0.75 1 + 0.25 2) + 0.25 (0.75 4 +
     * 0.25 5) */
    assert_rgbd(bis_textures_value(&t, &image, 0, (double[]){0.75 / 3, 1.25 / 2}, (vec3){0, 0, 0}), 2 / 32.0, 4 / 32.0,
        8 / 32.0);
    x.is_float = true;
    x.scale = 3;
    assert_rgbd(bis_textures_value(&t, &image, 0, (double[]){2.5 / 3, 0.25}, (vec3){0, 0, 0}), 42 / 32.0, 42 / 32.0,
        42 / 32.0); /* 6 7/3 3 */
    x.invert = true;
    assert_rgbd(bis_textures_value(&t, &image, 0, (double[]){0.5 / 3, 0.75}, (vec3){0, 0, 0}), 25 / 32.0, 25 / 32.0,
        25 / 32.0); /* 1 - 7/32 */
    bis_image_clear(&image.image);
}

/* Least and largest values of each kind in each channel: corners, worked out by hand. */
static void the_range_of_each_kind_is_found_in_each_channel(void **state)
{
    bis_texture_image image = six();
    bis_texture list[] = {
        {.kind = BIS_TEXTURE_CONSTANT, .value = {0.5, 0.25, 2}},
        {.kind = BIS_TEXTURE_IMAGE, .scale = 1},
        {.kind = BIS_TEXTURE_IMAGE, .scale = 2, .invert = true},
        {.kind = BIS_TEXTURE_IMAGE, .scale = 1, .is_float = true},
        {.kind = BIS_TEXTURE_IMAGE, .scale = 1, .wrap = BIS_WRAP_BLACK},
        {.kind = BIS_TEXTURE_CHECKERBOARD, .of = {0, 1}},
        {.kind = BIS_TEXTURE_CHECKERBOARD, .of = {1, 0}},
        {.kind = BIS_TEXTURE_SCALE, .of = {0, 1}},
        {.kind = BIS_TEXTURE_SCALE, .of = {1, 1}},
        {.kind = BIS_TEXTURE_MIX, .of = {0, 1, 3}},
        {.kind = BIS_TEXTURE_COAT, .of = {1}, .scale = 0.5},
        {.kind = BIS_TEXTURE_COAT, .of = {0}, .scale = 0.5},
        {.kind = BIS_TEXTURE_ALPHA, .of = {1}},
    };
    const struct { double lo[3], hi[3];
    } expected[] = {
        {{0.5, 0.25, 2}, {0.5, 0.25, 2}},
        {{1 / 32.0, 2 / 32.0, 4 / 32.0}, {6 / 32.0, 12 / 32.0, 24 / 32.0}},
        {{20 / 32.0, 8 / 32.0, -16 / 32.0}, {30 / 32.0, 28 / 32.0, 24 / 32.0}},
        {{7 / 96.0, 7 / 96.0, 7 / 96.0}, {42 / 96.0, 42 / 96.0, 42 / 96.0}},
        {{0, 0, 0}, {6 / 32.0, 12 / 32.0, 24 / 32.0}},
        {{1 / 32.0, 2 / 32.0, 4 / 32.0}, {0.5, 12 / 32.0, 2}},
        {{1 / 32.0, 2 / 32.0, 4 / 32.0}, {0.5, 12 / 32.0, 2}},
        {{1 / 64.0, 2 / 128.0, 8 / 32.0}, {6 / 64.0, 12 / 128.0, 48 / 32.0}},
        {{1 / 1024.0, 4 / 1024.0, 16 / 1024.0}, {36 / 1024.0, 144 / 1024.0, 576 / 1024.0}},
        /* (1 - w) a + w b, w in [7/96, 42/96]: red a = 1/2, b in [1, 6]/32; green a = 1/4, b in [2, 12]/32; blue a = 2
         */
        {{0.5 * 54 / 96 + 42 / 96.0 / 32, 0.25 * 54 / 96 + 42 / 96.0 / 16, 2 * 54 / 96.0 + 42 / 96.0 / 8},
            {0.5 * 89 / 96 + 7 / 96.0 * 6 / 32, 0.25 * 54 / 96 + 42 / 96.0 * 12 / 32,
                2 * 89 / 96.0 + 7 / 96.0 * 24 / 32}},
        /* 0.5 v/(1 - 0.5 v) */
        {{1 / 63.0, 1 / 31.0, 1 / 15.0}, {3 / 29.0, 3 / 13.0, 3 / 5.0}},
        {{1 / 3.0, 1 / 7.0, 2}, {1 / 3.0, 1 / 7.0, 2}}, /* above 1 it stays what is below */
        /* pbrt-v3's polynomial as python computes it; it is more than 1 at 24/32 */
        {{0.24219603187096084, 0.3539623122546913, 0.524208055445442}, {0.6594595221210344, 0.9684381966903411, 1}},
    };
    const bis_textures t = {.list = list, .n = sizeof list / sizeof *list};
    for (uint32_t i = 0; i < t.n; i++) {
        rgbd lo, hi;
        bis_textures_range(&lo, &hi, &t, &image, i);
        assert_rgbd(lo, expected[i].lo[0], expected[i].lo[1], expected[i].lo[2]);
        assert_rgbd(hi, expected[i].hi[0], expected[i].hi[1], expected[i].hi[2]);
    }
    bis_image_clear(&image.image);
}

static bis_texture constant_of(double r, double g, double b)
{
    return (bis_texture){.kind = BIS_TEXTURE_CONSTANT, .value = {r, g, b}};
}

/* Each channel by itself: (1 - w) a + w b; a b; 0.5 w/(1 - 0.5 w); pbrt-v3's polynomial, as python computes it. */
static void textures_of_textures_have_their_values_in_each_channel(void **state)
{
    bis_texture list[] = {
        constant_of(0.5, 0.25, 2), constant_of(1, 2, 4), constant_of(0.25, 0.5, 0.75),
        constant_of(1 / 32.0, 2 / 32.0, 4 / 32.0), {.kind = BIS_TEXTURE_MIX, .of = {0, 1, 2}},
        {.kind = BIS_TEXTURE_SCALE, .of = {0, 1}}, {.kind = BIS_TEXTURE_COAT, .of = {2}, .scale = 0.5},
        {.kind = BIS_TEXTURE_ALPHA, .of = {3}}};
    static const double expected[4][3] = {{0.625, 1.125, 3.5}, {0.5, 0.5, 8}, {1 / 7.0, 1 / 3.0, 0.6},
        {0.24219603187096084, 0.3539623122546913, 0.524208055445442}};
    const bis_textures t = {.list = list, .n = sizeof list / sizeof *list};
    for (uint32_t i = 0; i < 4; i++) {
        const rgbd c = bis_textures_value(&t, NULL, 4 + i, (double[]){0, 0}, (vec3){0, 0, 0});
        assert_rgbd(c, expected[i][0], expected[i][1], expected[i][2]);
    }
}

/* Constants stand for all textures here: which are looked at, in which channel, and what is said. */
static void textures_of_a_material_are_checked_one_by_one(void **state)
{
    enum { NO = -1 };
    static const struct { int Kd, Ks, width; bool facets; double power; const char *said; bool is_warning; } cases[] = {
        {0, NO, NO, false, 1, NULL, false}, {0, NO, NO, true, 1, NULL, false}, {NO, 0, NO, false, 1, NULL, false},
        {1, NO, NO, false, 1, "x:7: error: the texture of \"Kd\" has values up to 1.5, must be in [0, 1]: change it by "
         "its \"float scale\", or by a Texture \"scale\" or \"mix\"", false},
        {NO, 1, NO, true, 1, "x:7: error: the texture of \"Ks\" has values up to 1.5, must be in [0, 1]", false},
        {2, NO, NO, true, 1, "the texture of \"Kd\" has values down to -0.25, must be in [0, 1]", false},
        {11, NO, NO, false, 1, "the texture of \"Kd\" has values up to 1.25, must be in [0, 1]", false}, /* in red */
        {NO, 12, NO, false, 1, "the texture of \"Ks\" has values down to -0.5, must be in [0, 1]", false},
        {NO, 3, NO, false, 1, "the texture of \"Ks\" has values up to 3, must be in [0, 1]", false},
        {1, 2, NO, false, 1, "\"Kd\" has values up to 1.5", false},
        {0, 2, NO, false, 1, "\"Ks\" has values down to -0.25", false},
        {NO, NO, 3, false, 1, NULL, false}, /* exponents 0, 0, 3 */
        {NO, NO, 2, false, 1, "the texture of \"exponent\" has values down to -0.25, must be >= 0", false},
        {NO, NO, 4, true, 1, NULL, false}, {NO, NO, 5, true, 1, NULL, false},
        {NO, NO, 6, true, 1, "the texture of \"roughness\" has values down to 0.009, must be in [0.01, 1]", false},
        {NO, NO, 1, true, 1, "the texture of \"roughness\" has values up to 1.5, must be in [0.01, 1]", false},
        {NO, NO, 6, true, 0.5, NULL, false}, /* 0.009^(1/2) = 0.095; from 1e-4 on */
        {NO, NO, 7, true, 0.5, "the texture of \"roughness\" has values down to 9e-05, must be in [0.0001, 1]", false},
        {8, NO, NO, false, 1, "x:7: warning: Kd + Ks may reach 1.25 in red: the material would reflect more light than "
         "it receives. Make one of them smaller, a texture by its \"float scale\", or in an .mtl by the Kd or Ks "
         "beside it", true},
        {9, NO, NO, false, 1, "warning: Kd + Ks may reach 1.1875 in green", true},
        {10, NO, NO, false, 1, "warning: Kd + Ks may reach 1.125 in blue", true},
        {NO, 8, NO, false, 1, "warning: Kd + Ks may reach 1.1875 in red", true},
        {10, 9, NO, false, 1, "warning: Kd + Ks may reach 1.5 in green", true},
        {8, NO, NO, true, 1, NULL, false}, /* of facets nothing is too much */
    };
    bis_texture list[] = {constant_of(0, 0.5, 0), constant_of(0.5, 1.5, 1), constant_of(0.5, 0.5, -0.25),
        constant_of(0, 0, 3), constant_of(0.01, 1, 0.5), constant_of(1, 1, 1), constant_of(1, 0.009, 1),
        constant_of(1, 1, 9e-5), constant_of(1, 0.5, 0), constant_of(0.5, 1, 0), constant_of(0.5, 0.5, 1),
        constant_of(1.25, 0.5, 0.5), constant_of(-0.5, 0.5, 0.5)};
    const bis_textures t = {.list = list, .n = sizeof list / sizeof *list};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const rgb Kd = {0.1875f, 0.125f, 0.0625f}, Ks = {0.25f, 0.1875f, 0.125f};
        const bis_material base = cases[i].facets ? bis_microfacet(Kd, Ks, 0.5) : bis_phong(Kd, Ks, 1);
        const bis_material_textures of = {cases[i].Kd < 0 ? BIS_NO_TEXTURE : (uint32_t)cases[i].Kd,
            cases[i].Ks < 0 ? BIS_NO_TEXTURE : (uint32_t)cases[i].Ks,
            cases[i].width < 0 ? BIS_NO_TEXTURE : (uint32_t)cases[i].width, cases[i].power, {"x", 7, 0}, BIS_NO_TEXTURE,
            BIS_NO_TEXTURE};
        bis_diag diag = {0};
        const bis_status status = bis_textures_check(&t, NULL, &of, &base, &diag);
        if (status != (cases[i].said && !cases[i].is_warning ? BIS_INPUT : BIS_OK) || diag.n != (cases[i].said ? 1 : 0))
            fail_msg("case %zu: status %d, %zu messages: %s", i, status, diag.n, diag.n ? diag.messages[0].text : "");
        if (cases[i].said && !strstr(diag.messages[0].text, cases[i].said))
            fail_msg("case %zu: %s", i, diag.messages[0].text);
        bis_diag_clear(&diag);
    }
    /* floats: 0.6 + 0.4 is 1 + 3e-8 there, and that is no warning */
    list[0] = constant_of((double)0.6f, (double)0.6f, (double)0.6f);
    const bis_material base = bis_phong((rgb){0, 0, 0}, (rgb){0.4f, 0.4f, 0.4f}, 1);
    const bis_material_textures of = {0, BIS_NO_TEXTURE, BIS_NO_TEXTURE, 1, {0}, BIS_NO_TEXTURE, BIS_NO_TEXTURE};
    bis_diag diag = {0};
    assert_int_equal(bis_textures_check(&t, NULL, &of, &base, &diag), BIS_OK);
    assert_int_equal(diag.n, 0);
}

/* Which values a textured material has, and which it keeps. */
static void a_material_takes_what_its_textures_give_and_keeps_the_rest(void **state)
{
    bis_texture list[] = {constant_of(0.5, 0.25, 0.125), constant_of(0.25, 0.5, 0.75), constant_of(0.16, 0.5, 1),
        constant_of(1.0000001, 1, 1), constant_of(0.0099999, 1, 1), constant_of(-1e-9, 1, 1),
        constant_of(1.5, -0.5, 2), constant_of(-1, 1.25, -2)}; /* what is cut off */
    const bis_textures t = {.list = list, .n = 8};
    const rgb Kd = {0.1f, 0.2f, 0.3f}, Ks = {0.3f, 0.2f, 0.1f};
    bis_material base = bis_phong(Kd, Ks, 7), m;
    const double uv[2] = {0, 0};
    const vec3 p = {0, 0, 0};
    const uint32_t NO = BIS_NO_TEXTURE;
#define OF(Kd, Ks, width, power) \
    (m = bis_textures_material(&t, NULL, &(bis_material_textures){Kd, Ks, width, power, {0}, NO, NO}, &base, uv, p))
    OF(0, NO, NO, 1);
    assert_true(m.model == base.model && m.Kd.r == 0.5f && m.Kd.g == 0.25f && m.Kd.b == 0.125f && m.Ks.r == 0.3f &&
                m.Ks.g == 0.2f && m.Ks.b == 0.1f && m.exponent == 7);
    OF(NO, 1, 2, 1);
    assert_true(m.model == base.model && m.Ks.r == 0.25f && m.Ks.g == 0.5f && m.Ks.b == 0.75f && m.Kd.r == 0.1f &&
                m.Kd.b == 0.3f && m.exponent == 0.16);
    OF(NO, NO, 5, 1);
    assert_true(m.exponent == 0);
    OF(6, 7, NO, 1);
    assert_true(m.Kd.r == 1 && m.Kd.g == 0 && m.Kd.b == 1 && m.Ks.r == 0 && m.Ks.g == 1 && m.Ks.b == 0);
    base = bis_microfacet_metal(Ks, (rgb){1, 2, 3}, 0.5);
    OF(NO, 1, NO, 1);
    assert_true(
        m.model == base.model && m.Ks.g == 0.5f && m.alpha == 0.25 && m.eta.r == 1 && m.eta.g == 2 && m.eta.b == 3);
    OF(NO, NO, 2, 0.5);
    assert_near(m.alpha, 0.16); /* roughness 0.16^0.5 = 0.4 */
    assert_true(m.Ks.r == 0.3f && m.eta.b == 3);
    OF(NO, NO, 3, 1);
    assert_true(m.alpha == 1);
    OF(NO, NO, 4, 1);
    assert_true(m.alpha == 0.01 * 0.01);
#undef OF
}

/* The images below a texture, and whether (u, v) are asked for, through all parts of each kind. */
static void what_a_texture_needs_is_found_in_each_of_its_parts(void **state)
{
    bis_texture list[] = {
        {.kind = BIS_TEXTURE_CONSTANT},
        {.kind = BIS_TEXTURE_IMAGE, .image = 2},
        {.kind = BIS_TEXTURE_IMAGE, .image = 1, .mapping = BIS_TEXTURE_PLANAR},
        {.kind = BIS_TEXTURE_MIX, .of = {1, 0, 0}}, {.kind = BIS_TEXTURE_MIX, .of = {0, 1, 0}},
        {.kind = BIS_TEXTURE_MIX, .of = {0, 0, 1}},
        {.kind = BIS_TEXTURE_SCALE, .of = {1, 0}}, {.kind = BIS_TEXTURE_SCALE, .of = {0, 1}},
        {.kind = BIS_TEXTURE_CHECKERBOARD, .of = {1, 0}, .mapping = BIS_TEXTURE_SPHERICAL},
        {.kind = BIS_TEXTURE_CHECKERBOARD, .of = {0, 1}, .mapping = BIS_TEXTURE_SPHERICAL},
        {.kind = BIS_TEXTURE_COAT, .of = {1}}, {.kind = BIS_TEXTURE_ALPHA, .of = {1}},
        {.kind = BIS_TEXTURE_CHECKERBOARD, .of = {0, 0}}, {.kind = BIS_TEXTURE_CHECKERBOARD, .of = {2, 2},
         .mapping = BIS_TEXTURE_PLANAR},
    };
    static const struct { bool uv, image[3]; } expected[] = {
        {false, {0}}, {true, {0, 0, 1}}, {false, {0, 1, 0}}, {true, {0, 0, 1}}, {true, {0, 0, 1}}, {true, {0, 0, 1}},
        {true, {0, 0, 1}},
        {true, {0, 0, 1}}, {true, {0, 0, 1}}, {true, {0, 0, 1}}, {true, {0, 0, 1}}, {true, {0, 0, 1}},
        {true, {0, 0, 0}}, {false, {0, 1, 0}}};
    const bis_textures t = {.list = list, .n = sizeof list / sizeof *list};
    for (uint32_t i = 0; i < t.n; i++) {
        bool used[3] = {false, false, false};
        bis_textures_mark(used, &t, i);
        assert_memory_equal(used, expected[i].image, sizeof used);
        for (int role = 0; role < 3; role++) {
            const bis_material_textures of = {role == 0 ? i : BIS_NO_TEXTURE, role == 1 ? i : BIS_NO_TEXTURE,
                role == 2 ? i : BIS_NO_TEXTURE, 1, {0}, BIS_NO_TEXTURE, BIS_NO_TEXTURE};
            assert_int_equal(bis_textures_want_uv(&t, &of), expected[i].uv);
        }
    }
    bool used[3] = {false, false, false};
    bis_textures_mark(used, &t, BIS_NO_TEXTURE);
    assert_true(!used[0] && !used[1] && !used[2]);
    assert_false(bis_textures_want_uv(&t, &(bis_material_textures){BIS_NO_TEXTURE, BIS_NO_TEXTURE, BIS_NO_TEXTURE, 1,
                                              {0}, BIS_NO_TEXTURE, BIS_NO_TEXTURE}));
}

/* A bad channel of any texel is found, and its place is told. */
static void a_bad_texel_is_told_with_its_place(void **state)
{
    for (int bad = 0; bad < 18; bad++) {
        const float wrong[3] = {-0.25f, INFINITY, NAN};
        static const char *const words[3] = {"-0.25", "inf", "nan"};
        bis_texture_image image;
        bis_texture_file file = {.filename = (char *)(uintptr_t)scratch("bad.pfm"), .gamma = 1, .loc = {"s.txt", 3, 4}};
        bis_diag diag = {0};
        char text[300];
        const char *v[3] = {"0.5", "0.5", "0.5"};
        bytes b = {0};
        put_text(&b, "PF\n3 2\n-1.0\n");
        for (int i = 0; i < 18; i++) put_float(&b, i == bad ? wrong[bad % 3] : 0.5f);
        store(file.filename, b.data, b.n);
        bytes_clear(&b);
        assert_int_equal(bis_textures_load(&image, &file, &diag), BIS_INPUT);
        assert_null(image.image.pixels);
        v[bad % 3] = words[bad % 3];
        snprintf(text, sizeof text,
            "s.txt:3:4: error: \"%s\": texel (%d, %d), counted from the top left, is %s %s %s; those of a texture must "
            "be finite and >= 0",
            file.filename, bad / 3 % 3, bad / 9 == 0, v[0], v[1], v[2]);
        assert_string_equal(diag.messages[0].text, text);
        bis_diag_clear(&diag);
    }
}

/* With a texture for one colour only the check of the image's values speaks of energy, not the parser. */
static void energy_is_warned_of_once(void **state)
{
    static const struct { const char *words, *warning; } cases[] = {
        {"\"texture Kd\" \"t\" \"float Ks\" 0.6", "Kd + Ks may reach 1.5 in red"},
        {"\"texture Ks\" \"t\" \"float Kd\" 0.6", "Kd + Ks may reach 1.5 in red"},
        {"\"texture Ks\" \"t\" \"texture Kd\" \"t\"", "Kd + Ks may reach 1.8 in red"},
        {"\"texture exponent\" \"f\" \"float Kd\" 0.75 \"float Ks\" 0.5", "Kd + Ks is 1.25 in red"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        built b = scene_build(LIGHT "Texture \"t\" \"spectrum\" \"checkerboard\" \"float tex1\" 0.1 \"float tex2\" "
                                    "0.9\nTexture \"f\" \"float\" \"checkerboard\"\n"
                                    "Material \"phong\" %s Shape \"sphere\"",
            cases[i].words);
        size_t n = 0;
        for (size_t k = 0; k < b.diag.n; k++)
            n += strstr(b.diag.messages[k].text, "reach") || strstr(b.diag.messages[k].text, "Kd + Ks is");
        if (n < 1 || !strstr(b.diag.messages[0].text, cases[i].warning))
            fail_msg("%s: %s", cases[i].words, b.diag.n ? b.diag.messages[0].text : "");
        if (i < 3) assert_int_equal(n, 1);
        scene_clear(&b);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_texture_has_the_values_beside_it),
        cmocka_unit_test(every_kind_of_png_has_the_same_colours),
        cmocka_unit_test(a_texture_that_is_the_same_everywhere_is_no_texture),
        cmocka_unit_test(a_sphere_has_pbrts_coordinates),
        cmocka_unit_test(a_disk_has_pbrts_coordinates),
        cmocka_unit_test(a_triangle_interpolates_its_corners_and_without_any_has_pbrts),
        cmocka_unit_test(each_mesh_of_a_scene_keeps_its_own),
        cmocka_unit_test(without_textures_no_coordinates_are_kept),
        cmocka_unit_test(an_obj_and_a_ply_bring_theirs),
        cmocka_unit_test(an_obj_plain_or_compressed_brings_its_materials_and_each_part_is_a_shape),
        cmocka_unit_test(instances_of_an_obj_with_materials_are_alike),
        cmocka_unit_test(mistakes_of_a_library_are_found_in_it),
        cmocka_unit_test(a_statement_of_a_library_is_taken_ignored_or_refused),
        cmocka_unit_test(a_librarys_values_are_those_of_the_material),
        cmocka_unit_test(options_of_a_map_change_what_they_name_alone),
        cmocka_unit_test(options_that_change_no_value_pass),
        cmocka_unit_test(an_option_that_is_left_out_leaves_the_map),
        cmocka_unit_test(a_map_of_nothing_is_none),
        cmocka_unit_test(a_texture_of_256_steps_is_the_dearest),
        cmocka_unit_test(a_bad_part_of_a_texture_is_one_complaint),
        cmocka_unit_test(each_texture_is_described_as_its_words_say),
        cmocka_unit_test(a_point_has_the_material_of_its_place),
        cmocka_unit_test(values_out_of_range_are_refused_when_the_image_is_known),
        cmocka_unit_test(what_is_no_texture_is_refused),
        cmocka_unit_test(textures_of_textures_have_a_limit),
        cmocka_unit_test(materials_with_other_textures_have_other_numbers),
        cmocka_unit_test(in_a_furnace_the_mean_of_the_picture_is_that_of_the_image),
        cmocka_unit_test(a_textured_scene_is_the_scene_cut_into_its_colours),
        cmocka_unit_test(a_checkpoint_is_refused_with_other_texels_or_coordinates),
        cmocka_unit_test(the_plan_says_what_textures_cost),
        cmocka_unit_test(verify_finds_a_textured_scene_right),
        cmocka_unit_test(the_shipped_scenes_of_each_version_render),
        cmocka_unit_test(in_the_furnace_four_spellings_of_a_quarter_are_a_quarter),
        cmocka_unit_test(points_are_mapped_by_angles_or_by_a_plane),
        cmocka_unit_test(a_checkerboard_lies_in_its_plane),
        cmocka_unit_test(a_mapping_that_cannot_be_is_refused),
        cmocka_unit_test(an_image_that_is_no_square_has_its_rows_and_columns),
        cmocka_unit_test(the_range_of_each_kind_is_found_in_each_channel),
        cmocka_unit_test(textures_of_textures_have_their_values_in_each_channel),
        cmocka_unit_test(textures_of_a_material_are_checked_one_by_one),
        cmocka_unit_test(a_material_takes_what_its_textures_give_and_keeps_the_rest),
        cmocka_unit_test(what_a_texture_needs_is_found_in_each_of_its_parts),
        cmocka_unit_test(a_bad_texel_is_told_with_its_place),
        cmocka_unit_test(energy_is_warned_of_once),
    };
    program_folder(DIR);
    return cmocka_run_group_tests(tests, NULL, scratch_remove);
}
