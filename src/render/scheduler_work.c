/* SPDX-License-Identifier: BSD-2-Clause */
/* scheduler_work: the side of the other ranks: render what came, send what is done, give what is asked for. */
#include "scheduler_parts.h"

enum { TOGETHER = 8 };

/* Sends the n tiles behind the head of a GIVE as WORK. */
static void give(bis_sched *sched, const bis_sched_head *h, unsigned char *m)
{
    const bis_sched_head work = {.kind = BIS_SCHED_WORK, .n_tiles = h->n_tiles, .learned = true};
    unsigned char *out = bis_sched_message(sched, work);

    for (int i = 0; i < h->n_tiles; i++) {
        bis_sched_tile t;
        m = bis_sched_get(m, &t, sizeof t);
        out = bis_sched_put_learned(bis_sched_put(out, &t, sizeof t), sched->w, t.tile);
    }
    bis_sched_send(sched, h->to, out);
}

static void read_message(bis_sched *sched, unsigned char *m)
{
    bis_sched_head h;

    m = bis_sched_get(m, &h, sizeof h);
    if (h.kind == BIS_SCHED_GIVE) give(sched, &h, m);
    if (h.kind == BIS_SCHED_WORK) bis_sched_queue(sched, &h, m);
    if (h.kind == BIS_SCHED_STOP) {
#pragma omp atomic write
        sched->over = true;
    }
}

/* Tiles that are done are sent together, if as many wait in the queue: rank 0 hears of them long before this rank has
 * nothing left. */
static void send_finished(bis_sched *sched)
{
    bis_workspace *w = sched->w;
    int n, enough;

#pragma omp critical(bis_sched)
    {
        n = sched->n_finished;
        enough = sched->n_queued - sched->n_taken;
    }
    enough = enough < TOGETHER ? enough : TOGETHER;
    while (sched->n_sent < n && n - sched->n_sent >= enough) {
        const int n_tiles = n - sched->n_sent < BIS_SCHED_MOST_TILES ? n - sched->n_sent : BIS_SCHED_MOST_TILES;
        unsigned char *m = bis_sched_message(sched, (bis_sched_head){.kind = BIS_SCHED_DONE, .n_tiles = n_tiles});
        for (int i = 0; i < n_tiles; i++) {
            const int t = sched->finished[sched->n_sent++];
            const bis_sched_tile h = {.tile = t, .seconds = sched->seconds[t]};
            m = bis_sched_put_pixels(bis_sched_put(m, &h, sizeof h), w, t);
        }
        bis_sched_send(sched, 0, m);
    }
}

int bis_sched_work_next(bis_sched *sched)
{
    bis_ranks *ranks = sched->ranks;

    for (;;) {
        unsigned char *m;
        int from;
        size_t n;
        send_finished(sched);
        while (!sched->over && (m = ranks->receive(ranks, &from, &n, false)) != NULL) read_message(sched, m);
        const int t = bis_sched_take_queued(sched);
        if (t >= 0 || sched->over) return t;
        bis_sched_wait();
    }
}

/* Between two passes: what rank 0 asks for. */
static void give_all(bis_sched *sched)
{
    bis_ranks *ranks = sched->ranks;
    bis_sched_head h;

    do {
        int from;
        size_t n;
        unsigned char *m = bis_sched_get(ranks->receive(ranks, &from, &n, true), &h, sizeof h);
        if (h.kind == BIS_SCHED_GIVE) give(sched, &h, m);
    } while (h.kind == BIS_SCHED_GIVE);
}

bool bis_sched_follow(bis_sched *sched, bis_pass *pass, bis_status *status)
{
    bis_sched_step c;

    for (;;) {
        sched->ranks->broadcast(sched->ranks, &c, sizeof c);
        if (c.passes > sched->passes) bis_sched_learn(sched);
        sched->passes = c.passes;
        if (c.next != BIS_SCHED_GATHER) break;
        give_all(sched);
    }
    *pass = c.pass;
    *status = (bis_status)c.status;
    return c.next == BIS_SCHED_PASS;
}
