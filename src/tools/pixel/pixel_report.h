/* SPDX-License-Identifier: BSD-2-Clause */
/* pixel_report: what `bis pixel` found, as text, JSON, CSV files and a page. For src/cli/cmd_pixel.c alone. */
#pragma once

#include "pixel.h"

#include "out/json.h"

#include <stdio.h>

typedef struct bis_pixel_report {
    const bis_scene_desc *desc;
    const bis_scene *scene;
    int x, y;
    const char *folder;      /* where files go; it is there */
    bool html;               /* pixel.html, too */
    const char *why_nothing; /* no surface, no light, no reflection; NULL: all below is filled */
    bool is_hit;
    bis_pixel_hit hit;
    bis_point pt;
    bis_pixel_exact exact;
    size_t n_methods;
    bis_pixel_method methods[BIS_PIXEL_MAX_METHODS];
    bis_pixel_rays rays[BIS_PIXEL_MAX_METHODS];
    bis_pixel_candidates candidates;
} bis_pixel_report;

/* bis_pixel_report_clear frees what was found. NULL is fine. */
void bis_pixel_report_clear(bis_pixel_report *r);

/* bis_pixel_print_text prints the report as text, bis_pixel_print_json as JSON. */
void bis_pixel_print_text(FILE *out, const bis_pixel_report *r);
void bis_pixel_print_json(FILE *out, const bis_pixel_report *r);

/* bis_pixel_put_report writes the members of the JSON object into one that is open. */
void bis_pixel_put_report(bis_json *j, const bis_pixel_report *r);

/* bis_pixel_is_too_skew returns whether a z of this method is not that of a normal distribution. */
bool bis_pixel_is_too_skew(const bis_pixel_method *m);

/* bis_pixel_write_files writes methods.csv, candidates.csv, rays.csv, and pixel.html where it is asked for. Errors:
 * BIS_IO, BIS_NOMEM. */
bis_status bis_pixel_write_files(const bis_pixel_report *r, bis_diag *diag);

/* --- pixel_page.c --- */

enum { BIS_PIXEL_SPHERE_WIDTH = 720, BIS_PIXEL_SPHERE_HEIGHT = 360, BIS_PIXEL_SPHERE_DECADES = 7 };

/* bis_pixel_write_page writes the page: the report; the densities q_L (eq. 4.2), q_f (4.3), their product p (4.4) and
 * what of it is seen over the whole sphere; all rays; all candidates that weigh something. Errors: BIS_IO,
 * BIS_NOMEM. */
bis_status bis_pixel_write_page(const char *path, const bis_pixel_report *r, bis_diag *diag);
