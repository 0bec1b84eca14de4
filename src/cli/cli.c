/* cli: options from a table, SPEC 5.
 *
 * One table per command says everything about an option once: its name, its argument, its range, its help. Reading,
 * checking, the suggestion after a slip ("did you mean") and `--help` all come from it, so none can go out of step with
 * another. Values are written where the table points, which is the command's own stack: nothing here is kept, nothing
 * is allocated but messages.
 *
 * All mistakes of a command line are collected and printed together, as a parser does with a scene. */
#include "cli.h"

#include "bis/base/file.h"
#include "help.h"

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

/* --- help
 * ---------------------------------------------------------------------------------------------------------- */

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

static void print_option(FILE *out, const char *name, const char *argument, const char *help)
{
    char term[128];
    snprintf(term, sizeof term, "--%s%s%s", name, argument ? " " : "", argument ? argument : "");
    bis_cli_print_entry(out, term, help);
}

void bis_cli_help(const bis_command *c, FILE *out)
{
    fprintf(out, "usage: bis %s\n", c->usage);
    print_wrapped(out, c->summary, 0, 0);
    for (size_t i = 0; i < c->n_options; i++) {
        const bis_option *o = &c->options[i];
        if (!o->name) {
            fprintf(out, "\n%s:\n", o->help);
            continue;
        }
        print_option(out, o->name, o->argument, o->help);
    }
    fprintf(out, "\nabout bis:\n");
    print_option(out, "help", NULL, "this text");
    print_option(out, "version", NULL, "version, accelerators and libraries");
    if (c->notes) fprintf(out, "\n%s", c->notes);
}

/* --- values
 * -------------------------------------------------------------------------------------------------------- */

/* Digits alone, in [lo, hi]. */
static bool read_count(uint64_t *value, const char *text, double lo, double hi)
{
    if (*text == '\0' || text[strspn(text, "0123456789")] != '\0') return false;
    errno = 0;
    unsigned long long v = strtoull(text, NULL, 10);
    if (errno == ERANGE || (double)v < lo || (double)v > hi) return false;
    *value = v;
    return true;
}

static bool read_real(double *value, const char *text, double lo, double hi, bool above)
{
    const char *end;
    double v = bis_parse_double(text, &end);
    if (end == text || *end != '\0' || !isfinite(v) || v < lo || v > hi || (above && v == lo)) return false;
    *value = v;
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
        snprintf(buf, size, "a number in %s%s, %s]", o->above ? "(" : "[", lo, hi);
    }
}

static size_t count_names(const char *const *names)
{
    size_t n = 0;
    while (names[n]) n++;
    return n;
}

static bis_status read_name(const bis_option *o, const char *text, bis_diag *diag)
{
    size_t n = count_names(o->names);
    char list[512];
    size_t used = 0;

    for (size_t i = 0; i < n; i++) {
        if (strcmp(o->names[i], text) == 0) {
            *(const char **)o->value = o->names[i];
            return BIS_OK;
        }
        int printed = snprintf(list + used, sizeof list - used, "%s%s", i ? ", " : "", o->names[i]);
        used += (size_t)printed;
        if (used >= sizeof list) used = sizeof list - 1;
    }
    const char *near = bis_nearest_name(text, o->names, n);
    if (near) {
        return bis_error(diag, BIS_INPUT, bis_cli_loc, "--%s: no such thing as \"%s\" (did you mean \"%s\"?); it is one of %s", o->name,
                         text, near, list);
    }
    return bis_error(diag, BIS_INPUT, bis_cli_loc, "--%s: no such thing as \"%s\"; it is one of %s", o->name, text, list);
}

static bis_status read_text(const bis_option *o, const char *text, bis_diag *diag)
{
    if (*text == '\0') return bis_error(diag, BIS_INPUT, bis_cli_loc, "--%s is empty, wants %s", o->name, o->argument);
    if (o->kind == BIS_OPTION_TEXT) {
        *(const char **)o->value = text;
        return BIS_OK;
    }
    bis_texts *texts = o->value;
    if (texts->n == BIS_MAX_TEXTS) {
        return bis_error(diag, BIS_INPUT, bis_cli_loc, "--%s stands here more than %d times", o->name, BIS_MAX_TEXTS);
    }
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
    case BIS_OPTION_REAL: good = read_real(o->value, text, o->lo, o->hi, o->above); break;
    case BIS_OPTION_OWN: good = o->read(o->value, text); break;
    }
    if (good) return BIS_OK;
    if (o->kind != BIS_OPTION_OWN) describe_rule(rule, sizeof rule, o);
    return bis_error(diag, BIS_INPUT, bis_cli_loc, "--%s is \"%s\", must be %s", o->name, text,
                     o->kind == BIS_OPTION_OWN ? o->rule : rule);
}

/* --- the command line
 * ---------------------------------------------------------------------------------------------- */

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

    for (size_t i = 0; i < c->n_options && n < MAX_OPTIONS + 2; i++) {
        if (c->options[i].name) names[n++] = c->options[i].name;
    }
    snprintf(word, sizeof word, "%.*s", (int)length, name);
    const char *near = bis_nearest_name(word, names, n);
    if (near) {
        return bis_error(diag, BIS_INPUT, bis_cli_loc, "unknown option \"--%s\" (did you mean \"--%s\"?)", word, near);
    }
    return bis_error(diag, BIS_INPUT, bis_cli_loc, "unknown option \"--%s\"; `bis %s --help` lists them", word, c->name);
}

/* One option at argv[i], "--name" or "--name=value"; returns how many arguments it took. */
static int read_option(const bis_command *c, int argc, char **argv, int i, bis_diag *diag)
{
    const char *name = argv[i] + 2, *equals = strchr(name, '=');
    size_t length = equals ? (size_t)(equals - name) : strlen(name);
    const bis_option *o = find_option(c, name, length);

    if (!o) {
        unknown_option(c, name, length, diag);
        return 1;
    }
    if (o->given) *o->given = true;
    if (o->kind == BIS_OPTION_FLAG) {
        if (equals) {
            bis_error(diag, BIS_INPUT, bis_cli_loc, "--%s takes no value, has \"%s\"", o->name, equals + 1);
        } else {
            read_value(o, "", diag);
        }
        return 1;
    }
    if (equals) {
        read_value(o, equals + 1, diag);
        return 1;
    }
    if (i + 1 == argc || strncmp(argv[i + 1], "--", 2) == 0) {
        bis_error(diag, BIS_INPUT, bis_cli_loc, "--%s wants a value: --%s %s", o->name, o->name, o->argument);
        return 1;
    }
    read_value(o, argv[i + 1], diag);
    return 2;
}

static void read_arguments(const bis_command *c, int argc, char **argv, const char **operands, int *n_operands, bis_diag *diag)
{
    bool options_over = false;
    int n = 0;

    for (int i = 0; i < argc;) {
        const char *a = argv[i];
        if (!options_over && strcmp(a, "--") == 0) {
            options_over = true;
            i++;
        } else if (!options_over && strncmp(a, "--", 2) == 0) {
            i += read_option(c, argc, argv, i, diag);
        } else if (!options_over && a[0] == '-' && a[1] != '\0') {
            bis_error(diag, BIS_INPUT, bis_cli_loc, "unknown option \"%s\"; options start with \"--\"", a);
            i++;
        } else {
            if (n < c->max_operands) operands[n] = a;
            n++;
            i++;
        }
    }
    if (n < c->min_operands || n > c->max_operands) {
        bis_error(diag, BIS_INPUT, bis_cli_loc, "%s: %d given; usage: bis %s",
                  n < c->min_operands ? "too few operands" : "too many operands", n, c->usage);
    }
    *n_operands = n;
}

bool bis_cli_parse(const bis_command *c, int argc, char **argv, const char **operands, int *n_operands, int *exit_status)
{
    bis_diag diag = {0};

    for (int i = 0; i < argc && strcmp(argv[i], "--") != 0; i++) {
        if (strcmp(argv[i], "--help") == 0) {
            bis_cli_help(c, stdout);
            *exit_status = bis_cli_finish(BIS_EXIT_DONE);
            return false;
        }
        if (strcmp(argv[i], "--help=man") == 0) {
            bis_man_command(c, stdout);
            *exit_status = bis_cli_finish(BIS_EXIT_DONE);
            return false;
        }
        if (strcmp(argv[i], "--version") == 0) {
            bis_cli_version(stdout);
            *exit_status = bis_cli_finish(BIS_EXIT_DONE);
            return false;
        }
    }
    read_arguments(c, argc, argv, operands, n_operands, &diag);
    bool good = diag.n_errors == 0;
    bis_cli_print_diag(&diag, false);
    bis_diag_clear(&diag);
    *exit_status = good ? BIS_EXIT_DONE : BIS_EXIT_USAGE;
    return good;
}

/* --- what all commands end with
 * ------------------------------------------------------------------------------------ */

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

int bis_cli_run(const bis_command *c, int argc, char **argv, bis_cli_body *body, const void *options)
{
    const char *operands[BIS_CLI_MAX_OPERANDS];
    int n, exit_status;
    bis_diag diag = {0};

    if (!bis_cli_parse(c, argc, argv, operands, &n, &exit_status)) return exit_status;
    exit_status = body(options, operands, &diag);
    bis_cli_print_diag(&diag, false);
    bis_diag_clear(&diag);
    return bis_cli_finish(exit_status);
}

bis_status bis_cli_check_writable(const char *path, bis_diag *diag)
{
    struct stat st;
    const char *slash = strrchr(path, '/');
    char folder[4096] = ".";

    if (slash) {
        size_t length = slash == path ? 1 : (size_t)(slash - path);
        if (length >= sizeof folder) return bis_error(diag, BIS_IO, bis_cli_loc, "\"%s\" cannot be written: the name is too long", path);
        memcpy(folder, path, length);
        folder[length] = '\0';
    }
    if (stat(path, &st) == 0 && !S_ISREG(st.st_mode)) {
        return bis_error(diag, BIS_IO, bis_cli_loc, "\"%s\" cannot be written: it is %s", path,
                         S_ISDIR(st.st_mode) ? "a folder" : "not a regular file");
    }
    if (stat(folder, &st) != 0) {
        return bis_error(diag, BIS_IO, bis_cli_loc, "\"%s\" cannot be written: folder \"%s\": %s", path, folder, strerror(errno));
    }
    if (!S_ISDIR(st.st_mode)) {
        return bis_error(diag, BIS_IO, bis_cli_loc, "\"%s\" cannot be written: \"%s\" is not a folder", path, folder);
    }
    if (access(folder, W_OK | X_OK) != 0) {
        return bis_error(diag, BIS_IO, bis_cli_loc, "\"%s\" cannot be written: folder \"%s\": %s", path, folder, strerror(errno));
    }
    return BIS_OK;
}

void bis_cli_use_threads(uint64_t n)
{
#ifdef _OPENMP
    if (n) omp_set_num_threads((int)n);
#else
    (void)n;
#endif
}
