/* point: adds up the terms of an estimate, whose shadow rays are traced now or later. */
#include "bis/thesis/point.h"

void bis_point_add(rgbd *sum, const bis_point *pt, vec3 wi, rgbd C, uint16_t *seen)
{
    if (pt->later) {
        if (dot(pt->ng, wi) <= 0) return;
        pt->counters->shadow_rays++;
        pt->later->add(pt->later, pt, wi, C, seen);
    } else if (bis_point_sees(pt, wi)) {
        *sum = rgbd_add(*sum, C);
        if (seen) ++*seen;
    }
}
