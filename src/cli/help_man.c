/* help_man: the tables of help as a page for man(1), in the few requests of man(7) that every formatter knows: TH, SH,
 * SS, TP, PP, nf.
 *
 * No text here is the page's own but the headings. Whatever troff reads as its own is escaped, hyphens too, so that an
 * option can be copied from the page into a shell. The date of .TH is left empty: the same source makes the same
 * page. */
#include "help.h"

#include "bis/base/version.h"

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
static void put_paragraph(FILE *out, const char *text, size_t n)
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

static void put_entry(FILE *out, const char *term, const char *text)
{
    fputs(".TP\n\\fB", out);
    put_text(out, term, strlen(term));
    fputs("\\fR\n", out);
    put_paragraph(out, text, strlen(text));
}

static void put_line(FILE *out, const char *text, size_t n)
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
            put_line(out, notes, n);
        } else {
            while (notes[n] == '\n' && notes[n + 1] && !isspace((unsigned char)notes[n + 1])) n += 1 + strcspn(notes + n + 1, "\n");
            put_paragraph(out, notes, n);
        }
        notes += n + (notes[n] == '\n');
    }
}

void bis_man_command(const bis_command *c, FILE *out)
{
    char term[128];

    fputs(".SS bis ", out);
    put_text(out, c->usage, strlen(c->usage));
    fputc('\n', out);
    put_paragraph(out, c->summary, strlen(c->summary));
    for (size_t i = 0; i < c->n_options; i++) {
        const bis_option *o = &c->options[i];
        if (!o->name) {
            fputs(".PP\n\\fI", out);
            put_text(out, o->help, strlen(o->help));
            fputs("\\fR\n", out);
            continue;
        }
        snprintf(term, sizeof term, "--%s%s%s", o->name, o->argument ? " " : "", o->argument ? o->argument : "");
        put_entry(out, term, o->help);
    }
    if (c->notes) put_notes(out, c->notes);
}

static void put_topic(FILE *out, const bis_topic *t)
{
    fputs(".SH ", out);
    for (const char *c = t->name; *c; c++) fputc(toupper((unsigned char)*c), out);
    fputc('\n', out);
    put_paragraph(out, t->summary, strlen(t->summary));
    bool after_line = false;
    for (const bis_help_entry *e = t->entries; e->term || e->text; e++) {
        const bool is_line = !e->text;
        if (!e->term || (is_line && !after_line)) fputs(".PP\n", out);
        after_line = is_line;
        if (is_line) put_line(out, e->term, strlen(e->term));
        else if (e->term) put_entry(out, e->term, e->text);
        else put_paragraph(out, e->text, strlen(e->text));
    }
}

int bis_man_page(void)
{
    static char option[] = "--help=man";
    char *arguments[] = {option};
    FILE *out = stdout;

    fprintf(out, ".TH BIS 1 \"\" \"bis %s\" \"User Commands\"\n.nh\n.ad l\n", BIS_VERSION);
    fputs(".SH NAME\nbis \\- render direct light from environment maps\n", out);
    fputs(".SH SYNOPSIS\n\\fBbis\\fR [\\fBrender\\fR] [\\fIoptions\\fR] \\fISCENE\\fR\n.br\n"
          "\\fBbis\\fR \\fICOMMAND\\fR [\\fIoptions\\fR] \\fIoperands\\fR\n.br\n"
          "\\fBbis help\\fR [\\fICOMMAND\\fR | \\fITOPIC\\fR | \\fINAME\\fR]\n.SH DESCRIPTION\n", out);
    put_paragraph(out, bis_help_intro, strlen(bis_help_intro));
    for (const bis_subcommand *c = bis_subcommands; c->name; c++) put_entry(out, c->name, c->help);
    fputs(".SH COMMANDS\nEvery command knows \\fB\\-\\-help\\fR (\\fB\\-h\\fR) and \\fB\\-\\-version\\fR "
        "(\\fB\\-V\\fR).\n", out);
    for (const bis_subcommand *c = bis_subcommands; c->name; c++) {
        int exit_status = c->run(1, arguments);
        if (exit_status) return exit_status;
    }
    for (const bis_topic *t = bis_topics; t->name; t++) put_topic(out, t);
    return bis_cli_finish(BIS_EXIT_DONE);
}
