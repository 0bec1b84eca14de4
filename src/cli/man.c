/* SPDX-License-Identifier: BSD-2-Clause */
/* man: a command's options as a part of the page for man(1), in the few requests of man(7) that every formatter knows:
 * TH, SH, SS, TP, PP, nf. Whatever troff reads as its own is escaped, hyphens too, so that an option can be copied from
 * the page into a shell. */
#include "man.h"

#include <ctype.h>
#include <string.h>

enum { SOURCE_WIDTH = 76 };

static void put_escaped(FILE *out, char c)
{
    switch (c) {
    case '\\': fputs("\\e", out); break;
    case '-': fputs("\\-", out); break;
    case '\'': fputs("\\(aq", out); break;
    case '`': fputs("\\(ga", out); break;
    case '^': fputs("\\(ha", out); break;
    case '~': fputs("\\(ti", out); break;
    default: fputc(c, out);
    }
}

/* n characters; a full stop that begins them shall not begin a request. */
static void put_text(FILE *out, const char *text, size_t n)
{
    if (n > 0 && *text == '.') fputs("\\&", out);
    for (size_t i = 0; i < n; i++) put_escaped(out, text[i]);
}

/* n characters as a paragraph: blanks and newlines are all the same. */
void bis_man_paragraph(FILE *out, const char *text, size_t n)
{
    size_t column = 0;
    for (size_t i = 0; i < n;) {
        size_t word = 0;
        while (i + word < n && !isspace((unsigned char)text[i + word])) word++;
        if (column > 0 && word > 0) {
            const bool fits = column + 1 + word <= SOURCE_WIDTH;
            fputc(fits ? ' ' : '\n', out);
            column = fits ? column + 1 : 0;
        }
        put_text(out, text + i, word);
        column += word;
        i += word + 1;
    }
    fputc('\n', out);
}

void bis_man_entry(FILE *out, const char *term, const char *text)
{
    fputs(".TP\n\\fB", out);
    put_text(out, term, strlen(term));
    fputs("\\fR\n", out);
    bis_man_paragraph(out, text, strlen(text));
}

void bis_man_line(FILE *out, const char *text, size_t n)
{
    fputs(".nf\n", out);
    put_text(out, text, n);
    fputs("\n.fi\n", out);
}

/* Notes are wrapped by hand: lines from an empty one to the next are a paragraph, lines that begin with a blank stay as
 * they are. */
static void put_notes(FILE *out, const char *notes)
{
    fputs(".PP\n", out);
    while (*notes) {
        size_t n = strcspn(notes, "\n");
        if (n == 0) {
            fputs(".PP\n", out);
        } else if (*notes == ' ') {
            bis_man_line(out, notes, n);
        } else {
            while (notes[n] == '\n' && notes[n + 1] && !isspace((unsigned char)notes[n + 1]))
                n += 1 + strcspn(notes + n + 1, "\n");
            bis_man_paragraph(out, notes, n);
        }
        notes += n + (notes[n] == '\n');
    }
}

void bis_man_command(const bis_command *c, FILE *out)
{
    char term[BIS_CLI_TERM];

    fputs(".SS bis ", out);
    put_text(out, c->usage, strlen(c->usage));
    fputc('\n', out);
    bis_man_paragraph(out, c->summary, strlen(c->summary));
    for (const bis_option *o = c->options; o < c->options + c->n_options; o++) {
        if (o->name) {
            bis_man_entry(out, bis_cli_term(term, o), o->help);
            continue;
        }
        fputs(".PP\n\\fI", out);
        put_text(out, o->help, strlen(o->help));
        fputs("\\fR\n", out);
    }
    if (c->notes) put_notes(out, c->notes);
}
