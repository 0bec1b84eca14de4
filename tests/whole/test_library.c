/* SPDX-License-Identifier: BSD-2-Clause */
/* library: what `make install` installs is enough for a stranger's program. The example of docs/library.md is compiled
 * against installed files and run; the mean that it must print is that of the picture of the program `bis`, or known in
 * closed form. */
#include "bis/base/image.h"
#include "bis/files/image_file.h"
#include "claim.h"
#include "program.h"

#include <stdio.h>
#include <stdlib.h>

#define DIR "build/test_library"

static bool is_run_by_make(void)
{
    if (getenv("BIS_LINK")) return true;
    print_message("run by make test, which tells how to compile\n");
    return false;
}

static int check(const char *before, double mean)
{
    char command[512];
    snprintf(command, sizeof command, "%s sh scripts/check/check_library.sh " DIR "/scene.txt %.9g", before, mean);
    return system(command);
}

/* The mean of all channels of the picture that the program makes. */
static double mean_of_program(void)
{
    program_run r;
    bis_image image;
    double sum = 0;

    program_expect(&r, 0, DIR "/scene.txt --resolution 240x160 --outfile " DIR "/picture.pfm"); /* as the example */
    assert_int_equal(bis_image_read(&image, DIR "/picture.pfm", (bis_loc){0}, NULL), BIS_OK);
    const int n = image.width * image.height;
    for (int i = 0; i < n; i++) sum += rgb_sum(image.pixels[i]);
    bis_image_clear(&image);
    return sum / (3.0 * n);
}

static void the_example_of_the_page_works_with_what_is_installed(void **state)
{
    if (!is_run_by_make()) skip();
    program_folder(DIR);
    program_write_scene(DIR, "");
    assert_int_equal(check("", mean_of_program()), 0);
}

/* The twins: a sampler that is wrong by a hundredth, another mean, a line too many. */
static void a_page_with_a_wrong_program_is_found(void **state)
{
    if (!is_run_by_make()) skip();
    program_folder(DIR);
    program_write_scene(DIR, "");
    assert_int_equal(system("sed 's|mean += Le|mean += 1.01 * Le|' "
                            "docs/library.md >" DIR "/page.md"), 0);
    assert_int_not_equal(check("LIBRARY_PAGE=" DIR "/page.md", mean_of_program()), 0);
    assert_int_not_equal(check("", 1.5 * mean_of_program()), 0);
    assert_int_equal(system("sed 's|^    if (argc != 3) return 2;|&\\n|' docs/library.md >" DIR "/page.md"), 0);
    assert_int_not_equal(check("LIBRARY_PAGE=" DIR "/page.md", mean_of_program()), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_example_of_the_page_works_with_what_is_installed),
        cmocka_unit_test(a_page_with_a_wrong_program_is_found),
    };

    return cmocka_run_group_tests_name("library", tests, NULL, NULL);
}
