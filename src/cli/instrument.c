/* SPDX-License-Identifier: BSD-2-Clause */
/* instrument: see the header. An instrument measures what this program is: a student's material is in both, or the
 * figures would silently be those of another build. So the library is looked for where make and install.sh put it
 * beside this very program, and nowhere else. */
#include "instrument.h"

#include "bis/base/version.h"
#include "bis/flat/flat.h"
#include "cli.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#ifndef BIS_BUILD_FOLDER /* make says which one */
#define BIS_BUILD_FOLDER "build/release"
#endif

/* From the folder of the program. */
static const char *const programs[] = {"", "libexec/bis/", "../libexec/bis/", "scripts/python/",
                                       "../../scripts/python/"};
static const char *const libraries[] = {"library/libbis.so." BIS_VERSION,
                                        BIS_BUILD_FOLDER "/library/libbis.so." BIS_VERSION,
                                        "../libexec/bis/python/bis/libbis.so", "../libbis.so"};

/* The path of the program and, in *n, the length of its folder with the slash; NULL: /proc is missing. */
static const char *find_self(char path[PATH_MAX], int *n)
{
    const ssize_t got = readlink("/proc/self/exe", path, PATH_MAX - 1);

    if (got <= 0) return NULL;
    path[got] = '\0';
    *n = (int)(strrchr(path, '/') + 1 - path);
    return path;
}

static void name_library(const char *self, int n)
{
    char path[2 * PATH_MAX];

    setenv("BIS_PROGRAM", self, 1);
    for (size_t i = 0; i < sizeof libraries / sizeof *libraries; i++) {
        snprintf(path, sizeof path, "%.*s%s", n, self, libraries[i]);
        if (access(path, R_OK) != 0) continue;
        setenv("BIS_LIBRARY", path, 1);
        return;
    }
    snprintf(path, sizeof path, "%.*s%s", n, self, libraries[0]); /* where it is missing: another one would be ours */
    setenv("BIS_LIBRARY", path, 1);
}

/* Becomes the program at path. Returns where it is not there. */
static void become(const char *path, char **argv)
{
    if (access(path, X_OK) == 0) execv(path, argv);
}

int bis_instrument_run(const char *name, char **argv)
{
    char self[PATH_MAX], path[2 * PATH_MAX], program[NAME_MAX + 1];
    int n;

    if (strlen(name) > NAME_MAX - 4 || strchr(name, '/')) return -1;
    snprintf(program, sizeof program, "bis-%s", name);
    char *const before = argv[0];
    argv[0] = program;
    setenv("BIS_BUILD_ID", bis_flat_build(), 1);
    if (find_self(self, &n)) {
        name_library(self, n);
        for (size_t i = 0; i < sizeof programs / sizeof *programs; i++) {
            snprintf(path, sizeof path, "%.*s%s%s", n, self, programs[i], program);
            become(path, argv);
        }
    }
    execvp(program, argv);
    argv[0] = before;
    if (errno == ENOENT || errno == EACCES) return -1;
    fprintf(stderr, "bis: error: \"%s\" cannot be run: %s\n", program, strerror(errno));
    return BIS_EXIT_FAILED;
}

int bis_instrument_print(const char *name, const char *option)
{
    char word[32];
    char *argv[] = {NULL, word, NULL};
    int state;

    snprintf(word, sizeof word, "%s", option);
    fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
        const int status = bis_instrument_run(name, argv);
        if (status < 0) fprintf(stderr, "bis: error: the program bis-%s is not there: install bis anew\n", name);
        _exit(status < 0 ? BIS_EXIT_FAILED : status);
    }
    if (child < 0 || waitpid(child, &state, 0) != child) {
        fprintf(stderr, "bis: error: bis-%s cannot be run: %s\n", name, strerror(errno));
        return BIS_EXIT_FAILED;
    }
    return WIFEXITED(state) ? WEXITSTATUS(state) : BIS_EXIT_FAILED;
}

bool bis_instrument_leads(void)
{
    static const char *const names[] = {"OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK"};

    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const char *rank = getenv(names[i]);
        if (rank && strcmp(rank, "0") != 0) return false;
    }
    return true;
}
