/* SPDX-License-Identifier: BSD-2-Clause */
/* point: all that an integrator may know of the point that it shades. */
#pragma once

#include "bis/shape/accel.h"
#include "bis/thesis/bsdf.h"
#include "bis/thesis/light.h"

#include <stdint.h>

/* What was done. Each thread counts its own; the numbers are added up in the end (docs/errata.md E30). */
typedef struct bis_counters {
    uint64_t camera_rays, shadow_rays, candidates, accepted, fallbacks;
    /* estimates that were NaN or infinite. This is a defect, and it is counted where the estimate reaches the film */
    uint64_t nonfinite;
    uint64_t beside_portals; /* camera rays that see the light where none of its portals is */
} bis_counters;

typedef struct bis_ray_sink bis_ray_sink;

/* The point that is shaded. Directions are unit vectors in world space that point away from the surface. */
typedef struct bis_point {
    vec3 p, n, ng;  /* position; shading and geometric normal, both on wo's side */
    vec3 origin;    /* p moved out of the surface by its error bound; shadow rays start here */
    vec3 wo;        /* towards the eye */
    bis_bsdf bsdf;  /* f, sample, pdf */
    const bis_light *light;
    const bis_accel *accel;
    bis_counters *counters;
    bis_ray_sink *ray_sink; /* takes the shadow rays of bis_point_add; NULL: they are traced at once */
} bis_point;

/* A renderer that traces the shadow rays of many points together (src/render/wave.h). `add` takes one ray and the term
 * C of the point's estimate that it carries. *seen, unless seen is NULL, grows by 1 if nothing hides the light. */
struct bis_ray_sink {
    void (*add)(bis_ray_sink *ray_sink, const bis_point *pt, vec3 wi, const rgbd *C, uint16_t *seen);
};

/* bis_point_sees returns V of eq. 4.1: true if no surface hides the light in direction wi. Below the geometric
 * surface V is 0, and no ray is cast or counted. */
static inline bool bis_point_sees(const bis_point *pt, vec3 wi)
{
    if (dot(pt->ng, wi) <= 0) return false;
    pt->counters->shadow_rays++;
    ray r = {pt->origin, wi, INFINITY};
    return !bis_accel_occluded(pt->accel, &r);
}

/* bis_point_add adds the term C V(wi) of an estimate to *sum, with V of eq. 4.1. With pt->ray_sink the ray is only
 * noted: the renderer adds the term when it has traced the ray. So an estimate is what Lo returns plus its noted
 * terms, in the order in which they were added, and nothing may depend on V but the sum. *seen, unless seen is NULL,
 * grows by 1 if V = 1. Rays are counted as by bis_point_sees. */
static inline void bis_point_add(rgbd *sum, const bis_point *pt, vec3 wi, rgbd C, uint16_t *seen)
{
    if (pt->ray_sink) {
        if (dot(pt->ng, wi) <= 0) return;
        pt->counters->shadow_rays++;
        pt->ray_sink->add(pt->ray_sink, pt, wi, &C, seen);
    } else if (bis_point_sees(pt, wi)) {
        *sum = rgbd_add(*sum, C);
        if (seen) ++*seen;
    }
}
