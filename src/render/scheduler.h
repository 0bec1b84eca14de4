/* SPDX-License-Identifier: BSD-2-Clause */
/* scheduler: who of the ranks renders which tile of a pass. For pass.c and render.c. */
#pragma once

#include "ranks.h"
#include "workspace.h"

struct bis_pass;

typedef struct bis_sched bis_sched;

/* bis_sched_new makes the scheduler of a workspace; NULL: no memory. threads[] and the rest of it are set by
 * bis_sched_meet. */
bis_sched *bis_sched_new(bis_ranks *ranks, bis_workspace *w);
void bis_sched_free(bis_sched *sched);

/* bis_sched_meet compares the scenes of the ranks (bis_ranks_compare). *n_threads becomes the sum over the ranks. */
bis_status bis_sched_meet(bis_sched *sched, const bis_workspace *w, int *n_threads, bis_diag *diag);

/* bis_sched_call tells the others, from rank 0, which pass comes next; pass is NULL where there is none any more,
 * because of `status`. bis_sched_follow waits for that on another rank, and does meanwhile what rank 0 asks for; it
 * returns false where there is none, and *status. */
void bis_sched_call(bis_sched *sched, const struct bis_pass *pass, bis_status status);
bool bis_sched_follow(bis_sched *sched, struct bis_pass *pass, bis_status *status);

/* bis_sched_begin begins a pass, on every rank. Each thread then takes tiles (bis_sched_next), and says when one is
 * done and how many seconds it took (bis_sched_finish), until there is none (-1). bis_sched_end adds what the others
 * have counted to that of the first worker of rank 0. Thread 0 sends and receives between its tiles. progress is called
 * by thread 0 of rank 0. */
void bis_sched_begin(bis_sched *sched, void (*progress)(double share, void *user), void *user);
int bis_sched_next(bis_sched *sched, int thread);
void bis_sched_finish(bis_sched *sched, int thread, int tile, double seconds);
void bis_sched_end(bis_sched *sched);

/* bis_sched_learn lets visibility learn from the last pass in the tiles that were rendered here; on rank 0 the pass
 * must be complete. Other ranks do it by themselves. */
void bis_sched_learn(bis_sched *sched);

/* bis_sched_gather brings to rank 0, between two passes, what the tiles have learned in complete passes. */
void bis_sched_gather(bis_sched *sched);

/* bis_sched_bytes returns the bytes of *sched. */
size_t bis_sched_bytes(const bis_sched *sched);
