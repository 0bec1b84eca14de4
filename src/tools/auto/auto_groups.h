/* auto_groups: materials that integrator "auto" chooses one setting for. For src/tools/auto/auto.c. */
#ifndef BIS_AUTO_GROUPS_H
#define BIS_AUTO_GROUPS_H

#include "bis/render/film.h"
#include "bis/scene/scene.h"

enum { BIS_AUTO_MOST_GROUPS = 1 + BIS_MAX_EXCEPTIONS };

/* How narrowly a material reflects: the inverse of the solid angle, in steradians, that its light comes from, seen at 45
 * degrees under a uniform sky; 0: a black one. */
double bis_auto_narrowness(const bis_material *m);

/* Materials of one number. */
typedef struct bis_auto_kind {
    uint32_t number;
    double key, weight; /* the logarithm of the narrowness; how many rays met it */
    int group;
} bis_auto_kind;

/* Merge n >= 1 kinds of weight > 0, sorted by key, into at most BIS_AUTO_MOST_GROUPS groups of neighbours, numbered in
 * that order. Returns their number. */
int bis_auto_merge(bis_auto_kind *kinds, int n);

/* group[desc->n_materials], by one ray through the centre of each pixel of `film` (its size alone counts); share: what
 * part of the rays that met something met the group. A material that none met is in the largest.
 * *shows, by bis_alloc: the group of what each pixel's ray met, of the largest where it met nothing; NULL with one group.
 * Errors: BIS_NOMEM. */
bis_status bis_auto_group(unsigned char *group, int *n_groups, double share[BIS_AUTO_MOST_GROUPS], unsigned char **shows, const bis_film *film, const bis_scene *scene,
                          const bis_scene_desc *desc, bis_diag *diag);

#endif
