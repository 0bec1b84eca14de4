/* geometry: all surfaces of a scene in world space, ready to be put into an accelerator: triangles (with or without
 * vertex normals), spheres and discs (each under any affine transformation). Primitives are numbered: triangles first,
 * then quadrics. */
#ifndef BIS_GEOMETRY_H
#define BIS_GEOMETRY_H

#include "bis/base/status.h"
#include "bis/base/vec.h"
#include "bis/base/xform.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* What a mesh reader hands over: indexed triangles, in the file's space. Arrays come from bis_alloc. */
typedef struct bis_mesh {
    vec3 *p;         /* p[n_vertices] */
    vec3 *n;         /* n[n_vertices] or NULL */
    uint32_t *index; /* index[n_triangles][3], each < n_vertices */
    size_t n_vertices, n_triangles;
} bis_mesh;

void bis_mesh_clear(bis_mesh *m);

/* Vertex normals from the faces, weighted by angle, for `smooth` and for meshes that have none. Vertices of equal
 * position share theirs only if they share the index. A vertex without any proper face gets (0,0,0), which stands for
 * "use the face's". */
bis_status bis_mesh_smooth_normals(bis_mesh *m, bis_diag *diag);

typedef enum bis_quadric_kind { BIS_SPHERE, BIS_DISK } bis_quadric_kind;

/* Sphere of `radius` about the origin, or disc of `radius` in the plane z = height, in object space. */
typedef struct bis_quadric {
    bis_quadric_kind kind;
    double radius, height;
    bis_xform to_world;
    uint32_t material;
} bis_quadric;

/* Triangles [first, next range's first) have this material. */
typedef struct bis_range {
    uint32_t first, material;
} bis_range;

typedef struct bis_box {
    vec3 lo, hi; /* empty: lo > hi */
} bis_box;

typedef struct bis_geometry {
    vec3 *p;         /* p[n_vertices + 1]: one more, because Embree reads 16 bytes a vertex */
    vec3 *n;         /* vertex normals, n[n_vertices], or NULL where no mesh has any; (0,0,0): the face's */
    uint32_t *index; /* index[n_triangles][3] */
    size_t n_vertices, n_triangles, capacity_vertices, capacity_triangles;
    bis_range *ranges;
    size_t n_ranges;
    bis_quadric *quadrics;
    size_t n_quadrics;
    bis_box box;
} bis_geometry;

/* Append a mesh, transformed. The first mesh into an empty geometry with an identity transformation is moved, not
 * copied (m is then empty). Errors: BIS_NOMEM, BIS_INPUT (over 2^32 - 1 vertices or primitives;
 * a transformed vertex that overflows float). */
bis_status bis_geometry_add_mesh(bis_geometry *g, bis_mesh *m, const bis_xform *to_world, uint32_t material, bis_diag *diag);
bis_status bis_geometry_add_quadric(bis_geometry *g, const bis_quadric *q, bis_diag *diag);
void bis_geometry_clear(bis_geometry *g);
static inline size_t bis_geometry_primitives(const bis_geometry *g) { return g->n_triangles + g->n_quadrics; }
size_t bis_geometry_bytes(const bis_geometry *g);

/* World-space box of one primitive, conservative. */
bis_box bis_geometry_bounds(const bis_geometry *g, uint32_t prim);

/* Ray against one quadric in double; the nearest root in (0, tmax). The accelerators share it. */
bool bis_quadric_intersect(const bis_quadric *q, const ray *r, float *t);

/* The surface where a ray meets a primitive. */
typedef struct bis_surface {
    vec3 p;         /* on the surface, computed in double from the vertices, rounded once */
    vec3 p_error;   /* bound of |p - true p| per component */
    vec3 ng, n;     /* unit geometric and shading normal, ng turned to -d's side, n to ng's side */
    uint32_t material;
} bis_surface;

/* From the ray and the primitive that an accelerator found. Does not depend on which accelerator: barycentrics are
 * computed again, in double. */
void bis_geometry_surface(const bis_geometry *g, uint32_t prim, const ray *r, bis_surface *s);

/* A point that lies beyond the error bound of s->p on ng's side, where a shadow ray may start: no constant epsilon
 * (docs/errata.md E37). */
vec3 bis_surface_offset(const bis_surface *s);

#endif
