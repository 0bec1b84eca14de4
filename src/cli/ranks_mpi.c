/* SPDX-License-Identifier: BSD-2-Clause */
/* ranks_mpi: the ranks of bis-mpi, by MPI 3.1. The only file that knows MPI; `make MPI=1` compiles it, and links it in
 * the place of ranks_none.c.
 *
 * Ranks other than 0 say nothing: what fails on one of them is told by rank 0 (bis_ranks_agree). Where MPI itself
 * fails, it ends the job. */
#include "cli.h"

#include "render/ranks.h"

#include <mpi.h>
#include <time.h>

enum { MOST_AT_ONCE = 1 << 30 };

typedef struct mpi_ranks {
    bis_ranks ranks;
    char host[MPI_MAX_PROCESSOR_NAME + 1];
} mpi_ranks;

bis_ranks *bis_cli_ranks;

static mpi_ranks own;

/* MPI libraries wait by asking again and again, and so take a processor from those who have work. */
static void nap(void) { nanosleep(&(struct timespec){0, 50000}, NULL); }

static void wait_for(MPI_Request *request)
{
    int is_done;
    for (MPI_Test(request, &is_done, MPI_STATUS_IGNORE); !is_done; MPI_Test(request, &is_done, MPI_STATUS_IGNORE))
        nap();
}

/* How many of n bytes from `at` on go together. */
static int piece(size_t at, size_t n) { return (int)(n - at < MOST_AT_ONCE ? n - at : MOST_AT_ONCE); }

static void broadcast(bis_ranks *ranks, int from, void *data, size_t n)
{
    (void)ranks;
    for (size_t at = 0; at < n; at += MOST_AT_ONCE) {
        MPI_Request request;
        MPI_Ibcast((unsigned char *)data + at, piece(at, n), MPI_BYTE, from, MPI_COMM_WORLD, &request);
        wait_for(&request);
    }
}

static void join_bits(bis_ranks *ranks, unsigned char *data, size_t n)
{
    (void)ranks;
    for (size_t at = 0; at < n; at += MOST_AT_ONCE) {
        MPI_Request request;
        MPI_Iallreduce(MPI_IN_PLACE, data + at, piece(at, n), MPI_UNSIGNED_CHAR, MPI_BOR, MPI_COMM_WORLD, &request);
        wait_for(&request);
    }
}

static void add_up(bis_ranks *ranks, uint64_t *data, size_t n)
{
    MPI_Request request;

    (void)ranks;
    MPI_Iallreduce(MPI_IN_PLACE, data, (int)n, MPI_UINT64_T, MPI_SUM, MPI_COMM_WORLD, &request);
    wait_for(&request);
}

void bis_cli_ranks_open(int *argc, char ***argv)
{
    int provided, length;

    MPI_Init_thread(argc, argv, MPI_THREAD_FUNNELED, &provided);
    own.ranks = (bis_ranks){.host = own.host, .broadcast = broadcast, .join_bits = join_bits, .add = add_up};
    MPI_Comm_rank(MPI_COMM_WORLD, &own.ranks.rank);
    MPI_Comm_size(MPI_COMM_WORLD, &own.ranks.size);
    MPI_Get_processor_name(own.host, &length);
    if (provided < MPI_THREAD_FUNNELED) {
        fputs("bis: error: this MPI library allows no threads (MPI_THREAD_FUNNELED)\n", stderr);
        MPI_Abort(MPI_COMM_WORLD, BIS_EXIT_FAILED);
    }
    if (own.ranks.size > 1) bis_cli_ranks = &own.ranks;
    if (own.ranks.rank == 0) return;
    if (!freopen("/dev/null", "w", stdout) || !freopen("/dev/null", "w", stderr))
        MPI_Abort(MPI_COMM_WORLD, BIS_EXIT_FAILED);
}

void bis_cli_ranks_close(void)
{
    MPI_Request all;

    MPI_Ibarrier(MPI_COMM_WORLD, &all);
    wait_for(&all); /* while rank 0 writes the picture */
    MPI_Finalize();
}
