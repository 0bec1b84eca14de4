/* SPDX-License-Identifier: BSD-2-Clause */
/* geometry: all surfaces of a scene in world space, ready for an accelerator: triangles (with or without vertex
 * normals), spheres and discs (each under any affine transformation). Primitives are numbered: triangles first, then
 * quadrics. */
#pragma once

#include "bis/base/clones.h"
#include "bis/base/status.h"
#include "bis/base/xform.h"

#include <stdint.h>

/* Texture coordinates of a vertex. u is NaN where a vertex has none. */
typedef struct bis_uv {
    float u, v;
} bis_uv;

/* The result of a mesh reader: indexed triangles in the file's space. The arrays come from bis_alloc. */
typedef struct bis_mesh {
    vec3 *p;         /* p[n_vertices] */
    vec3 *n;         /* n[n_vertices] or NULL */
    bis_uv *uv;      /* uv[n_vertices] or NULL */
    uint32_t *index; /* index[n_triangles][3], each < n_vertices */
    uint32_t *part;  /* part[n_triangles], what a file tells apart, or NULL. A geometry does not ask */
    size_t n_vertices, n_triangles;
} bis_mesh;

/* bis_mesh_clear frees the arrays. *m is empty afterwards. */
void bis_mesh_clear(bis_mesh *m);

/* The parts of a mesh whose triangles are sorted by part. The arrays come from bis_alloc. */
typedef struct bis_mesh_parts {
    size_t n;
    size_t *first;    /* first[n + 1]: part k is the triangles [first[k], first[k + 1]) */
    uint32_t *number; /* number[n_vertices], for bis_mesh_take_part: UINT32_MAX between its calls */
} bis_mesh_parts;

/* bis_mesh_sort_parts sorts the triangles of *m by part, each m->part < n, in the order that they have within a part.
 * Errors: BIS_NOMEM. */
bis_status bis_mesh_sort_parts(bis_mesh_parts *parts, bis_mesh *m, size_t n, bis_diag *diag);
void bis_mesh_parts_clear(bis_mesh_parts *parts);

/* bis_mesh_take_part stores in *out a copy of part k of m, with the vertices that it uses. Cost: in proportion to the
 * part. Errors: BIS_NOMEM. */
bis_status bis_mesh_take_part(bis_mesh *out, const bis_mesh *m, bis_mesh_parts *parts, size_t k, bis_diag *diag);

/* bis_mesh_smooth_normals computes vertex normals from the faces, weighted by angle. It serves `smooth` for meshes
 * that have no normals. Vertices of equal position share a normal only if they share the index. A vertex without any
 * proper face gets (0,0,0), which means "use the normal of the face". Errors: BIS_NOMEM. */
bis_status bis_mesh_smooth_normals(bis_mesh *m, bis_diag *diag);

typedef enum bis_quadric_kind { BIS_SPHERE, BIS_DISK } bis_quadric_kind;

/* A sphere of `radius` about the origin, or a disc of `radius` in the plane z = height, in object space. */
typedef struct bis_quadric {
    bis_quadric_kind kind;
    double radius, height;
    bis_xform to_world;
    uint32_t material;
} bis_quadric;

/* The triangles [first, first of the next range) have this material, and their transformation exchanges left and right
 * (1) or not (0). */
typedef struct bis_range {
    uint32_t first, material, mirrored;
} bis_range;

typedef struct bis_box {
    vec3 lo, hi; /* empty: lo > hi */
} bis_box;

/* bis_box_include makes the box large enough for p, which must be finite. No fminf, because that is a call to the C
 * library. */
static inline void bis_box_include(bis_box *b, vec3 p)
{
    b->lo = (vec3){b->lo.x < p.x ? b->lo.x : p.x, b->lo.y < p.y ? b->lo.y : p.y, b->lo.z < p.z ? b->lo.z : p.z};
    b->hi = (vec3){b->hi.x > p.x ? b->hi.x : p.x, b->hi.y > p.y ? b->hi.y : p.y, b->hi.z > p.z ? b->hi.z : p.z};
}

typedef struct bis_geometry {
    vec3 *p;         /* p[n_vertices + 1]: one more, because Embree reads 16 bytes per vertex */
    vec3 *n;         /* vertex normals n[n_vertices], or NULL if no mesh has any; (0,0,0): use the normal of the face */
    bis_uv *uv;      /* texture coordinates uv[n_vertices], or NULL if no mesh has any */
    uint32_t *index; /* index[n_triangles][3] */
    size_t n_vertices, n_triangles, capacity_vertices, capacity_triangles;
    bis_range *ranges;
    size_t n_ranges;
    bis_quadric *quadrics;
    size_t n_quadrics;
    bis_box box;
} bis_geometry;

/* bis_geometry_add_mesh appends a mesh, transformed by to_world. If g is empty and to_world is the identity, the mesh
 * is moved and not copied (*m is then empty). Errors: BIS_NOMEM, BIS_INPUT (more than 2^32 - 1 vertices or
 * primitives; a transformed vertex that overflows a float). */
bis_status bis_geometry_add_mesh(bis_geometry *g, bis_mesh *m, const bis_xform *to_world, uint32_t material,
                                 bis_diag *diag);

/* bis_geometry_add_quadric appends a copy of a sphere or disc. Errors: BIS_NOMEM, BIS_INPUT (more than 2^32 - 1
 * primitives; a box that overflows a float). */
bis_status bis_geometry_add_quadric(bis_geometry *g, const bis_quadric *q, bis_diag *diag);

/* bis_geometry_clear frees everything. *g is empty afterwards. */
void bis_geometry_clear(bis_geometry *g);

/* bis_geometry_primitives returns the number of primitives. */
static inline size_t bis_geometry_primitives(const bis_geometry *g) { return g->n_triangles + g->n_quadrics; }

/* bis_geometry_bytes returns the bytes that the arrays take. */
size_t bis_geometry_bytes(const bis_geometry *g);

/* bis_geometry_bounds returns a box in world space that contains the primitive; it may be slightly too large. */
bis_box bis_geometry_bounds(const bis_geometry *g, uint32_t prim);

/* bis_quadric_intersect intersects a ray with one quadric, in double, and stores the nearest root in (0, tmax) in *t.
 * Returns false if there is none. Both accelerators use it. */
bool bis_quadric_intersect(const bis_quadric *q, const ray *r, float *t);

/* The surface where a ray meets a primitive. */
typedef struct bis_surface {
    vec3 p;         /* on the surface: computed in double from the vertices, rounded once */
    vec3 p_error;   /* bound of |p - true p| for each component */
    vec3 ng, n;     /* unit geometric and shading normal; ng is on the side of -d, n on the side of ng */
    uint32_t material;
} bis_surface;

/* bis_geometry_surface computes the surface where the ray r meets primitive `prim`, which an accelerator found. The
 * result does not depend on the accelerator, because the barycentric coordinates are computed again in double. */
void bis_geometry_surface(const bis_geometry *g, uint32_t prim, const ray *r, bis_surface *s);

/* bis_geometry_uv stores in uv the texture coordinates where r meets primitive `prim`, which an accelerator found. They
 * are pbrt's: interpolated between vertices, or, on a triangle that lacks some, between (0,0), (1,0) and (1,1); on a
 * sphere (phi/2pi, 1 - theta/pi), on a disc (phi/2pi, 1 - r/radius), with phi in [0, 2pi) about z from x. */
void bis_geometry_uv(const bis_geometry *g, uint32_t prim, const ray *r, double uv[2]);

/* How a surface lies where it is met. */
typedef struct bis_tangents {
    double u[3], v[3]; /* the derivatives of the point by its texture coordinates, world space */
    /* the unit normal of the side that pbrt calls outside without ReverseOrientation: that of the vertex normals, or,
     * on a triangle without them, from where its vertices turn counterclockwise in a right-handed world, before its
     * transformation mirrors it */
    double outside[3];
    bool is_arbitrary;   /* the texture coordinates give no derivatives: u and v are any two */
} bis_tangents;

/* bis_geometry_tangents stores in *t how primitive `prim` lies where r meets it, which an accelerator found. It is for
 * who bends the normal. Where the coordinates of a triangle give no derivatives, they are two unit vectors in its
 * plane, as in pbrt. */
void bis_geometry_tangents(const bis_geometry *g, uint32_t prim, const ray *r, bis_tangents *t);

/* bis_geometry_prefetch asks the memory for what bis_geometry_surface will read of the primitives prim[n], of which
 * BIS_NO_PRIM are left out. It asks for the indices of all vertices before it reads any of them, and does not wait for
 * the vertices and normals. It is for a caller with many hits at once.
 * always_inline, because gcc takes a function that only prefetches for one without effect and leaves out its calls
 * (scripts/check/check_prefetch.sh looks whether they are there). */
static inline BIS_INLINE void bis_geometry_prefetch(const bis_geometry *g, const uint32_t *prim, uint32_t n)
{
    for (uint32_t k = 0; k < n; k++) {
        if (prim[k] >= g->n_triangles) continue; /* no primitive, or one of few quadrics, which are near */
        __builtin_prefetch(g->index + 3 * (size_t)prim[k]);
        __builtin_prefetch(g->index + 3 * (size_t)prim[k] + 2); /* perhaps in the next cache line */
    }
    for (uint32_t k = 0; k < n; k++) {
        if (prim[k] >= g->n_triangles) continue;
        for (size_t i = 3 * (size_t)prim[k]; i < 3 * (size_t)prim[k] + 3; i++) {
            __builtin_prefetch(&g->p[g->index[i]]);
            if (g->n) __builtin_prefetch(&g->n[g->index[i]]);
        }
    }
}

/* bis_surface_offset returns a point where a shadow ray may start: it lies on ng's side of s->p, beyond the error
 * bound. There is no constant epsilon (docs/errata.md E37). */
vec3 bis_surface_offset(const bis_surface *s);
