/* SPDX-License-Identifier: BSD-2-Clause */
/* scheduler_parts: what the files of the scheduler share: its state, its messages, the queue of tiles. For
 * src/render/scheduler*.c. */
#pragma once

#include "pass.h"
#include "scheduler.h"

enum { BIS_SCHED_MOST_TILES = 32 /* of a message */, BIS_SCHED_BUCKETS = 64, BIS_SCHED_NOBODY = -1 };

/* Tiles to render; tiles that are done; tiles that their owner is to send as WORK to another rank; no more tiles. */
typedef enum bis_sched_kind { BIS_SCHED_WORK, BIS_SCHED_DONE, BIS_SCHED_GIVE, BIS_SCHED_STOP } bis_sched_kind;

/* Before each message. */
typedef struct bis_sched_head {
    int32_t kind, n_tiles;
    int32_t to;      /* of GIVE: a rank */
    int32_t learned; /* of WORK: what each tile has learned follows it */
} bis_sched_head;

/* Before each tile of a message. */
typedef struct bis_sched_tile {
    int32_t tile;
    double seconds; /* of DONE */
} bis_sched_tile;

/* What all ranks do next: rank 0 broadcasts it between two passes. */
typedef enum bis_sched_next_step { BIS_SCHED_PASS, BIS_SCHED_GATHER, BIS_SCHED_END } bis_sched_next_step;

typedef struct bis_sched_step {
    int32_t next, status;
    uint32_t passes; /* complete ones */
    bis_pass pass;
} bis_sched_step;

struct bis_sched {
    bis_ranks *ranks;
    bis_workspace *w;
    void (*progress)(double share, void *user);
    void *user;
    double *seconds; /* seconds[n_tiles] of the last pass */
    unsigned char *message;
    uint32_t passes; /* complete ones, when the last one began */

    /* tiles that came by WORK, and those that were rendered here: under the lock but for `over` and n_sent */
    int *queue, n_queued, n_taken;
    int *finished, n_finished, n_sent;
    bool over;

    /* rank 0: list i < size of tiles to render has those that rank i owns, list `size` those of nobody */
    int *owner;    /* owner[n_tiles], or BIS_SCHED_NOBODY */
    int *order;    /* order[n_tiles]: list after list, each as it is dealt out */
    double *until; /* until[n_tiles + 1]: seconds of the tiles before, in that order; while nothing is known, tiles */
    int *bucket;   /* bucket[(size + 1) BIS_SCHED_BUCKETS + 1]: for the sort */
    int *next, *end; /* next[size + 1], end[size + 1] of the lists in order[] */
    double left;   /* seconds of the tiles in all lists */
    int *threads;  /* threads[size] of the ranks */
    int *held;     /* held[size]: tiles that were dealt to a rank and did not come back, or to rank 0, did not arrive */
    double *work;  /* work[size]: the seconds of these tiles, but of rank 0 */
    int n_held, n_received, n_all_threads;
    bool knows;    /* seconds */
};

/* ---- scheduler_parts.c ---- */

/* bis_sched_message begins the scheduler's next message; bis_sched_send sends what stands before end. */
unsigned char *bis_sched_message(const bis_sched *sched, bis_sched_head h);
void bis_sched_send(bis_sched *sched, int to, const unsigned char *end);

/* bis_sched_put and bis_sched_get copy n bytes into a message and out of it; the others what a pass has made of the
 * pixels of a tile, and what a tile has learned in complete passes. All return what follows in the message. */
unsigned char *bis_sched_put(unsigned char *m, const void *data, size_t n);
unsigned char *bis_sched_get(unsigned char *m, void *data, size_t n);
unsigned char *bis_sched_put_pixels(unsigned char *m, bis_workspace *w, int tile);
unsigned char *bis_sched_get_pixels(unsigned char *m, bis_workspace *w, int tile);
unsigned char *bis_sched_put_learned(unsigned char *m, const bis_workspace *w, int tile);
unsigned char *bis_sched_get_learned(unsigned char *m, const bis_workspace *w, int tile);

/* bis_sched_tile_bytes returns the bytes of one tile in a message, at most. */
size_t bis_sched_tile_bytes(const bis_workspace *w);

/* bis_sched_queue puts the tiles behind the head of a WORK into the queue. bis_sched_take_queued returns the next tile
 * of the queue, -1: none. */
void bis_sched_queue(bis_sched *sched, const bis_sched_head *h, unsigned char *m);
int bis_sched_take_queued(bis_sched *sched);

/* bis_sched_wait waits a little. */
void bis_sched_wait(void);

/* ---- scheduler_deal.c: rank 0 ---- */

/* bis_sched_deal_begin makes the lists of a pass and deals out the first batches. */
void bis_sched_deal_begin(bis_sched *sched);

/* bis_sched_deal_next looks after the other ranks and returns a tile for thread 0, -1: the pass is complete.
 * bis_sched_deal_take returns a tile for another thread of rank 0, -1: none at the moment. */
int bis_sched_deal_next(bis_sched *sched);
int bis_sched_deal_take(bis_sched *sched);

/* bis_sched_deal_progress tells the share of the tiles that are done. */
void bis_sched_deal_progress(bis_sched *sched);

/* ---- scheduler_work.c: the other ranks ---- */

/* bis_sched_work_next sends what is done and returns a tile for thread 0, -1: there are no more. */
int bis_sched_work_next(bis_sched *sched);
