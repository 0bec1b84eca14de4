/* SPDX-License-Identifier: BSD-2-Clause */
/* still: what the still figures of docs show, as numbers. Each figure is an object of JSON (docs/live.md);
 * scripts/figures/still.js draws it. "right" comes from the library's own functions, "printed", for items of
 * docs/errata.md, from a few lines beside them.
 * Nothing here returns an error: what cannot go on prints why and exits with 1. */
#ifndef STILL_H
#define STILL_H

#include "bis/base/image.h"
#include "bis/thesis/integrator.h"
#include "bis/thesis/envmap.h"
#include "bis/thesis/importance.h"
#include "tools/json.h"

enum { ERRATA_SEED = 34 };

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

/* ---- a point under a map (errata_point.c) ---- */

/* The map's radiance at pixel (x, y) of width x height. */
typedef rgb errata_paint(int x, int y, int width, int height);

void errata_map(bis_envmap *em, int width, int height, errata_paint *paint);
bis_light *errata_light(int width, int height, errata_paint *paint, bis_table_kind kind);

/* A point that sees the whole sky, or only that half of it where y < 0. */
typedef struct errata_spot {
    bis_accel accel; /* first: what bis_accel_occluded sees */
    bis_material material;
    bis_counters counters;
    bis_point pt;
} errata_spot;

/* Seen at `degrees` from the normal. s must stay where it is (pt points into it). */
void errata_spot_init(errata_spot *s, const bis_light *light, bis_material m, vec3 n, double degrees, bool half_hidden);

/* Mean and variance of r+g+b of `runs` independent estimates. */
typedef struct errata_moments {
    double mean, variance;
} errata_moments;

errata_moments errata_run(errata_spot *s, const bis_settings *settings, uint32_t runs);

/* ---- the figures: each writes the members of its object ---- */

typedef void still_figure(bis_json *j);

still_figure thesis_marsaglia, thesis_alias, thesis_phong, thesis_draws, thesis_rejection, thesis_bounds,
    thesis_resampling; /* thesis.c */
still_figure errata_E1, errata_E2, errata_E4, errata_E5, errata_E17, errata_E18, errata_E19; /* errata_maps.c */
still_figure errata_E8, errata_E10, errata_E11, errata_E12, errata_E14, errata_E15; /* errata_tables.c */
still_figure errata_E9, errata_E24, errata_E25, errata_E26, errata_E28, errata_E30, errata_E31,
    errata_E32; /* errata_estimators.c */
still_figure errata_E33, errata_E35, errata_E36, errata_E37; /* errata_surfaces.c */

#endif
