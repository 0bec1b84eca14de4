/* SPDX-License-Identifier: BSD-2-Clause */
/* alloc: the k-th allocation fails, for k = 1, 2, ... until all goes well: from the scene's text to the picture on
 * disk, through every reader, every integrator and both accelerators. What must hold each time: BIS_NOMEM with an error
 * message and nothing handed out, or full success with the same picture (a library may do without a piece of memory; a
 * warning may be lost). Under `make asan` the same runs show that nothing leaks.
 * One thread, so that k means the same allocation in every run. */
#include "bis/base/mem.h"
#include "bis/render/render.h"
#include "bis/files/image_file.h"
#include "claim.h"
#include "image_help.h"
#include "mesh_help.h"
#include "files/obj.h"
#include "files/ply.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 5, HEIGHT = 4 };
#define SCENES "../../tests/data/scenes/" /* from build/scratch */

/* A step that allocates: its status, its complaints; *result is what it made, compared between runs. */
typedef bis_status step(void *setting, rgb *result, bis_diag *diag);

/* Returns the number of allocations that did fail the step. */
static long fail_each(step *run, void *setting)
{
    static rgb expected[WIDTH * HEIGHT];
    long n_failed = 0;
    bis_diag none = {0};

    memset(expected, 0, sizeof expected);
    bis_status first = run(setting, expected, &none);
    if (first) print_message("%s\n", none.messages[0].text);
    assert_int_equal(first, BIS_OK);
    bis_diag_clear(&none);
    for (long k = 1, count = k; count >= k; k++) {
        rgb found[WIDTH * HEIGHT] = {{0}};
        bis_diag diag = {0};
        bis_mem_fail_at(k);
        bis_status status = run(setting, found, &diag);
        count = bis_mem_count();
        bis_mem_fail_at(0);
        if (status) {
            n_failed++;
            if (status != BIS_NOMEM) print_message("k = %ld: %s\n", k, diag.n ? diag.messages[0].text : "no message");
            assert_int_equal(status, BIS_NOMEM);
            assert_true(diag.n_errors > 0);
        } else {
            assert_int_equal(diag.n_errors, 0);
            assert_memory_equal(found, expected, sizeof expected);
        }
        assert_true(count >= k || status == BIS_OK);
        bis_diag_clear(&diag);
    }
    return n_failed;
}

/* ---- from the scene's text to the picture ---- */

static bis_status write_film(const bis_film *film, rgb *result, bis_diag *diag)
{
    float rgba[4 * WIDTH * HEIGHT];
    bis_film_resolve(film, rgba);
    for (int i = 0; i < WIDTH * HEIGHT; i++) result[i] = (rgb){rgba[4 * i], rgba[4 * i + 1], rgba[4 * i + 2]};
    const bis_channel channels[] = {{"R", rgba, 4}, {"G", rgba + 1, 4}, {"B", rgba + 2, 4}, {"A", rgba + 3, 4}};
    const bis_picture picture = {.width = WIDTH,
        .height = HEIGHT,
        .full_width = WIDTH,
        .full_height = HEIGHT,
        .channels = channels,
        .n_channels = 4};
    return bis_image_write(scratch("out.exr"), &picture, diag);
}

static bis_status from_text_to_picture(void *path, rgb *result, bis_diag *diag)
{
    bis_scene_desc *d = NULL;
    bis_scene *s = NULL;
    bis_film film = {0};
    bis_render_result what;

    bis_status status = bis_scene_parse(&d, path, diag);
    assert_true((d == NULL) == (status != BIS_OK));
    if (status) goto done;
    d->accel.n_threads = 1;
    status = bis_scene_build(&s, d, diag);
    assert_true((s == NULL) == (status != BIS_OK));
    if (status) goto done;
    status = bis_film_init(&film, d->view.film.width, d->view.film.height, d->view.film.crop, (bis_loc){0}, diag);
    if (status) goto done;
    status = bis_render(&what, &film, s, &d->view, &(bis_render_options){.n_threads = 1}, diag);
    if (status) goto done;
    assert_int_equal(what.counters.nonfinite, 0);
    status = write_film(&film, result, diag);
done:
    bis_film_clear(&film);
    bis_scene_free(s);
    bis_scene_desc_free(d);
    return status;
}

/* Meshes from both kinds of file and from the scene itself, with invented normals, an object and its instances,
 * quadrics, named and nameless materials, transformations that have names. */
static const char world[] =
    "MakeNamedMaterial \"shiny\" \"string type\" \"phong\" \"rgb Kd\" [.2 .3 .4] \"rgb Ks\" [.4 .4 .4] \"float "
    "exponent\" 50\n"
    "CoordinateSystem \"here\"\n"
    "AttributeBegin NamedMaterial \"shiny\" Translate 0 0 1 Shape \"sphere\" AttributeEnd\n"
    "ObjectBegin \"piece\" Material \"diffuse\" \"rgb reflectance\" [.5 .5 .5]\n"
    "  Shape \"plymesh\" \"string filename\" \"" SCENES "tetrahedron.ply\" \"bool smooth\" \"true\"\n"
    "  Shape \"objmesh\" \"string filename\" \"" SCENES "square.obj\"\nObjectEnd\n"
    "CoordSysTransform \"here\" Translate 2 0 0 ObjectInstance \"piece\" Translate 0 2 0 ObjectInstance \"piece\"\n"
    "Shape \"disk\" \"float radius\" 4 Shape \"trianglemesh\" \"point3 P\" [0 0 3 1 0 3 0 1 3] \"normal N\" [0 0 1 0 0 "
    "1 0 0 1]\n";

static const char *store_scene(const char *integrator, const char *accelerator, const char *sampler, const char *light)
{
    char text[4096];
    int n = snprintf(text, sizeof text,
                     "LookAt 3 4 2  .5 .5 .5  0 0 1 Camera \"perspective\"\n"
                     "Film \"rgb\" \"integer xresolution\" %d \"integer yresolution\" %d\n"
                     "Sampler \"%s\" \"integer pixelsamples\" 2\nAccelerator \"%s\"\nIntegrator %s\nWorldBegin\n"
                     "LightSource \"infinite\" %s\n%s",
                     WIDTH, HEIGHT, sampler, accelerator, integrator, light, world);
    store(scratch("scene.txt"), text, (size_t)n);
    return scratch("scene.txt");
}

static void fail_each_of_scene(const char *integrator, const char *accelerator, const char *sampler, const char *light)
{
    char path[128];
    snprintf(path, sizeof path, "%s", store_scene(integrator, accelerator, sampler, light));
    const int n_files = scratch_count(); /* with out.exr of an earlier run, or without */
    long n = fail_each(from_text_to_picture, path);
    assert_true(n >= 30);
    assert_true(scratch_count() <= n_files + 1); /* no temporary file is left */
}

#define MAP "\"string filename\" \"" SCENES "map.pfm\" "

static void a_picture_by_any_integrator_or_a_clean_error(void **state)
{
    const char *integrators[] = {"\"em\"", "\"brdf\"", "\"mis\"", "\"mis\" \"bool compensate\" \"true\"",
                                 "\"rejection\" \"string proposal\" \"choose\"", "\"sir\" \"string proposal\" \"em\"",
                                 "\"sir\" \"string proposal\" \"mix\"", "\"exact\"", "\"unoccluded\""};
    for (size_t i = 0; i < sizeof integrators / sizeof integrators[0]; i++)
        fail_each_of_scene(integrators[i], "grid", "stratified", MAP);
}

static void both_accelerators_or_a_clean_error(void **state)
{
    if (bis_accel_embree_version()) fail_each_of_scene("\"sir\"", "embree", "stratified", MAP);
    fail_each_of_scene("\"sir\"", "grid", "independent", MAP);
}

static void every_kind_of_light_table_and_sampler_or_a_clean_error(void **state)
{
    const char *samplers[] = {"independent", "stratified", "halton"};
    const char *lights[] = {MAP "\"float areaexponent\" 0", MAP "\"string sampler\" \"cdf\"",
        MAP "\"string sampler\" \"alias\"", "\"rgb L\" [1 2 3]"};
    for (size_t i = 0; i < sizeof samplers / sizeof samplers[0]; i++)
        fail_each_of_scene("\"em\"", "grid", samplers[i], MAP);
    for (size_t i = 0; i < sizeof lights / sizeof lights[0]; i++)
        fail_each_of_scene("\"sir\"", "grid", "stratified", lights[i]);
}

static void maps_of_every_format_and_mapping_or_a_clean_error(void **state)
{
    const char *endings[] = {"hdr", "exr", "pfm"};
    bis_image image;
    assert_int_equal(bis_image_init(&image, 8, 8, NULL), BIS_OK);
    for (int i = 0; i < 64; i++) image.pixels[i] = rgb_from(1 + i % 3, 0.5, i / 8);
    for (size_t i = 0; i < 3; i++)
        for (int angular = 0; angular < 2; angular++) {
            char name[32], light[256];
            snprintf(name, sizeof name, "probe.%s", endings[i]);
            assert_int_equal(bis_image_save(&image, scratch(name), NULL), BIS_OK);
            snprintf(light, sizeof light, "\"string filename\" \"%s\" \"string mapping\" \"%s\"",
                strrchr(scratch(name), '/') + 1, angular ? "angular" : "latlong");
            fail_each_of_scene("\"sir\"", "grid", "stratified", light);
        }
    bis_image_clear(&image);
}

/* ---- one reader at a time ---- */

static bis_status read_image(void *path, rgb *result, bis_diag *diag)
{
    bis_image image;
    bis_status status = bis_image_read(&image, path, (bis_loc){0}, diag);
    assert_true((image.pixels == NULL) == (status != BIS_OK));
    if (image.pixels) memcpy(result, image.pixels, WIDTH * HEIGHT * sizeof *result);
    bis_image_clear(&image);
    return status;
}

static void an_image_of_every_format_or_a_clean_error(void **state)
{
    const char *names[] = {"a.hdr", "a.exr", "a.pfm"};
    bis_image image;
    assert_int_equal(bis_image_init(&image, 64, 32, NULL), BIS_OK);
    for (int i = 0; i < 64 * 32; i++) image.pixels[i] = rgb_from(1 + i % 7, 2, i % 11);
    for (size_t i = 0; i < 3; i++) {
        char path[128];
        snprintf(path, sizeof path, "%s", scratch(names[i]));
        assert_int_equal(bis_image_save(&image, path, NULL), BIS_OK);
        assert_true(fail_each(read_image, path) >= 2); /* the file, the pixels */
    }
    bis_image_clear(&image);
}

static void a_mesh_of_every_format_or_a_clean_error(void **state)
{
    static const char *const files[] = {
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty float "
        "nx\nproperty float ny\n"
        "property float nz\nproperty uchar red\nelement face 2\nproperty list uchar int vertex_indices\nelement edge "
        "1\nproperty int a\n"
        "end_header\n0 0 0 0 0 1 9\n1 0 0 0 0 1 9\n1 1 0 0 0 1 9\n0 1 0 0 0 1 9\n4 0 1 2 3\n3 0 1 2\n7\n",
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement "
        "tristrips 1\n"
        "property list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n8 0 1 2 -1 1 2 3 0\n",
    };
    const char *obj =
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nvn 0 1 0\nf 1//1 2//1 3//1 4//1\nf 1//2 2//1 3//2\nf -1 -2 -3\n";
    bytes b = {0};
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        b.n = 0;
        put_text(&b, files[i]);
        try_mesh_memory(bis_ply_read, &b, "a.ply");
    }
    b.n = 0;
    put_text(&b, obj);
    try_mesh_memory(bis_obj_read, &b, "a.obj");
    bytes_clear(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_picture_by_any_integrator_or_a_clean_error),
        cmocka_unit_test(both_accelerators_or_a_clean_error),
        cmocka_unit_test(every_kind_of_light_table_and_sampler_or_a_clean_error),
        cmocka_unit_test(maps_of_every_format_and_mapping_or_a_clean_error),
        cmocka_unit_test(an_image_of_every_format_or_a_clean_error),
        cmocka_unit_test(a_mesh_of_every_format_or_a_clean_error),
    };
    return cmocka_run_group_tests(tests, NULL, scratch_remove);
}
