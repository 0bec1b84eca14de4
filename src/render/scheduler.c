/* SPDX-License-Identifier: BSD-2-Clause */
/* scheduler: rank 0 deals out the tiles of a pass to the ranks, as they get done, and collects what they make of them.
 *
 * So a rank that is slow, or has other work beside, holds up nobody: it gets fewer tiles. Each rank has one batch of
 * tiles to work on and one in its queue, so that it does not wait for the answer of rank 0. Batches become smaller
 * towards the end of a pass, and tiles that took long in the pass before come first: what is left for the end is small.
 *
 * Nothing that a rank knows decides what a pixel gets. What a tile has learned (visibility.h), 8 KB, stays with the
 * rank that rendered the tile, its owner. Only rank 0 knows who owns what. A rank first gets the tiles that it owns;
 * then those of nobody, which are all in the first pass; and then those of the rank that has most work left. Such a
 * tile moves: rank 0 asks its owner to GIVE it, and the owner sends the WORK to the new one, with what the tile has
 * learned. So as a rule nothing travels but pixels, 4 KB a tile.
 *
 * What a tile has counted in a pass becomes part of what it has learned when the next call of rank 0 says that the pass
 * is complete: a pass that is given up leaves no trace. For a checkpoint rank 0 asks the owners for all that has been
 * learned; they stay the owners. So checkpoints, budgets and the next pass do not know how many ranks there are.
 *
 * Rank 0 renders, too, and looks after the others between two of its tiles. Where there are more than FEW ranks, its
 * thread 0 does nothing else.
 *
 * Only thread 0 of a rank talks to other ranks. Its other threads find tiles in a queue, and leave those that are done
 * in a list, which thread 0 sends. Numbers are sent as they are in memory: all machines must be of one kind.
 *
 * Here is what each rank calls. scheduler_deal.c is the side of rank 0, scheduler_work.c that of the others,
 * scheduler_parts.c has what both need. */
#include "scheduler_parts.h"

#include "bis/base/mem.h"

#include <string.h>

/* Room for the longest message. */
static size_t message_bytes(const bis_workspace *w)
{
    return sizeof(bis_sched_head) + BIS_SCHED_MOST_TILES * bis_sched_tile_bytes(w);
}

size_t bis_sched_bytes(const bis_sched *sched)
{
    const size_t n = (size_t)sched->w->n_tiles, size = (size_t)sched->ranks->size;
    const size_t tile = 2 * sizeof(double) + 4 * sizeof(int);
    const size_t rank = (4 + BIS_SCHED_BUCKETS) * sizeof(int) + sizeof(double);
    return sizeof *sched + n * tile + size * rank + message_bytes(sched->w);
}

bis_sched *bis_sched_new(bis_ranks *ranks, bis_workspace *w)
{
    const size_t n = (size_t)w->n_tiles, size = (size_t)ranks->size;
    bis_sched *sched = bis_alloc(1, sizeof *sched);

    if (!sched) return NULL;
    *sched = (bis_sched){.ranks = ranks, .w = w};
    sched->seconds = bis_alloc(n, sizeof *sched->seconds);
    sched->queue = bis_alloc(n, sizeof *sched->queue);
    sched->finished = bis_alloc(n, sizeof *sched->finished);
    sched->owner = bis_alloc(n, sizeof *sched->owner);
    sched->order = bis_alloc(n, sizeof *sched->order);
    sched->until = bis_alloc(n + 1, sizeof *sched->until);
    sched->bucket = bis_alloc((size + 1) * BIS_SCHED_BUCKETS + 1, sizeof *sched->bucket);
    sched->next = bis_alloc(size + 1, sizeof *sched->next);
    sched->end = bis_alloc(size + 1, sizeof *sched->end);
    sched->threads = bis_alloc(size, sizeof *sched->threads);
    sched->held = bis_alloc(size, sizeof *sched->held);
    sched->work = bis_alloc(size, sizeof *sched->work);
    sched->message = bis_alloc(1, message_bytes(w));
    if (sched->seconds && sched->queue && sched->finished && sched->owner && sched->order && sched->until &&
        sched->bucket && sched->next && sched->end && sched->threads && sched->held && sched->work && sched->message) {
        for (size_t t = 0; t < n; t++) sched->owner[t] = BIS_SCHED_NOBODY;
        return sched;
    }
    bis_sched_free(sched);
    return NULL;
}

void bis_sched_free(bis_sched *sched)
{
    if (!sched) return;
    bis_free(sched->seconds);
    bis_free(sched->queue);
    bis_free(sched->finished);
    bis_free(sched->owner);
    bis_free(sched->order);
    bis_free(sched->until);
    bis_free(sched->bucket);
    bis_free(sched->next);
    bis_free(sched->end);
    bis_free(sched->threads);
    bis_free(sched->held);
    bis_free(sched->work);
    bis_free(sched->message);
    bis_free(sched);
}

bis_status bis_sched_meet(bis_sched *sched, const bis_workspace *w, int *n_threads, bis_diag *diag)
{
    uint64_t parts[BIS_IDENTITY_PARTS];

    bis_identify(parts, w);
    const bis_status status = bis_ranks_compare(sched->ranks, parts, w->n_threads, sched->threads, diag);
    for (int i = 0; i < sched->ranks->size; i++) sched->n_all_threads += sched->threads[i];
    *n_threads = sched->n_all_threads;
    return status;
}

void bis_sched_begin(bis_sched *sched, void (*progress)(double share, void *user), void *user)
{
    sched->progress = progress;
    sched->user = user;
    sched->over = false;
    sched->n_held = sched->n_received = 0;
    sched->n_queued = sched->n_taken = sched->n_finished = sched->n_sent = 0;
    if (sched->ranks->rank == 0) bis_sched_deal_begin(sched);
}

int bis_sched_next(bis_sched *sched, int thread)
{
    const bool leads = sched->ranks->rank == 0;
    bool over;

    if (thread == 0) return leads ? bis_sched_deal_next(sched) : bis_sched_work_next(sched);
    for (;;) {
        const int t = leads ? bis_sched_deal_take(sched) : bis_sched_take_queued(sched);
        if (t >= 0) return t;
#pragma omp atomic read
        over = sched->over;
        if (over) return -1;
        bis_sched_wait();
    }
}

void bis_sched_finish(bis_sched *sched, int thread, int tile, double seconds)
{
    sched->seconds[tile] = seconds;
#pragma omp critical(bis_sched)
    sched->finished[sched->n_finished++] = tile;
    if (sched->ranks->rank == 0 && thread == 0) bis_sched_deal_progress(sched);
}

void bis_sched_end(bis_sched *sched)
{
    bis_ranks *ranks = sched->ranks;
    bis_workspace *w = sched->w;
    bis_counters sum = {0};

    for (int i = 0; i < w->n_threads; i++) bis_counters_add(&sum, &w->workers[i].counters);
    if (ranks->rank > 0) {
        ranks->send(ranks, 0, &sum, sizeof sum);
        return;
    }
    for (int i = 1; i < ranks->size; i++) {
        int from;
        size_t n;
        bis_counters c;
        memcpy(&c, ranks->receive(ranks, &from, &n, true), sizeof c);
        bis_counters_add(&w->workers[0].counters, &c);
    }
    sched->knows = true;
}
