/* SPDX-License-Identifier: BSD-2-Clause */
/* help: nothing that the program knows is missing in its help, and the man page is the same help.
 *
 * What must be there comes from elsewhere: the program's own lists of integrators and layers, the tables of
 * docs/scene-format.md, the options that each command prints. That the search can find something missing is tested on a
 * page with a parameter that nobody has. */
#include "bis/thesis/integrator.h"
#include "bis/scene/layers.h"
#include "cli/help.h"

#include "claim.h"
#include "expect.h"
#include "file_help.h"
#include "program.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define DIR "build/test_help"

static bool is_word_char(char c) { return isalnum((unsigned char)c) || c == '-' || c == '_'; }

static bool has_word(const char *text, const char *word, size_t n)
{
    for (const char *at = text; (at = strstr(at, word)) != NULL; at++) {
        if ((at == text || !is_word_char(at[-1])) && !is_word_char(at[n])) return true;
    }
    return false;
}

/* The names of a section's tables that are not in text: cells `"name"` at the start of a row, `float name` anywhere.
 * Returns the number of names. */
static int look_for_names(const char *text, const char *page, const char *section, int *n_missing)
{
    static const char *const types[] = {
        "`integer ", "`float ", "`string ", "`bool ", "`rgb ", "`point3 ", "`normal ", "| `\"", ", `\""};
    const char *start = strstr(page, section);
    int n = 0;

    assert_non_null(start);
    const char *end = strstr(start + strlen(section), "\n##");
    for (const char *row = start; row && row < end; row = strchr(row + 1, '\n')) {
        if (strncmp(row, "\n| ", 3) != 0) continue;
        const char *row_end = strchr(row + 1, '\n');
        for (size_t i = 0; i < sizeof types / sizeof *types; i++) {
            for (const char *at = strstr(row, types[i]); at && at < row_end; at = strstr(at + 1, types[i])) {
                char name[64];
                const char *from = at + strlen(types[i]);
                size_t length = strcspn(from, "`\"");
                assert_true(length < sizeof name);
                snprintf(name, sizeof name, "%.*s", (int)length, from);
                n++;
                if (has_word(text, name, length)) continue;
                print_message("%s: no \"%s\" in its topic, src/cli/help_scene.awk\n", section, name);
                ++*n_missing;
            }
        }
    }
    return n;
}

static char *read_page(const char *path)
{
    static char text[1 << 17];
    read_text(text, sizeof text, path);
    return text;
}

static const char *help_of(program_run *r, const char *topic)
{
    program_expect(r, 0, "help %s", topic);
    assert_string_equal(r->messages, "");
    return r->output;
}

/* ---- what must be there ---- */

static void every_name_of_the_scene_format_is_in_its_topic(void **state)
{
    const struct { const char *section, *topic, *and_topic; int at_least; } cases[] = {
        {"\n### Camera\n", "scene", NULL, 4}, {"\n### Film\n", "scene", "output", 5},
        {"\n### Sampler\n", "scene", NULL, 8},
        {"\n### Shape\n", "scene", NULL, 10}, {"\n### Integrator\n", "integrators", NULL, 20},
        {"\n### Material\n", "materials", NULL, 9}, {"\n### Texture\n", "textures", NULL, 9},
        {"\n### LightSource\n", "lights", NULL, 9},
    };
    const char *page = read_page("docs/scene-format.md");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        program_run r;
        static char text[1 << 16];
        int n_missing = 0;
        snprintf(text, sizeof text, "%s", help_of(&r, cases[i].topic));
        if (cases[i].and_topic) strncat(text, help_of(&r, cases[i].and_topic), sizeof text - 1 - strlen(text));
        int n = look_for_names(text, page, cases[i].section, &n_missing);
        if (n < cases[i].at_least) fail_msg("%s: only %d names found", cases[i].section, n);
        assert_int_equal(n_missing, 0);
    }
}

/* The twin. */
static void a_name_that_the_topic_lacks_is_found(void **state)
{
    const char page[] = "\n### Film\n\n| a | b |\n| --- | --- |\n| `\"rgb\"` | `float fov` (1), `string nonsense` "
                        "|\n\n## Next\n| `bool after` |\n";
    int n_missing = 0;
    assert_int_equal(look_for_names("rgb fov rgbd", page, "\n### Film\n", &n_missing), 3);
    assert_int_equal(n_missing, 1);
    n_missing = 0;
    assert_int_equal(look_for_names("rgb fovea nonsense", page, "\n### Film\n", &n_missing), 3);
    assert_int_equal(n_missing, 1);
}

static void every_integrator_and_every_layer_is_in_its_topic(void **state)
{
    program_run r;
    char term[64];
    help_of(&r, "integrators");
    for (int i = 0; bis_integrators[i]; i++) {
        snprintf(term, sizeof term, "\n  %s ", bis_integrators[i]->name);
        if (!strstr(r.output, term))
            fail_msg("bis help integrators has no %s: src/cli/help_topics.c", bis_integrators[i]->name);
    }
    help_of(&r, "render");
    char *at = strstr(r.output, "  --integrator NAME "), *end = at ? strstr(at + 1, "\n  --") : NULL;
    assert_non_null(end);
    *end = '\0';
    for (int i = 0; bis_integrators[i]; i++) {
        const size_t n = (size_t)snprintf(term, sizeof term, "%s", bis_integrators[i]->name);
        if (!has_word(at, term, n)) fail_msg("--integrator does not tell %s", term);
    }
    help_of(&r, "output");
    for (int i = 0; i < BIS_N_LAYERS; i++) {
        const char *name = bis_layer_name((bis_layer)i);
        if (!has_word(r.output, name, strlen(name))) fail_msg("no layer %s", name);
    }
}

static void assert_80_columns(const char *what, const char *text)
{
    for (const char *line = text; *line;) {
        size_t n = strcspn(line, "\n");
        if (n > 80) fail_msg("%s: \"%.*s\" has %zu columns", what, (int)n, line, n);
        line += n + (line[n] == '\n');
    }
}

static void the_overview_names_every_command_and_topic(void **state)
{
    program_run r, again;
    char term[64];
    program_expect(&r, 0, "help");
    program_expect(&again, 0, "--help");
    assert_string_equal(r.output, again.output);
    assert_80_columns("help", r.output);
    assert_ptr_equal(strstr(r.output, "usage: bis [render] [options] SCENE\n"), r.output);
    for (const bis_subcommand *c = bis_subcommands; c->name; c++) {
        snprintf(term, sizeof term, "\n  %-11s  %s\n", c->name, c->help);
        assert_non_null(strstr(r.output, term));
    }
    for (const bis_topic *t = bis_topics; t->name; t++) {
        snprintf(term, sizeof term, "\n  %-11s  %s\n", t->name, t->summary);
        assert_non_null(strstr(r.output, term));
    }
}

static void every_topic_and_command_fits_80_columns(void **state)
{
    program_run r, by_option;
    for (const bis_topic *t = bis_topics; t->name; t++) assert_80_columns(t->name, help_of(&r, t->name));
    for (const bis_subcommand *c = bis_subcommands; c->name; c++) {
        assert_80_columns(c->name, help_of(&r, c->name));
        program_expect(&by_option, 0, "%s --help", c->name);
        assert_string_equal(r.output, by_option.output);
    }
}

/* `bis help sir`: the entry of the topic, word for word, and none of its neighbours. Each name of a term:
 * tests/cli/test_options.c. */
static void a_name_is_looked_up_in_all_topics(void **state)
{
    const struct { const char *name, *has, *lacks; } cases[] = {
        {"sir", "from `bis help integrators`:\n\n  sir  ", "\n  rejection "},
        {"shadowrays", "\n  rejection ", "\n  em "},
        {"Shape", "from `bis help scene`:\n\n  Shape  ", "\n  Camera "},
        {"Camera", "\n  float fov  ", "\n  Film "},
        {"areaexponent", "from `bis help lights`:\n\n  float areaexponent  ", "\n  integer levels "},
        {"exponent", "from `bis help materials`:\n\n  phong  ", "areaexponent"},
        {"spp", "\n  --spp N", "\n  --time"},
        {".exr", "\n  .exr ", "\n  .png"},
        {"stderr", "\n  stderr, interval", "albedo"},
    };
    program_run r;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        help_of(&r, cases[i].name);
        const char *name = cases[i].name, *has = cases[i].has, *lacks = cases[i].lacks;
        if (!strstr(r.output, has)) fail_msg("bis help %s: no \"%s\" in: %s", name, has, r.output);
        if (strstr(r.output, lacks)) fail_msg("bis help %s: \"%s\" in: %s", name, lacks, r.output);
        assert_80_columns(cases[i].name, r.output);
    }
}

/* ---- the man page ---- */

/* Troff's escapes undone, as far as terms have them. */
static void unescape(char *text)
{
    char *to = text;
    for (const char *from = text; *from; from++) {
        if (from[0] == '\\' && from[1] == '&') {
            from++;
            continue;
        }
        if (from[0] == '\\' && from[1] == '-') from++;
        *to++ = *from;
    }
    *to = '\0';
}

static void every_command_and_option_is_in_the_man_page(void **state)
{
    static program_run man, r;
    char term[128];
    int n = 0;
    program_expect(&man, 0, "help --man");
    assert_string_equal(man.messages, "");
    assert_true(strlen(man.output) + 1 < sizeof man.output);
    unescape(man.output);
    const char *description = strstr(man.output, "\n.SH DESCRIPTION\n"),
               *commands = strstr(man.output, "\n.SH COMMANDS\n");
    assert_true(description && commands && description < commands);
    for (const bis_subcommand *c = bis_subcommands; c->name; c++) {
        snprintf(term, sizeof term, "\n.TP\n\\fB%s\\fR\n", c->name);
        const char *entry = strstr(description, term);
        if (!entry || entry > commands) fail_msg("man page: the description does not name %s", c->name);
        const char *first = entry + strlen(term); /* the help's first word follows */
        if (strncmp(first, c->help, strcspn(c->help, " ")) != 0) fail_msg("man page: %s: %.40s", c->name, first);
        char heading[64];
        snprintf(heading, sizeof heading, "\n.SS bis %s ", c == bis_subcommands ? "[render]" : c->name);
        help_of(&r, c->name);
        for (const char *at = r.output; (at = strstr(at, "\n  --")) != NULL; at++, n++) {
            snprintf(term, sizeof term, "\n\\fB--%.*s", (int)strcspn(at + 5, " \n"), at + 5);
            const char *part = strstr(man.output, heading);
            if (!part) fail_msg("no part of the man page for %s", c->name);
            const char *found = strstr(part, term), *next = strstr(part + 1, "\n.S");
            if (!found || found > next) fail_msg("man page: bis %s: no%s", c->name, term);
        }
    }
    assert_true(n > 50);
}

/* The lines of an example stand together: a paragraph begins before the first and after the last, none between. Notes
 * of a command begin one where they have an empty line. A term begins its own. */
static void lines_of_an_example_are_one_paragraph_of_the_man_page(void **state)
{
    static program_run man;
    static const struct {
        const char *before, *lines[8], *after;
    } blocks[] = {
        {"that says so.\n.PP\n",
         {"Camera \"perspective\" \"float fov\" 45", "Sampler \"sobol\" \"integer pixelsamples\" 64",
          "Integrator \"sir\" \"integer candidates\" 256", "WorldBegin",
          "LightSource \"infinite\" \"string filename\" \"map.exr\"",
          "Material \"phong\" \"rgb Kd\" [0.1 0.1 0.2] \"float Ks\" 0.6",
          "Shape \"plymesh\" \"string filename\" \"dragon.ply\""}, ".PP\n"},
        {"the second:\n.PP\n",
         {"Sampler \"sobol\" \"integer pixelsamples\" 16 \"integer seed\" 0",
          "  \"integer edgesamples\" 8 \"float edgelight\" 0.25",
          "Integrator \"sir\" \"string proposal\" \"product\" \"integer candidates\" 64",
          "  \"integer shadowrays\" 24 \"bool learn\" true"}, ".PP\n"},
        {"not finite\n.PP\nPrinted: mean_a mean_b bias bias_se rmse relmse max_abs pixels nonfinite.\n",
         {"  bias     mean_a - mean_b",
          "  bias_se  standard deviation of the pixels\\(aq differences / sqrt(pixels)",
          "  relmse   mean of (a-b)\\(ha2 / (b\\(ha2 + m\\(ha2/100) over pixels and channels,",
          "           m the mean of b"}, "Pixels with a NaN"},
    };

    program_expect(&man, 0, "help --man");
    unescape(man.output);
    for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++) {
        char wanted[2048];
        int n = snprintf(wanted, sizeof wanted, "%s", blocks[i].before);
        for (const char *const *line = blocks[i].lines; *line; line++)
            n += snprintf(wanted + n, sizeof wanted - (size_t)n, ".nf\n%s\n.fi\n", *line);
        snprintf(wanted + n, sizeof wanted - (size_t)n, "%s", blocks[i].after);
        if (!strstr(man.output, wanted)) fail_msg("not in the man page:\n%s", wanted);
    }
    assert_null(strstr(man.output, ".PP\n.TP\n"));
}

static void the_man_page_is_formatted_without_a_warning_in_80_columns(void **state)
{
    program_run r;
    if (system("groff -man -Tascii /dev/null > /dev/null 2>&1") != 0) {
        print_message("no groff here\n");
        skip();
    }
    program_folder(DIR);
    program_expect(&r, 0, "help --man >" DIR "/bis.1");
    assert_int_equal(
        system("groff -man -Tascii -ww -rLL=78n -P-cbou " DIR "/bis.1 > " DIR "/bis.txt 2> " DIR "/warnings"), 0);
    assert_string_equal(read_page(DIR "/warnings"), "");
    const char *text = read_page(DIR "/bis.txt");
    assert_80_columns("man page", text);
    assert_non_null(strstr(text, "--cropwindow x0,x1,y0,y1"));
    assert_non_null(strstr(text, "\n       bis - render direct light"));
    assert_non_null(strstr(text, "`bis envmap MAP` shows"));
    assert_non_null(strstr(text, "\n       .exr   float32"));
}

/* ---- examples ---- */

/* Small and short. What measures and verifies takes its time; test_trade and test_verify_scene run those. */
static void the_examples_work(void **state)
{
    char program[2048], command[4096], here[1024];
    const char *given = getenv("BIS_PROGRAM");
    const bis_topic *t = bis_topics;
    int n = 0;
    assert_non_null(getcwd(here, sizeof here));
    if (!given || !*given) given = "build/release/bis";
    snprintf(program, sizeof program, "%s%s%s", *given == '/' ? "" : here, *given == '/' ? "" : "/", given);
    program_folder(DIR);
    snprintf(command, sizeof command, "cd " DIR " && ln -sf '%s/scene.txt' '%s/data' .", here, here);
    assert_int_equal(system(command), 0);
    while (strcmp(t->name, "examples") != 0) t++;
    for (const bis_help_entry *e = t->entries; e->term || e->text; e++) {
        if (e->text || strncmp(e->term, "bis trade", 9) == 0 || strncmp(e->term, "bis verify", 10) == 0) continue;
        const bool renders = strncmp(e->term, "bis scene.txt", 13) == 0;
        const bool is_pixel = strncmp(e->term, "bis pixel", 9) == 0;
        assert_int_equal(strncmp(e->term, "bis ", 4), 0);
        snprintf(command, sizeof command, "cd " DIR " && '%s' %s%s > out 2> err", program, e->term + 4,
                 renders ? " --resolution 20x15 --spp 1 --quiet" : is_pixel ? " --repeats 2" : "");
        if (system(command) != 0) fail_msg("%s fails", e->term);
        n++;
    }
    assert_true(n >= 9);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_name_of_the_scene_format_is_in_its_topic),
        cmocka_unit_test(a_name_that_the_topic_lacks_is_found),
        cmocka_unit_test(every_integrator_and_every_layer_is_in_its_topic),
        cmocka_unit_test(the_overview_names_every_command_and_topic),
        cmocka_unit_test(every_topic_and_command_fits_80_columns),
        cmocka_unit_test(a_name_is_looked_up_in_all_topics),
        cmocka_unit_test(every_command_and_option_is_in_the_man_page),
        cmocka_unit_test(lines_of_an_example_are_one_paragraph_of_the_man_page),
        cmocka_unit_test(the_man_page_is_formatted_without_a_warning_in_80_columns),
        cmocka_unit_test(the_examples_work),
    };
    return expect_run("help", tests, sizeof tests / sizeof *tests, NULL, NULL,
                      &(expect_folder){"tests/data/expect/help", NULL, NULL});
}
