/* point: traces the shadow rays of one point in groups. */
#include "bis/thesis/point.h"

enum { GROUP = 64 };

void bis_point_sees_many(const bis_point *pt, const vec3 *wi, uint32_t n, bool *sees)
{
    vec3 d[GROUP];
    uint32_t at[GROUP];
    bool occluded[GROUP];

    for (uint32_t i = 0; i < n;) {
        uint32_t count = 0;
        for (; i < n && count < GROUP; i++) {
            sees[i] = false;
            if (dot(pt->ng, wi[i]) <= 0) continue;
            at[count] = i;
            d[count++] = wi[i];
        }
        pt->counters->shadow_rays += count;
        bis_accel_occluded_many(pt->accel, pt->origin, d, count, occluded);
        for (uint32_t k = 0; k < count; k++) sees[at[k]] = !occluded[k];
    }
}
