/* SPDX-License-Identifier: BSD-2-Clause */
/* auto: Integrator "auto", and "sir" with 0 candidates: a pilot measures which method, proposal, M and N are best
 * for a scene. For src/cli and the tests. */
#pragma once

#include "bis/render/render.h"

enum { BIS_AUTO_MOST_TRIED = 24 };

/* One of the settings that the pilot has tried. The time that a render takes to reach an error is in proportion to
 * (fill + cost) x variance. */
typedef struct bis_auto_tried {
    bis_settings settings;
    int replicates;  /* that it took part in: the more, the longer it was among the best */
    double fill;     /* processor seconds of a pass that do not depend on the picture's size */
    double cost;     /* processor seconds of a pass of the full picture, beside the fill */
    double variance; /* relMSE (docs/budgets.md) of a pass */
} bis_auto_tried;

typedef struct bis_auto_report {
    bis_settings settings; /* to render with */
    /* false: there was nothing to choose (the scene has no surface or no light), or no time (the render is too short,
     * or was interrupted); settings are then those of a scene that names no integrator */
    bool is_chosen;
    const char *reason; /* why nothing was chosen, in a few words; NULL: is_chosen, or nothing was left open */
    int chosen; /* index into tried */
    bis_auto_tried tried[BIS_AUTO_MOST_TRIED];
    int n_tried;
    int width, height, passes; /* the pilot's film, and passes of each replicate */
    double seconds;
} bis_auto_report;

/* bis_auto_cost_of returns the processor seconds of a pass of the full picture with the i-th setting. */
double bis_auto_cost_of(const bis_auto_report *r, int i);

/* bis_auto_is_wanted returns whether the choice is left to the program. */
bool bis_auto_is_wanted(const bis_settings *s);

/* bis_auto_choose chooses the settings to render desc with: *report receives them, or desc->view.settings where these
 * leave nothing open. scene is built for desc; options are those of the render to come: budget, threads, ranks (only
 * its size is read), interrupted. A render that is too short for a pilot of less than 5% of its time has none.
 * The pilot has other random numbers than the render. What it chooses does not depend on the render's, so an unbiased
 * method stays unbiased. But it depends on the clock: to make the same picture again, give the chosen settings.
 * Errors: BIS_NOMEM. */
bis_status bis_auto_choose(bis_auto_report *report, const bis_scene *scene, const bis_scene_desc *desc,
                           const bis_render_options *options, bis_diag *diag);
