/* SPDX-License-Identifier: BSD-2-Clause */
/* help: `bis help`: the commands and topics, one of them, a name that a topic explains, or the whole as a man page.
 *
 * A command's options live in a table on the stack of the command itself, beside the variables that they set. So this
 * file does not read them, but runs the command with `--help` (or `--help=man`) and nothing else: what is printed here,
 * there and in the man page cannot differ. */
#include "help.h"
#include "instrument.h"

#include "base/text.h"

#include "bis/base/file.h"

#include <ctype.h>
#include <string.h>

enum { MAX_NAMES = 512, MAX_TERM = 32 };

static const char intro[] = "bis renders scenes in a subset of the pbrt format, lit directly by an environment map. It "
                            "is the reference implementation of the thesis "
                            "\"Bidirectional Importance Sampling for Illumination from Environment Maps\": candidates "
                            "are drawn where the map or the BRDF is bright, and the "
                            "few that matter in the product of both are traced. Pictures are EXR, PNG, PFM or HDR.";

const bis_subcommand bis_subcommands[] = {
    {"render", bis_cmd_render, "render a scene; the word \"render\" may be left out"},
    {"merge", bis_cmd_merge, "one picture of the parts that `bis render --part` has made"},
    {"trade", NULL, "error against time, measured for your own scene: what to use?"},
    {"compare", bis_cmd_compare, "compare two images (EXR, PFM, HDR, PNG)"},
    {"convert", bis_cmd_convert, "a picture in another format; exposure and tone curve for a PNG"},
    {"envmap", NULL, "what is in a map; levels, regions, importance as pictures"},
    {"judge", NULL, "is a picture of another renderer right, and if not, why?"},
    {"pixel", NULL, "all about one pixel: every method against the exact integral"},
    {"verify", bis_cmd_verify, "is it right? samplers, materials, integrators on your own files"},
    {"irradiance", NULL, "how much light arrives at points"},
    {"tev", NULL, "render, and show the passes in the viewer tev"},
    {"help", bis_cmd_help, "this list; the options of a command; a topic; the man page"},
    {NULL, NULL, NULL},
};

const bis_subcommand *bis_subcommand_find(const char *name)
{
    for (const bis_subcommand *c = bis_subcommands; c->name; c++)
        if (strcmp(c->name, name) == 0) return c;
    return NULL;
}

static const bis_topic *find_topic(const char *name)
{
    for (const bis_topic *t = bis_topics; t->name; t++)
        if (strcmp(t->name, name) == 0) return t;
    return NULL;
}

static int run_help_of(const bis_subcommand *c)
{
    static char option[] = "--help";
    char *arguments[] = {option};
    return c->run ? c->run(1, arguments) : bis_instrument_print(c->name, option);
}

static void print_topic(const bis_topic *t)
{
    bis_help_page page;

    printf("%s: %s\n", t->name, t->summary);
    bool after_line = false;
    for (const bis_help_entry *e = bis_help_open(&page, t); e->term || e->text; e++) {
        const bool is_line = !e->text;
        if (!e->term || is_line != after_line) putchar('\n');
        after_line = is_line;
        if (is_line) printf("    %s\n", e->term);
        else if (e->term) bis_cli_print_entry(stdout, e->term, e->text);
        else bis_cli_print_text(stdout, e->text);
    }
}

/* The commands and topics, then the options of rendering. */
static int overview(void)
{
    printf("usage: bis [render] [options] SCENE\n");
    bis_cli_print_text(stdout, intro);
    printf("\ncommands:\n");
    for (const bis_subcommand *c = bis_subcommands; c->name; c++) printf("  %-11s  %s\n", c->name, c->help);
    printf("\ntopics:\n");
    for (const bis_topic *t = bis_topics; t->name; t++) printf("  %-11s  %s\n", t->name, t->summary);
    printf("\n`bis COMMAND --help` lists a command's options, `bis help TOPIC` explains,\n"
           "`bis help sir` looks up a name.\n\n");
    return run_help_of(&bis_subcommands[0]);
}

/* A name as it stands in the topics: "sir", "areaexponent", ".exr", "--spp". */
static bool is_of_name(char c) { return isalnum((unsigned char)c) || c == '-' || c == '_' || c == '.'; }

/* The next name in *at, its length in *n, and *at behind it; NULL: there is none. */
static const char *next_name(const char **at, size_t *n)
{
    const char *name = *at;

    while (*name && !is_of_name(*name)) name++;
    *n = 0;
    while (name[*n] && is_of_name(name[*n])) ++*n;
    *at = name + *n;
    return *n ? name : NULL;
}

/* Does an entry explain name? A row explains the directive whose heading it stands under. In a term all words are
 * names; in a text those are that a parenthesis with the default or the range follows, as in "candidates (800)". */
static bool explains(const bis_help_page *page, const bis_help_entry *e, const char *name)
{
    const char *heading = page->heading[e - page->entries];
    const size_t length = strlen(name);
    const char *found, *at;
    size_t n;

    if (!e->term || !e->text) return false;
    if (heading && strcmp(heading, name) == 0) return true;
    for (at = e->term; (found = next_name(&at, &n)) != NULL;) {
        const size_t dashes = *name == '-' ? 0 : strspn(found, "-");
        if (n - dashes == length && strncmp(found + dashes, name, length) == 0) return true;
    }
    for (at = e->text; (found = next_name(&at, &n)) != NULL;)
        if (n == length && strncmp(found, name, n) == 0 && strncmp(at, " (", 2) == 0) return true;
    return false;
}

/* `bis help sir`: what the topics say of an integrator, directive, parameter, option or layer. Returns whether they
 * do. */
static bool print_entries_of(const char *name)
{
    bis_help_page page;
    bool found = false;

    for (const bis_topic *t = bis_topics; t->name; t++) {
        bool is_first = true;
        for (const bis_help_entry *e = bis_help_open(&page, t); e->term || e->text; e++) {
            if (!explains(&page, e, name)) continue;
            if (is_first) printf("%sfrom `bis help %s`:\n\n", found ? "\n" : "", t->name);
            bis_cli_print_entry(stdout, e->term, e->text);
            is_first = false;
            found = true;
        }
    }
    return found;
}

static int unknown(const char *name)
{
    static char words[MAX_NAMES][MAX_TERM];
    bis_help_page page;
    char hint[BIS_HINT];
    const char *names[MAX_NAMES];
    size_t n = 0, n_words = 0, length;

    for (const bis_subcommand *c = bis_subcommands; c->name && n < MAX_NAMES; c++) names[n++] = c->name;
    for (const bis_topic *t = bis_topics; t->name && n < MAX_NAMES; t++) names[n++] = t->name;
    const size_t n_own = n;
    for (const bis_topic *t = bis_topics; t->name && n < MAX_NAMES; t++) {
        for (const bis_help_entry *e = bis_help_open(&page, t); e->term || e->text; e++) {
            if (!e->term || !e->text) continue;
            const char *found;
            for (const char *at = e->term; n < MAX_NAMES && (found = next_name(&at, &length)) != NULL;) {
                const size_t dashes = *name == '-' ? 0 : strspn(found, "-");
                snprintf(words[n_words], MAX_TERM, "%.*s", (int)(length - dashes), found + dashes);
                names[n++] = words[n_words++];
            }
        }
    }
    /* "integrator" is nearer to the directive Integrator than to the topic, but who asks for help wants the topic. */
    const char *near = bis_nearest_name(name, names, n_own);
    if (!near) near = bis_nearest_name(name, names, n);
    fprintf(stderr, "bis: error: no command, topic or name \"%s\"%s; `bis help` lists commands and topics\n", name,
            bis_hint(hint, near));
    return BIS_EXIT_USAGE;
}

int bis_cmd_help(int argc, char **argv)
{
    bool man = false;
    const bis_option options[] = {
        {.help = "options"},
        {.name = "man", .help = "print all of it as a page for man(1)", .kind = BIS_OPTION_FLAG, .value = &man},
    };
    const bis_command command = {
        .name = "help",
        .usage = "help [COMMAND | TOPIC | NAME]",
        .summary = "what the commands and topics are; the options of a command; a topic; what an integrator, "
            "parameter or directive is",
        .options = options, .n_options = sizeof options / sizeof *options,
        .max_operands = 1,
        .notes = "`make install` installs the page: `man bis`. Without: bis help --man | man -l -\n",
    };
    const char *operand[1];
    int n, exit_status;

    if (!bis_cli_parse(&command, argc, argv, operand, &n, &exit_status)) return exit_status;
    if (man) return bis_man_page(bis_subcommands, intro);
    if (n == 0) return overview();
    const bis_subcommand *c = bis_subcommand_find(operand[0]);
    if (c) return run_help_of(c);
    const bis_topic *t = find_topic(operand[0]);
    if (t) print_topic(t);
    else if (!print_entries_of(operand[0])) return unknown(operand[0]);
    return bis_cli_finish(BIS_EXIT_DONE);
}
