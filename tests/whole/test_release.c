/* SPDX-License-Identifier: BSD-2-Clause */
/* What a release promises of its files: one version, and a licence in every source file. (`make release` builds, tests
 * and installs the tarball.) */
#include "claim.h"
#include "program.h"

#include <stdio.h>
#include <stdlib.h>

#define DIR "build/test_release"

static void all_files_name_one_version(void **state)
{
    assert_int_equal(system("sh scripts/check/check_release.sh"), 0);
}

/* The twins: a copy of the files in which one has another version. */
static void another_version_is_found(void **state)
{
    static const char *const edits[] = {
        "s/^version: 0/version: 1/' " DIR "/CITATION.cff",
        "s/\"version\": \"0/\"version\": \"1/' " DIR "/codemeta.json",
        "s/^## 0/## 1/' " DIR "/CHANGELOG.md",
        "s/^bis (0/bis (1/' " DIR "/scripts/debian/changelog",
        "s/^Package: libbis0/Package: libbis1/' " DIR "/scripts/debian/control",
        "0,/^Section:/s/^Section:.*/&\\n&/' " DIR "/scripts/debian/control",
        "s/VERSION \"0/VERSION \"1/' " DIR "/include/bis/base/version.h",
    };
    for (size_t i = 0; i < sizeof edits / sizeof *edits; i++) {
        char command[256];
        program_folder(DIR);
        assert_int_equal(system("cp --parents CITATION.cff codemeta.json CHANGELOG.md scripts/debian/changelog "
                                "scripts/debian/control include/bis/base/version.h " DIR), 0);
        assert_int_equal(system("sh scripts/check/check_release.sh " DIR), 0);
        snprintf(command, sizeof command, "sed -i '%s", edits[i]);
        assert_int_equal(system(command), 0);
        assert_int_not_equal(system("sh scripts/check/check_release.sh " DIR), 0);
    }
}

static void every_source_file_names_its_licence(void **state)
{
    assert_int_equal(system("sh scripts/check/spdx.sh --check"), 0);
}

/* The twins: files of each kind without the line are named; then it is written, once, and the rest stays as it is. */
static void a_file_without_a_licence_is_found_and_mended(void **state)
{
    program_folder(DIR);
    assert_int_equal(system("mkdir -p " DIR "/src " DIR "/scripts"), 0);
    program_write_file(DIR "/src/a.c", "int a;\n");
    program_write_file(DIR "/src/page.html", "<!DOCTYPE html>\n<p>\n");
    program_write_file(DIR "/src/page.js", "draw();\n");
    program_write_file(DIR "/src/scene.txt", "Sampler\n");
    program_write_file(DIR "/scripts/run", "#!/bin/sh\necho a\n");
    program_write_file(DIR "/want", "/* SPDX-License-Identifier: BSD-2-Clause */\nint a;\n"
                                    "<!DOCTYPE html>\n<!-- SPDX-License-Identifier: BSD-2-Clause -->\n<p>\n"
                                    "/* SPDX-License-Identifier: BSD-2-Clause */\ndraw();\nSampler\n"
                                    "#!/bin/sh\n# SPDX-License-Identifier: BSD-2-Clause\necho a\n");
    assert_int_not_equal(system("sh scripts/check/spdx.sh --check " DIR), 0);
    for (int time = 0; time < 2; time++) {
        assert_int_equal(system("sh scripts/check/spdx.sh " DIR), 0);
        assert_int_equal(system("cd " DIR " && cat src/a.c src/page.html src/page.js src/scene.txt scripts/run | "
                                "cmp - want"), 0);
    }
    assert_int_equal(system("sh scripts/check/spdx.sh --check " DIR), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_files_name_one_version),
        cmocka_unit_test(another_version_is_found),
        cmocka_unit_test(every_source_file_names_its_licence),
        cmocka_unit_test(a_file_without_a_licence_is_found_and_mended),
    };

    return cmocka_run_group_tests_name("release", tests, NULL, NULL);
}
