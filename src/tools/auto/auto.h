/* auto: Integrator "auto", and "sir" with 0 candidates: a pilot measures which method, proposal, M and N are best
 * for a scene, and for which of its materials. For src/cli/cmd_render.c and the tests. */
#ifndef BIS_AUTO_H
#define BIS_AUTO_H

#include "auto_groups.h"

#include "bis/render/render.h"

enum { BIS_AUTO_MOST_TRIED = 24 };

/* One of the settings that the pilot has tried. What a render takes to reach an error is in proportion to cost x
 * variance, both summed over groups of materials. */
typedef struct bis_auto_tried {
    bis_settings settings;
    unsigned groups;  /* bit g: it may be chosen for group g; a pilot cannot judge it for the others */
    int replicates;   /* that it took part in: the more, the longer it was among the best */
    double fill;      /* processor seconds of a pass, however small the picture: once for all groups that have these settings */
    double cost[BIS_AUTO_MOST_GROUPS];     /* those that the group's points add to a pass of the full picture */
    double variance[BIS_AUTO_MOST_GROUPS]; /* the group's part in the relMSE (docs/budgets.md) of a pass */
} bis_auto_tried;

typedef struct bis_auto_report {
    bis_settings settings;     /* to render with */
    bis_exceptions exceptions; /* and for whom not; whoever moves it leaves n = 0 */
    bool is_chosen;   /* false: there was nothing to choose (the scene has no surface or no light: n_tried is 0), or no time: settings are the default */
    int n_groups;     /* of materials, 1 where all were taken together */
    unsigned char *group; /* group[n_materials] */
    double share[BIS_AUTO_MOST_GROUPS]; /* of what the camera sees of surfaces */
    int chosen[BIS_AUTO_MOST_GROUPS];   /* index into tried */
    bis_auto_tried tried[BIS_AUTO_MOST_TRIED];
    int n_tried;
    double common;    /* processor seconds of a pass beside shading and fills; 0 with one group, whose cost holds them */
    int width, height, passes; /* the pilot's film, and passes of each replicate */
    double seconds;
} bis_auto_report;

/* May the i-th setting be chosen for group g (BIS_AUTO_ALL: for all together)? */
enum { BIS_AUTO_ALL = -1 };
bool bis_auto_suits(const bis_auto_report *r, int g, int i);

/* Sums over the groups: with the i-th setting for all. */
double bis_auto_cost_of_all(const bis_auto_report *r, int i);
double bis_auto_variance_of_all(const bis_auto_report *r, int i);

/* Is the choice left to the program? */
bool bis_auto_is_wanted(const bis_settings *s);

/* What to render desc with: report->settings (desc->settings itself where it is not wanted) and exceptions. scene:
 * built for desc. options: those of the render to come: budget, threads, interrupted.
 * Other random numbers than the render's own: what is chosen does not depend on them, so that an unbiased method stays
 * so. But it depends on the clock:
 * to make the same picture again, give its settings. Errors: BIS_NOMEM. To be cleared, whatever the status. */
bis_status bis_auto_choose(bis_auto_report *report, const bis_scene *scene, const bis_scene_desc *desc, const bis_render_options *options, bis_diag *diag);
void bis_auto_report_clear(bis_auto_report *report);

#endif
