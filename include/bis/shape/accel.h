/* accel: does a ray hit anything, and what first? One interface, two backends: the voxel grid of the thesis
 * (src/shape/grid.h), Embree (src/shape/embree.h). */
#ifndef BIS_ACCEL_H
#define BIS_ACCEL_H

#include "bis/base/status.h"
#include "bis/base/vec.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct bis_accel bis_accel;
typedef struct bis_geometry bis_geometry; /* bis/shape/geometry.h */
typedef struct bis_box bis_box;           /* there, too */

typedef enum bis_accel_kind { BIS_ACCEL_DEFAULT, BIS_ACCEL_GRID, BIS_ACCEL_EMBREE } bis_accel_kind;

#define BIS_NO_PRIM UINT32_MAX

typedef struct bis_hit {
    float t;       /* of o + t d */
    uint32_t prim; /* primitive of the geometry */
} bis_hit;

/* A backend. Functions must not allocate nor change the accel: threads share it. */
typedef struct bis_accel_ops {
    const char *name;
    bool (*intersect)(const bis_accel *a, const ray *r, bis_hit *hit);
    bool (*occluded)(const bis_accel *a, const ray *r);
    size_t (*bytes)(const bis_accel *a);
    void (*free)(bis_accel *a);
    void (*occluded_many)(const bis_accel *a, vec3 o, const vec3 *d, uint32_t n, bool *occluded); /* NULL: one by one */
} bis_accel_ops;

/* Backends embed this as their first member. */
struct bis_accel {
    const bis_accel_ops *ops;
    const bis_geometry *geometry;
};

typedef struct bis_accel_options {
    bis_accel_kind kind;  /* DEFAULT: Embree where built in, else the grid */
    double density;       /* grid: cells per primitive; 0: the documented default */
    int n_threads;        /* for building; 0: all */
    const bis_box *eyes;  /* where rays start that start on no surface: the camera; NULL: none */
} bis_accel_options;

/* What Embree can do, in floats: no coordinate of the geometry or of a ray's start beyond BIS_EMBREE_FAR; from
 * BIS_EMBREE_LEAST to BIS_EMBREE_MOST from end to end (src/shape/embree.c derives them). */
#define BIS_EMBREE_FAR 1.8e18
#define BIS_EMBREE_MOST 3e12
#define BIS_EMBREE_LEAST 1e-10

/* g is borrowed for the life of the result and must have at least one primitive. Where Embree is only the default and
 * cannot do this geometry, a warning says so and the grid is built. Errors: BIS_INPUT (Embree asked for but not built
 * in, or not able: the message names the value, the limit and the way out), BIS_NOMEM. */
bis_status bis_accel_new(bis_accel **out, const bis_geometry *g, const bis_accel_options *options, bis_diag *diag);
void bis_accel_free(bis_accel *a);

/* Is Embree built in? Its version as text ("3.13.5"), or NULL. */
const char *bis_accel_embree_version(void);

/* The nearest hit in (0, r->tmax), both sides of a surface. NULL accel: an empty scene. */
static inline bool bis_accel_intersect(const bis_accel *a, const ray *r, bis_hit *hit)
{
    return a && a->ops->intersect(a, r, hit);
}
/* Any hit in (0, r->tmax)? */
static inline bool bis_accel_occluded(const bis_accel *a, const ray *r) { return a && a->ops->occluded(a, r); }
/* The same for n rays from o without end, directions d[n]: occluded[n]. May be faster than one by one. */
void bis_accel_occluded_many(const bis_accel *a, vec3 o, const vec3 *d, uint32_t n, bool *occluded);

static inline const char *bis_accel_name(const bis_accel *a) { return a ? a->ops->name : "none"; }
static inline size_t bis_accel_bytes(const bis_accel *a) { return a ? a->ops->bytes(a) : 0; }

#endif
