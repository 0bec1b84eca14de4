/* SPDX-License-Identifier: BSD-2-Clause */
/* Help, man page and comparison by hand, to the last blank; what commands say of their options beyond
 * tests/data/expect/bis. It is C and no .expect, because the tables of options are made here, not by the program. */
#include "base/text.h"
#include "cli/cli.h"
#include "cli/help.h"
#include "cli/man.h"
#include "cli/parameters.h"
#include "cli/progress.h"
#include "bis/base/version.h"
#include "bis/files/image_file.h"
#include "bis/shape/accel.h"
#include "bis/thesis/errata.h"
#include "claim.h"
#include "further.h"
#include "json_check.h"
#include "program.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define DIR "build/test_options"
#define SCENE DIR "/scene.txt"

static void an_option_stands_64_times_at_most(void **state)
{
    char arguments[4096] = "--plan " SCENE;
    program_run r;
    for (int i = 0; i < 65; i++) {
        const size_t n = strlen(arguments);
        if (i == 64) program_expect(&r, 0, "%s", arguments);
        snprintf(arguments + n, sizeof arguments - n, " --outfile=" DIR "/%d.exr", i);
    }
    program_expect(&r, 2, "%s", arguments);
    assert_string_equal(r.messages, "bis: error: --outfile stands here more than 64 times\n");
}

static void the_list_of_errata_has_them_all(void **state)
{
    program_run r;
    char line[1024];
    size_t used = 0;
    program_expect(&r, 0, "--as-printed list");
    for (const bis_erratum *e = bis_errata; e->name; e++) {
        snprintf(line, sizeof line, "%-4s thesis %s; integrators: %s\n     %s\n", e->name, e->section, e->integrators,
            e->effect);
        assert_int_equal(strncmp(r.output + used, line, strlen(line)), 0);
        used += strlen(line);
    }
    assert_int_equal(strlen(r.output), used);
    program_run again;
    program_expect(&again, 0, "render --as-printed=list");
    assert_string_equal(again.output, r.output);
}

/* ---- help and man page of a command by hand ---- */

#define A52 "aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa"
#define BLANKS26 "                          "

/* The term has 24 columns, or a line of its own; the text those from 27 to 80. */
static const bis_option options_by_hand[] = {
    {.help = "the first"},
    {.name = "flag", .help = "a flag - it isn't ^ or ~ or `", .kind = BIS_OPTION_FLAG},
    {.name = "abcdefghijklmnopqr", .argument = "N", .help = A52 " b c", .kind = BIS_OPTION_COUNT},
    {.help = "the .second"},
    {.name = "abcdefghijklmnopqrs", .argument = "N", .help = A52 "a b", .kind = BIS_OPTION_COUNT},
};
static const bis_command command_by_hand = {.name = "test",
    .usage = "test [options] A-B",
    .summary = "a .command that does\\nothing",
    .options = options_by_hand,
    .n_options = 5,
    .notes = "First line\nsecond line.\n\n  code 'x' -y\nThe last\nones.\n"};

static void help_by_hand(void **state)
{
    static const char expected[] =
        "usage: bis test [options] A-B\n"
        "a .command that does\\nothing\n"
        "\nthe first:\n"
        "  --flag                  a flag - it isn't ^ or ~ or `\n"
        "  --abcdefghijklmnopqr N  " A52 " b\n" BLANKS26 "c\n"
        "\nthe .second:\n"
        "  --abcdefghijklmnopqrs N\n" BLANKS26 A52 "a\n" BLANKS26 "b\n"
        "\nabout bis:\n"
        "  -h, --help              this text\n"
        "  -V, --version           version, accelerators and libraries\n"
        "\nFirst line\nsecond line.\n\n  code 'x' -y\nThe last\nones.\n";
    char *text = NULL;
    size_t n;
    FILE *out = open_memstream(&text, &n);
    bis_cli_help(&command_by_hand, out);
    fclose(out);
    assert_string_equal(text, expected);
    free(text);
    out = open_memstream(&text, &n);
    bis_cli_print_text(out, A52 " aaaaaaaaaaaaaaaaaaaaaaaaaaa " A52
                                " aaaaaaaaaaaaaaaaaaaaaaaaaaaa  b"); /* 52 + 1 + 27 are 80, 52 + 1 + 28 are not */
    fclose(out);
    assert_string_equal(text, A52 " aaaaaaaaaaaaaaaaaaaaaaaaaaa\n" A52 "\naaaaaaaaaaaaaaaaaaaaaaaaaaaa b\n");
    free(text);
}

static void man_page_by_hand(void **state)
{
    static const char expected[] =
        ".SS bis test [options] A\\-B\n"
        "a \\&.command that does\\enothing\n"
        ".PP\n\\fIthe first\\fR\n"
        ".TP\n\\fB\\-\\-flag\\fR\na flag \\- it isn\\(aqt \\(ha or \\(ti or \\(ga\n"
        ".TP\n\\fB\\-\\-abcdefghijklmnopqr N\\fR\n" A52 " b c\n"
        ".PP\n\\fIthe .second\\fR\n"
        ".TP\n\\fB\\-\\-abcdefghijklmnopqrs N\\fR\n" A52 "a b\n"
        ".PP\nFirst line second line.\n.PP\n.nf\n  code \\(aqx\\(aq \\-y\n.fi\nThe last ones.\n";
    char *text = NULL;
    size_t n;
    FILE *out = open_memstream(&text, &n);
    bis_man_command(&command_by_hand, out);
    fclose(out);
    assert_string_equal(text, expected);
    free(text);
    /* 52 + 1 + 23 are the 76 columns of a line of the source, 52 + 1 + 24 are not */
    static const char words[] = A52 " aaaaaaaaaaaaaaaaaaaaaaa\n" A52 "  aaaaaaaaaaaaaaaaaaaaaaaa .b not this";
    out = open_memstream(&text, &n);
    bis_man_paragraph(out, words, sizeof words - 1 - 9);
    fclose(out);
    assert_string_equal(text, A52 " aaaaaaaaaaaaaaaaaaaaaaa\n" A52 "\naaaaaaaaaaaaaaaaaaaaaaaa \\&.b\n");
    free(text);
}

/* Words with one blank between; a line that begins with a full stop, a request of troff, is left out where `is_man`,
 * and its escapes are undone. */
static void squeeze(char *to, size_t size, const char *text, bool is_man)
{
    size_t n = 0;
    bool begins = true;
    for (const char *c = text; *c && n + 2 < size; c++) {
        if (is_man && begins && *c == '.') {
            c += strcspn(c, "\n");
            if (!*c) break;
        }
        begins = *c == '\n';
        if (is_man && *c == '\\') {
            static const char *const escapes[][2] = {{"&", ""}, {"-", "-"}, {"e", "\\"}, {"(aq", "'"}, {"(ga", "`"},
                {"(ha", "^"}, {"(ti", "~"}, {"fB", ""}, {"fR", ""}, {"fI", ""}};
            size_t k = 0;
            while (k < 10 && strncmp(c + 1, escapes[k][0], strlen(escapes[k][0])) != 0) k++;
            assert_true(k < 10);
            if (escapes[k][1][0]) to[n++] = escapes[k][1][0];
            c += strlen(escapes[k][0]);
        } else if (*c == ' ' || *c == '\n') {
            if (n && to[n - 1] != ' ') to[n++] = ' ';
        } else {
            to[n++] = *c;
        }
    }
    while (n && to[n - 1] == ' ') n--;
    to[n] = '\0';
}

/* All entries of a topic, one behind the other, with those of the integrators and parameters in place. */
static void words_of(char *words, size_t size, const bis_topic *t)
{
    static char text[1 << 15];
    static bis_help_page page;
    size_t n = 0;
    *text = '\0';
    for (const bis_help_entry *e = bis_help_open(&page, t); e->term || e->text; e++)
        n += (size_t)snprintf(text + n, sizeof text - n, "%s %s ", e->term ? e->term : "", e->text ? e->text : "");
    assert_true(n < sizeof text - 1);
    squeeze(words, size, text, false);
}

static int kind_of(const char *line)
{
    const size_t indent = strspn(line, " ");
    /* a paragraph, a line of a scene (by 6: it goes on), an entry or its text */
    return indent == 0 ? 0 : indent == 4 || indent == 6 ? 4 : 2;
}

/* Title, entries in their order, nothing else, in `help` and in the man page. Between blank lines is one kind of line;
 * a paragraph may head entries. */
static void a_topic_is_printed_whole(void **state)
{
    static char words[1 << 15], found[1 << 15], man_words[1 << 17], title[256];
    static program_run r, man;
    program_expect(&man, 0, "help --man");
    for (const bis_topic *t = bis_topics; t->name; t++) {
        program_expect(&r, 0, "help %s", t->name);
        snprintf(title, sizeof title, "%s: %s", t->name, t->summary);
        squeeze(words, sizeof words, title, false);
        const size_t n = strlen(words);
        words[n] = ' ';
        words_of(words + n + 1, sizeof words - n - 1, t);
        squeeze(found, sizeof found, r.output, false);
        assert_string_equal(found, words);
        const char *line = strchr(r.output, '\n') + 1;
        for (int last = -1; *line; line += strcspn(line, "\n"), line += *line == '\n') {
            const int kind = *line == '\n' ? -1 : kind_of(line);
            if (kind >= 0 && last >= 0 && kind != last && !(last == 0 && kind == 2))
                fail_msg("help %s: no blank line before \"%.40s\"", t->name, line);
            assert_false(kind < 0 && (last < 0 && line != strchr(r.output, '\n') + 1)); /* never two */
            last = kind;
        }
        /* its section of the page, without heading and summary */
        char heading[64];
        snprintf(heading, sizeof heading, "\n.SH %s\n", t->name);
        for (char *c = heading + 5; *c; c++) *c = (char)(*c >= 'a' && *c <= 'z' ? *c - 32 : *c);
        char *part = strstr(man.output, heading);
        assert_non_null(part);
        part += strlen(heading);
        char *end = strstr(part, "\n.SH ");
        const size_t length = end ? (size_t)(end - part) + 1 : strlen(part);
        char *copy = malloc(length + 1);
        memcpy(copy, part, length);
        copy[length] = '\0';
        squeeze(man_words, sizeof man_words, copy, true);
        free(copy);
        snprintf(found, sizeof found, "%s %.*s", t->summary, (int)(sizeof found - 300), words + n + 1);
        assert_string_equal(man_words, found);
    }
}

/* Every word of a term explains itself: its entry is printed whole, and so are all others that have the word. */
static void every_name_of_a_term_is_looked_up(void **state)
{
    static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.";
    static char entry[8192], words[8192], found[1 << 16];
    static program_run r;
    static bis_help_page page;
    for (const bis_topic *t = bis_topics; t->name; t++) {
        for (const bis_help_entry *e = bis_help_open(&page, t); e->term || e->text; e++) {
            char name[64];
            const char *at = e->term ? e->term + strcspn(e->term, letters) : "";
            const size_t n = strspn(at, letters);
            if (!e->term || !e->text || n == 0) continue;
            snprintf(name, sizeof name, "%.*s", (int)n, at);
            bool is_topic = bis_subcommand_find(name) != NULL;
            for (const bis_topic *k = bis_topics; k->name; k++) is_topic |= strcmp(k->name, name) == 0;
            if (is_topic || strncmp(name, "--", 2) == 0) continue;
            program_expect(&r, 0, "help %s", name);
            snprintf(entry, sizeof entry, "%s %s", e->term, e->text);
            squeeze(words, sizeof words, entry, false);
            squeeze(found, sizeof found, r.output, false);
            if (!strstr(found, words)) fail_msg("help %s: no \"%s\"", name, words);
        }
    }
}

/* With its dashes an option alone is meant; a part of a name is no name. */
static void an_option_is_looked_up_with_its_dashes_and_whole(void **state)
{
    program_run with, without;
    program_expect(&with, 0, "help -- --spp");
    program_expect(&without, 0, "help spp");
    assert_non_null(strstr(with.output, "\n  --spp N"));
    assert_string_equal(with.output, without.output);
    program_expect(&without, 2, "help sp");
    assert_non_null(strstr(without.messages, "no command, topic or name \"sp\""));
    program_expect(&without, 2, "help -- --sp");
}

/* Of one integrator: what to use for a preview, a good picture and a final one; by which setting is for the clock to
 * say. The runs take 3 s and may take 300, because on a busy machine 20 were too few for the last of them. */
static void a_trade_ends_with_three_recommendations(void **state)
{
    static const char *const purposes[] = {"preview        error ", "good picture   error ", "final picture  error "};
    program_run r;
    assert_int_equal(system("rm -rf " DIR "/trade"), 0);
    program_expect(&r, 0,
        "trade " SCENE " --output " DIR
        "/trade --integrator em --passes 2 --seeds 1 --time 300 --error 60%% --nthreads 1 --quiet");
    const char *line = r.output;
    for (int i = 0; i < 3; i++) {
        assert_int_equal(strncmp(line, purposes[i], strlen(purposes[i])), 0);
        /* which setting wins is a matter of times; one that options cannot say is a line of a scene */
        const char *const options = strstr(line, " --integrator em --samples "),
                          *const words = strstr(line, " Integrator \"em\" \"integer samples\" ");
        const char *const setting = options && (!words || options < words) ? options : words;
        assert_true(setting && setting < strchr(line, '\n'));
        line = strchr(line, '\n') + 1;
    }
    int done, planned, used = 0;
    assert_int_equal(sscanf(line, "%d of %d runs in " DIR "/trade/report.html\n%n", &done, &planned, &used), 2);
    assert_true(done == planned && line[used] == '\0');
}

/* Who reads a parameter, in the order of the integrators, and what it is; a choice has names in the place of words. */
static void the_words_of_parameters_are_these(void **state)
{
    static const char *const words[][2] = {
        {"candidates", "rejection, sir, unoccluded: candidates for each camera sample"},
        {"shadowrays", "rejection, sir: candidates that are shadow-tested"},
        {"samples", "em, brdf, mis: light samples for each camera sample"},
        {"proposal", "rejection: em, brdf or choose; sir: em, brdf, mix or product"},
        {"heuristic", "mis: balance or power"},
        {"fallback", "rejection: resample, subset or unoccluded"},
        {"stratify", "em, mis, sir: take the map's samples along its curve"},
        {"split", "mis: the map's share of the samples"},
    };
    char text[BIS_PARAMETER_WORDS], all[BIS_INTEGRATOR_WORDS];
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        bool has_more = false;
        for (int k = 0; k < n_further(); k++)
            has_more |= bis_parameter_of(bis_integrators[OUR_INTEGRATORS + k], words[i][0]) != NULL;
        if (!has_more) assert_string_equal(bis_parameter_words(text, words[i][0]), words[i][1]);
    }
    assert_string_equal(bis_integrator_words(all, &bis_mis),
                        "both, combined by a heuristic. samples (16; at least 2), heuristic (balance, power), split "
                        "(0.5; "
                        "the map's share), compensate (false), stratify (false). Unbiased");
    assert_string_equal(bis_integrator_words(all, &bis_exact),
                        "every lit pixel of the map: ground truth for small maps. perpatch (1). Unbiased: every lit "
                        "patch, "
                        "noise only inside patches");
}

/* Its seven lines; one accelerator is the default. */
static void the_version_has_seven_lines(void **state)
{
    static const char *const begins[] = {
        "bis " BIS_VERSION "\n", "accelerators: grid", "Embree: ", "OpenEXR: ", "libpng: ", "libjpeg: ", "threads: "};
    program_run r, again;
    char line[128];
    const char *const embree = bis_accel_embree_version(), *at = r.output;
    program_expect(&r, 0, "version");
    for (int i = 0; i < 7; i++) {
        assert_int_equal(strncmp(at, begins[i], strlen(begins[i])), 0);
        at += strcspn(at, "\n") + 1;
    }
    assert_true(*at == '\0');
    snprintf(line, sizeof line, "\naccelerators: grid%s\nEmbree: %s\n", embree ? ", embree (default)" : " (default)",
        embree ? embree : "not built in");
    assert_non_null(strstr(r.output, line));
    program_expect(&again, 0, "--version");
    assert_string_equal(r.output, again.output);
}

/* ---- compare by hand ---- */

static void save(const char *path, const rgb *pixels, int n)
{
    rgb copy[8];
    memcpy(copy, pixels, (size_t)n * sizeof *pixels);
    const bis_image image = {n, 1, copy, NULL};
    assert_int_equal(bis_image_save(&image, path, NULL), BIS_OK);
}

/* a less b is 1 0 0 | 0 -2 2 | 2 2 -1; the fourth is not finite. Means 3 and 23/9; relMSE of b's values, with m^2/100.
 */
static void a_comparison_by_hand(void **state)
{
    const rgb a[4] = {{2, 1, 1}, {3, 2, 4}, {6, 6, 2}, {NAN, 1, 1}},
              b[4] = {{1, 1, 1}, {3, 4, 2}, {4, 4, 3}, {1, 1, 1}};
    static const char *const keys[] = {
        "mean_a", "mean_b", "bias", "bias_se", "rmse", "relmse", "max_abs", "pixels", "nonfinite"};
    const double m = 23 / 9.0, f = m * m / 100, d[3] = {1 / 3.0, 0, 1}, mean = 4 / 9.0;
    const double scatter = pow(d[0] - mean, 2) + pow(d[1] - mean, 2) + pow(d[2] - mean, 2);
    const double expected[] = {3, m, mean, sqrt(scatter / 2 / 3), sqrt((1 + 4 + 4 + 4 + 4 + 1) / 9.0),
                               (1 / (1 + f) + 4 / (16 + f) + 4 / (4 + f) + 8 / (16 + f) + 1 / (9 + f)) / 9, 2, 3, 1};
    program_run text, json;
    char line[64], exact[64], order[128];
    save(DIR "/a.pfm", a, 4);
    save(DIR "/b.pfm", b, 4);
    program_expect(&text, 0, "compare " DIR "/a.pfm " DIR "/b.pfm");
    program_expect(&json, 0, "compare --json " DIR "/a.pfm " DIR "/b.pfm");
    const char *at = text.output;
    for (int i = 0; i < 9; i++) {
        char *end;
        assert_int_equal(strncmp(at, keys[i], strlen(keys[i])), 0);
        at += strlen(keys[i]);
        assert_true(*at == ' ');
        const double found = strtod(at + 1, &end);
        if (!(fabs(found - expected[i]) <= 1e-12 * expected[i]))
            fail_msg("%s is %.17g, not %.17g", keys[i], found, expected[i]);
        assert_true(*end == '\n' && json_number(json.output, keys[i]) == found);
        at = end + 1;
    }
    assert_string_equal(at, "");
    assert_string_equal(json_keys(order, sizeof order, json.output, ""),
        "mean_a mean_b bias bias_se rmse relmse max_abs pixels nonfinite ");

    /* a tolerance that is reached, and one that is one step below */
    json_value(exact, sizeof exact, json.output, "relmse");
    program_expect(&text, 0, "compare --tolerance %s " DIR "/a.pfm " DIR "/b.pfm", exact);
    snprintf(line, sizeof line, "%.17g", nextafter(strtod(exact, NULL), 0));
    program_expect(&text, 1, "compare --tolerance %s " DIR "/a.pfm " DIR "/b.pfm", line);

    /* one pixel has no scatter */
    save(DIR "/a1.pfm", a, 1);
    save(DIR "/b1.pfm", b, 1);
    program_expect(&text, 0, "compare " DIR "/a1.pfm " DIR "/b1.pfm");
    assert_non_null(strstr(text.output, "\nbias_se nan\nrmse "));
    assert_non_null(strstr(text.output, "\nmax_abs 1\npixels 1\nnonfinite 0\n"));
}

/* 0 where equal; of b = 1 all over, (a - 1)/sqrt(1.01) = 0.1 is red; magenta. */
static void a_difference_by_hand(void **state)
{
    const rgb one[3] = {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}},
              off[3] = {{1, 1, 1}, {1.1004988f, 1.1004988f, 1.1004988f}, {INFINITY, 1, 1}};
    const rgb colours[3] = {{0, 0, 0}, {1, 0, 0}, {1, 0, 1}};
    bis_image picture;
    program_run text;
    save(DIR "/a3.pfm", off, 3);
    save(DIR "/b3.pfm", one, 3);
    program_expect(&text, 0, "compare " DIR "/a3.pfm " DIR "/b3.pfm --diff " DIR "/d.pfm");
    assert_int_equal(bis_image_read(&picture, DIR "/d.pfm", (bis_loc){0}, NULL), BIS_OK);
    for (int i = 0; i < 3; i++) {
        assert_true(fabsf(picture.pixels[i].r - colours[i].r) < 1e-3f &&
                    fabsf(picture.pixels[i].g - colours[i].g) < 1e-3f &&
                    fabsf(picture.pixels[i].b - colours[i].b) < 1e-3f);
    }
    bis_image_clear(&picture);
    program_expect(&text, 2, "compare " DIR "/a3.pfm " DIR "/b3.pfm --diff " DIR "/d.txt");
    assert_string_equal(
        text.messages, "bis: error: --diff \"" DIR "/d.txt\": the ending must be .exr, .pfm, .hdr or .png\n");
}

/* Into no other file than the one that was named. */
static void a_part_has_one_file_with_a_name(void **state)
{
    program_run r;
    program_expect(&r, 0, SCENE " --spp 1 --part 2/2 --outfile " DIR "/p.bispart");
    assert_true(program_exists(DIR "/p.bispart") && !program_exists(DIR "/film.exr"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_option_stands_64_times_at_most),
        cmocka_unit_test(the_list_of_errata_has_them_all),
        cmocka_unit_test(help_by_hand),
        cmocka_unit_test(man_page_by_hand),
        cmocka_unit_test(a_topic_is_printed_whole),
        cmocka_unit_test(every_name_of_a_term_is_looked_up),
        cmocka_unit_test(an_option_is_looked_up_with_its_dashes_and_whole),
        cmocka_unit_test(a_trade_ends_with_three_recommendations),
        cmocka_unit_test(the_words_of_parameters_are_these),
        cmocka_unit_test(the_version_has_seven_lines),
        cmocka_unit_test(a_comparison_by_hand),
        cmocka_unit_test(a_difference_by_hand),
        cmocka_unit_test(a_part_has_one_file_with_a_name),
    };
    program_folder(DIR);
    program_write_scene(DIR, "Sampler \"stratified\"\n");
    return cmocka_run_group_tests(tests, NULL, NULL);
}
