/* SPDX-License-Identifier: BSD-2-Clause */
/* team_deal: the side of rank 0: which rank gets which tiles, what comes back, what all are told to do next. */
#include "team_parts.h"

#include <string.h>

enum { FEW = 16, PIECES = 4 };

static double cost_of(const bis_team *team, int tile) { return team->knows ? team->seconds[tile] : 1; }

/* The lists. In each, costly tiles come first, by the seconds of the last pass; among those that are alike, neighbours
 * beside each other. */
static void make_lists(bis_team *team)
{
    const int n = team->w->n_tiles, size = team->crew->size;
    int *first = team->bucket;
    double most = 0;

    for (int t = 0; t < n; t++) most = team->seconds[t] > most ? team->seconds[t] : most;
    const double scale = team->knows && most > 0 ? (BIS_TEAM_BUCKETS - 1) / most : 0;
#define LIST_OF(t) (team->owner[t] == BIS_TEAM_NOBODY ? size : team->owner[t])
#define BUCKET_OF(t) (LIST_OF(t) * BIS_TEAM_BUCKETS + BIS_TEAM_BUCKETS - 1 - (int)(team->seconds[t] * scale))
    memset(first, 0, ((size_t)(size + 1) * BIS_TEAM_BUCKETS + 1) * sizeof *first);
    for (int t = 0; t < n; t++) first[BUCKET_OF(t) + 1]++;
    for (int b = 0; b < (size + 1) * BIS_TEAM_BUCKETS; b++) first[b + 1] += first[b];
    for (int i = 0; i <= size; i++) {
        team->next[i] = first[i * BIS_TEAM_BUCKETS];
        team->end[i] = first[(i + 1) * BIS_TEAM_BUCKETS];
    }
    for (int t = 0; t < n; t++) team->order[first[BUCKET_OF(t)]++] = t;
#undef BUCKET_OF
#undef LIST_OF
    for (int i = 0; i < n; i++) team->until[i + 1] = team->until[i] + cost_of(team, team->order[i]);
    team->left = team->until[n];
}

/* Tiles of one list: order[first], ..., n of them. */
typedef struct batch {
    int list, first, n;
} batch;

/* The list that a rank's next tiles come from; -1: there are no more, or, unless they may move, none that it may have
 * at once. */
static int find_list(const bis_team *team, int rank, bool may_move)
{
    const int nobodys = team->crew->size;
    double most = -1;
    int found = -1;

    if (team->next[rank] < team->end[rank]) return rank;
    if (team->next[nobodys] < team->end[nobodys]) return nobodys;
    for (int i = 0; may_move && i < nobodys; i++) {
        const double left = team->until[team->end[i]] - team->until[team->next[i]];
        if (team->next[i] < team->end[i] && left > most) most = left, found = i;
    }
    return found;
}

/* May a rank get more tiles? n: of a batch, which is worth `most` seconds. Where rank 0 renders, too, its answer takes
 * as long as a tile, and each rank needs a batch in its queue. Otherwise a rank that has enough to do gets none: a
 * costly tile that it has not begun can then go to another one. */
static bool may_get(const bis_team *team, int rank, int n, double most)
{
    if (team->crew->size <= FEW) return team->held[rank] <= n;
    return team->held[rank] < team->threads[rank] || team->work[rank] <= most;
}

/* Takes tiles for a rank out of the lists: one, or a batch. A batch is a share of what is left, so that there is some
 * for everybody later, but a tile for each thread. A share of the seconds, not of the tiles, because the first tiles
 * are the costly ones: a batch of many of them would outlast the pass. */
static batch take(bis_team *team, int rank, bool one)
{
    batch b = {.n = 0};

#pragma omp critical(bis_team)
    if (!bis_workspace_interrupted(team->w) && (b.list = find_list(team, rank, !one)) >= 0) {
        const int own = team->threads[rank], left = team->end[b.list] - team->next[b.list];
        b.first = team->next[b.list];
        const double *until = team->until + b.first, most = team->left * own / ((double)PIECES * team->n_all_threads);
        int n = one ? 1 : own;
        while (!one && n < BIS_TEAM_MOST_TILES && n < left && until[n + 1] - *until <= most) n++;
        n = n < BIS_TEAM_MOST_TILES ? n : BIS_TEAM_MOST_TILES;
        if (one || may_get(team, rank, n, most)) {
            b.n = n < left ? n : left;
            team->next[b.list] += b.n;
            team->left -= until[b.n] - *until;
        }
    }
    for (int i = 0; i < b.n && team->w->visibility.n_tiles; i++) team->owner[team->order[b.first + i]] = rank;
    return b;
}

/* The next batch for a rank: its own tiles or nobody's, or those of rank 0 with what they have learned; others are
 * given by their owner. */
static void deal(bis_team *team, int rank)
{
    const batch b = take(team, rank, false);
    const bool moves = b.list != rank && b.list < team->crew->size, gives = moves && b.list > 0;

    if (b.n == 0) return;
    unsigned char *m = bis_team_message(team, (bis_team_head){.kind = gives ? BIS_TEAM_GIVE : BIS_TEAM_WORK,
                                                              .n_tiles = b.n, .to = rank, .learned = moves && !gives});
    for (int i = 0; i < b.n; i++) {
        const bis_team_tile h = {.tile = team->order[b.first + i]};
        m = bis_team_put(m, &h, sizeof h);
        if (moves && !gives) m = bis_team_put_learned(m, team->w, h.tile);
    }
    bis_team_send(team, gives ? b.list : rank, m);
    team->held[rank] += b.n;
    team->work[rank] += team->until[b.first + b.n] - team->until[b.first];
    team->n_held += b.n;
}

void bis_team_deal_progress(bis_team *team)
{
    int n;

#pragma omp critical(bis_team)
    n = team->n_finished;
    team->progress((double)(n + team->n_received) / team->w->n_tiles, team->user);
}

/* Tiles that a rank has done, or that it gives to rank 0. */
static void take_in(bis_team *team, int from, unsigned char *m)
{
    bis_team_head h;

    m = bis_team_get(m, &h, sizeof h);
    const int holder = h.kind == BIS_TEAM_WORK ? 0 : from;
    team->held[holder] -= h.n_tiles;
    team->n_held -= h.n_tiles;
    if (h.kind == BIS_TEAM_WORK) {
        team->work[0] = 0;
        bis_team_queue(team, &h, m);
        return;
    }
    for (int i = 0; i < h.n_tiles; i++) {
        bis_team_tile t;
        m = bis_team_get(m, &t, sizeof t);
        m = bis_team_get_pixels(m, team->w, t.tile);
        team->work[from] -= cost_of(team, t.tile);
        team->seconds[t.tile] = t.seconds;
    }
    team->n_received += h.n_tiles;
    deal(team, from);
    bis_team_deal_progress(team);
}

int bis_team_deal_take(bis_team *team)
{
    const int t = bis_team_take_queued(team);
    if (t >= 0) return t;
    const batch b = take(team, 0, true);
    return b.n ? team->order[b.first] : -1;
}

/* Once rank 0 has only tiles that others own, it asks for them, before its threads need them. */
static void ask_for_more(bis_team *team)
{
    bool has_enough;

#pragma omp critical(bis_team)
    has_enough = find_list(team, 0, false) >= 0 ||
                 team->n_queued - team->n_taken + team->held[0] >= team->threads[0];
    if (!has_enough) deal(team, 0);
}

static void send_stop(bis_crew *crew, int rank)
{
    crew->send(crew, rank, &(bis_team_head){.kind = BIS_TEAM_STOP}, sizeof(bis_team_head));
}

int bis_team_deal_next(bis_team *team)
{
    bis_crew *crew = team->crew;
    const bool renders = crew->size <= FEW;
    unsigned char *m;
    int from, t = -1;
    size_t n;

    for (;;) {
        while ((m = crew->receive(crew, &from, &n, false)) != NULL) take_in(team, from, m);
        if (renders) t = bis_team_deal_take(team);
        if (renders || team->threads[0] > 1) ask_for_more(team);
        if (t >= 0) return t;
        if (team->n_held == 0) break;
        bis_team_wait();
    }
    for (int i = 1; i < crew->size; i++) send_stop(crew, i);
#pragma omp atomic write
    team->over = true;
    return -1;
}

static void call_others(bis_team *team, bis_team_next_step next, const bis_pass *pass, bis_status status)
{
    bis_team_step c;
    memset(&c, 0, sizeof c);
    c.next = (int32_t)next;
    c.status = (int32_t)status;
    c.passes = team->w->film->passes;
    if (pass) c.pass = *pass;
    team->crew->broadcast(team->crew, &c, sizeof c);
}

void bis_team_call(bis_team *team, const bis_pass *pass, bis_status status)
{
    call_others(team, pass ? BIS_TEAM_PASS : BIS_TEAM_END, pass, status);
}

/* Asks a rank for n tiles and takes what they have learned. */
static void fetch(bis_team *team, int rank, const int *tiles, int n)
{
    bis_crew *crew = team->crew;
    unsigned char *m = bis_team_message(team, (bis_team_head){.kind = BIS_TEAM_GIVE, .n_tiles = n, .to = 0});
    int from;
    size_t size;

    for (int i = 0; i < n; i++) m = bis_team_put(m, &(bis_team_tile){.tile = tiles[i]}, sizeof(bis_team_tile));
    bis_team_send(team, rank, m);
    m = crew->receive(crew, &from, &size, true) + sizeof(bis_team_head);
    for (int i = 0; i < n; i++) m = bis_team_get_learned(m + sizeof(bis_team_tile), team->w, tiles[i]);
}

void bis_team_gather(bis_team *team)
{
    bis_crew *crew = team->crew;

    if (!team->w->visibility.n_tiles) return;
    call_others(team, BIS_TEAM_GATHER, NULL, BIS_OK);
    make_lists(team);
    for (int rank = 1; rank < crew->size; rank++) {
        for (int i = team->next[rank], n; i < team->end[rank]; i += n) {
            n = team->end[rank] - i < BIS_TEAM_MOST_TILES ? team->end[rank] - i : BIS_TEAM_MOST_TILES;
            fetch(team, rank, team->order + i, n);
        }
        send_stop(crew, rank);
    }
}

/* Before the first pass after a checkpoint rank 0 has all that was learned. */
static void own_all(bis_team *team)
{
    for (int t = 0; t < team->w->n_tiles; t++) team->owner[t] = 0;
}

void bis_team_deal_begin(bis_team *team)
{
    const bis_workspace *w = team->w;

    if (!team->knows && w->film->passes && w->visibility.n_tiles) own_all(team);
    make_lists(team);
    memset(team->work, 0, (size_t)team->crew->size * sizeof *team->work);
    for (int round = 0; round < 2; round++)
        for (int i = 1; i < team->crew->size; i++) deal(team, i);
}
