/* regions: which pixels make up a light source, thesis 3.4 and figure 3.6, SPEC 4.
 *
 * Intensities are quantised into equal bins of their logarithm; components of equal level are found by breadth-first
 * search over 4 neighbours, the left and right edges joined, and all pixels of equal level in the top row neighbours of
 * one another, likewise in the bottom row (they touch at the pole; docs/errata.md E18, E19). Linear in the number of
 * pixels; a queue of our own, no recursion. */
#ifndef BIS_REGIONS_H
#define BIS_REGIONS_H

#include "bis/thesis/envmap.h"

#include <stdint.h>

#define BIS_REGION_NONE UINT32_MAX /* a black pixel */
#define BIS_LEVEL_NONE UINT8_MAX

/* The area of a small light, thesis 3.4: above this many sr the area no longer counts. In steradians (E17). */
#define BIS_AREA_CLAMP 0.01

typedef struct bis_regions {
    uint32_t *label;     /* label[height * width]: the pixel's component or BIS_REGION_NONE */
    uint32_t n;          /* components */
    double *solid_angle; /* solid_angle[n], sr */
    uint8_t *level;      /* level[n] */
} bis_regions;

/* bin = min(levels - 1, floor(levels log(I/Imin) / log(Imax/Imin))) over positive intensities; Imin = Imax: one
 * level. */
typedef struct bis_levels {
    int n;
    double least;     /* the smallest positive intensity; by the ratio I/least, levels do not change with the exposure */
    double log_range; /* log(Imax/Imin); 0: one level */
} bis_levels;

bis_levels bis_levels_of(const bis_envmap *em, int levels);

/* The level of an intensity, BIS_LEVEL_NONE for 0. */
uint8_t bis_level_of_intensity(const bis_levels *l, double intensity);

/* levels in [1, 254]. Errors: BIS_NOMEM. Peak memory 9 bytes a pixel (label, queue, level), 4 a pixel after it. */
bis_status bis_regions_init(bis_regions *r, const bis_envmap *em, int levels, bis_diag *diag);
void bis_regions_clear(bis_regions *r);

/* min(0.01 sr, solid angle)^b, the factor of thesis 3.4 by which a component's pixels gain or lose importance, divided
 * by 0.01^b: a constant factor cancels, and so the factor is 1 for large lights and in (0, 1] for any b that does not
 * underflow. */
double bis_area_factor(double solid_angle, double b);

#endif
