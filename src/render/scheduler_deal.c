/* SPDX-License-Identifier: BSD-2-Clause */
/* scheduler_deal: the side of rank 0: which rank gets which tiles, what comes back, what all are told to do next. */
#include "scheduler_parts.h"

#include <string.h>

enum { FEW = 16, PIECES = 4 };

static double cost_of(const bis_sched *sched, int tile) { return sched->knows ? sched->seconds[tile] : 1; }

/* The lists. In each, costly tiles come first, by the seconds of the last pass; among those that are alike, neighbours
 * beside each other. */
static void make_lists(bis_sched *sched)
{
    const int n = sched->w->n_tiles, size = sched->ranks->size;
    int *first = sched->bucket;
    double most = 0;

    for (int t = 0; t < n; t++) most = sched->seconds[t] > most ? sched->seconds[t] : most;
    const double scale = sched->knows && most > 0 ? (BIS_SCHED_BUCKETS - 1) / most : 0;
#define LIST_OF(t) (sched->owner[t] == BIS_SCHED_NOBODY ? size : sched->owner[t])
#define BUCKET_OF(t) (LIST_OF(t) * BIS_SCHED_BUCKETS + BIS_SCHED_BUCKETS - 1 - (int)(sched->seconds[t] * scale))
    memset(first, 0, ((size_t)(size + 1) * BIS_SCHED_BUCKETS + 1) * sizeof *first);
    for (int t = 0; t < n; t++) first[BUCKET_OF(t) + 1]++;
    for (int b = 0; b < (size + 1) * BIS_SCHED_BUCKETS; b++) first[b + 1] += first[b];
    for (int i = 0; i <= size; i++) {
        sched->next[i] = first[i * BIS_SCHED_BUCKETS];
        sched->end[i] = first[(i + 1) * BIS_SCHED_BUCKETS];
    }
    for (int t = 0; t < n; t++) sched->order[first[BUCKET_OF(t)]++] = t;
#undef BUCKET_OF
#undef LIST_OF
    for (int i = 0; i < n; i++) sched->until[i + 1] = sched->until[i] + cost_of(sched, sched->order[i]);
    sched->left = sched->until[n];
}

/* Tiles of one list: order[first], ..., n of them. */
typedef struct batch {
    int list, first, n;
} batch;

/* The list that a rank's next tiles come from; -1: there are no more, or, unless they may move, none that it may have
 * at once. */
static int find_list(const bis_sched *sched, int rank, bool may_move)
{
    const int nobodys = sched->ranks->size;
    double most = -1;
    int found = -1;

    if (sched->next[rank] < sched->end[rank]) return rank;
    if (sched->next[nobodys] < sched->end[nobodys]) return nobodys;
    for (int i = 0; may_move && i < nobodys; i++) {
        const double left = sched->until[sched->end[i]] - sched->until[sched->next[i]];
        if (sched->next[i] < sched->end[i] && left > most) most = left, found = i;
    }
    return found;
}

/* May a rank get more tiles? n: of a batch, which is worth `most` seconds. Where rank 0 renders, too, its answer takes
 * as long as a tile, and each rank needs a batch in its queue. Otherwise a rank that has enough to do gets none: a
 * costly tile that it has not begun can then go to another one. */
static bool may_get(const bis_sched *sched, int rank, int n, double most)
{
    if (sched->ranks->size <= FEW) return sched->held[rank] <= n;
    return sched->held[rank] < sched->threads[rank] || sched->work[rank] <= most;
}

/* Takes tiles for a rank out of the lists: one, or a batch. A batch is a share of what is left, so that there is some
 * for everybody later, but a tile for each thread. A share of the seconds, not of the tiles, because the first tiles
 * are the costly ones: a batch of many of them would outlast the pass. */
static batch take(bis_sched *sched, int rank, bool one)
{
    batch b = {.n = 0};

#pragma omp critical(bis_sched)
    if (!bis_workspace_interrupted(sched->w) && (b.list = find_list(sched, rank, !one)) >= 0) {
        const int own = sched->threads[rank], left = sched->end[b.list] - sched->next[b.list];
        b.first = sched->next[b.list];
        const double *until = sched->until + b.first;
        const double most = sched->left * own / ((double)PIECES * sched->n_all_threads);
        int n = one ? 1 : own;
        while (!one && n < BIS_SCHED_MOST_TILES && n < left && until[n + 1] - *until <= most) n++;
        n = n < BIS_SCHED_MOST_TILES ? n : BIS_SCHED_MOST_TILES;
        if (one || may_get(sched, rank, n, most)) {
            b.n = n < left ? n : left;
            sched->next[b.list] += b.n;
            sched->left -= until[b.n] - *until;
        }
    }
    for (int i = 0; i < b.n && sched->w->visibility.n_tiles; i++) sched->owner[sched->order[b.first + i]] = rank;
    return b;
}

/* The next batch for a rank: its own tiles or nobody's, or those of rank 0 with what they have learned; others are
 * given by their owner. */
static void deal(bis_sched *sched, int rank)
{
    const batch b = take(sched, rank, false);
    const bool moves = b.list != rank && b.list < sched->ranks->size, gives = moves && b.list > 0;

    if (b.n == 0) return;
    unsigned char *m = bis_sched_message(sched, (bis_sched_head){.kind = gives ? BIS_SCHED_GIVE : BIS_SCHED_WORK,
                                                              .n_tiles = b.n, .to = rank, .learned = moves && !gives});
    for (int i = 0; i < b.n; i++) {
        const bis_sched_tile h = {.tile = sched->order[b.first + i]};
        m = bis_sched_put(m, &h, sizeof h);
        if (moves && !gives) m = bis_sched_put_learned(m, sched->w, h.tile);
    }
    bis_sched_send(sched, gives ? b.list : rank, m);
    sched->held[rank] += b.n;
    sched->work[rank] += sched->until[b.first + b.n] - sched->until[b.first];
    sched->n_held += b.n;
}

void bis_sched_deal_progress(bis_sched *sched)
{
    int n;

#pragma omp critical(bis_sched)
    n = sched->n_finished;
    sched->progress((double)(n + sched->n_received) / sched->w->n_tiles, sched->user);
}

/* Tiles that a rank has done, or that it gives to rank 0. */
static void take_in(bis_sched *sched, int from, unsigned char *m)
{
    bis_sched_head h;

    m = bis_sched_get(m, &h, sizeof h);
    const int holder = h.kind == BIS_SCHED_WORK ? 0 : from;
    sched->held[holder] -= h.n_tiles;
    sched->n_held -= h.n_tiles;
    if (h.kind == BIS_SCHED_WORK) {
        bis_sched_queue(sched, &h, m);
        return;
    }
    for (int i = 0; i < h.n_tiles; i++) {
        bis_sched_tile t;
        m = bis_sched_get(m, &t, sizeof t);
        m = bis_sched_get_pixels(m, sched->w, t.tile);
        sched->work[from] -= cost_of(sched, t.tile);
        sched->seconds[t.tile] = t.seconds;
    }
    sched->n_received += h.n_tiles;
    deal(sched, from);
    bis_sched_deal_progress(sched);
}

int bis_sched_deal_take(bis_sched *sched)
{
    const int t = bis_sched_take_queued(sched);
    if (t >= 0) return t;
    const batch b = take(sched, 0, true);
    return b.n ? sched->order[b.first] : -1;
}

/* Once rank 0 has only tiles that others own, it asks for them, before its threads need them. */
static void ask_for_more(bis_sched *sched)
{
    bool has_enough;

#pragma omp critical(bis_sched)
    has_enough = find_list(sched, 0, false) >= 0 ||
                 sched->n_queued - sched->n_taken + sched->held[0] >= sched->threads[0];
    if (!has_enough) deal(sched, 0);
}

static void send_stop(bis_ranks *ranks, int rank)
{
    ranks->send(ranks, rank, &(bis_sched_head){.kind = BIS_SCHED_STOP}, sizeof(bis_sched_head));
}

int bis_sched_deal_next(bis_sched *sched)
{
    bis_ranks *ranks = sched->ranks;
    const bool renders = ranks->size <= FEW;
    unsigned char *m;
    int from, t = -1;
    size_t n;

    for (;;) {
        while ((m = ranks->receive(ranks, &from, &n, false)) != NULL) take_in(sched, from, m);
        if (renders) t = bis_sched_deal_take(sched);
        if (renders || sched->threads[0] > 1) ask_for_more(sched);
        if (t >= 0) return t;
        if (sched->n_held == 0) break;
        bis_sched_wait();
    }
    for (int i = 1; i < ranks->size; i++) send_stop(ranks, i);
#pragma omp atomic write
    sched->over = true;
    return -1;
}

static void call_others(bis_sched *sched, bis_sched_next_step next, const bis_pass *pass, bis_status status)
{
    bis_sched_step c;
    memset(&c, 0, sizeof c);
    c.next = (int32_t)next;
    c.status = (int32_t)status;
    c.passes = sched->w->film->passes;
    if (pass) c.pass = *pass;
    sched->ranks->broadcast(sched->ranks, &c, sizeof c);
}

void bis_sched_call(bis_sched *sched, const bis_pass *pass, bis_status status)
{
    call_others(sched, pass ? BIS_SCHED_PASS : BIS_SCHED_END, pass, status);
}

/* Asks a rank for n tiles and takes what they have learned. */
static void fetch(bis_sched *sched, int rank, const int *tiles, int n)
{
    bis_ranks *ranks = sched->ranks;
    unsigned char *m = bis_sched_message(sched, (bis_sched_head){.kind = BIS_SCHED_GIVE, .n_tiles = n, .to = 0});
    int from;
    size_t size;

    for (int i = 0; i < n; i++) m = bis_sched_put(m, &(bis_sched_tile){.tile = tiles[i]}, sizeof(bis_sched_tile));
    bis_sched_send(sched, rank, m);
    m = ranks->receive(ranks, &from, &size, true) + sizeof(bis_sched_head);
    for (int i = 0; i < n; i++) m = bis_sched_get_learned(m + sizeof(bis_sched_tile), sched->w, tiles[i]);
}

void bis_sched_gather(bis_sched *sched)
{
    bis_ranks *ranks = sched->ranks;

    if (!sched->w->visibility.n_tiles) return;
    call_others(sched, BIS_SCHED_GATHER, NULL, BIS_OK);
    make_lists(sched);
    for (int rank = 1; rank < ranks->size; rank++) {
        for (int i = sched->next[rank], n; i < sched->end[rank]; i += n) {
            n = sched->end[rank] - i < BIS_SCHED_MOST_TILES ? sched->end[rank] - i : BIS_SCHED_MOST_TILES;
            fetch(sched, rank, sched->order + i, n);
        }
        send_stop(ranks, rank);
    }
}

/* Before the first pass after a checkpoint rank 0 has all that was learned. */
static void own_all(bis_sched *sched)
{
    for (int t = 0; t < sched->w->n_tiles; t++) sched->owner[t] = 0;
}

void bis_sched_deal_begin(bis_sched *sched)
{
    const bis_workspace *w = sched->w;

    if (!sched->knows && w->film->passes && w->visibility.n_tiles) own_all(sched);
    make_lists(sched);
    memset(sched->work, 0, (size_t)sched->ranks->size * sizeof *sched->work);
    for (int round = 0; round < 2; round++)
        for (int i = 1; i < sched->ranks->size; i++) deal(sched, i);
}
