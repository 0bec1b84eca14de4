/* SPDX-License-Identifier: BSD-2-Clause */
/* few_pixels: a map of few pixels has few clusters, and the default is as good under it as candidates that are drawn
 * for each point alone. It had 36 times their squared error under a map of one pixel, because all points of a pass
 * shared 64 directions, of which few met a lobe. */
#include "claim.h"
#include "program.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DIR "build/test_few_pixels"

static void write_map(int width, int height)
{
    FILE *f = fopen(DIR "/map.pfm", "wb");

    assert_non_null(f);
    fprintf(f, "PF\n%d %d\n-1.0\n", width, height);
    for (int i = 0; i < 3 * width * height; i++) {
        const float radiance = 0.2f + 1.8f * (float)(i * 37 % 64) / 63; /* no order, nothing dark */
        fwrite(&radiance, sizeof radiance, 1, f);
    }
    assert_int_equal(fclose(f), 0);
}

static void write_scene(void)
{
    program_write_file(DIR "/scene.txt",
                       "Film \"rgb\" \"integer xresolution\" 48 \"integer yresolution\" 36\n"
                       "LookAt 0 -6 2.2  0 0 0.4  0 0 1\nCamera \"perspective\" \"float fov\" 36\nWorldBegin\n"
                       "LightSource \"infinite\" \"string filename\" \"map.pfm\" \"bool visible\" false\n"
                       "Material \"phong\" \"rgb Kd\" [.4 .4 .4] \"rgb Ks\" [.4 .4 .4] \"float exponent\" 50\n"
                       "Shape \"disk\" \"float radius\" 5\nTranslate 0 0 1\nShape \"sphere\"\n");
}

/* Twice the mean relative variance of a pixel: two renders with seeds of their own, compared with each other. */
static double scatter(const char *options)
{
    program_run run;

    for (int seed = 1; seed <= 2; seed++)
        program_expect(
            &run, 0, DIR "/scene.txt --quiet --spp 8 --seed %d --outfile " DIR "/%d.pfm %s", seed, seed, options);
    program_expect(&run, 0, "compare " DIR "/1.pfm " DIR "/2.pfm");
    const char *relmse = strstr(run.output, "relmse ");
    assert_non_null(relmse);
    return strtod(relmse + strlen("relmse "), NULL);
}

#define COUNTS " --candidates 64 --shadowrays 24"

/* The ratio is between 0.8 and 1 at all sizes here, and known to a tenth, because there are 1700 pixels. */
static const double most = 1.3;

static void the_default_is_as_good_as_mix(void **state)
{
    static const int sizes[][2] = {{1, 1}, {2, 1}, {4, 2}, {8, 4}, {16, 8}};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        write_map(sizes[i][0], sizes[i][1]);
        const double ratio = scatter("") / scatter("--integrator sir --proposal mix --learn off" COUNTS);
        if (ratio > most)
            fail_msg("%d x %d: squared error of the default over that of mix: %g", sizes[i][0], sizes[i][1], ratio);
    }
}

/* The twin: candidates from the map alone, as the default had them under one pixel. */
static void candidates_that_do_not_meet_the_lobe_are_found(void **state)
{
    write_map(1, 1);
    assert_true(scatter("--integrator sir --proposal em --learn off" COUNTS) >
                most * scatter("--integrator sir --proposal mix --learn off" COUNTS));
}

static int set_up(void **state)
{
    program_folder(DIR);
    write_scene();
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_default_is_as_good_as_mix),
        cmocka_unit_test(candidates_that_do_not_meet_the_lobe_are_found),
    };

    return cmocka_run_group_tests(tests, set_up, NULL);
}
