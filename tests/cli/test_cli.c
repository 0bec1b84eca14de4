/* SPDX-License-Identifier: BSD-2-Clause */
/* cli and json: what a table of options promises, and JSON that is valid whatever it is fed. */
#include "cli/cli.h"
#include "cli/progress.h"
#include "cli/render_files.h"
#include "tools/json.h"
#include "render/ranks.h"

#include "claim.h"
#include "expect.h"
#include "file_help.h"
#include "json_check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- a command of our own ---- */

typedef struct values {
    bool flag, quiet, has_count;
    const char *text, *name;
    bis_texts list;
    uint64_t count, big;
    double real, share, least, error, seconds;
    int own;
} values;

typedef struct run_result {
    bool go_on;
    int exit_status, n_operands;
    const char *operands[2];
    char messages[2048], output[8192];
} run_result;

static bool read_yes(void *value, const char *text)
{
    *(int *)value = 7;
    return strcmp(text, "yes") == 0;
}

/* Standard output or error into a file, until restore() reads it. */
static int redirect(FILE *stream, const char *path)
{
    fflush(stream);
    int saved = dup(fileno(stream));
    assert_non_null(freopen(path, "w", stream));
    return saved;
}

static void restore(FILE *stream, int saved, const char *path, char *buf, size_t size)
{
    fflush(stream);
    dup2(saved, fileno(stream));
    close(saved);
    read_text(buf, size, path);
}

static void with_table(run_result *r, values *v, int argc, const char *const *argv)
{
    static const char *const colours[] = {"red", "green", "blue", NULL};
    const bis_option options[] = {
        {.help = "options"},
        {.name = "flag", .help = "a flag", .kind = BIS_OPTION_FLAG, .value = &v->flag},
        {.name = "text", .argument = "F", .help = "a text", .kind = BIS_OPTION_TEXT, .value = &v->text},
        {.name = "list", .argument = "F", .help = "a list", .kind = BIS_OPTION_LIST, .value = &v->list},
        {.name = "count", .argument = "N", .help = "a count that needs a long, long explanation which does not fit "
         "into one line of eighty columns",
         .kind = BIS_OPTION_COUNT, .value = &v->count, .given = &v->has_count, .lo = 1, .hi = 1000},
        {.name = "real", .argument = "X", .help = "a number", .kind = BIS_OPTION_REAL, .value = &v->real, .above = true,
         .hi = (double)INFINITY},
        {.name = "big", .argument = "N", .help = "any count", .kind = BIS_OPTION_COUNT, .value = &v->big, .lo = 3,
         .hi = 0x1p64},
        {.name = "least", .argument = "X", .help = "at least 2", .kind = BIS_OPTION_REAL, .value = &v->least, .lo = 2,
         .hi = (double)INFINITY},
        {.name = "share", .argument = "S", .help = "a share", .kind = BIS_OPTION_REAL, .value = &v->share, .hi = 1},
        {.name = "error", .argument = "E", .help = "an error", .kind = BIS_OPTION_SHARE, .value = &v->error,
            .above = true, .hi = 10},
        {.name = "time", .argument = "S", .help = "a time", .kind = BIS_OPTION_SECONDS, .value = &v->seconds,
            .above = true, .hi = 1e8},
        {.name = "quiet", .help = "no warnings", .kind = BIS_OPTION_FLAG, .value = &v->quiet},
        {.name = "colour", .argument = "C", .help = "a name", .kind = BIS_OPTION_NAME, .value = &v->name,
         .names = colours},
        {.name = "own-and-rather-long-name", .argument = "Y", .help = "an own one", .kind = BIS_OPTION_OWN,
         .value = &v->own, .read = read_yes, .rule = "yes"},
    };
    const bis_command command = {.name = "test",
        .usage = "test [options] A [B]",
        .summary = "a command",
        .options = options,
        .n_options = sizeof options / sizeof *options,
        .min_operands = 1,
        .max_operands = 2,
        .notes = "Notes.\n"};
    char *arguments[32];
    for (int i = 0; i < argc; i++) arguments[i] = strdup(argv[i]);
    mkdir("build", 0777);
    *v = (values){0};
    *r = (run_result){0};
    int out = redirect(stdout, "build/test_cli.out"), err = redirect(stderr, "build/test_cli.err");
    r->go_on = bis_cli_parse(&command, argc, arguments, r->operands, &r->n_operands, &r->exit_status);
    restore(stderr, err, "build/test_cli.err", r->messages, sizeof r->messages);
    restore(stdout, out, "build/test_cli.out", r->output, sizeof r->output);
    for (int i = 0; i < r->n_operands && i < 2 && r->go_on; i++) r->operands[i] = strdup(r->operands[i]);
    if (v->text) v->text = strdup(v->text);
    for (int i = 0; i < v->list.n; i++) v->list.text[i] = strdup(v->list.text[i]);
    for (int i = 0; i < argc; i++) free(arguments[i]);
}

static void clear(run_result *r, values *v)
{
    for (int i = 0; i < r->n_operands && i < 2 && r->go_on; i++) free((void *)(uintptr_t)r->operands[i]);
    free((void *)(uintptr_t)v->text);
    for (int i = 0; i < v->list.n; i++) free((void *)(uintptr_t)v->list.text[i]);
}

#define RUN(...)                                                                     \
    values v;                                                                        \
    run_result r;                                                                    \
    const char *const argv[] = {__VA_ARGS__};                                        \
    with_table(&r, &v, (int)(sizeof argv / sizeof *argv), argv)

/* `test ARGUMENT...` between single blanks, "" an empty one: what it says, and its exit status. */
static int test(const expect_command *c)
{
    char words[256];
    const char *argv[8];
    int argc = 0;
    values v;
    run_result r;
    snprintf(words, sizeof words, "%s", c->arguments);
    for (char *word = strtok(words, " "); word && argc < 8; word = strtok(NULL, " "))
        argv[argc++] = strcmp(word, "\"\"") == 0 ? "" : word;
    with_table(&r, &v, argc, argv);
    fputs(r.messages, c->messages);
    fputs(r.output, c->output);
    assert_int_equal(r.go_on, r.exit_status != 2);
    clear(&r, &v);
    return r.exit_status;
}

/* ---- reading ---- */

static void options_and_operands_may_be_mixed(void **state)
{
    RUN("a", "--count", "12", "--flag", "b", "--real=0.5", "--text", "-", "--list", "x", "--list=y=z", "--colour",
        "green");
    assert_true(r.go_on);
    assert_int_equal(r.n_operands, 2);
    assert_string_equal(r.operands[0], "a");
    assert_string_equal(r.operands[1], "b");
    assert_true(v.flag && v.has_count && v.count == 12 && v.real == 0.5);
    assert_string_equal(v.text, "-");
    assert_int_equal(v.list.n, 2);
    assert_string_equal(v.list.text[1], "y=z");
    assert_string_equal(v.name, "green");
    assert_string_equal(r.messages, "");
    clear(&r, &v);
}

static void two_dashes_end_the_options(void **state)
{
    RUN("--flag", "--", "--count", "--help");
    assert_true(r.go_on);
    assert_int_equal(r.n_operands, 2);
    assert_string_equal(r.operands[0], "--count");
    assert_false(v.has_count);
    clear(&r, &v);
}

static void an_option_that_is_absent_leaves_its_value_alone(void **state)
{
    RUN("a");
    assert_true(r.go_on && !v.flag && !v.has_count && v.count == 0 && v.text == NULL);
    clear(&r, &v);
}

static void the_ends_of_a_range_belong_to_it(void **state)
{
    RUN("a", "--big", "18446744073709551615", "--least", "2", "--share", "1", "--count", "1000", "--error", "10");
    assert_true(r.go_on && v.big == UINT64_MAX && v.least == 2 && v.share == 1 && v.count == 1000 && v.error == 10);
    clear(&r, &v);
    const char *const low[] = {"a", "--big", "3", "--share", "0", "--count", "1", "--real", "1e-300", "--time", "1e8"};
    with_table(&r, &v, 11, low);
    assert_true(r.go_on && v.big == 3 && v.share == 0 && v.count == 1 && v.real == 1e-300 && v.seconds == 1e8);
    clear(&r, &v);
}

static void shares_may_be_percentages_and_times_have_units(void **state)
{
    const struct { const char *error, *time; double share, seconds; bool asks; } cases[] = {
        {"0.05", "10", 0.05, 10, false}, {"5%", "10s", 0.05, 10, false}, {"500%", "2min", 5, 120, false},
        {"1", "1.5h", 1, 5400, false},   {"5", "0.5", 5, 0.5, true},     {"2.5e0%", "1e3s", 0.025, 1000, false},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        RUN("a", "--error", cases[i].error, "--time", cases[i].time);
        assert_true(r.go_on && v.error == cases[i].share && v.seconds == cases[i].seconds);
        assert_string_equal(r.messages, cases[i].asks ? "bis: warning: --error 5 is 500 %: did you mean --error 5%, "
            "which is 0.05? If not, write 500%\n" : "");
        clear(&r, &v);
    }
    RUN("a", "--error", "5", "--quiet");
    assert_true(r.go_on && v.error == 5);
    assert_string_equal(r.messages, "");
    clear(&r, &v);
}

static void progress_counts_to_the_last_pass_and_tells_minutes(void **state)
{
    const double unknown = (double)NAN;
    const struct { bis_progress p; const char *text; } cases[] = {
        {{0, 12, 0, 0, unknown}, "pass 1 of 12, 0%"},
        {{11, 12, 0.92, 5, 0.3}, "pass 12 of 12, 92%, 1 s left"},
        {{12, 12, 1, 5, 0}, "pass 12 of 12, 100%, 0 s left"},
        {{3, 0, 0.25, 20, 379.2}, "pass 4, 25%, 6.3 min left"},
        {{3, 0, 0.25, 20, 119}, "pass 4, 25%, 2.0 min left"},
        {{3, 4000000000u, 0, 20, 9000}, "pass 4 of 4000000000, 0%, 2.5 h left"},
        {{3, 4000000000u, 0, 20, 1e6}, "pass 4 of 4000000000, 0%, 11.6 days left"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[BIS_PROGRESS_TEXT];
        assert_string_equal(bis_progress_text(text, &cases[i].p), cases[i].text);
    }
}

/* ---- help ---- */

static void help_names_every_option_within_80_columns(void **state)
{
    RUN("--count", "0", "--help"); /* help wins over mistakes */
    assert_false(r.go_on);
    assert_int_equal(r.exit_status, 0);
    assert_string_equal(r.messages, "");
    const char *names[] = {"--flag ", "--text F", "--list F", "--count N", "--real X", "--colour C",
        "--own-and-rather-long-name Y", "--help", "--version", "Notes.", "usage: bis test [options] A [B]\n"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) assert_non_null(strstr(r.output, names[i]));
    for (const char *line = r.output; *line;) {
        size_t n = strcspn(line, "\n");
        assert_true(n <= 80);
        assert_true(n == 0 || line[n - 1] != ' ');
        line += n + 1;
    }
    clear(&r, &v);
}

static void version_names_the_libraries(void **state)
{
    RUN("--version");
    assert_int_equal(r.exit_status, 0);
    assert_ptr_equal(strstr(r.output, "bis 0."), r.output);
    assert_non_null(strstr(r.output, "Embree: "));
    assert_non_null(strstr(r.output, "OpenEXR: 3."));
    assert_non_null(strstr(r.output, "libpng: 1."));
    clear(&r, &v);
}

/* -h and -V, as every other program has them. */
static void help_and_version_have_a_letter(void **state)
{
    const char *const words[2] = {"--help", "--version"}, *const letters[2] = {"-h", "-V"};
    for (int i = 0; i < 2; i++) {
        values v;
        run_result by_word, by_letter;
        with_table(&by_word, &v, 1, &words[i]);
        with_table(&by_letter, &v, 1, &letters[i]);
        assert_int_equal(by_letter.exit_status, 0);
        assert_string_equal(by_letter.output, by_word.output);
        assert_true(*by_letter.output);
    }
}

/* ---- files ---- */

static void a_place_that_cannot_take_a_file_is_known_beforehand(void **state)
{
    mkdir("build", 0777);
    fclose(fopen("build/test_cli.file", "w"));
    const struct { const char *path, *part; bis_status status; } cases[] = {
        {"build/test_cli.exr", NULL, BIS_OK},
        {"build/test_cli.file", NULL, BIS_OK},
        {"test_cli.exr", NULL, BIS_OK},
        {"build/no/such/folder.exr", "folder \"build/no/such\": No such file", BIS_IO},
        {"build/test_cli.file/x.exr", "\"build/test_cli.file\" is not a folder", BIS_IO},
        {"build", "it is a folder", BIS_IO},
        {"/dev/null", "it is not a regular file", BIS_IO},
    };
    unlink("build/test_cli.exr"); /* an ended run may have left it */
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bis_diag diag = {0};
        assert_int_equal(bis_cli_check_writable(cases[i].path, &diag), cases[i].status);
        if (cases[i].part) assert_non_null(strstr(diag.messages[0].text, cases[i].part));
        bis_diag_clear(&diag);
    }
    /* a file of the root lies in no folder of another name */
    bis_diag diag = {0};
    const bool may_write = access("/", W_OK | X_OK) == 0;
    assert_int_equal(bis_cli_check_writable("/test_cli.none", &diag), may_write ? BIS_OK : BIS_IO);
    if (!may_write) assert_non_null(strstr(diag.messages[0].text, "cannot be written: folder \"/\": "));
    assert_int_equal(access("/test_cli.none", F_OK), -1); /* nothing was left there */
    assert_int_equal(access("build/test_cli.exr", F_OK), -1);
    bis_diag_clear(&diag);
}

/* What has no place begins with the program's name; warnings are left out when quiet; lost messages are counted. */
static void messages_say_who_speaks(void **state)
{
    char text[512];
    for (int quiet = 0; quiet < 2; quiet++) {
        bis_diag diag = {0};
        bis_warn(&diag, (bis_loc){"a.txt", 3, 7}, "one");
        bis_warn(&diag, (bis_loc){0}, "two");
        bis_error(&diag, BIS_INPUT, (bis_loc){"b.txt", 0, 0}, "three");
        bis_error(&diag, BIS_INPUT, bis_cli_loc, "four");
        if (quiet) diag.n_lost = 12;
        const int err = redirect(stderr, "build/test_cli.err");
        bis_cli_print_diag(&diag, quiet);
        restore(stderr, err, "build/test_cli.err", text, sizeof text);
        assert_string_equal(text, quiet ? "b.txt: error: three\nbis: error: four\n"
                                          "bis: error: 12 more messages were lost for lack of memory\n"
                                        : "a.txt:3:7: warning: one\nbis: warning: two\nb.txt: error: three\n"
                                          "bis: error: four\n");
        bis_diag_clear(&diag);
    }
}

/* Of files that are read and written: the first pair is named, and the same name or a link is the same file. */
static void no_output_replaces_another_file(void **state)
{
    static const char *const in[] = {"build/test_cli.in", "build/test_cli.in2"};
    static const struct { const char *outputs[3]; size_t n; const char *message; } cases[] = {
        {{"build/test_cli.out1", "build/test_cli.out2"}, 2, NULL},
        {{"build/test_cli.out1", "build/./test_cli.in2"}, 2,
         "bis: error: output \"build/./test_cli.in2\" would replace \"build/test_cli.in2\", which is read; give the "
         "output another "
         "name"},
        {{"build/test_cli.link"}, 1, "bis: error: output \"build/test_cli.link\" would replace \"build/test_cli.in\", "
         "which is "
                                     "read; give the output another name"},
        {{"build/test_cli.out1", "build/test_cli.out2", "build/./test_cli.out1"}, 3,
         "bis: error: outputs \"build/test_cli.out1\" and \"build/./test_cli.out1\" are one file; give one of them "
         "another name"},
        {{"-", "-", "/dev/null"}, 3, NULL},
        {{"/dev/null", "/dev/null", "-"}, 3, NULL},
    };
    for (int i = 0; i < 2; i++) fclose(fopen(in[i], "w"));
    unlink("build/test_cli.link");
    assert_int_equal(symlink("test_cli.in", "build/test_cli.link"), 0);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bis_diag diag = {0};
        assert_int_equal(bis_cli_check_distinct(in, 2, cases[i].outputs, cases[i].n, &diag),
                         cases[i].message ? BIS_INPUT : BIS_OK);
        assert_int_equal(diag.n, cases[i].message ? 1 : 0);
        if (cases[i].message) assert_string_equal(diag.messages[0].text, cases[i].message);
        bis_diag_clear(&diag);
    }
}

/* What a render says last, of every way that it can end: renders that are ended in their first pass are a matter of
 * luck, so that results are made up here. */
static void the_last_line_tells_how_a_render_ended(void **state)
{
    const double no = (double)NAN;
    const struct { bis_render_result r; int n; const char *said; } cases[] = {
        {{.interrupted = true, .missing = 0.25, .spp = 1, .passes = 1, .seconds = 1.5, .error = {.relative_rmse = no}},
         2,
         "bis: interrupted in the first pass; wrote a.exr, b.png: 24 x 16 pixels, 25% of them without a camera sample "
         "and like a neighbour, 1.5 s, error unknown: one pass is too few\n"},
        {{.missing = 0.25, .spp = 1, .passes = 1, .seconds = 1.5, .error = {.relative_rmse = no}}, 1,
         "bis: wrote a.exr: 24 x 16 pixels, 25% of them without a camera sample and like a neighbour, 1.5 s, error "
         "unknown: one pass is too few\n"},
        {{.interrupted = true, .spp = 1, .passes = 1, .seconds = 120, .error = {.relative_rmse = no}}, 1,
         "bis: interrupted after 1 camera sample a pixel; wrote a.exr: 24 x 16 pixels, 1 camera sample a pixel in 1 "
         "pass, 2.0 min, error unknown: one pass is too few\n"},
        {{.interrupted = true, .spp = 4, .passes = 3, .seconds = 0.5, .error = {.relative_rmse = 0.5}}, 3,
         "bis: interrupted after 4 camera samples a pixel; wrote a.exr, b.png, c.pfm: 24 x 16 pixels, 4 camera samples "
         "a pixel in 3 passes, 0.5 s, error unknown: pixels may not have found their light yet\n"},
        {{.spp = 4, .passes = 2, .seconds = 1, .error = {.relative_rmse = 0.1, .upper = 0.123, .has_upper = true}}, 1,
         "bis: wrote a.exr: 24 x 16 pixels, 4 camera samples a pixel in 2 passes, 1 s, error at most 13%; exposure "
         "-1.5\n"},
        {{.spp = 4000000000, .passes = 2, .seconds = 50, .error = {.relative_rmse = 0.125, .is_known = true}}, 1,
         "bis: wrote a.exr: 24 x 16 pixels, 4000000000 camera samples a pixel in 2 passes, 50 s, error about 12%\n"},
    };
    const bis_film film = {.width = 24, .height = 16};

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const bis_texts written = {.text = {"a.exr", "b.png", "c.pfm"}, .n = cases[i].n};
        const bis_stats stats = {.film = &film, .result = &cases[i].r};
        char text[512];
        const int err = redirect(stderr, "build/test_cli.err");
        bis_render_files_print_result(&written, i == 4 ? -1.5 : no, &stats);
        restore(stderr, err, "build/test_cli.err", text, sizeof text);
        assert_string_equal(text, cases[i].said);
    }
}

static void exit_statuses_are_those_of_the_contract(void **state)
{
    assert_int_equal(bis_cli_exit_status(BIS_OK), 0);
    assert_int_equal(bis_cli_exit_status(BIS_IO), 1);
    assert_int_equal(bis_cli_exit_status(BIS_NOMEM), 1);
    assert_int_equal(bis_cli_exit_status(BIS_INPUT), 2);
}

/* ---- json ---- */

static void json_is_valid_for_any_number_and_any_bytes(void **state)
{
    char *text = NULL, buf[256];
    size_t size;
    bis_json j = {.out = open_memstream(&text, &size)};
    char all[256];
    for (int i = 0; i < 255; i++) all[i] = (char)(i + 1);
    all[255] = '\0';
    bis_json_open(&j, NULL, '{');
    bis_json_number(&j, "nan", (double)NAN);
    bis_json_number(&j, "inf", -(double)INFINITY);
    bis_json_number(&j, "tiny", 5e-324);
    bis_json_number(&j, "third", 1 / 3.0);
    bis_json_number(&j, "huge", -1.7976931348623157e308);
    bis_json_count(&j, "count", UINT64_MAX);
    bis_json_bool(&j, "yes", true);
    bis_json_text(&j, "nothing", NULL);
    bis_json_text(&j, "all bytes \"\\\n", all);
    bis_json_text(&j, "utf8", "\xc3\xa4\xe2\x82\xac\xf0\x9f\x98\x80 \xed\xa0\x80 \xc0\x80 \xf5 \xe2\x82");
    bis_json_open(&j, "list", '[');
    bis_json_number(&j, NULL, 1);
    bis_json_open(&j, NULL, '{');
    bis_json_close(&j);
    bis_json_open(&j, NULL, '[');
    bis_json_close(&j);
    bis_json_close(&j);
    bis_json_close(&j);
    fclose(j.out);
    assert_true(json_is_valid(text));
    assert_string_equal(json_value(buf, sizeof buf, text, "nan"), "null");
    assert_string_equal(json_value(buf, sizeof buf, text, "inf"), "null");
    assert_true(strtod(json_value(buf, sizeof buf, text, "third"), NULL) == 1 / 3.0);
    assert_true(strtod(json_value(buf, sizeof buf, text, "tiny"), NULL) == 5e-324);
    assert_string_equal(json_value(buf, sizeof buf, text, "count"), "18446744073709551615");
    assert_string_equal(json_value(buf, sizeof buf, text, "nothing"), "null");
    /* Surrogates, overlong forms, bytes that begin nothing, cut sequences: one U+FFFD a byte. */
    assert_string_equal(json_value(buf, sizeof buf, text, "utf8"),
                        "\"\xc3\xa4\xe2\x82\xac\xf0\x9f\x98\x80 \\ufffd\\ufffd\\ufffd \\ufffd\\ufffd \\ufffd "
                        "\\ufffd\\ufffd\"");
    free(text);
}

/* The judge itself: what it must refuse. */
static void the_json_reader_refuses_what_is_no_json(void **state)
{
    const char *good[] = {"{}", " [1, -0.5e+3, \"a\\u00e4\"] ", "null", "{\"a\": {\"b\": []}}"};
    const char *bad[] = {"", "{", "{\"a\" 1}", "{\"a\": 1,}", "[1 2]", "nan", "01", "1.", "\"\n\"", "\"\\x\"", "{} {}",
        "{a: 1}", "+1", "\"\\u12\""};
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) assert_true(json_is_valid(good[i]));
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) assert_false(json_is_valid(bad[i]));
}

static void a_rank_that_is_not_the_first_has_no_standard_input(void **state)
{
    bis_ranks second = {.rank = 1, .size = 2};
    bis_scene_desc *d;
    bis_diag diag = {0};
    bis_cli_ranks = &second;
    const bis_status status = bis_cli_parse_scene(&d, "-", 0, &diag);
    bis_cli_ranks = NULL;
    assert_int_equal(status, BIS_INPUT);
    assert_null(d);
    assert_string_equal(diag.messages[0].text, "bis: error: only the first rank has the standard input: give a file");
    bis_diag_clear(&diag);
}

static const expect_word words[] = {{"test", test}, {NULL, NULL}};

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(options_and_operands_may_be_mixed),
        cmocka_unit_test(two_dashes_end_the_options),
        cmocka_unit_test(an_option_that_is_absent_leaves_its_value_alone),
        cmocka_unit_test(the_ends_of_a_range_belong_to_it),
        cmocka_unit_test(shares_may_be_percentages_and_times_have_units),
        cmocka_unit_test(progress_counts_to_the_last_pass_and_tells_minutes),
        cmocka_unit_test(help_and_version_have_a_letter),
        cmocka_unit_test(help_names_every_option_within_80_columns),
        cmocka_unit_test(version_names_the_libraries),
        cmocka_unit_test(a_place_that_cannot_take_a_file_is_known_beforehand),
        cmocka_unit_test(messages_say_who_speaks),
        cmocka_unit_test(no_output_replaces_another_file),
        cmocka_unit_test(the_last_line_tells_how_a_render_ended),
        cmocka_unit_test(exit_statuses_are_those_of_the_contract),
        cmocka_unit_test(json_is_valid_for_any_number_and_any_bytes),
        cmocka_unit_test(a_rank_that_is_not_the_first_has_no_standard_input),
        cmocka_unit_test(the_json_reader_refuses_what_is_no_json),
    };
    return expect_run("cli", tests, sizeof tests / sizeof *tests, NULL, NULL,
                      &(expect_folder){"tests/data/expect/cli", words, NULL});
}
