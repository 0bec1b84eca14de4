/* SPDX-License-Identifier: BSD-2-Clause */
/* ranks: several processes that render one picture together. For the files of src/render and src/cli.
 *
 * Here is what the renderer needs of a message library, as functions; src/cli/ranks_mpi.c fills them in, and alone
 * knows MPI. Rank 0 leads: it has the film, the budgets, the files and the messages to the user. No ranks (NULL) is one
 * process that does all. All calls come from the thread that made the ranks. */
#pragma once

#include "bis/base/status.h"
#include "bis/render/render.h"
#include "identity.h"

struct bis_ranks {
    int rank, size; /* size > 1 */
    const char *host; /* name of this machine */
    /* n bytes of rank `from` to all ranks; all must call each of these */
    void (*broadcast)(bis_ranks *ranks, int from, void *data, size_t n);
    /* data[n] becomes the bitwise or of that of all ranks, everywhere */
    void (*join_bits)(bis_ranks *ranks, unsigned char *data, size_t n);
    /* data[n] becomes the sum over all ranks, everywhere */
    void (*add)(bis_ranks *ranks, uint64_t *data, size_t n);
};

/* bis_rank_leads returns whether this process is the one that talks to the user: rank 0, or alone. */
static inline bool bis_rank_leads(const bis_ranks *ranks) { return !ranks || ranks->rank == 0; }

/* bis_ranks_agree lets all ranks go on only if all can: it returns the status of the lowest rank that has failed. On
 * rank 0 the diag then has that rank's first message, with its number and machine; elsewhere none is added. All ranks
 * must call it; without ranks it returns status. */
bis_status bis_ranks_agree(bis_ranks *ranks, bis_status status, bis_diag *diag);

/* bis_ranks_compare compares what the ranks are about to render, by the hashes of identity.h. *n_threads becomes their
 * sum. Errors: BIS_INPUT on all ranks; rank 0 names the rank and what differs. */
bis_status bis_ranks_compare(bis_ranks *ranks, const uint64_t parts[BIS_IDENTITY_PARTS], int *n_threads,
                             bis_diag *diag);
