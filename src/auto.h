/* auto: Integrator "auto", and "sir" with 0 candidates: a pilot measures which method, proposal, M and N are best
 * for a scene. For src/cmd_render.c and the tests. */
#ifndef BIS_AUTO_H
#define BIS_AUTO_H

#include "bis/render.h"

enum { BIS_AUTO_MOST_TRIED = 24 };

/* One of the settings that the pilot has tried. What a render takes to reach an error is in proportion to cost x
 * variance. */
typedef struct bis_auto_tried {
    bis_settings settings;
    int replicates;   /* that it took part in: the more, the longer it was among the best */
    double cost;      /* processor seconds of a pass of the full picture */
    double variance;  /* of a pass: its relMSE (SPEC 5) */
} bis_auto_tried;

typedef struct bis_auto_report {
    bis_auto_tried tried[BIS_AUTO_MOST_TRIED];
    int n_tried;      /* 0: nothing to choose, the scene has no surface or no light */
    int chosen;       /* index into tried; -1: none (n_tried is 0, or it was interrupted): the default was taken */
    int width, height, passes; /* the pilot's film, and passes of each replicate */
    double seconds;
} bis_auto_report;

/* Is the choice left to the program? */
bool bis_auto_is_wanted(const bis_settings *s);

/* What to render desc with, *chosen (desc->settings itself where it is not wanted). scene: built for desc. options:
 * those of the render to come: budget, threads, interrupted.
 * Other random numbers than the render's own: what is chosen does not depend on them, so that an unbiased method stays
 * so. But it depends on the clock:
 * to make the same picture again, give its settings. Errors: BIS_NOMEM. */
bis_status bis_auto_choose(bis_settings *chosen, bis_auto_report *report, const bis_scene *scene,
                           const bis_scene_desc *desc, const bis_render_options *options, bis_diag *diag);

#endif
