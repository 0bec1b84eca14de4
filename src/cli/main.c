/* main: which command? `bis SCENE` renders. */
#include "help.h"

#include "bis/base/mem.h"

#include <stdio.h>
#include <string.h>

static int run(int argc, char **argv)
{
    if (argc < 2) {
        fprintf(stderr, "bis: error: no scene; usage: bis [render] [options] SCENE, `bis --help` tells more\n");
        return BIS_EXIT_USAGE;
    }
    if (strcmp(argv[1], "--help") == 0) return bis_cmd_help(argc - 2, argv + 2);
    if (strcmp(argv[1], "version") == 0) {
        bis_cli_version(stdout);
        return bis_cli_finish(BIS_EXIT_DONE);
    }
    const bis_subcommand *command = bis_subcommand_find(argv[1]);
    if (command) return command->run(argc - 2, argv + 2);
    return bis_cmd_render(argc - 1, argv + 1);
}

int main(int argc, char **argv)
{
    const int status = run(argc, argv);

    /* A mistake of ours, which harms nobody now: it is said, not aborted for, because the picture is safe. */
    if (bis_mem_live() != 0) {
        fprintf(stderr, "bis: error in bis itself: %ld blocks of memory were not freed; please report it\n",
                bis_mem_live());
    }
    return status;
}
