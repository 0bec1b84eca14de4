/* SPDX-License-Identifier: BSD-2-Clause */
/* auto_pilot: every k-th pixel rendered with several settings, for cost and variance of each. For
 * src/tools/auto/auto.c. */
#pragma once

#include "auto.h"

/* Replicates in all, half of them in each of the first two rounds. */
enum { BIS_AUTO_REPLICATES = 4 };

/* What the report does not hold of a setting. */
typedef struct bis_auto_trial {
    int family, wanted;    /* wanted: replicates in this round */
    bis_status status;
    double *sum, *squares; /* [pixels][3] over replicates */
    double seconds, fill;  /* of a replicate, the least so far: the pilot's film, and a film of one pixel */
} bis_auto_trial;

typedef struct bis_auto_pilot {
    const bis_scene *scene;
    const bis_scene_desc *desc;
    bis_view view; /* with the pilot's film and sampler; each replicate changes a copy */
    bis_settings base;   /* what was asked for */
    bis_render_options options;
    int n_threads;
    double covered;      /* the share of the picture in which a surface is seen */
    bool is_quick;       /* the short list */
    uint32_t passes;     /* of a replicate */
    double scale;        /* pixels of the picture : pixels of the pilot */
    size_t n_pixels;
    double *picture;     /* [n_pixels][3] the mean of all trials */
    bool *shaded;        /* [n_pixels] has been seen to show a surface: the others are the same with any setting */
    bool is_diffuse;     /* all materials are */
    bis_auto_trial trials[BIS_AUTO_MOST_TRIED];
    bis_auto_report *report;
} bis_auto_pilot;

/* bis_auto_no_memory adds that error and returns BIS_NOMEM. */
bis_status bis_auto_no_memory(const bis_scene_desc *desc, bis_diag *diag);

/* bis_auto_is_interrupted returns whether the user has interrupted the pilot. */
bool bis_auto_is_interrupted(const bis_auto_pilot *p);

/* bis_auto_pilot_start makes room; desc, passes, scale, options and n_pixels are known. Errors: BIS_NOMEM. */
bis_status bis_auto_pilot_start(bis_auto_pilot *p, bis_diag *diag);
void bis_auto_pilot_clear(bis_auto_pilot *p);

/* bis_auto_pilot_add puts a setting on the list, with so many replicates wanted. The first one of all finds the pixels
 * that show a surface. Errors: BIS_NOMEM. */
bis_status bis_auto_pilot_add(bis_auto_pilot *p, int family, const bis_settings *s, int wanted, bis_diag *diag);

/* bis_auto_pilot_run renders all replicates that are wanted, by all threads. Errors: BIS_NOMEM. */
bis_status bis_auto_pilot_run(bis_auto_pilot *p, bis_diag *diag);

/* bis_auto_pilot_measure computes the costs and variances of the report from all replicates so far. */
void bis_auto_pilot_measure(bis_auto_pilot *p);
