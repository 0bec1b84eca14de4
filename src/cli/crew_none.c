/* SPDX-License-Identifier: BSD-2-Clause */
/* crew_none: this program is one process. bis-mpi has crew_mpi.c in its place. */
#include "cli.h"

bis_crew *bis_cli_crew;

void bis_cli_crew_open(int *argc, char ***argv)
{
    (void)argc;
    (void)argv;
}

void bis_cli_crew_close(void) {}
