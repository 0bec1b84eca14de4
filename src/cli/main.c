/* main: which command? `bis SCENE` renders. */
#include "help.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>

int main(int argc, char **argv)
{
    signal(SIGXFSZ, SIG_IGN); /* where files are limited in size, writing fails with a message instead of killing */
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
