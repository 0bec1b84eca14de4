/* SPDX-License-Identifier: BSD-2-Clause */
/* checkpoint: sums, counts and the number of passes; no random number has a state that could be lost.
 *
 * What a pass makes depends on its number, its first camera sample and its size (pass.c), on what earlier passes left
 * in the film and in visibility.h, and on the scene. All but the scene is here (state.h), and of the scene
 * a hash of each of its parts (identity.h), so that a checkpoint is refused where it would continue another picture.
 *
 * Cost: 52 bytes a pixel (and 8 for each value of a layer, 512 bytes for each cell that learns), written in one go. */
#include "checkpoint.h"

#include "base/text.h"
#include "bis/base/file.h"
#include "bis/base/mem.h"

#include <inttypes.h>

bis_status bis_checkpoint_read(bis_checkpoint *c, const char *path, bis_diag *diag)
{
    bis_walk w;

    c->source = path;
    bis_status status = bis_file_read(&c->data, &c->size, path, (bis_loc){path, 0, 0}, diag);
    if (status) return status;
    status = bis_state_open(&w, BIS_STATE_CHECKPOINT, c->data, c->size, path, diag);
    if (!status) bis_state_walk_head(&w, &c->head);
    if (!status && w.bad) status = bis_error(diag, BIS_INPUT, (bis_loc){path, 0, 0}, "this checkpoint is damaged");
    c->at = status ? 0 : (size_t)(w.in - c->data);
    if (status) bis_checkpoint_clear(c);
    return status;
}

void bis_checkpoint_clear(bis_checkpoint *c)
{
    bis_free(c->data);
    c->data = NULL;
}

/* "part 2 of 5", "the whole picture" */
static const char *part_name(char text[64], bis_part part)
{
    if (part.n) snprintf(text, 64, "part %" PRIu32 " of %" PRIu32, part.k, part.n);
    else snprintf(text, 64, "the whole picture");
    return text;
}

static bis_status compare(const bis_checkpoint *c, const bis_state_head *own, bis_diag *diag)
{
    const bis_loc at = {c->source, 0, 0};
    char list[1024], theirs[64], ours[64];

    if (bis_identity_differs(list, sizeof list, c->head.parts, own->parts))
        return bis_error(diag, BIS_INPUT, at,
                         "this checkpoint belongs to another render. These differ: %s. Give the scene and options that "
                         "it was made with, or start afresh without --resume", list);
    if (c->head.part.k == own->part.k && c->head.part.n == own->part.n) return BIS_OK;
    return bis_error(diag, BIS_INPUT, at, "this checkpoint is one of %s, not of %s: give the --part that it was made "
                     "with, or start afresh without --resume", part_name(theirs, c->head.part),
                     part_name(ours, own->part));
}

/* Only a file with a forged checksum can fail here. */
static bool is_sound(const bis_done *d, uint32_t passes, double weight)
{
    return passes > 0 && d->spp > 0 && weight > 0 && d->seconds >= 0;
}

static bis_status restore(bis_checkpoint *c, bis_workspace *of, bis_done *done, bis_diag *diag)
{
    bis_walk w = {.in = c->data + c->at, .end = c->data + c->size - BIS_STATE_CHECKSUM};
    bis_film *f = of->film;

    bis_state_walk_done(&w, done, f);
    w.bad |= (uint64_t)(w.end - w.in) != bis_state_sums_bytes(of);
    if (!w.bad) bis_state_walk_sums(&w, of);
    if (w.bad || !is_sound(done, f->passes, f->weight))
        return bis_error(diag, BIS_INPUT, (bis_loc){c->source, 0, 0}, "this checkpoint is damaged");
    return BIS_OK;
}

bis_status bis_checkpoint_begin(bis_checkpoint *c, bis_workspace *w, bis_done *done, bis_diag *diag)
{
    bis_state_head own = {.settings = w->view->settings, .part = w->options->part};

    bis_identify(own.parts, w);
    bis_status status = c->data ? compare(c, &own, diag) : BIS_OK;
    if (!status && c->data) status = restore(c, w, done, diag);
    c->head = own;
    bis_checkpoint_clear(c);
    return status;
}

void bis_checkpoint_save(bis_checkpoint *c, bis_workspace *w, bis_done *done)
{
    const bool failed_before = c->failed;
    bis_state_head head = c->head; /* the walk looks for the integrator by its name */
    bis_diag diag = {0};
    bis_outfile *file;

    if (!c->path) return;
    c->failed = bis_outfile_open(&file, c->path, &diag) != BIS_OK;
    if (!c->failed) {
        bis_walk out = {.out = bis_outfile_stream(file), .hash = BIS_FNV1A};
        bis_state_begin(&out, BIS_STATE_CHECKPOINT);
        bis_state_walk_head(&out, &head);
        bis_state_walk_done(&out, done, w->film);
        bis_state_walk_sums(&out, w);
        bis_state_end(&out);
        c->failed = bis_outfile_commit(file, &diag) != BIS_OK;
    }
    if (c->failed && !failed_before && c->warn) c->warn(diag.n ? diag.messages[0].body : "no memory");
    bis_diag_clear(&diag);
}
