/* SPDX-License-Identifier: BSD-2-Clause */
/* tokens: lexer, comparison of items, refusal, prints. */
#include "tokens.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- lexer ---- */

static bool is(const token *t, const char *text)
{
    return t->n == strlen(text) && memcmp(t->text, text, t->n) == 0;
}
static bool same(const token *a, const token *b)
{
    return a->kind == b->kind && a->n == b->n && memcmp(a->text, b->text, a->n) == 0;
}

static void set_fault(token_file *f, unsigned line, const char *what)
{
    if (!f->fault[0]) snprintf(f->fault, sizeof f->fault, "line %u: %s", line, what);
}

/* The file without its continued lines, and the line of each byte. Compilers take blanks behind the backslash for
 * nothing. */
static char *unfold(const char *raw, size_t n, unsigned *lines)
{
    char *text = malloc(n + 2);
    size_t k = 0;
    unsigned line = 1;

    if (!text) return NULL;
    for (size_t i = 0; i < n; i++) {
        size_t end = i + 1;
        while (raw[i] == '\\' && end < n && strchr(" \t\v\f\r", raw[end]))
            end++;
        if (raw[i] == '\\' && end < n && raw[end] == '\n') {
            i = end;
            line++;
            continue;
        }
        lines[k] = line;
        text[k++] = raw[i] == '\r' ? ' ' : raw[i];
        if (raw[i] == '\n') line++;
    }
    lines[k] = line;
    text[k] = '\0';
    return text;
}

typedef struct lexer {
    token_file *f;
    char *text;
    const unsigned *lines;
    size_t at;
    bool in_directive, at_line_start, is_template, in_hole;
} lexer;

static void add(lexer *x, token_kind kind, size_t begin)
{
    if (!x->in_hole) x->f->tokens[x->f->n++] = (token){kind, x->text + begin, x->at - begin, x->lines[begin], false};
}

/* What a comment holds is nobody's business, and no compiler's: it becomes blanks (tokens_write). */
static void blank_out(lexer *x, size_t begin)
{
    for (size_t i = begin; i < x->at; i++) {
        if (x->text[i] != '\n') x->text[i] = ' ';
    }
}

/* A comment of a template may begin or end a hole. */
static void comment(lexer *x)
{
    const size_t begin = x->at;
    const char *end = strstr(x->text + begin + 2, "*/");

    if (!end) {
        set_fault(x->f, x->lines[begin], "a comment without an end");
        x->at += strlen(x->text + begin);
        return;
    }
    x->at = (size_t)(end - x->text) + 2;
    const size_t n = x->at - begin;
    if (!x->is_template) blank_out(x, begin);
    if (!x->is_template || n < 8 || memcmp(x->text + begin, "/* [", 4) != 0 || memcmp(end - 2, "] ", 2) != 0) return;
    const bool ends = n == 11 && memcmp(x->text + begin, "/* [end] */", 11) == 0;
    if (!ends) add(x, TOKEN_HOLE, begin);
    x->in_hole = !ends;
}

static void quoted(lexer *x)
{
    const size_t begin = x->at;
    const char quote = x->text[x->at++];

    while (x->text[x->at] != quote) {
        if (x->text[x->at] == '\\' && x->text[x->at + 1]) x->at++;
        if (x->text[x->at] == '\0' || x->text[x->at] == '\n') {
            set_fault(x->f, x->lines[begin], "a quotation mark without its other half");
            return;
        }
        if (x->text[x->at] == '?' && x->text[x->at + 1] == '?' && strchr("=/'()!<>-", x->text[x->at + 2]))
            set_fault(x->f, x->lines[x->at], "two question marks, which may be a trigraph");
        x->at++;
    }
    x->at++;
    add(x, TOKEN_STRING, begin);
}

static bool is_word(char c)
{
    return isalnum((unsigned char)c) || c == '_' || c == '$' || (unsigned char)c >= 128;
}

static void word(lexer *x)
{
    const size_t begin = x->at;
    const bool number = isdigit((unsigned char)x->text[begin]) || x->text[begin] == '.';

    x->at++;
    for (;; x->at++) {
        const char c = x->text[x->at];
        if (is_word(c) || (number && (c == '.' || ((c == '+' || c == '-') && strchr("eEpP", x->text[x->at - 1])))))
            continue;
        break;
    }
    add(x, number ? TOKEN_NUMBER : TOKEN_NAME, begin);
}

static void mark(lexer *x)
{
    static const char *const long_ones[] = {
        "...", "<<=", ">>=", "->", "++", "--", "<<", ">>", "<=", ">=", "==", "!=", "&&",
        "||",  "+=",  "-=",  "*=", "/=", "%=", "&=", "|=", "^=", "##", "%:", "<%", "<:"};
    const size_t begin = x->at;
    size_t n = 1;

    for (size_t i = 0; i < sizeof long_ones / sizeof *long_ones && n == 1; i++) {
        if (strncmp(x->text + begin, long_ones[i], strlen(long_ones[i])) == 0) n = strlen(long_ones[i]);
    }
    x->at += n;
    if (n == 1 && x->text[begin] == '#' && x->at_line_start) {
        x->in_directive = true;
        add(x, TOKEN_DIRECTIVE, begin);
    } else {
        add(x, TOKEN_MARK, begin);
    }
}

static void lex(lexer *x)
{
    x->at_line_start = true;
    while (x->text[x->at]) {
        const char *c = x->text + x->at;
        bool blank = true;
        if (*c == '\n') {
            const size_t begin = x->at++;
            if (x->in_directive) add(x, TOKEN_LINE_END, begin);
            x->in_directive = false;
            x->at_line_start = true;
            continue;
        }
        if (isspace((unsigned char)*c))
            x->at++;
        else if (c[0] == '/' && c[1] == '*')
            comment(x);
        else if (c[0] == '/' && c[1] == '/') {
            const size_t begin = x->at;
            x->at += strcspn(c, "\n");
            blank_out(x, begin);
        } else
            blank = false;
        if (blank) continue;
        if (c[0] == '?' && c[1] == '?') set_fault(x->f, x->lines[x->at], "two question marks, which may be a trigraph");
        if (*c == '"' || *c == '\'')
            quoted(x);
        else if (is_word(*c) || (*c == '.' && isdigit((unsigned char)c[1])))
            word(x);
        else
            mark(x);
        x->at_line_start = false;
    }
    if (x->in_directive) add(x, TOKEN_LINE_END, x->at);
    if (x->in_hole) set_fault(x->f, x->lines[x->at], "a fragment without an [end]");
}

/* A directive, a function (its { follows a parenthesis, or a declaration as of 1978) or what a semicolon ends. */
static void cut(token_file *f)
{
    size_t begin = 0;
    int depth = 0;
    bool body = false, directive = false;

    for (size_t i = 0; i < f->n; i++) {
        const token *t = &f->tokens[i];
        bool ends = false;
        if (t->kind == TOKEN_DIRECTIVE) {
            directive = true;
            if (depth == 0 && i > begin) { /* a macro's name alone stands before it */
                f->items[f->n_items++] = (token_item){begin, i};
                begin = i;
            }
        }
        if (directive) {
            directive = t->kind != TOKEN_LINE_END;
            ends = !directive && depth == 0;
        } else if (t->kind == TOKEN_HOLE) {
            ends = depth == 0 && i == begin;
        } else if (t->kind == TOKEN_MARK) {
            if (is(t, "{")) {
                if (depth == 0) body = i == begin || is(t - 1, ")");
                depth++;
            } else if (is(t, "}")) {
                depth--;
                if (depth < 0) set_fault(f, t->line, "a brace closes what none has opened");
                ends = depth == 0 && body;
            } else if (is(t, ";")) {
                ends = depth == 0;
            }
        }
        if (!ends && i + 1 < f->n) continue;
        f->items[f->n_items++] = (token_item){begin, i + 1};
        begin = i + 1;
    }
    if (depth > 0) set_fault(f, f->n ? f->tokens[f->n - 1].line : 1, "a brace is not closed");
}

static char *contents(const char *path, size_t *n)
{
    FILE *f = fopen(path, "rb");
    char *raw = f ? malloc(TOKEN_BYTES + 1) : NULL;

    if (raw) *n = fread(raw, 1, TOKEN_BYTES + 1, f);
    if (f) fclose(f);
    return raw;
}

bool tokens_read(token_file *f, const char *path, bool is_template)
{
    size_t n = 0;
    char *raw = contents(path, &n);

    *f = (token_file){.lines = malloc((n + 2) * sizeof *f->lines),
                      .tokens = calloc(n + 8, sizeof *f->tokens),
                      .items = calloc(n + 8, sizeof *f->items)};
    if (!raw || !f->lines || !f->tokens || !f->items)
        snprintf(f->fault, sizeof f->fault, "it cannot be read");
    else if (n > TOKEN_BYTES)
        snprintf(f->fault, sizeof f->fault, "it has more than a million bytes");
    else if (memchr(raw, '\0', n))
        snprintf(f->fault, sizeof f->fault, "it is no text");
    else if ((f->text = unfold(raw, n, f->lines))) {
        lex(&(lexer){.f = f, .text = f->text, .lines = f->lines, .is_template = is_template});
        cut(f);
    }
    free(raw);
    return f->text && !f->fault[0];
}

void tokens_clear(token_file *f)
{
    free(f->text);
    free(f->lines);
    free(f->tokens);
    free(f->items);
    *f = (token_file){0};
}

bool tokens_write(const token_file *f, const char *path)
{
    FILE *out = fopen(path, "w");
    unsigned line = 1;

    for (const char *c = f->text; out && *c; c++) {
        for (; *c == '\n' && line < f->lines[c - f->text]; line++)
            putc('\n', out); /* of lines that were continued */
        putc(*c, out);
        line += *c == '\n';
    }
    return out && fclose(out) == 0;
}

/* ---- what is theirs ---- */

static bool among(const token *t, const char *words)
{
    for (const char *w = words; *w;) {
        const size_t n = strcspn(w, " ");
        if (n == t->n && memcmp(w, t->text, n) == 0) return true;
        w += n;
        w += *w == ' ';
    }
    return false;
}

static const char *const words_of_c =
    "auto break case char const continue default do double else enum extern float for goto if inline int long register "
    "restrict return short signed sizeof static struct switch typedef union unsigned void volatile while bool";

/* The tokens t[0..n) of theirs against an item of ours, whose holes take the shortest run that lets the rest follow;
 * the last hole all but the rest. */
static bool fits(token *t, size_t n, const token *ours, size_t n_ours)
{
    for (; n_ours > 0 && ours->kind != TOKEN_HOLE; t++, n--, ours++, n_ours--) {
        if (n == 0 || !same(t, ours)) return false;
    }
    if (n_ours == 0) return n == 0;
    for (size_t skip = 0; skip <= n; skip++) {
        if (fits(t + skip, n - skip, ours + 1, n_ours - 1)) {
            for (size_t i = 0; i < skip; i++)
                t[i].theirs = true;
            return true;
        }
    }
    return false;
}

/* What stands before an item of ours, as a macro without a semicolon, is theirs; a word of C there changes ours. */
bool tokens_compare(token_file *f, const token_file *template, unsigned *line)
{
    const token_item *ours = template->items, *const end = ours + template->n_items;

    for (size_t k = 0; k <= f->n_items; k++) { /* and once more for holes at the end */
        while (ours < end && template->tokens[ours->begin].kind == TOKEN_HOLE)
            ours++;
        if (k == f->n_items) break;
        const token_item theirs = f->items[k];
        size_t i = theirs.begin;
        for (; i < theirs.end; i++) {
            if (ours < end && (i == theirs.begin || !among(&f->tokens[i - 1], words_of_c)) &&
                fits(f->tokens + i, theirs.end - i, template->tokens + ours->begin, ours->end - ours->begin)) break;
            f->tokens[i].theirs = true;
        }
        ours += i < theirs.end;
    }
    if (ours < end) *line = template->tokens[ours->begin].line;
    return ours == end;
}

/* ---- what is refused ---- */

static bool has_name(const token_file *template, const token *t)
{
    for (size_t i = 0; i < template->n; i++) {
        if (same(&template->tokens[i], t)) return true;
    }
    return false;
}

static bool begins(const token *t, const char *with)
{
    return t->n >= strlen(with) && memcmp(t->text, with, strlen(with)) == 0;
}

static const char *const plain_headers =
    "assert complex ctype errno fenv float inttypes iso646 limits math stdalign stdarg stdbool stddef stdint stdio "
    "stdlib stdnoreturn string tgmath";

/* After #include: a name of the C library, or one of ours, which stay within the folders of headers. */
static bool may_include(const token *t, char *const *folders)
{
    if (t->kind == TOKEN_STRING) {
        const token stem = {.text = t->text + 1, .n = t->n > 4 ? t->n - 4 : 0};
        if (t->n < 5 || t->text[1] == '/' || memcmp(t->text + t->n - 3, ".h", 2) != 0 ||
            memmem(t->text, t->n, "..", 2) || memmem(t->text, t->n, "\\", 1)) return false;
        for (bool ours = !*folders || among(&stem, plain_headers); !ours;) {
            char path[4096];
            if (!*folders) return false;
            snprintf(path, sizeof path, "%s/%.*s.h", *folders++, (int)stem.n, stem.text);
            ours = access(path, R_OK) == 0;
        }
        return true;
    }
    if (!is(t, "<")) return false;
    if (is(t + 1, "bis")) {
        for (t++; t->kind == TOKEN_NAME || is(t, "/"); t++)
            continue;
        return is(t, ".") && is(t + 1, "h") && is(t + 2, ">");
    }
    return among(t + 1, plain_headers) && is(t + 2, ".") && is(t + 3, "h") && is(t + 4, ">");
}

/* __attribute__((noinline)) and the like, which change nothing that is computed. */
static bool is_plain_attribute(const token *t)
{
    return is(t, "__attribute__") && is(t + 1, "(") && is(t + 2, "(") && is(t + 4, ")") &&
           among(t + 3, "noinline always_inline unused pure const hot cold flatten");
}

static const char *const conditions = "if ifdef ifndef elif else endif";

static bool is_refused_name(const token *t)
{
    if (among(t, "asm _Pragma")) return true;
    if (is_plain_attribute(t)) return false;
    if (!begins(t, "__")) return false;
    return !among(t, "__func__ __FILE__ __LINE__ __VA_ARGS__ __restrict __builtin_ctz __builtin_ctzl __builtin_ctzll "
                     "__builtin_clz __builtin_clzl __builtin_clzll __builtin_popcount __builtin_expect __builtin_fma "
                     "__builtin_sqrt");
}

static bool is_refused(const token_file *f, const token_file *template, char *const *folders, size_t i)
{
    const token *t = &f->tokens[i];

    switch (t->kind) {
    case TOKEN_NAME:
        return is_refused_name(t);
    case TOKEN_MARK:
        return among(t, "## %: <% <: \\ @ ` #") || (is(t, "[") && i + 1 < f->n && is(t + 1, "["));
    case TOKEN_DIRECTIVE:
        if (is(t + 1, "include")) return !may_include(t + 2, folders);
        if (among(t + 1, conditions)) return false; /* see encloses_ours */
        if (is(t + 1, "pragma")) return !is(t + 2, "omp");
        if (!is(t + 1, "define")) return true;
        /* a macro of theirs renames nothing of ours and no word of the language */
        return t[2].kind != TOKEN_NAME || t[2].text[0] == '_' || has_name(template, t + 2) ||
               among(t + 2, words_of_c) || among(t + 2, "true false NULL");
    default:
        return false;
    }
}

/* Is token i of theirs a condition whose other end is not before what is ours begins? Looks on from its beginning, back
 * from all else. */
static bool encloses_ours(const token_file *f, size_t i)
{
    const bool opens = begins(&f->tokens[i + 1], "if");
    int depth = 0;

    if (f->tokens[i].kind != TOKEN_DIRECTIVE || !among(&f->tokens[i + 1], conditions)) return false;
    for (size_t k = opens ? i + 1 : i - 1; k < f->n && f->tokens[k].theirs; opens ? k++ : k--) {
        if (f->tokens[k].kind != TOKEN_DIRECTIVE) continue;
        const int deeper = begins(&f->tokens[k + 1], "if") - is(&f->tokens[k + 1], "endif");
        depth += opens ? deeper : -deeper;
        if (depth < 0) return false;
    }
    return true;
}

const char *tokens_refuse(const token_file *f, const token_file *template, char *const *folders, char *text,
                          size_t room)
{
    for (size_t i = 0; i < f->n; i++) {
        const token *t = &f->tokens[i];
        if (!t->theirs || !(is_refused(f, template, folders, i) || encloses_ours(f, i))) continue;
        size_t n = t->n;
        if (t->kind == TOKEN_DIRECTIVE) n = strcspn(t->text, "\n");
        snprintf(text, room, "line %u: \"%.*s\" is refused", t->line, (int)(n < 80 ? n : 80), t->text);
        return text;
    }
    return NULL;
}

/* ---- prints ---- */

static uint64_t hash(uint64_t h, const char *text, size_t n)
{
    for (size_t i = 0; i < n; i++)
        h = (h ^ (unsigned char)text[i]) * 0x100000001b3;
    return h ^ h >> 29;
}

/* A name keeps its letters where it cannot be changed: a word of the language, a member, a function of ours that is
 * called. */
static uint64_t meaning(const token_file *f, const token_file *template, size_t i)
{
    const token *t = &f->tokens[i];

    if (t->kind == TOKEN_STRING) return 1;
    if (t->kind != TOKEN_NAME) return hash(2, t->text, t->n);
    const bool fixed = among(t, words_of_c) || among(t, "size_t uint32_t uint64_t") ||
                       (i > 0 && (is(t - 1, ".") || is(t - 1, "->"))) ||
                       (i + 1 < f->n && is(t + 1, "(") && has_name(template, t));
    return fixed ? hash(3, t->text, t->n) : 4;
}

size_t tokens_prints(const token_file *f, const token_file *template, uint64_t **prints)
{
    uint64_t window[TOKEN_RUN], *p = calloc(f->n + 1, sizeof *p);
    size_t n = 0;

    *prints = p;
    if (!p) return 0;
    for (size_t k = 0; k < f->n_items; k++) {
        size_t length = 0;
        for (size_t i = f->items[k].begin; i < f->items[k].end; i++) {
            if (!f->tokens[i].theirs) {
                length = 0;
                continue;
            }
            window[length++ % TOKEN_RUN] = meaning(f, template, i);
            if (length < TOKEN_RUN) continue;
            uint64_t h = 5;
            for (size_t j = 0; j < TOKEN_RUN; j++)
                h = hash(h, (const char *)&window[(length + j) % TOKEN_RUN], sizeof *window);
            p[n++] = h;
        }
    }
    return n;
}
