/* SPDX-License-Identifier: BSD-2-Clause */
/* The memory that --plan foretells, beside what the program then takes (peak_memory_bytes of --stats): within 15 %. */
#include "bis/base/mem.h"
#include "claim.h"
#include "program.h"
#include "threads.h"
#include "tools/memory.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DIR "build/test_memory"

/* A map of one colour with a lamp. */
static void write_map(int width, int height)
{
    FILE *out = fopen(DIR "/map.pfm", "wb");
    assert_non_null(out);
    fprintf(out, "PF\n%d %d\n-1.0\n", width, height);
    for (int i = 0; i < width * height; i++) fwrite((const float[3]){1, 1, i % 100 ? 1 : 50}, sizeof(float), 3, out);
    fclose(out);
}

/* n x n vertices of a hill, two triangles between four of them. */
static void write_hill(int n)
{
    FILE *out = fopen(DIR "/hill.ply", "wb");
    assert_non_null(out);
    fprintf(out,
        "ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float "
        "z\n"
        "element face %d\nproperty list uchar int vertex_indices\nend_header\n",
        n * n, 2 * (n - 1) * (n - 1));
    for (int i = 0; i < n * n; i++) {
        const double x = 4.0 * (i % n) / n - 2, y = 4.0 * (i / n) / n - 2;
        fwrite((const float[3]){(float)x, (float)y, (float)(sin(3 * x) * sin(5 * y) / 9)}, sizeof(float), 3, out);
    }
    for (int y = 0; y + 1 < n; y++) {
        for (int x = 0; x + 1 < n; x++) {
            const int32_t a = y * n + x, index[2][3] = {{a, a + 1, a + n + 1}, {a, a + n + 1, a + n}};
            for (int i = 0; i < 2; i++) {
                fputc(3, out);
                fwrite(index[i], sizeof index[i], 1, out);
            }
        }
    }
    fclose(out);
}

static double number_after(const char *text, const char *key)
{
    const char *at = strstr(text, key);
    if (!at) fail_msg("there is no %s in %s", key, text);
    return atof(at + strlen(key));
}

static double megabytes_foretold(const char *options)
{
    program_run run;
    program_expect(&run, 0, "--plan %s " DIR "/scene.txt", options);
    return number_after(run.output, "memory       about ");
}

/* Two passes: a film of one pass has no half, and its pages are not touched. *said receives what --stats says of the
 * parts: of meshes, accelerator, map and film. */
static double megabytes_taken(const char *options, double *said)
{
    static const char *const parts[] = {"\"mesh\": ", "\"accel\": ", "\"envmap\": ", "\"film\": "};
    program_run run;
    program_expect(&run, 0, "--quiet --stats - --spp 2 --outfile " DIR "/out.pfm %s " DIR "/scene.txt", options);
    const char *memory = strstr(run.output, "\"memory\": {");
    assert_non_null(memory);
    *said = 0;
    for (int i = 0; i < 4; i++) *said += number_after(memory, parts[i]) / 1e6;
    return number_after(run.output, "\"peak_memory_bytes\": ") / 1e6;
}

/* The address sanitizer takes memory of its own, which no plan knows, and more addresses than a limit leaves. */
static void need_no_sanitizer(void)
{
#ifdef __SANITIZE_ADDRESS__
    print_message("not with the address sanitizer, which takes memory of its own\n");
    skip();
#endif
}

/* What the parts say that they take is at least a share of what is taken: files that are read stand beside them. */
static void assert_foretold(const char *options, double least)
{
    need_no_sanitizer();
    double said;
    const double foretold = megabytes_foretold(options), taken = megabytes_taken(options, &said);
    if (!(foretold > 0.85 * taken && foretold < 1.15 * taken))
        fail_msg("%s: %.1f MB were foretold, %.1f MB were taken", options, foretold, taken);
    if (!(said < taken && said > least * (taken - 10))) /* the program itself has 10 MB */
        fail_msg("%s: --stats says %.1f MB of %.1f MB", options, said, taken);
}

static void write_scene(const char *light, const char *shape, int width, int height)
{
    char text[1024];
    snprintf(text, sizeof text, "LookAt 0 -6 2  0 0 0  0 0 1\nCamera \"perspective\"\n"
             "Film \"rgb\" \"integer xresolution\" %d \"integer yresolution\" %d\nWorldBegin\nLightSource \"infinite\" "
             "%s\n"
             "Material \"phong\"\nShape %s\n", width, height, light, shape);
    program_write_file(DIR "/scene.txt", text);
}

static void a_large_picture_takes_what_was_foretold(void **state)
{
    write_scene("\"rgb L\" [1 1 1]", "\"sphere\"", 1800, 1200);
    assert_foretold("--integrator brdf --samples 1", 0.95);
    assert_foretold("--integrator brdf --samples 1 --layers albedo,normal", 0.95);
    write_scene("\"rgb L\" [1 1 1]", "\"sphere\"", 12000, 160);
    assert_foretold("--integrator brdf --samples 1 --nthreads 5 --outfile " DIR "/out.exr", 0.8);
}

static void a_large_map_takes_what_was_foretold(void **state)
{
    write_map(3000, 1500);
    write_scene("\"string filename\" \"map.pfm\"", "\"sphere\"", 40, 30);
    assert_foretold("--integrator brdf --samples 1", 0.45);
    assert_foretold("--integrator mis --samples 2", 0.95);
    assert_foretold("--integrator sir", 0.75);
    write_scene("\"string filename\" \"map.pfm\"", "\"sphere\"", 1000, 1000);
    assert_foretold("--candidates 16 --shadowrays 1", 0.95);
}

static void a_large_mesh_takes_what_was_foretold(void **state)
{
    write_hill(900);
    write_scene("\"rgb L\" [1 1 1]", "\"plymesh\" \"string filename\" \"hill.ply\"", 40, 30);
    assert_foretold("--integrator brdf --samples 1 --accelerator grid", 0.95);
    assert_foretold("--integrator brdf --samples 1", 0.45);
    write_scene("\"rgb L\" [1 1 1]", "\"plymesh\" \"string filename\" \"hill.ply\" \"bool smooth\" true", 40, 30);
    assert_foretold("--integrator brdf --samples 1", 0.45);
}

/* Three instances of a mesh, and a texture that two shapes show. */
static void textures_and_instances_take_what_was_foretold(void **state)
{
    write_map(3000, 1500);
    write_hill(300);
    program_write_file(DIR "/scene.txt",
        "LookAt 0 -6 2  0 0 0  0 0 1\nFilm \"rgb\" \"integer xresolution\" 40 \"integer yresolution\" 30\nWorldBegin\n"
        "LightSource \"infinite\" \"rgb L\" [1 1 1]\n"
        "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"map.pfm\" \"float scale\" 0.02\n"
        "Material \"diffuse\" \"texture reflectance\" \"t\"\nShape \"sphere\" ObjectBegin \"o\"\n"
        "Shape \"plymesh\" \"string filename\" \"hill.ply\" ObjectEnd\n"
        "ObjectInstance \"o\" Translate 4 0 0 ObjectInstance \"o\" Translate 4 0 0 ObjectInstance \"o\"\n");
    assert_foretold("--integrator brdf --samples 1", 0.3);
}

/* A picture of 78 GB: the plan tells so and warns, and the render warns before it fails, here because it may have 8 GB
 * alone. A process cannot change what is free, so the figures of the advice are those of a machine; the test below has
 * them all. */
static void what_does_not_fit_is_told_before(void **state)
{
    need_no_sanitizer();
    program_run run;
    write_scene("\"rgb L\" [1 1 1]", "\"sphere\"", 32768, 32768);
    assert_true(fabs(megabytes_foretold("--integrator brdf") / (32768.0 * 32768 * 68.25 / 1e6) - 1) < 0.01);
    program_expect(&run, 0, "--plan --integrator brdf " DIR "/scene.txt");
    assert_non_null(strstr(run.messages, "warning: this render takes about 73.3 GB, but "));
    assert_true(system("ulimit -v 8000000; ${BIS_PROGRAM:-build/release/bis} --integrator brdf --spp 1 --outfile " DIR
                       "/out.pfm " DIR "/scene.txt 2>" DIR "/messages") != 0);
    assert_int_equal(system("grep -q 'warning: this render takes about 73.3 GB, but .* GB of memory are free: it will "
                            "be slow, or the system will end it. Less is taken by crops, as --cropwindow 0,1,0,0.*, .* "
                            "parts, as --part 1/.* (.* GB; bis merge takes 7[34].. GB)$' " DIR "/messages"),
        0);
    assert_int_equal(system("grep -q 'error: no memory' " DIR "/messages"), 0);
    program_expect(&run, 0,
        "--integrator brdf --samples 1 --spp 1 --resolution 60x60 --outfile " DIR "/out.pfm " DIR "/scene.txt");
    assert_null(strstr(run.messages, "this render takes"));
}

/* ---- each figure by hand, without a render ---- */

/* The files hold no more than what is asked of them: their heads. */
static void write_ply_head(const char *path, int vertices, int faces)
{
    char text[256];
    snprintf(text, sizeof text,
        "ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n"
        "element face %d\nproperty list uchar int vertex_indices\nend_header\n",
        vertices, faces);
    program_write_file(path, text);
}

static void write_pfm_head(const char *path, int width, int height)
{
    char text[64];
    snprintf(text, sizeof text, "PF\n%d %d\n-1.0\n", width, height);
    program_write_file(path, text);
}

#define CONSTANT_LIGHT "LightSource \"infinite\" "
#define PLY(name) "Shape \"plymesh\" \"string filename\" \"" name ".ply\" "
#define SMALL "Film \"rgb\" \"integer xresolution\" 10 \"integer yresolution\" 10 Integrator \"brdf\" "

/* What the system has free, in kilobytes, by the system's own file; 0 where there is none. */
static double kilobytes_free(void)
{
    char line[256];
    double kilobytes = 0;
    FILE *in = fopen("/proc/meminfo", "r");
    while (in && fgets(line, sizeof line, in))
        if (sscanf(line, "MemAvailable: %lf", &kilobytes) == 1) break;
    if (in) fclose(in);
    return kilobytes;
}

/* Within a third of what is free before and after; up to 20 times, because other programs come and go. */
static void free_memory_is_what_the_system_says(void **state)
{
    bool is_near = false;
    if (kilobytes_free() <= 0) skip();
    for (int i = 0; i < 20 && !is_near; i++) {
        const double before = kilobytes_free(), found = bis_memory_free(), after = kilobytes_free();
        is_near = found >= 0.75 * 1024 * fmin(before, after) && found <= 1024 * fmax(before, after) / 0.75;
    }
    assert_true(is_near);
}

#define HUGE "Film \"rgb\" \"integer xresolution\" 32768 \"integer yresolution\" 32768 "
#define LARGE "Film \"rgb\" \"integer xresolution\" 4096 \"integer yresolution\" 2048 "
#define MAP "LightSource \"infinite\" \"string filename\" \"map.pfm\" Shape \"sphere\" "
static const struct {
    const char *before, *world;
    double room;
    const char *expected;
    bool needs_embree;
} advised[] = {
    {HUGE "Integrator \"brdf\"", CONSTANT_LIGHT "Shape \"sphere\"", 20e9,
        "crops, as --cropwindow 0,1,0,0.25 (18.3 GB), 64 parts, as --part 1/64 (13.6 GB; bis merge takes 73.1 GB)",
        false},
    {HUGE "Integrator \"brdf\"", CONSTANT_LIGHT "Shape \"sphere\"", 50e9,
        "crops, as --cropwindow 0,1,0,0.5 (36.7 GB), 16 parts, as --part 1/16 (41.1 GB; bis merge takes 73.1 GB)",
        false},
    {HUGE "Integrator \"brdf\"", CONSTANT_LIGHT "Shape \"sphere\"", 1,
        "crops, as --cropwindow 0,1,0,0.015625 (1.2 GB), 1024 parts, as --part 1/1024 (5.0 GB; bis merge takes "
        "73.1 GB)",
        false},
    /* four values of 12 bytes */
    {"Film \"rgb\" \"integer xresolution\" 32768 \"integer yresolution\" 32768 \"float cropwindow\" [0 1 0.5 1] "
     "\"string layers\" [\"albedo\" \"depth\"] Integrator \"brdf\"",
        CONSTANT_LIGHT "Shape \"sphere\"", 40e9,
        "--layers none (36.7 GB), crops, as --cropwindow 0,1,0.5,0.75 (31.2 GB), 16 parts, as --part 1/16 (35.0 "
        "GB; bis merge takes 62.3 GB)",
        false},
    /* 2^23 pixels learn 64 bytes each */
    {LARGE "Integrator \"sir\" \"string proposal\" \"product\" \"integer candidates\" 64 \"bool learn\" true", MAP,
        1e9,
        "--learn off (0.6 GB), crops, as --cropwindow 0,1,0,0.5 (0.6 GB), 16 parts, as --part 1/16 (0.6 GB; bis "
        "merge takes 0.6 GB)",
        false},
    /* 10^7 triangles: 12 bytes, and 82 of a grid or 40 of Embree; the film is nothing beside them */
    {SMALL "Accelerator \"grid\"", CONSTANT_LIGHT PLY("many"), 1e9, "--accelerator embree (0.5 GB)", true},
    {SMALL "Accelerator \"embree\"", CONSTANT_LIGHT PLY("many"), 1, "", true},
    /* a picture of 0.57 GB beside a grid: no crop and no part takes less than building the grid, 1.13 GB */
    {LARGE "Integrator \"brdf\" Accelerator \"grid\"", CONSTANT_LIGHT PLY("many"), 1e9,
        "--accelerator embree (1.1 GB), crops, as --cropwindow 0,1,0,0.015625 (1.1 GB), 1024 parts, as --part "
        "1/1024 (1.1 GB; bis merge takes 0.6 GB)",
        true},
};

/* 2^30 pixels of 68.25 bytes, 14 MB of program; while it is written 68 bytes, and for one thread three times 16 rows of
 * 32768 pixels of 16 bytes. A row of n crops has 1/n of the pixels, one of n parts 8/n + 0.06 of the film. */
static void advice_names_what_takes_less_and_how_much(void **state)
{
    const int before = use_threads(1);
    write_pfm_head(DIR "/map.pfm", 64, 32);
    write_ply_head(DIR "/many.ply", 10, 10000000);
    for (size_t i = 0; i < sizeof advised / sizeof *advised; i++) {
        char text[4096], advice[BIS_MEMORY_ADVICE];
        bis_scene_desc *d;
        bis_memory m;
        if (advised[i].needs_embree && !bis_accel_embree_version()) continue;
        snprintf(text, sizeof text, "%s\nWorldBegin\n%s\n", advised[i].before, advised[i].world);
        program_write_file(DIR "/scene.txt", text);
        assert_int_equal(bis_scene_parse(&d, DIR "/scene.txt", NULL), BIS_OK);
        assert_int_equal(bis_memory_foresee(&m, d, NULL), BIS_OK);
        assert_int_equal(bis_memory_advise(advice, &m, d, advised[i].room, NULL), BIS_OK);
        assert_string_equal(advice, advised[i].expected);
        bis_scene_desc_free(d);
    }
    use_threads(before);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(advice_names_what_takes_less_and_how_much),
        cmocka_unit_test(free_memory_is_what_the_system_says),
        cmocka_unit_test(a_large_picture_takes_what_was_foretold),
        cmocka_unit_test(a_large_map_takes_what_was_foretold),
        cmocka_unit_test(a_large_mesh_takes_what_was_foretold),
        cmocka_unit_test(textures_and_instances_take_what_was_foretold),
        cmocka_unit_test(what_does_not_fit_is_told_before),
    };
    program_folder(DIR);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
