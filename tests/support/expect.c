/* SPDX-License-Identifier: BSD-2-Clause */
/* expect: read a file by its signs, run each command, compare, and show the difference. */
#include "expect.h"

#include "program.h"

#include <dirent.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* A line of the file: its sign, one or two characters, and its text. */
typedef struct line {
    char sign[3];
    int number;
    char *text;
} line;

typedef struct lines {
    line *at;
    size_t n;
} lines;

typedef struct check {
    const char *path;
    const expect_word *words;
    FILE *report;
} check;

static void add_line(lines *l, const char *sign, int number, const char *text, size_t n)
{
    if ((l->n & (l->n - 1)) == 0) l->at = realloc(l->at, (l->n ? 2 * l->n : 1) * sizeof *l->at);
    line *new = &l->at[l->n++];
    assert_non_null(l->at);
    *new = (line){.number = number, .text = strndup(text, n)};
    snprintf(new->sign, sizeof new->sign, "%s", sign);
}

static void clear_lines(lines *l)
{
    for (size_t i = 0; i < l->n; i++) free(l->at[i].text);
    free(l->at);
    *l = (lines){0};
}

/* ---- reading ---- */

static char *read_all(const char *path)
{
    FILE *f = fopen(path, "rb"), *copy;
    char *text = NULL, part[4096];
    size_t n;
    if (!f) return NULL;
    copy = open_memstream(&text, &n);
    while ((n = fread(part, 1, sizeof part, f)) > 0) fwrite(part, 1, n, copy);
    fclose(f);
    fclose(copy);
    return text;
}

/* The text with each {NAME} that is known replaced, to be freed. */
static char *filled_in(const char *text, size_t n, const expect_text *texts)
{
    char *out = NULL;
    size_t size;
    FILE *f = open_memstream(&out, &size);
    for (size_t i = 0; i < n; i++) {
        const expect_text *t = texts;
        size_t length = 0;
        for (; text[i] == '{' && t && t->name; t++) {
            length = strlen(t->name);
            if (i + length + 1 < n && strncmp(text + i + 1, t->name, length) == 0 && text[i + 1 + length] == '}') break;
        }
        if (text[i] == '{' && t && t->name) fputs(t->text, f), i += length + 1;
        else fputc(text[i], f);
    }
    fclose(f);
    return out;
}

/* False, and a word of why, where a line has no sign. */
static bool read_file(lines *l, const check *c, const char *text, const expect_text *texts)
{
    int number = 1;
    for (const char *at = text; *at; number++) {
        const size_t length = strcspn(at, "\n");
        const bool is_empty = length == 0 || *at == '#';
        const size_t sign = is_empty ? 0 : strchr("$<>!", *at) ? 1u + (length > 1 && at[1] != ' ') : 3;
        const bool is_known = sign < 2 || (sign == 2 && strchr(*at == '$' ? "0123456789" : *at == '<' ? "" : "%=~-",
            at[1]));
        if (!is_known || (length > sign && !is_empty && at[sign] != ' ')) {
            fprintf(c->report, "%s:%d: no line of an .expect: %.*s\n", c->path, number, (int)length, at);
            return false;
        }
        if (sign) {
            const size_t from = sign + (length > sign);
            char mark[3] = {at[0], sign == 2 ? at[1] : '\0', '\0'};
            char *whole = filled_in(at + from, length - from, texts);
            add_line(l, mark, number, whole, strlen(whole));
            free(whole);
        }
        at += length + (at[length] == '\n');
    }
    return true;
}

/* ---- comparing ---- */

/* To 9 digits; what is no number to the last byte. */
static bool same_cells(const char *a, const char *b)
{
    for (;; a++, b++) {
        const size_t n = strcspn(a, ","), m = strcspn(b, ",");
        char *end_a, *end_b;
        const double x = strtod(a, &end_a), y = strtod(b, &end_b);
        const bool numbers = n && m && end_a == a + n && end_b == b + m;
        const bool near = numbers && fabs(x - y) <= 1e-9 * fabs(y) + 1e-12;
        if (!near && (n != m || strncmp(a, b, n) != 0)) return false;
        a += n;
        b += m;
        if (!*a || !*b) return *a == *b;
    }
}

static bool same_line(const line *expected, const line *found)
{
    return expected->sign[1] == '%' ? same_cells(found->text, expected->text)
                                    : strcmp(found->text, expected->text) == 0;
}

/* Lines that must be and lines that are: what differs, between the last line before and the first behind it that do
 * not. */
static bool compare_lines(const check *c, const char *what, const lines *expected, const char *text)
{
    lines found = {0};
    for (const char *at = text; *at;) {
        const size_t n = strcspn(at, "\n");
        add_line(&found, "", 0, at, n);
        if (!at[n]) add_line(&found, "", 0, "(without a line break at the end)", 33);
        at += n + (at[n] == '\n');
    }
    size_t first = 0, n = expected->n, m = found.n;
    while (first < n && first < m && same_line(&expected->at[first], &found.at[first])) first++;
    while (n > first && m > first && same_line(&expected->at[n - 1], &found.at[m - 1])) n--, m--;
    const bool same = first == n && first == m;
    if (!same) {
        fprintf(c->report, "  its %s differ: - is expected, + is found\n", what);
        if (first) fprintf(c->report, "      %s\n", found.at[first - 1].text);
        for (size_t i = first; i < n; i++)
            fprintf(c->report, "    - %s   (line %d)\n", expected->at[i].text, expected->at[i].number);
        for (size_t i = first; i < m; i++) fprintf(c->report, "    + %s\n", found.at[i].text);
        if (m < found.n) fprintf(c->report, "      %s\n", found.at[m].text);
    }
    clear_lines(&found);
    return same;
}

/* Where a part stands, or, by '=', a whole line. */
static const char *place_of(const char *text, const char *part, char kind)
{
    const size_t n = strlen(part);
    const char *at = strstr(text, part);
    if (kind != '=') return at;
    for (at = text; strncmp(at, part, n) != 0 || (at[n] && at[n] != '\n'); at++) {
        at += strcspn(at, "\n");
        if (!*at) return NULL;
    }
    return *at || !n ? at : NULL;
}

/* One stream of a command, '>' or '!'. */
static bool compare(const check *c, char stream, const line *from, size_t n, const char *text)
{
    const char *const what = stream == '>' ? "output" : "messages", *at = text;
    lines whole = {0};
    bool same = true, has_parts = false;
    for (size_t i = 0; i < n && same; i++) {
        if (from[i].sign[0] != stream) continue;
        const char kind = from[i].sign[1];
        const bool is_part = kind == '~' || kind == '=';
        const char *const place = place_of(is_part ? at : text, from[i].text, kind);
        if (is_part) same = place != NULL, has_parts = true;
        else if (kind == '-') same = place == NULL;
        else add_line(&whole, from[i].sign, from[i].number, from[i].text, strlen(from[i].text));
        if (!same)
            fprintf(c->report, "  line %d: %s in its %s: %s\n  which are:\n%s\n", from[i].number,
                    kind == '-' ? "this stands" : at == text ? "this does not stand" :
                    "behind the part before this does not stand", what, from[i].text, text);
        if (is_part && place) at = place + strlen(from[i].text) + (kind == '=' && place[strlen(from[i].text)]);
    }
    if (has_parts && whole.n) fprintf(c->report, "  parts and lines of its %s cannot both be expected\n", what);
    same = same && !(has_parts && whole.n) && (has_parts || compare_lines(c, what, &whole, text));
    clear_lines(&whole);
    return same;
}

/* ---- running ---- */

static int run_bis(const expect_command *c)
{
    static program_run r;
    program_runf(&r, "%s", c->arguments);
    fputs(r.output, c->output);
    fputs(r.messages, c->messages);
    return r.exit_status;
}

/* `ls PATH`: the names in a folder, hidden ones too, or a file's path; status 1 where there is nothing. */
static int run_ls(const expect_command *c)
{
    struct dirent **names = NULL;
    const int n = scandir(c->arguments, &names, NULL, alphasort);
    for (int i = 0; i < n; i++) {
        if (strcmp(names[i]->d_name, ".") != 0 && strcmp(names[i]->d_name, "..") != 0)
            fprintf(c->output, "%s\n", names[i]->d_name);
        free(names[i]);
    }
    free(names);
    if (n < 0 && program_exists(c->arguments)) fprintf(c->output, "%s\n", c->arguments);
    return n < 0 && !program_exists(c->arguments);
}

/* The command of line 0 and what belongs to it, n lines: as it must be? The report says what is not. */
static bool run_command(const check *c, const line *from, size_t n)
{
    static const expect_word bis[] = {{"bis", run_bis}, {"ls", run_ls}, {NULL, NULL}};
    const size_t length = strcspn(from->text, " ");
    const int wanted = from->sign[1] ? from->sign[1] - '0' : 0;
    const expect_word *word = NULL;
    char *out = NULL, *err = NULL, *input = NULL;
    size_t size;

    for (int k = 0; k < 2 && !word; k++) {
        for (const expect_word *w = k ? c->words : bis; w && w->name && !word; w++)
            if (strlen(w->name) == length && strncmp(w->name, from->text, length) == 0) word = w;
    }
    if (!word) {
        fprintf(c->report, "  there is no such command here\n");
        return false;
    }
    FILE *f = open_memstream(&input, &size);
    for (size_t i = 1; i < n; i++) {
        if (from[i].sign[0] == '<') fprintf(f, "%s\n", from[i].text);
    }
    fclose(f);
    FILE *output = open_memstream(&out, &size), *messages = open_memstream(&err, &size);
    const char *const arguments = from->text + length + (from->text[length] == ' ');
    const int status = word->run(&(expect_command){arguments, input, output, messages});
    fclose(output);
    fclose(messages);
    const bool is_skipped = status == EXPECT_SKIPPED, ends_well = is_skipped || status == wanted;
    if (!ends_well) fprintf(c->report, "  ends with status %d, must with %d:\n%s%s", status, wanted, err, out);
    const bool good = ends_well && (is_skipped || (compare(c, '>', from + 1, n - 1, out) &&
        compare(c, '!', from + 1, n - 1, err)));
    free(input);
    free(out);
    free(err);
    return good;
}

char *expect_file(const char *path, const expect_word *words, const expect_text *texts)
{
    char *report = NULL, *text = read_all(path);
    size_t size;
    lines l = {0};
    const check c = {path, words, open_memstream(&report, &size)};
    bool good = false;
    if (!text) {
        fprintf(c.report, "%s: cannot be read\n", path);
    } else if (read_file(&l, &c, text, texts)) {
        good = l.n && l.at[0].sign[0] == '$';
        if (!good) fprintf(c.report, "%s: must begin with a command, \"$ COMMAND\"\n", path);
        for (size_t i = 0, n = 1; i < l.n && good; i += n) {
            for (n = 1; i + n < l.n && l.at[i + n].sign[0] != '$';) n++;
            good = run_command(&c, &l.at[i], n);
            if (!good) fprintf(c.report, "of %s:%d: %s\n", path, l.at[i].number, l.at[i].text);
        }
    }
    fclose(c.report);
    clear_lines(&l);
    free(text);
    if (!good) return report;
    free(report);
    return NULL;
}

/* ---- as tests ---- */

static const expect_folder *here;

static void one_file(void **state)
{
    char *wrong = expect_file(*state, here->words, here->texts);
    if (wrong) fputs(wrong, stderr); /* cmocka cuts a message off */
    free(wrong);
    if (wrong) fail_msg("%s", (const char *)*state);
}

static int is_expect(const struct dirent *e)
{
    const size_t n = strlen(e->d_name);
    return n > 7 && strcmp(e->d_name + n - 7, ".expect") == 0;
}

int expect_run(const char *group, const struct CMUnitTest *tests, size_t n, CMFixtureFunction setup,
               CMFixtureFunction teardown, const expect_folder *folder)
{
    struct dirent **files = NULL;
    const int found = scandir(folder->path, &files, is_expect, alphasort);
    const size_t n_files = found < 0 ? 0 : (size_t)found;
    struct CMUnitTest *all = calloc(n + n_files + 1, sizeof *all);
    here = folder;
    for (size_t i = 0; i < n; i++) all[i] = tests[i];
    for (size_t i = 0; i < n_files; i++) {
        const size_t size = strlen(folder->path) + strlen(files[i]->d_name) + 2;
        char *path = malloc(size), *name = strndup(files[i]->d_name, strlen(files[i]->d_name) - 7);
        snprintf(path, size, "%s/%s", folder->path, files[i]->d_name);
        all[n + i] = (struct CMUnitTest){name, one_file, NULL, NULL, path};
        free(files[i]);
    }
    free(files);
    if (n_files == 0) fprintf(stderr, "%s: no file *.expect\n", folder->path);
    int failed = _cmocka_run_group_tests(group, all, n + n_files, setup, teardown);
    for (size_t i = n; i < n + n_files; i++) free((void *)(uintptr_t)all[i].name), free(all[i].initial_state);
    free(all);
    return failed + (n_files == 0);
}
