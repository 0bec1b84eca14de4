/* SPDX-License-Identifier: BSD-2-Clause */
/* team: who of a crew renders which tile of a pass. For pass.c and render.c. */
#pragma once

#include "crew.h"
#include "workspace.h"

struct bis_pass;

typedef struct bis_team bis_team;

/* bis_team_new makes the team of a workspace; NULL: no memory. threads[] and the rest of it are set by
 * bis_team_meet. */
bis_team *bis_team_new(bis_crew *crew, bis_workspace *w);
void bis_team_free(bis_team *team);

/* bis_team_meet compares the scenes of the ranks (bis_crew_compare). *n_threads becomes the sum over the ranks. */
bis_status bis_team_meet(bis_team *team, const bis_workspace *w, int *n_threads, bis_diag *diag);

/* bis_team_call tells the others, from rank 0, which pass comes next; pass is NULL where there is none any more,
 * because of `status`. bis_team_follow waits for that on another rank, and does meanwhile what rank 0 asks for; it
 * returns false where there is none, and *status. */
void bis_team_call(bis_team *team, const struct bis_pass *pass, bis_status status);
bool bis_team_follow(bis_team *team, struct bis_pass *pass, bis_status *status);

/* A pass, on every rank: begin; then each thread takes tiles, and says when one is done and how many seconds it took,
 * until there is none (-1); then end, which adds what the others have counted to that of the first worker of rank 0.
 * Thread 0 sends and receives between its tiles. progress is called by thread 0 of rank 0. */
void bis_team_begin(bis_team *team, void (*progress)(double share, void *user), void *user);
int bis_team_next(bis_team *team, int thread);
void bis_team_finish(bis_team *team, int thread, int tile, double seconds);
void bis_team_end(bis_team *team);

/* bis_team_learn lets visibility learn from the last pass in the tiles that were rendered here; on rank 0 the pass must
 * be complete. Other ranks do it by themselves. */
void bis_team_learn(bis_team *team);

/* bis_team_gather brings to rank 0, between two passes, what the tiles have learned in complete passes. */
void bis_team_gather(bis_team *team);

/* bis_team_bytes returns the bytes of *team. */
size_t bis_team_bytes(const bis_team *team);
