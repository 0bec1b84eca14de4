/* point: all that an integrator may know of the point it shades. */
#ifndef BIS_POINT_H
#define BIS_POINT_H

#include "bis/shape/accel.h"
#include "bis/thesis/bsdf.h"
#include "bis/thesis/light.h"

#include <stdint.h>

/* What was done, counted per thread and added up in the end (docs/errata.md E30). */
typedef struct bis_counters {
    uint64_t camera_rays, shadow_rays, candidates, accepted, fallbacks;
    uint64_t nonfinite; /* estimates that were NaN or infinite: a defect, counted where it reaches the film */
} bis_counters;

/* Directions are unit, world space, away from the surface. */
typedef struct bis_point {
    vec3 p, n, ng;  /* position; shading and geometric normal, turned to wo's side */
    vec3 origin;    /* p, moved out of the surface by its error bound: where shadow rays start */
    vec3 wo;        /* towards the eye */
    bis_bsdf bsdf;  /* f, sample, pdf */
    const bis_light *light;
    const bis_accel *accel;
    bis_counters *counters;
} bis_point;

/* V of eq. 4.1: 1 where the light along wi is seen. No ray is cast (nor counted) below the geometric surface, where V =
 * 0. */
static inline bool bis_point_sees(const bis_point *pt, vec3 wi)
{
    if (dot(pt->ng, wi) <= 0) return false;
    pt->counters->shadow_rays++;
    ray r = {pt->origin, wi, INFINITY};
    return !bis_accel_occluded(pt->accel, &r);
}

/* The same for n directions: sees[n]. Rays that share their origin are cheaper together. */
void bis_point_sees_many(const bis_point *pt, const vec3 *wi, uint32_t n, bool *sees);

#endif
