/* SPDX-License-Identifier: BSD-2-Clause */
/* parser_state: what every file of the parser needs of its state: complaints, the next token, the path of a file. */
#include "parser.h"

#include "bis/base/file.h"
#include "bis/base/mem.h"
#include "bis/files/image_file.h"

#include <errno.h>
#include <stdarg.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- complaints ---- */

/* The list ends, and so does the scene: after so many errors the file is probably no scene. */
static void stop_at_many(bis_parser *p)
{
    if (++p->n_listed != BIS_MAX_ERRORS || p->stop) return;
    bis_error(p->diag, BIS_INPUT, p->token.at, "stopped after %d errors", BIS_MAX_ERRORS);
    p->stop = true;
}

void bis_parser_note(bis_parser *p, bis_status status)
{
    if (!status) return;
    if (!p->status) p->status = status;
    p->n_errors++;
    stop_at_many(p);
}

/* What the message is about: without the numbers that stand outside of quotes, errors of one cause read alike. */
static void name_cause(char cause[BIS_CAUSE], const char *text)
{
    size_t n = 0;
    bool is_quoted = false;
    for (; *text && n + 1 < BIS_CAUSE; text++) {
        is_quoted ^= *text == '"';
        if (is_quoted || !strchr("0123456789.+-", *text)) cause[n++] = *text;
    }
    cause[n] = '\0';
}

/* Is it one of a cause that is listed? Then it is counted there. */
static bool is_listed(bis_parser *p, const char *name, bis_loc at)
{
    for (size_t i = 0; i < p->n_causes; i++) {
        bis_cause *c = &p->causes[i];
        if (strcmp(c->name, name) != 0) continue;
        if (c->n < BIS_COUNT(c->others)) c->others[c->n] = at;
        c->n++;
        return true;
    }
    return false;
}

static bis_status complain(bis_parser *p, bis_status status, bis_loc at, const char *text)
{
    char name[BIS_CAUSE];

    if (!p->status) p->status = status;
    p->n_errors++;
    name_cause(name, text);
    if (is_listed(p, name, at)) return status;
    bis_error(p->diag, status, at, "%s", text);
    /* where there is no room, later errors like it are listed one by one */
    if (p->n_causes < BIS_COUNT(p->causes)) {
        bis_cause *c = &p->causes[p->n_causes++];
        *c = (bis_cause){.message = p->diag ? p->diag->n - 1 : 0};
        memcpy(c->name, name, sizeof name);
    }
    stop_at_many(p);
    return status;
}

static void vcomplain(bis_parser *p, bis_loc at, const char *fmt, va_list args) BIS_PRINTF(3, 0);

static void vcomplain(bis_parser *p, bis_loc at, const char *fmt, va_list args)
{
    char text[1024];
    vsnprintf(text, sizeof text, fmt, args);
    complain(p, BIS_INPUT, at, text);
}

/* ` (3 like it; the others are in lines 15, 20)`: the places, as far as they are known. */
static void describe_others(char text[BIS_OTHERS], const bis_cause *c, const char *file)
{
    const size_t shown = c->n < BIS_COUNT(c->others) ? c->n : BIS_COUNT(c->others);

    snprintf(text, BIS_OTHERS, " (%zu like it: also in", c->n + 1);
    for (size_t i = 0; i < shown; i++) {
        const bis_loc at = c->others[i];
        const bool same = at.file && file && strcmp(at.file, file) == 0;
        bis_append(text, BIS_OTHERS, "%s %s%.*s%s%d", i ? "," : "", same ? "line " : "", same ? 0 : 200,
                   at.file ? at.file : "", same ? "" : ":", at.line);
    }
    bis_append(text, BIS_OTHERS, "%s)", c->n > shown ? ", ..." : "");
}

void bis_parser_count_causes(bis_parser *p)
{
    for (size_t i = 0; i < p->n_causes && p->diag; i++) {
        const bis_cause *c = &p->causes[i];
        if (!c->n || c->message >= p->diag->n) continue;
        char **text = &p->diag->messages[c->message].text, others[BIS_OTHERS];
        describe_others(others, c, p->desc->files[0]);
        const size_t n = strlen(*text);
        char *longer = bis_realloc(*text, n + strlen(others) + 1, 1);
        if (!longer) return; /* the number is lost, the message is not */
        strcpy(longer + n, others);
        *text = longer;
    }
}

bool bis_parser_error(bis_parser *p, bis_loc at, const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    vcomplain(p, at, fmt, args);
    va_end(args);
    return false;
}

bool bis_parser_lose(bis_parser *p, bis_loc at, const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    vcomplain(p, at, fmt, args);
    va_end(args);
    p->lost = true;
    return false;
}

bool bis_parser_nomem(bis_parser *p, bis_loc at)
{
    p->stop = p->lost = true; /* without memory every directive would fail and be listed */
    bis_parser_note(p, bis_error(p->diag, BIS_NOMEM, at, "no memory for the scene's description"));
    return false;
}

bool bis_parser_once(bis_parser *p, const char *name)
{
    for (size_t i = 0; i < p->n_warned; i++)
        if (strcmp(p->warned[i], name) == 0) return false;
    if (p->n_warned < BIS_COUNT(p->warned)) p->warned[p->n_warned++] = name;
    return true;
}

const char *bis_parser_hint(bis_parser *p, const char *nearest)
{
    char word[128];
    return bis_hint(p->hint, nearest ? bis_printable(word, nearest, strlen(nearest)) : NULL);
}

const char *bis_parser_word(bis_parser *p, const char *text) { return bis_printable(p->word, text, strlen(text)); }

/* ---- tokens and files ---- */

void bis_parser_advance(bis_parser *p)
{
    p->lexer.takes_rest = p->approximate;
    p->token = bis_lexer_next(&p->lexer);
    if (p->token.has_rest && !p->n_rests++) p->rest_at = p->token.at;
    /* the lexer has complained of it by itself, and knows no status of the whole */
    if (p->token.kind == BIS_TOKEN_BAD) bis_parser_note(p, BIS_INPUT);
}

/* What keeps us from reading it, found before an hour is spent on the rest; NULL: nothing. */
static const char *why_unreadable(const char *path, bis_status *status)
{
    struct stat st;
    *status = BIS_INPUT;
    if (stat(path, &st)) {
        if (errno != ENOENT && errno != ENOTDIR) *status = BIS_IO;
        return strerror(errno);
    }
    if (S_ISDIR(st.st_mode)) return "it is a folder";
    if (!S_ISREG(st.st_mode)) return "it is no regular file";
    if (access(path, R_OK) == 0) return NULL;
    *status = BIS_IO;
    return strerror(errno);
}

/* A file that is there and may not be read is no missing one: another takes its place only where there is none. */
static bool is_absent(const char *path) { return access(path, F_OK) != 0 && (errno == ENOENT || errno == ENOTDIR); }

/* One of the places where a file may lie. False: it is not there, or there is no memory (*path is then NULL). */
static bool lies_at(char **path, const char *beside, const char *name)
{
    struct stat st;
    *path = bis_path_relative_to(beside, name);
    return *path && stat(*path, &st) == 0;
}

/* The places are pbrt's (of v2 to v4 the main scene's folder, of v4 then the working directory), then ours (the folder
 * of the file that names it). */
char *bis_parser_find_file(bis_parser *p, bis_loc at, const char *name)
{
    const char *const beside[] = {p->desc->files[0], "", at.file};
    char *first, *path;

    if (lies_at(&first, beside[0], name) || !first) return first;
    for (size_t i = 1; i < BIS_COUNT(beside); i++) {
        const bool found = lies_at(&path, beside[i], name);
        bis_free(found || !path ? first : path);
        if (found || !path) return path;
    }
    return first;
}

/* Takes over path, which is NULL where there was no memory for it. way_out: what to do about a file that is not there;
 * NULL: nothing but the obvious. */
static char *check_path(bis_parser *p, bis_loc at, const char *name, char *path, const char *way_out)
{
    bis_status status = BIS_INPUT;
    const char *why = "the name is empty";
    char text[1024];

    if (!path) {
        bis_parser_nomem(p, at);
        return NULL;
    }
    if (name[0]) why = why_unreadable(path, &status);
    if (!why) return path;
    if (p->lists_missing && name[0] && status == BIS_INPUT) {
        if (bis_parser_is_missing(p, path)) return path;
        char *copy = bis_names_set(&p->missing, path, 0) ? bis_strdup(path) : NULL;
        if (!copy || !bis_scene_desc_add_missing(p->desc, copy)) bis_parser_nomem(p, at);
        return path;
    }
    const bool has_way_out = way_out && name[0] && is_absent(path);
    snprintf(text, sizeof text, "cannot read \"%s\": %s%s%s", bis_parser_word(p, path), why, has_way_out ? "; " : "",
             has_way_out ? way_out : "");
    complain(p, status, at, text);
    bis_free(path);
    return NULL;
}

bool bis_parser_is_missing(const bis_parser *p, const char *path) { return bis_names_find(&p->missing, path, NULL); }

char *bis_parser_path(bis_parser *p, bis_loc at, const char *name, const char *way_out)
{
    return check_path(p, at, name, bis_parser_find_file(p, at, name), way_out);
}

char *bis_parser_path_or(bis_parser *p, const char **lacks, bis_loc at, const char *name, const bis_stand_in *other)
{
    char *path = other->is_beside ? bis_path_relative_to(at.file, name) : bis_parser_find_file(p, at, name);
    bis_status status;
    *lacks = NULL;
    if (p->approximate && name[0] && path && is_absent(path)) *lacks = other->kind;
    else if (p->approximate && name[0] && path && other->unread && !why_unreadable(path, &status) &&
             !bis_image_check_colours(path, at, p->diag))
        *lacks = other->unread;
    snprintf(p->way_out, sizeof p->way_out, "with --approximate: %s", other->consequence);
    if (!*lacks || p->lists_missing) path = check_path(p, at, name, path, p->way_out);
    if (!*lacks) return path;
    bis_free(path);
    return NULL;
}
