/* SPDX-License-Identifier: BSD-2-Clause */
/* cli: options from a table, docs/command-line.md.
 *
 * One table per command says everything about an option once: its name, its argument, its range, its help. Reading,
 * checking, the suggestion after a slip ("did you mean") and `--help` all come from it, so none can go out of step with
 * another. Values are written where the table points, which is the command's own stack: nothing here is kept, nothing
 * is allocated but messages.
 *
 * All mistakes of a command line are collected and printed together, as a parser does with a scene. */
#include "cli.h"

#include "base/text.h"
#include "bis/base/file.h"
#include "bis/base/mem.h"
#include "bis/files/image_file.h"
#include "man.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#ifdef _OPENMP
#include <omp.h>
#endif

const bis_loc bis_cli_loc = {"bis", 0, 0};

enum { HELP_WIDTH = 80, HELP_INDENT = 26, MAX_OPTIONS = 64 };

/* ---- help ---- */

/* Print text, words wrapped between columns indent and HELP_WIDTH; the cursor stands at `column`. */
static void print_wrapped(FILE *out, const char *text, int indent, int column)
{
    while (*text) {
        size_t word = strcspn(text, " ");
        if (column > indent && column + 1 + (int)word > HELP_WIDTH) {
            fprintf(out, "\n%*s", indent, "");
            column = indent;
        } else if (column > indent) {
            fputc(' ', out);
            column++;
        }
        fprintf(out, "%.*s", (int)word, text);
        column += (int)word;
        text += word;
        text += strspn(text, " ");
    }
    fputc('\n', out);
}

void bis_cli_print_text(FILE *out, const char *text) { print_wrapped(out, text, 0, 0); }

void bis_cli_print_entry(FILE *out, const char *term, const char *text)
{
    int width = fprintf(out, "  %s", term);
    if (width > HELP_INDENT - 2) {
        fputc('\n', out);
        width = 0;
    }
    fprintf(out, "%*s", HELP_INDENT - width, "");
    print_wrapped(out, text, HELP_INDENT, HELP_INDENT);
}

void bis_cli_help(const bis_command *c, FILE *out)
{
    fprintf(out, "usage: bis %s\n", c->usage);
    print_wrapped(out, c->summary, 0, 0);
    for (const bis_option *o = c->options; o < c->options + c->n_options; o++) {
        char term[BIS_CLI_TERM];
        if (o->name) bis_cli_print_entry(out, bis_cli_term(term, o), o->help);
        else fprintf(out, "\n%s:\n", o->help);
    }
    fprintf(out, "\nabout bis:\n");
    bis_cli_print_entry(out, "-h, --help", "this text");
    bis_cli_print_entry(out, "-V, --version", "version, accelerators and libraries");
    if (c->notes) fprintf(out, "\n%s", c->notes);
}

/* ---- values ---- */

/* A bound of the table as an integer: exact, since no range ends between 2^53 and 2^64. */
static uint64_t count_bound(double bound) { return bound >= 0x1p64 ? UINT64_MAX : (uint64_t)bound; }

/* Digits alone, in [lo, hi]; compared as integers, because 2^53 + 1 is no double. */
static bool read_count(uint64_t *value, const char *text, double lo, double hi)
{
    if (*text == '\0' || text[strspn(text, "0123456789")] != '\0') return false;
    errno = 0;
    unsigned long long v = strtoull(text, NULL, 10);
    if (errno == ERANGE || v < count_bound(lo) || v > count_bound(hi)) return false;
    *value = v;
    return true;
}

/* What may follow a number, and what the number is then divided by or multiplied by. Each table's first entry is the
 * unit "", a plain number. Dividing by 100 and not multiplying by 0.01 makes 5% the double nearest to 0.05. */
typedef struct unit {
    const char *name;
    double times, over;
} unit;

static const unit no_units[] = {{"", 1, 1}, {NULL, 0, 0}};
static const unit shares[] = {{"", 1, 1}, {"%", 1, 100}, {NULL, 0, 0}};
static const unit times[] = {{"", 1, 1}, {"s", 1, 1}, {"min", 60, 1}, {"h", 3600, 1}, {NULL, 0, 0}};

/* A number in the option's range, with one of the units. Returns the unit, NULL where the text is no such number. */
static const unit *read_real(double *value, const bis_option *o, const char *text, const unit *units)
{
    const char *end;
    double v = bis_parse_double(text, &end);

    if (end == text) return NULL;
    while (units->name && strcmp(units->name, end) != 0) units++;
    if (!units->name) return NULL;
    v = v * units->times / units->over;
    if (!isfinite(v) || v < o->lo || v > o->hi || (o->above && v == o->lo)) return NULL;
    *value = v;
    return units;
}

const char *bis_cli_digits(const char *text, int lo, int hi, int *value)
{
    char *end;
    if (*text < '0' || *text > '9') return NULL;
    const long v = strtol(text, &end, 10);
    *value = (int)v;
    return v >= lo && v <= hi ? end : NULL;
}

bool bis_cli_read_size(void *value, const char *text)
{
    int *size = value;
    const char *rest = bis_cli_digits(text, 1, BIS_IMAGE_MAX_SIDE, &size[0]);
    if (!rest || *rest != 'x') return false;
    rest = bis_cli_digits(rest + 1, 1, BIS_IMAGE_MAX_SIDE, &size[1]);
    return rest && !*rest;
}

/* "--error 5" renders until the error is 500 %. It may be meant, but 5 % is likelier. */
static bool read_share(const bis_option *o, const char *text, bis_diag *diag)
{
    double v;
    const unit *u = read_real(&v, o, text, shares);

    if (!u) return false;
    *(double *)o->value = v;
    if (v > 1 && *u->name == '\0')
        bis_warn(diag, bis_cli_loc, "--%s %s is %g %%: did you mean --%s %s%%, which is %g? If not, write %g%%",
                 o->name, text, 100 * v, o->name, text, v / 100, 100 * v);
    return true;
}

/* What a value of the option must be: "an integer in [1, 64]". */
static void describe_rule(char *buf, size_t size, const bis_option *o)
{
    char lo[32], hi[32];
    bis_format_double(lo, o->lo);
    bis_format_double(hi, o->hi);
    if (o->kind == BIS_OPTION_COUNT && o->hi >= 0x1p64) {
        snprintf(buf, size, "an integer >= %s, below 2^64", lo);
    } else if (o->kind == BIS_OPTION_COUNT) {
        snprintf(buf, size, "an integer in [%.0f, %.0f]", o->lo, o->hi);
    } else if (o->hi == (double)INFINITY) {
        snprintf(buf, size, "a number %s %s", o->above ? ">" : ">=", lo);
    } else {
        const bool is_time = o->kind == BIS_OPTION_SECONDS;
        const char *of = is_time ? "of seconds " : "", *open = o->above ? "(" : "[", *also = "";
        if (is_time) also = ", or with a unit: 10s, 2min, 1.5h";
        if (o->kind == BIS_OPTION_SHARE) also = ", as in 0.05, or 5%";
        snprintf(buf, size, "a number %sin %s%s, %s]%s", of, open, lo, hi, also);
    }
}

static bis_status read_name(const bis_option *o, const char *text, bis_diag *diag)
{
    char list[512] = "", hint[BIS_HINT];
    size_t n = 0;

    for (; o->names[n]; n++) {
        if (strcmp(o->names[n], text) == 0) {
            *(const char **)o->value = o->names[n];
            return BIS_OK;
        }
        bis_append(list, sizeof list, "%s%s", n ? ", " : "", o->names[n]);
    }
    return bis_error(diag, BIS_INPUT, bis_cli_loc, "--%s: no such thing as \"%s\"%s; it is one of %s%s", o->name, text,
                     bis_hint(hint, bis_nearest_name(text, o->names, n)), list, o->rule ? o->rule : "");
}

static bis_status read_text(const bis_option *o, const char *text, bis_diag *diag)
{
    if (*text == '\0') return bis_error(diag, BIS_INPUT, bis_cli_loc, "--%s is empty, wants %s", o->name, o->argument);
    if (o->kind == BIS_OPTION_TEXT) {
        *(const char **)o->value = text;
        return BIS_OK;
    }
    bis_texts *texts = o->value;
    if (texts->n == BIS_MAX_TEXTS)
        return bis_error(diag, BIS_INPUT, bis_cli_loc, "--%s stands here more than %d times", o->name, BIS_MAX_TEXTS);
    texts->text[texts->n++] = text;
    return BIS_OK;
}

static bis_status read_value(const bis_option *o, const char *text, bis_diag *diag)
{
    char rule[160];
    bool good = true;

    switch (o->kind) {
    case BIS_OPTION_FLAG: *(bool *)o->value = true; return BIS_OK;
    case BIS_OPTION_TEXT:
    case BIS_OPTION_LIST: return read_text(o, text, diag);
    case BIS_OPTION_NAME: return read_name(o, text, diag);
    case BIS_OPTION_COUNT: good = read_count(o->value, text, o->lo, o->hi); break;
    case BIS_OPTION_REAL: good = read_real(o->value, o, text, no_units); break;
    case BIS_OPTION_SHARE: good = read_share(o, text, diag); break;
    case BIS_OPTION_SECONDS: good = read_real(o->value, o, text, times); break;
    case BIS_OPTION_OWN: good = o->read(o->value, text); break;
    }
    if (good) return BIS_OK;
    if (o->kind != BIS_OPTION_OWN) describe_rule(rule, sizeof rule, o);
    return bis_error(diag, BIS_INPUT, bis_cli_loc, "--%s is \"%s\", must be %s", o->name, text,
                     o->kind == BIS_OPTION_OWN ? o->rule : rule);
}

/* ---- the command line ---- */

static const bis_option *find_option(const bis_command *c, const char *name, size_t length)
{
    for (size_t i = 0; i < c->n_options; i++) {
        const char *known = c->options[i].name;
        if (known && strlen(known) == length && strncmp(known, name, length) == 0) return &c->options[i];
    }
    return NULL;
}

static bis_status unknown_option(const bis_command *c, const char *name, size_t length, bis_diag *diag)
{
    const char *names[MAX_OPTIONS + 2] = {"help", "version"};
    size_t n = 2;
    char word[64];

    for (size_t i = 0; i < c->n_options && n < MAX_OPTIONS + 2; i++)
        if (c->options[i].name) names[n++] = c->options[i].name;
    snprintf(word, sizeof word, "%.*s", (int)length, name);
    const char *near = bis_nearest_name(word, names, n);
    if (near)
        return bis_error(diag, BIS_INPUT, bis_cli_loc, "unknown option \"--%s\" (did you mean \"--%s\"?)", word, near);
    return bis_error(diag, BIS_INPUT, bis_cli_loc, "unknown option \"--%s\"; `bis %s --help` lists them", word,
                     c->name);
}

/* One option at argv[i], "--name" or "--name=value"; returns how many arguments it took. *is_unknown is set where the
 * command has no such option. */
static int read_option(const bis_command *c, int argc, char **argv, int i, bool *is_unknown, bis_diag *diag)
{
    const char *name = argv[i] + 2, *equals = strchr(name, '=');
    size_t length = equals ? (size_t)(equals - name) : strlen(name);
    const bis_option *o = find_option(c, name, length);

    *is_unknown |= !o;
    if (o && o->given) *o->given = true;
    if (!o) unknown_option(c, name, length, diag);
    else if (o->kind == BIS_OPTION_FLAG && equals)
        bis_error(diag, BIS_INPUT, bis_cli_loc, "--%s takes no value, has \"%s\"", o->name, equals + 1);
    else if (o->kind == BIS_OPTION_FLAG || equals) read_value(o, equals ? equals + 1 : "", diag);
    else if (i + 1 == argc || strncmp(argv[i + 1], "--", 2) == 0)
        bis_error(diag, BIS_INPUT, bis_cli_loc, "--%s wants a value: --%s %s", o->name, o->name, o->argument);
    else {
        read_value(o, argv[i + 1], diag);
        return 2;
    }
    return 1;
}

static void read_arguments(const bis_command *c, int argc, char **argv, const char **operands, int *n_operands,
                           bis_diag *diag)
{
    bool options_over = false, has_unknown = false;
    int n = 0;

    for (int i = 0, taken; i < argc; i += taken) {
        const char *a = argv[i];
        taken = 1;
        if (options_over || a[0] != '-' || a[1] == '\0') {
            if (n < c->max_operands) operands[n] = a;
            n++;
        } else if (strcmp(a, "--") == 0) {
            options_over = true;
        } else if (a[1] == '-') {
            taken = read_option(c, argc, argv, i, &has_unknown, diag);
        } else {
            bis_error(diag, BIS_INPUT, bis_cli_loc, "unknown option \"%s\"; options start with \"--\"", a);
            has_unknown = true;
        }
    }
    /* Behind an unknown option its value looks like an operand: what is one too many then is no mistake of its own. */
    if (n < c->min_operands || (n > c->max_operands && !has_unknown))
        bis_error(diag, BIS_INPUT, bis_cli_loc, "%s: %d given; usage: bis %s",
                  n < c->min_operands ? "too few operands" : "too many operands", n, c->usage);
    *n_operands = n;
}

/* Is this a question about the command? It is answered then. */
static bool answers(const bis_command *c, const char *argument)
{
    if (strcmp(argument, "--help") == 0 || strcmp(argument, "-h") == 0) bis_cli_help(c, stdout);
    else if (strcmp(argument, "--help=man") == 0) bis_man_command(c, stdout);
    else if (strcmp(argument, "--version") == 0 || strcmp(argument, "-V") == 0) bis_cli_version(stdout);
    else return false;
    return true;
}

/* Print the messages, without warnings where the command has --quiet and it was given. */
static void print_and_clear(const bis_command *c, bis_diag *diag)
{
    const bis_option *quiet = find_option(c, "quiet", strlen("quiet"));
    bis_cli_print_diag(diag, quiet && *(const bool *)quiet->value);
    bis_diag_clear(diag);
}

bool bis_cli_parse(const bis_command *c, int argc, char **argv, const char **operands, int *n_operands,
                   int *exit_status)
{
    bis_diag diag = {0};

    for (int i = 0; i < argc && strcmp(argv[i], "--") != 0; i++) {
        if (!answers(c, argv[i])) continue;
        *exit_status = bis_cli_finish(BIS_EXIT_DONE);
        return false;
    }
    read_arguments(c, argc, argv, operands, n_operands, &diag);
    bool good = diag.n_errors == 0;
    print_and_clear(c, &diag);
    *exit_status = good ? BIS_EXIT_DONE : BIS_EXIT_USAGE;
    return good;
}

/* ---- what all commands end with ---- */

/* Who speaks, where a message names no file. */
static const char *speaker(const char *text)
{
    const bool has_place = strncmp(text, "error: ", 7) != 0 && strncmp(text, "warning: ", 9) != 0;
    return has_place ? "" : "bis: ";
}

void bis_cli_print_diag(const bis_diag *diag, bool quiet)
{
    for (size_t i = 0; i < diag->n; i++) {
        const bis_message *m = &diag->messages[i];
        if (m->is_error || !quiet) fprintf(stderr, "%s%s\n", speaker(m->text), m->text);
    }
    if (diag->n_lost) fprintf(stderr, "bis: error: %zu more messages were lost for lack of memory\n", diag->n_lost);
}

int bis_cli_exit_status(bis_status status)
{
    if (status == BIS_OK) return BIS_EXIT_DONE;
    return status == BIS_INPUT ? BIS_EXIT_USAGE : BIS_EXIT_FAILED;
}

int bis_cli_finish(int status)
{
    if (fflush(stdout) == 0 && !ferror(stdout)) return status;
    fprintf(stderr, "bis: error: standard output cannot be written: %s\n", strerror(errno));
    return status ? status : BIS_EXIT_FAILED;
}

int bis_cli_run(const bis_command *c, int argc, char **argv, bis_cli_body *body, void *options)
{
    const char *operands[BIS_CLI_MAX_OPERANDS] = {NULL};
    int n, exit_status;
    bis_diag diag = {0};

    if (!bis_cli_parse(c, argc, argv, operands, &n, &exit_status)) return exit_status;
    exit_status = body(options, operands, &diag);
    print_and_clear(c, &diag);
    return bis_cli_finish(exit_status);
}

bis_status bis_cli_check_writable(const char *path, bis_diag *diag)
{
    struct stat st;
    char target[PATH_MAX], folder[PATH_MAX] = ".";
    bis_outfile *file;

    if (stat(path, &st) == 0 && !S_ISREG(st.st_mode))
        return bis_error(diag, BIS_IO, bis_cli_loc, "\"%s\" cannot be written: it is %s", path,
                         S_ISDIR(st.st_mode) ? "a folder" : "not a regular file");
    bis_status status = bis_file_target(target, path, diag);
    if (status) return status;
    const char *slash = strrchr(target, '/');
    if (slash) snprintf(folder, sizeof folder, "%.*s", slash == target ? 1 : (int)(slash - target), target);
    const bool is_there = stat(folder, &st) == 0;
    if (is_there && !S_ISDIR(st.st_mode))
        return bis_error(diag, BIS_IO, bis_cli_loc, "\"%s\" cannot be written: \"%s\" is not a folder", path, folder);
    if (!is_there || access(folder, W_OK | X_OK) != 0)
        return bis_error(diag, BIS_IO, bis_cli_loc, "\"%s\" cannot be written: folder \"%s\": %s", path, folder,
                         strerror(errno));
    status = bis_outfile_open(&file, path, diag); /* the surest test is to do it */
    if (!status) bis_outfile_abort(file);
    return status;
}

/* A pipe or a device takes what is written, and is lost to nobody. */
static bool is_lost_when_written(const char *path)
{
    struct stat st;
    return strcmp(path, "-") != 0 && (stat(path, &st) != 0 || S_ISREG(st.st_mode));
}

bis_status bis_cli_check_distinct(const char *const *inputs, size_t n_inputs, const char *const *outputs,
                                  size_t n_outputs, bis_diag *diag)
{
    for (size_t i = 0; i < n_outputs; i++) {
        if (!is_lost_when_written(outputs[i])) continue;
        for (size_t k = 0; k < n_inputs; k++) {
            if (!bis_file_is_same(outputs[i], inputs[k])) continue;
            return bis_error(diag, BIS_INPUT, bis_cli_loc,
                             "output \"%s\" would replace \"%s\", which is read; give the output another name",
                             outputs[i], inputs[k]);
        }
        for (size_t k = 0; k < i; k++) {
            if (!bis_file_is_same(outputs[i], outputs[k])) continue;
            return bis_error(diag, BIS_INPUT, bis_cli_loc,
                             "outputs \"%s\" and \"%s\" are one file; give one of them another name", outputs[k],
                             outputs[i]);
        }
    }
    return BIS_OK;
}

int bis_cli_load_map(bis_light **light, bis_light_desc *desc, const char *path, const char *mapping, unsigned needs,
                     bis_diag *diag)
{
    int exit_status = BIS_EXIT_FAILED;
    bis_image image = {0};
    bool is_strip;

    *light = NULL;
    desc->mapping = mapping ? bis_mapping_find(mapping) : BIS_MAPPING_LATLONG;
    desc->has_mapping = mapping != NULL;
    desc->loc = (bis_loc){path, 0, 0};
    desc->filename = bis_strdup(path);
    if (!desc->filename) bis_error(diag, BIS_NOMEM, bis_cli_loc, "no memory");
    else if (!bis_image_read_map(&image, &is_strip, path, (bis_loc){0}, diag)) {
        bis_light_take_layout(desc, is_strip);
        exit_status = bis_cli_exit_status(bis_light_from_image(light, &image, desc, needs, diag));
    }
    bis_image_clear(&image);
    bis_free(desc->filename);
    desc->filename = NULL;
    return exit_status;
}

bis_status bis_cli_parse_scene(bis_scene_desc **out, const char *operand, unsigned how, bis_diag *diag)
{
    static const char name[] = "<stdin>";
    unsigned char *text;
    size_t size;

    if (strcmp(operand, "-") != 0) return bis_scene_parse_as(out, operand, how, diag);
    *out = NULL;
    if (bis_cli_ranks)
        return bis_error(diag, BIS_INPUT, bis_cli_loc, "only the first rank has the standard input: give a file");
    bis_status status = bis_file_read_open(&text, &size, STDIN_FILENO, name, diag);
    if (!status && strlen((char *)text) < size)
        status = bis_error(diag, BIS_INPUT, (bis_loc){name, 0, 0}, "byte %zu is 0: a scene is text",
                           strlen((char *)text) + 1);
    if (!status) status = bis_scene_parse_text(out, name, (char *)text, how, diag);
    bis_free(text);
    return status;
}

volatile sig_atomic_t bis_cli_signal;

static void catch_signal(int number)
{
    (void)number;
    bis_cli_signal = 1;
}

void bis_cli_catch_signals(void)
{
    const struct sigaction action = {.sa_handler = catch_signal, .sa_flags = (int)(SA_RESETHAND | SA_RESTART)};
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    sigaction(SIGHUP, &action, NULL);
}

void bis_cli_use_threads(uint64_t n)
{
#ifdef _OPENMP
    if (n) omp_set_num_threads((int)n);
#else
    (void)n;
#endif
}
