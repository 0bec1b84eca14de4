/* SPDX-License-Identifier: BSD-2-Clause */
/* accel: the choice of a backend. Rendering code knows bis/accel.h only. */
#include "bis/shape/accel.h"
#include "bis/shape/geometry.h"

#include "embree.h"
#include "grid.h"

#include <assert.h>
#include <stdio.h>

/* The geometry and the eyes. */
static bis_box reach(const bis_geometry *g, const bis_box *eyes)
{
    bis_box b = g->box;

    if (!eyes) return b;
    b.lo = (vec3){fminf(b.lo.x, eyes->lo.x), fminf(b.lo.y, eyes->lo.y), fminf(b.lo.z, eyes->lo.z)};
    b.hi = (vec3){fmaxf(b.hi.x, eyes->hi.x), fmaxf(b.hi.y, eyes->hi.y), fmaxf(b.hi.z, eyes->hi.z)};
    return b;
}

/* What Embree cannot do with this scene; "" if there is nothing. */
static void embree_limit(char text[200], const bis_box *b)
{
    const double lo[3] = {(double)b->lo.x, (double)b->lo.y, (double)b->lo.z},
                 hi[3] = {(double)b->hi.x, (double)b->hi.y, (double)b->hi.z};
    int most = 0, far = 0;

    for (int c = 1; c < 3; c++) {
        if (hi[c] - lo[c] > hi[most] - lo[most]) most = c;
        if (fmax(-lo[c], hi[c]) > fmax(-lo[far], hi[far])) far = c;
    }
    const double size = hi[most] - lo[most];
    text[0] = 0;
    if (fmax(-lo[far], hi[far]) > BIS_EMBREE_FAR) {
        snprintf(text, 200, "the scene or its camera reaches to %c = %g, and Embree works up to %g", 'x' + far,
                 hi[far] > -lo[far] ? hi[far] : lo[far], BIS_EMBREE_FAR);
    } else if (size > BIS_EMBREE_MOST) {
        snprintf(text, 200, "the scene and its camera measure %g along %c, and Embree loses triangles beyond %g", size,
                 'x' + most, BIS_EMBREE_MOST);
    } else if (size > 0 && size < BIS_EMBREE_LEAST) { /* of size 0 there is nothing to see */
        snprintf(text, 200, "the scene and its camera measure %g, and Embree loses triangles below %g", size,
                 BIS_EMBREE_LEAST);
    }
}

bool bis_accel_takes_embree(const bis_geometry *g, const bis_accel_options *options)
{
    const bis_box all = reach(g, options->eyes);
    char limit[200];

    if (!bis_accel_embree_version() || options->kind == BIS_ACCEL_GRID) return false;
    embree_limit(limit, &all);
    return !limit[0];
}

bis_status bis_accel_new(bis_accel **out, const bis_geometry *g, const bis_accel_options *options, bis_diag *diag)
{
    const bool by_default = options->kind == BIS_ACCEL_DEFAULT;
    const bool embree = bis_accel_embree_version() && options->kind != BIS_ACCEL_GRID;
    char limit[200] = "";

    assert(bis_geometry_primitives(g) > 0);
    *out = NULL;
    if (embree) {
        const bis_box all = reach(g, options->eyes);
        embree_limit(limit, &all);
    }
    if (limit[0] && !by_default) {
        return bis_error(diag, BIS_INPUT, (bis_loc){0},
                         "%s: scale the scene, or use the accelerator \"grid\" (--accelerator grid)", limit);
    }
    if (limit[0]) bis_warn(diag, (bis_loc){0}, "%s: the grid is used instead", limit);
    if ((embree && !limit[0]) || options->kind == BIS_ACCEL_EMBREE)
        return bis_embree_new(out, g, options->n_threads, diag);
    return bis_grid_new(out, g, options->density, options->n_threads, diag);
}

void bis_accel_intersect_many(const bis_accel *a, const ray *r, uint32_t n, uint32_t *prim)
{
    if (a && a->ops->intersect_many) {
        a->ops->intersect_many(a, r, n, prim);
        return;
    }
    for (uint32_t i = 0; i < n; i++) {
        bis_hit hit;
        prim[i] = bis_accel_intersect(a, &r[i], &hit) ? hit.prim : BIS_NO_PRIM;
    }
}

void bis_accel_occluded_many(const bis_accel *a, const ray *r, uint32_t n, bool *occluded)
{
    if (a && a->ops->occluded_many) {
        a->ops->occluded_many(a, r, n, occluded);
        return;
    }
    for (uint32_t i = 0; i < n; i++) occluded[i] = bis_accel_occluded(a, &r[i]);
}

void bis_accel_free(bis_accel *a)
{
    if (a) a->ops->free(a);
}
