/* SPDX-License-Identifier: BSD-2-Clause */
/* checkpoint: the state of a render in a file, from which a later process goes on to the same bits. For render.c, which
 * writes and restores it, and src/cli/cmd_render.c, which names the files. */
#pragma once

#include "state.h"

/* All zeros but for what the caller sets: nothing is written, and the render starts from its first pass. */
struct bis_checkpoint {
    const char *path; /* written to; NULL: nowhere */
    double every;     /* seconds between two writes, looked at between passes */
    void (*warn)(const char *message); /* called if a write fails, unless the one before did; may be NULL */
    bool failed; /* the last write did */
    bis_state_head head; /* bis_checkpoint_begin and bis_checkpoint_read set it */

    /* bis_checkpoint_read: what it found; data is NULL where there is nothing to go on from */
    const char *source; /* where it read; borrowed */
    unsigned char *data;
    size_t size, at; /* bytes of data; where the state begins */
};

/* bis_checkpoint_read reads the checkpoint at path into *c and checks its version and checksum. Errors: BIS_IO,
 * BIS_NOMEM, BIS_INPUT (it is no checkpoint, it is damaged, another version of bis wrote it). */
bis_status bis_checkpoint_read(bis_checkpoint *c, const char *path, bis_diag *diag);

/* bis_checkpoint_clear frees what was read. */
void bis_checkpoint_clear(bis_checkpoint *c);

/* bis_checkpoint_begin identifies the render of w and, if a checkpoint was read, puts its state in *w, its film and
 * *done, and frees what was read. The edges of w must be known. Errors: BIS_INPUT (it belongs to another render; the
 * message names what differs). */
bis_status bis_checkpoint_begin(bis_checkpoint *c, bis_workspace *w, bis_done *done, bis_diag *diag);

/* bis_checkpoint_save writes the state to c->path, if there is one. The older file stays until the new one is complete.
 * A failure sets c->failed and is told to c->warn. */
void bis_checkpoint_save(bis_checkpoint *c, bis_workspace *w, bis_done *done);
