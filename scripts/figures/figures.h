/* SPDX-License-Identifier: BSD-2-Clause */
/* figures: the parts of the program that draws the thesis's figures again (scripts/figures/figures.c, figures_plots.c).
 * Nothing here returns an error: what cannot go on prints why and exits with 1. */
#ifndef FIGURES_H
#define FIGURES_H

#include "bis/base/image.h"

#include <stdio.h>

rgb figures_ink(void);
rgb figures_faint(void);

/* White paper, to be folder/name.json (drawing.h); and what is drawn on it becomes that file. */
FILE *figures_paper(const char *folder, const char *name, int width, int height);
void figures_save(FILE *svg);

/* Figures 3.3, 3.4, 3.8, 3.9, 4.3, 4.4 and 4.5 as 3.3.svg, ... : drawn by the library's own tables, samplers and
 * densities. */
void figures_plots(const char *folder);

#endif
