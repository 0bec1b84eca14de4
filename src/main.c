/* main: which command? `bis SCENE` renders. */
#include "cli.h"

#include <stdio.h>
#include <string.h>

static const struct {
    const char *name;
    int (*run)(int argc, char **argv);
    const char *help;
} commands[] = {
    {"render", bis_cmd_render, "render a scene; the word \"render\" may be left out"},
    {"trade", bis_cmd_trade, "error against time, measured for your own scene: what to use?"},
    {"compare", bis_cmd_compare, "compare two images (EXR, PFM, HDR)"},
    {"envmap", bis_cmd_envmap, "what is in a map; its levels, regions and importance as pictures"},
    {"pixel", bis_cmd_pixel, "all about one pixel: every method against the exact integral"},
    {"verify", bis_cmd_verify, "is it right? samplers, materials, integrators on your own files"},
};
enum { N_COMMANDS = sizeof commands / sizeof *commands };

static int help(void)
{
    printf("usage: bis [render] [options] SCENE\n"
           "Renders scenes in a subset of the pbrt format, lit by an environment map.\n"
           "\ncommands:\n");
    for (int i = 0; i < N_COMMANDS; i++) printf("  %-10s  %s\n", commands[i].name, commands[i].help);
    printf("\n`bis COMMAND --help` lists a command's options.\n\n");
    return BIS_EXIT_DONE;
}

static int find_command(const char *name)
{
    for (int i = 0; i < N_COMMANDS; i++) {
        if (strcmp(commands[i].name, name) == 0) return i;
    }
    return -1;
}

/* `bis help`, `bis --help`: the commands, then the options of rendering; `bis help COMMAND` as `bis COMMAND --help`. */
static int run_help(int argc, char **argv)
{
    static char option[] = "--help";
    char *arguments[] = {option};
    int command = argc > 0 ? find_command(argv[0]) : 0;

    if (command < 0) {
        fprintf(stderr, "bis: error: no command \"%s\"; `bis help` lists them\n", argv[0]);
        return BIS_EXIT_USAGE;
    }
    if (argc == 0) help();
    return commands[command].run(1, arguments);
}

int main(int argc, char **argv)
{
    if (argc < 2) {
        fprintf(stderr, "bis: error: no scene; usage: bis [render] [options] SCENE, `bis --help` tells more\n");
        return BIS_EXIT_USAGE;
    }
    if (strcmp(argv[1], "help") == 0 || strcmp(argv[1], "--help") == 0) return run_help(argc - 2, argv + 2);
    if (strcmp(argv[1], "version") == 0) {
        bis_cli_version(stdout);
        return bis_cli_finish(BIS_EXIT_DONE);
    }
    int command = find_command(argv[1]);
    if (command >= 0) return commands[command].run(argc - 2, argv + 2);
    return bis_cmd_render(argc - 1, argv + 1);
}
