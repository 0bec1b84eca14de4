/* SPDX-License-Identifier: BSD-2-Clause */
/* envelope: see envelope.h. */
#include "envelope.h"
#include "claim.h"

#include <glob.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#ifdef _OPENMP
#include <omp.h>
#endif

static const char long_mark[] = " *(long)*";

/* The rows of this program, in the order in which they were closed. */
enum { MAX_ROWS = 64 };
static envelope rows[MAX_ROWS];
static int n_rows;

bool envelope_long(void)
{
    const char *wish = getenv("BIS_LONG");
    return wish && strcmp(wish, "1") == 0;
}

envelope envelope_row(const char *tried, const char *measure, double bound)
{
    return (envelope){.tried = tried, .measure = measure, .bound = bound};
}

envelope envelope_long_row(const char *tried, const char *measure, double bound)
{
    return (envelope){.tried = tried, .measure = measure, .bound = bound, .is_long = true};
}

void envelope_try(envelope *e, double error, const char *fmt, ...)
{
    va_list args;

    e->n_tries++;
    if (isnan(error)) error = (double)INFINITY;
    if (error <= e->worst) return;
    e->worst = error;
    va_start(args, fmt);
    vsnprintf(e->where, sizeof e->where, fmt, args);
    va_end(args);
}

void envelope_expect(envelope *e, bool right, const char *fmt, ...)
{
    va_list args;

    e->n_tries++;
    if (right) return;
    if (e->worst++ > 0) return;
    va_start(args, fmt);
    vsnprintf(e->where, sizeof e->where, fmt, args);
    va_end(args);
}

void envelope_close(envelope *e)
{
    assert_true(n_rows < MAX_ROWS && e->n_tries > 0);
    rows[n_rows++] = *e;
    if (e->worst <= e->bound) return;
    fail_msg("%s: %s is %.3g, more than %g, at %s", e->tried, e->measure, e->worst, e->bound, e->where);
}

double relative_error(double a, double b)
{
    if (a == b) return 0;
    return fabs(a - b) / fabs(b);
}

void envelope_one_thread(void)
{
#ifdef _OPENMP
    omp_set_num_threads(1);
#endif
}

/* What must be the same on the page. */
static void row_key(char *key, size_t size, const char *tried, const char *measure, const char *bound)
{
    snprintf(key, size, "%s | %s | %s", tried, measure, bound);
}

static void key_of(char *key, size_t size, const envelope *e)
{
    char tried[512], bound[32];

    snprintf(tried, sizeof tried, "%s%s", e->tried, e->is_long ? long_mark : "");
    snprintf(bound, sizeof bound, "%g", e->bound);
    row_key(key, size, tried, e->measure, bound);
}

static void write_section(int number, const char *title)
{
    char path[64], temporary[80], worst[32];

    mkdir("build", 0777);
    mkdir("build/envelope", 0777);
    snprintf(path, sizeof path, "build/envelope/%d.md", number);
    snprintf(temporary, sizeof temporary, "%s.%d.tmp", path, (int)getpid());
    FILE *f = fopen(temporary, "w");
    assert_non_null(f);
    fprintf(f, "## %s\n\n| tried | what is measured | largest | bound |\n| --- | --- | ---: | ---: |\n", title);
    for (int i = 0; i < n_rows; i++) {
        const envelope *e = &rows[i];
        snprintf(worst, sizeof worst, e->worst == 0 ? "0" : "%.1e", e->worst);
        fprintf(f, "| %s%s | %s | %s | %g |\n", e->tried, e->is_long ? long_mark : "", e->measure, worst, e->bound);
    }
    fprintf(f, "\n");
    assert_int_equal(fclose(f), 0);
    assert_int_equal(rename(temporary, path), 0);
}

/* All sections that there are by now; the last program leaves all of them. */
static void join_sections(void)
{
    char temporary[64], line[1024];
    glob_t sections;

    snprintf(temporary, sizeof temporary, "build/envelope.md.%d.tmp", (int)getpid());
    FILE *out = fopen(temporary, "w");
    assert_non_null(out);
    assert_int_equal(glob("build/envelope/?.md", 0, NULL, &sections), 0);
    for (size_t i = 0; i < sections.gl_pathc; i++) {
        FILE *in = fopen(sections.gl_pathv[i], "r");
        assert_non_null(in);
        while (fgets(line, sizeof line, in)) fputs(line, out);
        fclose(in);
    }
    globfree(&sections);
    assert_int_equal(fclose(out), 0);
    assert_int_equal(rename(temporary, "build/envelope.md"), 0);
}

/* The next table row of the section: its key. False at the section's end. */
static bool next_page_row(FILE *f, char *key, size_t size)
{
    char line[1024], tried[512], measure[512], bound[64];

    while (fgets(line, sizeof line, f) && strncmp(line, "## ", 3) != 0) {
        if (sscanf(line, "| %511[^|]| %511[^|]| %*[^|]| %63[^|]", tried, measure, bound) != 3) continue;
        if (strncmp(tried, "tried", 5) == 0 || strncmp(tried, "---", 3) == 0) continue;
        char *const ends[] = {tried, measure, bound};
        for (int i = 0; i < 3; i++) ends[i][strlen(ends[i]) - 1] = '\0'; /* the blank before the bar */
        row_key(key, size, tried, measure, bound);
        return true;
    }
    return false;
}

bool envelope_agrees_with(const char *path, const char *title, char *complaint, size_t size)
{
    char line[1024], heading[256], key[1200], on_page[1200];
    bool found = false, same = true;
    FILE *f = fopen(path, "r");

    snprintf(complaint, size, "%s has no section \"%s\"", path, title);
    if (!f) return false;
    snprintf(heading, sizeof heading, "## %s\n", title);
    while (!found && fgets(line, sizeof line, f)) found = strcmp(line, heading) == 0;
    for (int i = 0; found && same && i <= n_rows; i++) {
        bool more;
        do more = next_page_row(f, on_page, sizeof on_page);
        while (more && !envelope_long() && strstr(on_page, long_mark));
        snprintf(key, sizeof key, "(no more rows)");
        if (i < n_rows) key_of(key, sizeof key, &rows[i]);
        if (!more) snprintf(on_page, sizeof on_page, "(no more rows)");
        same = strcmp(key, on_page) == 0;
        if (!same) snprintf(complaint, size, "%s is stale.\n  tested: %s\n  page:   %s", path, key, on_page);
    }
    fclose(f);
    return found && same;
}

void envelope_finish(int number, const char *title)
{
    char complaint[3000];

    write_section(number, title);
    join_sections();
    if (getenv("BIS_ENVELOPE_WRITE")) return;
    if (!envelope_agrees_with("docs/envelope.md", title, complaint, sizeof complaint))
        fail_msg("%s\n`make envelope` writes it anew", complaint);
}
