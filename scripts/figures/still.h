/* SPDX-License-Identifier: BSD-2-Clause */
/* still: what the still figures of docs show, as numbers. Each figure is an object of JSON (docs/live.md);
 * scripts/figures/still.js draws it.
 * Nothing here returns an error: what cannot go on prints why and exits with 1. */
#ifndef STILL_H
#define STILL_H

#include "bis/base/image.h"
#include "bis/thesis/integrator.h"
#include "bis/thesis/envmap.h"
#include "bis/thesis/importance.h"
#include "tools/json.h"

/* Leave with a word where status is an error. */
void still_check(bis_status status);

/* An array of n numbers under key. */
void still_list(bis_json *j, const char *key, const double *v, int n);

/* The picture's pixels under key, as a PNG in an address; frees them. */
void still_picture(bis_json *j, const char *key, bis_image *image);

/* A picture of black pixels. */
bis_image still_field(int width, int height);

/* folder/NAME.json of each of the n figures; of all where n is 0. False: there is none of a name. */
bool still_write(const char *folder, char *const *names, int n);

/* ---- the figures: each writes the members of its object ---- */

typedef void still_figure(bis_json *j);

still_figure thesis_marsaglia, thesis_alias, thesis_phong, thesis_draws, thesis_rejection, thesis_bounds,
    thesis_resampling; /* thesis.c */

#endif
