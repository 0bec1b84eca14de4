/* SPDX-License-Identifier: BSD-2-Clause */
/* What a release promises of its files: one version, and a licence in every source file. (`make release` builds, tests
 * and installs the tarball.) */
#include "claim.h"

#include <stdlib.h>

static void all_files_name_one_version(void **state)
{
    assert_int_equal(system("sh scripts/check/check_release.sh"), 0);
}

static void every_source_file_names_its_licence(void **state)
{
    assert_int_equal(system("sh scripts/check/spdx.sh --check"), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_files_name_one_version),
        cmocka_unit_test(every_source_file_names_its_licence),
    };

    return cmocka_run_group_tests_name("release", tests, NULL, NULL);
}
