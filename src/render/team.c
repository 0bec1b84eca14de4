/* SPDX-License-Identifier: BSD-2-Clause */
/* team: rank 0 deals out the tiles of a pass to the ranks, as they get done, and collects what they make of them.
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
 * Here is what each rank calls. team_deal.c is the side of rank 0, team_work.c that of the others, team_parts.c has
 * what both need. */
#include "team_parts.h"

#include "bis/base/mem.h"

#include <string.h>

/* Room for the longest message. */
static size_t message_bytes(const bis_workspace *w)
{
    return sizeof(bis_team_head) + BIS_TEAM_MOST_TILES * bis_team_tile_bytes(w);
}

size_t bis_team_bytes(const bis_team *team)
{
    const size_t n = (size_t)team->w->n_tiles, size = (size_t)team->crew->size;
    const size_t tile = 2 * sizeof(double) + 4 * sizeof(int);
    const size_t rank = (4 + BIS_TEAM_BUCKETS) * sizeof(int) + sizeof(double);
    return sizeof *team + n * tile + size * rank + message_bytes(team->w);
}

bis_team *bis_team_new(bis_crew *crew, bis_workspace *w)
{
    const size_t n = (size_t)w->n_tiles, size = (size_t)crew->size;
    bis_team *team = bis_alloc(1, sizeof *team);

    if (!team) return NULL;
    *team = (bis_team){.crew = crew, .w = w};
    team->seconds = bis_alloc(n, sizeof *team->seconds);
    team->queue = bis_alloc(n, sizeof *team->queue);
    team->finished = bis_alloc(n, sizeof *team->finished);
    team->owner = bis_alloc(n, sizeof *team->owner);
    team->order = bis_alloc(n, sizeof *team->order);
    team->until = bis_alloc(n + 1, sizeof *team->until);
    team->bucket = bis_alloc((size + 1) * BIS_TEAM_BUCKETS + 1, sizeof *team->bucket);
    team->next = bis_alloc(size + 1, sizeof *team->next);
    team->end = bis_alloc(size + 1, sizeof *team->end);
    team->threads = bis_alloc(size, sizeof *team->threads);
    team->held = bis_alloc(size, sizeof *team->held);
    team->work = bis_alloc(size, sizeof *team->work);
    team->message = bis_alloc(1, message_bytes(w));
    if (team->seconds && team->queue && team->finished && team->owner && team->order && team->until && team->bucket &&
        team->next && team->end && team->threads && team->held && team->work && team->message) {
        for (size_t t = 0; t < n; t++) team->owner[t] = BIS_TEAM_NOBODY;
        return team;
    }
    bis_team_free(team);
    return NULL;
}

void bis_team_free(bis_team *team)
{
    if (!team) return;
    bis_free(team->seconds);
    bis_free(team->queue);
    bis_free(team->finished);
    bis_free(team->owner);
    bis_free(team->order);
    bis_free(team->until);
    bis_free(team->bucket);
    bis_free(team->next);
    bis_free(team->end);
    bis_free(team->threads);
    bis_free(team->held);
    bis_free(team->work);
    bis_free(team->message);
    bis_free(team);
}

bis_status bis_team_meet(bis_team *team, const bis_workspace *w, int *n_threads, bis_diag *diag)
{
    uint64_t parts[BIS_IDENTITY_PARTS];

    bis_identify(parts, w);
    const bis_status status = bis_crew_compare(team->crew, parts, w->n_threads, team->threads, diag);
    for (int i = 0; i < team->crew->size; i++) team->n_all_threads += team->threads[i];
    *n_threads = team->n_all_threads;
    return status;
}

void bis_team_begin(bis_team *team, void (*progress)(double share, void *user), void *user)
{
    team->progress = progress;
    team->user = user;
    team->over = false;
    team->n_held = team->n_received = 0;
    team->n_queued = team->n_taken = team->n_finished = team->n_sent = 0;
    if (team->crew->rank == 0) bis_team_deal_begin(team);
}

int bis_team_next(bis_team *team, int thread)
{
    const bool leads = team->crew->rank == 0;
    bool over;

    if (thread == 0) return leads ? bis_team_deal_next(team) : bis_team_work_next(team);
    for (;;) {
        const int t = leads ? bis_team_deal_take(team) : bis_team_take_queued(team);
        if (t >= 0) return t;
#pragma omp atomic read
        over = team->over;
        if (over) return -1;
        bis_team_wait();
    }
}

void bis_team_finish(bis_team *team, int thread, int tile, double seconds)
{
    team->seconds[tile] = seconds;
#pragma omp critical(bis_team)
    team->finished[team->n_finished++] = tile;
    if (team->crew->rank == 0 && thread == 0) bis_team_deal_progress(team);
}

void bis_team_end(bis_team *team)
{
    bis_crew *crew = team->crew;
    bis_workspace *w = team->w;
    bis_counters sum = {0};

    for (int i = 0; i < w->n_threads; i++) bis_counters_add(&sum, &w->workers[i].counters);
    if (crew->rank > 0) {
        crew->send(crew, 0, &sum, sizeof sum);
        return;
    }
    for (int i = 1; i < crew->size; i++) {
        int from;
        size_t n;
        bis_counters c;
        memcpy(&c, crew->receive(crew, &from, &n, true), sizeof c);
        bis_counters_add(&w->workers[0].counters, &c);
    }
    team->knows = true;
}
