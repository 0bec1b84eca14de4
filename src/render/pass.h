/* SPDX-License-Identifier: BSD-2-Clause */
/* pass: from camera samples to the film: one pass over all tiles. For render.c. */
#pragma once

#include "workspace.h"

typedef struct bis_pass {
    uint32_t number; /* of the pass, from 0 */
    uint32_t n;      /* camera samples of a pixel */
    uint64_t first;  /* camera samples of a pixel in the passes before */
    double weight;   /* of the pass in the film */
} bis_pass;

/* bis_pass_render renders a pass and keeps it aside in *w. It returns false if it was interrupted: some pixels were
 * then not done. The first pass, if w->fine is there, begins with a glimpse (first_light.h) and ends when it is late;
 * it then returns true, too. */
bool bis_pass_render(bis_workspace *w, const bis_pass *pass, bis_pass_progress *progress, void *user);

/* bis_pass_learn lets visibility learn from a complete pass, in the tiles that were rendered here. */
void bis_pass_learn(const bis_workspace *w);

/* bis_pass_keep adds the pass under way to the film and its counters to *sum, and lets visibility learn from it. */
void bis_pass_keep(bis_workspace *w, const bis_pass *pass, bis_counters *sum);
