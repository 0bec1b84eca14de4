/* SPDX-License-Identifier: BSD-2-Clause */
/* scripts/setup.sh asks the system for what an option needs, and for nothing that nobody asked for: stand-ins of the
 * package managers write down what they are told. */
#include "claim.h"
#include "program.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>

#define DIR "build/test_setup"

static char told[4096]; /* what the package manager was told by the last run */

static void write_program(const char *path, const char *body)
{
    program_write_file(path, body);
    assert_int_equal(chmod(path, 0755), 0);
}

/* Runs setup.sh as root of a system on which nothing is installed, with the options, and fills `told`. */
static int set_up(const char *path, const char *options)
{
    char command[1024];
    snprintf(command, sizeof command, "rm -f " DIR "/told && PATH=%s /bin/sh scripts/setup.sh %s > " DIR "/out 2>&1",
             path, options);
    fflush(stdout);
    const int status = system(command);
    FILE *f = fopen(DIR "/told", "r");
    told[f ? fread(told, 1, sizeof told - 1, f) : 0] = '\0';
    if (f) fclose(f);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

static bool asks_for(const char *package)
{
    char word[64];
    snprintf(word, sizeof word, " %s ", package);
    return strstr(told, word) != NULL;
}

/* Stand-ins: every package is known and none is installed. */
static void make_debian(void)
{
    program_folder(DIR);
    write_program(DIR "/id", "#!/bin/sh\necho 0\n");
    write_program(DIR "/dpkg-query", "#!/bin/sh\nexit 1\n");
    write_program(DIR "/apt-cache", "#!/bin/sh\nexit 0\n");
    write_program(DIR "/apt-get", "#!/bin/sh\necho \"$* \" >>" DIR "/told\n");
}

static void only_what_was_asked_for_is_installed(void **state)
{
    /* a package of each part, and the options that ask for it, one letter each */
    static const struct { const char *package, *by; } parts[] = {
        {"libopenexr-dev", "-mwpa"}, {"libcmocka-dev", "-mwpa"}, {"libembree-dev", "-mwpa"}, {"libopenmpi-dev", "ma"},
        {"pandoc", "wa"},            {"chromium", "wa"},         {"python3-numpy", "-mwpa"}, {"wasi-libc", "wa"},
        {"python3-venv", "pa"},
    };
    static const struct { char letter; const char *option; } runs[] = {
        {'-', ""}, {'m', "--mpi"}, {'w', "--web"}, {'p', "--python"}, {'a', "--all"}, {'a', "--mpi --web --python"},
    };
    make_debian();
    for (size_t i = 0; i < sizeof runs / sizeof *runs; i++) {
        assert_int_equal(set_up(DIR ":$PATH", runs[i].option), 0);
        for (size_t j = 0; j < sizeof parts / sizeof *parts; j++) {
            const bool is_wanted = strchr(parts[j].by, runs[i].letter);
            if (asks_for(parts[j].package) != is_wanted)
                fail_msg("setup.sh %s: %s %s", runs[i].option, is_wanted ? "lacks" : "installs", parts[j].package);
        }
    }
}

static void an_unknown_option_installs_nothing(void **state)
{
    make_debian();
    assert_int_equal(set_up(DIR ":$PATH", "--everything"), 2);
    assert_string_equal(told, "");
    assert_int_equal(system("grep -q -e '\"--everything\".* --all' " DIR "/out"), 0);
}

/* Only that the names of that system are given to its package manager; no such system was tried. */
static void fedora_and_arch_are_asked_by_their_own_names(void **state)
{
    static const struct { const char *manager, *image, *mpi; } systems[] = {
        {"dnf", "openexr-devel", "openmpi-devel"}, {"pacman", "openexr", "openmpi"},
    };
    for (int i = 0; i < 2; i++) {
        char path[64];
        program_folder(DIR);
        write_program(DIR "/id", "#!/bin/sh\necho 0\n");
        snprintf(path, sizeof path, DIR "/%s", systems[i].manager);
        write_program(path, "#!/bin/sh\necho \"$* \" >>" DIR "/told\n");
        assert_int_equal(set_up(DIR, ""), 0); /* no other folder, because apt-get may be in it */
        assert_true(asks_for(systems[i].image) && !asks_for(systems[i].mpi) && !asks_for("libopenexr-dev"));
        assert_int_equal(set_up(DIR, "--all"), 0);
        assert_true(asks_for(systems[i].image) && asks_for(systems[i].mpi));
    }
    program_folder(DIR); /* a system that has none of them */
    assert_int_equal(set_up(DIR, ""), 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(only_what_was_asked_for_is_installed),
        cmocka_unit_test(an_unknown_option_installs_nothing),
        cmocka_unit_test(fedora_and_arch_are_asked_by_their_own_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
