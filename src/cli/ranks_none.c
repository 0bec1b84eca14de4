/* SPDX-License-Identifier: BSD-2-Clause */
/* ranks_none: this program is one process. bis-mpi has ranks_mpi.c in its place. */
#include "cli.h"

bis_ranks *bis_cli_ranks;

void bis_cli_ranks_open(int *argc, char ***argv)
{
    (void)argc;
    (void)argv;
}

void bis_cli_ranks_close(void) {}
