/* SPDX-License-Identifier: BSD-2-Clause */
/* team: several processes render one picture. Each renders the same share of the tiles in every pass (share.h), and at
 * the end of a pass the shares are joined: the pixels of a rank are 0 where others render, so a bitwise or is the
 * whole.
 *
 * The shares are a deal of cards along a curve, so each is a fair sample of the picture: no rank waits long for
 * another, and nobody need know who is how fast. What a tile has learned (visibility.h) stays with its rank, because
 * the tile does. Only rank 0 keeps the film, the budgets and the files: for a checkpoint it gathers what was learned,
 * and spreads it after one was read. So checkpoints, budgets and the next pass do not know how many ranks there are.
 *
 * A pass that some rank could not complete is given up by all: its counts are not learned. Numbers travel as they are
 * in memory: all machines must be of one kind. */
#include "team.h"

#include <string.h>

/* What all ranks do next: rank 0 broadcasts it between two passes. */
typedef enum next_step { NEXT_PASS, NEXT_SPREAD, NEXT_GATHER, NEXT_END } next_step;

typedef struct step {
    int32_t next, status;
    bis_pass pass;
} step;

bis_status bis_team_meet(const bis_workspace *w, int *n_threads, bis_diag *diag)
{
    uint64_t parts[BIS_IDENTITY_PARTS];

    bis_identify(parts, w);
    *n_threads = w->n_threads;
    return bis_ranks_compare(w->options->ranks, parts, n_threads, diag);
}

static void call(const bis_workspace *w, next_step next, const bis_pass *pass, bis_status status)
{
    bis_ranks *ranks = w->options->ranks;
    step s;

    memset(&s, 0, sizeof s);
    s.next = (int32_t)next;
    s.status = (int32_t)status;
    if (pass) s.pass = *pass;
    ranks->broadcast(ranks, 0, &s, sizeof s);
}

void bis_team_call(const bis_workspace *w, const bis_pass *pass, bis_status status)
{
    call(w, pass ? NEXT_PASS : NEXT_END, pass, status);
}

static size_t learned_bytes(const bis_workspace *w)
{
    return (size_t)w->n_tiles * w->visibility.cells * sizeof *w->visibility.known;
}

static void spread(bis_workspace *w)
{
    bis_ranks *ranks = w->options->ranks;
    ranks->broadcast(ranks, 0, w->visibility.known, learned_bytes(w));
}

/* What a rank knows of the tiles of others is old: it must not be joined with what they know. */
static void gather(bis_workspace *w)
{
    bis_ranks *ranks = w->options->ranks;
    const size_t tile = w->visibility.cells * sizeof *w->visibility.known;
    unsigned char *known = (unsigned char *)w->visibility.known;

    for (int t = 0, i = 0; t < w->n_tiles; t++) {
        if (i < w->n_share && w->share[i] == t) i++;
        else memset(known + (size_t)t * tile, 0, tile);
    }
    ranks->join_bits(ranks, known, learned_bytes(w));
}

void bis_team_spread(bis_workspace *w)
{
    if (!w->visibility.n_tiles) return;
    call(w, NEXT_SPREAD, NULL, BIS_OK);
    spread(w);
}

void bis_team_gather(bis_workspace *w)
{
    if (!w->visibility.n_tiles) return;
    call(w, NEXT_GATHER, NULL, BIS_OK);
    gather(w);
}

bool bis_team_follow(bis_workspace *w, bis_pass *pass, bis_status *status)
{
    bis_ranks *ranks = w->options->ranks;
    step s;

    for (;;) {
        ranks->broadcast(ranks, 0, &s, sizeof s);
        if (s.next == NEXT_SPREAD) spread(w);
        else if (s.next == NEXT_GATHER) gather(w);
        else break;
    }
    *pass = s.pass;
    *status = (bis_status)s.status;
    return s.next == NEXT_PASS;
}

/* The arrays of the pass under way, and their bytes; NULL: there is none. */
enum { ARRAYS = 3 };
static void find_arrays(const bis_workspace *w, unsigned char *array[ARRAYS], size_t bytes[ARRAYS])
{
    const bis_film *f = w->film;
    const size_t n = (size_t)f->width * (size_t)f->height;

    array[0] = (unsigned char *)w->pass;
    bytes[0] = n * sizeof *w->pass;
    array[1] = (unsigned char *)w->pass_layers;
    bytes[1] = n * (size_t)f->layers.n_values * sizeof *w->pass_layers;
    array[2] = (unsigned char *)w->pass_twins;
    bytes[2] = w->pass_twins ? bis_film_twins(f) * sizeof *w->pass_twins : 0;
}

void bis_team_begin_pass(bis_workspace *w)
{
    unsigned char *array[ARRAYS];
    size_t bytes[ARRAYS];

    find_arrays(w, array, bytes);
    for (int i = 0; i < ARRAYS; i++)
        if (array[i]) memset(array[i], 0, bytes[i]);
}

void bis_team_end_pass(bis_workspace *w)
{
    enum { COUNTERS = sizeof(bis_counters) / sizeof(uint64_t) };
    bis_ranks *ranks = w->options->ranks;
    unsigned char *array[ARRAYS];
    size_t bytes[ARRAYS];
    uint64_t sum[COUNTERS + 1] = {0};
    bis_counters own = {0};

    for (int i = 0; i < w->n_threads; i++) bis_counters_add(&own, &w->workers[i].counters);
    memcpy(sum, &own, sizeof own);
    sum[COUNTERS] = bis_workspace_interrupted(w);
    ranks->add(ranks, sum, COUNTERS + 1);
    w->is_ended = sum[COUNTERS] > 0;
    for (int i = 0; i < w->n_threads; i++) w->workers[i].counters = (bis_counters){0};
    memcpy(&w->workers[0].counters, sum, sizeof own);
    find_arrays(w, array, bytes);
    for (int i = 0; i < ARRAYS && !w->is_ended; i++)
        if (array[i]) ranks->join_bits(ranks, array[i], bytes[i]);
}
