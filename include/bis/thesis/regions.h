/* SPDX-License-Identifier: BSD-2-Clause */
/* regions: which pixels together make up one light source. Source: thesis 3.4 and figure 3.6.
 *
 * Intensities are quantised into equal bins of their logarithm, the levels. A component is a connected set of pixels
 * of equal level. Breadth-first search finds it over 4 neighbours; the left and right edges of the map are joined.
 * All pixels of equal level in the top row are neighbours of one another, because they touch at the pole; likewise in
 * the bottom row (docs/errata.md E18, E19). The cost is linear in the number of pixels. The search keeps its own
 * queue and does not recurse. */
#pragma once

#include "bis/base/components.h"
#include "bis/thesis/envmap.h"

#include <stdint.h>

#define BIS_REGION_NONE BIS_COMPONENT_NONE /* a black pixel; BIS_LEVEL_NONE is its level */

/* The area of a small light in thesis 3.4. A component larger than this keeps the importance of one of this area. In
 * steradians (docs/errata.md E17). */
#define BIS_AREA_CLAMP 0.01

typedef struct bis_regions {
    uint32_t *label;     /* label[height * width]: the component of each pixel, or BIS_REGION_NONE */
    uint32_t n;          /* number of components */
    double *solid_angle; /* solid_angle[n], sr */
    uint8_t *level;      /* level[n] */
} bis_regions;

/* The levels of a map: level(I) = min(levels - 1, floor(levels log(I/Imin) / log(Imax/Imin))) over the positive
 * intensities. If Imin = Imax, there is one level. */
typedef struct bis_levels {
    int n;
    double least;     /* the smallest positive intensity; levels depend on I/least and so not on the exposure */
    double log_range; /* log(Imax/Imin); 0: one level */
} bis_levels;

/* bis_levels_of returns the levels of a map. `levels` is their number, in [1, 254]. A black map has no level: no
 * pixel has a positive intensity. */
bis_levels bis_levels_of(const bis_envmap *em, int levels);

/* bis_level_of_intensity returns the level of an intensity, and BIS_LEVEL_NONE for 0. */
uint8_t bis_level_of_intensity(const bis_levels *l, double intensity);

enum { BIS_REGIONS_BYTES = 4 + 1 }; /* a pixel while components are found: a label, which stays, and a level */

/* bis_regions_init finds the components of a map. `levels` is in [1, 254]. Memory: BIS_REGIONS_BYTES a pixel, 4 of them
 * afterwards, and 64 bytes a column for each thread. Errors: BIS_NOMEM. */
bis_status bis_regions_init(bis_regions *r, const bis_envmap *em, int levels, bis_diag *diag);

/* bis_regions_clear frees the components. *r is empty afterwards. */
void bis_regions_clear(bis_regions *r);

/* bis_area_factor returns the factor of thesis 3.4 for the pixels of a component: min(0.01 sr, solid_angle)^b,
 * divided by 0.01^b. The constant divisor cancels in all probabilities. With it, the factor is 1 for large lights,
 * and in (0, 1] for every b that does not underflow. */
double bis_area_factor(double solid_angle, double b);
