/* SPDX-License-Identifier: BSD-2-Clause */
/* team_work: the side of the other ranks: render what came, send what is done, give what is asked for. */
#include "team_parts.h"

enum { TOGETHER = 8 };

/* Sends the n tiles behind the head of a GIVE as WORK. */
static void give(bis_team *team, const bis_team_head *h, unsigned char *m)
{
    const bis_team_head work = {.kind = BIS_TEAM_WORK, .n_tiles = h->n_tiles, .learned = true};
    unsigned char *out = bis_team_message(team, work);

    for (int i = 0; i < h->n_tiles; i++) {
        bis_team_tile t;
        m = bis_team_get(m, &t, sizeof t);
        out = bis_team_put_learned(bis_team_put(out, &t, sizeof t), team->w, t.tile);
    }
    bis_team_send(team, h->to, out);
}

static void read_message(bis_team *team, unsigned char *m)
{
    bis_team_head h;

    m = bis_team_get(m, &h, sizeof h);
    if (h.kind == BIS_TEAM_GIVE) give(team, &h, m);
    if (h.kind == BIS_TEAM_WORK) bis_team_queue(team, &h, m);
    if (h.kind == BIS_TEAM_STOP) {
#pragma omp atomic write
        team->over = true;
    }
}

/* Tiles that are done are sent together, if as many wait in the queue: rank 0 hears of them long before this rank has
 * nothing left. */
static void send_finished(bis_team *team)
{
    bis_workspace *w = team->w;
    int n, enough;

#pragma omp critical(bis_team)
    {
        n = team->n_finished;
        enough = team->n_queued - team->n_taken;
    }
    enough = enough < TOGETHER ? enough : TOGETHER;
    while (team->n_sent < n && n - team->n_sent >= enough) {
        const int n_tiles = n - team->n_sent < BIS_TEAM_MOST_TILES ? n - team->n_sent : BIS_TEAM_MOST_TILES;
        unsigned char *m = bis_team_message(team, (bis_team_head){.kind = BIS_TEAM_DONE, .n_tiles = n_tiles});
        for (int i = 0; i < n_tiles; i++) {
            const int t = team->finished[team->n_sent++];
            const bis_team_tile h = {.tile = t, .seconds = team->seconds[t]};
            m = bis_team_put_pixels(bis_team_put(m, &h, sizeof h), w, t);
        }
        bis_team_send(team, 0, m);
    }
}

int bis_team_work_next(bis_team *team)
{
    bis_crew *crew = team->crew;

    for (;;) {
        unsigned char *m;
        int from;
        size_t n;
        send_finished(team);
        while (!team->over && (m = crew->receive(crew, &from, &n, false)) != NULL) read_message(team, m);
        const int t = bis_team_take_queued(team);
        if (t >= 0 || team->over) return t;
        bis_team_wait();
    }
}

/* Between two passes: what rank 0 asks for. */
static void give_all(bis_team *team)
{
    bis_crew *crew = team->crew;
    bis_team_head h;

    do {
        int from;
        size_t n;
        unsigned char *m = bis_team_get(crew->receive(crew, &from, &n, true), &h, sizeof h);
        if (h.kind == BIS_TEAM_GIVE) give(team, &h, m);
    } while (h.kind == BIS_TEAM_GIVE);
}

bool bis_team_follow(bis_team *team, bis_pass *pass, bis_status *status)
{
    bis_team_step c;

    for (;;) {
        team->crew->broadcast(team->crew, &c, sizeof c);
        if (c.passes > team->passes) bis_team_learn(team);
        team->passes = c.passes;
        if (c.next != BIS_TEAM_GATHER) break;
        give_all(team);
    }
    *pass = c.pass;
    *status = (bis_status)c.status;
    return c.next == BIS_TEAM_PASS;
}
