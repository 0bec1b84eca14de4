/* SPDX-License-Identifier: BSD-2-Clause */
/* What commands say of their options beyond tests/data/expect/bis, every name of the help, a comparison by hand. */
#include "base/text.h"
#include "cli/cli.h"
#include "cli/help.h"
#include "cli/parameters.h"
#include "cli/progress.h"
#include "bis/base/version.h"
#include "bis/files/image_file.h"
#include "bis/shape/accel.h"
#include "bis/thesis/errata.h"
#include "claim.h"
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

/* Words with one blank between. */
static void squeeze(char *to, size_t size, const char *text)
{
    size_t n = 0;
    for (const char *c = text; *c && n + 2 < size; c++) {
        if (*c != ' ' && *c != '\n') to[n++] = *c;
        else if (n && to[n - 1] != ' ') to[n++] = ' ';
    }
    while (n && to[n - 1] == ' ') n--;
    to[n] = '\0';
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
            squeeze(words, sizeof words, entry);
            squeeze(found, sizeof found, r.output);
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
        cmocka_unit_test(every_name_of_a_term_is_looked_up),
        cmocka_unit_test(an_option_is_looked_up_with_its_dashes_and_whole),
        cmocka_unit_test(the_version_has_seven_lines),
        cmocka_unit_test(a_comparison_by_hand),
        cmocka_unit_test(a_difference_by_hand),
        cmocka_unit_test(a_part_has_one_file_with_a_name),
    };
    program_folder(DIR);
    program_write_scene(DIR, "Sampler \"stratified\"\n");
    return cmocka_run_group_tests(tests, NULL, NULL);
}
