/* SPDX-License-Identifier: BSD-2-Clause */
/* help_man: the tables of help as a page for man(1).
 *
 * No text here is the page's own but the headings. The date of .TH is left empty: the same source makes the same page.
 */
#include "help.h"
#include "instrument.h"
#include "man.h"

#include "bis/base/version.h"

#include <ctype.h>
#include <string.h>

static void put_topic(FILE *out, const bis_topic *t)
{
    bis_help_page page;

    fputs(".SH ", out);
    for (const char *c = t->name; *c; c++) fputc(toupper((unsigned char)*c), out);
    fputc('\n', out);
    bis_man_paragraph(out, t->summary, strlen(t->summary));
    bool after_line = false;
    for (const bis_help_entry *e = bis_help_open(&page, t); e->term || e->text; e++) {
        const bool is_line = !e->text;
        if (!e->term || (is_line && !after_line)) fputs(".PP\n", out);
        after_line = is_line;
        if (is_line) bis_man_line(out, e->term, strlen(e->term));
        else if (e->term) bis_man_entry(out, e->term, e->text);
        else bis_man_paragraph(out, e->text, strlen(e->text));
    }
}

int bis_man_page(const bis_subcommand *commands, const char *intro)
{
    static char option[] = "--help=man";
    char *arguments[] = {option};
    FILE *out = stdout;

    fprintf(out, ".TH BIS 1 \"\" \"bis %s\" \"User Commands\"\n.nh\n.ad l\n", BIS_VERSION);
    fputs(".SH NAME\nbis \\- render direct light from environment maps\n", out);
    fputs(".SH SYNOPSIS\n\\fBbis\\fR [\\fBrender\\fR] [\\fIoptions\\fR] \\fISCENE\\fR\n.br\n"
          "\\fBbis\\fR \\fICOMMAND\\fR [\\fIoptions\\fR] \\fIoperands\\fR\n.br\n"
          "\\fBbis help\\fR [\\fICOMMAND\\fR | \\fITOPIC\\fR | \\fINAME\\fR]\n.SH DESCRIPTION\n", out);
    bis_man_paragraph(out, intro, strlen(intro));
    for (const bis_subcommand *c = commands; c->name; c++) bis_man_entry(out, c->name, c->help);
    fputs(".SH COMMANDS\nEvery command knows \\fB\\-\\-help\\fR (\\fB\\-h\\fR) and \\fB\\-\\-version\\fR "
        "(\\fB\\-V\\fR).\n", out);
    for (const bis_subcommand *c = commands; c->name; c++) {
        const int exit_status = c->run ? c->run(1, arguments) : bis_instrument_print(c->name, option);
        if (exit_status) return exit_status;
    }
    for (const bis_topic *t = bis_topics; t->name; t++) put_topic(out, t);
    return bis_cli_finish(BIS_EXIT_DONE);
}
