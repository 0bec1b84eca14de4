/* SPDX-License-Identifier: BSD-2-Clause */
/* scene: what is built of a description, and what is not. */
#include "bis/scene/scene.h"

#include "bis/base/mem.h"
#include "bis/files/image_file.h"
#include "claim.h"
#include "image_help.h"
#include "scene/scene_peek.h"
#include "scene_help.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define SCENES "../../tests/data/scenes/" /* from build/scratch */

/* ---- help ---- */

static built describe(const char *before, const char *after)
{
    built b;
    char text[4096];
    snprintf(text, sizeof text, "%s\nWorldBegin\n%s\n", before, after);
    scene_assert(&b, scene_parse(&b, text));
    return b;
}

static built build(const char *before, const char *after)
{
    return scene_build("%s\nWorldBegin\n%s\n", before, after);
}

#define TETRAHEDRON "Shape \"plymesh\" \"string filename\" \"" SCENES "tetrahedron.ply\"\n"
#define SQUARE "Shape \"objmesh\" \"string filename\" \"" SCENES "square.obj\"\n"
#define MAP "LightSource \"infinite\" \"string filename\" \"" SCENES "map.pfm\"\n"
#define MAP_B0 "LightSource \"infinite\" \"float areaexponent\" 0 \"string filename\" \"" SCENES "map.pfm\"\n"

static bool hits(const bis_scene *s, double x, double y, double z, double dx, double dy, double dz, float *t)
{
    ray r = {vec3_from(x, y, z), vec3_from(dx, dy, dz), INFINITY};
    bis_hit hit;
    if (!bis_accel_intersect(s->accel, &r, &hit)) return false;
    *t = hit.t;
    return true;
}

/* ---- geometry ---- */

static void every_kind_of_shape_is_built(void **state)
{
    built b = build("", MAP TETRAHEDRON SQUARE
        "Shape \"sphere\" Shape \"disk\" Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]");
    assert_int_equal(b.scene->geometry.n_triangles, 4 + 2 + 1);
    assert_int_equal(b.scene->geometry.n_quadrics, 2);
    assert_non_null(b.scene->accel);
    assert_non_null(b.scene->light);
    assert_true(b.scene->seconds.load > 0 && b.scene->seconds.accel > 0 && b.scene->seconds.envmap >= 0);
    /* triangles first, then the sphere and the disk */
    static const size_t shape_of[9] = {0, 0, 0, 0, 1, 1, 4, 2, 3}, part_of[9] = {0, 1, 2, 3, 0, 1, 0, 0, 0};
    for (uint32_t prim = 0; prim < 9; prim++) {
        size_t part = 77;
        assert_int_equal(bis_scene_shape_of(b.scene, prim, &part), shape_of[prim]);
        assert_int_equal(part, part_of[prim]);
    }
    scene_clear(&b);
}

static void instances_share_a_mesh_and_stand_where_they_were_put(void **state)
{
    built b = build("", MAP "ObjectBegin \"o\" " TETRAHEDRON "ObjectEnd\n"
                            "ObjectInstance \"o\" Translate 10 0 0 ObjectInstance \"o\" Translate 10 0 0 Scale 2 2 2 "
                            "ObjectInstance \"o\"");
    float t = 0;
    assert_int_equal(b.desc->n_meshes, 1);
    /* also the first, whose identity would let its mesh be moved away */
    assert_int_equal(b.scene->geometry.n_triangles, 12);
    for (int i = 0; i < 3; i++) {
        assert_true(hits(b.scene, 10 * i + 0.2, 0.2, -1, 0, 0, 1, &t));
        assert_true(fabs((double)t - 1) < 1e-6);
    }
    assert_true(hits(b.scene, 21.5, 0.2, -1, 0, 0, 1, &t)); /* only the doubled one is as wide */
    assert_false(hits(b.scene, 11.5, 0.2, -1, 0, 0, 1, &t));
    scene_clear(&b);
}

static void an_object_without_instance_is_not_built(void **state)
{
    built b = build("", MAP "ObjectBegin \"o\" " TETRAHEDRON "ObjectEnd Shape \"sphere\"");
    assert_int_equal(b.scene->geometry.n_triangles, 0);
    assert_int_equal(b.scene->geometry.n_quadrics, 1);
    scene_clear(&b);
}

static void smooth_makes_normals_only_when_asked(void **state)
{
    built b = build("", MAP TETRAHEDRON);
    assert_null(b.scene->geometry.n);
    scene_clear(&b);
    b = build("", MAP "Shape \"plymesh\" \"bool smooth\" true \"string filename\" \"" SCENES "tetrahedron.ply\"");
    assert_non_null(b.scene->geometry.n);
    scene_clear(&b);
}

static void a_mesh_that_vanishes_or_is_damaged_after_parsing_is_an_error_at_its_name(void **state)
{
    bis_scene *s = (bis_scene *)1;
    store(scratch("gone.ply"), "ply\nnonsense", 12);
    char text[512];
    const char *name = strrchr(scratch("gone.ply"), '/') + 1;
    snprintf(text, sizeof text, MAP "Shape \"plymesh\" \"string filename\" \"%s\"", name);
    built b = describe("", text);
    assert_int_equal(bis_scene_build(&s, b.desc, &b.diag), BIS_INPUT);
    assert_null(s);
    unlink(scratch("gone.ply"));
    assert_int_equal(bis_scene_build(&s, b.desc, &b.diag), BIS_IO);
    assert_null(s);
    assert_non_null(strstr(b.diag.messages[b.diag.n - 1].text, "scene.txt:4:17: error: "));
    scene_clear(&b);
}

/* By the file and no line: what places the camera may stand in several. */
static void a_camera_beyond_the_largest_float_is_an_error_of_its_file(void **state)
{
    static const struct { const char *camera, *place; } cases[] = {
        {"LookAt 0 1e39 0 0 0 0 0 0 1 Camera \"perspective\"", "y = 1e+39"},
        {"Scale 0.1 0.1 0.1 Camera \"orthographic\" \"float screenwindow\" [0 3e38 -1 1]", "x = 3e+39"},
        {"Scale 0.1 0.1 0.1 Rotate 90 1 0 0 Camera \"orthographic\" \"float screenwindow\" [-1 1 0 3e38]",
         "z = -3e+39"},
        {"Translate 0 -3.4028234663852886e38 0 Camera \"perspective\"", NULL}}; /* it is the largest float */
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        built b;
        char scene[256];
        snprintf(scene, sizeof scene, "Accelerator \"grid\" %s\nWorldBegin\nShape \"sphere\"\n", cases[i].camera);
        assert_int_equal(scene_try(&b, scene), cases[i].place ? BIS_INPUT : BIS_OK);
        if (cases[i].place) assert_non_null(strstr(b.diag.messages[b.diag.n - 1].text, cases[i].place));
        scene_clear(&b);
    }
    /* also of another accelerator over the same scene; there is none then */
    built b = build("Integrator \"em\"", "Shape \"sphere\"");
    bis_accel *other = b.scene->accel;
    b.desc->view.camera.to_world.m[0][3] = 1e39;
    assert_int_equal(bis_scene_accel(&other, b.scene, b.desc, BIS_ACCEL_GRID, &b.diag), BIS_INPUT);
    assert_null(other);
    scene_clear(&b);
}

/* ---- only what is required ---- */

/* ---- the light's frame ---- */

/* map.pfm: 4 x 2, radiance (1 + x, 2, 3 + row from the bottom). In the light's frame z is up; Rotate -90 about x turns
 * it to +y. */
static void the_map_is_turned_by_the_transformation_at_its_place(void **state)
{
    built b = build("", "AttributeBegin Rotate -90 1 0 0 " MAP "AttributeEnd");
    const bis_light *l = b.scene->light;
    assert_true(bis_light_Le(l, (vec3){0, 1, 0}).b == 4);  /* top row: the file's last */
    assert_true(bis_light_Le(l, (vec3){0, -1, 0}).b == 3);
    /* phi = 45 degrees of the light's frame, x = 0 of 4, is (1, 0, -1): y of the light becomes -z of the world */
    assert_true(bis_light_Le(l, normalize((vec3){1, 0.1f, -1})).r == 1);
    assert_true(bis_light_Le(l, normalize((vec3){-1, 0.1f, -1})).r == 2);
    scene_clear(&b);
}

/* ---- plan ---- */

static char *plan(const built *b)
{
    char *text = NULL;
    size_t n;
    FILE *out = open_memstream(&text, &n);
    bis_scene_plan(b->desc, out);
    fclose(out);
    return text;
}

static void assert_plan(const char *before, const char *after, const char *const *lines)
{
    built b = describe(before, after);
    char *text = plan(&b);
    for (; *lines; lines++) {
        if (!strstr(text, *lines)) print_error("no \"%s\" in\n%s", *lines, text);
        assert_non_null(strstr(text, *lines));
    }
    free(text);
    scene_clear(&b);
}

static void the_plan_says_what_is_left_out_and_why(void **state)
{
    assert_plan("", MAP, (const char *const[]){"\nskip         accelerator: there is no geometry\n",
                                               "\nskip         light table: there is no geometry to light\n", NULL});
    assert_plan("", "LightSource \"infinite\" Shape \"sphere\"",
                (const char *const[]){"\nlight        constant\n",
                                      "\nskip         light table: a constant light is drawn from without tables\n",
                                      "\nskip         specular candidates: Ks is 0 in 1 of 1 materials\n", NULL});
    assert_plan("", "Shape \"sphere\"", (const char *const[]){"\nlight        none: the picture will be black\n",
                                                              "\nskip         light table: there is no light\n", NULL});
    assert_plan("Integrator \"brdf\"", MAP "Shape \"sphere\"",
        (const char *const[]){
            "\nskip         light table: this integrator, so set, draws nothing from the map\n", NULL});
    assert_plan("Integrator \"em\"", MAP_B0 "Material \"phong\" \"float Kd\" 0 \"float Ks\" 1 Shape \"sphere\"",
                (const char *const[]){"\nskip         light components: areaexponent is 0\n",
                                      "\nskip         diffuse candidates: Kd is 0 in 1 of 1 materials\n", NULL});
    assert_plan("", MAP "ObjectBegin \"o\" " TETRAHEDRON "ObjectEnd Shape \"sphere\"",
                (const char *const[]){"tetrahedron.ply: no shape or instance uses it\n", NULL});
}

static void the_plan_says_what_is_built_and_how_large_it_is(void **state)
{
    assert_plan(
        "Integrator \"em\" \"integer samples\" 3\nAccelerator \"grid\" \"float density\" 2.5\nSampler \"sobol\"",
        MAP TETRAHEDRON TETRAHEDRON SQUARE,
        (const char *const[]){"\nintegrator   em: samples 3, stratify false\n", "\nclaim        ",
            "\nsampler      sobol, 16 camera samples a pixel, seed 0\n", "map.pfm, latlong, 4 x 2: 0.0 MB of pixels\n",
            "\nbuild        light table, CDFs: at most 0.0 MB\n",
            "\nbuild        light components, 8 levels, areaexponent 0.15\n",
            "tetrahedron.ply, 4 vertices, 4 faces, read once for 2 shapes\n", "square.obj, a file of",
            "\nbuild        accelerator grid, density 2.5\n", NULL});
}

/* The plan and the build draw the same conclusions. */
static void the_plan_agrees_with_the_build(void **state)
{
    static const char *const integrators[] = {"em", "brdf", "mis", "rejection", "sir", "exact", "unoccluded"};
    static const char *const worlds[] = {MAP, MAP "Shape \"sphere\"", "LightSource \"infinite\" Shape \"disk\"",
                                         "Shape \"sphere\"", ""};
    for (size_t i = 0; i < 7; i++)
        for (size_t j = 0; j < 5; j++) {
            char before[64];
            snprintf(before, sizeof before, "Integrator \"%s\"", integrators[i]);
            built b = build(before, worlds[j]);
            char *text = plan(&b);
            const bool table = strstr(text, "\nbuild        light table") || strstr(text, "\nbuild        light curve");
            assert_true(table == (bis_light_importance(b.scene->light) != NULL));
            assert_true((strstr(text, "\nbuild        accelerator") != NULL) == (b.scene->accel != NULL));
            free(text);
            scene_clear(&b);
        }
}

static bool peeked(const char *name, const void *data, size_t n, long wanted_w, long wanted_h)
{
    long w, h;
    store(scratch(name), data, n);
    return bis_scene_peek_image(scratch(name), &w, &h) && w == wanted_w && h == wanted_h;
}

/* Of files that bis writes, whole and cut off; then the first bytes of formats that it reads alone, written by hand. */
static void a_size_is_read_where_the_format_has_it(void **state)
{
    static const char *const names[] = {"p.hdr", "p.exr", "p.pfm", "p.png"};
    /* APP1 of 12 bytes holds a thumbnail's frame (9 x 9); a byte that fills; DHT; the frame: 8 bits, 80 rows of 70 */
    static const char jpeg[] = "\xff\xd8\xff\xe1\0\x0c\xff\xc0\0\x11\x08\0\x09\0\x09\x03\xff\xff\xc4\0\x02"
                               "\xff\xc2\0\x0b\x08\0\x50\0\x46\x01\x01\x11\0";
    static const char bmp[] = "BM\0\0\0\0\0\0\0\0\0\0\0\0\x28\0\0\0\x0c\0\0\0\xf0\xff\xff\xff";
    static const char tga[] = "\0\0\x0a\0\0\0\0\0\0\0\0\0\x20\0\x28\0\x18\0\0\0"; /* 32 x 40 of 24 bits, in runs */
    static const char *const hdr[] = {
        "-Y 512 +X 1024", "+Y 512 +X 1024", "-Y 512 -X 1024", "+Y 512 -X 1024", "+X 1024 -Y 512", "-X 1024 +Y 512"};
    bis_image image;
    long w, h;
    assert_int_equal(bis_image_init(&image, 300, 70, NULL), BIS_OK);
    for (int i = 0; i < 300 * 70; i++) image.pixels[i].g = (float)(i % 97);
    for (int i = 0; i < 4; i++) {
        assert_int_equal(bis_image_save(&image, scratch(names[i]), NULL), BIS_OK);
        if (!bis_scene_peek_image(scratch(names[i]), &w, &h) || w != 300 || h != 70) fail_msg("%s", names[i]);
        assert_int_equal(truncate(scratch(names[i]), 5), 0);
        assert_false(bis_scene_peek_image(scratch(names[i]), &w, &h));
    }
    bis_image_clear(&image);
    for (size_t i = 0; i < 6; i++) {
        char text[100];
        snprintf(text, sizeof text, "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n%s\n", hdr[i]);
        assert_true(peeked("p.hdr", text, strlen(text), 1024, 512));
    }
    assert_false(peeked("p.hdr", "#?RGBE\n\n-Y 0 +X 1\n", 19, 1, 0));
    assert_false(peeked("p.pfm", "PF\n7 0\n-1\n", 10, 7, 0));
    assert_true(peeked("p.jpg", jpeg, sizeof jpeg - 1, 70, 80)); /* 34 bytes have 34 x 512 pixels at most */
    assert_false(peeked("p.jpg", jpeg, 29, 70, 80));             /* the head ends within the frame */
    assert_true(peeked("p.bmp", bmp, 26, 12, 16) && !peeked("p.bmp", bmp, 25, 12, 16));
    assert_true(peeked("p.tga", tga, 20, 32, 40) && !peeked("p.tga", tga, 17, 32, 40));
}

/* The counts of a PLY stand in its head. */
static void counts_of_a_mesh_are_read_from_its_head(void **state)
{
    static const char ply[] = "ply\nformat ascii 1.0\nelement vertex 12\nproperty float x\nelement face 7\n";
    long v, f;
    store(scratch("p.ply"), ply, sizeof ply - 1);
    assert_true(bis_scene_peek_ply(scratch("p.ply"), &v, &f) && v == 12 && f == 7);
    assert_int_equal(bis_scene_peek_bytes(scratch("p.ply")), sizeof ply - 1);
    store(scratch("p.ply"), "ply\nelement vertex 12\n", 22);
    assert_false(bis_scene_peek_ply(scratch("p.ply"), &v, &f));
}

/* ---- what the camera sees of the map ---- */

/* 4 x 2 pixels: 1 2 3 4 above, 5 6 7 8 below, in red; a PFM's first row is the bottom. */
static const char *eight(int width, int height)
{
    bytes b = {0};
    char head[40];
    snprintf(head, sizeof head, "PF\n%d %d\n-1.0\n", width, height);
    put_text(&b, head);
    for (int i = 0; i < width * height; i++) {
        const int row = height - 1 - i / width;
        put_float(&b, (float)(row * width + i % width + 1));
        put_float(&b, 0);
        put_float(&b, 0);
    }
    store(scratch("eight.pfm"), b.data, b.n);
    bytes_clear(&b);
    return strrchr(scratch("eight.pfm"), '/') + 1;
}

/* E3, as printed, forgets the solid angle of a pixel: of 4 rows the first has 1 - sqrt(1/2) of its half, the second
 * sqrt(1/2). Their first pixels have 1 and 9. */
static void a_scene_as_printed_draws_from_its_light_as_printed(void **state)
{
    for (int printed = 0; printed < 2; printed++) {
        char light[200];
        double pmf[8 * 4];
        snprintf(light, sizeof light, "LightSource \"infinite\" \"float areaexponent\" 0 \"string filename\" "
                 "\"%s\" Shape \"sphere\"", eight(8, 4));
        built b = build(printed ? "Integrator \"em\"\nOption \"string asprinted\" \"E3\"" : "Integrator \"em\"",
                        light);
        assert_int_equal(bis_importance_implied_pmf(bis_light_importance(b.scene->light), pmf, NULL), BIS_OK);
        const double expected = printed ? 1 / 9. : (1 - sqrt(.5)) / sqrt(.5) / 9;
        if (!(fabs(pmf[0] / pmf[8] / expected - 1) < 1e-6))
            fail_msg("printed %d: %.9g and %.9g, not %.9g", printed, pmf[0], pmf[8], expected);
        scene_clear(&b);
    }
}

/* phi and theta in parts of a turn and of half a turn */
static double seen(const built *b, double turn, double fall)
{
    const vec3 d = vec3_from(sin(PI * fall) * cos(2 * PI * turn), sin(PI * fall) * sin(2 * PI * turn), cos(PI * fall));
    return (double)bis_light_seen(&b->desc->light, b->scene->light, d).r;
}

static void assert_seen(const built *b, double turn, double fall, double expected)
{
    if (!(fabs(seen(b, turn, fall) - expected) < 1e-5))
        fail_msg("at %g %g: %g, not %g", turn, fall, seen(b, turn, fall), expected);
}

/* Bilinear between the centres of pixels: columns at (i + 1/2)/4 of a turn, rows at 1/4 and 3/4 of the fall. */
static void a_map_is_seen_smooth_if_the_scene_says_so(void **state)
{
    char light[200];
    snprintf(light, sizeof light,
        "LightSource \"infinite\" \"string filename\" \"%s\" \"string filter\" \"bilinear\"\n" SQUARE, eight(4, 2));
    built b = build("", light);
    for (int i = 0; i < 8; i++) assert_seen(&b, (i % 4 + .5) / 4, (i / 4 + .5) / 2, i + 1);
    assert_seen(&b, .25, .25, 1.5);
    assert_seen(&b, .3, .25, .7 * 2 + .3 * 1);     /* 0.2 of a column behind the middle between: 0.7 of the second */
    assert_seen(&b, 0, .25, 2.5);                  /* over the seam: 4 and 1 */
    assert_seen(&b, .125, .5, 3);                  /* 1 and 5 */
    assert_seen(&b, .25, .5, (1 + 2 + 5 + 6) / 4.);
    assert_seen(&b, .125, 1e-9, (1 + 3) / 2.);     /* the pole lies between a column and that half a turn away */
    assert_seen(&b, .375, 1 - 1e-9, (6 + 8) / 2.);
    /* what surfaces receive is made of pixels all the same */
    const rgb Le =
        bis_light_Le(b.scene->light, vec3_from(sin(PI / 4) * cos(PI * .49), sin(PI / 4) * sin(PI * .49), cos(PI / 4)));
    assert_true(Le.r == 1);
    scene_clear(&b);
    /* twins: as it is otherwise, and not at all */
    snprintf(light, sizeof light,
        "LightSource \"infinite\" \"string filename\" \"%s\" \"string filter\" \"point\"\n" SQUARE, eight(4, 2));
    b = build("", light);
    assert_seen(&b, .24, .25, 1);
    scene_clear(&b);
    snprintf(light, sizeof light,
        "LightSource \"infinite\" \"string filename\" \"%s\" \"string filter\" \"bilinear\" \"bool visible\" "
        "false\n" SQUARE,
        eight(4, 2));
    b = build("", light);
    const rgb unseen = bis_light_seen(&b.desc->light, b.scene->light, (vec3){0, 0.6f, 0.8f});
    assert_true(unseen.r == 0 && unseen.g == 0 && unseen.b == 0);
    scene_clear(&b);
    b = build("", "LightSource \"infinite\" \"rgb L\" [3 1 1] \"string filter\" \"bilinear\"\n" SQUARE);
    assert_seen(&b, .24, .25, 3);
    scene_clear(&b);
}

static void a_map_higher_than_wide_is_warned_of_unless_its_mapping_is_given(void **state)
{
    for (int i = 0; i < 3; i++) {
        char light[200];
        snprintf(light, sizeof light, "LightSource \"infinite\" \"string filename\" \"%s\" %s\n" SQUARE,
                 i < 2 ? eight(2, 4) : eight(4, 2), i == 1 ? "\"string mapping\" \"latlong\"" : "");
        built b = build("", light);
        assert_int_equal(b.diag.n, i == 0);
        if (i == 0) {
            assert_non_null(strstr(b.diag.messages[0].text, "is 2 x 4, higher than wide, and is taken for a lat-long "
                                                            "map all the same"));
            assert_non_null(strstr(b.diag.messages[0].text, "if that is meant (string mapping)"));
        }
        scene_clear(&b);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_kind_of_shape_is_built),
        cmocka_unit_test(a_scene_as_printed_draws_from_its_light_as_printed),
        cmocka_unit_test(a_map_is_seen_smooth_if_the_scene_says_so),
        cmocka_unit_test(a_map_higher_than_wide_is_warned_of_unless_its_mapping_is_given),
        cmocka_unit_test(instances_share_a_mesh_and_stand_where_they_were_put),
        cmocka_unit_test(an_object_without_instance_is_not_built),
        cmocka_unit_test(smooth_makes_normals_only_when_asked),
        cmocka_unit_test(a_mesh_that_vanishes_or_is_damaged_after_parsing_is_an_error_at_its_name),
        cmocka_unit_test(a_camera_beyond_the_largest_float_is_an_error_of_its_file),
        cmocka_unit_test(the_map_is_turned_by_the_transformation_at_its_place),
        cmocka_unit_test(the_plan_says_what_is_left_out_and_why),
        cmocka_unit_test(the_plan_says_what_is_built_and_how_large_it_is),
        cmocka_unit_test(the_plan_agrees_with_the_build),
        cmocka_unit_test(a_size_is_read_where_the_format_has_it),
        cmocka_unit_test(counts_of_a_mesh_are_read_from_its_head),
    };
    return cmocka_run_group_tests_name("scene", tests, NULL, scratch_remove);
}
