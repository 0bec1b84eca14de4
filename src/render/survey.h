/* SPDX-License-Identifier: BSD-2-Clause */
/* survey: looks around in the picture before its first samples, coarse to fine. For pass.c and workspace.c. */
#pragma once

#include "workspace.h"

/* bis_survey_squares returns how many squares the survey of a film's picture has. */
size_t bis_survey_squares(const bis_film *f);

/* bis_survey_place says which square is around each tile of the film, and around each square. */
void bis_survey_place(bis_visibility *v, const bis_film *f);

/* bis_survey looks around in squares that hold a tile of the film, and closes them: first in those of 128 pixels and
 * more and in that of the whole picture, then, if is_fine, in all others. w->clusters must be those of the first pass.
 * Rays are counted once for the picture: if `counts`, and not by other parts or ranks than the first. Where it is
 * interrupted it is as if it had not begun. The fine one ends as well when the first pass is late. */
void bis_survey(bis_workspace *w, bool is_fine, bool counts, bis_pass_progress *progress, void *user);

/* bis_survey_tile looks around in tile t. The squares must be closed. Where it is interrupted it has learned less. */
void bis_survey_tile(const bis_workspace *w, bis_worker *me, int t);

/* bis_survey_pixel stores the place of pixel i of a tile, in an order that keeps neighbours together (Morton 1966): any
 * 16 that begin at a multiple of 16 are a square. */
void bis_survey_pixel(int i, int *x, int *y);

