/* SPDX-License-Identifier: BSD-2-Clause */
/* man: text in the language of man(7). For src/cli/cli.c, which prints a command's part of the page, and help_man.c. */
#pragma once

#include "cli.h"

/* bis_man_command prints what the page says of a command: its usage, its options, its notes. */
void bis_man_command(const bis_command *c, FILE *out);

/* bis_man_paragraph prints n characters as a paragraph, in which blanks and newlines are all the same. */
void bis_man_paragraph(FILE *out, const char *text, size_t n);

/* bis_man_entry prints a term and the text that explains it. */
void bis_man_entry(FILE *out, const char *term, const char *text);

/* bis_man_line prints n characters as a line that is not filled. */
void bis_man_line(FILE *out, const char *text, size_t n);
