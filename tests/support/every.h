/* SPDX-License-Identifier: BSD-2-Clause */
/* every: see every.c. */
#ifndef TESTS_EVERY_H
#define TESTS_EVERY_H

#include <stdbool.h>

/* Whether the program fails if it leaves blocks behind. True; a program whose code under test may leak sets it to
 * false. */
extern bool every_finds_leaks;

#endif
