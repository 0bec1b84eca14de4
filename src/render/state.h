/* SPDX-License-Identifier: BSD-2-Clause */
/* state: what a render has done, as fields of a file of one of two kinds. For checkpoint.c, part.c and render.c. */
#pragma once

#include "identity.h"
#include "walk.h"
#include "workspace.h"

/* What a render has done, beside its film. */
typedef struct bis_done {
    uint64_t spp;          /* camera samples of a pixel in complete passes */
    double seconds;        /* in all processes that took part */
    uint32_t next_check;   /* number of passes at which the error is estimated next */
    double rmse_upper;     /* as estimated last; NAN: not yet */
    bis_counters counters;
} bis_done;

/* Who did it. */
typedef struct bis_state_head {
    bis_settings settings; /* of the render; integrator is NULL if this program does not know it */
    bis_part part;
    uint64_t parts[BIS_IDENTITY_PARTS];
} bis_state_head;

typedef enum bis_state_kind { BIS_STATE_CHECKPOINT, BIS_STATE_PART } bis_state_kind;

enum { BIS_STATE_BEFORE = 8 + 4 + BIS_WALK_NAME, BIS_STATE_CHECKSUM = 8 }; /* bytes before the head, at the end */

/* bis_state_begin writes what stands before the head, bis_state_end the checksum. */
void bis_state_begin(bis_walk *w, bis_state_kind kind);
void bis_state_end(bis_walk *w);

/* bis_state_open checks the first bytes of a file, its checksum and its version, and begins a walk at the head. data is
 * borrowed. Errors: BIS_INPUT. */
bis_status bis_state_open(bis_walk *w, bis_state_kind kind, const unsigned char *data, size_t size, const char *path,
                          bis_diag *diag);

/* bis_state_walk_head, bis_state_walk_done and bis_state_walk_sums walk over a part of the file each. The sums are
 * those of the workspace's own tiles; it needs the film, the own tiles, and what it has of visibility. */
void bis_state_walk_head(bis_walk *w, bis_state_head *h);
void bis_state_walk_done(bis_walk *w, bis_done *d, bis_film *f);
void bis_state_walk_sums(bis_walk *w, bis_workspace *of);

/* bis_state_sums_bytes returns the bytes of the sums. */
uint64_t bis_state_sums_bytes(const bis_workspace *of);
