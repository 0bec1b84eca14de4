/* SPDX-License-Identifier: BSD-2-Clause */
/* Bump and normal maps: against the normals of surfaces that are really displaced, by formula or as fine meshes, and
 * against frames worked out by hand. */
#include "bis/base/mem.h"
#include "bis/scene/scene.h"
#include "claim.h"
#include "image_help.h"
#include "mesh_help.h"
#include "scene/bump.h"
#include "scene_help.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define build(...) scene_build("WorldBegin LightSource \"infinite\" " __VA_ARGS__)

/* The shading normal where a ray from `from` towards `to` hits. */
static bool normal_at(double n[3], const built *b, vec3 from, vec3 to)
{
    bis_point pt;
    bis_own_material own;
    bis_counters counters = {0};
    const ray eye = {from, normalize(sub(to, from)), INFINITY};
    if (!bis_scene_point(&pt, &own, b->scene, eye, &counters, NULL)) return false;
    n[0] = (double)pt.n.x;
    n[1] = (double)pt.n.y;
    n[2] = (double)pt.n.z;
    assert_true(fabs(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-6 && dot(pt.n, pt.ng) >= 0);
    return true;
}

static double degrees(const double a[3], const double b[3])
{
    const double c[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    return atan2(sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]), a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) * 180 / PI;
}

static void assert_normal(const double n[3], double x, double y, double z, double tolerance_deg)
{
    if (!(degrees(n, (double[]){x, y, z}) <= tolerance_deg))
        fail_msg(
            "%g %g %g, not along %g %g %g: %g degrees", n[0], n[1], n[2], x, y, z, degrees(n, (double[]){x, y, z}));
}

#define PLANE "Shape \"trianglemesh\" \"point3 P\" [0 0 0  4 0 0  4 2 0  0 2 0] \"integer indices\" [0 1 2 0 2 3] " \
              "\"point2 uv\" [0 0 1 0 1 1 0 1] "
#define SLOPE "Texture \"d\" \"float\" \"bilerp\" \"float v00\" 0 \"float v01\" 0.6 \"float v10\" 0.4 \"float v11\" 1 "

/* z = 0.4 u + 0.6 v = 0.1 x + 0.3 y: the normal is (-0.1, -0.3, 1) from above and from below, and the other way round
 * for a plane whose corners turn the other way. */
static void a_slope_tilts_a_plane(void **state)
{
    double n[3];
    built b = build(SLOPE "Material \"diffuse\" \"texture displacement\" \"d\" " PLANE);
    assert_true(normal_at(n, &b, (vec3){1, 1, 5}, (vec3){1.1f, 0.9f, 0}));
    assert_normal(n, -.1, -.3, 1, 1e-4);
    assert_true(normal_at(n, &b, (vec3){1, 1, -5}, (vec3){1.1f, 0.9f, 0}));
    assert_normal(n, .1, .3, -1, 1e-4);
    scene_clear(&b);
    /* pbrt-v3's name; (u, v) are mirrored, the corners turn as before: the same slope in x and y needs another texture
     */
    b = build("Texture \"d\" \"float\" \"bilerp\" \"float v00\" 0.4 \"float v01\" 1 \"float v10\" 0 \"float v11\" 0.6 "
              "Material \"matte\" \"texture bumpmap\" \"d\" Shape \"trianglemesh\" \"point3 P\" [0 0 0  4 0 0  4 2 0  "
              "0 2 0] "
              "\"integer indices\" [0 1 2 0 2 3] \"point2 uv\" [1 0 0 0 0 1 1 1]");
    assert_true(normal_at(n, &b, (vec3){1, 1, 5}, (vec3){1.1f, 0.9f, 0}));
    assert_normal(n, -.1, -.3, 1, 1e-4);
    scene_clear(&b);
    b = build(SLOPE "Material \"diffuse\" \"texture displacement\" \"d\" Shape \"trianglemesh\" \"point3 P\" "
              "[0 0 0  4 0 0  4 2 0  0 2 0] \"integer indices\" [0 2 1 0 3 2] \"point2 uv\" [0 0 1 0 1 1 0 1]");
    assert_true(normal_at(n, &b, (vec3){1, 1, 5}, (vec3){1.1f, 0.9f, 0}));
    assert_normal(n, .1, .3, 1, 1e-4); /* displaced down */
    scene_clear(&b);
}

/* 4 x 1 or, upwards, 1 x 4 pixels of 0, 1/4, 1/2, 3/4. Returns the file's name. */
static const char *store_ramp(bool upwards)
{
    bytes file = {0};
    put_text(&file, upwards ? "PF\n1 4\n-1.0\n" : "PF\n4 1\n-1.0\n");
    for (int i = 0; i < 12; i++) put_float(&file, (float)(i / 3) / 4);
    store(scratch("ramp.pfm"), file.data, file.n);
    bytes_clear(&file);
    return strrchr(scratch("ramp.pfm"), '/') + 1;
}

/* A texel ramp: 0, 0.25, 0.5, 0.75 over 4 texels; between their centres the slope is 1 in s, or in t. A u of 1 is 4 of
 * the plane, a v of 1 is 2. */
static void an_images_slope_is_taken_over_a_texel(void **state)
{
    for (int axis = 0; axis < 2; axis++) {
        const char *name = store_ramp(axis);
        const double side = axis ? 2 : 4;
        /* in the middle; over the border's texel, half of the slope at u = 1/8: from u = 0 and 1/4: 0 and 0.125; with a
         * scale of 2 for this axis a texel is half as wide */
        const struct { double at, slope; int scale; } cases[] = {{.5, 1, 1}, {.125, .5, 1}, {.25, 2, 2}};
        for (int i = 0; i < 3; i++) {
            double n[3];
            built b = build("Texture \"d\" \"float\" \"imagemap\" \"string filename\" \"%s\" \"string wrap\" "
                            "\"clamp\" \"float %cscale\" %d Material \"diffuse\" \"texture displacement\" \"d\" "
                            PLANE, name, axis ? 'v' : 'u', cases[i].scale);
            const float x = axis ? 2 : (float)(side * cases[i].at), y = axis ? (float)(side * cases[i].at) : 1;
            assert_true(normal_at(n, &b, (vec3){x, y, 5}, (vec3){x, y, 0}));
            assert_normal(n, axis ? 0 : -cases[i].slope / side, axis ? -cases[i].slope / side : 0, 1, 1e-4);
            scene_clear(&b);
        }
    }
}

/* An image of one colour all over. */
static void store_colour(const char *path, float r, float g, float b)
{
    bytes file = {0};
    put_text(&file, "PF\n1 1\n-1.0\n");
    put_float(&file, r);
    put_float(&file, g);
    put_float(&file, b);
    store(path, file.data, file.n);
    bytes_clear(&file);
}

/* A texel is the step for an image by (u, v) alone. The ramp has its first centre at s = 1/8. At s = 0.15 its slope is
 * 1; over a texel, from 0.025 to 0.275, it is 0.6, because it is flat left of the centre. An image by the plane s = x/4
 * shows the slope there, because the step is short. */
static void a_texel_counts_where_its_image_is_looked_up_by_uv(void **state)
{
    static const struct { const char *mapping; double slope; } images[] = {
        {"", .6}, {"\"string mapping\" \"planar\" \"vector3 v1\" [0.25 0 0] \"vector3 v2\" [0 0.5 0]", 1}};
    const char *name = store_ramp(false);
    double n[3];
    for (size_t i = 0; i < 2; i++) {
        built b = build("Texture \"d\" \"float\" \"imagemap\" \"string filename\" \"%s\" \"string wrap\" "
                        "\"clamp\" %s Material \"diffuse\" \"texture displacement\" \"d\" " PLANE,
                        name, images[i].mapping);
        assert_true(normal_at(n, &b, (vec3){.6f, 1, 5}, (vec3){.6f, 1, 0}));
        assert_normal(n, -.25 * images[i].slope, 0, 1, .01);
        scene_clear(&b);
    }
}

/* The normal in the middle of PLANE as an OBJ, whose library says this. The plane has one material with `Kd`. */
static void normal_of_library(double n[3], const char *statement)
{
    char text[512];
    const char *prefix = strrchr(scratch(""), '/') + 1;

    snprintf(text, sizeof text, "newmtl a\nKd 0.5 0.5 0.5\n");
    for (const char *s = statement; *s; s++) /* @: what the names of the test's files begin with */
        snprintf(text + strlen(text), sizeof text - strlen(text), *s == '@' ? "%s" : "%.1s", *s == '@' ? prefix : s);
    store(scratch("m.mtl"), text, strlen(text));
    snprintf(text, sizeof text, "mtllib %sm.mtl\nv 0 0 0\nv 4 0 0\nv 4 2 0\nv 0 2 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
             "usemtl a\nf 1/1 2/2 3/3 4/4\n", prefix);
    store(scratch("m.obj"), text, strlen(text));
    built b = build("Shape \"objmesh\" \"string filename\" \"%sm.obj\" \"bool materials\" true", prefix);
    assert_true(normal_at(n, &b, (vec3){2, 1, 5}, (vec3){2.1f, 1, 0}));
    scene_clear(&b);
}

/* The bytes 0 to 153 over 4 texels, of a format that means sRGB where it holds colours: heights are linear, 0.2 a
 * texel. */
static void a_library_bends_normals(void **state)
{
    static const unsigned char tga[] = {0, 0, 3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 4, 0, 1, 0, 8, 0, 0, 51, 102, 153};
    static const struct { const char *statement; double n[3]; } cases[] = {
        {"", {0, 0, 1}},
        {"map_bump @h.tga", {-.2, 0, 1}},
        {"map_Bump @h.tga", {-.2, 0, 1}},
        {"bump -bm 0.5 @h.tga", {-.1, 0, 1}},
        {"bump -clamp on -bm -2 -s 0.5 0.5 @h.tga", {.2, 0, 1}}, /* a texel is 2 wide, and -2 high */
        {"bump -bm 0 @h.tga", {0, 0, 1}},
        {"norm @n.pfm", {.6, 0, .8}},
        {"norm -clamp on @n.pfm\nmap_bump @h.tga", {.6, 0, .8}}, /* a normal map goes before a displacement */
    };
    bytes file = {0};
    put_text(&file, "PF\n1 1\n-1.0\n");
    for (int i = 0; i < 3; i++) put_float(&file, (const float[]){.8f, .5f, .9f}[i]); /* (n + 1)/2 */
    store(scratch("n.pfm"), file.data, file.n);
    store(scratch("h.tga"), tga, sizeof tga);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double n[3];
        normal_of_library(n, cases[i].statement);
        assert_normal(n, cases[i].n[0], cases[i].n[1], cases[i].n[2], 1e-4);
    }
    bytes_clear(&file);
}

/* A texel of the n-th image of 64 x 64: 20 of heights, then 20 of normals. */
static rgb twin(int n, int x, int y, uint64_t *random)
{
    const double wave[2] = {sin(.3 * x), sin(.4 * y)}, noise = random_double(random);
    const double height[] = {201 / 255., x / 63., noise, x % 16 < 2 || y % 8 < 1 ? 0.2 : 0.8,
                             .5 + .2 * wave[0] + .2 * wave[1]};
    if (n < 15) { /* of one channel, coloured, and those of a blue photograph */
        const double h = height[n % 5], tint = n < 5 ? 0 : n < 10 ? .1 : .4 * noise;
        return rgb_from(h * (1 - tint), h * (1 - tint / 2), h);
    }
    if (n < 20) return rgb_from(.2 + .1 * (n - 15) * noise, .35 + .3 * wave[0] * wave[1], .6 + .35 * wave[1]);
    const double steep = (n - 19) / 24.; /* a slope of up to 40 degrees */
    double v[3] = {steep * wave[0], (n % 2 ? -1 : 1) * steep * wave[1], 1};
    if (n >= 35) v[0] += .5 * (noise - .5); /* fine detail */
    const double size = sqrt(v[0] * v[0] + v[1] * v[1] + 1), jpeg = n % 3 == 0 ? .04 * (noise - .5) : 0;
    for (int k = 0; k < 3; k++) v[k] = round(255 * ((v[k] / size + 1) / 2 + jpeg)) / 255;
    return rgb_from(v[0], v[1], v[2]);
}

/* 20 maps of heights and 20 of normals: none and all are taken for normals, and only where it is asked. Grey of 201 of
 * 255 has the length of a unit vector everywhere. */
static void a_normal_map_is_known_by_its_texels(void **state)
{
    uint64_t random = 7;
    for (int n = 0; n < 40; n++) {
        bytes file = {0};
        put_text(&file, "PF\n64 64\n-1.0\n");
        for (int y = 0; y < 64; y++) {
            for (int x = 0; x < 64; x++) {
                const rgb c = twin(n, x, y, &random);
                put_float(&file, c.r);
                put_float(&file, c.g);
                put_float(&file, c.b);
            }
        }
        store(scratch("twin.pfm"), file.data, file.n);
        bytes_clear(&file);
        for (int asked = 0; asked < 2; asked++) {
            const bis_texture_file f = {.filename = (char *)(uintptr_t)scratch("twin.pfm"), .gamma = 1,
                                        .meaning = asked ? BIS_IMAGE_BUMP : BIS_IMAGE_COLOURS};
            bis_texture_image image;
            bis_diag diag = {0};
            assert_int_equal(bis_textures_load(&image, &f, &diag), BIS_OK);
            if (image.holds_normals != (asked && n >= 20)) fail_msg("image %d: %d", n, image.holds_normals);
            assert_true(diag.n == 1 || !image.holds_normals); /* what is blue and no normal map may be told, too */
            bis_diag_clear(&diag);
            bis_image_clear(&image.image);
        }
    }
}

/* d = g . p on a sphere of radius r about c, really displaced: p + d n. Its normal by differences; the formula leaves
 * out d itself, so that only the slopes count: amplitude 1e-3 of r makes them differ by about 1e-3 of the tilt. */
static void a_displaced_sphere_has_that_normal(void **state)
{
    /* planar mapping makes s = 40 x; wrap repeats are avoided by bilerp, which goes on linearly: d = 0.001 s */
    built b = build("Texture \"d\" \"float\" \"bilerp\" \"string mapping\" \"planar\" \"vector3 v1\" [40 0 0] "
                    "\"float v00\" 0 \"float v01\" 0 \"float v10\" 0.001 \"float v11\" 0.001 "
                    "Material \"diffuse\" \"texture displacement\" \"d\" Translate 0 1 0 Scale 1 1.5 1 Shape "
                    "\"sphere\"");
    for (int i = 0; i < 200; i++) {
        uint64_t random = (uint64_t)i;
        const vec3 d = random_direction(&random), from = {3 * d.x, 1 + 3 * d.y, 3 * d.z};
        double n[3], dp[2][3], expected[3];
        assert_true(normal_at(n, &b, from, (vec3){0, 1, 0}));
        /* the point: on (x, (y - 1)/1.5, z) = e */
        const double e0[3] = {(double)d.x, (double)d.y / 1.5, (double)d.z};
        const double size = sqrt(e0[0] * e0[0] + e0[1] * e0[1] + e0[2] * e0[2]);
        const double theta = acos(e0[2] / size), phi = atan2(e0[1], e0[0]), h = 1e-4;
        for (int k = 0; k < 2; k++)
            for (int c = 0; c < 3; c++) dp[k][c] = 0;
        for (int k = 0; k < 2; k++)
            for (int side = -1; side <= 1; side += 2) {
                const double t = theta + (k == 0) * side * h, f = phi + (k == 1) * side * h;
                const double e[3] = {sin(t) * cos(f), sin(t) * sin(f), cos(t)};
                double m[3] = {e[0], e[1] / 1.5, e[2]};
                const double length_m = sqrt(m[0] * m[0] + m[1] * m[1] + m[2] * m[2]);
                const double p[3] = {e[0], 1 + 1.5 * e[1], e[2]}, displaced = .04 * p[0];
                for (int c = 0; c < 3; c++) dp[k][c] += side * (p[c] + displaced * m[c] / length_m);
            }
        for (int c = 0; c < 3; c++)
            expected[c] = dp[0][(c + 1) % 3] * dp[1][(c + 2) % 3] - dp[0][(c + 2) % 3] * dp[1][(c + 1) % 3];
        /* the tilt is up to 2.3 degrees; |d| = 0.04 of the radius of curvature, at least 1/1.5: 6 % of it */
        assert_normal(n, expected[0], expected[1], expected[2], .15);
        double plain[3] = {e0[0], e0[1] / 1.5, e0[2]};
        plain[0] = e0[0] / size, plain[1] = e0[1] / size / 1.5, plain[2] = e0[2] / size;
        if (fabs(e0[0] / size) < .5) assert_true(degrees(expected, plain) > 1); /* twin: without the bump it is seen */
    }
    scene_clear(&b);
}

/* What depends on the place alone bends the same, whatever the coordinates of the mesh, and without any. */
static void noise_in_space_does_not_ask_for_coordinates(void **state)
{
    static const char *const uvs[] = {"\"point2 uv\" [0 0 1 0 1 1 0 1]", "\"point2 uv\" [5 1 2 1 2 3 5 3]", "",
                                      "\"point2 uv\" [1 1 1 1 1 1 1 1]", "\"normal N\" [0 0 1 0 0 1 0 0 1 0 0 1]"};
    double first[3];
    for (size_t i = 0; i < sizeof uvs / sizeof *uvs; i++) {
        double n[3];
        built b = build(
            "Texture \"f\" \"float\" \"fbm\" \"integer octaves\" 2 Texture \"d\" \"float\" \"scale\" \"texture tex1\" "
            "\"f\" \"float tex2\" 0.4 Material \"diffuse\" \"texture displacement\" \"d\" Shape \"trianglemesh\" "
            "\"point3 P\" [0 0 0  4 0 0  4 2 0  0 2 0] \"integer indices\" [0 1 2 0 2 3] %s",
            uvs[i]);
        assert_true(normal_at(n, &b, (vec3){1.3f, .8f, 5}, (vec3){1.3f, .8f, 0}));
        if (i == 0) memcpy(first, n, sizeof n);
        /* steps of 0.0005 to 0.002 over octaves of size 1/2: their curvature, below 40, times half a step */
        assert_normal(n, first[0], first[1], first[2], .05);
        assert_true(degrees(n, (double[]){0, 0, 1}) > 1);
        scene_clear(&b);
    }
}

/* An image of one colour c: 2c - 1 in the frame of dp/du, n x dp/du, n. */
static void a_normal_map_turns_with_the_surface(void **state)
{
    double n[3];
    store_colour(scratch("n.pfm"), .75f, .6f, .9f); /* (0.5, 0.2, 0.8) */
    char name[64]; /* scratch's own is soon overwritten */
    snprintf(name, sizeof name, "%s", strrchr(scratch("n.pfm"), '/') + 1);
    built b = build("Material \"diffuse\" \"string normalmap\" \"%s\" " PLANE, name);
    assert_true(normal_at(n, &b, (vec3){1, 1, 5}, (vec3){1.1f, 0.9f, 0}));
    assert_normal(n, .5, .2, .8, 1e-4);
    assert_true(normal_at(n, &b, (vec3){1, 1, -5}, (vec3){1.1f, 0.9f, 0}));
    assert_normal(n, -.5, -.2, -.8, 1e-4);
    scene_clear(&b);
    /* however short dp/du is */
    b = build("Material \"diffuse\" \"string normalmap\" \"%s\" Shape \"trianglemesh\" \"point3 P\" "
              "[0 0 0  4 0 0  4 2 0] \"point2 uv\" [0 0 32 0 32 32]", name);
    assert_true(normal_at(n, &b, (vec3){3, 1, 5}, (vec3){3, 1, 0}));
    assert_normal(n, .5, .2, .8, 1e-4);
    scene_clear(&b);
    /* on a sphere dp/du points along phi: at (1, 0, 0) it is y; n x y = z */
    b = build("Material \"diffuse\" \"string normalmap\" \"%s\" Shape \"sphere\"", name);
    assert_true(normal_at(n, &b, (vec3){5, 0, 0}, (vec3){0, 0, 0}));
    assert_normal(n, .8, .5, .2, 1e-4);
    /* at a pole phi is 0, and dp/du is 0: the normal stays */
    assert_true(normal_at(n, &b, (vec3){0, 0, 5}, (vec3){0, 0, 0}));
    assert_normal(n, 0, 0, 1, 1e-4);
    scene_clear(&b);
    /* a disk's v falls outwards, its frame is phi, -r, z: at (0, -0.5): phi is x, n x phi is y */
    b = build("Material \"diffuse\" \"string normalmap\" \"%s\" Shape \"disk\"", name);
    assert_true(normal_at(n, &b, (vec3){0, -.5f, 5}, (vec3){0, -.5f, 0}));
    assert_normal(n, .5, .2, .8, 1e-4);
    scene_clear(&b);
    /* no normal at all: the surface's own; the mesh turned and stretched */
    store_colour(scratch("n.pfm"), .5f, .5f, .5f);
    b = build("Material \"diffuse\" \"string normalmap\" \"%s\" Rotate 90 1 0 0 " PLANE, name);
    assert_true(normal_at(n, &b, (vec3){1, 5, 1}, (vec3){1, 0, 1}));
    assert_normal(n, 0, 1, 0, 1e-4);
    scene_clear(&b);
}

/* A map's normal that points below the surface is turned over; one that is 0, or a p_u that is 0, gives the surface's
 * own; and so does a displacement where p_u is 0. y is on the side of p_v, (1, 1, 0). */
static void a_bent_normal_is_on_the_side_of_the_surface(void **state)
{
    static const struct { rgb colour; double u[3], expected[3]; } cases[] = {
        {{.75f, .625f, .9f}, {3, 0, 0}, {.5, .25, .8}}, {{.75f, .625f, .1f}, {3, 0, 0}, {-.5, -.25, .8}},
        {{.75f, .625f, .9f}, {0, 3, 0}, {.25, .5, .8}}, {{.5f, .5f, .5f}, {3, 0, 0}, {0, 0, 1}},
        {{.75f, .625f, .9f}, {0, 0, 0}, {0, 0, 1}}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        rgb pixel = cases[i].colour;
        const bis_texture_image image = {.image = {1, 1, &pixel, NULL}};
        const bis_textures none = {0};
        const bis_material_textures of = {.bump = BIS_NO_TEXTURE, .normals = 0};
        const double *u = cases[i].u;
        /* a part along the normal does not count */
        const bis_tangents t = {{u[0], u[1], 0.5}, {1, 1, 0}, {0, 0, 1}, false};
        const vec3 n = bis_bump_normal(&none, &image, &of, &t, (double[]){.3, .4}, (vec3){0, 0, 0});
        assert_normal((double[]){(double)n.x, (double)n.y, (double)n.z}, cases[i].expected[0], cases[i].expected[1],
                      cases[i].expected[2], 1e-4);
    }
}

/* Where the coordinates of a triangle are one point, its tangents are unit vectors that the normal completes. */
static void without_coordinates_any_tangents_will_do(void **state)
{
    for (uint64_t i = 0; i < 50; i++) {
        uint64_t random = i;
        const vec3 n = random_direction(&random);
        const frame f = frame_about(n);
        const vec3 a = add(n, f.x), b = add(n, f.y), c = sub(n, add(f.x, f.y));
        const ray eye = {{0, 0, 0}, n, INFINITY};
        bis_tangents t;
        memset(&t, 0xff, sizeof t); /* NaN */
        built plane = build(SLOPE "Material \"diffuse\" \"texture displacement\" \"d\" Shape \"trianglemesh\" "
                            "\"point2 uv\" [1 1 1 1 1 1] \"point3 P\" [%.9g %.9g %.9g  %.9g %.9g %.9g  %.9g %.9g %.9g]",
                            (double)a.x, (double)a.y, (double)a.z, (double)b.x, (double)b.y, (double)b.z, (double)c.x,
                            (double)c.y, (double)c.z);
        bis_geometry_tangents(&plane.scene->geometry, 0, &eye, &t);
        const double *const parts[] = {t.u, t.v, t.outside};
        for (int k = 0; k < 9; k++) {
            const double *x = parts[k / 3], *y = parts[k % 3];
            assert_true(fabs(x[0] * y[0] + x[1] * y[1] + x[2] * y[2] - (k % 4 == 0)) < 1e-6);
        }
        scene_clear(&plane);
    }
}

/* The tangents of quadrics are the differences of their coordinates: a point that moves by p_u du has u + du. */
static void tangents_are_the_derivatives_of_the_point(void **state)
{
    bis_xform t = bis_xform_rotate(40, 1, 2, 3), s = bis_xform_scale(1, 2, .5);
    t = bis_xform_compose(&t, &s);
    for (int kind = 0; kind < 2; kind++) {
        bis_geometry g = {0};
        const bis_quadric q = {.kind = kind ? BIS_DISK : BIS_SPHERE, .radius = 1.5, .to_world = t};
        assert_int_equal(bis_geometry_add_quadric(&g, &q, NULL), BIS_OK);
        for (int i = 0; i < 100; i++) {
            uint64_t random = (uint64_t)i;
            const vec3 d = random_direction(&random);
            const double r = .3 + .01 * i, phi = .06 * i;
            const vec3 aim = kind ? vec3_from(r * cos(phi), r * sin(phi), 0) : (vec3){0, 0, 0};
            const vec3 to = bis_xform_point(&t, aim), off = {9 * d.x, 9 * d.y, 9 * d.z}, from = add(to, off);
            const ray eye = {from, normalize(sub(to, from)), INFINITY};
            bis_tangents tangents;
            bis_surface at;
            double uv[2];
            bis_geometry_surface(&g, 0, &eye, &at);
            bis_geometry_uv(&g, 0, &eye, uv);
            bis_geometry_tangents(&g, 0, &eye, &tangents);
            for (int k = 0; k < 2; k++) {
                const double *e = k ? tangents.v : tangents.u, h = 1e-3;
                double moved[2];
                const vec3 next =
                    vec3_from((double)at.p.x + h * e[0], (double)at.p.y + h * e[1], (double)at.p.z + h * e[2]);
                const ray other = {add(next, mul(at.ng, 3)), neg(at.ng), INFINITY};
                bis_geometry_uv(&g, 0, &other, moved);
                if (fabs(moved[0] - uv[0]) > .5) continue; /* over the seam */
                /* second order: the curvature, times h */
                assert_true(fabs(moved[k] - uv[k] - h) < .05 * h && fabs(moved[1 - k] - uv[1 - k]) < .05 * h);
            }
        }
        bis_geometry_clear(&g);
    }
}

static void a_bump_of_one_value_costs_nothing_and_a_colour_is_no_bump(void **state)
{
    built b = build("Texture \"d\" \"float\" \"constant\" Material \"diffuse\" \"texture displacement\" \"d\" " PLANE);
    assert_null(bis_textures_of(&b.desc->textures, b.desc->shapes[0].material));
    scene_clear(&b);
    static const char *const bad[][2] = {
        {"Texture \"d\" \"spectrum\" \"uv\" Material \"diffuse\" \"texture displacement\" \"d\"", "one of colours"},
        {"Material \"diffuse\" \"texture bumpmap\" \"no\"", "\"no\" is not defined"},
        {"Material \"diffuse\" \"string normalmap\" \"no.png\"", "cannot read"},
    };
    for (size_t i = 0; i < 3; i++) {
        char text[400];
        bis_scene_desc *d;
        bis_diag diag = {0};
        snprintf(text, sizeof text, "WorldBegin LightSource \"infinite\" %s Shape \"sphere\"", bad[i][0]);
        store(scratch("scene.txt"), text, strlen(text));
        assert_int_equal(bis_scene_parse(&d, scratch("scene.txt"), &diag) != BIS_OK, 1);
        if (!strstr(diag.messages[0].text, bad[i][1])) fail_msg("%s", diag.messages[0].text);
        bis_diag_clear(&diag);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_slope_tilts_a_plane),
        cmocka_unit_test(an_images_slope_is_taken_over_a_texel),
        cmocka_unit_test(a_texel_counts_where_its_image_is_looked_up_by_uv),
        cmocka_unit_test(a_library_bends_normals),
        cmocka_unit_test(a_normal_map_is_known_by_its_texels),
        cmocka_unit_test(a_displaced_sphere_has_that_normal),
        cmocka_unit_test(noise_in_space_does_not_ask_for_coordinates),
        cmocka_unit_test(a_normal_map_turns_with_the_surface),
        cmocka_unit_test(a_bent_normal_is_on_the_side_of_the_surface),
        cmocka_unit_test(without_coordinates_any_tangents_will_do),
        cmocka_unit_test(tangents_are_the_derivatives_of_the_point),
        cmocka_unit_test(a_bump_of_one_value_costs_nothing_and_a_colour_is_no_bump),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
