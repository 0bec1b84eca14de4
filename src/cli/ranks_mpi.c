/* SPDX-License-Identifier: BSD-2-Clause */
/* ranks_mpi: the ranks of bis-mpi, by MPI 3.1. The only file that knows MPI; `make MPI=1` compiles it, and links it in
 * the place of ranks_none.c.
 *
 * Ranks other than 0 say nothing: what fails on one of them is told by rank 0 (bis_ranks_agree). Where MPI itself
 * fails, it ends the job. */
#include "cli.h"

#include "render/ranks.h"

#include <mpi.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { TAG = 1, MOST_AT_ONCE = 1 << 30 };

/* A message on its way. */
typedef struct slot {
    MPI_Request request;
    unsigned char *data;
    size_t capacity;
} slot;

typedef struct mpi_ranks {
    bis_ranks ranks;
    char host[MPI_MAX_PROCESSOR_NAME + 1];
    slot *slots;
    size_t n_slots;
    unsigned char *received;
    size_t capacity;
} mpi_ranks;

bis_ranks *bis_cli_ranks;

static mpi_ranks own;

/* Out of malloc and not bis_alloc: it lives until the end, and MPI frees nothing of ours. */
static void *larger(void *old, size_t bytes)
{
    void *p = realloc(old, bytes);
    if (!p) MPI_Abort(MPI_COMM_WORLD, BIS_EXIT_FAILED);
    return p;
}

/* MPI libraries wait by asking again and again, and so take a processor from those who have work. */
static void nap(void) { nanosleep(&(struct timespec){0, 50000}, NULL); }

static void wait_for(MPI_Request *request)
{
    int is_done;
    for (MPI_Test(request, &is_done, MPI_STATUS_IGNORE); !is_done; MPI_Test(request, &is_done, MPI_STATUS_IGNORE))
        nap();
}

static void broadcast(bis_ranks *ranks, void *data, size_t n)
{
    MPI_Request request;

    (void)ranks;
    MPI_Ibcast(data, (int)n, MPI_BYTE, 0, MPI_COMM_WORLD, &request);
    wait_for(&request);
}

static void join_bits(bis_ranks *ranks, unsigned char *data, size_t n)
{
    (void)ranks;
    for (size_t at = 0; at < n; at += MOST_AT_ONCE) {
        const size_t left = n - at < MOST_AT_ONCE ? n - at : MOST_AT_ONCE;
        MPI_Request request;
        MPI_Iallreduce(MPI_IN_PLACE, data + at, (int)left, MPI_UNSIGNED_CHAR, MPI_BOR, MPI_COMM_WORLD, &request);
        wait_for(&request);
    }
}

/* A slot whose message has left, or a new one. */
static slot *free_slot(void)
{
    for (size_t i = 0; i < own.n_slots; i++) {
        int has_left;
        MPI_Test(&own.slots[i].request, &has_left, MPI_STATUS_IGNORE);
        if (has_left) return &own.slots[i];
    }
    own.slots = larger(own.slots, (own.n_slots + 1) * sizeof *own.slots);
    own.slots[own.n_slots] = (slot){.request = MPI_REQUEST_NULL};
    return &own.slots[own.n_slots++];
}

static void send_bytes(bis_ranks *ranks, int to, const void *data, size_t n)
{
    slot *s = free_slot();

    (void)ranks;
    if (s->capacity < n) s->data = larger(s->data, n), s->capacity = n;
    memcpy(s->data, data, n);
    MPI_Isend(s->data, (int)n, MPI_BYTE, to, TAG, MPI_COMM_WORLD, &s->request);
}

static unsigned char *receive(bis_ranks *ranks, int *from, size_t *n, bool wait)
{
    MPI_Status status;
    int there, count;

    (void)ranks;
    for (;;) {
        MPI_Iprobe(MPI_ANY_SOURCE, TAG, MPI_COMM_WORLD, &there, &status);
        if (there) break;
        if (!wait) return NULL;
        nap();
    }
    MPI_Get_count(&status, MPI_BYTE, &count);
    *from = status.MPI_SOURCE;
    *n = (size_t)count;
    if (own.capacity < *n) own.received = larger(own.received, *n), own.capacity = *n;
    MPI_Recv(own.received, count, MPI_BYTE, *from, TAG, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    return own.received;
}

void bis_cli_ranks_open(int *argc, char ***argv)
{
    int provided, length;

    MPI_Init_thread(argc, argv, MPI_THREAD_FUNNELED, &provided);
    own.ranks = (bis_ranks){.host = own.host, .broadcast = broadcast, .join_bits = join_bits, .send = send_bytes,
                          .receive = receive};
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

    for (size_t i = 0; i < own.n_slots; i++) {
        wait_for(&own.slots[i].request);
        free(own.slots[i].data);
    }
    free(own.slots);
    free(own.received);
    MPI_Ibarrier(MPI_COMM_WORLD, &all);
    wait_for(&all); /* while rank 0 writes the picture */
    MPI_Finalize();
}
