/* SPDX-License-Identifier: BSD-2-Clause */
/* main: which command? `bis SCENE` renders. */
#include "cli.h"
#include "help.h"
#include "instrument.h"

#include "bis/base/mem.h"
#include "render/ranks.h"

#include <string.h>
#include <unistd.h>

/* `bis rendr scene.txt`: a word that is no file but nearly a command. NULL: it may be a scene. */
static const char *nearest_command(const char *word)
{
    enum { MOST_COMMANDS = 16 };
    const char *names[MOST_COMMANDS];
    size_t n = 0;

    if (word[0] == '-' || access(word, F_OK) == 0) return NULL;
    for (const bis_subcommand *c = bis_subcommands; c->name && n < MOST_COMMANDS; c++) names[n++] = c->name;
    return bis_nearest_name(word, names, n);
}

static int run(int argc, char **argv)
{
    signal(SIGXFSZ, SIG_IGN); /* where files are limited in size, writing fails with a message instead of killing */
    if (argc < 2) {
        fprintf(stderr, "bis: error: no scene; usage: bis [render] [options] SCENE, `bis --help` tells more\n");
        return BIS_EXIT_USAGE;
    }
    const bis_subcommand *command = bis_subcommand_find(argv[1]);
    if (!bis_rank_leads(bis_cli_ranks) && command && command->run != bis_cmd_render)
        return BIS_EXIT_DONE; /* only renders are shared */
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0) return bis_cmd_help(argc - 2, argv + 2);
    if (strcmp(argv[1], "version") == 0) {
        bis_cli_version(stdout);
        return bis_cli_finish(BIS_EXIT_DONE);
    }
    if (command && command->run) return command->run(argc - 2, argv + 2);
    const char *near = nearest_command(argv[1]);
    if (near) {
        fprintf(stderr, "bis: error: no command and no scene \"%s\" (did you mean \"bis %s\"?); `bis help` lists "
                        "the commands\n", argv[1], near);
        return BIS_EXIT_USAGE;
    }
    return bis_cmd_render(argc - 1, argv + 1);
}

/* A word that is an instrument, known or somebody's own, is run before ranks are opened, because it is another program.
 * -1: it is none. */
static int run_instrument(int argc, char **argv)
{
    if (argc < 2 || argv[1][0] == '-') return -1;
    const bis_subcommand *command = bis_subcommand_find(argv[1]);
    if (command ? command->run != NULL : access(argv[1], F_OK) == 0) return -1;
    if (!bis_instrument_leads()) return command ? BIS_EXIT_DONE : -1;
    const int status = bis_instrument_run(argv[1], argv + 1);
    if (status >= 0 || !command) return status;
    fprintf(stderr, "bis: error: the program bis-%s is not there: install bis anew, with Python 3\n", argv[1]);
    return BIS_EXIT_USAGE;
}

int main(int argc, char **argv)
{
    /* A line that is printed in pieces leaves in one write, because mpirun may lose one of many (Open MPI 5). */
    setvbuf(stderr, NULL, _IOLBF, BUFSIZ);
    const int of_instrument = run_instrument(argc, argv);

    if (of_instrument >= 0) return of_instrument;
    bis_cli_ranks_open(&argc, &argv);
    const int status = run(argc, argv);
    bis_cli_ranks_close();

    /* A mistake of ours, which harms nobody now: it is said, not aborted for, because the picture is safe. */
    if (bis_mem_live() != 0)
        fprintf(stderr, "bis: error in bis itself: %ld blocks of memory were not freed; please report it\n",
                bis_mem_live());
    return status;
}
