/* SPDX-License-Identifier: BSD-2-Clause */
/* The memory that --plan foretells, beside what the program then takes (peak_memory_bytes of --stats): within 15 %. */
#include "bis/base/mem.h"
#include "claim.h"
#include "lack.h"
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

/* Two passes: a film of one pass has no half, and its pages are not touched. */
static double megabytes_taken(const char *options)
{
    program_run run;
    program_expect(&run, 0, "--quiet --stats - --spp 2 --outfile " DIR "/out.pfm %s " DIR "/scene.txt", options);
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

static void assert_foretold(const char *options)
{
    need_no_sanitizer();
    const double foretold = megabytes_foretold(options), taken = megabytes_taken(options);
    if (!(foretold > 0.85 * taken && foretold < 1.15 * taken))
        fail_msg("%s: %.1f MB were foretold, %.1f MB were taken", options, foretold, taken);
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
    assert_foretold("--integrator brdf --samples 1");
    assert_foretold("--integrator brdf --samples 1 --layers albedo,normal");
    write_scene("\"rgb L\" [1 1 1]", "\"sphere\"", 12000, 160);
    assert_foretold("--integrator brdf --samples 1 --nthreads 5 --outfile " DIR "/out.exr");
}

static void a_large_map_takes_what_was_foretold(void **state)
{
    write_map(3000, 1500);
    write_scene("\"string filename\" \"map.pfm\"", "\"sphere\"", 40, 30);
    assert_foretold("--integrator brdf --samples 1");
    assert_foretold("--integrator mis --samples 2");
    assert_foretold("--integrator sir");
    write_scene("\"string filename\" \"map.pfm\"", "\"sphere\"", 1000, 1000);
    assert_foretold("--candidates 16 --shadowrays 1");
}

static void a_large_mesh_takes_what_was_foretold(void **state)
{
    write_hill(900);
    write_scene("\"rgb L\" [1 1 1]", "\"plymesh\" \"string filename\" \"hill.ply\"", 40, 30);
    assert_foretold("--integrator brdf --samples 1 --accelerator grid");
    assert_foretold("--integrator brdf --samples 1");
    write_scene("\"rgb L\" [1 1 1]", "\"plymesh\" \"string filename\" \"hill.ply\" \"bool smooth\" true", 40, 30);
    assert_foretold("--integrator brdf --samples 1");
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

static bis_memory foreseen(const char *before, const char *world)
{
    char text[4096];
    bis_scene_desc *d;
    bis_diag diag = {0};
    bis_memory m;
    snprintf(text, sizeof text, "%s\nWorldBegin\n%s\n", before, world);
    program_write_file(DIR "/scene.txt", text);
    if (bis_scene_parse(&d, DIR "/scene.txt", &diag)) fail_msg("%s", diag.messages[0].text);
    bis_diag_clear(&diag);
    assert_int_equal(bis_memory_foresee(&m, d, NULL), BIS_OK);
    bis_scene_desc_free(d);
    return m;
}

static void assert_bytes(double found, double expected)
{
    if (!(fabs(found - expected) <= 1e-9 * expected)) fail_msg("%.10g bytes, must be %.10g", found, expected);
}

#define SHOW(texture) " Material \"diffuse\" \"texture reflectance\" \"" texture "\" Shape \"sphere\" "
#define CONSTANT_LIGHT "LightSource \"infinite\" "
#define PLY(name) "Shape \"plymesh\" \"string filename\" \"" name ".ply\" "
#define SMALL "Film \"rgb\" \"integer xresolution\" 10 \"integer yresolution\" 10 Integrator \"brdf\" "

/* A vertex: 12 bytes, 24 with a normal, 8 more with (u, v); a triangle: 12. Three shapes of a, two of the smooth b, one
 * of c, none of d; of the meshes with several shapes the largest is kept beside. Each triangle: 82 bytes of tree. */
static void meshes_take_their_arrays_for_each_shape(void **state)
{
    write_ply_head(DIR "/a.ply", 1000, 2000);
    write_ply_head(DIR "/b.ply", 500, 700);
    write_ply_head(DIR "/c.ply", 9000, 9001);
    write_ply_head(DIR "/d.ply", 77777, 77777);
    static const char shapes[] = CONSTANT_LIGHT PLY("c") "Shape \"sphere\" ObjectBegin \"o\" " PLY(
        "a") "Shape \"plymesh\" \"string filename\" \"b.ply\" \"bool smooth\" true "
             "Shape \"disk\" ObjectEnd ObjectBegin \"none\" " PLY(
                 "d") "ObjectEnd ObjectInstance \"o\" ObjectInstance \"o\" " PLY("a");
    char with_texture[2048];
    const double a = 1000 * 12 + 2000 * 12, b = 500 * 24 + 700 * 12, c = 9000 * 12 + 9001 * 12;
    const double triangles = 3 * 2000 + 2 * 700 + 9001;
    bis_memory m = foreseen(SMALL, shapes);
    assert_bytes(m.meshes, 3 * a + 2 * b + c + a);
    assert_bytes(m.accel, 82 * triangles);
    assert_false(m.guessed);
    assert_bytes(m.textures, 0);
    /* while the tree is built it takes 100 bytes, and the film of 100 pixels nothing yet */
    assert_bytes(m.peak, 14e6 + m.meshes + 100 * triangles);
    write_pfm_head(DIR "/t.pfm", 30, 20);
    snprintf(with_texture, sizeof with_texture,
        "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"t.pfm\" Material \"diffuse\" \"texture "
        "reflectance\" \"t\" %s",
        shapes);
    m = foreseen(SMALL, with_texture);
    assert_bytes(m.meshes, 3 * a + 2 * b + c + a + 8 * (4 * 1000 + 2 * 500 + 9000));
    assert_bytes(m.textures, 12 * 30 * 20);
    /* a mesh of the scene itself; a small one beside a larger one that has one shape only */
    m = foreseen(SMALL, CONSTANT_LIGHT "ObjectBegin \"o\" Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 "
                                       "0] \"integer indices\" [0 1 2 2 1 3] ObjectEnd "
                                       "ObjectInstance \"o\" ObjectInstance \"o\" " PLY("a"));
    assert_bytes(m.meshes, 2 * (4 * 12 + 2 * 12) + a + (4 * 12 + 2 * 12));
    m = foreseen(SMALL, CONSTANT_LIGHT "Shape \"sphere\" Shape \"disk\"");
    assert_true(m.meshes == 0 && m.accel == 0);
}

/* An OBJ does not tell: 100 bytes of the file are a vertex, and 50 a triangle. */
static void a_file_that_tells_nothing_is_guessed_by_its_length(void **state)
{
    char text[10001];
    memset(text, '#', 10000);
    text[10000] = '\0';
    program_write_file(DIR "/o.obj", text);
    bis_memory m = foreseen(SMALL, CONSTANT_LIGHT "Shape \"objmesh\" \"string filename\" \"o.obj\"");
    assert_bytes(m.meshes, 100 * 12 + 200 * 12);
    assert_bytes(m.accel, 200 * 82);
    assert_true(m.guessed);
    program_write_file(DIR "/o.ply", text);
    m = foreseen(SMALL, CONSTANT_LIGHT PLY("o"));
    assert_bytes(m.meshes, 100 * 12 + 200 * 12);
    assert_true(m.guessed);
    program_write_file(DIR "/odd.pfm", text); /* a map: four bytes a pixel, each of which becomes 12 */
    m = foreseen(SMALL, "LightSource \"infinite\" \"string filename\" \"odd.pfm\"");
    assert_bytes(m.map, 2500 * 12);
    assert_true(m.guessed);
    m = foreseen(
        SMALL, CONSTANT_LIGHT "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"odd.pfm\"" SHOW("t"));
    assert_true(m.textures == 0 && m.guessed);
}

static void every_texture_file_that_a_shape_shows_counts_once(void **state)
{
    write_pfm_head(DIR "/t.pfm", 30, 20);
    write_pfm_head(DIR "/u.pfm", 7, 5);
    write_pfm_head(DIR "/v.pfm", 11, 9);
    const bis_memory m =
        foreseen(SMALL, CONSTANT_LIGHT "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"t.pfm\" "
                                       "Texture \"again\" \"float\" \"imagemap\" \"string filename\" \"t.pfm\" Texture "
                                       "\"u\" \"spectrum\" \"imagemap\" \"string filename\" \"u.pfm\" "
                                       "Texture \"v\" \"spectrum\" \"imagemap\" \"string filename\" \"v.pfm\" "
                                       "Texture \"c\" \"spectrum\" \"checkerboard\"" SHOW("t") SHOW("again") SHOW("u")
                                           SHOW("c")); /* nothing shows v */
    assert_bytes(m.textures, 12 * (30 * 20 + 7 * 5));
    assert_false(m.guessed);
    /* by whatever path; another encoding makes another image */
    const bis_memory n = foreseen(SMALL,
        CONSTANT_LIGHT "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"t.pfm\" "
                       "Texture \"again\" \"float\" \"imagemap\" \"string filename\" \".././test_memory/t.pfm\" "
                       "Texture \"other\" \"float\" \"imagemap\" \"string filename\" \"./t.pfm\" \"string encoding\" "
                       "\"gamma 3\"" SHOW("t") SHOW("again") SHOW("other"));
    assert_bytes(n.textures, 2 * 12 * 30 * 20);
}

/* A PNG of n bytes in all that says it is w x h. */
static void write_png_head(const char *path, unsigned w, unsigned h, size_t n)
{
    unsigned char head[4096] = "\x89PNG\r\n\x1a\n\0\0\0\rIHDR";
    FILE *f = fopen(path, "wb");
    for (int i = 0; i < 4; i++) {
        head[16 + i] = (unsigned char)(w >> (24 - 8 * i));
        head[20 + i] = (unsigned char)(h >> (24 - 8 * i));
    }
    assert_true(f && n <= sizeof head && fwrite(head, 1, n, f) == n && fclose(f) == 0);
}

/* 100 bytes of deflate are 100 x 1032 x 8 = 825600 pixels at most, and a side is at most 32768. */
static void a_claim_that_no_file_can_keep_takes_nothing(void **state)
{
    static const struct { unsigned width, height; size_t bytes; bool possible; } cases[] = {
        {1000000, 1000000, 100, false}, {800, 1032, 100, true}, {800, 1033, 100, false}, {32768, 25, 100, true},
        {25, 32768, 100, true},
        {32769, 25, 4000, false}, {25, 32769, 4000, false}, {32768, 1000, 4000, true},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        write_png_head(DIR "/claim.png", cases[i].width, cases[i].height, cases[i].bytes);
        const bis_memory m = foreseen(SMALL,
            CONSTANT_LIGHT "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"claim.png\"" SHOW("t"));
        assert_bytes(m.textures, cases[i].possible ? 12.0 * cases[i].width * cases[i].height : 0);
        assert_true(m.guessed == !cases[i].possible);
    }
    write_pfm_head(DIR "/claim.pfm", 32768, 2);
    assert_bytes(foreseen(SMALL, "LightSource \"infinite\" \"string filename\" \"claim.pfm\"").map, 12.0 * 32768 * 2);
    write_pfm_head(DIR "/claim.pfm", 32770, 2);
    assert_true(foreseen(SMALL, "LightSource \"infinite\" \"string filename\" \"claim.pfm\"").map < 1000);
}

/* 52 bytes of sums, 16 1/4 of a pass, 12 for each value of a layer: eight and four. Visibility that is learned: 64. */
static void a_film_takes_its_pixels_in_the_crop(void **state)
{
#define LEARNS "\"sir\" \"string proposal\" \"product\" \"integer candidates\" 64 \"bool learn\" true"
    static const struct { const char *film, *integrator; double pixels, a_pixel; } cases[] = {
        {"\"integer xresolution\" 400 \"integer yresolution\" 300", "\"brdf\"", 120000, 52 + 16.25},
        {"\"integer xresolution\" 400 \"integer yresolution\" 300 \"float cropwindow\" [0.25 0.75 0 0.5]", "\"brdf\"",
         200 * 150, 52 + 16.25},
        {"\"integer xresolution\" 40 \"integer yresolution\" 30 \"string layers\" [\"albedo\" \"depth\"]", "\"brdf\"",
         1200, 52 + 16.25 + 4 * 12},
        {"\"integer xresolution\" 40 \"integer yresolution\" 30 \"string layers\" \"all\"", "\"brdf\"", 1200,
         52 + 16.25 + 15 * 12},
        {"\"integer xresolution\" 40 \"integer yresolution\" 30 \"string layers\" [\"stderr\" \"visibility\"]",
         "\"brdf\"", 1200, 52 + 16.25 + 2 * 12},
        {"\"integer xresolution\" 40 \"integer yresolution\" 30", LEARNS, 1200, 52 + 16.25 + 64},
        {"\"integer xresolution\" 40 \"integer yresolution\" 30",
         "\"sir\" \"string proposal\" \"product\" \"integer candidates\" 64 \"bool learn\" false", 1200, 52 + 16.25},
        {"\"integer xresolution\" 4096 \"integer yresolution\" 2048", LEARNS, 8388608, 52 + 16.25 + 64},
         /* 2^23 pixels have cells, */
        {"\"integer xresolution\" 4096 \"integer yresolution\" 2049", LEARNS, 4096 * 2049, 52 + 16.25 + 4},
         /* more have tiles, */
        {"\"integer xresolution\" 4096 \"integer yresolution\" 4096 \"float cropwindow\" [0 0.125 0 0.125]", LEARNS,
         512 * 512, 52 + 16.25 + 4}, /* in a part, too */
    };
    write_pfm_head(DIR "/map.pfm", 64, 32);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char before[512];
        snprintf(before, sizeof before, "Film \"rgb\" %s Integrator %s", cases[i].film, cases[i].integrator);
        bis_memory m = foreseen(before, "LightSource \"infinite\" \"string filename\" \"map.pfm\" Shape \"sphere\"");
        const bool learns = strstr(cases[i].integrator, "true") != NULL;
        /* 2 KB for each square of tiles of the whole picture, a third as many as tiles */
        const double whole = strstr(cases[i].film, "4096 \"float") ? 4096 * 4096 : cases[i].pixels,
                     squares = learns ? whole * 2048 / (3 * 256) : 0;
        assert_bytes(m.film, cases[i].pixels * cases[i].a_pixel + squares);
        if (cases[i].pixels > 1e6) assert_bytes(m.peak, 14e6 + m.film + m.map);
        m = foreseen(
            before, CONSTANT_LIGHT "Shape \"sphere\""); /* nothing is learned of a constant, or without a surface */
        const double learned = learns ? (cases[i].a_pixel == 52 + 16.25 + 4 ? 4 : 64) : 0;
        assert_bytes(m.film, cases[i].pixels * (cases[i].a_pixel - learned));
        m = foreseen(before, "LightSource \"infinite\" \"string filename\" \"map.pfm\"");
        assert_bytes(m.film, cases[i].pixels * (cases[i].a_pixel - learned));
    }
}

/* 16 bytes a pixel of the picture are in the place of the pass and of what was learned; each thread holds three times
 * 16 rows of it, if there are as many: nine times that at 144 rows, ten at 145. Albedo and depth: 8 + 4 bytes for each
 * of their four values. */
static void a_picture_takes_a_chunk_for_each_thread_while_it_is_written(void **state)
{
    static const struct { int width, height, threads; const char *layers; double pixel, writers; } cases[] = {
        {30000, 144, 32, "", 16, 9}, {30000, 145, 32, "", 16, 10}, {30000, 145, 5, "", 16, 5},
        {30000, 144, 7, "[\"albedo\" \"depth\"]", 16 + 4 * 4, 7}};
    const int before = use_threads(1);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char film[256];
        const double sums = 52 + 8 * (cases[i].pixel - 16) / 4, pixels = 30000.0 * cases[i].height;
        snprintf(film, sizeof film,
            "Film \"rgb\" \"integer xresolution\" %d \"integer yresolution\" %d %s%s Integrator \"brdf\"",
            cases[i].width, cases[i].height, *cases[i].layers ? "\"string layers\" " : "", cases[i].layers);
        use_threads(cases[i].threads);
        const bis_memory m = foreseen(film, CONSTANT_LIGHT "Shape \"sphere\"");
        assert_bytes(
            m.peak, 14e6 + pixels * (sums + cases[i].pixel) + cases[i].writers * 3 * 16 * 30000 * cases[i].pixel);
        assert_bytes(m.film, pixels * (sums + cases[i].pixel + 0.25));
    }
    use_threads(before);
}

/* 12 bytes a pixel; 14.4 for the table that directions are drawn with, 5.5 for the curve; one more while it is made.
 * The 5 bytes while regions are found are less than each. */
static void a_map_takes_what_its_integrator_needs(void **state)
{
    static const struct { const char *integrator; double a_pixel, beside; } cases[] = {
        {"\"brdf\"", 12, 0}, {"\"em\" \"bool stratify\" false", 12 + 14.4, 0},
        {"\"em\" \"bool stratify\" true", 12 + 5.5, 1},
        {"\"sir\" \"bool stratify\" false", 12 + 14.4, 0}, {"\"mis\" \"bool stratify\" true", 12 + 5.5, 1}};
    write_pfm_head(DIR "/map.pfm", 2048, 1024);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char before[256];
        snprintf(before, sizeof before,
            "Film \"rgb\" \"integer xresolution\" 1 \"integer yresolution\" 1 Integrator %s", cases[i].integrator);
        bis_memory m = foreseen(before, "LightSource \"infinite\" \"string filename\" \"map.pfm\" Shape \"sphere\"");
        assert_bytes(m.map, 2048 * 1024 * cases[i].a_pixel);
        /* one pixel's film is not written to while the curve is made; and its pass, or the head of the file, or a chunk
         */
        const double least = 14e6 + m.map + (cases[i].beside > 0 ? 0 : 64) + 2048 * 1024 * cases[i].beside;
        if (!(m.peak >= least && m.peak <= least + 100 + 3 * 16 * 16))
            fail_msg("%s: %.10g bytes at the peak", cases[i].integrator, m.peak);
        m = foreseen(before,
            "LightSource \"infinite\" \"string filename\" \"map.pfm\""); /* nothing is drawn without a surface */
        assert_bytes(m.map, 2048 * 1024 * 12);
    }
    const bis_memory m = foreseen(SMALL, CONSTANT_LIGHT);
    assert_true(m.map == 0);
}

/* The file stands beside the map while it is read, 12 bytes a pixel and its head, "PF\n64 32\n-1.0\n" of 14: all of it
 * beside the pixels alone, 5.5 less beside a curve, and nothing beside a table, which is larger. */
static void a_file_stands_beside_its_map_while_it_is_read(void **state)
{
    static const struct { const char *integrator; double a_pixel, beside; } cases[] = {
        {"\"brdf\"", 12, 64 * 32 * 12 + 14}, {"\"em\" \"bool stratify\" true", 12 + 5.5, 64 * 32 * (12 - 5.5) + 14},
        {"\"em\" \"bool stratify\" false", 12 + 14.4, 0}};
    write_map(64, 32);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char before[256];
        snprintf(before, sizeof before,
            "Film \"rgb\" \"integer xresolution\" 1 \"integer yresolution\" 1 Integrator %s", cases[i].integrator);
        const bis_memory m =
            foreseen(before, "LightSource \"infinite\" \"string filename\" \"map.pfm\" Shape \"sphere\"");
        assert_bytes(m.map, 64 * 32 * cases[i].a_pixel);
        assert_bytes(m.before, 14e6 + m.map + cases[i].beside);
        /* a pixel's film is written with a chunk of 16 rows, three times, of 16 bytes, for each thread that has one */
        assert_bytes(m.peak, fmax(m.before, 14e6 + m.map + 52 + 16 + 3 * 16 * 16));
        assert_bytes(m.merged, 14e6 + 52 + 16 + 3 * 16 * 16);
    }
}

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

/* A probe becomes a map of the width that the scene names, made even, or of the usual one. */
static void a_probe_has_the_size_of_the_map_that_it_becomes(void **state)
{
    static const struct { const char *light; long width, height; bis_mapping mapping; } cases[] = {
        {"\"string mapping\" \"angular\" \"integer width\" 100", 100, 50, BIS_MAPPING_ANGULAR},
        {"\"string mapping\" \"angular\" \"integer width\" 101", 102, 51, BIS_MAPPING_ANGULAR},
        {"\"string mapping\" \"equalarea\" \"integer width\" 64", 64, 32, BIS_MAPPING_EQUALAREA},
        {"\"string mapping\" \"latlong\"", 60, 60, BIS_MAPPING_LATLONG},
        {"\"integer width\" 64", 64, 32, BIS_MAPPING_EQUALAREA}};
    write_pfm_head(DIR "/probe.pfm", 60, 60);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char world[256];
        snprintf(world, sizeof world, "LightSource \"infinite\" \"string filename\" \"probe.pfm\" %s", cases[i].light);
        const bis_memory m = foreseen(SMALL, world);
        assert_bytes(m.map, 12.0 * (double)(cases[i].width * cases[i].height));
        bis_scene_desc *d;
        long width = 0, height = 0;
        bis_mapping mapping;
        assert_int_equal(bis_scene_parse(&d, DIR "/scene.txt", NULL), BIS_OK);
        assert_true(bis_memory_map_size(&d->light, &width, &height, &mapping));
        assert_true(width == cases[i].width && height == cases[i].height && mapping == cases[i].mapping);
        bis_scene_desc_free(d);
    }
    /* a square is no cross of 4 x 3 faces, of which none can be made */
    const bis_light_desc cross = {.filename = (char[]){DIR "/probe.pfm"}, .has_mapping = true,
                                  .mapping = BIS_MAPPING_HORIZONTAL_CROSS};
    long width = 0, height = 0;
    bis_mapping mapping;
    assert_false(bis_memory_map_size(&cross, &width, &height, &mapping));
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
        FOR_LACK(l) {
            LACK(l, bis_memory_advise(advice, &m, d, advised[i].room, NULL));
            assert_int_equal(l.status == BIS_OK, l.over);
        }
        bis_scene_desc_free(d);
    }
    use_threads(before);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(meshes_take_their_arrays_for_each_shape),
        cmocka_unit_test(a_file_that_tells_nothing_is_guessed_by_its_length),
        cmocka_unit_test(every_texture_file_that_a_shape_shows_counts_once),
        cmocka_unit_test(a_claim_that_no_file_can_keep_takes_nothing),
        cmocka_unit_test(a_film_takes_its_pixels_in_the_crop),
        cmocka_unit_test(advice_names_what_takes_less_and_how_much),
        cmocka_unit_test(a_picture_takes_a_chunk_for_each_thread_while_it_is_written),
        cmocka_unit_test(a_map_takes_what_its_integrator_needs),
        cmocka_unit_test(a_file_stands_beside_its_map_while_it_is_read),
        cmocka_unit_test(free_memory_is_what_the_system_says),
        cmocka_unit_test(a_probe_has_the_size_of_the_map_that_it_becomes),
        cmocka_unit_test(a_large_picture_takes_what_was_foretold),
        cmocka_unit_test(a_large_map_takes_what_was_foretold),
        cmocka_unit_test(a_large_mesh_takes_what_was_foretold),
        cmocka_unit_test(what_does_not_fit_is_told_before),
    };
    program_folder(DIR);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
