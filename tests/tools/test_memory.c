/* The memory that --plan foretells, beside what the program then takes (peak_memory_bytes of --stats): within 15 %. */
#include "program.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

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
    fprintf(out, "ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n"
            "element face %d\nproperty list uchar int vertex_indices\nend_header\n", n * n, 2 * (n - 1) * (n - 1));
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

static double megabytes_taken(const char *options)
{
    program_run run;
    program_expect(&run, 0, "--quiet --stats - --spp 1 --outfile " DIR "/out.pfm %s " DIR "/scene.txt", options);
    return number_after(run.output, "\"peak_memory_bytes\": ") / 1e6;
}

static void assert_foretold(const char *options)
{
    const double foretold = megabytes_foretold(options), taken = megabytes_taken(options);
    if (!(foretold > 0.85 * taken && foretold < 1.15 * taken))
        fail_msg("%s: %.1f MB were foretold, %.1f MB were taken", options, foretold, taken);
}

static void write_scene(const char *light, const char *shape, int width, int height)
{
    char text[1024];
    snprintf(text, sizeof text, "LookAt 0 -6 2  0 0 0  0 0 1\nCamera \"perspective\"\n"
             "Film \"rgb\" \"integer xresolution\" %d \"integer yresolution\" %d\nWorldBegin\nLightSource \"infinite\" %s\n"
             "Material \"phong\"\nShape %s\n", width, height, light, shape);
    program_write_file(DIR "/scene.txt", text);
}

static void a_large_picture_takes_what_was_foretold(void **state)
{
    (void)state;
    write_scene("\"rgb L\" [1 1 1]", "\"sphere\"", 1800, 1200);
    assert_foretold("--integrator brdf --samples 1");
    assert_foretold("--integrator brdf --samples 1 --layers albedo,normal");
}

static void a_large_map_takes_what_was_foretold(void **state)
{
    (void)state;
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
    (void)state;
    write_hill(900);
    write_scene("\"rgb L\" [1 1 1]", "\"plymesh\" \"string filename\" \"hill.ply\"", 40, 30);
    assert_foretold("--integrator brdf --samples 1 --accelerator grid");
    assert_foretold("--integrator brdf --samples 1");
    write_scene("\"rgb L\" [1 1 1]", "\"plymesh\" \"string filename\" \"hill.ply\" \"bool smooth\" true", 40, 30);
    assert_foretold("--integrator brdf --samples 1");
}

/* A picture of 77 GB: the plan tells so, and the render warns before it fails, here because it may have 8 GB alone. */
static void what_does_not_fit_is_told_before(void **state)
{
    (void)state;
    program_run run;
    write_scene("\"rgb L\" [1 1 1]", "\"sphere\"", 32768, 32768);
    assert_true(fabs(megabytes_foretold("--integrator brdf") / (32768.0 * 32768 * 72.125 / 1e6) - 1) < 0.01);
    assert_true(system("ulimit -v 8000000; ${BIS_PROGRAM:-build/release/bis} --integrator brdf --spp 1 --outfile " DIR "/out.pfm "
                       DIR "/scene.txt 2>" DIR "/messages") != 0);
    assert_int_equal(system("grep -q 'warning: this render takes about 77.5 GB, but .* GB of memory are free.*--cropwindow' " DIR "/messages"), 0);
    assert_int_equal(system("grep -q 'error: no memory' " DIR "/messages"), 0);
    program_expect(&run, 0, "--integrator brdf --samples 1 --spp 1 --resolution 60x60 --outfile " DIR "/out.pfm " DIR "/scene.txt");
    assert_null(strstr(run.messages, "this render takes"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_large_picture_takes_what_was_foretold),
        cmocka_unit_test(a_large_map_takes_what_was_foretold),
        cmocka_unit_test(a_large_mesh_takes_what_was_foretold),
        cmocka_unit_test(what_does_not_fit_is_told_before),
    };
    program_folder(DIR);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
