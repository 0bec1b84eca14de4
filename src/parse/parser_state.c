/* parser_state: what every file of the parser needs of its state: complaints, the next token, the path of a file. */
#include "parser.h"

#include "bis/base/file.h"
#include "bis/base/mem.h"

#include <errno.h>
#include <stdarg.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- complaints ---- */

void bis_parser_note(bis_parser *p, bis_status status)
{
    if (!status) return;
    if (!p->status) p->status = status;
    if (++p->n_errors == BIS_MAX_ERRORS && !p->stop) {
        bis_error(p->diag, BIS_INPUT, p->token.at, "stopped after %d errors", BIS_MAX_ERRORS);
        p->stop = true;
    }
}

static void complain(bis_parser *p, bis_loc at, const char *fmt, va_list args) BIS_PRINTF(3, 0);

static void complain(bis_parser *p, bis_loc at, const char *fmt, va_list args)
{
    char text[1024];
    vsnprintf(text, sizeof text, fmt, args);
    bis_parser_note(p, bis_error(p->diag, BIS_INPUT, at, "%s", text));
}

bool bis_parser_error(bis_parser *p, bis_loc at, const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    complain(p, at, fmt, args);
    va_end(args);
    return false;
}

bool bis_parser_lose(bis_parser *p, bis_loc at, const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    complain(p, at, fmt, args);
    va_end(args);
    p->lost = true;
    return false;
}

bool bis_parser_nomem(bis_parser *p, bis_loc at)
{
    p->stop = p->lost = true;
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
    p->token = bis_lexer_next(&p->lexer);
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

char *bis_parser_path(bis_parser *p, bis_loc at, const char *name)
{
    bis_status status = BIS_INPUT;
    const char *why = "the name is empty";
    char *path = bis_path_relative_to(at.file, name);

    if (!path) {
        bis_parser_nomem(p, at);
        return NULL;
    }
    if (name[0]) why = why_unreadable(path, &status);
    if (!why) return path;
    if (p->lists_missing && name[0] && status == BIS_INPUT) {
        char *copy = bis_names_find(&p->missing, path, NULL) ? NULL : bis_strdup(path);
        if (!copy) return path;
        if (bis_names_set(&p->missing, path, 0) && bis_scene_desc_add_missing(p->desc, copy)) return path;
        bis_parser_nomem(p, at);
        return path;
    }
    bis_parser_note(p, bis_error(p->diag, status, at, "cannot read \"%s\": %s", bis_parser_word(p, path), why));
    bis_free(path);
    return NULL;
}
