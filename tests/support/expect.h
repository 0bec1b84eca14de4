/* SPDX-License-Identifier: BSD-2-Clause */
/* expect: what a command must say, written by hand in a file *.expect, which is a test. How a line of it begins says
 * what the line is:
 *     #   a comment: where the expected words and figures come from; so is an empty line
 *     $   a command, which must end with status 0; `$2`: with status 2. All up to the next command belongs to it
 *     <   a line that the command is given
 *     >   a line of its output                       !   a line of its messages
 *     >%  such a line, cell by cell between commas; numbers are compared to 9 digits          !%
 *     >~  a part of its output, behind the part before; what lies between is free             !~
 *     >=  a part that is a whole line                                                         !=
 *     >-  what stands nowhere in its output                                                   !-
 * A sign is followed by a blank and the text, or by nothing. A stream of which neither lines nor parts are given must
 * be empty; `>~` alone takes any. {NAME} stands for a text that the test program gives. */
#ifndef TESTS_EXPECT_H
#define TESTS_EXPECT_H

#include "claim.h"

#include <stdio.h>

/* What a command is given: the words behind its name, and the lines of "<". */
typedef struct expect_command {
    const char *arguments, *input;
    FILE *output, *messages;
} expect_command;

/* What run returns where the command needs something that is not on this machine: nothing is compared. */
#define EXPECT_SKIPPED (-1)

/* A command beside `bis` and `ls PATH`, which every file may use: run returns its exit status. The list ends with a
 * name of NULL. */
typedef struct expect_word {
    const char *name;
    int (*run)(const expect_command *c);
} expect_word;

/* What {name} stands for. The list ends with a name of NULL. */
typedef struct expect_text {
    const char *name, *text;
} expect_text;

/* expect_file runs the file and returns NULL where all is as it says; else where and how it differs, to be freed. Both
 * lists may be NULL. */
char *expect_file(const char *path, const expect_word *words, const expect_text *texts);

/* The files of a folder and what they may use; both lists may be NULL. */
typedef struct expect_folder {
    const char *path;
    const expect_word *words;
    const expect_text *texts;
} expect_folder;

/* expect_run runs the n tests, then each .expect of the folder as a test of its name, in the order of the alphabet, and
 * returns how many failed. A folder without any is a failure. setup and teardown may be NULL. */
int expect_run(const char *group, const struct CMUnitTest *tests, size_t n, CMFixtureFunction setup,
               CMFixtureFunction teardown, const expect_folder *folder);

#endif
