/* SPDX-License-Identifier: BSD-2-Clause */
/* help: what `bis help`, `bis help TOPIC` and the man page say. The commands tell their options themselves (cli.h);
 * topics are tables of terms and texts. Both are written once, and printed as text of 80 columns or as troff. For
 * main.c and help*.c. */
#pragma once

#include "parameters.h"

typedef struct bis_subcommand {
    const char *name;
    int (*run)(int argc, char **argv); /* NULL: an instrument (instrument.h) */
    const char *help; /* one line */
} bis_subcommand;

/* One of a topic's entries. A term with a text explains it, a text alone is a paragraph, a term alone a line as one
 * would type it. */
typedef struct bis_help_entry {
    const char *term, *text;
} bis_help_entry;

/* A term that begins so, as in BIS_HELP_PAGE "Camera", stands for all rows under a heading of docs/scene-format.md. */
#define BIS_HELP_PAGE "### "

/* A term that begins so, as in BIS_HELP_OPTION "spp", stands for that option of rendering, as its own help has it. */
#define BIS_HELP_OPTION "--"

/* bis_render_option returns an option of rendering as an entry; `term` holds its term. The option must be there, and
 * its help a literal: those that name layers, integrators or parameters are not. */
bis_help_entry bis_render_option(char term[BIS_CLI_TERM], const char *name);

/* A row of a table of docs/scene-format.md. */
typedef struct bis_help_row {
    const char *heading; /* NULL ends the list */
    bis_help_entry entry;
} bis_help_row;

/* All rows, in the order of the page: src/cli/help_scene.awk makes them when bis is built. */
extern const bis_help_row bis_help_rows[];

typedef struct bis_topic {
    const char *name, *summary;
    const bis_help_entry *entries; /* ended by two NULLs */
} bis_topic;

/* All of them, in the order of the man page; each list is ended by a NULL name. The first command renders. */
extern const bis_subcommand bis_subcommands[];
extern const bis_topic bis_topics[];

/* A topic's entries with those of the program and of the page in place. */
enum { BIS_HELP_ENTRIES = 96 };
typedef struct bis_help_page {
    bis_help_entry entries[BIS_HELP_ENTRIES + 1]; /* ended by two NULLs */
    const char *heading[BIS_HELP_ENTRIES];        /* that a row stands under; NULL: no row */
    char text[BIS_HELP_ENTRIES][BIS_INTEGRATOR_WORDS];
} bis_help_page;

/* bis_help_open fills the page with t's entries and returns the first. */
const bis_help_entry *bis_help_open(bis_help_page *page, const bis_topic *t);

/* bis_subcommand_find returns the command with this name, or NULL. */
const bis_subcommand *bis_subcommand_find(const char *name);

/* bis_cmd_help answers `bis help`, `bis help COMMAND`, `bis help TOPIC`, `bis help NAME` and `bis help --man`. */
int bis_cmd_help(int argc, char **argv);

/* bis_man_page prints the whole page for man(1): the intro, the commands (ended by a NULL name), the topics. It returns
 * the exit status. */
int bis_man_page(const bis_subcommand *commands, const char *intro);
