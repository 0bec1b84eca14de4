/* SPDX-License-Identifier: BSD-2-Clause */
/* team: what ranks do together in a render: each renders its share of every pass. For pass.c and render.c. */
#pragma once

#include "pass.h"
#include "ranks.h"

/* bis_team_meet compares the scenes of the ranks (bis_ranks_compare). *n_threads becomes the sum over the ranks. */
bis_status bis_team_meet(const bis_workspace *w, int *n_threads, bis_diag *diag);

/* bis_team_call tells the others, from rank 0, which pass comes next; pass is NULL where there is none any more,
 * because of `status`. bis_team_follow waits for that on another rank, and takes part meanwhile in what rank 0 calls
 * for; it returns false where there is none, and *status. */
void bis_team_call(const bis_workspace *w, const bis_pass *pass, bis_status status);
bool bis_team_follow(bis_workspace *w, bis_pass *pass, bis_status *status);

/* bis_team_spread gives to all ranks what tiles have learned by a checkpoint, which rank 0 has read. bis_team_gather
 * brings to rank 0, between two passes, what they have learned on all ranks. Both are called on rank 0. */
void bis_team_spread(bis_workspace *w);
void bis_team_gather(bis_workspace *w);

/* bis_team_begin_pass empties the pass under way, before a rank renders its share. bis_team_end_pass gives the whole
 * pass to all ranks, the counters of all to the first worker of rank 0, and sets w->is_ended if a rank was interrupted.
 * All ranks must call both. */
void bis_team_begin_pass(bis_workspace *w);
void bis_team_end_pass(bis_workspace *w);
