/* accel: the choice of a backend. Rendering code knows bis/accel.h only. */
#include "bis/shape/accel.h"
#include "bis/shape/geometry.h"

#include "embree.h"
#include "grid.h"

#include <assert.h>

bis_status bis_accel_new(bis_accel **out, const bis_geometry *g, const bis_accel_options *options, bis_diag *diag)
{
    bool embree = options->kind == BIS_ACCEL_EMBREE;

    assert(bis_geometry_primitives(g) > 0);
    if (options->kind == BIS_ACCEL_DEFAULT) embree = bis_accel_embree_version() != NULL;
    if (embree) return bis_embree_new(out, g, options->n_threads, diag);
    return bis_grid_new(out, g, options->density, options->n_threads, diag);
}

void bis_accel_occluded_many(const bis_accel *a, vec3 o, const vec3 *d, uint32_t n, bool *occluded)
{
    if (a && a->ops->occluded_many) {
        a->ops->occluded_many(a, o, d, n, occluded);
        return;
    }
    for (uint32_t i = 0; i < n; i++) {
        const ray r = {o, d[i], INFINITY};
        occluded[i] = bis_accel_occluded(a, &r);
    }
}

void bis_accel_free(bis_accel *a)
{
    if (a) a->ops->free(a);
}
