/* SPDX-License-Identifier: BSD-2-Clause */
/* cli: what the commands share: options from a table, `--help` made from the same table, diagnostics out, exit
 * statuses.
 * For src/cli/main.c and src/cli/cmd_*.c alone; with json.h the only part of bis that prints.
 *
 * A command describes itself by one bis_command on its stack, whose options point to where their values go:
 *
 *     uint64_t spp = 0;
 *     const bis_option options[] = {
 *         {.name = "spp", .argument = "N", .help = "camera samples in a pixel", .kind = BIS_OPTION_COUNT, .value =
 *         &spp, .lo = 1, .hi = 1e9},
 *     };
 *     const bis_command command = {.name = "render", .usage = "[render] [options] SCENE", .summary = "render a scene",
 *                                  .options = options, .n_options = 1, .min_operands = 1, .max_operands = 1};
 *     const char *operand[1];
 *     int n, exit_status;
 *     if (!bis_cli_parse(&command, argc, argv, operand, &n, &exit_status)) return exit_status; */
#pragma once

#include "bis/render/render.h"
#include "bis/scene/light_load.h"

#include <signal.h>
#include <stdint.h>
#include <stdio.h>

/* Exit statuses, `bis help output`. */
enum { BIS_EXIT_DONE = 0, BIS_EXIT_FAILED = 1, BIS_EXIT_USAGE = 2, BIS_EXIT_INTERRUPTED = 130 };

typedef enum bis_option_kind {
    BIS_OPTION_FLAG,  /* bool: set to true */
    BIS_OPTION_TEXT,  /* const char *: borrowed from argv, not empty */
    BIS_OPTION_LIST,  /* bis_texts: the option may be repeated */
    BIS_OPTION_COUNT, /* uint64_t: an integer in [lo, hi] */
    BIS_OPTION_REAL,  /* double: finite, in [lo, hi]; a number in (0, hi] where `above` */
    BIS_OPTION_SHARE, /* double: like REAL, or in percent: "5%" is 0.05. A plain number above 1: a warning asks */
    BIS_OPTION_SECONDS, /* double: like REAL, or with a unit: "10s", "2min", "1.5h" */
    BIS_OPTION_NAME,  /* const char *: one of names, ended by NULL; the entry of names, not of argv */
    BIS_OPTION_OWN    /* whatever: `read` reads it */
} bis_option_kind;

#define BIS_MAX_TEXTS 64

typedef struct bis_texts {
    const char *text[BIS_MAX_TEXTS];
    int n;
} bis_texts;

typedef struct bis_option {
    const char *name;     /* without "--"; NULL: a heading in the help, its text in `help` */
    const char *argument; /* "N", shown in the help; NULL for a flag */
    const char *help;     /* a phrase; wrapped to 80 columns */
    bis_option_kind kind;
    void *value;
    bool *given;          /* may be NULL: set to true where the option stands on the command line */
    double lo, hi;
    bool above;           /* REAL, SHARE, SECONDS: lo itself is out of range */
    const char *const *names;
    /* OWN: false for a text that is no value; `rule` says what one looks like. NAME: `rule` ends the
     * message of a wrong name; may be NULL. */
    bool (*read)(void *value, const char *text);
    const char *rule;
} bis_option;

enum { BIS_CLI_TERM = 128 };

/* bis_cli_term writes "--spp N". */
static inline const char *bis_cli_term(char term[BIS_CLI_TERM], const bis_option *o)
{
    snprintf(term, BIS_CLI_TERM, "--%s%s%s", o->name, o->argument ? " " : "", o->argument ? o->argument : "");
    return term;
}

typedef struct bis_command {
    const char *name;    /* "render" */
    const char *usage;   /* after "bis ": "[render] [options] SCENE" */
    const char *summary; /* one line */
    const bis_option *options;
    size_t n_options;
    int min_operands, max_operands;
    const char *notes;   /* further text of the help, wrapped by hand; may be NULL */
} bis_command;

/* bis_cli_parse reads argv[0..argc-1], which stands behind the command's name. What is no option goes to
 * operands[max_operands], n_operands of them. Options and operands may be mixed, "--name=value" is "--name value", "--"
 * ends the options, "-" is an operand or a value. All mistakes are reported, not only the first; but after an unknown
 * option no operand is one too many, because it may be that option's value. `-h` is `--help`, `-V` is `--version`.
 * Returns false if the command is over with *exit_status: `--help` and `--version` were answered, or the usage was bad
 * and a message printed. */
bool bis_cli_parse(const bis_command *c, int argc, char **argv, const char **operands, int *n_operands,
                   int *exit_status);

enum { BIS_CLI_MAX_OPERANDS = 3 };
typedef int bis_cli_body(void *options, const char *const *operands, bis_diag *diag);

/* bis_cli_run takes a command from its arguments to its exit status: it parses, runs the body (exit status out), prints
 * its messages and finishes. `options` is what the table of options writes to. There are at most BIS_CLI_MAX_OPERANDS
 * operands; NULL: it is not given. */
int bis_cli_run(const bis_command *c, int argc, char **argv, bis_cli_body *body, void *options);

/* bis_cli_digits reads an integer in [lo, hi] of digits alone; returns what follows, NULL where there is none.
 * bis_cli_read_size is the `read` of an option "640x480", whose value is int[2] and whose rule is BIS_SIZE_RULE. */
const char *bis_cli_digits(const char *text, int lo, int hi, int *value);
bool bis_cli_read_size(void *value, const char *text);
#define BIS_SIZE_RULE "WxH with sides in [1, 32768], as in 640x480"

/* bis_cli_help prints the help of one command, at most 80 columns wide. The next two print what it consists of: a
 * paragraph, and a term with its text. `--help=man` prints the same as a part of the man page (help.h). */
void bis_cli_help(const bis_command *c, FILE *out);
void bis_cli_print_text(FILE *out, const char *text);
void bis_cli_print_entry(FILE *out, const char *term, const char *text);

/* bis_cli_version prints what `--version` says: bis, the accelerators that are built in, the libraries. */
void bis_cli_version(FILE *out);

/* bis_cli_print_diag prints the messages to standard error, without warnings if quiet. */
void bis_cli_print_diag(const bis_diag *diag, bool quiet);

/* bis_cli_exit_status returns the exit status of an error in scenes and usage: 2 for input, 1 for disk and memory. */
int bis_cli_exit_status(bis_status status);

/* bis_cli_finish flushes standard output. It returns status, or 1 with a message if the output could not be written
 * (`bis --help > /dev/full`). */
int bis_cli_finish(int status);

/* The place of complaints about the command line: they start with "bis: error: ". */
extern const bis_loc bis_cli_loc;

/* bis_cli_check_writable checks whether a file can be made at path: its folder, behind all links, must exist and be
 * writable, path must not be a folder, and its name not too long. It stands before hours of rendering; the write itself
 * is checked again. Errors: BIS_INPUT, BIS_IO. */
bis_status bis_cli_check_writable(const char *path, bis_diag *diag);

/* bis_cli_check_distinct refuses, before any work, an output that is one of the inputs or another output, because what
 * it holds would be lost. A pipe, a device or "-" may stand for several. Errors: BIS_INPUT. */
bis_status bis_cli_check_distinct(const char *const *inputs, size_t n_inputs, const char *const *outputs,
                                  size_t n_outputs, bis_diag *diag);

/* bis_cli_load_map makes a light of the map at path, by `mapping` (NULL: not given) and what else is in *desc. It
 * returns the exit status: a map that cannot be read, be it missing or damaged, is 1; one that does not fit the options
 * is bad usage. */
int bis_cli_load_map(bis_light **light, bis_light_desc *desc, const char *path, const char *mapping, unsigned needs,
                     bis_diag *diag);

/* For the help of a command that parses by the function below. */
#define BIS_CLI_SCENE_NOTE \
    "SCENE is a file, or - for standard input. The files that such a scene names are\n" \
    "looked for in the working directory.\n"

/* bis_cli_parse_scene parses the scene that an operand names: a file, or "-" for standard input, of which one process
 * has all, and messages say "<stdin>". `how` is as for bis_scene_parse_as. Errors: those of bis_scene_parse, BIS_INPUT
 * (a NUL in standard input, several ranks). */
bis_status bis_cli_parse_scene(bis_scene_desc **out, const char *operand, unsigned how, bis_diag *diag);

/* bis_cli_use_threads sets (--nthreads) that from now on n threads work wherever nobody says how many, as for the
 * tables of a map. 0: as many as there are. */
void bis_cli_use_threads(uint64_t n);

/* Set by the first SIGINT, SIGTERM or SIGHUP after bis_cli_catch_signals; render threads read it. */
extern volatile sig_atomic_t bis_cli_signal;

/* bis_cli_catch_signals lets those signals set bis_cli_signal. The second one of a kind finds the default action again,
 * and kills. */
void bis_cli_catch_signals(void);

/* The ranks that this process belongs to; NULL: it is alone. */
extern bis_ranks *bis_cli_ranks;

/* bis_cli_ranks_open finds the ranks, first of all in main, and on ranks other than 0 lets standard output and standard
 * error go nowhere. bis_cli_ranks_close leaves them. */
void bis_cli_ranks_open(int *argc, char ***argv);
void bis_cli_ranks_close(void);

/* bis_cmd_render and the others are the commands: they take the arguments behind the command's name and return the exit
 * status. */
int bis_cmd_render(int argc, char **argv);
int bis_cmd_compare(int argc, char **argv);
int bis_cmd_convert(int argc, char **argv);
int bis_cmd_verify(int argc, char **argv);
int bis_cmd_merge(int argc, char **argv);
