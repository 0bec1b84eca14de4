/* SPDX-License-Identifier: BSD-2-Clause */
/* pixel_report: what `bis pixel` found, as text, JSON, CSV files and pictures. For src/cli/cmd_pixel.c alone. */
#pragma once

#include "pixel.h"

#include <stdio.h>

typedef struct bis_pixel_report {
    const bis_scene_desc *desc;
    const bis_scene *scene;
    int x, y;
    const char *folder;      /* where files go; it is there */
    const char *why_nothing; /* no surface, no light, no reflection; NULL: all below is filled */
    bool is_hit;
    ray eye;
    bis_pixel_hit hit;
    bis_point pt;
    bis_pixel_exact exact;
    size_t n_methods;
    bis_pixel_method methods[BIS_PIXEL_MAX_METHODS];
    bis_pixel_rays rays[BIS_PIXEL_MAX_METHODS];
    bis_pixel_candidates candidates;
} bis_pixel_report;

void bis_pixel_report_clear(bis_pixel_report *r); /* NULL is fine */

void bis_pixel_print_text(FILE *out, const bis_pixel_report *r);
void bis_pixel_print_json(FILE *out, const bis_pixel_report *r);

/* densities.svg, samples.svg, methods.csv, candidates.csv, rays.csv. Errors: BIS_IO, BIS_NOMEM. */
bis_status bis_pixel_write_files(const bis_pixel_report *r, bis_diag *diag);
