/* SPDX-License-Identifier: BSD-2-Clause */
/* accel: does a ray hit anything, and what does it hit first? One interface with two backends: the voxel grid of the
 * thesis (src/shape/grid.h) and Embree (src/shape/embree.h). */
#pragma once

#include "bis/base/status.h"
#include "bis/base/vec.h"

#include <stdint.h>

typedef struct bis_accel bis_accel;
typedef struct bis_geometry bis_geometry; /* bis/shape/geometry.h */
typedef struct bis_box bis_box;           /* bis/shape/geometry.h */

typedef enum bis_accel_kind { BIS_ACCEL_DEFAULT, BIS_ACCEL_GRID, BIS_ACCEL_EMBREE } bis_accel_kind;

#define BIS_NO_PRIM UINT32_MAX

typedef struct bis_hit {
    float t;       /* the hit is at o + t d */
    uint32_t prim; /* the primitive of the geometry */
} bis_hit;

/* A backend. Its functions must neither allocate nor change the accelerator, because threads share it. */
typedef struct bis_accel_ops {
    const char *name;
    bool (*intersect)(const bis_accel *a, const ray *r, bis_hit *hit);
    bool (*occluded)(const bis_accel *a, const ray *r);
    size_t (*bytes)(const bis_accel *a);
    void (*free)(bis_accel *a);
    /* NULL: one ray at a time */
    void (*intersect_many)(const bis_accel *a, const ray *r, uint32_t n, uint32_t *prim);
    void (*occluded_many)(const bis_accel *a, const ray *r, uint32_t n, bool *occluded);
} bis_accel_ops;

/* Backends embed this struct as their first member. */
struct bis_accel {
    const bis_accel_ops *ops;
    const bis_geometry *geometry;
};

typedef struct bis_accel_options {
    bis_accel_kind kind;  /* DEFAULT: Embree if it is built in, else the grid */
    double density;       /* grid: cells per primitive; 0: the default (docs/scene-format.md, "Accelerator") */
    int n_threads;        /* threads for building; 0: all */
    const bis_box *eyes;  /* box of the places where rays start that start on no surface (the camera); NULL: none */
} bis_accel_options;

/* The limits of Embree, in floats. No coordinate of the geometry or of a ray's start may exceed BIS_EMBREE_FAR. The
 * extent of the geometry must lie between BIS_EMBREE_LEAST and BIS_EMBREE_MOST. src/shape/embree.c derives these
 * limits. */
#define BIS_EMBREE_FAR 1.8e18
#define BIS_EMBREE_MOST 3e12
#define BIS_EMBREE_LEAST 1e-10

/* bis_accel_new builds an accelerator for g. g is borrowed for the life of the result and must have at least one
 * primitive. If Embree is only the default and cannot hold this geometry, a warning says so and the grid is built.
 * Errors: BIS_INPUT (Embree was requested, but is not built in or cannot hold the geometry; the message names the
 * value, the limit and the way out), BIS_NOMEM. */
bis_status bis_accel_new(bis_accel **out, const bis_geometry *g, const bis_accel_options *options, bis_diag *diag);

/* bis_accel_takes_embree returns whether Embree is built in, allowed by the options, and reaches over the geometry and
 * the eyes. */
bool bis_accel_takes_embree(const bis_geometry *g, const bis_accel_options *options);

/* bis_accel_free frees the accelerator; NULL is allowed. */
void bis_accel_free(bis_accel *a);

enum { BIS_EMBREE_COMPACT = 1 << 23 }; /* triangles: from so many on, Embree takes less memory and more time */

/* bis_accel_embree_version returns the version of Embree as text ("3.13.5"), or NULL if Embree is not built in. */
const char *bis_accel_embree_version(void);

/* bis_accel_intersect finds the nearest hit in (0, r->tmax), on either side of a surface. Returns false if there is
 * none. a = NULL is an empty scene. */
static inline bool bis_accel_intersect(const bis_accel *a, const ray *r, bis_hit *hit)
{
    return a && a->ops->intersect(a, r, hit);
}
/* bis_accel_occluded returns whether anything is hit in (0, r->tmax). */
static inline bool bis_accel_occluded(const bis_accel *a, const ray *r) { return a && a->ops->occluded(a, r); }
/* bis_accel_intersect_many stores in prim[n] what bis_accel_intersect finds for each of n rays, BIS_NO_PRIM for
 * nothing, and bis_accel_occluded_many stores in occluded[n] what bis_accel_occluded returns. They answer the same as n
 * calls, bit for bit, and are faster where neighbours in r[n] start or run close together. */
void bis_accel_intersect_many(const bis_accel *a, const ray *r, uint32_t n, uint32_t *prim);
void bis_accel_occluded_many(const bis_accel *a, const ray *r, uint32_t n, bool *occluded);

/* bis_accel_name returns the name of the backend, "none" for an empty scene. */
static inline const char *bis_accel_name(const bis_accel *a) { return a ? a->ops->name : "none"; }

/* bis_accel_bytes returns the bytes that the accelerator takes. */
static inline size_t bis_accel_bytes(const bis_accel *a) { return a ? a->ops->bytes(a) : 0; }
