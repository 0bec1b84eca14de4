/* SPDX-License-Identifier: BSD-2-Clause */
/* instrument: commands that are programs of their own, as those of git are: `bis trade` runs `bis-trade`. C renders,
 * Python measures: trade, pixel and envmap are Python over the library (scripts/python/bis/tools). Anybody can add
 * `bis-mine`. For main.c and help*.c. */
#pragma once

#include <stdbool.h>

/* bis_instrument_run becomes `bis-NAME` with these arguments; argv[0] is replaced and argv[argc] is NULL. It looks
 * beside the program, in libexec/bis and in scripts/python of a source tree, then on PATH. In the environment it names
 * the program (BIS_PROGRAM), the library of the same build (BIS_LIBRARY) and that build (BIS_BUILD_ID). It returns only
 * where that fails: the exit status, with a message; -1 without one if there is no such program. */
int bis_instrument_run(const char *name, char **argv);

/* bis_instrument_print runs `bis-NAME OPTION` and waits for it. It returns the exit status. */
int bis_instrument_print(const char *name, const char *option);

/* bis_instrument_leads returns whether this process is the one of its MPI job that works. It looks at what starters of
 * jobs set, because an instrument runs before MPI is opened. */
bool bis_instrument_leads(void);
